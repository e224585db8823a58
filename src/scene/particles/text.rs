//! Rows of numbers without a header.

use super::builder::Builder;
use super::fields::Fields;
use super::frame::ParticleFrame;
use super::lines::{Line, Lines};
use super::options::{Format, ReadOptions, Role};
use super::reader::FrameReader;
use super::schema::Schema;
use super::{number, source::Source};
use crate::scene::SceneError;
use std::sync::Arc;

/// Rows by which columns of ids are told.
const ROWS: usize = 200;

/// Rows of `x y z` or `x y z radius`, or either with an id before it.
pub(super) struct Rows {
    lines: Lines,
    options: ReadOptions,
    layout: Layout,
    done: bool,
}

/// What the columns are of rows without a header.
#[derive(Debug, PartialEq)]
struct Layout {
    columns: usize,
    has_ids: bool,
}

impl Rows {
    pub(super) fn new(source: Source, options: &ReadOptions) -> Self {
        let layout = Layout::of(&source.head);
        Self { lines: Lines::new(source), options: options.clone(), layout, done: false }
    }
}

impl Layout {
    fn schema(&self, line: &Line, options: &ReadOptions) -> Result<Schema, SceneError> {
        let names: Vec<String> = (1..=self.columns).map(|column| column.to_string()).collect();
        let first = usize::from(self.has_ids);
        if !options.columns.roles.is_empty() {
            return Schema::new(names, options).map_err(|error| line.whole(error));
        }
        if !(3..=4).contains(&self.columns.saturating_sub(first)) {
            let message =
                format!("{} columns, but a row is `x y z` or `x y z radius`", self.columns);
            let help = "say which columns are what, as in x=2,y=3,z=4, or write a CSV file with \
                        a header that names them";
            return Err(line.whole(message).with_help(help));
        }
        let roles = [Role::X, Role::Y, Role::Z, Role::Radius].into_iter();
        let known: Vec<_> = roles.zip(names[first..].iter().map(String::as_str)).collect();
        Schema::with_roles(names.clone(), options, &known).map_err(|error| line.whole(error))
    }

    /// The columns of the first row, and whether what they begin with are ids: whole numbers, all
    /// different, beside positions that are not all whole.
    fn of(head: &[u8]) -> Self {
        let rows = head.split(|&byte| byte == b'\n').map(Fields::marks);
        let rows: Vec<Vec<&[u8]>> =
            rows.map(Iterator::collect).filter(|row: &Vec<_>| !row.is_empty()).take(ROWS).collect();
        let columns = rows.first().map_or(0, Vec::len);
        let mut ids: Vec<u64> = rows.iter().filter_map(|row| number::whole(row.first()?)).collect();
        ids.sort_unstable();
        ids.dedup();
        let different = rows.len() > 1 && ids.len() == rows.len();
        let whole =
            |row: &Vec<&[u8]>| row.iter().skip(1).all(|field| number::whole(field).is_some());
        let has_ids = (4..=5).contains(&columns) && different && !rows.iter().any(whole);
        Self { columns, has_ids }
    }
}

impl FrameReader for Rows {
    fn next(&mut self) -> Result<Option<ParticleFrame>, SceneError> {
        let mut builder = None;
        while let Some(line) = self.lines.next()? {
            let fields = Fields::marks(line.bytes);
            let columns = fields.clone().count();
            if columns == 0 {
                continue;
            }
            let builder = match &mut builder {
                Some(builder) => builder,
                none => {
                    self.layout.columns = columns;
                    let schema = Arc::new(self.layout.schema(&line, &self.options)?);
                    none.insert(Builder::new(line.path(), Format::Xyzr, &schema))
                }
            };
            if columns != self.layout.columns {
                let above = self.layout.columns;
                let message = format!("{columns} columns, but the rows above have {above}");
                return Err(line.whole(message).with_help("give all rows the same columns"));
            }
            builder.row(&line, fields)?;
        }
        let once = !std::mem::replace(&mut self.done, true);
        Ok(builder.filter(|_| once).map(|mut builder| {
            if self.layout.has_ids && self.options.columns.roles.is_empty() {
                builder.frame.warnings.push("the first column is taken for ids".to_owned());
            }
            builder.finish()
        }))
    }
}
