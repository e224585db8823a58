//! From rows of columns, wherever they are, to lanes.

use super::surface::Normals;
use super::workspace::BATCH;
use crate::lanes::{F32x16, MAX_LANES};
use crate::ray::Columns3;
use crate::scene::Rgb;
use crate::vec3::Vec3;

/// Rows for every lane, from at most sixteen: lanes without a row are like the first.
///
/// # Panics
/// If there is no row.
#[inline(always)]
pub(super) fn padded(rows: &[u32]) -> [u32; MAX_LANES] {
    let mut padded = [rows[0]; MAX_LANES];
    padded[..rows.len()].copy_from_slice(rows);
    padded
}

/// What a column of a batch has in some rows of it.
#[inline(always)]
pub(super) fn pick<T: Copy>(column: &[T], rows: &[u32; MAX_LANES]) -> [T; MAX_LANES] {
    let column: &[T; BATCH] = column.first_chunk().expect("columns hold a batch");
    let mut lanes = [column[0]; MAX_LANES];
    for (lane, &row) in lanes.iter_mut().zip(rows) {
        // Rows are less than that, which saves a check of each.
        *lane = column[row as usize % BATCH];
    }
    lanes
}

/// [`pick`] of three columns.
#[inline(always)]
pub(super) fn pick_row(columns: &Columns3, rows: &[u32; MAX_LANES]) -> Vec3<F32x16> {
    let lanes = |column: &[f32]| F32x16::new(pick(column, rows));
    Vec3::new(lanes(&columns.x), lanes(&columns.y), lanes(&columns.z))
}

/// The same of normals.
#[inline(always)]
pub(super) fn pick_normals(normals: &Normals, rows: &[u32; MAX_LANES]) -> [[f64; MAX_LANES]; 3] {
    let [x, y, z] = normals.columns();
    [pick(x, rows), pick(y, rows), pick(z, rows)]
}

/// Channel by channel, what a column of colors has in some rows.
#[inline(always)]
pub(super) fn pick_colors(column: &[Rgb], rows: &[u32; MAX_LANES]) -> Vec3<F32x16> {
    let column: &[Rgb; BATCH] = column.first_chunk().expect("columns hold a batch");
    let channel = |channel: usize| {
        let mut lanes = [0.0; MAX_LANES];
        for (lane, &row) in lanes.iter_mut().zip(rows) {
            *lane = column[row as usize % BATCH][channel];
        }
        F32x16::new(lanes)
    };
    Vec3::new(channel(0), channel(1), channel(2))
}
