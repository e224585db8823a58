//! A numbered picture of each of many frames, in one go through the file.
//!
//! What would otherwise change from picture to picture without anything in the file changing is that
//! of the first one: where the camera stands, which numbers the colors stand for, and a radius that
//! was guessed.

use super::finish_picture;
use super::job::Job;
use super::numbers::numbered;
use super::prepare::Prepared;
use crate::cli::failure::Failure;
use crate::cli::frames::FrameRange;
use crate::cli::looks::BarPlace;
use crate::cli::source::Source;
use spherule::image::check_writable;
use spherule::scene::SceneError;
use spherule::scene::particles::{
    Coloring, Frames, ParticleFrame, Particles, Radii, ReadOptions, of_frame,
};
use std::path::Path;
use std::process::ExitCode;

/// Digits of a frame's number: files that are sorted by name are sorted by frame, up to 10,000.
const DIGITS: usize = 4;

/// Makes the pictures, until one fails or is interrupted.
pub(super) fn run(first: &Job, range: FrameRange) -> Result<ExitCode, Failure> {
    let Source::Particles(path, options) = &first.source else {
        let message = "--frame is for a file of particles: name one";
        return Err(Failure::usage("render", message));
    };
    if first.views.turntable().is_some() {
        let message = "--turntable turns around one frame: give --frame a single one";
        return Err(Failure::usage("render", message));
    }
    let mut sequence = Sequence { job: first.clone(), options: ReadOptions::clone(options) };
    let mut frames = Frames::open(path, options)?;
    let mut number = 0;
    while range.last.is_none_or(|last| number <= last) {
        let failure = |error: SceneError| Failure::from(error).of_frame(number);
        if range.has(number) {
            let Some(frame) = frames.next().transpose().map_err(failure)? else { break };
            let code = sequence.picture(number, path, frame);
            let code = code.map_err(|error| error.of_frame(number))?;
            if code != ExitCode::SUCCESS {
                return Ok(code);
            }
        } else if !frames.skip_frame().map_err(failure)? {
            break;
        }
        number += 1;
    }
    check_end(path, range, number)?;
    Ok(ExitCode::SUCCESS)
}

/// A file of `count` frames has those of a range that ends, and one of any range.
fn check_end(path: &Path, range: FrameRange, count: u64) -> Result<(), SceneError> {
    let last = range.last.unwrap_or(range.first);
    if count > last {
        return Ok(());
    }
    let message = format!("has no frame {last}, but {count}, and the first is 0");
    Err(SceneError::whole_file(path, message))
}

/// Pictures that are alike.
struct Sequence<'a> {
    job: Job<'a>,
    options: ReadOptions,
}

impl Sequence<'_> {
    fn picture(
        &mut self,
        number: u64,
        path: &Path,
        frame: ParticleFrame,
    ) -> Result<ExitCode, Failure> {
        let output = numbered(&self.job.output, number, DIGITS);
        let job = Job { output, frame: Some(number), ..self.job.clone() };
        check_writable(&job.output)?;
        let particles = of_frame(path, frame, &self.options)?;
        let radius = guessed(&particles, &self.options);
        let mut prepared = Prepared::load(&job, Some(particles))?;
        let code = finish_picture(&job, &mut prepared, None, None)?;
        self.options.radii = radius.map_or(self.options.radii.clone(), Radii::Missing);
        self.keep(prepared);
        Ok(code)
    }

    /// Makes the next pictures like this one.
    fn keep(&mut self, prepared: Prepared) {
        self.job.camera = Some(prepared.scene.camera);
        self.job.color_bar = inside(self.job.color_bar);
        if let (Coloring::Column(colors), Some(legend)) =
            (&mut self.job.looks.coloring, prepared.legend)
        {
            let range = legend.scale.range;
            colors.ends.get_or_insert([range.low(), range.high()]);
        }
    }
}

/// A color bar that every picture has.
fn inside(bar: Option<&BarPlace>) -> Option<&BarPlace> {
    bar.filter(|bar| matches!(bar, BarPlace::Inside(_)))
}

/// The radius of all particles, before it is scaled, if it may have been guessed.
fn guessed(particles: &Particles, options: &ReadOptions) -> Option<f64> {
    let elements = particles.kinds.table.iter().any(|kind| kind.element.is_some());
    let radius = particles.spheres.radius.first()?;
    // Of a file with radii of its own, this one has no effect.
    (options.radii == Radii::Auto && !elements).then_some(radius / options.radius_scale)
}
