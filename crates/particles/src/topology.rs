//! Frames of a trajectory whose particles another file names.

use crate::ids::{self, ID, is_id};
use crate::{
    BondSource, Bonds, Columns, FileError, ParticleFrame, Radii, ReadOptions, Role, aliases,
    error::clipped, frame_reader::FrameReader, place::Place, reader, schema::unknown_column,
};
use std::path::{Path, PathBuf};

/// Columns that change from frame to frame, besides positions.
const VARYING: [&str; 9] = ["vx", "vy", "vz", "fx", "fy", "fz", "xu", "yu", "zu"];

/// Reader of a trajectory together with its topology.
pub(crate) struct Joined {
    path: PathBuf,
    topology: PathBuf,
    frames: Box<dyn FrameReader>,
    /// Options for the topology.
    options: ReadOptions,
    /// Columns that one of both files must have.
    kept: Vec<String>,
    /// True if the numbers of particles were asked for, and not only to sort rows.
    has_ids: bool,
    /// The topology, once read.
    particles: Option<ParticleFrame>,
}

/// Returns whether a column changes from frame to frame.
fn varies(name: &str) -> bool {
    let is = |other: &str| VARYING.contains(&other);
    is(&name.to_ascii_lowercase()) || aliases::of(name).any(is) || is_position(name)
}

fn is_position(name: &str) -> bool {
    let axes = [Role::X, Role::Y, Role::Z];
    let mut names = aliases::USUAL.iter().filter(|(role, _)| axes.contains(role));
    names.any(|(_, names)| names.iter().any(|own| own.eq_ignore_ascii_case(name)))
}

impl Joined {
    /// Opens a trajectory; the topology is read with its first frame.
    pub(crate) fn new(
        path: &Path,
        topology: &Path,
        options: &ReadOptions,
    ) -> Result<Self, FileError> {
        let axes = [Role::X, Role::Y, Role::Z];
        let (positions, others): (Vec<_>, Vec<_>) =
            options.columns.roles.iter().cloned().partition(|(role, _)| axes.contains(role));
        let kept = options.columns.kept.clone();
        let Columns { wanted, rest, .. } = &options.columns;
        let has_ids = rest.is_some() || kept.iter().chain(wanted).any(|name| is_id(name));
        // Each under any of its names: which of them there are, differs between the files.
        let mut wanted = [&kept[..], wanted, &[ID.to_owned()]].concat();
        let synonyms = wanted.iter().flat_map(|name| aliases::of(name)).map(str::to_owned);
        wanted = wanted.iter().cloned().chain(synonyms).collect();
        let columns = |roles| Columns {
            roles,
            kept: Vec::new(),
            wanted: wanted.clone(),
            rest: options.columns.rest,
        };
        let trajectory = ReadOptions {
            columns: columns(positions),
            radii: Radii::Auto,
            topology: None,
            align: None,
            bonds: BondSource::None,
            ..options.clone()
        };
        let (format, frames) = reader::open_positions(path, &trajectory)?;
        let reads_bonds = options.bonds.for_format(format).reads_file();
        let options = ReadOptions {
            format: None,
            columns: columns(others),
            radii: options.radii.clone(),
            atom_style: options.atom_style.clone(),
            bonds: if reads_bonds { BondSource::Auto } else { BondSource::None },
            ..ReadOptions::default()
        };
        let topology = topology.to_owned();
        Ok(Self {
            path: path.to_owned(),
            topology,
            frames,
            options,
            kept,
            has_ids,
            particles: None,
        })
    }

    /// Reads the topology.
    fn read(&self) -> Result<ParticleFrame, FileError> {
        let (_, mut frames) = reader::open(&self.topology, &self.options)?;
        let Some(mut particles) = frames.next()? else {
            return Err(FileError::whole_file(&self.topology, "holds no particles"));
        };
        ids::sort(&mut particles);
        // Only the columns are needed from here on.
        let is_kept = |name: &str| !varies(name) && (self.has_ids || !is_id(name));
        particles.numbers.retain(|column| is_kept(&column.name));
        particles.texts.retain(|column| is_kept(&column.name));
        particles.columns.retain(|name| !varies(name));
        particles.roles.retain(|(role, _)| ![Role::X, Role::Y, Role::Z].contains(role));
        // Shifts follow from the positions of each frame.
        particles.bonds.iter_mut().for_each(Bonds::forget_images);
        (particles.y, particles.z) = (Vec::new(), Vec::new());
        Ok(particles)
    }

    /// Adds the columns of the topology to a frame.
    fn join(&self, particles: &ParticleFrame, frame: &mut ParticleFrame) -> Result<(), FileError> {
        let (own, other) = (frame.len(), particles.len());
        if own != other {
            let message = format!("has {own} particles, but its topology {other}");
            let error = FileError::whole_file(&self.path, message);
            return Err(error.with_help(format!(
                "give --topology the file that the simulation was started from, not {}",
                self.topology.display()
            )));
        }
        ids::sort(frame);
        if !particles.kinds.codes.is_empty() {
            frame.kinds.clone_from(&particles.kinds);
        }
        frame.bonds.clone_from(&particles.bonds);
        if !particles.radius.is_empty() {
            // Radii are in the topology's unit.
            let factor = frame.unit.per_angstrom() / particles.unit.per_angstrom();
            frame.radius = particles.radius.iter().map(|radius| radius * factor).collect();
        }
        if !particles.color.is_empty() {
            frame.color.clone_from(&particles.color);
        }
        if !particles.materials.codes.is_empty() {
            frame.materials.clone_from(&particles.materials);
        }
        let has = |frame: &ParticleFrame, name: &str| {
            let numbers = frame.numbers.iter().map(|column| &column.name);
            numbers.chain(frame.texts.iter().map(|column| &column.name)).any(|own| own == name)
        };
        for column in &particles.numbers {
            if !has(frame, &column.name) {
                frame.numbers.push(column.clone());
            }
        }
        for column in &particles.texts {
            if !has(frame, &column.name) {
                frame.texts.push(column.clone());
            }
        }
        for name in &particles.columns {
            if !frame.columns.contains(name) {
                frame.columns.push(name.clone());
            }
        }
        for (role, name) in &particles.roles {
            frame.roles.retain(|(own, _)| own != role);
            frame.roles.push((*role, name.clone()));
        }
        if frame.title.is_empty() {
            frame.title.clone_from(&particles.title);
        }
        for warning in &particles.warnings {
            let warning = clipped(format!("{}: {warning}", self.topology.display()));
            frame.warnings.push(warning);
        }
        self.check_columns(frame)
    }

    /// Returns an error if neither file has a column that was asked for.
    fn check_columns(&self, frame: &ParticleFrame) -> Result<(), FileError> {
        let numbers = frame.numbers.iter().map(|column| &column.name);
        let texts = frame.texts.iter().map(|column| &column.name);
        let roles = frame.roles.iter().map(|(_, name)| name);
        let held: Vec<&str> = numbers.chain(texts).chain(roles).map(String::as_str).collect();
        let is_held = |name: &str| held.iter().any(|own| own.eq_ignore_ascii_case(name));
        let missing = |name: &&String| !is_held(name) && !aliases::of(name).any(is_held);
        match self.kept.iter().find(missing) {
            Some(name) => {
                let columns = frame.columns.iter().map(String::as_str);
                Err(FileError::whole_file(&self.path, unknown_column(name, columns)))
            }
            None => Ok(()),
        }
    }
}

impl FrameReader for Joined {
    fn next(&mut self) -> Result<Option<ParticleFrame>, FileError> {
        let Some(mut frame) = self.frames.next()? else { return Ok(None) };
        let particles = match self.particles.take() {
            Some(particles) => particles,
            None => self.read()?,
        };
        self.join(&particles, &mut frame)?;
        self.particles = Some(particles);
        Ok(Some(frame))
    }

    fn skip(&mut self) -> Result<bool, FileError> {
        self.frames.skip()
    }

    fn more(&mut self) -> Result<bool, FileError> {
        self.frames.more()
    }

    fn place(&self) -> Option<Place> {
        self.frames.place()
    }

    fn start_at(&mut self, place: &Place) -> Result<bool, FileError> {
        self.frames.start_at(place)
    }
}
