//! Colors of elements and of columns.

use super::columns::Column;
use super::labels::{self, Colored, NumberColors};
use super::{ColorEnds, ColumnSummary, SharedColors};
use crate::color;
use crate::color::elements::{cpk, jmol};
use crate::color::{CATEGORIES, Map, RangeError, Rgb, Scale, Spacing};
use crate::scene::FileError;
use crate::scene::particles::Codes;
use crate::scene::particles::select::expression;
use crate::scene::particles::{Element, ParticleFrame, Particles};
use crate::suggest;
use std::collections::BTreeSet;
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

/// Source of colors.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Coloring {
    /// The file's colors; without them, Jmol's colors of elements; without elements, one color per
    /// type.
    #[default]
    Usual,
    /// One linear color, each channel 0 to 1.
    Uniform(Rgb),
    /// Colors of elements, even if the file has colors.
    Elements(ElementColors),
    /// Colors by the numbers or texts of a column, or by an expression over columns.
    Column(ColumnColors),
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
        let plain = |colors| Painted { colors, legend: None, summary: None, warnings: Vec::new() };
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

/// Colors of particles by a column: numbers by a color map, texts and integers that are labels by one color each, which
/// repeat after [`CATEGORIES`](crate::color::CATEGORIES) of them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ColumnColors {
    /// The column: one of the file, or `x`, `y`, `z`, `radius`, `type`, `element`, `id`; or an expression over columns, in
    /// the language of [`Selection`](crate::scene::particles::Selection)s, as in `norm(velocity)` and `c_pe / mass`.
    pub column: String,
    /// Treatment of numbers.
    pub numbers: NumberColors,
    /// Color map for numbers; `None` is the default map.
    pub map: Option<Map>,
    /// True if the color map is reversed.
    pub reversed: bool,
    /// Numbers at the ends of the map; numbers beyond them are clamped.
    pub ends: ColorEnds,
    /// Spacing of numbers between the ends.
    pub spacing: Spacing,
    /// Title of the color bar or legend, in which `_` and `^` mark subscripts and superscripts; `None` for one that is made of
    /// the column's name.
    pub title: Option<String>,
    /// The meaning of colors that frames of a sequence have in common; `None` for that of the column.
    pub shared: Option<SharedColors>,
}

/// Meaning of the colors of a picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Legend {
    /// Map from numbers to colors.
    pub scale: Scale,
    /// Label: the quantity, with its unit if it is known; `_` and `^` mark subscripts and superscripts.
    pub label: String,
}

/// The colors of rows, and what is to be said of them.
pub(super) struct Painted {
    /// Linear colors; empty if no value has one.
    pub(super) colors: Vec<Rgb>,
    /// Their meaning, if they stand for numbers.
    pub(super) legend: Option<Legend>,
    /// A summary of their numbers, if their meaning is not shared with other frames.
    pub(super) summary: Option<ColumnSummary>,
    pub(super) warnings: Vec<String>,
}

impl ColumnColors {
    /// Chooses the colors of numbers: a map by its name, which ends in `_r` for a reversed one, or `categories`.
    ///
    /// # Errors
    ///
    /// There is no such map; the names.
    pub fn set_map(&mut self, name: &str) -> Result<(), String> {
        const CATEGORIES: &str = "categories";
        if name == CATEGORIES {
            (self.numbers, self.map) = (NumberColors::Categories, None);
            return Ok(());
        }
        let (stem, reversed) = name.strip_suffix("_r").map_or((name, false), |stem| (stem, true));
        let map = stem.parse().map_err(|why: String| {
            if stem.contains(',') {
                return why;
            }
            let names = Map::ALL.into_iter().map(Map::name).chain([CATEGORIES]);
            let help = suggest::help(stem, names, "maps are");
            let others = "maps are also reversed, with _r, or colors, as in navy,white,firebrick";
            format!("unknown color map `{name}`; {help} ({others})")
        })?;
        (self.numbers, self.map, self.reversed) = (NumberColors::Map, Some(map), reversed);
        Ok(())
    }

    /// Returns the column, or the numbers of the expression.
    pub(super) fn column_of<'p>(
        &self,
        path: &Path,
        particles: &'p Particles,
    ) -> Result<Colored<'p>, FileError> {
        labels::colored(self, path, self.evaluate(path, particles)?)
    }

    /// Returns the column, or the numbers of the expression, whatever their colors.
    pub(super) fn evaluate<'p>(
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
        let mut column = self.evaluate(path, particles)?;
        if let Some(rows) = rows {
            column = column.of_rows(rows);
        }
        let summary = match &column {
            Column::Numbers(values) if self.shared.is_none() => {
                Some(ColumnSummary::of(self, values))
            }
            Column::Numbers(_) | Column::Texts { .. } => None,
        };
        let (mut undefined, mut warnings) = (0, Vec::new());
        let (colors, legend, missing) = match labels::colored(self, path, column)? {
            Colored::Numbers(values) => match self.scale(summary.as_ref()) {
                Ok(scale) => {
                    let legend = Legend { scale, label: self.label(&particles.frame) };
                    let has_no_place = |value: &&f64| scale.range.is_undefined(**value);
                    undefined = values.iter().filter(has_no_place).count() - missing(&values);
                    (scale.colors(&values), Some(legend), missing(&values))
                }
                Err(error) if allow_empty && self.may_have_range(&error) => {
                    (Vec::new(), None, missing(&values))
                }
                Err(error) => return Err(self.range_error(path, &error)),
            },
            Colored::Names { names, colors, codes, missing } => {
                let used: BTreeSet<&str> =
                    used(&codes, names.len()).map(|row| &*names[row]).collect();
                let count = used.len() - usize::from(missing > 0);
                if count > CATEGORIES {
                    let warning = format!(
                        "{}: `{}` has {count} different values, more than the {CATEGORIES} colors of categories, \
                         which repeat",
                        path.display(),
                        self.column
                    );
                    warnings.push(warning);
                }
                (table_colors(&codes, &colors), None, missing)
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
        Ok(Painted { colors, legend, summary, warnings })
    }

    /// Returns whether colors stand for numbers, and not for integers or texts with colors of their own.
    pub fn is_numeric(&self, particles: &Particles) -> bool {
        matches!(self.column_of(Path::new(""), particles), Ok(Colored::Numbers(_)))
    }

    /// Returns the error for a column without a range.
    pub fn range_error(&self, path: &Path, error: &RangeError) -> FileError {
        let message = format!("cannot color by the column `{}`: {error}", self.column);
        FileError::whole_file(path, message)
    }

    /// Returns whether other frames may have a range, though the values of one have none.
    fn may_have_range(&self, error: &RangeError) -> bool {
        match error {
            RangeError::Empty | RangeError::NonePositive => true,
            _ => self.ends.depend_on_values(),
        }
    }

    /// Returns the legend if there are no particles: known if the ends of the map are given.
    pub(super) fn legend_of_ends(&self, frame: &ParticleFrame) -> Option<Legend> {
        if self.shared.as_ref().is_some_and(|shared| shared.labels.is_some()) {
            return None;
        }
        let scale = self.scale(None).ok()?;
        Some(Legend { scale, label: self.label(frame) })
    }

    /// Returns the scale of values, or of all frames of a sequence. If there are values beyond an end, it has a color for them,
    /// that of the end.
    fn scale(&self, summary: Option<&ColumnSummary>) -> Result<Scale, RangeError> {
        let of_values = || summary.unwrap_or(&ColumnSummary::default()).share(self);
        let SharedColors { range, beyond: [below, above], .. } =
            self.shared.clone().map_or_else(of_values, Ok)?;
        let scale = Scale::new(self.map.unwrap_or_default(), range);
        let scale = Scale { reversed: self.reversed, ..scale };
        let end = |is_beyond: bool, position| is_beyond.then(|| scale.at(position));
        Ok(Scale { below: end(below, 0.0), above: end(above, 1.0), ..scale })
    }
}

impl Coloring {
    /// Colors numbers by a color map if nothing else is asked for, as a color bar needs it.
    pub fn prefer_map(&mut self) {
        if let Self::Column(colors) = self
            && colors.numbers == NumberColors::Auto
        {
            colors.numbers = NumberColors::Map;
        }
    }
}

/// Returns subject and verbs for so many particles.
fn words(count: usize) -> (&'static str, &'static str) {
    if count == 1 { ("particle has", "is") } else { ("particles have", "are") }
}

fn missing(values: &[f64]) -> usize {
    values.iter().filter(|value| value.is_nan()).count()
}

/// Returns the codes that particles have.
fn used(codes: &Codes, count: usize) -> impl Iterator<Item = usize> {
    let mut is_used = vec![false; count];
    (0..codes.len()).for_each(|row| is_used[codes.code(row) as usize] = true);
    (0..count).filter(move |&code| is_used[code])
}

/// Returns the color of each row.
fn table_colors(codes: &Codes, table: &[Rgb]) -> Vec<Rgb> {
    (0..codes.len()).map(|row| table[codes.code(row) as usize]).collect()
}
