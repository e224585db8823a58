//! Caustics: specular spheres that focus the light of emitters on other surfaces.
//!
//! Every smooth mirror, coat and glass sphere that an emitter or a sun illuminates is a light of its own.
//! BSDF sampling finds this light with high variance. But the path is known in closed form
//! ([`specular_sphere`]), so a point of the emitter can be sampled, and then the direction toward it, as
//! for light samples. After "Manifold Next Event Estimation" (Hanika, Droske and Fascione, Computer
//! Graphics Forum 2015), with all solutions at hand instead of a walk to one of them. Which sphere is
//! sampled is chosen by a [tree], like that of lights. Light that both techniques find is weighted by the
//! power heuristic.

mod bounds;
mod connection;
mod device;
mod estimate;
mod isolation;
mod sample;
mod selection;
mod specular_sphere;
mod tree;

#[cfg(test)]
mod tests;

pub(crate) use connection::CausticPath;
pub(crate) use sample::{CausticHit, CausticQuery, CausticSample};

use super::World;
use super::lights::{LightSampler, Lights};
use crate::sampling::Cone;
use crate::scene::{LightChoice, Rgb};
use crate::shade::MaterialKind;
use bounds::SampleBounds;
use estimate::EmitterView;
use glam::DVec3;
use isolation::{Neighborhoods, TOUCH_TOLERANCE};
use rayon::prelude::*;
use tree::CasterTree;

/// Most specular spheres whose caustics are sampled: their tree takes time and memory.
const MAX_CASTERS: u64 = 1 << 16;

/// Sine of an emitter's angular radius as seen from a sphere, from which on BSDF sampling finds the
/// caustic as well: at 0.37 variance times time is 0.91 of that of BSDF sampling, at 0.55 it is 1.12.
const MAX_EMITTER_SINE: f64 = 0.4;

/// Distance of suns, in units of the scene's extent: light that leaves a sphere toward a sun is parallel
/// to that from its center, to the last bit.
const FAR: f64 = 1e30;

/// The specular spheres and the emitters whose caustics are sampled.
#[derive(Clone, Debug, Default)]
pub struct CausticCasters {
    casters: Vec<Caster>,
    /// Rows of the spheres with their indices in `casters`, by row.
    rows: Vec<[u32; 2]>,
    tree: CasterTree,
    emitters: Vec<CausticEmitter>,
    emitter_sampler: LightSampler,
    bounds: SampleBounds,
    /// True if paths do not choose at random between the light of emitters that a dielectric mirrors and
    /// what it lets pass.
    pub(crate) mirrored_light: bool,
}

/// A smooth specular sphere.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Caster {
    /// Row of the sphere.
    pub(crate) row: u32,
    pub(crate) center: DVec3,
    pub(crate) radius: f64,
    /// Index of refraction outside over that inside; 0 for a mirror.
    pub(crate) index: f64,
    /// True if light passes through.
    clear: bool,
    /// Luminance of the reflectance at normal incidence.
    normal_reflectance: f64,
}

/// An emissive sphere or a sun.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CausticEmitter {
    pub(crate) source: CausticSource,
    pub(crate) radiance: Rgb,
    /// Center and radius; of a sun, those of a sphere that is [`FAR`] away.
    center: DVec3,
    radius: f64,
    view: EmitterView,
}

/// The kind of an emitter, and its index.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum CausticSource {
    /// An emissive sphere, by row.
    Sphere(u32),
    /// A sun.
    Sun(usize),
}

/// A specular sphere and an emitter.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CasterPair {
    pub(crate) caster: Caster,
    pub(crate) emitter: CausticEmitter,
    /// Vector from the sphere's center to the emitter's.
    offset: DVec3,
    /// The emitter as seen from the sphere's center.
    cone: Cone,
}

impl CausticCasters {
    /// Finds the specular spheres and emitters of a world, which is complete otherwise.
    pub fn find(world: &World) -> Self {
        let emitters = emitters(world);
        let kinds = sampled_kinds(world);
        if emitters.is_empty() || kinds.is_empty() || !world.cut.is_empty() {
            return Self::default();
        }
        let casters = casters(world, kinds);
        if casters.is_empty() {
            return Self::default();
        }
        let bounds = world.lights.light_bounds(&world.spheres, &world.environment);
        let bounds: Vec<_> = emitter_indices(&world.lights).map(|index| bounds[index]).collect();
        let emitter_sampler = LightSampler::new(&bounds, LightChoice::Tree, world.lights.unit);
        let indices = casters.iter().zip(0..);
        let mut rows: Vec<_> = indices.map(|(caster, index)| [caster.row, index]).collect();
        rows.sort_unstable();
        let mut found = Self {
            tree: CasterTree::build(&casters),
            casters,
            rows,
            emitters,
            emitter_sampler,
            bounds: SampleBounds::default(),
            mirrored_light: world.lights.samples_mirrored_light(),
        };
        found.bounds = SampleBounds::build(&found, world);
        found
    }

    /// Returns whether there are no caustics to sample.
    pub fn is_empty(&self) -> bool {
        self.casters.is_empty()
    }

    /// Returns whether some sphere may cast caustics that are sampled: not if all emitters are suns that are too large.
    pub(super) fn has_pairs(&self) -> bool {
        // The directions of a sun from the spheres differ by less than rounding.
        let is_small = |emitter: &CausticEmitter| match emitter.source {
            CausticSource::Sphere(_) => true,
            CausticSource::Sun(_) => {
                emitter.radius < emitter.center.length() * MAX_EMITTER_SINE * (1.0 + 1e-9)
            }
        };
        !self.is_empty() && self.emitters.iter().any(is_small)
    }

    /// Returns the number of specular spheres.
    pub(crate) fn len(&self) -> usize {
        self.casters.len()
    }

    /// Returns the number of emitters.
    pub(crate) fn emitter_count(&self) -> usize {
        self.emitters.len()
    }

    /// Returns center and radius of a specular sphere.
    pub(crate) fn sphere(&self, caster: usize) -> (DVec3, f64) {
        (self.casters[caster].center, self.casters[caster].radius)
    }

    /// Returns the specular sphere in a row of the world's; `None` if it casts no caustics that are sampled.
    pub(crate) fn caster(&self, row: u32) -> Option<&Caster> {
        self.index_of(row).map(|index| &self.casters[index])
    }

    /// Returns whether a sphere casts caustics that are sampled.
    pub(crate) fn has(&self, row: u32) -> bool {
        self.index_of(row).is_some()
    }

    fn index_of(&self, row: u32) -> Option<usize> {
        let found = self.rows.binary_search_by_key(&row, |[row, _]| *row).ok()?;
        Some(self.rows[found][1] as usize)
    }

    /// Returns a pair; `None` if the emitter is large as seen from the sphere.
    #[inline]
    fn pair(&self, caster: usize, emitter: usize) -> Option<CasterPair> {
        let (caster, emitter) = (self.casters[caster], self.emitters[emitter]);
        let offset = emitter.center - caster.center;
        let distance = offset.length();
        let small = emitter.radius < distance * MAX_EMITTER_SINE;
        let apart = distance > (caster.radius + emitter.radius) * (1.0 + TOUCH_TOLERANCE);
        if !small || !apart {
            return None;
        }
        let cone = Cone::toward_sphere(distance * distance, emitter.radius)?;
        Some(CasterPair { caster, emitter, offset, cone })
    }
}

/// Returns the indices of emissive spheres and suns with discs among the lights.
fn emitter_indices(lights: &Lights) -> impl Iterator<Item = usize> {
    let first = lights.emitters.len() + lights.points.len();
    let suns = (0..lights.suns.len()).filter(|&sun| lights.suns[sun].disc.is_some());
    (0..lights.emitters.len()).chain(suns.map(move |sun| first + sun))
}

/// Returns the emitters, in the order of [`emitter_indices`].
fn emitters(world: &World) -> Vec<CausticEmitter> {
    let lights = &world.lights;
    let spheres = lights.emitters.iter().zip(&lights.radiance).map(|(&row, &radiance)| {
        let (center, radius) = world.spheres.exact(row as usize);
        let near = center.as_vec3();
        let view =
            EmitterView::Near { center: near, radius2: (radius as f32).powi(2), distance2: 0.0 };
        CausticEmitter { source: CausticSource::Sphere(row), radiance, center, radius, view }
    });
    let suns = lights.suns.iter().enumerate().filter_map(|(index, sun)| {
        let height = f64::from(sun.disc?.height());
        let sine2 = height * (2.0 - height);
        let far = FAR * lights.unit;
        let direction = sun.direction.as_dvec3().normalize();
        Some(CausticEmitter {
            source: CausticSource::Sun(index),
            radiance: sun.radiance,
            center: direction * far,
            radius: far * sine2.sqrt(),
            view: EmitterView::Far { direction: sun.direction, sine2: sine2 as f32 },
        })
    });
    spheres.chain(suns).collect()
}

/// Returns the kinds of specular materials whose caustics are sampled: all, if there are not too many
/// spheres of them, or those without coats, which reflect least.
fn sampled_kinds(world: &World) -> &'static [MaterialKind] {
    const KINDS: [MaterialKind; 3] =
        [MaterialKind::Conductor, MaterialKind::Dielectric, MaterialKind::Plastic];
    let count = |kinds: &&[MaterialKind]| {
        let each = kinds.iter().map(|&kind| world.features.spheres_of(kind));
        (1..=MAX_CASTERS).contains(&each.sum())
    };
    [&KINDS[..], &KINDS[..2]].into_iter().find(count).unwrap_or_default()
}

/// Returns the spheres of these kinds that are smooth mirrors, coated, or glass that stands alone, and not translucent.
fn casters(world: &World, kinds: &[MaterialKind]) -> Vec<Caster> {
    let rows = (0..world.spheres.len() as u32).into_par_iter();
    let smooth = |&row: &u32| {
        let id = world.appearance.material.row(row as usize);
        kinds.contains(&id.kind())
            && world.materials.optical_depth(id).is_opaque()
            && match id.kind() {
                MaterialKind::Conductor => world.materials.conductor[id.row()].roughness == 0.0,
                MaterialKind::Dielectric => world.materials.dielectric[id.row()].ior > 1.0,
                _ => world.materials.plastic[id.row()].ior > 1.0,
            }
    };
    let rows: Vec<u32> = rows.filter(smooth).collect();
    let mut rows = world.spheres.first_of_equals(rows.into_iter());
    rows.retain(smooth);
    if world.features.spheres_of(MaterialKind::Dielectric) > 0 {
        let neighborhoods = Neighborhoods::build(world);
        let stands_alone = |row: &u32| {
            world.material(*row).kind() != MaterialKind::Dielectric
                || neighborhoods.is_isolated(world, *row)
        };
        rows = rows.into_par_iter().filter(stands_alone).collect();
    }
    // In the user's order, the tree does not depend on that of the spheres.
    rows.sort_unstable_by_key(|&row| world.spheres.id[row as usize]);
    rows.into_iter().map(|row| caster(world, row)).collect()
}

fn caster(world: &World, row: u32) -> Caster {
    let (center, radius) = world.spheres.exact(row as usize);
    let id = world.material(row);
    let ior = match id.kind() {
        MaterialKind::Dielectric => Some(world.materials.dielectric[id.row()].ior),
        MaterialKind::Plastic => Some(world.materials.plastic[id.row()].ior),
        _ => None,
    };
    let index = ior.map_or(0.0, |ior| 1.0 / f64::from(ior));
    let normal_reflectance = if ior.is_some() {
        ((1.0 - index) / (1.0 + index)).powi(2)
    } else {
        let metal = world.materials.conductor[id.row()].color() * world.color(row);
        f64::from(super::environment::luminance(metal)).max(1e-3)
    };
    let clear = id.kind() == MaterialKind::Dielectric;
    Caster { row, center, radius, index, clear, normal_reflectance }
}
