//! A cone: the head of an arrow.

use glam::DVec3;

/// The convex hull of an apex and a disc whose axis goes through it: a solid right circular cone with a flat base.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cone {
    /// The apex.
    pub apex: DVec3,
    /// The center of the base, not the apex.
    pub base: DVec3,
    /// The radius of the base, more than 0.
    pub radius: f64,
}

/// A face of a cone's surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Face {
    /// The curved side.
    Side,
    /// The disc.
    Base,
}

impl Cone {
    /// Returns the signed distances of a point, given relative to the apex, from the side, continued as a cone without end, and from the plane
    /// of the base: negative on the inner side. Beyond the apex the first is no distance, but positive.
    pub fn distances(&self, from_apex: DVec3) -> [f64; 2] {
        let axis = self.base - self.apex;
        let height = axis.length();
        let axis = axis / height;
        let along = from_apex.dot(axis);
        let across = from_apex.cross(axis).length();
        let side = (across * height - along * self.radius)
            / (height * height + self.radius * self.radius).sqrt();
        [side, along - height]
    }

    /// Returns the outward unit normal of a face at a point, given relative to the apex; at the apex itself, where the side has none, it
    /// points away from the base.
    pub fn normal_of(&self, face: Face, from_apex: DVec3) -> DVec3 {
        let axis = (self.base - self.apex).normalize_or_zero();
        if face == Face::Base {
            return axis;
        }
        let across = (from_apex - axis * from_apex.dot(axis)).normalize_or_zero();
        // The side goes outward by the radius for each height, so its normal goes back by the radius for each height outward.
        (across * (self.base - self.apex).length() - axis * self.radius).normalize_or_zero()
    }

    /// The face on which a point is, which need not be there by more than rounding; at the rim either.
    pub fn face_at(&self, from_apex: DVec3) -> Face {
        let [side, base] = self.distances(from_apex);
        if base > side { Face::Base } else { Face::Side }
    }

    /// The outward unit normal at a point of the surface, given relative to the apex. The point need not be on the surface
    /// by more than rounding.
    pub fn normal(&self, from_apex: DVec3) -> DVec3 {
        self.normal_of(self.face_at(from_apex), from_apex)
    }

    /// Returns the point of the surface next to one that is off it by rounding, both relative to the apex.
    pub fn onto_surface(&self, from_apex: DVec3) -> DVec3 {
        let [side, base] = self.distances(from_apex);
        let off = if base > side { base } else { side };
        from_apex - self.normal(from_apex) * off
    }
}
