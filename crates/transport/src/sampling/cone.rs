//! Cones of directions: the directions from a point to a sphere or a sun.

use super::warp::cap;
use crate::elementary::sin;
use crate::lanes::{Doubles, F32x16, F64x8, Lanes, MAX_LANES, Mask, narrow};
use crate::vec3;
use glam::Vec3;
use std::f64::consts::PI;

/// A cone about local +z in which directions are uniform by solid angle.
///
/// Stores 1 - cos of the half-angle, which is exact even if the cosine itself would round to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cone<L = f32> {
    /// 1 - cos of the half-angle, more than 0, at most 2.
    height: L,
    /// Per steradian.
    pdf: L,
}

impl Cone {
    /// Returns the cone of directions to a sphere of `radius` whose center is at a distance of the
    /// square root of `distance2`; both in one unit, of any size. `None` for a point on or in the
    /// sphere, for a radius that is not more than 0 and for a distance that is not finite.
    ///
    /// Cones of less than about 1e-37 steradian are widened to that, so that the density stays finite.
    pub fn toward_sphere(distance2: f64, radius: f64) -> Option<Self> {
        let (outside, height) = toward_sphere(distance2, radius);
        outside.then(|| Self::from_height(height))
    }

    /// Returns the cone of a half-angle in radians, 0 < angle <= pi.
    pub fn from_half_angle(angle: f64) -> Self {
        let sine = sin(0.5 * angle);
        Self::from_height(2.0 * sine * sine)
    }

    fn from_height(height: f64) -> Self {
        let [height, pdf] = measures(height);
        Self { height: height as f32, pdf: pdf as f32 }
    }

    /// Samples a unit direction in the cone from two numbers in [0, 1).
    #[inline]
    pub fn sample(&self, u: [f32; 2]) -> Vec3 {
        self.sample_row(u).into()
    }

    /// [`Cone::sample`] for a row of numbers.
    #[inline(always)]
    pub fn sample_row<L: Lanes>(&self, u: [L; 2]) -> vec3::Vec3<L> {
        cap(u, L::splat(self.height))
    }

    /// Returns the density of [`Cone::sample`] per steradian, uniform in the cone and always finite.
    #[inline]
    pub fn pdf(&self) -> f32 {
        self.pdf
    }

    /// Returns 1 - cos of the half-angle.
    #[inline]
    pub fn height(&self) -> f32 {
        self.height
    }
}

impl Cone<F32x16> {
    /// [`Cone::toward_sphere`] in lanes; also returns the lanes that have a cone.
    #[inline(always)]
    pub fn toward_spheres(distance2: [F64x8; 2], radius: [F64x8; 2]) -> (Self, u32) {
        let [(low, a), (high, b)] = [0, 1].map(|half| toward_sphere(distance2[half], radius[half]));
        let [[a, a_pdf], [b, b_pdf]] = [a, b].map(measures);
        let cones = Self { height: narrow([a, b]), pdf: narrow([a_pdf, b_pdf]) };
        (cones, low.bits() | high.bits() << 8)
    }

    /// Returns cones in lanes.
    #[inline(always)]
    pub fn row(each: &[Cone; MAX_LANES]) -> Self {
        let column = |of: fn(&Cone) -> f32| F32x16::new(each.each_ref().map(of));
        Self { height: column(Cone::height), pdf: column(Cone::pdf) }
    }

    /// [`Cone::sample`] in lanes.
    #[inline(always)]
    pub fn sample_each(&self, u: [F32x16; 2]) -> vec3::Vec3<F32x16> {
        cap(u, self.height)
    }

    /// [`Cone::pdf`] in lanes.
    #[inline(always)]
    pub fn pdfs(&self) -> F32x16 {
        self.pdf
    }
}

/// Returns whether a point is outside of a sphere, and 1 - cos of the half-angle of the directions to
/// it.
#[inline(always)]
fn toward_sphere<D: Doubles>(distance2: D, radius: D) -> (D::Mask, D) {
    let (zero, one) = (D::splat(0.0), D::splat(1.0));
    let distance = distance2.sqrt();
    let outside = zero.lt(radius) & radius.lt(distance) & distance2.lt(D::splat(f64::INFINITY));
    let sine = radius / distance;
    let cosine2 = (distance - radius) / distance * ((distance + radius) / distance);
    (outside, sine * sine / (one + cosine2.sqrt()))
}

/// Returns height and density of a cone whose 1 - cos is `height`, or the minimum.
#[inline(always)]
fn measures<D: Doubles>(height: D) -> [D; 2] {
    let least = D::splat(f64::from(f32::MIN_POSITIVE));
    let height = D::select(height.lt(least), least, height);
    [height, D::splat(1.0) / (D::splat(2.0 * PI) * height)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::hash::ONE_BELOW;
    use crate::sampling::statistics::{Grid, random_pairs};
    use glam::DVec3;

    fn toward(radius: f64, distance: f64) -> Cone {
        Cone::toward_sphere(distance * distance, radius).expect("the point is outside")
    }

    #[test]
    fn densities_in_closed_form() {
        let truths = [
            (0.9, 0.282_134_536_3),
            (0.5, 1.187_948_668),
            (0.1, 31.751_211_20),
            (0.02, 795.695_130_0),
            (1e-3, 318_309.806_6),
            (1e-5, 3_183_098_861.8),
        ];
        for (sine, truth) in truths {
            for scale in [1.0, 1e-30, 1e38, 3.7e5] {
                let pdf = f64::from(toward(sine * scale, scale).pdf());
                assert!((pdf / truth - 1.0).abs() < 1e-7, "{sine} at {scale}: {pdf}");
            }
        }
    }

    #[test]
    fn density_is_exact_from_near_to_far() {
        for i in 0..=500 {
            let sine = 0.99 * (1e-6_f64 / 0.99).powf(f64::from(i) / 500.0);
            let cone = toward(sine, 1.0);
            // 1 - cos = 2 sin^2(angle / 2), a form that has no cancellation either.
            let height = 2.0 * (0.5 * sine.asin()).sin().powi(2);
            let pdf = 1.0 / (2.0 * PI * height);
            assert!((f64::from(cone.pdf()) / pdf - 1.0).abs() < 3e-7, "{sine}");
            assert!((f64::from(cone.height()) / height - 1.0).abs() < 1e-7, "{sine}");
        }
    }

    fn check(cone: Cone, angle: f64) {
        let samples = random_pairs(400_000, 3).map(|u| Some(cone.sample(u)));
        Grid::cone(Vec3::Z, angle).check(samples, |_| cone.pdf(), Some(0.0));
    }

    #[test]
    fn directions_follow_the_density() {
        for sine in [0.9999, 0.9, 0.5, 0.1, 1e-3] {
            let cone = toward(sine, 1.0);
            // The cosine of a narrow cone is not resolved by f32, but its density does not need it.
            check(cone, sine.asin());
        }
        for angle in [1e-3, 0.1, 0.5 * PI, 0.9 * PI, PI] {
            check(Cone::from_half_angle(angle), angle);
        }
    }

    #[test]
    fn directions_stay_in_the_cone() {
        for sine in [0.99, 0.3, 1e-2, 1e-6] {
            let cone = toward(sine, 1.0);
            for u in random_pairs(2000, 4).chain([[0.0, 0.0], [ONE_BELOW, 0.0]]) {
                let lateral = cone.sample(u).truncate().length();
                assert!(f64::from(lateral) <= sine * (1.0 + 3e-7), "{sine}: {lateral}");
            }
        }
    }

    #[test]
    fn points_on_or_in_the_sphere_and_bad_numbers() {
        for (distance2, radius) in [(1.0, 1.0), (0.25, 1.0), (0.0, 0.0), (1.0, -1.0)] {
            assert_eq!(Cone::toward_sphere(distance2, radius), None);
        }
        for (distance2, radius) in [(f64::NAN, 1.0), (1.0, f64::NAN), (f64::INFINITY, 1.0)] {
            assert_eq!(Cone::toward_sphere(distance2, radius), None);
        }
        assert!(Cone::toward_sphere(1.0, 1e-300).is_some_and(|cone| cone.pdf().is_finite()));
        let touching = toward(1.0, 1.0 + 1e-12);
        assert!((touching.pdf() - 1.0 / (2.0 * PI) as f32).abs() < 1e-5);
    }

    /// Irradiance over pi of a sphere of radiance 1, in closed forms of its form factor.
    #[test]
    fn irradiance_of_a_sphere_in_closed_form() {
        let truths = [
            (1.0, 3.0, 0.0, 0.111_111_111_1),
            (1.0, 3.0, 60.0, 0.055_555_555_6),
            (1.0, 2.0, 50.0, 0.160_696_902_4),
            (1.0, 2.0, 75.0, 0.070_410_427_0),
            (1.0, 2.0, 90.0, 0.028_834_442_8),
            (1.0, 2.0, 100.0, 0.011_283_772_0),
            (0.01, 10.0, 30.0, 8.660_254_038e-7),
            (1.0, 1.0001, 0.0, 0.999_800_030_0),
            (1.0, 1.0001, 90.0, 0.490_997_812_1),
            (1.0, 1.1, 120.0, 0.068_184_490_8),
        ];
        for (radius, distance, degrees, truth) in truths {
            let (mean, error) = form_factor(toward(radius, distance), f64::to_radians(degrees));
            let allowed = 5.0 * error + 1e-6 * truth;
            assert!((mean - truth).abs() < allowed, "{radius} {distance} {degrees}: {mean}");
        }
    }

    /// Returns the estimate and its standard error, for a receiver tilted by `angle` from the cone's
    /// axis.
    fn form_factor(cone: Cone, angle: f64) -> (f64, f64) {
        const COUNT: f64 = 100_000.0;
        let normal = DVec3::new(angle.sin(), 0.0, angle.cos());
        let (mut sum, mut squares) = (0.0, 0.0);
        for u in random_pairs(COUNT as u64, 8) {
            let cosine = normal.dot(cone.sample(u).as_dvec3()).max(0.0);
            let value = cosine / (PI * f64::from(cone.pdf()));
            sum += value;
            squares += value * value;
        }
        let mean = sum / COUNT;
        (mean, ((squares / COUNT - mean * mean).max(0.0) / COUNT).sqrt())
    }

    #[test]
    fn rows_are_what_their_lanes_are() {
        let distance2: [[f64; 8]; 2] = [0, 1]
            .map(|half| std::array::from_fn(|i| 1.0 + 0.7 * ((i * 5 + half * 3) % 11) as f64));
        // In some lanes the point is inside.
        let radius: [[f64; 8]; 2] =
            [0, 1].map(|half| std::array::from_fn(|i| if (i + half) % 3 == 0 { 9.0 } else { 0.9 }));
        let (row, outside) =
            Cone::toward_spheres(distance2.map(F64x8::new), radius.map(F64x8::new));
        for (lane, pdf) in row.pdfs().to_array().into_iter().enumerate() {
            let (half, i) = (lane / 8, lane % 8);
            let alone = Cone::toward_sphere(distance2[half][i], radius[half][i]);
            assert_eq!(alone.is_some(), outside >> lane & 1 == 1, "{lane}");
            assert!(alone.is_none_or(|cone| cone.pdf() == pdf), "{lane}");
        }
    }
}
