//! The rays, made beforehand, from what the camera sees.

use crate::scenes::Columns;
use clap::ValueEnum;
use glam::{DVec3, Vec3};
use serde::Serialize;
use spherule_core::SphereTree;
use spherule_core::internals::random::Random;
use spherule_core::{Hits, NOTHING, QueryError, RayColumns, Surface};
use spherule_measure::workload::{LIGHT, View, above};
use std::borrow::Cow;

/// A class of rays.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, ValueEnum)]
#[serde(rename_all = "lowercase")]
pub enum Class {
    /// From a pinhole through every pixel: what is hit first.
    Primary,
    /// From what the camera sees toward one far light: whether anything is hit.
    Shadow,
    /// Four from what the camera sees, cosine-distributed: whether anything is hit.
    Ao,
    /// One from what the camera sees, cosine-distributed: what is hit first.
    Diffuse,
    /// From a file: what is hit first.
    #[value(skip)]
    Closest,
    /// From a file: whether anything is hit.
    #[value(skip)]
    Any,
}

/// Order of all rays.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, ValueEnum)]
#[serde(rename_all = "lowercase")]
pub enum Order {
    /// By pixels in blocks of 4 x 4, row by row; within each, row by row.
    Blocks,
    /// By pixels, row by row.
    Rows,
    /// Shuffled.
    Random,
    /// As in the file.
    #[value(skip)]
    File,
}

/// Rays in columns.
#[derive(Clone, Debug, Default)]
pub struct Rays {
    origin: [Vec<f32>; 3],
    direction: [Vec<f32>; 3],
    /// Distances at which searches end; empty if none does.
    t_max: Vec<f32>,
}

/// What the camera sees.
#[derive(Debug)]
pub struct Seen {
    primary: Rays,
    points: Vec<Point>,
}

/// A point that is seen, and where rays start from it.
#[derive(Debug)]
struct Point {
    normal: DVec3,
    origin: Vec3,
}

impl Class {
    /// Whether it is only asked whether anything is hit.
    pub fn is_any(self) -> bool {
        matches!(self, Self::Shadow | Self::Ao | Self::Any)
    }

    /// The name in tables and on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Primary => "primary",
            Self::Shadow => "shadow",
            Self::Ao => "ao",
            Self::Diffuse => "diffuse",
            Self::Closest => "closest",
            Self::Any => "any",
        }
    }
}

impl Rays {
    pub fn len(&self) -> usize {
        self.origin[0].len()
    }

    pub fn columns(&self) -> RayColumns<'_> {
        RayColumns {
            origin: self.origin.each_ref().map(Vec::as_slice),
            direction: self.direction.each_ref().map(Vec::as_slice),
        }
    }

    /// Ray `i`: origin and direction.
    pub fn row(&self, i: usize) -> (Vec3, Vec3) {
        let row = |columns: &[Vec<f32>; 3]| columns.each_ref().map(|column| column[i]).into();
        (row(&self.origin), row(&self.direction))
    }

    /// The distance at which the search of ray `i` ends, in units of its direction's length.
    pub fn bound(&self, i: usize) -> f32 {
        self.t_max.get(i).copied().unwrap_or(f32::INFINITY)
    }

    /// The distances at which searches end; empty if none does.
    pub fn bounds(&self) -> &[f32] {
        &self.t_max
    }

    /// Fills a column with the distances at which searches end.
    pub fn fill_bounds(&self, t: &mut [f64]) {
        if self.t_max.is_empty() {
            t.fill(f64::INFINITY);
        }
        for (t, &bound) in t.iter_mut().zip(&self.t_max) {
            *t = f64::from(bound);
        }
    }

    /// The same rays in a random order.
    pub fn shuffled(&self) -> Self {
        let mut rows: Vec<usize> = (0..self.len()).collect();
        let mut random = Random::new(4);
        for last in (1..rows.len()).rev() {
            rows.swap(last, random.index(last + 1));
        }
        let mut rays = Self::default();
        for row in rows {
            let (origin, direction) = self.row(row);
            rays.push_bounded(origin, direction, self.bound(row));
        }
        rays
    }

    /// Appends a ray whose search ends at a distance.
    pub fn push_bounded(&mut self, origin: Vec3, direction: Vec3, t_max: f32) {
        if t_max < f32::INFINITY || !self.t_max.is_empty() {
            self.t_max.resize(self.len(), f32::INFINITY);
            self.t_max.push(t_max);
        }
        self.push(origin, direction);
    }

    /// Appends a ray.
    pub fn push(&mut self, origin: Vec3, direction: Vec3) {
        for axis in 0..3 {
            self.origin[axis].push(origin[axis]);
            self.direction[axis].push(direction[axis]);
        }
    }
}

impl Seen {
    /// Looks at spheres with `side` x `side` pixels, from above if they are `flat`.
    ///
    /// # Errors
    /// Columns of different lengths.
    pub fn new(
        flat: bool,
        spheres: &Columns,
        tree: &SphereTree,
        side: u32,
        order: Order,
    ) -> Result<Self, QueryError> {
        let primary = camera(flat, spheres, side, order);
        let count = primary.len();
        let (mut t, mut sphere) = (vec![f64::INFINITY; count], vec![NOTHING; count]);
        let mut surfaces = vec![Surface::default(); count];
        let hits = Hits { t: &mut t, sphere: &mut sphere, surface: Some(&mut surfaces) };
        tree.intersect_columns(&primary.columns(), hits)?;
        let hits = sphere.iter().zip(&surfaces).filter(|(sphere, _)| **sphere != NOTHING);
        let points = hits.map(|(&sphere, at)| Point::new(at, spheres.row(sphere as usize)));
        let points = points.collect();
        Ok(Self { primary, points })
    }

    /// The rays of a class; those that come by pixels come as the picture's do.
    pub fn rays(&self, class: Class, order: Order) -> Cow<'_, Rays> {
        let rays = match class {
            Class::Primary | Class::Closest | Class::Any => Cow::Borrowed(&self.primary),
            Class::Shadow => Cow::Owned(self.toward(LIGHT.normalize())),
            Class::Ao => Cow::Owned(self.scattered(2, 4)),
            Class::Diffuse => Cow::Owned(self.scattered(3, 1)),
        };
        if order == Order::Random { Cow::Owned(rays.shuffled()) } else { rays }
    }

    /// One ray from each point above whose horizon the light is.
    fn toward(&self, light: Vec3) -> Rays {
        let mut rays = Rays::default();
        let lit = |point: &&Point| point.normal.dot(light.as_dvec3()) > 0.0;
        for point in self.points.iter().filter(lit) {
            rays.push(point.origin, light);
        }
        rays
    }

    /// Some cosine-distributed rays from each point.
    fn scattered(&self, seed: u64, count: usize) -> Rays {
        let mut rays = Rays::default();
        for row in 0..self.points.len() * count {
            let point = &self.points[row / count];
            rays.push(point.origin, above(point.normal.as_vec3(), seed, row as u64));
        }
        rays
    }
}

impl Point {
    /// Rays start a ten-thousandth of the radius above the surface, and far enough that single
    /// precision keeps the origin outside: neither system is to hit what it starts from.
    fn new(at: &Surface, [x, y, z, radius]: [f32; 4]) -> Self {
        let (center, radius) = (Vec3::new(x, y, z).as_dvec3(), f64::from(radius));
        let (point, normal) = (DVec3::from(at.point), DVec3::from(at.normal));
        let rounding = point.abs().max_element() * f64::from(f32::EPSILON);
        let mut offset = (1e-4 * radius).max(2.0 * rounding);
        loop {
            let origin = (point + normal * offset).as_vec3();
            if origin.as_dvec3().distance(center) > radius {
                return Self { normal, origin };
            }
            offset *= 2.0;
        }
    }
}

/// Rays through all pixels.
fn camera(flat: bool, spheres: &Columns, side: u32, order: Order) -> Rays {
    let Columns { x, y, z, radius } = spheres;
    let view = View::new([x, y, z, radius], flat);
    let mut rays = Rays::default();
    for i in 0..side * side {
        let (eye, direction) = view.ray(order.pixel(i, side), side);
        rays.push(eye, direction);
    }
    rays
}

impl Order {
    /// The name in tables and on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Blocks => "blocks",
            Self::Rows => "rows",
            Self::Random => "random",
            Self::File => "file order",
        }
    }

    /// Column and row of pixel `i`; `side` is a multiple of 4.
    fn pixel(self, i: u32, side: u32) -> (u32, u32) {
        match self {
            Self::Rows => (i % side, i / side),
            Self::Blocks | Self::Random | Self::File => View::in_blocks(i, side),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use spherule_measure::workload::SphereScene;

    #[test]
    fn every_order_has_every_pixel() {
        for order in [Order::Blocks, Order::Rows] {
            let mut pixels: Vec<_> = (0..144).map(|i| order.pixel(i, 12)).collect();
            pixels.sort_unstable();
            pixels.dedup();
            assert_eq!(pixels.len(), 144);
        }
    }

    #[test]
    fn shuffled_rays_are_the_same_rays() {
        let mut rays = Rays::default();
        (0..100).for_each(|i| rays.push(Vec3::splat(i as f32), Vec3::X * i as f32));
        let shuffled = rays.shuffled();
        let mut rows: Vec<_> = (0..100).map(|i| shuffled.row(i)).collect();
        assert!(rows.iter().all(|(origin, direction)| origin.x == direction.x));
        let in_place = rows.iter().enumerate().filter(|(i, row)| row.0.x == *i as f32).count();
        assert!(in_place < 10, "{in_place}");
        rows.sort_by(|a, b| a.0.x.total_cmp(&b.0.x));
        assert!(rows.iter().enumerate().all(|(i, row)| row.0.x == i as f32));
    }

    #[test]
    fn rays_leave_what_they_start_from() {
        let spheres = Columns::of(SphereScene::PAPER400).unwrap();
        let Columns { x, y, z, radius } = &spheres;
        let tree = SphereTree::from_columns(x, y, z, radius).unwrap();
        let seen = Seen::new(true, &spheres, &tree, 64, Order::Blocks).unwrap();
        assert!(seen.points.len() > 400);
        assert_eq!(seen.rays(Class::Ao, Order::Blocks).len(), 4 * seen.points.len());
        let rays = seen.rays(Class::Diffuse, Order::Blocks);
        for (i, point) in seen.points.iter().enumerate() {
            let (origin, direction) = rays.row(i);
            assert!(direction.as_dvec3().dot(point.normal) > 0.0);
            // Straight back down there is the surface, at once.
            let down = tree.intersect(origin.into(), (-point.normal.as_vec3()).into()).unwrap();
            assert!(down.t < 1e-4);
        }
    }
}
