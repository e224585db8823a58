//! Rays among translucent bodies. A body lets part of the light through where a ray enters it, however long its path inside.
//!
//! The opacity of a body is given as an [`OpticalDepth`], and those of bodies that a ray intersects add up (Bouguer, Lambert and
//! Beer). A ray ends at the body at which their sum reaches the ray's threshold. If thresholds are distributed exponentially, it
//! ends at each body with the probability that is the body's weight in the image, composited in front of all that are farther
//! (Enderton, Sintorn, Shirley and Luebke, "Stochastic Transparency", I3D 2010). Optical depths are integers, so that no sum
//! depends on the order of its terms.
//!
//! The bodies that a ray intersects, and their order along it, are decided as exactly as for opaque bodies. A ray that starts
//! inside of a translucent body leaves it unattenuated.

use crate::bodies::{BodyTrees, row_at, with_tree};
use crate::body_rows::{BodyKind, BodyRow};
use crate::body_tree::{self, Part, Sphere};
use crate::bvh::{Intersection, for_each_intersection};
use crate::elementary;
use crate::exact::Quotient;
use crate::intersect::Root;
use crate::ray::{ExactRay, MISS};
use std::cell::Cell;
use std::cmp::Ordering;
use std::ops::ControlFlow;

/// Attenuation of light by a body, in units of 2^-32 halvings.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct OpticalDepth(u64);

impl OpticalDepth {
    /// No attenuation.
    pub const NONE: Self = Self(0);

    /// That of an opaque body.
    pub const OPAQUE: Self = Self(1 << 62);

    /// Depth beyond which the light behind all bodies is left to chance: 1/256 of it passes.
    const DEEP: Self = Self(8 << 32);

    const HALVING: f64 = (1_u64 << 32) as f64;

    /// The optical depth of a body of an opacity from 0 to 1.
    pub fn of_opacity(opacity: f64) -> Self {
        if opacity >= 1.0 {
            return Self::OPAQUE;
        }
        Self((-elementary::log2(1.0 - opacity) * Self::HALVING).round() as u64)
    }

    /// The opacity of all bodies with this sum.
    pub fn opacity(self) -> f64 {
        1.0 - elementary::exp2(-(self.0 as f64 / Self::HALVING))
    }

    /// The threshold of a ray, from a number that is distributed uniformly from 0 up to 1, not 1 itself. A single body stops
    /// the ray if the number is less than its opacity.
    pub fn threshold(uniform: f64) -> Self {
        let depth = -elementary::log2(1.0 - uniform) * Self::HALVING;
        // More than 0: rays do not end before the first body.
        Self(depth.round() as u64 + 1)
    }

    /// Returns whether it is opaque.
    pub fn is_opaque(self) -> bool {
        self >= Self::OPAQUE
    }

    /// The sum of two depths.
    #[must_use]
    pub fn plus(self, other: Self) -> Self {
        Self(self.0.saturating_add(other.0))
    }

    /// The rest of a threshold after a body that does not stop the ray.
    #[must_use]
    pub fn after(self, body: Self) -> Self {
        Self(self.0.saturating_sub(body.0))
    }
}

/// Bodies of all kinds, with the depth of each.
#[derive(Clone, Copy, Debug)]
pub struct TranslucentBodies<'a, D> {
    /// The bodies.
    pub bodies: BodyTrees<'a>,
    /// The depth of the body of a hit.
    pub depth: D,
}

/// A ray that ends where its attenuation reaches a threshold.
#[derive(Clone, Copy, Debug)]
pub struct AttenuatedRay {
    /// The ray.
    pub ray: ExactRay,
    /// The body that it starts on, and the one that it is aimed at, which it does not intersect; or [`MISS`].
    pub ends: [u32; 2],
    /// The depth at which it ends.
    pub threshold: OpticalDepth,
    /// Distance beyond which nothing counts, and the hit there: [`GROUND`](crate::ray::GROUND), or [`MISS`] for none.
    pub known: (f64, u32),
}

/// A body that a ray intersects.
#[derive(Clone, Copy, Debug)]
pub struct Fragment {
    root: Root,
    hit: u32,
    /// True if the ray starts inside.
    inside: bool,
    depth: OpticalDepth,
}

impl Fragment {
    /// The known end of a ray: the ground, or the distance beyond which nothing counts.
    fn known(attenuated: &AttenuatedRay) -> Self {
        let (t, hit) = attenuated.known;
        let root = Root { t, error: 0.0, exact: false };
        Self { root, hit, inside: false, depth: OpticalDepth::OPAQUE }
    }

    /// The body as what a part of a ray's light sees.
    fn seen(&self, coverage: f64) -> SeenBody {
        let coverage = if self.hit == MISS { 0.0 } else { coverage };
        SeenBody { t: self.root.t, hit: self.hit, coverage }
    }

    /// A distance beyond which nothing is nearer.
    fn far(&self) -> f32 {
        ((self.root.t + self.root.error) as f32).next_up()
    }
}

/// Returns the sum of the depths of bodies.
fn sum_of(fragments: &[Fragment]) -> OpticalDepth {
    fragments.iter().fold(OpticalDepth::NONE, |sum, body| sum.plus(body.depth))
}

/// Returns the first of bodies, in their order along a ray, at which the sum of depths reaches a threshold.
fn first_at(fragments: &[Fragment], threshold: OpticalDepth) -> Option<usize> {
    let mut sum = OpticalDepth::NONE;
    fragments.iter().position(|fragment| {
        sum = sum.plus(fragment.depth);
        sum >= threshold
    })
}

/// Returns bodies, in their order along a ray, with the part of its light that each stands for.
pub fn shares(fragments: &[Fragment]) -> impl Iterator<Item = (u32, f64)> {
    let mut sum = OpticalDepth::NONE;
    fragments.iter().map(move |fragment| {
        let before = sum.opacity();
        sum = sum.plus(fragment.depth);
        (fragment.hit, sum.opacity() - before)
    })
}

/// A body that a ray sees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SeenBody {
    /// Distance along the ray.
    pub t: f64,
    /// The body, the known hit, or [`MISS`].
    pub hit: u32,
    /// The part of the ray's light that the hit stands for, from 0 to 1. The rest is what nothing hides: the light behind all
    /// bodies.
    pub coverage: f64,
}

impl<D: Fn(u32) -> OpticalDepth> TranslucentBodies<'_, D> {
    /// Returns the body at which a ray ends: `attenuated.known` if none ends it before. `fragments` is memory to work with. Also
    /// returns how many decisions were made on integers.
    pub fn closest(
        &self,
        attenuated: &AttenuatedRay,
        fragments: &mut Vec<Fragment>,
    ) -> (SeenBody, u64) {
        let (end, exact) = self.gather(attenuated, fragments);
        (end.seen(1.0), exact)
    }

    /// Chooses one of the bodies on a ray by a number that is distributed uniformly from 0 up to 1. Where nothing opaque is
    /// behind them, one is chosen always, and only what it stands for is less than all of the light: so the picture has no noise
    /// from rays that pass all bodies. `attenuated.threshold` is not used. On return `fragments` are the bodies on the ray, down
    /// to the first beyond which hardly any light passes. Also returns how many decisions were made on integers.
    pub fn choose(
        &self,
        attenuated: &AttenuatedRay,
        number: f64,
        fragments: &mut Vec<Fragment>,
    ) -> (SeenBody, u64) {
        let threshold = OpticalDepth::threshold(number);
        let farthest =
            AttenuatedRay { threshold: threshold.max(OpticalDepth::DEEP), ..*attenuated };
        let (end, exact) = self.gather(&farthest, fragments);
        let all = sum_of(fragments);
        let opens = end.hit == MISS && OpticalDepth::NONE < all && all < OpticalDepth::DEEP;
        let (threshold, coverage) = if opens {
            let coverage = all.opacity();
            (OpticalDepth::threshold(number * coverage).min(all), coverage)
        } else {
            (threshold, 1.0)
        };
        let body = first_at(fragments, threshold).map_or(end, |body| fragments[body]);
        if end.hit != MISS {
            fragments.push(end);
        }
        if let Some(last) = first_at(fragments, OpticalDepth::DEEP) {
            fragments.truncate(last + 1);
        }
        (body.seen(coverage), exact)
    }

    /// Finds the body at which a ray ends, and those before it, in their order. Also returns how many decisions were made on
    /// integers.
    fn gather(&self, attenuated: &AttenuatedRay, fragments: &mut Vec<Fragment>) -> (Fragment, u64) {
        fragments.clear();
        let mut end = Fragment::known(attenuated);
        let (mut all, mut exact) = (OpticalDepth::NONE, 0);
        self.for_each_body(attenuated, end.far(), |fragment| {
            exact += u64::from(fragment.root.exact);
            let before = |other: &Fragment, exact: &mut u64| {
                self.order(&attenuated.ray, other, &fragment, exact) == Ordering::Less
            };
            if before(&end, &mut exact) {
                return ControlFlow::Continue(end.far());
            }
            let place = fragments.iter().rposition(|other| before(other, &mut exact));
            fragments.insert(place.map_or(0, |place| place + 1), fragment);
            all = all.plus(fragment.depth);
            if all >= attenuated.threshold
                && let Some(last) = first_at(fragments, attenuated.threshold)
            {
                end = fragments[last];
                fragments.truncate(last);
                all = sum_of(fragments);
            }
            ControlFlow::Continue(end.far())
        });
        (end, exact)
    }

    /// Returns whether a ray ends before `attenuated.known`, and how many decisions were made on integers.
    pub fn occluded(&self, attenuated: &AttenuatedRay) -> (bool, u64) {
        let (sum, exact) = self.depth_before(attenuated);
        (sum >= attenuated.threshold, exact)
    }

    /// Returns the part of the light at `attenuated.known` that passes all bodies before it, and how many decisions were made on
    /// integers. Where hardly any does, the threshold decides between none and all.
    pub fn transmittance(&self, attenuated: &AttenuatedRay) -> (f64, u64) {
        let threshold = attenuated.threshold.max(OpticalDepth::DEEP);
        let (sum, exact) = self.depth_before(&AttenuatedRay { threshold, ..*attenuated });
        if sum < OpticalDepth::DEEP {
            return (1.0 - sum.opacity(), exact);
        }
        (if sum < threshold { 1.0 } else { 0.0 }, exact)
    }

    /// Returns the depth of all bodies before `attenuated.known`, or a part of it that reaches the threshold. Also returns how
    /// many decisions were made on integers.
    fn depth_before(&self, attenuated: &AttenuatedRay) -> (OpticalDepth, u64) {
        let end = Fragment::known(attenuated);
        let (mut sum, mut exact) = (OpticalDepth::NONE, 0);
        self.for_each_body(attenuated, end.far(), |fragment| {
            exact += u64::from(fragment.root.exact);
            if self.order(&attenuated.ray, &fragment, &end, &mut exact) == Ordering::Less {
                sum = sum.plus(fragment.depth);
                if sum >= attenuated.threshold {
                    return ControlFlow::Break(());
                }
            }
            ControlFlow::Continue(end.far())
        });
        (sum, exact)
    }

    /// Calls a function with each body that may end the ray. The function returns a distance beyond which no body matters, or breaks.
    fn for_each_body(
        &self,
        attenuated: &AttenuatedRay,
        mut t_far: f32,
        mut visit: impl FnMut(Fragment) -> ControlFlow<(), f32>,
    ) {
        let AttenuatedRay { ref ray, ends, .. } = *attenuated;
        let ended = Cell::new(false);
        let mut body =
            |hit: u32, Intersection { root, inside, .. }: Intersection, t_far: &mut f32| {
                let depth = (self.depth)(hit);
                if inside && !depth.is_opaque() {
                    return ControlFlow::Continue(*t_far);
                }
                let flow = visit(Fragment { root, hit, inside, depth });
                match flow {
                    ControlFlow::Continue(far) => *t_far = far,
                    ControlFlow::Break(()) => ended.set(true),
                }
                flow
            };
        for_each_intersection(self.bodies.tree, ray, ends, t_far, |found| {
            body(found.row as u32, found, &mut t_far)
        });
        let rows = self.bodies.rows();
        for kind in BodyKind::ALL {
            if ended.get() || rows.count(kind) == 0 {
                continue;
            }
            let of_kind = |end: BodyRow| (end.kind == kind).then_some(end.row);
            let (own, first) = (ends.map(|end| rows.row(end).and_then(of_kind)), t_far);
            with_tree!(self.bodies, kind, |tree| {
                body_tree::for_each_intersection(tree, ray, own, first, |found| {
                    let hit = rows.hit(row_at(tree, found.row, ray, found.root.t));
                    body(hit, found, &mut t_far)
                });
            });
        }
    }

    /// Compares the distances of two bodies; of those at the same distance the one that comes first in the user's order, spheres
    /// before capsules, ellipsoids, cones and triangles, counts as the nearer one. The ground comes last, and a bound first.
    fn order(&self, ray: &ExactRay, a: &Fragment, b: &Fragment, exact: &mut u64) -> Ordering {
        if a.root.t + a.root.error < b.root.t - b.root.error {
            return Ordering::Less;
        }
        if a.root.t - a.root.error > b.root.t + b.root.error {
            return Ordering::Greater;
        }
        self.compare_closely(ray, a, b, exact)
            .then_with(|| self.place(a.hit).cmp(&self.place(b.hit)))
    }

    #[cold]
    fn compare_closely(
        &self,
        ray: &ExactRay,
        a: &Fragment,
        b: &Fragment,
        exact: &mut u64,
    ) -> Ordering {
        if a.inside == b.inside
            && let (Some(first), Some(second)) = (self.sphere_at(ray, a), self.sphere_at(ray, b))
            && first == second
        {
            return Ordering::Equal;
        }
        let [first, second] = [a, b].map(|fragment| self.closest_root(ray, fragment));
        let gap = first.t - second.t;
        if gap.abs() > first.error + second.error {
            return gap.total_cmp(&0.0);
        }
        *exact += 1;
        self.distance(ray, &first, a).compare(&self.distance(ray, &second, b))
    }

    /// The sphere whose surface is hit; `None` if there is none.
    fn sphere_at(&self, ray: &ExactRay, fragment: &Fragment) -> Option<Sphere> {
        let row = self.bodies.rows().row(fragment.hit)?;
        let part = match row.kind {
            BodyKind::Sphere => Part::Body,
            _ => self.bodies.decide(ray, row)?.part,
        };
        self.bodies.sphere_of(row, part)
    }

    /// Returns the distance of a body with its closest bound. One without error is a given number: a bound, or 0 where the ray
    /// starts on a body.
    fn closest_root(&self, ray: &ExactRay, fragment: &Fragment) -> Root {
        let number = Root { error: 0.0, ..fragment.root };
        if fragment.root.error == 0.0 {
            return number;
        }
        let row = self.bodies.rows().row(fragment.hit);
        let hit = row.and_then(|row| self.bodies.decide(ray, row));
        // Without error, the body is hit where the ray starts.
        hit.map(|hit| hit.root).filter(|root| root.error > 0.0).unwrap_or(number)
    }

    /// Returns the distance of a body without rounding.
    fn distance(&self, ray: &ExactRay, root: &Root, fragment: &Fragment) -> Quotient {
        self.bodies.distance(ray, root, self.bodies.rows().row(fragment.hit))
    }

    /// The place of a hit among those at the same distance.
    fn place(&self, hit: u32) -> (u32, BodyKind, u32) {
        match self.bodies.rows().row(hit) {
            None if hit == MISS => (0, BodyKind::Sphere, 0),
            Some(row) => (1, row.kind, self.bodies.id(row)),
            None => (2, BodyKind::Sphere, 0),
        }
    }
}
