//! Rays from surfaces to balls, and how they go on from there.

use crate::integrator::shadows::{Next, SHADOWS};
use crate::lanes::{F32x16, MAX_LANES, Packing, set_bits};
use crate::ray::{Hits, MISS, Rays};
use crate::vec3::Vec3;
use crate::world::{Looking, Sent};

/// Rays on their first leg.
#[derive(Default)]
pub(super) struct Legs {
    pub(super) rays: Rays,
    pub(super) hits: Hits,
    /// Their second legs.
    pub(super) next: Vec<Next>,
}

impl Legs {
    pub(super) fn new() -> Self {
        Self {
            rays: Rays::with_capacity(SHADOWS),
            hits: Hits::with_capacity(SHADOWS),
            next: Vec::with_capacity(SHADOWS),
        }
    }

    /// Whether there is room for another row.
    pub(super) fn has_room(&self) -> bool {
        self.next.len() + MAX_LANES <= SHADOWS
    }

    pub(super) fn clear(&mut self) {
        self.rays.truncate(0);
        self.next.clear();
    }

    /// Appends the rays in `lanes`, from these spheres and of these paths, and the light that they
    /// bring if nothing is in between.
    pub(super) fn push_row(
        &mut self,
        (looking, sent): (&Looking, &Sent),
        (own, place): (&[u32; MAX_LANES], &[u32; MAX_LANES]),
        light: Vec3<F32x16>,
        lanes: u32,
    ) {
        let first = self.rays.len();
        self.rays.append_packed(&Packing::new(lanes), (looking.point, sent.toward), own);
        let one = |v: Vec3<F32x16>, lane: usize| -> glam::Vec3 {
            v.map(|row| row.to_array()[lane]).into()
        };
        for (row, lane) in (first..).zip(set_bits(lanes)) {
            let pair = looking.pair[lane];
            self.rays.target[row] = pair.ball;
            self.hits.set(row, sent.length[0][lane], MISS);
            self.next.push(Next {
                start: (one(sent.exit, lane), pair.ball),
                direction: one(sent.onward, lane),
                end: (sent.length[1][lane], pair.lamp),
                place: place[lane],
                light: one(light, lane),
            });
        }
    }
}
