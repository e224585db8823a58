//! How particles look: what the user says beyond what the file does.

mod colors;
mod columns;
mod types;

pub use colors::{ColumnColors, ElementColors, Legend};
pub(super) use columns::{Column, ID, INDEX, unknown};
pub use types::{TypeLook, TypeMaterial};

use super::NumberColumn;
use super::select::Selection;
use super::{Particles, SharedNames};
use crate::scene::FileError;
use spherule_particles::internals::aliases;
use std::path::Path;

/// Where colors come from.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Coloring {
    /// The file; where it has none, Jmol's of elements; where there are none either, one for each
    /// type.
    #[default]
    Usual,
    /// Elements, whatever colors the file has.
    Elements(ElementColors),
    /// The numbers or texts of a column.
    Column(ColumnColors),
}

/// How particles look.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Looks {
    /// Which particles are drawn at all; `None` for all of them. Ranges of colors are those of
    /// what is drawn.
    pub select: Option<Selection>,
    /// Where colors come from.
    pub coloring: Coloring,
    /// Looks of single types, before all else; of two for one type the later one wins.
    pub types: Vec<TypeLook>,
    /// True if a selection may leave nothing, a column may have no number that has a color, and a type
    /// may be missing, as in some frames of a trajectory.
    pub allow_empty: bool,
}

impl Looks {
    /// The columns that these looks need, and other names of them, for
    /// [`Columns::wanted`](super::Columns::wanted).
    pub fn columns(&self) -> Vec<String> {
        let mut columns = self.typed_columns();
        for at in 0..columns.len() {
            let others = aliases::of(&columns[at]).map(str::to_owned).collect::<Vec<_>>();
            columns.extend(others);
        }
        columns
    }

    /// The columns that these looks name.
    fn typed_columns(&self) -> Vec<String> {
        let mut columns = self.select.as_ref().map_or_else(Vec::new, Selection::columns);
        if let Coloring::Column(colors) = &self.coloring {
            columns.push(colors.column.clone());
        }
        columns
    }

    /// Changes how particles look, which were read from `path` with the columns of
    /// [`Looks::columns`]. Returns what the colors stand for, where they stand for numbers.
    ///
    /// # Errors
    ///
    /// The file has no such column, type or element, the column has no range, or the selection is
    /// empty or makes no sense.
    pub fn apply(
        &self,
        path: &Path,
        particles: &mut Particles,
    ) -> Result<Option<Legend>, FileError> {
        for look in &self.types {
            look.check().map_err(|message| FileError::whole_file(path, message))?;
        }
        number(particles, &self.typed_columns());
        if let Some(selection) = self.select.as_ref().filter(|_| !particles.spheres.is_empty()) {
            selection.apply(path, particles, self.allow_empty)?;
        }
        if particles.spheres.is_empty() {
            return Ok(match &self.coloring {
                Coloring::Column(colors) => colors.legend_of_ends(particles.unit),
                Coloring::Usual | Coloring::Elements(_) => None,
            });
        }
        let legend = match &self.coloring {
            Coloring::Usual => None,
            Coloring::Elements(scheme) => scheme.apply(path, particles).map(|()| None)?,
            Coloring::Column(colors) => colors.apply(path, particles, self.allow_empty)?,
        };
        let table = &particles.kinds.table;
        let known = |look: &&TypeLook| !self.allow_empty || look.check_known(path, table).is_ok();
        let types: Vec<&TypeLook> = self.types.iter().filter(known).collect();
        types.iter().try_for_each(|look| look.apply(path, particles))?;
        types.iter().try_for_each(|look| look.apply_material(path, particles))?;
        Ok(legend)
    }

    /// Checks that every type with looks of its own is in one of the frames that share these names.
    ///
    /// # Errors
    ///
    /// There is no such type or element.
    pub fn check_types(&self, path: &Path, names: &SharedNames) -> Result<(), FileError> {
        self.types.iter().try_for_each(|look| look.check_known(path, names.kinds()))
    }
}

/// Gives particles the numbers that files leave out, if they are asked for: before any is dropped.
fn number(particles: &mut Particles, names: &[String]) {
    for own in [ID, INDEX] {
        let means = |name: &String| {
            name.eq_ignore_ascii_case(own)
                || aliases::of(own).any(|other| other.eq_ignore_ascii_case(name))
        };
        if names.iter().any(means) && Column::find(particles, own).is_none() {
            let values = (0..particles.spheres.len()).map(|row| row as f64).collect();
            particles.numbers.push(NumberColumn { name: own.to_owned(), values });
        }
    }
}

#[cfg(test)]
mod tests;
