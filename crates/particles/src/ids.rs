//! Numbers of particles, by which rows are sorted where files have them in any order.

use crate::{Format, ParticleFrame, aliases};

/// Name of the column of numbers of particles, as `aliases` knows it.
pub(crate) const ID: &str = "id";

/// Returns whether rows of this format come in any order, and have numbers.
fn is_unordered(format: Format) -> bool {
    matches!(format, Format::LammpsData | Format::LammpsDump)
}

/// Returns whether a column has numbers of particles.
pub(crate) fn is_id(name: &str) -> bool {
    name == ID || aliases::of(name).any(|other| other == ID)
}

/// Sorts the rows of a frame by their numbers, if they come in any order.
pub(crate) fn sort(frame: &mut ParticleFrame) {
    if !is_unordered(frame.format) {
        return;
    }
    if let Some(ids) = frame.numbers.iter().find(|column| is_id(&column.name)) {
        let mut rows: Vec<u32> = (0..frame.len() as u32).collect();
        rows.sort_by(|&a, &b| ids.values[a as usize].total_cmp(&ids.values[b as usize]));
        frame.pick(&rows);
    }
}
