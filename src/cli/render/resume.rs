//! Renders that go on from a file.

use super::job::Job;
use super::layers;
use super::prepare::Prepared;
use crate::cli::Failure;
use crate::cli::args::RenderArgs;
use crate::cli::command::{Given, TypedOptions, render_command};
use crate::cli::settings::region_text;
use clap::{ArgMatches, FromArgMatches};
use spherule::checkpoint::{self, Origin};
use spherule::render::Unfinished;
use spherule::scene::Settings;
use std::ffi::OsString;
use std::path::{Path, PathBuf};

/// A render that goes on.
pub(super) struct Resumed {
    path: PathBuf,
    origin: Origin,
    render: Unfinished,
}

impl Resumed {
    /// Reads a render, and what is to be done: what was typed when it began, but for what is given
    /// now; and how that is given in the folder of the beginning.
    pub(super) fn read(path: &Path, now: Given) -> Result<(Self, RenderArgs, Given), Failure> {
        let (origin, render) = checkpoint::read(path)?;
        let command = render_command();
        let then = TypedOptions::of(&command, &parse(origin.arguments.clone())?);
        let folder = PathBuf::from(&origin.folder);
        // If it is gone, all may have moved to where this is typed.
        let found = if folder.is_dir() { then.clone().typed_in(&folder) } else { then.clone() };
        let matches = parse(found.with(now.typed.clone()).arguments(&command))?;
        let args = RenderArgs::from_arg_matches(&matches).map_err(Failure::Usage)?;
        let given = Given { folder, typed: then.with(now.typed.typed_in(&now.folder)) };
        Ok((Self { path: path.to_owned(), origin, render }, args, given))
    }

    /// The same failure as of a render that cannot go on.
    pub(super) fn refuse(self, why: &str) -> Failure {
        Failure::Resume(self.path, why.to_owned())
    }

    /// The render, if it can go on as it is typed now.
    pub(super) fn go_on(mut self, job: &Job, prepared: &Prepared) -> Result<Unfinished, Failure> {
        match self.difference(job, prepared) {
            None => Ok(self.render),
            Some(why) => Err(Failure::Resume(self.path, why)),
        }
    }

    /// What does not fit the render that was begun.
    fn difference(&mut self, job: &Job, prepared: &Prepared) -> Option<String> {
        let (then, now) = (self.render.settings(), &prepared.scene.settings);
        let targets = |of: &Settings| (of.spp, of.until_error, of.time);
        if job.is_of_sequence() && targets(then) != targets(now) {
            let why = "the pictures of a sequence would differ; leave --spp, --until-error and --time \
                       as they were";
            return Some(why.to_owned());
        }
        if let Err(error) = self.render.raise(&prepared.scene.settings) {
            return Some(error.to_string());
        }
        let (then, now) = (self.render.region(), prepared.region);
        if then != now {
            let (then, now) = (region_text(then), region_text(now));
            return Some(format!("the region is {now}, but was {then}; leave it as it was"));
        }
        let (then, now) = (self.render.share(), &prepared.share);
        if then != now {
            return Some(format!(
                "it has {then}, and this command would render {now}; leave --part and --split as \
                 they were, or remove the file"
            ));
        }
        if layers::need_statistics(job) && !self.render.statistics() {
            let why = "--layers variance and samples take what was not measured from the \
                       beginning; leave them out";
            return Some(why.to_owned());
        }
        let part = prepared.identity.as_ref()?.difference(&self.origin.scene)?;
        Some(format!(
            "the {part} of {} changed since the render began; restore the scene, or begin anew",
            job.source.name()
        ))
    }
}

fn parse(arguments: Vec<OsString>) -> Result<ArgMatches, Failure> {
    let line = std::iter::once(OsString::from("render")).chain(arguments);
    render_command().try_get_matches_from(line).map_err(Failure::Usage)
}
