//! Runs of all tests on random scenes and rays.

use super::bodies;
use super::bounds;
use super::forms::{self, Answer, Form};
use super::rays::{self, Columns, Ray};
use super::reference::{self, Decision, DoubleDouble};
use super::regimes::{REGIMES, Regime};
use super::report::{FormReport, RegimeReport, Report};
use super::scenes;
use super::surface;
use glam::DVec3;
use rayon::prelude::*;
use spherule_core::internals::random::Random;
use spherule_render::elementary::atan2;
use spherule_render::query::{Hits, NOTHING, QueryError, SphereTree, Surface};
use spherule_render::sampling::{mix, stream};

/// Number of rays of a scene.
const RAYS: u64 = 256;

/// One ray in this many has its distance, normal and maximum distances tested, since integer arithmetic
/// is slow.
const MEASURED: usize = 16;

/// For this many rays, one further ray starts outward from a surface and one inward.
const SURFACE: usize = 8;

/// Number of a regime's rays for each one that tests sticks, ellipsoids or cones: their reference is slow.
const BODY_SHARE: u64 = 4;

/// Options of a run.
#[derive(Clone, Debug)]
pub struct Options {
    /// Total number of rays, divided evenly among the regimes.
    pub rays: u64,
    /// Seed of all random numbers.
    pub seed: u64,
    /// Regimes. Results of one depend on the others only by the number of rays.
    pub regimes: Vec<&'static Regime>,
}

/// Runs all tests in the current thread pool; those of bodies other than spheres only with all regimes. `progress` is called from any thread with the number of
/// rays finished since its last call.
///
/// The report does not depend on the number of threads.
pub fn run(options: &Options, progress: &(dyn Fn(u64) + Sync)) -> Report {
    let count = options.regimes.len().max(1) as u64;
    let regimes = options.regimes.iter().zip(0_u64..).map(|(regime, i)| {
        let rays = options.rays / count + u64::from(i < options.rays % count);
        run_regime(regime, rays, options.seed, progress)
    });
    let regimes: Vec<RegimeReport> = regimes.collect();
    let rays = regimes.iter().map(|regime| regime.rays).sum();
    let all = options.regimes.len() == REGIMES.len();
    let of_kind = options.rays / count / BODY_SHARE;
    let bodies = if all { bodies::run(of_kind, options.seed) } else { Vec::new() };
    Report { seed: options.seed, rays, regimes, bodies }
}

fn run_regime(
    regime: &Regime,
    rays: u64,
    seed: u64,
    progress: &(dyn Fn(u64) + Sync),
) -> RegimeReport {
    let name = regime.name.bytes().fold(mix(seed), |key, byte| stream(key, u64::from(byte)));
    let scene = |number: u64| {
        let count = RAYS.min(rays - number * RAYS);
        let report = run_scene(regime, count as usize, stream(name, number));
        progress(count);
        report
    };
    (0..rays.div_ceil(RAYS))
        .into_par_iter()
        .map(scene)
        .reduce(|| RegimeReport::new(regime), |a, b| a.merged(&b))
}

/// Returns the spheres of a random scene of a regime, and `count` rays.
pub fn sample(regime: &Regime, count: usize, random: &mut Random) -> (Vec<[f32; 4]>, Vec<Ray>) {
    let spheres = scenes::scene(&regime.recipe, random);
    let rays = (0..count).map(|_| rays::ray(&regime.recipe, &spheres, random)).collect();
    (spheres, rays)
}

/// Tests `count` rays in a random scene.
fn run_scene(regime: &Regime, count: usize, seed: u64) -> RegimeReport {
    let mut random = Random::new(seed);
    let (spheres, rays) = sample(regime, count, &mut random);
    let mut report = RegimeReport::new(regime);
    report.rays = count as u64;
    // Cannot fail: columns have equal lengths.
    let spherule = Spherule::trace(&spheres, &rays).unwrap_or_default();
    report.exact = spherule.exact;
    let mut measured = Vec::with_capacity(count.div_ceil(MEASURED));
    for (i, ray) in rays.iter().enumerate() {
        let expected = reference::closest(&spheres, ray);
        report.hits += u64::from(expected.sphere.is_some());
        report.close += u64::from(expected.close);
        let single = |form| forms::closest(form, &spheres, ray);
        // In the order of `Form::ALL`.
        let answers = [
            single(forms::naive),
            single(forms::naive_offset),
            single(forms::good),
            spherule.answer(i),
        ];
        for (form, answer) in report.forms.iter_mut().zip(&answers) {
            count_decision(form, expected, answer.as_ref());
        }
        if i % MEASURED == 0 {
            measure(&mut report, &spheres, ray, expected, &answers);
            measured.extend(expected.sphere.map(|sphere| (*ray, sphere)));
        }
    }
    report.forms[Form::Spherule as usize].wrong_hits += spherule.contradictions;
    bounds::count(&spheres, &measured, &mut report);
    surface::count(&spheres, count.div_ceil(SURFACE), &mut random, &mut report);
    report
}

fn count_decision(form: &mut FormReport, expected: Decision, answer: Option<&Answer>) {
    let sphere = answer.map(|answer| answer.sphere);
    if sphere.is_some() != expected.sphere.is_some() {
        form.wrong_hits += 1;
    } else if sphere != expected.sphere {
        form.wrong_spheres += 1;
    }
}

/// Measures errors of distance and normal of the tests that found the right sphere.
fn measure(
    report: &mut RegimeReport,
    spheres: &[[f32; 4]],
    ray: &Ray,
    expected: Decision,
    answers: &[Option<Answer>; Form::ALL.len()],
) {
    let solution = expected.sphere.and_then(|sphere| reference::solve(spheres[sphere], ray));
    let Some(solution) = solution else { return };
    let unit = f64::from(f32::EPSILON);
    for (form, answer) in report.forms.iter_mut().zip(answers) {
        let Some(answer) = answer.filter(|answer| Some(answer.sphere) == expected.sphere) else {
            continue;
        };
        form.measured += 1;
        let error = difference(answer.t, solution.t).abs();
        form.t_error = form.t_error.max(error / solution.t.high / unit);
        form.t_error_natural = form.t_error_natural.max(error / solution.t_unit);
        form.normal_error = form.normal_error.max(angle(answer.normal, &solution.normal) / unit);
    }
}

fn difference(x: f64, expected: DoubleDouble) -> f64 {
    (x - expected.high) - expected.low
}

/// Returns the angle between a vector and a unit vector. It is computed from their difference, so it is
/// accurate even far below the unit roundoff.
fn angle(found: DVec3, expected: &[DoubleDouble; 3]) -> f64 {
    let unit = DVec3::from(expected.map(|component| component.high));
    let rest = DVec3::from(std::array::from_fn(|i| difference(found[i], expected[i])));
    atan2(unit.cross(rest).length(), found.dot(unit))
}

/// Answers of [`Form::Spherule`] to the rays of a scene.
#[derive(Default)]
struct Spherule {
    t: Vec<f64>,
    sphere: Vec<u32>,
    surface: Vec<Surface>,
    exact: u64,
    /// Number of rays for which closest-hit and any-hit queries disagree.
    contradictions: u64,
}

impl Spherule {
    fn trace(spheres: &[[f32; 4]], rays: &[Ray]) -> Result<Self, QueryError> {
        let tree = SphereTree::from_rows(spheres)?;
        let columns = Columns::new(rays);
        let bounds = vec![f64::INFINITY; rays.len()];
        let (mut t, mut sphere) = (bounds.clone(), vec![NOTHING; rays.len()]);
        let mut surface = vec![Surface::default(); rays.len()];
        let hits = Hits { t: &mut t, sphere: &mut sphere, surface: Some(&mut surface) };
        let closest = tree.intersect_columns(&columns.view(), hits)?;
        let mut occluded = vec![false; rays.len()];
        let any = tree.occluded_columns(&columns.view(), &bounds, &mut occluded)?;
        let pairs = sphere.iter().zip(&occluded);
        let contradictions = pairs.filter(|(sphere, any)| (**sphere != NOTHING) != **any).count();
        Ok(Self {
            t,
            sphere,
            surface,
            exact: closest.exact + any.exact,
            contradictions: contradictions as u64,
        })
    }

    fn answer(&self, ray: usize) -> Option<Answer> {
        let sphere = self.sphere.get(ray).filter(|sphere| **sphere != NOTHING)?;
        let normal = DVec3::from(self.surface[ray].normal);
        Some(Answer { sphere: *sphere as usize, t: self.t[ray], normal })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::{AtomicU64, Ordering};

    fn all(rays: u64, seed: u64) -> Report {
        run(&Options { rays, seed, regimes: REGIMES.iter().collect() }, &|_| ())
    }

    #[test]
    fn spherule_is_never_wrong_and_single_precision_is() {
        for seed in [0, 1, 0xfeed] {
            let report = all(20_000, seed);
            for regime in &report.regimes {
                let spherule = regime.form(Form::Spherule);
                assert_eq!(spherule.wrong(), 0, "seed {seed}: {regime:?}");
                assert!(regime.leaving > 0 && regime.entering > 0, "{}", regime.name);
                assert!(regime.bounds > 0 || regime.name == "behind", "{}", regime.name);
                // Four natural units of double precision, 2^-29 of those of single precision.
                assert!(spherule.t_error_natural < 4.0 / 29_f64.exp2(), "seed {seed}: {regime:?}");
                assert!(spherule.normal_error < 0.5, "seed {seed}: {regime:?}");
                // Half a unit in the last place of double precision.
                assert!(spherule.t_error <= 1.0 / 30_f64.exp2(), "seed {seed}: {regime:?}");
            }
            let far = report.regimes.iter().find(|regime| regime.name == "far_1e5").unwrap();
            assert!(far.wrong_fraction(Form::Naive) > 0.1, "{far:?}");
            assert!(report.wrong(Form::Good) > 0);
            let near = &report.regimes[0];
            assert!(near.hits > near.rays / 4 && near.form(Form::Naive).self_hits > 0);
        }
    }

    #[test]
    fn the_report_does_not_depend_on_threads_or_other_regimes() {
        let with = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| all(40_000, 5))
        };
        let report = with(1);
        assert_eq!(report, with(3));
        assert_ne!(report, all(40_000, 6));
        let count = REGIMES.len() as u64;
        let (last, rays) = (&REGIMES[REGIMES.len() - 1], report.regimes[REGIMES.len() - 1].rays);
        let alone = run(&Options { rays, seed: 5, regimes: vec![last] }, &|_| ());
        assert_eq!(alone.regimes[0], report.regimes[count as usize - 1]);
    }

    #[test]
    fn every_ray_is_counted_once() {
        let done = AtomicU64::new(0);
        let regimes: Vec<_> = REGIMES[..3].iter().collect();
        let options = Options { rays: 1001, seed: 0, regimes };
        let report = run(&options, &|rays| {
            done.fetch_add(rays, Ordering::Relaxed);
        });
        let rays: Vec<_> = report.regimes.iter().map(|regime| regime.rays).collect();
        assert_eq!((rays, report.rays, done.into_inner()), (vec![334, 334, 333], 1001, 1001));
        let none = run(&Options { rays: 10, seed: 0, regimes: Vec::new() }, &|_| ());
        assert_eq!(none.rays, 0);
    }

    #[test]
    fn angles_are_right_far_below_the_unit_roundoff() {
        let axis = |x: f64| DoubleDouble { high: x, low: 0.0 };
        let expected = [axis(1.0), axis(0.0), DoubleDouble { high: 0.0, low: 1e-25 }];
        assert!((angle(DVec3::X, &expected) / 1e-25 - 1.0).abs() < 1e-9);
        assert!((angle(DVec3::Y, &expected) - std::f64::consts::FRAC_PI_2).abs() < 1e-9);
        assert!((angle(DVec3::NEG_X, &expected) - std::f64::consts::PI).abs() < 1e-9);
    }
}
