//! A frame of particles, in columns.

use super::categories::{Kinds, TextColumn, pick};
use super::options::{Format, Role};
use crate::Rgb;
use crate::categories::retain;
use crate::cell::Cell;
use glam::DVec3;

/// The particles of one frame, and what the file says of them all. Row `i` of every column belongs
/// to particle `i`; numbers are in the file's own units, and nothing is dropped.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ParticleFrame {
    /// Positions, x.
    pub x: Vec<f64>,
    /// Positions, y.
    pub y: Vec<f64>,
    /// Positions, z.
    pub z: Vec<f64>,
    /// Radii, also of files that have diameters; empty if the file has neither.
    pub radius: Vec<f64>,
    /// Types, with elements where they are known.
    pub kinds: Kinds,
    /// Linear colors, each channel 0 to 1; empty if the file has none.
    pub color: Vec<Rgb>,
    /// Names of materials; no codes if the file has none. An empty name stands for no material.
    pub materials: TextColumn,
    /// The columns of numbers that were asked for, and are no role.
    pub numbers: Vec<NumberColumn>,
    /// The columns of texts that were asked for, and are no role.
    pub texts: Vec<TextColumn>,
    /// Names of all columns of the file that can be asked for, read or not.
    pub columns: Vec<String>,
    /// The columns that positions, radii, types, colors and materials were read from.
    pub roles: Vec<(Role, String)>,
    /// The cell of the simulation, if the file has one.
    pub cell: Option<Cell>,
    /// The file's title or comment; empty if it has none.
    pub title: String,
    /// The step of the simulation, if the file tells it.
    pub step: Option<i64>,
    /// The time of the simulation in the file's own unit, if the file tells it.
    pub time: Option<f64>,
    /// Unit of lengths.
    pub unit: LengthUnit,
    /// Format of the file.
    pub format: Format,
    /// Assumptions and omissions: one sentence each.
    pub warnings: Vec<String>,
}

/// A column of numbers.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct NumberColumn {
    /// The name in the file.
    pub name: String,
    /// One for each particle; NaN where the file has none.
    pub values: Vec<f64>,
}

/// Unit of lengths in a file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LengthUnit {
    /// The file does not say, or lengths are reduced.
    #[default]
    Unknown,
    /// 1e-10 m.
    Angstrom,
    /// 1e-9 m.
    Nanometer,
    /// 0.529 177 angstrom.
    Bohr,
    /// 1e-6 m.
    Micrometer,
    /// 1e-2 m.
    Centimeter,
    /// 1 m.
    Meter,
}

impl LengthUnit {
    /// An angstrom in this unit; 1 where the unit is unknown.
    pub fn per_angstrom(self) -> f64 {
        match self {
            Self::Unknown | Self::Angstrom => 1.0,
            Self::Nanometer => 0.1,
            // CODATA 2022.
            Self::Bohr => 1.0 / 0.529_177_210_544,
            Self::Micrometer => 1e-4,
            Self::Centimeter => 1e-8,
            Self::Meter => 1e-10,
        }
    }

    /// The unit's name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Unknown => "unknown",
            Self::Angstrom => "angstrom",
            Self::Nanometer => "nanometer",
            Self::Bohr => "bohr",
            Self::Micrometer => "micrometer",
            Self::Centimeter => "centimeter",
            Self::Meter => "meter",
        }
    }
}

impl ParticleFrame {
    /// Number of particles.
    pub fn len(&self) -> usize {
        self.x.len()
    }

    /// Whether it has no particles.
    pub fn is_empty(&self) -> bool {
        self.x.is_empty()
    }

    /// Position of particle `row`, which is less than [`ParticleFrame::len`].
    pub fn position(&self, row: usize) -> DVec3 {
        DVec3::new(self.x[row], self.y[row], self.z[row])
    }

    /// Keeps the rows that `keep` is true for.
    pub fn retain(&mut self, keep: &[bool]) {
        let values = self.numbers.iter_mut().map(|column| &mut column.values);
        let columns = [&mut self.x, &mut self.y, &mut self.z, &mut self.radius];
        columns.into_iter().chain(values).for_each(|column| retain(column, keep));
        retain(&mut self.color, keep);
        let texts = self.texts.iter_mut().chain([&mut self.materials]);
        let codes = texts.map(|column| &mut column.codes).chain([&mut self.kinds.codes]);
        codes.for_each(|codes| codes.retain(keep));
    }

    /// Has row `rows[i]` in the place of row `i`, for each of `rows`.
    pub(crate) fn pick(&mut self, rows: &[u32]) {
        let values = self.numbers.iter_mut().map(|column| &mut column.values);
        let columns = [&mut self.x, &mut self.y, &mut self.z, &mut self.radius];
        columns.into_iter().chain(values).for_each(|column| pick(column, rows));
        pick(&mut self.color, rows);
        let texts = self.texts.iter_mut().chain([&mut self.materials]);
        let codes = texts.map(|column| &mut column.codes).chain([&mut self.kinds.codes]);
        codes.for_each(|codes| codes.pick(rows));
    }

    /// Gives back the memory that columns have beyond their rows.
    pub fn shrink(&mut self) {
        let values = self.numbers.iter_mut().map(|column| &mut column.values);
        let columns = [&mut self.x, &mut self.y, &mut self.z, &mut self.radius];
        columns.into_iter().chain(values).for_each(Vec::shrink_to_fit);
        self.color.shrink_to_fit();
    }
}
