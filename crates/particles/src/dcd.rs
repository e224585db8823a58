//! Reads DCD of CHARMM, NAMD, X-PLOR, OpenMM and LAMMPS: unformatted Fortran records of single-precision
//! coordinates in angstrom, in either byte order, with lengths of records in 32 or 64 bits
//! (charmm-gui.org/charmmdoc/dynamc.html; NAMD's `dcdlib.C`).

use crate::binary::{BinaryFile, Numbers};
use crate::scalar::{Order, Scalar};
use crate::{
    Cell, FileError, Format, LengthUnit, ParticleFrame, ReadOptions, builder::Builder,
    frame_reader::FrameReader, place::Place, schema::Schema, source::Source,
};
use glam::DVec3;
use std::sync::Arc;

/// Length of the first record.
const HEADER: u64 = 84;

/// Length of a line of the title.
const TITLE: u64 = 80;

/// Length of a record with a cell.
const CELL: u64 = 48;

/// Indices of the whole numbers in the first record.
const START: usize = 1;
const INTERVAL: usize = 2;
const FIXED: usize = 8;
const HAS_CELL: usize = 10;
const HAS_FOURTH: usize = 11;
const VERSION: usize = 19;

/// How records are stored: byte order, and the width of the length before and after each.
#[derive(Clone, Copy)]
struct Layout {
    order: Order,
    marker: u64,
}

impl Layout {
    /// Returns the layout of a file that begins with a record of [`HEADER`] bytes.
    fn of(head: &[u8]) -> Option<Self> {
        let length = |scalar: Scalar, order| scalar.read(head, order) == HEADER as f64;
        let is_first = |scalar: Scalar| {
            let word = head.get(scalar.size()..).unwrap_or_default();
            word.starts_with(b"CORD") || word.starts_with(b"VELD")
        };
        let layouts = [(Scalar::U32, Order::Little), (Scalar::U32, Order::Big)];
        let wide = [(Scalar::U64, Order::Little), (Scalar::U64, Order::Big)];
        let found = layouts
            .into_iter()
            .chain(wide)
            .find(|&(scalar, order)| length(scalar, order) && is_first(scalar))?;
        Some(Self { order: found.1, marker: found.0.size() as u64 })
    }

    /// Returns the length of a record of so many bytes, with its markers.
    fn record(self, length: u64) -> u64 {
        length + 2 * self.marker
    }
}

/// Returns whether a file with this head is DCD.
pub(crate) fn is_dcd(head: &[u8]) -> bool {
    Layout::of(head).is_some()
}

/// Reader of the frames of a DCD file.
pub(crate) struct Dcd {
    file: BinaryFile,
    schema: Arc<Schema>,
    layout: Layout,
    atoms: u64,
    /// Rows of the atoms that move, if others are fixed: only the first frame has those.
    free: Option<Vec<u32>>,
    /// Positions of the first frame, once needed.
    first_frame: Option<[Vec<f32>; 3]>,
    has_cell: bool,
    has_fourth: bool,
    /// Version of CHARMM.
    version: i64,
    start: i64,
    interval: i64,
    /// Offset of the first frame.
    frames_at: u64,
    next: u64,
}

impl Dcd {
    pub(crate) fn new(source: Source, options: &ReadOptions) -> Result<Self, FileError> {
        let layout = Layout::of(&source.head);
        let file = BinaryFile::open(source)?;
        let layout = layout.ok_or_else(|| file.fault("is not dcd"))?;
        let schema = Schema::new(["x", "y", "z"].map(str::to_owned).into(), options)
            .map_err(|message| file.fault(message))?;
        let mut dcd = Self {
            file,
            schema: Arc::new(schema),
            layout,
            atoms: 0,
            free: None,
            first_frame: None,
            has_cell: false,
            has_fourth: false,
            version: 0,
            start: 0,
            interval: 0,
            frames_at: 0,
            next: 0,
        };
        dcd.read_header()?;
        Ok(dcd)
    }

    fn read_header(&mut self) -> Result<(), FileError> {
        let header = self.record(0, Some(HEADER))?;
        if header.starts_with(b"VELD") {
            let error = self.file.fault("holds velocities, not positions");
            return Err(error.with_help("read the DCD file of coordinates of the same run"));
        }
        let words = Numbers::new(&header[4..], self.layout.order).array::<20>(Scalar::I32);
        let words = words.unwrap_or([0.0; 20]).map(|word| word as i64);
        // X-PLOR has neither.
        self.version = words[VERSION];
        let is_charmm = self.version != 0;
        self.has_cell = is_charmm && words[HAS_CELL] != 0;
        self.has_fourth = is_charmm && words[HAS_FOURTH] != 0;
        (self.start, self.interval) = (words[START], words[INTERVAL]);
        let mut at = self.layout.record(HEADER);
        at += self.layout.record(self.title(at)?);
        let count = self.record(at, Some(4))?;
        let count = Numbers::new(&count, self.layout.order).count();
        self.atoms = count.ok_or_else(|| self.file.fault("has a negative number of atoms"))?;
        at += self.layout.record(4);
        let fixed = words[FIXED];
        if fixed != 0 {
            let free = u64::try_from(fixed).ok().and_then(|fixed| self.atoms.checked_sub(fixed));
            let free = free.ok_or_else(|| {
                let atoms = self.atoms;
                self.file.fault(format!("has {fixed} fixed atoms, but {atoms} atoms"))
            })?;
            let rows = self.record(at, Some(free * 4))?;
            let mut numbers = Numbers::new(&rows, self.layout.order);
            let rows = (0..free).map(|_| {
                let row = numbers.count().filter(|row| (1..=self.atoms).contains(row))?;
                Some(row as u32 - 1)
            });
            let rows = rows.collect::<Option<Vec<u32>>>();
            self.free = Some(rows.ok_or_else(|| {
                self.file.fault("has numbers of moving atoms beyond its number of atoms")
            })?);
            at += self.layout.record(free * 4);
        }
        self.frames_at = at;
        Ok(())
    }

    /// Returns the length of the record of the title. Some writers claim two lines in it, whatever their number, so what is
    /// after the record must claim the same.
    fn title(&mut self, at: u64) -> Result<u64, FileError> {
        let title = self.record(at, None)?;
        let claimed = title.len() as u64;
        let lines = Numbers::new(&title, self.layout.order).count().unwrap_or(0);
        let counted = lines.saturating_mul(TITLE).saturating_add(4);
        let mut ends_after = |length: u64| {
            let end = at.saturating_add(self.layout.marker).saturating_add(length);
            self.marker(end).is_ok_and(|after| after == claimed)
        };
        Ok(if !ends_after(claimed) && ends_after(counted) { counted } else { claimed })
    }

    /// Returns the length of a record that stands before or after it.
    fn marker(&mut self, at: u64) -> Result<u64, FileError> {
        let Layout { order, marker } = self.layout;
        let scalar = if marker == 8 { Scalar::U64 } else { Scalar::U32 };
        Ok(scalar.read(&self.file.bytes(at, marker)?, order) as u64)
    }

    /// Reads the record at an offset; checks its length.
    fn record(&mut self, at: u64, length: Option<u64>) -> Result<Vec<u8>, FileError> {
        let claimed = self.marker(at)?;
        if let Some(length) = length.filter(|&length| length != claimed) {
            let message =
                format!("is damaged: a record of {claimed} bytes at byte {at}, not {length}");
            return Err(self.file.fault(message).with_help("copy the file again"));
        }
        self.file.bytes(at.saturating_add(self.layout.marker), claimed)
    }

    /// Returns the number of atoms that a frame stores.
    fn stored(&self, frame: u64) -> u64 {
        match &self.free {
            Some(free) if frame > 0 => free.len() as u64,
            _ => self.atoms,
        }
    }

    /// Returns the length of a frame in bytes.
    fn size(&self, frame: u64) -> u64 {
        let cell = if self.has_cell { self.layout.record(CELL) } else { 0 };
        let columns = if self.has_fourth { 4 } else { 3 };
        cell + columns * self.layout.record(4 * self.stored(frame))
    }

    /// Returns the offset of a frame.
    fn offset(&self, frame: u64) -> u64 {
        let before = frame
            .checked_sub(1)
            .map_or(0, |others| self.size(0).saturating_add(others.saturating_mul(self.size(1))));
        self.frames_at.saturating_add(before)
    }

    /// Returns whether a frame is complete.
    fn is_whole(&self, frame: u64) -> bool {
        self.file.has_range(self.offset(frame), self.size(frame))
    }

    /// Reads the stored coordinates of a frame, and its cell.
    fn coordinates(&mut self, frame: u64) -> Result<([Vec<f32>; 3], Option<Cell>), FileError> {
        let mut at = self.offset(frame);
        // Before any memory is taken.
        self.file.check_range(at, self.size(frame))?;
        let mut cell = None;
        if self.has_cell {
            let record = self.record(at, Some(CELL))?;
            let numbers = Numbers::new(&record, self.layout.order).array::<6>(Scalar::F64);
            cell = numbers.and_then(|numbers| self::cell(numbers, self.version));
            at += self.layout.record(CELL);
        }
        let length = 4 * self.stored(frame);
        let mut columns = [const { Vec::new() }; 3];
        for column in &mut columns {
            let record = self.record(at, Some(length))?;
            let order = self.layout.order;
            let values = record.chunks_exact(4).map(|bytes| Scalar::F32.read(bytes, order) as f32);
            *column = values.collect();
            at += self.layout.record(length);
        }
        Ok((columns, cell))
    }

    /// Reads the positions of all atoms of a frame, and its cell.
    fn positions(&mut self, frame: u64) -> Result<([Vec<f32>; 3], Option<Cell>), FileError> {
        if self.free.is_some() && frame > 0 && self.first_frame.is_none() {
            self.first_frame = Some(self.coordinates(0)?.0);
        }
        let (stored, cell) = self.coordinates(frame)?;
        let (Some(free), Some(first), 1..) = (&self.free, &self.first_frame, frame) else {
            return Ok((stored, cell));
        };
        let mut all = first.clone();
        for (column, stored) in all.iter_mut().zip(&stored) {
            for (&row, &value) in free.iter().zip(stored) {
                column[row as usize] = value;
            }
        }
        Ok((all, cell))
    }
}

/// Version of CHARMM that other programs write, whatever the cell: NAMD, LAMMPS, OpenMM and VMD.
const WRITERS_VERSION: i64 = 24;

/// Returns the cell of a record: lengths and angles in degrees, as A, gamma, B, beta, alpha, C; or the
/// cosines of the angles, as NAMD and LAMMPS write them; or the lower triangle of a symmetric matrix of
/// edges, as CHARMM has since version 22.
fn cell(numbers: [f64; 6], version: i64) -> Option<Cell> {
    let [a, gamma, b, beta, alpha, c] = numbers;
    let angles = [alpha, beta, gamma];
    // Smaller angles are components of edges: those of cells that are simulated are larger.
    let is_angle = |angle: &f64| *angle > 30.0 && *angle < 180.0;
    if angles.iter().all(is_angle) {
        return Cell::of_lengths([a, b, c], angles);
    }
    let [xx, xy, yy, xz, yz, zz] = numbers;
    let vectors = [DVec3::new(xx, xy, xz), DVec3::new(xy, yy, yz), DVec3::new(xz, yz, zz)];
    let is_positive =
        xx > 0.0 && xx * yy > xy * xy && vectors[0].cross(vectors[1]).dot(vectors[2]) > 0.0;
    let is_matrix = version >= 22 && version != WRITERS_VERSION && is_positive;
    let cosines = angles.iter().all(|cosine| cosine.abs() <= 1.0) && !is_matrix;
    // Right angles are exact.
    let degrees = |cosine: f64| if cosine == 0.0 { 90.0 } else { libm::acos(cosine).to_degrees() };
    let of_cosines =
        || Cell::of_lengths([a, b, c], angles.map(degrees)).and_then(Cell::with_volume);
    let matrix = || Cell { origin: DVec3::ZERO, vectors, periodic: [true; 3] }.declared();
    if cosines { of_cosines().or_else(matrix) } else { matrix() }
}

impl FrameReader for Dcd {
    fn next(&mut self) -> Result<Option<ParticleFrame>, FileError> {
        if self.offset(self.next) >= self.file.length() {
            return Ok(None);
        }
        let ([x, y, z], cell) = self.positions(self.next)?;
        let mut builder = Builder::new(self.file.path(), Format::Dcd, &self.schema);
        for ((x, y), z) in x.iter().zip(&y).zip(&z) {
            builder.push([x, y, z].map(|value| f64::from(*value)))?;
        }
        let step = self.interval.saturating_mul(self.next as i64).saturating_add(self.start);
        self.next += 1;
        let frame = builder.finish();
        Ok(Some(ParticleFrame { cell, step: Some(step), unit: LengthUnit::Angstrom, ..frame }))
    }

    fn skip(&mut self) -> Result<bool, FileError> {
        let there = self.more()?;
        self.next += u64::from(there);
        Ok(there)
    }

    fn more(&mut self) -> Result<bool, FileError> {
        Ok(self.is_whole(self.next))
    }

    fn place(&self) -> Option<Place> {
        Some(Place::new(0, self.next))
    }

    fn start_at(&mut self, place: &Place) -> Result<bool, FileError> {
        self.next = place.number;
        Ok(true)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lengths(numbers: [f64; 6]) -> Option<[f64; 3]> {
        cell(numbers, WRITERS_VERSION).map(|cell| cell.vectors.map(DVec3::length))
    }

    #[test]
    fn cells_are_angles_cosines_or_matrices() {
        let degrees = cell([20.0, 90.0, 30.0, 90.0, 60.0, 40.0], WRITERS_VERSION).expect("a cell");
        let cosines = cell([20.0, 0.0, 30.0, 0.0, 0.5, 40.0], WRITERS_VERSION).expect("a cell");
        for (one, other) in degrees.vectors.into_iter().zip(cosines.vectors) {
            assert!((one - other).length() < 1e-12, "{degrees:?} {cosines:?}");
        }
        assert_eq!(degrees.vectors[1], DVec3::new(0.0, 30.0, 0.0));
        for tilt in [-2.0, 2.0] {
            let matrix = cell([20.0, tilt, 30.0, 0.0, 1.5, 40.0], WRITERS_VERSION).expect("a cell");
            assert_eq!(matrix.vectors[1], DVec3::new(tilt, 30.0, 1.5));
        }
        // Of CHARMM, small numbers are components of edges, too, if they can be.
        let small = [20.0, -0.3, 21.0, 0.2, -0.1, 22.0];
        assert_eq!(cell(small, 46).expect("a cell").vectors[2], DVec3::new(0.2, -0.1, 22.0));
        let [one, other] = [cell(small, WRITERS_VERSION), cell(small, 21)];
        assert!(one == other && one.expect("a cell").vectors[0] == DVec3::X * 20.0);
        let no_matrix = [0.5, -0.6, 0.5, 0.0, 0.0, 1.0];
        assert_eq!(cell(no_matrix, 46), cell(no_matrix, WRITERS_VERSION));
        assert_eq!(lengths([0.0; 6]), None);
        assert_eq!(lengths([f64::NAN; 6]), None);
        assert_eq!(lengths([20.0, 0.0, 30.0, 0.0, 0.0, 40.0]), Some([20.0, 30.0, 40.0]));
    }
}
