//! Assignment of sample dimensions to the decisions of a path.
//!
//! The table is in the [module's](super) documentation.

use super::sampler::{Sampler, SamplerState};
use crate::lanes::{Doubles, F32x16, F64x8, widen};

/// Spacing of the numbers of a set.
const FINE: f64 = 1.0 / (1 << 23) as f64;

/// The numbers of one bounce; all in [0, 1).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScatterDraw {
    /// For the new direction.
    pub direction: [f32; 2],
    /// For the choice of the lobe: reflection or refraction, coat or base.
    pub lobe: f32,
    /// For Russian roulette.
    pub roulette: f32,
}

/// The numbers of one light sample; all in [0, 1).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightDraw {
    /// For the point on the light.
    pub point: [f32; 2],
    /// For the choice of the light: a number with twice the digits, for probabilities below the
    /// resolution of single precision.
    pub light: f64,
}

/// Returns the set with the direction of bounce number `bounce`.
#[inline(always)]
pub(super) fn directions(bounce: u32) -> u32 {
    if bounce == 0 { 0 } else { choices(bounce) }
}

/// Returns the set with lobe and roulette of bounce number `bounce`.
#[inline(always)]
pub(super) fn choices(bounce: u32) -> u32 {
    1 + 2 * bounce
}

/// Returns the set with the numbers of the light sample at bounce number `bounce`.
#[inline(always)]
pub(super) fn lights(bounce: u32) -> u32 {
    2 + 2 * bounce
}

impl Sampler {
    /// Returns the camera ray's position in its pixel, for
    /// [`PixelFilter::offset`](super::PixelFilter::offset); in [0, 1).
    #[inline]
    pub fn pixel(&self, path: &SamplerState) -> [f32; 2] {
        let [_, _, x, y] = self.draw4(path, 0);
        [x, y]
    }

    /// Returns the camera ray's position on the lens; in [0, 1).
    #[inline]
    pub fn lens(&self, path: &SamplerState) -> [f32; 2] {
        let [u, v, _, _] = self.draw4(path, 1);
        [u, v]
    }

    /// Returns the numbers of bounce number `bounce`, from 0 at the first hit.
    #[inline]
    pub fn scatter(&self, path: &SamplerState, bounce: u32) -> ScatterDraw {
        let first = self.draw4(path, directions(bounce));
        let second = if choices(bounce) == directions(bounce) {
            first
        } else {
            self.draw4(path, choices(bounce))
        };
        let ([u, v, ..], [_, _, lobe, roulette]) = (first, second);
        ScatterDraw { direction: [u, v], lobe, roulette }
    }

    /// Returns the numbers of the light sample at bounce number `bounce`.
    #[inline]
    pub fn light(&self, path: &SamplerState, bounce: u32) -> LightDraw {
        LightDraw::new(self.draw4(path, lights(bounce)))
    }
}

impl LightDraw {
    /// Creates the draw from the numbers of a set.
    #[inline]
    pub fn new([u, v, coarse, fine]: [f32; 4]) -> Self {
        Self { point: [u, v], light: combine(f64::from(coarse), f64::from(fine)) }
    }

    /// Returns [`LightDraw::light`] for a row of numbers.
    #[inline(always)]
    pub fn light_row([_, _, coarse, fine]: [F32x16; 4]) -> [F64x8; 2] {
        let ([a, b], [c, d]) = (widen(coarse), widen(fine));
        [combine(a, c), combine(b, d)]
    }
}

#[inline(always)]
fn combine<D: Doubles>(coarse: D, fine: D) -> D {
    let (light, most) = (coarse + fine * D::splat(FINE), D::splat(1.0 - f64::EPSILON));
    D::select(light.lt(most), light, most)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lanes::U32x16;
    use crate::sampling::{SamplerRow, SamplerStates};
    use crate::settings::SamplerKind;

    #[test]
    fn no_number_is_used_for_two_decisions() {
        for kind in [SamplerKind::Sobol, SamplerKind::Stratified, SamplerKind::Independent] {
            let sampler = Sampler::new(kind, 4, 16);
            let path = sampler.start(1, 2, 3);
            let (start, mut states) = (sampler.start_row(1, 2, 3), SamplerStates::with_paths(1));
            states.set_row(0, &start);
            let row = SamplerRow::new(start.positions, U32x16::splat(0), &states);
            let mut numbers = [sampler.pixel(&path), sampler.lens(&path)].concat();
            for bounce in 0..100 {
                let ScatterDraw { direction, lobe, roulette } = sampler.scatter(&path, bounce);
                let LightDraw { point, light } = sampler.light(&path, bounce);
                numbers.extend(direction.into_iter().chain(point).chain([
                    lobe,
                    roulette,
                    light as f32,
                ]));
                let [u, v, choice, _] = sampler.caustic_row(&row, bounce);
                numbers.extend([choice, u, v].map(|row| row.to_array()[0]));
            }
            let count = numbers.len();
            assert_eq!(count, 1004);
            numbers.sort_unstable_by(f32::total_cmp);
            numbers.dedup();
            // Of 1004 random multiples of 2^-23 or 2^-24, at most two may be equal by chance.
            assert!(numbers.len() + 2 >= count, "{kind:?}: {}", numbers.len());
        }
    }

    #[test]
    fn the_number_of_a_light_has_twice_the_digits() {
        let below = crate::sampling::ONE_BELOW;
        let draw = |coarse, fine| LightDraw::new([0.25, 0.75, coarse, fine]);
        assert_eq!(draw(0.5, 0.0).light, 0.5);
        assert_eq!(draw(0.5, 0.5).light, 0.5 + 2.0_f64.powi(-24));
        assert_eq!(draw(0.0, 0.125).light, 2.0_f64.powi(-26));
        assert_eq!(draw(0.5, 0.5).point, [0.25, 0.75]);
        // The sum of two numbers of 24 digits may exceed 1; it is clamped to the largest number below.
        let most = draw(below, below).light;
        assert!(most < 1.0 && most >= f64::from(below), "{most}");
    }

    #[test]
    fn rows_of_lights_are_those_of_their_lanes() {
        let below = crate::sampling::ONE_BELOW;
        let numbers = |step: usize| -> [f32; 16] {
            std::array::from_fn(
                |lane| if lane == 9 { below } else { (lane * step % 16) as f32 / 16.0 },
            )
        };
        let columns = [1, 3, 5, 7].map(numbers);
        let [low, high] = LightDraw::light_row(columns.map(F32x16::new)).map(F64x8::to_array);
        for (lane, light) in low.into_iter().chain(high).enumerate() {
            assert_eq!(light, LightDraw::new(columns.map(|column| column[lane])).light, "{lane}");
        }
    }

    #[test]
    fn the_best_dimensions_go_to_pixel_and_first_direction() {
        let sampler = Sampler::new(SamplerKind::Sobol, 4, 16);
        let path = sampler.start(1, 2, 3);
        let [u, v, x, y] = sampler.draw4(&path, 0);
        assert_eq!(sampler.scatter(&path, 0).direction, [u, v]);
        assert_eq!(sampler.pixel(&path), [x, y]);
    }
}
