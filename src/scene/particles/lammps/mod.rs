//! Files of LAMMPS: dumps and data files.

mod bounds;
mod data;
mod dump;
mod style;
mod velocities;

pub(super) use data::Data;
pub(super) use dump::Dump;

use super::frame::LengthUnit;

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
