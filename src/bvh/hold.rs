//! Which sphere holds a point.

use super::{Bvh, Child, Node, WIDTH};
use crate::exact;
use crate::spheres::{LEAF, Spheres};
use glam::{DVec3, Vec3};

/// The sphere that holds a point, so far.
#[derive(Clone, Copy)]
struct Deepest {
    /// The least power of the point, less than 0.
    power: f64,
    /// Of the sphere in the user's scene.
    id: u32,
    row: u32,
}

impl Bvh {
    /// The sphere whose inside holds a point: of several the one with the least power of the point,
    /// the square of its distance from the center less that of the radius; of equal powers, the
    /// first of the user's. `None` if none does.
    ///
    /// Where two spheres meet, both have the same power: on a plane through them the limit between
    /// them continues the crease that is seen on their surfaces. (Aurenhammer, "Power Diagrams:
    /// Properties, Algorithms and Applications", SIAM Journal on Computing 1987.)
    pub fn holder(&self, spheres: &Spheres, point: Vec3) -> Option<u32> {
        if self.is_empty() {
            return None;
        }
        let (mut open, mut deepest) = (vec![Child::node(0)], None);
        while let Some(child) = open.pop() {
            if child.kind() == Child::BLOCK {
                let first = child.index() * LEAF;
                let rows = first..spheres.len().min(first + LEAF);
                rows.for_each(|row| deeper(&mut deepest, spheres, row, point));
            } else {
                let node = &self.nodes()[child.index()];
                let inside = (0..WIDTH).filter(|&i| holds(node, i, point));
                open.extend(inside.map(|i| node.child[i]));
            }
        }
        deepest.map(|deepest| deepest.row)
    }
}

/// Whether the box of child `i`, which is no smaller than what is in it, holds a point.
fn holds(node: &Node, i: usize, point: Vec3) -> bool {
    (0..3).all(|axis| {
        let [low, high] = &node.planes[axis];
        low[i] <= point[axis] && point[axis] <= high[i]
    })
}

/// Takes a sphere in which the point is deeper.
fn deeper(deepest: &mut Option<Deepest>, spheres: &Spheres, row: usize, point: Vec3) {
    let (center, radius) = spheres.exact(row);
    let point = point.as_dvec3();
    let (power, id) = (power(point, center, radius), spheres.id[row]);
    let best = |known: Deepest| power < known.power || (power == known.power && id < known.id);
    if power < 0.0 && deepest.is_none_or(best) {
        *deepest = Some(Deepest { power, id, row: row as u32 });
    }
}

/// The power of a point: negative inside, which is decided without rounding, and 0 or more elsewhere.
fn power(point: DVec3, center: DVec3, radius: f64) -> f64 {
    /// More than the sum is rounded by, relative to its terms.
    const ERROR: f64 = 8.0 * f64::EPSILON;
    let distance2 = point.distance_squared(center);
    let power = distance2 - radius * radius;
    if power.abs() > ERROR * (distance2 + radius * radius) {
        return power;
    }
    // Where it is rounded away, next to nothing says which side it is.
    if exact::is_inside(point, center, radius) {
        power.min(-f64::MIN_POSITIVE)
    } else {
        power.max(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bvh::build::{Builder, build};
    use crate::sampling::{stream, unit};

    fn random(seed: u32) -> f32 {
        unit(stream(0x401d, u64::from(seed)) as u32)
    }

    #[test]
    fn the_tree_finds_what_brute_force_does() {
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
            let held = bvh.holder(&spheres, point);
            assert_eq!(held, deepest.map(|deepest| deepest.row));
            found[usize::from(held.is_some())] += 1;
        }
        assert!(found[0] > 100 && found[1] > 100, "{found:?}");
    }

    #[test]
    fn surfaces_are_not_inside_and_the_next_number_is() {
        let mut spheres = Spheres::with_capacity(1);
        spheres.push(Vec3::X, 0.25, 0);
        let bvh = build(&mut spheres, Builder::default());
        let at = |x: f32| bvh.holder(&spheres, Vec3::X * x);
        assert_eq!((at(0.75), at(0.75_f32.next_up())), (None, Some(0)));
        assert_eq!((at(1.25), at(1.25_f32.next_down())), (None, Some(0)));
        assert_eq!(Bvh::default().holder(&Spheres::with_capacity(0), Vec3::ZERO), None);
    }

    #[test]
    fn of_equal_depths_the_first_of_the_users_counts() {
        let mut spheres = Spheres::with_capacity(3);
        for (x, id) in [(0.5, 2), (-0.5, 1), (0.5, 0)] {
            spheres.push(Vec3::X * x, 1.0, id);
        }
        let bvh = build(&mut spheres, Builder::default());
        let id = |x: f32| bvh.holder(&spheres, Vec3::X * x).map(|row| spheres.id[row as usize]);
        assert_eq!([id(0.25), id(-0.25), id(0.0)], [Some(0), Some(1), Some(0)]);
    }
}
