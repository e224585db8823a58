//! Reads rows of numbers, without a header or with one of blank-separated names.

use crate::lines::{Line, Lines};
use crate::{
    FileError, Format, ParticleFrame, ReadOptions, builder::Builder, fields::Fields,
    frame_reader::FrameReader, header, header::ROWS, line, number, schema::Schema, source::Source,
    units,
};
use std::collections::HashMap;
use std::sync::Arc;

/// Reader of rows of `x y z` or `x y z radius`, optionally after an id; or of columns named by a
/// header, which may be in a comment, as `numpy.savetxt` writes it.
pub(crate) struct Rows {
    lines: Lines,
    options: ReadOptions,
    layout: Layout,
    /// Buffer for a row with points instead of decimal commas.
    row: Vec<u8>,
}

/// Comments that may be headers, by number of names: the last one that names positions, or else the
/// last one.
#[derive(Default)]
struct Comments(HashMap<usize, Vec<String>>);

impl Comments {
    fn add(&mut self, names: Vec<String>) {
        let old = self.0.get(&names.len());
        if old.is_none_or(|old| axes(&names) > 0 || axes(old) == 0) {
            self.0.insert(names.len(), names);
        }
    }

    fn of(&self, columns: usize) -> Option<&[String]> {
        self.0.get(&columns).map(Vec::as_slice)
    }
}

/// Layout of rows without a header.
#[derive(Debug, PartialEq)]
struct Layout {
    columns: usize,
    has_ids: bool,
    /// Number of first columns that number or name the rows, which a header may leave without a name: 0 or 1.
    unnamed: usize,
    /// True if a header names the columns.
    has_names: bool,
    /// True if commas are decimal points.
    decimal_commas: bool,
}

impl Rows {
    pub(crate) fn new(source: Source, options: &ReadOptions) -> Self {
        let layout = Layout::of(&source.head);
        let (options, row) = (options.clone(), Vec::new());
        Self { lines: Lines::new(source), options, layout, row }
    }
}

impl Layout {
    /// Returns the schema for the columns of a header.
    fn named(
        &mut self,
        line: &Line,
        names: &[String],
        options: &ReadOptions,
    ) -> Result<Schema, FileError> {
        let mut names = names.to_vec();
        if names.len() + self.unnamed == self.columns {
            names.splice(..0, (0..self.unnamed).map(|_| String::new()));
        } else {
            self.unnamed = 0;
        }
        if names.len() != self.columns {
            let message = format!("{} columns, but the header has {}", self.columns, names.len());
            let help = "give all rows the columns of the header";
            return Err(line.whole(message).with_help(help));
        }
        let help = header::columns_help(&names, options);
        let schema =
            Schema::new(names, options).map_err(|message| line.whole(message).with_help(help))?;
        (self.has_ids, self.has_names) = (false, true);
        Ok(schema)
    }

    /// Returns the schema for the first row; the `comment` above it may name its columns.
    fn schema(
        &mut self,
        line: &Line,
        comment: Option<&[String]>,
        options: &ReadOptions,
    ) -> Result<Schema, FileError> {
        if let Some(names) = comment {
            // A comment without x, y or z is no header, and roles may refer to column numbers.
            let may_be_other = (axes(names) == 0 || !options.columns.roles.is_empty())
                && self.has_usual_columns(options);
            match self.named(line, names, options) {
                Err(_) if may_be_other => (),
                named => return named,
            }
        }
        self.has_ids &= options.columns.roles.is_empty();
        if !self.has_usual_columns(options) {
            let message =
                format!("{} columns, but a row is `x y z` or `x y z radius`", self.columns);
            let help = "assign roles to the columns, as in --columns x=1,y=2,z=3,radius=4, or put a \
                        line that names the columns before the rows; write decimal points, not commas";
            return Err(line.whole(message).with_help(help));
        }
        Schema::unnamed(self.columns, usize::from(self.has_ids), options)
            .map_err(|error| line.whole(error))
    }

    /// Returns whether the columns are known without names, or assigned by the options.
    fn has_usual_columns(&self, options: &ReadOptions) -> bool {
        let columns = self.columns.saturating_sub(usize::from(self.has_ids));
        (3..=4).contains(&columns) || !options.columns.roles.is_empty()
    }

    /// Returns the columns of the first row, and whether the first is an id: distinct whole numbers, while
    /// the positions are not all whole.
    fn of(head: &[u8]) -> Self {
        let lines = || {
            let lines = head.split(|&byte| byte == b'\n');
            lines.filter(|line| !line::is_comment(line.trim_ascii_start()))
        };
        let decimal_commas = has_decimal_commas(lines());
        let rows: Vec<Vec<Vec<u8>>> = lines()
            .map(|line| with_points(line, decimal_commas))
            .map(|line| Fields::marks(&line).map(<[u8]>::to_vec).collect::<Vec<_>>())
            .filter(|row| !row.is_empty())
            .take(ROWS)
            .collect();
        let columns = rows.first().map_or(0, Vec::len);
        let first = rows.first().and_then(|row| row.first());
        let is_number = first.is_some_and(|field| number::whole(field).is_some());
        // Names of columns are a row here.
        let unnamed = usize::from(header::has_index(rows.get(1..).unwrap_or_default()));
        let has_ids = (4..=5).contains(&columns) && is_number && header::has_index(&rows);
        Self { columns, has_ids, unnamed, has_names: false, decimal_commas }
    }
}

/// Returns how many of x, y and z are among the names, with or without units.
fn axes(names: &[String]) -> usize {
    let has =
        |axis: &&str| names.iter().any(|name| units::split(name).0.eq_ignore_ascii_case(axis));
    ["x", "y", "z"].iter().filter(|axis| has(axis)).count()
}

/// Returns whether rows have decimal commas: other separators between fields, three or more numbers,
/// and digits around each comma.
fn has_decimal_commas<'l>(lines: impl Iterator<Item = &'l [u8]>) -> bool {
    let mut any = false;
    let content = lines.map(|line| &line[..memchr::memchr(b'#', line).unwrap_or(line.len())]);
    let rows = content.filter(|line| !line.trim_ascii().is_empty());
    for row in rows.take(ROWS).filter(|row| row.contains(&b',')) {
        let fields = row.split(|byte| b" \t\r\x0B\x0C;".contains(byte));
        let mut fields = fields.filter(|field| !field.is_empty());
        let is_decimal =
            |field: &[u8]| !field.starts_with(b",") && number::with_point(field).is_some();
        if fields.clone().count() < 3
            || !fields.all(|field| !field.contains(&b',') || is_decimal(field))
        {
            return false;
        }
        any = true;
    }
    any
}

/// Returns a row with points instead of decimal commas, if it has any.
fn with_points(row: &[u8], decimal_commas: bool) -> Vec<u8> {
    let point = |&byte: &u8| if decimal_commas && byte == b',' { b'.' } else { byte };
    row.iter().map(point).collect()
}

impl FrameReader for Rows {
    fn next(&mut self) -> Result<Option<ParticleFrame>, FileError> {
        let mut builder = None;
        let mut names: Option<Vec<String>> = None;
        let mut comments = Comments::default();
        let path = self.lines.path().clone();
        while let Some(mut line) = self.lines.next()? {
            let text = line.bytes.trim_ascii();
            let is_comment = line::is_comment(text);
            if builder.is_none() && names.is_none() {
                let found = header::names(if is_comment { text[1..].trim_ascii() } else { text });
                if header::is_header(&found) {
                    if is_comment {
                        comments.add(found);
                    } else {
                        names = Some(found);
                        continue;
                    }
                }
            }
            if is_comment || Fields::marks(text).next().is_none() {
                continue;
            }
            if self.layout.decimal_commas {
                self.row = with_points(line.bytes, true);
                line = Line::new(&path, line.number_in_file(), &self.row);
            }
            let fields = Fields::marks(line.bytes);
            let columns = fields.clone().count();
            let builder = match &mut builder {
                Some(builder) => builder,
                none => {
                    self.layout.columns = columns;
                    let schema = match &names {
                        Some(names) => self.layout.named(&line, names, &self.options)?,
                        None => self.layout.schema(&line, comments.of(columns), &self.options)?,
                    };
                    none.insert(Builder::new(&path, Format::Xyzr, &Arc::new(schema)))
                }
            };
            if columns != self.layout.columns {
                let above = self.layout.columns;
                let message = format!("{columns} columns, but the rows above have {above}");
                return Err(line.whole(message).with_help("give all rows the same columns"));
            }
            builder.row(&line, fields)?;
        }
        Ok(builder.map(|mut builder| {
            if self.layout.has_ids {
                builder.frame.warnings.push("the first column is read as ids".to_owned());
            }
            if self.layout.decimal_commas {
                builder.frame.warnings.push("commas are read as decimal points".to_owned());
            }
            if self.layout.has_names && self.layout.unnamed > 0 {
                builder.frame.warnings.push(header::UNNAMED.to_owned());
            }
            if self.layout.has_names {
                builder.warn_of_unused();
            }
            builder.finish()
        }))
    }
}
