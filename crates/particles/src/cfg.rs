//! Reads CFG of AtomEye, standard and extended: fractional coordinates, in angstrom
//! (Li, "AtomEye", 2003). `Transform` and `eta` are not applied.

use crate::schema::{Schema, Slot};
use crate::{
    Cell, FileError, Format, LengthUnit, ParticleFrame, ReadOptions, builder::Builder,
    frame_reader::FrameReader, line, lines::Lines, number, source::Source,
};
use glam::DVec3;
use std::sync::Arc;

/// The beginning of a file.
const FIRST: &[u8] = b"Number of particles";

/// Names of the first columns.
const NAMES: [&str; 5] = ["species", "mass", "x", "y", "z"];

/// Velocities, in fractional coordinates.
const VELOCITIES: [&str; 3] = ["vs1", "vs2", "vs3"];

/// Maximum number of auxiliary columns.
const COLUMNS: usize = 10_000;

/// Reader of a CFG file, which is one frame.
pub(crate) struct Cfg {
    lines: Lines,
    options: ReadOptions,
    done: bool,
}

/// What precedes the rows.
struct Header {
    count: u64,
    scale: f64,
    vectors: [DVec3; 3],
    has_velocities: bool,
    /// Number of numbers per row of an extended file.
    entries: Option<usize>,
    /// Names of auxiliary columns.
    names: Vec<String>,
    /// True if `Transform` or `eta` change positions.
    is_transformed: bool,
}

impl Cfg {
    pub(crate) fn new(source: Source, options: &ReadOptions) -> Self {
        Self { lines: Lines::new(source), options: options.clone(), done: false }
    }

    /// Reads the header, up to the first row.
    fn header(&mut self) -> Result<Header, FileError> {
        let vectors = [DVec3::ZERO; 3];
        let mut header = Header {
            count: 0,
            scale: 1.0,
            vectors,
            has_velocities: true,
            entries: None,
            names: Vec::new(),
            is_transformed: false,
        };
        let mut begun = false;
        while let Some(line) = self.lines.next()? {
            let text = line.without_comment(b"#").bytes.trim_ascii();
            begun |= text.starts_with(FIRST);
            if text.is_empty() || !begun {
                continue;
            }
            if text == b".NO_VELOCITY." {
                header.has_velocities = false;
                continue;
            }
            let Some(equals) = memchr::memchr(b'=', text) else {
                self.lines.back();
                break;
            };
            let (key, value) = (text[..equals].trim_ascii_end(), text[equals + 1..].trim_ascii());
            let first = value.split(u8::is_ascii_whitespace).next().unwrap_or_default();
            match key {
                FIRST => header.count = line.whole_number(first)?,
                b"A" => header.scale = line.number(first)?,
                b"entry_count" => header.entries = Some(line.whole_number(first)? as usize),
                _ => {
                    if let Some([row, axis]) = component(key, b"H0(") {
                        header.vectors[row][axis] = line.number(first)?;
                    } else if let Some([row, axis]) = component(key, b"Transform(") {
                        let usual = f64::from(u8::from(row == axis));
                        header.is_transformed |= line.number(first)? != usual;
                    } else if component(key, b"eta(").is_some() {
                        header.is_transformed |= line.number(first)? != 0.0;
                    } else if key.starts_with(b"auxiliary[") && header.names.len() < COLUMNS {
                        header.names.push(String::from_utf8_lossy(first).into_owned());
                    }
                }
            }
        }
        Ok(header)
    }
}

/// Returns the row and column of a component of a matrix, as in `H0(1,2)`.
fn component(key: &[u8], matrix: &[u8]) -> Option<[usize; 2]> {
    let digits = key.strip_prefix(matrix)?.strip_suffix(b")")?;
    let [row, b',', axis] = *digits else { return None };
    let index = |digit: u8| (b'1'..=b'3').contains(&digit).then(|| usize::from(digit - b'1'));
    Some([index(row)?, index(axis)?])
}

impl FrameReader for Cfg {
    fn next(&mut self) -> Result<Option<ParticleFrame>, FileError> {
        if std::mem::replace(&mut self.done, true) {
            return Ok(None);
        }
        let header = self.header()?;
        let vectors = header.vectors.map(|vector| vector * header.scale);
        let cell = Cell { origin: DVec3::ZERO, vectors, periodic: [true; 3] }.with_volume();
        let cell = cell.ok_or_else(|| self.lines.ended("the cell H0 has no volume"))?;
        let velocities = if header.has_velocities { &VELOCITIES[..] } else { &[] };
        let names = NAMES.iter().chain(velocities).map(|name| (*name).to_owned());
        let schema = Schema::new(names.chain(header.names).collect(), &self.options);
        let schema = Arc::new(schema.map_err(|message| self.lines.ended(message))?);
        let used: Vec<(usize, Slot)> = schema.used_columns().collect();
        let mut builder = Builder::new(self.lines.path(), Format::Cfg, &schema);
        let (mut mass, mut symbol) = (Vec::new(), Vec::new());
        for atom in 0..header.count {
            // In extended files, masses and symbols have lines of their own, before the atoms that they are of.
            let (line, skip) = loop {
                let line = self.lines.row(atom, header.count, "atoms", "the file is cut off")?;
                let line = line.without_comment(b"#");
                let mut fields = line.fields();
                let (first, second) = (fields.next().unwrap_or_default(), fields.next());
                match (header.entries, second) {
                    (None, Some(second)) => {
                        (mass, symbol) = (first.to_vec(), second.to_vec());
                        break (line, 2);
                    }
                    (Some(_), Some(_)) => break (line, 0),
                    (_, None) if first.is_empty() => (),
                    (_, None) if number::parse(first).is_some() => mass = first.to_vec(),
                    (_, None) => symbol = first.to_vec(),
                }
            };
            let fields: Vec<&[u8]> = line.fields().skip(skip).collect();
            let least = header.entries.unwrap_or(3).max(3);
            if fields.len() < least {
                return Err(line.whole(format!("{} numbers, but a row has {least}", fields.len())));
            }
            let place = [line.number(fields[0])?, line.number(fields[1])?, line.number(fields[2])?];
            builder.push(cell.cartesian(place).to_array())?;
            for &(column, slot) in &used {
                let field = match column {
                    0 => &symbol[..],
                    1 => &mass[..],
                    _ => fields.get(column - 2).copied().unwrap_or_default(),
                };
                builder.put(slot, &line, field)?;
            }
        }
        if self.lines.more()? {
            builder.warn_of_more_rows();
        }
        if header.is_transformed {
            let warning = "`Transform` and `eta` of its header are not applied";
            builder.frame.warnings.push(warning.to_owned());
        }
        let frame = builder.finish();
        Ok(Some(ParticleFrame { cell: Some(cell), unit: LengthUnit::Angstrom, ..frame }))
    }
}

/// Returns whether a file with this head is CFG.
pub(crate) fn is_cfg(head: &[u8]) -> bool {
    let lines = head.split(|&byte| byte == b'\n').map(<[u8]>::trim_ascii);
    let lines = lines.filter(|line| !line.is_empty() && !line.starts_with(b"#"));
    let is_first = |line: &[u8]| line.starts_with(FIRST) && line.contains(&b'=');
    { lines }.take(line::FIRST).any(is_first)
}
