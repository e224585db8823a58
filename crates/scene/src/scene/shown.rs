//! The bodies that slices leave of a scene, and their extent.

use super::{BodyColumns, Scene, Slice, SliceMode};
use glam::DVec3;

impl Scene {
    /// Returns the rows of bodies that slices do not remove.
    #[doc(hidden)]
    pub fn shown_of<'a>(&'a self, bodies: &'a dyn BodyColumns) -> impl Iterator<Item = usize> + 'a {
        let dropped = |row| self.slices.iter().any(|slice| slice.drops_body(bodies, row));
        (0..bodies.len()).filter(move |&row| !dropped(row))
    }

    /// Returns spheres whose convex hull holds what slices leave.
    pub fn framed(&self) -> impl Iterator<Item = (DVec3, f64)> {
        let spheres = self.shown().map(|row| (self.spheres.center(row), self.spheres.radius[row]));
        let others = self.other_bodies().into_iter();
        spheres
            .chain(others.flat_map(|bodies| self.shown_of(bodies).flat_map(|row| bodies.hull(row))))
    }

    /// Returns spheres whose convex hull holds the same bodies, sliced or not.
    #[doc(hidden)]
    pub fn other_hulls(&self) -> impl Iterator<Item = (DVec3, f64)> {
        let others = self.other_bodies().into_iter();
        others.flat_map(|bodies| (0..bodies.len()).flat_map(|row| bodies.hull(row)))
    }

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
