//! What was measured, as values: tables and plots, and the files that they become.
//!
//! A [`Report`] is what a measurement hands over. It holds [`Table`]s, of columns with names, units
//! and meanings, and [`Plot`]s, of series along axes. These know nothing of files: [`Table::text`],
//! [`Table::csv`] and [`Report::json`] write tables, [`draw`](draw::draw) draws plots, and
//! [`page`](html::page) puts everything on one page that refers to nothing outside.

pub mod draw;
mod files;
pub mod html;
mod machine;
mod number;
mod plot;
mod spread;
mod table;
mod text;

pub use machine::Machine;
pub use number::Style;
pub use plot::{Axis, Line, Plot, Point, Scale, Series};
pub use spread::Spread;
pub use table::{Cell, Column, Table};

/// What one measurement found.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Report {
    /// A word; files are called by it.
    pub name: String,
    /// What was measured, in a line.
    pub title: String,
    /// How it was measured and what to mind, in a few sentences.
    pub about: String,
    /// What was asked for, by name.
    pub settings: Vec<(String, String)>,
    /// The numbers.
    pub tables: Vec<Table>,
    /// The pictures of some of them.
    pub plots: Vec<Plot>,
}
