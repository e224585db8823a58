//! Paths that a device follows from the camera to their ends, with the processor's numbers.

use crate::columns::{BOUNCES, Columns, Needs};
use crate::device::{Device, Size, Work};
use crate::error::DeviceError;
use crate::film;
use crate::job::{self, JobUniforms};
use crate::lights;
use crate::materials;
use crate::sky;
use crate::stages::{Kernel, WhittedStep};
use crate::tree::{Answered, DeviceTree, Params};
use bytemuck::Pod;
use spherule_render::World;
use spherule_render::shade::MaterialKind;
use spherule_render::world::{
    DeviceIntegration, DeviceIntegrator, DeviceJob, DeviceLightChoice, DevicePaths, DevicePixels,
};
use std::ops::Range;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};
use wgpu::BufferUsages as Usage;

/// Shadow rays of a path that are traced at once in Whitted ray tracing.
const SHADOWS_AT_ONCE: usize = 8;

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
    needs: Needs,
    /// Kinds of materials that paths are queued by.
    kinds: Vec<MaterialKind>,
    /// Shadow samples of a surface in Whitted ray tracing.
    all_shadows: usize,
    numbers: wgpu::Buffer,
    lights: wgpu::Buffer,
    sky: wgpu::Buffer,
    sobol: wgpu::Buffer,
    offsets: wgpu::Buffer,
    /// Columns of paths that no batch uses now.
    columns: Mutex<Vec<Columns>>,
    /// Success once all kernels are compiled, or the reason why one is not.
    compiled: OnceLock<Result<(), DeviceError>>,
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
    /// Positions in the Sobol sequences, their keys, and numbers of samples.
    pub sequences: Vec<[u32; 4]>,
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
        let device = paths.device();
        let count = pixels.len() * samples.len();
        let columns = Columns::new(device, [pixels.len(), count], paths.needs)?;
        paths.begin(&columns, pixels, samples);
        let stage = |stage| {
            let mut work = device.work();
            paths.stage(&mut work, stage, &columns, 0)?;
            work.submit();
            Ok(())
        };
        let mut work = device.work();
        columns.set_bounce(&mut work, 0);
        work.submit();
        stage(Stage::Generate(count))?;
        let camera_rays = read_column(device, &columns.rays, count)?;
        let sequences = read_column(device, &columns.sequences, count)?;
        stage(Stage::FirstHits)?;
        let found = read_column(device, &columns.found, count)?;
        stage(match job.integration {
            DeviceIntegration::Occlusion { .. } => Stage::Occlusion,
            _ => Stage::Surfaces,
        })?;
        for &kind in &paths.kinds {
            stage(Stage::Path(kind))?;
        }
        let next_rays = read_column(device, &columns.rays, count)?;
        Ok(FirstStages { camera_rays, sequences, found, next_rays })
    }
}

/// Returns the first rows of a column.
fn read_column<T: Pod>(
    device: &Device,
    column: &wgpu::Buffer,
    rows: usize,
) -> Result<Vec<T>, DeviceError> {
    let mut read = vec![T::zeroed(); rows];
    let bytes = (size_of::<T>() * rows) as u64;
    let copy = device.buffer("rows to read", bytes, Usage::MAP_READ | Usage::COPY_DST)?;
    device.read_rows(column, &copy, bytemuck::cast_slice_mut(&mut read))?;
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
        let (lights, light_numbers) = lights::rows(job);
        Ok(Self {
            tree: Arc::clone(&integrator.tree),
            appearance: integrator.appearance.clone(),
            materials: integrator.materials.clone(),
            integration: job.integration,
            kinds: kinds(job),
            all_shadows: job::shadow_samples(job),
            needs: Needs {
                shadows: shadow_rays(job),
                nested_glass: job.world.features.nested_glass,
                caustics: job.caustics.sampled,
            },
            numbers: filled("job", bytemuck::bytes_of(&JobUniforms::of(job, light_numbers)))?,
            lights: filled("lights", bytemuck::cast_slice(&lights))?,
            sky: filled(
                "picture of the sky",
                bytemuck::cast_slice(&sky::rows(job.picture.as_ref())),
            )?,
            sobol: filled("direction vectors", bytemuck::cast_slice(&job.sobol))?,
            offsets: filled("filter", bytemuck::cast_slice(job.offsets.unwrap_or_default()))?,
            columns: Mutex::default(),
            compiled: OnceLock::new(),
        })
    }

    fn device(&self) -> &Device {
        self.tree.device()
    }

    /// Follows the paths of samples of pixels, and adds up the samples of each pixel.
    fn run(
        &self,
        pixels: &[(u32, u32)],
        samples: &Range<u32>,
        found: &mut DevicePixels,
    ) -> Result<(), DeviceError> {
        let device = self.device();
        device.check()?;
        let count = pixels.len() * samples.len();
        if count == 0 {
            *found = DevicePixels::default();
            return Ok(());
        }
        self.compiled.get_or_init(|| self.compile()).clone()?;
        let kept = || self.columns.lock().unwrap_or_else(PoisonError::into_inner);
        let last = kept().pop();
        let columns = match last.filter(|columns| columns.fit(pixels.len(), count)) {
            Some(columns) => columns,
            None => Columns::new(device, [pixels.len(), count], self.needs)?,
        };
        let params = self.begin(&columns, pixels, samples);
        self.follow_all(&columns, params)?;
        film::add_up(device, &columns, [pixels.len(), samples.len()], found)?;
        // Not after a fault: what is left of such buffers is unknown.
        kept().push(columns);
        Ok(())
    }

    /// Compiles all kernels of the job, side by side.
    fn compile(&self) -> Result<(), DeviceError> {
        let kernels = self.kernels();
        std::thread::scope(|scope| {
            let compile = |kernel| scope.spawn(move || self.device().compiled(kernel).map(drop));
            let all: Vec<_> = kernels.into_iter().map(compile).collect();
            all.into_iter().try_for_each(|kernel| match kernel.join() {
                Ok(compiled) => compiled,
                Err(panicked) => std::panic::resume_unwind(panicked),
            })
        })
    }

    /// Returns the kernels of all stages of the job.
    fn kernels(&self) -> Vec<Kernel> {
        let shadows = [Stage::ShadowHits, Stage::Shadows];
        let has_shadows = self.needs.shadows > 0 || self.needs.caustics;
        let mut stages = vec![Stage::Generate(0), Stage::FirstHits];
        match self.integration {
            DeviceIntegration::Occlusion { .. } => {
                stages.push(Stage::Occlusion);
                stages.extend(shadows);
            }
            DeviceIntegration::Paths { .. } => {
                stages.push(Stage::Surfaces);
                stages.extend(self.kinds.iter().map(|&kind| Stage::Path(kind)));
                stages.extend(shadows.iter().filter(|_| has_shadows));
            }
            DeviceIntegration::Whitted { .. } => {
                let steps = [WhittedStep::Light, WhittedStep::Shadows, WhittedStep::Bounce];
                stages.extend(steps.map(Stage::Whitted));
                stages.extend(shadows);
            }
        }
        if self.needs.caustics {
            stages.extend([Stage::Caustics, Stage::SecondSegments]);
        }
        let kernels = stages.into_iter().flat_map(|stage| {
            let kernel = self.kernel(stage);
            std::iter::once(kernel).chain(self.tree.hits_again(kernel))
        });
        kernels.chain([Kernel::Film]).collect()
    }

    /// Returns the kernel of a stage.
    fn kernel(&self, stage: Stage) -> Kernel {
        let caustics = self.needs.caustics;
        match stage {
            Stage::Generate(_) => Kernel::Generate,
            Stage::FirstHits => self.tree.queued_hits(false),
            Stage::Occlusion => Kernel::Occlusion,
            Stage::Surfaces => Kernel::Surfaces { caustics },
            Stage::Path(kind) => Kernel::Path { caustics, kind },
            Stage::Whitted(step) => Kernel::Whitted(step),
            Stage::ShadowHits => self.tree.queued_hits(true),
            Stage::Caustics => Kernel::Caustics,
            Stage::SecondSegments => Kernel::SecondSegments,
            Stage::Shadows => Kernel::Shadows,
        }
    }

    /// Writes the pixels of a batch, the queue of all its paths and the numbers of its first bounces; returns those of the
    /// first.
    fn begin(&self, columns: &Columns, pixels: &[(u32, u32)], samples: &Range<u32>) -> Params {
        let words: Vec<u32> = pixels.iter().map(|&(x, y)| x | y << 16).collect();
        self.device().write(&columns.pixels, bytemuck::cast_slice(&words));
        let count = pixels.len() * samples.len();
        self.device().write(&columns.queues[0], bytemuck::bytes_of(&Columns::head(count)));
        let params = Params {
            first_sample: samples.start,
            samples: samples.len() as u32,
            shadows: self.needs.shadows.max(1) as u32,
            caustics: self.needs.caustics.into(),
            kind_stride: columns.kind_stride() as u32,
            ..self.tree.params(count)
        };
        self.write_bounces(columns, &params);
        params
    }

    /// Writes the numbers of bounces, from that of `params` on.
    fn write_bounces(&self, columns: &Columns, params: &Params) {
        let bounces = (params.bounce..).take(BOUNCES);
        let rows: Vec<Params> = bounces.map(|bounce| Params { bounce, ..*params }).collect();
        self.device().write(&columns.bounces, bytemuck::cast_slice(&rows));
    }

    /// Adds a stage of the paths in a queue, by its place, to the work.
    fn stage(
        &self,
        work: &mut Work,
        stage: Stage,
        columns: &Columns,
        queue: usize,
    ) -> Result<(), DeviceError> {
        let Columns { params, pixels, rays, found, sequences, states, paths, queues, .. } = columns;
        let Self { numbers, sobol, offsets, lights, sky, .. } = self;
        let shadows = &columns.shadows;
        // Shadow rays are the paths' own where no others follow.
        let [shadow_rays, shadow_found] =
            if self.needs.shadows > 0 { [&shadows.rays, &shadows.found] } else { [rays, found] };
        let [queue, next] = [&queues[queue], &queues[1 - queue]];
        let mut size = Size::Queue(queue);
        let mut buffers = vec![params];
        match stage {
            Stage::Generate(count) => {
                buffers.extend([numbers, pixels, sobol, offsets, rays, sequences, states, paths]);
                buffers.push(queue);
                size = Size::Rows(count);
            }
            Stage::FirstHits => {
                buffers.push(self.tree.nodes());
                buffers.extend(self.tree.spheres());
                buffers.extend([rays, found, queue]);
            }
            Stage::Occlusion => {
                buffers.extend(self.surface_buffers(columns));
                buffers.extend([&shadows.lights, paths, queue, &shadows.queue, sky]);
            }
            Stage::Surfaces => {
                for &kind in &self.kinds {
                    columns.clear_kind(work, kind);
                }
                buffers.push(numbers);
                buffers.extend(self.tree.spheres());
                buffers.extend([&self.appearance, &self.materials, found, rays, states, paths]);
                buffers.extend([&shadows.rays, queue, &columns.kind_queues, lights]);
                buffers.extend([&columns.interiors, sky, &columns.caustics.chains]);
            }
            Stage::Path(kind) => {
                buffers.extend(self.bounce_buffers(columns, &columns.kind_queues, next));
                size = Size::QueueAt(&columns.kind_queues, columns.kind_offset(kind));
            }
            Stage::Whitted(_) => {
                buffers.extend(self.bounce_buffers(columns, queue, next));
                buffers.push(pixels);
            }
            Stage::ShadowHits => {
                buffers.push(self.tree.nodes());
                buffers.extend(self.tree.spheres());
                buffers.extend([shadow_rays, shadow_found, &shadows.queue]);
                size = Size::Queue(&shadows.queue);
            }
            Stage::Caustics => {
                buffers.extend(self.surface_buffers(columns));
                buffers.extend([states, paths, &shadows.rays, &shadows.lights]);
                buffers.extend([queue, &shadows.queue, lights]);
                buffers.extend([&columns.caustics.chains, &columns.caustics.seconds]);
            }
            Stage::SecondSegments => {
                buffers.extend([numbers, shadow_rays, shadow_found, paths, queue]);
                buffers.push(&shadows.queue);
                buffers.extend([&columns.caustics.chains, &columns.caustics.seconds]);
            }
            Stage::Shadows => {
                buffers.extend([shadow_rays, &shadows.lights, shadow_found, paths, queue]);
                buffers.extend([&columns.caustics.chains, &columns.caustics.seconds]);
            }
        }
        let kernel = self.kernel(stage);
        work.run(kernel, &buffers, size)?;
        match self.tree.hits_again(kernel) {
            Some(again) => work.run(again, &buffers, size),
            None => Ok(()),
        }
    }

    /// Returns the buffers of kernels that find surfaces, in the order in which they bind them first.
    fn surface_buffers<'a>(&'a self, columns: &'a Columns) -> Vec<&'a wgpu::Buffer> {
        let mut buffers = vec![&self.numbers];
        buffers.extend(self.tree.spheres());
        buffers.extend([&self.appearance, &self.materials, &self.sobol]);
        buffers.extend([&columns.sequences, &columns.found, &columns.rays]);
        buffers
    }

    /// Returns the buffers of kernels of bounces, in the order in which they bind them first.
    fn bounce_buffers<'a>(
        &'a self,
        columns: &'a Columns,
        queue: &'a wgpu::Buffer,
        next: &'a wgpu::Buffer,
    ) -> Vec<&'a wgpu::Buffer> {
        let shadows = &columns.shadows;
        let mut buffers = self.surface_buffers(columns);
        buffers.extend([&columns.states, &columns.paths, &shadows.rays, &shadows.lights]);
        buffers.extend([queue, next, &shadows.queue, &self.lights]);
        buffers.extend([&columns.interiors, &self.sky]);
        buffers
    }

    /// Runs the stages of all paths of a batch.
    fn follow_all(&self, columns: &Columns, mut params: Params) -> Result<(), DeviceError> {
        let device = self.device();
        let (depth, surfaces, has_shadows) = match self.integration {
            DeviceIntegration::Occlusion { .. } => (0, Stage::Occlusion, true),
            DeviceIntegration::Paths { depth, .. } => {
                (depth, Stage::Surfaces, self.needs.shadows > 0)
            }
            DeviceIntegration::Whitted { depth, .. } => {
                return self.follow_whitted(columns, params, depth);
            }
        };
        let mut queue = 0;
        loop {
            let mut work = device.work();
            if params.bounce == 0 {
                columns.set_bounce(&mut work, 0);
                self.stage(&mut work, Stage::Generate(params.count as usize), columns, queue)?;
            }
            let bounces = BOUNCES.min((depth - params.bounce) as usize + 1);
            for place in 0..bounces {
                columns.set_bounce(&mut work, place);
                columns.clear(&mut work, &columns.queues[1 - queue]);
                self.stage(&mut work, Stage::FirstHits, columns, queue)?;
                if self.needs.caustics {
                    self.stage(&mut work, Stage::Caustics, columns, queue)?;
                }
                self.stage(&mut work, surfaces, columns, queue)?;
                for &kind in &self.kinds {
                    self.stage(&mut work, Stage::Path(kind), columns, queue)?;
                }
                if has_shadows {
                    self.stage(&mut work, Stage::ShadowHits, columns, queue)?;
                    if self.needs.caustics {
                        columns.clear(&mut work, &columns.shadows.queue);
                        self.stage(&mut work, Stage::SecondSegments, columns, queue)?;
                        self.stage(&mut work, Stage::ShadowHits, columns, queue)?;
                    }
                    self.stage(&mut work, Stage::Shadows, columns, queue)?;
                }
                queue = 1 - queue;
            }
            let bytes = columns.head_to_read.size();
            work.copy(&columns.queues[queue], 0, &columns.head_to_read, bytes);
            let submitted = work.submit();
            if depth - params.bounce < BOUNCES as u32 {
                return Ok(());
            }
            params.bounce += BOUNCES as u32;
            let mut head = Columns::head(0);
            device.read(&columns.head_to_read, bytes, submitted, |view| {
                head = bytemuck::pod_read_unaligned(view);
            })?;
            if head == Columns::head(0) {
                return Ok(());
            }
            self.write_bounces(columns, &params);
        }
    }

    /// Runs the stages of Whitted ray tracing, in which each surface has many shadow samples.
    fn follow_whitted(
        &self,
        columns: &Columns,
        mut params: Params,
        depth: u32,
    ) -> Result<(), DeviceError> {
        let device = self.device();
        let set = |params: &Params| device.write(&columns.params, bytemuck::bytes_of(params));
        for bounce in 0..=depth {
            let queue = (bounce % 2) as usize;
            params.bounce = bounce;
            set(&params);
            let mut work = device.work();
            if bounce == 0 {
                self.stage(&mut work, Stage::Generate(params.count as usize), columns, queue)?;
            }
            self.stage(&mut work, Stage::FirstHits, columns, queue)?;
            self.stage(&mut work, Stage::Whitted(WhittedStep::Light), columns, queue)?;
            work.submit();
            if bounce == depth {
                break;
            }
            for first in (0..self.all_shadows).step_by(self.needs.shadows.max(1)) {
                params.first_shadow = first as u32;
                set(&params);
                let mut work = device.work();
                columns.clear(&mut work, &columns.shadows.queue);
                self.stage(&mut work, Stage::Whitted(WhittedStep::Shadows), columns, queue)?;
                self.stage(&mut work, Stage::ShadowHits, columns, queue)?;
                self.stage(&mut work, Stage::Shadows, columns, queue)?;
                work.submit();
            }
            let mut work = device.work();
            columns.clear(&mut work, &columns.queues[1 - queue]);
            self.stage(&mut work, Stage::Whitted(WhittedStep::Bounce), columns, queue)?;
            let bytes = columns.head_to_read.size();
            work.copy(&columns.queues[1 - queue], 0, &columns.head_to_read, bytes);
            let submitted = work.submit();
            let mut head = Columns::head(0);
            device.read(&columns.head_to_read, bytes, submitted, |view| {
                head = bytemuck::pod_read_unaligned(view);
            })?;
            if head == Columns::head(0) {
                break;
            }
        }
        Ok(())
    }
}

/// Returns the shadow rays of a path at each bounce: a light sample, and suns and an emissive sphere that are mirrored.
fn shadow_rays(job: &DeviceJob) -> usize {
    match job.integration {
        DeviceIntegration::Paths { mirrored_light: true, .. } => {
            1 + job.lights.suns.len() + job.lights.emitters.len().min(1)
        }
        DeviceIntegration::Paths { .. } if job.lights.choice == DeviceLightChoice::None => 0,
        DeviceIntegration::Paths { .. } => 1,
        DeviceIntegration::Whitted { .. } => job::shadow_samples(job).min(SHADOWS_AT_ONCE),
        DeviceIntegration::Occlusion { .. } => 0,
    }
}

/// Returns the kinds of materials that paths are queued by: emissive surfaces are diffuse beside.
fn kinds(job: &DeviceJob) -> Vec<MaterialKind> {
    if !matches!(job.integration, DeviceIntegration::Paths { .. }) {
        return Vec::new();
    }
    let features = &job.world.features;
    let emissive = features.has(MaterialKind::Emitter);
    let has = |kind| features.has(kind) || (kind == MaterialKind::Lambertian && emissive);
    let kinds = MaterialKind::ALL.into_iter().filter(|&kind| kind != MaterialKind::Emitter);
    kinds.filter(|&kind| has(kind)).collect()
}

/// A stage of all paths of a batch.
#[derive(Clone, Copy, Debug)]
enum Stage {
    /// Camera rays of so many paths.
    Generate(usize),
    /// First hits of the paths' rays.
    FirstHits,
    /// Surfaces and shadow rays of ambient occlusion.
    Occlusion,
    /// Surfaces of paths, and the light that they reach.
    Surfaces,
    /// Light and next rays at surfaces of a kind of material.
    Path(MaterialKind),
    /// A step of Whitted ray tracing.
    Whitted(WhittedStep),
    /// Whether shadow rays hit anything.
    ShadowHits,
    /// Caustic samples.
    Caustics,
    /// Second segments of caustic samples.
    SecondSegments,
    /// Light of shadow rays.
    Shadows,
}

impl DevicePaths for JobPaths {
    fn follow(&self, pixels: &[(u32, u32)], samples: Range<u32>, found: &mut DevicePixels) -> bool {
        let followed = self.run(pixels, &samples, found).map_err(|error| self.device().fail(error));
        if followed.is_err() {
            return false;
        }
        let paths = (pixels.len() * samples.len()) as u64;
        let unknown = found.samples.iter().filter(|path| path.radiance().is_none()).count();
        let rays: u64 = found.pixels.iter().map(|p| p.bounce_rays() + p.shadow_rays()).sum();
        self.tree.count_paths(Answered {
            rays: paths + rays,
            paths,
            unknown_paths: unknown as u64,
            ..Answered::default()
        });
        true
    }
}
