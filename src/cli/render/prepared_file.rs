//! `--prepare`: writes a scene with its acceleration structure to a file.

use super::appearance::write_bar;
use super::args::RenderArgs;
use super::metadata;
use super::notices::Notices;
use super::prepare::{PlacedScene, Prepared};
use super::setup::RenderSetup;
use crate::cli::contents::spheres;
use crate::cli::failure::Failure;
use crate::cli::output;
use crate::cli::write_file::check_destination;
use spherule_render::memory::Size;
use spherule_render::prepared::{self, PrepareError};
use spherule_render::scene::{Identity, Settings};
use std::path::Path;
use std::process::ExitCode;

/// Writes the scene of a setup to a file.
pub(super) fn write(setup: &RenderSetup, file: &Path) -> Result<ExitCode, Failure> {
    check_destination(file)?;
    let mut placed = PlacedScene::load(setup, None)?;
    let settings = &mut placed.scene.settings;
    if !settings.stop_given {
        // The program's own stop is chosen again when the file is rendered.
        (settings.until_error, settings.spp) = (None, Settings::default().spp);
    }
    write_bar(setup, placed.legend.as_ref(), &placed.scene.settings)?;
    let identity = placed.identity.take().unwrap_or_else(|| Identity::of(&placed.scene));
    let mut built = placed.build(setup)?;
    built.report(setup, &mut Notices::default());
    setup.encoding.display.apply(&mut built.scene.settings);
    built.scene.title.clone_from(&built.title);
    let Prepared { scene, world, builder, legend, .. } = &built;
    let looks = metadata::looks(setup, None, legend.as_ref(), None);
    let written = prepared::write(file, scene, world, &identity, &looks, *builder);
    written.map_err(|error| match error {
        PrepareError::Write(error) => Failure::Write(file.to_owned(), error),
        other => Failure::Prepare(setup.source.name().into_owned(), other),
    })?;
    if !setup.report.quiet {
        let bytes = file.metadata().map_or(0, |metadata| metadata.len());
        let count = spheres(world.spheres.len() as u64);
        output::print(format_args!("{}: {count} with their tree, {}", file.display(), Size(bytes)));
    }
    Ok(ExitCode::SUCCESS)
}

/// Rejects sequences, whose images have different scenes.
pub(super) fn refuse_sequence(args: &RenderArgs) -> Result<(), Failure> {
    if args.prepare.is_none() || !args.is_sequence() {
        return Ok(());
    }
    let message = "--prepare takes one scene; give --frame one frame";
    Err(Failure::usage("render", message))
}
