//! Bodies other than spheres in columns, and a tree over them: all of one kind, such as capsules.
//!
//! They are traced after the spheres, in trees of their own, so that scenes of spheres do not pay for them.

mod body;
mod crossing;
mod filter_ray;
mod intersections;

pub(crate) use body::Body;
pub use body::Sphere;
pub use crossing::{BodyHit, Doubt, Line, Part, Side};
pub(crate) use crossing::{first_ahead, normal_or_against, sign};
pub use filter_ray::FilterRay;
pub(crate) use filter_ray::{cross, magnitude};
pub(crate) use intersections::for_each_intersection;

use crate::body_rows::BodyKind;
use crate::bvh::builders::{Builder, Item, build_around};
use crate::bvh::{Beam, Bounds, Bvh};
use crate::exact::Quotient;
use crate::lanes::F32x8;
use crate::ray::ExactRay;
use crate::slabs::MARGIN;
use crate::spheres::LEAF;
use glam::{DVec3, Vec3};
use std::fmt::Debug;

/// A kind of convex body: its columns, its bounds, and the terms of which a hit is decided. A surface without inside is one, too.
pub trait Shape: Copy + Debug + PartialEq {
    /// The kind.
    const KIND: BodyKind;

    /// A body from which a tree is built.
    type Item: Copy + Debug;
    /// The columns of [`LEAF`] bodies side by side.
    type Block: Copy + Debug;
    /// A line and a body, in double precision with bounds.
    type Line: Line;

    /// Returns whether a body has an inside; else it is a surface that is seen from both sides.
    const HAS_INSIDE: bool = true;

    /// A block without bodies: no ray may hit any.
    const EMPTY: Self::Block;

    /// A sphere around a body, center and radius, up to rounding, and the body's place in the user's order.
    fn around(item: &Self::Item) -> (Vec3, f32, u32);

    /// Writes a body to a lane of a block.
    fn store(item: &Self::Item, block: &mut Self::Block, lane: usize);

    /// The body in a lane of a block.
    fn load(block: &Self::Block, lane: usize) -> Self;

    /// The least and greatest coordinates of a body, or bounds of them.
    fn extent(&self) -> [DVec3; 2];

    /// Returns whether a point is inside the body, not on its surface, in double precision.
    fn contains(&self, point: DVec3) -> bool;

    /// Returns whether none of its numbers is infinite or NaN.
    fn is_finite(&self) -> bool;

    /// Returns a bit for each body of a block that a ray may hit no farther than `t_max`, and distances before which it does
    /// not.
    fn may_hit(ray: &FilterRay, block: &Self::Block, t_max: f32) -> (u32, F32x8);

    /// Returns whether a ray enters the body at its origin, and the part of the surface there, for an origin that is on the surface within its own
    /// rounding ([`ExactRay::origin_error`]); `None` if it is elsewhere.
    fn enters_at_origin(&self, ray: &ExactRay) -> Option<(bool, Part)>;

    /// Returns the line of a ray; `None` if it misses the body.
    ///
    /// # Errors
    ///
    /// Fails where double precision cannot decide.
    fn line(&self, ray: &ExactRay) -> Result<Option<Self::Line>, Doubt>;

    /// Returns where a ray hits the body, without rounding; `None` if it does not. The ray's origin is taken as exact, all numbers are
    /// finite.
    fn exact_hit(&self, ray: &ExactRay) -> Option<(Quotient, Part)>;

    /// Returns the distance at which a line leaves the body, likewise; `None` if it misses it or leaves it before the origin.
    fn exact_exit(&self, ray: &ExactRay) -> Option<Quotient>;

    /// The sphere whose surface a part of the surface is; `None` if there is none. Spheres of other bodies may coincide with it.
    fn end_sphere(&self, _: Part) -> Option<Sphere> {
        None
    }

    /// Returns the number, among those of a body, of its hit at a distance of a ray, of a kind with more than one ([`BodyKind::hits`]).
    fn half_at(&self, _: &ExactRay, _: f64) -> usize {
        0
    }

    /// The outward unit normal at a point of the surface, which need not be there by more than rounding; 0 where there is none.
    fn normal_at(&self, point: DVec3) -> DVec3;

    /// Returns the point of the surface where a ray hits the body, and the unit normal there: outward, or against the ray where the body is thinner
    /// than rounding.
    fn surface_at(&self, ray: &ExactRay, t: f64) -> (DVec3, DVec3);

    /// A sphere that stands for the body, or for one of its halves ([`BodyKind::hits`]), where only its place and size count.
    fn like_sphere(&self, _: usize) -> Sphere {
        let [low, high] = self.extent();
        Sphere { center: low.midpoint(high), radius: (high - low).max_element() / 2.0 }
    }

    /// Decides whether and where a ray hits the body, as arithmetic without rounding would.
    ///
    /// Outside, that is where it enters; inside, where it leaves. A body is closed: a ray that only touches it hits. Where the origin is on the
    /// surface the direction decides: a ray that leaves misses, one that enters hits the far side, and one that runs along a
    /// face hits its edge. On the surface is exactly so, or for an origin that was rounded itself ([`ExactRay::origin_error`])
    /// within that rounding; then a ray that enters hits at once. Zero directions, and anything infinite or NaN, miss.
    #[inline(always)]
    fn intersect(&self, ray: &ExactRay) -> Option<BodyHit> {
        crossing::intersect(ray, self)
    }

    /// Returns the distance at which a line leaves the body, ahead of its origin, which is on the surface or inside, within
    /// rounding; 0 if it has left it.
    fn exit_distance(&self, ray: &ExactRay) -> f64 {
        crossing::exit_distance(ray, self)
    }
}

/// Bodies of one kind, and the tree over them.
#[derive(Clone, Debug)]
pub struct BodyTree<S: Shape> {
    blocks: Vec<S::Block>,
    /// Place in the user's order. Of two bodies at the same distance the one with the lower id is hit.
    id: Vec<u32>,
    bvh: Bvh,
}

impl<S: Shape> Default for BodyTree<S> {
    fn default() -> Self {
        Self { blocks: Vec::new(), id: Vec::new(), bvh: Bvh::default() }
    }
}

impl<S: Shape> BodyTree<S> {
    /// The most bodies there can be.
    pub const MAX: usize = 1 << 30;

    /// Builds the tree over bodies.
    pub fn build(items: &[S::Item], builder: Builder) -> Self {
        let around = |(row, item): (usize, &S::Item)| {
            let (center, reach, _) = S::around(item);
            Item { sphere: [center.x, center.y, center.z, reach], id: row as u32 }
        };
        let (order, bvh) = build_around(items.iter().enumerate().map(around).collect(), builder);
        let block = |rows: &[u32]| {
            let mut block = S::EMPTY;
            for (lane, &row) in rows.iter().enumerate() {
                S::store(&items[row as usize], &mut block, lane);
            }
            block
        };
        let blocks = order.chunks(LEAF).map(block).collect();
        let id = order.iter().map(|&row| S::around(&items[row as usize]).2).collect();
        let mut tree = Self { blocks, id, bvh: Bvh::default() };
        tree.bvh = bvh.refitted(|block| tree.bounds_of(block));
        tree
    }

    /// Number of bodies.
    pub fn len(&self) -> usize {
        self.id.len()
    }

    /// Returns whether there is none.
    pub fn is_empty(&self) -> bool {
        self.id.is_empty()
    }

    /// Places in the user's order, by row.
    pub fn ids(&self) -> &[u32] {
        &self.id
    }

    /// Bytes of bodies and tree.
    pub fn bytes(&self) -> usize {
        size_of_val(self.blocks.as_slice()) + size_of_val(self.id.as_slice()) + self.bvh.bytes()
    }

    /// Returns whether any ray in a beam may hit a body: never false if one does.
    pub fn may_be_hit(&self, beam: &Beam) -> bool {
        self.bvh.may_meet(beam, |_| true)
    }

    /// The box of all bodies; `None` if there is none.
    pub fn bounds(&self) -> Option<Bounds> {
        self.bvh.bounds()
    }

    /// Row `i`.
    pub fn body(&self, i: usize) -> S {
        S::load(&self.blocks[i / LEAF], i % LEAF)
    }

    /// Returns the body that contains a point, not on its surface; of several the first in the user's order. Decided in double
    /// precision: a point that is on a surface but for rounding may be called either.
    pub fn enclosing(&self, point: DVec3) -> Option<usize> {
        let mut found: Option<usize> = None;
        self.for_each_around(point, |row| {
            if found.is_none_or(|known| self.id[row] < self.id[known]) {
                found = Some(row);
            }
        });
        found
    }

    /// Returns all bodies that contain a point, in the user's order.
    pub fn all_enclosing(&self, point: DVec3) -> Vec<usize> {
        let mut found = Vec::new();
        self.for_each_around(point, |row| found.push(row));
        found.sort_unstable_by_key(|&row| self.id[row]);
        found
    }

    /// Calls a function with each body that contains a point.
    fn for_each_around(&self, point: DVec3, mut visit: impl FnMut(usize)) {
        self.bvh.for_each_block_at(point.as_vec3(), |block| {
            let rows = block * LEAF..self.len().min((block + 1) * LEAF);
            rows.filter(|&row| self.body(row).contains(point)).for_each(&mut visit);
        });
    }

    /// The blocks, and the tree over them.
    #[inline(always)]
    pub(crate) fn parts(&self) -> (&[S::Block], &Bvh) {
        (&self.blocks, &self.bvh)
    }

    /// A box that holds the bodies of a block, and more than rounding about them.
    fn bounds_of(&self, block: usize) -> Bounds {
        let rows = block * LEAF..self.len().min((block + 1) * LEAF);
        rows.fold(Bounds::EMPTY, |all, row| {
            let [low, high] = self.body(row).extent();
            let (low, high) = (low - f64::from(MARGIN), high + f64::from(MARGIN));
            // Rounding to single precision may fall on the inner side; the next number cannot.
            let low = low.as_vec3().to_array().map(f32::next_down);
            let high = high.as_vec3().to_array().map(f32::next_up);
            all.union(&Bounds { low: low.into(), high: high.into() })
        })
    }
}

#[cfg(test)]
pub(crate) mod tests;
