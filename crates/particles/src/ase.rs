//! Reads trajectories of ASE (`.traj`), which are files of its container Ulm: a table of offsets, and for each frame
//! a description in JSON that says where its arrays are (wiki.fysik.dtu.dk/ase/ase/io/ulm.html).

use crate::arrays::{RowLayout, UsedArrays};
use crate::binary::BinaryFile;
use crate::scalar::{Order, Scalar};
use crate::schema::Schema;
use crate::{
    Cell, Element, ElementSource, FileError, Format, LengthUnit, ParticleFrame, ReadOptions,
    builder::Builder, frame_reader::FrameReader, options::component_names, place::Place,
    source::Source,
};
use glam::DVec3;
use serde_json::{Map, Value};
use std::sync::Arc;

/// Beginning of files: the container, and what is in it.
const MAGIC: &[u8] = b"- of Ulm";
const TAG: &[u8] = b"ASE-Trajectory";

/// Length of the header: magic, tag, version, number of frames, and the offset of the table of frames.
const HEADER: u64 = 48;

/// Arrays of three numbers per atom, and the names of their columns.
const VECTORS: [(&str, [&str; 3]); 2] =
    [("positions", ["x", "y", "z"]), ("forces", ["fx", "fy", "fz"])];

/// Atomic numbers, which become types.
const NUMBERS: &str = "numbers";

/// Maximum number of values per atom in an array that is kept as columns.
const WIDEST: u64 = 64;

/// Maximum length of a frame's description in bytes.
const LONGEST: u64 = 1 << 26;

/// Returns whether a file with this head is a trajectory of ASE.
pub(crate) fn is_trajectory(head: &[u8]) -> bool {
    head.strip_prefix(MAGIC).is_some_and(|rest| rest.starts_with(TAG))
}

/// An array of numbers with a row for each atom.
struct Array {
    name: String,
    scalar: Scalar,
    order: Order,
    offset: u64,
    rows: u64,
    width: u64,
}

/// Reader of the frames of a trajectory.
pub(crate) struct Trajectory {
    file: BinaryFile,
    options: ReadOptions,
    frames: u64,
    /// Offset of the table of offsets.
    table: u64,
    next: u64,
    /// The description of the first frame, which has what does not change.
    first: Option<Map<String, Value>>,
}

impl Trajectory {
    pub(crate) fn new(source: Source, options: &ReadOptions) -> Result<Self, FileError> {
        let mut file = BinaryFile::open(source)?;
        let [_, _, _, _, frames, table] = words(&file.bytes(0, HEADER)?);
        Ok(Self { file, options: options.clone(), frames, table, next: 0, first: None })
    }

    /// Reads the description of a frame.
    fn description(&mut self, frame: u64) -> Result<Map<String, Value>, FileError> {
        let entry = self.table.saturating_add(frame.saturating_mul(8));
        let [offset] = words(&self.file.bytes(entry, 8)?);
        let [length] = words(&self.file.bytes(offset, 8)?);
        if length > LONGEST {
            return Err(self.file.damaged(frame, "its description is longer than 64 MiB"));
        }
        let text = self.file.bytes(offset.saturating_add(8), length)?;
        serde_json::from_slice(&without_nan(text)).map_err(|error| {
            self.file.damaged(frame, &format!("its description is no JSON: {error}"))
        })
    }

    /// Reads the values of an array.
    fn values(&mut self, array: &Array) -> Result<Vec<u8>, FileError> {
        let count = array.rows.saturating_mul(array.width);
        self.file.bytes(array.offset, count.saturating_mul(array.scalar.size() as u64))
    }
}

/// Returns an array of numbers with rows, if a key of a description tells one.
fn array(key: &str, value: &Value, order: Order) -> Option<Array> {
    let [shape, kind, offset] = &value.get("ndarray")?.as_array()?[..] else { return None };
    let shape: Option<Vec<u64>> = shape.as_array()?.iter().map(Value::as_u64).collect();
    let shape = shape?;
    let (rows, width) = match shape[..] {
        [rows] => (rows, 1),
        [rows, width] if (1..=WIDEST).contains(&width) => (rows, width),
        _ => return None,
    };
    let name = key.strip_suffix('.')?.to_owned();
    let scalar = scalar(kind.as_str()?)?;
    Some(Array { name, scalar, order, offset: offset.as_u64()?, rows, width })
}

/// Returns the arrays of a frame's description, those of its calculator too.
fn arrays(description: &Map<String, Value>) -> Vec<Array> {
    let little = description.get("_little_endian").and_then(Value::as_bool).unwrap_or(true);
    let order = if little { Order::Little } else { Order::Big };
    let calculator = description.get("calculator.").and_then(Value::as_object);
    let entries = description.iter().chain(calculator.into_iter().flatten());
    entries.filter_map(|(key, value)| array(key, value, order)).collect()
}

/// Returns the 64-bit words of a block, in the order of little-endian files, and zero beyond it.
fn words<const COUNT: usize>(bytes: &[u8]) -> [u64; COUNT] {
    let mut numbers = bytes.chunks_exact(8);
    std::array::from_fn(|_| {
        let word = numbers.next().and_then(|word| word.try_into().ok());
        word.map_or(0, u64::from_le_bytes)
    })
}

/// Returns the type of numbers of this name of NumPy.
fn scalar(name: &str) -> Option<Scalar> {
    Some(match name {
        "float64" => Scalar::F64,
        "float32" => Scalar::F32,
        "int64" => Scalar::I64,
        "int32" => Scalar::I32,
        "int16" => Scalar::I16,
        "int8" => Scalar::I8,
        "uint64" => Scalar::U64,
        "uint32" => Scalar::U32,
        "uint16" => Scalar::U16,
        "uint8" | "bool" => Scalar::U8,
        _ => return None,
    })
}

/// Replaces `NaN` and `Infinity`, which Python writes and JSON does not know, by `null` outside of strings.
fn without_nan(text: Vec<u8>) -> Vec<u8> {
    if memchr::memmem::find(&text, b"NaN").or(memchr::memmem::find(&text, b"Infinity")).is_none() {
        return text;
    }
    let mut clean = Vec::with_capacity(text.len());
    let (mut rest, mut is_string) = (&text[..], false);
    while let Some(&byte) = rest.first() {
        let unknown =
            ["-Infinity", "Infinity", "NaN"].iter().find(|word| rest.starts_with(word.as_bytes()));
        if let Some(word) = unknown.filter(|_| !is_string) {
            clean.extend_from_slice(b"null");
            rest = &rest[word.len()..];
        } else {
            is_string ^= byte == b'"';
            let length = if byte == b'\\' { 2.min(rest.len()) } else { 1 };
            clean.extend_from_slice(&rest[..length]);
            rest = &rest[length..];
        }
    }
    clean
}

/// Returns the cell of a description, if it has three edges.
fn cell(description: &Map<String, Value>, periodic: [bool; 3]) -> Option<Cell> {
    let rows = description.get("cell")?.as_array()?;
    let edge = |row: &Value| {
        let values: Option<Vec<f64>> = row.as_array()?.iter().map(Value::as_f64).collect();
        values.filter(|values| values.len() == 3).map(|values| DVec3::from_slice(&values))
    };
    let edges: Option<Vec<DVec3>> = rows.iter().map(edge).collect();
    let vectors = edges?.try_into().ok()?;
    Cell { origin: DVec3::ZERO, vectors, periodic }.declared()
}

impl FrameReader for Trajectory {
    fn next(&mut self) -> Result<Option<ParticleFrame>, FileError> {
        if self.next >= self.frames {
            return Ok(None);
        }
        let first = match self.first.take() {
            Some(first) => first,
            None => self.description(0)?,
        };
        let own = if self.next == 0 { first.clone() } else { self.description(self.next)? };
        let mut arrays = arrays(&own);
        for array in self::arrays(&first) {
            // Numbers and masses are only in the first frame, unless they change.
            if [NUMBERS, "masses"].contains(&array.name.as_str())
                && arrays.iter().all(|own| own.name != array.name)
            {
                arrays.push(array);
            }
        }
        let pbc = own.get("pbc").or(first.get("pbc")).and_then(Value::as_array);
        let periodic = std::array::from_fn(|axis| {
            pbc.and_then(|pbc| pbc.get(axis)).and_then(Value::as_bool).unwrap_or(false)
        });
        let Some(atoms) = arrays.iter().find(|own| own.name == "positions").map(|own| own.rows)
        else {
            return Err(self.file.damaged(self.next, "it has no positions"));
        };
        arrays.retain(|array| array.rows == atoms);
        let numbers = arrays.iter().position(|own| own.name == NUMBERS).map(|at| arrays.remove(at));
        let kinds = match numbers {
            Some(array) => Some((self.values(&array)?, array)),
            None => None,
        };
        let names = arrays.iter().flat_map(|array| {
            let known = VECTORS.iter().find(|(name, _)| *name == array.name && array.width == 3);
            match known {
                Some((_, axes)) => axes.map(str::to_owned).to_vec(),
                None => component_names(&array.name, array.width as usize),
            }
        });
        let names = kinds.iter().map(|_| "element".to_owned()).chain(names).collect();
        let schema = Schema::new(names, &self.options);
        let schema = Arc::new(schema.map_err(|message| self.file.fault(message))?);
        let (kind, slots) = schema.slots.split_at(usize::from(kinds.is_some()));
        let mut used = UsedArrays::new(slots);
        for array in &arrays {
            let &Array { scalar, order, width, .. } = array;
            let layout = RowLayout { scalar, order, width: width as usize, scale: 1.0 };
            used.add(layout, || self.values(array))?;
        }
        let mut builder = Builder::new(self.file.path(), Format::AseTrajectory, &schema);
        for atom in 0..atoms as usize {
            used.put_row(&mut builder, atom);
            if let Some((bytes, array)) = &kinds {
                let bytes = bytes.get(atom * array.scalar.size()..).unwrap_or_default();
                let number = array.scalar.read(bytes, array.order).max(0.0);
                let symbol = Element::from_number(number as u64).map_or("X", Element::symbol);
                builder.put_text(kind[0], symbol);
            }
            builder.end_row()?;
        }
        let cell = cell(&own, periodic);
        self.first = Some(first);
        self.next += 1;
        let mut frame = builder.finish();
        // The symbols are those of the numbers in the file.
        frame.kinds.table.iter_mut().for_each(|kind| kind.source = ElementSource::Number);
        Ok(Some(ParticleFrame { cell, unit: LengthUnit::Angstrom, ..frame }))
    }

    fn skip(&mut self) -> Result<bool, FileError> {
        let there = self.more()?;
        self.next += u64::from(there);
        Ok(there)
    }

    fn more(&mut self) -> Result<bool, FileError> {
        Ok(self.next < self.frames
            && self.file.has_range(self.table.saturating_add(self.next * 8), 8))
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

    #[test]
    fn words_of_python_become_null_outside_of_strings() {
        for (text, expected) in [
            (r#"{"a": NaN, "b": [-Infinity, Infinity]}"#, r#"{"a": null, "b": [null, null]}"#),
            (r#"{"NaN": "a\"NaN", "c": NaN}"#, r#"{"NaN": "a\"NaN", "c": null}"#),
            (r#"{"a": 1}"#, r#"{"a": 1}"#),
        ] {
            let clean = without_nan(text.as_bytes().to_vec());
            assert_eq!(String::from_utf8_lossy(&clean), expected);
        }
    }
}
