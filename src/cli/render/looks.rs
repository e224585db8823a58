//! Particles with the looks that the user chose.

use super::job::Job;
use crate::cli::failure::Failure;
use crate::cli::looks::BarPlace;
use crate::cli::source::Source;
use crate::cli::views::Canvas;
use crate::cli::write_file::write_file;
use spherule::atomic::check_destination;
use spherule::color::bar::{Bar, Direction};
use spherule::drawing::{DrawingError, Picture};
use spherule::image::Image;
use spherule::scene::particles::{self, Cell, Legend, Looks, Particles};
use spherule::scene::{ColorBar, Rgb, Scene};

/// How long a color bar in a picture is, by the picture's height.
const BAR_SHARE: f64 = 0.35;

/// The source, with the columns that the looks need; only particles have such looks.
pub(super) fn with_columns(source: Source, looks: &Looks) -> Result<Source, Failure> {
    match source {
        Source::Particles(path, mut options) => {
            options.columns.wanted = looks.columns();
            Ok(Source::Particles(path, options))
        }
        other if *looks == Looks::default() => Ok(other),
        Source::Toml(_) | Source::Prepared(_) | Source::Field { .. } => {
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
    Ok(Loaded { scene: job.style.scene(particles, &title), legend, cell })
}

/// Finds out whether the color bar can be written, and changes nothing.
pub(in crate::cli) fn check_bar(job: &Job) -> Result<(), Failure> {
    let Some(BarPlace::File(path, _)) = job.color_bar else { return Ok(()) };
    check_destination(path).map_err(|error| Failure::Write(path.clone(), error))
}

/// Refuses a color bar where colors stand for no numbers.
pub(in crate::cli) fn check_legend(job: &Job, legend: Option<&Legend>) -> Result<(), Failure> {
    if job.color_bar.is_none() || legend.is_some() {
        return Ok(());
    }
    let message =
        "--color-bar tells what numbers have which colors: --color-by a column of numbers";
    Err(Failure::usage("render", message))
}

/// Writes the color bar, as high as the picture, if it has a file; refuses one of no numbers.
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

/// The color bar that is drawn into the picture of particles.
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
    // What succeeds once does so again.
    canvas.draw(|image| _ = draw(image));
    Ok(())
}
