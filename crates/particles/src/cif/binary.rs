//! Decodes BinaryCIF, columns of mmCIF in MessagePack (Sehnal et al., "BinaryCIF and CIFTools", PLOS Computational
//! Biology 16, 2020; github.com/molstar/BinaryCIF), to the text of the categories that are read.

use crate::scalar::{Order, Scalar};
use crate::source::{self, Bytes, Source};
use crate::{FileError, memory};
use serde::Deserialize;
use std::io::{Cursor, Read};

/// Categories that are read, in the order in which they are: bonds before atoms.
const CATEGORIES: [&str; 6] =
    ["_cell", "_struct", "_struct_conn", "_chem_comp_bond", "_chem_comp_atom", "_atom_site"];

/// Categories whose row is items, not a loop.
const ITEMS: [&str; 2] = ["_cell", "_struct"];

/// Maximum length of a file in bytes, where free memory is unknown.
const MOST: u64 = 1 << 40;

/// Bytes of text that are decoded at a time.
const CHUNK: usize = 1 << 16;

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct File<'f> {
    #[serde(borrow)]
    data_blocks: Vec<Block<'f>>,
}

#[derive(Deserialize)]
struct Block<'f> {
    header: &'f str,
    #[serde(borrow)]
    categories: Vec<Category<'f>>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct Category<'f> {
    name: &'f str,
    row_count: usize,
    #[serde(borrow)]
    columns: Vec<Column<'f>>,
}

#[derive(Deserialize)]
struct Column<'f> {
    name: &'f str,
    #[serde(borrow)]
    data: Data<'f>,
    #[serde(borrow)]
    mask: Option<Data<'f>>,
}

#[derive(Deserialize)]
struct Data<'f> {
    data: &'f [u8],
    #[serde(borrow)]
    encoding: Vec<Encoding<'f>>,
}

/// A step by which a column was encoded.
#[derive(Deserialize)]
#[serde(tag = "kind", rename_all_fields = "camelCase")]
enum Encoding<'f> {
    ByteArray {
        r#type: u8,
    },
    FixedPoint {
        factor: f64,
    },
    IntervalQuantization {
        min: f64,
        max: f64,
        num_steps: f64,
    },
    RunLength {
        src_size: u64,
    },
    Delta {
        origin: i32,
    },
    IntegerPacking {
        byte_count: u8,
        is_unsigned: bool,
    },
    StringArray {
        #[serde(borrow)]
        data_encoding: Vec<Encoding<'f>>,
        string_data: &'f str,
        #[serde(borrow)]
        offset_encoding: Vec<Encoding<'f>>,
        offsets: &'f [u8],
    },
}

/// Decoded values.
enum Values {
    Whole(Vec<i32>),
    Real(Vec<f64>),
    /// Codes, the ends of all texts in bytes, and the texts one after another.
    Texts {
        codes: Vec<i32>,
        offsets: Vec<i32>,
        texts: String,
    },
}

/// Returns the whole numbers of these values.
fn whole(values: Values) -> Result<Vec<i32>, String> {
    match values {
        Values::Whole(values) => Ok(values),
        Values::Real(_) | Values::Texts { .. } => Err("numbers that must be whole are not".into()),
    }
}

/// Returns the values that these bytes encode.
fn decode(bytes: &[u8], encoding: &[Encoding]) -> Result<Values, String> {
    let (last, steps) = encoding.split_last().ok_or("a column has no encoding")?;
    let mut values = match last {
        Encoding::ByteArray { r#type } => numbers(bytes, *r#type)?,
        Encoding::StringArray { data_encoding, string_data, offset_encoding, offsets } => {
            let codes = whole(decode(bytes, data_encoding)?)?;
            let offsets = whole(decode(offsets, offset_encoding)?)?;
            Values::Texts { codes, offsets, texts: (*string_data).to_owned() }
        }
        _ => return Err("the last encoding of a column is not one of bytes".into()),
    };
    for step in steps.iter().rev() {
        values = match step {
            Encoding::FixedPoint { factor } => {
                let values = whole(values)?.into_iter().map(|value| f64::from(value) / factor);
                Values::Real(values.collect())
            }
            Encoding::IntervalQuantization { min, max, num_steps } => {
                let step = (max - min) / (num_steps - 1.0);
                let values = whole(values)?.into_iter().map(|value| min + step * f64::from(value));
                Values::Real(values.collect())
            }
            Encoding::RunLength { src_size } => Values::Whole(runs(&whole(values)?, *src_size)?),
            Encoding::Delta { origin } => {
                let mut value = *origin;
                let sums = whole(values)?.into_iter().map(|difference| {
                    value = value.wrapping_add(difference);
                    value
                });
                Values::Whole(sums.collect())
            }
            Encoding::IntegerPacking { byte_count, is_unsigned } => {
                Values::Whole(unpacked(&whole(values)?, *byte_count, *is_unsigned))
            }
            Encoding::ByteArray { .. } | Encoding::StringArray { .. } => {
                return Err("an encoding of bytes is not the last of a column".into());
            }
        };
    }
    Ok(values)
}

/// Returns the numbers of a block of bytes of this type.
fn numbers(bytes: &[u8], kind: u8) -> Result<Values, String> {
    let scalar = match kind {
        1 => Scalar::I8,
        2 => Scalar::I16,
        3 => Scalar::I32,
        4 => Scalar::U8,
        5 => Scalar::U16,
        6 => Scalar::U32,
        32 => Scalar::F32,
        33 => Scalar::F64,
        other => return Err(format!("there is no type {other} of numbers")),
    };
    let values = bytes.chunks_exact(scalar.size()).map(|bytes| scalar.read(bytes, Order::Little));
    if kind >= 32 {
        return Ok(Values::Real(values.collect()));
    }
    let fits = |value: f64| (value <= f64::from(i32::MAX)).then_some(value as i32);
    let values: Option<Vec<i32>> = values.map(fits).collect();
    values.map(Values::Whole).ok_or_else(|| "a whole number is above 2,147,483,647".into())
}

/// Returns the values of pairs of a value and its number of repetitions.
fn runs(pairs: &[i32], size: u64) -> Result<Vec<i32>, String> {
    let count: u64 = pairs.chunks_exact(2).map(|pair| pair[1].max(0) as u64).sum();
    if count != size {
        return Err(format!("runs have {count} values, not {size}"));
    }
    memory::check_growth(4 * count, 0)
        .map_err(|shortage| format!("{count} values need {shortage}"))?;
    let repeat = |pair: &[i32]| std::iter::repeat_n(pair[0], pair[1].max(0) as usize);
    Ok(pairs.chunks_exact(2).flat_map(repeat).collect())
}

/// Returns the numbers whose parts are added up while they are at a limit of their type.
fn unpacked(parts: &[i32], bytes: u8, is_unsigned: bool) -> Vec<i32> {
    let (low, high) = match (bytes, is_unsigned) {
        (1, true) => (-1, 0xFF),
        (1, false) => (-0x80, 0x7F),
        (_, true) => (-1, 0xFFFF),
        (_, false) => (-0x8000, 0x7FFF),
    };
    let mut values = Vec::new();
    let mut sum = 0_i32;
    for &part in parts {
        sum = sum.wrapping_add(part);
        if part != low && part != high {
            values.push(std::mem::take(&mut sum));
        }
    }
    values
}

/// A decoded column, with the marks of its values: 0 there, 1 not applicable, 2 unknown.
struct Decoded {
    values: Values,
    marks: Vec<i32>,
}

impl Decoded {
    fn new(column: &Column, rows: usize) -> Result<Self, String> {
        let values = decode(column.data.data, &column.data.encoding)?;
        let count = match &values {
            Values::Whole(values) | Values::Texts { codes: values, .. } => values.len(),
            Values::Real(values) => values.len(),
        };
        let marks = match &column.mask {
            Some(mask) => whole(decode(mask.data, &mask.encoding)?)?,
            None => vec![0; rows],
        };
        if count != rows || marks.len() != rows {
            let own = if count == rows { marks.len() } else { count };
            return Err(format!("{} has {own} values, but {rows} rows", column.name));
        }
        Ok(Self { values, marks })
    }

    /// Appends a value as CIF writes it.
    fn write(&self, row: usize, text: &mut Vec<u8>) {
        match (self.marks[row], &self.values) {
            (1, _) => text.push(b'.'),
            (2, _) => text.push(b'?'),
            (_, Values::Whole(values)) => {
                text.extend_from_slice(values[row].to_string().as_bytes());
            }
            (_, Values::Real(values)) => text.extend_from_slice(values[row].to_string().as_bytes()),
            (_, Values::Texts { codes, offsets, texts }) => {
                let end = |at: usize| offsets.get(at).and_then(|&end| usize::try_from(end).ok());
                let code = usize::try_from(codes[row]).ok();
                let range = code.and_then(|code| Some(end(code)?..end(code.checked_add(1)?)?));
                quote(range.and_then(|range| texts.get(range)).unwrap_or_default(), text);
            }
        }
    }
}

/// Appends a text in the quotes that it needs.
fn quote(value: &str, text: &mut Vec<u8>) {
    let lower = value.to_ascii_lowercase();
    let is_word = |word: &str| lower.starts_with(word);
    let is_bare = !value.is_empty()
        && !value.contains(|letter: char| letter.is_ascii_whitespace())
        && !value.starts_with(['_', '#', '$', '\'', '"', ';', '[', ']'])
        && !["data_", "loop_", "save_", "stop_", "global_"].iter().any(|word| is_word(word))
        && value != "."
        && value != "?";
    let quotes = ["'", "\""]
        .into_iter()
        .find(|quote| !value.contains(quote) && !value.contains(['\n', '\r']));
    match quotes {
        _ if is_bare => text.extend_from_slice(value.as_bytes()),
        Some(quote) => text.extend_from_slice(format!("{quote}{value}{quote}").as_bytes()),
        // A line of the text that begins with a semicolon would end it.
        None => {
            let value = value.replace("\n;", "\n ;");
            text.extend_from_slice(format!("\n;{value}\n;\n").as_bytes());
        }
    }
}

/// A category that is read.
struct Table {
    /// The name of its block, if it is the first of it.
    block: Option<String>,
    name: String,
    rows: usize,
    names: Vec<String>,
    columns: Vec<Decoded>,
}

impl Table {
    fn new(category: &Category) -> Result<Self, String> {
        let rows = category.row_count;
        let columns = category.columns.iter().map(|column| Decoded::new(column, rows));
        Ok(Self {
            block: None,
            name: category.name.to_owned(),
            rows,
            names: category.columns.iter().map(|column| column.name.to_owned()).collect(),
            columns: columns.collect::<Result<_, String>>()?,
        })
    }

    /// Appends what is before the rows.
    fn begin(&self, text: &mut Vec<u8>) {
        if let Some(block) = &self.block {
            text.extend_from_slice(
                format!("data_{}\n", block.replace(char::is_whitespace, "_")).as_bytes(),
            );
        }
        if !ITEMS.contains(&&*self.name) {
            text.extend_from_slice(b"loop_\n");
            self.names.iter().for_each(|name| self.tag(name, text));
        }
    }

    fn tag(&self, name: &str, text: &mut Vec<u8>) {
        text.extend_from_slice(format!("{}.{name}\n", self.name).as_bytes());
    }

    fn row(&self, row: usize, text: &mut Vec<u8>) {
        let is_items = ITEMS.contains(&&*self.name);
        for (name, column) in self.names.iter().zip(&self.columns) {
            if is_items {
                self.tag(name, text);
            }
            column.write(row, text);
            text.push(b' ');
        }
        text.push(b'\n');
    }
}

/// Reader of the text of tables.
struct Text {
    tables: Vec<Table>,
    table: usize,
    row: usize,
    /// Text that is decoded, and how much of it was read.
    pending: Cursor<Vec<u8>>,
}

impl Read for Text {
    fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        if self.pending.position() == self.pending.get_ref().len() as u64 {
            let text = self.pending.get_mut();
            text.clear();
            while let Some(table) = self.tables.get(self.table).filter(|_| text.len() < CHUNK) {
                if self.row == 0 {
                    table.begin(text);
                }
                if self.row < table.rows {
                    table.row(self.row, text);
                    self.row += 1;
                } else {
                    (self.table, self.row) = (self.table + 1, 0);
                }
            }
            self.pending.set_position(0);
        }
        self.pending.read(buffer)
    }
}

/// Returns the tables of a file.
fn tables(bytes: &[u8]) -> Result<Vec<Table>, String> {
    let file: File = rmp_serde::from_slice(bytes).map_err(|error| error.to_string())?;
    let mut tables = Vec::new();
    for block in &file.data_blocks {
        let mut header = Some(block.header.to_owned());
        for name in CATEGORIES {
            for category in
                block.categories.iter().filter(|own| own.name == name && own.row_count > 0)
            {
                tables.push(Table { block: header.take(), ..Table::new(category)? });
            }
        }
    }
    Ok(tables)
}

/// Returns the source of a file's text.
pub(in super::super) fn decoded(source: Source) -> Result<Source, FileError> {
    let Source { path, head, reader, progress } = source;
    let fault = |message: String| FileError::whole_file(&path, message);
    let limit = memory::left().map_or(MOST, |left| left.bytes);
    let bytes = memory::read_at_most(Cursor::new(head).chain(reader), limit)
        .map_err(|error| fault(format!("cannot be read: {error}")))?;
    let tables = tables(&bytes).map_err(|message| {
        let help = "the file is cut off or damaged: copy it again";
        FileError { cut_off: true, ..fault(format!("is damaged: {message}")) }.with_help(help)
    })?;
    let text = Text { tables, table: 0, row: 0, pending: Cursor::default() };
    let mut reader = Bytes::stream(text);
    let head = source::head(&mut reader).map_err(|error| fault(error.to_string()))?;
    Ok(Source { path, head, reader, progress })
}

/// Returns whether a file with this head is BinaryCIF: a map of MessagePack with its keys.
pub(in super::super) fn is_binary(head: &[u8]) -> bool {
    let start = &head[..head.len().min(256)];
    let is_map = start.first().is_some_and(|&byte| byte & 0xF0 == 0x80 || byte == 0xDE);
    let has = |key: &[u8]| memchr::memmem::find(start, key).is_some();
    is_map && (has(b"encoder") || has(b"dataBlocks"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn whole_of(bytes: &[u8], encoding: &[Encoding]) -> Result<Vec<i32>, String> {
        decode(bytes, encoding).and_then(whole)
    }

    #[test]
    fn steps_are_undone_from_the_last() {
        let bytes = |r#type| Encoding::ByteArray { r#type };
        assert_eq!(whole_of(&[1, 0xFF, 0x7F], &[bytes(1)]), Ok(vec![1, -1, 127]));
        let packing = Encoding::IntegerPacking { byte_count: 1, is_unsigned: false };
        let packed = [1, 0x7F, 3, 0x80, 0x80, 0xFF];
        assert_eq!(whole_of(&packed, &[packing, bytes(1)]), Ok(vec![1, 130, -257]));
        let packing = Encoding::IntegerPacking { byte_count: 1, is_unsigned: true };
        assert_eq!(whole_of(&[255, 0, 7], &[packing, bytes(4)]), Ok(vec![255, 7]));
        let runs =
            |src_size| [Encoding::Delta { origin: 10 }, Encoding::RunLength { src_size }, bytes(4)];
        assert_eq!(whole_of(&[1, 3, 0, 2], &runs(5)), Ok(vec![11, 12, 13, 13, 13]));
        assert!(whole_of(&[1, 3, 0, 2], &runs(6)).is_err());
        let Ok(Values::Real(values)) =
            decode(&[0x39, 0x30, 0, 0], &[Encoding::FixedPoint { factor: 1000.0 }, bytes(3)])
        else {
            panic!("not real");
        };
        assert_eq!(values, [12.345]);
        assert!(whole_of(&[0xFF; 4], &[bytes(6)]).is_err() && whole_of(&[1], &[]).is_err());
        assert!(whole_of(&[1], &[bytes(1), bytes(1)]).is_err());
    }

    #[test]
    fn texts_keep_their_content_in_quotes() {
        for (value, expected) in [
            ("CA", "CA"),
            ("O5'", "O5'"),
            ("", "''"),
            ("a b", "'a b'"),
            ("5' end", "\"5' end\""),
            ("_x", "'_x'"),
            ("Data_1", "'Data_1'"),
            ("?", "'?'"),
            ("a' \"b", "\n;a' \"b\n;\n"),
            ("a\n;b", "\n;a\n ;b\n;\n"),
        ] {
            let mut text = Vec::new();
            quote(value, &mut text);
            assert_eq!(String::from_utf8_lossy(&text), expected);
        }
    }
}
