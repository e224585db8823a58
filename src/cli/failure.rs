//! Errors of commands, and their printing: with an excerpt for scene files, in one line for all else.

use super::output;
use annotate_snippets::{AnnotationKind, Group, Level, Renderer, Snippet};
use clap::error::{ContextKind, ContextValue, ErrorKind};
use memchr::{memchr, memrchr};
use spherule_measure::bench::BenchError;
use spherule_render::checkpoint::{CheckpointError, LockError};
use spherule_render::graphics::PageError;
use spherule_render::image::{CompareError, ImageError};
use spherule_render::prepared::{PrepareError, PreparedError};
use spherule_render::render::RenderError;
use spherule_render::scene::generate::GenerateError;
use spherule_render::scene::{FileError, Place};
use spherule_render::split::MergeError;
use spherule_render::video::{self, VideoError};
use spherule_render::world::WorldError;
use std::fmt::Display;
use std::io;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Maximum number of bytes of an excerpt. A damaged file may be a single line.
const DRAWN: usize = 600;

/// Error of a command.
#[derive(Debug, thiserror::Error)]
pub(super) enum Failure {
    #[error("{0}")]
    Arguments(#[from] clap::Error),
    /// Options of a command that contradict each other or what they are for.
    #[error("{message}")]
    Usage { command: String, message: String },
    #[error("{}", .0.message)]
    Scene(Box<FileError>),
    #[error("{0}: {1}")]
    World(String, WorldError),
    #[error("{0}")]
    Render(#[from] RenderError),
    #[error("{0}")]
    Image(#[from] ImageError),
    #[error("{0}")]
    Compare(#[from] CompareError),
    #[error("--{} {}", .0.parameter, .0.message)]
    Generate(#[from] GenerateError),
    #[error("cannot start {0} threads: {1}; use a smaller number with --threads")]
    Threads(usize, rayon::ThreadPoolBuildError),
    #[error("{}: cannot be written: {}", .0.display(), .1)]
    Write(PathBuf, io::Error),
    /// With the exit code of the signal.
    #[error("{}: interrupted while waiting for a reader of the pipe; nothing is written", .0.display())]
    NoReader(PathBuf, u8),
    #[error("{}: {}", .0.display(), .1)]
    Video(PathBuf, String),
    #[error("frame {0}: {1}")]
    Frame(u64, Box<Self>),
    #[error("{0}")]
    Merge(#[from] MergeError),
    #[error("{0}: has other layers than {1}; render all parts with the same --layers")]
    Layers(String, String),
    #[error("{0}: its annotations cannot be read; remove the file, and render the part again")]
    UnreadAnnotations(String),
    #[error("{0}")]
    Checkpoint(#[from] CheckpointError),
    #[error("{0}")]
    Prepared(#[from] PreparedError),
    #[error("{0}: {1}")]
    Prepare(String, PrepareError),
    #[error("{0}")]
    Lock(#[from] LockError),
    #[error(
        "{}: already exists; resume it with --resume, delete it, or choose another name",
        .0.display()
    )]
    CheckpointExists(PathBuf),
    #[error("{}: cannot resume: {}", .0.display(), .1)]
    Resume(PathBuf, String),
    #[error("{0}")]
    Page(#[from] PageError),
    #[error("{0}")]
    Bench(BenchError),
    #[error("{0}")]
    Memory(String),
    #[error("{0}")]
    View(String),
    #[error(
        "this program was compiled for a processor with {0}, which this processor does not have; build it on \
         this machine (cargo build --release), or install the archive or package, whose programs suit every \
         processor"
    )]
    Processor(String),
}

impl From<FileError> for Failure {
    fn from(error: FileError) -> Self {
        Self::Scene(Box::new(error))
    }
}

impl From<BenchError> for Failure {
    fn from(error: BenchError) -> Self {
        match error {
            BenchError::Scene(error) => Self::Scene(error),
            other => Self::Bench(other),
        }
    }
}

impl Failure {
    /// Returns it in one line, for pages.
    pub(super) fn brief(&self) -> String {
        let text = match self {
            Self::Scene(error) => format!("{}: {}", error.path.display(), error.message),
            other => other.to_string(),
        };
        let line = text.lines().find(|line| !line.trim().is_empty()).unwrap_or_default();
        line.strip_prefix("error: ").unwrap_or(line).to_owned()
    }

    /// Creates an error for options that contradict each other.
    pub(super) fn usage(command: &str, message: impl Display) -> Self {
        Self::Usage { command: command.to_owned(), message: message.to_string() }
    }

    /// Creates the error of a video of so many images per second.
    pub(super) fn video(path: &Path, fps: Option<f64>, error: VideoError) -> Self {
        let message = match error {
            VideoError::Write(error) => return Self::Write(path.to_owned(), error),
            VideoError::Missing(_) => {
                let video = path.file_name().unwrap_or_default().to_string_lossy();
                let stem = path.file_stem().unwrap_or_default().to_string_lossy();
                let fps = fps.unwrap_or(video::FPS);
                format!(
                    "{error}, or write numbered images with -o {stem}-%04d.png and encode the video elsewhere:\n  \
                     ffmpeg -framerate {fps} -pattern_type glob -i '{stem}-*.png' -vf \
                     'pad=ceil(iw/2)*2:ceil(ih/2)*2' -pix_fmt yuv420p {video}"
                )
            }
            other => other.to_string(),
        };
        Self::Video(path.to_owned(), message)
    }

    /// Adds the number of a trajectory frame to the error.
    pub(super) fn of_frame(self, number: u64) -> Self {
        match self {
            Self::Scene(error) => {
                let message = format!("frame {number}: {}", error.message);
                Self::Scene(Box::new(FileError { message, ..*error }))
            }
            other => Self::Frame(number, Box::new(other)),
        }
    }

    /// Prints the error, for a usage error with that of `program`, and returns the exit code: 2 for an invalid command
    /// line, 1 for all else, 0 if the user asked for help or the version.
    pub(super) fn report(self, mut program: clap::Command) -> ExitCode {
        match self {
            Self::Arguments(asked) if !asked.use_stderr() => {
                output::write(format_args!("{}", asked.render().ansi()));
                return ExitCode::SUCCESS;
            }
            Self::Arguments(error) => {
                let error = with_better_tip(error);
                // There is nowhere to report that standard error is closed.
                let _ = error.print();
                return ExitCode::from(2);
            }
            Self::Usage { command, message } => {
                program.build();
                let command = program.find_subcommand_mut(&command).cloned().unwrap_or(program);
                let error = command.clone().error(ErrorKind::ValueValidation, message);
                return Self::Arguments(error).report(command);
            }
            Self::Frame(_, error)
                if matches!(
                    *error,
                    Self::Arguments(_) | Self::Usage { .. } | Self::NoReader(..)
                ) =>
            {
                return error.report(program);
            }
            Self::NoReader(_, code) => {
                output::error(self);
                return ExitCode::from(code);
            }
            Self::Scene(error) => report_scene(*error),
            other => output::error(other),
        }
        ExitCode::FAILURE
    }
}

/// Options of other programs, and those of this one that do the same.
const FOREIGN_OPTIONS: &[(&str, &[&str])] = &[
    ("--filter-by", &["--select"]),
    ("--rotate", &["--view", "--roll", "--turntable"]),
    ("--rotation", &["--view", "--roll", "--turntable"]),
    ("--fov", &["--zoom", "--projection"]),
    ("--dof", &["--aperture", "--focus"]),
    ("--light", &["--preset", "--lit-from"]),
    ("--lights", &["--preset", "--lit-from"]),
    ("--lighting", &["--preset", "--lit-from"]),
    ("--color", &["--color-by", "--type", "--style"]),
    ("--colour", &["--color-by", "--type", "--style"]),
    ("--scale", &["--zoom", "--radius-scale"]),
    ("--frames", &["--frame"]),
    ("--quality", &["--spp", "--until-error"]),
    ("--antialias", &["--spp"]),
    ("--representation", &["--model", "--style"]),
    ("--repr", &["--model", "--style"]),
    ("--supercell", &["--replicate"]),
    ("--unit-cell", &["--cell"]),
    ("--labels", &["--label"]),
    ("--transparent", &["--background transparent", "--opacity"]),
    ("--transparency", &["--opacity"]),
    ("--alpha", &["--opacity"]),
    ("--title", &["--label"]),
    ("--caption", &["--label"]),
    ("--text", &["--label"]),
    ("--font-size", &["--text-size"]),
    ("--fontsize", &["--text-size"]),
    ("--resolution", &["--size", "--dpi"]),
    ("--res", &["--size", "--dpi"]),
    ("--ppi", &["--dpi"]),
    ("--width", &["--size"]),
    ("--height", &["--size"]),
    ("--figsize", &["--size"]),
    ("--background-color", &["--background"]),
    ("--bgcolor", &["--background"]),
    ("--bg", &["--background"]),
    ("--colormap", &["--color-map"]),
    ("--cmap", &["--color-map"]),
    ("--colorbar", &["--color-bar"]),
    ("--colour-by", &["--color-by"]),
    ("--radius", &["--radii", "--radius-scale"]),
    ("--samples", &["--spp"]),
    ("--out", &["--output"]),
];

/// Models of other programs, and those of this one that are drawn alike.
const FOREIGN_MODELS: &[(&str, &str)] = &[
    ("vdw", "space-filling"),
    ("cpk", "ball-and-stick"),
    ("spacefill", "space-filling"),
    ("spheres", "space-filling"),
    ("sphere", "space-filling"),
    ("balls", "space-filling"),
    ("sticks", "licorice"),
    ("stick", "licorice"),
    ("tube", "licorice"),
    ("wireframe", "licorice"),
    ("lines", "licorice"),
];

/// Similarity of an unknown option to one that is suggested, 0 to 1, below which the suggestion misleads.
const LIKENESS: f64 = 0.7;

/// Replaces the option that is suggested instead of an unknown one, if another one is meant, or removes it.
fn with_better_tip(mut error: clap::Error) -> clap::Error {
    let text = |error: &clap::Error, kind| match error.get(kind) {
        Some(ContextValue::String(text)) => Some(text.clone()),
        _ => None,
    };
    let Some(unknown) = text(&error, ContextKind::InvalidArg) else { return error };
    if unknown.starts_with("--model ")
        && let Some(value) = text(&error, ContextKind::InvalidValue)
        && let Some((_, own)) =
            FOREIGN_MODELS.iter().find(|(other, _)| value.eq_ignore_ascii_case(other))
    {
        let own = ContextValue::String((*own).to_owned());
        error.insert(ContextKind::SuggestedValue, own);
        return error;
    }
    if error.kind() != ErrorKind::UnknownArgument {
        return error;
    }
    if !unknown.starts_with('-') {
        let tip = "one file is rendered, and each option takes one value; a value with blanks needs quotes";
        error.insert(ContextKind::Suggested, ContextValue::StyledStrs(vec![tip.into()]));
        return error;
    }
    let same = FOREIGN_OPTIONS.iter().find(|(other, _)| *other == unknown).map(|(_, own)| *own);
    if let Some(same) = same {
        error.remove(ContextKind::SuggestedArg);
        // It is that of the option that was suggested.
        error.remove(ContextKind::Usage);
        let same = same.iter().map(|&own| own.to_owned()).collect();
        error.insert(ContextKind::SuggestedArg, ContextValue::Strings(same));
        return error;
    }
    let tip = text(&error, ContextKind::SuggestedArg);
    let is_like = |tip: &String| strsim::normalized_damerau_levenshtein(&unknown, tip) >= LIKENESS;
    if tip.is_some_and(|tip| !is_like(&tip)) {
        error.remove(ContextKind::SuggestedArg);
        error.remove(ContextKind::Usage);
    }
    error
}

fn report_scene(mut error: FileError) {
    let Some(place) = error.place.take_if(|place| excerpt(place).len() <= DRAWN) else {
        return output::error(error);
    };
    let lines = excerpt(&place);
    let first_line = place.first_line + place.source_text[..lines.start].matches('\n').count();
    let span = place.span.start - lines.start..place.span.end - lines.start;
    let path = error.path.display().to_string();
    let snippet = Snippet::source(&place.source_text[lines])
        .line_start(first_line)
        .path(&path)
        .fold(false)
        .annotation(AnnotationKind::Primary.span(span));
    let mut report = vec![Level::ERROR.primary_title(&error.message).element(snippet)];
    if let Some(help) = &error.help {
        report.push(Group::with_title(Level::HELP.secondary_title(help)));
    }
    output::print_error_line(Renderer::styled().render(&report));
}

/// Returns the faulty lines of a text, with one above and one below.
fn excerpt(place: &Place) -> Range<usize> {
    let text = place.source_text.as_bytes();
    let above = |end: usize| memrchr(b'\n', &text[..end]);
    let below = |start: usize| memchr(b'\n', &text[start..]).map(|newline| start + newline);
    let start = above(place.span.start).and_then(above).map_or(0, |newline| newline + 1);
    let end = below(place.span.end).and_then(|newline| below(newline + 1));
    start..end.unwrap_or(text.len())
}
