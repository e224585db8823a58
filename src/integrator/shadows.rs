//! Shadow rays that wait to be traced together.

use crate::lanes::{F32x16, set_bits};
use crate::ray::{Hits, MISS, Rays};
use crate::scene::Rgb;
use crate::world::{LightRow, LightSample, ROW};
use glam::Vec3;

/// Shadow rays that are traced together.
pub const SHADOWS: usize = 4096;

/// Shadow rays and what they carry.
pub struct Shadows {
    /// From the surface toward the light.
    pub rays: Rays,
    /// Bounds on entry, occlusion on return.
    pub hits: Hits,
    /// Which path the light goes to.
    pub place: Vec<u32>,
    /// What arrives if nothing is in between.
    pub light: Vec<Rgb>,
}

impl Shadows {
    /// No shadow ray, room for [`SHADOWS`].
    pub fn new() -> Self {
        Self {
            rays: Rays::with_capacity(SHADOWS),
            hits: Hits::with_capacity(SHADOWS),
            place: vec![MISS; SHADOWS],
            light: vec![Rgb::ZERO; SHADOWS],
        }
    }

    /// Whether there is room for so many more.
    #[inline]
    pub fn has_room(&self, count: usize) -> bool {
        self.rays.len() + count <= SHADOWS
    }

    /// Appends a shadow ray toward a light, for the path and with the light given.
    #[inline]
    pub fn push(&mut self, (origin, own): (Vec3, u32), sample: &LightSample, to: (u32, Rgb)) {
        let row = self.rays.len();
        self.rays.push(origin, sample.direction, own);
        self.rays.target[row] = sample.target;
        self.hits.set(row, sample.t, MISS);
        (self.place[row], self.light[row]) = to;
    }

    /// [`Shadows::push`] for the lanes given; there is room for a whole row.
    #[inline]
    pub fn push_row(
        &mut self,
        (origin, own): (Vec3, u32),
        (samples, lanes): (&LightRow, u32),
        (place, light): (u32, &[Rgb; ROW]),
    ) {
        let count = lanes.trailing_ones() as usize;
        if lanes.count_ones() as usize != count {
            for lane in set_bits(lanes) {
                self.push((origin, own), &samples.sample(lane), (place, light[lane]));
            }
            return;
        }
        let rows = self.rays.len()..self.rays.len() + ROW;
        let direction = samples.direction;
        self.rays.append(
            count,
            &origin.to_array().map(F32x16::splat),
            &[direction.x, direction.y, direction.z],
        );
        self.rays.own[rows.clone()].fill(own);
        self.rays.target[rows.clone()].fill(samples.target);
        self.hits.t[rows.clone()].copy_from_slice(&samples.t);
        self.hits.sphere[rows.clone()].fill(MISS);
        self.place[rows.clone()].fill(place);
        self.light[rows].copy_from_slice(light);
    }
}

impl Default for Shadows {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::vec3;

    #[test]
    fn rows_are_pushed_as_their_lanes_are() {
        let lanes: [f32; ROW] = std::array::from_fn(|lane| lane as f32);
        let [x, y, z] = [1.0, 2.0, 3.0].map(|factor| F32x16::new(lanes) * F32x16::splat(factor));
        let mut samples = LightRow::distant(vec3::Vec3::new(x, y, z), Rgb::ONE, ROW);
        (samples.t, samples.target) = (lanes.map(f64::from), 7);
        let (from, light) = ((Vec3::new(0.1, 0.2, 0.3), 5), lanes.map(Rgb::splat));
        for bits in [0, 1, 0xffff, 0xff, 0xa5a5, 0x8000, 0xfffe] {
            let (mut rows, mut single) = (Shadows::new(), Shadows::new());
            for place in 0..3 {
                rows.push_row(from, (&samples, bits), (place, &light));
                for lane in set_bits(bits) {
                    single.push(from, &samples.sample(lane), (place, light[lane]));
                }
            }
            assert_eq!(rows.rays.len(), single.rays.len());
            for row in 0..rows.rays.len() {
                let all = |shadows: &Shadows| {
                    let rays = &shadows.rays;
                    let ray = (rays.origin.row(row), rays.direction.row(row));
                    let ends = (rays.own[row], rays.target[row], shadows.hits.t[row]);
                    (ray, ends, shadows.hits.sphere[row], shadows.place[row], shadows.light[row])
                };
                assert_eq!(all(&rows), all(&single), "{bits:x} {row}");
            }
        }
    }
}
