//! The table of formats: what tells each, and its reader.

use crate::format::Format;
use crate::frame_reader::FrameReader;
use crate::source::Source;
use crate::{
    FileError, ReadOptions, amber, ase, cfg, cif, csv, dcd, gro, gromacs, gsd, hdf5, lammps, mol2,
    molfile, namd, netcdf, numpy, pdb, ply, poscar, pqr, psf, text, xsf, xyz,
};

/// A test of the head of a file.
pub(crate) type Test = fn(&[u8]) -> bool;

/// Opens the reader of a file.
type Open = fn(Source, &ReadOptions) -> Result<Box<dyn FrameReader>, FileError>;

/// The sign of a format.
#[derive(Clone, Copy)]
pub(crate) enum Sign {
    /// The first bytes.
    Signature(Test),
    /// The structure of the first lines, after any title.
    Structure(Test),
    /// Words and numbers of the first lines, which are weighed in `sniff.rs`.
    Words,
}

/// The row of a format.
pub(crate) struct Row {
    pub(crate) format: Format,
    pub(crate) sign: Sign,
    /// Ends of names of files after the last point, in lower case, or whole names: they tell the format if the content does not.
    pub(crate) suffixes: &'static [&'static str],
    pub(crate) open: Open,
}

/// Makes a row; the reader is an expression that may return early with an error.
macro_rules! row {
    ($format:ident, $sign:expr, |$source:ident, $options:ident| $reader:expr) => {
        row!($format, $sign, &[], |$source, $options| $reader)
    };
    ($format:ident, $sign:expr, $suffixes:expr, |$source:ident, $options:ident| $reader:expr) => {
        Row {
            format: Format::$format,
            sign: $sign,
            suffixes: $suffixes,
            open: |$source, $options| Ok(Box::new($reader)),
        }
    };
}

use Sign::{Signature, Structure, Words};

/// All formats.
pub(crate) const ROWS: [Row; 30] = [
    row!(Xyzr, Words, &["xyzr"], |source, options| text::Rows::new(source, options)),
    row!(Csv, Words, &["csv", "tsv"], |source, options| csv::Csv::new(source, options)),
    row!(Xyz, Words, &["xyz", "extxyz"], |source, options| xyz::Xyz::new(source, options)),
    row!(LammpsDump, Words, &["dump", "lammpstrj"], |source, options| lammps::Dump::new(
        source, options
    )),
    row!(LammpsData, Words, &["data", "lmp", "lammps"], |source, options| lammps::Data::new(
        source, options
    )),
    row!(Gro, Words, &["gro"], |source, options| gro::Gro::new(source, options)),
    row!(Pdb, Words, &["pdb", "ent"], |source, options| pdb::Pdb::new(source, options)),
    row!(MmCif, Words, &["mmcif"], |source, options| cif::MmCif::new(
        Format::MmCif,
        source,
        options
    )),
    row!(Cif, Words, &["cif"], |source, options| cif::Crystal::new(source, options)),
    row!(Gsd, Signature(|head| head.starts_with(&gsd::MAGIC)), |source, options| {
        gsd::Gsd::new(source, options)?
    }),
    row!(Ply, Signature(ply::is_ply), |source, options| ply::Ply::new(source, options)),
    row!(Npy, Signature(|head| head.starts_with(numpy::MAGIC)), |source, options| {
        numpy::Npy::new(source, options)?
    }),
    row!(
        Npz,
        Signature(|head| head.starts_with(b"PK\x03\x04") || head.starts_with(b"PK\x05\x06")),
        |source, options| numpy::Npz::new(source, options)?
    ),
    row!(Dcd, Signature(dcd::is_dcd), |source, options| dcd::Dcd::new(source, options)?),
    row!(Xtc, Signature(gromacs::is_xtc), |source, options| gromacs::Xtc::new(source, options)?),
    row!(Trr, Signature(gromacs::is_trr), |source, options| gromacs::Trr::new(source, options)?),
    row!(NetCdf, Signature(netcdf::is_netcdf), |source, options| netcdf::NetCdf::new(
        source, options
    )?),
    row!(Hdf5, Signature(|head| head.starts_with(hdf5::MAGIC)), |source, options| {
        hdf5::Hdf5::new(source, options)?
    }),
    row!(Pqr, Words, &["pqr"], |source, options| pqr::Pqr::new(source, options)),
    row!(
        Poscar,
        Structure(poscar::is_poscar),
        &["poscar", "contcar", "xdatcar", "vasp"],
        |source, options| poscar::Poscar::new(source, options)
    ),
    row!(Sdf, Structure(molfile::is_molfile), &["sdf", "mol"], |source, options| {
        molfile::Molfile::new(source, options)
    }),
    row!(Mol2, Structure(mol2::is_mol2), &["mol2"], |source, options| mol2::Mol2::new(
        source, options
    )),
    row!(Xsf, Structure(xsf::is_xsf), &["xsf", "axsf"], |source, options| xsf::Xsf::new(
        source, options
    )),
    row!(Cfg, Structure(cfg::is_cfg), &["cfg"], |source, options| cfg::Cfg::new(source, options)),
    row!(Psf, Structure(psf::is_psf), &["psf"], |source, options| psf::Psf::new(source, options)),
    row!(Prmtop, Structure(amber::is_prmtop), &["prmtop", "parm7"], |source, options| {
        amber::Prmtop::new(source, options)
    }),
    row!(Restart, Structure(amber::is_restart), &["rst7", "inpcrd"], |source, options| {
        amber::Restart::new(source, options)
    }),
    row!(AseTrajectory, Signature(ase::is_trajectory), &[], |source, options| {
        ase::Trajectory::new(source, options)?
    }),
    row!(BinaryCif, Signature(cif::is_binary), &[], |source, options| cif::MmCif::new(
        Format::BinaryCif,
        cif::decoded(source)?,
        options
    )),
    // Last, since its sign is the vaguest.
    row!(Namd, Signature(namd::is_coordinates), |source, options| namd::Coordinates::new(
        source, options
    )?),
];

/// Returns the row of a format.
pub(crate) fn row(format: Format) -> Row {
    let [first, ..] = ROWS;
    ROWS.into_iter().find(|row| row.format == format).unwrap_or(first)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_format_has_a_row() {
        for (name, format) in Format::ALL {
            assert_eq!(row(format).format, format, "{name}");
        }
        assert_eq!(ROWS.len(), Format::ALL.len());
    }
}
