//! Opacity of particles: for all, for a selection, or by the numbers of a column.

use crate::scene::FileError;
use crate::scene::particles::Particles;
use crate::scene::particles::select::expression::numbers;
use crate::settings::share;
use std::collections::HashMap;
use std::path::Path;
use std::str::FromStr;

/// Number of steps between a particle that is not there and an opaque one, for opacities of columns: as fine as a picture
/// shows them.
const STEPS: f64 = 255.0;

/// Opacity of particles that are selected without saying how much.
pub const GHOST: f64 = 0.2;

/// The source of opacities.
#[derive(Clone, Debug, PartialEq)]
pub enum Opacity {
    /// The same for all particles, 0 to 1.
    Number(f64),
    /// A column of numbers.
    Column {
        /// Its name, or an expression over columns.
        name: String,
        /// The numbers that become 0 and 1; those beyond are as these are.
        ends: [f64; 2],
    },
}

impl FromStr for Opacity {
    type Err = String;

    /// Parses a number from 0 to 1, a percentage, or the name of a column or an expression, perhaps with the values that become 0 and 1, as in
    /// `occupancy` and `charge:-1,1`.
    fn from_str(text: &str) -> Result<Self, String> {
        if let Some(number) = share(text) {
            let valid = (0.0..=1.0).contains(&number).then_some(Self::Number(number));
            return valid.ok_or_else(|| format!("`{text}` is not between 0 and 1, or 0% and 100%"));
        }
        let ends = |text: &str| -> Option<[f64; 2]> {
            let (low, high) = text.split_once(',')?;
            let [low, high] = [low, high].map(|end| end.trim().parse::<f64>().ok());
            Some([low?, high?])
                .filter(|ends| ends.iter().all(|end| end.is_finite()) && ends[0] != ends[1])
        };
        let (name, ends) = match text.rsplit_once(':') {
            // A colon in an expression is part of a name.
            Some((name, range)) if range.contains(',') && !range.contains(')') => {
                let fault = || format!("`{range}` is not two different numbers, as in charge:-1,1");
                (name, ends(range).ok_or_else(fault)?)
            }
            _ => (text, [0.0, 1.0]),
        };
        let name = name.trim();
        if name.is_empty() {
            return Err(
                "give a number from 0 to 1, a percentage, or the name of a column".to_owned()
            );
        }
        Ok(Self::Column { name: name.to_owned(), ends })
    }
}

impl Opacity {
    /// Returns the opacity of each particle.
    pub(super) fn values(&self, path: &Path, particles: &Particles) -> Result<Vec<f64>, FileError> {
        let (name, [low, high]) = match self {
            Self::Number(number) => return Ok(vec![*number; particles.spheres.len()]),
            Self::Column { name, ends } => (name, *ends),
        };
        let opacity = |number: &f64| {
            let share = ((number - low) / (high - low)).clamp(0.0, 1.0);
            // A particle without a value is not hidden.
            if share.is_nan() { 1.0 } else { (share * STEPS).round() / STEPS }
        };
        Ok(numbers(path, particles, name, "opacities")?.iter().map(opacity).collect())
    }
}

/// Gives each opacity of each material a row of the materials; no opacities leave all as they are.
pub(super) fn split_materials(particles: &mut Particles, opacities: &[Option<f64>]) {
    if opacities.is_empty() {
        return;
    }
    particles.opacities.resize(particles.material_names.len(), None);
    particles.spheres.material.resize(opacities.len(), 0);
    let mut rows = HashMap::new();
    for (material, opacity) in particles.spheres.material.iter_mut().zip(opacities) {
        let Some(opacity) = opacity else { continue };
        *material = *rows.entry((*material, opacity.to_bits())).or_insert_with(|| {
            particles.material_names.push(particles.material_names[*material as usize].clone());
            particles.opacities.push(Some(*opacity));
            particles.opacities.len() as u32 - 1
        });
    }
}
