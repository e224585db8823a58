//! Rays per second of every traversal, for four classes of rays.

mod tables;
mod variants;

use self::tables::{builders, plot, rates};
use self::variants::{AUTO, SINGLE, VARIANTS, Variant};
use super::build::BUILDERS;
use super::rounds::{Times, clock};
use super::{BenchError, Options, Progress};
use crate::report::Report;
use crate::workload::{Class, SphereScene, Views};
use spherule_render::bvh::builders::{Builder, build};
use spherule_render::bvh::{Bvh, Traversal, Tree, Visits};
use spherule_render::ray::{Hits, MISS};
use spherule_render::spheres::Spheres;

const EXPLANATION: &str = "One thread. Rays are generated beforehand, and only tracing is timed. \
    Traversals run in turns, and medians over the rounds are given. Hits are compared with those of \
    single rays; only the variant that accepts single-precision hits without verification may differ, \
    in one ray of a hundred. Brute force is measured for at most 1,000 spheres. A packet's visit of a \
    node or a leaf counts once.";

/// Minimum duration of a turn in seconds; short ones are repeated.
const TURN: f64 = 0.02;

/// A BVH with its spheres, in the order of its leaves.
struct BuiltTree {
    spheres: Spheres,
    bvh: Bvh,
}

/// Results for one class of rays.
struct Outcome {
    scene: SphereScene,
    class: Class,
    rays: usize,
    /// Fraction of rays that hit.
    hits: f64,
    /// Indexed by variant; then one for each builder.
    times: Times,
    /// Indexed by variant.
    visits: Vec<Option<Visits>>,
}

impl BuiltTree {
    fn new(scene: SphereScene, builder: Builder) -> Result<Self, BenchError> {
        let mut spheres = scene.spheres()?;
        let bvh = build(&mut spheres, builder);
        Ok(Self { spheres, bvh })
    }

    fn view(&self) -> Tree<'_> {
        Tree { bvh: &self.bvh, spheres: &self.spheres }
    }
}

/// Measures the traversals.
///
/// # Errors
/// A scene is unknown or does not fit in memory, or traversals find different hits.
pub fn measure(options: &Options, progress: Progress) -> Result<Report, BenchError> {
    use SphereScene as S;
    let usual = [S::PAPER400, S::VOLUME10K, S::LAYER250K, S::VOLUME1M, S::LOGNORMAL1M];
    let scenes = if options.pick([false, false, true]) { &S::ALL[..] } else { &usual };
    let scenes = if options.pick([true, false, false]) { &usual[..1] } else { scenes };
    let scenes = options.choose(&S::ALL, scenes, |scene| scene.name)?;
    let mut outcomes = Vec::new();
    for scene in scenes {
        outcomes.extend(measure_scene(scene, options, progress)?);
    }
    let plots = Class::ALL.map(|class| plot(class, &outcomes));
    Ok(Report {
        name: "traversal".to_owned(),
        title: "Ray traversal".to_owned(),
        about: EXPLANATION.to_owned(),
        settings: options.settings(),
        tables: vec![rates(&outcomes), builders(&outcomes)],
        plots: plots.to_vec(),
    })
}

fn measure_scene(
    scene: SphereScene,
    options: &Options,
    progress: Progress,
) -> Result<Vec<Outcome>, BenchError> {
    let side = options.pick([32, 256, 512]);
    let mut trees = Vec::new();
    for (builder, _) in BUILDERS {
        let tree = BuiltTree::new(scene, builder)?;
        let views = Views::new(scene, tree.view(), side);
        trees.push((tree, views));
    }
    let outcome = |class: Class| {
        progress(&format!("traversal: {}, {} rays", scene.name, class.name()));
        measure_class(scene, class, &trees, options.rounds)
    };
    Class::ALL.into_iter().map(outcome).collect()
}

/// Index in [`BUILDERS`] of the builder whose BVH the traversals are compared on.
const BEST: usize = 1;

fn measure_class(
    scene: SphereScene,
    class: Class,
    trees: &[(BuiltTree, Views)],
    rounds: u32,
) -> Result<Outcome, BenchError> {
    let any = class.is_any();
    let (best, views) = &trees[BEST];
    let rays = views.rays(class);
    let expected = VARIANTS[SINGLE].run(any, best.view(), rays);
    let times = Times::measure(rounds, VARIANTS.len() + trees.len(), |i| {
        let auto = &VARIANTS[AUTO];
        if let Some((tree, views)) = i.checked_sub(VARIANTS.len()).map(|tree| &trees[tree]) {
            let rays = views.rays(class);
            return Ok::<_, BenchError>(clock(TURN, || auto.run(any, tree.view(), rays)).0);
        }
        let variant = &VARIANTS[i];
        if !variant.suits(best.spheres.len()) {
            return Ok(f64::NAN);
        }
        let (seconds, hits) = clock(TURN, || variant.run(any, best.view(), rays));
        check(variant, &hits, &expected, rays.len(), class)
            .map_err(|fault| BenchError::Differ(format!("{}: {fault}", scene.name)))?;
        Ok(seconds)
    })?;
    let visits = VARIANTS.iter().map(|variant| {
        let counts = variant.exact && variant.tracer.traversal != Traversal::Brute;
        counts.then(|| variant.count(any, best.view(), rays))
    });
    let count = (0..rays.len()).filter(|&row| expected.sphere[row] != MISS).count();
    let hits = count as f64 / rays.len().max(1) as f64;
    Ok(Outcome { scene, class, rays: rays.len(), hits, times, visits: visits.collect() })
}

/// Checks that a variant found the hits of single rays.
fn check(
    variant: &Variant,
    found: &Hits,
    expected: &Hits,
    rays: usize,
    class: Class,
) -> Result<(), String> {
    let differs = |row: &usize| {
        let missed = |hits: &Hits| hits.sphere[*row] == MISS;
        let closest =
            found.sphere[*row] != expected.sphere[*row] || found.t[*row] != expected.t[*row];
        missed(found) != missed(expected) || (!class.is_any() && variant.exact && closest)
    };
    let wrong = (0..rays).filter(differs).count();
    if wrong == 0 || (!variant.exact && wrong * 100 <= rays) {
        return Ok(());
    }
    let (class, name) = (class.name(), variant.name);
    Err(format!("{wrong} of {rays} {class} rays differ between the traversals single and {name}"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::tests::quick;
    use crate::report::Cell;

    #[test]
    fn traversals_agree_including_brute_force() {
        let report = measure(&quick(&["paper400"]), &|_| ()).unwrap();
        assert_eq!(report.tables[0].rows.len(), Class::ALL.len() * VARIANTS.len());
        assert_eq!(report.tables[1].rows.len(), Class::ALL.len());
        let number = |row: usize, column: usize| match report.tables[0].rows[row][column] {
            Cell::Number(number) => number,
            _ => f64::NAN,
        };
        // Streams visit the same nodes as single rays, in another order; packets share visits.
        assert!(number(SINGLE, 6) >= 1.0 && number(5, 6) < number(SINGLE, 6) / 2.0);
        assert!(number(SINGLE, 7) >= number(SINGLE, 8));
    }

    #[test]
    fn wrong_hits_are_reported() {
        let (mut found, expected) = (Hits::with_capacity(8), Hits::with_capacity(8));
        assert!(check(&VARIANTS[0], &found, &expected, 8, Class::Camera).is_ok());
        found.set(3, 1.0, 7);
        let message = check(&VARIANTS[AUTO], &found, &expected, 8, Class::Shadow).unwrap_err();
        assert!(message.contains("1 of 8 shadow rays") && message.contains("auto"), "{message}");
        assert!(check(&VARIANTS[7], &found, &expected, 8, Class::Camera).is_err());
    }
}
