//! Trigonometric functions in lanes, of angles in turns.
//!
//! Polynomials of Moshier's Cephes library, 1992: images must not depend on the platform's library,
//! whose last bits vary. A turn is a full circle: angles in turns are reduced to an octant exactly.

use crate::lanes::Lanes;
use std::f32::consts::{FRAC_1_PI, FRAC_PI_2};

/// Adding and subtracting it rounds a number of small magnitude to the nearest integer.
const ROUNDER: f32 = 12_582_912.0;

/// Tangent of 22.5 degrees.
const TAN_PI_8: f32 = 0.414_213_57;

/// Returns sine and cosine of an angle of at most 45 degrees, in radians, within 1e-7.
#[inline(always)]
pub(super) fn octant_sine_cosine<L: Lanes>(angle: L) -> (L, L) {
    let s = angle * angle;
    let series = |[a, b, c]: [f32; 3]| L::splat(a).mul_add(s, L::splat(b)).mul_add(s, L::splat(c));
    let sine = series([-1.951_529_6e-4, 8.332_161e-3, -0.166_666_55]) * s;
    let cosine = series([2.443_315_7e-5, -1.388_731_6e-3, 4.166_664_6e-2]) * s - L::splat(0.5);
    (sine.mul_add(angle, angle), cosine.mul_add(s, L::splat(1.0)))
}

/// Returns sine and cosine of an angle of at most one turn in either sense, within 2e-7; small sines
/// are as precise in proportion.
#[inline(always)]
pub fn sine_cosine<L: Lanes>(turns: L) -> (L, L) {
    let (rounder, quarters) = (L::splat(ROUNDER), turns.abs() * L::splat(4.0));
    let quadrant = (quarters + rounder) - rounder;
    let (s, c) = octant_sine_cosine((quarters - quadrant) * L::splat(FRAC_PI_2));
    let between = |low: f32, high: f32| L::splat(low).lt(quadrant) & quadrant.lt(L::splat(high));
    let swapped = between(0.5, 1.5) | between(2.5, 3.5);
    let negate = |mask: L::Mask, x: L| L::select(mask, -x, x);
    let sine = negate(between(1.5, 3.5), L::select(swapped, c, s));
    let cosine = negate(between(0.5, 2.5), L::select(swapped, s, c));
    (negate(turns.is_negative(), sine), cosine)
}

/// Returns the angle from the x axis to the point (x, y) in turns, 0..=1, within 6e-8; angles near 0
/// are as precise in proportion. 0 for the origin.
#[inline(always)]
pub fn turns<L: Lanes>(y: L, x: L) -> L {
    let (across, up) = (x.abs(), y.abs());
    let (less, greater) = (across.min(up), across.max(up));
    // From more than half an octant, the angle to the octant's end.
    let far = (greater * L::splat(TAN_PI_8)).lt(less);
    let numerator = L::select(far, less - greater, less);
    let denominator = L::select(far, less + greater, greater);
    let positive = L::splat(0.0).lt(denominator);
    let tangent = L::select(positive, numerator / denominator, L::splat(0.0));
    let octant = L::select(far, L::splat(0.125), L::splat(0.0));
    let turns = arc_tangent(tangent).mul_add(L::splat(FRAC_1_PI / 2.0), octant);
    let turns = L::select(across.lt(up), L::splat(0.25) - turns, turns);
    let turns = L::select(x.is_negative(), L::splat(0.5) - turns, turns);
    L::select(y.is_negative(), L::splat(1.0) - turns, turns)
}

/// Returns the angle in radians of a tangent of at most 0.4143, within 2e-7 of itself.
#[inline(always)]
fn arc_tangent<L: Lanes>(tangent: L) -> L {
    let s = tangent * tangent;
    let series = L::splat(8.053_744_5e-2)
        .mul_add(s, L::splat(-0.138_776_86))
        .mul_add(s, L::splat(0.199_777_1))
        .mul_add(s, L::splat(-0.333_329_5));
    (series * s).mul_add(tangent, tangent)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lanes::F32x16;
    use std::f32::consts::FRAC_PI_4;
    use std::f64::consts::TAU;

    #[test]
    fn octants_agree_with_the_library() {
        for i in -1000..=1000_i16 {
            let angle = FRAC_PI_4 * f32::from(i) / 1000.0;
            let (sine, cosine) = octant_sine_cosine(angle);
            let (s, c) = f64::from(angle).sin_cos();
            assert!((f64::from(sine) - s).abs() < 1e-7 && (f64::from(cosine) - c).abs() < 1e-7);
        }
    }

    #[test]
    fn whole_turns_agree_with_the_library() {
        for i in -80_000..=80_000_i32 {
            let angle = i as f32 / 80_000.0;
            let (sine, cosine) = sine_cosine(angle);
            let (s, c) = (f64::from(angle) * TAU).sin_cos();
            assert!((f64::from(sine) - s).abs() < 2e-7, "{angle}");
            assert!((f64::from(cosine) - c).abs() < 2e-7, "{angle}");
        }
        for angle in [1e-3_f32, 1e-8, 1e-30] {
            let truth = f64::from(angle) * TAU;
            assert!((f64::from(sine_cosine(angle).0) / truth.sin() - 1.0).abs() < 2e-7, "{angle}");
        }
    }

    #[test]
    fn arc_tangents_agree_with_the_library() {
        for i in 0..200_000_u32 {
            let (s, c) = (f64::from(i) / 200_000.0 * TAU).sin_cos();
            let (y, x) = (s as f32 * 3.0, c as f32 * 3.0);
            let truth = (f64::from(y).atan2(f64::from(x)) / TAU).rem_euclid(1.0);
            assert!((f64::from(turns(y, x)) - truth).abs() < 6e-8, "{y} {x}");
        }
        for y in [1e-3_f32, 1e-8, 1e-18] {
            let truth = f64::from(y).atan2(1.0) / TAU;
            assert!((f64::from(turns(y, 1.0)) / truth - 1.0).abs() < 3e-7, "{y}");
        }
    }

    #[test]
    fn the_axes_are_exact() {
        let axes = [(0.0, 1.0, 0.0), (1.0, 0.0, 0.25), (0.0, -1.0, 0.5), (-1.0, 0.0, 0.75)];
        for (y, x, truth) in axes {
            assert_eq!(turns::<f32>(y, x), truth);
            let (sine, cosine) = sine_cosine::<f32>(truth);
            assert_eq!((sine, cosine), (y, x), "{truth}");
        }
        assert_eq!(turns(0.0_f32, 0.0), 0.0);
        assert_eq!(turns(-0.0_f32, 1.0), 1.0);
    }

    #[test]
    fn rows_equal_their_lanes() {
        let x: [f32; 16] = std::array::from_fn(|lane| 0.13 * lane as f32 - 1.0);
        let y: [f32; 16] = std::array::from_fn(|lane| 0.7 - 0.09 * lane as f32);
        let angle = turns(F32x16::new(y), F32x16::new(x)).to_array();
        let (sine, cosine) = sine_cosine(F32x16::new(x));
        for lane in 0..16 {
            assert_eq!(angle[lane], turns(y[lane], x[lane]));
            let (s, c) = sine_cosine(x[lane]);
            assert_eq!((sine.to_array()[lane], cosine.to_array()[lane]), (s, c));
        }
    }
}
