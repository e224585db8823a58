//! Right-handed orthonormal bases about a unit vector.

use crate::lanes::Lanes;
use crate::vec3;
use glam::Vec3;

/// An orthonormal basis; local z is the normal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Basis {
    /// World direction of local x.
    pub tangent: Vec3,
    /// World direction of local y: normal x tangent.
    pub bitangent: Vec3,
    /// World direction of local z.
    pub normal: Vec3,
}

impl Basis {
    /// Returns the basis of any unit normal, including poles and negative zeros.
    ///
    /// Duff, Burgess, Christensen, Hery, Kensler, Liani & Villemin, "Building an Orthonormal Basis,
    /// Revisited", JCGT 2017.
    #[inline]
    pub fn new(normal: Vec3) -> Self {
        let Bases { tangent, bitangent, .. } = Bases::<f32>::about(normal.into());
        Self { tangent: tangent.into(), bitangent: bitangent.into(), normal }
    }

    /// Transforms a local direction to world axes.
    #[inline]
    pub fn to_world(&self, local: Vec3) -> Vec3 {
        self.row_to_world(local.into()).into()
    }

    /// [`Basis::to_world`] for a row of directions.
    #[inline(always)]
    pub fn row_to_world<L: Lanes>(&self, local: vec3::Vec3<L>) -> vec3::Vec3<L> {
        self.bases().to_world(local)
    }

    /// Transforms a world direction to local axes: the inverse of [`Basis::to_world`].
    #[inline]
    pub fn to_local(&self, world: Vec3) -> Vec3 {
        self.row_to_local(world.into()).into()
    }

    /// [`Basis::to_local`] for a row of directions.
    #[inline(always)]
    pub fn row_to_local<L: Lanes>(&self, world: vec3::Vec3<L>) -> vec3::Vec3<L> {
        self.bases().to_local(world)
    }

    #[inline(always)]
    fn bases<L: Lanes>(&self) -> Bases<L> {
        let splat = |axis: Vec3| vec3::Vec3::splat(axis.x, axis.y, axis.z);
        let [tangent, bitangent, normal] = [self.tangent, self.bitangent, self.normal].map(splat);
        Bases { tangent, bitangent, normal }
    }
}

/// A row of bases.
#[derive(Clone, Copy, Debug)]
pub struct Bases<L> {
    tangent: vec3::Vec3<L>,
    bitangent: vec3::Vec3<L>,
    normal: vec3::Vec3<L>,
}

impl<L: Lanes> Bases<L> {
    /// [`Basis::new`] for a row of unit normals.
    #[inline(always)]
    pub fn about(normal: vec3::Vec3<L>) -> Self {
        let vec3::Vec3 { x, y, z } = normal;
        let one = L::splat(1.0);
        let sign = L::select(z.is_negative(), -one, one);
        let a = -one / (sign + z);
        let b = x * y * a;
        Self {
            tangent: vec3::Vec3::new(one + sign * x * x * a, sign * b, -sign * x),
            bitangent: vec3::Vec3::new(b, sign + y * y * a, -y),
            normal,
        }
    }

    /// [`Basis::to_world`] for a row of directions.
    #[inline(always)]
    pub fn to_world(&self, local: vec3::Vec3<L>) -> vec3::Vec3<L> {
        (self.normal * local.z).along(self.bitangent, local.y).along(self.tangent, local.x)
    }

    /// [`Basis::to_local`] for a row of directions.
    #[inline(always)]
    pub fn to_local(&self, world: vec3::Vec3<L>) -> vec3::Vec3<L> {
        let [x, y, z] = [self.tangent, self.bitangent, self.normal].map(|axis| world.dot(axis));
        vec3::Vec3::new(x, y, z)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::statistics::random_pairs;
    use crate::sampling::uniform_sphere;

    /// Tolerance of the rounding error of products of unit vectors.
    const TOLERANCE: f32 = 4e-7;

    fn check(normal: Vec3) {
        let Basis { tangent, bitangent, normal: n } = Basis::new(normal);
        assert_eq!(n, normal);
        for vector in [tangent, bitangent] {
            assert!((vector.length_squared() - 1.0).abs() < TOLERANCE, "{normal}: {vector}");
        }
        for dot in [tangent.dot(bitangent), tangent.dot(n), bitangent.dot(n)] {
            assert!(dot.abs() < TOLERANCE, "{normal}: {dot}");
        }
        assert!((tangent.cross(bitangent) - n).length() < TOLERANCE, "{normal}: left-handed");
    }

    #[test]
    fn random_normals() {
        for u in random_pairs(10_000, 2) {
            check(uniform_sphere(u));
        }
    }

    #[test]
    fn poles_equator_and_negative_zeros() {
        let tiny = 1e-30;
        for z in [1.0, -1.0] {
            for side in [0.0, -0.0, tiny, -tiny] {
                check(Vec3::new(side, 0.0, z));
                check(Vec3::new(-0.0, side, z));
                check(Vec3::new(z, side, side));
                check(Vec3::new(side, z, side));
            }
            check(Vec3::new(3e-4, -2e-4, z).normalize());
        }
    }

    #[test]
    fn world_and_local_are_inverse() {
        let basis = Basis::new(Vec3::new(0.3, -0.8, -0.1).normalize());
        assert!((basis.to_world(Vec3::Z) - basis.normal).length() < TOLERANCE);
        for u in random_pairs(1000, 9) {
            let local = uniform_sphere(u);
            assert!((basis.to_local(basis.to_world(local)) - local).length() < 2.0 * TOLERANCE);
        }
    }
}
