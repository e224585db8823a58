//! `spherule render`: a scene becomes a picture in a file.

mod interrupt;
mod job;
mod layers;
mod looks;
mod memory;
mod metadata;
mod noise;
mod notes;
mod numbers;
mod prepare;
mod sequence;
mod summary;

use self::job::Job;
use self::prepare::Prepared;
use self::summary::Summary;
use super::args::RenderArgs;
use super::progress::Meter;
use super::views::Over;
use super::{Failure, output};
use spherule::image::check_writable;
use spherule::render::{Options, Render, Skips, render};
use std::process::ExitCode;

/// What a shell reports of a process that Ctrl-C ended.
const INTERRUPTED: u8 = 130;

/// Renders and writes the picture, and tells how it went.
pub(super) fn run(args: &RenderArgs) -> Result<ExitCode, Failure> {
    let job = Job::new(args)?;
    looks::check_bar(&job)?;
    if let Some(range) = args.particles.frames() {
        return job.pool()?.install(|| sequence::run(&job, range));
    }
    let Some(pictures) = args.views.turntable() else {
        check_writable(&job.output)?;
        return job.pool()?.install(|| make_picture(&job));
    };
    let jobs = job.turns(pictures)?;
    jobs.iter().try_for_each(|job| check_writable(&job.output))?;
    job.pool()?.install(|| make_turn(&jobs))
}

/// Makes the pictures of a turn, until one is interrupted.
fn make_turn(jobs: &[Job]) -> Result<ExitCode, Failure> {
    for job in jobs {
        let code = make_picture(job)?;
        if code != ExitCode::SUCCESS {
            return Ok(code);
        }
    }
    Ok(ExitCode::SUCCESS)
}

fn make_picture(job: &Job) -> Result<ExitCode, Failure> {
    finish_picture(job, &mut Prepared::load(job, None)?)
}

fn finish_picture(job: &Job, prepared: &mut Prepared) -> Result<ExitCode, Failure> {
    prepared.tell(job);
    looks::write_bar(job, prepared)?;
    let mut render = trace(job, prepared);
    if render.samples.total == 0 {
        output::warn("interrupted before the first sample: nothing is written");
        return Ok(ExitCode::from(INTERRUPTED));
    }
    let alpha = draw_over(job, prepared, &mut render)?;
    let options = metadata::write_options(job, prepared, &render);
    let mut channels = layers::channels(job, prepared, &render);
    channels.extend(alpha.map(layers::alpha));
    render.image.write_layers(&job.output, &channels, &options)?;
    Summary::new(job, prepared, &render, &options).tell(job.report);
    if render.complete {
        return Ok(ExitCode::SUCCESS);
    }
    let output = job.output.display();
    if prepared.scene.settings.has_target() {
        output::warn(format_args!("interrupted: {output} holds what there was"));
    } else {
        let share = 100.0 * prepared.share(&render);
        output::warn(format_args!("interrupted: {output} holds {share:.1} % of the samples"));
    }
    Ok(ExitCode::from(INTERRUPTED))
}

/// Draws what is drawn over pictures. Returns alpha, if the background is transparent.
fn draw_over(
    job: &Job,
    prepared: &mut Prepared,
    render: &mut Render,
) -> Result<Option<Vec<f32>>, Failure> {
    let over = Over {
        views: job.views,
        style: job.style,
        cell: prepared.cell.as_ref(),
        region: prepared.region,
        format: job.format,
    };
    let mut canvas = over.draw(&mut prepared.world, &prepared.scene.settings, render);
    looks::draw_bar(job, prepared.legend.as_ref(), &mut canvas, over.ink())?;
    Ok(canvas.alpha)
}

fn trace(job: &Job, prepared: &Prepared) -> Render {
    let meter = Meter::new(job.report.quiet);
    let show = |progress| meter.show(progress);
    let options = Options {
        tracer: job.tracer,
        region: Some(prepared.region),
        progress: Some(&show),
        cancel: Some(interrupt::flag()),
        statistics: layers::need_statistics(job),
        skips: Skips::ALL,
    };
    let render = render(&prepared.world, &prepared.scene.settings, &options);
    meter.finish();
    render
}
