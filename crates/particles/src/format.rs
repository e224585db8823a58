//! Formats of particle files, and their names.

/// Format of a particle file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Format {
    /// A row `x y z` or `x y z radius` for each particle, optionally after an id; numbers are
    /// separated by blanks, commas or semicolons, and `#` begins a comment.
    #[default]
    Xyzr,
    /// A header that names columns, and a row for each particle, separated by commas, semicolons or
    /// tabs.
    Csv,
    /// XYZ of chemistry: the number of atoms, a comment, and a row `symbol x y z` for each atom.
    /// With `Lattice` and `Properties` in the comment, it is extended XYZ.
    Xyz,
    /// A LAMMPS dump in text.
    LammpsDump,
    /// A LAMMPS data file.
    LammpsData,
    /// GRO of GROMACS.
    Gro,
    /// PDB.
    Pdb,
    /// mmCIF of the Protein Data Bank.
    MmCif,
    /// CIF of a crystal: the atoms of the asymmetric unit in fractional coordinates, and the symmetry.
    Cif,
    /// GSD of HOOMD-blue.
    Gsd,
    /// PLY point clouds, in text or binary.
    Ply,
    /// A NumPy array: rows `x y z` or `x y z radius`, or of a structured type.
    Npy,
    /// NumPy arrays in an archive: positions, radii, colors.
    Npz,
    /// A DCD trajectory of CHARMM, NAMD, OpenMM or LAMMPS.
    Dcd,
    /// A compressed XTC trajectory of GROMACS.
    Xtc,
    /// A TRR trajectory of GROMACS.
    Trr,
    /// A NetCDF trajectory of Amber.
    NetCdf,
    /// HDF5: an H5MD trajectory, one of mdtraj, NetCDF 4 of Amber, or a snapshot of Gadget.
    Hdf5,
    /// PQR: PDB with charges and radii.
    Pqr,
    /// POSCAR, CONTCAR or XDATCAR of VASP.
    Poscar,
    /// MDL molfiles and SDF.
    Sdf,
    /// MOL2 of Tripos.
    Mol2,
    /// XSF of XCrySDen.
    Xsf,
    /// CFG of AtomEye.
    Cfg,
    /// PSF of CHARMM and NAMD: a topology, without positions.
    Psf,
    /// `prmtop` or `parm7` of AMBER: a topology, without positions.
    Prmtop,
    /// `rst7` or `inpcrd` of AMBER: a restart file in text.
    Restart,
    /// A trajectory of ASE.
    AseTrajectory,
    /// BinaryCIF: mmCIF in MessagePack.
    BinaryCif,
    /// Binary coordinates of NAMD.
    Namd,
}

impl Format {
    /// All formats with their names in scene files and on the command line.
    pub const ALL: [(&'static str, Self); 30] = [
        ("xyzr", Self::Xyzr),
        ("csv", Self::Csv),
        ("xyz", Self::Xyz),
        ("lammps-dump", Self::LammpsDump),
        ("lammps-data", Self::LammpsData),
        ("gro", Self::Gro),
        ("pdb", Self::Pdb),
        ("mmcif", Self::MmCif),
        ("cif", Self::Cif),
        ("gsd", Self::Gsd),
        ("ply", Self::Ply),
        ("npy", Self::Npy),
        ("npz", Self::Npz),
        ("dcd", Self::Dcd),
        ("xtc", Self::Xtc),
        ("trr", Self::Trr),
        ("netcdf", Self::NetCdf),
        ("hdf5", Self::Hdf5),
        ("pqr", Self::Pqr),
        ("poscar", Self::Poscar),
        ("sdf", Self::Sdf),
        ("mol2", Self::Mol2),
        ("xsf", Self::Xsf),
        ("cfg", Self::Cfg),
        ("psf", Self::Psf),
        ("prmtop", Self::Prmtop),
        ("rst7", Self::Restart),
        ("ase", Self::AseTrajectory),
        ("bcif", Self::BinaryCif),
        ("namd", Self::Namd),
    ];

    /// Returns whether files of this format have positions alone, and a topology tells what they are of.
    pub(crate) fn lacks_names(self) -> bool {
        matches!(
            self,
            Self::Dcd
                | Self::Xtc
                | Self::Trr
                | Self::NetCdf
                | Self::Hdf5
                | Self::Restart
                | Self::Namd
        )
    }

    /// Returns whether positions of this format are in places of their own, which `--columns` cannot change.
    pub(crate) fn fixes_positions(self) -> bool {
        matches!(
            self,
            Self::Gro | Self::Pdb | Self::Poscar | Self::Cfg | Self::Dcd | Self::Xtc | Self::Gsd
        )
    }

    /// Returns whether files of this format hold single molecules, which have no direction of their own.
    pub fn has_molecules(self) -> bool {
        matches!(
            self,
            Self::Pdb | Self::MmCif | Self::BinaryCif | Self::Pqr | Self::Sdf | Self::Mol2
        )
    }

    /// Returns whether files of this format are topologies, which lack positions.
    pub(crate) fn lacks_positions(self) -> bool {
        matches!(self, Self::Psf | Self::Prmtop)
    }

    /// Returns the name in scene files and on the command line.
    pub fn name(self) -> &'static str {
        Self::ALL.iter().find(|(_, format)| *format == self).map_or("", |(name, _)| name)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_format_has_its_name() {
        for (name, format) in Format::ALL {
            assert_eq!(format.name(), name);
        }
    }
}
