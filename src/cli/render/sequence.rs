//! Numbered pictures: of many frames of a file, of a turn, or of frames in a turn.
//!
//! What would otherwise change from picture to picture without anything in the file changing is the
//! same in all of them: see [`super::survey`]. A file is read twice for that, standard input once.

mod plan;
mod reel;

use self::plan::{Frames, Plan, Shot};
use self::reel::Reel;
use super::finish_picture;
use super::job::Job;
use super::numbers::numbered;
use super::prepare::Prepared;
pub(in crate::cli) use super::survey::Common;
use super::survey::Survey;
use super::told::Told;
use crate::cli::contents::plural;
use crate::cli::failure::Failure;
use crate::cli::files::Files;
use crate::cli::looks::BarPlace;
use crate::cli::output;
use crate::cli::picture_file;
use crate::cli::source::Source;
use spherule::scene::SceneError;
use spherule::scene::particles::{Coloring, Particles, ReadOptions, of_frame};
use std::path::Path;
use std::process::ExitCode;

/// Makes the pictures, until one fails or is interrupted.
///
/// `files` are all files of the command but the pictures.
pub(super) fn run(job: &Job, files: &Files) -> Result<ExitCode, Failure> {
    let (particles, _) = job.typed;
    let Some(range) = particles.frames() else { return run_turn(job, files) };
    let Source::Particles(path, options) = &job.source else {
        let message = "--frame is for a file of particles: name one";
        return Err(Failure::usage("render", message));
    };
    let mut options = ReadOptions { allow_empty: true, ..ReadOptions::clone(options) };
    let frames = Frames::choose(path, &options, range)?;
    let plan = Plan::new(Some(frames), job.views.turntable())?;
    let mut job = job.clone();
    job.looks.allow_empty = true;
    check_outputs(&job, &plan, files)?;
    let mut reel = Reel::open(path, &options)?;
    let survey = look_at(&job, &plan, path, &options, &mut reel)?;
    survey.check(path)?;
    survey.fix_radius(&mut options);
    if let (Coloring::Column(colors), Some(ends)) = (&mut job.looks.coloring, survey.ends) {
        colors.ends.get_or_insert(ends);
    }
    tell_framing(&job, &plan);
    Sequence { job, plan, files, told: Told::default() }.of_frames(path, &options, reel, &survey)
}

/// Makes the pictures of a turn around one scene.
fn run_turn(job: &Job, files: &Files) -> Result<ExitCode, Failure> {
    if let Source::Particles(path, _) = &job.source
        && plan::is_stream(path)
    {
        let message = format!(
            "--turntable reads its file for every picture, but {} can be read only once: write it to \
             a file",
            stream_name(path)
        );
        return Err(Failure::usage("render", message));
    }
    let plan = Plan::new(None, job.views.turntable())?;
    check_outputs(job, &plan, files)?;
    Sequence { job: job.clone(), plan, files, told: Told::default() }.of_turn()
}

/// Finds out whether all pictures can be written, and replace no other file of the command, as far as their
/// number is known.
fn check_outputs(job: &Job, plan: &Plan, files: &Files) -> Result<(), Failure> {
    let known = (0..plan.count().unwrap_or(1)).map_while(|index| plan.shot(index));
    let mut files = files.clone();
    for shot in known {
        let output = numbered(&job.output, shot.number, plan.digits());
        files.writes("--output", &output);
        picture_file::check(&output)?;
    }
    files.check()
}

/// Looks at all frames that are shown or, of what can be read only once, at the first.
fn look_at(
    job: &Job,
    plan: &Plan,
    path: &Path,
    options: &ReadOptions,
    reel: &mut Reel,
) -> Result<Survey, Failure> {
    let mut survey = Survey::default();
    let add = |survey: &mut Survey, number: u64, frame| {
        let particles = of_frame(path, frame, options)?;
        survey.add(job, particles, options).map_err(|error| error.of_frame(number))
    };
    if plan.count().is_none() {
        if let Some(number) = plan.shot(0).and_then(|shot| shot.frame)
            && let Some(frame) = reel.look(number)?
        {
            add(&mut survey, number, frame)?;
        }
        return Ok(survey);
    }
    let mut first_pass = Reel::open(path, options)?;
    let mut last = None;
    for number in plan.shots().filter_map(|shot| shot.frame) {
        if last.replace(number) == Some(number) {
            continue;
        }
        let Some(frame) = first_pass.take(number)? else { break };
        add(&mut survey, number, frame)?;
    }
    if let Some(error) =
        plan.rest().or_else(|| plan.open_end().and_then(|end| first_pass.rest(end)))
    {
        output::warn(format_args!("{error}\nthe frames before it are drawn"));
    }
    Ok(survey)
}

/// Says what the camera frames.
fn tell_framing(job: &Job, plan: &Plan) {
    if job.report.quiet {
        return;
    }
    match (plan.frame_count(), plan.count()) {
        (Some(frames), Some(pictures)) if job.views.turntable().is_some() => {
            let (frames, pictures) = (plural(frames, "frame"), plural(pictures, "picture"));
            output::note(format_args!("{pictures} of a turn show {frames}; the camera frames all"));
        }
        (Some(frames), _) => {
            output::note(format_args!("the camera frames all of {}", plural(frames, "frame")));
        }
        _ => output::note("the camera frames the first frame: the input can be read only once"),
    }
}

/// What can be read only once, as users know it.
fn stream_name(path: &Path) -> String {
    if path.as_os_str() == "-" { "standard input".to_owned() } else { path.display().to_string() }
}

/// Pictures that are made one after another.
struct Sequence<'a> {
    job: Job<'a>,
    plan: Plan,
    files: &'a Files,
    told: Told,
}

impl Sequence<'_> {
    fn of_turn(mut self) -> Result<ExitCode, Failure> {
        for shot in self.plan.shots() {
            let code = self.picture(&shot, None, None)?;
            if code != ExitCode::SUCCESS {
                return Ok(code);
            }
        }
        self.told.finish("numbers");
        Ok(ExitCode::SUCCESS)
    }

    fn of_frames(
        mut self,
        path: &Path,
        options: &ReadOptions,
        mut reel: Reel,
        survey: &Survey,
    ) -> Result<ExitCode, Failure> {
        for warning in &survey.warnings {
            self.told.warn(warning);
        }
        let mut code = ExitCode::SUCCESS;
        let mut made = 0;
        while let Some(shot) = self.plan.shot(made) {
            let Some(number) = shot.frame else { break };
            let again = self.plan.shot(made + 1).is_some_and(|next| next.frame == shot.frame);
            let frame = if again { reel.look(number)? } else { reel.take(number)? };
            let Some(frame) = frame else { break };
            let angle = shot.turn.map(|turn| self.job.views.angle(turn));
            let result = of_frame(path, frame, options).map_err(Failure::from);
            let result = result.and_then(|particles| {
                let common = survey.common(&self.job, angle)?;
                self.picture(&shot, Some(particles), Some(common))
            });
            code = result.map_err(|error| error.of_frame(number))?;
            if code != ExitCode::SUCCESS {
                break;
            }
            made += 1;
        }
        self.told.finish(if self.plan.is_turn() { "numbers" } else { "frames" });
        if code == ExitCode::SUCCESS {
            self.plan.check_end(path, reel.passed())?;
        }
        Ok(code)
    }

    fn picture(
        &mut self,
        shot: &Shot,
        particles: Option<Particles>,
        common: Option<Common>,
    ) -> Result<ExitCode, Failure> {
        let output = numbered(&self.job.output, shot.number, self.plan.digits());
        let Shot { frame, turn, .. } = *shot;
        let job = Job { output, turn, frame, common, ..self.job.clone() };
        picture_file::check(&job.output)?;
        if self.plan.count().is_none() {
            self.files.check_output("--output", &job.output)?;
        }
        self.told.begin(shot.number);
        let mut prepared = Prepared::load(&job, particles)?;
        if self.plan.is_stream() && prepared.world.centers_out_of_view() > 0 {
            self.told.see_cropped();
        }
        let code = finish_picture(&job, &mut prepared, &mut self.told, None, None)?;
        // A bar in a file is that of all pictures.
        self.job.color_bar = inside(self.job.color_bar);
        Ok(code)
    }
}

/// A color bar that every picture has.
fn inside(bar: Option<&BarPlace>) -> Option<&BarPlace> {
    bar.filter(|bar| matches!(bar, BarPlace::Inside(_)))
}

/// An error of a whole file, of which nothing is rendered.
fn refuse(path: &Path, message: String, help: String) -> Failure {
    SceneError::whole_file(path, message).with_help(help).into()
}
