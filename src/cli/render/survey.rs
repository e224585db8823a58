//! Properties that the pictures of a sequence share, found before the first one is rendered: where
//! the camera stands, which numbers the colors stand for, and a radius that was guessed.

use super::job::Job;
use super::prepare::Staged;
use crate::cli::contents::plural;
use crate::cli::failure::Failure;
use crate::cli::views::corners;
use spherule::scene::particles::{
    Coloring, Looks, ParticleFrame, Particles, Radii, ReadOptions, SharedNames, of_frame,
};
use spherule::scene::{Camera, FileError};
use spherule::world::WorldError;
use spherule::world::framing::SequenceBounds;
use std::path::Path;

/// Properties that a picture shares with the others of its sequence.
#[derive(Clone)]
pub(in crate::cli) struct Common {
    pub(in crate::cli) camera: Camera,
    /// Height of the ground that a preset puts under all frames.
    pub(in crate::cli) ground: Option<f64>,
    /// True if the camera frames all pictures, and not only the first.
    pub(in crate::cli) frames_all: bool,
}

/// Findings about the frames that were looked at; memory does not grow with their number.
#[derive(Default)]
pub(super) struct Survey {
    bounds: Option<SequenceBounds>,
    /// Ends of the color map: the least and the greatest number in all frames.
    ends: Option<[f64; 2]>,
    /// True if colors stand for numbers, also where no frame has one that has a color.
    numeric: bool,
    /// Types and texts, whose places choose their colors.
    names: SharedNames,
    /// The radius of all particles, before it is scaled, if it may have been guessed.
    radius: Option<f64>,
    /// Warnings about the first frame that shows a sphere.
    pub(super) warnings: Vec<String>,
    frames: u64,
    /// Frames that show a sphere.
    shown: u64,
    /// True if it looks at all frames, and not only at the first.
    all: bool,
}

impl Survey {
    /// Creates a survey of `all` frames that are shown, or only of the first.
    pub(super) fn new(all: bool) -> Self {
        Self { all, ..Self::default() }
    }

    /// Returns the particles of a frame, with types and texts at the places that they have in all
    /// frames.
    pub(super) fn particles(
        &mut self,
        path: &Path,
        mut frame: ParticleFrame,
        options: &ReadOptions,
    ) -> Result<Particles, FileError> {
        self.names.share(&mut frame);
        of_frame(path, frame, options)
    }

    /// Looks at the particles of a frame.
    pub(super) fn add(
        &mut self,
        job: &Job,
        particles: Particles,
        options: &ReadOptions,
    ) -> Result<(), Failure> {
        self.frames += 1;
        let radius = guessed(&particles, options);
        if let Coloring::Column(colors) = &job.looks.coloring {
            self.numeric |= colors.is_numeric(&particles);
        }
        let Staged { mut scene, cuts, legend, .. } = Staged::load(job, Some(particles))?;
        if scene.spheres.is_empty() {
            return Ok(());
        }
        self.shown += 1;
        if self.shown == 1 {
            self.radius = radius;
            self.warnings = std::mem::take(&mut scene.warnings);
            job.views.choose(&mut scene, &cuts)?;
            self.bounds = SequenceBounds::new(&scene);
        }
        if let Some(legend) = legend {
            let range = legend.scale.range;
            let [low, high] = self.ends.unwrap_or([range.low(), range.high()]);
            self.ends = Some([low.min(range.low()), high.max(range.high())]);
        }
        if let Some(bounds) = &mut self.bounds {
            bounds.add(&scene, &corners(&scene));
        }
        Ok(())
    }

    /// Reads the frames that follow with the radius that was guessed for the first.
    pub(super) fn fix_radius(&self, options: &mut ReadOptions) {
        if let Some(radius) = self.radius {
            options.radii = Radii::Missing(radius);
        }
    }

    /// Has colors stand for the same numbers in all frames.
    pub(super) fn fix_colors(&self, coloring: &mut Coloring) {
        if let (Coloring::Column(colors), Some(ends)) = (coloring, self.ends) {
            colors.ends.get_or_insert(ends);
        }
    }

    /// Refuses frames that all show no sphere, or that all lack what looks are for.
    pub(super) fn check(&self, path: &Path, looks: &Looks) -> Result<(), FileError> {
        if self.shown > 0 {
            looks.check_types(path, &self.names)?;
            return match &looks.coloring {
                Coloring::Column(colors) if self.numeric && self.ends.is_none() => {
                    Err(colors.no_range(path))
                }
                _ => Ok(()),
            };
        }
        let frames = plural(self.frames, "frame");
        let message = format!("shows no sphere in the {frames} that the camera is to frame");
        let help = "the frames are empty, or --select and --slice leave nothing of them; of standard \
                    input, the first frame counts";
        Err(FileError::whole_file(path, message).with_help(help))
    }

    /// Returns the properties that a picture shares with all others, in a turn by `angle`.
    pub(super) fn common(&self, job: &Job, angle: Option<f64>) -> Result<Common, Failure> {
        let view = |angle| {
            let found = self.bounds.as_ref().ok_or(WorldError::NothingToFit);
            let failure = |error| Failure::World(job.source.name().into_owned(), error);
            found.and_then(|bounds| bounds.view(angle)).map_err(failure)
        };
        // A ground lies under all frames, from whatever side it is seen.
        let mut still = view(None)?;
        job.style.light(&mut still);
        let ground = still.ground.map(|ground| ground.height);
        let camera = if angle.is_none() { still.camera } else { view(angle)?.camera };
        Ok(Common { camera, ground, frames_all: self.all })
    }
}

/// The radius of all particles, before it is scaled, if it may have been guessed.
fn guessed(particles: &Particles, options: &ReadOptions) -> Option<f64> {
    let elements = particles.kinds.table.iter().any(|kind| kind.element.is_some());
    let radius = particles.spheres.radius.first()?;
    // Of a file with radii of its own, this one has no effect.
    (options.radii == Radii::Auto && !elements).then_some(radius / options.radius_scale)
}
