//! Builds a frame: columns grow with the rows that are read, never by a count in the file.

use crate::categories::{Codebook, add};
use crate::naming::{drop_uncertain_elements, kind, of_atom};
use crate::schema::{Schema, Slot};
use crate::{
    FileError, Format, Kind, MAX_PARTICLES, ParticleFrame, Rgb, error::listed, extra::Extra,
    lines::Line, memory,
};
use std::collections::HashMap;
use std::path::Path;
use std::sync::Arc;

/// Number of rows that are read before the first check of available memory.
const FIRST_CHECK: usize = 1 << 16;

/// Bytes of columns that may be copied when they grow; allocators extend larger ones in place.
const MAX_COPIED: u64 = 1 << 27;

/// A frame under construction.
pub(crate) struct Builder {
    path: Arc<Path>,
    pub(crate) frame: ParticleFrame,
    schema: Arc<Schema>,
    position: [f64; 3],
    color: Rgb,
    kinds: Codebook,
    kind_rows: HashMap<Kind, u32>,
    materials: Codebook,
    extras: Vec<Extra>,
    /// Number of rows at which to check available memory again.
    next_check: usize,
    /// Number of rows beyond which only columns that were requested by name are kept.
    most_rows: usize,
    needed_columns: usize,
    /// Number of color channels that are not 0 to 1.
    beyond: u64,
    /// Extra columns that are left out since they mix numbers and texts.
    mixed: Vec<String>,
}

impl Builder {
    pub(crate) fn new(path: &Arc<Path>, format: Format, schema: &Arc<Schema>) -> Self {
        let mut frame = ParticleFrame { format, ..ParticleFrame::default() };
        frame.columns = schema.listed();
        frame.roles.clone_from(&schema.roles);
        frame.unit = schema.unit;
        let rest = schema.extras.len() - schema.asked;
        let most_rows = schema.rest.checked_div(rest).map_or(usize::MAX, |rows| rows.max(1));
        Self {
            path: path.clone(),
            frame,
            position: [0.0; 3],
            color: Rgb::ONE,
            kinds: Codebook::default(),
            kind_rows: HashMap::new(),
            materials: Codebook::default(),
            extras: schema.extras.iter().map(|name| Extra::new(name)).collect(),
            schema: schema.clone(),
            next_check: FIRST_CHECK.min(most_rows),
            most_rows,
            needed_columns: schema.needed_columns(),
            beyond: 0,
            mixed: Vec::new(),
        }
    }

    pub(crate) fn schema(&self) -> &Arc<Schema> {
        &self.schema
    }

    /// Declares which extra columns are texts and which are numbers.
    pub(crate) fn declare(&mut self, texts: &[&str], numbers: &[&str]) {
        self.extras.iter_mut().for_each(|extra| extra.declare(texts, numbers));
    }

    /// Reads a row by the schema; surplus fields are ignored.
    #[inline]
    pub(crate) fn row<'l>(
        &mut self,
        line: &Line,
        mut fields: impl Iterator<Item = &'l [u8]>,
    ) -> Result<(), FileError> {
        for column in 0..self.schema.slots.len() {
            let Some(field) = fields.next() else {
                if column < self.needed_columns {
                    return Err(self.too_short(line, column));
                }
                // The remaining columns were not requested: rows may end before them.
                self.put(self.schema.slots[column], line, b"")?;
                continue;
            };
            self.put(self.schema.slots[column], line, field)?;
        }
        self.end_row()
    }

    fn too_short(&self, line: &Line, columns: usize) -> FileError {
        let names = &self.schema.names[..self.needed_columns];
        let message = format!("{columns} columns, but a row has {}", names.join(", "));
        line.whole(message)
    }

    /// Parses a field into its column.
    #[inline]
    pub(crate) fn put(&mut self, slot: Slot, line: &Line, field: &[u8]) -> Result<(), FileError> {
        match slot {
            Slot::Skip => (),
            Slot::Position(axis) => {
                // An empty field is more likely a mistake.
                let value = if field.is_empty() {
                    line.number(field)
                } else {
                    line.number_or_missing(field)
                };
                self.position[axis] = value?;
            }
            Slot::Radius(factor) => self.frame.radius.push(line.number_or_missing(field)? * factor),
            Slot::Kind => self.kind(field),
            Slot::Color(channel) => self.channel(channel, line, field)?,
            Slot::Material => self.material(field),
            Slot::Extra(extra) => {
                let put = self.extras[extra].put(line, field);
                if extra < self.schema.asked {
                    put?;
                } else if put.is_err() {
                    self.mixed.push(self.schema.extras[extra].clone());
                    self.extras[extra] = Extra::LeftOut;
                }
            }
        }
        Ok(())
    }

    /// Adds a number from a binary file; color channels are clamped to 0..=1.
    pub(crate) fn put_number(&mut self, slot: Slot, value: f64) {
        match slot {
            Slot::Skip | Slot::Material => (),
            Slot::Position(axis) => self.position[axis] = value,
            Slot::Radius(factor) => self.frame.radius.push(value * factor),
            Slot::Kind => self.kind(value.to_string().as_bytes()),
            Slot::Color(channel) => {
                self.beyond += u64::from(!is_color(value));
                self.color[channel] = clamp_channel(value);
            }
            Slot::Extra(extra) => self.extras[extra].put_number(value),
        }
    }

    /// Adds a text to a column that doesn't need a number.
    pub(crate) fn put_text(&mut self, slot: Slot, text: &str) {
        match slot {
            Slot::Skip | Slot::Position(_) | Slot::Radius(_) | Slot::Color(_) => (),
            Slot::Kind => self.kind(text.as_bytes()),
            Slot::Material => self.material(text.as_bytes()),
            Slot::Extra(extra) => self.extras[extra].put_text(text),
        }
    }

    /// Completes the row of the last fields.
    #[inline]
    pub(crate) fn end_row(&mut self) -> Result<(), FileError> {
        let [x, y, z] = self.position;
        self.push([x, y, z])?;
        if self.schema.has_color() {
            self.frame.color.push(self.color);
        }
        Ok(())
    }

    /// Appends a position.
    #[inline]
    pub(crate) fn push(&mut self, [x, y, z]: [f64; 3]) -> Result<(), FileError> {
        if self.frame.x.len() == self.next_check {
            self.check_memory()?;
        }
        self.frame.x.push(x);
        self.frame.y.push(y);
        self.frame.z.push(z);
        Ok(())
    }

    /// Appends a type by its name.
    #[inline]
    pub(crate) fn kind(&mut self, name: &[u8]) {
        let naming = self.schema.naming;
        self.kind_of(name, |name| kind(name, naming));
    }

    /// Appends a type by its key; `make` creates the type of a new key.
    #[inline]
    pub(crate) fn kind_of(&mut self, key: &[u8], make: impl FnOnce(&str) -> Kind) {
        let (rows, table) = (&mut self.kind_rows, &mut self.frame.kinds.table);
        let code = self.kinds.code(key, |key| {
            let kind = make(key);
            *rows.entry(kind).or_insert_with_key(|kind| {
                table.push(kind.clone());
                table.len() as u32 - 1
            })
        });
        self.frame.kinds.codes.push(code);
    }

    /// Appends the type of an atom of a molecule, by its name and that of its residue.
    pub(crate) fn atom_kind(&mut self, name: &[u8], residue: &[u8]) {
        self.kind_of(&[residue, name].join(&b' '), |key| {
            let (residue, name) = key.split_once(' ').unwrap_or(("", key));
            of_atom(name, residue)
        });
    }

    fn channel(&mut self, channel: usize, line: &Line, field: &[u8]) -> Result<(), FileError> {
        let value = line.number(field)? as f32;
        if !is_color(f64::from(value)) {
            let message = format!("a color of {value}, but colors are 0 to 1");
            let help = "colors are linear; make values of 0 to 255 linear after a division by 255";
            return Err(line.error_at(field, message).with_help(help));
        }
        self.color[channel] = value;
        Ok(())
    }

    fn material(&mut self, name: &[u8]) {
        let column = &mut self.frame.materials;
        let code = self.materials.code(name, |name| add(&mut column.names, name));
        column.codes.push(code);
    }

    /// Checks that there is memory for another batch of rows. Columns double their capacity at powers of
    /// two, which needs address space for as many rows again at once.
    fn check_memory(&mut self) -> Result<(), FileError> {
        let rows = self.next_check;
        if rows == self.most_rows {
            self.extras[self.schema.asked..].fill_with(|| Extra::LeftOut);
        }
        let next = (rows + rows / 8).min((rows + 1).next_power_of_two()).max(FIRST_CHECK);
        self.next_check = if rows < self.most_rows { next.min(self.most_rows) } else { next };
        let (count, more) = (rows as u64, (self.next_check - rows) as u64);
        if count >= MAX_PARTICLES {
            let message = format!("holds more than {MAX_PARTICLES} particles");
            return Err(FileError::whole_file(&self.path, message));
        }
        let bytes = self.row_bytes();
        let grown = if rows.is_power_of_two() { count * bytes } else { 0 };
        // Columns that are copied stay reserved until the copy is complete.
        let reserve = grown + grown.min(MAX_COPIED);
        memory::check_growth(more * bytes, reserve).map_err(|shortage| {
            let message =
                format!("holds more than {count} particles; more of them need {shortage}");
            FileError::whole_file(&self.path, message)
        })
    }

    /// Returns the number of extra columns that are kept.
    fn kept_extras(&self) -> usize {
        self.extras.iter().filter(|extra| !matches!(extra, Extra::LeftOut)).count()
    }

    /// Returns the bytes per row in all columns, from the rows read so far.
    fn row_bytes(&self) -> u64 {
        let frame = &self.frame;
        let column = |bytes: usize, there: bool| if there { bytes } else { 0 };
        let bytes = size_of::<[f64; 3]>()
            + column(size_of::<f64>(), !frame.radius.is_empty())
            + column(size_of::<Rgb>(), self.schema.has_color())
            + column(frame.kinds.codes.width(), !frame.kinds.codes.is_empty())
            + column(frame.materials.codes.width(), !frame.materials.codes.is_empty())
            + size_of::<f64>() * self.kept_extras();
        bytes as u64
    }

    /// Warns that rows have more columns than names, if they do.
    pub(crate) fn warn_of_surplus(&mut self, columns: usize) {
        let named = self.schema.names.len();
        if columns > named {
            self.frame.warnings.push(format!(
                "rows have {columns} columns, of which {named} are named; the others are not read"
            ));
        }
    }

    /// Warns that rows follow those that the file counts.
    pub(crate) fn warn_of_more_rows(&mut self) {
        let count = self.frame.len();
        self.frame.warnings.push(format!(
            "rows follow the {count} atoms that its header counts, and are left out; correct the number"
        ));
    }

    /// Warns of the file's columns that have no use, if there are any.
    pub(crate) fn warn_of_unused(&mut self) {
        let names: Vec<&str> = self.schema.unused.iter().map(String::as_str).collect();
        if !names.is_empty() {
            self.frame.warnings.push(listed("columns that are not used", &names));
        }
    }

    /// Returns the frame.
    pub(crate) fn finish(mut self) -> ParticleFrame {
        drop_uncertain_elements(&mut self.frame.kinds, self.schema.naming);
        warn_of_colors(&mut self.frame, self.beyond);
        if !self.mixed.is_empty() {
            let names: Vec<&str> = self.mixed.iter().map(String::as_str).collect();
            let warning = listed("columns that mix numbers and texts are not read", &names);
            self.frame.warnings.push(warning);
        }
        for extra in self.extras {
            extra.finish(&mut self.frame.numbers, &mut self.frame.texts);
        }
        self.frame.shrink();
        self.frame
    }
}

/// Returns whether a number is a channel of a color.
pub(crate) fn is_color(value: f64) -> bool {
    (0.0..=1.0).contains(&value)
}

/// Adds a warning that counts the channels of colors that are clamped.
pub(crate) fn warn_of_colors(frame: &mut ParticleFrame, beyond: u64) {
    if beyond > 0 {
        frame.warnings.push(format!(
            "{beyond} values of colors are not 0 to 1, and are cut off there; colors are linear: make values of 0 to 255 \
             linear after a division by 255"
        ));
    }
}

/// Clamps a color channel to 0..=1; returns 0 for NaN.
pub(crate) fn clamp_channel(value: f64) -> f32 {
    if value > 0.0 { value.min(1.0) as f32 } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ReadOptions;

    fn builder(columns: &str) -> Builder {
        let options =
            ReadOptions { columns: columns.parse().expect("columns"), ..ReadOptions::default() };
        let names = ["x", "y", "z", "radius", "type", "red", "green", "blue", "q", "t"];
        let schema = Schema::new(names.map(str::to_owned).into(), &options).expect("a schema");
        Builder::new(&Path::new("p").into(), Format::Csv, &Arc::new(schema))
    }

    fn push(builder: &mut Builder, rows: usize, kinds: usize) {
        let path = Path::new("p").into();
        for row in 0..rows {
            let text = format!("1,2,3,4,{},0,0,1,5,6", row % kinds);
            let line = Line::new(&path, 1, text.as_bytes());
            builder.row(&line, line.bytes.split(|&byte| byte == b',')).expect("a row");
        }
    }

    /// Returns the bytes of a frame's columns.
    fn bytes(frame: &ParticleFrame) -> u64 {
        let numbers = frame.numbers.iter().map(|column| column.values.len()).sum::<usize>();
        let codes = frame.kinds.codes.len() * frame.kinds.codes.width();
        let doubles = 3 * frame.x.len() + frame.radius.len() + numbers;
        (8 * doubles + size_of_val(&frame.color[..]) + codes) as u64
    }

    #[test]
    fn rows_take_the_bytes_of_their_columns() {
        for (columns, kinds) in [("", 1), ("q", 1), ("q,t", 3), ("q,t", 300)] {
            let mut builder = builder(columns);
            push(&mut builder, 300, kinds);
            let expected = builder.row_bytes() * 300;
            assert_eq!(bytes(&builder.finish()), expected, "{columns} {kinds}");
        }
    }

    #[test]
    fn memory_is_checked_at_least_every_eighth_and_where_columns_double() {
        let mut builder = builder("");
        let mut checks = Vec::new();
        let mut before = builder.next_check;
        assert_eq!(before, FIRST_CHECK);
        while before < 1 << 20 {
            builder.check_memory().expect("memory");
            checks.push(builder.next_check);
            assert!(
                builder.next_check > before && builder.next_check <= before + before / 8,
                "{before}"
            );
            assert!(builder.next_check <= (before + 1).next_power_of_two());
            before = builder.next_check;
        }
        for power in 17..=20 {
            assert!(checks.contains(&(1 << power)), "{checks:?}");
        }
    }

    #[test]
    fn more_particles_than_a_scene_holds_are_refused() {
        let mut builder = builder("");
        builder.next_check = MAX_PARTICLES as usize;
        let error = builder.check_memory().expect_err("too many");
        assert!(error.message.contains("more than"), "{error}");
        builder.next_check = MAX_PARTICLES as usize - 1;
        let message = builder.check_memory().err().map_or_else(String::new, |error| error.message);
        assert!(!message.ends_with("particles"), "{message}");
    }
}
