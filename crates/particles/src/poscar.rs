//! Reads POSCAR, CONTCAR and XDATCAR of VASP, in angstrom (vasp.at/wiki/index.php/POSCAR). XDATCAR has several
//! frames, whose cell may change.

use crate::lines::{Line, Lines};
use crate::schema::{Naming, Schema, Slot};
use crate::{
    Cell, Element, FileError, Format, LengthUnit, ParticleFrame, ReadOptions, builder::Builder,
    fields::Fields, frame_reader::FrameReader, number, place::Place, source::Source,
};
use glam::DVec3;
use std::sync::Arc;

/// The line before each frame of XDATCAR.
const CONFIGURATION: &[u8] = b"Direct configuration";

/// Maximum number of species.
const SPECIES: usize = 10_000;

/// Marks of comments at the ends of lines.
const COMMENT: &[u8] = b"!#";

/// Reader of the frames of a file.
pub(crate) struct Poscar {
    lines: Lines,
    schema: Result<Arc<Schema>, String>,
    known: Arc<Known>,
}

/// Facts of earlier frames.
#[derive(Clone, Default)]
struct Known {
    header: Option<Arc<Header>>,
    /// True if the file is XDATCAR.
    several: bool,
    done: bool,
}

/// What precedes the positions.
struct Header {
    title: String,
    /// Factor on positions that are not fractional.
    scale: DVec3,
    cell: Cell,
    /// Names of the species, and the number of atoms of each.
    species: Vec<(String, u64)>,
    /// True if names are element symbols.
    has_symbols: bool,
}

impl Poscar {
    pub(crate) fn new(source: Source, options: &ReadOptions) -> Self {
        let names = ["species", "x", "y", "z"].map(str::to_owned).into();
        let schema = Schema::new(names, options).map(Arc::new);
        Self { lines: Lines::new(source), schema, known: Arc::default() }
    }

    fn header(&mut self) -> Result<Header, FileError> {
        let title = self.lines.require("its title")?.text().trim().to_owned();
        let line = self.lines.require("its scale")?.without_comment(COMMENT);
        let scales = numbers(&line)?;
        let wrong_scale = line.whole("the scale is not one or three numbers");
        let mut vectors = [DVec3::ZERO; 3];
        for vector in &mut vectors {
            let line = self.lines.require("its lattice vectors")?;
            let [x, y, z] = first_three(&line)?;
            *vector = DVec3::new(x, y, z);
        }
        let volume = vectors[0].cross(vectors[1]).dot(vectors[2]).abs();
        let scale = match scales[..] {
            // A negative scale is the volume.
            [scale] if scale < 0.0 => DVec3::splat(libm::cbrt(-scale / volume)),
            [scale] => DVec3::splat(scale),
            [x, y, z] => DVec3::new(x, y, z),
            _ => return Err(wrong_scale),
        };
        let cell = Cell {
            origin: DVec3::ZERO,
            vectors: vectors.map(|vector| vector * scale),
            periodic: [true; 3],
        };
        let line = self.lines.require("its numbers of atoms")?.without_comment(COMMENT);
        let no_cell = line.whole("the lattice vectors before have no volume");
        let cell = cell.with_volume().ok_or(no_cell)?;
        let mut symbols = None;
        if line.fields().next().is_some_and(|field| number::whole(field).is_none()) {
            symbols = Some(line.fields().map(symbol).collect::<Vec<String>>());
        }
        let line =
            if symbols.is_some() { self.lines.require("its numbers of atoms")? } else { line };
        let line = line.without_comment(COMMENT);
        let counts = line.fields().take(SPECIES).map(|field| line.whole_number(field));
        let counts = counts.collect::<Result<Vec<u64>, FileError>>()?;
        // Before version 5, symbols stood in the title, if anywhere.
        let symbols = symbols.or_else(|| {
            let words: Vec<String> = title.split_whitespace().map(str::to_owned).collect();
            let known = words.iter().all(|word| Element::from_symbol(word).is_some());
            (known && words.len() == counts.len()).then_some(words)
        });
        let names = match &symbols {
            Some(symbols) if symbols.len() != counts.len() => {
                let message =
                    format!("{} numbers of atoms, but {} species", counts.len(), symbols.len());
                return Err(line.whole(message));
            }
            Some(symbols) => symbols.clone(),
            None => (1..=counts.len()).map(|number| number.to_string()).collect(),
        };
        let species = names.into_iter().zip(counts).collect();
        Ok(Header { title, scale, cell, species, has_symbols: symbols.is_some() })
    }

    /// Reads what precedes the positions of a frame. Returns whether they are fractional; `None` if there is no
    /// other frame.
    fn start(&mut self) -> Result<Option<bool>, FileError> {
        if self.known.done || !self.lines.more()? {
            return Ok(None);
        }
        let line = self.lines.require("its title")?;
        let again =
            self.known.header.is_some() && line.bytes.trim_ascii_start().starts_with(CONFIGURATION);
        if again {
            return Ok(Some(true));
        }
        self.lines.back();
        let header = Some(Arc::new(self.header()?));
        Arc::make_mut(&mut self.known).header = header;
        let mut line = self.lines.require("its positions")?;
        let first = |line: &Line| line.bytes.trim_ascii_start().first().map(u8::to_ascii_lowercase);
        if first(&line) == Some(b's') {
            line = self.lines.require("its positions")?;
        }
        let is_configuration = line.bytes.trim_ascii_start().starts_with(CONFIGURATION);
        let fractional = match first(&line) {
            Some(b'c' | b'k') => false,
            Some(b'd') => true,
            _ => {
                let help = "the line before positions begins with D for fractional ones, or with C";
                return Err(line.whole("not a kind of coordinates").with_help(help));
            }
        };
        let known = Arc::make_mut(&mut self.known);
        known.several = is_configuration;
        known.done = !is_configuration;
        Ok(Some(fractional))
    }
}

/// Returns the symbol of a species: the names of potentials follow it, as in `Fe_pv`.
fn symbol(field: &[u8]) -> String {
    let text = String::from_utf8_lossy(field);
    text.split(['_', '/']).next().unwrap_or_default().to_owned()
}

fn numbers(line: &Line) -> Result<Vec<f64>, FileError> {
    line.fields().take(4).map(|field| line.number(field)).collect()
}

fn first_three(line: &Line) -> Result<[f64; 3], FileError> {
    let numbers = line.fields().take(3).map(|field| line.number(field));
    let numbers = numbers.collect::<Result<Vec<f64>, FileError>>()?;
    numbers.try_into().map_err(|_| line.whole("three numbers are expected here"))
}

impl FrameReader for Poscar {
    fn next(&mut self) -> Result<Option<ParticleFrame>, FileError> {
        let schema = self.schema.clone().map_err(|message| self.lines.ended(message))?;
        let Some(fractional) = self.start()? else { return Ok(None) };
        let Some(header) = self.known.header.clone() else { return Ok(None) };
        let naming = if header.has_symbols { Naming::Symbols } else { Naming::Types };
        let schema = Arc::new(Schema { naming, ..Schema::clone(&schema) });
        let mut builder = Builder::new(self.lines.path(), Format::Poscar, &schema);
        for (name, count) in &header.species {
            for _ in 0..*count {
                let line = self.lines.require("its last position")?;
                let place = first_three(&line)?;
                let place = if fractional {
                    header.cell.cartesian(place)
                } else {
                    DVec3::from_array(place) * header.scale
                };
                builder.push(place.to_array())?;
                for (column, slot) in schema.used_columns() {
                    if slot == Slot::Kind && column == 0 {
                        builder.kind(name.as_bytes());
                    }
                }
            }
        }
        // Velocities may follow after a blank line.
        if !self.known.several && self.lines.next()?.is_some_and(|line| first_three(&line).is_ok())
        {
            builder.warn_of_more_rows();
        }
        let frame = builder.finish();
        let (cell, title) = (Some(header.cell), header.title.clone());
        Ok(Some(ParticleFrame { cell, title, unit: LengthUnit::Angstrom, ..frame }))
    }

    fn skip(&mut self) -> Result<bool, FileError> {
        if self.start()?.is_none() {
            return Ok(false);
        }
        let species = self.known.header.iter().flat_map(|header| &header.species);
        let rows = species.fold(0, |rows: u64, (_, count)| rows.saturating_add(*count));
        Ok(self.lines.skip(rows)? == rows)
    }

    fn more(&mut self) -> Result<bool, FileError> {
        if self.known.several { self.lines.more() } else { Ok(false) }
    }

    fn place(&self) -> Option<Place> {
        Some(self.lines.place()?.with_state(&self.known))
    }

    fn start_at(&mut self, place: &Place) -> Result<bool, FileError> {
        self.lines.start_with(place, &mut self.known)
    }
}

/// Returns whether a file with this head is POSCAR: a comment, a scale, three lattice vectors, element names
/// and numbers of atoms or only these, and the kind of coordinates.
pub(crate) fn is_poscar(head: &[u8]) -> bool {
    let lines: Vec<&[u8]> = head.split(|&byte| byte == b'\n').take(9).collect();
    let line = |line: usize| {
        let content =
            lines.get(line).and_then(|line| line.split(|byte| COMMENT.contains(byte)).next());
        content.unwrap_or_default()
    };
    let has = |row: usize, count: usize| {
        let numbers: Option<Vec<f64>> = Fields::blanks(line(row)).map(number::parse).collect();
        numbers.is_some_and(|numbers| numbers.len() == count)
    };
    let counts = |row: usize| {
        let mut fields = Fields::blanks(line(row)).peekable();
        fields.peek().is_some() && fields.all(|field| number::whole(field).is_some())
    };
    let coordinates = |row: usize| {
        line(row).trim_ascii_start().first().is_some_and(|letter| b"sSdDcCkK".contains(letter))
    };
    let scale = has(1, 1) || has(1, 3);
    scale
        && (2..5).all(|row| has(row, 3))
        && (counts(5) && coordinates(6) || counts(6) && coordinates(7))
}
