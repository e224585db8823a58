//! How the picture is written, and what its file says about itself.
//!
//! The file says everything that makes the picture, and nothing else: no time, no machine, no
//! threads. Equal pictures have equal files.

use super::job::Job;
use super::prepare::Prepared;
use crate::cli::settings;
use serde_json::Value;
use spherule::image::{Metadata, WriteOptions};
use spherule::render::{Render, Stage};

/// All that the picture's file needs besides the picture.
pub(super) fn write_options(job: &Job, prepared: &Prepared, render: &Render) -> WriteOptions {
    let (typed, scene) = (job.encoding, &prepared.scene.settings);
    let mut options = WriteOptions {
        depth: typed.bits.unwrap_or_default(),
        ppm: typed.ppm.unwrap_or_default(),
        exposure: typed.exposure.unwrap_or(scene.exposure),
        tone: typed.tone.unwrap_or(scene.tone),
        metadata: Metadata::new(),
    };
    options.metadata = metadata(job, prepared, render, &options);
    options
}

fn metadata(job: &Job, prepared: &Prepared, render: &Render, options: &WriteOptions) -> Metadata {
    let mut metadata = Metadata::new();
    metadata.push("Software", concat!("spherule ", env!("CARGO_PKG_VERSION")));
    if !prepared.title.is_empty() {
        // NUL is the one character that files have no room for.
        metadata.push("Title", prepared.title.replace('\0', " "));
    }
    let listed = settings::list(&prepared.scene.settings, prepared.region);
    let (particles, looks) = job.typed;
    let looks = looks.list(prepared.legend.as_ref());
    let listed = listed.into_iter().chain(particles.list(job.frame)).chain(looks);
    let listed = listed.chain(job.slices.list()).chain(job.views.list()).chain(job.style.list());
    for (name, value) in listed.chain(settings::list_encoding(job.format, options)) {
        let text = match value {
            Value::String(text) => text,
            other => other.to_string(),
        };
        metadata.push(name, text);
    }
    if prepared.scene.settings.has_target() {
        metadata.push("rounds", render.samples.rounds.to_string());
    }
    if let [earlier @ .., _] = &render.stages[..]
        && !earlier.is_empty()
    {
        let words: Vec<String> = earlier.iter().map(stage).collect();
        metadata.push("earlier targets", words.join("; "));
    }
    if prepared.scene.settings.has_target() || !render.complete {
        metadata.push("samples taken", render.samples.total.to_string());
    }
    if let Some(noise) = render.noise {
        metadata.push("error", noise.error.to_string());
        metadata.push("error bound", noise.bound.to_string());
    }
    metadata
}

/// What was to be reached before.
fn stage(stage: &Stage) -> String {
    let error = stage.until_error.map(|error| format!("until_error {error}, "));
    format!("{}spp {}", error.unwrap_or_default(), stage.spp)
}
