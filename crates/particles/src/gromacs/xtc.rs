//! Reads XTC.
//!
//! The crate `molly` isn't used: it panics on malformed files.

use super::compressed::{self, Fault, Packing};
use crate::binary::{BinaryFile, Numbers};
use crate::scalar::{Order, Scalar};
use crate::{
    FileError, Format, LengthUnit, ParticleFrame, ReadOptions, builder::Builder,
    frame_reader::FrameReader, place::Place, schema::Schema, source::Source,
};
use std::sync::Arc;

/// Magic numbers: with lengths of 32 bits, and, in frames of more than 298 million atoms, of 64 bits.
const MAGIC: i32 = 1995;
const WIDE: i32 = 2023;

/// Length of a frame's header in bytes, with the second number of atoms.
const HEADER: u64 = 56;

/// Length of what precedes compressed positions, without their length.
const PACKING: u64 = 32;

/// Maximum number of atoms whose positions are not compressed.
const PLAIN: u64 = 9;

/// Reader of the frames of an XTC file.
pub(crate) struct Xtc {
    file: BinaryFile,
    schema: Arc<Schema>,
    /// Offset and number of the next frame.
    at: u64,
    next: u64,
}

/// Where a frame is, from its header.
struct Found {
    atoms: u64,
    step: i64,
    time: f64,
    edges: [f64; 9],
    /// Offset of the positions, and of the next frame.
    positions: u64,
    end: u64,
    packed: Option<Packed>,
}

/// Compressed positions.
struct Packed {
    packing: Packing,
    precision: f64,
    length: u64,
}

/// Returns whether a file with this head is XTC: the number of atoms is stored twice.
pub(crate) fn is_xtc(head: &[u8]) -> bool {
    let word = |at: usize| Scalar::I32.read(head.get(at..).unwrap_or_default(), Order::Big);
    [MAGIC, WIDE].map(f64::from).contains(&word(0)) && word(4) > 0.0 && word(4) == word(52)
}

/// An error within compressed positions, or of the builder.
enum Failure {
    Positions(Fault),
    Other(FileError),
}

impl From<Fault> for Failure {
    fn from(fault: Fault) -> Self {
        Self::Positions(fault)
    }
}

impl Xtc {
    pub(crate) fn new(source: Source, options: &ReadOptions) -> Result<Self, FileError> {
        let file = BinaryFile::open(source)?;
        let schema = Schema::new(["x", "y", "z"].map(str::to_owned).into(), options)
            .map_err(|message| file.fault(message))?;
        Ok(Self { file, schema: Arc::new(schema), at: 0, next: 0 })
    }

    /// Reads the header of the next frame; returns `None` at the end of the file.
    fn find(&mut self) -> Result<Option<Found>, FileError> {
        if self.at >= self.file.length() {
            return Ok(None);
        }
        let damaged = |file: &BinaryFile, what| file.damaged(self.next, what);
        // The header and what precedes compressed positions, which small frames may lack.
        let most = HEADER + PACKING + 8;
        let length = most.min(self.file.length() - self.at).max(HEADER);
        let bytes = self.file.bytes(self.at, length)?;
        let mut numbers = Numbers::new(&bytes, Order::Big);
        let magic = numbers.i32();
        if ![Some(MAGIC), Some(WIDE)].contains(&magic) {
            return Err(damaged(&self.file, "it has no magic number"));
        }
        let atoms = numbers.count();
        let step = numbers.i32().map_or(0, i64::from);
        let time = numbers.scalar(Scalar::F32).unwrap_or(0.0);
        let edges = numbers.array::<9>(Scalar::F32).unwrap_or_default();
        let Some(atoms) = atoms.filter(|_| numbers.count() == atoms) else {
            return Err(damaged(&self.file, "its two numbers of atoms differ"));
        };
        let plain = Found {
            atoms,
            step,
            time,
            edges,
            positions: self.at + HEADER,
            end: self.at + HEADER + 12 * atoms,
            packed: None,
        };
        if atoms <= PLAIN {
            return Ok(Some(plain));
        }
        let wide = magic == Some(WIDE);
        let positions = self.at + HEADER + PACKING + if wide { 8 } else { 4 };
        self.file.check_range(self.at, positions - self.at)?;
        let precision = numbers.scalar(Scalar::F32).unwrap_or(0.0);
        let mut corner = || [0; 3].map(|_: i32| numbers.i32().unwrap_or(0));
        let packing = Packing { low: corner(), high: corner(), edge: numbers.i32().unwrap_or(0) };
        let high = if wide { numbers.count().unwrap_or(u64::MAX) } else { 0 };
        let low = numbers.scalar(Scalar::U32).unwrap_or(0.0) as u64;
        let length = high.checked_mul(1 << 32).map_or(u64::MAX, |high| high | low);
        if !(precision > 0.0 && precision.is_finite()) {
            return Err(damaged(&self.file, "its precision is not a positive number"));
        }
        let Some(end) =
            length.checked_next_multiple_of(4).and_then(|all| positions.checked_add(all))
        else {
            return Err(damaged(&self.file, "its length is impossible"));
        };
        let packed = Some(Packed { packing, precision, length });
        Ok(Some(Found { positions, end, packed, ..plain }))
    }

    /// Adds the positions of a frame.
    fn positions(&mut self, found: &Found, builder: &mut Builder) -> Result<(), FileError> {
        let Some(Packed { packing, precision, length }) = &found.packed else {
            let bytes = self.file.bytes(found.positions, 12 * found.atoms)?;
            let mut numbers = Numbers::new(&bytes, Order::Big);
            while let Some(position) = numbers.array(Scalar::F32) {
                builder.push(position)?;
            }
            return Ok(());
        };
        let bytes = self.file.bytes(found.positions, *length)?;
        let decoded = compressed::decode(packing, &bytes, found.atoms, |position| {
            let position = position.map(|value| f64::from(value) / precision);
            builder.push(position).map_err(Failure::Other)
        });
        decoded.map_err(|failure| match failure {
            Failure::Positions(fault) => self.file.damaged(self.next, fault),
            Failure::Other(error) => error,
        })
    }
}

impl FrameReader for Xtc {
    fn next(&mut self) -> Result<Option<ParticleFrame>, FileError> {
        let Some(found) = self.find()? else { return Ok(None) };
        let mut builder = Builder::new(self.file.path(), Format::Xtc, &self.schema);
        self.positions(&found, &mut builder)?;
        (self.at, self.next) = (found.end, self.next + 1);
        Ok(Some(ParticleFrame {
            cell: super::cell(found.edges),
            step: Some(found.step),
            time: Some(found.time),
            unit: LengthUnit::Nanometer,
            ..builder.finish()
        }))
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
        Ok(self.at < self.file.length())
    }

    fn place(&self) -> Option<Place> {
        Some(Place::new(self.at, self.next))
    }

    fn start_at(&mut self, place: &Place) -> Result<bool, FileError> {
        (self.at, self.next) = (place.offset, place.number);
        Ok(true)
    }
}
