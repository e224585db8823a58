//! The heads of frames of LAMMPS dumps in YAML (<https://docs.lammps.org/dump.html>, style `yaml`), which LAMMPS
//! writes line by line: keys, lists in brackets, and a list for each atom.

use super::bounds::{tilted, tilted_from_bounds};
use super::dump::Head;
use super::unit;
use crate::lines::{Line, Lines};
use crate::{Cell, FileError, LengthUnit, fields::Fields};

/// Returns whether a line begins a frame in YAML.
pub(super) fn begins(line: &[u8]) -> bool {
    line.starts_with(b"---") || line.starts_with(b"creator: LAMMPS")
}

/// Returns the values of a list: `  - [ 1, 2, ]`.
pub(super) fn values<'l>(line: &Line<'l>) -> impl Iterator<Item = &'l [u8]> {
    Fields::list(line.bytes)
}

/// Reads the head of a frame up to its rows, and the units that it names; `None` at the end of the file.
pub(super) fn head(lines: &mut Lines, units: &mut LengthUnit) -> Result<Option<Head>, FileError> {
    let mut head = Head::default();
    let mut any = false;
    let mut periodic = [true; 3];
    while let Some(line) = lines.next()? {
        let text = line.text();
        let Some((key, value)) = text.trim_end().split_once(':') else { continue };
        any = true;
        let value = value.trim();
        let number = || line.number(value.as_bytes());
        match key {
            "timestep" => head.step = Some(number()? as i64),
            "time" => head.time = Some(number()?),
            "natoms" => head.count = Some(line.whole_number(value.as_bytes())?),
            "units" => *units = unit(value),
            "boundary" => {
                // Two letters for each edge, or one for both of its ends.
                let flags: Vec<&[u8]> = values(&line).skip(1).collect();
                let ends = if flags.len() == 6 { 2 } else { 1 };
                for (edge, own) in periodic.iter_mut().zip(flags.chunks(ends)) {
                    *edge = own.iter().all(|flag| flag.starts_with(b"p"));
                }
            }
            "box" => {
                let cell = bounds(lines)?;
                head.cell = Cell { periodic, ..cell }.declared();
            }
            "keywords" => {
                let names = values(&line).skip(1);
                head.names = names.map(|name| String::from_utf8_lossy(name).into_owned()).collect();
            }
            "data" => return Ok(Some(head)),
            _ => (),
        }
    }
    if !any {
        return Ok(None);
    }
    let help = "the file is cut off; choose an earlier frame";
    Err(lines.ended("the file ends before the `data:` of a frame").with_help(help))
}

/// Reads the bounds of a box, and its tilts if a fourth row follows.
fn bounds(lines: &mut Lines) -> Result<Cell, FileError> {
    let mut rows = Vec::new();
    while let Some(line) = lines.next()? {
        if !line.bytes.trim_ascii_start().starts_with(b"-") {
            lines.back();
            break;
        }
        let numbers = values(&line).map(|value| line.number(value));
        rows.push(numbers.collect::<Result<Vec<f64>, FileError>>()?);
    }
    let column = |at: usize| -> Option<[f64; 3]> {
        let values: Option<Vec<f64>> =
            rows.get(..3)?.iter().map(|row| row.get(at).copied()).collect();
        values?.try_into().ok()
    };
    let tilt = rows.get(3).and_then(|row| row[..].try_into().ok());
    match (column(0), column(1), tilt) {
        (Some(low), Some(high), None) => Ok(tilted(low, high, [0.0; 3])),
        (Some(low), Some(high), Some(tilt)) => Ok(tilted_from_bounds(low, high, tilt)),
        _ => Err(lines.ended("a `box:` has two numbers for each edge, and three tilts")),
    }
}
