//! Reads PDB: fixed columns, lengths in angstrom (wwPDB, "Protein Data Bank Contents Guide", version
//! 3.30).
//!
//! The crate `pdbtbx` isn't used: it builds a tree of models, chains and residues, and rejects files of
//! simulations (serial numbers in hexadecimal, hybrid-36 or asterisks). This reader doesn't parse
//! numbers that aren't needed.

use super::alternates::{AlternateAtom, Alternates};
use super::builder::Builder;
use super::categories::Kind;
use super::cell::Cell;
use super::element::{Element, is_virtual_site, of_aligned_name};
use super::frame::{LengthUnit, ParticleFrame};
use super::frame_reader::FrameReader;
use super::lines::{Line, Lines};
use super::number;
use super::options::{Format, ReadOptions, Role};
use super::schema::{Naming, Schema, Slot};
use super::source::Source;
use super::undrawn::Undrawn;
use crate::FileError;
use std::collections::HashSet;
use std::sync::Arc;

/// Names of the columns, with their byte ranges.
const COLUMNS: [(&str, usize, usize); 15] = [
    ("number", 6, 11),
    ("name", 12, 16),
    ("altloc", 16, 17),
    ("residue", 17, 21),
    ("chain", 21, 22),
    ("residue_number", 22, 26),
    ("insertion", 26, 27),
    ("x", 30, 38),
    ("y", 38, 46),
    ("z", 46, 54),
    ("occupancy", 54, 60),
    ("b_factor", 60, 66),
    ("segment", 72, 76),
    ("element", 76, 78),
    ("charge", 78, 80),
];

/// Columns of texts, even if the texts look like numbers.
const TEXTS: [&str; 10] = [
    "number",
    "name",
    "altloc",
    "residue",
    "chain",
    "residue_number",
    "insertion",
    "segment",
    "element",
    "charge",
];

/// Record names that identify a PDB file.
const RECORDS: [&[u8]; 18] = [
    b"HEADER", b"OBSLTE", b"TITLE ", b"COMPND", b"SOURCE", b"KEYWDS", b"EXPDTA", b"AUTHOR",
    b"REMARK", b"CRYST1", b"ORIGX1", b"SCALE1", b"MODEL ", b"ATOM  ", b"HETATM", b"SPLIT ",
    b"CAVEAT", b"NUMMDL",
];

/// Reader of the models of a PDB file, one frame each.
pub(crate) struct Pdb {
    lines: Lines,
    schema: Result<Arc<Schema>, String>,
    cell: Option<Cell>,
    /// True if each `CRYST1` follows its model, as it does if none precedes the first model.
    cell_follows: bool,
    title: String,
}

/// Record type.
enum Record {
    Atom,
    Cell,
    Title,
    Bond,
    Begin,
    EndModel,
    End,
    Other,
}

impl Record {
    fn of(line: &[u8]) -> Self {
        match line.get(..6).unwrap_or(line) {
            b"ATOM  " | b"HETATM" => Self::Atom,
            b"CRYST1" => Self::Cell,
            b"TITLE " => Self::Title,
            b"CONECT" => Self::Bond,
            b"MODEL " => Self::Begin,
            b"ENDMDL" => Self::EndModel,
            other if other.trim_ascii_end() == b"END" => Self::End,
            _ => Self::Other,
        }
    }
}

impl Pdb {
    pub(crate) fn new(source: Source, options: &ReadOptions) -> Self {
        let names = COLUMNS.map(|(name, ..)| name.to_owned()).into();
        let schema = Schema::new(names, options);
        let typed = options.columns.roles.iter().any(|(role, _)| *role == Role::Kind);
        let named = |schema| Arc::new(if typed { schema } else { of_atom_names(schema) });
        let lines = Lines::new(source);
        let title = String::new();
        Self { lines, schema: schema.map(named), cell: None, cell_follows: false, title }
    }
}

impl FrameReader for Pdb {
    fn next(&mut self) -> Result<Option<ParticleFrame>, FileError> {
        let schema = self.schema.clone().map_err(|message| self.lines.ended(message))?;
        let mut builder = Builder::new(self.lines.path(), Format::Pdb, &schema);
        builder.declare(&TEXTS, &["occupancy", "b_factor"]);
        let others: Vec<(usize, Slot)> = schema.used_columns().collect();
        // The type is derived from several columns unless the user names one.
        let has_kind = others.iter().any(|(_, slot)| *slot == Slot::Kind);
        let mut alternates = Alternates::default();
        let mut bonds = HashSet::new();
        let (mut atoms, mut ended) = (false, false);
        while let Some(line) = self.lines.next()? {
            let record = Record::of(line.bytes);
            // Bonds follow the last model, and a cell may follow its model; other records belong to
            // the next frame.
            let belongs = match record {
                Record::Bond | Record::EndModel | Record::End => true,
                Record::Cell => self.cell_follows,
                _ => line.is_blank(),
            };
            if ended && !belongs {
                self.lines.back();
                break;
            }
            match record {
                Record::Atom => {
                    atoms = true;
                    if !matches!(line.bytes.get(16), None | Some(b' ')) {
                        alternates.add(builder.frame.len(), alternate(line.bytes));
                    }
                    builder.push(position(&line)?)?;
                    if !has_kind {
                        builder.kind_of(&key(line.bytes), kind);
                    }
                    for &(column, slot) in &others {
                        builder.put(slot, &line, field(line.bytes, column))?;
                    }
                }
                Record::Cell => self.cell = cell(&line)?,
                Record::Title => add_title(&mut self.title, line.bytes),
                Record::Begin if atoms => {
                    self.lines.back();
                    break;
                }
                Record::Bond => add_bonds(&mut bonds, line.bytes),
                Record::EndModel if atoms => {
                    ended = true;
                    self.cell_follows |= self.cell.is_none();
                }
                Record::End => {
                    ended = atoms;
                    self.cell_follows = false;
                }
                Record::Begin | Record::EndModel | Record::Other => (),
            }
        }
        if !atoms {
            return Ok(None);
        }
        let mut frame = builder.finish();
        alternates.choose(&mut frame);
        frame.add_undrawn(Undrawn::Bonds, bonds.len() as u64);
        let title = self.title.split_whitespace().collect::<Vec<_>>().join(" ");
        Ok(Some(ParticleFrame { title, cell: self.cell, unit: LengthUnit::Angstrom, ..frame }))
    }

    fn skip(&mut self) -> Result<bool, FileError> {
        let mut atoms = false;
        while let Some(line) = self.lines.next()? {
            match Record::of(line.bytes) {
                Record::Atom => atoms = true,
                Record::Cell => self.cell = cell(&line)?,
                Record::Title => add_title(&mut self.title, line.bytes),
                Record::Begin if atoms => {
                    self.lines.back();
                    break;
                }
                Record::EndModel if atoms => {
                    self.cell_follows |= self.cell.is_none();
                    break;
                }
                Record::End => {
                    self.cell_follows = false;
                    if atoms {
                        break;
                    }
                }
                _ => (),
            }
        }
        Ok(atoms)
    }

    fn more(&mut self) -> Result<bool, FileError> {
        self.skip()
    }
}

/// Returns the schema without the element column as type: types are atom names, which determine the
/// elements.
fn of_atom_names(mut schema: Schema) -> Schema {
    schema.slots.iter_mut().filter(|slot| **slot == Slot::Kind).for_each(|slot| *slot = Slot::Skip);
    schema.roles.retain(|(role, _)| *role != Role::Kind);
    schema.roles.push((Role::Kind, COLUMNS[1].0.to_owned()));
    Schema { naming: Naming::Names, ..schema }
}

/// Adds the bonds of a `CONECT` record, by the unparsed serial numbers of both atoms. Records list each
/// bond from both ends, and double bonds twice.
fn add_bonds(bonds: &mut HashSet<[[u8; 5]; 2]>, line: &[u8]) {
    let serial = |start: usize| {
        let mut serial = [b' '; 5];
        let field = bytes(line, start, start + 5);
        serial[..field.len()].copy_from_slice(field);
        (!field.is_empty()).then_some(serial)
    };
    let Some(first) = serial(6) else { return };
    for other in [11, 16, 21, 26].into_iter().filter_map(serial) {
        bonds.insert([first.min(other), first.max(other)]);
    }
}

fn add_title(title: &mut String, line: &[u8]) {
    title.push(' ');
    title.push_str(&String::from_utf8_lossy(bytes(line, 10, 80)));
}

/// Returns a byte range of a line, clamped to its length and trimmed.
fn bytes(line: &[u8], start: usize, end: usize) -> &[u8] {
    line.get(start..end.min(line.len())).unwrap_or_default().trim_ascii()
}

fn field(line: &[u8], column: usize) -> &[u8] {
    let (_, start, end) = COLUMNS[column];
    bytes(line, start, end)
}

fn position(line: &Line) -> Result<[f64; 3], FileError> {
    let number = |column: usize| {
        let field = field(line.bytes, column);
        if field.is_empty() {
            let (name, start, end) = COLUMNS[column];
            let help = format!("PDB has it at columns {} to {end}", start + 1);
            return Err(line.whole(format!("no {name} in this row")).with_help(help));
        }
        line.number(field)
    };
    Ok([number(7)?, number(8)?, number(9)?])
}

/// Returns the identifiers of an atom at an alternate location.
fn alternate(line: &[u8]) -> AlternateAtom<'_> {
    AlternateAtom {
        location: field(line, 2),
        residue: [field(line, 4), field(line, 5), field(line, 6)],
        residue_name: field(line, 3),
        name: field(line, 1),
        occupancy: number::parse(field(line, 10)).unwrap_or(1.0),
    }
}

/// Returns the unparsed fields that define the type of an atom: name, residue and element.
fn key(line: &[u8]) -> [u8; 10] {
    let mut key = [b' '; 10];
    for (to, from) in (12..16).chain(17..21).chain(76..78).enumerate() {
        key[to] = line.get(from).copied().unwrap_or(b' ');
    }
    key
}

fn kind(key: &str) -> Kind {
    let part = |start: usize, end: usize| key.get(start..end).unwrap_or_default();
    let (name, residue, symbol) = (part(0, 4), part(4, 8).trim(), part(8, 10).trim());
    let virtual_site = is_virtual_site(name.trim(), residue);
    let element = Element::from_symbol(symbol).or_else(|| of_aligned_name(name, residue));
    let element = element.filter(|_| !virtual_site);
    Kind { name: name.trim().to_owned(), element, virtual_site }
}

/// Parses the cell of `CRYST1`; a unit cell with edges of 1 means none.
fn cell(line: &Line) -> Result<Option<Cell>, FileError> {
    let number = |start: usize, end: usize| {
        let field = bytes(line.bytes, start, end);
        if field.is_empty() { Ok(0.0) } else { line.number(field) }
    };
    let lengths = [number(6, 15)?, number(15, 24)?, number(24, 33)?];
    let angles = [number(33, 40)?, number(40, 47)?, number(47, 54)?];
    Ok(Cell::of_lengths(lengths, angles).filter(|_| lengths != [1.0; 3]))
}

/// Returns whether a file that begins with this line is PDB.
pub(crate) fn is_pdb(first: &[u8]) -> bool {
    let mut padded = [b' '; 6];
    let length = first.len().min(6);
    padded[..length].copy_from_slice(&first[..length]);
    RECORDS.contains(&&padded[..])
}
