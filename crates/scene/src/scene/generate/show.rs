//! The default scene, which the program renders if no scene is named.

use super::{Field, Group};
use crate::scene::{
    Camera, Environment, EnvironmentMap, Ground, Lens, Light, Material, NamedMaterial, Pose,
    Projection, Rgb, Scene, Settings, Tone,
};
use glam::DVec3;

/// Fractions of plastic, metal and glass in the default scene.
pub const DEFAULT_MIX: [f64; 3] = [0.68, 0.2, 0.12];

/// Returns a random field of spheres of plastic, metal and glass under a low sun: the cover picture.
pub fn default_scene(seed: u64) -> Scene {
    let field = Field { mix: Some(DEFAULT_MIX), ..Field::default() };
    // These parameters are in range, so the default, a scene of only ground and sky, is never used.
    let Group { spheres, mut materials } = field.generate(seed).unwrap_or_default();
    for row in &mut materials {
        if row.name == "diffuse" {
            row.material = Material::Plastic { color: Rgb::splat(0.9), ior: 1.5 };
        }
    }
    let ground = Ground { normal: DVec3::Y, height: 0.0, material: materials.len() as u32 };
    let floor = Material::Lambertian { color: Rgb::new(0.38, 0.36, 0.34) };
    materials.push(NamedMaterial { name: "ground".to_owned(), material: floor });
    Scene {
        title: "A random field of spheres".to_owned(),
        spheres,
        materials,
        ground: Some(ground),
        lights: vec![sun()],
        environment: sky(),
        camera: camera(),
        settings: Settings {
            width: 960,
            height: 540,
            spp: 64,
            seed,
            tone: Tone::Filmic,
            ..Settings::default()
        },
        ..Scene::default()
    }
}

/// Returns a warm sun, low enough for long shadows and wide enough for soft ones.
fn sun() -> Light {
    Light::Sun {
        direction: DVec3::new(-0.75, 0.55, 0.35).normalize(),
        irradiance: Rgb::new(3.2, 2.75, 2.2),
        angular_radius: 10.0,
    }
}

/// Returns a gradient, pale at the horizon and blue above. Half of its range is below the horizon.
fn sky() -> Environment {
    let map = EnvironmentMap::Gradient {
        bottom: Rgb::new(0.95, 0.9, 0.85),
        top: Rgb::new(0.05, 0.22, 0.7),
        up: DVec3::Y,
    };
    Environment { map, illuminates: true }
}

/// Returns a camera low over a corner of the field, focused on its nearer part.
fn camera() -> Camera {
    let (eye, target) = (DVec3::new(5.5, 2.1, 12.2), DVec3::new(0.9, -0.15, 3.0));
    Camera {
        projection: Projection::Perspective { fov: 32.0 },
        pose: Pose::LookAt { eye, target },
        up: DVec3::Y,
        lens: Some(Lens { aperture: 0.06, focus: Some(7.5) }),
        ..Camera::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_cover_shows_all_materials() {
        let scene = default_scene(0);
        assert_eq!(scene.spheres.len(), 400);
        for material in 0..3 {
            assert!(scene.spheres.material.contains(&material));
        }
        let names: Vec<&str> = scene.materials.iter().map(|row| row.name.as_str()).collect();
        assert_eq!(names, ["diffuse", "metal", "glass", "ground"]);
        assert_eq!(default_scene(1).spheres, default_scene(1).spheres);
        assert_ne!(default_scene(1).spheres, scene.spheres);
    }
}
