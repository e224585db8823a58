//! The paper's tables, and the combined one.

mod combined;
mod roulette;
mod spheres;
mod threads;

pub(super) use combined::combined;
pub(super) use roulette::roulette;
pub(super) use spheres::spheres;
pub(super) use threads::threads;

use super::comparison::{Entry, Program, SceneSetup};
use crate::bench::{Options, Progress};
use crate::report::{Column, Style};
use spherule_render::scene::Settings;

/// Options of all tables.
pub(super) struct Plan<'a> {
    pub(super) options: &'a Options,
    /// Width and height in pixels.
    pub(super) size: u32,
    /// Samples per pixel.
    pub(super) spp: u32,
    pub(super) progress: Progress<'a>,
}

impl SceneSetup {
    /// Returns the entry of a program with the scene's settings.
    fn entry(&self, program: Program, threads: usize) -> Entry<'_> {
        Entry { setup: self, program, settings: self.settings.clone(), threads }
    }
}

/// Returns a column of times.
fn time(name: &str, about: &str) -> Column {
    Column::new(name, about).unit("s")
}

/// Returns a column of ratios.
fn ratio(name: &str, about: &str) -> Column {
    Column::new(name, about).style(Style::Fixed(2))
}

/// Returns the settings with another seed, so that compared images are not those that are timed.
fn reseeded(settings: &Settings) -> Settings {
    Settings { seed: settings.seed + 100, ..settings.clone() }
}
