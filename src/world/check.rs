//! Checks what only code can get wrong: a scene from a file has passed all this when it was read, with line and column.

use super::fit::{self, Placement};
use super::{Frame, WorldError, spheres};
use crate::image::Image;
use crate::memory;
use crate::scene::{
    BRIGHTEST, Camera, ConductorFresnel, Environment, EnvironmentMap, Ground, Integrator, Light,
    Material, NamedMaterial, Pose, Projection, Rgb, Roulette, Scene, Settings, Slice, is_radiance,
};
use glam::DVec3;

/// How far a unit vector's squared length may be from 1.
const UNIT: f64 = 1e-6;

/// What does not ask how many spheres there are.
pub(super) fn check_view(scene: &Scene) -> Result<(), WorldError> {
    settings(&scene.settings)?;
    camera(&scene.camera)
}

pub(super) fn check(scene: &Scene) -> Result<(), WorldError> {
    check_view(scene)?;
    scene.materials.iter().try_for_each(material)?;
    scene.lights.iter().try_for_each(light)?;
    scene.slices.iter().try_for_each(slice)?;
    environment(&scene.environment)?;
    scene.ground.as_ref().map_or(Ok(()), |plane| ground(plane, &scene.materials))?;
    let colors = scene.spheres.color.iter().all(|&color| share(color));
    demand(colors, || "a sphere's color must be 0 to 1 in each channel".to_owned())
}

fn demand(holds: bool, message: impl FnOnce() -> String) -> Result<(), WorldError> {
    if holds { Ok(()) } else { Err(WorldError::Invalid(message())) }
}

/// A number that must be in a range: NaN is in none.
fn number(holds: bool, name: &str, value: f64, range: &str) -> Result<(), WorldError> {
    demand(holds, || format!("{name} is {value}, but must be {range}"))
}

fn at_least_0(name: &str, value: f64) -> Result<(), WorldError> {
    number((0.0..f64::INFINITY).contains(&value), name, value, "finite and 0 or more")
}

fn more_than_0(name: &str, value: f64) -> Result<(), WorldError> {
    number(value > 0.0 && value < f64::INFINITY, name, value, "finite and more than 0")
}

fn unit(name: &str, vector: DVec3) -> Result<(), WorldError> {
    let holds = (vector.length_squared() - 1.0).abs() <= UNIT;
    demand(holds, || format!("{name} is {vector}, but must have length 1"))
}

fn share(color: Rgb) -> bool {
    (0..3).all(|channel| (0.0..=1.0).contains(&color[channel]))
}

fn bright(color: Rgb) -> bool {
    (0..3).all(|channel| (0.0..=BRIGHTEST).contains(&color[channel]))
}

fn radiance(name: &str, color: Rgb) -> Result<(), WorldError> {
    demand(bright(color), || format!("{name} is {color}, but must be 0 to {BRIGHTEST:e}"))
}

/// Whether settings are in the ranges that their documentation states.
pub(crate) fn settings(settings: &Settings) -> Result<(), WorldError> {
    let pixels = 1..=65_535;
    let (width, height) = (settings.width, settings.height);
    demand(pixels.contains(&width) && pixels.contains(&height), || {
        format!("a picture of {width} x {height} pixels: each must be 1 to 65535")
    })?;
    demand(settings.spp > 0, || "a pixel needs 1 sample or more".to_owned())?;
    if let Roulette::Fixed(p) = settings.roulette {
        number(p > 0.0 && p <= 1.0, "the probability of roulette", p, "more than 0, at most 1")?;
    }
    match settings.integrator {
        Integrator::Whitted { shadow_samples: 0 } => {
            Err(WorldError::Invalid("a light needs 1 shadow sample or more".to_owned()))
        }
        Integrator::Ao { distance } => {
            number(distance > 0.0, "the distance of occlusion", distance, "more than 0")
        }
        Integrator::Path | Integrator::Whitted { .. } => Ok(()),
    }
}

fn camera(camera: &Camera) -> Result<(), WorldError> {
    match camera.projection {
        Projection::Perspective { fov } => {
            number(
                fov > 0.0 && fov < 180.0,
                "the field of view",
                fov,
                "between 0 and 180 degrees",
            )?;
        }
        Projection::Orthographic { height } => {
            height.map_or(Ok(()), |height| more_than_0("the camera's height", height))?;
        }
    }
    if let Pose::Fit { margin, .. } = camera.pose {
        number(
            (0.0..1.0).contains(&margin),
            "the camera's margin",
            margin,
            "0 or more, less than 1",
        )?;
    }
    if let Some(lens) = camera.lens {
        at_least_0("the aperture", lens.aperture)?;
        lens.focus.map_or(Ok(()), |focus| more_than_0("the focus", focus))?;
    }
    let up = camera.up.is_finite() && camera.up != DVec3::ZERO;
    demand(up, || "the camera's `up` must be finite and not zero".to_owned())?;
    at_least_0("the camera's `near`", camera.near)
}

fn material(named: &NamedMaterial) -> Result<(), WorldError> {
    let sound = match &named.material {
        Material::Lambertian { color } => share(*color),
        Material::Conductor { fresnel, roughness } => {
            let positive = |x: Rgb| x.is_finite() && x.min_element() > 0.0;
            let metal = match *fresnel {
                ConductorFresnel::Schlick(color) | ConductorFresnel::Constant(color) => {
                    share(color)
                }
                ConductorFresnel::Exact { eta, k } => positive(eta) && positive(k),
            };
            metal && (0.0..=1.0).contains(roughness)
        }
        Material::Dielectric { ior, color } => *ior > 0.0 && ior.is_finite() && share(*color),
        Material::Plastic { color, ior } => *ior > 1.0 && ior.is_finite() && share(*color),
        Material::Reflective { color, diffuse, mirror } => {
            share(*color) && *diffuse >= 0.0 && *mirror >= 0.0 && diffuse + mirror <= 1.0
        }
        Material::Emitter { radiance, albedo } => bright(*radiance) && share(*albedo),
    };
    demand(sound, || format!("material \"{}\" is out of range: {:?}", named.name, named.material))
}

fn light(light: &Light) -> Result<(), WorldError> {
    match *light {
        Light::Sun { direction, irradiance, angular_radius } => {
            unit("the direction of a sun", direction)?;
            radiance("the irradiance of a sun", irradiance)?;
            let holds = (0.0..90.0).contains(&angular_radius);
            number(holds, "the angular radius of a sun", angular_radius, "0 or more, less than 90")
        }
        Light::Point { position, intensity, .. } => {
            demand(position.is_finite(), || {
                format!("a point light is at {position}, but must be somewhere finite")
            })?;
            let sound = intensity.is_finite() && intensity.min_element() >= 0.0;
            demand(sound, || {
                format!("the intensity of a point light is {intensity}, but must be 0 or more")
            })
        }
    }
}

fn slice(slice: &Slice) -> Result<(), WorldError> {
    unit("the normal of a slice", slice.normal)?;
    let distance = slice.distance;
    number(distance.is_finite(), "the distance of a slice", distance, "finite")
}

fn environment(environment: &Environment) -> Result<(), WorldError> {
    match &environment.map {
        EnvironmentMap::Constant(color) => radiance("the environment's color", *color),
        EnvironmentMap::Gradient { bottom, top, up } => {
            radiance("the environment's bottom", *bottom)?;
            radiance("the environment's top", *top)?;
            unit("the environment's `up`", *up)
        }
        EnvironmentMap::Picture { image, up, rotation, scale } => {
            picture(image, *scale)?;
            unit("the environment's `up`", *up)?;
            number(rotation.is_finite(), "the environment's rotation", *rotation, "finite")?;
            at_least_0("the environment's scale", f64::from(*scale))
        }
    }
}

fn picture(image: &Image, scale: f32) -> Result<(), WorldError> {
    let pixels = u64::from(image.width) * u64::from(image.height);
    let shape = pixels > 0 && pixels == image.pixels.len() as u64;
    let sound = |value: &f32| is_radiance(*value, scale);
    demand(shape && image.pixels.iter().flatten().all(sound), || {
        format!(
            "the environment's picture must hold width x height radiances that, times its scale, \
             are 0 to {BRIGHTEST:e}"
        )
    })
}

/// The material's row exists.
fn ground(ground: &Ground, materials: &[NamedMaterial]) -> Result<(), WorldError> {
    unit("the ground's normal", ground.normal)?;
    let height = ground.height;
    number(height.is_finite(), "the ground's height", height, "finite")?;
    let material = materials.get(ground.material as usize).map(|named| &named.material);
    let solid = !matches!(material, Some(Material::Dielectric { .. } | Material::Emitter { .. }));
    demand(solid, || "the ground can be neither glass nor an emitter; use a sphere".to_owned())
}

/// Finds where everything is, once nothing is wrong with it and so many bytes can be had.
pub(super) fn place(scene: &Scene, bytes: u64) -> Result<(Frame, Placement), WorldError> {
    memory::check(bytes).map_err(|shortage| WorldError::Memory(scene.spheres.len(), shortage))?;
    memory::check(super::Environment::bytes(&scene.environment))
        .map_err(WorldError::Environment)?;
    spheres::validate(scene)?;
    check(scene)?;
    let pose = fit::pose(scene)?;
    Ok((Frame::of(&scene.spheres, &pose), pose))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_have_length_1() {
        assert!(unit("it", DVec3::new(0.6, 0.0, -0.8)).is_ok());
        for length in [0.0, 0.999, 1.001, f64::NAN, f64::INFINITY] {
            assert!(unit("it", DVec3::Y * length).is_err(), "{length}");
        }
    }

    #[test]
    fn every_channel_of_a_color_is_checked() {
        let with = |channel: usize, value: f32| {
            let mut color = Rgb::splat(0.5);
            color[channel] = value;
            color
        };
        for channel in 0..3 {
            assert!([0.0, 1.0].iter().all(|&value| share(with(channel, value))));
            assert!([0.0, BRIGHTEST].iter().all(|&value| bright(with(channel, value))));
            for bad in [-0.1, f32::NAN, f32::INFINITY] {
                assert!(
                    !share(with(channel, bad)) && !bright(with(channel, bad)),
                    "{channel} {bad}"
                );
            }
            assert!(!share(with(channel, 1.1)), "{channel}");
        }
    }
}
