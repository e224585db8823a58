//! Reads XSF and AXSF of XCrySDen, in angstrom (xcrysden.org/doc/XSF.html). Grids of data are passed over.

use crate::{
    Cell, FileError, Format, LengthUnit, ParticleFrame, ReadOptions,
    builder::Builder,
    fields::Fields,
    frame_reader::FrameReader,
    line,
    lines::{Line, Lines},
    number,
    place::Place,
    schema::Schema,
    source::Source,
};
use glam::DVec3;
use std::sync::Arc;

/// Names of the columns; forces may be missing.
const NAMES: [&str; 7] = ["species", "x", "y", "z", "fx", "fy", "fz"];

/// Number of columns without forces.
const PLAIN: usize = 4;

/// Keywords that begin a structure, and the edges of its cell along which it is periodic.
const STRUCTURES: [(&[u8], [bool; 3]); 4] = [
    (b"CRYSTAL", [true; 3]),
    (b"SLAB", [true, true, false]),
    (b"POLYMER", [true, false, false]),
    (b"MOLECULE", [false; 3]),
];

/// Reader of the frames of an XSF file.
pub(crate) struct Xsf {
    lines: Lines,
    options: ReadOptions,
    known: Arc<Known>,
}

/// Facts that frames tell of those after them, too.
#[derive(Clone)]
struct Known {
    cell: Option<Cell>,
    periodic: [bool; 3],
}

/// Where the atoms of a frame end.
enum Atoms {
    /// After so many rows.
    Counted(u64),
    UntilKeyword,
}

impl Xsf {
    pub(crate) fn new(source: Source, options: &ReadOptions) -> Self {
        let known = Arc::new(Known { cell: None, periodic: [true; 3] });
        Self { lines: Lines::new(source), options: options.clone(), known }
    }

    /// Moves to the atoms of the next frame, if there is one.
    fn find(&mut self) -> Result<Option<Atoms>, FileError> {
        while let Some(line) = line(&mut self.lines)? {
            let Some(keyword) = fields(line.bytes).next() else { continue };
            if let Some((_, periodic)) = STRUCTURES.iter().find(|(own, _)| *own == keyword) {
                Arc::make_mut(&mut self.known).periodic = *periodic;
            }
            match keyword {
                b"PRIMVEC" => {
                    let cell = self.vectors()?;
                    Arc::make_mut(&mut self.known).cell = cell;
                }
                b"PRIMCOORD" => {
                    let line = require(&mut self.lines, "its number of atoms")?;
                    let count = line.whole_number(line.fields().next().unwrap_or_default())?;
                    return Ok(Some(Atoms::Counted(count)));
                }
                b"ATOMS" => return Ok(Some(Atoms::UntilKeyword)),
                _ => (),
            }
        }
        Ok(None)
    }

    fn vectors(&mut self) -> Result<Option<Cell>, FileError> {
        let mut vectors = [DVec3::ZERO; 3];
        for vector in &mut vectors {
            let line = require(&mut self.lines, "its lattice vectors")?;
            let numbers = line.fields().take(3).map(|field| line.number(field));
            let numbers = numbers.collect::<Result<Vec<f64>, FileError>>()?;
            let [x, y, z] = numbers[..] else {
                return Err(line.whole("a lattice vector is three numbers"));
            };
            *vector = DVec3::new(x, y, z);
        }
        Ok(Cell { origin: DVec3::ZERO, vectors, periodic: self.known.periodic }.declared())
    }
}

impl FrameReader for Xsf {
    fn next(&mut self) -> Result<Option<ParticleFrame>, FileError> {
        let Some(atoms) = self.find()? else { return Ok(None) };
        let columns = line(&mut self.lines)?.map_or(PLAIN, |line| fields(line.bytes).count());
        self.lines.back();
        let names = &NAMES[..if columns < NAMES.len() { PLAIN } else { NAMES.len() }];
        let names = names.iter().map(|name| (*name).to_owned()).collect();
        let schema = Schema::new(names, &self.options).map_err(|error| self.lines.ended(error))?;
        let mut builder = Builder::new(self.lines.path(), Format::Xsf, &Arc::new(schema));
        while let Some(line) = line(&mut self.lines)? {
            let fields = fields(line.bytes);
            // Keywords have no number after them, or one.
            if fields.clone().count() < 3 {
                self.lines.back();
                break;
            }
            builder.row(&line, fields)?;
        }
        let rows = builder.frame.len() as u64;
        if let Atoms::Counted(count) = atoms
            && count != rows
        {
            let message = format!("the coordinates end after {rows} of {count} atoms");
            return Err(self.lines.ended(message));
        }
        let cell = self.known.cell.filter(|_| self.known.periodic != [false; 3]);
        Ok(Some(ParticleFrame { cell, unit: LengthUnit::Angstrom, ..builder.finish() }))
    }

    fn more(&mut self) -> Result<bool, FileError> {
        Ok(self.find()?.is_some())
    }

    fn place(&self) -> Option<Place> {
        Some(self.lines.place()?.with_state(&self.known))
    }

    fn start_at(&mut self, place: &Place) -> Result<bool, FileError> {
        self.lines.start_with(place, &mut self.known)
    }
}

/// Returns the next line that is neither blank nor a comment.
fn line(lines: &mut Lines) -> Result<Option<Line<'_>>, FileError> {
    while lines.next()?.is_some_and(|line| fields(line.bytes).next().is_none()) {}
    lines.back();
    lines.next()
}

/// Returns the next such line, or an error that the file ends before `what`.
fn require<'l>(lines: &'l mut Lines, what: &str) -> Result<Line<'l>, FileError> {
    line(lines)?;
    lines.back();
    lines.require(what)
}

/// Returns the fields of a line before any comment.
fn fields(line: &[u8]) -> Fields<'_> {
    Fields::blanks(&line[..memchr::memchr(b'#', line).unwrap_or(line.len())])
}

/// Returns whether a file begins with a keyword of XSF, alone on its line or with a number, or has that of a structure among its
/// first lines, and has atoms.
pub(crate) fn is_xsf(head: &[u8]) -> bool {
    let lines = head.split(|&byte| byte == b'\n').map(fields);
    let mut lines = lines.filter(|fields| fields.clone().next().is_some()).take(line::FIRST);
    let is_keyword = |fields: &Fields<'_>, is: &dyn Fn(&[u8]) -> bool| {
        let mut fields = fields.clone();
        fields.next().is_some_and(is)
            && fields.next().is_none_or(|count| number::whole(count).is_some())
            && fields.next().is_none()
    };
    let is_structure = |word: &[u8]| STRUCTURES.iter().any(|(own, _)| *own == word);
    let is_other = |word: &[u8]| [&b"PRIMVEC"[..], b"PRIMCOORD", b"ATOMS"].contains(&word);
    let Some(first) = lines.next() else { return false };
    let begins = is_keyword(&first, &|word| {
        is_structure(word) || word == b"ANIMSTEPS" || word == b"ATOMS" || word == b"PRIMVEC"
    });
    let has = |is: &dyn Fn(&[u8]) -> bool| {
        is_keyword(&first, is) || { lines.clone() }.any(|fields| is_keyword(&fields, is))
    };
    (begins || has(&is_structure)) && has(&is_other)
}
