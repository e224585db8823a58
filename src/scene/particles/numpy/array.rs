//! One array (<https://numpy.org/doc/stable/reference/generated/numpy.lib.format.html>).

use super::MAGIC;
use crate::scene::SceneError;
use crate::scene::particles::scalar::{Order, Scalar};
use std::io::{self, BufReader, Read};
use std::path::Path;

/// Longest header in bytes.
const HEADER: u32 = 1 << 16;

/// Most columns of an array.
const COLUMNS: usize = 10_000;

/// An array whose numbers are about to be read.
pub(super) struct Array<R> {
    reader: BufReader<R>,
    fields: Vec<Field>,
    structured: bool,
    by_columns: bool,
    shape: Vec<u64>,
}

/// A number of each row, or of each element.
#[derive(Clone, Debug, PartialEq)]
struct Field {
    name: String,
    scalar: Scalar,
    order: Order,
}

impl<R: Read> Array<R> {
    /// Reads the header.
    pub(super) fn open(reader: R) -> Result<Self, String> {
        let mut reader = BufReader::with_capacity(1 << 16, reader);
        let cut = |error: io::Error| format!("cannot be read: {error}");
        let mut start = [0; 8];
        reader.read_exact(&mut start).map_err(cut)?;
        if !start.starts_with(MAGIC) {
            return Err("is not an array of NumPy".to_owned());
        }
        let mut length = [0; 4];
        let size = if start[6] == 1 { 2 } else { 4 };
        reader.read_exact(&mut length[..size]).map_err(cut)?;
        let length = u32::from_le_bytes(length);
        if length > HEADER {
            return Err(format!("has a header of {length} bytes"));
        }
        let mut header = vec![0; length as usize];
        reader.read_exact(&mut header).map_err(cut)?;
        let header = String::from_utf8_lossy(&header).into_owned();
        let unclear = || format!("has a header that is not understood: {}", header.trim());
        let (fields, structured) = fields(&header)?;
        let by_columns = after(&header, "fortran_order").ok_or_else(unclear)?.starts_with("True");
        let shape = after(&header, "shape").and_then(shape).ok_or_else(unclear)?;
        let rank = shape.len();
        let array = Self { reader, fields, structured, by_columns, shape };
        if !(1..=3 - usize::from(structured)).contains(&rank) || array.columns() > COLUMNS {
            let shape = array.shape;
            return Err(format!("is an array of shape {shape:?}, but rows are (count, 3 or 4)"));
        }
        if by_columns && (rank > 2 || structured) {
            return Err("is an array in Fortran's order of more than two dimensions".to_owned());
        }
        Ok(array)
    }

    /// Names of the columns of a structured array.
    pub(super) fn names(&self) -> Option<Vec<String>> {
        self.structured.then(|| self.fields.iter().map(|field| field.name.clone()).collect())
    }

    /// Numbers in a row.
    pub(super) fn columns(&self) -> usize {
        match self.shape[..] {
            _ if self.structured => self.fields.len(),
            [_, columns] | [_, _, columns] => columns.min(COLUMNS as u64 + 1) as usize,
            _ => 1,
        }
    }

    /// How many frames there are, none of them empty.
    pub(super) fn frames(&self) -> u64 {
        match self.shape[..] {
            _ if self.count() == 0 || self.columns() == 0 => 0,
            [frames, _] if self.structured => frames,
            [frames, _, _] => frames,
            _ => 1,
        }
    }

    /// Rows of a frame.
    fn count(&self) -> u64 {
        match self.shape[..] {
            [_, count] if self.structured => count,
            [count] | [count, _] | [_, count, _] => count,
            _ => 0,
        }
    }

    /// Reads the rows of the next frame.
    pub(super) fn rows(
        &mut self,
        path: &Path,
        mut take: impl FnMut(&[f64]) -> Result<(), SceneError>,
    ) -> Result<(), SceneError> {
        let fault = |error: io::Error| {
            let error = SceneError::whole_file(path, format!("ends before its last row: {error}"));
            error.with_help("the file is cut off")
        };
        let (count, columns) = (self.count(), self.columns());
        if self.by_columns {
            let all: io::Result<Vec<Vec<f64>>> = (0..columns).map(|_| self.column(count)).collect();
            let all = all.map_err(fault)?;
            let rows = 0..all.first().map_or(0, Vec::len);
            return rows.into_iter().try_for_each(|row| {
                take(&all.iter().map(|column| column[row]).collect::<Vec<_>>())
            });
        }
        let field = |column: usize| &self.fields[if self.structured { column } else { 0 }];
        let fields: Vec<(Scalar, Order)> =
            (0..columns).map(|column| (field(column).scalar, field(column).order)).collect();
        let mut bytes = vec![0; fields.iter().map(|(scalar, _)| scalar.size()).sum()];
        // Rows without a byte could be as many as the header likes.
        let count = if bytes.is_empty() { 0 } else { count };
        let mut row = vec![0.0; columns];
        for _ in 0..count {
            self.reader.read_exact(&mut bytes).map_err(fault)?;
            let mut at = 0;
            for (value, &(scalar, order)) in row.iter_mut().zip(&fields) {
                *value = scalar.read(&bytes[at..], order);
                at += scalar.size();
            }
            take(&row)?;
        }
        Ok(())
    }

    /// The next numbers of an array in Fortran's order.
    fn column(&mut self, count: u64) -> io::Result<Vec<f64>> {
        let Field { scalar, order, .. } = self.fields[0];
        let mut column = Vec::new();
        let mut block = vec![0; 1 << 16];
        let mut left = count.saturating_mul(scalar.size() as u64);
        while left > 0 {
            let length = left.min(block.len() as u64) as usize;
            self.reader.read_exact(&mut block[..length])?;
            let numbers = block[..length].chunks_exact(scalar.size());
            column.extend(numbers.map(|bytes| scalar.read(bytes, order)));
            left -= length as u64;
        }
        Ok(column)
    }
}

/// What stands in a header after a key.
fn after<'h>(header: &'h str, key: &str) -> Option<&'h str> {
    let rest = header.split_once(&format!("'{key}'"))?.1;
    Some(rest.trim_start().strip_prefix(':')?.trim_start())
}

/// `(5, 3)`.
fn shape(text: &str) -> Option<Vec<u64>> {
    let inner = text.strip_prefix('(')?.split_once(')')?.0;
    let numbers = inner.split(',').map(|number| number.trim().trim_end_matches('L'));
    numbers.filter(|number| !number.is_empty()).map(|number| number.parse().ok()).collect()
}

/// The type of the numbers, or those of a structured array's columns.
fn fields(header: &str) -> Result<(Vec<Field>, bool), String> {
    let descr = after(header, "descr").unwrap_or_default();
    if !descr.starts_with('[') {
        let name = descr.split('\'').nth(1).unwrap_or_default();
        return Ok((vec![field("", name)?], false));
    }
    let list = descr.split_once(']').map_or(descr, |(list, _)| list);
    let mut fields = Vec::new();
    for tuple in list.split('(').skip(1) {
        let mut quoted = tuple.split('\'');
        let (Some(name), Some(kind)) = (quoted.nth(1), quoted.nth(1)) else {
            return Err(format!("has columns of a type that is not read: {}", list.trim()));
        };
        fields.push(field(name, kind)?);
    }
    // Parentheses within a tuple are columns of vectors.
    if list.contains("((")
        || list.contains(", (") && list.matches('(').count() != list.matches("('").count()
    {
        return Err("has columns that hold arrays".to_owned());
    }
    Ok((fields, true))
}

/// `<f4` and the like.
fn field(name: &str, kind: &str) -> Result<Field, String> {
    let unknown =
        || format!("has numbers of the type `{kind}`, but types are f4, f8, i1 to i8 and u1 to u8");
    let mut letters = kind.chars();
    let order = match letters.next() {
        Some('>') => Order::Big,
        Some('<' | '|' | '=') => Order::Little,
        _ => return Err(unknown()),
    };
    let scalar = match letters.as_str() {
        "i1" => Scalar::I8,
        "u1" | "b1" => Scalar::U8,
        "i2" => Scalar::I16,
        "u2" => Scalar::U16,
        "i4" => Scalar::I32,
        "u4" => Scalar::U32,
        "i8" => Scalar::I64,
        "u8" => Scalar::U64,
        "f4" => Scalar::F32,
        "f8" => Scalar::F64,
        _ => return Err(unknown()),
    };
    Ok(Field { name: name.to_owned(), scalar, order })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn headers_are_read() {
        let header = "{'descr': '>f4', 'fortran_order': False, 'shape': (6912, 3), }";
        assert_eq!(after(header, "shape").and_then(shape), Some(vec![6912, 3]));
        let (plain, structured) = fields(header).expect("a type");
        assert_eq!((plain[0].scalar, plain[0].order, structured), (Scalar::F32, Order::Big, false));
        let header =
            "{'descr': [('x', '<f8'), ('id', '|u1')], 'fortran_order': False, 'shape': (2,)}";
        let (columns, structured) = fields(header).expect("types");
        assert_eq!((columns[1].name.as_str(), columns[1].scalar), ("id", Scalar::U8));
        assert!(structured);
        assert_eq!(after(header, "shape").and_then(shape), Some(vec![2]));
        for kind in ["<c16", "|O", "<U3", "", "f4"] {
            assert!(field("", kind).is_err(), "{kind}");
        }
        assert!(fields("{'descr': [('p', '<f8', (3,))]}").is_err());
    }
}
