//! Rays with a bound: is anything nearer?
//!
//! Bounds lie where it is hardest to say: at the distance of the hit, as near to it as double precision
//! can tell, and within what single precision can and cannot.

use super::forms::Form;
use super::rays::{Columns, Ray};
use super::reference;
use super::report::RegimeReport;
use crate::query::{QueryError, SphereTree};

/// Bounds of a ray.
const COUNT: usize = 7;

/// How far from the distance bounds are, in parts of it: 16 and a quarter of the unit in the last place
/// of single precision.
const APART: [f64; 2] = [1.0 / (1 << 19) as f64, 1.0 / (1 << 25) as f64];

/// Bounds about a distance, which is known to one number of double precision.
fn about(t: f64) -> [f64; COUNT] {
    let [far, near] = APART;
    [
        t * (1.0 - far),
        t * (1.0 - near),
        t.next_down(),
        t,
        t.next_up(),
        t * (1.0 + near),
        t * (1.0 + far),
    ]
}

/// Counts wrong answers about rays that hit, each with the sphere that it hits first.
pub(super) fn count(spheres: &[[f32; 4]], hits: &[(Ray, usize)], report: &mut RegimeReport) {
    let known = hits.iter().filter_map(|(ray, sphere)| {
        Some((ray, reference::nearer_than(spheres[*sphere], ray, about)?))
    });
    let questions = known.flat_map(|(ray, bounds)| bounds.map(|bound| (*ray, bound)));
    let (rays, bounds): (Vec<Ray>, Vec<(f64, bool)>) = questions.unzip();
    report.bounds += bounds.len() as u64;
    // Columns made here are of one length, and few.
    let wrong = wrong(spheres, &rays, &bounds).unwrap_or(bounds.len());
    report.form_mut(Form::Spherule).wrong_bounds += wrong as u64;
}

fn wrong(spheres: &[[f32; 4]], rays: &[Ray], bounds: &[(f64, bool)]) -> Result<usize, QueryError> {
    let (t, truth): (Vec<f64>, Vec<bool>) = bounds.iter().copied().unzip();
    let mut answers = vec![false; rays.len()];
    let tree = SphereTree::from_rows(spheres)?;
    tree.occluded_columns(&Columns::new(rays).view(), &t, &mut answers)?;
    Ok(answers.iter().zip(&truth).filter(|(answer, truth)| answer != truth).count())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stress::REGIMES;

    #[test]
    fn a_bound_at_the_distance_is_told_from_one_beyond() {
        let ray = Ray { origin: [-3.0, 0.0, 0.0], direction: [0.5, 0.0, 0.0] };
        let unit = [0.0, 0.0, 0.0, 1.0];
        let known = reference::nearer_than(unit, &ray, about).unwrap();
        assert_eq!(known.map(|(_, nearer)| nearer), [false, false, false, false, true, true, true]);
        assert!(known.is_sorted() && known[3].0 == 4.0);
        let mut report = RegimeReport::new(&REGIMES[0]);
        count(&[unit], &[(ray, 0)], &mut report);
        assert_eq!((report.bounds, report.form(Form::Spherule).wrong_bounds), (7, 0));
        // A sphere in front is no part of the truth handed in: what is behind it is not nearest.
        let nearer = [-2.0, 0.0, 0.0, 0.5];
        count(&[unit, nearer], &[(ray, 0)], &mut report);
        assert_eq!((report.bounds, report.form(Form::Spherule).wrong_bounds), (14, 4));
    }
}
