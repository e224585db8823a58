//! Reads MDL molfiles and SDF, versions V2000 and V3000: molecules, one frame each, in angstrom ("CT file
//! Formats", BIOVIA 2020).

use crate::bonds::{Listed, row_from_one};
use crate::fields::{Fields, fixed};
use crate::lines::{Line, Lines};
use crate::{
    Bonds, FileError, Format, LengthUnit, ParticleFrame, ReadOptions, builder::Builder,
    frame_reader::FrameReader, number, place::Place, schema::Schema, source::Source,
};
use std::sync::Arc;

/// Names of the columns.
const NAMES: [&str; 4] = ["x", "y", "z", "element"];

/// Number of lines before the counts.
const HEADER: usize = 3;

/// The line that ends a molecule of an SDF file.
const END: &[u8] = b"$$$$";

/// Beginnings of rows in version V3000.
const V3000: &[u8] = b"M  V30 ";

/// Number of bytes after which a row of version V3000 is not continued.
const LONGEST: usize = 1 << 16;

/// Reader of the molecules of a file.
pub(crate) struct Molfile {
    lines: Lines,
    schema: Result<Arc<Schema>, String>,
    reads_bonds: bool,
    /// A row of version V3000 that several lines make up.
    joined: Vec<u8>,
}

impl Molfile {
    pub(crate) fn new(source: Source, options: &ReadOptions) -> Self {
        let schema = Schema::new(NAMES.map(str::to_owned).into(), options);
        let reads_bonds = options.reads_bonds();
        let joined = Vec::new();
        Self { lines: Lines::new(source), schema: schema.map(Arc::new), reads_bonds, joined }
    }

    /// Reads the header: the title, and the numbers of atoms and bonds, which version V3000 has elsewhere.
    /// Returns `None` at the end of the file.
    fn header(&mut self) -> Result<Option<(String, Option<Counts>)>, FileError> {
        let Some(title) = self.lines.next()? else { return Ok(None) };
        let title = title.text().trim().to_owned();
        self.lines.skip(HEADER as u64 - 1)?;
        let Some(line) = self.lines.next()? else {
            // Blank lines may end a file.
            let blank = title.is_empty();
            return if blank {
                Ok(None)
            } else {
                Err(self.lines.ended("the file ends before its counts"))
            };
        };
        if line.bytes.trim_ascii_end().ends_with(b"V3000") {
            return Ok(Some((title, None)));
        }
        let atoms = line.whole_number(line.bytes.get(..3).unwrap_or(line.bytes))?;
        let bonds = if self.reads_bonds { line.whole_number(fixed(line.bytes, 3, 6))? } else { 0 };
        Ok(Some((title, Some(Counts { atoms, bonds }))))
    }

    /// Returns the next line; in version V3000 with those that continue it, which follow a `-` at the end.
    fn row(&mut self) -> Result<Option<Line<'_>>, FileError> {
        let is_continued = |line: &Line| {
            line.bytes.starts_with(V3000) && line.bytes.trim_ascii_end().ends_with(b"-")
        };
        let Some(line) = self.lines.next()?.filter(is_continued) else {
            self.lines.back();
            return self.lines.next();
        };
        let number = line.number_in_file();
        self.joined.clear();
        self.joined.extend_from_slice(line.bytes.trim_ascii_end());
        while self.joined.last() == Some(&b'-') && self.joined.len() < LONGEST {
            self.joined.pop();
            let Some(line) = self.lines.next()? else { break };
            self.joined.extend_from_slice(
                line.bytes.strip_prefix(V3000).unwrap_or(line.bytes).trim_ascii_end(),
            );
        }
        Ok(Some(Line::new(self.lines.path(), number, &self.joined)))
    }

    /// Finds the rows of atoms of version V3000, and returns their number.
    fn extended(&mut self) -> Result<u64, FileError> {
        let mut count = None;
        while let Some(line) = self.row()? {
            let mut words =
                line.bytes.strip_prefix(V3000).map(Fields::blanks).into_iter().flatten();
            match (words.next(), words.next()) {
                (Some(b"COUNTS"), Some(atoms)) => count = Some(line.whole_number(atoms)?),
                (Some(b"BEGIN"), Some(b"ATOM")) => break,
                _ if line.bytes == END => break,
                _ => (),
            }
        }
        count.ok_or_else(|| self.lines.ended("the molecule has no COUNTS of atoms"))
    }

    /// Reads the rows of bonds: the numbers of both atoms, and the type. Version V3000 has them between
    /// `BEGIN BOND` and `END BOND`.
    fn bonds(&mut self, atoms: usize, plain: Option<u64>) -> Result<Bonds, FileError> {
        let path = self.lines.path().clone();
        let mut bonds = Listed::default();
        let mut rest = plain;
        let mut inside = plain.is_some();
        while rest != Some(0) {
            let Some(line) = self.row()? else {
                return if plain.is_none() {
                    Ok(bonds.finish())
                } else {
                    Err(self.lines.ended("the file ends before the last bond"))
                };
            };
            let wrong = || {
                let help = "a row is the numbers of two atoms and a type in three columns each, or \
                            `M  V30 index type atom atom`";
                line.whole("not the columns of a bond").with_help(help)
            };
            let fields = if let Some(rest) = &mut rest {
                *rest -= 1;
                [(6, 9), (0, 3), (3, 6)].map(|(start, end)| fixed(line.bytes, start, end))
            } else {
                let row = line.bytes.strip_prefix(V3000);
                let words: Vec<&[u8]> = row.map(Fields::blanks).into_iter().flatten().collect();
                match words[..] {
                    [b"BEGIN", b"BOND"] => inside = true,
                    [b"END", b"BOND" | b"CTAB"] => break,
                    _ if line.bytes.trim_ascii_end() == END => {
                        self.lines.back();
                        break;
                    }
                    _ => (),
                }
                match words[..] {
                    [b"BEGIN", ..] => continue,
                    [_, kind, first, second, ..] if inside => [kind, first, second],
                    _ if inside => return Err(wrong()),
                    _ => continue,
                }
            };
            let [kind, first, second] = fields;
            if fields.iter().any(|field| field.is_empty()) {
                return Err(wrong());
            }
            let row = |field| row_from_one(&line, field, atoms);
            if let Some([first, second]) = bonds.ends([row(first)?, row(second)?]) {
                bonds.push_named(&path, (first, second, [0; 3]), kind)?;
            }
        }
        Ok(bonds.finish())
    }

    /// Moves past the end of a molecule.
    fn finish(&mut self) -> Result<(), FileError> {
        while let Some(line) = self.lines.next()? {
            if line.bytes.trim_ascii_end() == END {
                break;
            }
        }
        Ok(())
    }
}

/// Numbers of atoms and bonds in a header.
#[derive(Clone, Copy)]
struct Counts {
    atoms: u64,
    bonds: u64,
}

/// Returns the position and symbol of a row: in fixed columns, or after an index in version V3000.
fn fields<'l>(line: &Line<'l>, extended: bool) -> Result<[&'l [u8]; 4], FileError> {
    let wrong = || {
        let help =
            "a row is x, y and z in ten columns each, and a symbol, or `M  V30 index symbol x y z`";
        line.whole("not the columns of an atom").with_help(help)
    };
    if extended {
        let words = line.bytes.strip_prefix(V3000).map(Fields::blanks).into_iter().flatten();
        let words: Vec<&[u8]> = words.skip(1).take(4).collect();
        let [symbol, x, y, z] = words.try_into().map_err(|_| wrong())?;
        return Ok([x, y, z, symbol]);
    }
    let part = |start: usize, end: usize| fixed(line.bytes, start, end);
    let fields = [part(0, 10), part(10, 20), part(20, 30), part(31, 34)];
    if fields.iter().any(|field| field.is_empty()) { Err(wrong()) } else { Ok(fields) }
}

/// Returns whether a row is that of an atom: a position with decimals, and a symbol.
fn is_atom(line: &Line, extended: bool) -> bool {
    let is_number = |field: &[u8]| field.contains(&b'.') && number::parse(field).is_some();
    fields(line, extended).is_ok_and(|fields| {
        fields[..3].iter().all(|field| is_number(field)) && !is_number(fields[3])
    })
}

impl FrameReader for Molfile {
    fn next(&mut self) -> Result<Option<ParticleFrame>, FileError> {
        let schema = self.schema.clone().map_err(|message| self.lines.ended(message))?;
        let Some((title, plain)) = self.header()? else { return Ok(None) };
        let count = match plain {
            Some(counts) => counts.atoms,
            None => self.extended()?,
        };
        let mut builder = Builder::new(self.lines.path(), Format::Sdf, &schema);
        for atom in 0..count {
            let Some(line) = self.row()? else {
                let message = format!("the file ends after {atom} of {count} atoms");
                return Err(self.lines.ended(message).with_help("the file is cut off"));
            };
            builder.row(&line, fields(&line, plain.is_none())?.into_iter())?;
        }
        let is_extended = plain.is_none();
        let is_more = self.row()?.is_some_and(|line| is_atom(&line, is_extended));
        self.lines.back();
        if is_more {
            builder.warn_of_more_rows();
            self.finish()?;
            let frame = builder.finish();
            return Ok(Some(ParticleFrame { title, unit: LengthUnit::Angstrom, ..frame }));
        }
        let bonds = if self.reads_bonds {
            Some(self.bonds(builder.frame.len(), plain.map(|counts| counts.bonds))?)
        } else {
            None
        };
        self.finish()?;
        Ok(Some(ParticleFrame { bonds, title, unit: LengthUnit::Angstrom, ..builder.finish() }))
    }

    fn skip(&mut self) -> Result<bool, FileError> {
        let there = self.header()?.is_some();
        self.finish()?;
        Ok(there)
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

/// Returns whether the fourth line has the numbers of atoms and bonds, in three columns each, and the
/// version.
pub(crate) fn is_molfile(head: &[u8]) -> bool {
    let lines = head.split(|&byte| byte == b'\n').map(<[u8]>::trim_ascii_end);
    let Some(counts) = { lines }.nth(HEADER) else { return false };
    let is_count = |field: Option<&[u8]>| field.is_some_and(|field| number::whole(field).is_some());
    let version = counts.ends_with(b"V2000") || counts.ends_with(b"V3000");
    let end = memchr::memmem::find(head, b"\nM  END").is_some();
    is_count(counts.get(..3)) && is_count(counts.get(3..6)) && (version || end)
}
