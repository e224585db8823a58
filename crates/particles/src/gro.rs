//! Reads GRO of GROMACS: fixed columns, lengths in nanometers
//! (manual.gromacs.org/current/reference-manual/file-formats.html).

use crate::lines::{Line, Lines};
use crate::schema::{Schema, Slot};
use crate::{
    Cell, FileError, Format, Kind, LengthUnit, ParticleFrame, ReadOptions, builder::Builder,
    fields::fixed, frame_reader::FrameReader, naming, number, place::Place, source::Source,
};
use glam::DVec3;
use memchr::memchr_iter;
use std::ops::Range;
use std::sync::Arc;

/// Names of the columns, in order.
const NAMES: [&str; 10] =
    ["residue_number", "residue", "name", "number", "x", "y", "z", "vx", "vy", "vz"];

/// Optional columns after positions.
const VELOCITIES: [&str; 3] = ["vx", "vy", "vz"];

/// Index of the first velocity column.
const VELOCITY: usize = 7;

/// Offset of positions in a row, in bytes.
const POSITION: usize = 20;

/// Reader of the frames of a GRO file.
pub(crate) struct Gro {
    lines: Lines,
    schema: Result<Arc<Schema>, String>,
    /// A velocity that was requested by name.
    needed: Option<String>,
}

impl Gro {
    pub(crate) fn new(source: Source, options: &ReadOptions) -> Self {
        let is_velocity =
            |name: &&String| VELOCITIES.iter().any(|own| own.eq_ignore_ascii_case(name));
        let needed = options.columns.kept.iter().find(is_velocity).cloned();
        Self { lines: Lines::new(source), schema: Schema::of_atoms(NAMES, options), needed }
    }

    /// Reads the title and the number of atoms; returns `None` at the end of the file.
    fn head(&mut self) -> Result<Option<(String, u64)>, FileError> {
        let Some(title) = self.lines.next()? else { return Ok(None) };
        let title = title.text().trim().to_owned();
        match self.lines.next()? {
            Some(line) => Ok(Some((title, line.whole_number(line.bytes)?))),
            None if title.is_empty() => Ok(None),
            None => Err(self.lines.ended("the file ends before the number of atoms")),
        }
    }

    /// Reads the atoms. Returns whether any has a velocity.
    fn atoms(&mut self, builder: &mut Builder, count: u64) -> Result<bool, FileError> {
        let schema = builder.schema().clone();
        let others: Vec<(usize, Slot)> = schema.used_columns().collect();
        let has_kind = schema.slots.contains(&Slot::Kind);
        let (mut width, mut has_velocities) = (None, false);
        for atom in 0..count {
            let help = "the file is cut off, or its second line wrong";
            let line = self.lines.row(atom, count, "atoms", help)?;
            let width = match width {
                Some(width) => width,
                None => *width.insert(self::width(&line)?),
            };
            let position = |axis: usize| line.number(field(&line, 4 + axis, width)?);
            builder.push([position(0)?, position(1)?, position(2)?])?;
            if !has_kind {
                builder.kind_of(&line.bytes[5..15], kind);
            }
            has_velocities = has_velocities || !part(&line, VELOCITY, width).is_empty();
            for &(column, slot) in &others {
                let field = match slot {
                    Slot::Extra(_) => part(&line, column, width),
                    _ => field(&line, column, width)?,
                };
                builder.put(slot, &line, field)?;
            }
        }
        Ok(has_velocities)
    }

    /// Removes the velocity columns from a frame without velocities.
    fn without_velocities(&self, mut frame: ParticleFrame) -> Result<ParticleFrame, FileError> {
        frame.columns.retain(|name| !VELOCITIES.contains(&name.as_str()));
        frame.numbers.retain(|column| !VELOCITIES.contains(&column.name.as_str()));
        match &self.needed {
            Some(name) => {
                let names = frame.columns.join(", ");
                let message = format!("no column is named `{name}`; there are {names}");
                Err(self.lines.ended(message).with_help("the file has no velocities"))
            }
            None => Ok(frame),
        }
    }
}

/// Returns the width of each coordinate in bytes: the distance between decimal points.
fn width(line: &Line) -> Result<usize, FileError> {
    let positions = line.bytes.get(POSITION..).unwrap_or_default();
    let mut points = memchr_iter(b'.', positions);
    let width = points.next().zip(points.next()).map(|(first, second)| second - first);
    width.filter(|&width| width > 1 && line.bytes.is_ascii()).ok_or_else(|| {
        let help = "the columns of a GRO file are fixed: positions begin at column 21";
        line.whole("no position in this row").with_help(help)
    })
}

/// Returns the byte range of a column.
fn columns(column: usize, width: usize) -> Range<usize> {
    match column {
        0..4 => 5 * column..5 * column + 5,
        _ => POSITION + (column - 4) * width..POSITION + (column - 3) * width,
    }
}

/// Returns the content of a column; it is empty if the line ends before it.
fn part<'l>(line: &Line<'l>, column: usize, width: usize) -> &'l [u8] {
    let Range { start, end } = columns(column, width);
    fixed(line.bytes, start, end)
}

/// Returns the content of a required column.
fn field<'l>(line: &Line<'l>, column: usize, width: usize) -> Result<&'l [u8], FileError> {
    let field = part(line, column, width);
    if field.is_empty() {
        let range = columns(column, width);
        let message = format!("no {} in this row", NAMES[column]);
        let help = format!("it is expected at columns {} to {}", range.start + 1, range.end);
        return Err(line.whole(message).with_help(help));
    }
    Ok(field)
}

/// Returns the type for the names of a residue and an atom, five letters each.
fn kind(key: &str) -> Kind {
    let (residue, name) = key.split_at_checked(5).unwrap_or((key, ""));
    naming::of_atom(name.trim(), residue.trim())
}

/// Returns the numbers of a line in columns of equal width that no blanks separate; `None` if its decimal points are not
/// at equal distances.
fn touching(line: &[u8]) -> Option<Vec<&[u8]>> {
    let line = line.trim_ascii_end();
    let points: Vec<usize> = memchr_iter(b'.', line).collect();
    let width = points.get(1)? - points[0];
    let decimals = line.len() - points.last()?;
    let is_even = decimals < width && points.windows(2).all(|pair| pair[1] - pair[0] == width);
    let ends = || points.iter().map(|point| point + decimals);
    is_even.then(|| ends().map(|end| fixed(line, end.saturating_sub(width), end)).collect())
}

/// Parses the box: its lengths, then, if it is tilted, the other components of its edges.
fn cell(line: &Line) -> Result<Option<Cell>, FileError> {
    let mut values = [0.0; 9];
    let fields: Vec<&[u8]> = line.fields().collect();
    let is_free = fields.iter().take(9).all(|field| number::parse(field).is_some());
    let fields = if is_free { fields } else { touching(line.bytes).unwrap_or(fields) };
    let mut fields = fields.into_iter();
    for (at, value) in values.iter_mut().enumerate() {
        match fields.next() {
            Some(field) => *value = line.number(field)?,
            None if at == 3 => break,
            None => {
                let help = "the last line of a frame is its box: 3 or 9 numbers";
                return Err(line.whole("no box").with_help(help));
            }
        }
    }
    let [ax, by, cz, ay, az, bx, bz, cx, cy] = values;
    let vectors = [DVec3::new(ax, ay, az), DVec3::new(bx, by, bz), DVec3::new(cx, cy, cz)];
    Ok(Cell { origin: DVec3::ZERO, vectors, periodic: [true; 3] }.declared())
}

impl FrameReader for Gro {
    fn next(&mut self) -> Result<Option<ParticleFrame>, FileError> {
        let Some((title, count)) = self.head()? else { return Ok(None) };
        let schema = self.schema.clone().map_err(|message| self.lines.ended(message))?;
        let mut builder = Builder::new(self.lines.path(), Format::Gro, &schema);
        builder.declare(&["residue", "name"], &VELOCITIES);
        let has_velocities = self.atoms(&mut builder, count)?;
        let cell = if let Some(line) = self.lines.next()? {
            cell(&line)?
        } else {
            builder.frame.warnings.push("the file ends before the box".to_owned());
            None
        };
        let after = |key: &str| {
            let text = title.rsplit_once(key)?.1.trim_start();
            text.split_whitespace().next()
        };
        let time = after("t=").and_then(|time| number::parse(time.as_bytes()));
        let step = after("step=").and_then(|step| step.parse().ok());
        let mut frame = builder.finish();
        if !has_velocities {
            frame = self.without_velocities(frame)?;
        }
        let unit = LengthUnit::Nanometer;
        Ok(Some(ParticleFrame { cell, title, step, time, unit, ..frame }))
    }

    fn skip(&mut self) -> Result<bool, FileError> {
        let Some((_, count)) = self.head()? else { return Ok(false) };
        let lines = count.saturating_add(1);
        Ok(self.lines.skip(lines)? == lines)
    }

    fn more(&mut self) -> Result<bool, FileError> {
        let more = self.lines.next()?.is_some_and(|line| !line.is_blank());
        self.lines.back();
        Ok(more)
    }

    fn place(&self) -> Option<Place> {
        self.lines.place()
    }

    fn start_at(&mut self, place: &Place) -> Result<bool, FileError> {
        self.lines.start_at(place)
    }
}

/// Returns whether these are the second and third line of a GRO file.
pub(crate) fn is_gro(second: &[u8], third: &[u8]) -> bool {
    let count = number::whole(second).is_some();
    let residue = third.get(..5).map(<[u8]>::trim_ascii);
    let residue = residue.map(|field| field.strip_prefix(b"-").unwrap_or(field));
    let residue = residue.is_some_and(|field| number::whole(field).is_some());
    let width = third.get(POSITION..).and_then(|positions| {
        let mut points = memchr_iter(b'.', positions);
        let first = points.next()?;
        Some(points.next()? - first)
    });
    let x = |width| third.get(POSITION..POSITION + width);
    count && residue && width.and_then(x).is_some_and(|x| number::parse(x.trim_ascii()).is_some())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    #[test]
    fn numbers_of_a_box_may_touch() {
        let path = Path::new("p").into();
        let vectors = |text: &str| {
            let cell = cell(&Line::new(&path, 1, text.as_bytes())).expect(text);
            cell.map(|cell| cell.vectors.map(|vector| vector.to_array()))
        };
        let tilted = "1234.50000 123.45678  77.12345   0.00000   0.00000-411.50000   0.00000-411.50000-411.50000";
        let expected = [[1234.5, 0.0, 0.0], [-411.5, 123.45678, 0.0], [-411.5, -411.5, 77.12345]];
        assert_eq!(vectors(tilted), Some(expected));
        let straight = [[1000.0, 0.0, 0.0], [0.0, 2000.0, 0.0], [0.0, 0.0, 3000.0]];
        assert_eq!(vectors("1000.000002000.000003000.00000"), Some(straight));
        assert_eq!(vectors(" 1e3 2000. 3000.0 "), Some(straight));
        assert!(cell(&Line::new(&path, 1, b"1.0x2.0 3.0 4.00")).is_err());
    }

    #[test]
    fn residues_may_have_negative_numbers() {
        let row = |number: &str| format!("{number:>5}HIS      N    1   0.305   0.837   1.095");
        for (number, expected) in [("1", true), ("-3", true), ("3-", false), ("-", false)] {
            assert_eq!(is_gro(b"    2", row(number).as_bytes()), expected, "{number}");
        }
    }
}
