//! Reads mmCIF: the loop `_atom_site` of Protein Data Bank files, or else ligand definitions; lengths in angstrom.

use super::component::{self, Component, ComponentAtoms};
use super::connections::{self, Atoms, Connections};
use super::crystal::strip_uncertainty;
use super::rows::{Rows, add_dummies, is_dummy};
use super::tokens::{Token, Tokens};
use crate::alternates::{AlternateAtom, Alternates};
use crate::{
    Bonds, Cell, FileError, Format, LengthUnit, ParticleFrame, ReadOptions, builder::Builder,
    frame_reader::FrameReader, lines::Lines, number, schema::Schema, source::Source,
};
use std::sync::Arc;

/// Prefix of the columns.
const SITE: &str = "_atom_site.";

/// Columns of numbers, some of which may be unknown.
const NUMBERS: [&str; 3] = ["occupancy", "B_iso_or_equiv", "pdbx_formal_charge"];

/// Reads the models of a file, one frame each.
pub(in super::super) struct MmCif {
    format: Format,
    tokens: Tokens,
    options: ReadOptions,
    sites: Option<Sites>,
    title: String,
    lengths: [f64; 3],
    angles: [f64; 3],
    /// Tables of bonds, if they are read, and the items of one outside of a loop.
    connections: Option<Connections>,
    items: Items,
    component_items: Items,
    /// The atoms of a ligand definition; `None` once the file has had other atoms.
    component: Option<Component>,
    component_title: String,
    /// True after a frame of a ligand definition.
    is_library: bool,
}

/// Items of a table with one row.
#[derive(Default)]
struct Items {
    names: Vec<String>,
    values: Vec<Vec<u8>>,
}

/// The frame that a model is read into.
struct Model<'m> {
    builder: &'m mut Builder,
    alternates: &'m mut Alternates,
    /// Atoms by their names, if bonds are read.
    atoms: Option<&'m mut Atoms>,
    /// Number of dummy sites, which are no atoms.
    dummies: &'m mut u64,
}

/// The loop that is being read.
struct Sites {
    schema: Arc<Schema>,
    /// Column of the model number.
    model: Option<usize>,
    /// Column that tells dummy sites, as [`is_dummy`] does.
    calculated: Option<usize>,
    alternates: AlternateColumns,
    rows: Rows,
    /// True if the current row belongs to the next frame.
    pending: bool,
}

/// Columns that identify atoms at alternate locations, if the file has them.
struct AlternateColumns {
    location: Option<usize>,
    residue: [Option<usize>; 3],
    residue_name: Option<usize>,
    name: Option<usize>,
    occupancy: Option<usize>,
}

impl AlternateColumns {
    fn new(names: &[String]) -> Self {
        let column = |wanted: [&str; 2]| {
            let mut columns =
                wanted.iter().filter_map(|own| names.iter().position(|name| name == own));
            columns.next()
        };
        Self {
            location: column(["label_alt_id", "label_alt_id"]),
            // Waters have distinct numbers only in the authors' numbering.
            residue: [
                column(["auth_asym_id", "label_asym_id"]),
                column(["auth_seq_id", "label_seq_id"]),
                column(["pdbx_PDB_ins_code", "pdbx_PDB_ins_code"]),
            ],
            residue_name: column(["label_comp_id", "auth_comp_id"]),
            name: column(["label_atom_id", "auth_atom_id"]),
            occupancy: column(["occupancy", "occupancy"]),
        }
    }

    /// Returns the identifiers of a row's atom, if it is at an alternate location.
    fn atom<'r>(&self, rows: &'r Rows) -> Option<AlternateAtom<'r>> {
        let field = |column: Option<usize>| column.map_or(&b""[..], |column| rows.field(column));
        let location = field(self.location);
        (!matches!(location, b"" | b"." | b"?")).then(|| AlternateAtom {
            location,
            residue: self.residue.map(field),
            residue_name: field(self.residue_name),
            name: field(self.name),
            occupancy: number::parse(field(self.occupancy)).unwrap_or(1.0),
        })
    }
}

/// Returns the number of the last token, NaN if it is unknown.
fn number(tokens: &Tokens) -> Result<f64, FileError> {
    match tokens.word() {
        b"." | b"?" => Ok(f64::NAN),
        word => tokens.line().number(strip_uncertainty(word)),
    }
}

impl MmCif {
    /// Creates the reader of mmCIF, or of the text of BinaryCIF.
    pub(in super::super) fn new(format: Format, source: Source, options: &ReadOptions) -> Self {
        Self {
            format,
            tokens: Tokens::new(Lines::new(source)),
            options: options.clone(),
            sites: None,
            title: String::new(),
            lengths: [f64::NAN; 3],
            angles: [f64::NAN; 3],
            connections: options.reads_bonds().then(Connections::default),
            items: Items::default(),
            component_items: Items::default(),
            component: Some(Component::default()),
            component_title: String::new(),
            is_library: false,
        }
    }

    /// Reads up to the atoms; `None` if there are none, or at the end of a ligand definition.
    fn find(&mut self) -> Result<Option<Sites>, FileError> {
        loop {
            let has_component = self.has_component();
            let Some(token) = self.tokens.next()? else { return Ok(None) };
            match token {
                Token::Loop => {
                    if let Some(sites) = self.open()? {
                        return Ok(Some(sites));
                    }
                }
                Token::Tag(tag) => {
                    let tag = tag.to_owned();
                    self.item(&tag)?;
                }
                Token::Block if has_component => {
                    self.tokens.back();
                    return Ok(None);
                }
                Token::Block => {
                    self.title.clear();
                    (self.lengths, self.angles) = ([f64::NAN; 3], [f64::NAN; 3]);
                    self.items = Items::default();
                    self.component_items = Items::default();
                    self.component_title.clear();
                    self.connections.iter_mut().for_each(|own| *own = Connections::default());
                }
                Token::Value(_) => (),
            }
        }
    }

    /// Reads a tag and its value.
    fn item(&mut self, tag: &str) -> Result<(), FileError> {
        let Some(Token::Value(value)) = self.tokens.next()? else {
            self.tokens.back();
            return Ok(());
        };
        let axis = |letters: [&str; 3]| letters.iter().position(|letter| tag.ends_with(letter));
        let bonds = [
            (connections::CONNECTIONS, &mut self.items),
            (connections::COMPONENT_BONDS, &mut self.component_items),
        ];
        let mut bonds = bonds.into_iter().filter(|(prefix, _)| connections::is_of(tag, prefix));
        if let Some((prefix, items)) = bonds.next().filter(|_| self.connections.is_some()) {
            items.names.push(tag[prefix.len()..].to_owned());
            items.values.push(value.to_vec());
        } else if let Some(component) = &mut self.component
            && connections::is_of(tag, component::ATOMS)
        {
            component.push_item(&tag[component::ATOMS.len()..], value);
        } else if tag == "_chem_comp.name" {
            self.component_title = String::from_utf8_lossy(value).trim().to_owned();
        } else if tag == "_struct.title" {
            self.title = String::from_utf8_lossy(value).trim().to_owned();
        } else if let Some(edge) = axis(["_cell.length_a", "_cell.length_b", "_cell.length_c"]) {
            self.lengths[edge] = number(&self.tokens)?;
        } else if let Some(angle) =
            axis(["_cell.angle_alpha", "_cell.angle_beta", "_cell.angle_gamma"])
        {
            self.angles[angle] = number(&self.tokens)?;
        }
        Ok(())
    }

    /// Reads the tags of a loop; returns `None` if it doesn't list atoms.
    fn open(&mut self) -> Result<Option<Sites>, FileError> {
        let tags = self.tokens.tags()?;
        let is_site = |tag: &String| {
            tag.get(..SITE.len()).is_some_and(|start| start.eq_ignore_ascii_case(SITE))
        };
        if !tags.first().is_some_and(is_site) {
            if tags.iter().any(|tag| tag.starts_with("_atom_site_fract")) {
                let help = "this is a crystal in fractional coordinates: read it with --format cif";
                return Err(self.tokens.error("no _atom_site.Cartn_x").with_help(help));
            }
            let first = tags.first().map_or("", String::as_str);
            let is_of = |category| connections::is_of(first, category);
            if let Some(connections) = &mut self.connections
                && (is_of(connections::CONNECTIONS) || is_of(connections::COMPONENT_BONDS))
            {
                connections.read(&mut self.tokens, &tags)?;
            } else if let Some(component) = &mut self.component
                && is_of(component::ATOMS)
            {
                let prefix = component::ATOMS.len();
                let names = tags.iter().map(|tag| tag.get(prefix..).unwrap_or(tag).to_owned());
                component.set_names(names.collect());
                let mut rows = Rows::new(tags.len());
                while rows.read(&mut self.tokens)? {
                    component.push(&rows);
                }
            }
            return Ok(None);
        }
        let names: Vec<String> =
            tags.iter().map(|tag| tag.get(SITE.len()..).unwrap_or(tag).to_owned()).collect();
        self.component = None;
        let model = names.iter().position(|name| name == "pdbx_PDB_model_num");
        let calculated = names.iter().position(|name| name == "calc_flag");
        let alternates = AlternateColumns::new(&names);
        let rows = Rows::new(names.len());
        let schema = Schema::new(names, &self.options).map_err(|message| {
            let help = "atoms of mmCIF have _atom_site.Cartn_x, Cartn_y and Cartn_z";
            self.tokens.error(message).with_help(help)
        })?;
        let schema = Arc::new(schema);
        Ok(Some(Sites { schema, model, calculated, alternates, rows, pending: false }))
    }

    /// Reads the atoms of the next model into a builder, or skips them. Returns whether there are any.
    fn model(&mut self, mut taken: Option<Model>) -> Result<bool, FileError> {
        let Some(sites) = &mut self.sites else { return Ok(false) };
        let mut model: Option<Vec<u8>> = None;
        while std::mem::take(&mut sites.pending) || sites.rows.read(&mut self.tokens)? {
            let own = sites.model.map_or(&b""[..], |column| sites.rows.field(column));
            if model.as_deref().is_some_and(|model| model != own) {
                sites.pending = true;
                return Ok(true);
            }
            if model.is_none() {
                model = Some(own.to_vec());
            }
            let Some(Model { builder, alternates, atoms, dummies }) = &mut taken else { continue };
            if is_dummy(&sites.rows, sites.calculated) {
                **dummies += 1;
                continue;
            }
            if let Some(atom) = sites.alternates.atom(&sites.rows) {
                alternates.add(builder.frame.len(), atom);
            }
            if let Some(atoms) = atoms {
                atoms.add(&sites.rows);
            }
            builder.row(&self.tokens.line(), sites.rows.fields())?;
        }
        self.sites = None;
        Ok(model.is_some())
    }

    /// Returns the bonds of a model's atoms.
    fn bonds(
        &mut self,
        atoms: &Atoms,
        frame: &mut ParticleFrame,
    ) -> Result<Option<Bonds>, FileError> {
        let Some(connections) = &mut self.connections else { return Ok(None) };
        if self.sites.is_none() && self.component.is_none() {
            connections::read_rest(&mut self.tokens, connections)?;
        }
        let Items { names, values } = std::mem::take(&mut self.items);
        if !names.is_empty() {
            connections.add(&names, &values);
        }
        let Items { names, values } = std::mem::take(&mut self.component_items);
        connections.add_component(&names, &values);
        connections.bonds(self.tokens.path(), atoms, frame).map(Some)
    }

    /// Returns whether there are atoms of a ligand definition.
    fn has_component(&self) -> bool {
        self.component.as_ref().is_some_and(|component| !component.is_empty())
    }

    /// Takes the ligand definition of the block that ended.
    fn take_component(&mut self) -> Option<Component> {
        self.is_library |= self.has_component();
        self.component.as_mut().map(std::mem::take).filter(|component| !component.is_empty())
    }

    /// Returns the frame of a ligand definition.
    fn component(&mut self, component: Component) -> Result<ParticleFrame, FileError> {
        let fault = |message: String| FileError::whole_file(self.tokens.path(), message);
        let title = std::mem::take(&mut self.component_title);
        let Some(ComponentAtoms { names, rows, nowhere }) = component.atoms() else {
            let frame = ParticleFrame { title, format: Format::MmCif, ..ParticleFrame::default() };
            return Ok(frame);
        };
        let mut atoms = self.connections.is_some().then(|| Atoms::new(&names));
        let schema = Schema::new(names, &self.options).map_err(fault)?;
        let mut builder = Builder::new(self.tokens.path(), Format::MmCif, &Arc::new(schema));
        for row in &rows {
            if let Some(atoms) = &mut atoms {
                atoms.add(row);
            }
            builder.row(&self.tokens.line(), row.fields())?;
        }
        let mut frame = builder.finish();
        if nowhere > 0 {
            frame.warnings.push(format!("{nowhere} atoms without coordinates are left out"));
        }
        if let Some(atoms) = &atoms {
            frame.bonds = self.bonds(atoms, &mut frame)?;
        }
        Ok(ParticleFrame { title, unit: LengthUnit::Angstrom, ..frame })
    }

    /// Returns whether the reader is in a loop of atoms.
    fn is_open(&mut self) -> Result<bool, FileError> {
        if self.sites.is_none() {
            self.sites = self.find()?;
        }
        Ok(self.sites.is_some())
    }
}

impl FrameReader for MmCif {
    fn next(&mut self) -> Result<Option<ParticleFrame>, FileError> {
        while self.is_open()? {
            let Some(schema) = self.sites.as_ref().map(|sites| sites.schema.clone()) else { break };
            let mut builder = Builder::new(self.tokens.path(), self.format, &schema);
            builder.declare(&[], &NUMBERS);
            let mut alternates = Alternates::default();
            let mut atoms = self.connections.is_some().then(|| Atoms::new(&schema.names));
            let (own, atoms_now) = (&mut builder, atoms.as_mut());
            let (alternates_now, mut dummies) = (&mut alternates, 0);
            let model = Model {
                builder: own,
                alternates: alternates_now,
                atoms: atoms_now,
                dummies: &mut dummies,
            };
            if !self.model(Some(model))? {
                continue;
            }
            let mut frame = builder.finish();
            add_dummies(&mut frame, dummies);
            if let Some(atoms) = &atoms {
                let bonds = self.bonds(atoms, &mut frame)?;
                frame.bonds = bonds.map(|bonds| Bonds { partial: true, ..bonds });
            }
            alternates.choose(&mut frame);
            let cell = Cell::of_lengths(self.lengths, self.angles);
            let cell = cell.filter(|_| self.lengths != [1.0; 3]);
            let (title, unit) = (self.title.clone(), LengthUnit::Angstrom);
            return Ok(Some(ParticleFrame { cell, title, unit, ..frame }));
        }
        self.take_component().map(|component| self.component(component)).transpose()
    }

    fn skip(&mut self) -> Result<bool, FileError> {
        while self.is_open()? {
            if self.model(None)? {
                return Ok(true);
            }
        }
        Ok(self.take_component().is_some())
    }

    fn more(&mut self) -> Result<bool, FileError> {
        Ok(self.is_open()? || self.has_component())
    }
}
