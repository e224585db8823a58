//! CSV with a header.

use super::header::Header;
use super::sink::{Row, Sink};
use crate::scene::{Rgb, SceneError};
use csv::{ErrorKind, Position, ReaderBuilder, StringRecord, Trim};
use glam::DVec3;
use std::fs::File;
use std::io::{self, BufRead, BufReader, Read, Seek, SeekFrom};
use std::ops::Range;
use std::path::Path;
use std::str::FromStr;

/// Longest row in bytes.
const LONGEST_ROW: u64 = 1 << 20;

/// Longest part of a line that an error shows, in bytes.
const LONGEST: u64 = 1 << 12;

/// Reads all rows.
pub(super) fn read(
    path: &Path,
    mut reader: impl BufRead,
    sink: &mut Sink,
) -> Result<(), SceneError> {
    let delimiter = delimiter(reader.fill_buf().unwrap_or_default());
    let mut reader = ReaderBuilder::new()
        .delimiter(delimiter)
        .comment(Some(b'#'))
        .trim(Trim::All)
        .has_headers(false)
        .from_reader(reader.take(0));
    let mut names = StringRecord::new();
    next(path, &mut reader, &mut names)?;
    let header = Header::new(&names).map_err(|message| {
        let record = Record { path, names: &names, fields: &names, delimiter };
        let help = "the header names x, y and z, and may name radius (or r, or diameter), \
                    material, red, green and blue";
        record.error(0, message).with_help(help)
    })?;
    let mut fields = StringRecord::new();
    while next(path, &mut reader, &mut fields)? {
        row(&Record { path, names: &names, fields: &fields, delimiter }, &header, sink)?;
    }
    sink.warn_of("columns that are not used", &header.unused);
    Ok(())
}

/// Reads the next row, if there is one; not one without end, where a quote is not closed.
fn next(
    path: &Path,
    reader: &mut csv::Reader<io::Take<impl Read>>,
    fields: &mut StringRecord,
) -> Result<bool, SceneError> {
    let line = reader.position().line();
    reader.get_mut().set_limit(LONGEST_ROW);
    let more = reader.read_record(fields);
    if reader.get_ref().limit() == 0 {
        let message = format!("a row, from line {line} on, is longer than {LONGEST_ROW} bytes");
        let help = "a row ends with its line; perhaps a quote is not closed";
        return Err(SceneError::whole_file(path, message).with_help(help));
    }
    more.map_err(|error| broken(path, &error))
}

/// A line of the file.
struct Record<'r> {
    path: &'r Path,
    names: &'r StringRecord,
    fields: &'r StringRecord,
    delimiter: u8,
}

impl Record<'_> {
    fn error(&self, column: usize, message: impl Into<String>) -> SceneError {
        let (line, text) = line_at(self.path, self.fields.position());
        let span = field_span(&text, self.delimiter, column);
        SceneError::at(self.path, &text, line, span, message)
    }

    fn field(&self, column: usize) -> &str {
        self.fields.get(column).unwrap_or_default()
    }

    fn number<T: FromStr>(&self, column: usize) -> Result<T, SceneError> {
        self.field(column).parse().map_err(|_| {
            let name = self.names.get(column).unwrap_or_default();
            self.error(column, format!("{name} is `{}`, not a number", self.field(column)))
        })
    }

    fn numbers<T: FromStr>(&self, [x, y, z]: [usize; 3]) -> Result<[T; 3], SceneError> {
        Ok([self.number(x)?, self.number(y)?, self.number(z)?])
    }

    fn color(&self, columns: [usize; 3]) -> Result<Rgb, SceneError> {
        let values: [f32; 3] = self.numbers(columns)?;
        match (0..3).find(|&channel| !(0.0..=1.0).contains(&values[channel])) {
            None => Ok(Rgb::from_array(values)),
            Some(channel) => {
                let message = format!("a color of {}, but colors are 0 to 1", values[channel]);
                let help =
                    "colors are linear; make values of 0 to 255 linear after a division by 255";
                Err(self.error(columns[channel], message).with_help(help))
            }
        }
    }
}

fn row(record: &Record, header: &Header, sink: &mut Sink) -> Result<(), SceneError> {
    let radius = |(column, factor): (usize, f64)| Ok(record.number::<f64>(column)? * factor);
    sink.push(&Row {
        center: DVec3::from_array(record.numbers(header.position)?),
        radius: header.radius.map(radius).transpose()?,
        material: header.material.map_or("", |column| record.field(column)),
        color: header.color.map_or(Ok(Rgb::ONE), |columns| record.color(columns))?,
    })
}

/// What stands most often in the first line that is no comment.
fn delimiter(head: &[u8]) -> u8 {
    let lines = head.split(|&byte| byte == b'\n');
    let mut lines = lines.filter(|line| !line.trim_ascii().is_empty() && !line.starts_with(b"#"));
    let first = lines.next().unwrap_or_default();
    let count = |delimiter: &u8| first.split(|byte| byte == delimiter).count();
    // Of equals the last wins: a comma, where there is none of any.
    [b'\t', b';', b','].into_iter().max_by_key(count).unwrap_or(b',')
}

fn broken(path: &Path, error: &csv::Error) -> SceneError {
    let message = match error.kind() {
        ErrorKind::UnequalLengths { expected_len, len, .. } => {
            format!("{len} columns, but the header has {expected_len}")
        }
        ErrorKind::Utf8 { .. } => "not UTF-8 text".to_owned(),
        _ => return SceneError::whole_file(path, format!("cannot be read: {error}")),
    };
    let (line, text) = line_at(path, error.position());
    SceneError::at(path, &text, line, 0..text.len(), message)
}

/// Number and text of the line where a record begins. A record's position is where its search
/// began: before blank lines and comments, so they are passed over here. There is no text where the
/// file can be read but once: to open a pipe anew may take for ever.
fn line_at(path: &Path, position: Option<&Position>) -> (usize, String) {
    let (mut line, byte) = position.map_or((1, 0), |at| (at.line() as usize, at.byte()));
    if !path.is_file() {
        return (line, String::new());
    }
    let opened = File::open(path).and_then(|mut file| {
        file.seek(SeekFrom::Start(byte))?;
        Ok(BufReader::new(file))
    });
    let Ok(mut reader) = opened else { return (line, String::new()) };
    let mut bytes = Vec::new();
    while reader.by_ref().take(LONGEST).read_until(b'\n', &mut bytes).is_ok_and(|length| length > 0)
    {
        let text = String::from_utf8_lossy(&bytes);
        if !text.trim().is_empty() && !text.starts_with('#') {
            return (line, text.trim_end().to_owned());
        }
        line += 1;
        bytes.clear();
    }
    (line, String::new())
}

/// The bytes of a field in a line, without the blanks around it.
fn field_span(text: &str, delimiter: u8, column: usize) -> Range<usize> {
    let mut quoted = false;
    let ends = text.bytes().enumerate().filter(|&(_, byte)| {
        quoted ^= byte == b'"';
        byte == delimiter && !quoted
    });
    let mut ends = ends.map(|(at, _)| at).chain([text.len()]);
    let start = if column == 0 { 0 } else { ends.nth(column - 1).map_or(0, |end| end + 1) };
    let end = ends.next().unwrap_or(text.len()).max(start);
    let field = text.get(start..end).unwrap_or_default();
    let start = end - field.trim_start().len();
    start..start + field.trim().len()
}
