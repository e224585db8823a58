//! The options of a command line, stored in checkpoints and combined with later ones by `--resume`.

use crate::cli::command_line::command_line;
use crate::cli::options::appearance::BarPlace;
use clap::parser::ValueSource;
use clap::{Arg, ArgMatches, Command};
use std::env;
use std::ffi::{OsStr, OsString};
use std::path::{Path, PathBuf};

/// Options of a single run, which are not stored.
const NOT_STORED: [&str; 7] =
    ["checkpoint", "resume", "memory_limit", "quiet", "verbose", "stats", "json"];

/// Options whose values are paths.
const PATHS: [&str; 3] = ["scene", "output", "color_bar"];

/// The option that is always stored: the output file.
const ALWAYS_STORED: &str = "output";

/// Returns the definition of `spherule render`.
fn render_command(program: &Command) -> Command {
    let mut program = program.clone();
    program.build();
    program.find_subcommand("render").cloned().unwrap_or(program)
}

/// Options with their values; flags have none.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(in crate::cli) struct CommandOptions(Vec<(String, Vec<OsString>)>);

/// A command line of `spherule render`, and the folder in which it was run.
#[derive(Default)]
pub(in crate::cli) struct Invocation {
    /// The definition of the command.
    pub(in crate::cli) command: Command,
    pub(in crate::cli) folder: PathBuf,
    pub(in crate::cli) typed: CommandOptions,
}

impl Invocation {
    /// The command line of this process, which is one of `program`.
    pub(in crate::cli) fn of_process(program: &Command) -> Self {
        let command = render_command(program);
        let folder = env::current_dir().unwrap_or_default();
        let line = command_line(program).unwrap_or_default();
        let matches = program.clone().try_get_matches_from(line).ok();
        let matches = matches.and_then(|mut all| all.remove_subcommand());
        let typed = matches.map(|(_, matches)| CommandOptions::of(&command, &matches));
        Self { command, folder, typed: typed.unwrap_or_default() }
    }
}

impl CommandOptions {
    /// Returns the options that are on the command line of a command.
    pub(in crate::cli) fn of(command: &Command, matches: &ArgMatches) -> Self {
        let typed = |arg: &&Arg| {
            let id = arg.get_id().as_str();
            let source = matches.try_contains_id(id).is_ok().then(|| matches.value_source(id));
            source.flatten() == Some(ValueSource::CommandLine)
        };
        let values = |arg: &Arg| -> Vec<OsString> {
            let raw = matches.get_raw(arg.get_id().as_str()).filter(|_| has_values(arg));
            raw.into_iter().flatten().map(OsStr::to_owned).collect()
        };
        let options = command.get_arguments().filter(typed);
        Self(options.map(|arg| (arg.get_id().to_string(), values(arg))).collect())
    }

    /// Returns the options to store, with `output` as the output file if none was given.
    pub(in crate::cli) fn stored(mut self, output: &Path) -> Self {
        self.0.retain(|(id, _)| !NOT_STORED.contains(&id.as_str()));
        if self.0.iter().all(|(id, _)| id != ALWAYS_STORED) {
            self.0.push((ALWAYS_STORED.to_owned(), vec![output.into()]));
        }
        self
    }

    /// Makes paths absolute, relative to `folder`.
    pub(in crate::cli) fn relative_to(mut self, folder: &Path) -> Self {
        let paths = self.0.iter_mut().filter(|(id, _)| PATHS.contains(&id.as_str()));
        for value in paths.flat_map(|(_, values)| values) {
            // `-` is standard input, and a color bar may be inside the image.
            let text = value.to_str().unwrap_or_default();
            if text != "-" && !BarPlace::is_inside(text) {
                *value = folder.join(&*value).into();
            }
        }
        self
    }

    /// Sets the value of an option.
    pub(in crate::cli) fn set(&mut self, id: &str, value: impl Into<OsString>) {
        self.0.retain(|(other, _)| other != id);
        self.0.push((id.to_owned(), vec![value.into()]));
    }

    /// Combines the options with later ones, which override them.
    pub(in crate::cli) fn with(mut self, later: Self) -> Self {
        let again = |id: &String| later.0.iter().any(|(other, _)| other == id);
        self.0.retain(|(id, _)| !again(id));
        self.0.extend(later.0);
        self
    }

    /// Formats the options as arguments of the command.
    pub(in crate::cli) fn arguments(&self, command: &Command) -> Vec<OsString> {
        let (mut options, mut places) = (Vec::new(), Vec::new());
        for (id, values) in &self.0 {
            let arg = command.get_arguments().find(|arg| arg.get_id() == id.as_str());
            match arg.and_then(Arg::get_long) {
                Some(name) if values.is_empty() => options.push(format!("--{name}").into()),
                Some(name) => options.extend(values.iter().map(|value| option(name, value))),
                None => places.extend(values.iter().cloned()),
            }
        }
        if !places.is_empty() {
            options.push("--".into());
            options.extend(places);
        }
        options
    }
}

fn has_values(arg: &Arg) -> bool {
    arg.get_action().takes_values()
}

/// `--name=value`.
fn option(name: &str, value: &OsStr) -> OsString {
    let mut option = OsString::from(format!("--{name}="));
    option.push(value);
    option
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::args::Args;
    use clap::CommandFactory;

    fn render_command() -> Command {
        super::render_command(&Args::command())
    }

    fn typed(arguments: &[&str]) -> CommandOptions {
        CommandOptions::of(&render_command(), &matches(arguments))
    }

    fn matches(arguments: &[impl Into<OsString> + Clone]) -> ArgMatches {
        let mut line = vec![OsString::from("render")];
        line.extend(arguments.iter().cloned().map(Into::into));
        render_command().try_get_matches_from(line).expect("a line that is understood")
    }

    #[test]
    fn arguments_are_reproduced() {
        let lines: [&[&str]; 4] = [
            &[],
            &["a.toml", "--size", "40x24", "--cell", "-o", "b.exr", "--layers", "id,normal"],
            &[
                "--select=not z > -1",
                "--view",
                "-z",
                "--type",
                "A:radius=1",
                "--type",
                "B:color=#ffffff",
            ],
            &["--checkpoint-every", "5s", "--", "-strange.xyz"],
        ];
        for line in lines {
            let first = typed(line);
            let again = first.arguments(&render_command());
            let second = CommandOptions::of(&render_command(), &matches(&again));
            assert_eq!(first, second, "{again:?}");
        }
        assert_eq!(typed(&["--cell", "x"]).arguments(&render_command()).len(), 3);
    }

    #[test]
    fn later_options_replace_earlier_ones() {
        let first = typed(&["a.toml", "--spp", "5", "--seed", "3", "--type", "A:radius=1"]);
        let later = typed(&["--spp", "9", "--type", "B:radius=2", "--cell"]);
        let both =
            typed(&["a.toml", "--seed", "3", "--spp", "9", "--type", "B:radius=2", "--cell"]);
        let sorted = |typed: CommandOptions| {
            let mut arguments = typed.arguments(&render_command());
            arguments.sort();
            arguments
        };
        assert_eq!(sorted(first.with(later)), sorted(both));
    }

    #[test]
    fn relative_paths_follow_the_folder() {
        let line = typed(&["-", "--quiet", "--checkpoint", "c", "--spp", "2"]);
        let kept = line.stored(Path::new("a.png")).relative_to(Path::new("/somewhere"));
        let expected = ["--spp=2", "--output=/somewhere/a.png", "--", "-"];
        assert_eq!(kept.arguments(&render_command()), expected);
        let kept = typed(&["a/b.toml"]).relative_to(Path::new("/c"));
        assert_eq!(kept.arguments(&render_command()), ["--", "/c/a/b.toml"]);
    }
}
