//! Reads PDB: fixed columns, lengths in angstrom (wwPDB, "Protein Data Bank Contents Guide", version
//! 3.30).
//!
//! The crate `pdbtbx` isn't used: it builds a tree of models, chains and residues, and rejects files of
//! simulations (serial numbers in hexadecimal, hybrid-36 or asterisks). This reader doesn't parse
//! numbers that aren't needed.

use crate::alternates::{AlternateAtom, Alternates};
use crate::bonds::{End, Listed};
use crate::element::{is_virtual_site, of_aligned_name, of_autodock_type};
use crate::lines::{Line, Lines};
use crate::schema::{Naming, Schema, Slot};
use crate::source::{Source, is_standard_input};
use crate::{
    Bonds, Cell, Element, ElementSource, FileError, Format, Kind, LengthUnit, ParticleFrame,
    ReadOptions, ReadProgress, Role, builder::Builder, fields::fixed, frame_reader::FrameReader,
    number, place::Place,
};
use std::collections::{HashMap, HashSet};
use std::path::Path;
use std::sync::Arc;

/// A column of a row: its name and its bytes.
type Column = (&'static str, usize, usize);

/// The columns that all rows have.
const COLUMNS: [Column; 12] = [
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
];

/// The columns after those.
const OF_PDB: [Column; 3] = [("segment", 72, 76), ("element", 76, 78), ("charge", 78, 80)];

/// The columns in their place in PDBQT, in which charges are partial ones and types those of `AutoDock`
/// (<https://autodock.scripps.edu>).
const OF_PDBQT: [Column; 2] = [("charge", 70, 76), ("atom_type", 77, 80)];

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
    "atom_type",
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
    /// The columns of rows, with the indices that the schema has.
    columns: Vec<Column>,
    is_pdbqt: bool,
    known: Arc<Known>,
    /// The records of bonds, if they are read.
    bonds: Option<BondRecords>,
}

/// Facts that records tell of all models after them.
#[derive(Clone, Default)]
struct Known {
    cell: Option<Cell>,
    /// True if each `CRYST1` follows its model, as it does if none precedes the first model.
    cell_follows: bool,
    title: String,
}

/// Serial number of an atom, as text: it may be hexadecimal or hybrid-36.
type Serial = [u8; 5];

/// A bond of a record: the serial numbers of its atoms.
type ListedBond = [Serial; 2];

/// Bonds of the file.
struct BondRecords {
    /// Bonds that follow the last model, once they are needed for another one.
    last: Option<Vec<ListedBond>>,
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
        let is_pdbqt = is_pdbqt(&source.head);
        let further = if is_pdbqt { &OF_PDBQT[..] } else { &OF_PDB };
        let columns = [&COLUMNS, further].concat();
        let names = columns.iter().map(|(name, ..)| (*name).to_owned()).collect();
        let schema = Schema::new(names, options);
        let typed = options.columns.roles.iter().any(|(role, _)| *role == Role::Kind);
        let named = |schema| Arc::new(if typed { schema } else { of_atom_names(schema) });
        let lines = Lines::new(source);
        let bonds = options.reads_bonds().then_some(BondRecords { last: None });
        let schema = schema.map(named);
        Self { lines, schema, columns, is_pdbqt, known: Arc::default(), bonds }
    }

    /// Notes the end of a model.
    fn end_model(&mut self) {
        if self.known.cell.is_none() {
            Arc::make_mut(&mut self.known).cell_follows = true;
        }
    }
}

impl FrameReader for Pdb {
    fn next(&mut self) -> Result<Option<ParticleFrame>, FileError> {
        let schema = self.schema.clone().map_err(|message| self.lines.ended(message))?;
        let mut builder = Builder::new(self.lines.path(), Format::Pdb, &schema);
        let numbers = &["occupancy", "b_factor", "charge"];
        // The charge of PDB is a text such as `2-`.
        builder.declare(if self.is_pdbqt { &[] } else { &["charge"][..] }, &[]);
        builder.declare(&TEXTS, numbers);
        let others: Vec<(usize, Slot)> = schema.used_columns().collect();
        // The type is derived from several columns unless the user names one.
        let has_kind = others.iter().any(|(_, slot)| *slot == Slot::Kind);
        let mut alternates = Alternates::default();
        let mut serials: HashMap<Serial, End<u32>> = HashMap::new();
        let (reads_bonds, mut own_bonds) = (self.bonds.is_some(), Vec::new());
        let mut at_end = true;
        let (mut atoms, mut ended) = (false, false);
        while let Some(line) = self.lines.next()? {
            let record = Record::of(line.bytes);
            // Bonds follow the last model, and a cell may follow its model; other records belong to
            // the next frame.
            let belongs = match record {
                Record::Bond | Record::EndModel | Record::End => true,
                Record::Cell => self.known.cell_follows,
                _ => line.is_blank(),
            };
            if ended && !belongs {
                self.lines.back();
                at_end = false;
                break;
            }
            match record {
                Record::Atom => {
                    atoms = true;
                    if reads_bonds && let Some(serial) = serial(line.bytes, 6) {
                        let row = builder.frame.len() as u32;
                        let end = serials.entry(serial);
                        end.and_modify(|end| *end = End::Ambiguous).or_insert(End::Atom(row));
                    }
                    if !matches!(line.bytes.get(16), None | Some(b' ')) {
                        alternates.add(builder.frame.len(), alternate(line.bytes));
                    }
                    builder.push(position(&line)?)?;
                    if !has_kind {
                        let is_pdbqt = self.is_pdbqt;
                        let kind = |key: &str| kind(key, is_pdbqt);
                        builder.kind_of(&key(line.bytes, is_pdbqt), kind);
                    }
                    for &(column, slot) in &others {
                        let (_, start, end) = self.columns[column];
                        builder.put(slot, &line, fixed(line.bytes, start, end))?;
                    }
                }
                Record::Cell => Arc::make_mut(&mut self.known).cell = cell(&line)?,
                Record::Title => add_title(&mut Arc::make_mut(&mut self.known).title, line.bytes),
                Record::Begin if atoms => {
                    self.lines.back();
                    at_end = false;
                    break;
                }
                Record::Bond if reads_bonds => own_bonds.extend(bonds_of(line.bytes)),
                Record::EndModel if atoms => {
                    ended = true;
                    self.end_model();
                }
                Record::End => {
                    ended = atoms;
                    Arc::make_mut(&mut self.known).cell_follows = false;
                }
                Record::Bond | Record::Begin | Record::EndModel | Record::Other => (),
            }
        }
        if !atoms {
            return Ok(None);
        }
        let mut frame = builder.finish();
        if let Some(records) = &mut self.bonds {
            let path = self.lines.path();
            let list =
                if own_bonds.is_empty() && !at_end { records.last(path)? } else { &own_bonds };
            add_bonds(path, &mut frame, list, &serials)?;
        }
        alternates.choose(&mut frame);
        let title = self.known.title.split_whitespace().collect::<Vec<_>>().join(" ");
        Ok(Some(ParticleFrame {
            title,
            cell: self.known.cell,
            unit: LengthUnit::Angstrom,
            ..frame
        }))
    }

    fn skip(&mut self) -> Result<bool, FileError> {
        let mut atoms = false;
        while let Some(line) = self.lines.next()? {
            match Record::of(line.bytes) {
                Record::Atom => atoms = true,
                Record::Cell => Arc::make_mut(&mut self.known).cell = cell(&line)?,
                Record::Title => add_title(&mut Arc::make_mut(&mut self.known).title, line.bytes),
                Record::Begin if atoms => {
                    self.lines.back();
                    break;
                }
                Record::EndModel if atoms => {
                    self.end_model();
                    break;
                }
                Record::End => {
                    Arc::make_mut(&mut self.known).cell_follows = false;
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

    fn place(&self) -> Option<Place> {
        Some(self.lines.place()?.with_state(&self.known))
    }

    fn start_at(&mut self, place: &Place) -> Result<bool, FileError> {
        self.lines.start_with(place, &mut self.known)
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

/// Returns the serial number in the five columns from `start`.
fn serial(line: &[u8], start: usize) -> Option<Serial> {
    let mut serial = [b' '; 5];
    let field = fixed(line, start, start + 5);
    serial[..field.len()].copy_from_slice(field);
    (!field.is_empty()).then_some(serial)
}

/// Returns the bonds of a `CONECT` record, by the serial numbers of both atoms. Records list each bond from
/// both ends, and double bonds twice.
fn bonds_of(line: &[u8]) -> impl Iterator<Item = [Serial; 2]> {
    let first = serial(line, 6);
    let others = [11, 16, 21, 26].into_iter().filter_map(|start| serial(line, start));
    others.filter_map(move |other| first.map(|first| [first.min(other), first.max(other)]))
}

/// Adds bonds to a model whose atoms have these serial numbers.
fn add_bonds(
    path: &Arc<Path>,
    frame: &mut ParticleFrame,
    list: &[ListedBond],
    serials: &HashMap<Serial, End<u32>>,
) -> Result<(), FileError> {
    let mut bonds = Listed::default();
    // Records repeat bonds, but each counts once.
    let mut unclear = HashSet::new();
    for ends in list {
        let rows = ends.map(|serial| serials.get(&serial).copied().unwrap_or(End::Nowhere));
        let is_clear = rows.iter().all(|row| matches!(row, End::Atom(_)));
        if !is_clear && !unclear.insert(ends) {
            continue;
        }
        if let Some([first, second]) = bonds.ends(rows) {
            bonds.push(path, (first, second, [0; 3]))?;
        }
    }
    frame.bonds = Some(Bonds { partial: true, ..bonds.finish() });
    Ok(())
}

impl BondRecords {
    /// Returns the bonds that follow the last model, which are those of all models. Of standard input, which
    /// is read only once, only the last model has them.
    fn last(&mut self, path: &Path) -> Result<&[ListedBond], FileError> {
        if self.last.is_none() {
            self.last = Some(last_bonds(path)?);
        }
        Ok(self.last.as_deref().unwrap_or_default())
    }
}

fn last_bonds(path: &Path) -> Result<Vec<ListedBond>, FileError> {
    let mut list = Vec::new();
    if is_standard_input(path) {
        return Ok(list);
    }
    // Not counted as progress, since the file is read on.
    let mut lines = Lines::new(Source::open(path, &ReadProgress::default())?);
    while let Some(line) = lines.next()? {
        match Record::of(line.bytes) {
            Record::Atom => list.clear(),
            Record::Bond => list.extend(bonds_of(line.bytes)),
            _ => (),
        }
    }
    Ok(list)
}

fn add_title(title: &mut String, line: &[u8]) {
    title.push(' ');
    title.push_str(&String::from_utf8_lossy(fixed(line, 10, 80)));
}

fn field(line: &[u8], column: usize) -> &[u8] {
    let (_, start, end) = COLUMNS[column];
    fixed(line, start, end)
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

/// Returns the unparsed fields that define the type of an atom: name, residue, and element or type of `AutoDock`.
fn key(line: &[u8], is_pdbqt: bool) -> [u8; 11] {
    let mut key = [b' '; 11];
    let symbol = if is_pdbqt { 77..80 } else { 76..78 };
    for (to, from) in (12..16).chain(17..21).chain(symbol).enumerate() {
        key[to] = line.get(from).copied().unwrap_or(b' ');
    }
    key
}

/// Returns whether a file that begins so has rows of PDBQT: the first atom has a charge of three decimals and a type in its columns.
fn is_pdbqt(head: &[u8]) -> bool {
    let mut lines = head.split(|&byte| byte == b'\n');
    lines.find(|line| matches!(Record::of(line), Record::Atom)).is_some_and(|line| {
        let charge = || number::parse(fixed(line, 70, 76)).is_some();
        line.get(72) == Some(&b'.') && line.get(76) == Some(&b' ') && line.len() > 77 && charge()
    })
}

fn kind(key: &str, is_pdbqt: bool) -> Kind {
    let part = |start: usize, end: usize| key.get(start..end).unwrap_or_default();
    let (name, residue, symbol) = (part(0, 4), part(4, 8).trim(), part(8, 11).trim());
    let virtual_site = is_virtual_site(name.trim(), residue);
    let by_symbol = if is_pdbqt {
        (of_autodock_type(symbol), ElementSource::Type)
    } else {
        (Element::from_symbol(symbol), ElementSource::Symbol)
    };
    let (element, source) = match by_symbol {
        (None, _) => (of_aligned_name(name, residue), ElementSource::Name),
        found => found,
    };
    let element = element.filter(|_| !virtual_site);
    Kind { name: name.trim().to_owned(), element, source, virtual_site }
}

/// Parses the cell of `CRYST1`; a unit cell with edges of 1 means none, and so does a line that ends before its numbers.
fn cell(line: &Line) -> Result<Option<Cell>, FileError> {
    let number = |start: usize, end: usize| {
        let field = fixed(line.bytes, start, end);
        if field.is_empty() { Ok(f64::NAN) } else { line.number(field) }
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
