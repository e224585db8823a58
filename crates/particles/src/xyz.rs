//! Reads XYZ of chemistry and extended XYZ: element symbols, and positions in angstrom.
//!
//! The crate `extxyz` isn't used: it stores a map of values for each atom. The comment of extended XYZ
//! has pairs `key=value` (github.com/libAtoms/extxyz); `Lattice`, `Origin`, `pbc` and `Properties` are
//! read.

use crate::lines::{Line, Lines};
use crate::schema::{Naming, Schema};
use crate::{
    Cell, FileError, Format, LengthUnit, ParticleFrame, ReadOptions, Role, builder::Builder,
    frame_reader::FrameReader, number, options::component_names, place::Place, source::Source,
};
use glam::DVec3;
use std::sync::Arc;

/// Maximum number of columns in `Properties`.
const COLUMNS: usize = 10_000;

/// Roles of extended XYZ's columns with unusual names.
const KNOWN: [(Role, &str); 6] = [
    (Role::X, "pos_x"),
    (Role::Y, "pos_y"),
    (Role::Z, "pos_z"),
    (Role::Red, "color_x"),
    (Role::Green, "color_y"),
    (Role::Blue, "color_z"),
];

/// Reader of the frames of XYZ.
pub(crate) struct Xyz {
    lines: Lines,
    options: ReadOptions,
}

impl Xyz {
    pub(crate) fn new(source: Source, options: &ReadOptions) -> Self {
        Self { lines: Lines::new(source), options: options.clone() }
    }

    /// Reads the number of atoms after blank lines and comments; returns `None` at the end of the file.
    fn count(&mut self) -> Result<Option<u64>, FileError> {
        while let Some(line) = self.lines.next()? {
            if !line.is_blank() && !line.bytes.starts_with(b"#") {
                return number::whole(line.bytes).map(Some).ok_or_else(|| {
                    let text = line.text();
                    line.whole(format!("`{}` is not a number of atoms", text.trim())).with_help(
                        "a frame of an XYZ file begins with the number of its atoms, a comment",
                    )
                });
            }
        }
        Ok(None)
    }

    /// Reads the comment, and returns the columns of the `count` following rows.
    fn head(&mut self, count: u64) -> Result<(Comment, Arc<Schema>), FileError> {
        let comment = match self.lines.next()? {
            Some(line) => Comment::new(&line, &self.options)?,
            None => return Err(self.lines.ended("the file ends before the comment line")),
        };
        if let Some(schema) = &comment.schema {
            let schema = schema.clone();
            return Ok((comment, schema));
        }
        // The line after a frame without atoms begins the next frame.
        let first = if count > 0 { self.lines.next()? } else { None };
        let schema = match first {
            Some(line) => plain(&line, &self.options)?,
            None => Schema::new(["x", "y", "z"].map(str::to_owned).into(), &ReadOptions::default())
                .map_err(|message| self.lines.ended(message))?,
        };
        if count > 0 {
            self.lines.back();
        }
        let naming = if comment.has_types { Naming::Types } else { schema.naming };
        Ok((comment, Arc::new(Schema { naming, ..schema })))
    }
}

impl FrameReader for Xyz {
    fn next(&mut self) -> Result<Option<ParticleFrame>, FileError> {
        let Some(count) = self.count()? else { return Ok(None) };
        let (comment, schema) = self.head(count)?;
        let mut builder = Builder::new(self.lines.path(), Format::Xyz, &schema);
        for atom in 0..count {
            let help = "the file is cut off, or its first line wrong";
            let line = self.lines.row(atom, count, "atoms", help)?;
            if atom == 0 && comment.schema.is_some() {
                builder.warn_of_surplus(line.fields().count());
            }
            builder.row(&line, line.fields())?;
        }
        let frame = builder.finish();
        Ok(Some(ParticleFrame {
            title: comment.title,
            cell: comment.cell,
            step: comment.step,
            time: comment.time,
            unit: LengthUnit::Angstrom,
            ..frame
        }))
    }

    fn skip(&mut self) -> Result<bool, FileError> {
        let Some(count) = self.count()? else { return Ok(false) };
        let lines = count.saturating_add(1);
        Ok(self.lines.skip(lines)? == lines)
    }

    fn more(&mut self) -> Result<bool, FileError> {
        self.lines.more()
    }

    fn place(&self) -> Option<Place> {
        self.lines.place()
    }

    fn start_at(&mut self, place: &Place) -> Result<bool, FileError> {
        self.lines.start_at(place)
    }
}

/// Returns the columns of plain XYZ: a symbol and a position, or only a position in three columns.
fn plain(line: &Line, options: &ReadOptions) -> Result<Schema, FileError> {
    let columns = line.fields().count();
    let first = line.fields().next().unwrap_or_default();
    let bare = columns == 3 && number::parse(first).is_some();
    let named: &[&str] = if bare { &["x", "y", "z"] } else { &["species", "x", "y", "z"] };
    if columns < named.len() {
        return Err(line.whole("an atom is `symbol x y z`"));
    }
    let more = (named.len() + 1..=columns).map(|column| column.to_string());
    let names = named.iter().map(|name| (*name).to_owned()).chain(more).collect();
    Schema::new(names, options).map_err(|error| line.whole(error))
}

/// Contents of the second line of a frame.
struct Comment {
    title: String,
    cell: Option<Cell>,
    step: Option<i64>,
    time: Option<f64>,
    schema: Option<Arc<Schema>>,
    /// True if numbers are types, as LAMMPS writes them, not elements.
    has_types: bool,
}

impl Comment {
    fn new(line: &Line, options: &ReadOptions) -> Result<Self, FileError> {
        let text = line.text();
        let pairs = pairs(&text);
        let value = |key: &str| {
            let pair = pairs.iter().find(|(own, _)| own.eq_ignore_ascii_case(key));
            pair.map(|(_, value)| value.as_str())
        };
        let properties = value("Properties").map(|value| columns(line, value)).transpose()?;
        let schema = properties.map(|names| schema(line, names, options)).transpose()?;
        let lattice = value("Lattice").map(|value| numbers::<9>(line, "Lattice", value));
        let origin = value("Origin").map(|value| numbers::<3>(line, "Origin", value));
        let cell = lattice.transpose()?.map(|lattice| Cell {
            origin: DVec3::ZERO,
            vectors: [0, 3, 6].map(|row| DVec3::from_slice(&lattice[row..row + 3])),
            periodic: [true; 3],
        });
        let periodic = value("pbc").map_or(Ok([true; 3]), |value| periodic(line, value))?;
        let origin = origin.transpose()?.map_or(DVec3::ZERO, DVec3::from_array);
        let cell = cell.and_then(|cell| Cell { origin, periodic, ..cell }.declared());
        let lammps = text.strip_prefix("Atoms. Timestep:").map(str::trim);
        let step = lammps.or_else(|| value("Step")).or_else(|| value("Timestep"));
        Ok(Self {
            title: text.trim().to_owned(),
            cell,
            step: step.and_then(|step| step.parse().ok()),
            time: value("Time").and_then(|time| time.parse().ok()),
            schema: schema.map(Arc::new),
            has_types: lammps.is_some(),
        })
    }
}

fn schema(line: &Line, names: Vec<String>, options: &ReadOptions) -> Result<Schema, FileError> {
    let kind = ["species", "element", "Z", "type"];
    let kind = kind.into_iter().find(|kind| names.iter().any(|name| name == kind));
    let known: Vec<(Role, &str)> =
        KNOWN.into_iter().chain(kind.map(|kind| (Role::Kind, kind))).collect();
    Schema::with_roles(names, options, &known).map_err(|error| {
        line.whole(error).with_help("Properties must have pos:R:3, such as species:S:1:pos:R:3")
    })
}

/// Returns the names of the columns in `Properties`: `name:type:count`, and so on.
fn columns(line: &Line, value: &str) -> Result<Vec<String>, FileError> {
    let fault = || {
        let message = format!("invalid Properties `{value}`");
        line.whole(message).with_help("properties are name:type:count, such as pos:R:3")
    };
    let parts: Vec<&str> = value.split(':').collect();
    let mut names = Vec::new();
    for property in parts.chunks(3) {
        let [name, kind, count] = property else { return Err(fault()) };
        let count: usize = count.trim().parse().map_err(|_| fault())?;
        if !["S", "R", "I", "L"].contains(kind) {
            return Err(fault());
        }
        if count > COLUMNS - names.len() {
            let message = format!("`{name}:{kind}:{count}` makes more than {COLUMNS} columns");
            return Err(line.whole(message).with_help("the count of a property is wrong"));
        }
        names.extend(component_names(name, count));
    }
    Ok(names)
}

fn numbers<const COUNT: usize>(
    line: &Line,
    key: &str,
    value: &str,
) -> Result<[f64; COUNT], FileError> {
    let fields = value.split(|letter: char| letter.is_whitespace() || ",[]".contains(letter));
    let fields = fields.filter(|field| !field.is_empty());
    let numbers: Option<Vec<f64>> = fields.map(|field| number::parse(field.as_bytes())).collect();
    let numbers = numbers.and_then(|numbers| numbers.try_into().ok());
    numbers.ok_or_else(|| {
        let example = ["0 0 0", "5 0 0 0 5 0 0 0 5"][usize::from(COUNT > 3)];
        let help = format!("write the numbers in quotes, as in {key}=\"{example}\"");
        line.whole(format!("{key} is `{value}`, but must be {COUNT} numbers")).with_help(help)
    })
}

/// Parses boundary conditions such as `T T F`, or one for all edges.
fn periodic(line: &Line, value: &str) -> Result<[bool; 3], FileError> {
    let letters = |letter: char| letter.is_whitespace() || ",[]".contains(letter);
    let fields = value.split(letters).filter(|field| !field.is_empty());
    let flags: Option<Vec<bool>> = fields
        .map(|field| match field.as_bytes()[0] {
            b'T' | b't' | b'1' => Some(true),
            b'F' | b'f' | b'0' => Some(false),
            _ => None,
        })
        .collect();
    match flags.as_deref() {
        Some([a, b, c]) => Ok([*a, *b, *c]),
        Some([all]) => Ok([*all; 3]),
        _ => {
            let message = format!("pbc is `{value}`, but must be T or F for each of three edges");
            Err(line.whole(message).with_help("write them in quotes, as in pbc=\"T T F\""))
        }
    }
}

/// Returns all `key=value` pairs of a comment, in order; quoted values may contain blanks.
pub fn pairs(text: &str) -> Vec<(String, String)> {
    let mut pairs = Vec::new();
    let mut letters = text.chars().peekable();
    while letters.peek().is_some() {
        let key = word(&mut letters, |letter| letter == '=' || letter.is_whitespace());
        if letters.next_if_eq(&'=').is_some() {
            let value = word(&mut letters, char::is_whitespace);
            pairs.push((key, value));
        }
        while letters.next_if(|letter| letter.is_whitespace()).is_some() {}
    }
    pairs
}

/// Reads a word up to a terminating character, or a quoted or bracketed one.
fn word(letters: &mut std::iter::Peekable<std::str::Chars>, ends: impl Fn(char) -> bool) -> String {
    let pairs = [('"', '"'), ('\'', '\''), ('{', '}'), ('[', ']')];
    let close = letters.peek().and_then(|open| pairs.iter().find(|(own, _)| own == open));
    let mut word = String::new();
    let Some(&(_, close)) = close else {
        while let Some(letter) = letters.next_if(|&letter| !ends(letter)) {
            word.push(letter);
        }
        return word;
    };
    letters.next();
    while let Some(letter) = letters.next().filter(|&letter| letter != close) {
        let letter = if letter == '\\' { letters.next().unwrap_or(letter) } else { letter };
        word.push(letter);
    }
    word
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    #[test]
    fn properties_may_make_ten_thousand_columns() {
        let path = Path::new("p").into();
        let line = Line::new(&path, 2, b"");
        let count = |properties: &str| columns(&line, properties).ok().map(|names| names.len());
        assert_eq!(count("q:R:10000"), Some(10_000));
        assert_eq!(count("pos:R:3:q:R:9997"), Some(10_000));
        assert_eq!(count("pos:R:3:q:R:9998"), None);
    }

    #[test]
    fn comments_are_pairs_with_quotes() {
        let text = r#"Lattice="1 0 0" pbc='T F' flag e=-1.5 "odd key"=7 q="a \"b\" c" l=[1, 2] x="#;
        let expected = [
            ("Lattice", "1 0 0"),
            ("pbc", "T F"),
            ("e", "-1.5"),
            ("odd key", "7"),
            ("q", "a \"b\" c"),
            ("l", "1, 2"),
            ("x", ""),
        ];
        let pairs = pairs(text);
        let pairs: Vec<_> =
            pairs.iter().map(|(key, value)| (key.as_str(), value.as_str())).collect();
        assert_eq!(pairs, expected);
        let path = Path::new("p").into();
        let line = Line::new(&path, 2, b"pbc=x");
        let periodic = |value: &str| periodic(&line, value).ok();
        assert_eq!(periodic("T F 0"), Some([true, false, false]));
        assert_eq!(periodic("[True, False, True]"), Some([true, false, true]));
        assert_eq!(periodic("T"), Some([true; 3]));
        for wrong in ["", "T F", "T F F T", "T F yes"] {
            assert_eq!(periodic(wrong), None, "{wrong}");
        }
    }
}
