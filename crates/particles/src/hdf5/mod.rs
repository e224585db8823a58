//! Reads HDF5: trajectories of H5MD and of mdtraj, NetCDF 4 by the conventions of Amber, and snapshots of
//! Gadget.
//!
//! No crate is used. `hdf5-pure` 0.47 cannot read 11 chunked datasets of the tests' files (layout 5, trees of version 2)
//! nor old groups with soft links, and takes 3.3 GB for a damaged file for which this takes 4 MB; `hdf5-reader` 0.12 has
//! unsafe code, cannot read LZF, nor rows of enumerations, and takes 1.4 to 1.8 times the memory of this.
//!
//! It reads what these programs write: all versions of the superblock and of object
//! headers, groups of both kinds, contiguous and chunked datasets under every index, deflate, shuffle, LZF and
//! checksums, of numbers and texts. Frames are read at random, by the chunks that they are in.

mod conventions;
mod dataset;
mod file;
mod index;
mod tree;

pub(crate) use self::file::MAGIC;

use self::conventions::{Part, Trajectory};
use self::dataset::Datatype;
use self::file::File;
use crate::scalar::{Order, Scalar};
use crate::schema::{Naming, Schema, Slot};
use crate::{
    FileError, Format, ParticleFrame, ReadOptions, Role, binary::BinaryFile, builder::Builder,
    foreign, frame_reader::FrameReader, place::Place, source::Source,
};
use std::collections::HashSet;
use std::sync::Arc;

/// Name of the column of types in H5MD.
const SPECIES: &str = "species";

/// Reader of the frames of an HDF5 file.
pub(crate) struct Hdf5 {
    file: File,
    trajectory: Trajectory,
    schema: Arc<Schema>,
    next: u64,
}

/// Values of a column of the schema for the particles of a part.
enum Cells<'p> {
    Missing,
    /// The name of the part.
    Label,
    /// Index of the block, place in a row of it, and names of numbers.
    Values(usize, usize, &'p [(i64, String)]),
}

/// Values of a dataset in a frame, and their number per particle.
struct Rows {
    bytes: Vec<u8>,
    width: usize,
    scalar: Scalar,
    order: Order,
    scale: f64,
}

impl Hdf5 {
    pub(crate) fn new(source: Source, options: &ReadOptions) -> Result<Self, FileError> {
        let mut file = File::open(BinaryFile::open(source)?)?;
        let Some(trajectory) = conventions::find(&mut file)? else {
            let message = "is an HDF5 file, but neither H5MD nor a snapshot of Gadget, and has no \
                           `coordinates` of Amber's conventions";
            return Err(file
                .content
                .fault(message)
                .with_help(foreign::hdf5_help(file.content.path())));
        };
        let mut names: Vec<String> = ["x", "y", "z"].map(str::to_owned).into();
        let mut known: HashSet<String> = names.iter().cloned().collect();
        let columns = trajectory.parts.iter().flat_map(|part| &part.columns);
        let own = columns.flat_map(|column| column.names.iter().cloned());
        names.extend(own.filter(|name| known.insert(name.clone())));
        names.extend(trajectory.label.map(str::to_owned).filter(|name| !known.contains(name)));
        let schema = Schema::with_roles(names, options, &[(Role::Kind, SPECIES)]);
        let mut schema = schema.map_err(|message| file.content.fault(message))?;
        // Species are numbers of types, but names of an enumeration may be elements.
        schema.naming = Naming::Types;
        Ok(Self { file, trajectory, schema: Arc::new(schema), next: 0 })
    }
}

/// Reads the used columns of a part.
fn read_part(
    file: &mut File,
    part: &mut Part,
    schema: &Schema,
    frame: (u64, &conventions::Axis),
    warnings: &mut Vec<String>,
) -> Result<Vec<Option<Rows>>, FileError> {
    let (number, steps) = frame;
    let mut blocks = Vec::new();
    for column in &mut part.columns {
        let is_used = |name: &String| {
            let at = schema.names.iter().position(|own| own == name);
            at.and_then(|at| schema.slots.get(at)).is_some_and(|slot| *slot != Slot::Skip)
        };
        let Datatype::Number { scalar, order, .. } = column.element.dataset.datatype else {
            blocks.push(None);
            continue;
        };
        if !column.names.iter().any(is_used) {
            blocks.push(None);
            continue;
        }
        let row = column.element.row(number, steps);
        if row.is_some_and(|(_, is_own)| !is_own) {
            let name = column.names.first().map_or("", String::as_str);
            warnings.push(format!(
                "`{name}` is not of the frame's own step, but of the last one that has it"
            ));
        }
        let bytes = column.element.dataset.rows(file, row.map(|(row, _)| row))?;
        blocks.push(Some(Rows {
            bytes,
            width: column.names.len(),
            scalar,
            order,
            scale: column.element.scale,
        }));
    }
    Ok(blocks)
}

/// Returns where the values of the schema's columns are in a part.
fn cells<'p>(
    part: &'p Part,
    blocks: &[Option<Rows>],
    schema: &Schema,
    label: Option<&str>,
) -> Vec<Cells<'p>> {
    let find = |name: &String| {
        let columns = part.columns.iter().enumerate();
        let mut places =
            columns.filter(|(block, _)| blocks[*block].is_some()).filter_map(|(block, column)| {
                let place = column.names.iter().position(|own| own == name)?;
                let names = match &column.element.dataset.datatype {
                    Datatype::Number { names, .. } => &names[..],
                    _ => &[],
                };
                Some(Cells::Values(block, place, names))
            });
        match places.next() {
            None if label == Some(name) => Cells::Label,
            place => place.unwrap_or(Cells::Missing),
        }
    };
    schema.names.iter().take(schema.slots.len()).map(find).collect()
}

/// Returns which columns of the schema are texts in at least one part.
fn texts(parts: &[Part], schema: &Schema) -> Vec<bool> {
    let is_named = |name: &String| {
        let mut columns = parts.iter().flat_map(|part| &part.columns);
        columns.any(|column| {
            let datatype = &column.element.dataset.datatype;
            let is_enumeration =
                matches!(datatype, Datatype::Number { names, .. } if !names.is_empty());
            is_enumeration && column.names.contains(name)
        })
    };
    let is_text = |(name, slot): (&String, &Slot)| match slot {
        Slot::Kind => true,
        Slot::Extra(_) | Slot::Material => is_named(name),
        Slot::Skip | Slot::Position(_) | Slot::Radius(_) | Slot::Color(_) => false,
    };
    schema.names.iter().zip(&schema.slots).map(is_text).collect()
}

/// Checks that a part has the columns of positions; only z may be missing.
fn check_positions(part: &Part, schema: &Schema, cells: &[Cells]) -> Result<(), String> {
    for ((name, slot), cell) in schema.names.iter().zip(&schema.slots).zip(cells) {
        if matches!((slot, cell), (Slot::Position(_), Cells::Missing | Cells::Label)) && name != "z"
        {
            return Err(format!("its particles `{}` have no column `{name}`", part.name));
        }
    }
    Ok(())
}

impl FrameReader for Hdf5 {
    fn next(&mut self) -> Result<Option<ParticleFrame>, FileError> {
        if self.next >= self.trajectory.frames {
            return Ok(None);
        }
        self.file.start();
        let schema = self.schema.clone();
        let Trajectory { parts, label, steps, times, cell, unit, warnings, .. } =
            &mut self.trajectory;
        let mut warnings = warnings.clone();
        let texts = texts(parts, &schema);
        let mut builder = Builder::new(self.file.content.path(), Format::Hdf5, &schema);
        for part in parts {
            let frame = (self.next, &*steps);
            let blocks = read_part(&mut self.file, part, &schema, frame, &mut warnings)?;
            let cells = cells(part, &blocks, &schema, *label);
            check_positions(part, &schema, &cells)
                .map_err(|error| self.file.content.fault(error))?;
            for particle in 0..part.count as usize {
                for ((&slot, cell), &is_text) in schema.slots.iter().zip(&cells).zip(&texts) {
                    match cell {
                        _ if slot == Slot::Skip => (),
                        Cells::Values(block, place, names) => {
                            let Some(rows) = &blocks[*block] else { continue };
                            let at = (particle * rows.width + place) * rows.scalar.size();
                            let bytes = rows.bytes.get(at..).unwrap_or_default();
                            let value = rows.scale * rows.scalar.read(bytes, rows.order);
                            if !is_text {
                                builder.put_number(slot, value);
                                continue;
                            }
                            match names.iter().find(|(number, _)| *number as f64 == value) {
                                Some((_, name)) => builder.put_text(slot, name),
                                None => builder.put_text(slot, &value.to_string()),
                            }
                        }
                        Cells::Label => builder.put_text(slot, &part.name),
                        // Positions of two dimensions have no z.
                        Cells::Missing if matches!(slot, Slot::Position(_)) => {
                            builder.put_number(slot, 0.0);
                        }
                        Cells::Missing if is_text => builder.put_text(slot, ""),
                        Cells::Missing => builder.put_number(slot, f64::NAN),
                    }
                }
                builder.end_row()?;
            }
        }
        let cell = cell.read(&mut self.file, self.next, steps)?;
        let (step, time) = (steps.at(self.next), times.at(self.next));
        self.next += 1;
        let frame = builder.finish();
        let step = step.map(|step| step as i64);
        Ok(Some(ParticleFrame { cell, step, time, unit: *unit, warnings, ..frame }))
    }

    fn skip(&mut self) -> Result<bool, FileError> {
        let there = self.next < self.trajectory.frames;
        self.next += u64::from(there);
        Ok(there)
    }

    fn more(&mut self) -> Result<bool, FileError> {
        Ok(self.next < self.trajectory.frames)
    }

    fn place(&self) -> Option<Place> {
        Some(Place::new(0, self.next))
    }

    fn start_at(&mut self, place: &Place) -> Result<bool, FileError> {
        self.next = place.number;
        Ok(true)
    }
}
