//! Three coordinates, each one value or a row of lanes.

use crate::lanes::{Doubles, F32x16, F64x8, Lanes, narrow, widen};
use glam::DVec3;
use std::ops::{Add, Mul, Neg, Sub};

/// A point or a direction; `T` is a number or a row of [`Lanes`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vec3<T> {
    /// Along the first axis.
    pub x: T,
    /// Along the second axis.
    pub y: T,
    /// Along the third axis.
    pub z: T,
}

impl<T> Vec3<T> {
    /// From its coordinates.
    #[inline(always)]
    pub const fn new(x: T, y: T, z: T) -> Self {
        Self { x, y, z }
    }

    /// `f` of each coordinate.
    #[inline(always)]
    pub fn map<U>(self, f: impl Fn(T) -> U) -> Vec3<U> {
        Vec3 { x: f(self.x), y: f(self.y), z: f(self.z) }
    }
}

impl<L: Lanes> Vec3<L> {
    /// Returns the vector with the same coordinates in every lane.
    #[inline(always)]
    pub fn splat(x: f32, y: f32, z: f32) -> Self {
        Self { x: L::splat(x), y: L::splat(y), z: L::splat(z) }
    }

    /// Scalar product.
    #[inline(always)]
    pub fn dot(self, other: Self) -> L {
        self.x.mul_add(other.x, self.y.mul_add(other.y, self.z * other.z))
    }

    /// `self + direction * t`, each coordinate fused.
    #[inline(always)]
    pub fn along(self, direction: Self, t: L) -> Self {
        Self {
            x: direction.x.mul_add(t, self.x),
            y: direction.y.mul_add(t, self.y),
            z: direction.z.mul_add(t, self.z),
        }
    }
}

/// Products and sums as [`Lanes::relaxed_mul_add`] rounds them: for bounds.
impl<L: Lanes> Vec3<L> {
    /// Scalar product.
    #[inline(always)]
    pub fn relaxed_dot(self, other: Self) -> L {
        let last = self.z * other.z;
        self.x.relaxed_mul_add(other.x, self.y.relaxed_mul_add(other.y, last))
    }

    /// Scalar product plus `term`.
    #[inline(always)]
    pub fn relaxed_dot_add(self, other: Self, term: L) -> L {
        let last = self.z.relaxed_mul_add(other.z, term);
        self.x.relaxed_mul_add(other.x, self.y.relaxed_mul_add(other.y, last))
    }

    /// `self + direction * t`.
    #[inline(always)]
    pub fn relaxed_along(self, direction: Self, t: L) -> Self {
        Self {
            x: direction.x.relaxed_mul_add(t, self.x),
            y: direction.y.relaxed_mul_add(t, self.y),
            z: direction.z.relaxed_mul_add(t, self.z),
        }
    }
}

impl<L: Lanes> Vec3<L> {
    /// One or the other, lane by lane.
    #[inline(always)]
    pub fn select_lanes(mask: L::Mask, yes: Self, no: Self) -> Self {
        Self {
            x: L::select(mask, yes.x, no.x),
            y: L::select(mask, yes.y, no.y),
            z: L::select(mask, yes.z, no.z),
        }
    }

    /// The product coordinate by coordinate: of colors.
    #[inline(always)]
    pub fn times(self, other: Self) -> Self {
        Self { x: self.x * other.x, y: self.y * other.y, z: self.z * other.z }
    }

    /// Returns the lanes in which all coordinates are multiples of 2^-46, so that sums of a few that are below 64
    /// are exact in double precision. Of small coordinates only 0 is called so.
    #[inline(always)]
    pub fn is_coarse(self) -> L::Mask {
        /// Numbers that are not below this are multiples of 2^-46.
        const LEAST: f32 = 1.0 / (1 << 23) as f32;
        let Vec3 { x, y, z } = self.map(|x| {
            let x = x.abs();
            x.le(L::splat(0.0)) | L::splat(LEAST).le(x)
        });
        x & y & z
    }

    /// The greatest coordinate.
    #[inline(always)]
    pub fn max_element(self) -> L {
        self.x.max(self.y).max(self.z)
    }

    /// Returns the direction with length 1.
    #[inline(always)]
    pub fn normalize(self) -> Self {
        self * (L::splat(1.0) / self.dot(self).sqrt())
    }
}

impl Vec3<F32x16> {
    /// Returns the vector in two rows of double precision.
    #[inline(always)]
    pub fn halves(self) -> [Vec3<F64x8>; 2] {
        let Vec3 { x: [x, x2], y: [y, y2], z: [z, z2] } = self.map(widen);
        [Vec3::new(x, y, z), Vec3::new(x2, y2, z2)]
    }

    /// Rounds two rows of double precision.
    #[inline(always)]
    pub fn narrow([low, high]: [Vec3<F64x8>; 2]) -> Self {
        Self { x: narrow([low.x, high.x]), y: narrow([low.y, high.y]), z: narrow([low.z, high.z]) }
    }
}

impl<D: Doubles> Vec3<D> {
    /// Scalar product, each operation rounded: the same on every processor.
    #[inline(always)]
    pub fn dot_unfused(self, other: Self) -> D {
        self.x * other.x + self.y * other.y + self.z * other.z
    }

    /// One over the length.
    #[inline(always)]
    pub fn inverse_length(self) -> D {
        D::splat(1.0) / self.dot_unfused(self).sqrt()
    }

    /// `yes` where `mask` is true, `no` elsewhere.
    #[inline(always)]
    pub fn select(mask: D::Mask, yes: Self, no: Self) -> Self {
        Self {
            x: D::select(mask, yes.x, no.x),
            y: D::select(mask, yes.y, no.y),
            z: D::select(mask, yes.z, no.z),
        }
    }
}

impl From<DVec3> for Vec3<f64> {
    #[inline(always)]
    fn from(v: DVec3) -> Self {
        Self { x: v.x, y: v.y, z: v.z }
    }
}

impl From<Vec3<f64>> for [f64; 3] {
    #[inline(always)]
    fn from(v: Vec3<f64>) -> Self {
        [v.x, v.y, v.z]
    }
}

impl From<glam::Vec3> for Vec3<f32> {
    #[inline(always)]
    fn from(v: glam::Vec3) -> Self {
        Self { x: v.x, y: v.y, z: v.z }
    }
}

impl From<Vec3<f32>> for glam::Vec3 {
    #[inline(always)]
    fn from(v: Vec3<f32>) -> Self {
        Self::new(v.x, v.y, v.z)
    }
}

impl<T: Add<Output = T>> Add for Vec3<T> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self { x: self.x + other.x, y: self.y + other.y, z: self.z + other.z }
    }
}

impl<T: Copy + Mul<Output = T>> Mul<T> for Vec3<T> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, factor: T) -> Self {
        Self { x: self.x * factor, y: self.y * factor, z: self.z * factor }
    }
}

impl<L: Sub<Output = L>> Sub for Vec3<L> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self { x: self.x - other.x, y: self.y - other.y, z: self.z - other.z }
    }
}

impl<T: Neg<Output = T>> Neg for Vec3<T> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self { x: -self.x, y: -self.y, z: -self.z }
    }
}
