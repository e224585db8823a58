//! What a frame of a file of particles holds, in columns.

use super::categories::{Kinds, TextColumn, pick};
use super::options::{Format, Role};
use crate::scene::Rgb;
use crate::scene::spheres::retain;
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
    /// What a length of 1 is.
    pub unit: LengthUnit,
    /// How the file is written.
    pub format: Format,
    /// What was assumed or passed over: one sentence each.
    pub warnings: Vec<String>,
}

/// A column of numbers.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct NumberColumn {
    /// What the file calls it.
    pub name: String,
    /// One for each particle; NaN where the file has none.
    pub values: Vec<f64>,
}

/// The cell of a simulation: a parallelepiped.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cell {
    /// The corner that the vectors begin at.
    pub origin: DVec3,
    /// The edges a, b and c.
    pub vectors: [DVec3; 3],
    /// Whether the simulation repeats along each edge.
    pub periodic: [bool; 3],
}

impl Cell {
    /// The place of a point whose coordinates are shares of the edges.
    pub fn point(&self, shares: [f64; 3]) -> DVec3 {
        let [a, b, c] = self.vectors;
        self.origin + a * shares[0] + b * shares[1] + c * shares[2]
    }

    /// A cell of edges `a`, `b` and `c` long with angles in degrees between them, the first edge
    /// along x and the second in the plane of x and y, as crystallography has it; `None` if there
    /// is no such cell.
    pub(super) fn of_lengths(lengths: [f64; 3], angles: [f64; 3]) -> Option<Self> {
        let [a, b, c] = lengths;
        // Right angles exactly.
        let cosine = |angle: f64| if angle == 90.0 { 0.0 } else { angle.to_radians().cos() };
        let [alpha, beta, gamma] = angles.map(cosine);
        let sine = (1.0 - gamma * gamma).sqrt();
        let tilt = (alpha - beta * gamma) / sine;
        let height = (1.0 - beta * beta - tilt * tilt).sqrt();
        let vectors = [
            DVec3::new(a, 0.0, 0.0),
            DVec3::new(b * gamma, b * sine, 0.0),
            DVec3::new(c * beta, c * tilt, c * height),
        ];
        let cell = Self { origin: DVec3::ZERO, vectors, periodic: [true; 3] };
        cell.checked()
    }

    /// The cell, if it is finite and has a volume.
    pub(super) fn checked(self) -> Option<Self> {
        let [a, b, c] = self.vectors;
        let finite = [a, b, c, self.origin].iter().all(|vector| vector.is_finite());
        (finite && a.cross(b).dot(c) != 0.0).then_some(self)
    }
}

/// What a length of 1 is in a file.
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

    /// What it is called.
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

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.x.is_empty()
    }

    /// Position of particle `row`, which is less than [`ParticleFrame::len`].
    pub fn position(&self, row: usize) -> DVec3 {
        DVec3::new(self.x[row], self.y[row], self.z[row])
    }

    /// Keeps the rows that `keep` is true for.
    pub(super) fn retain(&mut self, keep: &[bool]) {
        let values = self.numbers.iter_mut().map(|column| &mut column.values);
        let columns = [&mut self.x, &mut self.y, &mut self.z, &mut self.radius];
        columns.into_iter().chain(values).for_each(|column| retain(column, keep));
        retain(&mut self.color, keep);
        let texts = self.texts.iter_mut().chain([&mut self.materials]);
        let codes = texts.map(|column| &mut column.codes).chain([&mut self.kinds.codes]);
        codes.for_each(|codes| codes.retain(keep));
    }

    /// Has row `rows[i]` in the place of row `i`, for each of `rows`.
    pub(super) fn pick(&mut self, rows: &[u32]) {
        let values = self.numbers.iter_mut().map(|column| &mut column.values);
        let columns = [&mut self.x, &mut self.y, &mut self.z, &mut self.radius];
        columns.into_iter().chain(values).for_each(|column| pick(column, rows));
        pick(&mut self.color, rows);
        let texts = self.texts.iter_mut().chain([&mut self.materials]);
        let codes = texts.map(|column| &mut column.codes).chain([&mut self.kinds.codes]);
        codes.for_each(|codes| codes.pick(rows));
    }

    /// Gives back the memory that columns have beyond their rows.
    pub(super) fn shrink(&mut self) {
        let values = self.numbers.iter_mut().map(|column| &mut column.values);
        let columns = [&mut self.x, &mut self.y, &mut self.z, &mut self.radius];
        columns.into_iter().chain(values).for_each(Vec::shrink_to_fit);
        self.color.shrink_to_fit();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_of_lengths_and_angles_have_them() {
        let cell = Cell::of_lengths([2.0, 3.0, 4.0], [80.0, 95.0, 120.0]).expect("a cell");
        let [a, b, c] = cell.vectors;
        for (first, second, angle) in [(b, c, 80.0_f64), (a, c, 95.0), (a, b, 120.0)] {
            assert!((first.angle_between(second).to_degrees() - angle).abs() < 1e-12, "{angle}");
        }
        assert!((b.length() - 3.0).abs() < 1e-14 && (c.length() - 4.0).abs() < 1e-14);
        let box_shaped = Cell::of_lengths([2.0, 3.0, 4.0], [90.0; 3]).expect("a cell");
        assert_eq!(box_shaped.vectors, [DVec3::X * 2.0, DVec3::Y * 3.0, DVec3::Z * 4.0]);
        assert_eq!(box_shaped.point([0.5, 1.0, 0.25]), DVec3::new(1.0, 3.0, 1.0));
        for (lengths, angles) in [
            ([0.0, 1.0, 1.0], [90.0; 3]),
            ([1.0; 3], [0.0; 3]),
            ([1.0; 3], [150.0, 150.0, 150.0]),
            ([f64::NAN, 1.0, 1.0], [90.0; 3]),
        ] {
            assert_eq!(Cell::of_lengths(lengths, angles), None, "{lengths:?} {angles:?}");
        }
    }
}
