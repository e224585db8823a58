//! Particles with the looks that the user chose.

use super::job::Job;
use super::prepare::Prepared;
use crate::cli::failure::Failure;
use crate::cli::looks::BarFile;
use crate::cli::source::Source;
use spherule::atomic::{check_destination, write_atomically};
use spherule::color::bar::{Bar, Direction};
use spherule::scene::particles::{self, Legend, Looks};
use spherule::scene::{Scene, SceneError};

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

/// The scene, and what its colors stand for if they stand for numbers.
pub(super) fn load(job: &Job) -> Result<(Scene, Option<Legend>), SceneError> {
    let Source::Particles(path, options) = &job.source else {
        return Ok((job.source.load()?, None));
    };
    let mut particles = particles::read(path, options)?;
    let legend = job.looks.apply(path, &mut particles)?;
    let title = job.source.title(&Scene::default()).into_owned();
    Ok((Scene::of_particles(particles, &title), legend))
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
