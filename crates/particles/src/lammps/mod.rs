//! Readers of LAMMPS files: dumps and data files.

mod bounds;
mod data;
mod dump;
mod style;
mod velocities;
mod yaml;

pub(super) use data::Data;
pub(super) use dump::Dump;

use crate::{LengthUnit, undrawn::Undrawn};

/// Returns the kind of object that a section of a data file lists, if it is not drawn.
fn undrawn(section: &str) -> Option<Undrawn> {
    match section {
        "Ellipsoids" | "Lines" | "Triangles" | "Bodies" => Some(Undrawn::Shapes),
        _ => None,
    }
}

/// Returns the unit of length of a LAMMPS unit style.
fn unit(units: &str) -> LengthUnit {
    match units {
        "real" | "metal" => LengthUnit::Angstrom,
        "electron" => LengthUnit::Bohr,
        "si" => LengthUnit::Meter,
        "cgs" => LengthUnit::Centimeter,
        "micro" => LengthUnit::Micrometer,
        "nano" => LengthUnit::Nanometer,
        _ => LengthUnit::Unknown,
    }
}
