//! The paper's ray tracer, as a baseline for Spherule.
//!
//! The paper "Optimizing Ray Tracing" starts from a recursive ray tracer of spheres, and speeds it up
//! by Russian roulette, threads, and a tree of bounding boxes. This is that tracer, in its style: an
//! array of sphere structures, a tree of boxed nodes, recursion for each mirrored ray, double
//! precision, and an epsilon against self-intersection. Optionally, random numbers and finished pixels
//! are protected by critical sections, which limited the paper's four threads to twice the speed of one.
//!
//! It reads the [`Scene`] and shares only the camera and the environment's colors with Spherule. It
//! estimates the same integral as [`whitted`](spherule_render::integrator::whitted), so each checks the
//! other's images. Diffuse surfaces gather direct light from the lights and the environment by jittered
//! samples; mirrors reflect. Pixels have a box filter, whatever the settings say.

#![forbid(unsafe_code)]
#![allow(clippy::disallowed_methods, reason = "a baseline that is timed, not compared")]

mod hierarchy;
mod light;
mod random;
mod render;
mod shape;
#[cfg(test)]
mod tests;

pub use render::{Render, Threading};
pub use shape::{Hit, Primitive};

use glam::DVec3;
use hierarchy::Node;
use light::Light;
use shape::{Ray, Sphere};
use spherule_render::scene::{ConductorFresnel, InvalidSetting, Material, NamedMaterial, Scene};
use spherule_render::world::{Camera, Environment, Transform, World};

/// A scene in the paper's data structures.
pub struct PaperTracer {
    spheres: Vec<Sphere>,
    hierarchy: Option<Node>,
    ground: Option<Ground>,
    lights: Vec<Light>,
    environment: Environment,
    camera: Camera,
    transform: Transform,
}

/// The points `p` with `normal . p = height`.
struct Ground {
    normal: DVec3,
    height: f64,
    surface: Surface,
}

/// Emission and reflectance of a surface.
#[derive(Clone, Copy, Debug)]
struct Surface {
    /// Emitted radiance.
    emitted: DVec3,
    /// Albedo of the diffuse part.
    diffuse: DVec3,
    /// Reflectance of the mirrored part.
    mirror: DVec3,
}

/// An error for scenes or settings that the paper's tracer does not support.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Unsupported {
    /// A setting is out of range.
    #[error(transparent)]
    Setting(#[from] InvalidSetting),
    /// The material is not diffuse, a mirror of constant reflectance, a mixture of both, or an emitter.
    #[error(
        "the paper's tracer does not support material `{0}`; use lambertian, reflective, emitter or a smooth conductor of constant reflectance"
    )]
    Material(String),
    /// The integrator is not `whitted`.
    #[error("the paper's tracer supports only integrator = \"whitted\"")]
    Integrator,
    /// The roulette depends on throughput.
    #[error("the paper's tracer supports only roulette = \"none\" or a probability")]
    Roulette,
    /// The depth is unlimited or too large for the stack.
    #[error("the paper's tracer is recursive; use depth = {max} or less", max = PaperTracer::MAX_BOUNCES)]
    Depth,
}

impl PaperTracer {
    /// Maximum depth that the stack has room for.
    pub const MAX_BOUNCES: u32 = 1000;

    /// Converts a scene, with the paper's tree or, for brute force, without. `world` is built from the
    /// same scene, and provides the camera and the environment.
    ///
    /// # Errors
    /// [`Unsupported::Material`] for glass, plastic and metals that are rough or colored by angle.
    pub fn new(scene: &Scene, world: &World, hierarchy: bool) -> Result<Self, Unsupported> {
        let surfaces: Vec<Surface> =
            scene.materials.iter().map(surface).collect::<Result<_, _>>()?;
        let spheres: Vec<Sphere> = (0..scene.spheres.len())
            .map(|row| Sphere {
                center: scene.spheres.center(row),
                radius: scene.spheres.radius[row],
                surface: surfaces[scene.spheres.material_of(row) as usize]
                    .tinted(scene.spheres.color_of(row).as_dvec3()),
            })
            .collect();
        let ground = scene.ground.as_ref().map(|ground| Ground {
            normal: ground.normal,
            height: ground.height,
            surface: surfaces[ground.material as usize],
        });
        let hierarchy = hierarchy.then(|| Node::build(&spheres)).flatten();
        let lights = Light::all(scene, &spheres);
        let environment = world.environment.clone();
        let (camera, transform) = (world.camera, world.transform);
        Ok(Self { spheres, hierarchy, ground, lights, environment, camera, transform })
    }

    /// Builds the paper's tree again, for measurements.
    pub fn hierarchy(&self) -> impl Sized + use<> {
        Node::build(&self.spheres)
    }

    /// Returns the nearest hit beyond the epsilon; `direction` has length 1.
    pub fn closest(&self, origin: DVec3, direction: DVec3) -> Option<Hit> {
        let ray = Ray { origin, direction };
        let mut nearest = Hit { primitive: Primitive::Ground, t: f64::INFINITY };
        match &self.hierarchy {
            Some(node) => node.closest(&self.spheres, &ray, &mut nearest),
            None => {
                for (row, sphere) in self.spheres.iter().enumerate() {
                    sphere.closest(row, &ray, &mut nearest);
                }
            }
        }
        if let Some(t) = self.ground.as_ref().and_then(|ground| ground.hit(&ray, nearest.t)) {
            nearest = Hit { primitive: Primitive::Ground, t };
        }
        nearest.t.is_finite().then_some(nearest)
    }

    /// Returns whether there is a hit between the epsilon and `t`.
    fn occluded(&self, ray: &Ray, t: f64) -> bool {
        let spheres = match &self.hierarchy {
            Some(node) => node.any(&self.spheres, ray, t),
            None => self.spheres.iter().any(|sphere| sphere.hit(ray, t).is_some()),
        };
        spheres || self.ground.as_ref().is_some_and(|ground| ground.hit(ray, t).is_some())
    }

    /// Returns the surface of a primitive and its outward unit normal at a point.
    fn surface(&self, primitive: Primitive, point: DVec3) -> (&Surface, DVec3) {
        match (primitive, &self.ground) {
            (Primitive::Sphere(row), _) => {
                let sphere = &self.spheres[row];
                (&sphere.surface, (point - sphere.center) / sphere.radius)
            }
            (Primitive::Ground, Some(ground)) => (&ground.surface, ground.normal),
            (Primitive::Ground, None) => (&Surface::BLACK, DVec3::Z),
        }
    }
}

impl Surface {
    const BLACK: Self = Self { emitted: DVec3::ZERO, diffuse: DVec3::ZERO, mirror: DVec3::ZERO };

    fn tinted(self, color: DVec3) -> Self {
        Self { diffuse: self.diffuse * color, mirror: self.mirror * color, ..self }
    }
}

fn surface(named: &NamedMaterial) -> Result<Surface, Unsupported> {
    let black = Surface::BLACK;
    match &named.material {
        Material::Lambertian { color } => Ok(Surface { diffuse: color.as_dvec3(), ..black }),
        Material::Reflective { color, diffuse, mirror } => {
            let color = color.as_dvec3();
            Ok(Surface { diffuse: color * *diffuse, mirror: color * *mirror, ..black })
        }
        Material::Emitter { radiance, albedo } => {
            let (emitted, diffuse) = (radiance.as_dvec3(), albedo.as_dvec3());
            Ok(Surface { emitted, diffuse, ..black })
        }
        Material::Conductor { fresnel: ConductorFresnel::Constant(color), roughness: 0.0 } => {
            Ok(Surface { mirror: color.as_dvec3(), ..black })
        }
        _ => Err(Unsupported::Material(named.name.clone())),
    }
}
