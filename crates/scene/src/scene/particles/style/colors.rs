//! Colors of elements and of columns.

use super::Coloring;
use super::columns::Column;
use crate::color;
use crate::color::elements::{cpk, jmol};
use crate::color::{Map, Range, RangeError, Rgb, Scale, Spacing, category};
use crate::scene::FileError;
use crate::scene::particles::Codes;
use crate::scene::particles::select::expression;
use crate::scene::particles::{Element, LengthUnit, Particles};
use crate::suggest;
use std::collections::HashMap;
use std::path::Path;

/// A color scheme of elements.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ElementColors {
    /// Jmol's.
    #[default]
    Jmol,
    /// After Corey, Pauling and Koltun, in the shades of `RasMol`.
    Cpk,
}

impl ElementColors {
    /// Returns the linear color of an element; gray if the element is unknown or has no color in the
    /// scheme.
    pub fn of(self, element: Option<Element>) -> Rgb {
        let color = element.and_then(|element| match self {
            Self::Jmol => jmol(element.number()),
            Self::Cpk => cpk(element.number()),
        });
        color.unwrap_or(Rgb::splat(0.5))
    }

    /// Returns the colors of some rows; `None` for all rows.
    fn paint(
        self,
        path: &Path,
        particles: &Particles,
        rows: Option<&[usize]>,
    ) -> Result<Vec<Rgb>, FileError> {
        let kinds = &particles.frame.kinds;
        if kinds.table.iter().all(|kind| kind.element.is_none()) {
            let message = "cannot color by element: no particle has an element";
            let help = "name the column of elements, as in type=NAME, or color by a column";
            return Err(FileError::whole_file(path, message).with_help(help));
        }
        let table: Vec<Rgb> = kinds.table.iter().map(|kind| self.of(kind.element)).collect();
        Ok(match rows {
            Some(rows) => rows.iter().map(|&row| table[kinds.codes.code(row) as usize]).collect(),
            None => table_colors(&kinds.codes, &table),
        })
    }
}

impl Coloring {
    /// Returns the colors of some rows, `None` for all rows; nothing if they keep those that they have.
    pub(super) fn paint(
        &self,
        path: &Path,
        particles: &Particles,
        rows: Option<&[usize]>,
        allow_empty: bool,
    ) -> Result<Option<Painted>, FileError> {
        let plain = |colors| Painted { colors, legend: None, warnings: Vec::new() };
        Ok(Some(match self {
            Self::Usual => return Ok(None),
            Self::Uniform(color) => {
                plain(vec![*color; rows.map_or(particles.spheres.len(), <[usize]>::len)])
            }
            Self::Elements(scheme) => plain(scheme.paint(path, particles, rows)?),
            Self::Column(colors) => colors.paint(path, particles, rows, allow_empty)?,
        }))
    }
}

/// Colors of particles by a column: numbers by a color map, texts by one color each, which repeat after
/// [`CATEGORIES`](crate::color::CATEGORIES) texts.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ColumnColors {
    /// The column: one of the file, or `x`, `y`, `z`, `radius`, `type`, `element`, `id`; or an expression over columns, in
    /// the language of [`Selection`](crate::scene::particles::Selection)s, as in `norm(velocity)` and `c_pe / mass`.
    pub column: String,
    /// Color map for numbers; `None` is the default map.
    pub map: Option<Map>,
    /// True if the color map is reversed.
    pub reversed: bool,
    /// Numbers at the ends of the map; numbers beyond them are clamped. `None` is the column's range.
    pub ends: Option<[f64; 2]>,
    /// Spacing of numbers between the ends.
    pub spacing: Spacing,
}

/// Meaning of the colors of a picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Legend {
    /// Map from numbers to colors.
    pub scale: Scale,
    /// Label: the quantity, with its unit if it is known.
    pub label: String,
}

/// The colors of rows, and what is to be said of them.
pub(super) struct Painted {
    /// Linear colors; empty if no value has one.
    pub(super) colors: Vec<Rgb>,
    /// Their meaning, if they stand for numbers.
    pub(super) legend: Option<Legend>,
    pub(super) warnings: Vec<String>,
}

impl ColumnColors {
    /// Returns the column, or the numbers of the expression.
    pub(super) fn column_of<'p>(
        &self,
        path: &Path,
        particles: &'p Particles,
    ) -> Result<Column<'p>, FileError> {
        expression::evaluate(path, particles, &self.column).map_err(|error| match suggest::nearest(
            &self.column,
            color::names(),
        ) {
            Some(near) if error.help.is_none() => {
                error.with_help(format!("the color `{near}` has a similar name"))
            }
            _ => error,
        })
    }

    /// Returns the colors of some rows, whose values have the range of colors if none is given; `None` for all rows.
    pub(super) fn paint(
        &self,
        path: &Path,
        particles: &Particles,
        rows: Option<&[usize]>,
        allow_empty: bool,
    ) -> Result<Painted, FileError> {
        let mut column = self.column_of(path, particles)?;
        if let Some(rows) = rows {
            column = column.of_rows(rows);
        }
        let (mut undefined, mut warnings) = (0, Vec::new());
        let (colors, legend, missing) = match &column {
            Column::Numbers(values) => match self.scale(values) {
                Ok(scale) => {
                    let legend = Legend { scale, label: self.label(particles.frame.unit) };
                    let has_no_place = |value: &&f64| scale.range.is_undefined(**value);
                    undefined = values.iter().filter(has_no_place).count() - missing(values);
                    (scale.colors(values), Some(legend), missing(values))
                }
                Err(RangeError::Empty | RangeError::NonePositive) if allow_empty => {
                    (Vec::new(), None, missing(values))
                }
                Err(error) => return Err(self.scale_error(path, error)),
            },
            Column::Texts { names, codes } => {
                self.check_texts(path)?;
                (table_colors(codes, &categories(names)), None, 0)
            }
        };
        if missing > 0 {
            let (path, name) = (path.display(), &self.column);
            let (particles_have, are) = words(missing);
            let warning = format!(
                "{path}: {missing} {particles_have} no value of `{name}` and {are} drawn in gray"
            );
            warnings.push(warning);
        }
        if undefined > 0 {
            let (path, name) = (path.display(), &self.column);
            let (particles_have, are) = words(undefined);
            let warning = format!(
                "{path}: {undefined} {particles_have} a `{name}` of 0 or less, which has no place on a logarithmic \
                 scale, and {are} drawn in gray"
            );
            warnings.push(warning);
        }
        Ok(Painted { colors, legend, warnings })
    }

    /// Returns whether the column holds numbers.
    pub fn is_numeric(&self, particles: &Particles) -> bool {
        matches!(self.column_of(Path::new(""), particles), Ok(Column::Numbers(_)))
    }

    /// Returns the error for a column without a range.
    pub fn range_error(&self, path: &Path) -> FileError {
        let error = match self.spacing {
            Spacing::Linear => RangeError::Empty,
            Spacing::Logarithmic => RangeError::NonePositive,
        };
        self.scale_error(path, error)
    }

    fn scale_error(&self, path: &Path, error: RangeError) -> FileError {
        let message = format!("cannot color by the column `{}`: {error}", self.column);
        FileError::whole_file(path, message)
    }

    /// Returns the legend if there are no particles: known if the ends of the map are given.
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

    /// Checks that neither a map nor a range is given, which are for numbers.
    fn check_texts(&self, path: &Path) -> Result<(), FileError> {
        if self.map.is_none() && self.ends.is_none() && self.spacing == Spacing::Linear {
            return Ok(());
        }
        let message = format!(
            "the column `{}` holds texts, to which color map and range do not apply",
            self.column
        );
        Err(FileError::whole_file(path, message).with_help("name a column of numbers"))
    }

    /// Returns the name of the column, with the unit if it is a length.
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

/// Returns the map with a name, and whether it is reversed, as one whose name ends in `_r`.
///
/// # Errors
///
/// There is no such map; the names.
pub fn map_named(name: &str) -> Result<(Map, bool), String> {
    let (stem, reversed) = name.strip_suffix("_r").map_or((name, false), |stem| (stem, true));
    let map = Map::named(stem).ok_or_else(|| {
        let help = suggest::help(stem, Map::ALL.into_iter().map(Map::name), "maps are");
        format!("unknown color map `{name}`; {help} (each also reversed, with _r)")
    })?;
    Ok((map, reversed))
}

/// Returns subject and verbs for so many particles.
fn words(count: usize) -> (&'static str, &'static str) {
    if count == 1 { ("particle has", "is") } else { ("particles have", "are") }
}

fn missing(values: &[f64]) -> usize {
    values.iter().filter(|value| value.is_nan()).count()
}

/// Returns the colors of texts: equal texts have equal colors.
fn categories(names: &[&str]) -> Vec<Rgb> {
    let mut indices = HashMap::new();
    let mut index = |name| {
        let next = indices.len();
        *indices.entry(name).or_insert(next)
    };
    names.iter().map(|&name| category(index(name))).collect()
}

/// Returns the color of each row.
fn table_colors(codes: &Codes, table: &[Rgb]) -> Vec<Rgb> {
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
