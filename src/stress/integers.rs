//! Rays against spheres in whole numbers: the truth of the [reference](super::reference).
//!
//! Coordinates in single precision are whole multiples of a power of two, so with one power for
//! all lengths and one for the direction everything here is a whole number of as many bits as it
//! takes. With `F` from the center to the origin, `a = d.d`, `b = -F.d`, `c = F.F - r^2` and
//! `q = b^2 - a c`, a hit's distance is `(b -+ sqrt(q)) / a`.
//!
//! Distances are compared by their value to as many bits as it takes. `x = p + s1 sqrt(q1) + s2
//! sqrt(q2)`, of which none of the four versions with other signs exceeds `2^m`, is an algebraic
//! integer whose conjugates are among them. If it is not 0, the product of the conjugates is a whole
//! number other than 0, so `|x| >= 2^-3m` (a separation bound: Burnikel et al., "A Strong and Easily
//! Computable Separation Bound for Arithmetic Expressions Involving Radicals", Algorithmica 2000).
//! Evaluating it to `3 m + 3` binary places decides.

use super::rays::Ray;
use num_bigint::{BigInt, Sign};
use std::cmp::Ordering;

/// Binary places to which distances are compared before all that are needed.
const FIRST_PLACES: u64 = 64;

/// Binary places of roots and quotients for [`Encounter::distance`] and [`Encounter::normal`].
const PLACES: u64 = 256;

/// A number as the sum of two of double precision, the second far below the first: 106 bits.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Twofold {
    /// The number, rounded toward zero.
    pub high: f64,
    /// The rest.
    pub low: f64,
}

/// Powers of two of which lengths and the direction are multiples.
#[derive(Clone, Copy)]
pub(super) struct Units {
    length: i32,
    direction: i32,
}

impl Units {
    /// For a ray and all spheres that it is to be compared with.
    pub(super) fn of(ray: &Ray, spheres: &[[f32; 4]]) -> Self {
        let lengths = spheres.iter().flatten().chain(&ray.origin);
        Self { length: least(lengths), direction: least(&ray.direction) }
    }
}

/// A ray and a sphere that it hits.
pub(super) struct Encounter {
    units: Units,
    from_center: [BigInt; 3],
    direction: [BigInt; 3],
    radius: BigInt,
    a: BigInt,
    b: BigInt,
    c: BigInt,
    q: BigInt,
    /// Sign of the root in the distance.
    root: i8,
}

impl Encounter {
    /// `None` if the ray does not hit.
    pub(super) fn new(units: Units, ray: &Ray, [x, y, z, radius]: [f32; 4]) -> Option<Self> {
        let length = |x: f32| whole(x, units.length);
        let center = [x, y, z];
        let from_center: [BigInt; 3] =
            std::array::from_fn(|i| length(ray.origin[i]) - length(center[i]));
        let direction = ray.direction.map(|x| whole(x, units.direction));
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

    /// Compares the distances of two spheres on one ray; both in the same units.
    pub(super) fn compare(&self, other: &Self) -> Ordering {
        let p = &self.b - &other.b;
        let bits = p.bits().max(self.q.bits() / 2 + 1).max(other.q.bits() / 2 + 1);
        let enough = 3 * (bits + 2) + 3;
        let value =
            |places: u64| (&p << places) + self.scaled_root(places) - other.scaled_root(places);
        for places in [FIRST_PLACES, enough] {
            // Each of the two roots is off by less than 1.
            let value = value(places);
            if value.bits() > 2 {
                return value.sign().cmp(&Sign::NoSign);
            }
        }
        Ordering::Equal
    }

    /// Compares the distance with a finite number, exactly: `root sqrt(q)` with `a x - b`, by their
    /// squares with the signs kept.
    pub(super) fn compare_with(&self, number: f64) -> Ordering {
        let (significand, exponent) = parts_of_double(number);
        let exponent = exponent - (self.units.length - self.units.direction);
        // All times 2^fraction is whole.
        let fraction = (-exponent).max(0) as u64;
        let product = (&self.a * significand) << exponent.max(0) as u64;
        let rest = product - (&self.b << fraction);
        let square = BigInt::from_biguint(rest.sign(), rest.magnitude() * rest.magnitude());
        ((&self.q * self.root) << (2 * fraction)).cmp(&square)
    }

    /// `root sqrt(q) 2^places`, off by less than 1.
    fn scaled_root(&self, places: u64) -> BigInt {
        (&self.q << (2 * places)).sqrt() * self.root
    }

    /// Distance in units of the direction's length.
    pub(super) fn distance(&self) -> Twofold {
        let b = &self.b << PLACES;
        let root = (&self.q << (2 * PLACES)).sqrt();
        // The form in which nothing cancels.
        let near = self.root < 0 || self.b.sign() == Sign::Minus;
        let (over, under) = if near {
            let sum = if self.root < 0 { b + root } else { root - b };
            ((self.c.magnitude() << PLACES).into(), sum)
        } else {
            (b + root, &self.a << PLACES)
        };
        quotient(over, &under, self.units.length - self.units.direction)
    }

    /// Outward unit normal where the ray hits.
    pub(super) fn normal(&self) -> [Twofold; 3] {
        let root = self.scaled_root(PLACES);
        let under = (&self.a * &self.radius) << PLACES;
        std::array::from_fn(|i| {
            let across = &self.a * &self.from_center[i] + &self.b * &self.direction[i];
            quotient((across << PLACES) + &root * &self.direction[i], &under, 0)
        })
    }

    /// Half of the chord, squared.
    pub(super) fn half_chord2(&self) -> f64 {
        quotient(self.q.clone(), &self.a, 2 * self.units.length).high
    }
}

fn dot(a: &[BigInt; 3], b: &[BigInt; 3]) -> BigInt {
    &a[0] * &b[0] + &a[1] * &b[1] + &a[2] * &b[2]
}

/// `over / under 2^exponent`, `under` more than 0.
fn quotient(over: BigInt, under: &BigInt, exponent: i32) -> Twofold {
    let (sign, over) = over.into_parts();
    // 106 bits at least, 107 at most.
    let shift = 106 + under.bits() as i64 - over.bits() as i64;
    let quotient: u128 = if shift >= 0 {
        (over << shift as u64) / under.magnitude()
    } else {
        over / (under.magnitude() << -shift as u64)
    }
    .try_into()
    .unwrap_or(0);
    let (high, low) = ((quotient >> 54) as f64, (quotient & ((1 << 54) - 1)) as f64);
    let sign = if sign == Sign::Minus { -1.0 } else { 1.0 };
    let exponent = i64::from(exponent) - shift;
    Twofold { high: scaled(sign * high, exponent + 54), low: scaled(sign * low, exponent) }
}

/// `x 2^exponent` in two steps, neither of which leaves the range where the result does not.
fn scaled(x: f64, exponent: i64) -> f64 {
    let exponent = exponent.clamp(-2000, 2000) as i32;
    x * f64::from(exponent / 2).exp2() * f64::from(exponent - exponent / 2).exp2()
}

/// Significand and exponent of a finite number.
fn parts(x: f32) -> (u32, i32) {
    let (fraction, biased) = (x.to_bits() & 0x7f_ffff, (x.to_bits() >> 23 & 0xff) as i32);
    if biased == 0 { (fraction, -149) } else { (fraction | 0x80_0000, biased - 150) }
}

/// Significand, with the sign, and exponent of a finite number.
fn parts_of_double(x: f64) -> (i64, i32) {
    let (fraction, biased) = ((x.to_bits() << 12 >> 12) as i64, (x.to_bits() >> 52 & 0x7ff) as i32);
    let (significand, exponent) =
        if biased == 0 { (fraction, -1074) } else { (fraction | 1 << 52, biased - 1075) };
    (if x < 0.0 { -significand } else { significand }, exponent)
}

/// `x 2^-exponent`, which is whole.
fn whole(x: f32, exponent: i32) -> BigInt {
    let (significand, own) = parts(x);
    let zeros = significand.trailing_zeros() as i32;
    if significand == 0 {
        return BigInt::ZERO;
    }
    let magnitude = BigInt::from(significand >> zeros) << (own + zeros - exponent) as u32;
    if x < 0.0 { -magnitude } else { magnitude }
}

/// The exponent of the lowest bit of all; 0 if all numbers are 0.
fn least<'a>(numbers: impl IntoIterator<Item = &'a f32>) -> i32 {
    let nonzero = numbers.into_iter().filter(|x| **x != 0.0);
    let lowest = nonzero.map(|&x| {
        let (significand, exponent) = parts(x);
        exponent + significand.trailing_zeros() as i32
    });
    lowest.min().unwrap_or(0)
}

#[cfg(test)]
mod tests;
