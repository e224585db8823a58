//! Resuming of renders from checkpoints.

use super::invocation::{CommandOptions, Invocation};
use crate::cli::failure::Failure;
use crate::cli::options::lists::region_text;
use crate::cli::render::args::RenderArgs;
use crate::cli::render::prepare::Prepared;
use crate::cli::render::setup::RenderSetup;
use clap::{ArgMatches, Command, FromArgMatches};
use spherule_render::checkpoint::{self, Origin};
use spherule_render::render::ResumableRender;
use spherule_render::scene::Settings;
use std::ffi::OsString;
use std::path::{Path, PathBuf};

/// A resumed render.
pub(in crate::cli) struct Resumed {
    path: PathBuf,
    origin: Origin,
    render: ResumableRender,
}

impl Resumed {
    /// Reads a checkpoint. Returns the render and its arguments: those stored in the checkpoint, overridden
    /// by those of the command line, with paths relative to the folder where the render started.
    pub(in crate::cli) fn read(
        path: &Path,
        now: Invocation,
    ) -> Result<(Self, RenderArgs, Invocation), Failure> {
        let (origin, render) = checkpoint::read(path)?;
        let command = now.command;
        let then = CommandOptions::of(&command, &parse(&command, origin.arguments.clone())?);
        let folder = PathBuf::from(&origin.folder);
        // If the folder does not exist any more, the files may have moved to the current one.
        let found = if folder.is_dir() { then.clone().relative_to(&folder) } else { then.clone() };
        let matches = parse(&command, found.with(now.typed.clone()).arguments(&command))?;
        let args = RenderArgs::from_arg_matches(&matches).map_err(Failure::Arguments)?;
        let typed = then.with(now.typed.relative_to(&now.folder));
        let given = Invocation { command, folder, typed };
        Ok((Self { path: path.to_owned(), origin, render }, args, given))
    }

    /// Converts an error to that of a render that cannot resume.
    pub(in crate::cli) fn refuse(self, why: &str) -> Failure {
        Failure::Resume(self.path, why.to_owned())
    }

    /// Returns the render, if it can resume with these arguments.
    pub(in crate::cli) fn into_render(
        mut self,
        setup: &RenderSetup,
        prepared: &Prepared,
    ) -> Result<ResumableRender, Failure> {
        match self.difference(setup, prepared) {
            None => Ok(self.render),
            Some(why) => Err(Failure::Resume(self.path, why)),
        }
    }

    /// Returns the reason why the arguments do not match the render.
    fn difference(&mut self, setup: &RenderSetup, prepared: &Prepared) -> Option<String> {
        let (then, now) = (self.render.settings(), &prepared.scene.settings);
        let targets = |of: &Settings| (of.spp, of.until_error, of.time);
        if setup.is_of_sequence() && targets(then) != targets(now) {
            let why = "the images of the sequence would differ; use the same --spp, --until-error and --time \
                       as before";
            return Some(why.to_owned());
        }
        if let Err(error) = self.render.extend(&prepared.scene.settings) {
            return Some(error.to_string());
        }
        let (then, now) = (self.render.region(), prepared.region);
        if then != now {
            let (then, now) = (region_text(then), region_text(now));
            return Some(format!(
                "the region is {now}, but was {then}; use the same --region as before"
            ));
        }
        let (then, now) = (self.render.part(), &prepared.part);
        if then != now {
            return Some(format!(
                "it has {then}, but this command would render {now}; use the same --part and --split as \
                 before, or delete the file"
            ));
        }
        if setup.encoding.needs_statistics() && !self.render.statistics() {
            let why = "--layers variance and samples need statistics from the start of the render; remove \
                       them";
            return Some(why.to_owned());
        }
        let part = prepared.identity.as_ref()?.difference(&self.origin.scene)?;
        Some(format!(
            "the {part} of {} changed since the render started; restore the scene, or start a new render",
            setup.source.name()
        ))
    }
}

fn parse(command: &Command, arguments: Vec<OsString>) -> Result<ArgMatches, Failure> {
    let line = std::iter::once(OsString::from("render")).chain(arguments);
    command.clone().try_get_matches_from(line).map_err(Failure::Arguments)
}
