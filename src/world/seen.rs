//! What the camera sees, where slices hide spheres from it: a tree of the other spheres.

use crate::bvh::builders::{Builder, build};
use crate::bvh::{Bvh, NodeRow};
use crate::spheres::Spheres;

/// The spheres that camera rays are tested against.
#[derive(Clone, Debug, Default)]
pub struct Seen {
    /// In the order of the tree's leaves.
    pub spheres: Spheres,
    /// The tree over them.
    pub bvh: Bvh,
    /// Which of the world's spheres each of them is.
    pub row: Vec<u32>,
}

impl Seen {
    /// Of the rows of a world's spheres and the nodes over them. `None` if there are no such rows, or the
    /// nodes are no tree.
    pub(crate) fn of_rows(row: Vec<u32>, nodes: &[NodeRow], all: &Spheres) -> Option<Self> {
        let mut spheres = Spheres::with_capacity(row.len());
        for &row in &row {
            let (row, id) = (row as usize, *all.id.get(row as usize)?);
            spheres.push(all.center(row), all.radius(row), id);
        }
        let bvh = Bvh::from_rows(nodes, spheres.blocks().len())?;
        Some(Self { spheres, bvh, row })
    }

    /// Those of a world's spheres that are not hidden, by their places in the user's scene; `None`
    /// if none is.
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
