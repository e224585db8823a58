//! One image: rendered, denoised, drawn over and written.

use super::album::Album;
use super::appearance::{self, draw_annotations, write_bar};
use super::checkpoint::resume::Resumed;
use super::checkpoint::writer::CheckpointWriter;
use super::notices::Notices;
use super::pace::Pace;
use super::prepare::{PlacedScene, Prepared};
use super::setup::RenderSetup;
use super::summary::Summary;
use super::terminal::Terminal;
use super::{existing, layers, metadata, page, part};
use crate::cli::failure::Failure;
use crate::cli::progress::Meter;
use crate::cli::write_file::write_file;
use crate::cli::{output, signals};
use spherule_render::denoise::{Denoiser, Judged};
use spherule_render::film::Film;
use spherule_render::overlay::{Canvas, Matte};
use spherule_render::render::{End, Judge, Options, Render, RenderError, ResumableRender};
use spherule_render::scene::Scene;
use std::process::ExitCode;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Result of a render, complete or not.
struct Traced {
    render: ResumableRender,
    /// The denoised image, and its error.
    judged: Option<Judged>,
    /// Exit code, if a signal ended it.
    signal: Option<u8>,
    /// Command that resumes it, if a checkpoint was written.
    resume_command: Option<String>,
}

/// State shared by the images of a run.
#[derive(Default)]
pub(super) struct Session<'a> {
    pub(super) notices: Notices,
    pub(super) writer: Option<&'a CheckpointWriter>,
    /// The file of all images, unless each has its own.
    pub(super) album: Option<Album>,
    /// The pace, if the images are a sequence.
    pub(super) pace: Option<Pace>,
}

/// Renders the image of a setup without a sequence.
pub(super) fn render_image(
    setup: &RenderSetup,
    writer: Option<&CheckpointWriter>,
    resumed: Option<Resumed>,
) -> Result<ExitCode, Failure> {
    let mut session = Session { writer, album: Album::begin(setup)?, ..Session::default() };
    let code = render_placed(setup, PlacedScene::load(setup, None)?, &mut session, resumed)?;
    session.album.map_or(Ok(()), |album| album.finish(setup))?;
    Ok(code)
}

/// Renders the image of a scene, unless it exists and is skipped.
pub(super) fn render_placed(
    setup: &RenderSetup,
    placed: PlacedScene,
    session: &mut Session,
    resumed: Option<Resumed>,
) -> Result<ExitCode, Failure> {
    write_bar(setup, placed.legend.as_ref(), &placed.scene.settings)?;
    // After a signal, checks are left out: the render is interrupted at once and saved.
    if resumed.is_none()
        && signals::end_pause().is_none()
        && existing::is_up_to_date(setup, &placed)
    {
        let notify =
            if setup.is_of_sequence() { setup.report.verbose } else { !setup.report.quiet };
        session.notices.count_kept(&setup.output, notify);
        return Ok(ExitCode::SUCCESS);
    }
    let mut prepared = placed.build(setup)?;
    let unfinished = resumed.map(|resumed| resumed.into_render(setup, &prepared)).transpose()?;
    finish_image(setup, &mut prepared, session, unfinished)
}

fn finish_image(
    setup: &RenderSetup,
    prepared: &mut Prepared,
    session: &mut Session,
    unfinished: Option<ResumableRender>,
) -> Result<ExitCode, Failure> {
    prepared.report(setup, &mut session.notices);
    let traced = trace(setup, prepared, session.writer, unfinished)?;
    let finished = finish_traced(setup, prepared, session, &traced);
    // A signal while the image is written ends a sequence, too. If something must be saved or removed, the
    // next image does so: it is interrupted at once. But no input is awaited that may never come.
    let stream = setup.common.as_ref().is_some_and(|common| !common.frames_all);
    let saves = !stream && (session.writer.is_some() || session.album.is_some());
    let goes_on = saves && setup.place.is_some_and(|place| !place.last);
    let signal = if goes_on { traced.signal } else { traced.signal.or(signals::release()) };
    finished?;
    Ok(signal.map_or(ExitCode::SUCCESS, ExitCode::from))
}

/// Writes the image or the part.
fn finish_traced(
    setup: &RenderSetup,
    prepared: &mut Prepared,
    session: &mut Session,
    traced: &Traced,
) -> Result<(), Failure> {
    if let (Some(part), Some(writer)) = (setup.part, session.writer) {
        return part::finish(setup, part, prepared, writer, &traced.render);
    }
    if setup.is_of_sequence() && !traced.render.is_complete() {
        let output = setup.output.display();
        output::warn(format_args!("interrupted: {output} is incomplete and is not written"));
        traced.advise(setup);
        return Ok(());
    }
    if traced.render.samples().total == 0 {
        output::warn("interrupted before the first sample: nothing is written");
        return Ok(());
    }
    let mut render = traced.render.render();
    if let Some(Judged { denoised: Some(denoised), .. }) = &traced.judged {
        render.image.clone_from(&denoised.image);
    }
    write(setup, prepared, session, &mut render, traced.judged.as_ref())?;
    traced.report(setup, prepared, &render);
    Ok(())
}

/// Draws overlays, writes the image and its layers, and prints a summary.
fn write(
    setup: &RenderSetup,
    prepared: &mut Prepared,
    session: &mut Session,
    render: &mut Render,
    judged: Option<&Judged>,
) -> Result<(), Failure> {
    let matte = draw_over(setup, prepared, session, render)?;
    let options = metadata::write_options(setup, prepared, render, judged);
    let mut channels = layers::channels(setup, prepared, render)?;
    channels.extend(matte.map(|matte| layers::alpha(&matte, setup.format)));
    if let Some(album) = &mut session.album {
        album.add(setup, prepared, &render.image, &channels, &options)?;
    } else {
        let file = render.image.encode(setup.format, &channels, &options)?;
        write_file(&setup.output, &page::file(setup, prepared, file, &options)?)?;
    }
    Summary::new(setup, prepared, render, judged, &options).report(
        setup.report,
        session.pace,
        &mut session.notices,
    );
    Ok(())
}

/// Draws the look and, unless they are vectors on a page, the annotations over an image; returns the matte
/// of a transparent background.
fn draw_over(
    setup: &RenderSetup,
    prepared: &mut Prepared,
    session: &mut Session,
    render: &mut Render,
) -> Result<Option<Matte>, Failure> {
    let Scene { look, annotations, settings, .. } = &prepared.scene;
    let region = prepared.region;
    let world = &mut prepared.world;
    // The looks of interrupted images are finished, too.
    let never = AtomicBool::new(false);
    let mut canvas = Canvas::with_look(look, world, settings, region, render, &never)?;
    if setup.page.is_none() {
        let turns = setup.turn.is_some();
        let scene = (annotations, look);
        if !draw_annotations(scene, &prepared.world, settings.dpi, &mut canvas, turns) {
            session.notices.warn(appearance::OVERLAP);
        }
    }
    Ok(canvas.matte)
}

/// Starts or resumes a render.
fn trace(
    setup: &RenderSetup,
    prepared: &Prepared,
    writer: Option<&CheckpointWriter>,
    unfinished: Option<ResumableRender>,
) -> Result<Traced, RenderError> {
    let meter = Meter::new(setup.report.quiet || setup.report.terminal);
    let options = Options {
        tracer: setup.tracer,
        region: Some(prepared.region),
        statistics: setup.encoding.needs_statistics() || prepared.denoise.is_some(),
        features: prepared.denoise.is_some(),
        cancel: Some(signals::stop()),
        ..Options::default()
    };
    signals::catch();
    let (world, settings) = (&prepared.world, &prepared.scene.settings);
    let denoiser = prepared
        .denoise
        .map(|choice| Denoiser::new(world, settings, &options, choice))
        .transpose()?;
    let judge = |film: &Film| denoiser.as_ref()?.noise(world, film, &options);
    let options = Options { judge: denoiser.is_some().then_some(&judge as &Judge), ..options };
    let begin = || ResumableRender::begin_part(world, settings, &options, prepared.part.clone());
    let mut render = unfinished.map_or_else(begin, Ok)?;
    let caption = writer.map(|_| part::caption(setup, prepared)).unwrap_or_default();
    let mut terminal = setup.report.terminal.then(|| Terminal::new(settings));
    let after = |pause: Option<Duration>| pause.map(|pause| Instant::now() + pause);
    // Between the images of a sequence, checkpoints are written only when they are due.
    let last = setup.place.is_none_or(|place| place.last);
    let (signal, kept) = loop {
        let due = writer.and_then(|writer| writer.due(setup.checkpoints));
        let drawn = after(terminal.as_ref().map(Terminal::pause));
        let stop = due.into_iter().chain(drawn).min();
        let show = |progress| {
            meter.show(progress);
            if stop.is_some_and(|stop| stop <= Instant::now()) {
                signals::stop().store(true, Ordering::SeqCst);
            }
        };
        let end = render.run(&prepared.world, &Options { progress: Some(&show), ..options });
        let signal = signals::end_pause();
        let ended = end != End::Cancelled || signal.is_some();
        if let Some(terminal) = &mut terminal {
            terminal.draw(&render.film().resolve());
        }
        let is_due = due.is_some_and(|due| due <= Instant::now());
        let keep = writer.filter(|_| is_due || ended && (last || end == End::Cancelled));
        let kept = keep.is_some_and(|writer| writer.save(setup, prepared, &caption, &render));
        if ended {
            break (signal.filter(|_| end == End::Cancelled), kept);
        }
    };
    meter.finish();
    let resume_command = writer.filter(|_| kept).map(CheckpointWriter::resume_command);
    // Also if the render was cancelled.
    let finishing = Options { cancel: None, ..options };
    let judged = denoiser.as_ref().and_then(|one| one.judge(world, render.film(), &finishing));
    Ok(Traced { render, judged, signal, resume_command })
}

impl Traced {
    /// Warns of an incomplete image.
    fn report(&self, setup: &RenderSetup, prepared: &Prepared, render: &Render) {
        let output = setup.output.display();
        let share = render.sampled_share();
        let gaps = if share < 1.0 {
            format!(
                ": {:.1} % of its pixels are sampled, the others show the background",
                100.0 * share
            )
        } else {
            String::new()
        };
        if !render.complete && prepared.scene.settings.has_target() {
            output::warn(format_args!("interrupted: {output} is incomplete{gaps}"));
        } else if !render.complete {
            let percent = 100.0 * prepared.taken(render);
            output::warn(format_args!(
                "interrupted: {output} has {percent:.1} % of the samples{gaps}"
            ));
        } else if share < 1.0 {
            output::warn(format_args!("{output} is incomplete{gaps}"));
        }
        if matches!(render.end, End::Cancelled | End::Time) {
            self.advise(setup);
        }
    }

    /// Prints the command that resumes the render, if a checkpoint was written.
    fn advise(&self, setup: &RenderSetup) {
        if let Some(resume_command) = self.resume_command.as_ref().filter(|_| !setup.report.quiet) {
            output::note(resume_command);
        }
    }
}
