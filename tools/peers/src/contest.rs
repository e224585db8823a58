//! Both systems on the same rays, by turns.

use crate::embree::{Call, Scene};
use crate::levels::Runner;
use crate::rays::{Class, Order, Rays};
use crate::referee::{Referee, Verdicts};
use crate::scenes::Columns;
use cpu_time::ThreadTime;
use serde::Serialize;
use spherule_core::SphereTree;
use spherule_core::{Hits, NOTHING, QueryError, Surface};
use std::error::Error;
use std::time::Duration;

/// One way to ask Embree.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Entry {
    /// Which of Embree's configurations.
    pub configuration: usize,
    /// Rays in each call.
    pub width: usize,
    /// Whether they are said to go alike.
    pub coherent: bool,
    /// Whether the spheres come along a Morton curve, not as in the file.
    pub sorted: bool,
}

/// What was measured for one class of rays in one scene; rates in million rays per second.
#[derive(Clone, Debug, Serialize)]
pub struct Outcome {
    pub scene: String,
    pub class: Class,
    pub order: Order,
    pub rays: usize,
    /// Share of the rays that hit something.
    pub hits: f64,
    /// The way that made Embree fastest.
    pub fastest: Entry,
    pub embree: f64,
    pub spherule: f64,
    /// Calls for one ray each, in the same order.
    pub single: SingleCalls,
    /// Spherule compiled for other processor levels.
    pub levels: Vec<(String, f64)>,
    /// Rays that Spherule decided in arithmetic without rounding.
    pub exact: u64,
    pub verdicts: Verdicts,
    /// One run of each way to ask Embree.
    pub heat: Vec<(Entry, f64)>,
}

/// Nanoseconds that a call for one ray takes.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct SingleCalls {
    /// `rtcIntersect1` or `rtcOccluded1`, in the fastest of all ways.
    pub embree: f64,
    /// `SphereTree::intersect` or `occluded`.
    pub spherule: f64,
}

/// Who competes in a scene, and for how long.
pub struct Contest<'a> {
    pub scene: &'a str,
    pub spheres: &'a Columns,
    pub tree: &'a SphereTree,
    /// The rows of spheres along a Morton curve.
    pub order: &'a [u32],
    /// Whether Spherule leaves out points and normals.
    pub hits_only: bool,
    /// For each of Embree's configurations: spheres as in the file, and along the curve.
    pub embree: &'a [[Scene<'a>; 2]],
    /// The ways to ask Embree, which run in a first heat.
    pub entries: &'a [Entry],
    /// Number of them, the fastest, that run in the rounds.
    pub finalists: u32,
    pub rounds: u32,
}

/// Room for answers.
pub struct Answers {
    pub spheres: Vec<u32>,
    embree_t: Vec<f32>,
    pub spherule_t: Vec<f64>,
    surfaces: Vec<Surface>,
    pub occluded: Vec<bool>,
}

impl Entry {
    /// All ways to ask so many configurations with packets of these widths.
    pub fn all(configurations: usize, widths: &[usize]) -> Vec<Self> {
        let mut entries = Vec::new();
        for configuration in 0..configurations {
            for &width in widths {
                for (coherent, sorted) in
                    [(false, false), (false, true), (true, false), (true, true)]
                {
                    entries.push(Self { configuration, width, coherent, sorted });
                }
            }
        }
        entries
    }

    fn call(self) -> Call {
        Call { width: self.width, coherent: self.coherent }
    }
}

impl Answers {
    pub fn new(count: usize) -> Self {
        Self {
            spheres: vec![NOTHING; count],
            embree_t: vec![0.0; count],
            spherule_t: vec![f64::INFINITY; count],
            surfaces: vec![Surface::default(); count],
            occluded: vec![false; count],
        }
    }
}

impl Contest<'_> {
    /// Measures one class of rays: a heat of all ways to ask Embree, then rounds of the finalists
    /// and Spherule by turns, for every level.
    ///
    /// # Errors
    /// Columns of different lengths, or a level that has other answers.
    pub fn run(
        &self,
        class: Class,
        order: Order,
        rays: &Rays,
        runners: &mut [Runner],
    ) -> Result<Outcome, Box<dyn Error>> {
        let mut answers = Answers::new(rays.len());
        let rate = |seconds: f64| rays.len() as f64 / seconds / 1e6;
        let mut heat: Vec<(Entry, f64)> = Vec::new();
        for &entry in self.entries {
            heat.push((entry, rate(self.embree(class, rays, entry, &mut answers))));
        }
        heat.sort_by(|a, b| b.1.total_cmp(&a.1));
        let (_, exact) = self.spherule(class, rays, &mut answers)?;
        let finalists = &heat[..heat.len().min(self.finalists as usize)];
        let mut embree = vec![Vec::new(); finalists.len()];
        // Of the ways to ask for one ray, heat decides.
        let one = heat.iter().find(|(entry, _)| entry.width == 1).map(|(entry, _)| *entry);
        let (mut spherule, mut single) = (Vec::new(), [Vec::new(), Vec::new()]);
        let mut levels = vec![Vec::new(); runners.len()];
        for _ in 0..self.rounds {
            for ((entry, _), seconds) in finalists.iter().zip(&mut embree) {
                seconds.push(self.embree(class, rays, *entry, &mut answers));
            }
            spherule.push(self.spherule(class, rays, &mut answers)?.0);
            if let Some(one) = one {
                single[0].push(self.embree(class, rays, one, &mut answers));
                single[1].push(self.spherule_single(class, rays, &mut answers));
            }
            for (runner, seconds) in runners.iter_mut().zip(&mut levels) {
                seconds.push(runner.run(class, &answers)?);
            }
        }
        let names = runners.iter().map(|runner| runner.level.clone());
        let levels = names.zip(levels.iter_mut().map(|seconds| rate(median(seconds))));
        let medians = embree.iter_mut().map(|seconds| median(seconds));
        let mut ranked: Vec<_> = finalists.iter().map(|(entry, _)| *entry).zip(medians).collect();
        ranked.sort_by(|a, b| a.1.total_cmp(&b.1));
        let (fastest, seconds) = ranked[0];
        let (verdicts, hits) = self.judge(class, rays, fastest)?;
        Ok(Outcome {
            scene: self.scene.to_owned(),
            class,
            order,
            rays: rays.len(),
            hits,
            fastest,
            embree: rate(seconds),
            spherule: rate(median(&mut spherule)),
            single: SingleCalls {
                embree: median(&mut single[0]) / rays.len() as f64 * 1e9,
                spherule: median(&mut single[1]) / rays.len() as f64 * 1e9,
            },
            levels: levels.collect(),
            exact,
            verdicts,
            heat,
        })
    }

    /// Seconds that Embree takes.
    fn embree(&self, class: Class, rays: &Rays, entry: Entry, answers: &mut Answers) -> f64 {
        let scene = &self.embree[entry.configuration][usize::from(entry.sorted)];
        let call = entry.call();
        let mut clock = Clock::default();
        while clock.goes_on() {
            clock.time(|| {
                if class.is_any() {
                    scene.occluded(rays, call, &mut answers.occluded);
                } else {
                    scene.intersect(rays, call, &mut answers.spheres, &mut answers.embree_t);
                }
            });
        }
        clock.mean()
    }

    /// Seconds that Spherule takes, and rays that needed arithmetic without rounding.
    fn spherule(
        &self,
        class: Class,
        rays: &Rays,
        answers: &mut Answers,
    ) -> Result<(f64, u64), QueryError> {
        spherule(self.tree, class, rays, self.hits_only, answers)
    }

    /// Seconds that calls of Spherule for one ray each take.
    fn spherule_single(&self, class: Class, rays: &Rays, answers: &mut Answers) -> f64 {
        let mut clock = Clock::default();
        while clock.goes_on() {
            clock.time(|| {
                for i in 0..rays.len() {
                    let (origin, direction) = rays.row(i);
                    let (origin, direction) = (origin.into(), direction.into());
                    let bound = f64::from(rays.bound(i));
                    if class.is_any() {
                        answers.occluded[i] = self.tree.occluded(origin, direction, bound);
                    } else if let Some(hit) = self.tree.intersect_within(origin, direction, bound) {
                        let surface = Surface { point: hit.point, normal: hit.normal };
                        (answers.spheres[i], answers.spherule_t[i]) = (hit.sphere, hit.t);
                        answers.surfaces[i] = surface;
                    } else {
                        answers.spheres[i] = NOTHING;
                    }
                }
            });
        }
        clock.mean()
    }

    /// Where the systems differ, and the share of rays that hit something.
    fn judge(
        &self,
        class: Class,
        rays: &Rays,
        entry: Entry,
    ) -> Result<(Verdicts, f64), QueryError> {
        let (mut embree, mut spherule) = (Answers::new(rays.len()), Answers::new(rays.len()));
        self.embree(class, rays, entry, &mut embree);
        self.spherule(class, rays, &mut spherule)?;
        let referee = Referee { rays, spheres: self.spheres };
        let (verdicts, hits) = if class.is_any() {
            let named = |ray| self.named(rays, ray);
            let verdicts = referee.any(&embree.occluded, &spherule.occluded, named);
            (verdicts, spherule.occluded.iter().filter(|hit| **hit).count())
        } else {
            self.as_filed(entry, &mut embree.spheres);
            let verdicts = referee.closest(&embree.spheres, &spherule.spheres);
            (verdicts, spherule.spheres.iter().filter(|sphere| **sphere != NOTHING).count())
        };
        Ok((verdicts, hits as f64 / rays.len().max(1) as f64))
    }

    /// What the systems say that a ray hits first.
    fn named(&self, rays: &Rays, ray: usize) -> [u32; 2] {
        let (origin, direction) = rays.row(ray);
        let spherule = self.tree.intersect(origin.into(), direction.into());
        let mut one = Rays::default();
        one.push(origin, direction);
        let (mut embree, mut t) = ([NOTHING], [0.0]);
        let call = Call { width: 1, coherent: false };
        self.embree[0][0].intersect(&one, call, &mut embree, &mut t);
        [embree[0], spherule.map_or(NOTHING, |hit| hit.sphere)]
    }

    /// Rows of the file instead of those along the curve.
    fn as_filed(&self, entry: Entry, spheres: &mut [u32]) {
        if entry.sorted {
            for sphere in spheres.iter_mut().filter(|sphere| **sphere != NOTHING) {
                *sphere = self.order[*sphere as usize];
            }
        }
    }
}

/// Seconds that Spherule takes, and rays that needed arithmetic without rounding.
///
/// # Errors
/// Columns of different lengths.
pub fn spherule(
    tree: &SphereTree,
    class: Class,
    rays: &Rays,
    hits_only: bool,
    answers: &mut Answers,
) -> Result<(f64, u64), QueryError> {
    let columns = rays.columns();
    let Answers { spherule_t: t, spheres: sphere, occluded, surfaces, .. } = answers;
    let (mut clock, mut exact) = (Clock::default(), 0);
    while clock.goes_on() {
        let tally = clock.time(|| {
            rays.fill_bounds(t);
            if class.is_any() {
                tree.occluded_columns(&columns, t, occluded)
            } else {
                let surface = (!hits_only).then_some(surfaces.as_mut_slice());
                tree.intersect_columns(&columns, Hits { t, sphere, surface })
            }
        })?;
        exact = tally.exact;
    }
    Ok((clock.mean(), exact))
}

/// Adds up runs until they can be told from the clock's grain: in time of the processor, which other
/// processes disturb less.
#[derive(Default)]
struct Clock {
    total: Duration,
    runs: u32,
}

impl Clock {
    fn goes_on(&self) -> bool {
        self.runs == 0 || self.total < Duration::from_millis(20)
    }

    fn time<T>(&mut self, run: impl FnOnce() -> T) -> T {
        let start = ThreadTime::now();
        let result = run();
        self.total += start.elapsed();
        self.runs += 1;
        result
    }

    /// Seconds of a run.
    fn mean(&self) -> f64 {
        self.total.as_secs_f64() / f64::from(self.runs)
    }
}

/// The middle of the values, the greater one if there are two.
fn median(values: &mut [f64]) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
}
