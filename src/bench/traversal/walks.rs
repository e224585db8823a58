//! The walks that are compared.

use super::Tree;
use crate::bvh::walk::{Any, Closest, Method, Query, Rough, Visits, trace, visits};
use crate::lanes::{F32x4, F32x8, F32x16, Lanes};
use crate::ray::{Hits, Rays};

/// Traces rays.
pub(super) type Run = fn(Method, &Tree, &Rays) -> Hits;
/// Counts what rays visit.
pub(super) type Count = fn(Method, &Tree, &Rays) -> Visits;

/// A way to trace rays: its name, and what it takes for the first hit and for any hit.
pub(super) struct Walk {
    pub(super) name: &'static str,
    pub(super) method: Method,
    pub(super) run: [Run; 2],
    pub(super) count: [Count; 2],
    pub(super) exact: bool,
}

/// Spheres above which brute force takes too long.
const FEW: usize = 1000;

pub(super) const SINGLE: usize = 1;
pub(super) const AUTO: usize = 6;

pub(super) const WALKS: [Walk; 8] = [
    Walk::of::<F32x16>("brute force", Method::Brute),
    Walk::of::<f32>("single", Method::Single),
    Walk::of::<f32>("stream", Method::Stream),
    Walk::of::<F32x4>("packets of 4", Method::Packet),
    Walk::of::<F32x8>("packets of 8", Method::Packet),
    Walk::of::<F32x16>("packets of 16", Method::Packet),
    Walk::of::<F32x16>("auto", Method::Auto),
    Walk {
        run: [run::<F32x16, Rough<Closest>>, run::<F32x16, Rough<Any>>],
        exact: false,
        ..Walk::of::<F32x16>("auto, rough", Method::Auto)
    },
];

impl Walk {
    const fn of<L: Lanes>(name: &'static str, method: Method) -> Self {
        let run: [Run; 2] = [run::<L, Closest>, run::<L, Any>];
        let count: [Count; 2] = [count::<L, Closest>, count::<L, Any>];
        Self { name, method, run, count, exact: true }
    }

    /// Whether it is measured in a scene.
    pub(super) fn suits(&self, tree: &Tree) -> bool {
        self.method != Method::Brute || tree.spheres.len() <= FEW
    }
}

fn run<L: Lanes, Q: Query>(method: Method, tree: &Tree, rays: &Rays) -> Hits {
    let mut hits = Hits::with_capacity(rays.len());
    trace::<L, Q>(method, &tree.bvh, &tree.spheres, rays, &mut hits);
    hits
}

fn count<L: Lanes, Q: Query>(method: Method, tree: &Tree, rays: &Rays) -> Visits {
    let mut hits = Hits::with_capacity(rays.len());
    visits::<L, Q>(method, &tree.bvh, &tree.spheres, rays, &mut hits)
}
