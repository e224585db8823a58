//! Shadow rays that wait to be traced together.

use super::Job;
use super::gather::Starts;
use super::stages;
use super::workspace::Workspace;
use crate::lanes::{F32x16, Lanes, Mask, Packing, U32x16, set_bits};
use crate::ray::{Columns3, ExactRay, GROUND, Hits, MISS, Rays};
use crate::vec3::Vec3;
use crate::world::{LightRow, LightSample, ROW, ReceiverRow, World};
use glam::Vec3 as Point;

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
    pub light: Columns3,
}

impl Shadows {
    /// No shadow ray, room for [`SHADOWS`].
    pub fn new() -> Self {
        Self {
            rays: Rays::with_capacity(SHADOWS),
            hits: Hits::with_capacity(SHADOWS),
            place: vec![0; SHADOWS + ROW],
            light: Columns3::with_rows(SHADOWS + ROW),
        }
    }

    /// Whether there is room for so many more.
    #[inline]
    pub fn has_room(&self, count: usize) -> bool {
        self.rays.len() + count <= SHADOWS
    }

    /// Appends the shadow rays in `lanes` toward lights, for the paths and with the light given; there
    /// is room for a whole row.
    #[inline(always)]
    fn push_row(
        &mut self,
        from: &ReceiverRow,
        (samples, lanes): (&LightRow, u32),
        (place, light): (U32x16, Vec3<F32x16>),
    ) {
        let (packing, first) = (Packing::new(lanes), self.rays.len());
        self.rays.append_packed(&packing, (from.point, samples.direction), &from.own);
        packing.store_numbers(U32x16::new(samples.target), &mut self.rays.target[first..]);
        packing.store_numbers(place, &mut self.place[first..]);
        packing.store_doubles(&samples.t, &mut self.hits.t[first..]);
        self.hits.sphere[first..first + ROW].fill(MISS);
        self.light.pack(first, &packing, light);
    }
}

/// A shadow ray that comes by itself.
pub(super) struct Next {
    /// Where it starts, and on which sphere.
    pub(super) start: (Point, u32),
    /// Where it goes.
    pub(super) direction: Point,
    /// The distance of its light, and the light's row.
    pub(super) end: (f64, u32),
    /// Which path the light goes to.
    pub(super) place: u32,
    /// What arrives if nothing is in between.
    pub(super) light: Point,
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
    let hidden = set_bits(lanes & lit & starts.inside).filter(|&lane| {
        let row = starts.rows.to_array()[lane] as usize;
        hides(job.world, work, row, &samples.sample(lane))
    });
    let lanes = hidden.fold(lanes & lit, |lanes, lane| lanes & !(1 << lane));
    if !work.shadows.has_room(ROW) {
        stages::occlude(job, work);
    }
    work.shadows.push_row(&starts.at, (samples, lanes), (starts.carried.place, light));
}

/// Returns whether a sphere hides a light from a point of its inside: the light is behind its far
/// side, or behind its cap.
fn hides(world: &World, work: &Workspace, row: usize, sample: &LightSample) -> bool {
    let own = work.hits.sphere[row];
    own != GROUND
        && (work.chord(world, row, sample.direction) < sample.t
            || (!world.cut.is_empty() && cap_hides(world, work, row, sample)))
}

/// Returns whether the way to a light from the inside of a sphere crosses a flat cut.
#[cold]
fn cap_hides(world: &World, work: &Workspace, row: usize, sample: &LightSample) -> bool {
    let ray = ExactRay::new(work.surface.point.row(row), sample.direction, true);
    world.cut.clip(&ray, work.hits.sphere[row]).to < sample.t
}

impl Shadows {
    /// Appends a ray; there is room for it.
    pub(super) fn push(&mut self, next: &Next) {
        let row = self.rays.len();
        self.rays.push(next.start.0, next.direction, next.start.1);
        self.rays.target[row] = next.end.1;
        self.hits.set(row, next.end.0, MISS);
        self.place[row] = next.place;
        self.light.set(row, next.light);
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
    use crate::scene::Rgb;

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
        let light = direction * F32x16::splat(0.5);
        for bits in [0, 1, 0xffff, 0xff, 0xa5a5, 0x8000, 0xfffe] {
            let mut shadows = Shadows::new();
            for _ in 0..3 {
                shadows.push_row(&from, (&samples, bits), (U32x16::new(numbers), light));
            }
            let each = [(); 3].into_iter().flat_map(|()| set_bits(bits));
            assert_eq!(shadows.rays.len(), 3 * u32::count_ones(bits) as usize);
            for (row, lane) in each.enumerate() {
                let (rays, sample) = (&shadows.rays, samples.sample(lane));
                let start = (rays.origin.row(row), rays.own[row]);
                let end = (rays.direction.row(row), rays.target[row], shadows.hits.t[row]);
                assert_eq!(start, (from.receiver(lane).point, from.own[lane]));
                assert_eq!(end, (sample.direction, sample.target, sample.t));
                assert_eq!((shadows.hits.sphere[row], shadows.place[row]), (MISS, numbers[lane]));
                assert_eq!(shadows.light.row(row), 0.5 * sample.direction);
            }
        }
    }
}
