//! The header of a NetCDF file of the classic formats: with offsets of 32 bits, of 64 bits, and with data of
//! 64 bits (docs.unidata.ucar.edu/netcdf-c/current/file_format_specifications.html).
//!
//! The crate `netcdf3` isn't used: it reads neither the third format nor files that are still being written.

use crate::FileError;
use crate::binary::{BinaryFile, Numbers};
use crate::scalar::{Order, Scalar};

/// Maximum length of a header in bytes.
const LONGEST: u64 = 1 << 24;

/// Tags of lists.
const DIMENSIONS: i32 = 10;
const VARIABLES: i32 = 11;
const ATTRIBUTES: i32 = 12;

/// A dimension: its name, and its length, which is 0 for records.
pub(super) struct Dimension {
    pub(super) name: String,
    pub(super) length: u64,
}

/// An attribute: a text, or its first number.
pub(super) enum Attribute {
    Text(String),
    Number(f64),
    /// It has no value.
    Empty,
}

/// A variable: an array in the file.
pub(super) struct Variable {
    pub(super) name: String,
    /// Indices of its dimensions.
    pub(super) dimensions: Vec<usize>,
    attributes: Vec<(String, Attribute)>,
    /// The type of its numbers; `None` if they are characters.
    pub(super) scalar: Option<Scalar>,
    /// Offset of its first value.
    pub(super) begin: u64,
}

/// A header.
pub(super) struct Header {
    pub(super) dimensions: Vec<Dimension>,
    pub(super) attributes: Vec<(String, Attribute)>,
    pub(super) variables: Vec<Variable>,
    /// Number of records; `None` if the file was still being written.
    pub(super) records: Option<u64>,
}

/// Returns the text of an attribute.
pub(super) fn text<'a>(attributes: &'a [(String, Attribute)], name: &str) -> Option<&'a str> {
    attributes.iter().find(|(own, _)| own == name).and_then(|(_, value)| match value {
        Attribute::Text(text) => Some(text.as_str()),
        _ => None,
    })
}

impl Variable {
    /// Returns the text of an attribute.
    pub(super) fn text(&self, name: &str) -> Option<&str> {
        text(&self.attributes, name)
    }

    /// Returns the factor on its values.
    pub(super) fn scale(&self) -> f64 {
        let factor = self.attributes.iter().find(|(own, _)| own == "scale_factor");
        match factor {
            Some((_, Attribute::Number(factor))) => *factor,
            _ => 1.0,
        }
    }
}

impl Header {
    /// Reads the header of a file.
    pub(super) fn read(file: &mut BinaryFile) -> Result<Self, FileError> {
        let bytes = file.bytes(0, file.length().min(LONGEST))?;
        let fault = |what: &str| {
            let error = file.fault(format!("has a damaged header: {what}"));
            error.with_help("copy the file again; `ncdump -h` shows its header")
        };
        let version = bytes.get(3).copied().unwrap_or(0);
        let rest = bytes.get(4..).unwrap_or_default();
        let mut parser = Parser { numbers: Numbers::new(rest, Order::Big), version };
        let header = parser.header().ok_or_else(|| fault("it ends early, or a count is wrong"))?;
        let known = |variable: &Variable| {
            variable.dimensions.iter().all(|&dimension| dimension < header.dimensions.len())
        };
        if !header.variables.iter().all(known) {
            return Err(fault("a variable has a dimension that is not there"));
        }
        Ok(header)
    }
}

struct Parser<'b> {
    numbers: Numbers<'b>,
    version: u8,
}

impl Parser<'_> {
    fn header(&mut self) -> Option<Header> {
        // All bits are set while records are written.
        let records = match self.version {
            5 => self.long().filter(|&count| count != u64::MAX),
            _ => self.numbers.count(),
        };
        let dimensions = self.list(DIMENSIONS, |parser| {
            Some(Dimension { name: parser.name()?, length: parser.length()? })
        })?;
        let attributes = self.list(ATTRIBUTES, Self::attribute)?;
        let variables = self.list(VARIABLES, Self::variable)?;
        Some(Header { dimensions, attributes, variables, records })
    }

    /// Returns a whole number of 64 bits.
    fn long(&mut self) -> Option<u64> {
        self.numbers.take(8)?.first_chunk().map(|bytes| u64::from_be_bytes(*bytes))
    }

    /// Returns a count, whose width depends on the version.
    fn length(&mut self) -> Option<u64> {
        if self.version == 5 { self.long() } else { self.numbers.count() }
    }

    /// Returns a list with a tag and a count; an empty one has the tag 0.
    fn list<T>(&mut self, tag: i32, item: impl Fn(&mut Self) -> Option<T>) -> Option<Vec<T>> {
        let own = self.numbers.i32()?;
        let count = self.length()?;
        if own != tag && (own != 0 || count != 0) {
            return None;
        }
        let mut items = Vec::new();
        for _ in 0..count {
            items.push(item(self)?);
        }
        Some(items)
    }

    /// Returns bytes, which are padded to a multiple of four.
    fn padded(&mut self, length: u64) -> Option<&[u8]> {
        let whole = usize::try_from(length.checked_next_multiple_of(4)?).ok()?;
        self.numbers.take(whole)?.get(..length as usize)
    }

    fn name(&mut self) -> Option<String> {
        let length = self.length()?;
        Some(String::from_utf8_lossy(self.padded(length)?).into_owned())
    }

    fn attribute(&mut self) -> Option<(String, Attribute)> {
        let name = self.name()?;
        let kind = kind(self.numbers.i32()?)?;
        let count = self.length()?;
        let value = match kind {
            Kind::Characters => {
                let text = String::from_utf8_lossy(self.padded(count)?);
                Attribute::Text(text.trim_end_matches('\0').to_owned())
            }
            Kind::Numbers(scalar) => {
                let bytes = self.padded(count.checked_mul(scalar.size() as u64)?)?;
                let empty = bytes.is_empty();
                if empty {
                    Attribute::Empty
                } else {
                    Attribute::Number(scalar.read(bytes, Order::Big))
                }
            }
        };
        Some((name, value))
    }

    fn variable(&mut self) -> Option<Variable> {
        let name = self.name()?;
        let mut dimensions = Vec::new();
        for _ in 0..self.length()? {
            dimensions.push(usize::try_from(self.length()?).ok()?);
        }
        let attributes = self.list(ATTRIBUTES, Self::attribute)?;
        let scalar = match kind(self.numbers.i32()?)? {
            Kind::Characters => None,
            Kind::Numbers(scalar) => Some(scalar),
        };
        // The size follows from the dimensions; where they are large, it is wrong.
        self.length()?;
        let begin = if self.version == 1 { self.numbers.count()? } else { self.long()? };
        Some(Variable { name, dimensions, attributes, scalar, begin })
    }
}

/// Type of values.
enum Kind {
    Characters,
    Numbers(Scalar),
}

/// Returns the type with this number, if there is one.
fn kind(number: i32) -> Option<Kind> {
    let scalar = match number {
        2 => return Some(Kind::Characters),
        1 => Scalar::I8,
        3 => Scalar::I16,
        4 => Scalar::I32,
        5 => Scalar::F32,
        6 => Scalar::F64,
        7 => Scalar::U8,
        8 => Scalar::U16,
        9 => Scalar::U32,
        10 => Scalar::I64,
        11 => Scalar::U64,
        _ => return None,
    };
    Some(Kind::Numbers(scalar))
}
