//! Checks of scenes that come from code; scenes from files passed the same checks when they were read,
//! with line and column.

use super::fit::{self, Placement};
use super::{Transform, WorldError, spheres};
use crate::capsules::Capsules;
use crate::image::Image;
use crate::memory;
use crate::scene::{
    self, BRIGHTEST, BodyColumns, EnvironmentMap, Ground, Material, NamedMaterial, Rgb, Scene,
    is_radiance, keys,
};

/// Checks what does not depend on the number of spheres.
pub(super) fn check_view(scene: &Scene) -> Result<(), WorldError> {
    scene.settings.check()?;
    keys::check_camera(&scene.camera).map_err(WorldError::Invalid)
}

pub(super) fn check(scene: &Scene) -> Result<(), WorldError> {
    scene.settings.check()?;
    keys::check_sections(scene).map_err(WorldError::Invalid)?;
    scene.materials.iter().try_for_each(material)?;
    if let EnvironmentMap::Picture { image, scale, .. } = &scene.environment.map {
        picture(image, *scale)?;
    }
    scene.ground.as_ref().map_or(Ok(()), |plane| ground(plane, &scene.materials))?;
    let mut hits = scene.spheres.len();
    for columns in scene.other_bodies() {
        bodies(columns, hits, &scene.materials)?;
        hits += columns.kind().hits() * columns.len();
    }
    let invalid = scene.spheres.color.iter().position(|&color| !is_fraction(color));
    invalid.map_or(Ok(()), |row| {
        let color = scene.spheres.color[row];
        let message =
            || format!("the color of sphere {row} is {color}, but must be 0 to 1 in each channel");
        require(false, message)
    })
}

fn require(holds: bool, message: impl FnOnce() -> String) -> Result<(), WorldError> {
    if holds { Ok(()) } else { Err(WorldError::Invalid(message())) }
}

fn is_fraction(color: Rgb) -> bool {
    (0..3).all(|channel| (0.0..=1.0).contains(&color[channel]))
}

/// Checks what a translucent material consists of.
fn material(NamedMaterial { name, material }: &NamedMaterial) -> Result<(), WorldError> {
    let refused = match (material, material.surface()) {
        (Material::Translucent { .. }, Material::Dielectric { .. }) => Some("glass"),
        (Material::Translucent { .. }, Material::Emitter { .. }) => Some("an emitter"),
        (_, Material::Translucent { .. }) => Some("translucent itself"),
        _ => None,
    };
    refused.map_or(Ok(()), |kind| {
        let whose = format!("the surface of the translucent material \"{name}\"");
        Err(WorldError::Invalid(format!("{whose} must not be {kind}")))
    })
}

fn picture(image: &Image, scale: f32) -> Result<(), WorldError> {
    let pixels = u64::from(image.width) * u64::from(image.height);
    let shape = pixels > 0 && pixels == image.pixels.len() as u64;
    let valid = |value: &f32| is_radiance(*value, scale);
    require(shape && image.pixels.iter().flatten().all(valid), || {
        format!(
            "the environment's picture must have width x height radiances that, times its scale, \
             are 0 to {BRIGHTEST:e}"
        )
    })
}

/// Checks the ground, whose material's row exists.
fn ground(ground: &Ground, materials: &[NamedMaterial]) -> Result<(), WorldError> {
    let material = materials.get(ground.material as usize).map(|named| &named.material);
    let solid = !matches!(
        material,
        Some(Material::Dielectric { .. } | Material::Emitter { .. } | Material::Translucent { .. })
    );
    require(solid, || "the ground cannot be glass, an emitter or translucent".to_owned())
}

/// Returns whether there is a material, neither glass nor an emitter.
fn is_solid(materials: &[NamedMaterial], row: u32) -> bool {
    materials.get(row as usize).is_some_and(|named| named.material.is_solid())
}

/// Checks columns of bodies of one kind; `hits` are those of the kinds before it.
fn bodies(
    bodies: &dyn BodyColumns,
    hits: usize,
    materials: &[NamedMaterial],
) -> Result<(), WorldError> {
    let ((column, lengths), kind) = (bodies.lengths(), bodies.kind());
    let (count, name) = (lengths[0], kind.name());
    require(lengths.iter().all(|&length| length == count), || {
        format!("the columns of the {name}s differ in length from `{column}`, {count}")
    })?;
    let left = (scene::Spheres::MAX as usize).saturating_sub(hits) / kind.hits();
    let most = Capsules::MAX.min(left);
    require(count <= most, || {
        format!("too many {name}s: {count}, but at most {most} fit; render a part of them")
    })?;
    for row in 0..count {
        bodies.fault(row).map_or(Ok(()), |fault| Err(WorldError::Invalid(fault)))?;
        let colors = bodies.colors(row);
        let invalid = colors.iter().find(|&&color| !is_fraction(color));
        invalid.map_or(Ok(()), |color| {
            let which = if colors.len() > 1 { "a" } else { "the" };
            require(false, || {
                format!(
                    "{which} color of {name} {row} is {color}, but must be 0 to 1 in each channel"
                )
            })
        })?;
        require(is_solid(materials, bodies.materials()[row]), || {
            format!("{name} {row} must have a material, which cannot be glass or an emitter")
        })?;
    }
    Ok(())
}

/// Checks the scene and that `bytes` of memory are available, and computes coordinates and camera.
pub(super) fn place(scene: &Scene, bytes: u64) -> Result<(Transform, Placement), WorldError> {
    memory::check(bytes).map_err(|shortage| WorldError::Memory(scene.spheres.len(), shortage))?;
    check_environment_memory(scene)?;
    spheres::validate(scene)?;
    check(scene)?;
    let pose = fit::pose(scene)?;
    Ok((Transform::of(scene, &pose), pose))
}

/// Checks that memory suffices for the light of the environment.
pub(super) fn check_environment_memory(scene: &Scene) -> Result<(), WorldError> {
    let bytes = super::Environment::bytes(&scene.environment);
    memory::check(bytes).map_err(WorldError::Environment)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::World;
    use crate::scene::generate::default_scene;
    use crate::scene::particles::Cell;
    use crate::scene::{
        Background, Camera, ConductorFresnel, Environment, Insets, Lens, Light, Pose, Projection,
        Slice, SliceMode,
    };
    use glam::DVec3;
    use std::sync::Arc;

    /// Values that most fields refuse.
    const BAD: [f64; 4] = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, -1e300];

    /// Checks that every bad value of a field is refused and named.
    fn refuse(name: &str, set: impl Fn(&mut Scene, f64)) {
        let mut scene = default_scene(0);
        set(&mut scene, 0.5);
        World::build(&scene).unwrap_or_else(|error| panic!("{name}: {error}"));
        for bad in BAD {
            let mut scene = default_scene(0);
            set(&mut scene, bad);
            let error = World::build(&scene).expect_err(name).to_string();
            assert!(error.contains(name), "{name} {bad}: {error}");
        }
    }

    /// Checks the same for a field that accepts negative numbers of any size.
    fn refuse_infinite(name: &str, set: impl Fn(&mut Scene, f64)) {
        for bad in &BAD[..3] {
            let mut scene = default_scene(0);
            set(&mut scene, *bad);
            let error = World::build(&scene).expect_err(name).to_string();
            assert!(error.contains(name), "{name} {bad}: {error}");
        }
    }

    fn made_of(scene: &mut Scene, material: Material) {
        scene.materials.push(NamedMaterial { name: "own".to_owned(), material });
    }

    #[test]
    fn cameras_out_of_range_are_refused() {
        let look_at = |eye, target| Pose::LookAt { eye, target };
        refuse("`fov`", |scene, fov| {
            scene.camera.projection = Projection::Perspective { fov };
        });
        refuse("`height`", |scene, height| {
            scene.camera.projection = Projection::Orthographic { height: Some(height) };
        });
        refuse("`margin`", |scene, margin| {
            scene.camera.pose = Pose::Fit { direction: DVec3::NEG_Z, margin };
        });
        refuse("`near`", |scene, near| scene.camera.near = near);
        refuse("`aperture`", |scene, aperture| {
            scene.camera.lens = Some(Lens { aperture, focus: None });
        });
        refuse("`focus`", |scene, focus| {
            scene.camera.lens = Some(Lens { aperture: 0.1, focus: Some(focus) });
        });
        // Also where the camera is placed by hand, and leaves nothing free.
        for pose in [Camera::default().pose, look_at(DVec3::Z, DVec3::ZERO)] {
            refuse("`insets`", |scene, top| {
                scene.camera.pose = pose;
                scene.camera.insets = Insets { top, ..Insets::default() };
            });
        }
        for axis in [DVec3::X, DVec3::Y, DVec3::Z] {
            let with = |value: f64| DVec3::ONE + axis.map(|on| if on > 0.0 { value } else { 0.0 });
            refuse_infinite("`eye`", |scene, value| {
                scene.camera.pose = look_at(with(value), DVec3::ZERO);
            });
            refuse_infinite("`target`", |scene, value| {
                scene.camera.pose = look_at(DVec3::ZERO, with(value));
            });
            refuse_infinite("`direction`", |scene, value| {
                scene.camera.pose = Pose::Fit { direction: with(value), margin: 0.0 };
            });
            refuse_infinite("`up`", |scene, value| scene.camera.up = with(value));
        }
    }

    #[test]
    fn materials_out_of_range_are_refused() {
        for channel in 0..3 {
            let gray = |value: f64| {
                let mut color = Rgb::splat(0.25);
                color[channel] = value as f32;
                color
            };
            refuse("`color`", |scene, value| {
                made_of(scene, Material::Lambertian { color: gray(value) });
            });
            refuse("`color`", |scene, value| {
                let fresnel = ConductorFresnel::Schlick(gray(value));
                made_of(scene, Material::Conductor { fresnel, roughness: 0.0 });
            });
            refuse("`eta`", |scene, value| {
                let fresnel = ConductorFresnel::Exact { eta: gray(value), k: Rgb::ONE };
                made_of(scene, Material::Conductor { fresnel, roughness: 0.0 });
            });
            refuse("`k`", |scene, value| {
                let fresnel = ConductorFresnel::Exact { eta: Rgb::ONE, k: gray(value) };
                made_of(scene, Material::Conductor { fresnel, roughness: 0.0 });
            });
            refuse("`color`", |scene, value| {
                made_of(scene, Material::Dielectric { ior: 1.5, color: gray(value) });
            });
            refuse("`radiance`", |scene, value| {
                let radiance = gray(value);
                made_of(scene, Material::Emitter { radiance, albedo: Rgb::ZERO });
            });
            refuse("`albedo`", |scene, value| {
                let albedo = gray(value);
                made_of(scene, Material::Emitter { radiance: Rgb::ONE, albedo });
            });
            refuse("color of sphere 7", |scene, value| {
                scene.spheres.color.resize(scene.spheres.len(), Rgb::ONE);
                scene.spheres.color[7] = gray(value);
            });
        }
        refuse("`roughness`", |scene, roughness| {
            let fresnel = ConductorFresnel::Constant(Rgb::ONE);
            made_of(scene, Material::Conductor { fresnel, roughness });
        });
        refuse("`ior`", |scene, ior| {
            made_of(scene, Material::Dielectric { ior, color: Rgb::ONE });
        });
        refuse("`ior`", |scene, ior| {
            made_of(scene, Material::Plastic { ior: ior + 1.0, color: Rgb::ONE });
        });
        for (name, factors) in [("`diffuse`", [1.0, 0.0]), ("`mirror`", [0.0, 1.0])] {
            refuse(name, |scene, value| {
                let [diffuse, mirror] =
                    factors.map(|factor: f64| if factor > 0.0 { value } else { 0.25 });
                made_of(scene, Material::Reflective { color: Rgb::ONE, diffuse, mirror });
            });
        }
        let mut scene = default_scene(0);
        made_of(&mut scene, Material::Reflective { color: Rgb::ONE, diffuse: 0.5, mirror: 0.75 });
        let error = World::build(&scene).expect_err("more than 1").to_string();
        assert!(error.contains("`diffuse + mirror` of the material \"own\" is 1.25"), "{error}");
        refuse("sphere 3", |scene, value| scene.spheres.radius[3] = value);
        refuse_infinite("sphere 3", |scene, value| scene.spheres.y[3] = value);
    }

    #[test]
    fn light_out_of_range_is_refused() {
        let sun = |direction, irradiance, angular_radius| Light::Sun {
            direction,
            irradiance: Rgb::splat(irradiance),
            angular_radius,
        };
        refuse("`angular_radius`", |scene, value| {
            scene.lights = vec![sun(DVec3::Y, 1.0, value)];
        });
        refuse("`irradiance`", |scene, value| {
            scene.lights = vec![sun(DVec3::Y, value as f32, 1.0)];
        });
        refuse_infinite("`direction`", |scene, value| {
            scene.lights = vec![sun(DVec3::new(0.0, 1.0, value), 1.0, 1.0)];
        });
        refuse("`intensity`", |scene, value| {
            let intensity = Rgb::new(1.0, 1.0, value as f32);
            let light = Light::Point { position: DVec3::splat(50.0), intensity, falloff: true };
            scene.lights = vec![light];
        });
        refuse_infinite("`position`", |scene, value| {
            let position = DVec3::new(0.0, value, 0.0);
            scene.lights = vec![Light::Point { position, intensity: Rgb::ONE, falloff: false }];
        });
        let sky = |scene: &mut Scene, map| {
            scene.environment = Environment { map, illuminates: true };
        };
        refuse("`color`", |scene, value| {
            sky(scene, EnvironmentMap::Constant(Rgb::splat(value as f32)));
        });
        for (name, ends) in [("`bottom`", [true, false]), ("`top`", [false, true])] {
            refuse(name, |scene, value| {
                let [bottom, top] =
                    ends.map(|end| Rgb::splat(if end { value as f32 } else { 1.0 }));
                sky(scene, EnvironmentMap::Gradient { bottom, top, up: DVec3::Y });
            });
        }
        let image = || Arc::new(Image { width: 2, height: 1, pixels: vec![[0.5; 3]; 2] });
        let picture = |rotation: f64, scale: f64| EnvironmentMap::Picture {
            image: image(),
            up: DVec3::Y,
            rotation,
            scale: scale as f32,
        };
        refuse("`scale`", |scene, value| sky(scene, picture(0.0, value)));
        refuse_infinite("`rotation`", |scene, value| sky(scene, picture(value, 1.0)));
    }

    #[test]
    fn grounds_slices_and_looks_out_of_range_are_refused() {
        let ground = |normal, height, material| Some(Ground { normal, height, material });
        refuse_infinite("`height`", |scene, value| scene.ground = ground(DVec3::Y, value, 0));
        refuse_infinite("`normal`", |scene, value| {
            scene.ground = ground(DVec3::new(value, 1.0, 0.0), 0.0, 0);
        });
        let mut scene = default_scene(0);
        scene.ground = ground(DVec3::Y, 0.0, 99);
        let error = World::build(&scene).expect_err("no such material").to_string();
        assert!(error.contains("material 99"), "{error}");
        let slice = |normal, distance| Slice { normal, distance, mode: SliceMode::Remove };
        refuse_infinite("`distance`", |scene, value| scene.slices = vec![slice(DVec3::Y, value)]);
        refuse_infinite("`normal`", |scene, value| {
            scene.slices = vec![slice(DVec3::new(0.0, value, 1.0), 0.0)];
        });
        refuse("`background`", |scene, value| {
            scene.look.background = Background::Color(Rgb::new(0.5, 0.5, value as f32));
        });
        for row in 0..4 {
            refuse_infinite("`cell`", |scene, value| {
                let mut edges = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
                edges[row].y = value;
                let [origin, a, b, c] = edges;
                let cell = Cell { origin, vectors: [a, b, c], periodic: [true; 3] };
                scene.look.cell = Some(cell);
            });
        }
        for name in ["until_error", "exposure"] {
            let mut scene = default_scene(0);
            match name {
                "exposure" => scene.settings.exposure = f64::NAN,
                _ => scene.settings.until_error = Some(f64::NAN),
            }
            let error = World::build(&scene).expect_err(name).to_string();
            assert!(error.contains(name), "{error}");
        }
    }
}
