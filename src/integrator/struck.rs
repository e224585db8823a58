//! Centers and radii of the spheres that rows of rays hit.

use super::surface::ROW;
use crate::lanes::{F64x8, U32x16, load_doubles, look_up, widen};
use crate::spheres::{LEAF, Spheres};
use crate::vec3::Vec3;

/// Centers and radii of the spheres that rows have hit; of any where that is none.
#[inline(always)]
pub(super) fn struck(spheres: &Spheres, hits: &[u32; ROW]) -> (Vec3<F64x8>, F64x8) {
    let blocks = spheres.blocks();
    let mut columns = [[0.0; ROW]; 4];
    for (lane, &hit) in hits.iter().enumerate() {
        let (block, place) = (hit as usize / LEAF, hit as usize % LEAF);
        let block = &blocks[block.min(blocks.len() - 1)];
        columns[0][lane] = block.x[place];
        columns[1][lane] = block.y[place];
        columns[2][lane] = block.z[place];
        columns[3][lane] = block.radius[place];
    }
    let [x, y, z, radius] = columns.each_ref().map(|column| load_doubles(column));
    (Vec3::new(x, y, z), radius)
}

/// All spheres of a world of few, where registers hold them.
pub(super) struct Few([U32x16; 4]);

impl Few {
    /// None if there are too many; there may be no sphere at all.
    pub(super) fn of(spheres: &Spheres) -> Option<Self> {
        let mut columns = [[0.0_f32; 2 * LEAF]; 4];
        let blocks = spheres.blocks();
        if blocks.len() > 2 {
            return None;
        }
        for (i, block) in blocks.iter().enumerate() {
            let rows = [&block.x, &block.y, &block.z, &block.radius];
            for (column, row) in columns.iter_mut().zip(rows) {
                column[i * LEAF..][..LEAF].copy_from_slice(row);
            }
        }
        Some(Self(columns.map(bytemuck::cast)))
    }

    /// [`struck`] among them.
    #[inline(always)]
    pub(super) fn struck(&self, hits: &[u32; ROW]) -> (Vec3<F64x8>, F64x8) {
        let mut places = [0; 2 * ROW];
        places[..ROW].copy_from_slice(hits);
        let places = U32x16::new(places);
        let pick = |column: U32x16| widen(bytemuck::cast(look_up(column, places)))[0];
        let [x, y, z, radius] = &self.0;
        (Vec3::new(pick(*x), pick(*y), pick(*z)), pick(*radius))
    }
}
