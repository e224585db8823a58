//! Distances to 120 digits, on integers: nothing of the crate that is tested.
//!
//! Every number of single precision is a multiple of 2^-149, so coordinates, radii and directions in that
//! unit are integers, and so are `a = d.d`, `b = -F.d`, `c = F.F - r^2` and `q = b^2 - a c`, with `F` from
//! the center to the origin. The distance is `(b -+ sqrt(q)) / a`.

use num_bigint::{BigInt, Sign};
use std::cmp::Ordering;

/// A row of x, y, z and radius.
pub(crate) type Sphere = [f32; 4];

/// Origin and direction.
pub(crate) type Ray = ([f32; 3], [f32; 3]);

/// Binary digits of distances, at least: 120 decimal ones.
const DIGITS: u64 = 400;

/// The hit of a ray and a sphere.
pub(crate) struct Reference {
    a: BigInt,
    b: BigInt,
    q: BigInt,
    /// True for the near one of the two distances.
    near: bool,
    /// The distance times 2^`places`, off by less than 2, with [`DIGITS`] or more.
    digits: BigInt,
    places: u64,
}

impl Reference {
    /// Intersects a ray with a sphere; `None` if the ray misses. All numbers are finite.
    pub(crate) fn new((origin, direction): Ray, [x, y, z, radius]: Sphere) -> Option<Self> {
        let center = [x, y, z];
        let from_center: [BigInt; 3] =
            std::array::from_fn(|i| multiple(origin[i]) - multiple(center[i]));
        let (direction, radius) = (direction.map(multiple), multiple(radius));
        let dot = |u: &[BigInt; 3], v: &[BigInt; 3]| -> BigInt {
            u.iter().zip(v).map(|(x, y)| x * y).sum()
        };
        let (a, b) = (dot(&direction, &direction), -dot(&from_center, &direction));
        let c = dot(&from_center, &from_center) - &radius * &radius;
        let q = &b * &b - &a * &c;
        let near = c.sign() == Sign::Plus;
        let heads_in = b.sign() == Sign::Plus;
        let hits = match c.sign() {
            Sign::Plus => heads_in && q.sign() != Sign::Minus,
            Sign::NoSign => heads_in,
            Sign::Minus => a.sign() == Sign::Plus,
        };
        if !hits {
            return None;
        }
        let mut reference = Self { a, b, q, near, digits: BigInt::ZERO, places: 0 };
        while reference.digits.bits() < DIGITS {
            reference.places += DIGITS + 64 - reference.digits.bits();
            reference.digits = reference.rounded();
        }
        Some(reference)
    }

    /// The distance times 2^places, off by less than 2.
    fn rounded(&self) -> BigInt {
        let root = (&self.q << (2 * self.places)).sqrt();
        let root = if self.near { -root } else { root };
        ((&self.b << self.places) + root) / &self.a
    }

    /// The double that is nearest to the distance; of two the even one.
    pub(crate) fn nearest(&self) -> f64 {
        let surplus = self.digits.bits() - 53;
        let down = &self.digits >> surplus;
        let mantissa = u64::try_from(&down).expect("53 bits");
        // At least two powers of two, each of which double precision has.
        let exponent = surplus as i32 - self.places as i32;
        let scaled = |mantissa: u64| {
            mantissa as f64 * 2_f64.powi(exponent / 2) * 2_f64.powi(exponent - exponent / 2)
        };
        let (low, high) = (scaled(mantissa), scaled(mantissa + 1));
        let middle = (&down * 2 + 1) << (surplus - 1);
        match self.compare_scaled(&middle) {
            Ordering::Less => low,
            Ordering::Equal if mantissa % 2 == 0 => low,
            Ordering::Equal | Ordering::Greater => high,
        }
    }

    /// How far a number is from the distance, in units of the number's last place.
    pub(crate) fn error(&self, t: f64) -> f64 {
        let (mantissa, exponent) = parts(t);
        let shift =
            u64::try_from(exponent + self.places as i64).expect("more places than the number");
        let error = (BigInt::from(mantissa) << shift) - &self.digits;
        let parts = (error.magnitude() << 64_u32) >> shift;
        u128::try_from(parts).map_or(f64::INFINITY, |parts| parts as f64) / 2_f64.powi(64)
    }

    /// Compares the distance with a finite number, exactly.
    pub(crate) fn compare(&self, number: f64) -> Ordering {
        let (mantissa, exponent) = parts(number);
        let places = (-exponent).max(0) as u64;
        let scaled = BigInt::from(mantissa) << (exponent.max(0) as u64);
        self.compare_with(&scaled, places)
    }

    /// Compares the distance times 2^places with an integer, exactly.
    fn compare_scaled(&self, number: &BigInt) -> Ordering {
        self.compare_with(number, self.places)
    }

    /// -+sqrt(q) against a x - b, times 2^places, by their squares with the signs.
    fn compare_with(&self, x: &BigInt, places: u64) -> Ordering {
        let rest = &self.a * x - (&self.b << places);
        let rest = if rest.sign() == Sign::Minus { -(&rest * &rest) } else { &rest * &rest };
        let root = &self.q << (2 * places);
        let root = if self.near { -root } else { root };
        root.cmp(&rest)
    }

    /// Compares the distances of two hits of one ray, exactly but for 2^-390 of them.
    pub(crate) fn is_before(&self, other: &Self) -> bool {
        let places = self.places.max(other.places);
        let aligned = |hit: &Self| &hit.digits << (places - hit.places);
        let (difference, size) = (aligned(other) - aligned(self), aligned(other));
        difference.sign() == Sign::Plus && difference.bits() + 390 > size.bits()
    }
}

/// A number as a multiple of 2^-149.
fn multiple(x: f32) -> BigInt {
    let (fraction, biased) = (x.to_bits() & 0x7f_ffff, x.to_bits() >> 23 & 0xff);
    let magnitude = match biased {
        0 => BigInt::from(fraction),
        _ => BigInt::from(fraction | 0x80_0000) << (biased - 1),
    };
    if x < 0.0 { -magnitude } else { magnitude }
}

/// Mantissa and exponent of a number; the exponent is that of its last place.
fn parts(x: f64) -> (i64, i64) {
    let (fraction, biased) = ((x.to_bits() << 12 >> 12) as i64, (x.to_bits() >> 52 & 0x7ff) as i64);
    let (mantissa, exponent) =
        if biased == 0 { (fraction, -1074) } else { (fraction | 1 << 52, biased - 1075) };
    (if x < 0.0 { -mantissa } else { mantissa }, exponent)
}

#[test]
fn the_reference_knows_what_is_known() {
    // From the center of a sphere of radius 1 along (1, 1, 0): 1 / sqrt(2), to 60 digits of OEIS A010503.
    let hit = Reference::new(([0.0; 3], [1.0, 1.0, 0.0]), [0.0, 0.0, 0.0, 1.0]).unwrap();
    let digits = "707106781186547524400844362104849039284835937688474036588339";
    let scaled = (&hit.digits * BigInt::from(10).pow(60)) >> hit.places;
    assert_eq!(scaled.to_string(), digits);
    assert_eq!(hit.nearest(), std::f64::consts::FRAC_1_SQRT_2);
    assert_eq!(hit.compare(std::f64::consts::FRAC_1_SQRT_2), Ordering::Less);
    assert_eq!(hit.compare(std::f64::consts::FRAC_1_SQRT_2.next_down()), Ordering::Greater);
    assert!((hit.error(hit.nearest().next_up()) - 1.435).abs() < 1e-3);
    // A rational one, and a tie: (2^53 + 1) / 2^53 is between two doubles.
    let ahead = Reference::new(([-3.0, 0.0, 0.0], [0.5, 0.0, 0.0]), [0.0, 0.0, 0.0, 1.0]).unwrap();
    assert_eq!(
        (ahead.nearest(), ahead.error(4.0), ahead.error(4.0_f64.next_up())),
        (4.0, 0.0, 1.0)
    );
    assert_eq!(ahead.compare(4.0), Ordering::Equal);
    let tiny = 53_f32.exp2().recip();
    let tie = Reference::new(([-1.0, 0.0, 0.0], [1.0, 0.0, 0.0]), [tiny * 2.0, 0.0, 0.0, tiny]);
    let tie = tie.unwrap();
    assert_eq!((tie.nearest(), tie.error(1.0), tie.error(1.0_f64.next_up())), (1.0, 0.5, 0.5));
    assert!(tie.is_before(&ahead) && !ahead.is_before(&tie) && !tie.is_before(&tie));
}
