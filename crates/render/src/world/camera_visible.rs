//! The spheres that slices leave visible to the camera, and their tree.

use crate::bvh::builders::{Builder, build};
use crate::bvh::{Bvh, NodeRow};
use crate::spheres::Spheres;

/// The spheres that camera rays are tested against.
#[derive(Clone, Debug, Default)]
pub struct CameraVisible {
    /// Spheres, in the order of the tree's leaves.
    pub spheres: Spheres,
    /// Tree over the spheres.
    pub bvh: Bvh,
    /// Rows of the spheres in the world.
    pub row: Vec<u32>,
}

impl CameraVisible {
    /// Restores the spheres from rows of a world's spheres and the nodes over them. `None` if a row
    /// does not exist, or the nodes are not a tree.
    pub(crate) fn of_rows(row: Vec<u32>, nodes: &[NodeRow], all: &Spheres) -> Option<Self> {
        let mut spheres = Spheres::with_capacity(row.len());
        for &row in &row {
            let (row, id) = (row as usize, *all.id.get(row as usize)?);
            spheres.push(all.center(row), all.radius(row), id);
        }
        let bvh = Bvh::from_rows(nodes, spheres.blocks().len())?;
        Some(Self { spheres, bvh, row })
    }

    /// Builds the tree of the spheres that are not hidden; `hidden` is in the order of the user's
    /// scene. `None` if no sphere is hidden.
    pub(super) fn build(hidden: &[bool], all: &Spheres, builder: Builder) -> Option<Self> {
        let is_hidden = |row: &usize| hidden[all.id[*row] as usize];
        if hidden.is_empty() || !(0..all.len()).any(|row| is_hidden(&row)) {
            return None;
        }
        let rows: Vec<usize> = (0..all.len()).filter(|row| !is_hidden(row)).collect();
        let mut spheres = Spheres::with_capacity(rows.len());
        for &row in &rows {
            spheres.push(all.center(row), all.radius(row), all.id[row]);
        }
        let bvh = build(&mut spheres, builder);
        let mut of_id = vec![0; hidden.len()];
        for &row in &rows {
            of_id[all.id[row] as usize] = row as u32;
        }
        let row = spheres.id.iter().map(|&id| of_id[id as usize]).collect();
        Some(Self { spheres, bvh, row })
    }
}
