//! Time and memory of builds.

use crate::options::Options;
use crate::scenes::Columns;
use peak_alloc::PeakAlloc;
use rayon::ThreadPool;
use serde::Serialize;
use spherule_core::SphereTree;
use spherule_core::internals::bvh::builders::{self, Builder};
use spherule_core::internals::spheres::Spheres;
use std::error::Error;
use std::time::Instant;

/// Counts what Rust code allocates, and so what Spherule does; Embree counts its own.
#[global_allocator]
static ALLOCATED: PeakAlloc = PeakAlloc;

/// What a system's build took.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub struct Cost {
    /// Seconds with one thread and with two: the least of some builds by turns.
    pub seconds: [f64; 2],
    /// Bytes for each sphere once built, spheres included.
    pub bytes: f64,
    /// The most bytes for each sphere during the build, its input not counted.
    pub peak: f64,
}

/// Builds over one scene, in one order of its spheres.
#[derive(Clone, Debug, Serialize)]
pub struct Builds {
    pub scene: String,
    /// True if the spheres are sorted along a Morton curve, not as in the file.
    pub sorted: bool,
    pub spheres: usize,
    pub embree: Cost,
    pub spherule: Cost,
    /// Spherule's builder along a Morton curve.
    pub morton: Cost,
}

/// Scenes are built until so many spheres are, small ones 50 times, large ones twice.
const ENOUGH: usize = 2_000_000;

/// Measures builds with one thread and two.
///
/// # Errors
/// Embree or a thread does not start, or spheres cannot be built over.
pub fn measure(
    options: &Options,
    scene: &str,
    spheres: &Columns,
    sorted: bool,
) -> Result<Builds, Box<dyn Error>> {
    let rows: Vec<_> = (0..spheres.len()).map(|row| spheres.row(row)).collect();
    // Configurations differ in their trees, not in how long these take to build.
    let configuration = options.configuration.first().map_or("", String::as_str);
    let times = ENOUGH.div_ceil(rows.len()).clamp(2, 50);
    let [mut embree, mut spherule, mut morton] = [Cost::default(); 3];
    for threads in [2, 1] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build()?;
        for _ in 0..times {
            let device = options.device(configuration, threads)?;
            let start = Instant::now();
            let built = device.build(&rows, options.build())?;
            let seconds = start.elapsed().as_secs_f64();
            let (bytes, peak) = device.bytes();
            drop(built);
            embree.keep(rows.len(), threads, Taken { seconds, bytes, peak });

            let Columns { x, y, z, radius } = spheres;
            let (tree, taken) = timed(&pool, || SphereTree::from_columns(x, y, z, radius));
            let bytes = tree?.bytes();
            spherule.keep(rows.len(), threads, Taken { bytes, ..taken });

            let ((spheres, bvh), taken) = timed(&pool, || {
                let row = |i: usize| (rows[i], i as u32);
                let mut spheres = Spheres::from_rows(rows.len(), row);
                let bvh = builders::build(&mut spheres, Builder::Morton);
                (spheres, bvh)
            });
            let bytes = spheres.bytes() + bvh.bytes();
            morton.keep(rows.len(), threads, Taken { bytes, ..taken });
        }
    }
    Ok(Builds { scene: scene.to_owned(), sorted, spheres: rows.len(), embree, spherule, morton })
}

/// What one build took.
#[derive(Clone, Copy)]
struct Taken {
    seconds: f64,
    bytes: usize,
    peak: usize,
}

/// Builds on a thread of a pool, as Embree does on the thread that calls it, and measures all but the bytes at the end.
fn timed<T: Send>(pool: &ThreadPool, build: impl FnOnce() -> T + Send) -> (T, Taken) {
    pool.install(|| {
        ALLOCATED.reset_peak_usage();
        let before = ALLOCATED.current_usage();
        let start = Instant::now();
        let built = build();
        let seconds = start.elapsed().as_secs_f64();
        let peak = ALLOCATED.peak_usage().saturating_sub(before);
        (built, Taken { seconds, bytes: 0, peak })
    })
}

impl Cost {
    fn keep(&mut self, spheres: usize, threads: usize, taken: Taken) {
        let least = &mut self.seconds[threads - 1];
        *least = if *least > 0.0 { least.min(taken.seconds) } else { taken.seconds };
        self.bytes = taken.bytes as f64 / spheres as f64;
        self.peak = taken.peak as f64 / spheres as f64;
    }
}
