//! Presets of the look: materials, lights and ground that suit particles.
//!
//! Lights are placed relative to the camera, so that all views are lit equally. Overlays of a look,
//! such as contours, are drawn by [`crate::overlay`].

use super::{
    Background, Camera, Environment, EnvironmentMap, Ground, Integrator, Light, Look, Material,
    NamedMaterial, Pose, Rgb, Scene,
};
use glam::DVec3;

/// Albedo of all bodies; colors of particles are factors on it.
const BODY: f32 = 0.8;

/// Albedo of the ground: under these lights it is as white as the background.
const GROUND: f32 = 0.9;

/// A preset of the look.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Preset {
    /// Matte, lit uniformly: ambient occlusion shows the shape.
    Chalk,
    /// Matte under three soft lights, on a ground that receives their shadows.
    Studio,
    /// Matte under an overcast sky, which is brightest above.
    Cloudy,
    /// Polished plastic under the three lights of a studio.
    Glossy,
    /// Matte under a white sky; far objects fade.
    DepthCue,
    /// Matte under a white sky, with outlines around spheres.
    Outline,
}

/// A studio light, in the camera's axes.
struct StudioLight {
    /// Direction toward the light: right, up, and toward the camera.
    toward: [f64; 3],
    irradiance: f32,
    /// Degrees.
    angular_radius: f64,
}

/// Key light from the upper left, fill light from the right, and a rim light from behind.
const STUDIO: [StudioLight; 3] = [
    StudioLight { toward: [-0.7, 1.2, 0.9], irradiance: 2.4, angular_radius: 20.0 },
    StudioLight { toward: [1.2, 0.5, 0.8], irradiance: 0.8, angular_radius: 30.0 },
    StudioLight { toward: [0.5, 1.3, -0.9], irradiance: 1.1, angular_radius: 20.0 },
];

impl Preset {
    /// All presets.
    pub const ALL: [Self; 6] =
        [Self::Chalk, Self::Studio, Self::Cloudy, Self::Glossy, Self::DepthCue, Self::Outline];

    /// Returns the name in scene files and options.
    pub fn name(self) -> &'static str {
        match self {
            Self::Chalk => "chalk",
            Self::Studio => "studio",
            Self::Cloudy => "cloudy",
            Self::Glossy => "glossy",
            Self::DepthCue => "depthcue",
            Self::Outline => "outline",
        }
    }

    /// Returns the integrator. Ambient occlusion shades every surface as if it were matte, so it is
    /// only for scenes without materials of their own.
    pub fn integrator(self, own_materials: bool) -> Integrator {
        match self {
            Self::Chalk if !own_materials => Integrator::Ao { distance: f64::INFINITY },
            _ => Integrator::Path,
        }
    }

    /// Sets the integrator of a scene whose other materials are the user's choice.
    pub fn set(self, scene: &mut Scene) {
        let own = scene.materials.iter().any(|row| row.material != self.material());
        scene.settings.integrator = self.integrator(own);
    }

    /// Returns the overlays and the background.
    pub fn look(self) -> Look {
        Look {
            background: Background::Color(Rgb::ONE),
            depth_cue: self == Self::DepthCue,
            outline: self == Self::Outline,
            cell: None,
        }
    }

    /// Gives every sphere and the ground this look's material; names stay.
    pub fn replace_materials(self, scene: &mut Scene) {
        for row in &mut scene.materials {
            row.material = self.material();
        }
    }

    /// Replaces environment, lights and ground. Materials stay: those of particles are set by
    /// [`Scene::of_particles_with`]. The lights depend on the camera, so its pose must be set.
    pub fn light(self, scene: &mut Scene) {
        scene.environment = Environment { map: self.sky(scene), illuminates: true };
        scene.lights = match self {
            Self::Studio | Self::Glossy => studio(&scene.camera),
            _ => Vec::new(),
        };
        scene.ground = (self == Self::Studio).then(|| ground(scene));
    }

    /// Returns the material of particles that have none of their own; their colors are factors on
    /// its albedo.
    pub fn material(self) -> Material {
        let color = Rgb::splat(BODY);
        match self {
            Self::Glossy => Material::Plastic { color, ior: 1.6 },
            _ => Material::Lambertian { color },
        }
    }

    fn sky(self, scene: &Scene) -> EnvironmentMap {
        match self {
            Self::Studio => EnvironmentMap::Constant(Rgb::splat(0.3)),
            Self::Glossy => EnvironmentMap::Constant(Rgb::splat(0.5)),
            Self::Cloudy => EnvironmentMap::Gradient {
                bottom: Rgb::splat(0.05),
                top: Rgb::splat(1.7),
                up: vertical(&scene.camera),
            },
            _ => EnvironmentMap::Constant(Rgb::ONE),
        }
    }
}

fn vertical(camera: &Camera) -> DVec3 {
    camera.up.normalize_or(DVec3::Y)
}

/// Returns the studio lights for a camera.
fn studio(camera: &Camera) -> Vec<Light> {
    let direction = match camera.pose {
        Pose::Fit { direction, .. } => direction,
        Pose::LookAt { eye, target } => target - eye,
    };
    let back = -direction.normalize_or(DVec3::NEG_Z);
    let side = vertical(camera).cross(back);
    let right = side.try_normalize().unwrap_or_else(|| back.any_orthonormal_vector());
    let up = back.cross(right);
    let sun = |light: &StudioLight| {
        let [x, y, z] = light.toward;
        Light::Sun {
            direction: (right * x + up * y + back * z).normalize(),
            irradiance: Rgb::splat(light.irradiance),
            angular_radius: light.angular_radius,
        }
    };
    STUDIO.iter().map(sun).collect()
}

/// Returns a plane under the lowest sphere.
fn ground(scene: &mut Scene) -> Ground {
    let normal = vertical(&scene.camera);
    let spheres = &scene.spheres;
    let lowest = |row: usize| normal.dot(spheres.center(row)) - spheres.radius[row];
    let height = (0..spheres.len()).map(lowest).fold(f64::INFINITY, f64::min);
    let material = Material::Lambertian { color: Rgb::splat(GROUND) };
    let mut name = "ground".to_owned();
    while scene.materials.iter().any(|row| row.name == name) {
        name.push('_');
    }
    scene.materials.push(NamedMaterial { name, material });
    let height = if height.is_finite() { height } else { 0.0 };
    Ground { normal, height, material: scene.materials.len() as u32 - 1 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::World;
    use crate::scene::particles::Particles;

    fn scene() -> Scene {
        let mut scene = Scene::of_particles(Particles::default(), "");
        scene.spheres.push(DVec3::new(3.0, 4.0, 5.0), 1.0, 0, Rgb::X);
        scene.spheres.push(DVec3::new(3.0, 8.0, 5.0), 2.0, 0, Rgb::Y);
        scene
    }

    #[test]
    fn every_preset_makes_a_world() {
        for preset in Preset::ALL {
            let mut scene = scene();
            preset.replace_materials(&mut scene);
            preset.set(&mut scene);
            preset.light(&mut scene);
            let world = World::build(&scene).unwrap();
            assert_eq!(world.ground.is_some(), preset == Preset::Studio);
            assert_eq!(scene.lights.is_empty(), !matches!(preset, Preset::Studio | Preset::Glossy));
            let ao = matches!(scene.settings.integrator, Integrator::Ao { .. });
            assert_eq!(ao, preset == Preset::Chalk);
        }
    }

    #[test]
    fn materials_of_the_user_stay_and_set_the_integrator() {
        let glass = Material::Dielectric { ior: 1.5, color: Rgb::ONE };
        for preset in Preset::ALL {
            let mut scene = Scene::of_particles_with(Particles::default(), "", &preset.material());
            let material = glass.clone();
            scene.materials.push(NamedMaterial { name: "glass".to_owned(), material });
            scene.spheres.push(DVec3::ZERO, 1.0, 1, Rgb::X);
            preset.set(&mut scene);
            preset.light(&mut scene);
            assert_eq!(scene.materials[0].material, preset.material());
            assert_eq!(scene.materials[1].material, glass);
            assert_eq!(scene.settings.integrator, Integrator::Path, "{}", preset.name());
        }
    }

    #[test]
    fn the_lowest_sphere_stands_on_the_ground() {
        let mut scene = scene();
        for (up, height) in [(DVec3::Y, 3.0), (DVec3::Z * 7.0, 3.0), (DVec3::NEG_X, -5.0)] {
            scene.camera.up = up;
            Preset::Studio.light(&mut scene);
            let ground = scene.ground.clone().unwrap();
            assert_eq!((ground.normal, ground.height), (up.normalize(), height));
        }
    }

    #[test]
    fn lights_turn_with_the_camera_even_for_a_vertical_view() {
        for eye in [DVec3::new(1.0, 2.0, 3.0), DVec3::Y * 4.0, DVec3::NEG_Y] {
            let pose = Pose::LookAt { eye, target: DVec3::ZERO };
            let camera = Camera { pose, ..Camera::default() };
            for (light, studio_light) in studio(&camera).into_iter().zip(STUDIO) {
                let Light::Sun { direction, .. } = light else { panic!("suns alone") };
                let [_, _, back] = studio_light.toward;
                let expected = back / DVec3::from(studio_light.toward).length();
                assert!((direction.dot(eye.normalize()) - expected).abs() < 1e-12);
            }
        }
    }
}
