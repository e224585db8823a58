//! Bonds of mmCIF: `_struct_conn`, which connects residues, and `_chem_comp_bond`, which connects the atoms of
//! each residue of a name (<https://mmcif.wwpdb.org/dictionaries/mmcif_pdbx_v50.dic>).

use super::rows::Rows;
use super::tokens::{Token, Tokens};
use crate::{Bonds, FileError, ParticleFrame, bonds::Listed, line::Line};
use std::collections::HashMap;
use std::path::Path;
use std::sync::Arc;

/// Prefixes of the tags.
pub(super) const CONNECTIONS: &str = "_struct_conn.";
pub(super) const COMPONENT_BONDS: &str = "_chem_comp_bond.";

/// Types of connections that are bonds; others are hydrogen bonds, salt bridges and remarks.
const BONDS: [&str; 3] = ["covale", "disulf", "metalc"];

/// Columns of an atom: its chain, residue number, insertion code, residue name and name.
const SITE_COLUMNS: [[&str; 2]; 5] = [
    ["auth_asym_id", "label_asym_id"],
    ["auth_seq_id", "label_seq_id"],
    ["pdbx_PDB_ins_code", "pdbx_PDB_ins_code"],
    ["label_comp_id", "auth_comp_id"],
    ["label_atom_id", "auth_atom_id"],
];

/// Columns of the same, and of the alternate location and symmetry, of the first atom of a connection; those of the
/// second one have a 2 for the 1.
const PARTNER: [[&str; 2]; 7] = [
    ["ptnr1_auth_asym_id", "ptnr1_label_asym_id"],
    ["ptnr1_auth_seq_id", "ptnr1_label_seq_id"],
    ["pdbx_ptnr1_PDB_ins_code", "pdbx_ptnr1_PDB_ins_code"],
    ["ptnr1_label_comp_id", "ptnr1_auth_comp_id"],
    ["ptnr1_label_atom_id", "ptnr1_label_atom_id"],
    ["pdbx_ptnr1_label_alt_id", "pdbx_ptnr1_label_alt_id"],
    ["ptnr1_symmetry", "ptnr1_symmetry"],
];

/// A connection of two atoms in a file.
struct Connection {
    /// Keys of both atoms, and their alternate locations.
    atoms: [(Vec<u8>, Vec<u8>); 2],
    kind: Vec<u8>,
    /// The number and text of its line.
    line: (usize, Vec<u8>),
}

/// The bonds of a file's tables.
#[derive(Default)]
pub(super) struct Connections {
    list: Vec<Connection>,
    /// Number of connections to symmetry images of atoms.
    symmetric: u64,
    /// Pairs of atom names with the order of their bond, by the name of the residue.
    components: HashMap<Vec<u8>, Vec<[Vec<u8>; 3]>>,
}

/// Atoms by their residues and names.
#[derive(Default)]
pub(super) struct Atoms {
    columns: Vec<Option<usize>>,
    location: Option<usize>,
    /// Row and alternate location of the atoms with a key.
    rows: HashMap<Vec<u8>, Vec<(u32, Vec<u8>)>>,
    /// The name of the residue of each key, and the key without the name of the atom.
    residues: Vec<(Vec<u8>, Vec<u8>)>,
}

/// Returns the first of two columns that a table has.
fn column(names: &[String], wanted: [&str; 2]) -> Option<usize> {
    wanted.iter().find_map(|own| names.iter().position(|name| name.eq_ignore_ascii_case(own)))
}

/// Returns a value, empty if it is unknown or doesn't apply.
fn known(value: &[u8]) -> &[u8] {
    if matches!(value, b"." | b"?") { b"" } else { value }
}

impl Atoms {
    pub(super) fn new(names: &[String]) -> Self {
        let columns = SITE_COLUMNS.map(|wanted| column(names, wanted)).into();
        let location = column(names, ["label_alt_id", "label_alt_id"]);
        Self { columns, location, ..Self::default() }
    }

    /// Adds the atom of a row.
    pub(super) fn add(&mut self, row: u32, rows: &Rows) {
        let field = |at: Option<usize>| known(at.map_or(b"", |at| rows.field(at)));
        let parts: Vec<&[u8]> = self.columns.iter().map(|at| field(*at)).collect();
        let location = field(self.location).to_vec();
        let residue = parts[..4].join(&0);
        if self.residues.last().is_none_or(|(_, own)| *own != residue) {
            self.residues.push((parts[3].to_vec(), residue));
        }
        self.rows.entry(parts.join(&0)).or_default().push((row, location));
    }
}

impl Connections {
    /// Reads the rows of a table of connections or of bonds in residues.
    pub(super) fn read(&mut self, tokens: &mut Tokens, tags: &[String]) -> Result<(), FileError> {
        let prefix = tags.first().map_or(0, |tag| tag.find('.').map_or(0, |point| point + 1));
        let of_components = tags.first().is_some_and(|tag| is_of(tag, COMPONENT_BONDS));
        let names: Vec<String> = tags.iter().map(|tag| tag[prefix..].to_owned()).collect();
        let mut rows = Rows::new(tags.len());
        while rows.read(tokens)? {
            let line = tokens.line();
            let at = (line.number_in_file(), line.bytes.to_vec());
            let fields: Vec<Vec<u8>> = rows.fields().map(<[u8]>::to_vec).collect();
            if of_components {
                self.add_component(&names, &fields);
            } else {
                self.add(&names, &fields, at);
            }
        }
        Ok(())
    }

    /// Adds a row of `_struct_conn`, or its items outside of a loop.
    pub(super) fn add(&mut self, names: &[String], fields: &[Vec<u8>], line: (usize, Vec<u8>)) {
        let field = |wanted: [&str; 2]| {
            known(column(names, wanted).map_or(b"", |at| fields[at].as_slice()))
        };
        let kind = field(["conn_type_id", "conn_type_id"]).to_ascii_lowercase();
        if !BONDS.iter().any(|bond| kind.starts_with(bond.as_bytes())) {
            return;
        }
        let partners = ["1", "2"].map(|atom| {
            PARTNER.map(|wanted| {
                let [one, other] = wanted.map(|name| name.replace('1', atom));
                field([&one, &other])
            })
        });
        let symmetry = partners.map(|partner| partner[6]);
        let is_same = |symmetry: &[u8]| matches!(symmetry, b"" | b"1_555");
        if symmetry[0] != symmetry[1] && !symmetry.into_iter().all(is_same) {
            self.symmetric += 1;
            return;
        }
        let atoms = partners.map(|partner| (partner[..5].join(&0), partner[5].to_vec()));
        self.list.push(Connection { atoms, kind, line });
    }

    fn add_component(&mut self, names: &[String], fields: &[Vec<u8>]) {
        let field = |name: &str| column(names, [name, name]).map(|at| fields[at].clone());
        if let (Some(component), Some(first), Some(second)) =
            (field("comp_id"), field("atom_id_1"), field("atom_id_2"))
        {
            let order = field("value_order").unwrap_or_default().to_ascii_lowercase();
            self.components.entry(component).or_default().push([first, second, order]);
        }
    }

    /// Returns the bonds of a model's atoms.
    pub(super) fn bonds(
        &self,
        path: &Arc<Path>,
        atoms: &Atoms,
        frame: &mut ParticleFrame,
    ) -> Result<Bonds, FileError> {
        let mut bonds = Listed::default();
        let none = Vec::new();
        for (name, residue) in &atoms.residues {
            for [first, second, order] in self.components.get(name).unwrap_or(&Vec::new()) {
                let find = |atom: &[u8]| atoms.rows.get(&[residue, atom].join(&0)).unwrap_or(&none);
                add_pairs(&mut bonds, path, [find(first), find(second)], order)?;
            }
        }
        for Connection { atoms: ends, kind, line } in &self.list {
            let mut found = [Vec::new(), Vec::new()];
            for (rows, (key, location)) in found.iter_mut().zip(ends) {
                let all = atoms.rows.get(key).ok_or_else(|| {
                    let line = Line::new(path, line.0, &line.1);
                    let parts: Vec<_> =
                        key.split(|&byte| byte == 0).map(String::from_utf8_lossy).collect();
                    let name = parts.into_iter().filter(|part| !part.is_empty());
                    let name = name.collect::<Vec<_>>().join(" ");
                    let message = format!("a bond to atom {name}, but there is no such atom");
                    let help = "remove the connection from the file, or read no bonds of it";
                    line.whole(message).with_help(help)
                })?;
                let here = |atom: &&(u32, Vec<u8>)| location.is_empty() || atom.1 == *location;
                rows.extend(all.iter().filter(here).cloned());
            }
            add_pairs(&mut bonds, path, [&found[0], &found[1]], kind)?;
        }
        if self.symmetric > 0 {
            let count = self.symmetric;
            let warning = format!("{count} bonds to symmetry images of atoms are left out");
            frame.warnings.push(warning);
        }
        Ok(Bonds { partial: true, ..bonds.finish() })
    }
}

/// Adds the bonds between atoms at the same alternate location, or at any if one of them has none.
fn add_pairs(
    bonds: &mut Listed,
    path: &Path,
    [first, second]: [&Vec<(u32, Vec<u8>)>; 2],
    kind: &[u8],
) -> Result<(), FileError> {
    for (one, here) in first {
        for (other, there) in second {
            if here == there || here.is_empty() || there.is_empty() {
                bonds.push_named(path, (*one, *other, [0; 3]), kind)?;
            }
        }
    }
    Ok(())
}

/// Returns whether a tag belongs to a category.
pub(super) fn is_of(tag: &str, category: &str) -> bool {
    tag.get(..category.len()).is_some_and(|start| start.eq_ignore_ascii_case(category))
}

/// Reads on to the end of a data block, for tables that follow the atoms.
pub(super) fn read_rest(
    tokens: &mut Tokens,
    connections: &mut Connections,
) -> Result<(), FileError> {
    while let Some(token) = tokens.next()? {
        match token {
            Token::Block => {
                tokens.back();
                break;
            }
            Token::Loop => {
                let tags = tokens.tags()?;
                let first = tags.first().map_or("", String::as_str);
                if is_of(first, CONNECTIONS) || is_of(first, COMPONENT_BONDS) {
                    connections.read(tokens, &tags)?;
                }
            }
            Token::Tag(_) | Token::Value(_) => (),
        }
    }
    Ok(())
}
