//! The section `Velocities` of a data file: rows in an order of their own, told by ids
//! (<https://docs.lammps.org/read_data.html>).

use crate::FileError;
use crate::frame::{NumberColumn, ParticleFrame};
use crate::lines::{Line, Lines};
use crate::options::ReadOptions;
use std::collections::HashMap;

/// Names of its columns, after that of ids; what follows them in some atom styles is not read.
const NAMES: [&str; 3] = ["vx", "vy", "vz"];

/// The column of atoms that tells which is which.
const ID: &str = "id";

/// The columns of the section that were asked for.
#[derive(Default)]
pub(super) struct Velocities {
    /// Columns to be kept: names as they were asked for, and the axis of each.
    asked: Vec<(String, usize)>,
    /// The first of those that must be there.
    needed: Option<String>,
    /// Whether ids are kept for this section alone.
    lends_ids: bool,
    /// Most atoms for which the section is read; where it is not asked for by name there is a limit.
    most: u64,
    /// True if the file has the section.
    found: bool,
    values: Option<HashMap<u64, [f64; 3]>>,
}

fn axis(name: &str) -> Option<usize> {
    NAMES.iter().position(|own| own.eq_ignore_ascii_case(name))
}

impl Velocities {
    /// Takes from the options what atoms do not have, and has ids kept if they are needed.
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
        let is_id = |name: &String| name.eq_ignore_ascii_case(ID);
        let has_ids = columns.kept.iter().chain(&columns.wanted).any(is_id);
        let lends_ids = !asked.is_empty() && !has_ids;
        if lends_ids {
            columns.wanted.push(ID.to_owned());
        }
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

    /// Takes note of the section in a file of so many atoms; returns whether it is worth reading.
    pub(super) fn find(&mut self, atoms: u64) -> bool {
        self.found = true;
        !self.asked.is_empty() && atoms <= self.most
    }

    /// Reads a row of the section. A faulty one is an error only if velocities were asked for by name.
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

    /// Gives atoms what was asked for.
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
