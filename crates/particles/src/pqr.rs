//! Reads PQR of PDB2PQR, APBS and `MDAnalysis`: rows of PDB whose fields are separated by blanks, or in the columns of PDB
//! where they touch, with a charge and a radius in angstrom (apbs.readthedocs.io/en/latest/formats/pqr.html).

use crate::lines::{Line, Lines};
use crate::schema::{Schema, Slot};
use crate::{
    FileError, Format, LengthUnit, ParticleFrame, ReadOptions,
    builder::Builder,
    fields::{Fields, fixed},
    frame_reader::FrameReader,
    number,
    place::Place,
    source::Source,
};
use std::path::Path;
use std::sync::Arc;

/// Names of the columns. A chain may be missing.
const NAMES: [&str; 10] =
    ["number", "name", "residue", "chain", "residue_number", "x", "y", "z", "charge", "radius"];

/// Columns of texts, even if the texts look like numbers.
const TEXTS: [&str; 5] = ["number", "name", "residue", "chain", "residue_number"];

/// Index of the chain.
const CHAIN: usize = 3;

/// Index of the first number: the position, charge and radius are last.
const NUMBERS: usize = 5;

/// Number of rows from which the format is detected.
const ROWS: usize = 64;

/// Reader of the models of a PQR file, one frame each.
pub(crate) struct Pqr {
    lines: Lines,
    schema: Result<Arc<Schema>, String>,
}

impl Pqr {
    pub(crate) fn new(source: Source, options: &ReadOptions) -> Self {
        Self { lines: Lines::new(source), schema: Schema::of_atoms(NAMES, options) }
    }
}

fn is_atom(line: &[u8]) -> bool {
    line.starts_with(b"ATOM") || line.starts_with(b"HETATM")
}

/// Returns the fields of a row in the columns of PDB, after which blanks separate the charge and the radius.
fn aligned(line: &[u8]) -> Option<[&[u8]; 10]> {
    let part = |start: usize, end: usize| fixed(line, start, end);
    let mut rest = Fields::blanks(line.get(54..)?);
    let (charge, radius) = (rest.next()?, rest.next()?);
    let [number, name, residue, chain] = [part(6, 11), part(12, 16), part(17, 21), part(21, 22)];
    let [x, y, z] = [part(30, 38), part(38, 46), part(46, 54)];
    Some([number, name, residue, chain, part(22, 27), x, y, z, charge, radius])
}

/// Returns the fields of a row, in the order of [`NAMES`].
fn fields<'l>(line: &Line<'l>) -> Result<[&'l [u8]; 10], FileError> {
    let mut fields: Vec<&[u8]> = line.fields().skip(1).collect();
    // MDAnalysis writes the element after the radius.
    if fields.last().is_some_and(|last| number::parse(last).is_none()) {
        fields.pop();
    }
    if fields.len() == NAMES.len() - 1 {
        fields.insert(CHAIN, b"");
    }
    let are_numbers =
        |fields: &[&[u8]; 10]| fields[NUMBERS..].iter().all(|field| number::parse(field).is_some());
    let free = <[&[u8]; 10]>::try_from(fields);
    if !free.as_ref().is_ok_and(are_numbers)
        && let Some(fields) = aligned(line.bytes).filter(are_numbers)
    {
        return Ok(fields);
    }
    free.map_err(|_| {
        let help = "a row is ATOM, number, name, residue, chain, residue number, x, y, z, charge and radius, \
                    separated by blanks; the chain may be missing";
        line.whole("not the columns of PQR").with_help(help)
    })
}

impl FrameReader for Pqr {
    fn next(&mut self) -> Result<Option<ParticleFrame>, FileError> {
        let schema = self.schema.clone().map_err(|message| self.lines.ended(message))?;
        let mut builder = Builder::new(self.lines.path(), Format::Pqr, &schema);
        builder.declare(&TEXTS, &["charge"]);
        let has_kind = schema.slots.contains(&Slot::Kind);
        while let Some(line) = self.lines.next()? {
            let has_atoms = !builder.frame.is_empty();
            if line.bytes.starts_with(b"ENDMDL") && has_atoms {
                break;
            }
            if line.bytes.starts_with(b"MODEL") && has_atoms {
                self.lines.back();
                break;
            }
            if is_atom(line.bytes) {
                let fields = fields(&line)?;
                builder.row(&line, fields.into_iter())?;
                if !has_kind {
                    builder.atom_kind(fields[1], fields[2]);
                }
            }
        }
        let frame = builder.finish();
        Ok((!frame.is_empty()).then_some(ParticleFrame { unit: LengthUnit::Angstrom, ..frame }))
    }

    fn skip(&mut self) -> Result<bool, FileError> {
        let mut has_atoms = false;
        while let Some(line) = self.lines.next()? {
            if line.bytes.starts_with(b"ENDMDL") && has_atoms {
                break;
            }
            if line.bytes.starts_with(b"MODEL") && has_atoms {
                self.lines.back();
                break;
            }
            has_atoms |= is_atom(line.bytes);
        }
        Ok(has_atoms)
    }

    fn more(&mut self) -> Result<bool, FileError> {
        self.skip()
    }

    fn place(&self) -> Option<Place> {
        self.lines.place()
    }

    fn start_at(&mut self, place: &Place) -> Result<bool, FileError> {
        self.lines.start_at(place)
    }
}

/// Returns whether a file with this head is PQR: by its name, or since no row has the columns of PDB.
pub(crate) fn is_pqr(head: &[u8], path: &Path) -> bool {
    let has_suffix = |wanted: &str| {
        let name = path.file_name().unwrap_or_default().to_string_lossy().to_ascii_lowercase();
        name.split('.').skip(1).any(|part| part == wanted)
    };
    if has_suffix("pdb") || has_suffix("ent") {
        return false;
    }
    let complete = &head[..memchr::memrchr(b'\n', head).unwrap_or(head.len())];
    let atoms = complete.split(|&byte| byte == b'\n').filter(|line| is_atom(line));
    let mut atoms = atoms.take(ROWS).peekable();
    atoms.peek().is_some() && (has_suffix("pqr") || atoms.all(is_pqr_atom))
}

/// Returns whether a row ends with five decimal numbers that are not in the columns of PDB.
fn is_pqr_atom(line: &[u8]) -> bool {
    let fields: Vec<&[u8]> = Fields::blanks(line).collect();
    let last = fields.len().checked_sub(5).map(|first| &fields[first..]).unwrap_or_default();
    let is_decimal = |field: &&[u8]| field.contains(&b'.') && number::parse(field).is_some();
    let numbers = last.len() == 5 && last.iter().all(is_decimal);
    // In PDB, occupancy and temperature factor have two decimals in fixed columns.
    let two_decimals = |end: usize| line.get(end - 3) == Some(&b'.');
    numbers && !(two_decimals(60) && two_decimals(66) && line.get(38 - 4) == Some(&b'.'))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_without_the_columns_of_pdb_are_pqr() {
        let is = |text: &str, name: &str| is_pqr(text.as_bytes(), Path::new(name));
        let aligned = "ATOM      1  N   NTR     0      63.889  69.990 133.214  0.1414 1.8240\n";
        let free = "ATOM 1 N NTR 0 63.889 69.990 133.214 0.1414 1.8240\nTER\n";
        assert!(is(aligned, "a.txt") && is(free, "-"));
        assert!(!is(free, "a.pdb.gz"));
        let element =
            "ATOM      1  N   ALA A   1      11.104   6.134  -6.504  1.00  0.00           N\n";
        let pdb = "ATOM      1  N   ALA     1      11.104   6.134  -6.504  1.00  0.00\n";
        for other in [element, pdb, "ATOM      1  N   ALA A   1      11.104   6.134  -6.504\n", ""]
        {
            assert!(!is(other, "a.txt"), "{other}");
        }
        assert!(is(element, "a.pqr"));
    }

    #[test]
    fn columns_may_touch() {
        for (row, expected) in [
            (
                "ATOM     41  O   ASN A  64     -30.125 -61.500-101.250  0.5000 1.6000",
                ["ASN", "A", "64", "-30.125", "-61.500", "-101.250", "0.5000", "1.6000"],
            ),
            (
                "ATOM     42  N   ASN A  64     -31.125-161.500-101.250 -0.5000 1.5500",
                ["ASN", "A", "64", "-31.125", "-161.500", "-101.250", "-0.5000", "1.5500"],
            ),
            (
                "ATOM     43  N   ASN   100     -31.125 161.500 101.250 -0.5000 1.5500",
                ["ASN", "", "100", "-31.125", "161.500", "101.250", "-0.5000", "1.5500"],
            ),
        ] {
            let path = Path::new("p").into();
            let fields = fields(&Line::new(&path, 1, row.as_bytes())).expect(row);
            assert_eq!(fields[2..], expected.map(str::as_bytes), "{row}");
        }
    }
}
