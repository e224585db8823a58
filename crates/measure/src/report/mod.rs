//! Reports of measurements: tables and plots as values, and their conversion to files.
//!
//! A [`Report`] is the result of a measurement. It holds [`Table`]s, whose columns have names, units
//! and descriptions, and [`Plot`]s of series along axes. [`Table::text`], [`Table::csv`] and
//! [`Report::json`] format tables, [`draw`](draw::draw) draws plots, and [`page`](html::page) puts
//! everything on a self-contained HTML page.

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

/// The result of a measurement.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Report {
    /// Name; the stem of file names.
    pub name: String,
    /// Title, in a line.
    pub title: String,
    /// Description of the method, in a few sentences.
    pub about: String,
    /// Names and values of the options.
    pub settings: Vec<(String, String)>,
    /// Tables.
    pub tables: Vec<Table>,
    /// Plots.
    pub plots: Vec<Plot>,
}
