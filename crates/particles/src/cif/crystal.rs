//! CIF of crystals: a cell, the atoms of the asymmetric unit, and the symmetry operations
//! (CIF core dictionary, <https://www.iucr.org/resources/cif/dictionaries/cif_core>).

use super::declared::{Contents, Declared, Resolved};
use super::geometry::{self, Geometry, Labels, ListedBond, NOWHERE};
use super::hall::MOST;
use super::occupancy::{Occupancies, Positions};
use super::rows::{Rows, add_dummies, is_dummy};
use super::symmetry::{Operation, images};
use super::tokens::{Token, Tokens};
use crate::{
    Bonds, Cell, Element, ElementSource, FileError, Format, LengthUnit, ParticleFrame, ReadOptions,
    Rgb, Role,
    bonds::End,
    builder::Builder,
    frame_reader::FrameReader,
    lines::Lines,
    memory, number,
    schema::{Naming, Schema},
    source::Source,
    undrawn::Undrawn,
};
use glam::DVec3;
use memchr::memmem;
use std::sync::Arc;

/// Bytes of an atom as a sphere: four numbers in double precision, a material and a color.
const ATOM_BYTES: u64 = (4 * size_of::<f64>() + size_of::<u32>() + size_of::<Rgb>()) as u64;

/// Prefix of the columns of atoms; newer files have a point at the end.
const SITE: &str = "_atom_site_";

/// Columns of fractional coordinates.
const FRACTIONAL: [(Role, &str); 3] =
    [(Role::X, "fract_x"), (Role::Y, "fract_y"), (Role::Z, "fract_z")];

/// Column that tells dummy sites.
const DUMMY: &str = "_atom_site_calc_flag";

/// Columns of numbers, some of which may be unknown.
const NUMBERS: [&str; 3] = ["occupancy", "U_iso_or_equiv", "B_iso_or_equiv"];

/// Tags of symmetry operations: current ones, and those of old files and magnetic CIF.
const OPERATIONS: [&str; 4] = [
    "_space_group_symop_operation_xyz",
    "_symmetry_equiv_pos_as_xyz",
    "_space_group_symop_magn_operation_xyz",
    "_space_group_symop_magn_centering_xyz",
];

/// Tags of Hermann-Mauguin symbols; those of Hall symbols and space group numbers follow.
const SYMBOLS: [&str; 4] = [
    "_space_group_name_h-m_alt",
    "_symmetry_space_group_name_h-m",
    "_space_group_name_h-m_full",
    "_space_group_name_h-m",
];
const HALL: [&str; 2] = ["_space_group_name_hall", "_symmetry_space_group_name_hall"];
const NUMBERS_OF_GROUPS: [&str; 2] = ["_space_group_it_number", "_symmetry_int_tables_number"];

/// Tags that serve as a title, in order of increasing preference.
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
    /// The next block with atoms, if it was looked for.
    ahead: Option<Result<Option<Block>, FileError>>,
}

/// Contents of a data block.
struct Block {
    title: (usize, String),
    lengths: [f64; 3],
    angles: [f64; 3],
    symmetry: Declared,
    atoms: Option<Atoms>,
    /// Number of anisotropic displacements.
    displacements: u64,
    geometry: Vec<ListedBond>,
}

/// Atoms of the asymmetric unit, as listed.
struct Atoms {
    /// Positions are fractional coordinates.
    frame: ParticleFrame,
    occupancies: Occupancies,
    /// The atom of each label, if bonds are read.
    labels: Labels,
}

impl Default for Block {
    fn default() -> Self {
        Self {
            title: (0, String::new()),
            lengths: [0.0; 3],
            // The default without tags for them.
            angles: [90.0; 3],
            symmetry: Declared::default(),
            atoms: None,
            displacements: 0,
            geometry: Vec::new(),
        }
    }
}

impl Crystal {
    pub(in super::super) fn new(source: Source, options: &ReadOptions) -> Self {
        Self { tokens: Tokens::new(Lines::new(source)), options: options.clone(), ahead: None }
    }

    /// Reads a tag and its value.
    fn item(&mut self, tag: &str, block: &mut Block) -> Result<(), FileError> {
        let Some(Token::Value(value)) = self.tokens.next()? else {
            self.tokens.back();
            return Ok(());
        };
        let text = String::from_utf8_lossy(value).trim().to_owned();
        let known = !matches!(&text[..], "" | "?" | ".");
        let axis = |letters: [&str; 3]| letters.iter().position(|letter| tag == *letter);
        let number = || self.tokens.line().number(strip_uncertainty(text.as_bytes()));
        if let Some(edge) = axis(["_cell_length_a", "_cell_length_b", "_cell_length_c"]) {
            block.lengths[edge] = number()?;
        } else if let Some(angle) =
            axis(["_cell_angle_alpha", "_cell_angle_beta", "_cell_angle_gamma"])
        {
            block.angles[angle] = number()?;
        } else if let Some(rank) = TITLES.iter().position(|title| *title == tag) {
            if known && rank >= block.title.0 {
                block.title = (rank, text);
            }
        } else if known {
            self.symmetry(tag, text, &mut block.symmetry)?;
        }
        Ok(())
    }

    /// Stores the value of a symmetry tag; ignores other tags.
    fn symmetry(&self, tag: &str, text: String, symmetry: &mut Declared) -> Result<(), FileError> {
        if SYMBOLS.contains(&tag) {
            symmetry.symbols.push(text);
        } else if HALL.contains(&tag) {
            symmetry.hall = Some(text);
        } else if NUMBERS_OF_GROUPS.contains(&tag) {
            symmetry.number = text.parse().ok();
        } else if OPERATIONS.contains(&tag) {
            let operation = self.operation(&text)?;
            let centering = tag == OPERATIONS[3];
            let list = if centering { &mut symmetry.centerings } else { &mut symmetry.operations };
            list.push(operation);
            if list.len() > MOST {
                let message = format!("more than {MOST} symmetry operations");
                let error = self.tokens.error(message);
                return Err(error.with_help("no space group has more"));
            }
        }
        Ok(())
    }

    fn operation(&self, text: &str) -> Result<Operation, FileError> {
        // Magnetic CIF has time reversal as a fourth component.
        let place = text.strip_suffix(",+1").or_else(|| text.strip_suffix(",-1")).unwrap_or(text);
        Operation::parse(place).ok_or_else(|| {
            let error = self.tokens.error(format!("`{text}` is not a symmetry operation"));
            error.with_help("operations are written as in -x, y+1/2, z")
        })
    }

    /// Reads a loop of operations or atoms, or skips another loop.
    fn list(&mut self, block: &mut Block) -> Result<(), FileError> {
        let tags = self.tokens.tags()?;
        let tags_now: Vec<String> = tags.iter().map(|tag| plain(tag)).collect();
        let is_site = |tag: &String| *tag == format!("{SITE}{}", FRACTIONAL[0].1);
        let is_symmetry = |tag: &&String| {
            let tags = OPERATIONS.iter().chain(&SYMBOLS).chain(&HALL).chain(&NUMBERS_OF_GROUPS);
            tags.into_iter().any(|own| own == *tag)
        };
        if tags_now.iter().any(is_site) {
            block.atoms = Some(self.atoms(&tags)?);
        } else if tags_now.iter().any(|tag| is_symmetry(&tag)) {
            let mut rows = Rows::new(tags.len());
            while rows.read(&mut self.tokens)? {
                for (column, tag) in tags_now.iter().enumerate() {
                    let text = String::from_utf8_lossy(rows.field(column)).trim().to_owned();
                    if !matches!(&text[..], "" | "?" | ".") {
                        self.symmetry(tag, text, &mut block.symmetry)?;
                    }
                }
            }
        } else if tags_now.iter().any(|tag| tag.starts_with("_geom_bond_atom_site_label")) {
            if self.options.reads_bonds() {
                block.geometry.extend(geometry::read(&mut self.tokens, &tags_now)?);
            }
        } else if tags_now.iter().any(|tag| tag.starts_with("_atom_site_aniso_")) {
            block.displacements += Rows::count(&mut self.tokens, tags.len())?;
        }
        Ok(())
    }

    /// Reads the atoms of a loop.
    fn atoms(&mut self, tags: &[String]) -> Result<Atoms, FileError> {
        let names = tags.iter().map(|tag| tag.get(SITE.len()..).unwrap_or(tag).to_owned());
        let names: Vec<String> = names.collect();
        let has_symbols = names.iter().any(|name| name == "type_symbol");
        let label = (!has_symbols).then_some((Role::Kind, "label"));
        let known: Vec<(Role, &str)> = FRACTIONAL.into_iter().chain(label).collect();
        let places = FRACTIONAL.map(|(_, tag)| names.iter().position(|name| name == tag));
        if let Some(axis) = places.iter().position(Option::is_none) {
            let message = format!("no {SITE}{} in this loop of atoms", FRACTIONAL[axis].1);
            return Err(self.tokens.error(message));
        }
        let mut occupancies = Occupancies::new(&names);
        let mut schema = Schema::with_roles(names, &self.options, &known)
            .map_err(|message| self.tokens.error(message))?;
        if has_symbols && schema.naming == Naming::Symbols {
            schema.naming = Naming::Groups;
        }
        let calculated = tags.iter().position(|tag| plain(tag) == DUMMY);
        let mut dummies = 0_u64;
        let mut builder = Builder::new(self.tokens.path(), Format::Cif, &Arc::new(schema));
        builder.declare(&["label"], &NUMBERS);
        let (mut rows, mut nowhere) = (Rows::new(tags.len()), 0_u64);
        let label = tags.iter().position(|tag| plain(tag) == "_atom_site_label");
        let label = label.filter(|_| self.options.reads_bonds());
        let mut labels = Labels::new();
        let mut add = |text: Option<Vec<u8>>, row: u32| {
            let Some(text) = text else { return };
            let end = labels.entry(text).and_modify(|end| *end = End::Ambiguous);
            end.or_insert(End::Atom(row));
        };
        while rows.read(&mut self.tokens)? {
            let unknown = |column: &usize| matches!(rows.field(*column), b"." | b"?");
            let text = label.map(|label| rows.field(label).to_vec());
            if is_dummy(&rows, calculated) {
                add(text, NOWHERE);
                dummies += 1;
            } else if places.iter().flatten().any(unknown) {
                add(text, NOWHERE);
                nowhere += 1;
            } else {
                let row = builder.frame.len() as u32;
                add(text, row);
                builder.row(&self.tokens.line(), rows.fields().map(strip_uncertainty))?;
                occupancies.read(&rows);
            }
        }
        if nowhere > 0 {
            let warning = format!("{nowhere} atoms without coordinates are left out");
            builder.frame.warnings.push(warning);
        }
        let mut frame = builder.finish();
        add_dummies(&mut frame, dummies);
        if !has_symbols {
            for kind in &mut frame.kinds.table {
                kind.element = kind.element.or_else(|| element(&kind.name));
                kind.source = ElementSource::Name;
            }
        }
        Ok(Atoms { frame, occupancies, labels })
    }

    /// Reads the next block with atoms, if there is one.
    fn block(&mut self) -> Result<Option<Block>, FileError> {
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
        Ok(Some(block).filter(|block| block.atoms.is_some()))
    }

    /// Returns the frame of a block; `None` if it has no atoms.
    fn frame(&self, mut block: Block) -> Result<Option<ParticleFrame>, FileError> {
        let Some(Atoms { frame: mut atoms, mut occupancies, mut labels }) = block.atoms.take()
        else {
            return Ok(None);
        };
        let fault = |message: String| FileError::whole_file(self.tokens.path(), message);
        let (lengths, angles) = (block.lengths, block.angles);
        // Symmetry may repeat atoms in a plane beyond it, so no crystal is a layer.
        let cell = Cell::of_lengths(lengths, angles)
            .and_then(Cell::with_volume)
            .filter(|_| !lengths.contains(&0.0))
            .ok_or_else(|| {
                let message =
                    format!("there is no cell with edges {lengths:?} and angles {angles:?}");
                fault(message)
                    .with_help("a crystal needs _cell_length_a, _b and _c, and its angles")
            })?;
        leave_out_vacant(&mut atoms, &mut occupancies, &mut labels);
        keep_main_groups(&mut atoms, &mut occupancies, &mut labels);
        let positions: Vec<DVec3> = (0..atoms.len()).map(|row| atoms.position(row)).collect();
        let contents = Contents { cell: &cell, positions: &positions };
        let declared = block.symmetry.operations.clone();
        let Resolved { operations, warnings } = block.symmetry.resolve(contents);
        atoms.warnings.extend(warnings);
        let images = operations.len().max(1) as u64 * atoms.len() as u64;
        memory::check(images.saturating_mul(ATOM_BYTES))
            .map_err(|shortage| fault(format!("its {images} atoms need {shortage}")))?;
        let images = repeat(&positions, &operations, &cell);
        let bonds = (!block.geometry.is_empty()).then(|| {
            let crystal = Geometry { positions: &positions, labels: &labels, declared: &declared };
            let Images { rows, places } = &images;
            crystal.bonds(
                self.tokens.path(),
                &block.geometry,
                &operations,
                Positions { rows, places, cell: &cell },
            )
        });
        place(&mut atoms, &images, &occupancies, &cell, bonds.transpose()?);
        let (unit, title) = (LengthUnit::Angstrom, block.title.1);
        atoms.add_undrawn(Undrawn::Displacements, block.displacements);
        Ok(Some(ParticleFrame { cell: Some(cell), unit, title, ..atoms }))
    }
}

impl FrameReader for Crystal {
    fn next(&mut self) -> Result<Option<ParticleFrame>, FileError> {
        let block = match self.ahead.take() {
            Some(block) => block?,
            None => self.block()?,
        };
        block.map_or(Ok(None), |block| self.frame(block))
    }

    fn more(&mut self) -> Result<bool, FileError> {
        if self.ahead.is_none() {
            self.ahead = Some(self.block());
        }
        // What is wrong there is told once it is read.
        Ok(!matches!(self.ahead, Some(Ok(None))))
    }
}

/// Removes the atoms that are not to be kept. Returns their number.
fn keep_atoms(
    keep: &[bool],
    atoms: &mut ParticleFrame,
    occupancies: &mut Occupancies,
    labels: &mut Labels,
) -> usize {
    let others = keep.iter().filter(|keep| !**keep).count();
    if others > 0 {
        atoms.retain(keep);
        occupancies.retain(keep);
        let mut next = 0..;
        let places: Vec<u32> = keep
            .iter()
            .map(|keep| if *keep { next.next().unwrap_or(NOWHERE) } else { NOWHERE })
            .collect();
        for row in labels.values_mut() {
            if let End::Atom(row) = row
                && *row != NOWHERE
            {
                *row = places[*row as usize];
            }
        }
    }
    others
}

/// Removes the sites without an atom: those of occupancy 0, unless all are.
fn leave_out_vacant(atoms: &mut ParticleFrame, occupancies: &mut Occupancies, labels: &mut Labels) {
    let keep = occupancies.occupied();
    if keep.contains(&true) {
        let vacant = keep_atoms(&keep, atoms, occupancies, labels);
        if vacant > 0 {
            let count = count_text(vacant, "site of occupancy 0 is", "sites of occupancy 0 are");
            atoms.warnings.push(format!("{count} left out"));
        }
    }
}

/// Removes the atoms of all disorder groups but the main ones.
fn keep_main_groups(atoms: &mut ParticleFrame, occupancies: &mut Occupancies, labels: &mut Labels) {
    let lesser = keep_atoms(&occupancies.main_groups(), atoms, occupancies, labels);
    if lesser > 0 {
        atoms.warnings.push(format!(
            "{} left out: of each disorder, the group with the greatest occupancy is drawn",
            count_text(lesser, "listed atom is", "listed atoms are"),
        ));
    }
    let about = occupancies.about_symmetry();
    if about > 0 {
        atoms.warnings.push(format!(
            "{} disordered about a symmetry element: all images are drawn, though they overlap",
            count_text(about, "listed atom is", "listed atoms are"),
        ));
    }
}

/// Images of the listed atoms in fractional coordinates, with the rows of their atoms.
struct Images {
    rows: Vec<u32>,
    places: Vec<DVec3>,
}

/// Returns all symmetry images of the listed positions; without symmetry, the positions themselves.
fn repeat(positions: &[DVec3], operations: &[Operation], cell: &Cell) -> Images {
    let (mut rows, mut places) = (Vec::new(), Vec::new());
    for (row, position) in positions.iter().enumerate() {
        let images = if let [] | [_] = operations {
            vec![*position]
        } else {
            images(*position, operations, cell)
        };
        rows.extend(images.iter().map(|_| row as u32));
        places.extend(images);
    }
    Images { rows, places }
}

/// Places an atom at each image; at shared sites, only the atom with the greatest occupancy.
fn place(
    atoms: &mut ParticleFrame,
    images: &Images,
    occupancies: &Occupancies,
    cell: &Cell,
    bonds: Option<Bonds>,
) {
    let Images { rows, places } = images;
    let shared = occupancies.select_on_sites(Positions { rows, places, cell });
    atoms.pick(rows);
    for (row, place) in places.iter().enumerate() {
        [atoms.x[row], atoms.y[row], atoms.z[row]] = cell.cartesian(place.to_array()).to_array();
    }
    atoms.bonds = bonds;
    if shared.sites > 0 {
        let others = shared.keep.iter().filter(|keep| !**keep).count();
        atoms.retain(&shared.keep);
        atoms.warnings.push(format!(
            "{} shared by several atoms: the one with the greatest occupancy is drawn, and {} left \
             out",
            count_text(shared.sites, "site is", "sites are"),
            count_text(others, "other is", "others are"),
        ));
    }
}

fn count_text(count: usize, one: &str, many: &str) -> String {
    format!("{count} {}", if count == 1 { one } else { many })
}

/// Returns the element at the beginning of a label: oxygen for `O1A`.
fn element(label: &str) -> Option<Element> {
    let end = label.find(|letter: char| !letter.is_ascii_alphabetic()).unwrap_or(label.len());
    (1..=end.min(2)).rev().find_map(|letters| Element::from_symbol(&label[..letters]))
}

/// Normalizes a tag to the spelling of old files.
fn plain(tag: &str) -> String {
    tag.replace('.', "_").to_ascii_lowercase()
}

/// Strips the standard uncertainty from a number: `0.123` from `0.123(4)`.
pub(super) fn strip_uncertainty(field: &[u8]) -> &[u8] {
    let open = field.strip_suffix(b")").and_then(|inner| memchr::memrchr(b'(', inner));
    open.map(|end| &field[..end]).filter(|value| number::parse(value).is_some()).unwrap_or(field)
}

/// Returns whether a CIF file with this head is that of a crystal.
pub(in super::super) fn is_crystal(head: &[u8]) -> bool {
    let has = |tag: &str| memmem::find(head, tag.as_bytes()).is_some();
    let fractional = has("_atom_site_fract_x") || has("_atom_site.fract_x");
    !has("_atom_site.Cartn_x") && (fractional || has("_cell_length_a"))
}
