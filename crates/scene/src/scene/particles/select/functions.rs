//! Functions of numbers.

use crate::elementary::{exp, ln, log10, pow};

/// A function of the numbers of a row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Function {
    Abs,
    Sqrt,
    Exp,
    /// The natural logarithm.
    Log,
    Log10,
    Min,
    Max,
    /// The length of a vector.
    Norm,
    /// The first number to the power of the second; written as an operator.
    Power,
}

/// All functions that have a name.
const NAMES: [(&str, Function); 8] = [
    ("abs", Function::Abs),
    ("sqrt", Function::Sqrt),
    ("exp", Function::Exp),
    ("log", Function::Log),
    ("log10", Function::Log10),
    ("min", Function::Min),
    ("max", Function::Max),
    ("norm", Function::Norm),
];

impl Function {
    /// Returns the function with a name, in any case.
    pub(super) fn named(name: &str) -> Option<Self> {
        NAMES.iter().find(|(own, _)| own.eq_ignore_ascii_case(name)).map(|(_, function)| *function)
    }

    /// Returns the names of all functions.
    pub(super) fn names() -> impl Iterator<Item = &'static str> + Clone {
        NAMES.iter().map(|(name, _)| *name)
    }

    /// Returns what the function takes, if it does not take so many numbers.
    pub(super) fn refuse(self, count: usize) -> Option<&'static str> {
        match self {
            Self::Min | Self::Max => {
                (count < 2).then_some("two numbers or more of each particle, as in `max(x, y)`")
            }
            Self::Norm => (count != 3)
                .then_some("a vector or three numbers, as in `norm(velocity)` and `norm(x, y, z)`"),
            Self::Power => (count != 2).then_some("two numbers"),
            _ => (count != 1).then_some("one number, as in `sqrt(x)`"),
        }
    }

    /// Returns the value of the function; NaN if one of the numbers is.
    pub(super) fn of(self, mut numbers: impl Iterator<Item = f64>) -> f64 {
        let mut next = || numbers.next().unwrap_or(f64::NAN);
        match self {
            Self::Abs => next().abs(),
            Self::Sqrt => next().sqrt(),
            Self::Exp => exp(next()),
            Self::Log => ln(next()),
            Self::Log10 => log10(next()),
            Self::Power => {
                let base = next();
                power(base, next())
            }
            Self::Norm => numbers.map(|number| number * number).sum::<f64>().sqrt(),
            Self::Min => {
                numbers.reduce(|a, b| if a.is_nan() || a < b { a } else { b }).unwrap_or(f64::NAN)
            }
            Self::Max => {
                numbers.reduce(|a, b| if a.is_nan() || a > b { a } else { b }).unwrap_or(f64::NAN)
            }
        }
    }
}

/// Returns a power; a missing base or exponent gives none, though `pow` has 1 for the power of 0.
fn power(base: f64, exponent: f64) -> f64 {
    if base.is_nan() || exponent.is_nan() { f64::NAN } else { pow(base, exponent) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn functions_have_their_values() {
        let e = std::f64::consts::E;
        for (name, numbers, expected) in [
            ("abs", &[-2.0][..], 2.0),
            ("SQRT", &[9.0], 3.0),
            ("exp", &[1.0], e),
            ("log", &[e], 1.0),
            ("log10", &[1000.0], 3.0),
            ("min", &[2.0, -1.0, 5.0], -1.0),
            ("max", &[2.0, -1.0, 5.0], 5.0),
            ("norm", &[2.0, 3.0, 6.0], 7.0),
        ] {
            let function = Function::named(name).expect("a function");
            let value = function.of(numbers.iter().copied());
            assert!((value - expected).abs() < 1e-14, "{name}: {value}");
            assert_eq!(function.refuse(numbers.len()), None, "{name}");
            assert!(function.refuse(0).is_some(), "{name}");
            for missing in 0..numbers.len() {
                let mut numbers = numbers.to_vec();
                numbers[missing] = f64::NAN;
                assert!(function.of(numbers.into_iter()).is_nan(), "{name} {missing}");
            }
        }
        assert_eq!(Function::Power.of([-2.0, 3.0].into_iter()), -8.0);
        assert!(Function::Power.of([f64::NAN, 0.0].into_iter()).is_nan());
        assert!(Function::Power.of([1.0, f64::NAN].into_iter()).is_nan());
        assert_eq!(Function::named("sin"), None);
    }
}
