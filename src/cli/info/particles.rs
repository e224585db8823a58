//! A summary of a particle file.

use super::rows::RowInfo;
use crate::cli::output;
use indicatif::HumanCount;
use serde::Serialize;
use spherule_render::scene::particles::{
    Element, LengthUnit, Orientation, Particles, ReadOptions, count_frames,
};
use std::path::Path;

/// Contents of a particle file, with lengths in its own unit.
#[derive(Serialize)]
pub(super) struct ParticleInfo {
    format: &'static str,
    title: String,
    /// Null if they cannot be counted.
    frames: Option<u64>,
    step: Option<i64>,
    time: Option<f64>,
    unit: Option<&'static str>,
    columns: Vec<String>,
    types: Vec<TypeInfo>,
    /// Null if the file has none.
    cell: Option<CellInfo>,
    /// The direction that is up in the image.
    up: UpInfo,
    /// Null if they are not asked for.
    pub(super) rows: Option<RowInfo>,
}

#[derive(Serialize)]
struct TypeInfo {
    name: String,
    element: Option<&'static str>,
    spheres: u64,
}

#[derive(Serialize)]
struct UpInfo {
    axis: &'static str,
    reason: String,
}

#[derive(Serialize)]
struct CellInfo {
    origin: [f64; 3],
    vectors: [[f64; 3]; 3],
    periodic: [bool; 3],
}

/// Maximum number of types that are listed.
const SHOWN: usize = 12;

impl ParticleInfo {
    pub(super) fn new(path: &Path, options: &ReadOptions, particles: &Particles) -> Self {
        let Orientation { up, reason, .. } = Orientation::of(particles);
        let kinds = &particles.frame.kinds;
        let mut counts = vec![0; kinds.table.len()];
        (0..kinds.codes.len()).for_each(|row| counts[kinds.codes.code(row) as usize] += 1);
        let types = kinds.table.iter().zip(counts).filter(|(_, spheres)| *spheres > 0);
        Self {
            format: particles.frame.format.name(),
            title: particles.frame.title.clone(),
            // Input that is not a file can be read only once.
            frames: path.is_file().then(|| count_frames(path, options).ok()).flatten(),
            step: particles.frame.step,
            time: particles.frame.time,
            unit: (particles.frame.unit != LengthUnit::Unknown)
                .then(|| particles.frame.unit.name()),
            columns: particles.frame.columns.clone(),
            types: types
                .map(|(kind, spheres)| TypeInfo {
                    name: kind.name.clone(),
                    element: kind.element.map(Element::symbol),
                    spheres,
                })
                .collect(),
            cell: particles.frame.cell.map(|cell| CellInfo {
                origin: cell.origin.to_array(),
                vectors: cell.vectors.map(|vector| vector.to_array()),
                periodic: cell.periodic,
            }),
            up: UpInfo { axis: up.name(), reason: reason.to_string() },
            rows: None,
        }
    }

    pub(super) fn print(&self) {
        let title = if self.title.is_empty() { String::new() } else { format!(": {}", self.title) };
        output::print(format_args!("format       {}{title}", self.format));
        if let Some(frames) = self.frames {
            output::print(format_args!("frames       {}", HumanCount(frames)));
        }
        if let Some(step) = self.step {
            output::print(format_args!("step         {step}"));
        }
        if let Some(time) = self.time {
            output::print(format_args!("time         {time}"));
        }
        output::print(format_args!("unit         {}", self.unit.unwrap_or("unknown")));
        output::print(format_args!("columns      {}", self.columns.join(", ")));
        for kind in self.types.iter().take(SHOWN) {
            let element = kind.element.map_or(String::new(), |element| format!(" ({element})"));
            let count = HumanCount(kind.spheres);
            output::print(format_args!("type         {}{element}: {count}", kind.name));
        }
        if self.types.len() > SHOWN {
            let more = self.types.len() - SHOWN;
            output::print(format_args!("type         and {more} more; --json lists all"));
        }
        if let Some(CellInfo { origin, vectors: [a, b, c], .. }) = &self.cell {
            output::print(format_args!("cell         {a:?}, {b:?}, {c:?} from {origin:?}"));
        }
        output::print(format_args!("up           {}: {}", self.up.axis, self.up.reason));
        self.rows.iter().for_each(RowInfo::print);
    }
}
