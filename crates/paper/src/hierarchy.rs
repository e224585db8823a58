//! The paper's tree: a BVH by median splits along the longest axis, with one sphere in each leaf.
//! Each node is a separate allocation.

use super::shape::{Hit, Ray, Sphere};
use glam::DVec3;

/// A subtree.
pub(super) enum Node {
    /// Index into the array of spheres.
    Leaf(usize),
    /// Two children and their bounding box.
    Branch { low: DVec3, high: DVec3, children: [Box<Node>; 2] },
}

impl Node {
    /// Builds the tree; `None` if there are no spheres.
    pub(super) fn build(spheres: &[Sphere]) -> Option<Self> {
        let mut rows: Vec<usize> = (0..spheres.len()).collect();
        (!rows.is_empty()).then(|| Self::build_over(spheres, &mut rows))
    }

    fn build_over(spheres: &[Sphere], rows: &mut [usize]) -> Self {
        if let [row] = rows {
            return Self::Leaf(*row);
        }
        let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for &row in &*rows {
            low = low.min(spheres[row].center - spheres[row].radius);
            high = high.max(spheres[row].center + spheres[row].radius);
        }
        let axis = (high - low).max_position();
        rows.sort_by(|&a, &b| spheres[a].center[axis].total_cmp(&spheres[b].center[axis]));
        let (first, second) = rows.split_at_mut(rows.len() / 2);
        let children = [first, second].map(|half| Box::new(Self::build_over(spheres, half)));
        Self::Branch { low, high, children }
    }

    /// Updates the nearest hit with that of this subtree if it is nearer.
    pub(super) fn closest(&self, spheres: &[Sphere], ray: &Ray, nearest: &mut Hit) {
        match self {
            Self::Leaf(row) => spheres[*row].closest(*row, ray, nearest),
            Self::Branch { low, high, children } => {
                if intersects_box([*low, *high], ray, nearest.t) {
                    for half in children {
                        half.closest(spheres, ray, nearest);
                    }
                }
            }
        }
    }

    /// Returns whether a sphere of this subtree is hit nearer than `t_max`.
    pub(super) fn any(&self, spheres: &[Sphere], ray: &Ray, t_max: f64) -> bool {
        match self {
            Self::Leaf(row) => spheres[*row].hit(ray, t_max).is_some(),
            Self::Branch { low, high, children } => {
                intersects_box([*low, *high], ray, t_max)
                    && children.iter().any(|half| half.any(spheres, ray, t_max))
            }
        }
    }
}

/// Returns whether a ray intersects the box between its origin and `t_max`, by the slab test (Kay and
/// Kajiya, "Ray Tracing Complex Scenes", SIGGRAPH 1986).
fn intersects_box([low, high]: [DVec3; 2], ray: &Ray, t_max: f64) -> bool {
    let (a, b) = ((low - ray.origin) / ray.direction, (high - ray.origin) / ray.direction);
    a.min(b).max_element().max(0.0) <= a.max(b).min_element().min(t_max)
}
