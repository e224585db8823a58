//! What kind of file this is, told from how it begins.

use super::Format;
use crate::scene::SceneError;
use std::io::BufRead;
use std::path::Path;

/// How many bytes of a file are looked at.
pub(super) const HEAD: usize = 1 << 16;

/// How compressed files begin.
const COMPRESSED: [(&[u8], &str); 4] = [
    (&[0x1F, 0x8B], "gzip"),
    (b"BZh", "bzip2"),
    (&[0x28, 0xB5, 0x2F, 0xFD], "zstd"),
    (&[0xFD, b'7', b'z', b'X', b'Z'], "xz"),
];

/// The format that was asked for, or else the one the file seems to have. Nothing is consumed.
pub(super) fn format(
    path: &Path,
    reader: &mut impl BufRead,
    asked: Option<Format>,
) -> Result<Format, SceneError> {
    let fault = |message: String| SceneError::whole_file(path, message);
    let head = reader.fill_buf().map_err(|error| fault(format!("cannot be read: {error}")))?;
    if let Some((_, name)) = COMPRESSED.iter().find(|(magic, _)| head.starts_with(magic)) {
        return Err(fault(format!("is compressed ({name})")).with_help("unpack the file first"));
    }
    if head.contains(&0) {
        let error = fault("is not a text file: it holds zero bytes".to_owned());
        return Err(error.with_help(KNOWN));
    }
    match asked {
        Some(format) => Ok(format),
        None => {
            told(&String::from_utf8_lossy(head)).map_err(|message| fault(message).with_help(KNOWN))
        }
    }
}

const KNOWN: &str = "files of particles are rows of `x y z [radius]`, CSV with a header that \
                     names x, y and z, or XYZ";

fn told(head: &str) -> Result<Format, String> {
    let lines = head.trim_start_matches('\u{FEFF}').lines().map(str::trim);
    let mut lines = lines.filter(|line| !line.is_empty() && !line.starts_with('#'));
    let Some(first) = lines.next() else { return Err("holds no particles".to_owned()) };
    if first.parse::<u64>().is_ok() {
        return Ok(Format::Xyz);
    }
    let fields = first.split(|letter: char| letter.is_whitespace() || ",;#".contains(letter));
    let mut fields = fields.map(|field| field.trim_matches('"')).filter(|field| !field.is_empty());
    // Two, because a title may begin with a number.
    if fields.clone().take(2).all(|field| field.parse::<f64>().is_ok()) {
        return Ok(Format::Xyzr);
    }
    if fields.any(|field| field.eq_ignore_ascii_case("x")) {
        return Ok(Format::Csv);
    }
    let shown: String = first.chars().take(40).collect();
    Err(format!("is in no format known here: it begins with `{}`", shown.escape_debug()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn content_tells_the_format() {
        assert_eq!(told("60\nfullerene\nC 0 0 0\n"), Ok(Format::Xyz));
        assert_eq!(told("# rows\n\n1 2 3 .5\n"), Ok(Format::Xyzr));
        assert_eq!(told("\u{FEFF}-1,2e5;nan\r\n"), Ok(Format::Xyzr));
        assert_eq!(told("id,X,Y,Z\n1,2,3,4\n"), Ok(Format::Csv));
        assert_eq!(told("\"x\";\"y\";\"z\"\n"), Ok(Format::Csv));
        assert_eq!(told("x\ty\tz\n"), Ok(Format::Csv));
        assert!(told(" \n# nothing\n").is_err_and(|message| message == "holds no particles"));
        assert!(told("BEGIN_SCENE\n").is_err());
        assert!(told("50 pct water\n").is_err());
    }
}
