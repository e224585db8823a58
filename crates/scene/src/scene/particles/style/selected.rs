//! Styles of selections: properties, and the particles that have them.

use super::colors::Painted;
use super::properties::{PROPERTIES, entries};
use super::types::common_color;
use super::{Coloring, ColumnSummary, GHOST, Legend, Opacity, ParticleStyle, Properties, opacity};
use crate::color::Rgb;
use crate::scene::particles::model::{self, Part};
use crate::scene::particles::{Fault, Model, Particles, Selection};
use crate::scene::{FileError, NamedMaterial};
use std::borrow::Cow;
use std::path::Path;
use std::str::FromStr;

/// Properties of the particles of a selection.
#[derive(Clone, Debug, PartialEq)]
pub struct SelectedStyle {
    /// The particles.
    pub selection: Selection,
    /// Their properties.
    pub properties: Properties,
}

impl SelectedStyle {
    /// Hides the particles of a selection.
    pub fn hidden(selection: Selection) -> Self {
        Self { selection, properties: Properties { visible: Some(false), ..Properties::default() } }
    }
}

impl FromStr for SelectedStyle {
    type Err = String;

    /// Parses a selection, a colon and properties, as in `resname ATP MG: model=ball-and-stick color=magenta`.
    fn from_str(text: &str) -> Result<Self, String> {
        let usage = "expected a selection, a colon and properties, as in \
                     'resname ATP: model=ball-and-stick color=magenta'";
        // A selection may hold colons, as in `resid 5:10`: the first after which properties follow ends it.
        let known = |name: &str| PROPERTIES.iter().any(|(own, _)| *own == name);
        let colons = || text.match_indices(':').map(|(at, _)| at);
        let begins = |at: &usize, is_one: &dyn Fn(&str) -> bool| {
            let first = entries(&text[at + 1..]).ok().and_then(|found| found.first().copied());
            first.is_some_and(|(name, _)| is_one(name))
        };
        let end = colons().find(|at| begins(at, &known));
        let end = end.or_else(|| colons().find(|at| begins(at, &|_| true)));
        let end = end.or_else(|| colons().next_back().filter(|at| text[*at..].contains('=')));
        let at = end.ok_or(usage)?;
        let (selection, properties) = (text[..at].trim(), text[at + 1..].trim());
        if selection.is_empty() || properties.is_empty() {
            return Err(usage.to_owned());
        }
        let selection = selection.parse().map_err(|fault: Fault| fault.to_string())?;
        Ok(Self { selection, properties: properties.parse()? })
    }
}

/// Results of the application of a style.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Applied {
    /// The meaning of colors for each of [`ParticleStyle::column_colors`]; `None` if it colors no particle by numbers.
    pub legends: Vec<Option<Legend>>,
    /// Summaries of the numbers of the same colors; `None` for those that are shared with other frames, or of texts.
    pub summaries: Vec<Option<ColumnSummary>>,
    /// True for each of [`ParticleStyle::styles`] whose selection holds a particle.
    pub matched: Vec<bool>,
    /// The style that colors each particle: 0 for the base, `k + 1` for [`ParticleStyle::styles`] `k`; empty if none of
    /// them says a color.
    pub(super) painters: Vec<u32>,
}

impl Applied {
    /// Returns the meaning of colors that stand for numbers: the first one, if there are several.
    pub fn legend(&self) -> Option<&Legend> {
        self.legends.iter().flatten().next()
    }
}

/// Properties, and the rows that have them.
pub(super) struct Assigned<'s> {
    /// Names them in materials.
    name: Cow<'s, str>,
    /// Row of [`ParticleStyle::styles`]; `None` for the short forms.
    style: Option<usize>,
    rows: Vec<usize>,
    properties: Cow<'s, Properties>,
}

/// Drops the particles that are not selected or not visible, and returns the rows of all properties in the order of their
/// application: those of opacity, of types, and of selections. `matched` becomes true for selections that hold a particle.
pub(super) fn assign<'s>(
    style: &'s ParticleStyle,
    path: &Path,
    particles: &mut Particles,
    matched: &mut [bool],
) -> Result<Vec<Assigned<'s>>, FileError> {
    let count = particles.spheres.len();
    let mut chosen = Vec::new();
    for (at, selected) in style.styles.iter().enumerate() {
        let rows = selected.selection.some(path, particles, style.allow_empty, "styled")?;
        matched[at] = rows.contains(&true);
        chosen.push(rows);
    }
    let mut kept = match &style.select {
        Some(select) => select.some(path, particles, style.allow_empty, "selected")?,
        None => vec![true; count],
    };
    let mut visible = vec![true; count];
    for (rows, selected) in chosen.iter().zip(&style.styles) {
        let Some(is_visible) = selected.properties.visible else { continue };
        (0..count).filter(|&row| rows[row]).for_each(|row| visible[row] = is_visible);
    }
    kept.iter_mut().zip(visible).for_each(|(kept, is_visible)| *kept &= is_visible);
    if !kept.contains(&true) && !style.allow_empty {
        let message = format!("none of its {count} particles is visible");
        return Err(FileError::whole_file(path, message));
    }
    if kept.contains(&false) {
        particles.retain(&kept);
        for rows in &mut chosen {
            let mut of_row = kept.iter();
            rows.retain(|_| of_row.next() == Some(&true));
        }
    }
    let mut assigned = of_opacity(style, particles)?;
    let table = &particles.frame.kinds.table;
    for of_type in &style.types {
        let is_absent = style.allow_empty && of_type.check_known(path, table).is_err();
        let rows = if is_absent { Vec::new() } else { of_type.rows(path, particles)? };
        let name = Cow::from(&of_type.name);
        let properties = Cow::Borrowed(&of_type.properties);
        assigned.push(Assigned { name, style: None, rows, properties });
    }
    for (at, (chosen, selected)) in chosen.into_iter().zip(&style.styles).enumerate() {
        let rows = (0..chosen.len()).filter(|&row| chosen[row]).collect();
        let (name, properties) =
            (Cow::from(selected.selection.text()), Cow::Borrowed(&selected.properties));
        assigned.push(Assigned { name, style: Some(at), rows, properties });
    }
    Ok(assigned)
}

/// Returns the opacity of all particles, or of those that are selected for it; then others are opaque.
fn of_opacity<'s>(
    style: &'s ParticleStyle,
    particles: &Particles,
) -> Result<Vec<Assigned<'s>>, FileError> {
    let part = |rows, opacity| Assigned {
        name: Cow::Borrowed("opacity"),
        style: None,
        rows,
        properties: Cow::Owned(Properties { opacity: Some(opacity), ..Properties::default() }),
    };
    let all = || (0..particles.spheres.len()).collect::<Vec<_>>();
    let opacity = style.opacity.clone();
    let Some(select) = &style.translucent else {
        return Ok(opacity.map(|opacity| part(all(), opacity)).into_iter().collect());
    };
    let chosen = select.chosen(particles)?;
    let rows = (0..chosen.len()).filter(|&row| chosen[row]).collect();
    let opacity = opacity.unwrap_or(Opacity::Number(GHOST));
    Ok(vec![part(all(), Opacity::Number(1.0)), part(rows, opacity)])
}

/// Colors the particles whose properties say colors.
pub(super) fn color(
    assigned: &[Assigned],
    path: &Path,
    particles: &mut Particles,
    allow_empty: bool,
    applied: &mut Applied,
) -> Result<(), FileError> {
    let count = particles.spheres.len();
    for Assigned { rows, properties, style, .. } in assigned {
        let Some(coloring) = &properties.color else { continue };
        let painted = if rows.is_empty() {
            None
        } else {
            coloring.paint(path, particles, Some(rows), allow_empty)?
        };
        if matches!(coloring, Coloring::Column(_)) {
            applied.legends.push(painted.as_ref().and_then(|painted| painted.legend.clone()));
            applied.summaries.push(painted.as_ref().and_then(|painted| painted.summary.clone()));
        }
        let Some(Painted { colors, warnings, .. }) = painted else { continue };
        particles.frame.warnings.extend(warnings);
        if colors.is_empty() {
            continue;
        }
        particles.spheres.color.resize(count, Rgb::ONE);
        for (&row, color) in rows.iter().zip(colors) {
            particles.spheres.color[row] = color;
        }
        if let Some(style) = style {
            applied.painters.resize(count, 0);
            for &row in rows {
                applied.painters[row] = *style as u32 + 1;
            }
        }
    }
    Ok(())
}

/// Gives particles their models, of which `base` is that of all others, and then their radii.
pub(super) fn shape(
    assigned: &[Assigned],
    particles: &mut Particles,
    base: Model,
    bond_radius: Option<f64>,
) {
    let says = |own: &&Assigned| {
        let Properties { model, bonds, bond_radius, .. } = &*own.properties;
        model.is_some() || bonds.is_some() || bond_radius.is_some()
    };
    let parts = assigned.iter().filter(says).map(|Assigned { rows, properties, .. }| {
        let Properties { model, bonds, bond_radius, .. } = **properties;
        Part { rows, model, bonds, bond_radius }
    });
    let parts: Vec<Part> = parts.collect();
    model::apply(particles, base, bond_radius, &parts);
    let radii = &mut particles.spheres.radius;
    for Assigned { rows, properties, .. } in assigned {
        if let Some(radius) = properties.radius {
            for &row in rows {
                radii[row] = radius;
            }
        }
        if let Some(scale) = properties.scale {
            for &row in rows {
                radii[row] *= scale;
            }
        }
    }
}

/// Gives particles the polyhedra that their properties say, as rows of [`ParticleStyle::polyhedra_of_all`].
pub(super) fn set_polyhedra(assigned: &[Assigned], particles: &mut Particles) {
    let says = |own: &&Assigned| own.properties.polyhedra.is_some();
    for (own, Assigned { rows, .. }) in (1..).zip(assigned.iter().filter(says)) {
        particles.polyhedra.resize(particles.spheres.len(), 0);
        for &row in rows {
            particles.polyhedra[row] = own;
        }
    }
}

/// Gives particles, which have their final colors, their materials.
pub(super) fn set_materials(assigned: &[Assigned], particles: &mut Particles) {
    for Assigned { name, rows, properties, .. } in assigned {
        let Some(material) = properties.material else { continue };
        let color = common_color(&particles.spheres, rows.iter().copied());
        let name = format!("{name}: {}", material.name());
        let material = material.material(color);
        let known = particles.materials.iter().any(|own| own.name == name);
        let row = particles.material_names.iter().position(|own| known && *own == name);
        let row = row.unwrap_or(particles.material_names.len()) as u32;
        let spheres = &mut particles.spheres;
        spheres.material.resize(spheres.len(), 0);
        for &sphere in rows {
            spheres.material[sphere] = row;
        }
        if !known {
            particles.material_names.push(name.clone());
            particles.materials.push(NamedMaterial { name, material });
        }
    }
}

/// Gives particles their opacities.
pub(super) fn set_opacities(
    assigned: &[Assigned],
    path: &Path,
    particles: &mut Particles,
) -> Result<(), FileError> {
    let mut opacities = Vec::new();
    for Assigned { rows, properties, .. } in assigned {
        let Some(opacity) = &properties.opacity else { continue };
        opacities.resize(particles.spheres.len(), None);
        let values = opacity.values(path, particles)?;
        for &row in rows {
            opacities[row] = Some(values[row]);
        }
    }
    opacity::split_materials(particles, &opacities);
    Ok(())
}

#[cfg(test)]
mod tests;
