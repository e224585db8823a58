//! Reads TRR: positions, velocities and forces in single or double precision. Frames without positions, which
//! a simulation may write at other intervals, are passed over.

use crate::binary::{BinaryFile, Numbers};
use crate::scalar::{Order, Scalar};
use crate::{
    FileError, Format, LengthUnit, ParticleFrame, ReadOptions, builder::Builder,
    frame_reader::FrameReader, place::Place, schema::Schema, source::Source,
};
use std::sync::Arc;

/// The beginning of every frame: magic number, length of a text with its end and without, and the text.
const MAGIC: &[u8] = b"\0\0\x07\xC9\0\0\0\x0D\0\0\0\x0CGMX_trn_file";

/// Length of a header in bytes, of which the last two numbers are in the frame's precision.
const HEADER: u64 = 24 + 13 * 4;

/// Names of the columns of positions, velocities and forces.
const NAMES: [[&str; 3]; 3] = [["x", "y", "z"], ["vx", "vy", "vz"], ["fx", "fy", "fz"]];

/// Reader of the frames of a TRR file.
pub(crate) struct Trr {
    file: BinaryFile,
    options: ReadOptions,
    /// Offset and number of the next frame.
    at: u64,
    next: u64,
}

/// Where a frame is, from its header.
struct Found {
    atoms: u64,
    real: Scalar,
    step: i64,
    time: f64,
    /// Offset of the cell, if there is one.
    cell: Option<u64>,
    /// Offsets of positions, velocities and forces.
    columns: [Option<u64>; 3],
    end: u64,
}

/// Returns whether a file with this head is TRR.
pub(crate) fn is_trr(head: &[u8]) -> bool {
    head.starts_with(MAGIC)
}

impl Trr {
    pub(crate) fn new(source: Source, options: &ReadOptions) -> Result<Self, FileError> {
        let file = BinaryFile::open(source)?;
        Ok(Self { file, options: options.clone(), at: 0, next: 0 })
    }

    /// Finds the next frame with positions, and moves to it; returns `None` at the end of the file.
    fn find(&mut self) -> Result<Option<Found>, FileError> {
        while let Some(found) = self.header()? {
            if found.columns[0].is_some() {
                return Ok(Some(found));
            }
            self.at = found.end;
        }
        Ok(None)
    }

    fn header(&mut self) -> Result<Option<Found>, FileError> {
        if self.at >= self.file.length() {
            return Ok(None);
        }
        let bytes = self.file.bytes(self.at, HEADER)?;
        let damaged = |file: &BinaryFile, what| file.damaged(self.next, what);
        let Some(numbers) = bytes.strip_prefix(MAGIC) else {
            return Err(damaged(&self.file, "it has no magic number"));
        };
        let mut numbers = Numbers::new(numbers, Order::Big);
        let Some(sizes) = numbers.array::<10>(Scalar::I32) else { return Ok(None) };
        let [ir, energy, edges, virial, pressure, topology, symmetry, x, v, f] =
            sizes.map(|size| size as i64 as u64);
        let (atoms, step) = (numbers.count(), numbers.i32());
        if sizes.iter().any(|&size| size < 0.0) {
            return Err(damaged(&self.file, "it has blocks of negative length"));
        }
        let Some(atoms) = atoms else {
            return Err(damaged(&self.file, "it has a negative number of atoms"));
        };
        // As GROMACS does: by the size of the cell, or else of any column.
        let columns = [x, v, f];
        let of_column =
            || columns.iter().find(|&&size| size > 0).map(|size| size / (3 * atoms).max(1));
        let real = match if edges > 0 { Some(edges / 9) } else { of_column() } {
            Some(8) => Scalar::F64,
            Some(4) | None => Scalar::F32,
            Some(_) => {
                return Err(damaged(&self.file, "its numbers are neither single nor double"));
            }
        };
        let size = real.size() as u64;
        if columns.iter().any(|&column| column > 0 && column != 3 * size * atoms) {
            return Err(damaged(
                &self.file,
                "the lengths of its columns contradict its number of atoms",
            ));
        }
        let times = self.at + HEADER;
        let time = real.read(&self.file.bytes(times, size)?, Order::Big);
        let mut at = times + 2 * size + ir + energy;
        let cell = (edges > 0).then_some(at);
        at += edges + virial + pressure + topology + symmetry;
        let offsets = columns.map(|length| {
            at += length;
            (length > 0).then_some(at - length)
        });
        let step = step.map_or(0, i64::from);
        Ok(Some(Found { atoms, real, step, time, cell, columns: offsets, end: at }))
    }

    fn frame(&mut self, found: &Found) -> Result<ParticleFrame, FileError> {
        let size = found.real.size();
        self.file.check_range(self.at, found.end - self.at)?;
        let edges = match found.cell {
            Some(at) => {
                let bytes = self.file.bytes(at, 9 * size as u64)?;
                Numbers::new(&bytes, Order::Big).array(found.real)
            }
            None => None,
        };
        let present = NAMES.iter().zip(found.columns).filter_map(|(names, at)| Some((names, at?)));
        let names = present.clone().flat_map(|(names, _)| names.map(str::to_owned)).collect();
        let schema = Schema::new(names, &self.options).map_err(|error| self.file.fault(error))?;
        let schema = Arc::new(schema);
        let used = schema.slots.len().div_ceil(3);
        let mut blocks = Vec::new();
        for (_, at) in present.take(used) {
            blocks.push(self.file.bytes(at, found.atoms * 3 * size as u64)?);
        }
        let mut builder = Builder::new(self.file.path(), Format::Trr, &schema);
        for atom in 0..found.atoms as usize {
            for (column, &slot) in schema.slots.iter().enumerate() {
                let at = (3 * atom + column % 3) * size;
                builder.put_number(slot, found.real.read(&blocks[column / 3][at..], Order::Big));
            }
            builder.end_row()?;
        }
        Ok(ParticleFrame {
            cell: edges.and_then(super::cell),
            step: Some(found.step),
            time: Some(found.time),
            unit: LengthUnit::Nanometer,
            ..builder.finish()
        })
    }
}

impl FrameReader for Trr {
    fn next(&mut self) -> Result<Option<ParticleFrame>, FileError> {
        let Some(found) = self.find()? else { return Ok(None) };
        let frame = self.frame(&found)?;
        (self.at, self.next) = (found.end, self.next + 1);
        Ok(Some(frame))
    }

    fn skip(&mut self) -> Result<bool, FileError> {
        let found = self.find();
        super::pass(found, |found| {
            let there = found.end <= self.file.length();
            if there {
                (self.at, self.next) = (found.end, self.next + 1);
            }
            there
        })
    }

    fn more(&mut self) -> Result<bool, FileError> {
        let found = self.find();
        super::pass(found, |_| true)
    }

    fn place(&self) -> Option<Place> {
        Some(Place::new(self.at, self.next))
    }

    fn start_at(&mut self, place: &Place) -> Result<bool, FileError> {
        (self.at, self.next) = (place.offset, place.number);
        Ok(true)
    }
}
