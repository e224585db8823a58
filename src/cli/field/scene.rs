//! Light, ground and cameras for generated spheres.

use glam::DVec3;
use spherule_render::elementary::tan;
use spherule_render::scene::generate::{Field, GenerateError, Generator, Group, default_scene};
use spherule_render::scene::{
    Camera, Environment, EnvironmentMap, Lens, Material, NamedMaterial, Pose, Projection, Rgb,
    Scene,
};

/// Returns the generator's spheres with the lights of the default scene.
pub(super) fn scene(generator: &Generator, seed: u64) -> Result<Scene, GenerateError> {
    let group = generator.generate(seed)?;
    Ok(match generator {
        Generator::Field(field) => field_scene(field, group, seed),
        Generator::Grid(_) => Scene { camera: Camera::default(), ..on_ground(group, seed) },
        Generator::Weekend(_) => weekend(group, seed),
        Generator::Volume(_) | Generator::Lattice(_) | Generator::Sphereflake(_) => {
            floating(group, seed)
        }
    })
}

/// A field of the default size has the camera of the default scene.
fn field_scene(field: &Field, group: Group, seed: u64) -> Scene {
    let scene = default_scene(seed);
    let own_camera = field.count == Field::default().count;
    let camera = if own_camera { scene.camera } else { Camera::default() };
    // Both have the materials diffuse, metal and glass, in this order.
    Scene { spheres: group.spheres, camera, ..default_scene(seed) }
}

/// Spheres of the first material on the ground.
fn on_ground(group: Group, seed: u64) -> Scene {
    Scene { title: "A grid of spheres".to_owned(), spheres: group.spheres, ..default_scene(seed) }
}

/// Plastic spheres without a ground.
fn floating(group: Group, seed: u64) -> Scene {
    let plastic = Material::Plastic { color: Rgb::splat(0.8), ior: 1.5 };
    Scene {
        title: "Generated spheres".to_owned(),
        spheres: group.spheres,
        materials: vec![NamedMaterial { name: "plastic".to_owned(), material: plastic }],
        ground: None,
        camera: Camera::default(),
        ..default_scene(seed)
    }
}

/// Camera and sky of the book (Shirley, Black, Hollasch, "Ray Tracing in One Weekend", 2016-2024).
fn weekend(group: Group, seed: u64) -> Scene {
    let bottom = Rgb::ONE;
    let top = Rgb::new(0.5, 0.7, 1.0);
    let map = EnvironmentMap::Gradient { bottom, top, up: DVec3::Y };
    // The book's cone of 0.6 degrees at distance 10.
    let aperture = 2.0 * 10.0 * tan(0.3_f64.to_radians());
    let scene = default_scene(seed);
    Scene {
        title: "Ray Tracing in One Weekend, final scene".to_owned(),
        spheres: group.spheres,
        materials: group.materials,
        ground: None,
        lights: Vec::new(),
        environment: Environment { map, illuminates: true },
        camera: Camera {
            projection: Projection::Perspective { fov: 20.0 },
            pose: Pose::LookAt { eye: DVec3::new(13.0, 2.0, 3.0), target: DVec3::ZERO },
            up: DVec3::Y,
            lens: Some(Lens { aperture, focus: Some(10.0) }),
            ..Camera::default()
        },
        ..scene
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_field_is_the_default_scene() {
        let field = Field { mix: Some([0.68, 0.2, 0.12]), ..Field::default() };
        let scene = scene(&Generator::Field(field), 3).unwrap();
        assert_eq!(format!("{scene:?}"), format!("{:?}", default_scene(3)));
    }
}
