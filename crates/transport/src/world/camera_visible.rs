//! The spheres that slices leave visible to the camera, and their tree.

use crate::bvh::builders::{Builder, build};
use crate::bvh::{Bvh, NodeRow};
use crate::ray::MISS;
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
    /// Rows here of the world's spheres; [`MISS`] of those that are hidden.
    of_world: Vec<u32>,
}

impl CameraVisible {
    /// Restores the spheres from rows of a world's spheres and the nodes over them. `None` if a row
    /// does not exist, or the nodes are not a tree.
    pub fn of_rows(row: Vec<u32>, nodes: &[NodeRow], all: &Spheres) -> Option<Self> {
        let mut spheres = Spheres::with_capacity(row.len());
        for &row in &row {
            let (row, id) = (row as usize, *all.id.get(row as usize)?);
            spheres.push(all.center(row), all.radius(row), id);
        }
        let bvh = Bvh::from_rows(nodes, spheres.blocks().len())?;
        Some(Self { of_world: inverse(&row, all.len()), spheres, bvh, row })
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
        let row: Vec<u32> = spheres.id.iter().map(|&id| of_id[id as usize]).collect();
        Some(Self { of_world: inverse(&row, all.len()), spheres, bvh, row })
    }

    /// Returns the row here of a row of the world's spheres; `None` if it is hidden.
    pub(crate) fn row_of(&self, row: u32) -> Option<u32> {
        self.of_world.get(row as usize).copied().filter(|&row| row != MISS)
    }
}

/// Returns the places of numbers below `count` in a list of them; [`MISS`] for those that are not in it.
fn inverse(numbers: &[u32], count: usize) -> Vec<u32> {
    let mut places = vec![MISS; count];
    numbers.iter().zip(0..).for_each(|(&number, place)| places[number as usize] = place);
    places
}
