//! Samples of caustics, and MIS weights of caustics that BSDF samples find.

use super::connection::{CausticPath, PathMasks, connect};
use super::specular_sphere::{Angle, SpecularSphere};
use super::{CasterPair, CausticCasters, CausticSource};
use crate::lanes::{Doubles, F32x16, F64x8, MAX_LANES, Mask, narrow, set_bits, widen};
use crate::ray::MISS;
use crate::sampling::{Bases, Cone};
use crate::scene::Rgb;
use crate::shade::fresnel;
use crate::vec3::Vec3;
use crate::world::{Receiver, SeenLight};
use glam::DVec3;

/// A row of surface points, each with a caustic to sample.
pub(crate) struct CausticQuery {
    pub(crate) point: Vec3<F32x16>,
    pub(crate) pairs: CasterPairRow,
    pub(crate) path: [CausticPath; MAX_LANES],
    /// Expected numbers of samples of the caustics.
    pub(crate) rate: F32x16,
}

/// A row of specular spheres and emitters, in columns.
#[derive(Clone)]
pub(crate) struct CasterPairRow {
    center: [[f64; MAX_LANES]; 3],
    radius: [f64; MAX_LANES],
    index: [f64; MAX_LANES],
    offset: [[f64; MAX_LANES]; 3],
    emitter_radius: [f64; MAX_LANES],
    /// Directions from the spheres' centers to the emitters.
    axis: [[f32; MAX_LANES]; 3],
    cone: [Cone; MAX_LANES],
    /// Rows of the spheres.
    pub(crate) sphere: [u32; MAX_LANES],
    /// Rows of emissive spheres; [`MISS`] for suns.
    pub(crate) emitter: [u32; MAX_LANES],
    /// Radiance of the emitters.
    pub(crate) radiance: [Rgb; MAX_LANES],
    /// Lanes of the suns.
    suns: u32,
    /// Lanes that have a pair; the others have any numbers that are valid.
    pub(crate) lanes: u32,
}

impl CasterPairRow {
    fn new() -> Self {
        let (zero, one) = ([0.0; MAX_LANES], [1.0; MAX_LANES]);
        Self {
            center: [zero; 3],
            radius: one,
            index: zero,
            offset: [[4.0; MAX_LANES], zero, zero],
            emitter_radius: one,
            axis: [[1.0; MAX_LANES], [0.0; MAX_LANES], [0.0; MAX_LANES]],
            cone: [Cone::from_half_angle(0.1); MAX_LANES],
            sphere: [MISS; MAX_LANES],
            emitter: [MISS; MAX_LANES],
            radiance: [Rgb::ZERO; MAX_LANES],
            suns: 0,
            lanes: 0,
        }
    }

    fn set(&mut self, lane: usize, pair: &CasterPair) {
        let axis = pair.offset.normalize();
        for i in 0..3 {
            self.center[i][lane] = pair.caster.center[i];
            self.offset[i][lane] = pair.offset[i];
            self.axis[i][lane] = axis[i] as f32;
        }
        self.radius[lane] = pair.caster.radius;
        self.index[lane] = pair.caster.index;
        self.emitter_radius[lane] = pair.emitter.radius;
        self.cone[lane] = pair.cone;
        self.sphere[lane] = pair.caster.row;
        self.radiance[lane] = pair.emitter.radiance;
        match pair.emitter.source {
            CausticSource::Sphere(row) => self.emitter[lane] = row,
            CausticSource::Sun(_) => self.suns |= 1 << lane,
        }
        self.lanes |= 1 << lane;
    }
}

/// A row of caustic samples: light that arrives if both segments are unoccluded.
pub(crate) struct CausticSample {
    /// Unit vectors from the points to the spheres.
    pub(crate) toward: Vec3<F32x16>,
    /// Points where rays leave the spheres.
    pub(crate) exit: Vec3<F32x16>,
    /// Unit vectors from there to the emitters.
    pub(crate) toward_emitter: Vec3<F32x16>,
    /// Lengths of both segments; infinite toward a sun.
    pub(crate) length: [[f64; MAX_LANES]; 2],
    /// Cosine of the angle of incidence.
    pub(crate) incidence: F32x16,
    /// Fraction of light that reflection or refraction keeps, without colors.
    pub(crate) kept: F32x16,
    /// Lanes that are reflected.
    pub(crate) reflected: u32,
    /// Density of the samples at the points, by solid angle.
    pub(crate) pdf: F32x16,
    /// Lanes that have a sample.
    pub(crate) lanes: u32,
}

/// A ray from a surface that reached an emitter by way of a specular sphere.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CausticHit {
    /// Origin.
    pub(crate) start: Receiver,
    /// Direction at the origin.
    pub(crate) toward: glam::Vec3,
    /// Density of that direction by solid angle.
    pub(crate) pdf: f32,
    pub(crate) sphere: u32,
    pub(crate) through: bool,
    pub(crate) emitter: CausticSource,
    /// Point of an emissive sphere; of a sun, the direction toward it.
    pub(crate) end: glam::Vec3,
    /// Direction of the ray there.
    pub(crate) toward_emitter: glam::Vec3,
    /// Expected number of samples of this caustic; `None` for that of a surface.
    pub(crate) rate: Option<f64>,
}

/// Half a row of caustics to sample, in double precision; places are relative to the centers of the
/// specular spheres.
struct HalfQuery {
    receiver: Vec3<F64x8>,
    /// Radius of the specular sphere.
    radius: F64x8,
    /// Its index of refraction outside over that inside; 0 for a mirror.
    index: F64x8,
    /// Center of the emitter.
    offset: Vec3<F64x8>,
    emitter_radius: F64x8,
    /// Direction in which a point of the emitter is seen.
    seen: Vec3<F64x8>,
    /// Density of that direction.
    pdf: F64x8,
    paths: PathMasks<F64x8>,
}

/// Samples of half a row, in double precision.
struct HalfRow {
    toward: Vec3<F64x8>,
    exit: Vec3<F64x8>,
    toward_emitter: Vec3<F64x8>,
    length: [F64x8; 2],
    incidence: F64x8,
    kept: F64x8,
    pdf: F64x8,
    found: u32,
}

impl CausticQuery {
    /// Samples each path, from two random numbers in [0, 1).
    #[inline(never)]
    pub(crate) fn sample(&self, u: [F32x16; 2]) -> CausticSample {
        let pairs = &self.pairs;
        let [x, y, z] = pairs.axis.map(F32x16::new);
        let cone = Cone::row(&pairs.cone);
        let seen = Bases::about(Vec3::new(x, y, z)).to_world(cone.sample_each(u));
        let (seen, pdf) = (seen.halves(), widen(cone.pdfs() * self.rate));
        let point = self.point.halves();
        let [low, high] = [0, 1].map(|half| {
            let part = |column: &[f64; MAX_LANES]| F64x8::from(&column[8 * half..8 * half + 8]);
            let vector = |[x, y, z]: &[[f64; MAX_LANES]; 3]| Vec3::new(part(x), part(y), part(z));
            sample_half(&HalfQuery {
                receiver: point[half] - vector(&pairs.center),
                radius: part(&pairs.radius),
                index: part(&pairs.index),
                offset: vector(&pairs.offset),
                emitter_radius: part(&pairs.emitter_radius),
                seen: seen[half],
                pdf: pdf[half],
                paths: self.paths(half),
            })
        });
        let center = |i: usize| F32x16::new(pairs.center[i].map(|x| x as f32));
        let lengths = |i: usize| {
            let mut row = [0.0; MAX_LANES];
            row[..8].copy_from_slice(&low.length[i].to_array());
            row[8..].copy_from_slice(&high.length[i].to_array());
            row
        };
        let mut length = [lengths(0), lengths(1)];
        set_bits(pairs.suns).for_each(|lane| length[1][lane] = f64::INFINITY);
        CausticSample {
            toward: Vec3::narrow([low.toward, high.toward]).normalize(),
            exit: Vec3::narrow([low.exit, high.exit]) + Vec3::new(center(0), center(1), center(2)),
            toward_emitter: Vec3::narrow([low.toward_emitter, high.toward_emitter]).normalize(),
            length,
            incidence: narrow([low.incidence, high.incidence]),
            kept: narrow([low.kept, high.kept]),
            reflected: (0..MAX_LANES)
                .filter(|&lane| self.path[lane] == CausticPath::Reflected)
                .fold(0, |lanes, lane| lanes | 1 << lane),
            pdf: narrow([low.pdf, high.pdf]),
            lanes: pairs.lanes & (low.found | high.found << 8),
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

/// Connects receivers with the points of emitters that are visible from the centers of the specular
/// spheres.
#[inline(always)]
fn sample_half(query: &HalfQuery) -> HalfRow {
    let HalfQuery { receiver, radius, index, offset, emitter_radius, seen, pdf, paths } = *query;
    let (zero, one) = (F64x8::splat(0.0), F64x8::splat(1.0));
    let seen = seen * seen.inverse_length();
    let middle = offset.dot_unfused(seen);
    let off = offset - seen * middle;
    let half2 = emitter_radius * emitter_radius - off.dot_unfused(off);
    let distance = middle - Doubles::select(zero.lt(half2), half2, zero).sqrt();
    let emitter = seen * distance;
    let outside = (radius * radius).lt(receiver.dot_unfused(receiver));
    let connection = connect(radius, index, [receiver, emitter], paths);
    let outward = (emitter - offset) * (one / emitter_radius);
    let leaving = -outward.dot_unfused(seen);
    let arriving = -outward.dot_unfused(connection.toward_emitter);
    let pdf = pdf * leaving * connection.spread / arriving;
    let there = zero.lt(leaving) & zero.lt(arriving) & zero.lt(pdf);
    let found = connection.found & outside & there;
    HalfRow {
        toward: connection.toward,
        exit: connection.exit,
        toward_emitter: connection.toward_emitter,
        length: connection.length,
        incidence: connection.at.cosine,
        kept: fresnel_factor(connection.at, index, paths.through),
        pdf,
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
    /// Returns the specular spheres and emitters of the choices in `lanes`, without those whose emitter is
    /// large as seen from the sphere.
    pub(crate) fn pair_row(
        &self,
        code: &[u32; MAX_LANES],
        emitter: &[u32; MAX_LANES],
        lanes: u32,
    ) -> CasterPairRow {
        let mut row = CasterPairRow::new();
        for lane in set_bits(lanes) {
            let caster = (code[lane] / CausticPath::COUNT) as usize;
            if let Some(pair) = self.pair(caster, emitter[lane] as usize) {
                row.set(lane, &pair);
            }
        }
        row
    }

    /// Returns a query for samples of one emitter by one sphere and path, from points in `lanes`;
    /// `None` if the emitter is large as seen from the sphere.
    pub(crate) fn query(
        &self,
        sphere: u32,
        source: CausticSource,
        path: CausticPath,
        point: Vec3<F32x16>,
        lanes: u32,
    ) -> Option<CausticQuery> {
        let emitter = self.emitters.iter().position(|emitter| emitter.source == source)?;
        let pair = self.pair(self.index_of(sphere)?, emitter)?;
        let mut pairs = CasterPairRow::new();
        set_bits(lanes).for_each(|lane| pairs.set(lane, &pair));
        Some(CausticQuery { point, pairs, path: [path; MAX_LANES], rate: F32x16::splat(1.0) })
    }

    /// Returns an emitter as a camera sees it in a specular sphere, and points of the sphere in which it is
    /// seen; `None` if it is not seen in this way, or is large as seen from the sphere.
    pub(crate) fn image_in(
        &self,
        caster: usize,
        emitter: usize,
        path: CausticPath,
        eye: DVec3,
    ) -> Option<(SeenLight, Vec<DVec3>)> {
        let through = path != CausticPath::Reflected;
        let (caster, source) = (&self.casters[caster], self.emitters[emitter].source);
        if through && !caster.clear {
            return None;
        }
        let point = eye.as_vec3();
        let point = Vec3::splat(point.x, point.y, point.z);
        let query = self.query(caster.row, source, path, point, (1 << MAX_LANES) - 1)?;
        // A grid over the emitter, up to its rim.
        let place = |step: usize| (step as f32 + 0.05) / 3.11;
        let [u, v] = [std::array::from_fn(|i| place(i % 4)), std::array::from_fn(|i| place(i / 4))];
        let sample = query.sample([F32x16::new(u), F32x16::new(v)]);
        let hit = |lane: usize| {
            let toward: glam::Vec3 = sample.toward.map(|row| row.to_array()[lane]).into();
            eye + toward.as_dvec3() * sample.length[0][lane]
        };
        let light = SeenLight { source, sphere: caster.row, through };
        (sample.lanes != 0).then(|| (light, set_bits(sample.lanes).map(hit).collect()))
    }

    /// Returns the probability with which a path that meets a sphere of a pair goes on to the emitter: 1
    /// for mirrored light that is sampled.
    fn own_probability(&self, at: Angle<f64>, pair: &CasterPair, through: bool) -> f64 {
        if self.mirrored_light && !through {
            1.0
        } else {
            fresnel_factor(at, pair.caster.index, through)
        }
    }

    /// Returns the MIS weight of an emitter that a BSDF sample has hit, beside caustic samples.
    pub(crate) fn weight(&self, found: &CausticHit) -> f32 {
        let emitter = self.emitters.iter().position(|emitter| emitter.source == found.emitter);
        let Some((caster, emitter)) = self.index_of(found.sphere).zip(emitter) else { return 1.0 };
        let Some(pair) = self.pair(caster, emitter) else { return 1.0 };
        let from = found.start.point.as_dvec3() - pair.caster.center;
        let end = match found.emitter {
            CausticSource::Sphere(_) => found.end.as_dvec3() - pair.caster.center,
            CausticSource::Sun(_) => pair.point_toward(found.end.as_dvec3()),
        };
        let toward = found.toward.as_dvec3();
        let distance = [from.length(), end.length()];
        let sine = from.cross(toward).length() / (toward.length() * pair.caster.radius);
        if distance[0] <= pair.caster.radius || sine >= 1.0 {
            return 1.0;
        }
        let at = Angle { sine, cosine: ((1.0 - sine) * (1.0 + sine)).sqrt() };
        let index = if found.through { pair.caster.index } else { 0.0 };
        let sphere = SpecularSphere::new(pair.caster.radius, distance, index);
        let turn = sphere.turn(at);
        let path = if found.through { CausticPath::through(&turn) } else { CausticPath::Reflected };
        let outward = (end - pair.offset) / pair.emitter.radius;
        let leaving = -outward.dot(end) / distance[1];
        let arriving = -outward.dot(found.toward_emitter.as_dvec3());
        let of_surface = || self.rate(&found.start, emitter, caster, path);
        let rate = found.rate.unwrap_or_else(of_surface);
        let cone = f64::from(pair.cone.pdf());
        let density = rate * cone * leaving * sphere.spread(at, &turn) / arriving;
        let own = f64::from(found.pdf) * self.own_probability(at, &pair, found.through);
        if leaving > 0.0 && arriving > 0.0 && density > 0.0 {
            let ratio = density / own;
            return (1.0 / (1.0 + ratio * ratio)) as f32;
        }
        1.0
    }
}

impl CasterPair {
    /// Returns the point of a sun's sphere in a direction, relative to the center of the specular sphere.
    fn point_toward(&self, direction: DVec3) -> DVec3 {
        let direction = direction.normalize();
        let middle = self.offset.dot(direction);
        let off2 = (self.offset - direction * middle).length_squared();
        direction * (middle - (self.emitter.radius.powi(2) - off2).max(0.0).sqrt())
    }
}
