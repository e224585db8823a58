//! One part of a render: no picture, but a file for `spherule merge`.
//!
//! The file is the checkpoint of the part. So the same command goes on with a part that was cut off, as
//! schedulers give it again.

use super::job::Job;
use super::keeper::Keeper;
use super::layers;
use super::prepare::Prepared;
use crate::cli::args::RenderArgs;
use crate::cli::command::TypedOptions;
use crate::cli::{Failure, output};
use spherule::checkpoint::Caption;
use spherule::film::{Film, Region};
use spherule::layers::{Layer, features};
use spherule::render::{Options, Share, Unfinished};
use spherule::scene::Scene;
use spherule::split::Part;
use std::path::{Path, PathBuf};

/// Where part number `number` goes: `a.07-of-64.part` for the picture `a.png`.
fn path(picture: &Path, part: Part, number: &str) -> PathBuf {
    let mut name = picture.file_stem().unwrap_or_default().to_owned();
    name.push(format!(".{number}-of-{}.part", part.count()));
    picture.with_file_name(name)
}

/// The number of a part, with as many digits as the last one has.
fn number(part: Part) -> String {
    let digits = part.count().to_string().len();
    format!("{:0digits$}", part.number())
}

/// Makes of a command for a part one that keeps the part in its file, or goes on from it if it is there;
/// `typed` says the same.
pub(super) fn keep(args: &mut RenderArgs, typed: &mut TypedOptions) -> Result<(), Failure> {
    if args.keep.resume.is_some() {
        return Ok(());
    }
    let Some(part) = args.part.settle()? else { return Ok(()) };
    typed.set("part", part.to_string());
    if args.is_sequence() {
        // Of a sequence, whole pictures are dealt out, and there is nothing to merge.
        if args.part.split.is_some() {
            let message = "--split is for parts of one picture; those of a sequence are whole \
                           pictures: leave it out";
            return Err(Failure::usage("render", message));
        }
        return Ok(());
    }
    if args.keep.checkpoint.is_some() {
        let message = "--part keeps its render in the file of the part: leave out --checkpoint";
        return Err(Failure::usage("render", message));
    }
    if args.sequence.skip_existing {
        let message =
            "--skip-existing is for pictures; the same command goes on with its part anyway";
        return Err(Failure::usage("render", message));
    }
    let file = path(&args.output, part, &number(part));
    if file.is_file() {
        typed.set("resume", &file);
        args.keep.resume = Some(file);
    } else {
        args.keep.checkpoint = Some(file);
    }
    Ok(())
}

/// What is to be rendered: all of it, or the share of the part.
pub(super) fn share(job: &Job, region: Region, scene: &Scene) -> Result<Share, Failure> {
    let settings = &scene.settings;
    let whole = Share::whole(region, settings.spp);
    let Some(part) = job.part else { return Ok(whole) };
    let refuse = |message: &dyn std::fmt::Display| Err(Failure::usage("render", message));
    if settings.has_target() {
        return refuse(
            &"no --part knows how much is enough for the whole: give --until-error none and --time \
              none, and --spp",
        );
    }
    if !scene.look.is_plain() || scene.color_bar.is_some() {
        return refuse(
            &"--cell, --background (which presets have), a scene's [look] and [color_bar] and --color-bar \
              inside are drawn over whole pictures: leave them out with --part",
        );
    }
    part.share(&whole, job.split).or_else(|error| refuse(&format!("--part: {error}")))
}

/// What merging has to know besides samples; nothing yet of layers.
pub(super) fn caption(job: &Job, prepared: &Prepared) -> Caption {
    let layers = layers::wanted(&job.encoding.layers);
    let title = prepared.title.clone();
    let Scene { look, color_bar, .. } = &prepared.scene;
    let drawn_over = !look.is_plain() || color_bar.is_some();
    Caption { title, looks: prepared.looks(job), drawn_over, layers, ..Caption::default() }
}

/// Completes the file of a part, and tells of it.
pub(super) fn finish(
    job: &Job,
    part: Part,
    prepared: &Prepared,
    keeper: &Keeper,
    render: &Unfinished,
) -> Result<(), Failure> {
    let mut caption = caption(job, prepared);
    let file = keeper.path().display();
    if !render.is_complete() {
        let taken = render.samples().total;
        output::warn(format_args!(
            "interrupted: {file} holds {taken} samples; the same command goes on with them"
        ));
        return Ok(());
    }
    if caption.layers.iter().any(|layer: &Layer| !layer.is_statistic()) {
        caption.tiles = known_tiles(part, render.share(), prepared.region);
        let options =
            Options { tracer: job.tracer, region: Some(prepared.region), ..Options::default() };
        let (world, settings) = (&prepared.world, &prepared.scene.settings);
        let tiles = caption.tiles.clone();
        caption.features = features(world, settings, &options, &caption.layers, tiles)?;
    }
    keeper
        .write(job, prepared, &caption, render)
        .map_err(|error| Failure::Write(keeper.path().to_owned(), error))?;
    if !job.report.quiet {
        let picture = job.output.display();
        let all = path(&job.output, part, "*");
        output::print(format_args!("{file}: {}", render.share()));
        output::note(format_args!(
            "when all parts are there: spherule merge {} -o {picture}",
            all.display()
        ));
    }
    Ok(())
}

/// The tiles whose layers a part finds: its own, or else an equal share of all.
fn known_tiles(part: Part, share: &Share, region: Region) -> std::ops::Range<u32> {
    let tiles = Film::tile_count(region);
    if share.tiles == (0..tiles) { part.of(tiles) } else { share.tiles.clone() }
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
    fn every_tile_is_known_to_one_part() {
        let region = Region { x: 0, y: 0, width: 33, height: 33 };
        let whole = Share::whole(region, 4);
        for split in [None, Some(spherule::split::Split::Tiles)] {
            let tiles = (1..=4).flat_map(|number| {
                let part = Part::new(number, 4).expect("it is one of them");
                let share = part.share(&whole, split).expect("there are enough");
                known_tiles(part, &share, region)
            });
            assert!(tiles.eq(0..9), "{split:?}");
        }
    }
}
