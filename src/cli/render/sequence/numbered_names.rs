//! Names of numbered images.

use std::path::{Path, PathBuf};

/// Returns a numbered name, as `a-007.png` for `a.png`. A placeholder in the name, `{}` or `%03d` as in C, is
/// replaced by the number. Numbers have at least `digits` digits, except for `%d` and `%0Nd`, which set the
/// number of digits.
pub(super) fn numbered(path: &Path, number: u64, digits: usize) -> PathBuf {
    let padded = format!("{number:0digits$}");
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    if let Some((before, after)) = name.split_once("{}") {
        return path.with_file_name(format!("{before}{padded}{after}"));
    }
    if let Some((before, digits, after)) = place(&name) {
        return path.with_file_name(format!("{before}{number:0digits$}{after}"));
    }
    let mut name = path.file_stem().unwrap_or_default().to_owned();
    name.push(format!("-{padded}"));
    if let Some(suffix) = path.extension() {
        name.push(".");
        name.push(suffix);
    }
    path.with_file_name(name)
}

/// Returns the text before and after `%d` or `%0Nd`, and its number of digits.
fn place(name: &str) -> Option<(&str, usize, &str)> {
    let (before, rest) = name.split_once('%')?;
    let (width, after) = rest.split_once('d')?;
    let digits = match width.strip_prefix('0') {
        Some(width) => width.parse().ok().filter(|width| (1..20).contains(width))?,
        None if width.is_empty() => 1,
        None => return None,
    };
    Some((before, digits, after))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_precede_the_suffix_or_replace_the_placeholder() {
        for (path, expected) in [
            ("a/b.c.png", "a/b.c-007.png"),
            ("a/b", "a/b-007"),
            ("a/b{}c.png", "a/b007c.png"),
            ("a/b%05d.png", "a/b00007.png"),
            ("a/%d.png", "a/7.png"),
            ("a/50%-dark.png", "a/50%-dark-007.png"),
            ("a/%099d.png", "a/%099d-007.png"),
            ("{}/b.png", "{}/b-007.png"),
        ] {
            assert_eq!(numbered(Path::new(path), 7, 3), Path::new(expected), "{path}");
        }
        assert_eq!(numbered(Path::new("a.png"), 12345, 3), Path::new("a-12345.png"));
    }
}
