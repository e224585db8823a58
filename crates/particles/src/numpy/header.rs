//! Parses the header of an array: the type of its elements, its shape and order.

use crate::scalar::{Order, Scalar};

/// Maximum length of a row with texts, in bytes.
pub(super) const ROW: usize = 1 << 24;

/// A number or text in each row.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Field {
    pub(super) name: String,
    pub(super) kind: Item,
}

/// The type of an element.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Item {
    Number(Scalar, Order),
    /// Text of at most this many bytes, padded with zeros.
    Bytes(usize),
    /// Text of at most this many code points of four bytes, padded with zeros.
    Letters(usize, Order),
}

impl Item {
    pub(super) fn size(self) -> usize {
        match self {
            Self::Number(scalar, _) => scalar.size(),
            Self::Bytes(count) => count,
            Self::Letters(count, _) => 4 * count,
        }
    }

    pub(super) fn is_text(self) -> bool {
        !matches!(self, Self::Number(..))
    }

    /// Returns the number; NaN for a text, which is written to `text`.
    pub(super) fn read(self, bytes: &[u8], text: Option<&mut String>) -> f64 {
        let Some(text) = text else {
            return match self {
                Self::Number(scalar, order) => scalar.read(bytes, order),
                _ => f64::NAN,
            };
        };
        text.clear();
        match self {
            Self::Number(scalar, order) => return scalar.read(bytes, order),
            Self::Bytes(_) => text.push_str(&String::from_utf8_lossy(bytes)),
            Self::Letters(_, order) => text.extend(bytes.chunks_exact(4).map(|letter| {
                let code = Scalar::U32.read(letter, order) as u32;
                char::from_u32(code).unwrap_or(char::REPLACEMENT_CHARACTER)
            })),
        }
        text.truncate(text.trim_end_matches('\0').len());
        f64::NAN
    }
}

/// Returns the text after a key of a header.
pub(super) fn after<'h>(header: &'h str, key: &str) -> Option<&'h str> {
    let rest = header.split_once(&format!("'{key}'"))?.1;
    Some(rest.trim_start().strip_prefix(':')?.trim_start())
}

/// Parses a shape such as `(5, 3)`.
pub(super) fn shape(text: &str) -> Option<Vec<u64>> {
    let inner = text.strip_prefix('(')?.split_once(')')?.0;
    let numbers = inner.split(',').map(|number| number.trim().trim_end_matches('L'));
    numbers.filter(|number| !number.is_empty()).map(|number| number.parse().ok()).collect()
}

/// Returns the fields of a row; true if the array is structured.
pub(super) fn fields(header: &str) -> Result<(Vec<Field>, bool), String> {
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
    // Parentheses within a tuple are subarrays.
    if list.contains("((")
        || list.contains(", (") && list.matches('(').count() != list.matches("('").count()
    {
        return Err("has columns that hold arrays".to_owned());
    }
    Ok((fields, true))
}

/// Parses a type such as `<f4`.
fn field(name: &str, kind: &str) -> Result<Field, String> {
    let unknown = || {
        format!(
            "has numbers of the type `{kind}`, but types are f4, f8, i1 to i8, u1 to u8, S and U"
        )
    };
    let named = |kind: Item| Field { name: name.to_owned(), kind };
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
        other => {
            let length = |count: &str| count.parse().ok().filter(|count| (1..=ROW).contains(count));
            let text = other.split_at_checked(1).and_then(|(kind, count)| match kind {
                "S" => Some(Item::Bytes(length(count)?)),
                "U" => Some(Item::Letters(length(count)?, order)),
                _ => None,
            });
            return text.map(named).ok_or_else(unknown);
        }
    };
    Ok(named(Item::Number(scalar, order)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn headers_are_read() {
        let header = "{'descr': '>f4', 'fortran_order': False, 'shape': (6912, 3), }";
        assert_eq!(after(header, "shape").and_then(shape), Some(vec![6912, 3]));
        let (plain, structured) = fields(header).expect("a type");
        assert_eq!((plain[0].kind, structured), (Item::Number(Scalar::F32, Order::Big), false));
        let header =
            "{'descr': [('x', '<f8'), ('id', '|u1')], 'fortran_order': False, 'shape': (2,)}";
        let (columns, structured) = fields(header).expect("types");
        let byte = Item::Number(Scalar::U8, Order::Little);
        assert_eq!((columns[1].name.as_str(), columns[1].kind), ("id", byte));
        assert!(structured);
        assert_eq!(after(header, "shape").and_then(shape), Some(vec![2]));
        for kind in ["<c16", "|O", "<U", "|S0", "<U99999999", "|S1\u{e4}", "", "f4"] {
            assert!(field("", kind).is_err(), "{kind}");
        }
        assert!(fields("{'descr': [('p', '<f8', (3,))]}").is_err());
    }
}
