//! Reads CSV with a header.

use crate::lines::{LONGEST, Line, Lines};
use crate::record::{Record, header_names, separator};
use crate::schema::{Schema, Slot};
use crate::{
    FileError, Format, ParticleFrame, ReadOptions, builder::Builder, frame_reader::FrameReader,
    header, line, number, source::Source,
};
use std::ops::Range;
use std::sync::Arc;

/// Reader of CSV with a header.
pub(crate) struct Csv {
    lines: Lines,
    options: ReadOptions,
    record: Record,
    /// True if the first column of the rows may number or name them, and the header doesn't name it.
    has_index: bool,
    /// Buffer for a row of several lines.
    row: Vec<u8>,
}

impl Csv {
    pub(crate) fn new(source: Source, options: &ReadOptions) -> Self {
        let has_index = has_index(&source.head);
        let lines = Lines::new(source);
        let (record, row) = (Record::default(), Vec::new());
        Self { lines, options: options.clone(), record, has_index, row }
    }

    /// Returns the next line that is neither blank nor a comment.
    fn line(lines: &mut Lines) -> Result<Option<Line<'_>>, FileError> {
        while let Some(line) = lines.next()? {
            if !line.is_blank() && !line::is_comment(line.bytes) {
                lines.back();
                break;
            }
        }
        lines.next()
    }

    /// Joins the last line with the following ones until its quotes are closed.
    fn whole_row(&mut self) -> Result<(), FileError> {
        self.lines.back();
        self.row.clear();
        let (mut first, mut open) = (0, false);
        while let Some(line) = self.lines.next()? {
            if first == 0 {
                first = line.number_in_file();
            }
            self.row.extend_from_slice(line.bytes);
            open ^= is_open(line.bytes);
            if !open {
                return Ok(());
            }
            if self.row.len() > LONGEST {
                break;
            }
            self.row.extend_from_slice(self.lines.ending());
        }
        let end = memchr::memchr(b'\n', &self.row).unwrap_or(self.row.len());
        let line = Line::new(self.lines.path(), first, &self.row[..end]);
        let help = "a quoted field has two quotes for each quote within it";
        Err(line.whole("a quote is not closed").with_help(help))
    }
}

/// Returns whether the complete rows in the head of a file have a first column that the header does not name.
fn has_index(head: &[u8]) -> bool {
    let complete = &head[..memchr::memrchr(b'\n', head).unwrap_or(head.len())];
    let lines = complete.split(|&byte| byte == b'\n').map(<[u8]>::trim_ascii);
    let is_content =
        |line: &&[u8]| !line.is_empty() && !line::is_comment(line) && !line.starts_with(b"sep=");
    let mut lines = lines.filter(is_content);
    let Some(header) = lines.next() else { return false };
    let (names, separator) = (header_names(header), separator(header));
    let mut record = Record::default();
    let rows = lines.take(header::ROWS).map(|line| {
        record.read(line, separator);
        record.fields().map(<[u8]>::to_vec).collect()
    });
    let rows: Vec<Vec<Vec<u8>>> = rows.collect();
    rows.iter().all(|row| row.len() == names.len() + 1) && header::has_index(&rows)
}

/// Returns whether a line has an odd number of quotes, so that it opens or closes a quoted field.
fn is_open(row: &[u8]) -> bool {
    memchr::memchr_iter(b'"', row).count() % 2 == 1
}

impl FrameReader for Csv {
    fn next(&mut self) -> Result<Option<ParticleFrame>, FileError> {
        // Excel's first line, which declares the separator.
        if Self::line(&mut self.lines)?.is_some_and(|line| !line.bytes.starts_with(b"sep=")) {
            self.lines.back();
        }
        let Some(line) = Self::line(&mut self.lines)? else { return Ok(None) };
        let mut names = header_names(line.bytes);
        let separator = separator(line.bytes);
        for (column, name) in names.iter().enumerate() {
            let same = |other: &String| other.eq_ignore_ascii_case(name);
            if names.iter().position(same) != Some(column) {
                let span = span(line.bytes, separator, column);
                return Err(line.error(span, format!("two columns are named `{name}`")));
            }
        }
        if self.has_index {
            names.insert(0, String::new());
        }
        let help = header::columns_help(&names, &self.options);
        let schema =
            Schema::new(names, &self.options).map_err(|error| line.whole(error).with_help(help))?;
        let schema = Arc::new(schema);
        let mut builder = Builder::new(line.path(), Format::Csv, &schema);
        let path = self.lines.path().clone();
        let mut has_commas = false;
        while let Some(line) = Self::line(&mut self.lines)? {
            let number = line.number_in_file();
            if !is_open(line.bytes) {
                let row = Row { line, separator, schema: &schema };
                has_commas |= row.read(&mut self.record, &mut builder)?;
                continue;
            }
            self.whole_row()?;
            let line = Line::new(&path, number, &self.row);
            let row = Row { line, separator, schema: &schema };
            has_commas |= row.read(&mut self.record, &mut builder)?;
        }
        if self.has_index {
            builder.frame.warnings.push(header::UNNAMED.to_owned());
        }
        if has_commas {
            builder.frame.warnings.push("commas are read as decimal points".to_owned());
        }
        builder.warn_of_unused();
        Ok(Some(builder.finish()))
    }
}

/// A row under construction.
struct Row<'r> {
    line: Line<'r>,
    separator: u8,
    schema: &'r Schema,
}

impl Row<'_> {
    /// Reads the row. Returns whether it has decimal commas.
    fn read(&self, record: &mut Record, builder: &mut Builder) -> Result<bool, FileError> {
        let bytes = self.line.bytes;
        if memchr::memchr(b'"', bytes).is_none() {
            return self.put(bytes.split(|&byte| byte == self.separator), builder);
        }
        record.read(bytes, self.separator);
        self.put(record.fields(), builder)
    }

    fn put<'f>(
        &self,
        fields: impl Iterator<Item = &'f [u8]>,
        builder: &mut Builder,
    ) -> Result<bool, FileError> {
        let (mut columns, mut has_commas) = (0, false);
        for field in fields {
            if let Some(&slot) = self.schema.slots.get(columns) {
                let field = field.trim_ascii();
                let decimal =
                    if self.may_have_comma(slot) { number::with_point(field) } else { None };
                has_commas |= decimal.is_some();
                let field = decimal.as_deref().unwrap_or(field);
                builder.put(slot, &self.line, field).map_err(|error| {
                    let span = span(self.line.bytes, self.separator, columns);
                    let here = self.line.error(span, error.message);
                    FileError { help: error.help, ..here }
                })?;
            }
            columns += 1;
        }
        let expected = self.schema.names.len();
        if columns != expected {
            let message = format!("{columns} columns, but the header has {expected}");
            return Err(self.line.whole(message));
        }
        builder.end_row()?;
        Ok(has_commas)
    }

    /// Returns whether a field may have a decimal comma.
    fn may_have_comma(&self, slot: Slot) -> bool {
        self.separator != b',' && !matches!(slot, Slot::Skip | Slot::Kind | Slot::Material)
    }
}

/// Returns the byte range of a field in a line, without surrounding blanks.
fn span(line: &[u8], separator: u8, column: usize) -> Range<usize> {
    let mut quoted = false;
    let ends = line.iter().enumerate().filter(|&(_, &byte)| {
        quoted ^= byte == b'"';
        byte == separator && !quoted
    });
    let mut ends = ends.map(|(at, _)| at).chain([line.len()]);
    let start = if column == 0 { 0 } else { ends.nth(column - 1).map_or(0, |end| end + 1) };
    let end = ends.next().unwrap_or(line.len()).max(start);
    let field = line.get(start..end).unwrap_or_default();
    let start = end - field.trim_ascii_start().len();
    start..start + field.trim_ascii().len()
}
