//! Jobs as devices get them: see [`DeviceIntegrator`](crate::world::DeviceIntegrator).

use super::Job;
use super::elisions::Elisions;
use super::roulette::roulette_threshold;
use super::whitted;
use crate::scene::{Integrator, Rgb, Roulette, SamplerKind};
use crate::world::{
    DeviceCaustics, DeviceIntegration, DeviceJob, DeviceLights, DeviceRoulette, DeviceSky, Picture,
    Radiance, World,
};
use std::borrow::Cow;

/// Most shadow samples of a surface in Whitted ray tracing.
const MAX_SHADOW_SAMPLES: usize = 1024;

/// Most suns that are sampled where smooth surfaces mirror them: each has shadow rays of its own.
const MAX_MIRRORED_SUNS: usize = 4;

/// Returns the numbers of a job, or what it has that devices do not do.
///
/// # Errors
/// A reason why devices do not follow paths.
pub fn device_job<'a>(job: &'a Job) -> Result<DeviceJob<'a>, Cow<'static, str>> {
    let world = job.world;
    let roulette = match job.settings.roulette {
        Roulette::None => DeviceRoulette::None,
        Roulette::Throughput => DeviceRoulette::ByThroughput(roulette_threshold(world)),
        Roulette::Fixed(p) => DeviceRoulette::Fixed(p as f32),
    };
    let depth = job.depth();
    let integration = match job.settings.integrator {
        Integrator::Ao { distance } => DeviceIntegration::Occlusion { distance },
        Integrator::Whitted { shadow_samples } => {
            let sky = whitted::samples_sky(world);
            let lights = world.lights.len() + usize::from(sky);
            if lights.saturating_mul(shadow_samples as usize) > MAX_SHADOW_SAMPLES {
                return Err("each surface has many shadow samples".into());
            }
            DeviceIntegration::Whitted { depth, roulette, shadow_samples, sky }
        }
        Integrator::Path => {
            let mirrored_light = job.samples_mirrored_light();
            DeviceIntegration::Paths { depth, roulette, mirrored_light }
        }
    };
    if let Some(reason) = unsupported(job) {
        return Err(reason);
    }
    if job.settings.sampler != SamplerKind::Sobol {
        return Err("devices have Sobol points only".into());
    }
    if job.elisions != Elisions::ALL {
        return Err("no work is to be skipped".into());
    }
    let lights = match integration {
        DeviceIntegration::Occlusion { .. } => DeviceLights::default(),
        _ => world.lights.for_devices(),
    };
    let paths = job.settings.integrator == Integrator::Path;
    let caustics = if paths && job.settings.caustics {
        world.caustic_casters.for_devices()
    } else {
        DeviceCaustics::default()
    };
    Ok(DeviceJob {
        world,
        integration,
        lights,
        caustics,
        camera: world.camera.terms(),
        sky: sky(world),
        picture: world.environment.picture().map(Picture::for_devices),
        seed: job.sampler.hashed_seed(),
        sobol: job.sampler.table(),
        offsets: job.filter.offsets(),
    })
}

/// Returns what a job has that devices do not do.
fn unsupported(job: &Job) -> Option<Cow<'static, str>> {
    let world = job.world;
    if world.is_sliced() {
        return Some("the scene has slices".into());
    }
    if let Some(kind) = world.trees().other_kinds().next() {
        return Some(format!("the scene has {}s", kind.name()).into());
    }
    if world.features.translucent {
        return Some("the scene has translucent bodies".into());
    }
    if let Integrator::Ao { distance } = job.settings.integrator {
        return (distance == 0.0).then(|| "nothing occludes".into());
    }
    if job.samples_mirrored_light() && world.lights.suns.len() > MAX_MIRRORED_SUNS {
        return Some("many suns are mirrored".into());
    }
    let paths = job.settings.integrator == Integrator::Path;
    if paths && job.settings.caustics && world.caustic_casters.is_deep() {
        return Some("the tree of specular spheres is deep".into());
    }
    None
}

/// Returns the sky; a picture counts as black.
fn sky(world: &World) -> DeviceSky {
    let environment = &world.environment;
    let (middle, gradient) = match &environment.radiance {
        Radiance::Constant(color) => (*color, None),
        Radiance::Gradient { middle, slope, up } => (*middle, Some((*slope, *up))),
        Radiance::Picture(_) => (Rgb::ZERO, None),
    };
    let (background, illuminates) = (environment.background, environment.illuminates);
    DeviceSky { middle, gradient, background, illuminates }
}
