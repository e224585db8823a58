//! Arrays of binary files with a row for each particle: those of which a column is used, and their slots.

use crate::builder::Builder;
use crate::scalar::{Order, Scalar};
use crate::{FileError, schema::Slot};

/// Layout of the rows of an array.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RowLayout {
    pub(crate) scalar: Scalar,
    pub(crate) order: Order,
    /// Number of values in a row.
    pub(crate) width: usize,
    /// Factor of the values.
    pub(crate) scale: f64,
}

/// An array of which a column is used.
struct UsedArray<'s> {
    slots: &'s [Slot],
    layout: RowLayout,
    bytes: Vec<u8>,
}

/// The arrays of a frame, in the order of the schema's columns.
pub(crate) struct UsedArrays<'s> {
    /// Slots of the arrays to come.
    rest: &'s [Slot],
    arrays: Vec<UsedArray<'s>>,
}

impl<'s> UsedArrays<'s> {
    pub(crate) fn new(slots: &'s [Slot]) -> Self {
        Self { rest: slots, arrays: Vec::new() }
    }

    /// Adds the next array, which is read only if one of its columns is used.
    pub(crate) fn add(
        &mut self,
        layout: RowLayout,
        read: impl FnOnce() -> Result<Vec<u8>, FileError>,
    ) -> Result<(), FileError> {
        let (slots, rest) = self.rest.split_at(layout.width.min(self.rest.len()));
        self.rest = rest;
        if slots.iter().any(|slot| *slot != Slot::Skip) {
            self.arrays.push(UsedArray { slots, layout, bytes: read()? });
        }
        Ok(())
    }

    /// Puts the values of a particle into their columns.
    pub(crate) fn put_row(&self, builder: &mut Builder, row: usize) {
        for UsedArray { slots, layout, bytes } in &self.arrays {
            let RowLayout { scalar, order, width, scale } = *layout;
            let size = scalar.size();
            for (place, &slot) in slots.iter().enumerate() {
                let value = bytes.get((row * width + place) * size..).unwrap_or_default();
                builder.put_number(slot, scalar.read(value, order) * scale);
            }
        }
    }
}
