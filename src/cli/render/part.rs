//! Rendering of one part of an image to a file for `spherule merge`.
//!
//! The file is the checkpoint of the part. So the same command resumes an interrupted part, as when a
//! scheduler restarts it.

use super::appearance::OVERLAP;
use super::args::RenderArgs;
use super::checkpoint::invocation::CommandOptions;
use super::checkpoint::writer::CheckpointWriter;
use super::prepare::Prepared;
use super::setup::RenderSetup;
use crate::cli::failure::Failure;
use crate::cli::output;
use spherule_render::checkpoint::Caption;
use spherule_render::film::{Film, Region};
use spherule_render::layers::{Layer, features};
use spherule_render::overlay::annotations::{self, AnnotationDrawing};
use spherule_render::render::{ImagePart, Options, ResumableRender};
use spherule_render::scene::Scene;
use spherule_render::split::Part;
use std::path::{Path, PathBuf};

/// Returns the file of part `number`: `a.07-of-64.part` for the image `a.png`.
fn path(picture: &Path, part: Part, number: &str) -> PathBuf {
    let mut name = picture.file_stem().unwrap_or_default().to_owned();
    name.push(format!(".{number}-of-{}.part", part.count()));
    picture.with_file_name(name)
}

/// Formats the number of a part, with as many digits as the last one has.
fn number(part: Part) -> String {
    let digits = part.count().to_string().len();
    format!("{:0digits$}", part.number())
}

/// Adds the part's file to the arguments as checkpoint, and resumes it if it exists; `typed` is changed in
/// the same way.
pub(super) fn add_checkpoint(
    args: &mut RenderArgs,
    typed: &mut CommandOptions,
) -> Result<(), Failure> {
    if args.checkpoints.resume.is_some() {
        return Ok(());
    }
    let Some(part) = args.part.resolve()? else { return Ok(()) };
    typed.set("part", part.to_string());
    if args.is_sequence() {
        // Parts of a sequence are whole images, with nothing to merge.
        if args.part.split.is_some() {
            let message =
                "--split does not apply to sequences, whose parts are whole images; remove it";
            return Err(Failure::usage("render", message));
        }
        return Ok(());
    }
    if args.checkpoints.checkpoint.is_some() {
        let message = "--part saves its state in the file of the part; remove --checkpoint";
        return Err(Failure::usage("render", message));
    }
    if args.sequence.skip_existing {
        let message = "--skip-existing does not apply to parts; the same command resumes its part in any case";
        return Err(Failure::usage("render", message));
    }
    let file = path(&args.output, part, &number(part));
    if file.is_file() {
        typed.set("resume", &file);
        args.checkpoints.resume = Some(file);
    } else {
        args.checkpoints.checkpoint = Some(file);
    }
    Ok(())
}

/// Returns the data for merging other than samples, without layers.
pub(super) fn caption(setup: &RenderSetup, prepared: &Prepared) -> Caption {
    let title = prepared.title.clone();
    Caption {
        title,
        looks: prepared.looks(setup),
        drawn_over: !prepared.scene.look.is_plain(),
        annotations: annotation_drawing(setup, prepared).drawing.to_bytes(),
        layers: setup.encoding.wanted_layers(),
        ..Caption::default()
    }
}

/// Returns the drawing of the annotations over the whole image.
fn annotation_drawing(setup: &RenderSetup, prepared: &Prepared) -> AnnotationDrawing {
    let Scene { look, annotations, settings, .. } = &prepared.scene;
    let turns = setup.turn.is_some();
    annotations::draw(annotations, &prepared.world, look, settings.dpi, turns)
}

/// Completes the file of a part, and prints a summary.
pub(super) fn finish(
    setup: &RenderSetup,
    part: Part,
    prepared: &Prepared,
    writer: &CheckpointWriter,
    render: &ResumableRender,
) -> Result<(), Failure> {
    let mut caption = caption(setup, prepared);
    let file = writer.path().display();
    if !render.is_complete() {
        let taken = render.samples().total;
        output::warn(format_args!(
            "interrupted: {file} has {taken} samples; run the same command to resume"
        ));
        return Ok(());
    }
    if caption.layers.iter().any(|layer: &Layer| !layer.is_statistic()) {
        caption.tiles = known_tiles(part, render.part(), prepared.region);
        let options =
            Options { tracer: setup.tracer, region: Some(prepared.region), ..Options::default() };
        let (world, settings) = (&prepared.world, &prepared.scene.settings);
        let tiles = caption.tiles.clone();
        caption.features = features(world, settings, &options, &caption.layers, tiles)?;
    }
    writer
        .write(setup, prepared, &caption, render)
        .map_err(|error| Failure::Write(writer.path().to_owned(), error))?;
    if !annotation_drawing(setup, prepared).fits {
        output::warn(OVERLAP);
    }
    if !setup.report.quiet {
        let picture = setup.output.display();
        let all = path(&setup.output, part, "*");
        output::print(format_args!("{file}: {}", render.part()));
        output::note(format_args!(
            "when all parts are complete, run: spherule merge {} -o {picture}",
            all.display()
        ));
    }
    Ok(())
}

/// Returns the tiles whose layers a part renders: its own, or else an equal number of all.
fn known_tiles(part: Part, image_part: &ImagePart, region: Region) -> std::ops::Range<u32> {
    let tiles = Film::tile_count(region);
    if image_part.tiles == (0..tiles) { part.of(tiles) } else { image_part.tiles.clone() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_of_parts_are_in_order() {
        let file = |number: u32, count| {
            let part = Part::new(number, count).expect("it is one of them");
            path(Path::new("a/b.c.png"), part, &super::number(part))
        };
        assert_eq!(file(7, 64), Path::new("a/b.c.07-of-64.part"));
        assert_eq!(file(8, 8), Path::new("a/b.c.8-of-8.part"));
    }

    #[test]
    fn every_tile_belongs_to_one_part() {
        let region = Region { x: 0, y: 0, width: 33, height: 33 };
        let whole = ImagePart::whole(region, 4);
        for split in [None, Some(spherule_render::split::Split::Tiles)] {
            let tiles = (1..=4).flat_map(|number| {
                let part = Part::new(number, 4).expect("it is one of them");
                let image_part = part.of_image(&whole, split).expect("there are enough");
                known_tiles(part, &image_part, region)
            });
            assert!(tiles.eq(0..9), "{split:?}");
        }
    }
}
