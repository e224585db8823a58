//! Point lights.

use super::row::{LANES, LightLanes, ReceiverRow};
use super::{LightSample, Lights};
use crate::lanes::{Doubles, F64x8, Mask, set_bits};
use crate::ray::MISS;
use crate::scene::{BRIGHTEST, Rgb};
use crate::vec3::Vec3;
use glam::DVec3;

/// A point light in world space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    pub(super) position: DVec3,
    /// Radiant intensity; irradiance if there is no falloff.
    pub(super) intensity: Rgb,
    /// World units per unit of the user, in which falloff is computed; `None` if there is none.
    pub(super) falloff: Option<f64>,
}

/// Point lights as seen from points: one, or a row.
struct PointView<D: Doubles> {
    /// Unit vectors toward the lights.
    direction: Vec3<D>,
    distance: D,
    weight: Vec3<D>,
    /// False at the light itself.
    apart: D::Mask,
}

/// Returns a light, by position and intensity, as seen from a point; `scale` is that of the
/// falloff, 0 if there is none.
#[inline(always)]
fn view<D: Doubles>(
    origin: Vec3<D>,
    position: Vec3<D>,
    intensity: Vec3<D>,
    scale: D,
) -> PointView<D> {
    let (zero, one) = (D::splat(0.0), D::splat(1.0));
    let toward = position - origin;
    let distance = toward.dot_unfused(toward).sqrt();
    // Double precision: in units far from 1, intensity and falloff may each leave the range of single
    // precision. Next to a surface, light has no other bound.
    let ratio = scale / distance;
    let falloff = D::select(zero.lt(scale), ratio * ratio, one);
    let most = D::splat(f64::from(BRIGHTEST));
    let weight = (intensity * falloff).map(|channel| D::select(channel.lt(most), channel, most));
    let direction = toward.map(|x| x / distance);
    PointView { direction, distance, weight, apart: zero.lt(distance) }
}

impl Point {
    /// Samples the light at a point; `None` at the light itself.
    pub(super) fn sample(&self, origin: glam::Vec3) -> Option<LightSample> {
        let (position, intensity) = (self.position.into(), self.intensity.as_dvec3().into());
        let scale = self.falloff.unwrap_or(0.0);
        let seen: PointView<f64> = view(origin.as_dvec3().into(), position, intensity, scale);
        seen.apart.then(|| LightSample {
            direction: seen.direction.map(|x| x as f32).into(),
            t: seen.distance,
            target: MISS,
            weight: seen.weight.map(|x| x as f32).into(),
            pdf: None,
            close: false,
        })
    }
}

/// The point lights of a row of lanes.
struct PointRow {
    position: [[f64; LANES]; 3],
    intensity: [[f64; LANES]; 3],
    scale: [f64; LANES],
}

impl PointRow {
    /// Returns eight of the lights, from lane `first` on, as seen from `origin`.
    #[inline(always)]
    fn view(&self, origin: Vec3<F64x8>, first: usize) -> PointView<F64x8> {
        let part = |column: &[f64; LANES]| F64x8::from(&column[first..first + 8]);
        let vector = |[x, y, z]: &[[f64; LANES]; 3]| Vec3::new(part(x), part(y), part(z));
        view(origin, vector(&self.position), vector(&self.intensity), part(&self.scale))
    }
}

impl Point {
    /// Returns the light as seen from eight points.
    #[inline(always)]
    fn view_row(&self, origin: Vec3<F64x8>) -> PointView<F64x8> {
        let splat = |v: DVec3| Vec3::from(v).map(F64x8::splat);
        let (position, intensity) = (splat(self.position), splat(self.intensity.as_dvec3()));
        view(origin, position, intensity, F64x8::splat(self.falloff.unwrap_or(0.0)))
    }
}

impl Lights {
    #[inline(always)]
    fn gather_points(&self, light: &[u32; LANES], lanes: u32, first: usize) -> PointRow {
        let column = [0.0; LANES];
        let mut row = PointRow { position: [column; 3], intensity: [column; 3], scale: column };
        for lane in set_bits(lanes) {
            let point = &self.points[light[lane] as usize - first];
            for axis in 0..3 {
                row.position[axis][lane] = point.position[axis];
                row.intensity[axis][lane] = f64::from(point.intensity[axis]);
            }
            row.scale[lane] = point.falloff.unwrap_or(0.0);
        }
        row
    }

    /// Does what [`Point::sample`] does for each receiver in `lanes`: point `light[lane]`, counted from
    /// `first`.
    #[inline(always)]
    pub(super) fn sample_points(
        &self,
        at: &ReceiverRow,
        light: &[u32; LANES],
        lanes: u32,
        first: usize,
    ) -> LightLanes {
        let origin = at.point.halves();
        let (low, high) = if let [lone] = &self.points[..] {
            (lone.view_row(origin[0]), lone.view_row(origin[1]))
        } else {
            let points = self.gather_points(light, lanes, first);
            (points.view(origin[0], 0), points.view(origin[1], 8))
        };
        let row = LightLanes::distant(
            Vec3::narrow([low.direction, high.direction]),
            Rgb::ZERO,
            lanes & (low.apart.bits() | high.apart.bits() << 8),
        );
        let mut t = [0.0; LANES];
        t[..8].copy_from_slice(&low.distance.to_array());
        t[8..].copy_from_slice(&high.distance.to_array());
        LightLanes { t, weight: Vec3::narrow([low.weight, high.weight]), ..row }
    }
}
