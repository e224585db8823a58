//! Bonds of mmCIF: `_struct_conn`, which connects residues, and `_chem_comp_bond`, which connects the atoms of
//! each residue of a name (<https://mmcif.wwpdb.org/dictionaries/mmcif_pdbx_v50.dic>).

use super::rows::Rows;
use super::tokens::{Token, Tokens};
use crate::{
    Bonds, FileError, ParticleFrame,
    bonds::{End, Listed},
};
use std::collections::HashMap;
use std::path::Path;
use std::sync::Arc;

/// Prefixes of the tags.
pub(super) const CONNECTIONS: &str = "_struct_conn.";
pub(super) const COMPONENT_BONDS: &str = "_chem_comp_bond.";

/// Types of connections that are bonds; others are hydrogen bonds, salt bridges and remarks.
const BONDS: [&str; 3] = ["covale", "disulf", "metalc"];

/// Columns of the residue of an atom: chain, number, insertion code and name.
const RESIDUE: [&str; 7] = [
    "auth_asym_id",
    "label_asym_id",
    "auth_seq_id",
    "label_seq_id",
    INSERTION,
    "label_comp_id",
    "auth_comp_id",
];
const INSERTION: &str = "pdbx_PDB_ins_code";

/// Indices of the columns that say the same of a residue, in order of preference.
const SAME: [&[usize]; 4] = [&[0, 1], &[2, 3], &[4], &[5, 6]];

/// Columns of the name of an atom, and of its alternate location.
const NAME: [&str; 2] = ["label_atom_id", "auth_atom_id"];
const LOCATION: &str = "label_alt_id";

/// An atom of a connection, as the file names it.
struct Partner {
    /// The columns of [`RESIDUE`], empty if their values are unknown; `None` without the column.
    residue: [Option<Vec<u8>>; RESIDUE.len()],
    name: Vec<u8>,
    location: Vec<u8>,
}

/// A connection of two atoms in a file.
struct Connection {
    partners: [Partner; 2],
    kind: Vec<u8>,
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

/// The atoms of a residue, by their rows.
struct Residue {
    /// The columns of [`RESIDUE`].
    ids: [Vec<u8>; RESIDUE.len()],
    rows: Vec<u32>,
}

/// Atoms by their residues and names.
pub(super) struct Atoms {
    columns: [Option<usize>; RESIDUE.len()],
    name: Option<usize>,
    location: Option<usize>,
    /// Names and alternate locations of all atoms.
    names: Vec<Vec<u8>>,
    locations: Vec<Vec<u8>>,
    residues: Vec<Residue>,
    /// Index of each residue, by all its columns.
    places: HashMap<Vec<u8>, usize>,
}

/// Indices of residues by the values of some of their columns.
#[derive(Default)]
struct Index {
    /// For each set of columns, as bits.
    by_columns: HashMap<u8, HashMap<Vec<u8>, Vec<usize>>>,
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
        Self {
            columns: RESIDUE.map(|wanted| column(names, [wanted, wanted])),
            name: column(names, NAME),
            location: column(names, [LOCATION, LOCATION]),
            names: Vec::new(),
            locations: Vec::new(),
            residues: Vec::new(),
            places: HashMap::new(),
        }
    }

    /// Adds the atom of the next row.
    pub(super) fn add(&mut self, rows: &Rows) {
        let field = |at: Option<usize>| known(at.map_or(b"", |at| rows.field(at)));
        let row = self.names.len() as u32;
        self.names.push(field(self.name).to_vec());
        self.locations.push(field(self.location).to_vec());
        let ids = self.columns.map(field);
        if let Some(last) = self.residues.last_mut().filter(|last| last.ids == ids) {
            last.rows.push(row);
            return;
        }
        let residues = &mut self.residues;
        let place = *self.places.entry(ids.join(&0)).or_insert_with(|| {
            residues.push(Residue { ids: ids.map(<[u8]>::to_vec), rows: Vec::new() });
            residues.len() - 1
        });
        residues[place].rows.push(row);
    }

    /// Returns the atoms of a name in a residue.
    fn named(&self, residue: &Residue, name: &[u8]) -> Vec<u32> {
        let rows = residue.rows.iter().copied();
        rows.filter(|row| self.names[*row as usize] == name).collect()
    }

    /// Returns the atoms that a connection names in a residue, at all alternate locations or at its own.
    fn find(&self, index: &mut Index, partner: &Partner) -> End<Vec<u32>> {
        // Columns of atoms with the values that they must have. An insertion code that is not known is none.
        let mut wanted: [Option<&[u8]>; RESIDUE.len()] = [None; RESIDUE.len()];
        for same in SAME {
            let given = |at: usize| {
                let value = partner.residue[at].as_deref()?;
                (!value.is_empty() || RESIDUE[at] == INSERTION).then_some(value)
            };
            let has = |at: usize| self.columns[at].is_some();
            let own = same.iter().find_map(|&at| Some((at, given(at)?)).filter(|_| has(at)));
            let other = || {
                Some((
                    same.iter().copied().find(|&at| has(at))?,
                    same.iter().find_map(|&at| given(at))?,
                ))
            };
            if let Some((at, value)) = own.or_else(other) {
                wanted[at] = Some(value);
            }
        }
        let rows = |&place: &usize| {
            let residue = &self.residues[place];
            (residue, self.named(residue, &partner.name))
        };
        let places = index.find(&self.residues, wanted);
        let mut found = places.iter().map(rows).filter(|(_, rows)| !rows.is_empty());
        let Some((first, mut rows)) = found.next() else { return End::Nowhere };
        for (residue, others) in found {
            // Residues of several names at a place are alternates.
            if residue.ids[..SAME[3][0]] != first.ids[..SAME[3][0]] {
                return End::Ambiguous;
            }
            rows.extend(others);
        }
        let location = &partner.location;
        rows.retain(|row| location.is_empty() || self.locations[*row as usize] == *location);
        End::Atom(rows)
    }

    /// Adds the bonds between atoms at the same alternate location, or at any if one of them has none.
    fn add_pairs(
        &self,
        bonds: &mut Listed,
        path: &Path,
        [first, second]: [Vec<u32>; 2],
        kind: &[u8],
    ) -> Result<(), FileError> {
        for &one in &first {
            for &other in &second {
                let [here, there] = [one, other].map(|row| &self.locations[row as usize]);
                if here == there || here.is_empty() || there.is_empty() {
                    bonds.push_named(path, (one, other, [0; 3]), kind)?;
                }
            }
        }
        Ok(())
    }
}

impl Index {
    /// Returns the residues whose columns have these values.
    fn find(&mut self, residues: &[Residue], wanted: [Option<&[u8]>; RESIDUE.len()]) -> &[usize] {
        let columns =
            wanted.iter().rev().fold(0, |bits, value| bits << 1 | u8::from(value.is_some()));
        let places = self.by_columns.entry(columns).or_insert_with(|| {
            let mut places = HashMap::<_, Vec<usize>>::new();
            for (place, residue) in residues.iter().enumerate() {
                let ids = residue.ids.iter().zip(wanted).filter(|(_, value)| value.is_some());
                let key = ids.map(|(id, _)| &id[..]).collect::<Vec<_>>().join(&0);
                places.entry(key).or_default().push(place);
            }
            places
        });
        let key = wanted.into_iter().flatten().collect::<Vec<_>>().join(&0);
        places.get(&key).map_or(&[], Vec::as_slice)
    }
}

impl Connections {
    /// Reads the rows of a table of connections or of bonds in residues.
    pub(super) fn read(&mut self, tokens: &mut Tokens, tags: &[String]) -> Result<(), FileError> {
        let prefix = tags.first().map_or(0, |tag| tag.find('.').map_or(0, |point| point + 1));
        let of_components = tags.first().is_some_and(|tag| is_of(tag, COMPONENT_BONDS));
        let names = tags.iter().map(|tag| tag.get(prefix..).unwrap_or(tag).to_owned());
        let names: Vec<String> = names.collect();
        let mut rows = Rows::new(tags.len());
        while rows.read(tokens)? {
            let fields: Vec<Vec<u8>> = rows.fields().map(<[u8]>::to_vec).collect();
            if of_components {
                self.add_component(&names, &fields);
            } else {
                self.add(&names, &fields);
            }
        }
        Ok(())
    }

    /// Adds a row of `_struct_conn`, or its items outside of a loop.
    pub(super) fn add(&mut self, names: &[String], fields: &[Vec<u8>]) {
        let field = |wanted: [&str; 2]| {
            known(column(names, wanted).map_or(b"", |at| fields[at].as_slice()))
        };
        let kind = field(["conn_type_id", "conn_type_id"]).to_ascii_lowercase();
        if !BONDS.iter().any(|bond| kind.starts_with(bond.as_bytes())) {
            return;
        }
        let symmetry = ["1", "2"].map(|atom| {
            let name = format!("ptnr{atom}_symmetry");
            field([&name, &name])
        });
        let is_same = |symmetry: &[u8]| matches!(symmetry, b"" | b"1_555");
        if symmetry[0] != symmetry[1] && !symmetry.into_iter().all(is_same) {
            self.symmetric += 1;
            return;
        }
        let partners = ["1", "2"].map(|atom| {
            // Names are those of the atoms after `ptnr1_`, and after `pdbx_` for some.
            let value = |name: &str| {
                let own = name.strip_prefix("pdbx_").unwrap_or(name);
                let [plain, other] = ["", "pdbx_"].map(|start| format!("{start}ptnr{atom}_{own}"));
                column(names, [&plain, &other]).map(|at| known(&fields[at]).to_vec())
            };
            Partner {
                residue: RESIDUE.map(value),
                name: NAME.into_iter().find_map(value).unwrap_or_default(),
                location: value(LOCATION).unwrap_or_default(),
            }
        });
        self.list.push(Connection { partners, kind });
    }

    /// Adds a row of `_chem_comp_bond`, or its items outside of a loop.
    pub(super) fn add_component(&mut self, names: &[String], fields: &[Vec<u8>]) {
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
        for residue in &atoms.residues {
            let name = SAME[3].iter().map(|&at| &residue.ids[at]).find(|name| !name.is_empty());
            for [first, second, order] in
                name.and_then(|name| self.components.get(name)).into_iter().flatten()
            {
                let ends = [first, second].map(|name| atoms.named(residue, name));
                atoms.add_pairs(&mut bonds, path, ends, order)?;
            }
        }
        let mut index = Index::default();
        for Connection { partners, kind } in &self.list {
            let ends = partners.each_ref().map(|partner| atoms.find(&mut index, partner));
            if let Some(ends) = bonds.ends(ends) {
                atoms.add_pairs(&mut bonds, path, ends, kind)?;
            }
        }
        if self.symmetric > 0 {
            let count = self.symmetric;
            let warning = format!("{count} bonds to symmetry images of atoms are left out");
            frame.warnings.push(warning);
        }
        Ok(bonds.finish())
    }
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
