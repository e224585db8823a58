//! The first and last particles of a file, as `spherule info --rows` lists them.

use crate::cli::output;
use serde::Serialize;
use spherule_render::scene::particles::Particles;

/// The first and last particles, without repetition.
#[derive(Serialize)]
pub(super) struct RowInfo {
    first: Vec<ListedParticle>,
    last: Vec<ListedParticle>,
}

/// A particle, with lengths in the file's unit.
#[derive(Serialize)]
struct ListedParticle {
    row: usize,
    position: [f64; 3],
    radius: f64,
    /// Null if the file has no types.
    #[serde(rename = "type")]
    kind: Option<String>,
}

impl RowInfo {
    /// The first and the last `count` particles.
    pub(super) fn new(particles: &Particles, count: usize) -> Self {
        let all = particles.spheres.len();
        let end = count.min(all);
        let start = all.saturating_sub(count).max(end);
        let row = |row| ListedParticle {
            row,
            position: particles.spheres.center(row).to_array(),
            radius: particles.spheres.radius[row],
            kind: particles.frame.kinds.kind(row).map(|kind| kind.name.clone()),
        };
        Self { first: (0..end).map(row).collect(), last: (start..all).map(row).collect() }
    }

    pub(super) fn print(&self) {
        for ListedParticle { row, position, radius, kind } in self.first.iter().chain(&self.last) {
            let kind = kind.as_ref().map_or(String::new(), |kind| format!(" {kind}"));
            output::print(format_args!(
                "row          {row}:{kind} at {position:?}, radius {radius}"
            ));
        }
    }
}
