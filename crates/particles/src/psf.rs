//! Reads PSF, topologies of CHARMM, NAMD and X-PLOR: what the atoms of a trajectory are
//! (charmm-gui.org/charmmdoc/struct.html). They have no positions: those of the frame are NaN.

use crate::bonds::{Listed, row_from_one};
use crate::lines::{Line, Lines};
use crate::unplaced::{self, UnplacedAtoms};
use crate::{
    Bonds, FileError, Format, ParticleFrame, ReadOptions, fields::Fields,
    frame_reader::FrameReader, number, schema::Schema, source::Source,
};
use std::sync::Arc;

/// Names of the columns.
const NAMES: [&str; COLUMNS] =
    ["number", "segment", "residue_number", "residue", "name", "atom_type", "charge", "mass"];

/// Number of columns.
const COLUMNS: usize = 8;

/// Reader of a PSF file, which is one frame.
pub(crate) struct Psf {
    lines: Lines,
    schema: Result<Arc<Schema>, String>,
    done: bool,
    reads_bonds: bool,
}

impl Psf {
    pub(crate) fn new(source: Source, options: &ReadOptions) -> Self {
        let schema = unplaced::schema(NAMES, options);
        let reads_bonds = options.reads_bonds();
        Self { lines: Lines::new(source), schema, done: false, reads_bonds }
    }

    /// Reads the section of bonds: pairs of numbers of atoms, four in a line; `None` without the section.
    fn bonds(&mut self, atoms: usize) -> Result<Option<Bonds>, FileError> {
        let path = self.lines.path().clone();
        let mut bonds = Listed::default();
        let mut rest = None;
        while rest != Some(0) {
            let Some(line) = self.lines.next()? else {
                return match rest {
                    None => Ok(None),
                    Some(rest) => {
                        let message = format!("the file ends before the last {rest} bonds");
                        Err(self.lines.ended(message).with_help("the file is cut off"))
                    }
                };
            };
            let mut fields = line.fields();
            let Some(rest) = &mut rest else {
                let (count, name) = (fields.next(), fields.next());
                if name.is_some_and(|name| name.starts_with(b"!NBOND")) {
                    rest = Some(line.whole_number(count.unwrap_or_default())?);
                }
                continue;
            };
            while let Some(first) = fields.next() {
                let Some(second) = fields.next() else {
                    let help = "a row of bonds has the numbers of two atoms for each";
                    return Err(line.whole("an atom without another one").with_help(help));
                };
                let row = |field| row_from_one(&line, field, atoms);
                if let Some([first, second]) = bonds.ends([row(first)?, row(second)?]) {
                    bonds.push(&path, (first, second, [0; 3]))?;
                }
                *rest = rest.checked_sub(1).ok_or_else(|| {
                    let help = "correct the number of bonds before !NBOND";
                    line.error_at(first, "more bonds than the section has").with_help(help)
                })?;
            }
        }
        Ok(Some(bonds.finish()))
    }

    /// Finds the section of atoms; returns their number.
    fn count(&mut self) -> Result<u64, FileError> {
        while let Some(line) = self.lines.next()? {
            let mut fields = line.fields();
            let (count, name) = (fields.next(), fields.next());
            if name.is_some_and(|name| name.starts_with(b"!NATOM")) {
                return line.whole_number(count.unwrap_or_default());
            }
        }
        Err(self.lines.ended("the file has no section !NATOM"))
    }
}

/// Returns the fields of a row, in the order of [`NAMES`]. The segment may be blank.
fn fields<'l>(line: &Line<'l>) -> Result<[&'l [u8]; COLUMNS], FileError> {
    let mut fields: Vec<&[u8]> = line.fields().collect();
    // Charge and mass have decimals; types, and what follows, may be whole numbers.
    let is_decimal = |field: &&[u8]| field.contains(&b'.') && number::parse(field).is_some();
    if !fields.iter().skip(6).take(2).all(is_decimal) && fields.len() > 1 {
        fields.insert(1, b"");
    }
    fields.truncate(COLUMNS);
    fields.try_into().map_err(|_| {
        let help =
            "a row is a number, segment, residue number, residue, name, type, charge and mass";
        line.whole("not the columns of an atom").with_help(help)
    })
}

impl FrameReader for Psf {
    fn next(&mut self) -> Result<Option<ParticleFrame>, FileError> {
        if std::mem::replace(&mut self.done, true) {
            return Ok(None);
        }
        let schema = self.schema.clone().map_err(|message| self.lines.ended(message))?;
        let count = self.count()?;
        let mut atoms = UnplacedAtoms::new(self.lines.path(), Format::Psf, &schema);
        for atom in 0..count {
            let line = self.lines.row(atom, count, "atoms", "the file is cut off")?;
            let fields = fields(&line)?;
            let positions: [&[u8]; 3] = [b"nan"; 3];
            atoms.builder.row(&line, fields.into_iter().chain(positions))?;
            let [.., residue, name, _, _, mass] = fields;
            atoms.kind(b"", mass, name, residue);
        }
        if self.lines.next()?.is_some_and(|line| fields(&line).is_ok()) {
            atoms.builder.warn_of_more_rows();
        }
        self.lines.back();
        let mut frame = atoms.finish();
        if self.reads_bonds {
            frame.bonds = self.bonds(frame.len())?;
        }
        Ok(Some(frame))
    }
}

/// Returns whether the first line is `PSF` with flags, and a section with a title follows.
pub(crate) fn is_psf(head: &[u8]) -> bool {
    let first = head.split(|&byte| byte == b'\n').next().unwrap_or_default().trim_ascii_end();
    let is_flag = |field: &[u8]| field.iter().all(u8::is_ascii_uppercase);
    first.starts_with(b"PSF")
        && Fields::blanks(first).all(is_flag)
        && memchr::memmem::find(head, b"!N").is_some()
}
