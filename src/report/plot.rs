//! Plots: series of values along an axis.

use super::Spread;

/// A plot. Where the places on its first axis are names, each is a line with marks to its right;
/// else it is a plane with places to the right and values upward.
#[derive(Clone, Debug, PartialEq)]
pub struct Plot {
    /// A word; files are called by it.
    pub name: String,
    /// What it shows, in a line.
    pub title: String,
    /// How it was measured, in a line below the title.
    pub about: String,
    /// What to mind, in a line at the foot; may be empty.
    pub note: String,
    /// Where values are.
    pub place: Axis,
    /// The values.
    pub value: Axis,
    /// What is compared; the first is drawn below the others.
    pub series: Vec<Series>,
}

/// One of the axes.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    /// What it shows; empty if the plot's title says so.
    pub label: String,
    /// Its unit; empty for none.
    pub unit: String,
    /// How numbers go along it.
    pub scale: Scale,
    /// Its ends; from the data if there are none.
    pub range: Option<[f64; 2]>,
    /// What zero is called on a logarithmic axis, where it stands apart; `None` if zero is left out.
    pub zero: Option<String>,
}

/// How numbers go along an axis.
#[derive(Clone, Debug, PartialEq)]
pub enum Scale {
    /// By their differences, from 0 on.
    Linear,
    /// The same, of whole numbers.
    Whole,
    /// By their ratios.
    Log,
    /// Names: places are their indices. For places alone.
    Names(Vec<String>),
}

/// Values that belong together.
#[derive(Clone, Debug, PartialEq)]
pub struct Series {
    /// What it is.
    pub name: String,
    /// Its values; those that are not finite are left out.
    pub points: Vec<Point>,
    /// What joins them.
    pub line: Line,
    /// Whether each has a mark.
    pub marked: bool,
    /// Number of its color and mark; `None` for its own number among the series.
    pub color: Option<usize>,
}

/// What joins the points of a series.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Line {
    /// Nothing.
    None,
    /// A line: measured values in an order.
    Solid,
    /// A dashed line: a model or a limit.
    Dashed,
}

/// A value and where it is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// Place on the first axis.
    pub place: f64,
    /// The value, with the ends of its error bar.
    pub value: Spread,
}

impl Axis {
    /// From 0 on.
    pub fn linear(label: &str, unit: &str) -> Self {
        Self {
            label: label.to_owned(),
            unit: unit.to_owned(),
            scale: Scale::Linear,
            range: None,
            zero: None,
        }
    }

    /// Whole numbers from 0 on.
    pub fn whole(label: &str) -> Self {
        Self { scale: Scale::Whole, ..Self::linear(label, "") }
    }

    /// Logarithmic.
    pub fn log(label: &str, unit: &str) -> Self {
        Self { scale: Scale::Log, ..Self::linear(label, unit) }
    }

    /// Names, one below the other.
    pub fn names<T: Into<String>>(names: impl IntoIterator<Item = T>) -> Self {
        let names = names.into_iter().map(Into::into).collect();
        Self { scale: Scale::Names(names), ..Self::linear("", "") }
    }

    /// Label and unit, as in `time (s)`; percent are written at each number.
    pub fn heading(&self) -> String {
        match self.unit.as_str() {
            "" | "%" => self.label.clone(),
            unit => format!("{} ({unit})", self.label),
        }
    }
}

impl Series {
    /// Marks.
    pub fn marks(name: impl Into<String>, points: impl IntoIterator<Item = Point>) -> Self {
        let points = points.into_iter().collect();
        Self { name: name.into(), points, line: Line::None, marked: true, color: None }
    }

    /// Marks that are joined.
    pub fn joined(name: impl Into<String>, points: impl IntoIterator<Item = Point>) -> Self {
        Self { line: Line::Solid, ..Self::marks(name, points) }
    }

    /// A dashed line in the color of another series: a model of it, or a limit.
    pub fn model(
        name: impl Into<String>,
        points: impl IntoIterator<Item = Point>,
        color: usize,
    ) -> Self {
        let marks = Self::marks(name, points);
        Self { line: Line::Dashed, marked: false, color: Some(color), ..marks }
    }
}

impl Point {
    /// A value that does not vary.
    pub fn new(place: f64, value: f64) -> Self {
        Self { place, value: Spread::exactly(value) }
    }

    /// A value that was measured several times.
    pub fn spread(place: f64, value: Spread) -> Self {
        Self { place, value }
    }
}
