//! Samples of caustics, and MIS weights of caustics that BSDF samples find.

use super::connection::{CausticPath, PathMasks, connect};
use super::specular_sphere::{Angle, SpecularSphere};
use super::{CasterPair, CausticCasters};
use crate::lanes::{Doubles, F32x16, F64x8, MAX_LANES, Mask, narrow, widen};
use crate::sampling::{Bases, Cone};
use crate::shade::fresnel;
use crate::vec3::Vec3;
use glam::DVec3;
use std::f64::consts::FRAC_1_PI;

/// A row of surface points, each with a pair and a path to sample.
pub(crate) struct CausticQuery<'a> {
    pub(crate) point: Vec3<F32x16>,
    pub(crate) normal: Vec3<F32x16>,
    pub(crate) pair: [&'a CasterPair; MAX_LANES],
    pub(crate) path: [CausticPath; MAX_LANES],
    /// Probabilities of the choices.
    pub(crate) probability: F32x16,
}

/// A row of caustic samples: light that arrives if both segments are unoccluded.
pub(crate) struct CausticSample {
    /// Unit vectors from the points to the spheres.
    pub(crate) toward: Vec3<F32x16>,
    /// Points where rays leave the spheres.
    pub(crate) exit: Vec3<F32x16>,
    /// Unit vectors from there to the emitters.
    pub(crate) toward_emitter: Vec3<F32x16>,
    /// Lengths of both segments.
    pub(crate) length: [[f64; MAX_LANES]; 2],
    /// Cosine of the angle of incidence.
    pub(crate) incidence: F32x16,
    /// Factor on the emitter's radiance, the surface's response to light along the normal, and the
    /// color of mirrors and glass; includes the MIS weight.
    pub(crate) weight: F32x16,
    /// Lanes that have a sample.
    pub(crate) lanes: u32,
}

/// A ray from a diffuse surface that hit an emitter by way of a specular sphere.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CausticHit {
    /// Origin: the point, and the normal.
    pub(crate) start: [glam::Vec3; 2],
    /// Direction at the origin.
    pub(crate) toward: glam::Vec3,
    /// Density of that direction by solid angle.
    pub(crate) pdf: f32,
    pub(crate) sphere: u32,
    pub(crate) through: bool,
    pub(crate) emitter: u32,
    /// Point of the emitter, and the direction of the ray there.
    pub(crate) end: [glam::Vec3; 2],
}

/// Samples of half a row, in double precision.
struct HalfRow {
    toward: Vec3<F64x8>,
    exit: Vec3<F64x8>,
    toward_emitter: Vec3<F64x8>,
    length: [F64x8; 2],
    incidence: F64x8,
    weight: F64x8,
    found: u32,
}

impl CausticQuery<'_> {
    /// Samples each path, from two random numbers in [0, 1).
    #[inline(always)]
    pub(crate) fn sample(&self, u: [F32x16; 2]) -> CausticSample {
        let column = |of: &dyn Fn(&CasterPair) -> f64| self.pair.map(of);
        let axis = |i: usize| F32x16::new(self.pair.map(|pair| pair.offset[i] as f32));
        let axes = Vec3::new(axis(0), axis(1), axis(2)).normalize();
        let cone = Cone::row(&self.pair.map(|pair| pair.cone));
        let seen = Bases::about(axes).to_world(cone.sample_each(u));
        let (seen, pdf) = (seen.halves(), widen(cone.pdfs() * self.probability));
        let (point, normal) = (self.point.halves(), self.normal.halves());
        let [low, high] = [0, 1].map(|half| {
            let part =
                |of: &dyn Fn(&CasterPair) -> f64| F64x8::from(&column(of)[8 * half..8 * half + 8]);
            let vector = |of: fn(&CasterPair) -> DVec3| {
                let axis = |i: usize| part(&move |pair| of(pair)[i]);
                Vec3::new(axis(0), axis(1), axis(2))
            };
            let receiver = point[half] - vector(|pair| pair.center);
            let emitter = (vector(|pair| pair.offset), part(&|pair| pair.emitter_radius));
            let sphere = (part(&|pair| pair.radius), part(&|pair| pair.index));
            let paths = self.paths(half);
            sample_half((receiver, normal[half]), (sphere, emitter), (seen[half], pdf[half]), paths)
        });
        let center = |i: usize| F32x16::new(self.pair.map(|pair| pair.center[i] as f32));
        let lengths = |i: usize| {
            let mut row = [0.0; MAX_LANES];
            row[..8].copy_from_slice(&low.length[i].to_array());
            row[8..].copy_from_slice(&high.length[i].to_array());
            row
        };
        CausticSample {
            toward: Vec3::narrow([low.toward, high.toward]).normalize(),
            exit: Vec3::narrow([low.exit, high.exit]) + Vec3::new(center(0), center(1), center(2)),
            toward_emitter: Vec3::narrow([low.toward_emitter, high.toward_emitter]).normalize(),
            length: [lengths(0), lengths(1)],
            incidence: narrow([low.incidence, high.incidence]),
            weight: narrow([low.weight, high.weight]),
            lanes: low.found | high.found << 8,
        }
    }

    #[inline(always)]
    fn paths(&self, half: usize) -> PathMasks<F64x8> {
        let mask = |is: fn(CausticPath) -> bool| {
            let lane = |lane: usize| f64::from(u8::from(is(self.path[8 * half + lane])));
            F64x8::splat(0.0).lt(F64x8::new(std::array::from_fn(lane)))
        };
        PathMasks {
            through: mask(|path| path != CausticPath::Reflected),
            crosses: mask(|path| path == CausticPath::Crossed),
            inner: mask(|path| path == CausticPath::Paraxial),
        }
    }
}

/// Connects receivers, relative to the center of a sphere, with the points of emitters that are visible
/// from the center in directions `seen`.
#[inline(always)]
fn sample_half(
    (receiver, normal): (Vec3<F64x8>, Vec3<F64x8>),
    (sphere, (offset, radius)): ((F64x8, F64x8), (Vec3<F64x8>, F64x8)),
    (seen, pdf): (Vec3<F64x8>, F64x8),
    paths: PathMasks<F64x8>,
) -> HalfRow {
    let (zero, one) = (F64x8::splat(0.0), F64x8::splat(1.0));
    let seen = seen * seen.inverse_length();
    let middle = offset.dot_unfused(seen);
    let off = offset - seen * middle;
    let half2 = radius * radius - off.dot_unfused(off);
    let distance = middle - Doubles::select(zero.lt(half2), half2, zero).sqrt();
    let emitter = seen * distance;
    let outside = (sphere.0 * sphere.0).lt(receiver.dot_unfused(receiver));
    let connection = connect(sphere, [receiver, emitter], paths);
    let outward = (emitter - offset) * (one / radius);
    let leaving = -outward.dot_unfused(seen);
    let arriving = -outward.dot_unfused(connection.toward_emitter);
    let cosine = normal.dot_unfused(connection.toward);
    let density = pdf * leaving * connection.spread / (distance * distance * arriving);
    let fresnel_factor = fresnel_factor(connection.at, sphere.1, paths.through);
    let own = cosine * F64x8::splat(FRAC_1_PI) * fresnel_factor;
    // The power heuristic, divided by the density.
    let weight = cosine * fresnel_factor * density / (density * density + own * own);
    let there = zero.lt(leaving) & zero.lt(arriving) & zero.lt(cosine) & zero.lt(density);
    let found = connection.found & outside & there & weight.lt(F64x8::splat(f64::from(f32::MAX)));
    HalfRow {
        toward: connection.toward,
        exit: connection.exit,
        toward_emitter: connection.toward_emitter,
        length: connection.length,
        incidence: connection.at.cosine,
        weight,
        found: found.bits(),
    }
}

/// Returns the fraction of light that reflection or refraction keeps, without colors.
#[inline(always)]
fn fresnel_factor<D: Doubles>(at: Angle<D>, index: D, through: D::Mask) -> D {
    let (zero, one) = (D::splat(0.0), D::splat(1.0));
    let glass = zero.lt(index);
    let (reflected, _) = fresnel::dielectric(at.cosine, D::select(glass, index, D::splat(0.5)));
    let passing = (one - reflected) * (one - reflected);
    D::select(glass, D::select(through, passing, reflected), one)
}

impl CausticCasters {
    /// Returns the pair of a code.
    #[inline(always)]
    pub(crate) fn pair(&self, code: u32) -> &CasterPair {
        &self.pairs[(code / CausticPath::COUNT) as usize]
    }

    /// Returns the MIS weight of an emitter that a BSDF sample has hit, beside caustic samples.
    pub(crate) fn weight(&self, found: &CausticHit) -> f32 {
        let same = |pair: &CasterPair| pair.sphere == found.sphere && pair.emitter == found.emitter;
        let Some(number) = self.pairs.iter().position(same) else { return 1.0 };
        let pair = &self.pairs[number];
        let [from, end] =
            [found.start[0], found.end[0]].map(|place| place.as_dvec3() - pair.center);
        let toward = found.toward.as_dvec3();
        let distance = [from.length(), end.length()];
        let sine = from.cross(toward).length() / (toward.length() * pair.radius);
        if distance[0] <= pair.radius || sine >= 1.0 {
            return 1.0;
        }
        let at = Angle { sine, cosine: ((1.0 - sine) * (1.0 + sine)).sqrt() };
        let index = if found.through { pair.index } else { 0.0 };
        let sphere = SpecularSphere::new(pair.radius, distance, index);
        let turn = sphere.turn(at);
        let path = if found.through { CausticPath::through(&turn) } else { CausticPath::Reflected };
        let outward = (end - pair.offset) / pair.emitter_radius;
        let leaving = -outward.dot(end) / distance[1];
        let arriving = -outward.dot(found.end[1].as_dvec3());
        let chance = self.probability(number, path, found.start) * pair.cone.pdf();
        let spread = sphere.spread(at, &turn);
        let density = f64::from(chance) * leaving * spread / (distance[1] * distance[1] * arriving);
        let own = f64::from(found.pdf) * fresnel_factor(at, pair.index, found.through);
        if leaving > 0.0 && arriving > 0.0 && density > 0.0 {
            let ratio = density / own;
            return (1.0 / (1.0 + ratio * ratio)) as f32;
        }
        1.0
    }
}
