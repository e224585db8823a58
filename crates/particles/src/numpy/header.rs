//! Parses the header of an array: the type of its elements, its shape and order.

use crate::options::component_names;
use crate::scalar::{Order, Scalar};

/// Maximum length of a row with texts, in bytes.
pub(super) const ROW: usize = 1 << 24;

/// Maximum number of columns of an array.
pub(super) const COLUMNS: usize = 10_000;

/// Maximum depth of structures in structures.
const DEPTH: usize = 8;

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
    let mut descr = Descr { rest: descr };
    let mut fields = Vec::new();
    descr.list("", 0, &mut fields)?;
    Ok((fields, true))
}

/// The description of a structured type: a list of names and types, as Python writes it.
struct Descr<'h> {
    rest: &'h str,
}

impl<'h> Descr<'h> {
    /// Takes a mark, if it is next.
    fn has(&mut self, mark: char) -> bool {
        let rest = self.rest.trim_start().strip_prefix(mark);
        self.rest = rest.unwrap_or(self.rest);
        rest.is_some()
    }

    /// Takes a mark that must be next.
    fn need(&mut self, mark: char) -> Result<(), String> {
        let rest: String = self.rest.chars().take(40).collect();
        let wrong = || format!("has columns of a type that is not read: {rest}");
        self.has(mark).then_some(()).ok_or_else(wrong)
    }

    fn text(&mut self) -> Result<&'h str, String> {
        self.need('\'')?;
        let (text, rest) = self.rest.split_once('\'').unwrap_or((self.rest, ""));
        self.rest = rest;
        Ok(text)
    }

    /// Takes the name of a field; a title may precede it.
    fn name(&mut self) -> Result<&'h str, String> {
        if !self.has('(') {
            return self.text();
        }
        self.text()?;
        self.need(',')?;
        let name = self.text()?;
        self.need(')')?;
        Ok(name)
    }

    /// Takes the shape of an array in a field. Returns its number of elements.
    fn shape(&mut self) -> Result<usize, String> {
        self.need('(')?;
        let (numbers, rest) = self.rest.split_once(')').unwrap_or((self.rest, ""));
        self.rest = rest;
        let mut numbers = numbers.split(',').map(str::trim).filter(|number| !number.is_empty());
        let count =
            numbers.try_fold(1_usize, |count, number| count.checked_mul(number.parse().ok()?));
        count.ok_or_else(|| format!("has columns of arrays of {COLUMNS} numbers or more"))
    }

    /// Takes a list of fields. Those of structures in them have the names of both, and arrays one for each element.
    fn list(&mut self, outer: &str, depth: usize, fields: &mut Vec<Field>) -> Result<(), String> {
        self.need('[')?;
        if depth > DEPTH {
            return Err(format!("has structures within more than {DEPTH} others"));
        }
        while self.has('(') {
            let name = self.name()?;
            let name = if outer.is_empty() { name.to_owned() } else { format!("{outer}_{name}") };
            self.need(',')?;
            let mut inner = Vec::new();
            if self.rest.trim_start().starts_with('[') {
                self.list(&name, depth + 1, &mut inner)?;
            } else {
                inner.push(field(&name, self.text()?)?);
            }
            let count = if self.has(',') && self.rest.trim_start().starts_with('(') {
                self.shape()?
            } else {
                1
            };
            if inner.len().saturating_mul(count) > COLUMNS - fields.len() {
                return Err(format!("has more than {COLUMNS} columns"));
            }
            match &inner[..] {
                // Names of elements are those of columns of an array.
                [only] => fields.extend(
                    component_names(&name, count)
                        .into_iter()
                        .map(|name| Field { name, ..only.clone() }),
                ),
                _ => (0..count).for_each(|_| fields.extend_from_slice(&inner)),
            }
            self.need(')')?;
            self.has(',');
        }
        self.need(']')
    }
}

/// Parses a type such as `<f4`.
fn field(name: &str, kind: &str) -> Result<Field, String> {
    let unknown = || {
        format!(
            "has numbers of the type `{kind}`, but types are f2 to f8, i1 to i8, u1 to u8, S and U"
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
        "f2" => Scalar::F16,
        "f4" => Scalar::F32,
        "f8" => Scalar::F64,
        other => {
            let length = |count: &str| count.parse().ok().filter(|count| (1..=ROW).contains(count));
            let text = other.split_at_checked(1).and_then(|(kind, count)| match kind {
                // Padding of a structure is a column without a name.
                "S" | "V" => Some(Item::Bytes(length(count)?)),
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
    }

    #[test]
    fn structures_and_arrays_in_fields_are_columns() {
        let names = |descr: &str| {
            let fields = fields(&format!("{{'descr': {descr}, 'shape': (2,)}}"));
            fields.map(|(fields, _)| fields.into_iter().map(|field| field.name).collect::<Vec<_>>())
        };
        for (descr, expected) in [
            ("[('pos', '<f8', (3,)), ('id', '<i4')]", &["pos_x", "pos_y", "pos_z", "id"][..]),
            ("[('q', '<f2', (2, 2)), ('r', '<f4', ()), ]", &["q_1", "q_2", "q_3", "q_4", "r"]),
            ("[('pos', [('x', '<f8'), ('y', '<f8')]), ('', '|V4')]", &["pos_x", "pos_y", ""]),
            ("[(('a title', 'r'), '<f4')]", &["r"]),
            ("[]", &[]),
        ] {
            assert_eq!(names(descr).expect("fields"), expected, "{descr}");
        }
        for wrong in [
            "[('p', '<f8', (3))",
            "[('p', '|O')]",
            "[('p' '<f8')]",
            "[('p', '<f8', (10001,))]",
            "[('p', '<f8', (99999999999, 99999999999))]",
            "[(",
            "['p']",
            &"[('p', ".repeat(20),
        ] {
            assert!(names(wrong).is_err(), "{wrong}");
        }
    }
}
