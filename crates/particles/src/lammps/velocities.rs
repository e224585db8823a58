//! The section `Velocities` of a data file: rows in arbitrary order, identified by ids
//! (<https://docs.lammps.org/read_data.html>).

use crate::lines::{Line, Lines};
use crate::{FileError, NumberColumn, ParticleFrame, ReadOptions};
use std::collections::HashMap;

/// Names of its columns after the id; further columns of some atom styles are ignored.
const NAMES: [&str; 3] = ["vx", "vy", "vz"];

/// Column of atoms that identifies them.
pub(super) const ID: &str = "id";

/// The requested columns of the section.
#[derive(Default)]
pub(super) struct Velocities {
    /// Columns to keep: names as requested, with their axes.
    asked: Vec<(String, usize)>,
    /// The first required column.
    needed: Option<String>,
    /// True if ids are kept only for this section.
    lends_ids: bool,
    /// Maximum number of atoms for which the section is read; limited unless it is requested by name.
    most: u64,
    /// True if the file has the section.
    found: bool,
    values: Option<HashMap<u64, [f64; 3]>>,
}

fn axis(name: &str) -> Option<usize> {
    NAMES.iter().position(|own| own.eq_ignore_ascii_case(name))
}

/// Requests ids; returns whether they weren't requested before.
pub(super) fn want_ids(options: &mut ReadOptions) -> bool {
    let columns = &mut options.columns;
    let is_id = |name: &String| name.eq_ignore_ascii_case(ID);
    let has_ids = columns.kept.iter().chain(&columns.wanted).any(is_id);
    if !has_ids {
        columns.wanted.push(ID.to_owned());
    }
    !has_ids && columns.rest.is_none()
}

impl Velocities {
    /// Moves the section's columns out of the options, and requests ids if they are needed.
    pub(super) fn take(options: &mut ReadOptions) -> Self {
        let columns = &mut options.columns;
        let all = columns.kept.iter().chain(&columns.wanted);
        let mut asked: Vec<(String, usize)> = Vec::new();
        for (name, axis) in all.filter_map(|name| Some((name.clone(), axis(name)?))) {
            if asked.iter().all(|(_, other)| *other != axis) {
                asked.push((name, axis));
            }
        }
        let needed = columns.kept.iter().find(|name| axis(name).is_some()).cloned();
        for list in [&mut columns.kept, &mut columns.wanted] {
            list.retain(|name| axis(name).is_none());
        }
        let lends_ids = !asked.is_empty() && want_ids(options);
        let columns = &options.columns;
        let rest = columns.rest.map_or(0, |values| values / NAMES.len());
        let most = if asked.is_empty() { rest as u64 } else { u64::MAX };
        if columns.rest.is_some() {
            for (axis, name) in NAMES.iter().enumerate() {
                if asked.iter().all(|(_, other)| *other != axis) {
                    asked.push(((*name).to_owned(), axis));
                }
            }
        }
        Self { asked, needed, lends_ids, most, found: false, values: None }
    }

    /// Records that the file has the section and `atoms` atoms. Returns whether to read the section.
    pub(super) fn find(&mut self, atoms: u64) -> bool {
        self.found = true;
        !self.asked.is_empty() && atoms <= self.most
    }

    /// Reads a row of the section. A malformed one is an error only if velocities were requested by name.
    pub(super) fn row(&mut self, line: &Line) -> Result<(), FileError> {
        let read = self.read(line);
        if read.is_err() && self.most < u64::MAX {
            self.asked.clear();
            return Ok(());
        }
        read
    }

    fn read(&mut self, line: &Line) -> Result<(), FileError> {
        let mut fields = line.fields();
        let mut field = || {
            let message = "a row of velocities has an id and vx, vy, vz";
            fields.next().ok_or_else(|| line.whole(message))
        };
        let id = line.number(field()?)?;
        let mut value = || line.number(field()?);
        let velocity = [value()?, value()?, value()?];
        self.values.get_or_insert_default().insert(id.to_bits(), velocity);
        Ok(())
    }

    /// Adds the requested columns to the atoms.
    pub(super) fn complete(
        self,
        frame: &mut ParticleFrame,
        lines: &Lines,
    ) -> Result<(), FileError> {
        let ids = frame.numbers.iter().position(|column| column.name == ID);
        if let (Some(values), Some(ids)) = (&self.values, ids) {
            for (name, axis) in self.asked {
                let ids = &frame.numbers[ids].values;
                let value =
                    |id: &f64| values.get(&id.to_bits()).map_or(f64::NAN, |value| value[axis]);
                let values = ids.iter().map(value).collect();
                frame.numbers.push(NumberColumn { name, values });
            }
        } else if let Some(name) = self.needed {
            let names = frame.columns.join(", ");
            let message = format!("no column is named `{name}`; there are {names}");
            return Err(lines.ended(message).with_help("there is no section `Velocities`"));
        }
        if self.lends_ids {
            frame.numbers.retain(|column| column.name != ID);
        }
        if self.found {
            frame.columns.extend(NAMES.map(str::to_owned));
        }
        Ok(())
    }
}
