//! The choice of a caustic for a surface point: an emitter, a specular sphere and a kind of path.

use super::CausticCasters;
use super::connection::CausticPath;
use super::estimate::EmitterView;
use super::tree::NodeChances;
use crate::lanes::{F32x16, F64x8, MAX_LANES, set_bits};
use crate::world::lights::{ROOT, Receiver, ReceiverRow};

/// Number of samples where caustics bring as much light as their emitter. In the default field, variance
/// times time is 0.85 of that with four times as many.
const IRRADIANCE_TO_SAMPLES: f64 = 0.25;

/// Maximum number of samples at a point.
const MAX_SAMPLES: f64 = 16.0;

/// Range of sums of estimates that single precision resolves well.
const RESOLVED: std::ops::Range<f64> = 1e-30..1e30;

/// An emitter, a specular sphere and a kind of path.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CausticChoice {
    /// Indices in the lists of emitters and of spheres.
    pub(crate) emitter: usize,
    pub(crate) caster: usize,
    pub(crate) path: CausticPath,
    /// Probability of the choice times the expected number of samples.
    pub(crate) rate: f64,
}

/// A row of choices.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CausticChoices {
    /// Indices of the emitters.
    pub(crate) emitter: [u32; MAX_LANES],
    /// Indices of the spheres times [`CausticPath::COUNT`], plus those of the paths.
    pub(crate) code: [u32; MAX_LANES],
    /// Probabilities of the choices times the expected numbers of samples.
    pub(crate) rate: F32x16,
    /// Lanes in which something was chosen.
    pub(crate) lanes: u32,
}

impl CausticCasters {
    /// Chooses a caustic for each of the receivers in `lanes` that has more than `number` samples.
    #[inline(never)]
    pub(crate) fn choose_row(
        &self,
        at: &ReceiverRow,
        draw: [F64x8; 2],
        number: u32,
        lanes: u32,
    ) -> CausticChoices {
        let draw = draw.map(F64x8::to_array);
        let (mut emitter, mut code) = ([0; MAX_LANES], [0; MAX_LANES]);
        let (mut rate, mut found) = ([1.0; MAX_LANES], 0);
        for lane in set_bits(lanes) {
            let draw = draw[lane / 8][lane % 8];
            let Some(choice) = self.choose(&at.receiver(lane), draw, number) else { continue };
            emitter[lane] = choice.emitter as u32;
            code[lane] = choice.caster as u32 * CausticPath::COUNT + choice.path as u32;
            rate[lane] = choice.rate as f32;
            found |= 1 << lane;
        }
        CausticChoices { emitter, code, rate: F32x16::new(rate), lanes: found }
    }

    /// Chooses the caustic of sample `number` by a random number in [0, 1), the same for all samples of a
    /// receiver. The expected number of samples is proportional to the light that caustics may bring.
    pub(super) fn choose(&self, at: &Receiver, draw: f64, number: u32) -> Option<CausticChoice> {
        let (emitter, probability, draw) = self.emitter_sampler.choose_around(at, draw);
        let bound = self.bounds.at(at.point, at.normal);
        if f64::from(number) + draw >= bound {
            return None;
        }
        let view = self.view(emitter, at);
        let mut children = self.tree.children(ROOT);
        let mut chances = self.tree.chances(children, at, &view);
        let samples = chances.samples().min(bound);
        // Sample `number` is taken if the random number, extended by the sample's number, is in the range
        // of expected samples; what is left of it is the sample's own random number.
        let left = f64::from(number) + draw;
        if left >= samples {
            return None;
        }
        let mut draw = left / samples;
        let mut rate = f64::from(probability) * samples;
        loop {
            let (lane, rest) = chances.all.pick(children.count, draw);
            rate *= chances.all.of(lane);
            let node = children.first + lane;
            if let Some(caster) = self.tree.leaf(node) {
                let (path, share) = chances.pick_path(lane, rest)?;
                return Some(CausticChoice { emitter, caster, path, rate: rate * share });
            }
            children = self.tree.children(node as u32);
            chances = self.tree.chances(children, at, &view);
            if !RESOLVED.contains(&chances.all.total) {
                return None;
            }
            draw = rest;
        }
    }

    /// Returns the expected number of samples at a receiver, without bound.
    pub(super) fn samples(&self, emitter: usize, at: &Receiver) -> f64 {
        self.tree.chances(self.tree.children(ROOT), at, &self.view(emitter, at)).samples()
    }

    /// Returns the expected number of samples of a caustic at a receiver.
    pub(super) fn rate(
        &self,
        at: &Receiver,
        emitter: usize,
        caster: usize,
        path: CausticPath,
    ) -> f64 {
        let mut rate = f64::from(self.emitter_sampler.probability_around(at, emitter));
        let view = self.view(emitter, at);
        let mut nodes = self.tree.path_to_root(caster).peekable();
        if nodes.peek().is_none() {
            return 0.0;
        }
        for node in nodes {
            let parent = self.tree.parent(node);
            let children = self.tree.children(parent);
            let chances = self.tree.chances(children, at, &view);
            if !RESOLVED.contains(&chances.all.total) {
                return 0.0;
            }
            let lane = node as usize - children.first;
            rate *= chances.all.of(lane);
            if self.tree.leaf(node as usize).is_some() {
                rate *= chances.share(lane, path);
            }
            if parent == ROOT {
                rate *= chances.samples().min(self.bounds.at(at.point, at.normal));
            }
        }
        rate
    }

    /// Returns an emitter for the estimates at a receiver.
    fn view(&self, emitter: usize, at: &Receiver) -> EmitterView {
        match self.emitters[emitter].view {
            EmitterView::Near { center, radius2, .. } => {
                let distance2 = center.distance_squared(at.point).max(radius2);
                EmitterView::Near { center, radius2, distance2 }
            }
            sun @ EmitterView::Far { .. } => sun,
        }
    }
}

impl NodeChances {
    /// Returns the expected number of samples, for children of the root.
    fn samples(&self) -> f64 {
        let total = self.all.total;
        if RESOLVED.contains(&total) {
            (total * IRRADIANCE_TO_SAMPLES).min(MAX_SAMPLES)
        } else {
            0.0
        }
    }

    /// Chooses a kind of path by a random number in [0, 1); also returns the probability.
    fn pick_path(&self, lane: usize, draw: f64) -> Option<(CausticPath, f64)> {
        let mut left = draw;
        let mut last = None;
        for path in CausticPath::ALL {
            let share = self.share(lane, path);
            if share > 0.0 {
                last = Some((path, share));
                if left < share {
                    break;
                }
            }
            left -= share;
        }
        last
    }

    /// Returns the share of a kind of path in the contribution of a node.
    fn share(&self, lane: usize, path: CausticPath) -> f64 {
        let each = self.each.map(|row| f64::from(row[lane]));
        let sum: f64 = each.iter().sum();
        if sum > 0.0 { each[path as usize] / sum } else { 0.0 }
    }
}
