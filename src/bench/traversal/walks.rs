//! The traversals that are compared.

use crate::bvh::{
    Any, Closest, PacketWidth, Query, Tracer, Traversal, Tree, Unverified, Visits, count_visits,
    trace,
};
use crate::lanes::{F32x4, F32x8, F32x16};
use crate::ray::{Hits, Rays};

/// A traversal that is measured.
pub(super) struct Walk {
    pub(super) name: &'static str,
    pub(super) tracer: Tracer,
    /// Whether hits are decided exactly.
    pub(super) exact: bool,
}

/// Spheres above which brute force takes too long.
const FEW: usize = 1000;

pub(super) const SINGLE: usize = 1;
pub(super) const AUTO: usize = 6;

pub(super) const WALKS: [Walk; 8] = [
    Walk::new("brute force", Traversal::Brute, PacketWidth::Sixteen),
    Walk::new("single", Traversal::Single, PacketWidth::One),
    Walk::new("stream", Traversal::Stream, PacketWidth::One),
    Walk::new("packets of 4", Traversal::Packet, PacketWidth::Four),
    Walk::new("packets of 8", Traversal::Packet, PacketWidth::Eight),
    Walk::new("packets of 16", Traversal::Packet, PacketWidth::Sixteen),
    Walk::new("auto", Traversal::Auto, PacketWidth::Sixteen),
    Walk { exact: false, ..Walk::new("auto, rough", Traversal::Auto, PacketWidth::Sixteen) },
];

impl Walk {
    const fn new(name: &'static str, traversal: Traversal, width: PacketWidth) -> Self {
        Self { name, tracer: Tracer { traversal, width }, exact: true }
    }

    /// Whether it is measured in a scene.
    pub(super) fn suits(&self, spheres: usize) -> bool {
        self.tracer.traversal != Traversal::Brute || spheres <= FEW
    }

    /// Traces rays: for any hit, or for the first.
    pub(super) fn run(&self, any: bool, tree: Tree, rays: &Rays) -> Hits {
        let mut hits = Hits::with_capacity(rays.len());
        match (self.exact, any) {
            (true, false) => self.tracer.closest(tree, rays, &mut hits),
            (true, true) => self.tracer.occluded(tree, rays, &mut hits),
            (false, false) => self.run_unverified::<Closest>(tree, rays, &mut hits),
            (false, true) => self.run_unverified::<Any>(tree, rays, &mut hits),
        };
        hits
    }

    fn run_unverified<Q: Query>(&self, tree: Tree, rays: &Rays, hits: &mut Hits) -> u64 {
        trace::<F32x16, Unverified<Q>>(self.tracer.traversal, tree, rays, hits)
    }

    /// Counts the visits of rays: for any hit, or for the first.
    pub(super) fn count(&self, any: bool, tree: Tree, rays: &Rays) -> Visits {
        if any { self.count_of::<Any>(tree, rays) } else { self.count_of::<Closest>(tree, rays) }
    }

    fn count_of<Q: Query>(&self, tree: Tree, rays: &Rays) -> Visits {
        let mut hits = Hits::with_capacity(rays.len());
        let Tracer { traversal, width } = self.tracer;
        match width {
            PacketWidth::One => count_visits::<f32, Q>(traversal, tree, rays, &mut hits),
            PacketWidth::Four => count_visits::<F32x4, Q>(traversal, tree, rays, &mut hits),
            PacketWidth::Eight => count_visits::<F32x8, Q>(traversal, tree, rays, &mut hits),
            PacketWidth::Sixteen => count_visits::<F32x16, Q>(traversal, tree, rays, &mut hits),
        }
    }
}
