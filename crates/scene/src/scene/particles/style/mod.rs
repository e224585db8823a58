//! The style of particles: the user's choices of colors, radii, materials and selection.

mod arrows;
mod categories;
mod colors;
mod columns;
mod ends;
mod labels;
mod opacity;
mod properties;
mod selected;
mod summary;
mod title;
mod types;

pub use arrows::ArrowStyle;
pub use categories::Category;
use colors::Painted;
pub use colors::{Coloring, ColumnColors, ElementColors, Legend};
pub use columns::ColumnValues;
pub(super) use columns::{Column, add_numbers, missing, nearest, unknown, with_synonyms};
pub use ends::{ColorEnd, ColorEnds};
pub use labels::NumberColors;
pub use opacity::{GHOST, Opacity};
pub use properties::{PROPERTIES, Properties};
pub use selected::{Applied, SelectedStyle};
pub use summary::{ColumnSummary, SharedColors};
pub use types::{TypeMaterial, TypeStyle};

use super::polyhedra;
use super::select::{Selection, expression};
use super::{BondSource, Coordination, Model, Orientation, Particles, Polyhedra, SharedNames};
use crate::scene::{FileError, FramedSphere};
use std::path::Path;

/// The style of particles.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ParticleStyle {
    /// Selection of the particles that are drawn; `None` selects all. Ranges of colors are those of the
    /// selected particles.
    pub select: Option<Selection>,
    /// Source of colors.
    pub coloring: Coloring,
    /// The way in which particles and bonds are drawn; `None` for balls and sticks if `bonds` or `polyhedra` are asked for and
    /// for crystals, and else for spheres.
    pub model: Option<Model>,
    /// Source of bonds; `None` for those that the model needs.
    pub bonds: Option<BondSource>,
    /// Radius of the sticks of bonds; `None` for the model's usual one.
    pub bond_radius: Option<f64>,
    /// Coordination polyhedra.
    pub polyhedra: Polyhedra,
    /// Opacity of the particles that `translucent` selects; `None` for [`GHOST`] if there is a selection, and else for opaque
    /// particles.
    pub opacity: Option<Opacity>,
    /// Selection of the particles that `opacity` is for; `None` selects all.
    pub translucent: Option<Selection>,
    /// Arrows for vectors of particles; `None` for none.
    pub arrows: Option<ArrowStyle>,
    /// Styles of single types, which override the above; of those for a type, later ones win.
    pub types: Vec<TypeStyle>,
    /// Styles of selections, which override all else; later ones win. Selections are of all particles, also of those that
    /// `select` leaves out.
    pub styles: Vec<SelectedStyle>,
    /// Columns that are read although neither colors nor selections need them, as for annotations.
    pub also_read: Vec<String>,
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
            (None, _) if self.properties().any(Properties::draws_bonds) => BondSource::Auto,
            _ if self.polyhedra_of_all().any(Polyhedra::need_bonds) => BondSource::Auto,
            (None, Some(_)) => BondSource::None,
            (None, None) => BondSource::OfCrystals,
        }
    }

    /// Returns whether particles are drawn as a crystal because nothing else is asked for: as balls and sticks in their
    /// cell.
    pub fn draws_crystal(&self, particles: &Particles) -> bool {
        let is_chosen = self.model.is_some() || self.bonds.is_some();
        !is_chosen && particles.is_crystal && particles.frame.bonds.is_some()
    }

    /// The properties of types and of selections.
    fn properties(&self) -> impl Iterator<Item = &Properties> {
        let types = self.types.iter().map(|style| &style.properties);
        types.chain(self.styles.iter().map(|style| &style.properties))
    }

    /// Returns the polyhedra of all particles, and then those of types and of selections that say any.
    fn polyhedra_of_all(&self) -> impl Iterator<Item = &Polyhedra> {
        std::iter::once(&self.polyhedra)
            .chain(self.properties().filter_map(|own| own.polyhedra.as_ref()))
    }

    /// Finds the polyhedra of particles to which this style was applied: see [`Coordination`].
    ///
    /// # Errors
    ///
    /// A rule names no type of the file unless frames may be empty, there are no bonds although a rule has no distance, or a
    /// center has too many neighbors.
    pub fn find_polyhedra(
        &self,
        path: &Path,
        particles: &mut Particles,
    ) -> Result<Vec<Coordination>, FileError> {
        let all: Vec<&Polyhedra> = self.polyhedra_of_all().collect();
        polyhedra::find(&all, path, particles, self.allow_empty)
    }

    /// Returns the sources of colors: of all, of types and of selections.
    pub fn colorings(&self) -> impl Iterator<Item = &Coloring> {
        std::iter::once(&self.coloring)
            .chain(self.properties().filter_map(|own| own.color.as_ref()))
    }

    /// Returns the colors by columns, in the order of their application.
    pub fn column_colors(&self) -> impl Iterator<Item = &ColumnColors> {
        self.colorings().filter_map(|coloring| match coloring {
            Coloring::Column(colors) => Some(colors),
            Coloring::Usual | Coloring::Uniform(_) | Coloring::Elements(_) => None,
        })
    }

    /// Returns the same as [`ParticleStyle::column_colors`], to change them.
    pub fn column_colors_mut(&mut self) -> impl Iterator<Item = &mut ColumnColors> {
        let types = self.types.iter_mut().map(|style| &mut style.properties);
        let all = types.chain(self.styles.iter_mut().map(|style| &mut style.properties));
        let own = all.filter_map(|own| own.color.as_mut());
        let colorings = std::iter::once(&mut self.coloring).chain(own);
        colorings.filter_map(|coloring| match coloring {
            Coloring::Column(colors) => Some(colors),
            Coloring::Usual | Coloring::Uniform(_) | Coloring::Elements(_) => None,
        })
    }

    /// Returns the columns that this style names.
    fn typed_columns(&self) -> Vec<String> {
        let mut columns = self.select.as_ref().map_or_else(Vec::new, Selection::columns);
        columns.extend(self.column_colors().flat_map(|own| expression::columns(&own.column)));
        let opacities =
            self.properties().filter_map(|own| own.opacity.as_ref()).chain(&self.opacity);
        for opacity in opacities {
            if let Opacity::Column { name, .. } = opacity {
                columns.extend(expression::columns(name));
            }
        }
        columns.extend(self.styles.iter().flat_map(|style| style.selection.columns()));
        columns.extend(self.translucent.iter().flat_map(Selection::columns));
        columns.extend(self.framed.iter().flat_map(Selection::columns));
        let arrows = self.arrows.iter().flat_map(|arrows| &arrows.columns.0);
        columns.extend(arrows.flat_map(|name| expression::columns(name)));
        columns.extend(self.also_read.iter().cloned());
        columns
    }

    /// Applies the style to particles that were read from `path` with the columns of
    /// [`ParticleStyle::columns`]. Returns the meaning of colors, if they stand for numbers or names.
    ///
    /// # Errors
    ///
    /// The file has no such column, type or element, the column has no range, or a selection is empty
    /// or invalid.
    pub fn apply(&self, path: &Path, particles: &mut Particles) -> Result<Applied, FileError> {
        let types =
            self.types.iter().map(|own| (format!("the type `{}`", own.name), &own.properties));
        let styles =
            self.styles.iter().map(|own| (format!("`{}`", own.selection.text()), &own.properties));
        for (name, properties) in types.chain(styles) {
            properties.check(&name).map_err(|message| FileError::whole_file(path, message))?;
        }
        if particles.orientation.is_none() && particles.first_frame.is_none() {
            particles.orientation = Some(Orientation::of(particles));
        }
        add_numbers(particles, &self.typed_columns());
        let mut applied = Applied { matched: vec![false; self.styles.len()], ..Applied::default() };
        let mut assigned = Vec::new();
        if !particles.spheres.is_empty() {
            assigned = selected::assign(self, path, particles, &mut applied.matched)?;
        }
        if particles.spheres.is_empty() {
            let frame = &particles.frame;
            applied.legends = self.column_colors().map(|own| own.legend_of_ends(frame)).collect();
            applied.summaries = vec![None; applied.legends.len()];
            return Ok(applied);
        }
        let painted = self.coloring.paint(path, particles, None, self.allow_empty)?;
        if let Some(Painted { colors, legend, summary, warnings }) = painted {
            particles.spheres.color = colors;
            particles.frame.warnings.extend(warnings);
            if matches!(self.coloring, Coloring::Column(_)) {
                applied.legends.push(legend);
                applied.summaries.push(summary);
            }
        }
        selected::color(&assigned, path, particles, self.allow_empty, &mut applied)?;
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
        let asks_for_bonds = self.bonds.is_some() || self.draws_crystal(particles);
        let has_balls =
            has_bonds && asks_for_bonds || !self.polyhedra_of_all().all(Polyhedra::is_empty);
        let usual = if has_balls { Model::BallAndStick } else { Model::SpaceFilling };
        let base = self.model.unwrap_or(usual);
        selected::shape(&assigned, particles, base, self.bond_radius);
        selected::set_polyhedra(&assigned, particles);
        selected::set_materials(&assigned, particles);
        selected::set_opacities(&assigned, path, particles)?;
        Ok(applied)
    }

    /// Checks that every selection with a style of its own held a particle of a frame: `matched` is as in [`Applied`], of all
    /// frames.
    ///
    /// # Errors
    ///
    /// One held none.
    pub fn check_matched(&self, path: &Path, matched: &[bool]) -> Result<(), FileError> {
        let idle = self.styles.iter().zip(matched).find(|(_, matched)| !**matched);
        idle.map_or(Ok(()), |(style, _)| {
            let message = format!("no particle of a frame is styled: `{}`", style.selection.text());
            Err(FileError::whole_file(path, message))
        })
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

impl Particles {
    /// Returns a sphere about the middle of the particles that the camera frames, with all of them; `None` if the style names
    /// none, or if there are no particles.
    ///
    /// # Errors
    ///
    /// The condition names no column there is, compares what cannot be compared, or is true of no particle.
    pub fn framed(
        &self,
        path: &Path,
        style: &ParticleStyle,
    ) -> Result<Option<FramedSphere>, FileError> {
        let Some(selection) = style.framed.as_ref().filter(|_| !self.spheres.is_empty()) else {
            return Ok(None);
        };
        let rows = self.selected(path, selection, false, "looked at")?;
        let sphere = |&row: &usize| (self.spheres.center(row), self.spheres.radius[row]);
        Ok(FramedSphere::around(|| rows.iter().map(sphere)))
    }
}

#[cfg(test)]
mod tests;
