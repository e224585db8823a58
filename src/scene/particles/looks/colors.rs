//! Colors of elements and of columns.

use super::columns::{self, Column};
use crate::color::elements::{cpk, jmol};
use crate::color::{Map, Range, RangeError, Rgb, Scale, Spacing, category};
use crate::scene::FileError;
use crate::scene::particles::Codes;
use crate::scene::particles::{Element, LengthUnit, Particles};
use std::collections::HashMap;
use std::path::Path;

/// A scheme of colors for elements.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ElementColors {
    /// Jmol's.
    #[default]
    Jmol,
    /// After Corey, Pauling and Koltun, in the shades of `RasMol`.
    Cpk,
}

impl ElementColors {
    /// The linear color of an element; gray where the scheme has none, or the element is unknown.
    pub fn of(self, element: Option<Element>) -> Rgb {
        let color = element.and_then(|element| match self {
            Self::Jmol => jmol(element.number()),
            Self::Cpk => cpk(element.number()),
        });
        color.unwrap_or(Rgb::splat(0.5))
    }

    pub(super) fn apply(self, path: &Path, particles: &mut Particles) -> Result<(), FileError> {
        let kinds = &particles.kinds;
        if kinds.table.iter().all(|kind| kind.element.is_none()) {
            let message = "colors of elements are asked for, but no particle has an element";
            let help = "name the column of elements, as in type=NAME, or color by a column";
            return Err(FileError::whole_file(path, message).with_help(help));
        }
        let table: Vec<Rgb> = kinds.table.iter().map(|kind| self.of(kind.element)).collect();
        particles.spheres.color = picked(&kinds.codes, &table);
        Ok(())
    }
}

/// How a column becomes colors: numbers by a map, texts by a color for each, which come again after
/// [`CATEGORIES`](crate::color::CATEGORIES) of them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ColumnColors {
    /// The column: one of the file, or `x`, `y`, `z`, `radius`, `type`, `element`, `id`.
    pub column: String,
    /// The colors of numbers; `None` for the usual ones.
    pub map: Option<Map>,
    /// True if the map's high end is at the low end of the numbers.
    pub reversed: bool,
    /// The numbers that the map's ends stand for, and for all beyond them; `None` for the least and
    /// the greatest there are.
    pub ends: Option<[f64; 2]>,
    /// How numbers are spaced between the ends.
    pub spacing: Spacing,
}

/// What the colors of a picture stand for.
#[derive(Clone, Debug, PartialEq)]
pub struct Legend {
    /// From numbers to colors.
    pub scale: Scale,
    /// What the numbers are, with their unit if it is known.
    pub label: String,
}

impl ColumnColors {
    pub(super) fn apply(
        &self,
        path: &Path,
        particles: &mut Particles,
        allow_empty: bool,
    ) -> Result<Option<Legend>, FileError> {
        let column = Column::find(particles, &self.column)
            .ok_or_else(|| columns::missing(path, particles, &self.column))?;
        let (colors, legend, missing) = match &column {
            Column::Numbers(values) => match self.scale(values) {
                Ok(scale) => {
                    let legend = Legend { scale, label: self.label(particles.unit) };
                    (scale.colors(values), Some(legend), missing(values))
                }
                Err(RangeError::Empty | RangeError::NonePositive) if allow_empty => {
                    (Vec::new(), None, missing(values))
                }
                Err(error) => return Err(self.no_colors(path, error)),
            },
            Column::Texts { names, codes } => {
                self.check_texts(path)?;
                (picked(codes, &categories(names)), None, 0)
            }
        };
        particles.spheres.color = colors;
        if missing > 0 {
            let (path, name) = (path.display(), &self.column);
            let warning = format!("{path}: gray for want of `{name}`: {missing} of the particles");
            particles.warnings.push(warning);
        }
        Ok(legend)
    }

    /// Returns whether the column is one of numbers.
    pub fn is_numeric(&self, particles: &Particles) -> bool {
        matches!(Column::find(particles, &self.column), Some(Column::Numbers(_)))
    }

    /// The error for a column of numbers that have no range.
    pub fn no_range(&self, path: &Path) -> FileError {
        let error = match self.spacing {
            Spacing::Linear => RangeError::Empty,
            Spacing::Logarithmic => RangeError::NonePositive,
        };
        self.no_colors(path, error)
    }

    fn no_colors(&self, path: &Path, error: RangeError) -> FileError {
        let message = format!("the column `{}` has no colors: {error}", self.column);
        FileError::whole_file(path, message)
    }

    /// Returns the legend where there is no particle: known if the ends of the map are.
    pub(super) fn legend_of_ends(&self, unit: LengthUnit) -> Option<Legend> {
        let scale = self.ends.and_then(|_| self.scale(&[]).ok())?;
        Some(Legend { scale, label: self.label(unit) })
    }

    fn scale(&self, values: &[f64]) -> Result<Scale, RangeError> {
        let range = match self.ends {
            Some([low, high]) => Range::new(low, high, self.spacing),
            None => Range::of(values, self.spacing),
        };
        let scale = Scale::new(self.map.unwrap_or_default(), range?);
        Ok(Scale { reversed: self.reversed, ..scale })
    }

    /// Maps and ranges are for numbers.
    fn check_texts(&self, path: &Path) -> Result<(), FileError> {
        if self.map.is_none() && self.ends.is_none() && self.spacing == Spacing::Linear {
            return Ok(());
        }
        let message = format!(
            "the column `{}` holds texts, each with a color of its own: there is no map and no range",
            self.column
        );
        Err(FileError::whole_file(path, message).with_help("name a column of numbers"))
    }

    /// The column, and the unit of lengths.
    fn label(&self, unit: LengthUnit) -> String {
        let lengths = ["x", "y", "z", "radius", "diameter"];
        let is_length = lengths.iter().any(|name| name.eq_ignore_ascii_case(&self.column));
        if is_length && unit != LengthUnit::Unknown {
            format!("{} ({})", self.column, unit.name())
        } else {
            self.column.clone()
        }
    }
}

fn missing(values: &[f64]) -> usize {
    values.iter().filter(|value| value.is_nan()).count()
}

/// The colors of texts: those that are the same have the same color.
fn categories(names: &[&str]) -> Vec<Rgb> {
    let mut places = HashMap::new();
    let mut place = |name| {
        let next = places.len();
        *places.entry(name).or_insert(next)
    };
    names.iter().map(|&name| category(place(name))).collect()
}

/// The color of each row.
fn picked(codes: &Codes, table: &[Rgb]) -> Vec<Rgb> {
    (0..codes.len()).map(|row| table[codes.code(row) as usize]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_that_are_the_same_have_one_color() {
        assert_eq!(categories(&["C", "N", "C", "O"]), [0, 1, 0, 2].map(category));
    }
}
