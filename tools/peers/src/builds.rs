//! Time and memory of builds.

use crate::options::Options;
use crate::scenes::Columns;
use peak_alloc::PeakAlloc;
use serde::Serialize;
use spherule_core::SphereTree;
use spherule_measure::workload::SphereScene;
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

/// Builds over one scene, in the file's order.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Builds {
    pub scene: &'static str,
    pub spheres: usize,
    pub embree: Cost,
    pub spherule: Cost,
}

/// Small scenes are built until so many spheres are, large ones twice.
const ENOUGH: usize = 200_000;

/// Measures builds with one thread and two.
///
/// # Errors
/// Embree or a thread does not start, or spheres cannot be built over.
pub fn measure(
    options: &Options,
    scene: SphereScene,
    spheres: &Columns,
) -> Result<Builds, Box<dyn Error>> {
    let rows: Vec<_> = (0..spheres.len()).map(|row| spheres.row(row)).collect();
    // Configurations differ in their trees, not in how long these take to build.
    let configuration = options.configuration.first().map_or("", String::as_str);
    let times = ENOUGH.div_ceil(rows.len()).clamp(2, 50);
    let (mut embree, mut spherule) = (Cost::default(), Cost::default());
    for threads in [2, 1] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build()?;
        let (mut seconds, mut spherule_seconds) = (f64::INFINITY, f64::INFINITY);
        for _ in 0..times {
            let device = options.device(configuration, threads)?;
            let start = Instant::now();
            let built = device.build(&rows, options.build())?;
            seconds = seconds.min(start.elapsed().as_secs_f64());
            let (bytes, peak) = device.bytes();
            drop(built);
            embree.keep(rows.len(), bytes, peak);

            ALLOCATED.reset_peak_usage();
            let before = ALLOCATED.current_usage();
            let start = Instant::now();
            let tree = pool.install(|| {
                let Columns { x, y, z, radius } = spheres;
                SphereTree::from_columns(x, y, z, radius)
            })?;
            spherule_seconds = spherule_seconds.min(start.elapsed().as_secs_f64());
            let peak = ALLOCATED.peak_usage().saturating_sub(before);
            spherule.keep(rows.len(), tree.bytes(), peak);
        }
        embree.seconds[threads - 1] = seconds;
        spherule.seconds[threads - 1] = spherule_seconds;
    }
    Ok(Builds { scene: scene.name, spheres: rows.len(), embree, spherule })
}

impl Cost {
    fn keep(&mut self, spheres: usize, bytes: usize, peak: usize) {
        self.bytes = bytes as f64 / spheres as f64;
        self.peak = peak as f64 / spheres as f64;
    }
}
