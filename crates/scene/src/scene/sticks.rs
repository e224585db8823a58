//! The sticks of a scene: capsules, in columns.

use super::{Rgb, Scene, Slice, SliceMode};
use glam::DVec3;

/// Sticks in columns: cylinders with round ends, all points within a radius of a line segment. Row `i` of every column belongs
/// to stick `i`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Sticks {
    /// The first ends of the segments.
    pub from: Vec<DVec3>,
    /// The second ends, which may be the first ones: then the stick is a sphere.
    pub to: Vec<DVec3>,
    /// Radii, more than 0.
    pub radius: Vec<f64>,
    /// Rows of [`Scene::materials`], of which none is glass or an emitter.
    pub material: Vec<u32>,
    /// Factors on the material's color, of the half at the first end and of that at the second.
    pub colors: Vec<[Rgb; 2]>,
}

impl Sticks {
    /// The most sticks of a scene.
    pub const MAX: usize = 1 << 30;

    /// Number of sticks.
    pub fn len(&self) -> usize {
        self.radius.len()
    }

    /// Returns whether there is none.
    pub fn is_empty(&self) -> bool {
        self.radius.is_empty()
    }

    /// Appends a stick.
    pub fn push(&mut self, ends: [DVec3; 2], radius: f64, material: u32, colors: [Rgb; 2]) {
        self.from.push(ends[0]);
        self.to.push(ends[1]);
        self.radius.push(radius);
        self.material.push(material);
        self.colors.push(colors);
    }

    /// The ends of stick `row`.
    pub fn ends(&self, row: usize) -> [DVec3; 2] {
        [self.from[row], self.to[row]]
    }

    /// The middle of stick `row`.
    pub fn middle(&self, row: usize) -> DVec3 {
        self.from[row].midpoint(self.to[row])
    }

    /// Bytes of the columns.
    pub fn bytes(&self) -> u64 {
        let row = 2 * size_of::<DVec3>() + size_of::<f64>() + size_of::<u32>();
        (self.len() * (row + size_of::<[Rgb; 2]>())) as u64
    }
}

impl Slice {
    /// Returns whether a stick is removed: as a sphere is, whose center is the stick's middle; caps remove it if they leave
    /// nothing of it.
    pub fn drops_stick(&self, sticks: &Sticks, row: usize) -> bool {
        match self.mode {
            SliceMode::Remove => self.depth(sticks.middle(row)) > 0.0,
            SliceMode::Caps => {
                sticks.ends(row).iter().all(|&end| self.depth(end) >= sticks.radius[row])
            }
            SliceMode::Hide => false,
        }
    }
}

impl Scene {
    /// Returns the rows of the sticks that slices do not remove.
    pub fn shown_sticks(&self) -> impl Iterator<Item = usize> {
        let dropped = |row| self.slices.iter().any(|slice| slice.drops_stick(&self.sticks, row));
        (0..self.sticks.len()).filter(move |&row| !dropped(row))
    }

    /// Returns the rows of the ellipsoids that slices do not remove.
    pub fn shown_ellipsoids(&self) -> impl Iterator<Item = usize> {
        let all = &self.ellipsoids;
        let dropped = |row| self.slices.iter().any(|slice| slice.drops_ellipsoid(all, row));
        (0..all.len()).filter(move |&row| !dropped(row))
    }

    /// Returns the rows of the cones that slices do not remove.
    pub fn shown_cones(&self) -> impl Iterator<Item = usize> {
        let dropped = |row| self.slices.iter().any(|slice| slice.drops_cone(&self.cones, row));
        (0..self.cones.len()).filter(move |&row| !dropped(row))
    }

    /// Returns spheres whose convex hull holds what slices leave: the spheres, those about the ends of sticks, those around
    /// ellipsoids, and those about the apexes and bases of cones.
    pub fn framed(&self) -> impl Iterator<Item = (DVec3, f64)> {
        let spheres = self.shown().map(|row| (self.spheres.center(row), self.spheres.radius[row]));
        let ends = self
            .shown_sticks()
            .flat_map(|row| self.sticks.ends(row).map(|end| (end, self.sticks.radius[row])));
        let around = self
            .shown_ellipsoids()
            .map(|row| (self.ellipsoids.center[row], self.ellipsoids.reach(row)));
        let cones = self.shown_cones().flat_map(|row| self.cones.hull(row));
        spheres.chain(ends).chain(around).chain(cones)
    }

    /// Returns whether there is no body.
    pub fn is_empty(&self) -> bool {
        self.spheres.is_empty()
            && self.sticks.is_empty()
            && self.ellipsoids.is_empty()
            && self.cones.is_empty()
    }
}
