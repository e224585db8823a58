//! The arguments of the process, with the default command `render` inserted.

use super::failure::Failure;
use clap::Command;
use spherule_render::compose::{Axes, Bar};
use spherule_render::scene::Anchor;
use spherule_render::suggest;
use std::env;
use std::ffi::{OsStr, OsString};
use std::fs;
use std::io::ErrorKind;
use std::path::Path;

/// The default command.
const USUAL: &str = "render";

/// Options of the program, not of a command.
const OWN: [&str; 4] = ["-h", "--help", "-V", "--version"];

/// The command that `clap` adds.
const HELP: &str = "help";

/// Minimum similarity of a word to a suggestion, 0..=1.
const LIKENESS: f64 = 0.6;

/// Maximum number of files of a folder that are compared with an unknown name.
const COMPARED: usize = 10_000;

/// Returns the arguments of this process, its own name first; `program` is the definition of the program. A file or an
/// option of `render` that comes first means `render`; the name of a command is never a file.
pub(super) fn command_line(program: &Command) -> Result<Vec<OsString>, Failure> {
    complete(program, env::args_os().collect())
}

fn complete(program: &Command, mut line: Vec<OsString>) -> Result<Vec<OsString>, Failure> {
    join_positions(&mut line);
    let Some(first) = line.get(1) else { return Ok(line) };
    let is_command = |word: &str| word == HELP || program.find_subcommand(word).is_some();
    let is_known = |word: &str| OWN.contains(&word) || is_command(word);
    if first.to_str().is_some_and(is_known) {
        return Ok(line);
    }
    if !first.as_encoded_bytes().starts_with(b"-") && !exists(Path::new(first)) {
        return Err(Failure::usage("", unknown(first, &commands(program))));
    }
    line.insert(1, USUAL.into());
    Ok(line)
}

/// Returns whether a text is a value of an option.
type IsValue = fn(&str) -> bool;

/// Options whose value may be left out, so that `clap` reads one only after `=`.
const PLACED: [(&str, IsValue); 3] = [
    ("--legend", |text| Anchor::named(text).is_some()),
    ("--axes", |text| text.parse::<Axes>().is_ok()),
    ("--scale-bar", |text| text.parse::<Bar>().is_ok()),
];

/// Joins such an option and the value after it by `=`, unless a file has that name. A word that is nearly a position is
/// no file, either: `clap` refuses it with the positions that there are.
fn join_positions(line: &mut Vec<OsString>) {
    let mut at = 1;
    while at + 1 < line.len() && line[at] != "--" {
        let option = PLACED.iter().find(|(option, _)| line[at] == *option);
        let text = line[at + 1].to_str().unwrap_or_default();
        let position = text.rsplit(':').next().unwrap_or_default();
        let is_near = || suggest::nearest(position, Anchor::ALL.map(|(name, _)| name)).is_some();
        if option.is_some_and(|(_, is_value)| is_value(text) || is_near())
            && !Path::new(text).exists()
        {
            let position = line.remove(at + 1);
            line[at].push("=");
            line[at].push(position);
        }
        at += 1;
    }
}

/// Names of all commands.
fn commands(program: &Command) -> Vec<String> {
    let mut program = program.clone();
    program.build();
    let commands = program.get_subcommands().filter(|command| !command.is_hide_set());
    commands.flat_map(|command| command.get_name_and_visible_aliases()).map(str::to_owned).collect()
}

/// Returns whether a file exists, or cannot be accessed to find out.
fn exists(path: &Path) -> bool {
    fs::symlink_metadata(path).map_or_else(|error| error.kind() != ErrorKind::NotFound, |_| true)
}

fn unknown(word: &OsStr, commands: &[String]) -> String {
    let text = word.to_string_lossy();
    let path = Path::new(word);
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
    let entries = fs::read_dir(folder.unwrap_or(Path::new("."))).into_iter().flatten();
    let names = entries.take(COMPARED).flatten().map(|entry| entry.file_name());
    let files = names.map(|name| path.with_file_name(name).to_string_lossy().into_owned());
    let likeness = |name: &String| strsim::normalized_damerau_levenshtein(&text, name);
    let all = commands.iter().cloned().chain(files).map(|name| (likeness(&name), name));
    let best = all.filter(|(likeness, _)| *likeness >= LIKENESS);
    let best = best.max_by(|a, b| a.0.total_cmp(&b.0).then_with(|| b.1.cmp(&a.1)));
    let hint = best.map(|(_, name)| format!("; did you mean `{name}`?")).unwrap_or_default();
    format!("`{text}` is neither a command nor a file{hint}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::args::Args;
    use clap::CommandFactory;

    fn completed(words: &[&str]) -> Result<Vec<OsString>, String> {
        let line = std::iter::once(&"spherule").chain(words).map(Into::into).collect();
        complete(&Args::command(), line).map_err(|failure| failure.to_string())
    }

    #[test]
    fn files_and_options_are_rendered() {
        for words in
            [&["Cargo.toml", "--spp", "4"][..], &["--spp", "4"], &["-"], &["--", "a"], &["."]]
        {
            let line = completed(words).expect("a line that is understood");
            assert_eq!(line[1], "render", "{words:?}");
            assert_eq!(line[2..], *words, "{words:?}");
        }
        for words in [&[][..], &["info", "a"], &["render"], &["help"], &["--help"], &["-V"]] {
            assert_eq!(completed(words).expect("a line").len(), words.len() + 1, "{words:?}");
        }
    }

    #[test]
    fn positions_of_annotations_need_no_equals_sign() {
        let joined = |words: &[&str]| completed(words).expect("a line")[2..].to_vec();
        assert_eq!(joined(&["-", "--legend", "top-left"]), ["-", "--legend=top-left"]);
        assert_eq!(joined(&["--axes", "cell:top", "-"]), ["--axes=cell:top", "-"]);
        assert_eq!(joined(&["--axes", "cell", "-"]), ["--axes=cell", "-"]);
        assert_eq!(joined(&["--scale-bar", "2.5"]), ["--scale-bar=2.5"]);
        assert_eq!(joined(&["--legend", "topleft"]), ["--legend=topleft"]);
        assert_eq!(joined(&["--legend", "missing.xyz"]), ["--legend", "missing.xyz"]);
        assert_eq!(joined(&["--legend", "-"]), ["--legend", "-"]);
        assert_eq!(joined(&["--scale-bar", "10:right"]), ["--scale-bar=10:right"]);
        assert_eq!(joined(&["--legend", "Cargo.toml"]), ["--legend", "Cargo.toml"]);
        assert_eq!(joined(&["--", "--legend", "top"]), ["--", "--legend", "top"]);
    }

    #[test]
    fn unknown_words_get_a_suggestion() {
        for (word, like) in
            [("rendr", "`render`"), ("Cargo.tmol", "`Cargo.toml`"), ("src/lib.r", "`src/lib.rs`")]
        {
            let message = completed(&[word]).expect_err("no such thing");
            assert!(message.contains(word) && message.contains(like), "{message}");
        }
        assert!(!completed(&["quxquxqux"]).expect_err("no such thing").contains("mean"));
    }
}
