//! Which walk takes which rays.
//!
//! All of them find the same: what is hit is decided in [`decide`](super::decide). Rays that go alike
//! go in packets ([`packet`](super::packet)), others many at a time but each on its own
//! ([`stream`](super::stream)). Brute force is a packet's leaf test over all spheres: the oracle.

use super::decide::Decider;
use super::Bvh;
use super::packet::Packet;
use super::single::Single;
use super::stream::Stream;
use crate::lanes::Lanes;
use crate::ray::{Columns3, Hits, Rays};
use crate::slabs::Slabs;
use crate::spheres::Spheres;
use glam::Vec3 as Point;
use std::marker::PhantomData;

/// Rays that are looked at together before they are traced.
const CHUNK: usize = 4096;

/// Rays on their way at once (`cargo bench --bench walk`: 64 beats 16 and 32).
const RAYS: usize = 64;

/// Packets on their way at once.
const PACKETS: usize = 8;

/// What a walk wants to know.
pub trait Query {
    /// Whether any hit ends a ray's walk.
    const ANY: bool;
    /// Whether hits are decided exactly.
    const EXACT: bool = true;
}

/// Which sphere is hit first: leaves `t` and `sphere` of the hit.
pub struct Closest;

/// Whether anything is hit nearer than `t`: leaves some sphere, or what was there.
pub struct Any;

/// A query that takes the filter's word for hits and distances, in single precision. For benches
/// alone: what it saves is what exactness costs.
pub struct Rough<Q>(PhantomData<Q>);

impl<Q: Query> Query for Rough<Q> {
    const ANY: bool = Q::ANY;
    const EXACT: bool = false;
}

impl Query for Closest {
    const ANY: bool = false;
}

impl Query for Any {
    const ANY: bool = true;
}

/// How rays find spheres. The answer is the same whichever it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// Test every sphere.
    Brute,
    /// One ray after another.
    Single,
    /// Many rays at a time, each on its own.
    Stream,
    /// In packets where rays go alike, and one after another elsewhere.
    Packet,
    /// In packets where rays go so much alike that it pays, and many at a time elsewhere.
    Auto,
}

/// Traces all rays, in packets of `L::WIDTH` if any; `hits` holds bounds on entry, answers on return.
///
/// Returns how many decisions took arithmetic without rounding.
pub fn trace<'a, L: Lanes, Q: Query>(
    method: Method,
    bvh: &'a Bvh,
    spheres: &'a Spheres,
    rays: &'a Rays,
    hits: &'a mut Hits,
) -> u64 {
    hits.error[..rays.len()].fill(0.0);
    let decider = &mut Decider::<Q>::new(spheres, rays, hits);
    for first in (0..rays.len()).step_by(CHUNK) {
        let rows = first..rays.len().min(first + CHUNK);
        let single = |row: usize| (row, Slabs::new(rays.origin.row(row), rays.direction.row(row)));
        match method {
            Method::Brute => {
                rows.step_by(L::WIDTH).for_each(|row| Packet::<L>::brute(decider, row));
            }
            Method::Single => Stream::<Single, 1>::trace(bvh, decider, rows.map(single)),
            Method::Stream => Stream::<Single, RAYS>::trace(bvh, decider, rows.map(single)),
            Method::Packet | Method::Auto => {
                let mut others = [0_u32; CHUNK];
                let mut count = 0;
                let packets = rows.clone().step_by(L::WIDTH).filter_map(|row| {
                    let slabs = alike::<L>(rays, row);
                    if slabs.is_none() {
                        for row in row..rows.end.min(row + L::WIDTH) {
                            others[count] = row as u32;
                            count += 1;
                        }
                    }
                    Some((row, slabs?))
                });
                Stream::<Packet<L>, PACKETS>::trace(bvh, decider, packets);
                let others = others[..count].iter().map(|&row| single(row as usize));
                Stream::<Single, RAYS>::trace(bvh, decider, others);
            }
        }
    }
    decider.exact
}

/// The bounds of a packet's rays if all go into one octant.
#[inline(always)]
fn alike<L: Lanes>(rays: &Rays, row: usize) -> Option<Slabs> {
    let column = |x: &[f32]| {
        let lanes = L::load(&x[row..]);
        (-(-lanes).greatest(), lanes.greatest())
    };
    let bounds = |columns: &Columns3| {
        let [x, y, z] = [column(&columns.x), column(&columns.y), column(&columns.z)];
        (Point::new(x.0, y.0, z.0), Point::new(x.1, y.1, z.1))
    };
    if row + L::WIDTH > rays.len() {
        return None;
    }
    let direction = bounds(&rays.direction);
    let alike = direction.0.signum() == direction.1.signum();
    alike.then(|| Slabs::between(bounds(&rays.origin), direction))
}
