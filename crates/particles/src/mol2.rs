//! Reads MOL2 of Tripos: molecules, one frame each, in angstrom (zhanggroup.org/DockRMSD/mol2.pdf).

use crate::bonds::{Listed, Numbering};
use crate::lines::{Line, Lines};
use crate::schema::{Schema, Slot};
use crate::{
    Cell, FileError, Format, Kind, LengthUnit, ParticleFrame, ReadOptions, builder::Builder,
    fields::Fields, frame_reader::FrameReader, naming, number, place::Place, source::Source,
};
use std::path::Path;
use std::sync::Arc;

/// Names of the columns; the last three may be missing.
const NAMES: [&str; 9] =
    ["number", "name", "x", "y", "z", "atom_type", "residue_number", "residue", "charge"];

/// Columns of texts, even if the texts look like numbers.
const TEXTS: [&str; 5] = ["number", "name", "atom_type", "residue_number", "residue"];

/// Indices of the name of an atom, its type and its residue.
const NAME: usize = 1;
const TYPE: usize = 5;
const RESIDUE: usize = 7;

/// The beginning of a line with the name of a section.
const SECTION: &[u8] = b"@<TRIPOS>";

/// Reader of the molecules of a MOL2 file.
pub(crate) struct Mol2 {
    lines: Lines,
    schema: Result<Arc<Schema>, String>,
    reads_bonds: bool,
}

impl Mol2 {
    pub(crate) fn new(source: Source, options: &ReadOptions) -> Self {
        let schema = Schema::new(NAMES.map(str::to_owned).into(), options);
        let reads_bonds = options.reads_bonds();
        Self { lines: Lines::new(source), schema: schema.map(Arc::new), reads_bonds }
    }

    /// Moves past the line that begins the next molecule. Returns whether there is one.
    fn find(&mut self) -> Result<bool, FileError> {
        while let Some(line) = self.lines.next()? {
            if section(line.bytes) == Some(b"MOLECULE") {
                return Ok(true);
            }
        }
        Ok(false)
    }
}

/// Adds the bond of a row: its number, the numbers of its atoms and its type, which may be `1`, `2`, `3`,
/// `am`, `ar`, `du`, `un` or `nc`, not connected.
fn add_bond(
    bonds: &mut Listed,
    numbering: &Numbering,
    line: &Line,
    path: &Path,
) -> Result<(), FileError> {
    let mut fields = line.fields().skip(1);
    let [Some(first), Some(second), Some(kind)] = [(); 3].map(|()| fields.next()) else {
        let help = "a row is a number, the numbers of two atoms, and a type";
        return Err(line.whole("not the columns of a bond").with_help(help));
    };
    if kind == b"nc" {
        return Ok(());
    }
    match bonds.ends([numbering.row(line, first)?, numbering.row(line, second)?]) {
        Some([first, second]) => bonds.push_named(path, (first, second, [0; 3]), kind),
        None => Ok(()),
    }
}

/// Returns the type for the type, name and residue of an atom, separated by blanks.
fn kind(key: &str) -> Kind {
    let mut parts = key.split(' ');
    let [kind, name, residue] = [(); 3].map(|()| parts.next().unwrap_or_default());
    naming::of_sybyl(kind, name, residue)
}

/// Returns a line up to a comment: a `#` at its beginning or after a blank.
fn without_comment(line: &[u8]) -> &[u8] {
    let mut marks = memchr::memchr_iter(b'#', line);
    let is_comment =
        |at: &usize| at.checked_sub(1).is_none_or(|before| line[before].is_ascii_whitespace());
    &line[..marks.find(is_comment).unwrap_or(line.len())]
}

/// Returns the name of the section that a line begins.
fn section(line: &[u8]) -> Option<&[u8]> {
    line.strip_prefix(SECTION).map(<[u8]>::trim_ascii)
}

/// Parses the cell: lengths and angles.
fn cell(line: &Line) -> Result<Option<Cell>, FileError> {
    let mut numbers = [f64::NAN; 6];
    for (number, field) in numbers.iter_mut().zip(line.fields()) {
        *number = line.number(field)?;
    }
    let [a, b, c, alpha, beta, gamma] = numbers;
    Ok(Cell::of_lengths([a, b, c], [alpha, beta, gamma]))
}

impl FrameReader for Mol2 {
    fn next(&mut self) -> Result<Option<ParticleFrame>, FileError> {
        let schema = self.schema.clone().map_err(|message| self.lines.ended(message))?;
        if !self.find()? {
            return Ok(None);
        }
        let title = self.lines.next()?.map(|line| line.text().trim().to_owned());
        let counts = self.lines.next()?;
        let counted = counts.and_then(|line| line.fields().next().and_then(number::whole));
        self.lines.back();
        let mut builder = Builder::new(self.lines.path(), Format::Mol2, &schema);
        builder.declare(&TEXTS, &["charge"]);
        let has_kind = schema.slots.contains(&Slot::Kind);
        let (mut inside, mut edges) = (Vec::new(), None);
        let path = self.lines.path().clone();
        let (mut numbers, mut numbering, mut bonds) = (Vec::new(), None, Listed::default());
        while let Some(line) = self.lines.next()? {
            let line = Line::new(line.path(), line.number_in_file(), without_comment(line.bytes));
            if let Some(section) = section(line.bytes) {
                inside = section.to_vec();
                if inside == b"MOLECULE" {
                    self.lines.back();
                    break;
                }
            } else if inside == b"ATOM" && !line.is_blank() {
                let mut row = line.fields().collect::<Vec<_>>();
                if row.len() <= TYPE {
                    let help = "a row is a number, name, x, y, z and type, and may have more";
                    return Err(line.whole("not the columns of an atom").with_help(help));
                }
                if self.reads_bonds {
                    numbers.push(number::parse(row[0]).unwrap_or(f64::NAN));
                }
                row.resize(NAMES.len().max(row.len()), b"");
                builder.row(&line, row.iter().copied())?;
                if !has_kind {
                    builder.kind_of(&[row[TYPE], row[NAME], row[RESIDUE]].join(&b' '), kind);
                }
            } else if inside == b"BOND" && self.reads_bonds && !line.is_blank() {
                let numbering = numbering.get_or_insert_with(|| Numbering::of(&numbers));
                add_bond(&mut bonds, numbering, &line, &path)?;
            } else if inside == b"CRYSIN" && !line.is_blank() && edges.is_none() {
                edges = cell(&line)?;
            }
        }
        let atoms = builder.frame.len() as u64;
        if let Some(counted) = counted.filter(|counted| *counted != atoms) {
            builder.frame.warnings.push(format!(
                "a molecule has {atoms} atoms, but counts {counted}: the file is cut off, or the number wrong"
            ));
        }
        let frame = builder.finish();
        let bonds = numbering.map(|_| bonds.finish());
        let title = title.unwrap_or_default();
        Ok(Some(ParticleFrame { bonds, cell: edges, title, unit: LengthUnit::Angstrom, ..frame }))
    }

    fn skip(&mut self) -> Result<bool, FileError> {
        self.find()
    }

    fn more(&mut self) -> Result<bool, FileError> {
        self.find()
    }

    fn place(&self) -> Option<Place> {
        self.lines.place()
    }

    fn start_at(&mut self, place: &Place) -> Result<bool, FileError> {
        self.lines.start_at(place)
    }
}

/// Returns whether a file with this head is MOL2: comments, and the beginning of a section.
pub(crate) fn is_mol2(head: &[u8]) -> bool {
    let mut lines = head.split(|&byte| byte == b'\n');
    let first = lines.find(|line| !line.trim_ascii().is_empty() && !line.starts_with(b"#"));
    first.is_some_and(|line| line.starts_with(SECTION) && Fields::blanks(line).count() == 1)
}
