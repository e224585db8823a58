//! Light samples in rows, sixteen at a time: each is a long chain of dependent arithmetic, and the
//! chains of a row overlap.

use super::sampler::LightSampler;
use super::sphere_light::distances;
use super::{Disc, LightSample, LightView, Lights, Receiver};
use crate::lanes::{F32x16, F64x8, Lanes, first_lanes, set_bits};
use crate::ray::MISS;
use crate::scene::Rgb;
use crate::vec3::Vec3;
use crate::world::{Picture, SkySamples};

/// Samples in a row.
pub const LANES: usize = 16;

/// A row of receivers; lane by lane a [`Receiver`].
#[derive(Clone, Copy, Debug)]
pub struct ReceiverRow {
    /// Points.
    pub point: Vec3<F32x16>,
    /// Unit normals, on the sides that are lit.
    pub normal: Vec3<F32x16>,
    /// Spheres whose surfaces the points are on.
    pub own: [u32; LANES],
}

/// A row of light samples; lane by lane a [`LightSample`].
#[derive(Clone, Copy, Debug)]
pub struct LightLanes {
    /// Unit vectors toward the lights.
    pub direction: Vec3<F32x16>,
    /// Distances of the lights.
    pub t: [f64; LANES],
    /// Rows of lights that are spheres, otherwise [`MISS`].
    pub target: [u32; LANES],
    /// Radiance over density, by channel.
    pub weight: Vec3<F32x16>,
    /// Densities by solid angle; 0 for lights without extent, and where they are not needed.
    pub pdf: F32x16,
    /// Lanes whose light is close.
    pub close: u32,
    /// Lanes that have a sample; the others have no light.
    pub lanes: u32,
}

impl ReceiverRow {
    /// Returns the receiver of a lane.
    #[inline(always)]
    pub fn receiver(&self, lane: usize) -> Receiver {
        let one = |v: Vec3<F32x16>| v.map(|row| row.to_array()[lane]).into();
        Receiver { point: one(self.point), normal: one(self.normal), own: self.own[lane] }
    }
}

impl LightLanes {
    /// Returns light from infinity, the same from everywhere.
    #[inline(always)]
    pub fn distant(direction: Vec3<F32x16>, weight: Rgb, lanes: u32) -> Self {
        Self {
            direction,
            t: [f64::INFINITY; LANES],
            target: [MISS; LANES],
            weight: every(weight),
            pdf: F32x16::splat(0.0),
            close: 0,
            lanes,
        }
    }

    /// Samples a part of a picture of the sky in `lanes`, from two random numbers in [0, 1) each. Lanes without
    /// light get no sample.
    #[inline(always)]
    pub(super) fn sky(picture: &Picture, part: usize, u: [F32x16; 2], lanes: u32) -> Self {
        let SkySamples { direction, radiance, pdf, lanes } = picture.sample(part, u, lanes);
        Self {
            weight: radiance.map(|channel| channel / pdf),
            pdf,
            close: lanes,
            ..Self::distant(direction, Rgb::ZERO, lanes)
        }
    }

    /// Returns a row without samples.
    #[inline(always)]
    pub(super) fn dark() -> Self {
        Self::distant(Vec3::splat(0.0, 0.0, 1.0), Rgb::ZERO, 0)
    }

    /// Returns the sample of a lane.
    #[inline]
    pub fn sample(&self, lane: usize) -> LightSample {
        let one = |v: Vec3<F32x16>| v.map(|row| row.to_array()[lane]).into();
        let pdf = self.pdf.to_array()[lane];
        LightSample {
            direction: one(self.direction),
            t: self.t[lane],
            target: self.target[lane],
            weight: one(self.weight),
            pdf: (pdf > 0.0).then_some(pdf),
            close: self.close >> lane & 1 == 1,
        }
    }

    /// Merges with other samples, which replace those in their lanes.
    #[inline(always)]
    pub(super) fn or(self, others: &Self) -> Self {
        if self.lanes == 0 {
            return *others;
        }
        let mask = <F32x16 as Lanes>::lanes(others.lanes);
        let mut row = Self {
            direction: Vec3::select_lanes(mask, others.direction, self.direction),
            weight: Vec3::select_lanes(mask, others.weight, self.weight),
            pdf: Lanes::select(mask, others.pdf, self.pdf),
            close: self.close & !others.lanes | others.close & others.lanes,
            lanes: self.lanes | others.lanes,
            ..self
        };
        for lane in set_bits(others.lanes) {
            (row.t[lane], row.target[lane]) = (others.t[lane], others.target[lane]);
        }
        row
    }

    /// Writes samples to lanes.
    #[inline(always)]
    pub(super) fn with(mut self, samples: impl Iterator<Item = (usize, LightSample)>) -> Self {
        for (lane, sample) in samples {
            (self.t[lane], self.target[lane]) = (sample.t, sample.target);
            set_lane(&mut self.direction, lane, sample.direction);
            set_lane(&mut self.weight, lane, sample.weight);
            self.pdf.as_mut_array()[lane] = sample.pdf.unwrap_or(0.0);
            self.close |= u32::from(sample.close) << lane;
            self.lanes |= 1 << lane;
        }
        self
    }

    /// Divides weights, and multiplies densities, by the probabilities of the choices.
    #[inline(always)]
    pub(super) fn chosen(self, probability: F32x16) -> Self {
        let weight = self.weight.map(|channel| channel / probability);
        Self { weight, pdf: self.pdf * probability, ..self }
    }
}

#[inline(always)]
fn set_lane(row: &mut Vec3<F32x16>, lane: usize, value: glam::Vec3) {
    row.x.as_mut_array()[lane] = value.x;
    row.y.as_mut_array()[lane] = value.y;
    row.z.as_mut_array()[lane] = value.z;
}

#[inline(always)]
fn every(color: Rgb) -> Vec3<F32x16> {
    Vec3::splat(color.x, color.y, color.z)
}

impl Lights {
    /// Returns the probability with which a part of the environment's picture is sampled, for each of
    /// the receivers in `lanes`.
    #[inline(never)]
    pub fn sky_probabilities(
        &self,
        at: &ReceiverRow,
        mut part: [u32; LANES],
        lanes: u32,
    ) -> [f32; LANES] {
        let first = (self.len() - self.sky_parts) as u32;
        for part in &mut part {
            *part += first;
        }
        if let LightSampler::Tree(tree) = &self.sampler {
            return tree.probability_row(at, &part, lanes);
        }
        // The same for all receivers.
        let mut each = [0.0; LANES];
        for lane in set_bits(lanes) {
            each[lane] = self.probability(&at.receiver(lane), part[lane] as usize);
        }
        each
    }

    pub(super) fn choose_each(
        &self,
        at: &ReceiverRow,
        draw: [F64x8; 2],
    ) -> ([u32; LANES], [f32; LANES]) {
        let draw = draw.map(F64x8::to_array);
        let chosen: [(u32, f32); LANES] = std::array::from_fn(|lane| {
            let chosen = self.choose(&at.receiver(lane), draw[lane / 8][lane % 8]);
            chosen.map_or((0, 1.0), |(light, probability)| (light as u32, probability))
        });
        (chosen.map(|(light, _)| light), chosen.map(|(_, probability)| probability))
    }
}

impl LightView<'_> {
    /// Does what [`LightView::sample`] does for the first `count` lanes of a row of random numbers.
    #[inline(always)]
    pub fn sample_row(&self, u: [F32x16; 2], count: usize) -> LightLanes {
        let lanes = first_lanes(count);
        match self {
            Self::Disc(disc) => disc.sample_row(u, lanes),
            Self::Sun(sun) => sun.sample_row(u, lanes),
            Self::Sky(picture, part) => LightLanes::sky(picture, *part, u, lanes),
            Self::Delta(sample) => LightLanes::dark().with((0..count).map(|lane| (lane, *sample))),
        }
    }
}

impl Disc {
    #[inline(always)]
    fn sample_row(&self, u: [F32x16; 2], lanes: u32) -> LightLanes {
        let direction = self.basis.row_to_world(self.cone.sample_row(u));
        let splat = |v: glam::DVec3| [Vec3::from(v).map(F64x8::splat); 2];
        let origin = Vec3::from(self.origin).map(F32x16::splat);
        let (center, radius) = (splat(self.center), [F64x8::splat(self.radius); 2]);
        LightLanes {
            direction,
            t: distances(origin, direction, &center, &radius, lanes),
            target: [self.row; LANES],
            weight: every(self.weight),
            pdf: F32x16::splat(self.cone.pdf()),
            close: if self.close { lanes } else { 0 },
            lanes,
        }
    }
}

#[cfg(test)]
mod tests;
