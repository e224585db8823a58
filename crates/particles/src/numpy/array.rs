//! Reads one array (<https://numpy.org/doc/stable/reference/generated/numpy.lib.format.html>).

use super::MAGIC;
use super::header::{COLUMNS, Field, Item, ROW, after, fields, shape};
use crate::FileError;
use std::io::{self, BufReader, Read, Seek};
use std::path::Path;

/// Maximum length of a header in bytes.
const HEADER: u32 = 1 << 16;

/// Reader of an array.
pub(super) struct Array<R> {
    reader: BufReader<R>,
    fields: Vec<Field>,
    structured: bool,
    by_columns: bool,
    shape: Vec<u64>,
    transposed: bool,
}

/// Condition for transposing an array of two dimensions.
#[derive(Clone, Copy, Debug)]
pub(super) enum Transpose {
    /// Never.
    Never,
    /// If its shape is (3, N) or (4, N), and its rows cannot be positions.
    ToPositions,
    /// If it has a column for each of `count` particles, but no row. Rows for each of several frames stay.
    ToRows { count: u64, frames: u64 },
}

impl Transpose {
    fn applies(self, rows: u64, columns: u64) -> bool {
        let is_position = |count: u64| (3..=4).contains(&count);
        match self {
            Self::Never => false,
            Self::ToPositions => is_position(rows) && !is_position(columns),
            Self::ToRows { count, .. } => columns == count && rows != count,
        }
    }
}

/// A row of an array.
#[derive(Clone, Copy)]
pub(super) struct Row<'r> {
    /// The numbers; NaN for texts.
    pub(super) numbers: &'r [f64],
    texts: &'r [Option<String>],
}

impl Row<'_> {
    /// Returns the text of a column; `None` if it holds numbers.
    pub(super) fn text(&self, column: usize) -> Option<&str> {
        self.texts.get(column)?.as_deref()
    }
}

impl<R: Read> Array<R> {
    /// Reads the header.
    pub(super) fn open(reader: R, transpose: Transpose) -> Result<Self, String> {
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
        let unclear = || format!("has an invalid header: {}", header.trim());
        let (fields, structured) = fields(&header)?;
        let by_columns = after(&header, "fortran_order").ok_or_else(unclear)?.starts_with("True");
        let shape = after(&header, "shape").and_then(shape).ok_or_else(unclear)?;
        let mut array = Self { reader, fields, structured, by_columns, shape, transposed: false };
        if let (Transpose::ToRows { count, frames: frames @ 2.. }, [rows, columns]) =
            (transpose, &array.shape[..])
            && (*rows, *columns) == (frames, count)
            && !structured
            && !by_columns
            && frames != count
        {
            // A number for each particle of each frame.
            array.shape.push(1);
        }
        let rank = array.shape.len();
        if let [rows, columns] = array.shape[..]
            && !structured
            && !array.fields[0].kind.is_text()
            && transpose.applies(rows, columns)
        {
            // Both orders are equal here.
            array.shape.reverse();
            (array.by_columns, array.transposed) = (!by_columns, true);
        }
        if !(1..=3 - usize::from(structured)).contains(&rank) || array.columns() > COLUMNS {
            let shape = array.shape;
            return Err(format!("is an array of shape {shape:?}, but rows are (count, 3 or 4)"));
        }
        if array.by_columns && (rank > 2 || structured || array.is_text(0)) {
            let what = "is an array in Fortran's order of texts or of more than two dimensions";
            return Err(what.to_owned());
        }
        let row = (0..array.columns()).map(|column| array.field(column).kind.size()).sum::<usize>();
        if row > ROW {
            return Err(format!("has rows of {row} bytes"));
        }
        Ok(array)
    }

    fn field(&self, column: usize) -> &Field {
        &self.fields[if self.structured { column } else { 0 }]
    }

    /// Returns a warning if the array is transposed.
    pub(super) fn warning(&self) -> Option<String> {
        let columns = self.columns();
        self.transposed.then(|| {
            let count = self.count();
            format!(
                "the shape ({columns}, {count}) is read as {columns} columns of {count} particles"
            )
        })
    }

    /// Returns whether a column holds texts.
    pub(super) fn is_text(&self, column: usize) -> bool {
        column < self.columns() && self.field(column).kind.is_text()
    }

    /// Returns the names of the columns of a structured array.
    pub(super) fn names(&self) -> Option<Vec<String>> {
        self.structured.then(|| self.fields.iter().map(|field| field.name.clone()).collect())
    }

    /// Returns the number of columns.
    pub(super) fn columns(&self) -> usize {
        match self.shape[..] {
            _ if self.structured => self.fields.len(),
            [_, columns] | [_, _, columns] => columns.min(COLUMNS as u64 + 1) as usize,
            _ => 1,
        }
    }

    /// Returns the number of frames; 0 if they are empty.
    pub(super) fn frames(&self) -> u64 {
        match self.shape[..] {
            _ if self.count() == 0 || self.columns() == 0 => 0,
            [frames, _] if self.structured => frames,
            [frames, _, _] => frames,
            _ => 1,
        }
    }

    /// Returns the number of rows of a frame.
    pub(super) fn count(&self) -> u64 {
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
        mut take: impl FnMut(Row) -> Result<(), FileError>,
    ) -> Result<(), FileError> {
        let fault = |error: io::Error| {
            let error = FileError::whole_file(path, format!("ends before its last row: {error}"));
            error.with_help("the file is cut off")
        };
        let (count, columns) = (self.count(), self.columns());
        if self.by_columns {
            let all: io::Result<Vec<Vec<f64>>> = (0..columns).map(|_| self.column(count)).collect();
            let all = all.map_err(fault)?;
            let rows = 0..all.first().map_or(0, Vec::len);
            return rows.into_iter().try_for_each(|row| {
                let numbers: Vec<f64> = all.iter().map(|column| column[row]).collect();
                take(Row { numbers: &numbers, texts: &[] })
            });
        }
        let kinds: Vec<Item> = (0..columns).map(|column| self.field(column).kind).collect();
        let mut bytes = vec![0; kinds.iter().map(|kind| kind.size()).sum()];
        // The file's length does not limit the number of empty rows.
        let count = if bytes.is_empty() { 0 } else { count };
        let mut numbers = vec![0.0; columns];
        let any_text = kinds.iter().any(|kind| kind.is_text());
        let text = |kind: &Item| kind.is_text().then(String::new);
        let mut texts: Vec<Option<String>> =
            if any_text { kinds.iter().map(text).collect() } else { Vec::new() };
        for _ in 0..count {
            self.reader.read_exact(&mut bytes).map_err(fault)?;
            let mut rest = &bytes[..];
            for (column, kind) in kinds.iter().enumerate() {
                let (own, after) = rest.split_at(kind.size());
                let text = texts.get_mut(column).and_then(Option::as_mut);
                numbers[column] = kind.read(own, text);
                rest = after;
            }
            take(Row { numbers: &numbers, texts: &texts })?;
        }
        Ok(())
    }

    /// Returns the length of a frame in bytes.
    fn frame_size(&self) -> u64 {
        let row: usize = (0..self.columns()).map(|column| self.field(column).kind.size()).sum();
        self.count().saturating_mul(row as u64)
    }

    /// Reads the next column of an array in Fortran order.
    fn column(&mut self, count: u64) -> io::Result<Vec<f64>> {
        let mut column = Vec::new();
        let Item::Number(scalar, order) = self.fields[0].kind else { return Ok(column) };
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

impl<R: Read + Seek> Array<R> {
    /// Moves to a frame, if there are several.
    pub(super) fn move_to(&mut self, frame: u64) -> io::Result<()> {
        if self.frames() <= 1 || frame == 0 {
            return Ok(());
        }
        let offset =
            self.frame_size().checked_mul(frame).and_then(|offset| i64::try_from(offset).ok());
        self.reader.seek_relative(offset.ok_or(io::ErrorKind::UnexpectedEof)?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Cursor;

    /// Returns the number of columns of an array whose header has `length` bytes, or the error.
    fn columns(kind: &str, shape: &str, length: usize) -> Result<usize, String> {
        let header = format!("{{'descr': {kind}, 'fortran_order': False, 'shape': {shape}, }}");
        let header = header.clone() + &" ".repeat(length.saturating_sub(header.len()));
        let size = (header.len() as u32).to_le_bytes();
        let bytes = [MAGIC, &[2, 0], &size, header.as_bytes()].concat();
        Array::open(Cursor::new(bytes), Transpose::Never).map(|array| array.columns())
    }

    #[test]
    fn headers_columns_and_rows_have_limits() {
        assert_eq!(columns("'<f4'", "(5, 3)", 1 << 16), Ok(3));
        let long = columns("'<f4'", "(5, 3)", (1 << 16) + 1);
        assert_eq!(long, Err("has a header of 65537 bytes".to_owned()));
        assert_eq!(columns("'<f4'", "(5, 10000)", 0), Ok(10_000));
        assert!(columns("'<f4'", "(5, 10001)", 0).is_err_and(|fault| fault.contains("10001")));
        let texts =
            |length: u32| columns(&format!("[('x', '<f4'), ('a', '|S{length}')]"), "(5,)", 0);
        assert_eq!(texts((1 << 24) - 4), Ok(2));
        assert_eq!(texts((1 << 24) - 3), Err("has rows of 16777217 bytes".to_owned()));
    }

    #[test]
    fn arrays_have_numbers_of_each_frame() {
        let shape = |shape: &str, count, frames| {
            let header = format!("{{'descr': '<f4', 'fortran_order': False, 'shape': {shape}, }}");
            let size = (header.len() as u32).to_le_bytes();
            let bytes = [MAGIC, &[2, 0], &size, header.as_bytes()].concat();
            let array = Array::open(Cursor::new(bytes), Transpose::ToRows { count, frames });
            array.map(|array| (array.frames(), array.count(), array.columns()))
        };
        assert_eq!(shape("(2, 5)", 5, 2), Ok((2, 5, 1)));
        assert_eq!(shape("(2, 20000)", 20_000, 2), Ok((2, 20_000, 1)));
        assert_eq!(shape("(2, 5)", 5, 1), Ok((1, 5, 2)));
        assert_eq!(shape("(3, 5)", 5, 2), Ok((1, 5, 3)));
        assert_eq!(shape("(2, 2)", 2, 2), Ok((1, 2, 2)));
        assert_eq!(shape("(2, 5, 3)", 5, 2), Ok((2, 5, 3)));
        assert_eq!(shape("(5,)", 5, 2), Ok((1, 5, 1)));
    }

    #[test]
    fn arrays_of_columns_are_transposed() {
        for (transpose, rows, columns, expected) in [
            (Transpose::Never, 3, 9, false),
            (Transpose::ToPositions, 3, 9, true),
            (Transpose::ToPositions, 4, 2, true),
            (Transpose::ToPositions, 4, 3, false),
            (Transpose::ToPositions, 5, 9, false),
            (Transpose::ToRows { count: 9, frames: 1 }, 3, 9, true),
            (Transpose::ToRows { count: 9, frames: 1 }, 9, 9, false),
            (Transpose::ToRows { count: 9, frames: 1 }, 9, 3, false),
            (Transpose::ToRows { count: 9, frames: 1 }, 3, 8, false),
        ] {
            assert_eq!(
                transpose.applies(rows, columns),
                expected,
                "{transpose:?} {rows} {columns}"
            );
        }
    }
}
