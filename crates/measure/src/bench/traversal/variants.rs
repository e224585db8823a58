//! The traversals that are compared.

use spherule_render::bvh::{
    Any, Closest, PacketWidth, Query, Tracer, Traversal, Tree, Unverified, Visits, count_visits,
    trace,
};
use spherule_render::lanes::{F32x4, F32x8, F32x16};
use spherule_render::ray::{Hits, Rays};

/// A traversal that is measured.
pub(super) struct Variant {
    pub(super) name: &'static str,
    pub(super) tracer: Tracer,
    /// True if hits are verified, not accepted from the single-precision test.
    pub(super) exact: bool,
}

/// Maximum number of spheres for brute force.
const MAX_BRUTE: usize = 1000;

pub(super) const SINGLE: usize = 1;
pub(super) const AUTO: usize = 6;

pub(super) const VARIANTS: [Variant; 8] = [
    Variant::new("brute force", Traversal::Brute, PacketWidth::Sixteen),
    Variant::new("single", Traversal::Single, PacketWidth::One),
    Variant::new("stream", Traversal::Stream, PacketWidth::One),
    Variant::new("packets of 4", Traversal::Packet, PacketWidth::Four),
    Variant::new("packets of 8", Traversal::Packet, PacketWidth::Eight),
    Variant::new("packets of 16", Traversal::Packet, PacketWidth::Sixteen),
    Variant::new("auto", Traversal::Auto, PacketWidth::Sixteen),
    Variant { exact: false, ..Variant::new("auto, rough", Traversal::Auto, PacketWidth::Sixteen) },
];

impl Variant {
    const fn new(name: &'static str, traversal: Traversal, width: PacketWidth) -> Self {
        Self { name, tracer: Tracer { traversal, width }, exact: true }
    }

    /// Returns whether to measure the variant in a scene.
    pub(super) fn suits(&self, spheres: usize) -> bool {
        self.tracer.traversal != Traversal::Brute || spheres <= MAX_BRUTE
    }

    /// Traces rays, for any hit or the closest.
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

    /// Counts the visits of rays, for any hit or the closest.
    pub(super) fn count(&self, any: bool, tree: Tree, rays: &Rays) -> Visits {
        if any { self.count_of::<Any>(tree, rays) } else { self.count_of::<Closest>(tree, rays) }
    }

    fn count_of<Q: Query>(&self, tree: Tree, rays: &Rays) -> Visits {
        let mut hits = Hits::with_capacity(rays.len());
        let Tracer { traversal, width } = self.tracer;
        match width {
            PacketWidth::Four => count_visits::<F32x4, Q>(traversal, tree, rays, &mut hits),
            PacketWidth::Eight => count_visits::<F32x8, Q>(traversal, tree, rays, &mut hits),
            // The variants of one lane trace no packets.
            PacketWidth::One | PacketWidth::Sixteen => {
                count_visits::<F32x16, Q>(traversal, tree, rays, &mut hits)
            }
        }
    }
}
