//! Fused multiply-add, rounded once, on every processor.
//!
//! Images must not depend on the instructions of a processor. Where it has none for `a * b + c`, a row
//! goes to software that gives the same bits, some ten times slower. [`Lanes::relaxed_mul_add`] is for
//! bounds that hold with either rounding.
//!
//! Products of single precision are exact in double precision. The sum is rounded to odd: to the neighbor
//! with an odd last bit, unless it is exact. With 53 digits on the way to at most 24, rounding that
//! again gives what one rounding of the exact sum does (Boldo and Melquiond, "Emulation of a FMA and
//! Correctly Rounded Sums: Proved Algorithms Using Rounding to Odd", IEEE Transactions on Computers 2008).

#[cfg(doc)]
use super::Lanes;

/// True if the program is compiled for instructions that multiply and add with one rounding.
pub(super) const IN_HARDWARE: bool =
    cfg!(any(target_feature = "fma", all(target_arch = "aarch64", target_feature = "neon")));

/// `a * b + c` of each lane, rounded once, in software.
#[inline(never)]
pub(super) fn mul_add_row<const WIDTH: usize>(
    a: [f32; WIDTH],
    b: [f32; WIDTH],
    c: [f32; WIDTH],
) -> [f32; WIDTH] {
    std::array::from_fn(|lane| mul_add(a[lane], b[lane], c[lane]))
}

/// `a * b + c`, rounded once, in software. Without branches, so that rows of it become vectors.
#[inline(always)]
pub(super) fn mul_add(a: f32, b: f32, c: f32) -> f32 {
    // At most 48 digits, and exponents that double precision has.
    let product = f64::from(a) * f64::from(b);
    let c = f64::from(c);
    let sum = product + c;
    // What rounding has taken from the sum (Knuth's TwoSum); NaN if it is infinite or NaN.
    let rest = sum - product;
    let lost = (product - (sum - rest)) + (c - rest);
    let bits = sum.to_bits();
    // The neighbor on the other side of the exact sum: away from 0 if both have the same sign.
    let step = if (lost > 0.0) == (sum > 0.0) { 1 } else { u64::MAX };
    let inexact = lost.abs() > 0.0;
    let even = bits & 1 == 0;
    f64::from_bits(bits.wrapping_add(if inexact & even { step } else { 0 })) as f32
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lanes::{F32x4, F32x8, F32x16, Lanes};
    use proptest::prelude::*;

    /// The bits of a result; the same for every NaN, whose bits no operation defines.
    fn bits(x: f32) -> u32 {
        if x.is_nan() { f32::NAN.to_bits() } else { x.to_bits() }
    }

    #[track_caller]
    fn check(a: f32, b: f32, c: f32) {
        let expected = bits(a.mul_add(b, c));
        assert_eq!(bits(mul_add(a, b, c)), expected, "software: {a:e} * {b:e} + {c:e}");
        assert_eq!(bits(Lanes::mul_add(a, b, c)), expected, "one lane: {a:e} * {b:e} + {c:e}");
    }

    fn check_rows<L: Lanes>(values: &[[f32; 3]; 16]) {
        for rows in values.chunks_exact(L::WIDTH) {
            let column = |i: usize| L::load(&rows.iter().map(|row| row[i]).collect::<Vec<_>>());
            let mut found = [0.0; 16];
            column(0).mul_add(column(1), column(2)).store(&mut found);
            for ([a, b, c], found) in rows.iter().zip(found) {
                let expected = bits(a.mul_add(*b, *c));
                assert_eq!(bits(found), expected, "{} lanes: {a:e} * {b:e} + {c:e}", L::WIDTH);
            }
        }
    }

    /// Numbers at the ends of every range, and their neighbors.
    const EDGES: [f32; 24] = [
        0.0,
        f32::from_bits(1),
        f32::from_bits(2),
        f32::from_bits(3),
        f32::from_bits(0x0040_0000),
        f32::from_bits(0x007f_ffff),
        f32::MIN_POSITIVE,
        f32::from_bits(0x0080_0001),
        1.0 / (1_u128 << 100) as f32,
        f32::EPSILON / 4.0,
        f32::EPSILON / 2.0,
        f32::EPSILON,
        0.5,
        1.0 - f32::EPSILON / 2.0,
        1.0,
        1.0 + f32::EPSILON,
        1.5,
        2.0,
        16_777_215.0,
        16_777_217.0,
        (1_u128 << 100) as f32,
        f32::MAX,
        f32::INFINITY,
        f32::NAN,
    ];

    #[test]
    fn software_rounds_the_ends_of_every_range_as_the_standard_library_does() {
        let all = EDGES.iter().flat_map(|&x| [x, -x]);
        for a in all.clone() {
            for b in all.clone() {
                all.clone().for_each(|c| check(a, b, c));
            }
        }
    }

    #[test]
    fn sums_halfway_between_two_numbers_are_rounded_once() {
        // (1 + u)(1 - u) = 1 - u^2, with u = 2^-12: halfway, but for what the third number adds.
        let (above, below) = (1.0 + 1.0 / 4096.0, 1.0 - 1.0 / 4096.0);
        for scale in [1.0, 1.0 / (1_u128 << 90) as f32, (1_u128 << 90) as f32] {
            for least in [0.0, f32::from_bits(1), f32::MIN_POSITIVE, 1e-30, 1e-20, 1e-9] {
                check(above * scale, above, least * scale);
                check(above * scale, below, -least * scale);
                check(above * scale, below, least);
                check(-above * scale, below, scale);
                check(16_777_215.0 * scale, 1.0 + f32::EPSILON, least);
                check(16_777_215.0 * scale, 0.5, -least);
            }
        }
        // Half of the least subnormal number, a bit more, and a bit less.
        let half = f32::from_bits(1);
        check(half, 0.5, 0.0);
        check(half, 0.5 + f32::EPSILON, 0.0);
        check(half, 0.5 - f32::EPSILON, 0.0);
        check(f32::MIN_POSITIVE, f32::EPSILON / 2.0, half);
        check(f32::MIN_POSITIVE, -f32::EPSILON / 2.0, f32::from_bits(3));
        check(f32::MAX, 1.0 + f32::EPSILON, -f32::MAX);
        check(f32::MAX, 1.0, f32::MAX * f32::EPSILON / 4.0);
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(20_000))]

        #[test]
        fn every_width_rounds_any_bits_as_the_standard_library_does(
            numbers in prop::array::uniform16(prop::array::uniform3(any::<u32>())),
        ) {
            let values = numbers.map(|row| row.map(f32::from_bits));
            for [a, b, c] in values {
                check(a, b, c);
            }
            check_rows::<F32x4>(&values);
            check_rows::<F32x8>(&values);
            check_rows::<F32x16>(&values);
        }

        /// Terms of about the size of the product, so that the sum cancels or is rounded near a tie.
        #[test]
        fn every_width_rounds_sums_that_cancel_as_the_standard_library_does(
            numbers in prop::array::uniform16((any::<u32>(), any::<u32>(), -64_i32..64, any::<u32>())),
        ) {
            let values = numbers.map(|(a, b, shift, digits)| {
                let near_one = |bits: u32| f32::from_bits(0x3f00_0000 | bits & 0x80ff_f000);
                let (a, b) = (near_one(a), near_one(b));
                let product = a * b;
                let steps = digits as i32 % 5;
                let near = f32::from_bits(product.to_bits().wrapping_add_signed(steps));
                let power = f32::from_bits(((127 + shift) as u32) << 23);
                [a, b, if digits & 64 == 0 { -near } else { near * power }]
            });
            for [a, b, c] in values {
                check(a, b, c);
            }
            check_rows::<F32x4>(&values);
            check_rows::<F32x8>(&values);
            check_rows::<F32x16>(&values);
        }
    }
}
