//! Caustics: specular spheres that focus the light of emitters on diffuse surfaces.
//!
//! The spheres are smooth mirrors, coats and glass; there must be few of them, and few emitters. A
//! diffuse surface's BSDF sampling finds this light with high variance. But the path is known in closed
//! form ([`specular_sphere`]), so a point of the emitter can be sampled, and then the direction toward
//! it, as for light samples. After "Manifold Next Event Estimation" (Hanika, Droske and Fascione,
//! Computer Graphics Forum 2015), with all solutions at hand instead of a walk to one of them. Light
//! that both techniques find is weighted by the power heuristic.

mod connection;
mod sample;
mod selection;
mod specular_sphere;

#[cfg(test)]
mod tests;

pub(crate) use connection::CausticPath;
pub(crate) use sample::{CausticHit, CausticQuery, CausticSample};

use super::World;
use super::environment::luminance;
use crate::sampling::Cone;
use crate::scene::Rgb;
use crate::shade::MaterialKind;
use glam::DVec3;
use rayon::prelude::*;
use selection::ContributionEstimate;

/// Most specular spheres, and most emitters, for which caustics are sampled: each pair costs time at
/// every surface.
const MAX_COUNT: usize = 4;

/// Sine of an emitter's angular radius as seen from a sphere, from which on BSDF sampling finds the
/// caustic as well: at 0.37 variance times time is 0.91 of that of BSDF sampling, at 0.55 it is 1.12.
const MAX_EMITTER_SINE: f64 = 0.4;

/// Overlap, relative to the distance, up to which spheres touch but do not intersect.
const TOUCH_TOLERANCE: f64 = 1e-6;

/// All pairs of specular sphere and emitter whose caustics are sampled.
#[derive(Clone, Debug, Default)]
pub struct CausticCasters {
    pairs: Vec<CasterPair>,
}

/// A specular sphere and an emitter.
#[derive(Clone, Debug)]
pub(crate) struct CasterPair {
    /// Rows of the spheres.
    pub(crate) sphere: u32,
    pub(crate) emitter: u32,
    center: DVec3,
    radius: f64,
    /// Index of refraction outside over that inside; 0 for a mirror.
    index: f64,
    /// True if light passes through.
    clear: bool,
    /// Vector from the sphere's center to the emitter's.
    offset: DVec3,
    emitter_radius: f64,
    /// The emitter as seen from the sphere's center.
    cone: Cone,
    pub(crate) radiance: Rgb,
    estimate: ContributionEstimate,
}

impl CasterPair {
    /// Returns the paths of light from the emitter by the sphere.
    #[inline(always)]
    fn paths(&self) -> &'static [CausticPath] {
        if self.clear { &CausticPath::ALL } else { &CausticPath::ALL[..1] }
    }
}

impl CausticCasters {
    /// Finds the pairs of a world, which is complete otherwise.
    pub(super) fn find(world: &World) -> Self {
        let emitters = &world.lights.emitters;
        let kinds = few_kinds(world);
        let few = (1..=MAX_COUNT).contains(&emitters.len()) && !kinds.is_empty();
        if !few || !world.cut.is_empty() || world.features.nested_glass {
            return Self::default();
        }
        let emitters: Vec<u32> =
            emitters.iter().copied().filter(|&row| is_isolated(world, row)).collect();
        let rows = (0..world.spheres.len() as u32).into_par_iter();
        let mut spheres: Vec<u32> = rows.filter(|&row| is_caster(world, kinds, row)).collect();
        spheres.sort_unstable_by_key(|&row| world.spheres.id[row as usize]);
        let pairs = spheres.iter().map(|&sphere| pairs(world, sphere, &emitters));
        Self { pairs: distribute_shares(pairs.collect()) }
    }

    /// Returns whether there are no pairs.
    pub fn is_empty(&self) -> bool {
        self.pairs.is_empty()
    }

    /// Returns whether a sphere is the specular sphere of a pair.
    pub(crate) fn has(&self, row: u32) -> bool {
        self.pairs.iter().any(|pair| pair.sphere == row)
    }
}

/// Returns the kinds of specular materials, if there are few spheres of them in total; without coats,
/// which reflect least, if that makes them few.
fn few_kinds(world: &World) -> &'static [MaterialKind] {
    const KINDS: [MaterialKind; 3] =
        [MaterialKind::Conductor, MaterialKind::Dielectric, MaterialKind::Plastic];
    let count = |kinds: &&[MaterialKind]| {
        let each = kinds.iter().map(|&kind| world.features.spheres_by_kind[kind as usize]);
        (1..=MAX_COUNT as u64).contains(&each.sum())
    };
    [&KINDS[..], &KINDS[..2]].into_iter().find(count).unwrap_or_default()
}

/// Returns whether a sphere is of these kinds and a smooth mirror, coated, or glass with nothing
/// inside.
fn is_caster(world: &World, kinds: &[MaterialKind], row: u32) -> bool {
    let id = world.appearance.material.row(row as usize);
    let specular = match id.kind() {
        MaterialKind::Conductor => world.materials.conductor[id.row()].roughness == 0.0,
        MaterialKind::Dielectric => world.materials.dielectric[id.row()].ior > 1.0,
        MaterialKind::Plastic => world.materials.plastic[id.row()].ior > 1.0,
        _ => false,
    };
    specular
        && kinds.contains(&id.kind())
        && (id.kind() != MaterialKind::Dielectric || is_isolated(world, row))
}

/// Returns whether neither another sphere nor the ground intersects a sphere's surface.
fn is_isolated(world: &World, row: u32) -> bool {
    let (center, radius) = world.spheres.exact(row as usize);
    let cuts = |other: usize| {
        let (at, reach) = world.spheres.exact(other);
        let distance = center.distance(at);
        other != row as usize
            && distance < (radius + reach) * (1.0 - TOUCH_TOLERANCE)
            && distance + radius > reach * (1.0 - TOUCH_TOLERANCE)
    };
    let grounded = world.ground.as_ref().is_some_and(|ground| {
        (ground.normal.dot(center) - ground.height).abs() < radius * (1.0 - TOUCH_TOLERANCE)
    });
    !grounded && !(0..world.spheres.len()).into_par_iter().any(cuts)
}

/// Returns the pairs of a specular sphere with all small emitters.
fn pairs(world: &World, sphere: u32, emitters: &[u32]) -> Vec<CasterPair> {
    let (center, radius) = world.spheres.exact(sphere as usize);
    let material = world.material(sphere);
    let index = match material.kind() {
        MaterialKind::Dielectric => 1.0 / f64::from(world.materials.dielectric[material.row()].ior),
        MaterialKind::Plastic => 1.0 / f64::from(world.materials.plastic[material.row()].ior),
        _ => 0.0,
    };
    let clear = material.kind() == MaterialKind::Dielectric;
    let pair = |&emitter: &u32| {
        let (at, emitter_radius) = world.spheres.exact(emitter as usize);
        let offset = at - center;
        let small = emitter_radius < offset.length() * MAX_EMITTER_SINE;
        let apart = offset.length() > (radius + emitter_radius) * (1.0 + TOUCH_TOLERANCE);
        let cone = Cone::toward_sphere(offset.length_squared(), emitter_radius)?;
        let radiance = world.materials.emitter[world.material(emitter).row()].radiance;
        let estimate = ContributionEstimate::default();
        (small && apart).then_some(CasterPair {
            sphere,
            emitter,
            center,
            radius,
            index,
            clear,
            offset,
            emitter_radius,
            cone,
            radiance,
            estimate,
        })
    };
    emitters.iter().filter_map(pair).collect()
}

/// Sets each pair's share among the pairs of its sphere, by the light that reaches the sphere from its
/// emitter.
fn distribute_shares(spheres: Vec<Vec<CasterPair>>) -> Vec<CasterPair> {
    let paths = |pairs: &Vec<CasterPair>| pairs.first().map_or(0, |pair| pair.paths().len());
    let paths: usize = spheres.iter().map(paths).sum();
    let light = |pair: &CasterPair| f64::from(luminance(pair.radiance) / pair.cone.pdf());
    let share = |pairs: Vec<CasterPair>| {
        let all: f64 = pairs.iter().map(light).sum();
        pairs.into_iter().map(move |pair| {
            let share = light(&pair) / all;
            pair.with_estimate(share, paths)
        })
    };
    spheres.into_iter().flat_map(share).collect()
}
