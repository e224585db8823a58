//! `spherule view`: an interactive viewer in a window, or run by a script without a display.
//!
//! ```text
//! window or script -> events -> Viewer -> requests -> Renderer -> images -> Viewer -> Canvas
//! ```
//!
//! The [`viewer`] is a state machine without clock, threads and files. [`headless`] drives it in one thread.
//! `window`, the only module that depends on a display, drives it with two threads: one loads, the other
//! renders.

mod args;
mod camera_control;
mod canvas;
mod checkerboard;
mod colorbar;
mod commands;
mod content;
mod digits;
mod events;
mod font;
mod frame_rate;
mod headless;
mod help;
mod image;
mod keys;
mod load;
mod loading;
mod overlay;
mod refinement;
mod renderer;
mod save;
mod script;
mod session;
mod slicing;
mod times;
mod tonemap;
mod viewer;
#[cfg(feature = "view")]
mod window;
#[cfg(feature = "view")]
mod worker;
mod wrap;

pub(super) use self::args::ViewerArgs;

use self::events::Command;
use self::headless::Headless;
use self::script::Step;
use super::failure::Failure;
use super::files::{Files, STREAM};
use super::options::appearance::BarPlace;
use super::render::{RenderSetup, check_bar};
use super::source::is_scene;
use clap::Arg;
use std::fmt::Write;
use std::path::Path;
use std::process::ExitCode;

/// Options of `spherule render` that the viewer always refuses, and hides from its help.
const REFUSED: [&str; 11] = [
    "output_format",
    "region",
    "layers",
    "part",
    "split",
    "turntable",
    "fps",
    "checkpoint",
    "checkpoint_every",
    "resume",
    "terminal",
];

/// Hides an option from the viewer's help if the viewer refuses it.
pub(super) fn hide_refused(option: Arg) -> Arg {
    if REFUSED.contains(&option.get_id().as_str()) { option.hide(true) } else { option }
}

/// Returns the examples, keys and script commands at the end of `--help`.
pub(super) fn examples() -> String {
    let mut text = "\
Examples:
  spherule view                              the random field
  spherule view scene.toml --size 1280x720
  spherule view run.lammpstrj --color-by c_pe
  spherule view scene.toml --headless-script turn.txt

Keys and mouse:
"
    .to_owned();
    for (keys, what) in keys::HELP {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "  {keys:<26} {what}");
    }
    text + "\n" + &script::manual()
}

/// Runs the viewer.
pub(super) fn run(args: Box<ViewerArgs>) -> Result<ExitCode, Failure> {
    // A thread that is loading when the window closes is not joined, so its references must live as long as
    // the process.
    let args: &'static ViewerArgs = Box::leak(args);
    args.render.memory.apply();
    let setup = RenderSetup::new(&args.render)?;
    refuse(args, &setup)?;
    check_bar(&setup)?;
    if let Some(path) = &args.headless_script {
        let steps = read_script(path)?;
        script_files(args, path, &steps).check()?;
        let json = args.render.report.json;
        let pool = setup.pool()?;
        return pool
            .install(|| Headless::new(setup)?.run(&steps, json))
            .map(|()| ExitCode::SUCCESS);
    }
    open(setup, args)
}

#[cfg(feature = "view")]
fn open(setup: RenderSetup<'static>, args: &ViewerArgs) -> Result<ExitCode, Failure> {
    window::run(setup, args.render.report.json).map(|()| ExitCode::SUCCESS)
}

#[cfg(not(feature = "view"))]
fn open(_: RenderSetup<'static>, _: &ViewerArgs) -> Result<ExitCode, Failure> {
    let message = "this program was built without windows; install it with `cargo install --path . \
                   --features view`, or use --headless-script FILE";
    Err(Failure::Window(message.to_owned()))
}

/// Files that a script reads and writes.
fn script_files(args: &ViewerArgs, script: &Path, steps: &[(usize, Step)]) -> Files {
    let mut files = Files::new("view");
    if let Some(scene) = &args.render.scene {
        files.reads_particles(scene, &args.render.particles);
    }
    files.reads("the script", script);
    let mut saves = |step: &str, path: &Path| {
        files.writes(step, path);
        if is_scene(path) {
            files.writes(&format!("the spheres of {step}"), &path.with_extension("csv"));
        }
    };
    for (row, step) in steps {
        match step {
            Step::Save(path) => saves(&format!("line {row}: save"), path),
            Step::Window(path) => saves(&format!("line {row}: window"), path),
            _ => (),
        }
    }
    let saved = |(_, step): &(usize, Step)| matches!(step, Step::Key(key) if keys::command(key) == Some(Command::Save));
    if let Some(BarPlace::File(bar, _)) = &args.render.looks.color_bar {
        saves("--color-bar", bar);
    }
    if steps.iter().any(saved) {
        saves("--output", &args.render.output);
        saves("--output", &args.render.output.with_extension("toml"));
    }
    files
}

fn read_script(path: &Path) -> Result<Vec<(usize, Step)>, Failure> {
    let failed = |message: String| Failure::Window(format!("{}: {message}", path.display()));
    let text = std::fs::read_to_string(path)
        .map_err(|error| failed(format!("cannot be read: {error}")))?;
    script::parse(&text).map_err(failed)
}

/// Rejects options that apply only to rendered files.
fn refuse(args: &ViewerArgs, setup: &RenderSetup) -> Result<(), Failure> {
    let has = [
        ("--output -", args.render.output == Path::new(STREAM)),
        ("--output-format", args.render.encoding.output_format.is_some()),
        ("--region", args.render.picture.region.is_some()),
        ("--layers", !args.render.encoding.layers.is_empty()),
        ("--part", setup.part.is_some()),
        ("--turntable", setup.views.turntable().is_some()),
        ("--checkpoint", args.render.checkpoints.checkpoint.is_some()),
        ("--resume", args.render.checkpoints.resume.is_some()),
        ("--terminal", args.render.report.terminal),
        ("--frame with several", args.render.particles.frames().is_some()),
    ];
    match has.into_iter().find(|(_, has)| *has) {
        Some((name, _)) => Err(Failure::usage(
            "view",
            format!("{name} applies only to `spherule render`; remove it"),
        )),
        None => Ok(()),
    }
}
