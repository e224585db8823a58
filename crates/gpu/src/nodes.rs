//! Nodes of trees as kernels read them: boxes of children on a grid of 256 planes by axis, after Ylitie, Karras and
//! Laine, "Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs" (HPG 2017).

use spherule_core::internals::bvh::{Bvh, NodeRow};

/// Children of a node.
const WIDTH: usize = 8;

/// Words of a node: the corner and the grid, planes, and children.
pub(crate) const NODE: usize = 4 + 2 * 3 * WIDTH / 4 + WIDTH;

/// The bit of a child that is none.
const NONE: u32 = 1 << 31;

/// The least exponent of a step. Boxes are wider than what is in them by about as much, so none is finer.
const LEAST_EXPONENT: i32 = -60;

/// Planes of a node by axis and side, lower first, and by child.
type Planes = [[[f32; WIDTH]; 2]; 3];

/// Returns the nodes.
pub(crate) fn rows(bvh: &Bvh) -> Vec<[u32; NODE]> {
    bvh.rows().map(row).collect()
}

fn row(node: NodeRow) -> [u32; NODE] {
    let words: [u32; 7 * WIDTH] = bytemuck::cast(node);
    let (planes, children) = words.split_at(6 * WIDTH);
    let planes: Planes = bytemuck::pod_read_unaligned(bytemuck::cast_slice(planes));
    let exists: [bool; WIDTH] = std::array::from_fn(|child| children[child] != NONE);
    let mut row = [0; NODE];
    for (axis, sides) in planes.iter().enumerate() {
        let grid = Grid::about(sides, exists);
        row[axis] = grid.corner.to_bits();
        row[3] |= ((grid.exponent + 127) as u32) << (8 * axis);
        for child in (0..WIDTH).filter(|&child| exists[child]) {
            let steps = grid.steps([sides[0][child], sides[1][child]]);
            for (side, steps) in steps.into_iter().enumerate() {
                row[4 + 4 * axis + 2 * side + child / 4] |= u32::from(steps) << (8 * (child % 4));
            }
        }
    }
    for child in (0..WIDTH).filter(|&child| exists[child]) {
        row[3] |= 1 << (24 + child);
    }
    row[NODE - WIDTH..].copy_from_slice(children);
    row
}

/// Planes across an axis at equal distances, a power of two.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Grid {
    /// Where the first plane is.
    pub(crate) corner: f32,
    /// The exponent of their distance.
    pub(crate) exponent: i32,
}

impl Grid {
    /// Returns a grid that 255 steps lead across all boxes of children that exist, and 64 do not.
    pub(crate) fn about(sides: &[[f32; WIDTH]; 2], exists: [bool; WIDTH]) -> Self {
        let of = |side: usize| (0..WIDTH).filter(move |&i| exists[i]).map(move |i| sides[side][i]);
        let low = of(0).reduce(f32::min).unwrap_or_default();
        let high = of(1).reduce(f32::max).unwrap_or_default();
        // Steps that are not fine beside the corner, one of 24 bits, so that all planes are double numbers.
        let least = f64::from(low.abs()) / f64::from(1 << 24);
        let least = least.max((f64::from(high) - f64::from(low)) / 254.0);
        Self { corner: low, exponent: LEAST_EXPONENT.max(exponent_above(least)) }
    }

    /// Returns the place of a plane.
    pub(crate) fn plane(self, steps: u8) -> f64 {
        f64::from(self.corner) + f64::from(steps) * power(self.exponent)
    }

    /// Returns the planes closest around an interval that is within the grid: one is not above it, and one not below.
    pub(crate) fn steps(self, [low, high]: [f32; 2]) -> [u8; 2] {
        let step = |x: f32| (f64::from(x) - f64::from(self.corner)) / power(self.exponent);
        let [mut below, mut above] = [step(low).floor() as u8, step(high).ceil() as u8];
        while below > 0 && self.plane(below) > f64::from(low) {
            below -= 1;
        }
        while above < u8::MAX && self.plane(above) < f64::from(high) {
            above += 1;
        }
        [below, above]
    }
}

/// Returns the exponent of a power of two that is above a number.
fn exponent_above(x: f64) -> i32 {
    (x.to_bits() >> 52) as i32 - 1022
}

/// Returns a power of two.
fn power(exponent: i32) -> f64 {
    f64::from_bits(((exponent + 1023) as u64) << 52)
}

#[cfg(test)]
mod tests {
    use super::*;
    use spherule_core::internals::bvh::builders::{Builder, build};
    use spherule_measure::workload::SphereScene;

    /// Returns a byte of a row.
    fn byte(row: &[u32; NODE], word: usize, byte: usize) -> u8 {
        (row[word] >> (8 * byte)) as u8
    }

    #[test]
    fn boxes_on_grids_are_about_those_of_the_tree() {
        let (mut boxes, mut wider) = (0, 0.0);
        for scene in [SphereScene::PAPER400, SphereScene::VOLUME10K] {
            let mut spheres = scene.spheres().unwrap();
            let bvh = build(&mut spheres, Builder::default());
            for (node, row) in bvh.rows().zip(rows(&bvh)) {
                let words: [u32; 7 * WIDTH] = bytemuck::cast(node);
                for child in 0..WIDTH {
                    let exists = words[6 * WIDTH + child] != NONE;
                    assert_eq!(row[NODE - WIDTH + child], words[6 * WIDTH + child]);
                    assert_eq!(byte(&row, 3, 3) >> child & 1 == 1, exists);
                    for axis in (0..3).filter(|_| exists) {
                        let exponent = i32::from(byte(&row, 3, axis)) - 127;
                        let grid = Grid { corner: f32::from_bits(row[axis]), exponent };
                        let [low, high] = [0, 1].map(|side| {
                            let word = 4 + 4 * axis + 2 * side + child / 4;
                            let plane = f32::from_bits(words[(2 * axis + side) * WIDTH + child]);
                            (grid.plane(byte(&row, word, child % 4)), f64::from(plane))
                        });
                        let step = power(exponent);
                        assert!((0.0..step).contains(&(low.1 - low.0)), "{low:?} {grid:?}");
                        assert!((0.0..step).contains(&(high.0 - high.1)), "{high:?} {grid:?}");
                        boxes += 1;
                        wider += (high.0 - low.0) / (high.1 - low.1);
                    }
                }
            }
        }
        assert!(boxes > 1000 && wider < 1.1 * f64::from(boxes), "{boxes} {wider}");
    }

    #[test]
    fn grids_hold_flat_and_distant_boxes() {
        let exists = [true, true, false, false, false, false, false, false];
        for (low, high) in
            [(0.0, 0.0), (1.0, 1.0), (-1.0, 1.0), (0.75, 0.75_f32.next_up()), (-1e-30, 1e-30)]
        {
            let sides = [
                [low, high, 9.0, 9.0, 9.0, 9.0, 9.0, 9.0],
                [low, high, 9.0, 9.0, 9.0, 9.0, 9.0, 9.0],
            ];
            let grid = Grid::about(&sides, exists);
            for x in [low, high] {
                let [below, above] = grid.steps([x, x]);
                assert!(
                    grid.plane(below) <= f64::from(x) && f64::from(x) <= grid.plane(above),
                    "{x} {grid:?}"
                );
                assert!(above - below <= 1);
            }
        }
    }
}
