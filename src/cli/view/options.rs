//! Options of the view: those of the command line, and what commands set since.

use super::args::{ViewerArgs, hide_refused};
use crate::cli::command_line::command_line;
use crate::cli::failure::Failure;
use crate::cli::help;
use clap::parser::ValueSource;
use clap::{Arg, ArgMatches, Command, CommandFactory, FromArgMatches};
use spherule_render::scene::Anchor;
use spherule_render::suggest;
use std::borrow::Cow;
use std::ffi::{OsStr, OsString};
use std::path::PathBuf;

/// The command, and the name of its argument for the file.
const COMMAND: &str = "view";
const FILE: &str = "scene";

/// Options that a page or a script has other means for, or that apply to files.
const FIXED: [&str; 8] =
    ["frame", "size", "dpi", "output_format", "bits", "quality", "ppm", "turntable"];

/// Options of the page, which say nothing of the image.
const OF_PAGE: [&str; 5] = ["headless_script", "address", "port", "no_browser", "pipe"];

/// A file and options, as on the command line.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Options {
    /// The scene or particle file; `None` for the random field.
    pub(super) file: Option<OsString>,
    /// The name that is told in its place, if a page sent it.
    told: Option<OsString>,
    /// Names without dashes, and values, in their order; `None` for a flag and for an option without its value.
    list: Vec<(String, Option<OsString>)>,
}

impl Options {
    /// Returns the options of this process.
    ///
    /// # Errors
    /// Those of parsing its command line.
    pub(super) fn of_process(program: &Command) -> Result<Self, Failure> {
        let matches = program.clone().try_get_matches_from(command_line(program)?)?;
        let command = program.find_subcommand(COMMAND);
        match (matches.subcommand(), command) {
            (Some((COMMAND, matches)), Some(command)) => Ok(Self::of(matches, command)),
            _ => Ok(Self::default()),
        }
    }

    /// Returns the options of a command line.
    pub(super) fn of(matches: &ArgMatches, command: &Command) -> Self {
        let mut options = Self::default();
        for arg in command.get_arguments() {
            let id = arg.get_id().as_str();
            if OF_PAGE.contains(&id) || matches.value_source(id) != Some(ValueSource::CommandLine) {
                continue;
            }
            let values = || matches.get_raw(id).into_iter().flatten().map(OsStr::to_owned);
            if id == FILE {
                options.file = values().next();
                continue;
            }
            let Some(name) = arg.get_long() else { continue };
            if takes_values(arg) && values().next().is_some() {
                options.list.extend(values().map(|value| (name.to_owned(), Some(value))));
            } else {
                options.list.push((name.to_owned(), None));
            }
        }
        options
    }

    /// Returns the options of words as after `spherule view`.
    #[cfg(test)]
    pub(super) fn parse(words: &[&str]) -> Self {
        let command = command();
        let line = std::iter::once(&COMMAND).chain(words);
        let matches = command.clone().try_get_matches_from(line).expect("options");
        Self::of(&matches, &command)
    }

    /// Sets an option to these values, once each; a flag has the value `None`. Without values it is as if it had not been
    /// given.
    ///
    /// # Errors
    /// There is no such option, or a view cannot change it; the options stay what they were.
    pub(super) fn set(
        &mut self,
        name: &str,
        values: impl IntoIterator<Item = Option<OsString>>,
    ) -> Result<(), Failure> {
        let name = name.trim_start_matches('-');
        check(name)?;
        let mut new = self.clone();
        new.list.retain(|(own, _)| own != name);
        for value in values {
            check_value(name, value.as_deref())?;
            new.list.push((name.to_owned(), value));
        }
        new.args()?;
        *self = new;
        Ok(())
    }

    /// Gives an option a value, whatever it is.
    pub(super) fn put(&mut self, name: &str, value: impl Into<OsString>) {
        self.list.retain(|(own, _)| own != name);
        self.list.push((name.to_owned(), Some(value.into())));
    }

    /// Returns the last value of an option.
    pub(super) fn last(&self, name: &str) -> Option<String> {
        let value = self.iter().filter(|(own, _)| *own == name).last()?.1?;
        Some(value.to_string_lossy().into_owned())
    }

    /// Returns the values of an option.
    pub(super) fn all(&self, name: &str) -> Vec<Option<OsString>> {
        let own = self.iter().filter(|(own, _)| *own == name);
        own.map(|(_, value)| value.map(OsStr::to_owned)).collect()
    }

    /// Names and values of all options.
    pub(super) fn iter(&self) -> impl Iterator<Item = (&str, Option<&OsStr>)> {
        self.list.iter().map(|(name, value)| (name.as_str(), value.as_deref()))
    }

    /// Returns the options of these names alone.
    pub(super) fn restricted(&self, is_wanted: impl Fn(&str) -> bool) -> Self {
        let list = self.list.iter().filter(|(name, _)| is_wanted(name)).cloned().collect();
        Self { list, ..self.clone() }
    }

    /// Returns the same options of a file that a page sent.
    pub(super) fn of_sent(&self, path: PathBuf) -> Self {
        let told = path.file_name().map(OsStr::to_owned);
        Self { file: Some(path.into()), told, list: self.list.clone() }
    }

    /// Returns the name of the file as it is told.
    pub(super) fn name(&self) -> Option<&OsStr> {
        self.told.as_deref().or(self.file.as_deref())
    }

    /// Words of the options, with the file first.
    pub(super) fn words(&self) -> Vec<OsString> {
        let option = |(name, value): &(String, Option<OsString>)| {
            let mut word = OsString::from(format!("--{name}"));
            if let Some(value) = value {
                word.push("=");
                word.push(value);
            }
            word
        };
        self.file.iter().cloned().chain(self.list.iter().map(option)).collect()
    }

    /// Parses the options.
    ///
    /// # Errors
    /// Options contradict each other, or values cannot be understood.
    pub(super) fn args(&self) -> Result<ViewerArgs, Failure> {
        let line = std::iter::once(COMMAND.into()).chain(self.words());
        let matches = command().try_get_matches_from(line)?;
        Ok(ViewerArgs::from_arg_matches(&matches)?)
    }

    /// Returns the command that renders with these options, as one types it.
    pub(super) fn command_line(&self) -> String {
        let own = Self { file: self.name().map(OsStr::to_owned), ..self.clone() };
        let words = own.words().into_iter().map(|word| quoted(&word.to_string_lossy()));
        ["spherule".to_owned(), "render".to_owned()]
            .into_iter()
            .chain(words)
            .collect::<Vec<_>>()
            .join(" ")
    }
}

/// Returns a word as one types it; of an option only its value is quoted, where it must be.
fn quoted(word: &str) -> String {
    let quote = |text: &str| shlex::try_quote(text).map_or(text.to_owned(), Cow::into_owned);
    match word.split_once('=') {
        Some((name, value)) if name.starts_with("--") => format!("{name}={}", quote(value)),
        _ => quote(word),
    }
}

/// Returns the definition of the command.
pub(super) fn command() -> Command {
    ViewerArgs::command().allow_negative_numbers(true).mut_args(hide_refused)
}

/// Returns whether an option has values.
fn takes_values(arg: &Arg) -> bool {
    arg.get_action().takes_values()
}

/// Options that commands can set, by topics of the help. None of them names a file.
pub(super) fn topics(command: &Command) -> Vec<(&'static str, Vec<&Arg>)> {
    let path = clap::builder::ValueParser::path_buf().type_id();
    let can_set = |arg: &&Arg| {
        !FIXED.contains(&arg.get_id().as_str())
            && !arg.is_hide_set()
            && arg.get_long().is_some()
            && arg.get_value_parser().type_id() != path
    };
    let args = |names: &&[&str]| {
        let named = |name: &&str| command.get_arguments().find(|arg| arg.get_id() == *name);
        names.iter().filter_map(named).filter(can_set).collect()
    };
    let topics = help::topics().iter().filter(|(topic, _)| !["films", "machine"].contains(topic));
    topics.map(|(topic, names)| (*topic, args(names))).collect()
}

/// Refuses the name of an option that a view cannot change.
fn check(name: &str) -> Result<(), Failure> {
    let command = command();
    let topics = topics(&command);
    let names = || topics.iter().flat_map(|(_, args)| args).filter_map(|arg| arg.get_long());
    if names().any(|own| own == name) {
        return Ok(());
    }
    let near = suggest::question(name, names());
    Err(Failure::usage(COMMAND, format!("`{name}` is no option that can be set here{near}")))
}

/// Refuses a value that names a file.
fn check_value(name: &str, value: Option<&OsStr>) -> Result<(), Failure> {
    let anchor = |value: &OsStr| value.to_str().is_some_and(|text| Anchor::named(text).is_some());
    if name == "color-bar" && !value.is_some_and(anchor) {
        let message = "--color-bar takes a position here, as in right";
        return Err(Failure::usage(COMMAND, message));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_are_set_and_unset() {
        let mut options =
            Options::parse(&["run.xyz", "--color-by", "q", "--style", "H: color=red", "--cell"]);
        assert_eq!(options.words().len(), 4);
        options.set("color-by", [Some("vx / 2".into())]).unwrap();
        options
            .set("style", [Some("H: color=blue".into()), Some("O: opacity=0.5".into())])
            .unwrap();
        options.set("cell", []).unwrap();
        options.set("legend", [None]).unwrap();
        options.put("output", "a b.png");
        options.put("size", "64x48");
        let line = options.command_line();
        assert!(line.ends_with(" --output='a b.png' --size=64x48"), "{line}");
        let words = shlex::split(&line).unwrap();
        let expected = [
            "spherule",
            "render",
            "run.xyz",
            "--color-by=vx / 2",
            "--style=H: color=blue",
            "--style=O: opacity=0.5",
            "--legend",
            "--output=a b.png",
            "--size=64x48",
        ];
        assert_eq!(words, expected);
    }

    #[test]
    fn options_that_name_files_or_do_not_exist_are_refused() {
        let mut options = Options::parse(&["run.xyz"]);
        let before = options.clone();
        for (name, text) in [
            ("output", "a.png"),
            ("camera", "/etc/passwd"),
            ("topology", "/etc/passwd"),
            ("color-bar", "bar.svg"),
            ("checkpoint", "a"),
            ("memory-limit", "1"),
            ("model", "cubes"),
            ("colour-by", "q"),
        ] {
            assert!(options.set(name, [Some(text.into())]).is_err(), "{name}");
        }
        assert_eq!(options, before);
        assert!(options.set("color-bar", [Some("right".into())]).is_ok());
    }
}
