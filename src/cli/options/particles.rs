//! Options for reading particle files.

use super::frames::{FrameArg, FrameRange};
use super::lists::{self, List};
use super::values;
use super::with_text::{self, WithText};
use crate::cli::failure::Failure;
use spherule_render::scene::particles::{
    Columns, Format, FrameChoice, Radii, ReadOptions, Selection, accept_radii_expression,
};
use std::ffi::OsStr;
use std::path::{Path, PathBuf};

/// Options for reading a particle file.
#[derive(Clone, Debug, Default, clap::Args)]
#[command(next_help_heading = "Particle files")]
pub(in crate::cli) struct ParticleArgs {
    /// File format [default: detected]: xyzr, csv, xyz, lammps-dump, lammps-data, gro, pdb, mmcif, cif, gsd,
    /// ply, npy, npz, dcd, xtc, trr, netcdf, hdf5, pqr, poscar, sdf, mol2, xsf, cfg,
    /// psf, prmtop, rst7, ase, bcif or namd
    #[arg(long, value_parser = |name: &str| values::named(&Format::ALL, name, "formats are"))]
    format: Option<Format>,
    /// Meaning of columns, as in x=px,radius=size,type=species
    #[arg(long, value_name = "ROLE=NAME,...", value_parser = |text: &str| text.parse::<WithText<Columns>>())]
    columns: Option<WithText<Columns>>,
    /// Trajectory frame: first, last or a number from 0; or a range, all, A-B or A..B..STEP, which renders a
    /// numbered image of each frame, with one camera that frames all of them
    #[arg(long, value_name = "N|first|last|all|A-B", value_parser = |text: &str| text.parse::<WithText<FrameArg>>())]
    frame: Option<WithText<FrameArg>>,
    /// Radii: vdw, covalent or ionic by element, a column of the file or an expression, as in 'column:0.3*mass^(1/3)',
    /// or one radius for all
    #[arg(long, value_name = "vdw|covalent|ionic|column:EXPR|R", value_parser = |text: &str| text.parse::<WithText<Radii>>())]
    radii: Option<WithText<Radii>>,
    /// Scale factor for all radii
    #[arg(long, value_name = "FACTOR", value_parser = values::positive)]
    radius_scale: Option<f64>,
    /// Atom style of a LAMMPS data file that does not name it, as in full or "hybrid sphere dipole"
    #[arg(long, value_name = "STYLE")]
    atom_style: Option<String>,
    /// File that names the particles of a trajectory: their types, elements, residues, radii and other columns
    #[arg(long, value_name = "FILE")]
    topology: Option<PathBuf>,
    /// Make molecules whole that the periodic cell divides: by the file's bonds, or by distance
    #[arg(long)]
    whole: bool,
    /// Superpose every frame on the first one by translation and rotation, by the particles of a selection, as in
    /// --align='name CA'; without one, by all. The first frame of the file is read, too
    #[arg(
        long,
        value_name = "EXPR",
        num_args = 0..=1,
        require_equals = true,
        default_missing_value = "all",
        value_parser = |text: &str| text.parse::<WithText<Selection>>()
    )]
    align: Option<WithText<Selection>>,
    /// Average the positions of each frame with those of N frames before and N after it, as far as there are any
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1000))]
    smooth: Option<u32>,
    /// Draw where each particle was in the N frames before, as far as there are any, as thin sticks of its color
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1000))]
    trail: Option<u32>,
}

impl ParticleArgs {
    /// Converts the options for the reader.
    pub(in crate::cli) fn options(&self) -> ReadOptions {
        let mut options = ReadOptions {
            format: self.format,
            columns: self.columns.as_deref().cloned().unwrap_or_default(),
            frame: self
                .frame
                .as_deref()
                .copied()
                .map_or_else(FrameChoice::default, FrameArg::first),
            radii: self.radii.as_deref().cloned().unwrap_or_default(),
            radius_scale: self.radius_scale.unwrap_or(1.0),
            atom_style: self.atom_style.clone(),
            topology: self.topology.clone(),
            whole: self.whole,
            align: self.align.as_deref().map(Selection::align_by),
            smooth: self.smooth.unwrap_or(0),
            trail: self.trail.unwrap_or(0),
            ..ReadOptions::default()
        };
        accept_radii_expression(&mut options);
        options
    }

    /// Returns whether any option was given.
    pub(in crate::cli) fn any(&self) -> bool {
        self.frames().is_some() || self.options() != ReadOptions::default()
    }

    /// The file that names the particles of a trajectory.
    pub(in crate::cli) fn topology(&self) -> Option<&Path> {
        self.topology.as_deref()
    }

    /// The range of frames, if several are rendered.
    pub(in crate::cli) fn frames(&self) -> Option<FrameRange> {
        self.frame.as_deref().copied().and_then(FrameArg::range)
    }

    /// Settings for the image's metadata; `frame` is the frame of a sequence that the image shows.
    pub(in crate::cli) fn list(&self, frame: Option<u64>) -> List {
        let mut list = List::new();
        lists::put(&mut list, "format", self.format.map(Format::name));
        with_text::insert(&mut list, "columns", &self.columns);
        match frame {
            Some(_) => lists::put(&mut list, "frame", frame),
            None => with_text::insert(&mut list, "frame", &self.frame),
        }
        with_text::insert(&mut list, "radii", &self.radii);
        lists::put(&mut list, "radius_scale", self.radius_scale);
        lists::put(&mut list, "atom_style", self.atom_style.as_deref());
        // Without folders, which are private.
        let name = self.topology.as_deref().and_then(Path::file_name);
        lists::put(&mut list, "topology", name.map(OsStr::to_string_lossy));
        lists::put(&mut list, "whole", self.whole.then_some(true));
        with_text::insert(&mut list, "align", &self.align);
        lists::put(&mut list, "smooth", self.smooth);
        lists::put(&mut list, "trail", self.trail);
        list
    }

    /// Rejects a range of frames.
    pub(in crate::cli) fn refuse_frames(&self, command: &str) -> Result<(), Failure> {
        if self.frames().is_some() {
            let message = "--frame takes one frame here: first, last or a number from 0";
            return Err(Failure::usage(command, message));
        }
        Ok(())
    }
}
