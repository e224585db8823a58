//! One file for each table.

mod roulette;
mod spheres;
mod threads;
mod together;

pub(super) use roulette::roulette;
pub(super) use spheres::spheres;
pub(super) use threads::threads;
pub(super) use together::together;

use super::contest::{Entry, Program, Stage};
use crate::bench::{Options, Tell};
use crate::report::{Column, Style};
use crate::scene::Settings;

/// What all tables are made with.
pub(super) struct Plan<'a> {
    pub(super) options: &'a Options,
    /// Pixels along each side.
    pub(super) size: u32,
    /// Samples in each.
    pub(super) spp: u32,
    pub(super) tell: Tell<'a>,
}

impl Plan<'_> {
    fn scale(&self) -> (u32, u32) {
        (self.size, self.spp)
    }
}

impl Stage {
    /// A program that renders this as its settings say.
    fn entry(&self, program: Program, threads: usize) -> Entry<'_> {
        Entry { stage: self, program, settings: self.settings.clone(), threads }
    }
}

/// A column of times.
fn time(name: &str, about: &str) -> Column {
    Column::new(name, about).unit("s")
}

/// A column of ratios.
fn ratio(name: &str, about: &str) -> Column {
    Column::new(name, about).style(Style::Fixed(2))
}

/// The settings with another seed: pictures that are compared are not those that are timed.
fn reseeded(settings: &Settings) -> Settings {
    Settings { seed: settings.seed + 100, ..settings.clone() }
}
