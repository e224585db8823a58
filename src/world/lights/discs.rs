//! Emissive spheres in rows: each lane sees a sphere of its own, from a point of its own.

use super::Lights;
use super::disc::{distance, toward};
use super::row::{LightRow, ROW, ReceiverRow};
use crate::intersect::{self, Pairs};
use crate::lanes::{F32x16, F64x8, Mask, set_bits, widen};
use crate::ray::{MISS, rounding};
use crate::sampling::{Cone, Frames};
use crate::spheres::Spheres;
use crate::vec3::Vec3;

/// Centers, radii and radiance of a row of spheres.
struct Gathered {
    center: [[f32; ROW]; 3],
    radius: [f32; ROW],
    radiance: [[f32; ROW]; 3],
    target: [u32; ROW],
}

impl Lights {
    /// One sample of an emissive sphere for each receiver in `lanes`: of `light[lane]`, from two
    /// numbers in [0, 1). Lanes in or on their light are left out.
    #[inline(always)]
    pub(super) fn sample_discs(
        &self,
        spheres: &Spheres,
        at: &ReceiverRow,
        (light, lanes): (&[u32; ROW], u32),
        u: [F32x16; 2],
    ) -> LightRow {
        let row = self.gather(spheres, light, lanes);
        let (origin, center) = (at.point.halves(), row.center().halves());
        let radius = widen(F32x16::new(row.radius));
        let low = toward(origin[0], (center[0], radius[0]), self.reach);
        let high = toward(origin[1], (center[1], radius[1]), self.reach);
        let (cone, outside) = Cone::toward_spheres([low.distance2, high.distance2], radius);
        let axis = Vec3::narrow([low.direction, high.direction]);
        let direction = Frames::about(axis).to_world(cone.sample_each(u));
        let own = set_bits(lanes).filter(|&lane| row.target[lane] == at.own[lane]);
        let lanes = own.fold(lanes & outside, |lanes, lane| lanes & !(1 << lane));
        let pdf = cone.pdfs();
        LightRow {
            direction,
            t: distances((at.point, direction), (&center, &radius), lanes),
            target: row.target,
            weight: row.radiance().map(|channel| channel / pdf),
            pdf,
            close: lanes & (low.close.bits() | high.close.bits() << 8),
            lanes,
        }
    }

    #[inline(always)]
    fn gather(&self, spheres: &Spheres, light: &[u32; ROW], lanes: u32) -> Gathered {
        if let [lone] = self.emitters[..] {
            // All at once: what is written lane by lane has to be waited for.
            let (center, radiance) = (spheres.center(lone as usize), self.radiance[0]);
            return Gathered {
                center: center.to_array().map(|x| [x; ROW]),
                radius: [spheres.radius(lone as usize); ROW],
                radiance: radiance.to_array().map(|x| [x; ROW]),
                target: [lone; ROW],
            };
        }
        let mut row = Gathered {
            center: [[0.0; ROW]; 3],
            radius: [1.0; ROW],
            radiance: [[0.0; ROW]; 3],
            target: [MISS; ROW],
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

impl Gathered {
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
fn columns([x, y, z]: &[[f32; ROW]; 3]) -> Vec3<F32x16> {
    Vec3::new(F32x16::new(*x), F32x16::new(*y), F32x16::new(*z))
}

/// In each of `lanes` the [`distance`] from a surface to a sphere.
#[inline(always)]
pub(super) fn distances(
    (origin, direction): (Vec3<F32x16>, Vec3<F32x16>),
    (center, radius): (&[Vec3<F64x8>; 2], &[F64x8; 2]),
    lanes: u32,
) -> [f64; ROW] {
    let (from, toward) = (origin.halves(), direction.halves());
    let mut t = [0.0; ROW];
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
            let sphere = (glam::DVec3::new(at.x, at.y, at.z), radius[half].to_array()[i]);
            t[lane] = distance((one(origin), one(direction)), sphere);
        }
    }
    t
}
