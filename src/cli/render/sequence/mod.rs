//! Image sequences: of trajectory frames, of a turntable, or of both.
//!
//! Properties that depend on all frames, such as the camera and the color range, are the same in all images:
//! see [`Survey`]. A file is read twice for that, standard input once.

mod frame_reader;
mod numbered_names;
mod plan;

use self::frame_reader::FrameReader;
use self::numbered_names::numbered;
use self::plan::{Frames, Plan, Shot, stream_name};
use super::album::Album;
use super::checkpoint::resume::Resumed;
use super::checkpoint::writer::CheckpointWriter;
use super::image::{Session, render_placed};
use super::pace::Pace;
use super::prepare::{PlacedScene, stage};
use super::setup::{Common, Place, RenderSetup};
use crate::cli::contents::plural;
use crate::cli::failure::Failure;
use crate::cli::files::Files;
use crate::cli::options::appearance::BarPlace;
use crate::cli::output;
use crate::cli::picture_file;
use crate::cli::source::Source;
use spherule_render::compose::Survey;
use spherule_render::scene::particles::{Particles, ReadOptions, TrajectoryReader};
use spherule_render::split::Part;
use std::path::Path;
use std::process::ExitCode;

/// Renders the images until one fails or is interrupted.
///
/// `files` are all files of the command except the images.
pub(super) fn run(
    setup: &RenderSetup,
    files: &Files,
    writer: Option<&CheckpointWriter>,
    resumed: Option<Resumed>,
) -> Result<ExitCode, Failure> {
    let resumed = match resumed {
        Some(resumed) if setup.sequence.first_picture.is_none() => {
            let why = "it holds a single image; remove --turntable, and give --frame one frame";
            return Err(resumed.refuse(why));
        }
        resumed => resumed,
    };
    let session = Session { writer, ..Session::default() };
    let Some(range) = setup.particles.frames() else {
        return run_turntable(setup, files, session, resumed);
    };
    let Source::Particles(path, options) = &setup.source else {
        let message = "--frame needs a particle file";
        return Err(Failure::usage("render", message));
    };
    let options = ReadOptions { allow_empty: true, ..ReadOptions::clone(options) };
    let frames = Frames::choose(path, &options, range)?;
    let plan = Plan::new(Some(frames), setup.views.turntable())?;
    let mut setup = setup.clone();
    setup.request.style.allow_empty = true;
    let album = check_outputs(&setup, &plan, files)?;
    let mut reader = FrameReader::open(path, &options)?;
    let survey = survey_frames(&setup, &plan, path, &options, &mut reader)?;
    survey.check(path, &setup.request.style)?;
    print_framing(&setup, &plan);
    survey.fix_colors(&mut setup.request.style);
    survey.fix_arrows(setup.request.style.arrows.as_mut());
    let pace = Some(Pace::new(own_count(&setup, &plan)));
    let session = Session { album, pace, ..session };
    Sequence { setup, plan, files, session, resumed }.of_frames(path, &options, reader, survey)
}

/// Renders the images of a turntable around one scene.
fn run_turntable(
    setup: &RenderSetup,
    files: &Files,
    session: Session,
    resumed: Option<Resumed>,
) -> Result<ExitCode, Failure> {
    if let Source::Particles(path, _) = &setup.source
        && plan::is_stream(path)
    {
        let message = format!(
            "--turntable reads its input for every image, but {} can be read only once; write it to a file",
            stream_name(path)
        );
        return Err(Failure::usage("render", message));
    }
    let plan = Plan::new(None, setup.views.turntable())?;
    let album = check_outputs(setup, &plan, files)?;
    let pace = Some(Pace::new(own_count(setup, &plan)));
    let session = Session { album, pace, ..session };
    Sequence { setup: setup.clone(), plan, files, session, resumed }.of_turn()
}

/// Checks that all images of this process can be written without replacing other files of the command, as far
/// as their number is known; returns the file of all images, if there is one.
fn check_outputs(
    setup: &RenderSetup,
    plan: &Plan,
    files: &Files,
) -> Result<Option<Album>, Failure> {
    if setup.album.is_some() {
        files.check_output("--output", &setup.output)?;
        return Album::begin(setup);
    }
    let known = (0..plan.count().unwrap_or(1)).filter(|&index| is_assigned(setup, index));
    let mut files = files.clone();
    for shot in known.filter_map(|index| plan.shot(index)) {
        let output = numbered(&setup.output, shot.number, plan.digits());
        files.writes("--output", &output);
        picture_file::check(&output)?;
    }
    files.check()?;
    Ok(None)
}

/// Returns whether this process renders an image. Parts of a sequence take the images in turn.
fn is_assigned(setup: &RenderSetup, index: u64) -> bool {
    let own = |part: Part| index % u64::from(part.count()) == u64::from(part.number() - 1);
    setup.deal.is_none_or(own)
}

/// Returns the number of images that this process renders, if it is known.
fn own_count(setup: &RenderSetup, plan: &Plan) -> Option<u64> {
    let first = setup.sequence.first_picture.unwrap_or(0);
    let own = (first..plan.count()?).filter(|&index| is_assigned(setup, index));
    Some(own.count() as u64)
}

/// Surveys all frames of the sequence, or only the first one if the input can be read only once.
fn survey_frames(
    setup: &RenderSetup,
    plan: &Plan,
    path: &Path,
    options: &ReadOptions,
    reader: &mut FrameReader,
) -> Result<Survey, Failure> {
    let trajectory = trajectory(setup, plan, path, options, reader)?;
    let mut survey = Survey::new(trajectory);
    let add = |survey: &mut Survey, number: u64, frame| {
        let particles = survey.particles(path, frame, options)?;
        let request = survey.begin_frame(&setup.request, &particles);
        let sized = RenderSetup { frame: Some(number), request, ..setup.clone() };
        let added = stage(&sized, Some(particles)).and_then(|staged| {
            survey.add(&setup.request, staged).map_err(|fault| setup.refuse(fault))
        });
        added.map_err(|error| error.of_frame(number))
    };
    if plan.count().is_none() {
        if let Some(number) = plan.shot(0).and_then(|shot| shot.frame)
            && let Some(frame) = reader.look(number)?
        {
            add(&mut survey, number, frame)?;
        }
        return Ok(survey);
    }
    let mut first_pass = FrameReader::open(path, options)?;
    let mut numbers: Vec<u64> = plan.shots().filter_map(|shot| shot.frame).collect();
    numbers.dedup();
    for (at, &number) in numbers.iter().enumerate() {
        let Some(frame) = first_pass.take(number)? else { break };
        if let Some(&next) = numbers.get(at + 1) {
            first_pass.read_ahead(next, frame.len());
        }
        add(&mut survey, number, frame)?;
    }
    if let Some(error) =
        plan.rest().or_else(|| plan.open_end().and_then(|end| first_pass.rest(end)))
    {
        output::warn(format_args!("{error}\nthe frames before it are rendered"));
    }
    Ok(survey)
}

/// Finds the choices that all frames of the file have in common; of input that can be read only once, by the first frame
/// alone, which `reader` keeps.
fn trajectory(
    setup: &RenderSetup,
    plan: &Plan,
    path: &Path,
    options: &ReadOptions,
    reader: &mut FrameReader,
) -> Result<TrajectoryReader, Failure> {
    let arrows = setup.request.style.arrows.as_ref();
    if !plan.is_stream() {
        return Ok(TrajectoryReader::of_file(path, options, arrows));
    }
    let mut trajectory = TrajectoryReader::default();
    if let Some(frame) = reader.look(0)?
        && reader.has_more()?
    {
        trajectory.add_first(path, frame, options, arrows);
    }
    Ok(trajectory)
}

/// Prints which frames the camera shows.
fn print_framing(setup: &RenderSetup, plan: &Plan) {
    if setup.report.quiet {
        return;
    }
    match (plan.frame_count(), plan.count()) {
        (Some(1), Some(1)) => {}
        (Some(frames), Some(pictures)) if setup.views.turntable().is_some() => {
            let (shown, frames) = (frames.min(pictures), plural(frames, "frame"));
            let pictures = plural(pictures, "picture");
            output::note(format_args!(
                "{pictures} of a turntable show {shown} of {frames}, with one camera that frames all of them"
            ));
        }
        (Some(frames), _) => {
            output::note(format_args!("one camera frames all of {}", plural(frames, "frame")));
        }
        _ => {
            let mut colors = setup.request.style.column_colors();
            let ranged = colors.any(|own| own.ends.depend_on_values());
            let colors = if ranged { ", and its color range applies to all images" } else { "" };
            output::note(format_args!(
                "the camera frames the first frame{colors}: the input can be read only once"
            ));
        }
    }
}

/// Images that are rendered one after another.
struct Sequence<'a> {
    setup: RenderSetup<'a>,
    plan: Plan,
    files: &'a Files,
    session: Session<'a>,
    /// The resumed image, which is the first one.
    resumed: Option<Resumed>,
}

impl Sequence<'_> {
    fn of_turn(mut self) -> Result<ExitCode, Failure> {
        for (index, shot) in (0..).zip(self.plan.shots()) {
            if !self.is_rendered_here(index) {
                continue;
            }
            let code = self.picture(index, &shot, None, None)?;
            if code != ExitCode::SUCCESS {
                return Ok(code);
            }
        }
        self.finish()
    }

    fn of_frames(
        mut self,
        path: &Path,
        options: &ReadOptions,
        mut reader: FrameReader,
        mut survey: Survey,
    ) -> Result<ExitCode, Failure> {
        for warning in &survey.warnings {
            self.session.notices.warn(warning);
        }
        for index in 0.. {
            let Some(shot) = self.plan.shot(index) else { break };
            let Some(number) = shot.frame else { break };
            if !self.is_rendered_here(index) {
                // If the input can be read only once, the end is known only after reading it.
                if self.plan.is_stream() && !reader.pass(number)? {
                    break;
                }
                continue;
            }
            let again = self.plan.shot(index + 1).is_some_and(|next| next.frame == shot.frame);
            let frame = if again { reader.look(number)? } else { reader.take(number)? };
            let Some(frame) = frame else { break };
            // Signals end programs that wait for a pipe, which a thread that waits for it would hinder.
            let next = self.next_frame(index).filter(|&next| next > number);
            if let Some(next) = next.filter(|_| !self.plan.is_stream()) {
                reader.read_ahead(next, frame.len());
            }
            let angle = shot.turn.map(|turn| self.setup.views.angle(turn));
            let result = survey.particles(path, frame, options).map_err(Failure::from);
            let result = result.and_then(|particles| {
                let shared = survey.shared(&self.setup.request, angle).map_err(|error| {
                    Failure::World(self.setup.source.name().into_owned(), error)
                })?;
                let common = Common { shared, frames_all: !self.plan.is_stream() };
                self.picture(index, &shot, Some(particles), Some(common))
            });
            let code = result.map_err(|error| error.of_frame(number))?;
            if code != ExitCode::SUCCESS {
                self.session.notices.summarize(self.plan.noun());
                return Ok(code);
            }
        }
        let missing = self.plan.check_end(path, reader.passed());
        let code = self.finish()?;
        missing.map(|()| code)
    }

    /// Returns whether an image is rendered in this run.
    fn is_rendered_here(&self, index: u64) -> bool {
        is_assigned(&self.setup, index) && index >= self.setup.sequence.first_picture.unwrap_or(0)
    }

    /// Returns the frame of the next image that is rendered in this run, if there is one.
    fn next_frame(&self, index: u64) -> Option<u64> {
        let mut shots = (index + 1..).map_while(|next| Some((next, self.plan.shot(next)?)));
        shots.find(|(next, _)| self.is_rendered_here(*next))?.1.frame
    }

    /// Returns whether no image of this process follows, as far as is known.
    fn is_last(&self, index: u64) -> bool {
        let stride = self.setup.deal.map_or(1, |part| u64::from(part.count()));
        self.plan.shot(index.saturating_add(stride)).is_none()
    }

    fn picture(
        &mut self,
        index: u64,
        shot: &Shot,
        particles: Option<Particles>,
        common: Option<Common>,
    ) -> Result<ExitCode, Failure> {
        let Shot { frame, turn, number } = *shot;
        let place = Some(Place { index, last: self.is_last(index) });
        let mut setup = RenderSetup { turn, frame, common, place, ..self.setup.clone() };
        if setup.album.is_none() {
            setup.output = numbered(&self.setup.output, number, self.plan.digits());
            picture_file::check(&setup.output)?;
            if self.plan.count().is_none() {
                self.files.check_output("--output", &setup.output)?;
            }
        }
        let session = &mut self.session;
        session.notices.start_picture(number);
        if let Some(pace) = &mut session.pace {
            pace.next();
        }
        let resumed = self.resumed.take();
        let code = render_placed(&setup, PlacedScene::load(&setup, particles)?, session, resumed)?;
        // A color bar in a file is the same for all images.
        self.setup.color_bar = inside(self.setup.color_bar);
        Ok(code)
    }

    /// Completes the file of all images, and prints the final messages.
    fn finish(self) -> Result<ExitCode, Failure> {
        let Session { notices, album, .. } = self.session;
        notices.summarize(self.plan.noun());
        if notices.pictures() == 0 {
            let which = self.setup.deal.map_or_else(String::new, |part| format!(" of part {part}"));
            output::warn(format_args!("there is no image{which} to render"));
        }
        if !self.setup.report.quiet && notices.kept() > 0 {
            let (kept, pictures) = (notices.kept(), notices.pictures());
            output::note(format_args!(
                "{kept} of {pictures} images already existed and were skipped"
            ));
        }
        album.map_or(Ok(()), |album| album.finish(&self.setup))?;
        Ok(ExitCode::SUCCESS)
    }
}

/// The color bar of all images.
fn inside(bar: Option<&BarPlace>) -> Option<&BarPlace> {
    bar.filter(|bar| matches!(bar, BarPlace::Inside(_)))
}
