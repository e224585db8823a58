//! The numbers of a job, as kernels get them.

use crate::lights::{self, LightUniforms};
use crate::materials;
use crate::tree::FAR;
use bytemuck::{Pod, Zeroable};
use spherule_render::world::{DeviceIntegration, DeviceJob, DeviceLightChoice, DeviceRoulette};

/// The numbers of a job, as `job.wgsl` has them.
#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
pub(crate) struct JobUniforms {
    frame: [[f64; 3]; 4],
    size: [[f64; 2]; 2],
    lens_radius: f64,
    focus: f64,
    near: f64,
    ground_normal: [f64; 3],
    ground_height: f64,
    distance: f64,
    reach: f64,
    seed: [u32; 2],
    flags: u32,
    depth: u32,
    ground_material: u32,
    spheres: u32,
    middle: [f32; 3],
    slope: [f32; 3],
    toward: [f32; 3],
    background: [f32; 3],
    threshold: f32,
    survival: f32,
    lights: LightUniforms,
    shadow_samples: u32,
    all_shadows: u32,
    /// So that the size is a multiple of a double's.
    padding: u32,
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
    pub(super) const LIGHTS: u32 = 512;
    pub(super) const MIRRORED_LIGHT: u32 = 1024;
    pub(super) const LIGHT_TREE: u32 = 2048;
    pub(super) const LIGHT_TABLE: u32 = 4096;
    pub(super) const NESTED_GLASS: u32 = 8192;
    pub(super) const PICTURE: u32 = 16384;
}

/// What integrators have in different ways.
struct IntegrationUniforms {
    flags: u32,
    distance: f64,
    depth: u32,
    threshold: f32,
    survival: f32,
    shadow_samples: u32,
}

impl JobUniforms {
    /// Returns the numbers of a job with these lights.
    pub(crate) fn of(job: &DeviceJob, lights: LightUniforms) -> Self {
        let (camera, sky, ground) = (&job.camera, &job.sky, &job.world.ground);
        let (slope, toward) = sky.gradient.unwrap_or_default();
        let own = IntegrationUniforms::of(job.integration);
        let flags = [
            (camera.orthographic, flag::ORTHOGRAPHIC),
            (camera.lens_radius > 0.0, flag::LENS),
            (ground.is_some(), flag::HAS_GROUND),
            (job.offsets.is_some(), flag::FILTER_TABLE),
            (sky.background.is_some(), flag::BACKGROUND),
            (sky.gradient.is_some(), flag::GRADIENT),
            (sky.illuminates, flag::ILLUMINATES),
            (job.picture.is_some(), flag::PICTURE),
            (job.world.features.nested_glass, flag::NESTED_GLASS),
            (job.lights.choice != DeviceLightChoice::None, flag::LIGHTS),
            (matches!(job.lights.choice, DeviceLightChoice::Tree(_)), flag::LIGHT_TREE),
            (matches!(job.lights.choice, DeviceLightChoice::Table(_)), flag::LIGHT_TABLE),
        ];
        let material = |id| materials::row(&job.world.materials, id);
        Self {
            frame: camera.frame.map(|axis| axis.to_array()),
            size: camera.size,
            lens_radius: camera.lens_radius,
            focus: camera.focus,
            near: camera.near,
            ground_normal: ground.map(|ground| ground.normal.to_array()).unwrap_or_default(),
            ground_height: ground.map(|ground| ground.height).unwrap_or_default(),
            distance: own.distance,
            reach: lights::reach(&job.lights),
            seed: [job.seed as u32, (job.seed >> 32) as u32],
            flags: flags
                .iter()
                .fold(own.flags, |flags, &(is, bit)| flags | if is { bit } else { 0 }),
            depth: own.depth,
            ground_material: ground.map(|ground| material(ground.material)).unwrap_or_default(),
            spheres: job.world.spheres.len() as u32,
            middle: sky.middle.to_array(),
            slope: slope.to_array(),
            toward: toward.to_array(),
            background: sky.background.unwrap_or_default().to_array(),
            threshold: own.threshold,
            survival: own.survival,
            lights,
            shadow_samples: own.shadow_samples,
            all_shadows: shadow_samples(job) as u32,
            padding: 0,
        }
    }
}

/// Returns the number of shadow samples of a surface in Whitted ray tracing.
pub(crate) fn shadow_samples(job: &DeviceJob) -> usize {
    let DeviceIntegration::Whitted { shadow_samples, sky, .. } = job.integration else { return 0 };
    let lights = &job.lights;
    let delta = lights.points.len() + lights.suns.iter().filter(|sun| sun.disc.is_none()).count();
    let suns = lights.suns.iter().filter(|sun| sun.disc.is_some()).count();
    let extended = lights.emitters.len() + suns + lights.sky_parts + usize::from(sky);
    delta + shadow_samples as usize * extended
}

impl IntegrationUniforms {
    fn of(integration: DeviceIntegration) -> Self {
        let far = f64::from(FAR);
        let mut numbers = Self {
            flags: 0,
            distance: far,
            depth: 0,
            threshold: 1.0,
            survival: 1.0,
            shadow_samples: 0,
        };
        let (depth, roulette, mirrored_light) = match integration {
            DeviceIntegration::Occlusion { distance } => {
                return Self { distance: far.min(distance), ..numbers };
            }
            DeviceIntegration::Whitted { depth, roulette, shadow_samples, .. } => {
                numbers.shadow_samples = shadow_samples;
                (depth, roulette, false)
            }
            DeviceIntegration::Paths { depth, roulette, mirrored_light } => {
                (depth, roulette, mirrored_light)
            }
        };
        numbers.depth = depth;
        match roulette {
            DeviceRoulette::None => {}
            DeviceRoulette::ByThroughput(least) => {
                numbers.flags |= flag::ROULETTE_BY_THROUGHPUT;
                numbers.threshold = least;
            }
            DeviceRoulette::Fixed(p) => {
                numbers.flags |= flag::ROULETTE_FIXED;
                numbers.survival = p;
            }
        }
        if mirrored_light {
            numbers.flags |= flag::MIRRORED_LIGHT;
        }
        numbers
    }
}
