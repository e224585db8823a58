//! Smooth glass: reflection and refraction at an interface.

use super::fresnel;
use crate::color::Rgb;
use crate::lanes::Doubles;
use crate::vec3::Vec3;

/// A row of the table of glasses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dielectric {
    /// Index of refraction.
    pub ior: f32,
    /// Factor on what passes.
    pub color: Rgb,
}

/// A ray at the surface of a glass sphere, or a row of them.
#[derive(Clone, Copy, Debug)]
pub struct Interface<D> {
    /// Direction of the ray, of any length.
    pub direction: Vec3<D>,
    /// Outward unit normal.
    pub normal: Vec3<D>,
    /// Index of refraction of the sphere.
    pub ior_inside: D,
    /// Index of refraction outside of the sphere; 0 if another sphere decides the medium on both sides,
    /// so that the interface does not exist.
    pub ior_outside: D,
    /// A random number in [0, 1) that decides whether the ray is reflected.
    pub choice: D,
}

/// A reflected or refracted ray.
#[derive(Clone, Copy, Debug)]
pub struct RefractedRay<D: Doubles> {
    /// Direction of the ray, a unit vector.
    pub direction: Vec3<D>,
    /// True where the ray is inside the sphere.
    pub inward: D::Mask,
}

/// Reflects or refracts a ray at the surface of a glass sphere.
///
/// The probability of reflection is the reflectance, so the weight of the ray does not change.
#[inline(always)]
pub fn scatter<D: Doubles>(interface: &Interface<D>) -> RefractedRay<D> {
    let Interface { direction, normal, ior_inside, ior_outside, choice } = *interface;
    let direction = direction * direction.inverse_length();
    let entering = direction.dot_unfused(normal).lt(D::splat(0.0));
    let from = D::select(entering, ior_outside, ior_inside);
    let eta = from / D::select(entering, ior_inside, ior_outside);
    let facing = Vec3::select(entering, normal, -normal);
    let (sent, through) = refract(direction, facing, eta, choice);
    let real = D::splat(0.0).lt(ior_outside);
    let across = through | !real;
    RefractedRay {
        direction: Vec3::select(real, sent, direction),
        inward: (entering & across) | (!entering & !across),
    }
}

/// Reflects or refracts at an interface with unit normal `facing`, against the ray. Returns the
/// direction, and whether the ray is refracted.
#[inline(always)]
fn refract<D: Doubles>(
    direction: Vec3<D>,
    facing: Vec3<D>,
    eta: D,
    choice: D,
) -> (Vec3<D>, D::Mask) {
    let cosine = clamp(-direction.dot_unfused(facing));
    let (reflected, refracted) = fresnel::dielectric(cosine, eta);
    let back = choice.lt(reflected);
    let mirrored = direction + facing * (D::splat(2.0) * cosine);
    let bent = direction * eta + facing * (eta * cosine - refracted);
    let sent = Vec3::select(back, mirrored, bent);
    (sent * sent.inverse_length(), !back)
}

/// Clamps to 0..=1.
#[inline(always)]
fn clamp<D: Doubles>(x: D) -> D {
    let (zero, one) = (D::splat(0.0), D::splat(1.0));
    let x = D::select(x.lt(zero), zero, x);
    D::select(one.lt(x), one, x)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lanes::{F64x8, Mask};
    use crate::shade::tests::numbers;
    use glam::DVec3;

    fn refract_or_reflect(direction: DVec3, normal: DVec3, eta: f64, choice: f64) -> (DVec3, bool) {
        let (sent, through) = refract(direction.into(), normal.into(), eta, choice);
        (DVec3::new(sent.x, sent.y, sent.z), through)
    }

    #[test]
    fn refraction_obeys_snell_and_keeps_to_the_plane() {
        let normal = DVec3::Z;
        for degrees in [1.0, 30.0, 60.0, 89.0] {
            let (sin, cos) = f64::to_radians(degrees).sin_cos();
            let direction = DVec3::new(sin, 0.0, -cos);
            // A choice of 1 reflects only by total internal reflection.
            let (refracted, through) = refract_or_reflect(direction, normal, 1.0 / 1.5, 1.0);
            assert!(through && refracted.y == 0.0 && refracted.z < 0.0);
            assert!((refracted.x * 1.5 - sin).abs() < 1e-14);
            let (reflected, through) = refract_or_reflect(direction, normal, 1.0 / 1.5, 0.0);
            assert!(!through && (reflected - DVec3::new(sin, 0.0, cos)).length() < 1e-14);
        }
        let grazing = DVec3::new(0.9, 0.0, -(1.0_f64 - 0.81).sqrt());
        assert!(!refract_or_reflect(grazing, normal, 1.5, 0.999_999).1, "total reflection");
    }

    #[test]
    fn rows_equal_their_lanes() {
        let draws: Vec<[f64; 3]> =
            numbers(5, 24).map(|u| u.map(|x| 2.0 * f64::from(x) - 1.0)).collect();
        let interface = |lane: usize| {
            let [a, b, c] = [draws[lane], draws[lane + 8], draws[lane + 16]];
            let around = [1.0, 0.0, 1.33, 2.4][lane % 4];
            let normal = DVec3::from(b).normalize();
            Interface {
                direction: DVec3::from(a).into(),
                normal: normal.into(),
                ior_inside: 1.5,
                ior_outside: around,
                choice: c[0].abs(),
            }
        };
        let one: [Interface<f64>; 8] = std::array::from_fn(interface);
        let row = |of: fn(&Interface<f64>) -> f64| F64x8::new(one.each_ref().map(of));
        let together = scatter(&Interface {
            direction: Vec3::new(
                row(|m| m.direction.x),
                row(|m| m.direction.y),
                row(|m| m.direction.z),
            ),
            normal: Vec3::new(row(|m| m.normal.x), row(|m| m.normal.y), row(|m| m.normal.z)),
            ior_inside: row(|m| m.ior_inside),
            ior_outside: row(|m| m.ior_outside),
            choice: row(|m| m.choice),
        });
        let direction = together.direction.map(F64x8::to_array);
        for (lane, interface) in one.iter().enumerate() {
            let alone = scatter(interface);
            let sent = Vec3::new(direction.x[lane], direction.y[lane], direction.z[lane]);
            assert_eq!(sent, alone.direction, "{lane}");
            assert_eq!(together.inward.bits() >> lane & 1 == 1, alone.inward, "{lane}");
            if interface.ior_outside == 0.0 {
                let scale = interface.direction.inverse_length();
                assert_eq!(alone.direction, interface.direction * scale, "what is not there");
                assert_eq!(alone.inward, interface.direction.dot_unfused(interface.normal) < 0.0);
            }
        }
    }
}
