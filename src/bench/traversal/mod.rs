//! Rays per second of every traversal, for four classes of rays.

mod tables;
mod walks;

use self::tables::{builders, plot, walks};
use self::walks::{AUTO, SINGLE, WALKS, Walk};
use super::build::BUILDERS;
use super::rounds::{Times, clock};
use super::{BenchError, Options, Tell};
use crate::bvh::builders::{Builder, build};
use crate::bvh::{Bvh, Traversal, Tree, Visits};
use crate::ray::{Hits, MISS};
use crate::report::Report;
use crate::spheres::Spheres;
use crate::workload::{Class, SphereScene, Views};

const EXPLANATION: &str = "One thread. Rays are made beforehand, only tracing is timed: medians over \
    the rounds, in which every walk has its turn. What each of them finds is compared with what \
    single rays find; only the walk that takes the word of single precision may differ, in one ray \
    of a hundred. Brute force is measured where there are a few hundred spheres. A packet's visit \
    of a node or a leaf counts once.";

/// Seconds that a turn takes at least.
const TURN: f64 = 0.02;

/// Spheres in the order of their tree.
struct BuiltTree {
    spheres: Spheres,
    bvh: Bvh,
}

/// What was measured for one class of rays.
struct Outcome {
    scene: SphereScene,
    class: Class,
    rays: usize,
    hits: f64,
    /// By walk, then by builder.
    times: Times,
    /// By walk.
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

/// Measures the walks.
///
/// # Errors
/// A scene is unknown or does not fit in memory, or walks find different hits.
pub fn measure(options: &Options, tell: Tell) -> Result<Report, BenchError> {
    use SphereScene as S;
    let most = [S::PAPER400, S::VOLUME10K, S::LAYER250K, S::VOLUME1M, S::LOGNORMAL1M];
    let usual = if options.pick([false, false, true]) { &S::ALL[..] } else { &most };
    let usual = if options.pick([true, false, false]) { &most[..1] } else { usual };
    let scenes = options.choose(&S::ALL, usual, |scene| scene.name)?;
    let mut outcomes = Vec::new();
    for scene in scenes {
        outcomes.extend(of_scene(scene, options, tell)?);
    }
    let plots = Class::ALL.map(|class| plot(class, &outcomes));
    Ok(Report {
        name: "traversal".to_owned(),
        title: "Finding what rays hit".to_owned(),
        about: EXPLANATION.to_owned(),
        settings: options.settings(),
        tables: vec![walks(&outcomes), builders(&outcomes)],
        plots: plots.to_vec(),
    })
}

fn of_scene(scene: SphereScene, options: &Options, tell: Tell) -> Result<Vec<Outcome>, BenchError> {
    let side = options.pick([64, 256, 512]);
    let mut trees = Vec::new();
    for (builder, _) in BUILDERS {
        let tree = BuiltTree::new(scene, builder)?;
        let views = Views::new(scene, (&tree.spheres, &tree.bvh), side);
        trees.push((tree, views));
    }
    let outcome = |class: Class| {
        tell(&format!("traversal: {}, {} rays", scene.name, class.name()));
        of_class((scene, class), &trees, options.rounds)
    };
    Class::ALL.into_iter().map(outcome).collect()
}

/// Where the tree that the walks are compared on is in [`BUILDERS`].
const BEST: usize = 1;

fn of_class(
    (scene, class): (SphereScene, Class),
    trees: &[(BuiltTree, Views)],
    rounds: u32,
) -> Result<Outcome, BenchError> {
    let any = class.is_any();
    let (best, views) = &trees[BEST];
    let rays = views.rays(class);
    let expected = WALKS[SINGLE].run(any, best.view(), rays);
    let times = Times::by_turns(rounds, WALKS.len() + trees.len(), |i| {
        let auto = &WALKS[AUTO];
        if let Some((tree, views)) = i.checked_sub(WALKS.len()).map(|tree| &trees[tree]) {
            let rays = views.rays(class);
            return Ok::<_, BenchError>(clock(TURN, || auto.run(any, tree.view(), rays)).0);
        }
        let walk = &WALKS[i];
        if !walk.suits(best.spheres.len()) {
            return Ok(f64::NAN);
        }
        let (seconds, hits) = clock(TURN, || walk.run(any, best.view(), rays));
        check(walk, (&hits, &expected), rays.len(), class)
            .map_err(|fault| BenchError::Differ(format!("{}: {fault}", scene.name)))?;
        Ok(seconds)
    })?;
    let visits = WALKS.iter().map(|walk| {
        let counts = walk.exact && walk.tracer.traversal != Traversal::Brute;
        counts.then(|| walk.count(any, best.view(), rays))
    });
    let count = (0..rays.len()).filter(|&row| expected.sphere[row] != MISS).count();
    let hits = count as f64 / rays.len().max(1) as f64;
    Ok(Outcome { scene, class, rays: rays.len(), hits, times, visits: visits.collect() })
}

/// Whether the walk found what single rays found.
fn check(
    walk: &Walk,
    (found, expected): (&Hits, &Hits),
    rays: usize,
    class: Class,
) -> Result<(), String> {
    let differs = |row: &usize| {
        let missed = |hits: &Hits| hits.sphere[*row] == MISS;
        let closest =
            found.sphere[*row] != expected.sphere[*row] || found.t[*row] != expected.t[*row];
        missed(found) != missed(expected) || (!class.is_any() && walk.exact && closest)
    };
    let wrong = (0..rays).filter(differs).count();
    if wrong == 0 || (!walk.exact && wrong * 100 <= rays) {
        return Ok(());
    }
    let (class, name) = (class.name(), walk.name);
    Err(format!("{wrong} of {rays} {class} rays differ between the walks single and {name}"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::tests::quick;
    use crate::report::Cell;

    #[test]
    fn walks_agree_and_brute_force_is_among_them() {
        let report = measure(&quick(&["paper400"]), &|_| ()).unwrap();
        assert_eq!(report.tables[0].rows.len(), Class::ALL.len() * WALKS.len());
        assert_eq!(report.tables[1].rows.len(), Class::ALL.len());
        let number = |row: usize, column: usize| match report.tables[0].rows[row][column] {
            Cell::Number(number) => number,
            _ => f64::NAN,
        };
        // Single rays and streams visit the same but for their order; packets share visits.
        assert!(number(SINGLE, 6) >= 1.0 && number(5, 6) < number(SINGLE, 6) / 2.0);
        assert!(number(SINGLE, 7) >= number(SINGLE, 8));
    }

    #[test]
    fn a_wrong_hit_is_told() {
        let (mut found, expected) = (Hits::with_capacity(8), Hits::with_capacity(8));
        assert!(check(&WALKS[0], (&found, &expected), 8, Class::Camera).is_ok());
        found.set(3, 1.0, 7);
        let message = check(&WALKS[AUTO], (&found, &expected), 8, Class::Shadow).unwrap_err();
        assert!(message.contains("1 of 8 shadow rays") && message.contains("auto"), "{message}");
        assert!(check(&WALKS[7], (&found, &expected), 8, Class::Camera).is_err());
    }
}
