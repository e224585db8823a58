//! Numbers of hits: rows of the spheres, after them two for each capsule, then one for each ellipsoid, and one for each cone.

use crate::capsules::CapsuleRow;
use crate::ray::GROUND;

/// The numbers of bodies of the kinds that come before others.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BodyRows {
    /// Number of spheres.
    pub spheres: usize,
    /// Number of capsules.
    pub capsules: usize,
    /// Number of ellipsoids.
    pub ellipsoids: usize,
}

/// A body, by its row among those of its kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BodyRow {
    /// A sphere.
    Sphere(usize),
    /// A half of a capsule.
    Capsule(CapsuleRow),
    /// An ellipsoid.
    Ellipsoid(usize),
    /// A cone.
    Cone(usize),
}

impl BodyRows {
    /// Returns the body of a hit; `None` for the ground, and for none.
    #[inline(always)]
    pub fn row(self, hit: u32) -> Option<BodyRow> {
        if hit >= GROUND {
            return None;
        }
        let hit = hit as usize;
        let Some(row) = hit.checked_sub(self.spheres) else { return Some(BodyRow::Sphere(hit)) };
        let Some(rest) = row.checked_sub(2 * self.capsules) else {
            return Some(BodyRow::Capsule(CapsuleRow { capsule: row / 2, half: row % 2 }));
        };
        Some(match rest.checked_sub(self.ellipsoids) {
            None => BodyRow::Ellipsoid(rest),
            Some(row) => BodyRow::Cone(row),
        })
    }

    /// Returns the hit on a body.
    #[inline(always)]
    pub fn hit(self, row: BodyRow) -> u32 {
        let row = match row {
            BodyRow::Sphere(row) => row,
            BodyRow::Capsule(CapsuleRow { capsule, half }) => self.spheres + 2 * capsule + half,
            BodyRow::Ellipsoid(row) => self.spheres + 2 * self.capsules + row,
            BodyRow::Cone(row) => self.spheres + 2 * self.capsules + self.ellipsoids + row,
        };
        row as u32
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ray::MISS;

    #[test]
    fn every_hit_is_one_body() {
        let rows = BodyRows { spheres: 3, capsules: 2, ellipsoids: 2 };
        let capsule = |capsule, half| BodyRow::Capsule(CapsuleRow { capsule, half });
        let expected = [
            BodyRow::Sphere(0),
            BodyRow::Sphere(1),
            BodyRow::Sphere(2),
            capsule(0, 0),
            capsule(0, 1),
            capsule(1, 0),
            capsule(1, 1),
            BodyRow::Ellipsoid(0),
            BodyRow::Ellipsoid(1),
            BodyRow::Cone(0),
            BodyRow::Cone(1),
        ];
        for (hit, &row) in (0..).zip(&expected) {
            assert_eq!(rows.row(hit), Some(row));
            assert_eq!(rows.hit(row), hit);
        }
        assert!(rows.row(GROUND).is_none() && rows.row(MISS).is_none());
        let alone = BodyRows { spheres: 0, capsules: 0, ellipsoids: 0 };
        assert_eq!(alone.row(0), Some(BodyRow::Cone(0)));
    }
}
