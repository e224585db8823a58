//! Properties that the pictures of a sequence share, found before the first one is rendered: where
//! the camera stands, which numbers the colors stand for, and a radius that was guessed.

use super::job::Job;
use super::prepare::Staged;
use crate::cli::contents::plural;
use crate::cli::failure::Failure;
use crate::cli::views::corners;
use spherule::scene::particles::{Particles, Radii, ReadOptions};
use spherule::scene::{Camera, SceneError};
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
    /// Ends of the color map.
    pub(super) ends: Option<[f64; 2]>,
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

    /// Looks at a frame, of which this takes what it has to know.
    pub(super) fn add(
        &mut self,
        job: &Job,
        particles: Particles,
        options: &ReadOptions,
    ) -> Result<(), Failure> {
        self.frames += 1;
        let radius = guessed(&particles, options);
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
            self.ends.get_or_insert([range.low(), range.high()]);
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

    /// Refuses frames that all show no sphere.
    pub(super) fn check(&self, path: &Path) -> Result<(), SceneError> {
        if self.shown > 0 {
            return Ok(());
        }
        let frames = plural(self.frames, "frame");
        let message = format!("shows no sphere in the {frames} that the camera is to frame");
        let help = "the frames are empty, or --select and --slice leave nothing of them; of standard \
                    input, the first frame counts";
        Err(SceneError::whole_file(path, message).with_help(help))
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
