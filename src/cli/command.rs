//! A command as it was typed, option by option: to be kept, and given again with other options.

use super::args::Args;
use super::command_line::command_line;
use clap::parser::ValueSource;
use clap::{Arg, ArgMatches, Command, CommandFactory};
use std::env;
use std::ffi::{OsStr, OsString};
use std::path::{Path, PathBuf};

/// What is said of the moment, not of the picture: it is not kept.
const MOMENTARY: [&str; 7] =
    ["checkpoint", "resume", "memory_limit", "quiet", "verbose", "stats", "json"];

/// Options that are the paths of files.
const PATHS: [&str; 3] = ["scene", "output", "color_bar"];

/// What is kept though nobody typed it: where the picture goes.
const USUAL: &str = "output";

/// The command that renders.
pub(super) fn render_command() -> Command {
    let mut program = Args::command();
    program.build();
    program.find_subcommand("render").cloned().unwrap_or(program)
}

/// Options and their values; those without are switches.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct TypedOptions(Vec<(String, Vec<OsString>)>);

/// A command, and the folder in which it was typed.
pub(super) struct Given {
    pub(super) folder: PathBuf,
    pub(super) typed: TypedOptions,
}

impl Given {
    /// The command of this process.
    pub(super) fn of_process() -> Self {
        Self { folder: env::current_dir().unwrap_or_default(), typed: TypedOptions::of_process() }
    }
}

impl TypedOptions {
    /// What was typed of the command that renders, if this process was called with it.
    fn of_process() -> Self {
        let line = command_line().unwrap_or_default();
        let matches = Args::command().try_get_matches_from(line);
        let matches = matches.ok().and_then(|mut all| all.remove_subcommand());
        matches.map_or(Self(Vec::new()), |(_, matches)| Self::of(&render_command(), &matches))
    }

    /// What was typed of a command.
    pub(super) fn of(command: &Command, matches: &ArgMatches) -> Self {
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

    /// What is worth keeping, with `output` as the place of the picture if none was typed.
    pub(super) fn lasting(mut self, output: &Path) -> Self {
        self.0.retain(|(id, _)| !MOMENTARY.contains(&id.as_str()));
        if self.0.iter().all(|(id, _)| id != USUAL) {
            self.0.push((USUAL.to_owned(), vec![output.into()]));
        }
        self
    }

    /// The same from another folder than that in which it was typed.
    pub(super) fn typed_in(mut self, folder: &Path) -> Self {
        let paths = self.0.iter_mut().filter(|(id, _)| PATHS.contains(&id.as_str()));
        for value in paths.flat_map(|(_, values)| values) {
            // A line is what standard input is called, and a bar may be in the picture.
            let text = value.to_str().unwrap_or_default();
            if text != "-" && text != "inside" && !text.starts_with("inside:") {
                *value = folder.join(&*value).into();
            }
        }
        self
    }

    /// This, but with a value of an option.
    pub(super) fn set(&mut self, id: &str, value: impl Into<OsString>) {
        self.0.retain(|(other, _)| other != id);
        self.0.push((id.to_owned(), vec![value.into()]));
    }

    /// This, but for what was typed later.
    pub(super) fn with(mut self, later: Self) -> Self {
        let again = |id: &String| later.0.iter().any(|(other, _)| other == id);
        self.0.retain(|(id, _)| !again(id));
        self.0.extend(later.0);
        self
    }

    /// As arguments of the command.
    pub(super) fn arguments(&self, command: &Command) -> Vec<OsString> {
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

    fn typed(arguments: &[&str]) -> TypedOptions {
        TypedOptions::of(&render_command(), &matches(arguments))
    }

    fn matches(arguments: &[impl Into<OsString> + Clone]) -> ArgMatches {
        let mut line = vec![OsString::from("render")];
        line.extend(arguments.iter().cloned().map(Into::into));
        render_command().try_get_matches_from(line).expect("a line that is understood")
    }

    #[test]
    fn what_was_typed_can_be_typed_again() {
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
            let second = TypedOptions::of(&render_command(), &matches(&again));
            assert_eq!(first, second, "{again:?}");
        }
        assert_eq!(typed(&["--cell", "x"]).arguments(&render_command()).len(), 3);
    }

    #[test]
    fn what_comes_later_counts() {
        let first = typed(&["a.toml", "--spp", "5", "--seed", "3", "--type", "A:radius=1"]);
        let later = typed(&["--spp", "9", "--type", "B:radius=2", "--cell"]);
        let both =
            typed(&["a.toml", "--seed", "3", "--spp", "9", "--type", "B:radius=2", "--cell"]);
        let sorted = |typed: TypedOptions| {
            let mut arguments = typed.arguments(&render_command());
            arguments.sort();
            arguments
        };
        assert_eq!(sorted(first.with(later)), sorted(both));
    }

    #[test]
    fn paths_are_those_of_the_folder() {
        let line = typed(&["-", "--quiet", "--checkpoint", "c", "--spp", "2"]);
        let kept = line.lasting(Path::new("a.png")).typed_in(Path::new("/somewhere"));
        let expected = ["--spp=2", "--output=/somewhere/a.png", "--", "-"];
        assert_eq!(kept.arguments(&render_command()), expected);
        let kept = typed(&["a/b.toml"]).typed_in(Path::new("/c"));
        assert_eq!(kept.arguments(&render_command()), ["--", "/c/a/b.toml"]);
    }
}
