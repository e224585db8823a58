//! Particles with the looks that the user chose.

use super::job::Job;
use super::prepare::Prepared;
use crate::cli::failure::Failure;
use crate::cli::looks::BarFile;
use crate::cli::source::Source;
use spherule::atomic::{check_destination, write_atomically};
use spherule::color::bar::{Bar, Direction};
use spherule::scene::Scene;
use spherule::scene::particles::{self, Cell, Legend, Looks, Particles};

/// The source, with the columns that the looks need; only particles have such looks.
pub(super) fn with_columns(source: Source, looks: &Looks) -> Result<Source, Failure> {
    match source {
        Source::Particles(path, mut options) => {
            options.columns.wanted = looks.columns();
            Ok(Source::Particles(path, options))
        }
        other if *looks == Looks::default() => Ok(other),
        Source::Toml(_) | Source::Field { .. } => {
            let message = "looks of particles are for a file of particles: a scene says itself how \
                           its spheres look";
            Err(Failure::usage("render", message))
        }
    }
}

/// A scene, and what is known of the particles that it is made of.
pub(super) struct Loaded {
    pub(super) scene: Scene,
    /// What the colors stand for, if they stand for numbers.
    pub(super) legend: Option<Legend>,
    pub(super) cell: Option<Cell>,
}

/// Loads what is to be rendered: particles as they are to look, in as many copies as there are to be.
///
/// `given` is a frame that was read before.
pub(super) fn load(job: &Job, given: Option<Particles>) -> Result<Loaded, Failure> {
    let Source::Particles(path, options) = &job.source else {
        job.views.refuse_cells()?;
        return Ok(Loaded { scene: job.source.load()?, legend: None, cell: None });
    };
    let mut particles = match given {
        Some(particles) => particles,
        None => particles::read(path, options)?,
    };
    let legend = job.looks.apply(path, &mut particles)?;
    let cell = job.views.repeat(path, &mut particles)?;
    let title = job.source.title(&Scene::default()).into_owned();
    Ok(Loaded { scene: Scene::of_particles(particles, &title), legend, cell })
}

/// Finds out whether the color bar can be written, and changes nothing.
pub(super) fn check_bar(job: &Job) -> Result<(), Failure> {
    let Some(BarFile { path, .. }) = job.color_bar else { return Ok(()) };
    check_destination(path).map_err(|error| Failure::Write(path.clone(), error))
}

/// Writes the color bar, as high as the picture.
pub(super) fn write_bar(job: &Job, prepared: &Prepared) -> Result<(), Failure> {
    let Some(BarFile { path, format }) = job.color_bar else { return Ok(()) };
    let Some(Legend { scale, label }) = &prepared.legend else {
        let message = "--color-bar tells what numbers have which colors: --color-by a column of \
                       numbers";
        return Err(Failure::usage("render", message));
    };
    let height = prepared.scene.settings.height;
    let bar = Bar::new(scale, label, height, Direction::Up)?.file(*format)?;
    write_atomically(path, |writer| writer.write_all(&bar))
        .map_err(|error| Failure::Write(path.clone(), error))
}
