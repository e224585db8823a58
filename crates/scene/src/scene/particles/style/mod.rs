//! The style of particles: the user's choices of colors, radii, materials and selection.

mod arrows;
mod categories;
mod colors;
mod columns;
mod opacity;
mod types;

pub use arrows::{ArrowCentering, ArrowSizes, ArrowStyle, Arrows, VectorColumns};
pub use categories::Category;
pub use colors::{ColumnColors, ElementColors, Legend};
use columns::SPEED;
pub(super) use columns::{Column, ID, INDEX, missing, nearest, numbers, unknown};
pub use opacity::{GHOST, Opacity};
pub use types::{TypeMaterial, TypeStyle};

use super::NumberColumn;
use super::select::{Selection, expression};
use super::{BondSource, Model, Particles, SharedNames};
use crate::scene::FileError;
use spherule_particles::internals::aliases;
use std::path::Path;

/// Source of colors.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Coloring {
    /// The file's colors; without them, Jmol's colors of elements; without elements, one color per
    /// type.
    #[default]
    Usual,
    /// Colors of elements, even if the file has colors.
    Elements(ElementColors),
    /// Colors by the numbers or texts of a column, or by an expression over columns.
    Column(ColumnColors),
}

/// The style of particles.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ParticleStyle {
    /// Selection of the particles that are drawn; `None` selects all. Ranges of colors are those of the
    /// selected particles.
    pub select: Option<Selection>,
    /// Source of colors.
    pub coloring: Coloring,
    /// The way in which particles and bonds are drawn; `None` for balls and sticks if `bonds` are asked for and for
    /// crystals, and else for spheres.
    pub model: Option<Model>,
    /// Source of bonds; `None` for those that the model needs.
    pub bonds: Option<BondSource>,
    /// Radius of the sticks of bonds; `None` for the model's usual one.
    pub bond_radius: Option<f64>,
    /// Opacity of the particles that `translucent` selects; `None` for [`GHOST`] if there is a selection, and else for opaque
    /// particles.
    pub opacity: Option<Opacity>,
    /// Selection of the particles that `opacity` is for; `None` selects all.
    pub translucent: Option<Selection>,
    /// Arrows for vectors of particles; `None` for none.
    pub arrows: Option<ArrowStyle>,
    /// Styles of single types, which override all else; the last one for a type applies.
    pub types: Vec<TypeStyle>,
    /// True if ids are read although neither colors nor the selection need them.
    pub ids: bool,
    /// True if a selection may be empty, a column may have no valid number, and a type may be missing,
    /// as in some frames of a trajectory.
    pub allow_empty: bool,
    /// Particles that the camera frames, instead of all.
    pub framed: Option<Selection>,
}

impl ParticleStyle {
    /// Returns the columns that this style needs, with their aliases, for
    /// [`Columns::wanted`](super::Columns::wanted).
    pub fn columns(&self) -> Vec<String> {
        with_synonyms(self.typed_columns())
    }

    /// Returns the source of bonds, for [`ReadOptions::bonds`](super::ReadOptions::bonds).
    pub fn bond_source(&self) -> BondSource {
        match (&self.bonds, self.model) {
            (Some(source), _) => source.clone(),
            (None, Some(model)) if model.draws_bonds() => BondSource::Auto,
            (None, Some(_)) => BondSource::None,
            (None, None) => BondSource::OfCrystals,
        }
    }

    /// Returns whether particles are drawn as a crystal because nothing else is asked for: as balls and sticks in their
    /// cell.
    pub fn draws_crystal(&self, particles: &Particles) -> bool {
        self.bond_source() == BondSource::OfCrystals && particles.frame.bonds.is_some()
    }

    /// Returns the columns that this style names.
    fn typed_columns(&self) -> Vec<String> {
        let mut columns = self.select.as_ref().map_or_else(Vec::new, Selection::columns);
        if let Coloring::Column(colors) = &self.coloring {
            columns.extend(expression::columns(&colors.column));
        }
        if let Some(Opacity::Column { name, .. }) = &self.opacity {
            columns.extend(expression::columns(name));
        }
        columns.extend(self.translucent.iter().flat_map(Selection::columns));
        columns.extend(self.framed.iter().flat_map(Selection::columns));
        let arrows = self.arrows.iter().flat_map(|arrows| &arrows.columns.0);
        columns.extend(arrows.flat_map(|name| expression::columns(name)));
        if self.ids {
            columns.push(ID.to_owned());
        }
        columns
    }

    /// Applies the style to particles that were read from `path` with the columns of
    /// [`ParticleStyle::columns`]. Returns the legend if colors stand for numbers.
    ///
    /// # Errors
    ///
    /// The file has no such column, type or element, the column has no range, or the selection is empty
    /// or invalid.
    pub fn apply(
        &self,
        path: &Path,
        particles: &mut Particles,
    ) -> Result<Option<Legend>, FileError> {
        for style in &self.types {
            style.check().map_err(|message| FileError::whole_file(path, message))?;
        }
        add_numbers(particles, &self.typed_columns());
        if let Some(selection) = self.select.as_ref().filter(|_| !particles.spheres.is_empty()) {
            selection.apply(path, particles, self.allow_empty)?;
        }
        if particles.spheres.is_empty() {
            return Ok(match &self.coloring {
                Coloring::Column(colors) => colors.legend_of_ends(particles.frame.unit),
                Coloring::Usual | Coloring::Elements(_) => None,
            });
        }
        let legend = match &self.coloring {
            Coloring::Usual => None,
            Coloring::Elements(scheme) => scheme.apply(path, particles).map(|()| None)?,
            Coloring::Column(colors) => colors.apply(path, particles, self.allow_empty)?,
        };
        if let Some(arrows) = &self.arrows {
            arrows.apply(path, particles)?;
        }
        let has_bonds = self.bond_source() != BondSource::None && particles.frame.bonds.is_some();
        if self.bond_source() == BondSource::Auto && !has_bonds {
            let first = particles.frame.kinds.table.first().map_or("NAME", |kind| &kind.name);
            let warning = format!(
                "{}: no bonds to draw, as the file has none and no particle has an element by which they could be \
                 found; name elements, as in --type {first}:element=O",
                path.display()
            );
            particles.frame.warnings.push(warning);
        }
        let usual = if has_bonds { Model::BallAndStick } else { Model::SpaceFilling };
        self.model.unwrap_or(usual).apply(particles, self.bond_radius);
        let table = &particles.frame.kinds.table;
        let known =
            |style: &&TypeStyle| !self.allow_empty || style.check_known(path, table).is_ok();
        let types: Vec<&TypeStyle> = self.types.iter().filter(known).collect();
        types.iter().try_for_each(|style| style.apply(path, particles))?;
        types.iter().try_for_each(|style| style.apply_material(path, particles))?;
        let by_type = types.iter().filter_map(|style| Some((style, style.opacity?)));
        let by_type: Vec<_> = by_type
            .map(|(style, opacity)| Ok((style.rows(path, particles)?, opacity)))
            .collect::<Result<_, FileError>>()?;
        let (opacity, select) = (self.opacity.as_ref(), self.translucent.as_ref());
        opacity::apply(path, particles, opacity, select, by_type.into_iter())?;
        Ok(legend)
    }

    /// Checks that every type with a style of its own is in one of the frames that share these names.
    ///
    /// # Errors
    ///
    /// There is no such type or element.
    pub fn check_types(&self, path: &Path, names: &SharedNames) -> Result<(), FileError> {
        self.types.iter().try_for_each(|style| style.check_known(path, names.kinds()))
    }
}

/// Returns names of columns with those that the same quantities have in other programs, or that they are computed from.
pub(super) fn with_synonyms(mut columns: Vec<String>) -> Vec<String> {
    if columns.iter().any(|name| name.eq_ignore_ascii_case(SPEED.0)) {
        columns.extend(SPEED.1.map(str::to_owned));
    }
    for at in 0..columns.len() {
        let others = aliases::of(&columns[at]).map(str::to_owned).collect::<Vec<_>>();
        columns.extend(others);
    }
    columns
}

/// Adds the columns of ids and indices, if they are asked for and missing, before rows are dropped.
pub(super) fn add_numbers(particles: &mut Particles, names: &[String]) {
    for own in [ID, INDEX] {
        let names_column = |name: &String| {
            name.eq_ignore_ascii_case(own)
                || aliases::of(own).any(|other| other.eq_ignore_ascii_case(name))
        };
        if names.iter().any(names_column) && Column::find(particles, own).is_none() {
            let values = (0..particles.spheres.len()).map(|row| row as f64).collect();
            particles.frame.numbers.push(NumberColumn { name: own.to_owned(), values });
        }
    }
}

#[cfg(test)]
mod tests;
