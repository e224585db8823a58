//! A frame of particles, in columns.

mod bonds;
mod crystal;
mod shapes;
mod trails;

pub use bonds::Bonds;
pub(crate) use bonds::{Bond, ordered};
pub use shapes::Shapes;
pub use trails::Trails;

use crate::{Cell, Format, Kinds, Rgb, Role, TextColumn, categories::RowChange};
use glam::{DMat3, DVec3};

/// The particles of one frame, with the frame's metadata. Row `i` of every column belongs to
/// particle `i`. Numbers are in the file's units, and nothing is dropped.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ParticleFrame {
    /// Positions, x.
    pub x: Vec<f64>,
    /// Positions, y.
    pub y: Vec<f64>,
    /// Positions, z.
    pub z: Vec<f64>,
    /// Radii, computed from diameters if the file has those; empty if it has neither.
    pub radius: Vec<f64>,
    /// Types, with elements where they are known.
    pub kinds: Kinds,
    /// Linear colors, each channel 0 to 1; empty if the file has none.
    pub color: Vec<Rgb>,
    /// Material names; no codes if the file has none. An empty name means no material.
    pub materials: TextColumn,
    /// Requested columns of numbers that have no role.
    pub numbers: Vec<NumberColumn>,
    /// Requested columns of texts that have no role.
    pub texts: Vec<TextColumn>,
    /// Names of all columns of the file that can be requested, whether read or not.
    pub columns: Vec<String>,
    /// Columns from which positions, radii, types, colors and materials were read.
    pub roles: Vec<(Role, String)>,
    /// Bonds, if they were asked for and there are any.
    pub bonds: Option<Bonds>,
    /// Shapes of particles that are ellipsoids; their radius is that of a sphere around them.
    pub shapes: Shapes,
    /// Earlier positions, if they were asked for and there are any.
    pub trails: Trails,
    /// The rotation of the frame since it was read, by which vectors in `numbers` have to be turned
    /// ([`ReadOptions::align`](crate::ReadOptions::align)).
    pub rotation: DMat3,
    /// The simulation cell, if the file has one.
    pub cell: Option<Cell>,
    /// The file's title or comment; empty if it has none.
    pub title: String,
    /// The simulation step, if the file has one.
    pub step: Option<i64>,
    /// The simulation time in the file's unit, if the file has one.
    pub time: Option<f64>,
    /// Unit of lengths.
    pub unit: LengthUnit,
    /// Format of the file.
    pub format: Format,
    /// Assumptions and omissions of the reader, one sentence each.
    pub warnings: Vec<String>,
}

/// A column of numbers.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct NumberColumn {
    /// The name in the file.
    pub name: String,
    /// Values of the particles; NaN where the file has none.
    pub values: Vec<f64>,
}

/// Unit of lengths in a file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LengthUnit {
    /// Unknown unit, or reduced units.
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
    /// Returns the length of an angstrom in this unit; 1 if the unit is unknown.
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

    /// Returns the unit's name.
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

    /// Returns the unit's symbol; empty if the unit is unknown.
    pub fn symbol(self) -> &'static str {
        match self {
            Self::Unknown => "",
            Self::Angstrom => "\u{c5}",
            Self::Nanometer => "nm",
            Self::Bohr => "bohr",
            Self::Micrometer => "\u{b5}m",
            Self::Centimeter => "cm",
            Self::Meter => "m",
        }
    }
}

impl ParticleFrame {
    /// Returns the number of particles.
    pub fn len(&self) -> usize {
        self.x.len()
    }

    /// Returns whether the frame has no particles.
    pub fn is_empty(&self) -> bool {
        self.x.is_empty()
    }

    /// Returns the position of particle `row`, which must be less than [`ParticleFrame::len`].
    pub fn position(&self, row: usize) -> DVec3 {
        DVec3::new(self.x[row], self.y[row], self.z[row])
    }

    /// Keeps the rows for which `keep` is true.
    pub fn retain(&mut self, keep: &[bool]) {
        self.change(RowChange::Retain(keep));
    }

    /// Gathers rows: row `i` becomes the former row `rows[i]`.
    pub(crate) fn pick(&mut self, rows: &[u32]) {
        self.change(RowChange::Pick(rows));
    }

    /// Repeats all rows, `count` times in all, but not the bonds ([`Bonds::replicate`]).
    pub fn repeat(&mut self, count: usize) {
        self.change(RowChange::Repeat(count));
    }

    /// Appends copies of rows of `count` particles, but no bonds of theirs ([`Bonds::between`]).
    pub fn append_rows(&mut self, count: usize, rows: &[u32]) {
        let bonds = self.bonds.take();
        let all: Vec<u32> = (0..count as u32).chain(rows.iter().copied()).collect();
        self.change(RowChange::Pick(&all));
        self.bonds = bonds;
    }

    /// Frees the unused capacity of columns.
    pub fn shrink(&mut self) {
        self.change(RowChange::Shrink);
    }

    /// Changes the rows of all columns.
    fn change(&mut self, change: RowChange) {
        let values = self.numbers.iter_mut().map(|column| &mut column.values);
        let columns = [&mut self.x, &mut self.y, &mut self.z, &mut self.radius];
        columns.into_iter().chain(values).for_each(|column| change.apply(column));
        change.apply(&mut self.color);
        let texts = self.texts.iter_mut().chain([&mut self.materials]);
        let codes = texts.map(|column| &mut column.codes).chain([&mut self.kinds.codes]);
        codes.for_each(|codes| codes.change(change));
        self.bonds.iter_mut().for_each(|bonds| bonds.change(change));
        self.shapes.change(change);
        self.trails.change(change);
    }
}
