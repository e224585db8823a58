//! A summary of a particle file.

use super::columns::{self, ColumnInfo};
use super::rows::RowInfo;
use crate::cli::contents::plural;
use crate::cli::output;
use indicatif::HumanCount;
use serde::Serialize;
use spherule_render::scene::particles::{
    Element, FrameChoice, LengthUnit, MoleculeCensus, Orientation, Particles, ReadOptions,
    count_frames, read_frame,
};
use std::path::Path;

/// Contents of a particle file, with lengths in its own unit.
#[derive(Serialize)]
pub(super) struct ParticleInfo {
    format: &'static str,
    title: String,
    /// Null if they cannot be counted.
    frames: Option<u64>,
    /// Times of the first and the last of several frames; null if they are unknown.
    times: Option<[f64; 2]>,
    step: Option<i64>,
    time: Option<f64>,
    unit: Option<&'static str>,
    columns: Vec<String>,
    /// Ranges of the columns that are numbers or texts.
    column_values: Vec<ColumnInfo>,
    types: Vec<TypeInfo>,
    /// Null if the file has no names of residues.
    molecules: Option<MoleculeInfo>,
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
    /// The fact of the file from which the element is known; null without one.
    element_from: Option<&'static str>,
    spheres: u64,
}

/// Chains, residues by group, and ligands, each with its number of atoms or residues.
#[derive(Serialize)]
struct MoleculeInfo {
    chains: Vec<NamedCount>,
    residues: u64,
    groups: Vec<NamedCount>,
    ligands: Vec<NamedCount>,
}

#[derive(Serialize)]
struct NamedCount {
    name: String,
    count: u64,
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
        let of_first = particles.first_frame.as_ref().map(|first| first.orientation);
        let Orientation { up, reason, .. } = of_first.unwrap_or_else(|| Orientation::of(particles));
        let kinds = &particles.frame.kinds;
        let mut counts = vec![0; kinds.table.len()];
        (0..kinds.codes.len()).for_each(|row| counts[kinds.codes.code(row) as usize] += 1);
        let types = kinds.table.iter().zip(counts).filter(|(_, spheres)| *spheres > 0);
        // Input that is not a file can be read only once.
        let frames = path.is_file().then(|| count_frames(path, options).ok()).flatten();
        Self {
            format: particles.frame.format.name(),
            title: particles.frame.title.clone(),
            frames,
            times: frames
                .filter(|frames| *frames > 1)
                .and_then(|frames| times(path, options, frames)),
            step: particles.frame.step,
            time: particles.frame.time,
            unit: (particles.frame.unit != LengthUnit::Unknown)
                .then(|| particles.frame.unit.name()),
            columns: particles.frame.columns.clone(),
            column_values: columns::columns(particles),
            types: types
                .map(|(kind, spheres)| TypeInfo {
                    name: kind.name.clone(),
                    element: kind.element.map(Element::symbol),
                    element_from: kind.element.map(|_| kind.source.name()),
                    spheres,
                })
                .collect(),
            molecules: MoleculeCensus::of(particles).map(MoleculeInfo::from),
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
            let times = self
                .times
                .map_or_else(String::new, |[first, last]| format!(", time {first} to {last}"));
            output::print(format_args!("frames       {}{times}", HumanCount(frames)));
        }
        if let Some(step) = self.step {
            output::print(format_args!("step         {step}"));
        }
        if let Some(time) = self.time {
            output::print(format_args!("time         {time}"));
        }
        output::print(format_args!("unit         {}", self.unit.unwrap_or("unknown")));
        output::print(format_args!("columns      {}", self.columns.join(", ")));
        columns::print(&self.column_values);
        for kind in self.types.iter().take(SHOWN) {
            let element = kind.element.zip(kind.element_from);
            let element = element.map_or(String::new(), |(element, from)| match from {
                "given" => format!(" ({element} as given)"),
                _ => format!(" ({element} by {from})"),
            });
            let count = HumanCount(kind.spheres);
            output::print(format_args!("type         {}{element}: {count}", kind.name));
        }
        if self.types.len() > SHOWN {
            let more = self.types.len() - SHOWN;
            output::print(format_args!("type         and {more} more; --json lists all"));
        }
        self.molecules.iter().for_each(MoleculeInfo::print);
        if let Some(CellInfo { origin, vectors: [a, b, c], periodic }) = &self.cell {
            let edges = ["a", "b", "c"].into_iter().zip(periodic).filter(|(_, is)| **is);
            let edges: Vec<&str> = edges.map(|(edge, _)| edge).collect();
            let along = if edges.is_empty() {
                "not periodic".to_owned()
            } else {
                format!("periodic along {}", edges.join(", "))
            };
            output::print(format_args!(
                "cell         {a:?}, {b:?}, {c:?} from {origin:?}, {along}"
            ));
        }
        output::print(format_args!("up           {}: {}", self.up.axis, self.up.reason));
        self.rows.iter().for_each(RowInfo::print);
    }
}

/// Returns the times of the first and the last frame of a file.
fn times(path: &Path, options: &ReadOptions, frames: u64) -> Option<[f64; 2]> {
    let mut options = ReadOptions { smooth: 0, trail: 0, align: None, ..options.clone() };
    options.columns.rest = None;
    let mut time = |index| {
        options.frame = FrameChoice::Index(index);
        read_frame(path, &options).ok()?.time
    };
    Some([time(0)?, time(frames - 1)?])
}

impl From<MoleculeCensus> for MoleculeInfo {
    fn from(census: MoleculeCensus) -> Self {
        let named = |rows: Vec<(String, u64)>| {
            rows.into_iter().map(|(name, count)| NamedCount { name, count }).collect()
        };
        let groups = census.groups.into_iter().map(|(word, count)| (word.to_owned(), count));
        Self {
            chains: named(census.chains),
            residues: census.residues,
            groups: named(groups.collect()),
            ligands: named(census.ligands),
        }
    }
}

impl MoleculeInfo {
    fn print(&self) {
        let list = |rows: &[NamedCount], noun: &str| {
            let first = rows.iter().take(SHOWN);
            let texts = first.map(|row| format!("{} ({})", row.name, plural(row.count, noun)));
            let more = if rows.len() > SHOWN { ", ..." } else { "" };
            texts.collect::<Vec<_>>().join(", ") + more
        };
        if !self.chains.is_empty() {
            output::print(format_args!("chains       {}", list(&self.chains, "atom")));
        }
        let groups =
            self.groups.iter().map(|row| format!(", {} of {}", HumanCount(row.count), row.name));
        let groups: String = groups.collect();
        output::print(format_args!("residues     {}{groups}", HumanCount(self.residues)));
        if !self.ligands.is_empty() {
            output::print(format_args!("ligands      {}", list(&self.ligands, "residue")));
        }
    }
}
