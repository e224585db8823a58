//! Radii of particles: the file's, those of elements, or a guess.

use super::Element;
use super::select::expression::{self, numbers};
use super::spheres::Warnings;
use super::style::{add_numbers, with_synonyms};
use super::{Kind, Kinds};
use super::{ParticleFrame, Particles};
use super::{Radii, ReadOptions};
use crate::elementary::{exp, ln};
use crate::scene::FileError;
use spherule_particles::internals::clipped;
use std::path::Path;

/// Radius of an atom whose element is unknown or has no radius in the table, in angstrom.
const DEFAULT_RADIUS: f64 = 1.7;

/// Radii of all rows.
pub(super) struct FoundRadii {
    pub(super) radius: Vec<f64>,
    /// True if they are all 1 for now, to be guessed from the rows that are drawn.
    pub(super) guessed: bool,
}

/// Finds radii as the options say; moves them out of the frame, if it has any.
pub(super) fn radii(
    path: &Path,
    frame: &mut ParticleFrame,
    options: &ReadOptions,
    warnings: &mut Warnings,
) -> Result<FoundRadii, FileError> {
    let count = frame.len();
    if count == 0 {
        return Ok(FoundRadii { radius: Vec::new(), guessed: false });
    }
    let own = std::mem::take(&mut frame.radius);
    if matches!(options.radii, Radii::Expression(_)) {
        let radius = if own.is_empty() { vec![1.0; count] } else { own };
        return Ok(FoundRadii { radius, guessed: false });
    }
    let has_elements = frame.kinds.table.iter().any(|kind| kind.element.is_some());
    let table = |warnings: &mut Warnings, radius: fn(Element) -> Option<f64>| {
        let factor = frame.unit.per_angstrom() * options.scale * options.radius_scale;
        table_radii(&frame.kinds, radius, factor, warnings)
    };
    let demanded = matches!(options.radii, Radii::VanDerWaals | Radii::Covalent | Radii::Ionic);
    if demanded && !has_elements {
        let message = "cannot use radii of elements: no particle has an element";
        return Err(FileError::whole_file(path, message)
            .with_help("give a radius, or name the column of elements"));
    }
    let guessed = options.radii == Radii::Auto && own.is_empty() && !has_elements;
    let radius = match options.radii {
        Radii::Constant(radius) => vec![radius * options.radius_scale; count],
        Radii::VanDerWaals => table(warnings, Element::van_der_waals_radius),
        Radii::Covalent => table(warnings, Element::covalent_radius),
        Radii::Ionic => {
            let lacks = |kind: &&Kind| kind.element.is_some_and(|own| own.ionic_radius().is_none());
            let lacking = frame.kinds.table.iter().filter(lacks);
            let lacking: Vec<&str> = lacking.map(|kind| kind.name.as_str()).collect();
            warnings.add_of("elements without ionic radii have covalent ones", &lacking);
            table(warnings, |own| own.ionic_radius().or_else(|| own.covalent_radius()))
        }
        _ if !own.is_empty() => {
            let factor = options.scale * options.radius_scale;
            let mut own = own;
            if factor != 1.0 {
                for radius in &mut own {
                    *radius *= factor;
                }
            }
            own
        }
        Radii::Missing(radius) => vec![radius * options.radius_scale; count],
        _ if has_elements => table(warnings, Element::van_der_waals_radius),
        _ => vec![1.0; count],
    };
    Ok(FoundRadii { radius, guessed })
}

/// Takes arithmetic in the name of the column of radii as an expression, and wants its columns.
pub fn accept_radii_expression(options: &mut ReadOptions) {
    let Radii::Column(text) = &options.radii else { return };
    if expression::is_arithmetic(text) {
        options.columns.wanted.extend(with_synonyms(expression::columns(text)));
        options.radii = Radii::Expression(text.clone());
    }
}

/// Gives particles the radii of an expression, if the options have one, and drops those for which it is none.
pub(super) fn apply_expression(
    path: &Path,
    particles: &mut Particles,
    options: &ReadOptions,
) -> Result<(), FileError> {
    let Radii::Expression(text) = &options.radii else { return Ok(()) };
    let count = particles.spheres.len();
    if count == 0 {
        return Ok(());
    }
    add_numbers(particles, &expression::columns(text));
    let factor = options.scale * options.radius_scale;
    let radius = numbers(path, particles, text, "radii")?;
    let radius: Vec<f64> = radius.iter().map(|radius| radius * factor).collect();
    let keep: Vec<bool> = radius.iter().map(|&radius| radius > 0.0 && radius.is_finite()).collect();
    particles.spheres.radius = radius;
    let dropped = keep.iter().filter(|&&keep| !keep).count();
    if dropped == 0 {
        return Ok(());
    }
    let reason = "their radii are not finite, or 0 or less";
    if dropped == count && !options.allow_empty {
        let message = format!("none of its {count} rows is a sphere: {reason}");
        return Err(FileError::whole_file(path, message));
    }
    let warning = format!("{}: {dropped} of {count} rows were dropped: {reason}", path.display());
    particles.frame.warnings.push(clipped(&warning));
    particles.retain(&keep);
    Ok(())
}

fn table_radii(
    kinds: &Kinds,
    radius: fn(Element) -> Option<f64>,
    factor: f64,
    warnings: &mut Warnings,
) -> Vec<f64> {
    let known = |kind: &Kind| kind.element.and_then(radius);
    let unknown = kinds.table.iter().filter(|kind| known(kind).is_none() && !kind.virtual_site);
    let unknown: Vec<&str> = unknown.map(|kind| kind.name.as_str()).collect();
    warnings.add_of("unknown radii of elements, replaced by 1.7 angstrom", &unknown);
    let table = kinds.table.iter().map(|kind| known(kind).unwrap_or(DEFAULT_RADIUS) * factor);
    let table: Vec<f64> = table.collect();
    (0..kinds.codes.len()).map(|row| table[kinds.codes.code(row) as usize]).collect()
}

/// Returns half of the edge of the cube, square or line that each particle has on average; 1 for a
/// single position. Rounded to two digits, which shows that it is an estimate.
pub(super) fn half_spacing(position: [&Vec<f64>; 3]) -> f64 {
    let count = position[0].len();
    let extent = |column: &Vec<f64>| {
        let least = column.iter().copied().fold(f64::INFINITY, f64::min);
        column.iter().copied().fold(f64::NEG_INFINITY, f64::max) - least
    };
    let extents = position.map(extent).into_iter();
    let extents: Vec<f64> = extents.filter(|extent| *extent > 0.0 && extent.is_finite()).collect();
    if extents.is_empty() {
        return 1.0;
    }
    // The mean of logarithms avoids overflow of the product of lengths.
    let logarithms: f64 = extents.iter().map(|extent| ln(*extent)).sum();
    let spacing = exp((logarithms - ln(count as f64)) / extents.len() as f64);
    format!("{:.1e}", spacing / 2.0).parse().unwrap_or(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn guessed_radii_follow_the_spacing_in_any_dimension() {
        let rows = || (0..100).map(f64::from);
        let line = [rows().map(|row| row * 3.0).collect(), vec![5.0; 100], vec![5.0; 100]];
        let plane = [
            rows().map(|row| row % 10.0 * 2.0).collect(),
            vec![0.0; 100],
            rows().map(|row| (row / 10.0).floor() * 2.0).collect(),
        ];
        assert_eq!(half_spacing(line.each_ref()), 1.5);
        assert_eq!(half_spacing(plane.each_ref()), 0.9);
        assert_eq!(half_spacing([&vec![1.0], &vec![1.0], &vec![1.0]]), 1.0);
    }
}
