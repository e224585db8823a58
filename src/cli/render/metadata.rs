//! Encoding and metadata of the image file.
//!
//! Metadata contain everything that determines the image, and nothing else: no time, machine or threads.
//! Equal images have equal files.

use super::prepare::{PlacedScene, Prepared};
use super::setup::RenderSetup;
use crate::cli::options::appearance::BarPlace;
use crate::cli::options::image::EncodingArgs;
use crate::cli::options::lists::{self, List};
use serde_json::Value;
use spherule_render::denoise::Judged;
use spherule_render::film::Region;
use spherule_render::image::{Format, Metadata, QUALITY, WriteOptions};
use spherule_render::layers::Layer;
use spherule_render::noise::{Noise, StopCondition};
use spherule_render::render::Render;
use spherule_render::scene::particles::Legend;
use spherule_render::scene::{Identity, Settings};

/// The subject of an image.
pub(in crate::cli) struct Subject<'a> {
    /// The scene's title; empty if it has none.
    pub(in crate::cli) title: &'a str,
    pub(in crate::cli) settings: &'a Settings,
    pub(in crate::cli) region: Region,
    /// Settings for particles: names and values.
    pub(in crate::cli) looks: &'a [(String, String)],
}

/// Metadata key of the scene's identity, in images of sequences.
pub(super) const SCENE: &str = "scene";

/// Metadata key of the number of samples, if it does not follow from the settings.
pub(super) const SAMPLES_TAKEN: &str = "samples taken";

/// Metadata keys of denoising: whether it was used, and the error without it.
pub(super) const DENOISED: &str = "denoised";
pub(super) const BEFORE: &str = "error before denoising";

/// Metadata key of an incomplete image.
pub(super) const INTERRUPTED: &str = "interrupted";

/// Returns the encoding options and metadata of the image file.
pub(super) fn write_options(
    setup: &RenderSetup,
    prepared: &Prepared,
    render: &Render,
    judged: Option<&Judged>,
) -> WriteOptions {
    let subject = Subject {
        title: &prepared.title,
        settings: &prepared.scene.settings,
        region: prepared.region,
        looks: &prepared.looks(setup),
    };
    subject.write_options(setup.encoding, setup.format, render, judged)
}

/// Returns the metadata of a complete image, without results of the render.
pub(super) fn expected(setup: &RenderSetup, placed: &PlacedScene) -> Metadata {
    let PlacedScene { scene, region, legend, identity, stored, .. } = placed;
    let listed = stored.as_ref().map(|stored| stored.metadata.as_slice());
    let subject = Subject {
        title: &setup.source.title(scene),
        settings: &scene.settings,
        region: *region,
        looks: &looks(setup, listed, legend.as_ref(), identity.as_ref()),
    };
    subject.describe(setup.format, &subject.encoding(setup.encoding, setup.format))
}

impl Prepared {
    /// Returns the settings for particles, as metadata list them.
    pub(super) fn looks(&self, setup: &RenderSetup) -> Vec<(String, String)> {
        looks(setup, self.looks.as_deref(), self.legend.as_ref(), self.identity.as_ref())
    }
}

/// Returns the settings for particles as metadata, with the scene's identity for images of a sequence. The
/// list of a prepared scene replaces the options.
pub(super) fn looks(
    setup: &RenderSetup,
    prepared: Option<&[(String, String)]>,
    legend: Option<&Legend>,
    identity: Option<&Identity>,
) -> Vec<(String, String)> {
    let mut listed = prepared.map_or_else(|| typed(setup, legend), <[_]>::to_vec);
    let Some(identity) = identity.filter(|_| setup.is_identified()) else { return listed };
    let layers: Vec<&str> = setup.encoding.wanted_layers().into_iter().map(Layer::name).collect();
    if !layers.is_empty() {
        listed.push(("layers".to_owned(), layers.join(",")));
    }
    listed.push((SCENE.to_owned(), identity.to_string()));
    listed
}

/// Returns the settings for particles of the command line.
fn typed(setup: &RenderSetup, legend: Option<&Legend>) -> Vec<(String, String)> {
    let listed = setup.particles.list(setup.frame).into_iter().chain(setup.looks.list(legend));
    let listed =
        listed.chain(setup.slices.list()).chain(setup.views.list()).chain(setup.style.list());
    let mut listed = texts(listed.chain(setup.annotations.list()).collect());
    if let Some(BarPlace::Inside(position)) = setup.color_bar {
        listed.push(("color_bar".to_owned(), position.name().to_owned()));
    }
    listed
}

fn texts(list: List) -> Vec<(String, String)> {
    let text = |value| match value {
        Value::String(text) => text,
        other => other.to_string(),
    };
    list.into_iter().map(|(name, value)| (name, text(value))).collect()
}

impl Subject<'_> {
    /// Returns the encoding options, of the command line or else of the scene.
    pub(in crate::cli) fn write_options(
        &self,
        typed: &EncodingArgs,
        format: Format,
        render: &Render,
        judged: Option<&Judged>,
    ) -> WriteOptions {
        let mut options = self.encoding(typed, format);
        options.metadata = self.metadata(format, &options, render, judged);
        options
    }

    /// Returns the encoding options without metadata.
    fn encoding(&self, typed: &EncodingArgs, format: Format) -> WriteOptions {
        let mut settings = self.settings.clone();
        typed.display.apply(&mut settings);
        WriteOptions {
            depth: typed.bits.filter(|_| format.has_sixteen_bits()).unwrap_or_default(),
            quality: typed.quality.unwrap_or(QUALITY),
            ppm: typed.ppm.unwrap_or_default(),
            exposure: settings.exposure,
            tone: settings.tone,
            resolution: settings.dpi.filter(|_| format.has_resolution()),
            metadata: Metadata::new(),
        }
    }

    /// Returns the metadata of the image, without results of the render.
    pub(in crate::cli) fn describe(&self, format: Format, options: &WriteOptions) -> Metadata {
        let mut metadata = Metadata::new();
        metadata.push("Software", concat!("spherule ", env!("CARGO_PKG_VERSION")));
        if !self.title.is_empty() {
            // NUL is the only character that files cannot store.
            metadata.push("Title", self.title.replace('\0', " "));
        }
        let listed = texts(lists::of_settings(self.settings, self.region));
        let encoding = texts(lists::of_encoding(format, options));
        for (name, text) in listed.iter().chain(self.looks).chain(&encoding) {
            metadata.push(name, text);
        }
        metadata
    }

    fn metadata(
        &self,
        format: Format,
        options: &WriteOptions,
        render: &Render,
        judged: Option<&Judged>,
    ) -> Metadata {
        let mut metadata = self.describe(format, options);
        if self.settings.has_target() {
            metadata.push("rounds", render.samples.rounds.to_string());
        }
        if let [earlier @ .., _] = &render.stop_conditions[..]
            && !earlier.is_empty()
        {
            let words: Vec<String> = earlier.iter().map(target).collect();
            metadata.push("earlier targets", words.join("; "));
        }
        if self.settings.has_target() || !render.complete {
            metadata.push(SAMPLES_TAKEN, render.samples.total.to_string());
        }
        if !render.complete {
            metadata.push(INTERRUPTED, "true");
        }
        if let Some(noise) = judged.map(|judged| judged.noise).or(render.noise) {
            push_error(&mut metadata, noise);
        }
        if let Some(Judged { denoised, before, .. }) = judged {
            push_denoised(&mut metadata, denoised.as_ref().map(|_| before));
        }
        metadata
    }
}

/// Appends the error of the image.
pub(in crate::cli) fn push_error(metadata: &mut Metadata, noise: Noise) {
    metadata.push("error", noise.error.to_string());
    metadata.push("error bound", noise.bound.to_string());
}

/// Appends whether the image was denoised, and the error `before` if it was.
pub(in crate::cli) fn push_denoised(metadata: &mut Metadata, before: Option<&Noise>) {
    metadata.push(DENOISED, before.is_some().to_string());
    if let Some(before) = before {
        metadata.push(BEFORE, before.error.to_string());
    }
}

/// Earlier targets of a resumed render.
fn target(stop: &StopCondition) -> String {
    let error = stop.until_error.map(|error| format!("until_error {error}, "));
    format!("{}spp {}", error.unwrap_or_default(), stop.spp)
}
