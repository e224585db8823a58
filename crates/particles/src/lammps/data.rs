//! LAMMPS data files: a header, and sections in any order (<https://docs.lammps.org/read_data.html>).

use super::bounds::tilted;
use super::style::{self, Chosen, Facts, Layout, Sample};
use super::unit;
use super::velocities::{self, Velocities};
use crate::bonds::{End, Listed, Numbering};
use crate::lines::{Line, Lines};
use crate::naming::{Weighing, drop_uncertain_elements, kind, of_atom};
use crate::schema::{Naming, Schema};
use crate::{
    Bonds, Cell, Element, ElementSource, FileError, Format, Kind, LengthUnit, NumberColumn,
    ParticleFrame, ReadOptions, Role, builder::Builder, error::listed, fields::Fields,
    frame_reader::FrameReader, number, source::Source,
};
use glam::DVec3;
use std::borrow::Cow;
use std::collections::HashMap;
use std::sync::Arc;

/// Names of the columns of the section `Ellipsoids` in dumps.
const ELLIPSOID: [&str; 7] = ["shapex", "shapey", "shapez", "quatw", "quati", "quatj", "quatk"];

/// Reader of the single frame of a data file.
pub(in super::super) struct Data {
    lines: Lines,
    options: ReadOptions,
}

/// The header and the sections other than atoms.
#[derive(Default)]
struct Head {
    title: String,
    atoms: u64,
    /// Number of atom types; 0 if the header has none.
    types: u64,
    /// Type labels, by type number.
    labels: HashMap<String, String>,
    /// Counts of bonds, ellipsoids and the like.
    counts: HashMap<&'static str, u64>,
    low: [f64; 3],
    high: [f64; 3],
    tilt: [f64; 3],
    /// Vectors and origin of a general triclinic box.
    general: [Option<DVec3>; 4],
    has_box: bool,
    /// Masses of types, by type name.
    masses: HashMap<String, Mass>,
    /// Lines of the header that LAMMPS does not know.
    unknown: Vec<String>,
}

/// The mass of a type.
struct Mass {
    mass: f64,
    /// The first word of the comment beside it, by convention the name of the type.
    name: String,
}

impl Mass {
    /// Returns the element that a name of the type says, if it may have this mass.
    fn named(&self, name: &str) -> Option<Element> {
        if number::whole(name.as_bytes()).is_some() {
            return None;
        }
        let by_name = [of_atom(name, "").element, Element::from_label(name)];
        by_name.into_iter().flatten().find(|element| element.may_have_mass(self.mass))
    }

    /// Returns whether the mass is a whole number, as in reduced units.
    fn is_whole(&self) -> bool {
        self.mass.fract() == 0.0
    }
}

impl Data {
    pub(in super::super) fn new(source: Source, options: &ReadOptions) -> Self {
        Self { lines: Lines::new(source), options: options.clone() }
    }

    /// Returns the next line that is neither blank nor a comment.
    fn line(lines: &mut Lines) -> Result<Option<Line<'_>>, FileError> {
        while let Some(line) = lines.next()? {
            if content(line.bytes).is_some() {
                lines.back();
                break;
            }
        }
        lines.next()
    }

    /// Returns whether the next line begins a section, or the file ends.
    fn at_section(&mut self) -> Result<bool, FileError> {
        let section = Self::line(&mut self.lines)?.is_none_or(|line| is_section(line.bytes));
        self.lines.back();
        Ok(section)
    }

    /// Skips the rows of a section and counts them. A body has several rows: its id and the numbers of
    /// integers and floating-point numbers, and then these numbers.
    fn pass(&mut self, bodies: bool) -> Result<u64, FileError> {
        let (mut count, mut numbers) = (0, 0);
        while !self.at_section()? {
            let Some(line) = Self::line(&mut self.lines)? else { break };
            let fields = Fields::blanks(content(line.bytes).unwrap_or_default());
            if !bodies || numbers == 0 {
                count += 1;
                let counts = fields.skip(1).take(2).filter_map(number::whole);
                numbers = counts.fold(0, u64::saturating_add);
            } else {
                numbers = numbers.saturating_sub(fields.count() as u64);
            }
        }
        Ok(count)
    }

    fn masses(&mut self, head: &mut Head) -> Result<(), FileError> {
        self.pairs(|line, kind, mass| {
            let comment = line.bytes.split(|&byte| byte == b'#').nth(1).unwrap_or_default();
            let name = Fields::blanks(comment).next().map(String::from_utf8_lossy);
            let name = name.map_or_else(String::new, Cow::into_owned);
            head.masses.insert(kind, Mass { mass: line.number(mass)?, name });
            Ok(())
        })
    }

    fn labels(&mut self, head: &mut Head) -> Result<(), FileError> {
        self.pairs(|_, number, label| {
            head.labels.insert(number, String::from_utf8_lossy(label).into_owned());
            Ok(())
        })
    }

    /// Reads the section `Bonds`, which follows the atoms: the number and type of each bond, and the numbers
    /// of its atoms.
    fn bonds(&mut self, frame: Option<&ParticleFrame>) -> Result<Bonds, FileError> {
        let column = |frame: &ParticleFrame| {
            let ids = frame.numbers.iter().find(|column| column.name == velocities::ID);
            ids.map(|ids| Numbering::of(&ids.values))
        };
        let Some(ids) = frame.and_then(column) else {
            let error = self.lines.ended("the section `Bonds` precedes the atoms");
            return Err(error.with_help("move it below the section `Atoms`"));
        };
        let path = self.lines.path().clone();
        let mut bonds = Listed::default();
        while !self.at_section()? {
            let Some(line) = Self::line(&mut self.lines)? else { break };
            let mut fields = Fields::blanks(content(line.bytes).unwrap_or_default()).skip(1);
            let [Some(kind), Some(first), Some(second)] = [(); 3].map(|()| fields.next()) else {
                let help = "a row is a number, a type and the numbers of two atoms";
                return Err(line.whole("not the columns of a bond").with_help(help));
            };
            if let Some([first, second]) =
                bonds.ends([ids.row(&line, first)?, ids.row(&line, second)?])
            {
                bonds.push_named(&path, (first, second, [0; 3]), kind)?;
            }
        }
        Ok(bonds.finish())
    }

    /// Reads the section `Ellipsoids`, which follows the atoms: the number of each one's atom, its three diameters and its quaternion. Adds
    /// them as the columns that dumps have; atoms without an ellipsoid have diameters of 0.
    fn ellipsoids(&mut self, frame: &mut ParticleFrame) -> Result<(), FileError> {
        let ids = frame.numbers.iter().find(|column| column.name == velocities::ID);
        let Some(ids) = ids.map(|ids| Numbering::of(&ids.values)) else { return Ok(()) };
        let mut values = [(); ELLIPSOID.len()].map(|()| vec![0.0; frame.len()]);
        let mut unclear = 0_u64;
        while !self.at_section()? {
            let Some(line) = Self::line(&mut self.lines)? else { break };
            let mut fields = Fields::blanks(content(line.bytes).unwrap_or_default());
            let mut field = || {
                let help = "a row is the number of an atom, three diameters and a quaternion";
                let error = || line.whole("not the columns of an ellipsoid").with_help(help);
                fields.next().ok_or_else(error)
            };
            let End::Atom(row) = ids.row(&line, field()?)? else {
                unclear += 1;
                continue;
            };
            for column in &mut values {
                column[row as usize] = line.number(field()?)?;
            }
        }
        if unclear > 0 {
            let (are, of) =
                if unclear == 1 { ("ellipsoid is", "its") } else { ("ellipsoids are", "their") };
            frame.warnings.push(format!(
                "{unclear} {are} left out: no atom has {of} number, or several have it"
            ));
        }
        for (name, values) in ELLIPSOID.into_iter().zip(values) {
            frame.numbers.push(NumberColumn { name: name.to_owned(), values });
            frame.columns.push(name.to_owned());
        }
        Ok(())
    }

    /// Calls a function with the first two fields of each row of a section.
    fn pairs(
        &mut self,
        mut take: impl FnMut(&Line, String, &[u8]) -> Result<(), FileError>,
    ) -> Result<(), FileError> {
        while !self.at_section()? {
            let Some(line) = Self::line(&mut self.lines)? else { break };
            let mut fields = line.fields();
            if let (Some(first), Some(second)) = (fields.next(), fields.next()) {
                take(&line, String::from_utf8_lossy(first).into_owned(), second)?;
            }
        }
        Ok(())
    }

    /// Reads the section `Atoms`; `comment` follows its name and may be empty.
    fn atoms(&mut self, head: &Head, comment: &str) -> Result<ParticleFrame, FileError> {
        let (layout, warning) = self.layout(head, comment)?;
        let known = [(Role::Kind, "type")];
        let schema = Schema::with_roles(layout.columns, &self.options, &known)
            .map_err(|message| self.lines.ended(message))?;
        let path = self.lines.path().clone();
        let mut builder = Builder::new(&path, Format::LammpsData, &Arc::new(schema));
        let is_ambiguous = warning.is_some();
        builder.frame.warnings.extend(warning);
        for atom in 0..head.atoms {
            let Some(line) = Self::line(&mut self.lines)? else {
                let message = format!("the file ends after {atom} of {} atoms", head.atoms);
                return Err(self.lines.ended(message).with_help("the file is cut off"));
            };
            if is_section(line.bytes) {
                let message = format!("the section ends after {atom} of {} atoms", head.atoms);
                return Err(line.whole(message).with_help("correct the number in the header"));
            }
            builder.row(&line, line.fields())?;
        }
        if self.pass(false)? > 0 {
            builder.warn_of_more_rows();
        }
        let mut frame = builder.finish();
        if !is_ambiguous {
            frame.warnings.extend(head.unknown_type(&frame));
        }
        Ok(frame)
    }

    /// Returns the columns of the following rows, and a warning if they are ambiguous.
    fn layout(
        &mut self,
        head: &Head,
        comment: &str,
    ) -> Result<(Layout, Option<String>), FileError> {
        let sample = Sample::new(self.peek()?);
        let facts = head.facts();
        if let Some(style) = &self.options.atom_style {
            let Some(Chosen { layout, misfit, .. }) = facts.named(style, &sample) else {
                let error = self.lines.ended(format!("the atom style `{style}` is not known"));
                return Err(error.with_help(format!("styles are {}", style::names().join(", "))));
            };
            let warning = misfit.map(|reason| {
                format!("the atom style `{style}` does not fit the rows of `Atoms`: {reason}")
            });
            return Ok((layout, warning));
        }
        let named = facts.named(comment.trim(), &sample);
        if let Some(Chosen { layout, misfit: None, .. }) = named {
            return Ok((layout, None));
        }
        let guess = facts.guess(&sample);
        match (named, guess) {
            (Some(Chosen { misfit: Some(reason), .. }), Some(guess)) => {
                let style = guess.layout.style.clone();
                let warning = format!(
                    "its rows do not fit the atom style of `Atoms #{comment}` ({reason}), and are \
                     read as `{style}`; name another style with --atom-style"
                );
                Ok((guess.layout, Some(warning)))
            }
            (Some(Chosen { layout, misfit: Some(reason), .. }), None)
                if sample.width() >= layout.columns.len() =>
            {
                let warning = format!(
                    "its rows do not fit the atom style of `Atoms #{comment}`: {reason}; name \
                     another style with --atom-style"
                );
                Ok((layout, Some(warning)))
            }
            (_, Some(guess)) => {
                let warning = guess.warning();
                Ok((guess.layout, Some(warning)))
            }
            (named, None) => {
                let why = named.and_then(|named| named.misfit).unwrap_or_else(|| {
                    format!("its rows of {} columns fit no style", sample.width())
                });
                let message = format!("the atom style of the section `Atoms` is not known: {why}");
                let names = style::names().join(", ");
                let help = format!("name it with --atom-style, which takes {names}");
                Err(self.lines.ended(message).with_help(help))
            }
        }
    }

    /// Returns the fields of up to a block of following rows without consuming them.
    fn peek(&mut self) -> Result<Vec<Vec<String>>, FileError> {
        let text = self.lines.ahead()?;
        let complete = memchr::memrchr(b'\n', text).map_or(text, |newline| &text[..newline]);
        let rows = complete.split(|&byte| byte == b'\n').filter_map(content);
        let rows = rows.take_while(|row| !is_section(row));
        let fields = |row| Fields::blanks(row).map(|field| String::from_utf8_lossy(field).into());
        Ok(rows.map(|row| fields(row).collect()).collect())
    }
}

/// Returns a line without its comment; `None` if nothing else is left.
fn content(line: &[u8]) -> Option<&[u8]> {
    let end = memchr::memchr(b'#', line).unwrap_or(line.len());
    Some(line[..end].trim_ascii()).filter(|content| !content.is_empty())
}

/// Returns whether a line is the name of a section: a word, while rows begin with a number or a label.
fn is_section(line: &[u8]) -> bool {
    let content = content(line).unwrap_or_default();
    content.first().is_some_and(u8::is_ascii_uppercase)
        && content.iter().all(|&byte| byte.is_ascii_alphabetic() || byte == b' ' || byte == b'/')
}

impl FrameReader for Data {
    fn next(&mut self) -> Result<Option<ParticleFrame>, FileError> {
        let Some(title) = self.lines.next()? else { return Ok(None) };
        let mut head = Head { title: title.text().trim().to_owned(), ..Head::default() };
        let mut lends_ids = self.options.reads_bonds() && velocities::want_ids(&mut self.options);
        let mut velocities = Velocities::take(&mut self.options);
        let (mut frame, mut bonds) = (None, None);
        let mut undrawn = Vec::new();
        while let Some(line) = Self::line(&mut self.lines)? {
            if !is_section(line.bytes) {
                head.read(&line)?;
                continue;
            }
            let text = line.text().into_owned();
            let (name, comment) = text.split_once('#').unwrap_or((&text, ""));
            match name.trim() {
                "Masses" => self.masses(&mut head)?,
                "Atom Type Labels" => self.labels(&mut head)?,
                "Atoms" => {
                    if head.counts.contains_key("ellipsoids") {
                        lends_ids |= velocities::want_ids(&mut self.options);
                    }
                    frame = Some(self.atoms(&head, comment)?);
                }
                "Velocities" if velocities.find(head.atoms) => {
                    while !self.at_section()? {
                        let line = Self::line(&mut self.lines)?;
                        line.iter().try_for_each(|line| velocities.row(line))?;
                    }
                }
                "Bonds" if self.options.reads_bonds() => bonds = Some(self.bonds(frame.as_ref())?),
                "Ellipsoids" if frame.is_some() && head.counts.contains_key("ellipsoids") => {
                    frame.iter_mut().try_for_each(|frame| self.ellipsoids(frame))?;
                }
                section => {
                    let count = self.pass(section == "Bodies")?;
                    undrawn.extend(super::undrawn(section).map(|kind| (kind, count)));
                }
            }
        }
        let mut frame = frame.ok_or_else(|| {
            self.lines
                .ended("no section `Atoms`")
                .with_help("the file is cut off, or not a data file")
        })?;
        velocities.complete(&mut frame, &self.lines)?;
        if lends_ids {
            frame.numbers.retain(|column| column.name != velocities::ID);
        }
        frame.bonds = bonds;
        for (kind, count) in undrawn {
            frame.add_undrawn(kind, count);
        }
        Ok(Some(head.complete(frame)))
    }
}

impl Head {
    /// Reads a line of the header: numbers and a keyword.
    fn read(&mut self, line: &Line) -> Result<(), FileError> {
        let words: Vec<&[u8]> = line.fields().take_while(|word| !word.starts_with(b"#")).collect();
        let first = words.iter().position(|word| number::parse(word).is_none());
        let (numbers, names) = words.split_at(first.unwrap_or(words.len()));
        let values = || numbers.iter().map(|field| number::parse(field).unwrap_or(0.0));
        let vector = |at: usize| {
            let value = |axis: usize| values().nth(at + axis).unwrap_or(f64::NAN);
            DVec3::new(value(0), value(1), value(2))
        };
        let pair = |at: usize| [vector(0)[0], vector(0)[1]][at];
        let count = match names {
            [b"xlo", b"xhi"] | [b"ylo", b"yhi"] | [b"zlo", b"zhi"] => 2,
            [b"xy", b"xz", b"yz"] | [b"avec" | b"bvec" | b"cvec"] | [b"abc", b"origin"] => 3,
            _ => 0,
        };
        if numbers.len() < count {
            let help = "a line of the header has its numbers before its name";
            let message = format!("{} numbers, but there must be {count}", numbers.len());
            return Err(line.whole(message).with_help(help));
        }
        match names {
            [b"atoms"] => self.atoms = line.whole_number(numbers.first().unwrap_or(&&b""[..]))?,
            [b"atom", b"types"] => self.types = vector(0)[0] as u64,
            [b"xlo", b"xhi"] => {
                (self.low[0], self.high[0], self.has_box) = (pair(0), pair(1), true);
            }
            [b"ylo", b"yhi"] => (self.low[1], self.high[1]) = (pair(0), pair(1)),
            [b"zlo", b"zhi"] => (self.low[2], self.high[2]) = (pair(0), pair(1)),
            [b"xy", b"xz", b"yz"] => self.tilt = vector(0).to_array(),
            [b"avec"] => self.general[0] = Some(vector(0)),
            [b"bvec"] => self.general[1] = Some(vector(0)),
            [b"cvec"] => self.general[2] = Some(vector(0)),
            [b"abc", b"origin"] => self.general[3] = Some(vector(0)),
            [thing] => {
                let thing = style::counted().find(|counted| counted.as_bytes() == *thing);
                let count = numbers.first().and_then(|count| number::whole(count));
                self.counts.extend(thing.zip(count));
            }
            [] | [_, b"types"] | [b"extra", ..] => (),
            _ => self.unknown.push(format!("`{}`", line.text().trim())),
        }
        Ok(())
    }

    /// Returns the properties that rows of atoms must be consistent with.
    fn facts(&self) -> Facts<'_> {
        Facts {
            types: self.types,
            labels: self.labels.values().map(String::as_str).collect(),
            counts: self.counts.clone(),
            cell: self.cell(),
        }
    }

    /// Returns a warning about the first type that the header doesn't define.
    fn unknown_type(&self, frame: &ParticleFrame) -> Option<String> {
        let mut numbers =
            frame.kinds.table.iter().filter_map(|kind| number::whole(kind.name.as_bytes()));
        let facts = self.facts();
        let unknown = numbers.find(|&number| !facts.has_type(number))?;
        Some(format!(
            "an atom is of type {unknown}, but the header has {} atom types; if the columns are \
             those of another atom style, name it with --atom-style",
            self.types
        ))
    }

    /// Returns the label of a type, by its number or label.
    fn label<'h>(&'h self, kind: &'h str) -> &'h str {
        self.labels.get(kind).map_or(kind, String::as_str)
    }

    fn cell(&self) -> Option<Cell> {
        if let [Some(a), Some(b), Some(c), origin] = self.general {
            let origin = origin.unwrap_or(DVec3::ZERO);
            return Cell { origin, vectors: [a, b, c], periodic: [true; 3] }.declared();
        }
        self.has_box.then(|| tilted(self.low, self.high, self.tilt)).and_then(Cell::declared)
    }

    /// Returns the types with the elements of their names and masses. None have one if all masses of elements are 1, which is
    /// the usual mass of particles that aren't atoms, or small whole numbers without names, as in reduced units; then
    /// a warning is added if charges don't tell.
    fn weighed(&self, frame: &mut ParticleFrame, weighing: &mut Weighing) -> Option<Vec<Kind>> {
        let masses = self.masses.iter().map(|(kind, mass)| (self.label(kind), mass));
        let masses: HashMap<&str, &Mass> = masses.collect();
        let (mut heavy, mut certain) = (false, false);
        let kinds = frame.kinds.table.iter().map(|kind| {
            let Some(own) = masses.get(kind.name.as_str()) else { return kind.clone() };
            let names = [own.name.as_str(), kind.name.as_str()];
            let named = names.into_iter().find_map(|name| Some((name, own.named(name)?)));
            let (name, element) = named.map_or(("", None), |(name, element)| (name, Some(element)));
            let source = ElementSource::Name;
            let named = Kind { element, source, ..kind.clone() };
            let weighed = weighing.weigh(named, name, own.mass);
            heavy |= weighed.element.is_some() && own.mass > 2.5;
            certain |= weighed.element.is_some() && (element.is_some() || !own.is_whole());
            if weighed.element.is_some() { weighed } else { kind.clone() }
        });
        let kinds: Vec<Kind> = kinds.collect();
        let is_charged = frame.columns.iter().any(|name| name == "q");
        if heavy && !certain && !is_charged {
            if frame.kinds.table.iter().all(|kind| kind.element.is_none()) {
                let warning = "its masses are whole numbers, as in reduced units, so its types have no elements; \
                               comments in `Masses` name them, as in `1 12.0 # C`";
                frame.warnings.push(warning.to_owned());
            }
            return None;
        }
        heavy.then_some(kinds)
    }

    fn complete(self, mut frame: ParticleFrame) -> ParticleFrame {
        let units = self.title.split_once("units = ").map(|(_, units)| units);
        let units = units.and_then(|units| units.split([',', ' ']).next()).unwrap_or("");
        frame.unit = unit(units);
        if !self.labels.is_empty() {
            frame.kinds.rename(|name| kind(self.label(name), Naming::Types));
            drop_uncertain_elements(&mut frame.kinds, Naming::Types);
        }
        let mut weighing = Weighing::default();
        let has_masses = units != "lj";
        if has_masses && let Some(kinds) = self.weighed(&mut frame, &mut weighing) {
            frame.kinds.table = kinds;
            drop_uncertain_elements(&mut frame.kinds, Naming::Symbols);
            if frame.kinds.table.iter().any(|kind| kind.element.is_some()) {
                weighing.warn(&mut frame);
                if frame.unit == LengthUnit::Unknown {
                    frame.unit = LengthUnit::Angstrom;
                }
            }
        }
        if !self.unknown.is_empty() {
            let lines: Vec<&str> = self.unknown.iter().map(String::as_str).collect();
            frame.warnings.push(listed("lines of its header that are not known", &lines));
        }
        frame.cell = self.cell();
        frame.title = self.title;
        frame
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sections_begin_with_a_capital_and_have_only_letters() {
        for line in ["Atoms", " Atoms # full", "Atom Type Labels", "PairIJ Coeffs", "Types/kk"] {
            assert!(is_section(line.as_bytes()), "{line}");
        }
        for line in ["", "# Atoms", "atoms", "xlo xhi", "C1 12.011", "O-2", "1 Atoms", "2 atoms"] {
            assert!(!is_section(line.as_bytes()), "{line}");
        }
    }
}
