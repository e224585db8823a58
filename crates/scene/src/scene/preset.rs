//! Presets of the look: materials, lights and ground that suit particles.
//!
//! Lights are placed relative to the camera, so that all views are lit equally. They are wide, because
//! wide lights make soft shadows and little noise: a sky whose radiance is linear in the cosine of an
//! angle, which needs no light samples, and at most one sun of tens of degrees. All lights are neutral:
//! a matte surface has the hue of its color, and is nowhere brighter than its color, so that white
//! spheres are darker than a white background, and colors can be compared with a color bar. Overlays of
//! a look, such as contours, are drawn by `overlay` of the renderer.

use super::particles::{GHOST, Orientation, Particles};
use super::{
    Background, Camera, Environment, EnvironmentMap, Ground, Integrator, Light, Look, Material,
    NamedMaterial, Pose, Rgb, Scene,
};
use crate::elementary;
use glam::DVec3;

/// Albedo of matte bodies and of the ground; colors of particles are factors on it.
const MATTE: f32 = 0.8;

/// Albedo of the base of polished bodies, which reflects less under its coat.
const POLISHED: f32 = 0.95;

/// Radiance of the open ground under the lights of a studio: its background.
const SWEEP: f32 = 0.825;

/// A preset of the look.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Preset {
    /// Matte under a soft key light and a sky, before white: for publications.
    #[default]
    Figure,
    /// Matte, lit uniformly: ambient occlusion shows the shape.
    Chalk,
    /// Matte under a studio's soft light, on a light gray ground that receives shadows.
    Studio,
    /// Matte under an overcast sky, which is brightest above.
    Cloudy,
    /// Polished plastic with the highlight of a large light.
    Glossy,
    /// Matte under the lights of `Figure`; far objects fade.
    DepthCue,
    /// Matte under a white sky, with outlines around spheres.
    Outline,
    /// As `Figure`, but translucent: what is inside is seen too.
    Ghost,
    /// Translucent before black, lit uniformly: the more bodies there are behind each other, the brighter.
    XRay,
}

/// The lights of a preset. Directions are right, up, and toward the camera.
struct Lighting {
    /// True if up is that of the picture, and not that of the ground.
    tilted: bool,
    sky: Sky,
    sun: Option<StudioLight>,
}

/// A sky whose radiance is linear in the cosine of the angle to a direction.
struct Sky {
    /// Radiance opposite of the direction, and in it.
    radiance: [f32; 2],
    toward: [f64; 3],
}

/// A sun.
struct StudioLight {
    toward: [f64; 3],
    irradiance: f32,
    /// Degrees.
    angular_radius: f64,
}

/// Key light from the upper left, and a sky that is dark behind the scene: edges are darker than middles.
const FIGURE: Lighting = Lighting {
    tilted: true,
    sky: Sky { radiance: [0.05, 0.55], toward: [-0.3, 0.6, 0.75] },
    sun: Some(StudioLight { toward: [-0.9, 0.9, 0.5], irradiance: 1.95, angular_radius: 30.0 }),
};

/// Key light from high on the left, and an even fill. The open ground has the radiance [`SWEEP`].
const STUDIO: Lighting = Lighting {
    tilted: false,
    sky: Sky { radiance: [0.5, 0.5], toward: UP },
    sun: Some(StudioLight { toward: [-0.6, 1.4, 0.5], irradiance: 1.91, angular_radius: 30.0 }),
};

/// Light from above.
const CLOUDY: Lighting =
    Lighting { tilted: false, sky: Sky { radiance: [0.1, 1.25], toward: UP }, sun: None };

/// Key light from the upper left, small enough for a highlight.
const GLOSSY: Lighting = Lighting {
    tilted: true,
    sky: Sky { radiance: [0.1, 0.7], toward: [-0.3, 0.8, 0.4] },
    sun: Some(StudioLight { toward: [-0.6, 1.0, 0.9], irradiance: 1.5, angular_radius: 25.0 }),
};

/// The same light from everywhere.
const EVEN: Lighting =
    Lighting { tilted: false, sky: Sky { radiance: [1.0, 1.0], toward: UP }, sun: None };

/// Returns the opacity of bodies in an x-ray picture of `count` of them. A ray through the middle of a heap meets a number of
/// bodies that grows with its cubic root; about half of the light stays in the heap whatever the count.
fn faint(count: usize) -> f64 {
    let root = elementary::exp2(elementary::log2(count.max(1) as f64) / 3.0);
    let opacity = 1.26 / root;
    (opacity.clamp(0.001, 0.5) * 1e3).round() / 1e3
}

const UP: [f64; 3] = [0.0, 1.0, 0.0];

impl Preset {
    /// All presets.
    pub const ALL: [Self; 9] = [
        Self::Figure,
        Self::Chalk,
        Self::Studio,
        Self::Cloudy,
        Self::Glossy,
        Self::DepthCue,
        Self::Outline,
        Self::Ghost,
        Self::XRay,
    ];

    /// Returns the name in scene files and options.
    pub fn name(self) -> &'static str {
        match self {
            Self::Figure => "figure",
            Self::Chalk => "chalk",
            Self::Studio => "studio",
            Self::Cloudy => "cloudy",
            Self::Glossy => "glossy",
            Self::DepthCue => "depthcue",
            Self::Outline => "outline",
            Self::Ghost => "ghost",
            Self::XRay => "x-ray",
        }
    }

    /// Creates a scene of particles with this look, except for its lights, and with a camera that frames
    /// all of them.
    pub fn scene(self, particles: Particles, title: &str, orientation: &Orientation) -> Scene {
        let material = self.material(particles.spheres.len());
        let mut scene = Scene::of_particles_with(particles, title, &material);
        scene.camera = orientation.camera();
        scene.look = self.look();
        self.set(&mut scene);
        scene
    }

    /// Returns the integrator. Ambient occlusion shades every surface as if it were matte, so it is
    /// only for scenes without materials of their own.
    pub fn integrator(self, own_materials: bool) -> Integrator {
        match self {
            Self::Chalk if !own_materials => Integrator::Ao { distance: f64::INFINITY },
            Self::XRay if !own_materials => Integrator::Ao { distance: 0.0 },
            _ => Integrator::Path,
        }
    }

    /// Sets the integrator of a scene whose other materials are the user's choice.
    pub fn set(self, scene: &mut Scene) {
        let usual = self.material(scene.spheres.len());
        let is_own = |row: &NamedMaterial| row.material.surface() != usual.surface();
        let own = scene.materials.iter().any(is_own);
        scene.settings.integrator = self.integrator(own);
    }

    /// Returns the overlays and the background.
    pub fn look(self) -> Look {
        let background = match self {
            Self::Studio => SWEEP,
            Self::XRay => 0.0,
            _ => 1.0,
        };
        Look {
            background: Background::Color(Rgb::splat(background)),
            depth_cue: self == Self::DepthCue,
            outline: self == Self::Outline,
            cell: None,
        }
    }

    /// Gives every sphere this look's material; names stay, and opacities of less than 1.
    pub fn replace_materials(self, scene: &mut Scene) {
        let material = self.material(scene.spheres.len());
        let ground = scene.ground.as_ref().map(|ground| ground.material as usize);
        for (index, row) in scene.materials.iter_mut().enumerate() {
            let opacity = match row.material.opacity() {
                _ if Some(index) == ground => 1.0,
                1.0 => material.opacity(),
                opacity => opacity,
            };
            row.material = material.with_opacity(opacity);
        }
    }

    /// Replaces environment, lights and ground. Materials stay: those of particles are set by
    /// [`Scene::of_particles_with`]. The lights depend on the camera, so its pose must be set; the
    /// ground and an overcast sky depend on what is up.
    pub fn light(self, scene: &mut Scene, up: DVec3) {
        let up = up.normalize_or(DVec3::Y);
        let lighting = self.lighting();
        let axes = LightAxes::of(&scene.camera);
        let axes = if lighting.tilted { axes } else { axes.upright(up) };
        scene.environment = Environment { map: lighting.sky.map(&axes), illuminates: true };
        scene.lights = lighting.sun.iter().map(|sun| sun.light(&axes)).collect();
        scene.ground = (self == Self::Studio).then(|| ground(scene, up));
    }

    /// Returns the material of `count` particles that have none of their own; their colors are factors on
    /// its albedo.
    pub fn material(self, count: usize) -> Material {
        let matte = Material::Lambertian { color: Rgb::splat(MATTE) };
        match self {
            Self::Glossy => Material::Plastic { color: Rgb::splat(POLISHED), ior: 1.5 },
            Self::Ghost => matte.with_opacity(GHOST),
            Self::XRay => matte.with_opacity(faint(count)),
            _ => matte,
        }
    }

    fn lighting(self) -> Lighting {
        match self {
            Self::Figure | Self::DepthCue | Self::Ghost => FIGURE,
            Self::Studio => STUDIO,
            Self::Cloudy => CLOUDY,
            Self::Glossy => GLOSSY,
            Self::Chalk | Self::Outline | Self::XRay => EVEN,
        }
    }
}

/// Unit axes of lights: to the right, up, and toward the camera.
struct LightAxes {
    right: DVec3,
    up: DVec3,
    toward: DVec3,
}

impl LightAxes {
    /// Returns the axes of the picture.
    fn of(camera: &Camera) -> Self {
        let direction = match camera.pose {
            Pose::Fit { direction, .. } => direction,
            Pose::LookAt { eye, target } => target - eye,
        };
        let toward = -direction.normalize_or(DVec3::NEG_Z);
        let side = camera.up.normalize_or(DVec3::Y).cross(toward);
        let right = side.try_normalize().unwrap_or_else(|| toward.any_orthonormal_vector());
        Self { right, up: toward.cross(right), toward }
    }

    /// Returns the axes tilted such that `up`, a unit vector, is up; in a view along it, the picture's up
    /// is away from the camera.
    fn upright(&self, up: DVec3) -> Self {
        let right = up.cross(self.toward).try_normalize().unwrap_or(self.right);
        Self { right, up, toward: right.cross(up) }
    }

    /// Returns the unit vector with the direction of these coordinates.
    fn direction(&self, [x, y, z]: [f64; 3]) -> DVec3 {
        (self.right * x + self.up * y + self.toward * z).normalize()
    }
}

impl Sky {
    fn map(&self, axes: &LightAxes) -> EnvironmentMap {
        let [bottom, top] = self.radiance.map(Rgb::splat);
        if bottom == top {
            return EnvironmentMap::Constant(top);
        }
        EnvironmentMap::Gradient { bottom, top, up: axes.direction(self.toward) }
    }
}

impl StudioLight {
    fn light(&self, axes: &LightAxes) -> Light {
        Light::Sun {
            direction: axes.direction(self.toward),
            irradiance: Rgb::splat(self.irradiance),
            angular_radius: self.angular_radius,
        }
    }
}

/// Returns a plane under the lowest sphere.
fn ground(scene: &mut Scene, up: DVec3) -> Ground {
    let spheres = &scene.spheres;
    let lowest = |row: usize| up.dot(spheres.center(row)) - spheres.radius[row];
    let height = (0..spheres.len()).map(lowest).fold(f64::INFINITY, f64::min);
    let material = Material::Lambertian { color: Rgb::splat(MATTE) };
    let mut name = "ground".to_owned();
    while scene.materials.iter().any(|row| row.name == name) {
        name.push('_');
    }
    scene.materials.push(NamedMaterial { name, material });
    let height = if height.is_finite() { height } else { 0.0 };
    Ground { normal: up, height, material: scene.materials.len() as u32 - 1 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    fn scene() -> Scene {
        let mut scene = Scene::of_particles(Particles::default(), "");
        scene.spheres.push(DVec3::new(3.0, 4.0, 5.0), 1.0, 0, Rgb::X);
        scene.spheres.push(DVec3::new(3.0, 8.0, 5.0), 2.0, 0, Rgb::Y);
        scene
    }

    #[test]
    fn materials_of_the_user_stay_and_set_the_integrator() {
        let glass = Material::Dielectric { ior: 1.5, color: Rgb::ONE };
        for preset in Preset::ALL {
            let mut scene = Scene::of_particles_with(Particles::default(), "", &preset.material(0));
            let material = glass.clone();
            scene.materials.push(NamedMaterial { name: "glass".to_owned(), material });
            scene.spheres.push(DVec3::ZERO, 1.0, 1, Rgb::X);
            preset.set(&mut scene);
            preset.light(&mut scene, DVec3::Y);
            assert_eq!(scene.materials[0].material, preset.material(0));
            assert_eq!(scene.materials[1].material, glass);
            assert_eq!(scene.settings.integrator, Integrator::Path, "{}", preset.name());
        }
    }

    #[test]
    fn the_lowest_sphere_stands_on_the_ground() {
        for (up, height) in [(DVec3::Y, 3.0), (DVec3::Z * 7.0, 3.0), (DVec3::NEG_X, -5.0)] {
            let mut scene = scene();
            Preset::Studio.light(&mut scene, up);
            let ground = scene.ground.clone().unwrap();
            assert_eq!((ground.normal, ground.height), (up.normalize(), height));
        }
    }

    #[test]
    fn lights_turn_with_the_camera_even_for_a_vertical_view() {
        for eye in [DVec3::new(1.0, 2.0, 3.0), DVec3::Y * 4.0, DVec3::NEG_Y] {
            let pose = Pose::LookAt { eye, target: DVec3::ZERO };
            let axes = LightAxes::of(&Camera { pose, ..Camera::default() });
            for StudioLight { toward, .. } in [FIGURE, GLOSSY].into_iter().filter_map(|row| row.sun)
            {
                let expected = toward[2] / DVec3::from(toward).length();
                let cosine = axes.direction(toward).dot(eye.normalize());
                assert!((cosine - expected).abs() < 1e-12, "{eye} {cosine}");
            }
            let upright = axes.upright(DVec3::Y);
            assert_eq!(upright.up, DVec3::Y);
            assert!(upright.toward.dot(eye) >= -1e-12 && upright.right.is_normalized(), "{eye}");
        }
    }

    /// Returns the irradiance of a surface in the open, over pi.
    fn light(lighting: &Lighting, normal: DVec3) -> f64 {
        let unit = |toward: [f64; 3]| DVec3::from(toward).normalize();
        let [bottom, top] = lighting.sky.radiance.map(f64::from);
        let sun = lighting.sun.as_ref().map_or(0.0, |sun| {
            f64::from(sun.irradiance) * unit(sun.toward).dot(normal).max(0.0) / PI
        });
        let slope = unit(lighting.sky.toward).dot(normal);
        f64::midpoint(bottom, top) + (top - bottom) / 3.0 * slope + sun
    }

    #[test]
    fn white_spheres_are_darker_than_white_paper() {
        let normal = |i: i32| {
            let (z, angle) = (f64::from(i) / 500.0 - 1.0, f64::from(i) * 2.4);
            let radius = (1.0 - z * z).sqrt();
            DVec3::new(radius * angle.cos(), radius * angle.sin(), z)
        };
        for preset in Preset::ALL {
            let lights = (0..=1000).map(|i| light(&preset.lighting(), normal(i)));
            let brightest = f64::from(MATTE) * lights.fold(0.0, f64::max);
            assert!((0.75..0.9).contains(&brightest), "{} {brightest}", preset.name());
        }
    }

    #[test]
    fn the_open_ground_has_the_color_of_the_background() {
        let ground = f64::from(MATTE) * light(&STUDIO, DVec3::Y);
        assert!((ground / f64::from(SWEEP) - 1.0).abs() < 1e-3, "{ground}");
        assert_eq!(Preset::Studio.look().background, Background::Color(Rgb::splat(SWEEP)));
    }
}
