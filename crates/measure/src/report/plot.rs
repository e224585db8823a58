//! Plots: series of values along an axis.

use super::Spread;

/// A plot. If the axis of places has names, it is a dot plot with a row for each name; otherwise an x-y
/// plot with places along x and values along y.
#[derive(Clone, Debug, PartialEq)]
pub struct Plot {
    /// Name; the stem of file names.
    pub name: String,
    /// Title, in a line.
    pub title: String,
    /// Subtitle: the method, in a line.
    pub about: String,
    /// Note at the bottom, in a line; may be empty.
    pub note: String,
    /// Axis of places: x, or names.
    pub place: Axis,
    /// Axis of values.
    pub value: Axis,
    /// Series; the first is drawn below the others.
    pub series: Vec<Series>,
}

/// An axis of a plot.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    /// Quantity; empty if the plot's title names it.
    pub label: String,
    /// Unit; empty for none.
    pub unit: String,
    /// Scale.
    pub scale: Scale,
    /// Limits; from the data if `None`.
    pub range: Option<[f64; 2]>,
    /// Label of zero on a logarithmic axis, where it is drawn apart; `None` if zeros are left out.
    pub zero: Option<String>,
}

/// Scale of an axis.
#[derive(Clone, Debug, PartialEq)]
pub enum Scale {
    /// Linear, from 0 on.
    Linear,
    /// Linear, with ticks at whole numbers.
    Whole,
    /// Logarithmic.
    Log,
    /// Names; places are their indices. Only for the axis of places.
    Names(Vec<String>),
}

/// A series of points.
#[derive(Clone, Debug, PartialEq)]
pub struct Series {
    /// Name in the legend.
    pub name: String,
    /// Points; those that are not finite are left out.
    pub points: Vec<Point>,
    /// Line through the points.
    pub line: Line,
    /// True if each point has a marker.
    pub marked: bool,
    /// Index of color and marker; `None` for the series' own index.
    pub color: Option<usize>,
}

/// The line through the points of a series.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Line {
    /// No line.
    None,
    /// A solid line: measured values.
    Solid,
    /// A dashed line: a model or a limit.
    Dashed,
}

/// A value and its place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// Position on the axis of places.
    pub place: f64,
    /// The value, with its error bar.
    pub value: Spread,
}

impl Axis {
    /// Returns a linear axis from 0 on.
    pub fn linear(label: &str, unit: &str) -> Self {
        Self {
            label: label.to_owned(),
            unit: unit.to_owned(),
            scale: Scale::Linear,
            range: None,
            zero: None,
        }
    }

    /// Returns an axis of whole numbers from 0 on.
    pub fn whole(label: &str) -> Self {
        Self { scale: Scale::Whole, ..Self::linear(label, "") }
    }

    /// Returns a logarithmic axis.
    pub fn log(label: &str, unit: &str) -> Self {
        Self { scale: Scale::Log, ..Self::linear(label, unit) }
    }

    /// Returns an axis of names, from top to bottom.
    pub fn names<T: Into<String>>(names: impl IntoIterator<Item = T>) -> Self {
        let names = names.into_iter().map(Into::into).collect();
        Self { scale: Scale::Names(names), ..Self::linear("", "") }
    }

    /// Returns label and unit, as in `time (s)`. Percent signs are written at each tick instead.
    pub fn heading(&self) -> String {
        match self.unit.as_str() {
            "" | "%" => self.label.clone(),
            unit => format!("{} ({unit})", self.label),
        }
    }
}

impl Series {
    /// Returns a series of markers.
    pub fn marks(name: impl Into<String>, points: impl IntoIterator<Item = Point>) -> Self {
        let points = points.into_iter().collect();
        Self { name: name.into(), points, line: Line::None, marked: true, color: None }
    }

    /// Returns a series of markers with a solid line.
    pub fn joined(name: impl Into<String>, points: impl IntoIterator<Item = Point>) -> Self {
        Self { line: Line::Solid, ..Self::marks(name, points) }
    }

    /// Returns a dashed line in the color of another series, for a model or a limit.
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
    /// Returns a point without error bar.
    pub fn new(place: f64, value: f64) -> Self {
        Self { place, value: Spread::exactly(value) }
    }

    /// Returns a point with an error bar.
    pub fn spread(place: f64, value: Spread) -> Self {
        Self { place, value }
    }
}
