//! Reads binary coordinates of NAMD (`.coor`): the number of atoms in 32 bits, and three numbers of 64 bits for each, in the byte
//! order of the machine that wrote them (ks.uiuc.edu/Research/namd/3.0/ug/node13.html).

use crate::arrays::{RowLayout, UsedArrays};
use crate::binary::BinaryFile;
use crate::scalar::{Order, Scalar};
use crate::{
    FileError, Format, LengthUnit, ParticleFrame, ReadOptions, builder::Builder,
    frame_reader::FrameReader, schema::Schema, source::Source,
};
use std::sync::Arc;

/// Length of the number of atoms, and of a position.
const HEADER: u64 = 4;
const POSITION: u64 = 24;

/// Numbers of atoms from this one on would be four letters of a text.
const MOST: u64 = 0x0900_0000;

/// Reader of a file of coordinates, which is one frame.
pub(crate) struct Coordinates {
    file: BinaryFile,
    schema: Arc<Schema>,
    order: Order,
    atoms: u64,
    done: bool,
}

impl Coordinates {
    pub(crate) fn new(source: Source, options: &ReadOptions) -> Result<Self, FileError> {
        let mut file = BinaryFile::open(source)?;
        let name = file.path().file_name().unwrap_or_default().to_string_lossy().into_owned();
        if name.to_ascii_lowercase().split('.').skip(1).any(|part| part == "vel") {
            let error = file.fault("holds velocities of NAMD, not positions");
            return Err(error.with_help("name the file of coordinates beside it, as in run.coor"));
        }
        let head = file.bytes(0, file.length().min(1 << 16))?;
        let Some((order, atoms)) = layout(&head) else {
            return Err(file.fault("is not a file of coordinates of NAMD"));
        };
        let length = HEADER + atoms * POSITION;
        file.check_range(0, length)?;
        if file.length() > length {
            let message = format!(
                "has {} bytes, but coordinates of {atoms} atoms of NAMD are {length}",
                file.length()
            );
            return Err(file.fault(message).with_help("convert other binary files to text"));
        }
        let names = ["x", "y", "z"].map(str::to_owned).into();
        let schema = Schema::new(names, options).map_err(|message| file.fault(message))?;
        Ok(Self { file, schema: Arc::new(schema), order, atoms, done: false })
    }
}

impl FrameReader for Coordinates {
    fn next(&mut self) -> Result<Option<ParticleFrame>, FileError> {
        if std::mem::replace(&mut self.done, true) {
            return Ok(None);
        }
        let schema = self.schema.clone();
        let mut arrays = UsedArrays::new(&schema.slots);
        let layout = RowLayout { scalar: Scalar::F64, order: self.order, width: 3, scale: 1.0 };
        arrays.add(layout, || self.file.bytes(HEADER, self.atoms * POSITION))?;
        let mut builder = Builder::new(self.file.path(), Format::Namd, &schema);
        for atom in 0..self.atoms as usize {
            arrays.put_row(&mut builder, atom);
            builder.end_row()?;
        }
        Ok(Some(ParticleFrame { unit: LengthUnit::Angstrom, ..builder.finish() }))
    }
}

/// Returns the byte order and the number of atoms, if a head has them and numbers that may be coordinates.
fn layout(head: &[u8]) -> Option<(Order, u64)> {
    [Order::Little, Order::Big].into_iter().find_map(|order| {
        let (count, rest) = head.split_at_checked(HEADER as usize)?;
        let atoms = Scalar::U32.read(count, order) as u64;
        let shown = rest.len().min((atoms * POSITION) as usize);
        let mut numbers = rest[..shown].chunks_exact(8).map(|own| Scalar::F64.read(own, order));
        // Of other files, some number is not one, or has an exponent far off.
        let is_length = |number: f64| number == 0.0 || (1e-30..1e6).contains(&number.abs());
        let is_some = numbers.clone().any(|number| number != 0.0);
        ((1..MOST).contains(&atoms) && is_some && numbers.all(is_length)).then_some((order, atoms))
    })
}

/// Returns whether a file with this head has coordinates of NAMD.
pub(crate) fn is_coordinates(head: &[u8]) -> bool {
    layout(head).is_some()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_after_their_number_tell_the_format_in_both_byte_orders() {
        let numbers = [0.0_f64, -12.5, 6e-17, 103.25, 4.0, 5.0];
        let file = |count: u32, numbers: &[f64], little: bool| {
            let order = |number: &f64| {
                if little { number.to_le_bytes() } else { number.to_be_bytes() }
            };
            let count = if little { count.to_le_bytes() } else { count.to_be_bytes() };
            [&count[..], &numbers.iter().flat_map(order).collect::<Vec<u8>>()].concat()
        };
        for little in [true, false] {
            let found = layout(&file(2, &numbers, little)).expect("coordinates");
            assert_eq!(found.1, 2);
            assert_eq!(found.0 == Order::Little, little);
        }
        for other in [
            file(2, &[0.0; 6], true),
            file(0, &numbers, true),
            file(2, &[1.0, 1e9, 1.0], true),
            file(2, &[1.0, f64::NAN, 1.0], false),
            b"2\nwater\nO 0.0 0.0 0.0\nH 1.0 0.0 0.0\n".to_vec(),
            vec![0; 40],
            vec![2, 0],
        ] {
            assert!(!is_coordinates(&other), "{other:?}");
        }
    }
}
