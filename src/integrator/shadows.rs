//! Shadow rays that wait to be traced together.

use super::Job;
use super::gather::Starts;
use super::stages;
use super::workspace::Workspace;
use crate::lanes::{F32x16, Lanes, Mask, set_bits};
use crate::ray::{GROUND, Hits, MISS, Rays};
use crate::scene::Rgb;
use crate::vec3::Vec3;
use crate::world::{LightRow, LightSample, ROW, Receiver, ReceiverRow, World};

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
    fn push(&mut self, from: &Receiver, sample: &LightSample, to: (u32, Rgb)) {
        let row = self.rays.len();
        self.rays.push(from.point, sample.direction, from.own);
        self.rays.target[row] = sample.target;
        self.hits.set(row, sample.t, MISS);
        (self.place[row], self.light[row]) = to;
    }

    /// Appends the shadow rays in `lanes` toward lights, for the paths and with the light given; there
    /// is room for a whole row.
    #[inline]
    fn push_row(
        &mut self,
        from: &ReceiverRow,
        (samples, lanes): (&LightRow, u32),
        (place, light): (&[u32; ROW], &[Rgb; ROW]),
    ) {
        let count = lanes.trailing_ones() as usize;
        if lanes.count_ones() as usize != count {
            for lane in set_bits(lanes) {
                let to = (place[lane], light[lane]);
                self.push(&from.receiver(lane), &samples.sample(lane), to);
            }
            return;
        }
        let rows = self.rays.len()..self.rays.len() + ROW;
        let axes = |v: Vec3<F32x16>| [v.x, v.y, v.z];
        self.rays.append(count, &axes(from.point), &axes(samples.direction));
        self.rays.own[rows.clone()].copy_from_slice(&from.own);
        self.rays.target[rows.clone()].copy_from_slice(&samples.target);
        self.hits.t[rows.clone()].copy_from_slice(&samples.t);
        self.hits.sphere[rows.clone()].fill(MISS);
        self.place[rows.clone()].copy_from_slice(place);
        self.light[rows].copy_from_slice(light);
    }
}

/// Queues the shadow rays in `lanes` of light samples, with the light that arrives if nothing is in
/// between; traces the queue when it is full.
#[inline(always)]
pub fn cast(
    job: &Job,
    work: &mut Workspace,
    starts: &Starts,
    (samples, lanes): (&LightRow, u32),
    light: Vec3<F32x16>,
) {
    let lit = Lanes::lt(F32x16::splat(0.0), light.max_element()).bits();
    let hidden = set_bits(lanes & lit & starts.inside)
        .filter(|&lane| hides(job.world, work, starts.rows[lane] as usize, &samples.sample(lane)));
    let lanes = hidden.fold(lanes & lit, |lanes, lane| lanes & !(1 << lane));
    if !work.shadows.has_room(ROW) {
        stages::occlude(job, work);
    }
    let place = starts.rows.map(|row| work.place[row as usize]);
    let Vec3 { x, y, z } = light.map(F32x16::to_array);
    let light = std::array::from_fn(|lane| Rgb::new(x[lane], y[lane], z[lane]));
    work.shadows.push_row(&starts.at, (samples, lanes), (&place, &light));
}

/// Whether a sphere hides a light from a point of its inside: what lies behind its far side.
fn hides(world: &World, work: &Workspace, row: usize, sample: &LightSample) -> bool {
    let own = work.hits.sphere[row];
    own != GROUND && work.chord(world, row, sample.direction) < sample.t
}

impl Default for Shadows {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_pushed_as_their_lanes_are() {
        let lanes: [f32; ROW] = std::array::from_fn(|lane| lane as f32);
        let [x, y, z] = [1.0, 2.0, 3.0].map(|factor| F32x16::new(lanes) * F32x16::splat(factor));
        let direction = Vec3::new(x, y, z);
        let numbers: [u32; ROW] = std::array::from_fn(|lane| 7 + lane as u32);
        let mut samples = LightRow::distant(direction, Rgb::ONE, u32::from(u16::MAX));
        (samples.t, samples.target) = (lanes.map(f64::from), numbers);
        let point = direction.map(|x| x + F32x16::splat(0.1));
        let from = ReceiverRow { point, normal: direction, own: numbers.map(|x| 2 * x) };
        let light = lanes.map(Rgb::splat);
        for bits in [0, 1, 0xffff, 0xff, 0xa5a5, 0x8000, 0xfffe] {
            let (mut rows, mut single) = (Shadows::new(), Shadows::new());
            for _ in 0..3 {
                rows.push_row(&from, (&samples, bits), (&numbers, &light));
                for lane in set_bits(bits) {
                    let to = (numbers[lane], light[lane]);
                    single.push(&from.receiver(lane), &samples.sample(lane), to);
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
