//! Readers of particle files: they return frames, each with its columns and periodic cell.
//!
//! ```text
//! file or standard input -> decompressed, by magic number               source
//!    -> format, detected from the first bytes                           sniff
//!    -> lines -> fields -> roles, by column names                       lines, fields, schema
//!    -> one ParticleFrame per frame, in columns, in the file's units    one file per format
//! ```
//!
//! XYZ and extended XYZ, LAMMPS dumps and data files, GRO, PDB, mmCIF, CIF of crystals with their
//! symmetry, GSD, PLY, NPY and NPZ, tables and plain columns are recognized by their content, and so are the
//! trajectories DCD, XTC, TRR, NetCDF and restart files of Amber, whose particles a topology names, POSCAR, XDATCAR,
//! PQR, SDF, MOL2, XSF, CFG, BinaryCIF, coordinates of NAMD, trajectories of ASE, and HDF5 of H5MD, mdtraj and Gadget; topologies are
//! PSF, those of Amber, or any other file. Files may be compressed with gzip, bzip2, xz or zstd.
//!
//! Every reader streams: it stores columns, never the file, and doesn't allocate by counts in the file.
//! A malformed number is an error with its line. To add a format, add it to [`Format`], its detection to
//! `sniff`, and a `FrameReader`.
//!
//! ```
//! use spherule_particles::{ReadOptions, read_frame};
//!
//! let folder = tempfile::tempdir()?;
//! let path = folder.path().join("water.xyz");
//! std::fs::write(&path, "3\nwater\nO 0 0 0\nH 0.96 0 0\nH -0.24 0.93 0\n")?;
//! let frame = read_frame(&path, &ReadOptions::default())?;
//! assert_eq!((frame.len(), frame.x[1]), (3, 0.96));
//! assert_eq!(frame.kinds.kind(0).and_then(|kind| kind.element).map(|e| e.symbol()), Some("O"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

#![forbid(unsafe_code)]
#![cfg_attr(test, allow(clippy::disallowed_methods, reason = "tests compare with tolerances"))]

mod aliases;
mod alternates;
mod amber;
mod arrays;
mod ase;
mod binary;
pub mod bonds;
mod builder;
mod categories;
mod cell;
mod cfg;
mod cif;
mod csv;
mod dcd;
mod derived;
mod element;
mod error;
mod extra;
mod fields;
mod foreign;
mod format;
mod formats;
mod frame;
mod frame_reader;
mod gro;
mod gromacs;
mod gsd;
mod hdf5;
mod header;
mod ids;
pub mod images;
mod lammps;
mod line;
mod lines;
mod memory;
mod mesh;
mod mol2;
mod molfile;
mod namd;
mod naming;
pub mod neighbors;
mod netcdf;
mod number;
mod numpy;
mod open_file;
mod options;
mod pdb;
mod place;
mod ply;
mod poscar;
mod pqr;
mod progress;
mod psf;
mod reader;
mod record;
mod role;
mod scalar;
mod schema;
mod shapes;
mod shared_names;
mod smoothing;
mod sniff;
mod source;
mod srgb;
mod suggest;
mod superposition;
mod text;
mod topology;
mod trails;
mod undrawn;
mod units;
mod unplaced;
mod utf16;
mod xsf;
mod xyz;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

pub use bonds::{BondRules, BondSource, Bonds, Molecule};
pub use categories::{Codes, ElementSource, Kind, Kinds, TextColumn};
pub use cell::Cell;
pub use element::Element;
pub use error::{FileError, Place};
pub use format::Format;
pub use frame::{LengthUnit, NumberColumn, ParticleFrame, Shapes, Trails};
pub use open_file::OpenFile;
pub use options::{Columns, FrameChoice, Radii, ReadOptions};
pub use progress::ReadProgress;
pub use reader::{FrameCount, Frames, count_frames, read_frame, read_frame_after};
pub use role::Role;
pub use shared_names::SharedNames;
pub use superposition::AlignBy;

/// A linear RGB triple with the primaries of sRGB.
pub type Rgb = glam::Vec3;

/// Maximum number of particles in a frame: the last few 32-bit indices are reserved.
pub const MAX_PARTICLES: u64 = (1 << 32) - 17;

/// Items for the renderer. Anything here may change in any release.
#[doc(hidden)]
pub mod internals {
    /// Column names that are synonyms.
    pub mod aliases {
        pub use crate::aliases::*;
    }
    pub use crate::bonds::{PairRule, nearest_image};
    pub use crate::categories::retain;
    pub use crate::error::{clipped, listed};
    pub use crate::mesh::{Mesh, read_mesh};
    /// Available memory.
    pub mod memory {
        pub use crate::memory::*;
    }
    pub use crate::schema::unknown_column;
    pub use crate::srgb::{linear_from_srgb, srgb};
    pub use crate::xyz::pairs;
    /// Suggestions for misspelled words.
    pub mod suggest {
        pub use crate::suggest::*;
    }
}
