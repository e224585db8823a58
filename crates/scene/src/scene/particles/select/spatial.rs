//! Conditions on other particles: within a distance of them, or in the same residue.

use super::vocabulary;
use crate::scene::particles::Particles;
use crate::scene::particles::style::Column;
use rayon::prelude::*;
use spherule_particles::neighbors::{CellList, Points};
use std::collections::{HashMap, HashSet};

/// Returns the rows within a distance of those that are true, over the periodic cell; without these if
/// `others` is true.
pub(super) fn within(
    particles: &Particles,
    of: &[bool],
    distance: f64,
    others: bool,
) -> Result<Vec<bool>, String> {
    let spheres = &particles.spheres;
    let axes = [&spheres.x[..], &spheres.y, &spheres.z];
    let points = Points { axes, cell: particles.frame.cell.as_ref() };
    let rows: Vec<u32> = (0..of.len()).filter(|&row| of[row]).map(|row| row as u32).collect();
    if rows.is_empty() {
        return Ok(vec![false; of.len()]);
    }
    let list = CellList::new(points, &rows, distance)?;
    let near = |row: usize| {
        if of[row] { !others } else { list.any(points.position(row), distance, |_| true) }
    };
    Ok((0..of.len()).into_par_iter().map(near).collect())
}

/// Returns the rows that have the same values in a column as one of those that are true.
pub(super) fn same(
    particles: &Particles,
    of: &[bool],
    column: &str,
) -> Result<Vec<bool>, Option<String>> {
    let names = vocabulary::columns_of(column);
    let found: Vec<Column> =
        names.iter().filter_map(|name| Column::find(particles, name)).collect();
    let is_residue = names.len() > 1;
    if found.is_empty()
        || is_residue && Column::find(particles, vocabulary::RESIDUE_COLUMNS[0]).is_none()
    {
        return Err(is_residue.then(|| "the file has no numbers of residues".to_owned()));
    }
    // The values of a row in all columns become one number.
    let mut group: Vec<u32> = vec![0; of.len()];
    for column in &found {
        let mut places: HashMap<(u32, u64), u32> = HashMap::new();
        for (row, group) in group.iter_mut().enumerate() {
            let value = match column {
                Column::Numbers(values) => values[row].to_bits(),
                Column::Texts { codes, .. } => u64::from(codes.code(row)),
            };
            let next = places.len() as u32;
            *group = *places.entry((*group, value)).or_insert(next);
        }
    }
    let chosen: HashSet<u32> = (0..of.len()).filter(|&row| of[row]).map(|row| group[row]).collect();
    Ok(group.iter().map(|group| chosen.contains(group)).collect())
}
