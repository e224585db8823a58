//! The tracer that Spherule grew out of, to be measured beside it.
//!
//! The paper "Optimizing Ray Tracing" starts from a plain recursive tracer of spheres and makes it
//! faster by Russian roulette, by threads, and by a tree of bounding boxes. This is that tracer, in
//! its own style: an array of sphere structures, a tree of boxed nodes, a function that calls
//! itself for every mirrored ray, double precision throughout, an epsilon against self-hits, and,
//! where it is told so, random numbers and finished pixels that go through critical sections, which
//! is what kept the paper's four threads from being more than twice as fast as one.
//!
//! It reads the [`Scene`] itself and shares none of Spherule's kernels but the camera and the
//! environment's colors, and it estimates what [`whitted`](crate::integrator::whitted) does: a
//! picture of the one is right if it agrees with the other's. Diffuse light comes from the lights
//! and the environment, each by jittered samples; mirrors bounce. Pixels are averages over their
//! own square, whatever filter the settings ask for.

mod hierarchy;
mod light;
mod random;
mod render;
mod shape;
#[cfg(test)]
mod tests;

pub use render::{Render, Threading};
pub use shape::{Hit, What};

use crate::scene::{ConductorFresnel, InvalidSetting, Material, NamedMaterial, Scene};
use crate::world::{Camera, Environment, Frame, World};
use glam::DVec3;
use hierarchy::Node;
use light::Light;
use shape::{Ray, Sphere};

/// A scene as the paper's program holds it.
pub struct Tracer {
    spheres: Vec<Sphere>,
    hierarchy: Option<Node>,
    ground: Option<Ground>,
    lights: Vec<Light>,
    environment: Environment,
    camera: Camera,
    frame: Frame,
}

/// The points `p` with `normal . p = height`.
struct Ground {
    normal: DVec3,
    height: f64,
    surface: Surface,
}

/// What a surface does with light.
#[derive(Clone, Copy, Debug)]
struct Surface {
    /// Radiance.
    emitted: DVec3,
    /// Albedo of the diffuse part.
    diffuse: DVec3,
    /// Reflectance of the mirrored part.
    mirror: DVec3,
}

/// What the paper's tracer does not do.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Unsupported {
    /// A setting is out of its range.
    #[error(transparent)]
    Setting(#[from] InvalidSetting),
    /// It knows diffuse surfaces, mirrors of constant reflectance, mixtures of both, and emitters.
    #[error(
        "material `{0}` is none of the paper's; write lambertian, reflective, emitter or a smooth conductor of constant reflectance"
    )]
    Material(String),
    /// It is a Whitted tracer.
    #[error("the paper's tracer gathers light in one way; write integrator = \"whitted\"")]
    Integrator,
    /// Its roulette knows no throughput.
    #[error("the paper's roulette has one probability; write roulette = \"none\" or a number")]
    Roulette,
    /// Every bounce takes a part of the stack.
    #[error("the paper's tracer calls itself for every bounce; write depth = {max} or less", max = Tracer::MOST_BOUNCES)]
    Depth,
}

impl Tracer {
    /// The greatest depth that its recursion is sure to have the stack for.
    pub const MOST_BOUNCES: u32 = 1000;

    /// The scene, with the paper's tree over its spheres or, for brute force, without. `world` is
    /// built from the same scene; the camera and the environment come from it.
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
        let (camera, frame) = (world.camera, world.frame);
        Ok(Self { spheres, hierarchy, ground, lights, environment, camera, frame })
    }

    /// Builds the paper's tree anew, to be measured and thrown away.
    pub fn hierarchy(&self) -> impl Sized + use<> {
        Node::build(&self.spheres)
    }

    /// What a ray hits first, farther than the epsilon; `direction` has length 1.
    pub fn closest(&self, origin: DVec3, direction: DVec3) -> Option<Hit> {
        let ray = Ray { origin, direction };
        let mut nearest = Hit { what: What::Ground, t: f64::INFINITY };
        match &self.hierarchy {
            Some(node) => node.closest(&self.spheres, &ray, &mut nearest),
            None => {
                for (row, sphere) in self.spheres.iter().enumerate() {
                    sphere.closest(row, &ray, &mut nearest);
                }
            }
        }
        if let Some(t) = self.ground.as_ref().and_then(|ground| ground.hit(&ray, nearest.t)) {
            nearest = Hit { what: What::Ground, t };
        }
        nearest.t.is_finite().then_some(nearest)
    }

    /// Whether anything is farther than the epsilon and nearer than `t`.
    fn occluded(&self, ray: &Ray, t: f64) -> bool {
        let spheres = match &self.hierarchy {
            Some(node) => node.any(&self.spheres, ray, t),
            None => self.spheres.iter().any(|sphere| sphere.hit(ray, t).is_some()),
        };
        spheres || self.ground.as_ref().is_some_and(|ground| ground.hit(ray, t).is_some())
    }

    /// The surface of what was hit, and its outward unit normal at a point.
    fn surface(&self, what: What, point: DVec3) -> (&Surface, DVec3) {
        match (what, &self.ground) {
            (What::Sphere(row), _) => {
                let sphere = &self.spheres[row];
                (&sphere.surface, (point - sphere.center) / sphere.radius)
            }
            (What::Ground, Some(ground)) => (&ground.surface, ground.normal),
            (What::Ground, None) => (&Surface::BLACK, DVec3::Z),
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
