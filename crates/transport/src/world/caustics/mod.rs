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
mod find;
mod isolation;
mod sample;
mod selection;
mod specular_sphere;
mod tree;

#[cfg(test)]
mod tests;

pub(crate) use connection::CausticPath;
pub(crate) use sample::{CausticHit, CausticQuery, CausticSample};

use super::lights::LightSampler;
use crate::sampling::Cone;
use crate::scene::Rgb;
use bounds::SampleBounds;
use estimate::EmitterView;
use glam::DVec3;
use tree::CasterTree;

/// Sine of an emitter's angular radius as seen from a sphere, from which on BSDF sampling finds the
/// caustic as well: at 0.37 variance times time is 0.91 of that of BSDF sampling, at 0.55 it is 1.12.
const MAX_EMITTER_SINE: f64 = 0.4;

/// Overlap, relative to the distance, up to which spheres touch but do not intersect.
const TOUCH_TOLERANCE: f64 = 1e-6;

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
    /// Center and radius; of a sun, those of a sphere that is far away.
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
