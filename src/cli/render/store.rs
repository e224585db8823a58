//! `--prepare`: a scene goes to a file with its tree, for many renders to begin at once.

use super::job::Job;
use super::metadata;
use super::notices::Notices;
use super::prepare::{Placed, Prepared};
use super::write_bar;
use crate::cli::args::RenderArgs;
use crate::cli::contents::spheres;
use crate::cli::failure::Failure;
use crate::cli::output;
use spherule::atomic::check_destination;
use spherule::memory::Size;
use spherule::prepared::{self, PrepareError};
use spherule::scene::Identity;
use std::path::Path;
use std::process::ExitCode;

/// Writes the scene of a job to a file.
pub(super) fn write(job: &Job, file: &Path) -> Result<ExitCode, Failure> {
    check_destination(file).map_err(|error| Failure::Write(file.to_owned(), error))?;
    let mut placed = Placed::load(job, None)?;
    write_bar(job, placed.legend.as_ref(), placed.scene.settings.height)?;
    let identity = placed.identity.take().unwrap_or_else(|| Identity::of(&placed.scene));
    let mut built = placed.build(job)?;
    built.tell(job, &mut Notices::default());
    job.encoding.replace(&mut built.scene.settings);
    built.scene.title.clone_from(&built.title);
    let Prepared { scene, world, builder, legend, .. } = &built;
    let looks = metadata::looks(job, None, legend.as_ref(), None);
    let written = prepared::write(file, scene, world, &identity, &looks, *builder);
    written.map_err(|error| match error {
        PrepareError::Write(error) => Failure::Write(file.to_owned(), error),
        other => Failure::Prepare(job.source.name().into_owned(), other),
    })?;
    if !job.report.quiet {
        let bytes = file.metadata().map_or(0, |metadata| metadata.len());
        let count = spheres(world.spheres.len() as u64);
        output::print(format_args!("{}: {count} with their tree, {}", file.display(), Size(bytes)));
    }
    Ok(ExitCode::SUCCESS)
}

/// Refuses to prepare the scenes of many pictures, of which each has its own.
pub(super) fn refuse_sequence(args: &RenderArgs) -> Result<(), Failure> {
    if args.prepare.is_none() || !args.is_sequence() {
        return Ok(());
    }
    let message = "--prepare is for one scene: give --frame one number";
    Err(Failure::usage("render", message))
}

/// Refuses options that would change what a prepared scene has settled.
pub(super) fn refuse_changes(args: &RenderArgs) -> Result<(), Failure> {
    let none = args.looks.list(None).is_empty() && args.looks.color_bar.is_none();
    let none = none && args.slices.list().is_empty() && args.style.list().is_empty();
    let none = none && args.views.list().is_empty() && !args.is_sequence();
    if args.prepare.is_none() && none && !args.particles.any() {
        return Ok(());
    }
    let message = "a prepared scene has its spheres, looks and camera: name the file that it was made of, \
                   or leave out what changes these";
    Err(Failure::usage("render", message))
}
