//! `spherule view`: an interactive viewer in a page of the browser, or run by a script.
//!
//! ```text
//! page or script -> steps -> Viewer -> requests -> Renderer -> images -> Viewer -> page or files
//! ```
//!
//! The [`viewer`] is a state machine without clock, threads and files. [`headless`] drives it in one thread. [`host`]
//! drives it for pages, with a thread that loads and one that renders; [`listen`] connects pages, [`pipe`] the program that
//! started this one, and [`client`] sends them images.

mod args;
mod camera_control;
mod checkerboard;
mod client;
mod commands;
mod content;
mod events;
mod file_render;
mod frame_rate;
mod headless;
mod history;
mod host;
mod http;
mod image;
mod keys;
mod listen;
mod load;
mod loading;

mod options;
mod overlay;
mod pace;
mod page;
mod pipe;
mod plot;
mod python;
mod refinement;
mod renderer;
mod save;
mod scratch;
mod script;
mod sent_file;
mod session;
mod state;
mod steps;
mod tiles;
mod times;
mod token;
mod tonemap;
mod viewer;
mod worker;

pub(super) use self::args::{ViewerArgs, hide_refused};

use self::events::Command;
use self::headless::Headless;
use self::options::Options;
use self::script::Step;
use super::failure::Failure;
use super::files::{Files, STREAM};
use super::options::appearance::BarPlace;
use super::render::{RenderSetup, check_bar};
use super::signals;
use super::source::is_scene;
use std::fmt::Write;
use std::path::Path;
use std::process::ExitCode;

/// Returns the examples, keys and script commands at the end of `--help`.
pub(super) fn examples() -> String {
    let mut text = "\
Examples:
  spherule view                              the random field
  spherule view scene.toml --port 8000
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

/// Runs the viewer; `program` is the definition of the program.
pub(super) fn run(args: &ViewerArgs, program: &clap::Command) -> Result<ExitCode, Failure> {
    args.render.memory.apply();
    let setup = RenderSetup::new(&args.render)?;
    refuse(args, &setup)?;
    check_bar(&setup)?;
    let options = Options::of_process(program)?;
    if args.pipe {
        pipe::open(&setup, options)?;
        return Ok(ended());
    }
    let Some(path) = &args.headless_script else {
        page::open(&setup, args, options)?;
        return Ok(ended());
    };
    let steps = read_script(path)?;
    script_files(args, path, &steps).check()?;
    let json = args.render.report.json;
    let pool = setup.pool()?;
    pool.install(|| Headless::new(setup, options)?.run(&steps, json)).map(|()| ExitCode::SUCCESS)
}

/// Exit code of a view that has ended, perhaps by a signal.
fn ended() -> ExitCode {
    signals::received().map_or(ExitCode::SUCCESS, ExitCode::from)
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
    let failed = |message: String| Failure::View(format!("{}: {message}", path.display()));
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
