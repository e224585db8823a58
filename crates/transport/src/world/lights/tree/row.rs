//! The choice of lights for a row of receivers.
//!
//! Near the root all receivers evaluate the same nodes: there a lane is a receiver and not a node, so
//! that sums and searches are in lanes as well. Below, each receiver descends alone.

use super::super::row::{LANES, ReceiverRow};
use super::{BRANCHES, Nodes, OneSided, RESOLVED, Siblings, Tree};
use crate::lanes::{Doubles, F32x16, F64x8, Mask, set_bits, widen};
use crate::vec3::Vec3;

/// The nodes that half a row of receivers have chosen.
struct Picked {
    /// Places among the siblings.
    place: F64x8,
    /// Places of the random numbers in the shares of the nodes.
    rest: F64x8,
    probability: F64x8,
    /// Lanes whose probabilities single precision resolves.
    resolved: u32,
}

impl Tree {
    /// Does what [`Tree::choose`] does for each of the receivers in `lanes`; returns lights, and the
    /// probabilities of the choices.
    #[inline(always)]
    pub(in super::super) fn choose_row(
        &self,
        at: &ReceiverRow,
        draw: [F64x8; 2],
        lanes: u32,
    ) -> ([u32; LANES], [f32; LANES]) {
        let chances = self.chances_row(at);
        let (mut light, mut probability) = ([0; LANES], [1.0; LANES]);
        for (half, draw) in draw.into_iter().enumerate() {
            let wanted = lanes >> (8 * half) & 0xff;
            if wanted == 0 {
                continue;
            }
            // Not `map`, whose closure might not be inlined.
            let mut of_half = [draw; BRANCHES];
            of_half.iter_mut().zip(&chances).for_each(|(of, &row)| *of = widen(row)[half]);
            let picked = pick(&of_half[..usize::from(self.top)], draw);
            let (place, chance) = (picked.place.to_array(), picked.probability.to_array());
            for i in set_bits(wanted) {
                let lane = 8 * half + i;
                let node = place[i] as usize;
                let below = usize::from(self.children[node]);
                let (found, pdf, _) = if picked.resolved >> i & 1 == 0 {
                    self.choose::<OneSided>(&at.receiver(lane), draw.to_array()[i])
                } else if below > 0 {
                    let nodes = Siblings { first: self.child[node] as usize, count: below };
                    let rest = picked.rest.to_array()[i];
                    self.descend::<OneSided>(nodes, &at.receiver(lane), rest, chance[i])
                } else {
                    (self.child[node] as usize, chance[i] as f32, 0.0)
                };
                (light[lane], probability[lane]) = (found as u32, pdf);
            }
        }
        (light, probability)
    }

    /// Does what [`Tree::probability`] does for each of the receivers in `lanes`; 0 in the other lanes.
    #[inline(always)]
    pub(in super::super) fn probability_row(
        &self,
        at: &ReceiverRow,
        light: &[u32; LANES],
        lanes: u32,
    ) -> [f32; LANES] {
        let chances = self.chances_row(at);
        let top = usize::from(self.top);
        let mut total = [F64x8::splat(0.0); 2];
        for &chance in &chances[..top] {
            let [low, high] = widen(chance);
            total = [total[0] + low, total[1] + high];
        }
        let totals: [f64; LANES] = bytemuck::cast(total);
        let chances: [[f32; LANES]; BRANCHES] = bytemuck::cast(chances);
        let mut probability = [0.0; LANES];
        for lane in set_bits(lanes) {
            let (light, total) = (light[lane] as usize, totals[lane]);
            let node = self.leaf[light] as usize;
            probability[lane] = if node < top && RESOLVED.contains(&total) {
                (f64::from(chances[node][lane]) / total) as f32
            } else {
                self.probability::<OneSided>(&at.receiver(lane), light)
            };
        }
        probability
    }

    /// Estimates the contribution of each of the root's children to each receiver.
    #[inline(always)]
    fn chances_row(&self, at: &ReceiverRow) -> [F32x16; BRANCHES] {
        let mut chances = [F32x16::splat(0.0); BRANCHES];
        for (node, chance) in chances.iter_mut().enumerate().take(usize::from(self.top)) {
            let nodes = Nodes {
                center: Vec3::splat(self.x[node], self.y[node], self.z[node]),
                radius: F32x16::splat(self.radius[node]),
                power: F32x16::splat(self.power[node]),
                steady: F32x16::splat(self.steady[node]),
            };
            *chance = nodes.irradiance::<OneSided>(at.point, at.normal);
        }
        chances
    }
}

/// Returns in each lane the node in whose share a random number falls.
#[inline(always)]
fn pick(chances: &[F64x8], draw: F64x8) -> Picked {
    let (zero, one) = (F64x8::splat(0.0), F64x8::splat(1.0));
    let total = chances.iter().fold(zero, |sum, &chance| sum + chance);
    let (mut left, mut open) = (draw * total, zero.lt(one));
    let (mut place, mut part, mut share) = (zero, zero, one);
    for (i, &chance) in chances.iter().enumerate() {
        let here = open & zero.lt(chance);
        place = Doubles::select(here, F64x8::splat(i as f64), place);
        part = Doubles::select(here, left, part);
        share = Doubles::select(here, chance, share);
        open = open & !(here & left.lt(chance));
        left -= chance;
    }
    let below_one = F64x8::splat(1.0 - f64::EPSILON);
    let rest = part / share;
    let rest = Doubles::select(rest.lt(below_one), rest, below_one);
    let resolved = !total.lt(F64x8::splat(RESOLVED.start)) & total.lt(F64x8::splat(RESOLVED.end));
    Picked {
        place,
        rest: Doubles::select(zero.lt(rest), rest, zero),
        probability: share / total,
        resolved: resolved.bits(),
    }
}
