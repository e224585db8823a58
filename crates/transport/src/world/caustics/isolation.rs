//! Glass spheres that stand alone: nothing intersects their surface, and they are in no other glass.
//!
//! Light passes through such a sphere from air to air on a straight chord.

use super::TOUCH_TOLERANCE;
use crate::ray::MISS;
use crate::shade::MaterialKind;
use crate::world::World;
use glam::Vec3;

/// Children of a box.
const BRANCHES: usize = 16;

/// A hierarchy of boxes around all spheres. The spheres are in the order of the leaves of a tree, in which
/// neighbors are near each other: each box contains sixteen consecutive boxes of the next level.
pub(super) struct Neighborhoods {
    /// Levels of lower and upper corners, those of the spheres first.
    levels: Vec<Vec<[Vec3; 2]>>,
}

impl Neighborhoods {
    pub(super) fn build(world: &World) -> Self {
        let sphere = |row: usize| {
            let (center, radius) = world.spheres.exact(row);
            // Wider than rounding.
            let reach = radius * (1.0 + 1e-6) + center.abs().max_element() * 1e-6;
            [(center - reach).as_vec3(), (center + reach).as_vec3()]
        };
        let mut levels: Vec<Vec<[Vec3; 2]>> = vec![(0..world.spheres.len()).map(sphere).collect()];
        while let Some(last) = levels.last().filter(|last| last.len() > BRANCHES) {
            let join = |boxes: &[[Vec3; 2]]| {
                boxes.iter().copied().reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])])
            };
            let above = last.chunks(BRANCHES).filter_map(join).collect();
            levels.push(above);
        }
        Self { levels }
    }

    /// Returns whether any sphere whose box touches that of `row` has a property.
    fn any(&self, row: u32, has: impl Fn(usize) -> bool) -> bool {
        let [low, high] = self.levels[0][row as usize];
        let touches = |&[a, b]: &[Vec3; 2]| a.cmple(high).all() && b.cmpge(low).all();
        let top = self.levels.len() - 1;
        let mut open: Vec<(usize, usize)> = (0..self.levels[top].len()).map(|i| (top, i)).collect();
        while let Some((level, index)) = open.pop() {
            if !touches(&self.levels[level][index]) {
                continue;
            }
            if level == 0 {
                if index != row as usize && has(index) {
                    return true;
                }
                continue;
            }
            let below = self.levels[level - 1].len();
            let children = BRANCHES * index..(BRANCHES * (index + 1)).min(below);
            open.extend(children.map(|child| (level - 1, child)));
        }
        false
    }

    /// Returns whether a glass sphere stands alone.
    pub(super) fn is_isolated(&self, world: &World, row: u32) -> bool {
        debug_assert_ne!(row, MISS);
        let (center, radius) = world.spheres.exact(row as usize);
        let interferes = |other: usize| {
            let (at, reach) = world.spheres.exact(other);
            let distance = center.distance(at);
            let contains = distance + radius <= reach * (1.0 - TOUCH_TOLERANCE);
            let glass = world.appearance.material.row(other).kind() == MaterialKind::Dielectric;
            distance < (radius + reach) * (1.0 - TOUCH_TOLERANCE) && (glass || !contains)
        };
        let grounded = world.ground.as_ref().is_some_and(|ground| {
            (ground.normal.dot(center) - ground.height).abs() < radius * (1.0 - TOUCH_TOLERANCE)
        });
        !grounded && !self.any(row, interferes)
    }
}
