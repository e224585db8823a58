//! Reads topologies of AMBER: sections of values in fixed columns (<https://ambermd.org/prmtop.pdf>). They have no
//! positions: those of the frame are NaN.

use crate::bonds::{End, Listed};
use crate::lines::{Line, Lines};
use crate::schema::Slot;
use crate::unplaced::{self, UnplacedAtoms};
use crate::{
    Bonds, FileError, Format, ParticleFrame, ReadOptions, fields::fixed, frame_reader::FrameReader,
    source::Source,
};
use std::collections::HashMap;

/// Names of the columns of numbers and texts of atoms, with their sections.
const SECTIONS: [(&str, &str); 4] = [
    ("name", "ATOM_NAME"),
    ("atom_type", "AMBER_ATOM_TYPE"),
    ("charge", "CHARGE"),
    ("mass", "MASS"),
];

/// Section of the atomic numbers, from which elements follow.
const ELEMENTS: &str = "ATOMIC_NUMBER";

/// Names of the other columns.
const NUMBERED: [&str; 3] = ["number", "residue_number", "residue"];

/// Sections of the residues, and of the bonds: with hydrogen and without.
const RESIDUES: [&str; 2] = ["RESIDUE_LABEL", "RESIDUE_POINTER"];
const BONDS: [&str; 2] = ["BONDS_INC_HYDROGEN", "BONDS_WITHOUT_HYDROGEN"];

/// Charges are in units in which the energy of two of them at 1 angstrom is in kcal/mol.
const PER_CHARGE: f64 = 18.2223;

/// Values of a section.
enum Values {
    Numbers(Vec<f64>),
    /// Texts of the same width, one after another.
    Texts(Vec<u8>, usize),
}

impl Values {
    fn text(&self, row: usize) -> &[u8] {
        match self {
            Self::Texts(bytes, width) => fixed(bytes, row * width, (row + 1) * width),
            Self::Numbers(_) => b"",
        }
    }

    fn numbers(&self) -> &[f64] {
        match self {
            Self::Numbers(numbers) => numbers,
            Self::Texts(..) => &[],
        }
    }

    fn len(&self) -> usize {
        match self {
            Self::Numbers(numbers) => numbers.len(),
            Self::Texts(bytes, width) => bytes.len() / width,
        }
    }
}

/// Reader of a topology, which is one frame.
pub(in super::super) struct Prmtop {
    lines: Lines,
    options: ReadOptions,
    done: bool,
    sections: HashMap<String, Values>,
}

impl Prmtop {
    pub(in super::super) fn new(source: Source, options: &ReadOptions) -> Self {
        let lines = Lines::new(source);
        Self { lines, options: options.clone(), done: false, sections: HashMap::new() }
    }

    /// Reads the sections that are used.
    fn read(&mut self) -> Result<(), FileError> {
        let reads_bonds = self.options.reads_bonds();
        let is_used = |name: &str| {
            SECTIONS.iter().any(|(_, section)| *section == name)
                || RESIDUES.contains(&name)
                || ["POINTERS", ELEMENTS, "TITLE", "CTITLE"].contains(&name)
                || reads_bonds && BONDS.contains(&name)
        };
        let (mut used, mut is_text, mut width) = (None, false, 0);
        while let Some(line) = self.lines.next()? {
            let text = line.bytes.trim_ascii_end();
            if let Some(flag) = text.strip_prefix(b"%FLAG") {
                let name = String::from_utf8_lossy(flag.trim_ascii()).into_owned();
                used = Some(name).filter(|name| is_used(name));
            } else if text.starts_with(b"%FORMAT") {
                (is_text, width) = layout(text).ok_or_else(|| {
                    line.whole("not a format of columns").with_help("an example is %FORMAT(20a4)")
                })?;
            } else if let Some(name) =
                used.as_ref().filter(|_| !text.starts_with(b"%") && width > 0)
            {
                let values = self.sections.entry(name.clone()).or_insert_with(|| {
                    if is_text {
                        Values::Texts(Vec::new(), width)
                    } else {
                        Values::Numbers(Vec::new())
                    }
                });
                add(values, &line, width)?;
            }
        }
        Ok(())
    }

    /// Takes a section, which must have `count` values at least, of which each atom has one.
    fn take(&mut self, name: &str, count: usize) -> Result<Option<Values>, FileError> {
        let Some(values) = self.sections.remove(name) else { return Ok(None) };
        // Texts may end with blanks.
        let has_more = matches!(&values, Values::Numbers(numbers) if numbers.len() > count);
        if has_more {
            let message =
                format!("{name} has {} values, but there are {count} atoms", values.len());
            return Err(self
                .lines
                .ended(message)
                .with_help("correct the first number of POINTERS"));
        }
        if values.len() < count {
            let message =
                format!("{name} has {} values, but there are {count} atoms", values.len());
            return Err(self.lines.ended(message).with_help("the file is cut off"));
        }
        Ok(Some(values))
    }

    /// Returns the index of the first atom of each residue, and its name.
    fn residues(&mut self) -> Vec<(usize, Vec<u8>)> {
        let [labels, starts] = RESIDUES.map(|name| self.sections.remove(name));
        let (Some(labels), Some(starts)) = (labels, starts) else { return Vec::new() };
        let starts = starts.numbers().iter().map(|&first| (first as usize).saturating_sub(1));
        starts.enumerate().map(|(row, first)| (first, labels.text(row).to_vec())).collect()
    }

    /// Returns the bonds, in which atoms are three times their index; the third number is a type.
    fn bonds(&mut self, atoms: usize) -> Result<Option<Bonds>, FileError> {
        let sections: Vec<Values> =
            BONDS.iter().filter_map(|name| self.sections.remove(*name)).collect();
        if sections.is_empty() {
            return Ok(None);
        }
        let mut bonds = Listed::default();
        for bond in sections.iter().flat_map(|section| section.numbers().chunks_exact(3)) {
            let row = |place: f64| {
                let row = place / 3.0;
                let is_atom = row >= 0.0 && row.fract() == 0.0 && row < atoms as f64;
                End::from(is_atom.then_some(row as u32))
            };
            if let Some([first, second]) = bonds.ends([row(bond[0]), row(bond[1])]) {
                bonds.push(self.lines.path(), (first, second, [0; 3]))?;
            }
        }
        Ok(Some(bonds.finish()))
    }
}

/// Returns whether values are texts, and their width in columns, from `%FORMAT(20a4)`.
fn layout(format: &[u8]) -> Option<(bool, usize)> {
    let inner = format.split(|&byte| byte == b'(').nth(1)?.split(|&byte| byte == b')').next()?;
    let letter = inner.iter().position(u8::is_ascii_alphabetic)?;
    let digits = inner[letter + 1..].iter().take_while(|byte| byte.is_ascii_digit()).count();
    let width = str::from_utf8(&inner[letter + 1..letter + 1 + digits]).ok()?.parse().ok()?;
    let is_text = inner[letter].eq_ignore_ascii_case(&b'a');
    (1..=256).contains(&width).then_some((is_text, width))
}

/// Adds the values of a line to those of its section.
fn add(values: &mut Values, line: &Line, width: usize) -> Result<(), FileError> {
    match values {
        Values::Texts(bytes, own) => {
            bytes.extend_from_slice(line.bytes);
            bytes.resize(bytes.len().next_multiple_of(*own), b' ');
        }
        Values::Numbers(numbers) => {
            for field in line.bytes.trim_ascii_end().chunks(width) {
                numbers.push(line.number(field.trim_ascii())?);
            }
        }
    }
    Ok(())
}

impl FrameReader for Prmtop {
    fn next(&mut self) -> Result<Option<ParticleFrame>, FileError> {
        if std::mem::replace(&mut self.done, true) {
            return Ok(None);
        }
        self.read()?;
        let pointers = self.sections.get("POINTERS").map_or(&[][..], Values::numbers);
        let Some(&count) = pointers.first() else {
            return Err(self.lines.ended("the file has no section POINTERS"));
        };
        let count = count.max(0.0) as usize;
        let mut columns = Vec::new();
        for (name, section) in SECTIONS {
            columns.extend(self.take(section, count)?.map(|values| (name, values)));
        }
        if columns.is_empty() {
            return Err(self.lines.ended("the file has no section ATOM_NAME"));
        }
        let names = columns.iter().map(|(name, _)| *name).chain(NUMBERED);
        let schema = unplaced::schema(names, &self.options);
        let schema = schema.map_err(|message| self.lines.ended(message))?;
        let slots = |column: usize| schema.slots.get(column).copied().unwrap_or(Slot::Skip);
        let mut atoms = UnplacedAtoms::new(self.lines.path(), Format::Prmtop, &schema);
        let residues = self.residues();
        let mut residue = 0;
        let column = |name: &str| columns.iter().find(|(own, _)| *own == name).map(|own| &own.1);
        let (names, masses) = (column("name"), column("mass"));
        let elements = self.take(ELEMENTS, count)?;
        for atom in 0..count {
            while residues.get(residue + 1).is_some_and(|(first, _)| *first <= atom) {
                residue += 1;
            }
            let label = residues.get(residue).map_or(&b""[..], |(_, label)| label);
            let label = String::from_utf8_lossy(label);
            let builder = &mut atoms.builder;
            for (at, (name, values)) in columns.iter().enumerate() {
                match values {
                    Values::Texts(..) => {
                        builder.put_text(slots(at), &String::from_utf8_lossy(values.text(atom)));
                    }
                    Values::Numbers(numbers) => {
                        let scale = if *name == "charge" { PER_CHARGE } else { 1.0 };
                        builder.put_number(slots(at), numbers[atom] / scale);
                    }
                }
            }
            let first = columns.len();
            builder.put_text(slots(first), &(atom + 1).to_string());
            builder.put_text(slots(first + 1), &(residue + 1).to_string());
            builder.put_text(slots(first + 2), &label);
            (3..6).for_each(|axis| builder.put_number(slots(first + axis), f64::NAN));
            builder.end_row()?;
            let text = |values: Option<&Values>| {
                let value = values.and_then(|values| values.numbers().get(atom));
                value.map_or(String::new(), f64::to_string)
            };
            let name = names.map_or(&b""[..], |names| names.text(atom));
            let (number, mass) = (text(elements.as_ref()), text(masses));
            atoms.kind(number.as_bytes(), mass.as_bytes(), name, label.as_bytes());
        }
        let mut frame = atoms.finish();
        frame.bonds = self.bonds(frame.len())?;
        let title = ["TITLE", "CTITLE"].into_iter().find_map(|name| self.sections.get(name));
        if let Some(Values::Texts(bytes, _)) = title {
            frame.title = String::from_utf8_lossy(bytes.trim_ascii()).into_owned();
        }
        Ok(Some(frame))
    }
}

/// Returns whether a file with this head is a topology of AMBER, by its first section.
pub(in super::super) fn is_prmtop(head: &[u8]) -> bool {
    let mut lines = head.split(|&byte| byte == b'\n');
    let first = lines.next().unwrap_or_default();
    (first.starts_with(b"%VERSION") || first.starts_with(b"%FLAG"))
        && memchr::memmem::find(head, b"%FORMAT(").is_some()
}
