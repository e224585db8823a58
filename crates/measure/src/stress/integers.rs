//! Ray-sphere intersection with arbitrary-precision integers, for the [reference](super::reference).
//!
//! Coordinates in single precision are integer multiples of a power of two. With one power for all
//! lengths and one for the direction, all values here are integers. With `F` from the center to the
//! origin, `a = d.d`, `b = -F.d`, `c = F.F - r^2` and `q = b^2 - a c`, the distance of a hit is
//! `(b -+ sqrt(q)) / a`.
//!
//! Distances are compared by the sign of `x = p + s1 sqrt(q1) + s2 sqrt(q2)`, evaluated to a sufficient
//! number of bits. `x` is an algebraic integer, and its conjugates are among the four expressions with
//! other signs. Let `2^m` bound all four. If `x` is not 0, the product of its conjugates is a nonzero
//! integer, so `|x| >= 2^-3m` (a separation bound: Burnikel et al., "A Strong and Easily Computable
//! Separation Bound for Arithmetic Expressions Involving Radicals", Algorithmica 2000). So `3 m + 3`
//! binary places decide.

use super::rays::Ray;
use num_bigint::{BigInt, Sign};
use spherule_render::elementary::power_of_two;
use std::cmp::Ordering;

/// Binary places of the first attempt to compare distances.
const FIRST_PLACES: u64 = 64;

/// Binary places of roots and quotients for [`ExactHit::distance`] and [`ExactHit::normal`].
const PLACES: u64 = 256;

/// A double-double number: the unevaluated sum of two doubles, with 106 bits.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DoubleDouble {
    /// The number, rounded toward zero.
    pub high: f64,
    /// The remainder.
    pub low: f64,
}

/// Exponents of the powers of two of which lengths and the direction are multiples.
#[derive(Clone, Copy)]
pub(super) struct Units {
    length: i32,
    direction: i32,
}

impl Units {
    /// Returns the units for a ray and all spheres to compare.
    pub(super) fn of(ray: &Ray, spheres: &[[f32; 4]]) -> Self {
        let lengths = spheres.iter().flatten().chain(&ray.origin);
        Self { length: lowest_exponent(lengths), direction: lowest_exponent(&ray.direction) }
    }
}

/// A ray and a sphere that it hits.
pub(super) struct ExactHit {
    units: Units,
    from_center: [BigInt; 3],
    direction: [BigInt; 3],
    radius: BigInt,
    a: BigInt,
    b: BigInt,
    c: BigInt,
    q: BigInt,
    /// Sign of the square root in the distance.
    root: i8,
}

impl ExactHit {
    /// Intersects a ray with a sphere; `None` if the ray misses.
    pub(super) fn new(units: Units, ray: &Ray, [x, y, z, radius]: [f32; 4]) -> Option<Self> {
        let length = |x: f32| to_integer(x, units.length);
        let center = [x, y, z];
        let from_center: [BigInt; 3] =
            std::array::from_fn(|i| length(ray.origin[i]) - length(center[i]));
        let direction = ray.direction.map(|x| to_integer(x, units.direction));
        let radius = length(radius);
        let a = dot(&direction, &direction);
        let b = -dot(&from_center, &direction);
        let c = dot(&from_center, &from_center) - &radius * &radius;
        let q = &b * &b - &a * &c;
        let root = match (c.sign(), b.sign()) {
            (Sign::Plus, Sign::Plus) if q.sign() != Sign::Minus => -1,
            (Sign::NoSign, Sign::Plus) | (Sign::Minus, _) => 1,
            _ => return None,
        };
        Some(Self { units, from_center, direction, radius, a, b, c, q, root })
    }

    /// Compares the distances of two spheres along one ray, in the same units.
    pub(super) fn compare(&self, other: &Self) -> Ordering {
        let p = &self.b - &other.b;
        let bits = p.bits().max(self.q.bits() / 2 + 1).max(other.q.bits() / 2 + 1);
        let enough = 3 * (bits + 2) + 3;
        let value =
            |places: u64| (&p << places) + self.scaled_root(places) - other.scaled_root(places);
        for places in [FIRST_PLACES, enough] {
            // The error of each root is less than 1.
            let value = value(places);
            if value.bits() > 2 {
                return value.sign().cmp(&Sign::NoSign);
            }
        }
        Ordering::Equal
    }

    /// Compares the distance exactly with a finite number x: `root sqrt(q)` with `a x - b`, by their
    /// signed squares.
    pub(super) fn compare_with(&self, number: f64) -> Ordering {
        let (significand, exponent) = split_double(number);
        let exponent = exponent - (self.units.length - self.units.direction);
        // All values times 2^fraction are integers.
        let fraction = (-exponent).max(0) as u64;
        let product = (&self.a * significand) << exponent.max(0) as u64;
        let rest = product - (&self.b << fraction);
        let square = BigInt::from_biguint(rest.sign(), rest.magnitude() * rest.magnitude());
        ((&self.q * self.root) << (2 * fraction)).cmp(&square)
    }

    /// Returns `root sqrt(q) 2^places`, with an error of less than 1.
    fn scaled_root(&self, places: u64) -> BigInt {
        (&self.q << (2 * places)).sqrt() * self.root
    }

    /// Returns the distance in units of the direction's length.
    pub(super) fn distance(&self) -> DoubleDouble {
        let b = &self.b << PLACES;
        let root = (&self.q << (2 * PLACES)).sqrt();
        // The form without cancellation.
        let near = self.root < 0 || self.b.sign() == Sign::Minus;
        let (numerator, denominator) = if near {
            let sum = if self.root < 0 { b + root } else { root - b };
            ((self.c.magnitude() << PLACES).into(), sum)
        } else {
            (b + root, &self.a << PLACES)
        };
        quotient(numerator, &denominator, self.units.length - self.units.direction)
    }

    /// Returns the outward unit normal at the hit.
    pub(super) fn normal(&self) -> [DoubleDouble; 3] {
        let root = self.scaled_root(PLACES);
        let denominator = (&self.a * &self.radius) << PLACES;
        std::array::from_fn(|i| {
            let across = &self.a * &self.from_center[i] + &self.b * &self.direction[i];
            quotient((across << PLACES) + &root * &self.direction[i], &denominator, 0)
        })
    }

    /// Returns the square of half the chord.
    pub(super) fn half_chord2(&self) -> f64 {
        quotient(self.q.clone(), &self.a, 2 * self.units.length).high
    }
}

fn dot(a: &[BigInt; 3], b: &[BigInt; 3]) -> BigInt {
    &a[0] * &b[0] + &a[1] * &b[1] + &a[2] * &b[2]
}

/// Returns `numerator / denominator 2^exponent`, for a positive denominator.
fn quotient(numerator: BigInt, denominator: &BigInt, exponent: i32) -> DoubleDouble {
    let (sign, numerator) = numerator.into_parts();
    // The quotient has 106 or 107 bits.
    let shift = 106 + denominator.bits() as i64 - numerator.bits() as i64;
    let quotient: u128 = if shift >= 0 {
        (numerator << shift as u64) / denominator.magnitude()
    } else {
        numerator / (denominator.magnitude() << -shift as u64)
    }
    .try_into()
    .unwrap_or(0);
    let (high, low) = ((quotient >> 54) as f64, (quotient & ((1 << 54) - 1)) as f64);
    let sign = if sign == Sign::Minus { -1.0 } else { 1.0 };
    let exponent = i64::from(exponent) - shift;
    DoubleDouble {
        high: scale_by_power(sign * high, exponent + 54),
        low: scale_by_power(sign * low, exponent),
    }
}

/// Returns `x 2^exponent`, in two steps that overflow only if the result does.
fn scale_by_power(x: f64, exponent: i64) -> f64 {
    let exponent = exponent.clamp(-2000, 2000) as i32;
    x * power_of_two(exponent / 2) * power_of_two(exponent - exponent / 2)
}

/// Splits a finite number into the magnitude of its significand and its exponent.
fn split(x: f32) -> (u32, i32) {
    let (fraction, biased) = (x.to_bits() & 0x7f_ffff, (x.to_bits() >> 23 & 0xff) as i32);
    if biased == 0 { (fraction, -149) } else { (fraction | 0x80_0000, biased - 150) }
}

/// Splits a finite number into its signed significand and its exponent.
fn split_double(x: f64) -> (i64, i32) {
    let (fraction, biased) = ((x.to_bits() << 12 >> 12) as i64, (x.to_bits() >> 52 & 0x7ff) as i32);
    let (significand, exponent) =
        if biased == 0 { (fraction, -1074) } else { (fraction | 1 << 52, biased - 1075) };
    (if x < 0.0 { -significand } else { significand }, exponent)
}

/// Returns `x 2^-exponent`, which must be an integer.
fn to_integer(x: f32, exponent: i32) -> BigInt {
    let (significand, own) = split(x);
    let zeros = significand.trailing_zeros() as i32;
    if significand == 0 {
        return BigInt::ZERO;
    }
    let magnitude = BigInt::from(significand >> zeros) << (own + zeros - exponent) as u32;
    if x < 0.0 { -magnitude } else { magnitude }
}

/// Returns the exponent of the lowest bit set in any number; 0 if all are 0.
fn lowest_exponent<'a>(numbers: impl IntoIterator<Item = &'a f32>) -> i32 {
    let nonzero = numbers.into_iter().filter(|x| **x != 0.0);
    let lowest = nonzero.map(|&x| {
        let (significand, exponent) = split(x);
        exponent + significand.trailing_zeros() as i32
    });
    lowest.min().unwrap_or(0)
}

#[cfg(test)]
mod tests;
