//! Exact ray queries on spheres: which sphere a ray hits first, and whether it hits any.
//!
//! Answers are those of arithmetic without rounding on the numbers as they are given, without an
//! epsilon, at any scale. A conservative test in single precision, in SIMD lanes, rules out most
//! spheres; double precision with error bounds decides nearly all that is left, and integers decide
//! the rest. Distances are rounded once: each is the double that is nearest to the true one, at a
//! tangent, on a surface, and a million radii away. The [`SphereTree`] is an eight-wide bounding volume hierarchy, walked by packets of 16
//! coherent rays or with 64 incoherent rays in flight.
//!
//! ```
//! use spherule_core::{Hits, RayColumns, SphereTree};
//!
//! let tree = SphereTree::from_columns(&[0.0, 3.0], &[0.0; 2], &[0.0; 2], &[1.0, 0.5])?;
//!
//! // One ray.
//! let hit = tree.intersect([-5.0, 0.0, 0.0], [2.0, 0.0, 0.0]).expect("the ray hits both spheres");
//! assert_eq!((hit.sphere, hit.t, hit.normal), (0, 2.0, [-1.0, 0.0, 0.0]));
//! assert!(!tree.occluded([-5.0, 0.0, 0.0], [2.0, 0.0, 0.0], 2.0));
//!
//! // Many rays, in columns.
//! let rays = RayColumns {
//!     origin: [&[-5.0, 9.0], &[0.0, 0.0], &[0.0, 0.0]],
//!     direction: [&[2.0, -1.0], &[0.0, 0.0], &[0.0, 0.0]],
//! };
//! let (mut t, mut sphere) = ([f64::INFINITY; 2], [0; 2]);
//! tree.intersect_columns(&rays, Hits { t: &mut t, sphere: &mut sphere, surface: None })?;
//! assert_eq!((t, sphere), ([2.0, 5.5], [0, 1]));
//! # Ok::<(), spherule_core::QueryError>(())
//! ```
//!
//! The lane width of the kernels is fixed when the crate is compiled: build with
//! `-C target-cpu=native`, or name the processor that the program is for.

#![forbid(unsafe_code)]
#![cfg_attr(test, allow(clippy::disallowed_methods, reason = "tests compare with tolerances"))]

mod bodies;
mod body_rows;
mod body_tree;
mod bounded;
mod bvh;
mod capsules;
mod cones;
mod conservative;
mod elementary;
mod ellipsoids;
mod exact;
#[cfg(test)]
mod fixed;
mod intersect;
mod lanes;
mod query;
mod radix;
mod random;
mod ray;
mod slabs;
mod spheres;
mod translucency;
mod triangles;
mod vec3;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

pub use query::{Hit, Hits, NOTHING, QueryError, RayColumns, RayRows, SphereTree, Surface, Tally};

/// Items for the renderer and for measurements. Anything here may change in any release.
#[doc(hidden)]
pub mod internals {
    /// Rays among bodies of all kinds.
    pub mod bodies {
        pub use crate::bodies::*;
    }
    /// Numbers of hits.
    pub mod body_rows {
        pub use crate::body_rows::*;
    }
    /// Bodies of one kind in columns, with their tree.
    pub mod body_tree {
        pub use crate::body_tree::{
            BodyHit, BodyTree, Doubt, FilterRay, Line, Part, Shape, Side, Sphere,
        };
    }
    /// The bounding volume hierarchy, its builders and its traversal.
    pub mod bvh {
        pub use crate::bvh::*;
    }
    /// Capsules: cylinders with round ends.
    pub mod capsules {
        pub use crate::capsules::*;
    }
    /// Cones.
    pub mod cones {
        pub use crate::cones::*;
    }
    /// The conservative test in single precision.
    pub mod conservative {
        pub use crate::conservative::*;
    }
    /// Elementary functions that are the same on every platform.
    pub mod elementary {
        pub use crate::elementary::*;
    }
    /// Ellipsoids.
    pub mod ellipsoids {
        pub use crate::ellipsoids::*;
    }
    /// The exact decision, on integers.
    pub mod exact {
        pub use crate::exact::*;
    }
    /// The test in double precision, with error bounds.
    pub mod intersect {
        pub use crate::intersect::*;
    }
    /// SIMD lanes of every width.
    pub mod lanes {
        pub use crate::lanes::*;
    }
    /// Random numbers for rays and spheres of tests.
    pub mod random {
        pub use crate::random::*;
    }
    /// Rays and hits in columns.
    pub mod ray {
        pub use crate::ray::*;
    }
    /// Slabs, the test of boxes.
    pub mod slabs {
        pub use crate::slabs::*;
    }
    /// Spheres in columns.
    pub mod spheres {
        pub use crate::spheres::*;
    }
    /// Rays among translucent bodies.
    pub mod translucency {
        pub use crate::translucency::*;
    }
    /// Triangles.
    pub mod triangles {
        pub use crate::triangles::*;
    }
    /// Vectors of lanes.
    pub mod vec3 {
        pub use crate::vec3::*;
    }
}
