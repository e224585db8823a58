//! `spherule --version --verbose`: the version, and the processor level of the program.

use super::output;
use super::processor;
use std::ffi::OsString;
use std::process::ExitCode;

/// Returns whether these arguments, the program's name first, ask for the version with details.
pub(super) fn is_asked_in_detail(line: &[OsString]) -> bool {
    let is = |place: usize, words: [&str; 2]| {
        line.get(place).and_then(|word| word.to_str()).is_some_and(|word| words.contains(&word))
    };
    let (version, verbose) = (["-V", "--version"], ["-v", "--verbose"]);
    match line.len() {
        2 => is(1, ["-Vv", "-vV"]),
        3 => is(1, version) && is(2, verbose) || is(1, verbose) && is(2, version),
        _ => false,
    }
}

/// Prints the version, the level and why it is this one, and the path of the program.
pub(super) fn print_in_detail() -> ExitCode {
    output::print(format_args!("spherule {}", env!("CARGO_PKG_VERSION")));
    output::print(format_args!("level: {}", processor::level()));
    if let Ok(program) = std::env::current_exe() {
        output::print(format_args!("program: {}", program.display()));
    }
    ExitCode::SUCCESS
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn details_are_asked_for_by_two_options() {
        let asked = |words: &[&str]| {
            let line = std::iter::once(&"spherule").chain(words).map(OsString::from);
            is_asked_in_detail(&line.collect::<Vec<_>>())
        };
        for words in
            [&["--version", "--verbose"][..], &["-v", "-V"], &["-V", "--verbose"], &["-Vv"]]
        {
            assert!(asked(words), "{words:?}");
        }
        for words in [&["--version"][..], &["-v"], &[], &["-V", "-V"], &["-V", "-v", "scene.toml"]]
        {
            assert!(!asked(words), "{words:?}");
        }
    }
}
