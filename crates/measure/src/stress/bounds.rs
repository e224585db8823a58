//! Tests of any-hit queries with a maximum distance.
//!
//! Maximum distances ("bounds") are chosen where the answer is hardest: at the distance of the hit, at
//! its neighbors in double precision, and at offsets that single precision can and cannot resolve.

use super::forms::Form;
use super::rays::{Columns, Ray};
use super::reference;
use super::report::RegimeReport;
use spherule_render::query::{QueryError, SphereTree};

/// Number of bounds of a ray.
const COUNT: usize = 9;

/// Relative offsets of bounds from the distance: 16 and a quarter of the unit in the last place of single
/// precision, and 32 of that of double precision.
const OFFSETS: [f64; 3] =
    [1.0 / (1 << 19) as f64, 1.0 / (1 << 25) as f64, 1.0 / (1_u64 << 47) as f64];

/// Returns the bounds for a distance, which is known to one unit in the last place of double precision.
fn bounds_around(t: f64) -> [f64; COUNT] {
    let [far, near, close] = OFFSETS;
    [
        t * (1.0 - far),
        t * (1.0 - near),
        t * (1.0 - close),
        t.next_down(),
        t,
        t.next_up(),
        t * (1.0 + close),
        t * (1.0 + near),
        t * (1.0 + far),
    ]
}

/// Counts wrong answers for rays that hit, each given with the sphere that it hits first.
pub(super) fn count(spheres: &[[f32; 4]], hits: &[(Ray, usize)], report: &mut RegimeReport) {
    let known = hits.iter().filter_map(|(ray, sphere)| {
        Some((ray, reference::nearer_than(spheres[*sphere], ray, bounds_around)?))
    });
    let questions = known.flat_map(|(ray, bounds)| bounds.map(|bound| (*ray, bound)));
    let (rays, bounds): (Vec<Ray>, Vec<(f64, bool)>) = questions.unzip();
    report.bounds += bounds.len() as u64;
    // Cannot fail: columns have equal lengths.
    let wrong = wrong(spheres, &rays, &bounds).unwrap_or(bounds.len());
    report.form_mut(Form::Spherule).wrong_bounds += wrong as u64;
}

fn wrong(spheres: &[[f32; 4]], rays: &[Ray], bounds: &[(f64, bool)]) -> Result<usize, QueryError> {
    let (t, expected): (Vec<f64>, Vec<bool>) = bounds.iter().copied().unzip();
    let mut answers = vec![false; rays.len()];
    let tree = SphereTree::from_rows(spheres)?;
    tree.occluded_columns(&Columns::new(rays).view(), &t, &mut answers)?;
    Ok(answers.iter().zip(&expected).filter(|(answer, expected)| answer != expected).count())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stress::REGIMES;

    #[test]
    fn bounds_at_the_distance_and_beyond_are_distinguished() {
        let ray = Ray { origin: [-3.0, 0.0, 0.0], direction: [0.5, 0.0, 0.0] };
        let unit = [0.0, 0.0, 0.0, 1.0];
        let known = reference::nearer_than(unit, &ray, bounds_around).unwrap();
        let nearer = known.map(|(_, nearer)| nearer);
        assert_eq!(nearer, [false, false, false, false, false, true, true, true, true]);
        assert!(known.is_sorted() && known[4].0 == 4.0);
        let mut report = RegimeReport::new(&REGIMES[0]);
        count(&[unit], &[(ray, 0)], &mut report);
        assert_eq!((report.bounds, report.form(Form::Spherule).wrong_bounds), (9, 0));
        // With another sphere in front, the given one is not the nearest, so answers are wrong.
        let nearer = [-2.0, 0.0, 0.0, 0.5];
        count(&[unit, nearer], &[(ray, 0)], &mut report);
        assert_eq!((report.bounds, report.form(Form::Spherule).wrong_bounds), (18, 5));
    }
}
