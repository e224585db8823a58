//! Samples of the light that balls cast, and how likely a ray that is found by chance is one.

use super::ball::{Angle, Ball};
use super::link::{Way, Ways, link};
use super::{Casters, Pair};
use crate::lanes::{Doubles, F32x16, F64x8, MAX_LANES, Mask, narrow, widen};
use crate::sampling::{Cone, Frames};
use crate::shade::fresnel;
use crate::vec3::Vec3;
use glam::DVec3;
use std::f64::consts::FRAC_1_PI;

/// Points on surfaces, and of which pairs they look for which ways.
pub(crate) struct Looking<'a> {
    pub(crate) point: Vec3<F32x16>,
    pub(crate) normal: Vec3<F32x16>,
    pub(crate) pair: [&'a Pair; MAX_LANES],
    pub(crate) way: [Way; MAX_LANES],
    /// How likely those were chosen.
    pub(crate) probability: F32x16,
}

/// Light that balls send to points, if nothing is in between.
pub(crate) struct Sent {
    /// Unit vectors from the points to the balls.
    pub(crate) toward: Vec3<F32x16>,
    /// Where rays leave the balls.
    pub(crate) exit: Vec3<F32x16>,
    /// Unit vectors from there to the lamps.
    pub(crate) onward: Vec3<F32x16>,
    /// Lengths of both.
    pub(crate) length: [[f64; MAX_LANES]; 2],
    /// Cosine of the angle of incidence.
    pub(crate) incidence: F32x16,
    /// What to multiply the lamp's radiance with, and the surface's response to light along the
    /// normal, and what smooth mirrors and colored glass take away.
    pub(crate) weight: F32x16,
    /// Lanes in which there is any.
    pub(crate) lanes: u32,
}

/// A ray from a surface that met a lamp by way of a ball.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Found {
    /// Where it started: the point, and the normal.
    pub(crate) start: [glam::Vec3; 2],
    /// Its direction there.
    pub(crate) toward: glam::Vec3,
    /// Density of that direction by solid angle.
    pub(crate) pdf: f32,
    pub(crate) ball: u32,
    pub(crate) through: bool,
    pub(crate) lamp: u32,
    /// Where it met the lamp, and in which direction.
    pub(crate) end: [glam::Vec3; 2],
}

/// What of half a row comes of its links.
struct Half {
    toward: Vec3<F64x8>,
    exit: Vec3<F64x8>,
    onward: Vec3<F64x8>,
    length: [F64x8; 2],
    incidence: F64x8,
    weight: F64x8,
    found: u32,
}

impl Looking<'_> {
    /// A sample for each, from two numbers in [0, 1).
    #[inline(always)]
    pub(crate) fn sample(&self, u: [F32x16; 2]) -> Sent {
        let column = |of: &dyn Fn(&Pair) -> f64| self.pair.map(of);
        let axis = |i: usize| F32x16::new(self.pair.map(|pair| pair.offset[i] as f32));
        let axes = Vec3::new(axis(0), axis(1), axis(2)).normalize();
        let cone = Cone::row(&self.pair.map(|pair| pair.cone));
        let seen = Frames::about(axes).to_world(cone.sample_each(u));
        let (seen, pdf) = (seen.halves(), widen(cone.pdfs() * self.probability));
        let (point, normal) = (self.point.halves(), self.normal.halves());
        let [low, high] = [0, 1].map(|half| {
            let part = |of: &dyn Fn(&Pair) -> f64| F64x8::from(&column(of)[8 * half..8 * half + 8]);
            let vector = |of: fn(&Pair) -> DVec3| {
                let axis = |i: usize| part(&move |pair| of(pair)[i]);
                Vec3::new(axis(0), axis(1), axis(2))
            };
            let receiver = point[half] - vector(|pair| pair.center);
            let lamp = (vector(|pair| pair.offset), part(&|pair| pair.lamp_radius));
            let ball = (part(&|pair| pair.radius), part(&|pair| pair.index));
            let ways = self.ways(half);
            follow((receiver, normal[half]), (ball, lamp), (seen[half], pdf[half]), ways)
        });
        let center = |i: usize| F32x16::new(self.pair.map(|pair| pair.center[i] as f32));
        let lengths = |i: usize| {
            let mut row = [0.0; MAX_LANES];
            row[..8].copy_from_slice(&low.length[i].to_array());
            row[8..].copy_from_slice(&high.length[i].to_array());
            row
        };
        Sent {
            toward: Vec3::narrow([low.toward, high.toward]).normalize(),
            exit: Vec3::narrow([low.exit, high.exit]) + Vec3::new(center(0), center(1), center(2)),
            onward: Vec3::narrow([low.onward, high.onward]).normalize(),
            length: [lengths(0), lengths(1)],
            incidence: narrow([low.incidence, high.incidence]),
            weight: narrow([low.weight, high.weight]),
            lanes: low.found | high.found << 8,
        }
    }

    #[inline(always)]
    fn ways(&self, half: usize) -> Ways<F64x8> {
        let mask = |is: fn(Way) -> bool| {
            let lane = |lane: usize| f64::from(u8::from(is(self.way[8 * half + lane])));
            F64x8::splat(0.0).lt(F64x8::new(std::array::from_fn(lane)))
        };
        Ways {
            through: mask(|way| way != Way::Reflected),
            crosses: mask(|way| way == Way::Crossed),
            inner: mask(|way| way == Way::Paraxial),
        }
    }
}

/// Follows rays from receivers, told from the center of a ball, to the points of lamps that are seen
/// from there in some directions.
#[inline(always)]
fn follow(
    (receiver, normal): (Vec3<F64x8>, Vec3<F64x8>),
    (ball, (offset, radius)): ((F64x8, F64x8), (Vec3<F64x8>, F64x8)),
    (seen, pdf): (Vec3<F64x8>, F64x8),
    ways: Ways<F64x8>,
) -> Half {
    let (zero, one) = (F64x8::splat(0.0), F64x8::splat(1.0));
    let seen = seen * seen.inverse_length();
    let middle = offset.dot_unfused(seen);
    let off = offset - seen * middle;
    let half2 = radius * radius - off.dot_unfused(off);
    let distance = middle - Doubles::select(zero.lt(half2), half2, zero).sqrt();
    let lamp = seen * distance;
    let outside = (ball.0 * ball.0).lt(receiver.dot_unfused(receiver));
    let link = link(ball, [receiver, lamp], ways);
    let outward = (lamp - offset) * (one / radius);
    let leaving = -outward.dot_unfused(seen);
    let arriving = -outward.dot_unfused(link.onward);
    let cosine = normal.dot_unfused(link.toward);
    let density = pdf * leaving * link.spread / (distance * distance * arriving);
    let kept = kept(link.at, ball.1, ways.through);
    let own = cosine * F64x8::splat(FRAC_1_PI) * kept;
    // By the power heuristic, and over the density.
    let weight = cosine * kept * density / (density * density + own * own);
    let there = zero.lt(leaving) & zero.lt(arriving) & zero.lt(cosine) & zero.lt(density);
    let found = link.found & outside & there & weight.lt(F64x8::splat(f64::from(f32::MAX)));
    Half {
        toward: link.toward,
        exit: link.exit,
        onward: link.onward,
        length: link.length,
        incidence: link.at.cosine,
        weight,
        found: found.bits(),
    }
}

/// Share of the light that goes that way, of what is not lost to colors.
#[inline(always)]
fn kept<D: Doubles>(at: Angle<D>, index: D, through: D::Mask) -> D {
    let (zero, one) = (D::splat(0.0), D::splat(1.0));
    let glass = zero.lt(index);
    let (reflected, _) = fresnel::dielectric(at.cosine, D::select(glass, index, D::splat(0.5)));
    let passing = (one - reflected) * (one - reflected);
    D::select(glass, D::select(through, passing, reflected), one)
}

impl Casters {
    /// The pair that a code stands for.
    #[inline(always)]
    pub(crate) fn pair(&self, code: u32) -> &Pair {
        &self.pairs[(code / Way::COUNT) as usize]
    }

    /// What a ray that has found a lamp by chance counts, beside samples that might have found it.
    pub(crate) fn weight(&self, found: &Found) -> f32 {
        let same = |pair: &Pair| pair.ball == found.ball && pair.lamp == found.lamp;
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
        let ball = Ball::new(pair.radius, distance, index);
        let turn = ball.turn(at);
        let way = if found.through { Way::through(&turn) } else { Way::Reflected };
        let outward = (end - pair.offset) / pair.lamp_radius;
        let leaving = -outward.dot(end) / distance[1];
        let arriving = -outward.dot(found.end[1].as_dvec3());
        let chance = self.probability(number, way, found.start) * pair.cone.pdf();
        let spread = ball.spread(at, &turn);
        let density = f64::from(chance) * leaving * spread / (distance[1] * distance[1] * arriving);
        let own = f64::from(found.pdf) * kept(at, pair.index, found.through);
        if leaving > 0.0 && arriving > 0.0 && density > 0.0 {
            let ratio = density / own;
            return (1.0 / (1.0 + ratio * ratio)) as f32;
        }
        1.0
    }
}
