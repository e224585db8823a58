//! LAMMPS dumps in text: frames of `ITEM:` sections, or in YAML (<https://docs.lammps.org/dump.html>).

use super::bounds::{tilted, tilted_from_bounds};
use super::{unit, yaml};
use crate::lines::{Line, Lines};
use crate::{
    Cell, FileError, Format, LengthUnit, ParticleFrame, ReadOptions, Role, builder::Builder,
    frame_reader::FrameReader, place::Place, schema::Schema, source::Source,
};
use glam::DVec3;
use std::sync::Arc;

/// Names of position columns, in order of precedence: wrapped, unwrapped, and both in fractional
/// coordinates (`true`).
const POSITIONS: [([&str; 3], bool); 4] = [
    (["x", "y", "z"], false),
    (["xs", "ys", "zs"], true),
    (["xu", "yu", "zu"], false),
    (["xsu", "ysu", "zsu"], true),
];

/// Columns of dumps without column names.
const UNNAMED: [&str; 5] = ["id", "type", "xs", "ys", "zs"];

/// Reader of the frames of a dump.
pub(in super::super) struct Dump {
    lines: Lines,
    options: ReadOptions,
    known: Arc<Known>,
}

/// Facts of earlier frames.
#[derive(Clone)]
struct Known {
    /// Units: only the first frame must declare them.
    units: LengthUnit,
    /// True after the first section. Other text may precede it.
    begun: bool,
    /// True once a frame in YAML began.
    is_yaml: bool,
}

/// The header of a frame.
#[derive(Default)]
pub(super) struct Head {
    pub(super) step: Option<i64>,
    pub(super) time: Option<f64>,
    pub(super) count: Option<u64>,
    pub(super) cell: Option<Cell>,
    pub(super) names: Vec<String>,
}

impl Dump {
    pub(in super::super) fn new(source: Source, options: &ReadOptions) -> Self {
        let known = Known { units: LengthUnit::Unknown, begun: false, is_yaml: false };
        Self { lines: Lines::new(source), options: options.clone(), known: Arc::new(known) }
    }

    /// Reads a frame up to the column names of atoms; returns `None` at the end of the file.
    fn head(&mut self) -> Result<Option<Head>, FileError> {
        let mut head = Head::default();
        let mut any = false;
        while let Some(line) = self.lines.next()? {
            if line.is_blank() {
                continue;
            }
            let Known { begun, is_yaml, .. } = *self.known;
            if is_yaml || !begun && yaml::begins(line.bytes) {
                self.lines.back();
                let known = Arc::make_mut(&mut self.known);
                known.is_yaml = true;
                return yaml::head(&mut self.lines, &mut known.units);
            }
            if !begun {
                if !line.bytes.starts_with(b"ITEM:") {
                    continue;
                }
                Arc::make_mut(&mut self.known).begun = true;
            }
            any = true;
            let text = line.text();
            let Some(item) = text.strip_prefix("ITEM:").map(str::trim) else {
                let help = "a dump begins with ITEM: TIMESTEP, and has a row for each atom";
                return Err(line.whole("not the beginning of a section").with_help(help));
            };
            if let Some(names) = item.strip_prefix("ATOMS") {
                head.names = names.split_whitespace().map(str::to_owned).collect();
                return Ok(Some(head));
            }
            let item = item.to_owned();
            self.section(&item, &mut head)?;
        }
        if any { Err(self.ended("ITEM: ATOMS")) } else { Ok(None) }
    }

    fn section(&mut self, item: &str, head: &mut Head) -> Result<(), FileError> {
        if let Some(kind) = item.strip_prefix("BOX BOUNDS") {
            head.cell = self.bounds(kind)?;
            return Ok(());
        }
        let Some(line) = self.lines.next()? else { return Err(self.ended(item)) };
        let value = line.bytes.trim_ascii();
        match item {
            "TIMESTEP" => head.step = Some(line.number(value)? as i64),
            "TIME" => head.time = Some(line.number(value)?),
            "NUMBER OF ATOMS" => head.count = Some(line.whole_number(value)?),
            "UNITS" => {
                Arc::make_mut(&mut self.known).units = unit(&String::from_utf8_lossy(value));
            }
            // A section of a later version: skip its lines up to the next section.
            _ => {
                self.lines.back();
                while self.lines.next()?.is_some_and(|line| !line.bytes.starts_with(b"ITEM:")) {}
                self.lines.back();
            }
        }
        Ok(())
    }

    fn bounds(&mut self, kind: &str) -> Result<Option<Cell>, FileError> {
        let mut words = kind.split_whitespace().peekable();
        let mut has =
            |first: &str| words.next_if(|word| word.eq_ignore_ascii_case(first)).is_some();
        let general = has("abc") && has("origin");
        let is_tilted = has("xy") && has("xz") && has("yz");
        let columns = if general { 4 } else { 2 + usize::from(is_tilted) };
        let mut rows = [[0.0; 4]; 3];
        for row in &mut rows {
            let Some(line) = self.lines.next()? else { return Err(self.ended("BOX BOUNDS")) };
            read_row(&line, &mut row[..columns])?;
        }
        let column = |at: usize| rows.map(|row| row[at]);
        let cell = if general {
            let vectors = rows.map(|row| DVec3::from_slice(&row[..3]));
            let origin = DVec3::from_array(column(3));
            Cell { origin, vectors, periodic: [true; 3] }
        } else if is_tilted {
            tilted_from_bounds(column(0), column(1), column(2))
        } else {
            tilted(column(0), column(1), [0.0; 3])
        };
        let mut periodic = cell.periodic;
        for (edge, flag) in periodic.iter_mut().zip(words) {
            *edge = flag.starts_with('p');
        }
        Ok(Cell { periodic, ..cell }.declared())
    }

    fn ended(&self, section: &str) -> FileError {
        let message = format!("the file ends within the section {section}");
        self.lines.ended(message).with_help("the file is cut off; choose an earlier frame")
    }

    /// Returns the columns, and whether positions are fractional coordinates.
    fn schema(&self, mut names: Vec<String>) -> Result<(Schema, bool), FileError> {
        if names.is_empty() {
            names = UNNAMED.map(str::to_owned).into();
        }
        let roles = &self.options.columns.roles;
        let given = roles.iter().find(|(role, _)| *role == Role::X).map(|(_, name)| name.as_str());
        let family = POSITIONS.iter().find(|(family, _)| match given {
            Some(name) => family[0] == name,
            None => family.iter().all(|name| names.iter().any(|own| own == name)),
        });
        let (known, scaled) = family.map_or((Vec::new(), false), |(family, scaled)| {
            ([Role::X, Role::Y, Role::Z].into_iter().zip(family.iter().copied()).collect(), *scaled)
        });
        let schema = Schema::with_roles(names, &self.options, &known).map_err(|message| {
            self.lines
                .ended(message)
                .with_help("dump the positions too, as in `dump ... id type x y z`")
        })?;
        Ok((schema, scaled))
    }
}

/// Fills `row` with the numbers at the beginning of a line.
fn read_row(line: &Line, row: &mut [f64]) -> Result<(), FileError> {
    let count = row.len();
    let mut fields = line.fields();
    for number in row {
        let field = fields.next();
        let field =
            field.ok_or_else(|| line.whole(format!("a bound of a box has {count} numbers")))?;
        *number = line.number(field)?;
    }
    Ok(())
}

impl FrameReader for Dump {
    fn next(&mut self) -> Result<Option<ParticleFrame>, FileError> {
        let Some(mut head) = self.head()? else { return Ok(None) };
        let (schema, scaled) = self.schema(std::mem::take(&mut head.names))?;
        let has_elements = schema.names.iter().any(|name| name == "element");
        let mut builder = Builder::new(self.lines.path(), Format::LammpsDump, &Arc::new(schema));
        let Some(count) = head.count else {
            return Err(self.lines.ended("a frame without ITEM: NUMBER OF ATOMS"));
        };
        for atom in 0..count {
            let help = "the file is cut off; choose an earlier frame";
            let line = self.lines.row(atom, count, "atoms", help)?;
            if atom == 0 && !self.known.is_yaml {
                builder.warn_of_surplus(line.fields().count());
            }
            if self.known.is_yaml {
                builder.row(&line, yaml::values(&line))?;
            } else {
                builder.row(&line, line.fields())?;
            }
        }
        let mut frame = builder.finish();
        if scaled {
            let Some(cell) = head.cell else {
                let error = self.lines.ended("fractional positions, but the box has no volume");
                return Err(error.with_help("dump `x y z`, or correct ITEM: BOX BOUNDS"));
            };
            unscale(&mut frame, &cell);
        }
        let unit = match self.known.units {
            LengthUnit::Unknown if has_elements => LengthUnit::Angstrom,
            unit => unit,
        };
        Ok(Some(ParticleFrame { cell: head.cell, step: head.step, time: head.time, unit, ..frame }))
    }

    fn skip(&mut self) -> Result<bool, FileError> {
        let Some(Head { count: Some(count), .. }) = self.head()? else { return Ok(false) };
        Ok(self.lines.skip(count)? == count)
    }

    fn more(&mut self) -> Result<bool, FileError> {
        self.lines.more()
    }

    fn place(&self) -> Option<Place> {
        Some(self.lines.place()?.with_state(&self.known))
    }

    fn start_at(&mut self, place: &Place) -> Result<bool, FileError> {
        self.lines.start_with(place, &mut self.known)
    }
}

/// Converts fractional to Cartesian coordinates.
fn unscale(frame: &mut ParticleFrame, cell: &Cell) {
    for row in 0..frame.len() {
        let point = cell.cartesian(frame.position(row).to_array());
        (frame.x[row], frame.y[row], frame.z[row]) = (point.x, point.y, point.z);
    }
}
