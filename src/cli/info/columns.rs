//! Ranges of the columns of a particle file, as `spherule info` lists them.

use crate::cli::output;
use indicatif::HumanCount;
use rayon::prelude::*;
use serde::Serialize;
use spherule_render::scene::particles::{Particles, Role, TextColumn};
use std::borrow::Cow;

/// Maximum number of values in columns that are read only for their ranges: 32 columns of a million particles.
pub(super) const VALUES: usize = 1 << 25;

/// Maximum number of columns, and of texts of a column, that are listed.
const SHOWN: usize = 40;
const SHOWN_TEXTS: usize = 6;

/// The values of a column.
#[derive(Serialize)]
pub(super) struct ColumnInfo {
    name: String,
    /// Minimum and maximum of the finite numbers; null for texts, and if there is none.
    range: Option<[f64; 2]>,
    /// Texts in the order in which they first occur, each once; null for numbers.
    texts: Option<Vec<String>>,
    /// Number of rows without a value.
    missing: u64,
}

/// Returns the values of all columns that were read, in the order of the file.
pub(super) fn columns(particles: &Particles) -> Vec<ColumnInfo> {
    let frame = &particles.frame;
    let of_name = |name: &String| {
        let numbers = frame.numbers.iter().find(|column| column.name == *name);
        let texts = || frame.texts.iter().find(|column| column.name == *name);
        let role = || frame.roles.iter().find(|(_, own)| own == name).map(|(role, _)| *role);
        match numbers {
            Some(column) => Some(of_numbers(name, &column.values)),
            None => texts()
                .map(of_texts)
                .or_else(|| Some(of_numbers(name, &of_role(particles, role()?)?))),
        }
    };
    frame.columns.iter().filter_map(of_name).collect()
}

/// Returns the numbers of a role, in the file's unit.
fn of_role(particles: &Particles, role: Role) -> Option<Cow<'_, [f64]>> {
    let spheres = &particles.spheres;
    match role {
        Role::X => Some(Cow::Borrowed(&spheres.x)),
        Role::Y => Some(Cow::Borrowed(&spheres.y)),
        Role::Z => Some(Cow::Borrowed(&spheres.z)),
        Role::Radius => Some(Cow::Borrowed(&spheres.radius)),
        Role::Diameter => Some(spheres.radius.iter().map(|radius| 2.0 * radius).collect()),
        Role::Kind | Role::Red | Role::Green | Role::Blue | Role::Material => None,
    }
}

fn of_numbers(name: &str, values: &[f64]) -> ColumnInfo {
    let none = || (f64::INFINITY, f64::NEG_INFINITY, 0_u64);
    let (low, high, missing) = values
        .par_iter()
        .fold(none, |(low, high, missing), &value| {
            if value.is_finite() {
                (value.min(low), value.max(high), missing)
            } else {
                (low, high, missing + u64::from(value.is_nan()))
            }
        })
        .reduce(none, |a, b| (a.0.min(b.0), a.1.max(b.1), a.2 + b.2));
    let range = (low <= high).then_some([low, high]);
    ColumnInfo { name: name.to_owned(), range, texts: None, missing }
}

fn of_texts(column: &TextColumn) -> ColumnInfo {
    let mut counts = vec![0_u64; column.names.len()];
    (0..column.codes.len()).for_each(|row| counts[column.codes.code(row) as usize] += 1);
    let counted = || column.names.iter().zip(&counts).filter(|(_, count)| **count > 0);
    let texts = counted().filter(|(name, _)| !name.is_empty()).map(|(name, _)| name.clone());
    let missing = counted().filter(|(name, _)| name.is_empty()).map(|(_, count)| count).sum();
    ColumnInfo { name: column.name.clone(), range: None, texts: Some(texts.collect()), missing }
}

impl ColumnInfo {
    fn print(&self) {
        let values = match (&self.texts, self.range) {
            (Some(texts), _) => {
                let first = texts.iter().take(SHOWN_TEXTS).map(String::as_str);
                let more = if texts.len() > SHOWN_TEXTS { ", ..." } else { "" };
                let list = first.collect::<Vec<_>>().join(", ");
                match texts.len() {
                    0 => "no text".to_owned(),
                    1 => list,
                    count => format!("{} texts: {list}{more}", HumanCount(count as u64)),
                }
            }
            (None, Some([low, high])) => format!("{low} to {high}"),
            (None, None) => "no number".to_owned(),
        };
        let missing = match self.missing {
            0 => String::new(),
            missing => format!(", {} missing", HumanCount(missing)),
        };
        output::print(format_args!("column       {}: {values}{missing}", self.name));
    }
}

/// Prints the ranges of columns.
pub(super) fn print(columns: &[ColumnInfo]) {
    columns.iter().take(SHOWN).for_each(ColumnInfo::print);
    if columns.len() > SHOWN {
        let more = columns.len() - SHOWN;
        output::print(format_args!("column       and {more} more; --json lists all"));
    }
}
