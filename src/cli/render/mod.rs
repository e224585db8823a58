//! `spherule render`: renders a scene to an image file.

mod album;
mod appearance;
mod args;
mod checkpoint;
mod estimate;
mod existing;
mod files;
mod image;
mod layers;
mod memory;
mod metadata;
mod noise;
mod notes;
mod notices;
mod pace;
mod page;
mod part;
mod prepare;
mod prepared_file;
mod sequence;
mod setup;
mod summary;
mod terminal;
mod visibility;

pub(super) use self::appearance::{check_bar, check_legend, draw_annotations, write_bar};
pub(super) use self::args::{EXAMPLES, RenderArgs};
use self::checkpoint::invocation::Invocation;
use self::checkpoint::resume::Resumed;
use self::checkpoint::writer::CheckpointWriter;
use self::files::files;
use self::image::render_image;
pub(super) use self::layers::alpha;
pub(super) use self::metadata::{Subject, push_denoised, push_error};
#[cfg(test)]
pub(super) use self::prepare::PlacedScene;
pub(super) use self::prepare::frame_number;
pub(super) use self::setup::{RenderSetup, VALUES, check_alpha};
pub(super) use self::summary::warnings;
use super::failure::Failure;
use super::{output, picture_file, processor};
use std::process::ExitCode;

/// Renders, writes the image, and prints a summary; `program` is the definition of the program.
pub(super) fn run(mut args: RenderArgs, program: &clap::Command) -> Result<ExitCode, Failure> {
    args.memory.apply();
    // Only files of unfinished renders store the command line.
    let is_stored = args.part.is_given() || args.checkpoints.file().is_some();
    let mut now = if is_stored { Invocation::of_process(program) } else { Invocation::default() };
    part::add_checkpoint(&mut args, &mut now.typed)?;
    let Some(path) = &args.checkpoints.resume else {
        files(&args).check()?;
        let writer =
            CheckpointWriter::new(&args.checkpoints)?.map(|writer| writer.with(now, &args.output));
        return run_as(&args, writer.as_ref(), None);
    };
    // The file is locked before it is read, so that no other process writes it in between.
    let writer = CheckpointWriter::new(&args.checkpoints)?;
    let (resumed, args, given) = Resumed::read(path, now)?;
    files(&args).check()?;
    let writer = writer.map(|writer| writer.with(given, &args.output));
    run_as(&args, writer.as_ref(), Some(resumed))
}

fn run_as(
    args: &RenderArgs,
    writer: Option<&CheckpointWriter>,
    mut resumed: Option<Resumed>,
) -> Result<ExitCode, Failure> {
    prepared_file::refuse_sequence(args)?;
    let setup = RenderSetup::new(args)?;
    if !setup.report.quiet
        && let Some(advice) = processor::advice()
    {
        output::note(advice);
    }
    check_stream(args)?;
    check_bar(&setup)?;
    terminal::check(setup.report.terminal)?;
    if args.is_sequence() {
        let files = files(args);
        return setup.pool()?.install(|| sequence::run(&setup, &files, writer, resumed));
    }
    if let Some(resumed) = resumed.take_if(|_| args.sequence.first_picture.is_some()) {
        return Err(
            resumed.refuse("it holds a sequence; use the same --frame and --turntable as before")
        );
    }
    if let Some(file) = &args.prepare {
        return setup.pool()?.install(|| prepared_file::write(&setup, file));
    }
    picture_file::check(&setup.output)?;
    setup.pool()?.install(|| render_image(&setup, writer, resumed))
}

/// Reserves standard output for a single image; rejects it for parts and sequences.
fn check_stream(args: &RenderArgs) -> Result<(), Failure> {
    let refuse = |message: &str| Err(Failure::usage("render", message));
    if picture_file::is_stream(&args.output) && args.part.resolved().is_some() {
        return refuse("--part names its file after --output; give --output a file name");
    }
    if picture_file::is_stream(&args.output) && args.is_sequence() {
        return refuse(
            "--output - takes one image; remove --turntable, and give --frame one frame",
        );
    }
    picture_file::check_stream("render", &args.output, args.report.json)
}
