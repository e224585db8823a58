//! Fixed-point numbers with 150 decimal places, the reference of tests.

use glam::DVec3;
use num_bigint::BigInt;

/// Binary places of the reference.
pub(crate) const PLACES: u64 = 512;

/// A fixed-point number.
#[derive(Clone, Debug, PartialEq, PartialOrd)]
pub(crate) struct Fixed(pub(crate) BigInt);

impl Fixed {
    pub(crate) fn new(x: f64) -> Self {
        // A multiple of 2^-149, of at most 53 bits.
        let (mut places, mut x) = (PLACES, x);
        while x.fract() != 0.0 {
            (places, x) = (places - 1, x * 2.0);
        }
        Self(BigInt::from(x as i128) << places)
    }

    pub(crate) fn times(&self, other: &Self) -> Self {
        Self((&self.0 * &other.0) >> PLACES)
    }

    pub(crate) fn over(&self, other: &Self) -> Self {
        Self((&self.0 << PLACES) / &other.0)
    }

    pub(crate) fn plus(&self, other: &Self) -> Self {
        Self(&self.0 + &other.0)
    }

    pub(crate) fn minus(&self, other: &Self) -> Self {
        Self(&self.0 - &other.0)
    }

    pub(crate) fn root(&self) -> Self {
        Self((&self.0 << PLACES).sqrt())
    }

    pub(crate) fn is_negative(&self) -> bool {
        self.0.sign() == num_bigint::Sign::Minus
    }

    pub(crate) fn to_f64(&self) -> f64 {
        let surplus = self.0.bits().saturating_sub(80);
        let top = i128::try_from(&self.0 >> surplus).unwrap() as f64;
        top * 2.0_f64.powi((surplus as i64 - PLACES as i64) as i32)
    }
}

pub(crate) type Vector = [Fixed; 3];

pub(crate) fn vector(v: DVec3) -> Vector {
    v.to_array().map(Fixed::new)
}

pub(crate) fn minus(a: &Vector, b: &Vector) -> Vector {
    std::array::from_fn(|i| a[i].minus(&b[i]))
}

pub(crate) fn dot(a: &Vector, b: &Vector) -> Fixed {
    let product = |i: usize| a[i].times(&b[i]);
    product(0).plus(&product(1)).plus(&product(2))
}

/// The roots of `a t^2 - 2 b t + c`.
pub(crate) fn roots(a: &Fixed, b: &Fixed, c: &Fixed) -> Option<[Fixed; 2]> {
    let discriminant = b.times(b).minus(&a.times(c));
    if discriminant.is_negative() || *a == Fixed::new(0.0) {
        return None;
    }
    let root = discriminant.root();
    Some([b.minus(&root).over(a), b.plus(&root).over(a)])
}
