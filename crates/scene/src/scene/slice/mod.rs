//! Slices: half spaces that are cut away.

mod text;

pub use text::SlicePlane;

use glam::DVec3;

/// A half space that is cut away: the points `p` with `normal . p > distance`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slice {
    /// Unit normal, toward the part that is cut away.
    pub normal: DVec3,
    /// Signed distance of the plane from the origin along `normal`.
    pub distance: f64,
    /// Effect on spheres.
    pub mode: SliceMode,
}

/// Effect of a slice on spheres.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SliceMode {
    /// Removes spheres whose centers are cut away; others stay whole.
    #[default]
    Remove,
    /// Spheres end at the plane, with flat caps of their own color. A sphere that the plane cuts must
    /// not be of glass; an emitter that it cuts is not sampled as a light.
    Caps,
    /// Hides spheres whose centers are cut away from camera rays; all other rays still see them, in
    /// shadows, in mirrors and behind glass.
    Hide,
}

impl SliceMode {
    /// All modes, with their names in scene files and options.
    pub const ALL: [(&'static str, Self); 3] =
        [("remove", Self::Remove), ("caps", Self::Caps), ("hide", Self::Hide)];

    /// Returns the name in scene files and options.
    pub fn name(self) -> &'static str {
        Self::ALL.iter().find(|(_, mode)| *mode == self).map_or("", |(name, _)| name)
    }
}

impl Slice {
    /// Returns the signed depth of a point in the half space that is cut away; negative outside.
    pub fn depth(&self, point: DVec3) -> f64 {
        self.normal.dot(point) - self.distance
    }

    /// Returns whether a sphere is removed.
    pub fn drops(&self, center: DVec3, radius: f64) -> bool {
        match self.mode {
            SliceMode::Remove => self.depth(center) > 0.0,
            SliceMode::Caps => self.depth(center) >= radius,
            SliceMode::Hide => false,
        }
    }

    /// Returns whether a sphere is hidden from the camera.
    pub fn hides(&self, center: DVec3) -> bool {
        self.mode == SliceMode::Hide && self.depth(center) > 0.0
    }
}
