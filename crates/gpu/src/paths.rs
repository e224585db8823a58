//! Paths that a device follows from the camera to their ends, with the processor's numbers.

use crate::device::Device;
use crate::error::DeviceError;
use crate::stages::Kernel;
use crate::tree::{Answered, DeviceTree, FAR, Params};
use bytemuck::{Pod, Zeroable};
use spherule_render::World;
use spherule_render::world::{
    DeviceIntegration, DeviceIntegrator, DeviceJob, DevicePath, DevicePaths, DeviceRoulette,
};
use std::ops::Range;
use std::sync::{Arc, Mutex, PoisonError};
use wgpu::BufferUsages as Usage;

/// Follows the paths of renders of one world, whose tree is on the device.
#[derive(Debug)]
pub struct Integrator {
    tree: Arc<DeviceTree>,
    /// The colors of spheres, on the device.
    albedos: wgpu::Buffer,
}

/// The numbers of a job, as `job.wgsl` has them.
#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct JobNumbers {
    frame: [[f64; 3]; 4],
    size: [[f64; 2]; 2],
    lens_radius: f64,
    focus: f64,
    near: f64,
    ground_normal: [f64; 3],
    ground_height: f64,
    distance: f64,
    seed: [u32; 2],
    flags: u32,
    depth: u32,
    ground_albedo: [f32; 3],
    middle: [f32; 3],
    slope: [f32; 3],
    toward: [f32; 3],
    background: [f32; 3],
    threshold: f32,
    survival: f32,
    unused: f32,
}

/// Bits of the flags, as in `job.wgsl`.
mod flag {
    pub(super) const ORTHOGRAPHIC: u32 = 1;
    pub(super) const LENS: u32 = 2;
    pub(super) const HAS_GROUND: u32 = 4;
    pub(super) const FILTER_TABLE: u32 = 8;
    pub(super) const BACKGROUND: u32 = 16;
    pub(super) const GRADIENT: u32 = 32;
    pub(super) const ILLUMINATES: u32 = 64;
    pub(super) const ROULETTE_BY_THROUGHPUT: u32 = 128;
    pub(super) const ROULETTE_FIXED: u32 = 256;
}

/// A job on a device.
struct JobPaths {
    tree: Arc<DeviceTree>,
    albedos: wgpu::Buffer,
    integration: DeviceIntegration,
    numbers: wgpu::Buffer,
    sobol: wgpu::Buffer,
    offsets: wgpu::Buffer,
    /// Columns of paths, of the size of the last batch or larger.
    columns: Mutex<Option<Columns>>,
}

/// Columns of paths.
struct Columns {
    /// Pixels and paths that fit.
    capacity: [usize; 2],
    params: wgpu::Buffer,
    pixels: wgpu::Buffer,
    rays: wgpu::Buffer,
    found: wgpu::Buffer,
    sequences: wgpu::Buffer,
    /// Throughput, or the light of shadow rays.
    lights: wgpu::Buffer,
    paths: wgpu::Buffer,
    paths_to_read: wgpu::Buffer,
    alive: wgpu::Buffer,
    alive_to_read: wgpu::Buffer,
}

impl Integrator {
    /// Copies the colors of a world's spheres to the device that has its tree.
    ///
    /// # Errors
    /// Why the device can follow no paths: its arithmetic is not the processor's, colors do not fit, or it fails. The reason
    /// completes "the processor shades, for".
    pub fn new(tree: &Arc<DeviceTree>, world: &World) -> Result<Self, String> {
        let device = tree.device();
        if let Some(reason) = device.lacks_for_paths() {
            return Err(reason);
        }
        if !tree.is_single() {
            return Err("single precision does not hold the spheres".to_owned());
        }
        let colors: Vec<[f32; 3]> =
            (0..world.spheres.len() as u32).map(|sphere| world.albedo(sphere).to_array()).collect();
        let albedos = device.filled("colors", bytemuck::cast_slice(&colors));
        let albedos = albedos.map_err(|error| error.to_string())?;
        Ok(Self { tree: Arc::clone(tree), albedos })
    }
}

/// What the first stages of a batch of paths write, for tests: rays as `hits.wgsl` reads them.
#[doc(hidden)]
#[derive(Clone, Debug)]
pub struct FirstStages {
    /// Camera rays.
    pub camera_rays: Vec<[u32; 12]>,
    /// Positions in the Sobol sequences, and their seeds.
    pub sequences: Vec<[u32; 2]>,
    /// First hits.
    pub found: Vec<u32>,
    /// The rays that follow: shadow rays of ambient occlusion, or those of the first bounce.
    pub next_rays: Vec<[u32; 12]>,
}

impl Integrator {
    /// Runs the stages up to the first surface.
    ///
    /// # Errors
    /// The device fails.
    #[doc(hidden)]
    pub fn first_stages(
        &self,
        job: &DeviceJob,
        pixels: &[(u32, u32)],
        samples: &Range<u32>,
    ) -> Result<FirstStages, DeviceError> {
        let paths = JobPaths::new(self, job)?;
        let count = pixels.len() * samples.len();
        let columns = Columns::new(paths.device(), pixels.len(), count)?;
        paths.set_params(&columns, &paths.begin(&columns, pixels, samples));
        let stage = |kernel| paths.stage(kernel, &columns, count);
        stage(Kernel::Generate)?;
        let camera_rays = read_column(paths.device(), &columns.rays, count)?;
        let sequences = read_column(paths.device(), &columns.sequences, count)?;
        stage(Kernel::Hits { any: false, counts: false })?;
        let found = read_column(paths.device(), &columns.found, count)?;
        stage(match job.integration {
            DeviceIntegration::Occlusion { .. } => Kernel::Occlusion,
            DeviceIntegration::Diffuse { .. } => Kernel::Path,
        })?;
        let next_rays = read_column(paths.device(), &columns.rays, count)?;
        Ok(FirstStages { camera_rays, sequences, found, next_rays })
    }
}

/// Returns the first rows of a column.
fn read_column<T: Pod>(
    device: &Device,
    column: &wgpu::Buffer,
    rows: usize,
) -> Result<Vec<T>, DeviceError> {
    let bytes = (size_of::<T>() * rows) as u64;
    let copy = device.buffer("rows to read", bytes, Usage::MAP_READ | Usage::COPY_DST)?;
    device.copy(column, &copy, bytes);
    let mut read = vec![T::zeroed(); rows];
    device.read(&copy, bytes, |view| bytemuck::cast_slice_mut(&mut read).copy_from_slice(view))?;
    Ok(read)
}

impl DeviceIntegrator for Integrator {
    fn begin(&self, job: &DeviceJob) -> Option<Box<dyn DevicePaths>> {
        let paths = JobPaths::new(self, job);
        let paths = paths.map_err(|error| self.tree.device().fail(error)).ok()?;
        Some(Box::new(paths))
    }
}

impl JobPaths {
    fn new(integrator: &Integrator, job: &DeviceJob) -> Result<Self, DeviceError> {
        let device = integrator.tree.device();
        let filled = |what, bytes: &[u8]| device.filled(what, bytes);
        Ok(Self {
            tree: Arc::clone(&integrator.tree),
            albedos: integrator.albedos.clone(),
            integration: job.integration,
            numbers: filled("job", bytemuck::bytes_of(&numbers(job)))?,
            sobol: filled("direction vectors", bytemuck::cast_slice(&job.sobol))?,
            offsets: filled("filter", bytemuck::cast_slice(job.offsets.unwrap_or_default()))?,
            columns: Mutex::default(),
        })
    }

    fn device(&self) -> &Device {
        self.tree.device()
    }

    /// Follows paths.
    fn run(
        &self,
        pixels: &[(u32, u32)],
        samples: &Range<u32>,
    ) -> Result<Vec<DevicePath>, DeviceError> {
        let device = self.device();
        device.check()?;
        let count = pixels.len() * samples.len();
        let mut answers = vec![DevicePath::default(); count];
        if count == 0 {
            return Ok(answers);
        }
        let mut kept = self.columns.lock().unwrap_or_else(PoisonError::into_inner);
        let columns = match kept.take().filter(|columns| columns.fit(pixels.len(), count)) {
            Some(columns) => columns,
            None => Columns::new(device, pixels.len(), count)?,
        };
        self.follow_all(&columns, self.begin(&columns, pixels, samples))?;
        let bytes = size_of_val(&*answers) as u64;
        device.copy(&columns.paths, &columns.paths_to_read, bytes);
        device.read(&columns.paths_to_read, bytes, |view| {
            bytemuck::cast_slice_mut(&mut answers).copy_from_slice(view);
        })?;
        // Not after a fault: what is left of such buffers is unknown.
        *kept = Some(columns);
        Ok(answers)
    }

    /// Writes the pixels of a batch; returns its numbers.
    fn begin(&self, columns: &Columns, pixels: &[(u32, u32)], samples: &Range<u32>) -> Params {
        let words: Vec<u32> = pixels.iter().map(|&(x, y)| x | y << 16).collect();
        self.device().write(&columns.pixels, bytemuck::cast_slice(&words));
        Params {
            first_sample: samples.start,
            samples: samples.len() as u32,
            ..self.tree.params(pixels.len() * samples.len())
        }
    }

    /// Writes the numbers of a batch.
    fn set_params(&self, columns: &Columns, params: &Params) {
        self.device().write(&columns.params, bytemuck::bytes_of(params));
    }

    /// Runs a stage of all paths of a batch.
    fn stage(&self, kernel: Kernel, columns: &Columns, count: usize) -> Result<(), DeviceError> {
        let Columns { params, pixels, rays, found, sequences, lights, paths, alive, .. } = columns;
        let Self { numbers, sobol, offsets, albedos, .. } = self;
        let mut buffers = vec![params];
        let spheres = self.tree.spheres();
        match kernel {
            Kernel::Hits { .. } => {
                buffers.push(self.tree.nodes());
                buffers.extend(spheres);
                buffers.extend([rays, found]);
            }
            Kernel::Generate => {
                buffers.extend([numbers, pixels, sobol, offsets, rays, sequences, lights, paths]);
            }
            Kernel::Occlusion | Kernel::Path => {
                buffers.push(numbers);
                buffers.extend(spheres);
                buffers.extend([albedos, sobol, sequences, found, rays, lights, paths]);
                buffers.extend((kernel == Kernel::Path).then_some(alive));
            }
            Kernel::Shadows => buffers.extend([rays, lights, found, paths]),
            // No stage of paths.
            Kernel::Doubles => {}
        }
        self.device().run(kernel, &buffers, count)
    }

    /// Runs the stages of all paths of a batch.
    fn follow_all(&self, columns: &Columns, params: Params) -> Result<(), DeviceError> {
        const FIRST_HITS: Kernel = Kernel::Hits { any: false, counts: false };
        const ANY_HITS: Kernel = Kernel::Hits { any: true, counts: false };
        let device = self.device();
        let stage = |kernel| self.stage(kernel, columns, params.count as usize);
        self.set_params(columns, &params);
        stage(Kernel::Generate)?;
        if let DeviceIntegration::Occlusion { .. } = self.integration {
            stage(FIRST_HITS)?;
            stage(Kernel::Occlusion)?;
            stage(ANY_HITS)?;
            return stage(Kernel::Shadows);
        }
        for bounce in 0.. {
            self.set_params(columns, &Params { bounce, ..params });
            device.write(&columns.alive, &0_u32.to_ne_bytes());
            stage(FIRST_HITS)?;
            stage(Kernel::Path)?;
            let mut left = 0_u32;
            let bytes = size_of_val(&left) as u64;
            device.copy(&columns.alive, &columns.alive_to_read, bytes);
            device.read(&columns.alive_to_read, bytes, |view| {
                left = bytemuck::pod_read_unaligned(view);
            })?;
            if left == 0 {
                break;
            }
        }
        Ok(())
    }
}

impl DevicePaths for JobPaths {
    fn follow(&self, pixels: &[(u32, u32)], samples: Range<u32>) -> Option<Vec<DevicePath>> {
        let paths = self.run(pixels, &samples).map_err(|error| self.device().fail(error)).ok()?;
        let unknown = paths.iter().filter(|path| path.radiance().is_none()).count();
        self.tree.count_paths(Answered {
            rays: paths.iter().map(|path| 1 + path.rays()).sum(),
            paths: paths.len() as u64,
            unknown_paths: unknown as u64,
            ..Answered::default()
        });
        Some(paths)
    }
}

impl Columns {
    /// Returns whether so many pixels and paths fit.
    fn fit(&self, pixels: usize, paths: usize) -> bool {
        self.capacity[0] >= pixels && self.capacity[1] >= paths
    }

    fn new(device: &Device, pixels: usize, paths: usize) -> Result<Self, DeviceError> {
        let buffer = |what, words: usize, usage| {
            device.buffer(what, (size_of::<u32>() * words) as u64, usage)
        };
        let column = |what, words| buffer(what, words * paths, Usage::STORAGE | Usage::COPY_SRC);
        let read = Usage::MAP_READ | Usage::COPY_DST;
        Ok(Self {
            capacity: [pixels, paths],
            params: device.buffer(
                "numbers",
                size_of::<Params>() as u64,
                Usage::UNIFORM | Usage::COPY_DST,
            )?,
            pixels: buffer("pixels", pixels, Usage::STORAGE | Usage::COPY_DST)?,
            rays: column("rays", 12)?,
            found: column("answers", 1)?,
            sequences: column("samples", 2)?,
            lights: column("light", 4)?,
            paths: column("paths", 4)?,
            paths_to_read: buffer("paths to read", 4 * paths, read)?,
            alive: buffer("count", 1, Usage::STORAGE | Usage::COPY_SRC | Usage::COPY_DST)?,
            alive_to_read: buffer("count to read", 1, read)?,
        })
    }
}

/// Returns the numbers of a job.
fn numbers(job: &DeviceJob) -> JobNumbers {
    let (camera, sky, ground) = (&job.camera, &job.sky, &job.world.ground);
    let (slope, toward) = sky.gradient.unwrap_or_default();
    let (mut distance, mut depth, mut threshold, mut survival) = (f64::from(FAR), 0, 1.0, 1.0);
    let mut flags = 0;
    match job.integration {
        DeviceIntegration::Occlusion { distance: limit } => distance = distance.min(limit),
        DeviceIntegration::Diffuse { depth: most, roulette } => {
            depth = most;
            match roulette {
                DeviceRoulette::None => {}
                DeviceRoulette::ByThroughput(least) => {
                    flags |= flag::ROULETTE_BY_THROUGHPUT;
                    threshold = least;
                }
                DeviceRoulette::Fixed(p) => {
                    flags |= flag::ROULETTE_FIXED;
                    survival = p;
                }
            }
        }
    }
    for (is, bit) in [
        (camera.orthographic, flag::ORTHOGRAPHIC),
        (camera.lens_radius > 0.0, flag::LENS),
        (ground.is_some(), flag::HAS_GROUND),
        (job.offsets.is_some(), flag::FILTER_TABLE),
        (sky.background.is_some(), flag::BACKGROUND),
        (sky.gradient.is_some(), flag::GRADIENT),
        (sky.illuminates, flag::ILLUMINATES),
    ] {
        flags |= if is { bit } else { 0 };
    }
    JobNumbers {
        frame: camera.frame.map(|axis| axis.to_array()),
        size: camera.size,
        lens_radius: camera.lens_radius,
        focus: camera.focus,
        near: camera.near,
        ground_normal: ground.map(|ground| ground.normal.to_array()).unwrap_or_default(),
        ground_height: ground.map(|ground| ground.height).unwrap_or_default(),
        distance,
        seed: [job.seed as u32, (job.seed >> 32) as u32],
        flags,
        depth,
        ground_albedo: job.ground_albedo().unwrap_or_default().to_array(),
        middle: sky.middle.to_array(),
        slope: slope.to_array(),
        toward: toward.to_array(),
        background: sky.background.unwrap_or_default().to_array(),
        threshold,
        survival,
        unused: 0.0,
    }
}
