//! The paper's tree: spheres sorted along the longest axis of their bounds and halved, down to one
//! sphere in a leaf; every node is an allocation of its own.

use super::shape::{Hit, Ray, Sphere};
use glam::DVec3;

/// A part of the tree.
pub(super) enum Node {
    /// A row of the array of spheres.
    Leaf(usize),
    /// Two halves and the box about them.
    Branch { low: DVec3, high: DVec3, halves: [Box<Node>; 2] },
}

impl Node {
    /// The tree over an array; `None` if that is empty.
    pub(super) fn build(spheres: &[Sphere]) -> Option<Self> {
        let mut rows: Vec<usize> = (0..spheres.len()).collect();
        (!rows.is_empty()).then(|| Self::over(spheres, &mut rows))
    }

    fn over(spheres: &[Sphere], rows: &mut [usize]) -> Self {
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
        let halves = [first, second].map(|half| Box::new(Self::over(spheres, half)));
        Self::Branch { low, high, halves }
    }

    /// Makes the nearest hit that of this part if that is nearer.
    pub(super) fn closest(&self, spheres: &[Sphere], ray: &Ray, nearest: &mut Hit) {
        match self {
            Self::Leaf(row) => spheres[*row].closest(*row, ray, nearest),
            Self::Branch { low, high, halves } => {
                if enters([*low, *high], ray, nearest.t) {
                    for half in halves {
                        half.closest(spheres, ray, nearest);
                    }
                }
            }
        }
    }

    /// Whether anything in this part is hit nearer than `most`.
    pub(super) fn any(&self, spheres: &[Sphere], ray: &Ray, most: f64) -> bool {
        match self {
            Self::Leaf(row) => spheres[*row].hit(ray, most).is_some(),
            Self::Branch { low, high, halves } => {
                enters([*low, *high], ray, most)
                    && halves.iter().any(|half| half.any(spheres, ray, most))
            }
        }
    }
}

/// Whether a ray is in the box somewhere between its origin and `most` (Kay and Kajiya, "Ray
/// Tracing Complex Scenes", SIGGRAPH 1986).
fn enters([low, high]: [DVec3; 2], ray: &Ray, most: f64) -> bool {
    let (a, b) = ((low - ray.origin) / ray.direction, (high - ray.origin) / ray.direction);
    a.min(b).max_element().max(0.0) <= a.max(b).min_element().min(most)
}
