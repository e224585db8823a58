//! Slices: half spaces that are cut away.

mod text;

pub use text::SlicePlane;

use super::{BodyColumns, Scene};
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

impl Scene {
    /// Returns the rows of the spheres that the slices do not remove.
    pub fn shown(&self) -> impl Iterator<Item = usize> {
        (0..self.spheres.len()).filter(|&row| !self.drops(row))
    }

    fn drops(&self, row: usize) -> bool {
        let (center, radius) = (self.spheres.center(row), self.spheres.radius[row]);
        self.slices.iter().any(|slice| slice.drops(center, radius))
    }

    /// Returns the normals of the slices that cut or remove any sphere or any body that stands alone, toward what is cut away.
    pub fn cut_normals(&self) -> Vec<DVec3> {
        let cuts = |slice: &&Slice| {
            let spheres = &self.spheres;
            let reach = |row: usize| match slice.mode {
                SliceMode::Caps => spheres.radius[row],
                SliceMode::Remove | SliceMode::Hide => 0.0,
            };
            let cut = |row: usize| slice.depth(spheres.center(row)) + reach(row) > 0.0;
            let cut_any = |bodies: &dyn BodyColumns| {
                (0..bodies.len()).any(|row| slice.cuts_body(bodies, row))
            };
            (0..spheres.len()).any(cut) || self.standing_bodies().any(cut_any)
        };
        self.slices.iter().filter(cuts).map(|slice| slice.normal).collect()
    }

    /// The box of all spheres and all bodies that stand alone: lower and upper corner; `None` if there are none.
    pub fn bounds(&self) -> Option<[DVec3; 2]> {
        let spheres = &self.spheres;
        let own = (0..spheres.len()).map(|row| {
            let (center, radius) = (spheres.center(row), DVec3::splat(spheres.radius[row]));
            [center - radius, center + radius]
        });
        let across =
            DVec3::AXES.map(|normal| Slice { normal, distance: 0.0, mode: SliceMode::default() });
        let others = self.standing_bodies().flat_map(move |bodies| {
            (0..bodies.len()).map(move |row| {
                let ranges = across.map(|slice| bodies.depths(row, &slice));
                [0, 1].map(|end| DVec3::from(ranges.map(|range| range[end])))
            })
        });
        own.chain(others).reduce(|[low, high], [lower, upper]| [low.min(lower), high.max(upper)])
    }

    fn standing_bodies(&self) -> impl Iterator<Item = &dyn BodyColumns> {
        self.other_bodies().into_iter().filter(|bodies| bodies.stand_alone())
    }

    /// Drops the spheres that the slices remove, so that their memory is freed and cameras frame the
    /// rest. Returns how many. A world of the scene is the same, except for the numbers of the spheres
    /// and rounding to single precision.
    pub fn drop_cut(&mut self) -> usize {
        let keep: Vec<bool> = (0..self.spheres.len()).map(|row| !self.drops(row)).collect();
        let dropped = keep.iter().filter(|&&kept| !kept).count();
        if dropped > 0 {
            self.spheres.retain(&keep);
        }
        dropped
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Rgb;
    use glam::DQuat;

    fn scene(mode: SliceMode) -> Scene {
        let mut scene = Scene::default();
        for x in [-2.0, -0.5, 0.0, 0.5, 1.0, 3.0] {
            scene.spheres.push(DVec3::X * x, 1.0, 0, Rgb::splat(0.5));
        }
        scene.slices.push(Slice { normal: DVec3::X, distance: 0.0, mode });
        scene
    }

    #[test]
    fn every_mode_keeps_its_spheres() {
        for (mode, shown) in [
            (SliceMode::Remove, &[0, 1, 2][..]),
            (SliceMode::Caps, &[0, 1, 2, 3]),
            (SliceMode::Hide, &[0, 1, 2, 3, 4, 5]),
        ] {
            let mut scene = scene(mode);
            assert_eq!(scene.shown().collect::<Vec<_>>(), shown, "{mode:?}");
            assert_eq!(scene.drop_cut(), 6 - shown.len());
            assert_eq!(scene.spheres.len(), shown.len());
            assert_eq!(scene.spheres.color.len(), shown.len());
            assert_eq!(scene.drop_cut(), 0);
        }
        let hidden = scene(SliceMode::Hide);
        let hides = |row: usize| hidden.slices[0].hides(hidden.spheres.center(row));
        assert_eq!((0..6).filter(|&row| hides(row)).collect::<Vec<_>>(), [3, 4, 5]);
    }

    #[test]
    fn bounds_include_radii_ellipsoids_and_cones() {
        let mut own = scene(SliceMode::Remove);
        let all = own.bounds();
        assert_eq!(all, Some([DVec3::new(-3.0, -1.0, -1.0), DVec3::new(4.0, 1.0, 1.0)]));
        let semi_axes = DVec3::new(0.5, 1.5, 0.5);
        own.ellipsoids.push(DVec3::Y, semi_axes, DQuat::IDENTITY, 0, Rgb::ONE);
        let all = own.bounds();
        assert_eq!(all, Some([DVec3::new(-3.0, -1.0, -1.0), DVec3::new(4.0, 2.5, 1.0)]));
        own.cones.push(DVec3::Y * -3.0, DVec3::Y * -2.0, 4.0, 0, Rgb::ONE);
        let all = own.bounds();
        assert_eq!(all, Some([DVec3::new(-4.0, -3.0, -4.0), DVec3::new(4.0, 2.5, 4.0)]));
        assert_eq!(Scene::default().bounds(), None);
    }
}
