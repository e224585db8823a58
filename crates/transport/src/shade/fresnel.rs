//! The Fresnel equations.

use crate::lanes::{Doubles, Lanes};

/// Returns the reflectance of a smooth interface for unpolarised light, and the cosine of the refracted
/// direction.
///
/// `cosine` of the incident direction is in 0..=1; `eta` is the index of refraction on the incident
/// side over that on the other. Total internal reflection gives 1 and 0.
#[inline(always)]
pub fn dielectric<D: Doubles>(cosine: D, eta: D) -> (D, D) {
    let one = D::splat(1.0);
    let sine2 = eta * eta * ((one - cosine) * (one + cosine));
    let passes = sine2.lt(one);
    let refracted = (one - sine2).sqrt();
    let s = (eta * cosine - refracted) / (eta * cosine + refracted);
    let p = (cosine - eta * refracted) / (cosine + eta * refracted);
    let reflected = D::splat(0.5) * (s * s + p * p);
    (D::select(passes, reflected, one), D::select(passes, refracted, D::splat(0.0)))
}

/// Returns Schlick's interpolation from the reflectance at normal incidence, 0, to 1 at grazing angles
/// (Schlick, "An Inexpensive BRDF Model for Physically-based Rendering", Computer Graphics Forum 1994).
#[inline(always)]
pub fn schlick_rise<L: Lanes>(cosine: L) -> L {
    let (zero, one) = (L::splat(0.0), L::splat(1.0));
    let x = (one - cosine).max(zero).min(one);
    let x2 = x * x;
    x2 * x2 * x
}

/// Returns the reflectance of a metal of complex index `eta + i k`, relative to the outside, for
/// unpolarised light.
#[inline(always)]
pub fn conductor<D: Doubles>(c: D, eta: D, k: D) -> D {
    let (zero, half, two) = (D::splat(0.0), D::splat(0.5), D::splat(2.0));
    let (c2, s2) = (c * c, D::splat(1.0) - c * c);
    let difference = eta * eta - k * k - s2;
    let a2_plus_b2 = (difference * difference + D::splat(4.0) * eta * eta * k * k).sqrt();
    let a2 = half * (a2_plus_b2 + difference);
    let a = D::select(zero.lt(a2), a2, zero).sqrt();
    let s = (a2_plus_b2 + c2 - two * a * c) / (a2_plus_b2 + c2 + two * a * c);
    let along = c2 * a2_plus_b2 + s2 * s2;
    let across = two * a * c * s2;
    let p = s * (along - across) / (along + across);
    half * (s + p)
}

/// Returns the reflectance of an interface to index `ior` for diffuse light from outside: the
/// cosine-weighted mean of [`dielectric`].
pub fn external_diffuse_reflectance(ior: f64) -> f64 {
    // Midpoints in the squared sine, in which the cosine weight is uniform. The integrand behaves like
    // a square root at grazing angles; with this many points the error is about 1e-6.
    const STEPS: u32 = 4096;
    let reflected = |i: u32| {
        let sine2 = (f64::from(i) + 0.5) / f64::from(STEPS);
        dielectric((1.0 - sine2).sqrt(), 1.0 / ior).0
    };
    (0..STEPS).map(reflected).sum::<f64>() / f64::from(STEPS)
}

/// Returns the reflectance of an interface for diffuse light from inside: `1 - external` enters, and by
/// reciprocity that over `ior^2` leaves.
pub fn internal_diffuse_reflectance(ior: f64) -> f64 {
    1.0 - (1.0 - external_diffuse_reflectance(ior)) / (ior * ior)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Computed from the equations with 50 digits.
    #[test]
    fn glass_reflects_as_by_the_fresnel_equations() {
        let known = [
            (0.0, 0.04),
            (30.0, 0.041_522_626_0),
            (45.0, 0.050_239_911_0),
            // Brewster's angle.
            (1.5_f64.atan().to_degrees(), 0.073_964_497_0),
            (60.0, 0.089_186_712_8),
            (75.0, 0.253_060_563_0),
            (85.0, 0.612_799_645_3),
            (89.0, 0.904_184_949_8),
        ];
        for (degrees, expected) in known {
            let cosine = f64::to_radians(degrees).cos();
            let (reflected, refracted) = dielectric(cosine, 1.0 / 1.5);
            assert!((reflected - expected).abs() < 1e-10, "{degrees}: {reflected}");
            // The reverse path has the same reflectance.
            let (back, incident) = dielectric(refracted, 1.5);
            assert!((back - reflected).abs() < 1e-12 && (incident - cosine).abs() < 1e-12);
        }
    }

    #[test]
    fn reflection_is_total_beyond_the_critical_angle() {
        let critical = (1.0 / 1.5_f64).asin();
        assert_eq!(dielectric((critical + 1e-3).cos(), 1.5), (1.0, 0.0));
        assert!(dielectric((critical - 1e-3).cos(), 1.5).0 < 1.0);
        assert_eq!(dielectric(0.0, 1.5), (1.0, 0.0));
        assert_eq!(dielectric(0.0, 1.0 / 1.5).0, 1.0);
    }

    #[test]
    fn no_interface_reflects_nothing() {
        for cosine in [1.0, 0.5, 0.01] {
            assert!(dielectric(cosine, 1.0).0 < 1e-24);
        }
    }

    #[test]
    fn mean_reflectance_of_a_diffuse_environment() {
        let known = [(1.33, 0.065_930_849_3), (1.5, 0.091_777_959_3), (2.4, 0.210_181_302_0)];
        for (ior, expected) in known {
            assert!((external_diffuse_reflectance(ior) - expected).abs() < 2e-6);
        }
    }

    #[test]
    fn a_conductor_without_absorption_is_a_dielectric() {
        for cosine in [1.0, 0.7, 0.3, 0.05] {
            let difference = conductor(cosine, 1.5, 0.0) - dielectric(cosine, 1.0 / 1.5).0;
            assert!(difference.abs() < 1e-6);
        }
    }

    #[test]
    fn gold_is_golden() {
        let [r, g, b] =
            [(0.143, 3.983), (0.375, 2.386), (1.442, 1.603)].map(|(eta, k)| conductor(1.0, eta, k));
        assert!(r > 0.96 && g > 0.75 && g < 0.85 && b < 0.4, "{r} {g} {b}");
    }
}
