//! Reads mmCIF: the loop `_atom_site` of Protein Data Bank files, lengths in angstrom.

use super::rows::Rows;
use super::tokens::{Token, Tokens};
use crate::FileError;
use crate::alternates::{AlternateAtom, Alternates};
use crate::builder::Builder;
use crate::cell::Cell;
use crate::frame::{LengthUnit, ParticleFrame};
use crate::frame_reader::FrameReader;
use crate::lines::Lines;
use crate::number;
use crate::options::{Format, ReadOptions};
use crate::schema::Schema;
use crate::source::Source;
use crate::undrawn::Undrawn;
use std::sync::Arc;

/// Prefix of the columns.
const SITE: &str = "_atom_site.";

/// Columns of numbers, some of which may be unknown.
const NUMBERS: [&str; 3] = ["occupancy", "B_iso_or_equiv", "pdbx_formal_charge"];

/// Reads the models of a file, one frame each.
pub(in super::super) struct MmCif {
    tokens: Tokens,
    options: ReadOptions,
    sites: Option<Sites>,
    title: String,
    lengths: [f64; 3],
    angles: [f64; 3],
    /// Rows of `_struct_conn` before the atoms.
    bonds: u64,
}

/// The loop that is being read.
struct Sites {
    schema: Arc<Schema>,
    /// Column of the model number.
    model: Option<usize>,
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

impl MmCif {
    pub(in super::super) fn new(source: Source, options: &ReadOptions) -> Self {
        Self {
            tokens: Tokens::new(Lines::new(source)),
            options: options.clone(),
            sites: None,
            title: String::new(),
            lengths: [0.0; 3],
            angles: [0.0; 3],
            bonds: 0,
        }
    }

    /// Reads up to the atoms; `None` if there are none.
    fn find(&mut self) -> Result<Option<Sites>, FileError> {
        while let Some(token) = self.tokens.next()? {
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
                Token::Value(_) | Token::Block => (),
            }
        }
        Ok(None)
    }

    /// Reads a tag and its value.
    fn item(&mut self, tag: &str) -> Result<(), FileError> {
        let Some(Token::Value(value)) = self.tokens.next()? else {
            self.tokens.back();
            return Ok(());
        };
        let axis = |letters: [&str; 3]| letters.iter().position(|letter| tag.ends_with(letter));
        let number = || number::parse(value).unwrap_or(0.0);
        if tag == "_struct_conn.id" {
            self.bonds += 1;
        } else if tag == "_struct.title" {
            self.title = String::from_utf8_lossy(value).trim().to_owned();
        } else if let Some(edge) = axis(["_cell.length_a", "_cell.length_b", "_cell.length_c"]) {
            self.lengths[edge] = number();
        } else if let Some(angle) =
            axis(["_cell.angle_alpha", "_cell.angle_beta", "_cell.angle_gamma"])
        {
            self.angles[angle] = number();
        }
        Ok(())
    }

    /// Reads the tags of a loop; returns `None` if it doesn't list atoms.
    fn open(&mut self) -> Result<Option<Sites>, FileError> {
        let mut tags = Vec::new();
        while let Some(Token::Tag(tag)) = self.tokens.next()? {
            tags.push(tag.to_owned());
        }
        self.tokens.back();
        let is_site = |tag: &String| {
            tag.get(..SITE.len()).is_some_and(|start| start.eq_ignore_ascii_case(SITE))
        };
        if !tags.first().is_some_and(is_site) {
            if tags.iter().any(|tag| tag.starts_with("_atom_site_fract")) {
                let help = "this is a crystal in fractional coordinates: read it with --format cif";
                return Err(self.tokens.error("no _atom_site.Cartn_x").with_help(help));
            }
            if tags.iter().any(|tag| tag.starts_with("_struct_conn.")) {
                let mut rows = Rows::new(tags.len());
                while rows.read(&mut self.tokens)? {
                    self.bonds += 1;
                }
            }
            return Ok(None);
        }
        let names: Vec<String> =
            tags.iter().map(|tag| tag.get(SITE.len()..).unwrap_or(tag).to_owned()).collect();
        let model = names.iter().position(|name| name == "pdbx_PDB_model_num");
        let alternates = AlternateColumns::new(&names);
        let rows = Rows::new(names.len());
        let schema = Schema::new(names, &self.options).map_err(|message| {
            let help = "atoms of mmCIF have _atom_site.Cartn_x, Cartn_y and Cartn_z";
            self.tokens.error(message).with_help(help)
        })?;
        Ok(Some(Sites { schema: Arc::new(schema), model, alternates, rows, pending: false }))
    }

    /// Reads the atoms of the next model into a builder, or skips them. Returns whether there are any.
    fn model(
        &mut self,
        mut taken: Option<(&mut Builder, &mut Alternates)>,
    ) -> Result<bool, FileError> {
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
            let Some((builder, alternates)) = &mut taken else { continue };
            if let Some(atom) = sites.alternates.atom(&sites.rows) {
                alternates.add(builder.frame.len(), atom);
            }
            builder.row(&self.tokens.line(), sites.rows.fields())?;
        }
        self.sites = None;
        Ok(model.is_some())
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
            let mut builder = Builder::new(self.tokens.path(), Format::MmCif, &schema);
            builder.declare(&[], &NUMBERS);
            let mut alternates = Alternates::default();
            if !self.model(Some((&mut builder, &mut alternates)))? {
                continue;
            }
            let mut frame = builder.finish();
            alternates.choose(&mut frame);
            frame.add_undrawn(Undrawn::Bonds, self.bonds);
            let cell = Cell::of_lengths(self.lengths, self.angles);
            let cell = cell.filter(|_| self.lengths != [1.0; 3]);
            let (title, unit) = (self.title.clone(), LengthUnit::Angstrom);
            return Ok(Some(ParticleFrame { cell, title, unit, ..frame }));
        }
        Ok(None)
    }

    fn skip(&mut self) -> Result<bool, FileError> {
        while self.is_open()? {
            if self.model(None)? {
                return Ok(true);
            }
        }
        Ok(false)
    }

    fn more(&mut self) -> Result<bool, FileError> {
        Ok(self.sites.is_some())
    }
}
