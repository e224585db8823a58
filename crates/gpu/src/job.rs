//! The numbers of a job, as kernels get them.

use crate::materials;
use crate::tree::FAR;
use bytemuck::{Pod, Zeroable};
use spherule_render::world::{DeviceIntegration, DeviceJob, DeviceRoulette};

/// The numbers of a job, as `job.wgsl` has them.
#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
pub(crate) struct JobNumbers {
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
    ground_material: u32,
    middle: [f32; 3],
    slope: [f32; 3],
    toward: [f32; 3],
    background: [f32; 3],
    threshold: f32,
    survival: f32,
    sun: SunNumbers,
}

/// The numbers of a sun.
#[repr(C)]
#[derive(Clone, Copy, Default, Pod, Zeroable)]
struct SunNumbers {
    tangent: [f32; 3],
    bitangent: [f32; 3],
    direction: [f32; 3],
    disc: [f32; 2],
    radiance: [f32; 3],
    weight: [f32; 3],
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
    pub(super) const SUN: u32 = 512;
    pub(super) const SUN_DISC: u32 = 1024;
    pub(super) const MIRRORED_LIGHT: u32 = 2048;
}

/// What integrators have in different ways.
struct IntegrationNumbers {
    flags: u32,
    distance: f64,
    depth: u32,
    threshold: f32,
    survival: f32,
    sun: SunNumbers,
}

impl JobNumbers {
    /// Returns the numbers of a job.
    pub(crate) fn of(job: &DeviceJob) -> Self {
        let (camera, sky, ground) = (&job.camera, &job.sky, &job.world.ground);
        let (slope, toward) = sky.gradient.unwrap_or_default();
        let own = IntegrationNumbers::of(job.integration);
        let flags = [
            (camera.orthographic, flag::ORTHOGRAPHIC),
            (camera.lens_radius > 0.0, flag::LENS),
            (ground.is_some(), flag::HAS_GROUND),
            (job.offsets.is_some(), flag::FILTER_TABLE),
            (sky.background.is_some(), flag::BACKGROUND),
            (sky.gradient.is_some(), flag::GRADIENT),
            (sky.illuminates, flag::ILLUMINATES),
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
            seed: [job.seed as u32, (job.seed >> 32) as u32],
            flags: flags
                .iter()
                .fold(own.flags, |flags, &(is, bit)| flags | if is { bit } else { 0 }),
            depth: own.depth,
            ground_material: ground.map(|ground| material(ground.material)).unwrap_or_default(),
            middle: sky.middle.to_array(),
            slope: slope.to_array(),
            toward: toward.to_array(),
            background: sky.background.unwrap_or_default().to_array(),
            threshold: own.threshold,
            survival: own.survival,
            sun: own.sun,
        }
    }
}

impl IntegrationNumbers {
    fn of(integration: DeviceIntegration) -> Self {
        let far = f64::from(FAR);
        let mut numbers = Self {
            flags: 0,
            distance: far,
            depth: 0,
            threshold: 1.0,
            survival: 1.0,
            sun: SunNumbers::default(),
        };
        let (depth, roulette, sun, mirrored_light) = match integration {
            DeviceIntegration::Occlusion { distance } => {
                return Self { distance: far.min(distance), ..numbers };
            }
            DeviceIntegration::Paths { depth, roulette, sun, mirrored_light } => {
                (depth, roulette, sun, mirrored_light)
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
        if let Some(sun) = sun {
            let disc = if sun.disc.is_some() { flag::SUN_DISC } else { 0 };
            let mirrored = if mirrored_light { flag::MIRRORED_LIGHT } else { 0 };
            numbers.flags |= flag::SUN | disc | mirrored;
            numbers.sun = SunNumbers {
                tangent: sun.basis.tangent.to_array(),
                bitangent: sun.basis.bitangent.to_array(),
                direction: sun.basis.normal.to_array(),
                disc: sun.disc.unwrap_or_default(),
                radiance: sun.radiance.to_array(),
                weight: sun.weight.to_array(),
            };
        }
        numbers
    }
}
