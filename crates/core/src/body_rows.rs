//! Numbers of hits: rows of the spheres, after them two for each capsule, then one for each ellipsoid, cone and triangle.

use crate::ray::GROUND;

/// A kind of body. Of bodies at the same distance those of the first kind come first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum BodyKind {
    /// Spheres.
    Sphere,
    /// Capsules.
    Capsule,
    /// Ellipsoids.
    Ellipsoid,
    /// Cones.
    Cone,
    /// Triangles.
    Triangle,
}

impl BodyKind {
    /// Names, in the words of scene files.
    const NAMES: [&'static str; Self::ALL.len()] =
        ["sphere", "stick", "ellipsoid", "cone", "triangle"];

    /// All kinds, in their order.
    pub const ALL: [Self; 5] =
        [Self::Sphere, Self::Capsule, Self::Ellipsoid, Self::Cone, Self::Triangle];

    /// Numbers of hits of a body of each kind: each half of a capsule has one.
    const HITS: [usize; Self::ALL.len()] = [1, 2, 1, 1, 1];

    /// The name of a body of the kind, in the words of scene files.
    pub const fn name(self) -> &'static str {
        Self::NAMES[self as usize]
    }

    /// The name after an article: `a stick`, `an ellipsoid`.
    pub fn with_article(self) -> String {
        let article = if self.name().starts_with(['a', 'e', 'i', 'o', 'u']) { "an" } else { "a" };
        format!("{article} {}", self.name())
    }

    /// The number of hits of each body of the kind.
    #[inline(always)]
    pub const fn hits(self) -> usize {
        Self::HITS[self as usize]
    }
}

/// The numbers of bodies of all kinds, in the order of [`BodyKind::ALL`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct BodyRows(pub [usize; BodyKind::ALL.len()]);

/// A body, by its row among those of its kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BodyRow {
    /// The kind.
    pub kind: BodyKind,
    /// The row.
    pub row: usize,
    /// Number of the hit among those of the body: of a capsule, the half of its axis, 0 about the first end, 1 about the second; else 0.
    pub half: usize,
}

impl BodyRow {
    /// A body that has one hit.
    #[inline(always)]
    pub fn new(kind: BodyKind, row: usize) -> Self {
        Self { kind, row, half: 0 }
    }
}

impl BodyRows {
    /// Returns the body of a hit; `None` for the ground, and for none.
    #[inline(always)]
    pub fn row(self, hit: u32) -> Option<BodyRow> {
        if hit >= GROUND {
            return None;
        }
        let mut rest = hit as usize;
        for kind in BodyKind::ALL {
            let hits = self.hits(kind);
            if rest < hits {
                let (row, half) = (rest / kind.hits(), rest % kind.hits());
                return Some(BodyRow { kind, row, half });
            }
            rest -= hits;
        }
        None
    }

    /// Returns the hit on a body.
    #[inline(always)]
    pub fn hit(self, row: BodyRow) -> u32 {
        (self.first(row.kind) + row.row * row.kind.hits() + row.half) as u32
    }

    /// Returns the first hit on a body of a kind.
    #[inline(always)]
    pub fn first(self, kind: BodyKind) -> usize {
        BodyKind::ALL[..kind as usize].iter().map(|kind| self.hits(*kind)).sum()
    }

    /// Returns the number of bodies of a kind.
    #[inline(always)]
    pub fn count(self, kind: BodyKind) -> usize {
        self.0[kind as usize]
    }

    /// Returns the number of hits on bodies of a kind.
    #[inline(always)]
    pub fn hits(self, kind: BodyKind) -> usize {
        kind.hits() * self.count(kind)
    }

    /// Returns the number of hits on bodies of all kinds.
    #[inline(always)]
    pub fn all_hits(self) -> usize {
        BodyKind::ALL.into_iter().map(|kind| self.hits(kind)).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ray::MISS;

    #[test]
    fn every_hit_is_one_body() {
        let rows = BodyRows([3, 2, 2, 2, 2]);
        let mut hit = 0;
        for kind in BodyKind::ALL {
            assert_eq!(rows.first(kind), hit as usize);
            for row in 0..rows.count(kind) {
                for half in 0..kind.hits() {
                    let row = BodyRow { kind, row, half };
                    assert_eq!((rows.row(hit), rows.hit(row)), (Some(row), hit));
                    hit += 1;
                }
            }
        }
        assert_eq!((hit, rows.all_hits()), (13, 13));
        assert!([hit, GROUND, MISS].into_iter().all(|hit| rows.row(hit).is_none()));
        let alone = BodyRows([0, 0, 0, 0, 1]);
        assert_eq!(alone.row(0), Some(BodyRow::new(BodyKind::Triangle, 0)));
    }
}
