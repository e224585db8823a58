//! The sphere that encloses a point.

use super::{Bvh, Child, Node, WIDTH};
use crate::exact;
use crate::spheres::{LEAF, Spheres};
use glam::{DVec3, Vec3};

/// The sphere that encloses a point, so far.
#[derive(Clone, Copy)]
struct Deepest {
    /// The least power of the point, less than 0.
    power: f64,
    /// The sphere's place in the user's order.
    id: u32,
    row: u32,
}

impl Bvh {
    /// Returns the sphere that encloses a point: of several the one with the least power of the point,
    /// which is the square of its distance from the center minus that of the radius; of equal powers,
    /// the first in the user's order. `None` if no sphere does.
    ///
    /// At the intersection of two spheres both have the same power: on a plane through them the border
    /// between them continues the crease that is seen on their surfaces. (Aurenhammer, "Power Diagrams:
    /// Properties, Algorithms and Applications", SIAM Journal on Computing 1987.)
    pub fn enclosing_sphere(&self, spheres: &Spheres, point: Vec3) -> Option<u32> {
        let mut deepest = None;
        self.for_each_block_at(point, |block| {
            let rows = block * LEAF..spheres.len().min((block + 1) * LEAF);
            rows.for_each(|row| deeper(&mut deepest, spheres, row, point));
        });
        deepest.map(|deepest| deepest.row)
    }

    /// Returns all spheres that enclose a point, the one that [`Bvh::enclosing_sphere`] returns first, and after each the one
    /// that it would return without those before.
    pub fn enclosing_spheres(&self, spheres: &Spheres, point: Vec3) -> Vec<u32> {
        let mut found = Vec::new();
        self.for_each_block_at(point, |block| {
            for row in block * LEAF..spheres.len().min((block + 1) * LEAF) {
                let (center, radius) = spheres.exact(row);
                let power = power(point.as_dvec3(), center, radius);
                if power < 0.0 {
                    found.push((power, spheres.id[row], row as u32));
                }
            }
        });
        found.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        found.into_iter().map(|(.., row)| row).collect()
    }

    /// Calls a function with each block in whose box a point is.
    pub(crate) fn for_each_block_at(&self, point: Vec3, mut each: impl FnMut(usize)) {
        let mut open = if self.is_empty() { Vec::new() } else { vec![Child::node(0)] };
        while let Some(child) = open.pop() {
            if child.kind() == Child::BLOCK {
                each(child.index());
            } else {
                let node = &self.nodes()[child.index()];
                let inside = (0..WIDTH).filter(|&i| contains(node, i, point));
                open.extend(inside.map(|i| node.child[i]));
            }
        }
    }
}

/// Returns whether the box of child `i` contains a point.
fn contains(node: &Node, i: usize, point: Vec3) -> bool {
    (0..3).all(|axis| {
        let [low, high] = &node.planes[axis];
        low[i] <= point[axis] && point[axis] <= high[i]
    })
}

/// Replaces the deepest sphere by one that encloses the point more deeply.
fn deeper(deepest: &mut Option<Deepest>, spheres: &Spheres, row: usize, point: Vec3) {
    let (center, radius) = spheres.exact(row);
    let point = point.as_dvec3();
    let (power, id) = (power(point, center, radius), spheres.id[row]);
    let is_deeper = |known: Deepest| power < known.power || (power == known.power && id < known.id);
    if power < 0.0 && deepest.is_none_or(is_deeper) {
        *deepest = Some(Deepest { power, id, row: row as u32 });
    }
}

/// Returns the power of a point. Its sign is exact: negative inside, and 0 or more elsewhere.
pub(super) fn power(point: DVec3, center: DVec3, radius: f64) -> f64 {
    /// A bound of the rounding error, relative to the terms.
    const ERROR: f64 = 8.0 * f64::EPSILON;
    let distance2 = point.distance_squared(center);
    let power = distance2 - radius * radius;
    if power.abs() > ERROR * (distance2 + radius * radius) {
        return power;
    }
    // Rounding hides the sign: decided exactly, and the magnitude does not matter.
    if exact::is_inside(point, center, radius) {
        power.min(-f64::MIN_POSITIVE)
    } else {
        power.max(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bvh::builders::{Builder, build};
    use crate::random::numbered;

    fn random(seed: u32) -> f32 {
        numbered(u64::from(seed), 0)
    }

    #[test]
    fn the_tree_finds_the_sphere_that_brute_force_finds() {
        let mut spheres = Spheres::with_capacity(500);
        for i in 0..500 {
            let center = Vec3::new(random(4 * i), random(4 * i + 1), random(4 * i + 2));
            spheres.push(center, 0.02 + 0.1 * random(4 * i + 3), i);
        }
        let bvh = build(&mut spheres, Builder::default());
        let mut found = [0; 2];
        for i in 0..2000 {
            let point = Vec3::new(random(!(3 * i)), random(!(3 * i + 1)), random(!(3 * i + 2)));
            let mut deepest = None;
            (0..spheres.len()).for_each(|row| deeper(&mut deepest, &spheres, row, point));
            let found_row = bvh.enclosing_sphere(&spheres, point);
            assert_eq!(found_row, deepest.map(|deepest| deepest.row));
            let all = bvh.enclosing_spheres(&spheres, point);
            assert_eq!(all.first().copied(), found_row);
            let at = |&row: &u32| {
                let (center, radius) = spheres.exact(row as usize);
                power(point.as_dvec3(), center, radius)
            };
            assert!(all.iter().map(at).is_sorted(), "{point}");
            let count = (0..spheres.len() as u32).filter(|row| at(row) < 0.0).count();
            assert_eq!(all.len(), count, "{point}");
            found[usize::from(found_row.is_some())] += 1;
        }
        assert!(found[0] > 100 && found[1] > 100, "{found:?}");
    }

    #[test]
    fn points_on_the_surface_are_not_inside_and_the_next_float_is() {
        let mut spheres = Spheres::with_capacity(1);
        spheres.push(Vec3::X, 0.25, 0);
        let bvh = build(&mut spheres, Builder::default());
        let at = |x: f32| bvh.enclosing_sphere(&spheres, Vec3::X * x);
        assert_eq!((at(0.75), at(0.75_f32.next_up())), (None, Some(0)));
        assert_eq!((at(1.25), at(1.25_f32.next_down())), (None, Some(0)));
        assert_eq!(Bvh::default().enclosing_sphere(&Spheres::with_capacity(0), Vec3::ZERO), None);
    }

    #[test]
    fn ties_go_to_the_first_sphere_of_the_scene() {
        let mut spheres = Spheres::with_capacity(3);
        for (x, id) in [(0.5, 2), (-0.5, 1), (0.5, 0)] {
            spheres.push(Vec3::X * x, 1.0, id);
        }
        let bvh = build(&mut spheres, Builder::default());
        let id = |x: f32| {
            bvh.enclosing_sphere(&spheres, Vec3::X * x).map(|row| spheres.id[row as usize])
        };
        assert_eq!([id(0.25), id(-0.25), id(0.0)], [Some(0), Some(1), Some(0)]);
    }
}
