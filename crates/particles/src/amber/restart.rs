//! Reads restart files of AMBER in text: a title, the number of atoms, and numbers in columns of twelve: positions,
//! optionally velocities, optionally the lengths and angles of the box (<https://ambermd.org/FileFormats.php#restart>).

use crate::lines::{Line, Lines};
use crate::schema::{Schema, Slot};
use crate::{
    Cell, FileError, Format, LengthUnit, ParticleFrame, ReadOptions, builder::Builder,
    fields::Fields, frame_reader::FrameReader, number, source::Source,
};
use std::sync::Arc;

/// Columns of a number.
const WIDTH: usize = 12;

/// Numbers of a line.
const PER_LINE: usize = 6;

/// Velocities are in angstrom per 1/20.455 of a picosecond.
const PER_PICOSECOND: f64 = 20.455;

/// Reader of a restart file, which is one frame.
pub(in super::super) struct Restart {
    lines: Lines,
    options: ReadOptions,
    done: bool,
}

impl Restart {
    pub(in super::super) fn new(source: Source, options: &ReadOptions) -> Self {
        Self { lines: Lines::new(source), options: options.clone(), done: false }
    }
}

/// Returns the numbers of a line, in fixed columns.
fn fields<'l>(line: &Line<'l>) -> impl Iterator<Item = &'l [u8]> {
    line.bytes.trim_ascii_end().chunks(WIDTH).map(<[u8]>::trim_ascii)
}

/// Splits what follows the positions of `atoms` atoms into velocities and the box.
fn split(rest: &[f64], atoms: usize) -> Option<(&[f64], &[f64])> {
    let velocities = 3 * atoms;
    match rest.len() {
        // Of one or two atoms a box can't be told from velocities; restart files of them have a box.
        0 | 3 | 6 => Some((&[], rest)),
        own if own == velocities => Some((rest, &[])),
        own if own == velocities + 3 || own == velocities + 6 => Some(rest.split_at(velocities)),
        _ => None,
    }
}

impl FrameReader for Restart {
    fn next(&mut self) -> Result<Option<ParticleFrame>, FileError> {
        if std::mem::replace(&mut self.done, true) {
            return Ok(None);
        }
        let title = self.lines.require("its title")?.text().trim().to_owned();
        let line = self.lines.require("the number of atoms")?;
        let mut head = line.fields();
        let atoms = line.whole_number(head.next().unwrap_or_default())?;
        let time = head.next().map(|time| line.number(time)).transpose()?;
        let mut positions = Vec::new();
        let mut rest = Vec::new();
        while let Some(line) = self.lines.next()? {
            for field in fields(&line) {
                let value = line.number(field)?;
                let is_position = (positions.len() as u64) < atoms.saturating_mul(3);
                if is_position { positions.push(value) } else { rest.push(value) }
            }
        }
        if (positions.len() as u64) < atoms.saturating_mul(3) {
            let read = positions.len() / 3;
            let message = format!("the file ends after {read} of {atoms} atoms");
            return Err(self.lines.ended(message).with_help("the file is cut off"));
        }
        let Some((velocities, edges)) = split(&rest, atoms as usize) else {
            let message = format!(
                "{} numbers follow the positions, which are neither velocities nor a box",
                rest.len()
            );
            return Err(self
                .lines
                .ended(message)
                .with_help("the file is cut off, or has other columns"));
        };
        let mut names = ["x", "y", "z"].to_vec();
        if !velocities.is_empty() {
            names.extend(["vx", "vy", "vz"]);
        }
        let schema = Schema::new(names.into_iter().map(str::to_owned).collect(), &self.options);
        let schema = Arc::new(schema.map_err(|message| self.lines.ended(message))?);
        let mut builder = Builder::new(self.lines.path(), Format::Restart, &schema);
        let slot = |column: usize| schema.slots.get(column).copied().unwrap_or(Slot::Skip);
        for (atom, position) in positions.chunks_exact(3).enumerate() {
            position.iter().enumerate().for_each(|(axis, &at)| builder.put_number(slot(axis), at));
            let velocity = velocities.get(3 * atom..).unwrap_or_default().iter().take(3);
            for (axis, &value) in velocity.enumerate() {
                builder.put_number(slot(3 + axis), value * PER_PICOSECOND);
            }
            builder.end_row()?;
        }
        let cell = match *edges {
            [a, b, c] => Cell::of_lengths([a, b, c], [90.0; 3]),
            [a, b, c, alpha, beta, gamma] => Cell::of_lengths([a, b, c], [alpha, beta, gamma]),
            _ => None,
        };
        let frame = builder.finish();
        let unit = LengthUnit::Angstrom;
        Ok(Some(ParticleFrame { cell, title, time, unit, ..frame }))
    }
}

/// Returns whether a file with this head is a restart file: a number of atoms below the title, and then numbers with
/// seven decimals in columns of twelve.
pub(in super::super) fn is_restart(head: &[u8]) -> bool {
    let mut lines = head.split(|&byte| byte == b'\n').map(<[u8]>::trim_ascii_end);
    let (Some(title), Some(counts), Some(row)) = (lines.next(), lines.next(), lines.next()) else {
        return false;
    };
    let mut counts = Fields::blanks(counts);
    let Some(atoms) = counts.next().and_then(number::whole) else { return false };
    let is_time = counts.next().is_none_or(|time| number::parse(time).is_some());
    let numbers = (atoms as usize).saturating_mul(3).min(PER_LINE);
    let is_fixed = |field: &[u8]| {
        field.len() == WIDTH
            && field[WIDTH - 8] == b'.'
            && number::parse(field.trim_ascii()).is_some()
    };
    // XYZ begins with a number.
    number::whole(title).is_none()
        && numbers > 0
        && is_time
        && counts.next().is_none()
        && row.len() == numbers * WIDTH
        && row.chunks(WIDTH).all(is_fixed)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_after_positions_are_velocities_and_a_box() {
        let numbers: Vec<f64> = (0..15).map(f64::from).collect();
        for (count, velocities, edges) in
            [(0, 0, 0), (3, 0, 3), (6, 0, 6), (9, 9, 0), (12, 9, 3), (15, 9, 6)]
        {
            let (own, rest) = split(&numbers[..count], 3).expect("a layout");
            assert_eq!((own.len(), rest.len()), (velocities, edges));
        }
        assert!(split(&numbers[..10], 3).is_none());
    }

    #[test]
    fn columns_of_twelve_tell_the_format() {
        let row = "   1.1234567-100.1234567   3.0000000";
        assert!(is_restart(format!("title\n    1\n{row}\n").as_bytes()));
        assert!(is_restart(format!("\n    2  0.5E+01\n{row}{row}\n").as_bytes()));
        for other in [
            format!("a\n2\n{row}\n"),
            format!("a\n1 b\n{row}\n"),
            format!("1\n1\n{row}\n"),
            "a\n1\nC 1.0 2.0 3.0\n".to_owned(),
        ] {
            assert!(!is_restart(other.as_bytes()), "{other}");
        }
    }
}
