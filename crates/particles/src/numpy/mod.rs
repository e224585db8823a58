//! Readers of NumPy arrays: one (NPY), or several in an archive (NPZ).
//!
//! The crate `npyz` isn't used: it reads one type of numbers at a time, and its header parser has no
//! depth limit. Archives are read with the crate `zip`.

mod archive;
mod array;
mod header;
mod rest;

pub(super) use archive::Npz;

use self::array::{Array, Transpose};
use crate::schema::{Schema, Slot};
use crate::{
    FileError, Format, ParticleFrame, ReadOptions, builder::Builder, frame_reader::FrameReader,
    source::Source,
};
use std::io::{Cursor, Read};
use std::path::Path;
use std::sync::Arc;

/// Magic number of an array.
pub(super) const MAGIC: &[u8] = b"\x93NUMPY";

/// Reader of an array: rows of `x y z` or `x y z radius`, or of a structured type with these names. A
/// leading third dimension is that of frames.
pub(super) struct Npy {
    array: Array<Box<dyn Read + Send>>,
    schema: Arc<Schema>,
    path: Arc<Path>,
    /// Number of remaining frames.
    left: u64,
}

impl Npy {
    pub(super) fn new(source: Source, options: &ReadOptions) -> Result<Self, FileError> {
        let path = source.path;
        let reader: Box<dyn Read + Send> = Box::new(Cursor::new(source.head).chain(source.reader));
        let fault = |message: String| FileError::whole_file(&path, message);
        let no_roles = options.columns.roles.is_empty();
        let transpose = if no_roles { Transpose::ToPositions } else { Transpose::Never };
        let array = Array::open(reader, transpose).map_err(|message| {
            fault(message).with_help(
                "make it an array of shape (count, 3): python3 -c \"import numpy; numpy.save('rows.npy', \
                 numpy.load('FILE').reshape(-1, 3).astype('f8'))\"",
            )
        })?;
        let schema = Arc::new(schema(&array, options).map_err(fault)?);
        let left = array.frames();
        Ok(Self { array, schema, path, left })
    }
}

/// Returns the roles of an array's columns.
fn schema<R: Read>(array: &Array<R>, options: &ReadOptions) -> Result<Schema, String> {
    let schema = columns(array, options)?;
    let is_number =
        |slot: &Slot| matches!(slot, Slot::Position(_) | Slot::Radius(_) | Slot::Color(_));
    let mut slots = schema.slots.iter().enumerate();
    match slots.find(|(column, slot)| is_number(slot) && array.is_text(*column)) {
        Some((column, _)) => Err(format!("holds texts in its column `{}`", schema.names[column])),
        None => Ok(schema),
    }
}

fn columns<R: Read>(array: &Array<R>, options: &ReadOptions) -> Result<Schema, String> {
    if let Some(names) = array.names() {
        return Schema::new(names, options);
    }
    let columns = array.columns();
    if options.columns.roles.is_empty() && !(3..=4).contains(&columns) {
        return Err(format!(
            "is an array of {columns} columns, but a row is `x y z` or `x y z radius`; say which \
             columns are what, as in --columns x=1,y=2,z=3,radius=4"
        ));
    }
    Schema::unnamed(columns, 0, options)
}

impl FrameReader for Npy {
    fn next(&mut self) -> Result<Option<ParticleFrame>, FileError> {
        if self.left == 0 {
            return Ok(None);
        }
        self.left -= 1;
        let mut builder = Builder::new(&self.path, Format::Npy, &self.schema);
        builder.frame.warnings.extend(self.array.warning());
        let schema = self.schema.clone();
        self.array.rows(&self.path, |row| {
            for (column, (slot, &value)) in schema.slots.iter().zip(row.numbers).enumerate() {
                match row.text(column) {
                    Some(text) => builder.put_text(*slot, text),
                    None => builder.put_number(*slot, value),
                }
            }
            builder.end_row()
        })?;
        Ok(Some(builder.finish()))
    }

    fn more(&mut self) -> Result<bool, FileError> {
        Ok(self.left > 0)
    }
}
