//! Emissive spheres as seen from points: discs that fill cones, one at a time or in rows.

use super::row::{LANES, LightLanes, ReceiverRow};
use super::{LightSample, Lights};
use crate::intersect::{self, Pairs};
use crate::lanes::{Doubles, F32x16, F64x8, Mask, set_bits, widen};
use crate::ray::{ExactRay, MISS, rounding};
use crate::sampling::{Bases, Basis, Cone};
use crate::scene::Rgb;
use crate::spheres::Spheres;
use crate::vec3::Vec3;
use glam::DVec3;

/// An emissive sphere as seen from a point: a disc that fills a cone.
pub struct Disc {
    pub(super) row: u32,
    pub(super) basis: Basis,
    pub(super) cone: Cone,
    pub(super) origin: glam::Vec3,
    pub(super) center: DVec3,
    pub(super) radius: f64,
    pub(super) weight: Rgb,
    pub(super) close: bool,
}

/// A sphere as seen from a point, or a row of both.
pub(super) struct SphereView<D: Doubles> {
    /// Unit vector toward the center.
    pub direction: Vec3<D>,
    /// Squared distance of the center.
    pub distance2: D,
    /// True where the center is nearer than the reach, in radii.
    pub close: D::Mask,
}

/// Returns a sphere, by center and radius, as seen from `origin`; close is nearer than `reach` radii.
#[inline(always)]
pub(super) fn toward<D: Doubles>(
    origin: Vec3<D>,
    center: Vec3<D>,
    radius: D,
    reach: f64,
) -> SphereView<D> {
    let toward = center - origin;
    let distance2 = toward.dot_unfused(toward);
    let reach = D::splat(reach) * radius;
    SphereView {
        direction: toward * (D::splat(1.0) / distance2.sqrt()),
        distance2,
        close: distance2.lt(reach * reach),
    }
}

/// Returns sphere `row` as seen from `origin`, and the cone that it fills; `None` from inside.
/// Close is nearer than `reach` radii.
pub(super) fn view_sphere(
    spheres: &Spheres,
    row: usize,
    origin: glam::Vec3,
    reach: f64,
) -> Option<(SphereView<f64>, Cone)> {
    let (center, radius) = (spheres.center(row).as_dvec3(), f64::from(spheres.radius(row)));
    let seen = toward(origin.as_dvec3().into(), center.into(), radius, reach);
    let cone = Cone::toward_sphere(seen.distance2, radius)?;
    Some((seen, cone))
}

impl Disc {
    /// Returns sphere `row`, with this radiance, as seen from `origin`; `None` from inside it. It is
    /// close within `reach` radii of its center.
    pub(super) fn new(
        spheres: &Spheres,
        row: usize,
        radiance: Rgb,
        origin: glam::Vec3,
        reach: f64,
    ) -> Option<Self> {
        let (seen, cone) = view_sphere(spheres, row, origin, reach)?;
        Some(Self {
            row: row as u32,
            basis: Basis::new(seen.direction.map(|x| x as f32).into()),
            origin,
            center: spheres.center(row).as_dvec3(),
            radius: f64::from(spheres.radius(row)),
            weight: radiance / cone.pdf(),
            cone,
            close: seen.close,
        })
    }

    /// Samples a direction toward the disc.
    #[inline]
    pub(super) fn sample(&self, u: [f32; 2]) -> LightSample {
        let direction = self.basis.to_world(self.cone.sample(u));
        LightSample {
            direction,
            t: distance(self.origin, direction, self.center, self.radius),
            target: self.row,
            weight: self.weight,
            pdf: Some(self.cone.pdf()),
            close: self.close,
        }
    }
}

/// Returns the distance from a surface to a sphere, by center and radius. At the edge of the disc
/// rounding may make the ray miss: then, the distance to the ray's nearest point.
pub(super) fn distance(
    origin: glam::Vec3,
    direction: glam::Vec3,
    center: DVec3,
    radius: f64,
) -> f64 {
    let ray = ExactRay::new(origin, direction, true);
    match intersect::confirm(&ray, center, radius, || false) {
        Some(root) => root.t,
        None => (center - ray.origin).dot(ray.direction) / ray.direction.length_squared(),
    }
}

/// Centers, radii and radiance of a row of spheres.
struct SphereRow {
    center: [[f32; LANES]; 3],
    radius: [f32; LANES],
    radiance: [[f32; LANES]; 3],
    target: [u32; LANES],
}

impl Lights {
    /// Samples an emissive sphere for each receiver in `lanes`: `light[lane]`, with two random numbers
    /// in [0, 1). Lanes in or on their light get no sample.
    #[inline(always)]
    pub(super) fn sample_discs(
        &self,
        spheres: &Spheres,
        at: &ReceiverRow,
        light: &[u32; LANES],
        lanes: u32,
        u: [F32x16; 2],
    ) -> LightLanes {
        let row = self.gather(spheres, light, lanes);
        let (origin, center) = (at.point.halves(), row.center().halves());
        let radius = widen(F32x16::new(row.radius));
        let low = toward(origin[0], center[0], radius[0], self.reach);
        let high = toward(origin[1], center[1], radius[1], self.reach);
        let (cone, outside) = Cone::toward_spheres([low.distance2, high.distance2], radius);
        let axis = Vec3::narrow([low.direction, high.direction]);
        let direction = Bases::about(axis).to_world(cone.sample_each(u));
        let own = set_bits(lanes).filter(|&lane| row.target[lane] == at.own[lane]);
        let lanes = own.fold(lanes & outside, |lanes, lane| lanes & !(1 << lane));
        let pdf = cone.pdfs();
        LightLanes {
            direction,
            t: distances(at.point, direction, &center, &radius, lanes),
            target: row.target,
            weight: row.radiance().map(|channel| channel / pdf),
            pdf,
            close: lanes & (low.close.bits() | high.close.bits() << 8),
            lanes,
        }
    }

    #[inline(always)]
    fn gather(&self, spheres: &Spheres, light: &[u32; LANES], lanes: u32) -> SphereRow {
        if let [lone] = self.emitters[..] {
            // Broadcasts: writing lane by lane would stall the load of the row.
            let (center, radiance) = (spheres.center(lone as usize), self.radiance[0]);
            return SphereRow {
                center: center.to_array().map(|x| [x; LANES]),
                radius: [spheres.radius(lone as usize); LANES],
                radiance: radiance.to_array().map(|x| [x; LANES]),
                target: [lone; LANES],
            };
        }
        let mut row = SphereRow {
            center: [[0.0; LANES]; 3],
            radius: [1.0; LANES],
            radiance: [[0.0; LANES]; 3],
            target: [MISS; LANES],
        };
        for lane in set_bits(lanes) {
            let light = light[lane] as usize;
            let sphere = self.emitters[light] as usize;
            let (center, radiance) = (spheres.center(sphere), self.radiance[light]);
            for axis in 0..3 {
                row.center[axis][lane] = center[axis];
                row.radiance[axis][lane] = radiance[axis];
            }
            (row.radius[lane], row.target[lane]) = (spheres.radius(sphere), sphere as u32);
        }
        row
    }
}

impl SphereRow {
    #[inline(always)]
    fn center(&self) -> Vec3<F32x16> {
        columns(&self.center)
    }

    #[inline(always)]
    fn radiance(&self) -> Vec3<F32x16> {
        columns(&self.radiance)
    }
}

#[inline(always)]
fn columns([x, y, z]: &[[f32; LANES]; 3]) -> Vec3<F32x16> {
    Vec3::new(F32x16::new(*x), F32x16::new(*y), F32x16::new(*z))
}

/// Returns the [`distance`] from a surface to a sphere in each of `lanes`.
#[inline(always)]
pub(super) fn distances(
    origin: Vec3<F32x16>,
    direction: Vec3<F32x16>,
    center: &[Vec3<F64x8>; 2],
    radius: &[F64x8; 2],
    lanes: u32,
) -> [f64; LANES] {
    let (from, toward) = (origin.halves(), direction.halves());
    let mut t = [0.0; LANES];
    for half in 0..2 {
        let samples = lanes >> (8 * half) & 0xff;
        if samples == 0 {
            continue;
        }
        let (plain, near) = intersect::confirm_plain(&Pairs {
            origin: from[half],
            direction: toward[half],
            origin_error: rounding(from[half]),
            center: center[half],
            radius: radius[half],
        });
        t[8 * half..8 * half + 8].copy_from_slice(&near.to_array());
        for i in set_bits(!plain.bits() & samples) {
            let lane = 8 * half + i;
            let one = |v: Vec3<F32x16>| v.map(|row| row.to_array()[lane]).into();
            let at = center[half].map(|row| row.to_array()[i]);
            let (center, radius) = (DVec3::new(at.x, at.y, at.z), radius[half].to_array()[i]);
            t[lane] = distance(one(origin), one(direction), center, radius);
        }
    }
    t
}
