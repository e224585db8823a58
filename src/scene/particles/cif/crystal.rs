//! CIF of crystals: a cell, the atoms that differ, and the symmetry that makes the others of them
//! (CIF core dictionary, <https://www.iucr.org/resources/cif/dictionaries/cif_core>).

use super::rows::Rows;
use super::symmetry::{Operation, images};
use super::tokens::{Token, Tokens};
use crate::memory;
use crate::scene::particles::builder::Builder;
use crate::scene::particles::element::Element;
use crate::scene::particles::frame::{Cell, LengthUnit, ParticleFrame};
use crate::scene::particles::lines::Lines;
use crate::scene::particles::number;
use crate::scene::particles::options::{Format, ReadOptions, Role};
use crate::scene::particles::reader::FrameReader;
use crate::scene::particles::schema::Schema;
use crate::scene::particles::source::Source;
use crate::scene::{SceneError, Spheres};
use glam::DVec3;
use memchr::memmem;
use std::sync::Arc;

/// What the names of the columns of atoms begin with; newer files have a point at the end.
const SITE: &str = "_atom_site_";

/// Shares of the edges.
const SHARES: [(Role, &str); 3] =
    [(Role::X, "fract_x"), (Role::Y, "fract_y"), (Role::Z, "fract_z")];

/// Columns of numbers, some of which may be unknown.
const NUMBERS: [&str; 3] = ["occupancy", "U_iso_or_equiv", "B_iso_or_equiv"];

/// What operations of symmetry are called, now and before.
const OPERATIONS: [&str; 2] = ["_space_group_symop_operation_xyz", "_symmetry_equiv_pos_as_xyz"];

/// No group of space has more operations.
const MOST: usize = 192;

/// What is taken for a title, the best last.
const TITLES: [&str; 4] = [
    "_chemical_formula_sum",
    "_chemical_name_systematic",
    "_chemical_name_common",
    "_chemical_name_mineral",
];

/// Reads the blocks of a file, one frame each.
pub(in super::super) struct Crystal {
    tokens: Tokens,
    options: ReadOptions,
}

/// What a block says, in whatever order.
struct Block {
    title: (usize, String),
    group: String,
    lengths: [f64; 3],
    angles: [f64; 3],
    operations: Vec<Operation>,
    /// Places are shares of the edges.
    atoms: Option<ParticleFrame>,
}

impl Default for Block {
    fn default() -> Self {
        Self {
            title: (0, String::new()),
            group: String::new(),
            lengths: [0.0; 3],
            // What they are where a file does not say.
            angles: [90.0; 3],
            operations: Vec::new(),
            atoms: None,
        }
    }
}

impl Crystal {
    pub(in super::super) fn new(source: Source, options: &ReadOptions) -> Self {
        Self { tokens: Tokens::new(Lines::new(source)), options: options.clone() }
    }

    /// A tag and its value.
    fn item(&mut self, tag: &str, block: &mut Block) -> Result<(), SceneError> {
        let Some(Token::Value(value)) = self.tokens.next()? else {
            self.tokens.back();
            return Ok(());
        };
        let text = String::from_utf8_lossy(value).trim().to_owned();
        let axis = |letters: [&str; 3]| letters.iter().position(|letter| tag == *letter);
        let number = || self.tokens.line().number(certain(text.as_bytes()));
        if let Some(edge) = axis(["_cell_length_a", "_cell_length_b", "_cell_length_c"]) {
            block.lengths[edge] = number()?;
        } else if let Some(angle) =
            axis(["_cell_angle_alpha", "_cell_angle_beta", "_cell_angle_gamma"])
        {
            block.angles[angle] = number()?;
        } else if let Some(rank) = TITLES.iter().position(|title| *title == tag) {
            if text != "?" && text != "." && rank >= block.title.0 {
                block.title = (rank, text);
            }
        } else if ["_symmetry_space_group_name_h-m", "_space_group_name_h-m_alt"].contains(&tag) {
            block.group = text;
        } else if OPERATIONS.contains(&tag) {
            block.operations.push(self.operation(&text)?);
        }
        Ok(())
    }

    fn operation(&self, text: &str) -> Result<Operation, SceneError> {
        Operation::parse(text).ok_or_else(|| {
            let error = self.tokens.error(format!("`{text}` is no operation of symmetry"));
            error.with_help("operations are written as in -x, y+1/2, z")
        })
    }

    /// A loop: operations, atoms, or what is passed over.
    fn list(&mut self, block: &mut Block) -> Result<(), SceneError> {
        let mut tags = Vec::new();
        while let Some(Token::Tag(tag)) = self.tokens.next()? {
            tags.push(tag.to_owned());
        }
        self.tokens.back();
        let is_share = |tag: &String| plain(tag) == format!("{SITE}{}", SHARES[0].1);
        let is_operation = |tag: &String| OPERATIONS.contains(&&plain(tag)[..]);
        if tags.iter().any(is_share) {
            block.atoms = Some(self.atoms(&tags)?);
        } else if let Some(column) = tags.iter().position(is_operation) {
            let mut rows = Rows::new(tags.len());
            while rows.read(&mut self.tokens)? {
                let text = String::from_utf8_lossy(rows.field(column)).into_owned();
                block.operations.push(self.operation(&text)?);
                if block.operations.len() > MOST {
                    let message = format!("more than {MOST} operations of symmetry");
                    return Err(self.tokens.error(message).with_help("no group has so many"));
                }
            }
        }
        Ok(())
    }

    /// The atoms of a loop, their places in shares.
    fn atoms(&mut self, tags: &[String]) -> Result<ParticleFrame, SceneError> {
        let names = tags.iter().map(|tag| tag.get(SITE.len()..).unwrap_or(tag).to_owned());
        let names: Vec<String> = names.collect();
        let has_symbols = names.iter().any(|name| name == "type_symbol");
        let label = (!has_symbols).then_some((Role::Kind, "label"));
        let known: Vec<(Role, &str)> = SHARES.into_iter().chain(label).collect();
        let places = SHARES.map(|(_, share)| names.iter().position(|name| name == share));
        if let Some(axis) = places.iter().position(Option::is_none) {
            let message = format!("no {SITE}{} in this loop of atoms", SHARES[axis].1);
            return Err(self.tokens.error(message));
        }
        let schema = Schema::with_roles(names, &self.options, &known)
            .map_err(|message| self.tokens.error(message))?;
        let mut builder = Builder::new(self.tokens.path(), Format::Cif, &Arc::new(schema));
        builder.declare(&["label"], &NUMBERS);
        let (mut rows, mut nowhere) = (Rows::new(tags.len()), 0_u64);
        while rows.read(&mut self.tokens)? {
            let unknown = |column: &usize| matches!(rows.field(*column), b"." | b"?");
            if places.iter().flatten().any(unknown) {
                nowhere += 1;
            } else {
                builder.row(&self.tokens.line(), rows.fields().map(certain))?;
            }
        }
        if nowhere > 0 {
            let warning = format!("{nowhere} atoms without a place are left out");
            builder.frame.warnings.push(warning);
        }
        let mut atoms = builder.finish();
        if !has_symbols {
            for kind in &mut atoms.kinds.table {
                kind.element = kind.element.or_else(|| element(&kind.name));
            }
        }
        Ok(atoms)
    }

    /// The frame of a block; `None` if it has no atoms.
    fn frame(&self, mut block: Block) -> Result<Option<ParticleFrame>, SceneError> {
        let Some(mut atoms) = block.atoms.take() else { return Ok(None) };
        let fault = |message: String| SceneError::whole_file(self.tokens.path(), message);
        let (lengths, angles) = (block.lengths, block.angles);
        let cell = Cell::of_lengths(lengths, angles).ok_or_else(|| {
            let message = format!("there is no cell with edges {lengths:?} and angles {angles:?}");
            fault(message).with_help("a crystal needs _cell_length_a, _b and _c, and its angles")
        })?;
        let places = block.operations.len().max(1) as u64 * atoms.len() as u64;
        memory::check(places.saturating_mul(Spheres::BYTES))
            .map_err(|shortage| fault(format!("its {places} places need {shortage}")))?;
        if let [] | [_] = block.operations[..] {
            place(&mut atoms, &cell);
            let trivial = ["", "?", ".", "P1"].contains(&block.group.replace(' ', "").as_str());
            if block.operations.is_empty() && !trivial {
                let group = &block.group;
                let warning = format!(
                    "the operations of its symmetry, {group}, are not listed, so only the atoms \
                     that are listed are drawn"
                );
                atoms.warnings.push(warning);
            }
        } else {
            spread(&mut atoms, &block.operations, &cell);
        }
        let (unit, title) = (LengthUnit::Angstrom, block.title.1);
        Ok(Some(ParticleFrame { cell: Some(cell), unit, title, ..atoms }))
    }
}

impl FrameReader for Crystal {
    fn next(&mut self) -> Result<Option<ParticleFrame>, SceneError> {
        let mut block = Block::default();
        while let Some(token) = self.tokens.next()? {
            match token {
                Token::Loop => self.list(&mut block)?,
                Token::Tag(tag) => {
                    let tag = plain(tag);
                    self.item(&tag, &mut block)?;
                }
                Token::Block if block.atoms.is_some() => break,
                Token::Block => block = Block::default(),
                Token::Value(_) => (),
            }
        }
        self.frame(block)
    }
}

/// From shares to places.
fn place(atoms: &mut ParticleFrame, cell: &Cell) {
    for row in 0..atoms.len() {
        let place = cell.point(atoms.position(row).to_array());
        [atoms.x[row], atoms.y[row], atoms.z[row]] = place.to_array();
    }
}

/// Puts all images of each atom in its place.
fn spread(atoms: &mut ParticleFrame, operations: &[Operation], cell: &Cell) {
    let (mut rows, mut places): (Vec<u32>, Vec<DVec3>) = (Vec::new(), Vec::new());
    for row in 0..atoms.len() {
        let images = images(atoms.position(row), operations, cell);
        rows.extend(images.iter().map(|_| row as u32));
        places.extend(images);
    }
    atoms.pick(&rows);
    for (row, place) in places.into_iter().enumerate() {
        [atoms.x[row], atoms.y[row], atoms.z[row]] = place.to_array();
    }
    place(atoms, cell);
}

/// The element that a label begins with, as `O1A` with oxygen.
fn element(label: &str) -> Option<Element> {
    let end = label.find(|letter: char| !letter.is_ascii_alphabetic()).unwrap_or(label.len());
    (1..=end.min(2)).rev().find_map(|letters| Element::from_symbol(&label[..letters]))
}

/// A tag in the spelling of old files.
fn plain(tag: &str) -> String {
    tag.replace('.', "_").to_ascii_lowercase()
}

/// A number without what says how certain it is: `0.123` of `0.123(4)`.
fn certain(field: &[u8]) -> &[u8] {
    let open = field.strip_suffix(b")").and_then(|inner| memchr::memrchr(b'(', inner));
    open.map(|end| &field[..end]).filter(|value| number::parse(value).is_some()).unwrap_or(field)
}

/// Whether a CIF file that begins so is that of a crystal.
pub(in super::super) fn is_crystal(head: &[u8]) -> bool {
    let has = |tag: &str| memmem::find(head, tag.as_bytes()).is_some();
    let shares = has("_atom_site_fract_x") || has("_atom_site.fract_x");
    !has("_atom_site.Cartn_x") && (shares || has("_cell_length_a"))
}
