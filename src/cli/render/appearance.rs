//! Loading of particles with the colors and materials of the options.

use super::job::Job;
use crate::cli::appearance::BarPlace;
use crate::cli::failure::Failure;
use crate::cli::source::Source;
use crate::cli::views::Canvas;
use crate::cli::write_file::write_file;
use spherule_render::atomic::check_destination;
use spherule_render::drawing::{DrawingError, Picture};
use spherule_render::image::Image;
use spherule_render::overlay::color_bar::{Bar, Direction};
use spherule_render::scene::particles::{
    self, Cell, Legend, Orientation, ParticleStyle, Particles,
};
use spherule_render::scene::{ColorBar, Rgb, Scene};

/// Length of a color bar as a fraction of the image's height.
const BAR_SHARE: f64 = 0.35;

/// Returns the source, with the columns that colors and selections need; an error if it has no particles.
pub(super) fn with_columns(source: Source, looks: &ParticleStyle) -> Result<Source, Failure> {
    match source {
        Source::Particles(path, mut options) => {
            options.columns.wanted = looks.columns();
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
    /// What is up, if the scene is of particles.
    pub(super) orientation: Option<Orientation>,
}

/// Loads the scene, with colors, materials and replicas of particles.
///
/// `given` is a frame that is already loaded.
pub(super) fn load(job: &Job, given: Option<Particles>) -> Result<Loaded, Failure> {
    let Source::Particles(path, options) = &job.source else {
        job.views.refuse_cells()?;
        let scene = job.source.load()?;
        return Ok(Loaded { scene, legend: None, cell: None, orientation: None });
    };
    let mut particles = match given {
        Some(particles) => particles,
        None => particles::read(path, options)?,
    };
    let legend = job.looks.apply(path, &mut particles)?;
    let cell = job.views.repeat(path, &mut particles)?;
    let shared = job.common.as_ref().and_then(|common| common.orientation);
    let orientation = shared.unwrap_or_else(|| job.views.orientation(&particles));
    let title = job.source.title(&Scene::default()).into_owned();
    let scene = job.preset().unwrap_or_default().scene(particles, &title, &orientation);
    Ok(Loaded { scene, legend, cell, orientation: Some(orientation) })
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
    let bar = Bar::new(scale, label, height, Direction::Up)?.file(*format)?;
    write_file(path, &bar)
}

/// Returns the color bar that is drawn inside the image.
pub(in crate::cli) fn color_bar(job: &Job, legend: Option<&Legend>) -> Option<ColorBar> {
    let (Some(BarPlace::Inside(corner)), Some(Legend { scale, label })) = (job.color_bar, legend)
    else {
        return None;
    };
    Some(ColorBar { scale: *scale, label: label.clone(), corner: *corner })
}

/// Draws a scene's color bar into its corner.
pub(in crate::cli) fn draw_bar(
    color_bar: &ColorBar,
    canvas: &mut Canvas,
    ink: Rgb,
) -> Result<(), DrawingError> {
    let ColorBar { scale, label, corner } = color_bar;
    let (width, height) = (canvas.image.width, canvas.image.height);
    let length = (f64::from(height) * BAR_SHARE) as u32;
    let bar = Bar::new(scale, label, length, Direction::Up)?;
    let size = bar.size();
    let x = if corner.left { 0 } else { width.saturating_sub(size.0) };
    let y = if corner.top { 0 } else { height.saturating_sub(size.1) };
    let draw = |image: &mut Image| bar.draw_over(image, (x, y), ink);
    draw(&mut Image { width: 1, height: 1, pixels: vec![[0.0; 3]] })?;
    // Cannot fail after it has succeeded once.
    canvas.draw(|image| _ = draw(image));
    Ok(())
}
