//! Directions along the coordinate axes.

use glam::DVec3;

/// A direction along a coordinate axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axis {
    /// +x.
    X,
    /// -x.
    NegX,
    /// +y.
    Y,
    /// -y.
    NegY,
    /// +z.
    Z,
    /// -z.
    NegZ,
}

impl Axis {
    /// All directions, with their names in options.
    pub const ALL: [(&'static str, Self); 6] = [
        ("x", Self::X),
        ("-x", Self::NegX),
        ("y", Self::Y),
        ("-y", Self::NegY),
        ("z", Self::Z),
        ("-z", Self::NegZ),
    ];

    /// Returns the name in options.
    pub fn name(self) -> &'static str {
        Self::ALL.iter().find(|(_, axis)| *axis == self).map_or("", |(name, _)| name)
    }

    /// Returns the direction with this name.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.iter().find(|(own, _)| *own == name).map(|(_, axis)| *axis)
    }

    /// Returns the unit vector.
    pub fn vector(self) -> DVec3 {
        match self {
            Self::X => DVec3::X,
            Self::NegX => DVec3::NEG_X,
            Self::Y => DVec3::Y,
            Self::NegY => DVec3::NEG_Y,
            Self::Z => DVec3::Z,
            Self::NegZ => DVec3::NEG_Z,
        }
    }

    /// Returns the opposite direction.
    pub fn opposite(self) -> Self {
        match self {
            Self::X => Self::NegX,
            Self::NegX => Self::X,
            Self::Y => Self::NegY,
            Self::NegY => Self::Y,
            Self::Z => Self::NegZ,
            Self::NegZ => Self::Z,
        }
    }

    /// Returns the direction nearest to a vector; `None` for a vector without a direction.
    pub fn nearest(vector: DVec3) -> Option<Self> {
        let cosine = |axis: Self| axis.vector().dot(vector);
        let found = Self::ALL.map(|(_, axis)| axis).into_iter();
        found.filter(|axis| cosine(*axis) > 0.0).max_by(|a, b| cosine(*a).total_cmp(&cosine(*b)))
    }

    /// Returns the axes of a view from the front with this direction up: to the right, and toward the
    /// viewer. If z is up, x is to the right; if y is up, z is toward the viewer, as on paper.
    pub fn front(self) -> [DVec3; 2] {
        match self {
            Self::X => [DVec3::Z, DVec3::Y],
            Self::NegX => [DVec3::NEG_Z, DVec3::Y],
            Self::Y => [DVec3::X, DVec3::Z],
            Self::NegY => [DVec3::NEG_X, DVec3::Z],
            Self::Z => [DVec3::X, DVec3::NEG_Y],
            Self::NegZ => [DVec3::NEG_X, DVec3::NEG_Y],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_and_vectors_agree() {
        for (name, axis) in Axis::ALL {
            assert_eq!((Axis::named(name), axis.name()), (Some(axis), name));
            assert_eq!(Axis::nearest(axis.vector() * 3.0 + DVec3::splat(0.1)), Some(axis));
            assert_eq!(axis.opposite().vector(), -axis.vector());
        }
        assert_eq!(Axis::named("up"), None);
        assert_eq!(Axis::nearest(DVec3::ZERO), None);
    }

    #[test]
    fn views_from_the_front_are_right_handed() {
        for (_, axis) in Axis::ALL {
            let [right, toward] = axis.front();
            assert_eq!(right.cross(axis.vector()), toward);
        }
    }
}
