//! Samples of a world's lights.

use super::row::{LANES, LightLanes, ReceiverRow};
use super::sampler::LightSampler;
use super::{Disc, Light, LightSample, LightView, Receiver};
use crate::lanes::{F32x16, F64x8, set_bits};
use crate::sampling::LightDraw;
use crate::world::World;
use glam::Vec3;
use std::ops::Range;

/// Maximum number of lights that [`World::middle_light_row`] distinguishes.
pub(crate) const MAX_MIDDLES: usize = 4;

impl World {
    /// Returns light `index` as seen from a point on the surface of sphere `own`; `None` if the point
    /// is in or on the light: BSDF samples find such light.
    #[inline]
    pub fn light_view(&self, index: usize, origin: Vec3, own: u32) -> Option<LightView<'_>> {
        match self.lights.light(index) {
            Light::Emitter(i) if self.lights.emitters[i] == own => None,
            Light::Emitter(i) => {
                let row = self.lights.emitters[i] as usize;
                Disc::new(&self.spheres, row, self.lights.radiance[i], origin, self.lights.reach)
                    .map(LightView::Disc)
            }
            Light::Point(i) => self.lights.points[i].sample(origin).map(LightView::Delta),
            Light::Sun(i) => Some(LightView::Sun(&self.lights.suns[i])),
            Light::Sky(part) => {
                self.environment.picture().map(|picture| LightView::Sky(picture, part))
            }
        }
    }

    /// Samples light `index` once, like [`World::light_view`], but on a shorter path where there is one.
    #[inline(always)]
    pub fn sample_light(
        &self,
        index: usize,
        origin: Vec3,
        own: u32,
        u: [f32; 2],
    ) -> Option<LightSample> {
        match self.lights.light(index) {
            Light::Sun(i) => Some(self.lights.suns[i].sample(u)),
            _ => self.light_view(index, origin, own)?.sample(u),
        }
    }

    /// Samples one light for each of the receivers in `lanes`, from a set of random numbers for each:
    /// [`Lights::choose`](super::Lights::choose) and [`World::sample_light`]. Weights and densities include the probability of the
    /// choice.
    #[inline(never)]
    pub fn sample_light_row(
        &self,
        at: &ReceiverRow,
        numbers: [F32x16; 4],
        lanes: u32,
    ) -> LightLanes {
        let [u, v, ..] = numbers;
        if let Some(sun) = self.lights.single_sun() {
            return sun.sample_row([u, v], lanes);
        }
        let draw = || LightDraw::light_row(numbers);
        let (light, probability) = match &self.lights.sampler {
            LightSampler::None => return LightLanes::dark(),
            LightSampler::Single => {
                return self.sample_lights(at, &[0; LANES], lanes, [u, v]);
            }
            LightSampler::Tree(tree) => tree.choose_row(at, draw(), lanes),
            LightSampler::Table(_) => self.lights.choose_each(at, draw()),
        };
        let samples = self.sample_lights(at, &light, lanes, [u, v]);
        samples.chosen(F32x16::new(probability))
    }

    /// Returns the light that comes from the middle of a light, without chance: from light number `index` if there are
    /// at most [`MAX_MIDDLES`], apart from the environment's picture; otherwise from one that stands for a share of
    /// `1 / MAX_MIDDLES` of the light at each receiver.
    #[inline(never)]
    pub(crate) fn middle_light_row(
        &self,
        at: &ReceiverRow,
        index: usize,
        lanes: u32,
    ) -> LightLanes {
        let (count, middle) = (self.lights.count_without_sky(), [F32x16::splat(0.0); 2]);
        if count <= MAX_MIDDLES {
            return self.sample_lights(at, &[index as u32; LANES], lanes, middle);
        }
        let draw = [F64x8::splat((index as f64 + 0.5) / MAX_MIDDLES as f64); 2];
        let (light, probability) = match &self.lights.sampler {
            LightSampler::Tree(tree) => tree.choose_row(at, draw, lanes),
            _ => self.lights.choose_each(at, draw),
        };
        let others = set_bits(lanes).filter(|&lane| (light[lane] as usize) < count);
        let lanes = others.fold(0, |lanes, lane| lanes | 1 << lane);
        let samples = self.sample_lights(at, &light, lanes, middle);
        samples.chosen(F32x16::new(probability) * F32x16::splat(MAX_MIDDLES as f32))
    }

    /// Samples the lights that were chosen for the receivers in `lanes`.
    #[inline(never)]
    fn sample_lights(
        &self,
        at: &ReceiverRow,
        light: &[u32; LANES],
        lanes: u32,
        u: [F32x16; 2],
    ) -> LightLanes {
        let lanes_of = |kind: Range<usize>| {
            let chosen = set_bits(lanes).filter(|&lane| kind.contains(&(light[lane] as usize)));
            chosen.fold(0_u32, |lanes, lane| lanes | 1 << lane)
        };
        let emitters = self.lights.emitters.len();
        let discs = lanes_of(0..emitters);
        let points = lanes_of(emitters..emitters + self.lights.points.len());
        let mut row = LightLanes::dark();
        if discs != 0 {
            row = self.lights.sample_discs(&self.spheres, at, light, discs, u);
        }
        if points != 0 {
            row = row.or(&self.lights.sample_points(at, light, points, emitters));
        }
        let sky = self.lights.len() - self.lights.sky_parts;
        for part in 0..self.lights.sky_parts {
            let lanes = lanes_of(sky + part..sky + part + 1);
            if let Some(picture) = self.environment.picture().filter(|_| lanes != 0) {
                row = row.or(&LightLanes::sky(picture, part, u, lanes));
            }
        }
        let others = lanes_of(emitters + self.lights.points.len()..sky);
        if others == 0 {
            return row;
        }
        let [u, v] = u.map(F32x16::to_array);
        row.with(set_bits(others).filter_map(|lane| {
            let Receiver { point, own, .. } = at.receiver(lane);
            let light = light[lane] as usize;
            Some((lane, self.sample_light(light, point, own, [u[lane], v[lane]])?))
        }))
    }
}
