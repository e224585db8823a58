//! Synonyms of column names in common programs.

use super::role::Role;

/// Groups of synonyms in PDB, GRO, mmCIF, LAMMPS and extended XYZ files, and in `MDAnalysis`, VMD,
/// `PyMOL` and OVITO. If a file has no column of the requested name, the first synonym in the file is
/// used.
pub const GROUPS: [&[&str]; 28] = [
    &["id", "serial", "particle identifier", "number", "atom_id", "atomid"],
    &["name", "atom_name", "atomname", "label_atom_id", "auth_atom_id"],
    &["residue", "resname", "resn", "auth_comp_id", "label_comp_id", "residue_name"],
    &["residue_number", "resid", "resi", "resnum", "resseq", "auth_seq_id", "label_seq_id"],
    &["chain", "chainid", "chain_id", "auth_asym_id", "label_asym_id"],
    &["segment", "segid", "segi", "segment_id"],
    &["mol", "molecule", "molecule_id", "molid", "molecule identifier"],
    &["mass", "masses"],
    &["charge", "q", "charges", "partial_charge", "formal_charge", "pdbx_formal_charge"],
    &["b_factor", "bfactor", "beta", "tempfactor", "temp_factor", "b_iso_or_equiv", "b"],
    &["occupancy", "occ", "occupancies"],
    &["altloc", "alt", "label_alt_id"],
    &["insertion", "icode", "pdbx_pdb_ins_code"],
    &["vx", "velocity.x", "velocity_x", "vel_x", "velo_x", "velocity:0", "velocity_0"],
    &["vy", "velocity.y", "velocity_y", "vel_y", "velo_y", "velocity:1", "velocity_1"],
    &["vz", "velocity.z", "velocity_z", "vel_z", "velo_z", "velocity:2", "velocity_2"],
    &["fx", "force.x", "force_x", "forces_x"],
    &["fy", "force.y", "force_y", "forces_y"],
    &["fz", "force.z", "force_z", "forces_z"],
    &["mux", "dipole.x", "dipole_x", "dipoles_x", "dipole orientation.x"],
    &["muy", "dipole.y", "dipole_y", "dipoles_y", "dipole orientation.y"],
    &["muz", "dipole.z", "dipole_z", "dipoles_z", "dipole orientation.z"],
    &["spx", "spin.x", "spin_x", "magmom_x", "magmoms_x"],
    &["spy", "spin.y", "spin_y", "magmom_y", "magmoms_y"],
    &["spz", "spin.z", "spin_z", "magmom_z", "magmoms_z"],
    &["xu", "unwrapped position.x"],
    &["yu", "unwrapped position.y"],
    &["zu", "unwrapped position.z"],
];

/// Names of the coordinate of an axis: those that are suggested, then those made of a word, and of the axis or its index in
/// arrays of vectors. `@with_words` passes the words on.
macro_rules! coordinate {
    ($axis:literal, $index:literal, $($suggested:literal)*) => {
        coordinate!(@with_words names $axis, $index, [$($suggested)*])
    };
    (@with_words $next:ident $($arguments:tt)*) => {
        coordinate!(@$next $($arguments)*, "pos" "position" "positions" "coord" "coords" "coordinate" "coordinates"
            "cartn" "point" "points" "center" "centre" "centroid" "location")
    };
    (@words, $($word:literal)*) => {
        &[$($word,)*]
    };
    (@names $axis:literal, $index:literal, [$($suggested:literal)*], $($word:literal)*) => {
        &[
            $($suggested,)*
            $(
                concat!($word, "_", $axis), concat!($word, ".", $axis), concat!($word, ":", $axis),
                concat!($word, " ", $axis), concat!($word, $axis), concat!($axis, "_", $word),
                concat!($axis, ".", $word), concat!($axis, " ", $word), concat!($axis, $word),
                concat!($word, "_", $index), concat!($word, ".", $index), concat!($word, ":", $index),
            )*
        ]
    };
}

/// Words that names of coordinates begin with.
const WORDS: &[&str] = coordinate!(@with_words words);

/// Returns names of x, y and z that are numbered from 1, which mean positions where no other name does: with numbers from 0,
/// two of them are others.
pub(crate) fn numbered_from_one() -> impl Iterator<Item = [String; 3]> {
    let names = |word: &str, mark: &str| [1, 2, 3].map(|axis| format!("{word}{mark}{axis}"));
    WORDS.iter().flat_map(move |word| ["_", "", ".", ":", " "].map(|mark| names(word, mark)))
}

/// Number of names of a role that are suggested.
const SUGGESTED: usize = 6;

/// Names that imply a role, ignoring case, in order of precedence.
pub(crate) const USUAL: [(Role, &[&str]); 10] = [
    (Role::X, coordinate!("x", "0", "x" "pos_x" "position_x" "position.x" "cartn_x" "points:0")),
    (Role::Y, coordinate!("y", "1", "y" "pos_y" "position_y" "position.y" "cartn_y" "points:1")),
    (Role::Z, coordinate!("z", "2", "z" "pos_z" "position_z" "position.z" "cartn_z" "points:2")),
    (Role::Radius, &["radius"]),
    (Role::Diameter, &["diameter"]),
    (
        Role::Kind,
        &[
            "element",
            "species",
            "symbol",
            "type_symbol",
            "typelabel",
            "type",
            "typeid",
            "particle type",
        ],
    ),
    (Role::Red, &["red", "color.r"]),
    (Role::Green, &["green", "color.g"]),
    (Role::Blue, &["blue", "color.b"]),
    (Role::Material, &["material"]),
];

/// Returns the names that imply a role, in order of precedence.
pub(crate) fn usual(role: Role) -> &'static [&'static str] {
    USUAL.iter().find(|(own, _)| *own == role).map_or(&[], |(_, names)| names)
}

/// Returns the names of the role that a name implies, ignoring case; none for colors and materials,
/// which are not columns of numbers or texts.
fn names_of_role(name: &str) -> Option<&'static [&'static str]> {
    let named = |names: &&[&str]| names.iter().any(|own| own.eq_ignore_ascii_case(name));
    let roles = [Role::X, Role::Y, Role::Z, Role::Radius, Role::Diameter, Role::Kind];
    let mut rows = USUAL.iter().filter(|(role, _)| roles.contains(role)).map(|(_, names)| *names);
    rows.find(named)
}

/// Returns the synonyms of a column name, ignoring case, the usual one first.
pub fn of(name: &str) -> impl Iterator<Item = &'static str> {
    up_to(name, usize::MAX)
}

/// Returns the synonyms of a column name among so many names of its role.
fn up_to(name: &str, most: usize) -> impl Iterator<Item = &'static str> {
    let same = |other: &&&str| other.eq_ignore_ascii_case(name);
    let group = GROUPS.iter().find(|group| group.iter().any(|own| same(&own)));
    let of_role = || names_of_role(name).map(|names| &names[..names.len().min(most)]);
    let names = group.copied().or_else(of_role).unwrap_or_default();
    names.iter().copied().filter(move |other| !other.eq_ignore_ascii_case(name))
}

/// Returns the usual names for the columns of a file.
pub fn typed<'n>(columns: impl Iterator<Item = &'n str>) -> Vec<&'n str> {
    let mut names: Vec<&'n str> = Vec::new();
    for name in columns {
        names.push(name);
        for other in up_to(name, SUGGESTED) {
            names.push(other);
        }
    }
    names
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_name_is_in_one_group() {
        let all: Vec<&str> = GROUPS.iter().flat_map(|group| group.iter().copied()).collect();
        for (place, name) in all.iter().enumerate() {
            assert!(!all[..place].contains(name), "{name}");
            assert_eq!(*name, name.to_lowercase());
        }
    }

    #[test]
    fn synonyms_find_each_other() {
        let finds = |name: &str, other: &str| of(name).any(|own| own == other);
        for (name, other) in [
            ("resname", "residue"),
            ("residue", "auth_comp_id"),
            ("resid", "residue_number"),
            ("chainID", "chain"),
            ("bfactor", "b_iso_or_equiv"),
            ("beta", "b_factor"),
            ("q", "charge"),
            ("charge", "q"),
            ("Molecule Identifier", "mol"),
            ("Position.X", "x"),
            ("x", "position.x"),
            ("Particle Type", "type"),
            ("species", "type"),
            ("Points_0", "x"),
            ("y", "y_coord"),
            ("z", "coordinates_2"),
            ("X Position", "centroid.x"),
        ] {
            assert!(finds(name, other), "{name} {other}");
        }
        assert_eq!(of("speed").count(), 0);
        assert_eq!(
            typed(["x"].into_iter()),
            ["x", "pos_x", "position_x", "position.x", "cartn_x", "points:0"]
        );
    }
}
