//! Paths that a device follows from the camera to their ends, with the processor's numbers.

use crate::columns::Columns;
use crate::device::Device;
use crate::error::DeviceError;
use crate::job::JobNumbers;
use crate::materials;
use crate::stages::Kernel;
use crate::tree::{Answered, DeviceTree, Params};
use bytemuck::Pod;
use spherule_render::World;
use spherule_render::world::{
    DeviceIntegration, DeviceIntegrator, DeviceJob, DevicePath, DevicePaths,
};
use std::ops::Range;
use std::sync::{Arc, Mutex, PoisonError};
use wgpu::BufferUsages as Usage;

/// Follows the paths of renders of one world, whose tree is on the device.
#[derive(Debug)]
pub struct Integrator {
    tree: Arc<DeviceTree>,
    /// Colors and materials of spheres, on the device.
    appearance: wgpu::Buffer,
    materials: wgpu::Buffer,
}

/// A job on a device.
struct JobPaths {
    tree: Arc<DeviceTree>,
    appearance: wgpu::Buffer,
    materials: wgpu::Buffer,
    integration: DeviceIntegration,
    numbers: wgpu::Buffer,
    sobol: wgpu::Buffer,
    offsets: wgpu::Buffer,
    /// Columns of paths, of the size of the last batch or larger.
    columns: Mutex<Option<Columns>>,
}

impl Integrator {
    /// Copies the materials of a world's spheres to the device that has its tree.
    ///
    /// # Errors
    /// Why the device can follow no paths: its arithmetic is not the processor's, colors do not fit, or it fails. The
    /// reason completes "the processor shades, for".
    pub fn new(tree: &Arc<DeviceTree>, world: &World) -> Result<Self, String> {
        let device = tree.device();
        if let Some(reason) = device.lacks_for_paths() {
            return Err(reason);
        }
        if !tree.is_single() {
            return Err("single precision does not hold the spheres".to_owned());
        }
        let filled = |what, rows: &[[u32; 4]]| {
            device.filled(what, bytemuck::cast_slice(rows)).map_err(|error| error.to_string())
        };
        let appearance = filled("colors", &materials::appearance(world))?;
        let materials = filled("materials", &materials::rows(&world.materials))?;
        Ok(Self { tree: Arc::clone(tree), appearance, materials })
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
        let columns = Columns::new(paths.device(), [pixels.len(), count], paths.shadows())?;
        paths.set_params(&columns, &paths.begin(&columns, pixels, samples));
        let stage = |kernel| paths.stage(kernel, &columns, count);
        stage(Kernel::Generate)?;
        let camera_rays = read_column(paths.device(), &columns.rays, count)?;
        let sequences = read_column(paths.device(), &columns.sequences, count)?;
        stage(self.tree.hits(false, false))?;
        let found = read_column(paths.device(), &columns.found, count)?;
        stage(match job.integration {
            DeviceIntegration::Occlusion { .. } => Kernel::Occlusion,
            DeviceIntegration::Paths { .. } => Kernel::Path,
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
            appearance: integrator.appearance.clone(),
            materials: integrator.materials.clone(),
            integration: job.integration,
            numbers: filled("job", bytemuck::bytes_of(&JobNumbers::of(job)))?,
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
            None => Columns::new(device, [pixels.len(), count], self.shadows())?,
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
            shadows: self.shadows().max(1) as u32,
            ..self.tree.params(pixels.len() * samples.len())
        }
    }

    /// Returns the shadow rays of a path at each bounce; 0 if there are none beside the path's own rays.
    fn shadows(&self) -> usize {
        match self.integration {
            DeviceIntegration::Paths { sun: Some(_), mirrored_light, .. } => {
                1 + usize::from(mirrored_light)
            }
            DeviceIntegration::Paths { .. } | DeviceIntegration::Occlusion { .. } => 0,
        }
    }

    /// Writes the numbers of a batch.
    fn set_params(&self, columns: &Columns, params: &Params) {
        self.device().write(&columns.params, bytemuck::bytes_of(params));
        let count = params.count * params.shadows;
        self.device()
            .write(&columns.shadows.params, bytemuck::bytes_of(&Params { count, ..*params }));
    }

    /// Runs a stage of all paths of a batch.
    fn stage(&self, kernel: Kernel, columns: &Columns, count: usize) -> Result<(), DeviceError> {
        let Columns { params, pixels, rays, found, sequences, states, paths, alive, .. } = columns;
        let Self { numbers, sobol, offsets, appearance, materials, .. } = self;
        let shadows = &columns.shadows;
        // Shadow rays are the paths' own where no others follow.
        let apart = kernel.is_any() && self.shadows() > 0;
        let mut buffers = vec![if apart { &shadows.params } else { params }];
        let spheres = self.tree.spheres();
        match kernel {
            Kernel::Hits { .. } => {
                buffers.push(self.tree.nodes());
                buffers.extend(spheres);
                buffers.extend(if apart { [&shadows.rays, &shadows.found] } else { [rays, found] });
            }
            Kernel::Generate => {
                buffers.extend([numbers, pixels, sobol, offsets, rays, sequences, states, paths]);
            }
            Kernel::Occlusion | Kernel::Path => {
                buffers.push(numbers);
                buffers.extend(spheres);
                buffers.extend([appearance, materials, sobol, sequences, found, rays]);
                if kernel == Kernel::Path {
                    buffers.extend([states, paths, alive, &shadows.rays, &shadows.lights]);
                } else {
                    buffers.extend([&shadows.lights, paths]);
                }
            }
            Kernel::Shadows => {
                let [rays, found] = if self.shadows() > 0 {
                    [&shadows.rays, &shadows.found]
                } else {
                    [rays, found]
                };
                buffers.extend([rays, &shadows.lights, found, paths]);
            }
            // No stage of paths.
            Kernel::Doubles => {}
        }
        let rows = if apart { count * self.shadows() } else { count };
        self.device().run(kernel, &buffers, rows)
    }

    /// Runs the stages of all paths of a batch.
    fn follow_all(&self, columns: &Columns, params: Params) -> Result<(), DeviceError> {
        let [first_hits, any_hits] = [false, true].map(|any| self.tree.hits(any, false));
        let device = self.device();
        let stage = |kernel| self.stage(kernel, columns, params.count as usize);
        self.set_params(columns, &params);
        stage(Kernel::Generate)?;
        if let DeviceIntegration::Occlusion { .. } = self.integration {
            stage(first_hits)?;
            stage(Kernel::Occlusion)?;
            stage(any_hits)?;
            return stage(Kernel::Shadows);
        }
        for bounce in 0.. {
            self.set_params(columns, &Params { bounce, ..params });
            device.write(&columns.alive, &0_u32.to_ne_bytes());
            stage(first_hits)?;
            stage(Kernel::Path)?;
            if self.shadows() > 0 {
                stage(any_hits)?;
                stage(Kernel::Shadows)?;
            }
            if !is_counted(bounce) {
                continue;
            }
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

/// Returns whether the paths that go on after a bounce are counted, for which the device is waited for. A bounce without
/// any takes it less time.
fn is_counted(bounce: u32) -> bool {
    bounce == 0 || bounce % 4 == 3
}

impl DevicePaths for JobPaths {
    fn follow(&self, pixels: &[(u32, u32)], samples: Range<u32>) -> Option<Vec<DevicePath>> {
        let paths = self.run(pixels, &samples).map_err(|error| self.device().fail(error)).ok()?;
        let unknown = paths.iter().filter(|path| path.radiance().is_none()).count();
        self.tree.count_paths(Answered {
            rays: paths.iter().map(|path| 1 + path.bounce_rays() + path.shadow_rays()).sum(),
            paths: paths.len() as u64,
            unknown_paths: unknown as u64,
            ..Answered::default()
        });
        Some(paths)
    }
}
