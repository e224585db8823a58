//! Files of LAMMPS: dumps and data files.

mod bounds;
mod data;
mod dump;
mod style;
mod velocities;

pub(super) use data::Data;
pub(super) use dump::Dump;

use super::frame::LengthUnit;
use super::undrawn::Undrawn;

/// The things that a section of a data file lists in its rows and that are not drawn.
fn undrawn(section: &str) -> Option<Undrawn> {
    match section {
        "Bonds" => Some(Undrawn::Bonds),
        "Ellipsoids" | "Lines" | "Triangles" | "Bodies" => Some(Undrawn::Shapes),
        _ => None,
    }
}

/// The unit of length of a style of units.
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
