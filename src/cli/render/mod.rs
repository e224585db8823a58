//! `spherule render`: renders a scene to a picture in a file.

mod estimate;
mod existing;
mod files;
mod film;
mod job;
mod keeper;
mod layers;
mod looks;
mod memory;
mod metadata;
mod noise;
mod notes;
mod notices;
mod numbers;
mod part;
mod prepare;
mod resume;
mod sequence;
mod store;
mod summary;
mod survey;
mod terminal;
mod visibility;

pub(super) use self::estimate::Estimate;
use self::files::files;
use self::film::Film;
pub(super) use self::job::{Job, check_alpha};
use self::keeper::Keeper;
pub(super) use self::layers::alpha;
pub(super) use self::looks::{check_bar, check_legend, color_bar, draw_bar, write_bar};
pub(super) use self::metadata::Subject;
use self::notices::Notices;
use self::prepare::{Placed, Prepared};
use self::resume::Resumed;
use self::summary::Summary;
pub(super) use self::summary::warnings;
use self::terminal::Terminal;
use super::args::RenderArgs;
use super::command::Given;
use super::progress::Meter;
use super::views::draw_over as draw_look;
use super::write_file::write_file;
use super::{Failure, output, picture_file, signals};
use spherule::overlay::Matte;
use spherule::render::{End, Options, Render, RenderError, Unfinished};
use spherule::scene::Scene;
use std::process::ExitCode;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

/// Result of a render, complete or not.
struct Traced {
    render: Unfinished,
    /// Exit code, if a signal ended it.
    signal: Option<u8>,
    /// Command that resumes it, if a checkpoint was written.
    advice: Option<String>,
}

/// Renders, writes the picture, and prints a summary.
pub(super) fn run(mut args: RenderArgs) -> Result<ExitCode, Failure> {
    args.memory.obey();
    let mut now = Given::of_process();
    part::keep(&mut args, &mut now.typed)?;
    let Some(path) = &args.keep.resume else {
        files(&args).check()?;
        let keeper = Keeper::new(&args.keep)?.map(|keeper| keeper.with(now, &args.output));
        return run_as(&args, keeper.as_ref(), None);
    };
    // The lock comes before the file is read: no other process writes it in between.
    let keeper = Keeper::new(&args.keep)?;
    let (resumed, args, given) = Resumed::read(path, now)?;
    files(&args).check()?;
    let keeper = keeper.map(|keeper| keeper.with(given, &args.output));
    run_as(&args, keeper.as_ref(), Some(resumed))
}

fn run_as(
    args: &RenderArgs,
    keeper: Option<&Keeper>,
    mut resumed: Option<Resumed>,
) -> Result<ExitCode, Failure> {
    store::refuse_sequence(args)?;
    let job = Job::new(args)?;
    check_stream(args)?;
    check_bar(&job)?;
    terminal::check(job.report.terminal)?;
    if args.is_sequence() {
        let files = files(args);
        return job.pool()?.install(|| sequence::run(&job, &files, keeper, resumed));
    }
    if let Some(resumed) = resumed.take_if(|_| args.sequence.first_picture.is_some()) {
        return Err(
            resumed.refuse("it keeps a sequence; leave --frame and --turntable as they were")
        );
    }
    if let Some(file) = &args.prepare {
        return job.pool()?.install(|| store::write(&job, file));
    }
    picture_file::check(&job.output)?;
    job.pool()?.install(|| make_picture(&job, keeper, resumed))
}

/// Refuses standard output for anything but a single picture, and reserves it for that picture.
fn check_stream(args: &RenderArgs) -> Result<(), Failure> {
    let refuse = |message: &str| Err(Failure::usage("render", message));
    if picture_file::is_stream(&args.output) && args.part.settled().is_some() {
        return refuse("--part writes a file that is named after --output: give --output a name");
    }
    if picture_file::is_stream(&args.output) && args.is_sequence() {
        return refuse(
            "--output - is for one picture: leave out --turntable, and give --frame one",
        );
    }
    picture_file::check_stream("render", &args.output, args.report.json)
}

/// State that the pictures of a run share.
#[derive(Default)]
struct Session<'a> {
    notices: Notices,
    keeper: Option<&'a Keeper>,
    /// The film that pictures go to, if they do not go to files of their own.
    film: Option<Film>,
}

fn make_picture(
    job: &Job,
    keeper: Option<&Keeper>,
    resumed: Option<Resumed>,
) -> Result<ExitCode, Failure> {
    let mut session = Session { keeper, ..Session::default() };
    make_placed(job, Placed::load(job, None)?, &mut session, resumed)
}

/// Makes the picture of a scene, unless it exists and is to be kept.
fn make_placed(
    job: &Job,
    placed: Placed,
    session: &mut Session,
    resumed: Option<Resumed>,
) -> Result<ExitCode, Failure> {
    write_bar(job, placed.legend.as_ref(), placed.scene.settings.height)?;
    // After a signal, nothing is looked at any more: what follows is interrupted at once, and kept.
    if resumed.is_none() && signals::go_on().is_none() && existing::is_there(job, &placed) {
        let tell = if job.is_of_sequence() { job.report.verbose } else { !job.report.quiet };
        session.notices.count_kept(&job.output, tell);
        return Ok(ExitCode::SUCCESS);
    }
    let mut prepared = placed.build(job)?;
    let unfinished = resumed.map(|resumed| resumed.go_on(job, &prepared)).transpose()?;
    finish_picture(job, &mut prepared, session, unfinished)
}

fn finish_picture(
    job: &Job,
    prepared: &mut Prepared,
    session: &mut Session,
    unfinished: Option<Unfinished>,
) -> Result<ExitCode, Failure> {
    prepared.tell(job, &mut session.notices);
    let traced = trace(job, prepared, session.keeper, unfinished)?;
    let finished = finish_traced(job, prepared, session, &traced);
    // One that came while the picture was written ends a sequence, too. If something is to be saved or
    // removed then, the next picture sees to that: it is interrupted at once. But nothing waits for
    // input that may never come.
    let stream = job.common.as_ref().is_some_and(|common| !common.frames_all);
    let saves = !stream && (session.keeper.is_some() || session.film.is_some());
    let goes_on = saves && job.place.is_some_and(|place| !place.last);
    let signal = if goes_on { traced.signal } else { traced.signal.or(signals::release()) };
    finished?;
    Ok(signal.map_or(ExitCode::SUCCESS, ExitCode::from))
}

/// Writes what was rendered: the picture, or the part.
fn finish_traced(
    job: &Job,
    prepared: &mut Prepared,
    session: &mut Session,
    traced: &Traced,
) -> Result<(), Failure> {
    if let (Some(part), Some(keeper)) = (job.part, session.keeper) {
        return part::finish(job, part, prepared, keeper, &traced.render);
    }
    if job.is_of_sequence() && !traced.render.is_complete() {
        let output = job.output.display();
        output::warn(format_args!("interrupted: {output} is unfinished and is not written"));
        traced.advise(job);
        return Ok(());
    }
    if traced.render.samples().total == 0 {
        output::warn("interrupted before the first sample: nothing is written");
        return Ok(());
    }
    let mut render = traced.render.render();
    write(job, prepared, session, &mut render)?;
    traced.tell(job, prepared, &render);
    Ok(())
}

/// Draws over the picture, writes it and its layers, and prints a summary.
fn write(
    job: &Job,
    prepared: &mut Prepared,
    session: &mut Session,
    render: &mut Render,
) -> Result<(), Failure> {
    let matte = draw_over(prepared, render)?;
    let options = metadata::write_options(job, prepared, render);
    let mut channels = layers::channels(job, prepared, render)?;
    channels.extend(matte.map(|matte| alpha(&matte, job.format)));
    match &mut session.film {
        Some(film) => film.add(&render.image, &options)?,
        None => write_file(&job.output, &render.image.encode(job.format, &channels, &options)?)?,
    }
    Summary::new(job, prepared, render, &options).tell(job.report, &mut session.notices);
    Ok(())
}

/// Draws the look and the color bar over a picture; returns the matte of a transparent background.
fn draw_over(prepared: &mut Prepared, render: &mut Render) -> Result<Option<Matte>, Failure> {
    let Scene { look, color_bar, settings, .. } = &prepared.scene;
    let region = prepared.region;
    let mut canvas = draw_look(look, &mut prepared.world, settings, region, render)?;
    if let Some(color_bar) = color_bar {
        draw_bar(color_bar, &mut canvas, look.ink())?;
    }
    Ok(canvas.matte)
}

/// Renders from the beginning, or resumes a render.
fn trace(
    job: &Job,
    prepared: &Prepared,
    keeper: Option<&Keeper>,
    unfinished: Option<Unfinished>,
) -> Result<Traced, RenderError> {
    let meter = Meter::new(job.report.quiet || job.report.terminal);
    let options = Options {
        tracer: job.tracer,
        region: Some(prepared.region),
        statistics: layers::need_statistics(job),
        cancel: Some(signals::stop()),
        ..Options::default()
    };
    signals::catch();
    let (world, settings) = (&prepared.world, &prepared.scene.settings);
    let begin = || Unfinished::begin_share(world, settings, &options, prepared.share.clone());
    let mut render = unfinished.map_or_else(begin, Ok)?;
    let caption = part::caption(job, prepared);
    let mut terminal = job.report.terminal.then(|| Terminal::new(settings));
    let after = |pause: Option<Duration>| pause.map(|pause| Instant::now() + pause);
    // Between the pictures of a sequence, checkpoints are written only when they are due.
    let last = job.place.is_none_or(|place| place.last);
    let (signal, kept) = loop {
        let due = keeper.and_then(|keeper| keeper.due(job.keep));
        let drawn = after(terminal.as_ref().map(Terminal::pause));
        let stop = due.into_iter().chain(drawn).min();
        let show = |progress| {
            meter.show(progress);
            if stop.is_some_and(|stop| stop <= Instant::now()) {
                signals::stop().store(true, Ordering::SeqCst);
            }
        };
        let end = render.run(&prepared.world, &Options { progress: Some(&show), ..options });
        let signal = signals::go_on();
        let ended = end != End::Cancelled || signal.is_some();
        if let Some(terminal) = &mut terminal {
            terminal.draw(&render.film().resolve());
        }
        let is_due = due.is_some_and(|due| due <= Instant::now());
        let keep = keeper.filter(|_| is_due || ended && (last || end == End::Cancelled));
        let kept = keep.is_some_and(|keeper| keeper.keep(job, prepared, &caption, &render));
        if ended {
            break (signal.filter(|_| end == End::Cancelled), kept);
        }
    };
    meter.finish();
    let advice = keeper.filter(|_| kept).map(Keeper::advice);
    Ok(Traced { render, signal, advice })
}

impl Traced {
    /// Warns of an incomplete picture.
    fn tell(&self, job: &Job, prepared: &Prepared, render: &Render) {
        let output = job.output.display();
        if !render.complete && prepared.scene.settings.has_target() {
            output::warn(format_args!("interrupted: {output} holds what there was"));
        } else if !render.complete {
            let share = 100.0 * prepared.taken(render);
            output::warn(format_args!("interrupted: {output} holds {share:.1} % of the samples"));
        }
        if matches!(render.end, End::Cancelled | End::Time) {
            self.advise(job);
        }
    }

    /// Prints the command that resumes the render, if a checkpoint was written.
    fn advise(&self, job: &Job) {
        if let Some(advice) = self.advice.as_ref().filter(|_| !job.report.quiet) {
            output::note(advice);
        }
    }
}
