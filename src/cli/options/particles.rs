//! Options for reading particle files, and a summary of their contents.

use super::frames::{FrameArg, FrameRange};
use super::lists::{self, List};
use super::values;
use super::with_text::{self, WithText};
use crate::cli::failure::Failure;
use crate::cli::info::rows::RowInfo;
use crate::cli::output;
use indicatif::HumanCount;
use serde::Serialize;
use spherule_render::scene::particles::{
    Columns, Element, Format, FrameChoice, LengthUnit, Orientation, Particles, Radii, ReadOptions,
    Selection, count_frames,
};
use std::ffi::OsStr;
use std::path::{Path, PathBuf};

/// Options for reading a particle file.
#[derive(Clone, Debug, Default, clap::Args)]
#[command(next_help_heading = "Particle files")]
pub(in crate::cli) struct ParticleArgs {
    /// File format [default: detected]: xyzr, csv, xyz, lammps-dump, lammps-data, gro, pdb, mmcif, cif, gsd,
    /// ply, npy, npz, dcd, xtc, trr, netcdf, hdf5, pqr, poscar, sdf, mol2, xsf, cfg
    /// or psf
    #[arg(long, value_parser = |name: &str| values::named(&Format::ALL, name, "formats are"))]
    format: Option<Format>,
    /// Meaning of columns, as in x=px,radius=size,type=species
    #[arg(long, value_name = "ROLE=NAME,...", value_parser = |text: &str| text.parse::<WithText<Columns>>())]
    columns: Option<WithText<Columns>>,
    /// Trajectory frame: first, last or a number from 0; or a range, all, A-B or A..B..STEP, which renders a
    /// numbered image of each frame, with one camera that frames all of them
    #[arg(long, value_name = "N|first|last|all|A-B", value_parser = |text: &str| text.parse::<WithText<FrameArg>>())]
    frame: Option<WithText<FrameArg>>,
    /// Radii: vdw or covalent by element, a column of the file, or one radius for all
    #[arg(long, value_name = "vdw|covalent|column:NAME|R", value_parser = |text: &str| text.parse::<WithText<Radii>>())]
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
        ReadOptions {
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
        }
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

/// Contents of a particle file, with lengths in its own unit.
#[derive(Serialize)]
pub(in crate::cli) struct ParticleInfo {
    format: &'static str,
    title: String,
    /// Null if they cannot be counted.
    frames: Option<u64>,
    step: Option<i64>,
    time: Option<f64>,
    unit: Option<&'static str>,
    columns: Vec<String>,
    types: Vec<TypeInfo>,
    /// Null if the file has none.
    cell: Option<CellInfo>,
    /// The direction that is up in the image.
    up: UpInfo,
    /// Null if they are not asked for.
    pub(in crate::cli) rows: Option<RowInfo>,
}

#[derive(Serialize)]
struct TypeInfo {
    name: String,
    element: Option<&'static str>,
    spheres: u64,
}

#[derive(Serialize)]
struct UpInfo {
    axis: &'static str,
    reason: String,
}

#[derive(Serialize)]
struct CellInfo {
    origin: [f64; 3],
    vectors: [[f64; 3]; 3],
    periodic: [bool; 3],
}

/// Maximum number of types that are listed.
const SHOWN: usize = 12;

impl ParticleInfo {
    pub(in crate::cli) fn new(path: &Path, options: &ReadOptions, particles: &Particles) -> Self {
        let Orientation { up, reason, .. } = Orientation::of(particles);
        let kinds = &particles.kinds;
        let mut counts = vec![0; kinds.table.len()];
        (0..kinds.codes.len()).for_each(|row| counts[kinds.codes.code(row) as usize] += 1);
        let types = kinds.table.iter().zip(counts).filter(|(_, spheres)| *spheres > 0);
        Self {
            format: particles.format.name(),
            title: particles.title.clone(),
            // Input that is not a file can be read only once.
            frames: path.is_file().then(|| count_frames(path, options).ok()).flatten(),
            step: particles.step,
            time: particles.time,
            unit: (particles.unit != LengthUnit::Unknown).then(|| particles.unit.name()),
            columns: particles.columns.clone(),
            types: types
                .map(|(kind, spheres)| TypeInfo {
                    name: kind.name.clone(),
                    element: kind.element.map(Element::symbol),
                    spheres,
                })
                .collect(),
            cell: particles.cell.map(|cell| CellInfo {
                origin: cell.origin.to_array(),
                vectors: cell.vectors.map(|vector| vector.to_array()),
                periodic: cell.periodic,
            }),
            up: UpInfo { axis: up.name(), reason: reason.to_string() },
            rows: None,
        }
    }

    pub(in crate::cli) fn print(&self) {
        let title = if self.title.is_empty() { String::new() } else { format!(": {}", self.title) };
        output::print(format_args!("format       {}{title}", self.format));
        if let Some(frames) = self.frames {
            output::print(format_args!("frames       {}", HumanCount(frames)));
        }
        if let Some(step) = self.step {
            output::print(format_args!("step         {step}"));
        }
        if let Some(time) = self.time {
            output::print(format_args!("time         {time}"));
        }
        output::print(format_args!("unit         {}", self.unit.unwrap_or("unknown")));
        output::print(format_args!("columns      {}", self.columns.join(", ")));
        for kind in self.types.iter().take(SHOWN) {
            let element = kind.element.map_or(String::new(), |element| format!(" ({element})"));
            let count = HumanCount(kind.spheres);
            output::print(format_args!("type         {}{element}: {count}", kind.name));
        }
        if self.types.len() > SHOWN {
            let more = self.types.len() - SHOWN;
            output::print(format_args!("type         and {more} more; --json lists all"));
        }
        if let Some(CellInfo { origin, vectors: [a, b, c], .. }) = &self.cell {
            output::print(format_args!("cell         {a:?}, {b:?}, {c:?} from {origin:?}"));
        }
        output::print(format_args!("up           {}: {}", self.up.axis, self.up.reason));
        self.rows.iter().for_each(RowInfo::print);
    }
}
