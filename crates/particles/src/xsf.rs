//! Reads XSF and AXSF of XCrySDen, in angstrom (xcrysden.org/doc/XSF.html). Grids of data are passed over.

use crate::{
    Cell, FileError, Format, LengthUnit, ParticleFrame, ReadOptions, builder::Builder,
    frame_reader::FrameReader, lines::Lines, number, schema::Schema, source::Source,
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
        let lines = Lines::new(source);
        Self { lines, options: options.clone(), cell: None, periodic: [true; 3] }
    }

    /// Moves to the atoms of the next frame, if there is one.
    fn find(&mut self) -> Result<Option<Atoms>, FileError> {
        while let Some(line) = self.lines.next()? {
            let Some(keyword) = line.fields().next() else { continue };
            if let Some((_, periodic)) = STRUCTURES.iter().find(|(own, _)| *own == keyword) {
                self.periodic = *periodic;
            }
            match keyword {
                b"PRIMVEC" => self.cell = self.vectors()?,
                b"PRIMCOORD" => {
                    let line = self.lines.require("its number of atoms")?;
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
            let line = self.lines.require("its lattice vectors")?;
            let numbers = line.fields().take(3).map(|field| line.number(field));
            let numbers = numbers.collect::<Result<Vec<f64>, FileError>>()?;
            let [x, y, z] = numbers[..] else {
                return Err(line.whole("a lattice vector is three numbers"));
            };
            *vector = DVec3::new(x, y, z);
        }
        Ok(Cell { origin: DVec3::ZERO, vectors, periodic: self.periodic }.checked())
    }
}

impl FrameReader for Xsf {
    fn next(&mut self) -> Result<Option<ParticleFrame>, FileError> {
        let Some(atoms) = self.find()? else { return Ok(None) };
        let columns = self.lines.next()?.map_or(PLAIN, |line| line.fields().count());
        self.lines.back();
        let names = &NAMES[..if columns < NAMES.len() { PLAIN } else { NAMES.len() }];
        let names = names.iter().map(|name| (*name).to_owned()).collect();
        let schema = Schema::new(names, &self.options).map_err(|error| self.lines.ended(error))?;
        let mut builder = Builder::new(self.lines.path(), Format::Xsf, &Arc::new(schema));
        while let Some(line) = self.lines.next()? {
            // Keywords have no number after them, or one.
            if line.fields().nth(1).and_then(number::parse).is_none() || line.fields().count() < 3 {
                self.lines.back();
                break;
            }
            builder.row(&line, line.fields())?;
        }
        let rows = builder.frame.len() as u64;
        if let Atoms::Counted(count) = atoms
            && count != rows
        {
            let message = format!("the coordinates end after {rows} of {count} atoms");
            return Err(self.lines.ended(message));
        }
        let cell = self.cell.filter(|_| self.periodic != [false; 3]);
        Ok(Some(ParticleFrame { cell, unit: LengthUnit::Angstrom, ..builder.finish() }))
    }

    fn more(&mut self) -> Result<bool, FileError> {
        Ok(self.find()?.is_some())
    }
}

/// Returns whether a file begins with a keyword of XSF, alone on its line or with a number, and has atoms.
pub(crate) fn is_xsf(head: &[u8]) -> bool {
    let lines = head.split(|&byte| byte == b'\n').map(<[u8]>::trim_ascii);
    let mut lines = lines.filter(|line| !line.is_empty() && !line.starts_with(b"#"));
    let mut words = lines.next().unwrap_or_default().split(|&byte| byte == b' ');
    let (first, rest) = (words.next().unwrap_or_default(), words.filter(|word| !word.is_empty()));
    let rest: Vec<&[u8]> = rest.collect();
    let numbered = [&b"ANIMSTEPS"[..], b"ATOMS", b"PRIMVEC"].contains(&first);
    let named = STRUCTURES.iter().any(|(own, _)| *own == first);
    let is_first = match rest[..] {
        [] => named || numbered,
        [count] => numbered && number::whole(count).is_some(),
        _ => false,
    };
    let has_line = |keyword: &[u8]| {
        memchr::memmem::find_iter(head, keyword).any(|at| at == 0 || head[at - 1] == b'\n')
    };
    is_first && [&b"PRIMVEC"[..], b"PRIMCOORD", b"ATOMS"].into_iter().any(has_line)
}
