//! Why a command failed, and how that is told: scene files with the faulty line drawn, all else in
//! a line.

use super::args::Args;
use super::output;
use super::render::Estimate;
use clap::CommandFactory;
use clap::error::ErrorKind;
use miette::{
    LabeledSpan, MietteError, MietteHandlerOpts, MietteSpanContents, SourceCode, SourceSpan,
    SpanContents,
};
use spherule::bench::BenchError;
use spherule::checkpoint::{CheckpointError, LockError};
use spherule::drawing::DrawingError;
use spherule::image::{CompareError, ImageError};
use spherule::memory::Shortage;
use spherule::prepared::{PrepareError, PreparedError};
use spherule::render::RenderError;
use spherule::scene::generate::GenerateError;
use spherule::scene::{FileError, Place};
use spherule::split::MergeError;
use spherule::world::WorldError;
use std::fmt;
use std::io;
use std::path::PathBuf;
use std::process::ExitCode;

/// Most bytes of a file that are drawn: a damaged one may be a single line.
const DRAWN: usize = 600;

/// Why a command failed.
#[derive(Debug, thiserror::Error)]
pub(crate) enum Failure {
    #[error("{0}")]
    Usage(clap::Error),
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
    #[error("cannot start {0} threads: {1}; give --threads a smaller number")]
    Threads(usize, rayon::ThreadPoolBuildError),
    #[error("{}: cannot be written: {}", .0.display(), .1)]
    Write(PathBuf, io::Error),
    /// With the exit code of the signal.
    #[error("{}: interrupted, and nobody reads the pipe: nothing is written to it", .0.display())]
    NoReader(PathBuf, u8),
    #[error("{}: {}", .0.display(), .1)]
    Film(PathBuf, String),
    #[error("frame {0}: {1}")]
    Frame(u64, Box<Self>),
    #[error("{0}")]
    Merge(#[from] MergeError),
    #[error("{0}: has other layers than {1}; render all parts with the same --layers")]
    Layers(String, String),
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
    Kept(PathBuf),
    #[error("{}: cannot resume: {}", .0.display(), .1)]
    Resume(PathBuf, String),
    #[error("{0}")]
    Drawing(#[from] DrawingError),
    #[error("{0}")]
    Bench(BenchError),
    #[error("{}", .0.message(.1))]
    Memory(Estimate, Shortage),
    #[error("{0}")]
    Window(String),
    #[error(
        "this program was compiled for a processor with {0}, which this one does not have; build \
         it on this machine: cargo build --release"
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
    /// A command line that only turns out to be wrong once it is read as a whole.
    pub(super) fn usage(command: &str, message: impl fmt::Display) -> Self {
        let mut program = Args::command();
        program.build();
        let command = program.find_subcommand_mut(command).cloned().unwrap_or(program);
        Self::Usage(command.clone().error(ErrorKind::ValueValidation, message))
    }

    /// The same, of a frame among many.
    pub(super) fn of_frame(self, number: u64) -> Self {
        match self {
            Self::Scene(error) => {
                let message = format!("frame {number}: {}", error.message);
                Self::Scene(Box::new(FileError { message, ..*error }))
            }
            other => Self::Frame(number, Box::new(other)),
        }
    }

    /// Tells the user, and returns the exit code: 2 for a wrong command line, 1 for all else, 0 if the
    /// user asked for help or the version.
    pub(crate) fn report(self) -> ExitCode {
        match self {
            Self::Usage(asked) if !asked.use_stderr() => {
                output::write(format_args!("{}", asked.render().ansi()));
                return ExitCode::SUCCESS;
            }
            Self::Usage(error) => {
                // Nobody is left to tell if standard error is closed.
                let _ = error.print();
                return ExitCode::from(2);
            }
            Self::Frame(_, error) if matches!(*error, Self::Usage(_) | Self::NoReader(..)) => {
                return error.report();
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

fn report_scene(mut error: FileError) {
    let Some(place) = error.place.take_if(|place| is_short(place)) else {
        return output::error(error);
    };
    // Long lines are left to the terminal, so that messages can be searched for. That the hook is
    // set already is the only way to fail.
    let _ = miette::set_hook(Box::new(|_| {
        Box::new(MietteHandlerOpts::new().terminal_links(false).wrap_lines(false).build())
    }));
    let report = miette::Report::new(Drawn { error, place: *place });
    output::tell_plain(format_args!("{report:?}"));
}

/// Whether the faulty lines, with one above and one below, help more than they hide.
fn is_short(place: &Place) -> bool {
    let drawn = place.source_text.as_str().read_span(&place.span.clone().into(), 1, 1);
    drawn.is_ok_and(|lines| lines.data().len() <= DRAWN)
}

/// A fault in a scene, for drawing.
#[derive(Debug)]
struct Drawn {
    error: FileError,
    place: Place,
}

impl fmt::Display for Drawn {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(&self.error.message)
    }
}

impl std::error::Error for Drawn {}

impl miette::Diagnostic for Drawn {
    fn help(&self) -> Option<Box<dyn fmt::Display + '_>> {
        self.error.help.as_ref().map(|help| Box::new(help) as Box<dyn fmt::Display>)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        let label = LabeledSpan::underline(self.place.span.clone());
        Some(Box::new(std::iter::once(label)))
    }

    fn source_code(&self) -> Option<&dyn SourceCode> {
        Some(self)
    }
}

impl SourceCode for Drawn {
    fn read_span<'a>(
        &'a self,
        span: &SourceSpan,
        lines_before: usize,
        lines_after: usize,
    ) -> Result<Box<dyn SpanContents<'a> + 'a>, MietteError> {
        let text = self.place.source_text.as_str();
        let contents = text.read_span(span, lines_before, lines_after)?;
        // The text may begin in the middle of its file.
        let line = contents.line() + self.place.first_line - 1;
        Ok(Box::new(MietteSpanContents::new_named(
            self.error.path.display().to_string(),
            contents.data(),
            *contents.span(),
            line,
            contents.column(),
            contents.line_count(),
        )))
    }
}
