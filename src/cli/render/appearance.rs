//! Loading of particles with the colors and materials of the options.

use super::job::Job;
use crate::cli::annotations::FrameFacts;
use crate::cli::appearance::BarPlace;
use crate::cli::failure::Failure;
use crate::cli::source::Source;
use crate::cli::write_file::write_file;
use glam::DVec3;
use spherule_render::World;
use spherule_render::atomic::check_destination;
use spherule_render::overlay::Canvas;
use spherule_render::overlay::annotations::{self, AnnotationDrawing};
use spherule_render::overlay::color_bar::Bar;
use spherule_render::scene::particles::{
    self, ArrowSizes, Cell, Legend, Orientation, ParticleStyle, Particles,
};
use spherule_render::scene::{Annotations, FileError, Look, Scene};
use std::path::Path;

/// Returns the source, with the columns that colors and selections need; an error if it has no particles.
pub(super) fn with_columns(source: Source, looks: &ParticleStyle) -> Result<Source, Failure> {
    match source {
        Source::Particles(path, mut options) => {
            options.columns.wanted = looks.columns();
            options.bonds = looks.bond_source();
            Ok(Source::Particles(path, options))
        }
        other if *looks == ParticleStyle::default() => Ok(other),
        Source::Toml(_) | Source::Prepared(_) | Source::Field { .. } => {
            let message = "options for particles need a particle file; a scene defines its own colors and \
                           materials";
            Err(Failure::usage("render", message))
        }
    }
}

/// A scene, and facts about its particles.
pub(super) struct Loaded {
    pub(super) scene: Scene,
    /// The color scale, if colors represent numbers.
    pub(super) legend: Option<Legend>,
    pub(super) cell: Option<Cell>,
    /// True if the particles are drawn as a crystal because nothing else is asked for.
    pub(super) is_crystal: bool,
    /// The orientation of the particles, if the scene is of particles.
    pub(super) orientation: Option<Orientation>,
    pub(super) facts: FrameFacts,
    /// Center of the particle in focus, if the focus is a particle.
    pub(super) focus: Option<DVec3>,
    /// The sizes of arrows, if there are any.
    pub(super) arrow_sizes: Option<ArrowSizes>,
}

/// Loads the scene, with colors, materials and replicas of particles.
///
/// `given` is a frame that is already loaded.
pub(super) fn load(job: &Job, given: Option<Particles>) -> Result<Loaded, Failure> {
    let Source::Particles(path, options) = &job.source else {
        job.views.refuse_cells()?;
        let (facts, scene) = (FrameFacts::default(), job.source.load()?);
        let (legend, cell, orientation, focus) = (None, None, None, None);
        let (is_crystal, arrow_sizes) = (false, None);
        return Ok(Loaded {
            scene,
            legend,
            cell,
            is_crystal,
            orientation,
            facts,
            focus,
            arrow_sizes,
        });
    };
    let mut particles = match given {
        Some(particles) => particles,
        None => particles::read(path, options)?,
    };
    let legend = job.looks.apply(path, &mut particles)?;
    let is_crystal = job.looks.draws_crystal(&particles);
    let cell = job.views.repeat(path, &mut particles)?;
    let focus = focus(job, path, &particles)?;
    let facts = FrameFacts::of(job, &particles);
    let shared = job.common.as_ref().and_then(|common| common.orientation);
    let orientation = shared.unwrap_or_else(|| job.views.orientation(&particles));
    let title = job.source.title(&Scene::default()).into_owned();
    let arrow_sizes = particles.arrows.sizes;
    let scene = job.preset().unwrap_or_default().scene(particles, &title, &orientation);
    let orientation = Some(orientation);
    Ok(Loaded { scene, legend, cell, is_crystal, orientation, facts, focus, arrow_sizes })
}

/// Returns the center of the particle in focus, if the focus is a particle.
pub(in crate::cli) fn focus(
    job: &Job,
    path: &Path,
    particles: &Particles,
) -> Result<Option<DVec3>, FileError> {
    let Some(id) = job.views.particle_in_focus() else { return Ok(None) };
    if job.looks.allow_empty && particles.spheres.is_empty() {
        return Ok(None);
    }
    let point = particles.position_of(id);
    point.map(Some).ok_or_else(|| {
        let error =
            FileError::whole_file(path, format!("no particle that is drawn has the id {id}"));
        error.with_help(
            "--focus id:ID takes a value of the column id, or without one a number from 0",
        )
    })
}

/// Checks that the color bar can be written, without changing anything.
pub(in crate::cli) fn check_bar(job: &Job) -> Result<(), Failure> {
    let Some(BarPlace::File(path, _)) = job.color_bar else { return Ok(()) };
    check_destination(path).map_err(|error| Failure::Write(path.clone(), error))
}

/// Rejects a color bar if colors do not represent numbers.
pub(in crate::cli) fn check_legend(job: &Job, legend: Option<&Legend>) -> Result<(), Failure> {
    if job.color_bar.is_none() || legend.is_some() {
        return Ok(());
    }
    let message = "--color-bar needs --color-by with a numeric column";
    Err(Failure::usage("render", message))
}

/// Writes the color bar, as high as the image, if it has a file; an error if colors do not represent numbers.
pub(in crate::cli) fn write_bar(
    job: &Job,
    legend: Option<&Legend>,
    height: u32,
) -> Result<(), Failure> {
    check_legend(job, legend)?;
    let (Some(BarPlace::File(path, format)), Some(legend)) = (job.color_bar, legend) else {
        return Ok(());
    };
    let Legend { scale, label } = legend;
    let bar = Bar::file(scale, label, height, *format)?;
    write_file(path, &bar)
}

/// Warning of annotations that have no room.
pub(super) const OVERLAP: &str =
    "annotations overlap: make the image larger, or use fewer or a smaller --text-size";

/// Draws the annotations of a scene over an image; returns whether all of them have room.
pub(in crate::cli) fn draw_annotations(
    scene: (&Annotations, &Look),
    world: &World,
    canvas: &mut Canvas,
    turns: bool,
) -> bool {
    let (annotations, look) = scene;
    if annotations.is_empty() {
        return true;
    }
    let AnnotationDrawing { drawing, fits } = annotations::draw(annotations, world, look, turns);
    canvas.draw(|image| drawing.draw_over(image));
    fits
}
