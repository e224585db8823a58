//! Tests of bonds that files list. What other programs read is compared in `tests/library/readers.rs`.

use spherule_particles::{BondSource, Bonds, ParticleFrame, ReadOptions, read_frame};
use std::path::PathBuf;

const LAMMPS: &str = "# water\n\n3 atoms\n2 bonds\n1 atom types\n0 10 xlo xhi\n0 10 ylo yhi\n0 10 zlo zhi\n\n\
    Atoms # molecular\n\n30 1 1 0.5 5 5\n10 1 1 9.9 5 5\n20 1 1 1 5.5 5\n\nBonds\n\n1 2 10 30\n2 1 20 30 # x\n";

const PDB: &str = "\
CRYST1   10.000   10.000   10.000  90.00  90.00  90.00 P 1           1
MODEL        1
HETATM    7  O   HOH A   1       0.500   5.000   5.000  1.00  0.00           O
HETATM    8  H1  HOH A   1       9.900   5.000   5.000  1.00  0.00           H
HETATMA0009  H2  HOH A   1       1.000   5.800   5.000  1.00  0.00           H
ENDMDL
MODEL        2
HETATM    7  O   HOH A   1       1.500   5.000   5.000  1.00  0.00           O
HETATM    8  H1  HOH A   1       0.900   5.000   5.000  1.00  0.00           H
HETATMA0009  H2  HOH A   1       2.000   5.800   5.000  1.00  0.00           H
ENDMDL
CONECT    7    8A0009
CONECT    8    7
CONECTA0009    7    7
END
";

const MMCIF: &str = "data_x
loop_
_struct_conn.id
_struct_conn.conn_type_id
_struct_conn.ptnr1_auth_asym_id
_struct_conn.ptnr1_auth_seq_id
_struct_conn.ptnr1_label_comp_id
_struct_conn.ptnr1_label_atom_id
_struct_conn.pdbx_ptnr1_label_alt_id
_struct_conn.ptnr1_symmetry
_struct_conn.ptnr2_auth_asym_id
_struct_conn.ptnr2_auth_seq_id
_struct_conn.ptnr2_label_comp_id
_struct_conn.ptnr2_label_atom_id
_struct_conn.pdbx_ptnr2_label_alt_id
_struct_conn.ptnr2_symmetry
1 disulf A 1 CYS SG ? 1_555 A 2 CYS SG ? 1_555
2 hydrog A 1 CYS SG ? 1_555 A 2 CYS CB ? 1_555
3 covale A 1 CYS SG ? 1_555 A 2 CYS CB ? 2_655
#
loop_
_atom_site.label_atom_id
_atom_site.label_alt_id
_atom_site.label_comp_id
_atom_site.auth_asym_id
_atom_site.auth_seq_id
_atom_site.type_symbol
_atom_site.Cartn_x
_atom_site.Cartn_y
_atom_site.Cartn_z
_atom_site.occupancy
SG . CYS A 1 S 0 0 0 1
CB . CYS A 1 C 1.8 0 0 1
SG A CYS A 2 S 0 2.0 0 0.4
SG B CYS A 2 S 0 2.1 0 0.6
CB . CYS A 2 C 1.8 2 0 1
#
loop_
_chem_comp_bond.comp_id
_chem_comp_bond.atom_id_1
_chem_comp_bond.atom_id_2
_chem_comp_bond.value_order
CYS CB SG SING
CYS CB HB SING
";

/// Rock salt in a primitive setting of few operations, with one bond that all images repeat.
const CIF: &str = "data_x
_cell_length_a 4
_cell_length_b 4
_cell_length_c 4
loop_
_space_group_symop_operation_xyz
x,y,z
-x,-y,-z
loop_
_atom_site_label
_atom_site_type_symbol
_atom_site_fract_x
_atom_site_fract_y
_atom_site_fract_z
Na1 Na 0 0 0
Cl1 Cl 0.45 0 0
loop_
_geom_bond_atom_site_label_1
_geom_bond_atom_site_label_2
_geom_bond_distance
_geom_bond_site_symmetry_2
Na1 Cl1 1.8 .
Cl1 Cl1 0.4 2_655
";

const SDF: &str = "water\n\n\n  3  2  0  0  0  0            999 V2000\n\
    \x20   0.0000    0.0000    0.0000 O   0  0\n    0.9600    0.0000    0.0000 H   0  0\n\
    \x20  -0.2400    0.9300    0.0000 H   0  0\n  1  2  1  0\n  3  1  4  0\nM  END\n$$$$\n";

const V3000: &str = "water\n\n\n  0  0  0     0  0            999 V3000\nM  V30 BEGIN CTAB\n\
    M  V30 COUNTS 3 2 0 0 0\nM  V30 BEGIN ATOM\nM  V30 1 O 0 0 0 0\nM  V30 2 H 0.96 0 0 0\n\
    M  V30 3 H -0.24 0.93 0 0\nM  V30 END ATOM\nM  V30 BEGIN BOND\nM  V30 1 1 1 2\nM  V30 2 4 3 1\n\
    M  V30 END BOND\nM  V30 END CTAB\nM  END\n$$$$\n";

const MOL2: &str = "@<TRIPOS>MOLECULE\nwater\n3 2\n@<TRIPOS>ATOM\n5 O 0 0 0 O.3 1 HOH 0\n\
    6 H1 0.96 0 0 H 1 HOH 0\n7 H2 -0.24 0.93 0 H 1 HOH 0\n@<TRIPOS>BOND\n1 5 6 1\n2 7 5 ar\n3 6 7 nc\n";

const PSF: &str = "PSF\n\n 1 !NTITLE\n REMARKS x\n\n 3 !NATOM\n\
    1 A 1 HOH O OT -0.8 15.9994 0\n2 A 1 HOH H1 HT 0.4 1.008 0\n3 A 1 HOH H2 HT 0.4 1.008 0\n\n\
    2 !NBOND: bonds\n 1 2 3 1\n\n 0 !NTHETA: angles\n";

struct File {
    folder: tempfile::TempDir,
}

impl File {
    fn new(content: &str) -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        std::fs::write(folder.path().join("input"), content).expect("a file");
        Self { folder }
    }

    fn path(&self) -> PathBuf {
        self.folder.path().join("input")
    }

    fn read(&self, bonds: &str, frame: &str) -> Result<ParticleFrame, String> {
        let bonds = bonds.parse().expect(bonds);
        let options =
            ReadOptions { bonds, frame: frame.parse().expect(frame), ..ReadOptions::default() };
        let message = |error: spherule_particles::FileError| {
            error.to_string().replace(&self.path().display().to_string(), "input")
        };
        read_frame(&self.path(), &options).map_err(message)
    }
}

fn rows(bonds: &Bonds) -> Vec<(u32, u32, [i8; 3], &str)> {
    let kind = |bond: usize| if bonds.kinds.codes.is_empty() { "" } else { bonds.kinds.text(bond) };
    (0..bonds.len())
        .map(|bond| (bonds.first[bond], bonds.second[bond], bonds.shift_of(bond), kind(bond)))
        .collect()
}

fn bonds(content: &str, frame: &str) -> Bonds {
    let frame = File::new(content).read("file", frame).unwrap_or_else(|error| panic!("{error}"));
    assert!(frame.warnings.iter().all(|warning| !warning.contains("not drawn")));
    frame.bonds.expect("bonds")
}

#[test]
fn bonds_of_all_formats_are_read() {
    let none = [0; 3];
    for (content, expected) in [
        (LAMMPS, [(0, 1, [-1, 0, 0], "2"), (0, 2, none, "1")]),
        (SDF, [(0, 1, none, "1"), (0, 2, none, "4")]),
        (V3000, [(0, 1, none, "1"), (0, 2, none, "4")]),
        (MOL2, [(0, 1, none, "1"), (0, 2, none, "ar")]),
        (PDB, [(0, 1, [-1, 0, 0], ""), (0, 2, none, "")]),
    ] {
        assert_eq!(rows(&bonds(content, "first")), expected, "{content}");
    }
    // The records follow the last model; here no bond crosses the cell.
    assert_eq!(rows(&bonds(PDB, "1")), [(0, 1, none, ""), (0, 2, none, "")]);
    assert!(bonds(PDB, "first").partial && !bonds(SDF, "first").partial);
}

#[test]
fn connections_and_residues_of_mmcif_are_bonds() {
    let frame = File::new(MMCIF).read("file", "first").expect("a frame");
    let bonds = frame.bonds.as_ref().expect("bonds");
    let none = [0; 3];
    // The atom at the alternate location A is not drawn.
    let expected = [(0, 1, none, "sing"), (0, 2, none, "disulf"), (2, 3, none, "sing")];
    assert_eq!(rows(bonds), expected);
    assert!(frame.warnings.iter().any(|warning| warning.starts_with("1 bonds to symmetry images")));
}

#[test]
fn bonds_of_crystals_are_repeated_by_symmetry() {
    let found = bonds(CIF, "first");
    // Na at the origin, Cl at 0.45 and 0.55.
    let none = [0; 3];
    assert_eq!(rows(&found), [(0, 1, none, ""), (0, 2, [-1, 0, 0], ""), (1, 2, none, "")]);
}

#[test]
fn bonds_are_read_only_if_asked_for() {
    for content in [LAMMPS, PDB, MMCIF, CIF, SDF, V3000, MOL2] {
        let file = File::new(content);
        assert_eq!(file.read("none", "first").expect("a frame").bonds, None);
        let by_distance = file.read("*-*<1.1", "first").expect("a frame").bonds.expect("bonds");
        assert!(by_distance.kinds.codes.is_empty(), "{content}");
        let ids = file.read("file", "first").expect("a frame").numbers;
        assert!(ids.is_empty(), "{content}");
    }
}

#[test]
fn distances_complete_partial_lists() {
    let frame = File::new(PDB).read("auto", "first").expect("a frame");
    assert_eq!(frame.bonds.expect("bonds").len(), 2);
    let without = PDB.replace("CONECT    7    8A0009", "REMARK").replace("CONECT    8    7\n", "");
    let frame = File::new(&without).read("auto", "first").expect("a frame");
    assert_eq!(frame.bonds.expect("bonds").len(), 2);
    // A complete list stays as it is, though the hydrogens of LAMMPS have no element.
    let complete = SDF.replace("  3  2  0", "  3  1  0");
    assert_eq!(
        File::new(&complete).read("auto", "first").expect("a frame").bonds.expect("bonds").len(),
        1
    );
    let xyz = "3\n\nO 0 0 0\nH 0.96 0 0\nH -0.24 0.93 0\n";
    assert_eq!(
        File::new(xyz).read("auto", "first").expect("a frame").bonds.expect("bonds").len(),
        2
    );
    // Crystals without a table of bonds.
    let cif = "data_a\n_cell_length_a 5\n_cell_length_b 5\n_cell_length_c 5\n_cell_angle_alpha 90\n\
               _cell_angle_beta 90\n_cell_angle_gamma 90\nloop_\n_atom_site_label\n_atom_site_fract_x\n\
               _atom_site_fract_y\n_atom_site_fract_z\nC1 0.95 0 0\nO1 0.2 0 0\n";
    let bonds = File::new(cif).read("auto", "first").expect("a frame").bonds.expect("bonds");
    assert_eq!((bonds.len(), bonds.shift_of(0)), (1, [1, 0, 0]));
    assert!(File::new(cif).read("file", "first").is_err());
    let error = File::new(xyz).read("file", "first").expect_err("no bonds");
    assert!(error.starts_with("input: has no bonds in it"), "{error}");
}

#[test]
fn comments_and_continued_lines_are_no_rows() {
    let comments = MOL2
        .replace("5 O 0", "# atoms\n5 O 0")
        .replace("1 HOH 0\n6", "1 HOH 0 # oxygen\n6")
        .replace("2 7 5 ar", "#\tlast\n2 7 5 ar # x");
    let none = [0; 3];
    let expected = [(0, 1, none, "1"), (0, 2, none, "ar")];
    assert_eq!(rows(&bonds(&format!("{comments}\n#\tEnd of record\n"), "first")), expected);
    let continued = V3000
        .replace("COUNTS 3 2", "COUNTS -\nM  V30 3 2")
        .replace("1 O 0 0 0 0", "1 O 0 0 0 0 -\nM  V30 CFG=2 -\nM  V30 CHG=1")
        .replace("2 4 3 1", "2 4 -\nM  V30 3 1");
    let expected = [(0, 1, none, "1"), (0, 2, none, "4")];
    assert_eq!(rows(&bonds(&continued, "first")), expected);
}

#[test]
fn malformed_bonds_are_reported_at_their_line() {
    for (content, from, to, expected) in [
        (
            LAMMPS,
            "1 2 10 30",
            "1 2 10 31",
            "input:18:8: a bond to atom 31, but there is no such atom",
        ),
        (LAMMPS, "1 2 10 30", "1 2 10", "input:18:1: not the columns of a bond"),
        (LAMMPS, "1 2 10 30", "1 2 ten 30", "input:18:5: `ten` is not a whole number"),
        (LAMMPS, "20 1 1 1 5.5", "10 1 1 1 5.5", "input:18:5: several atoms have the number 10"),
        (LAMMPS, "Atoms # molecular", "Bonds\n\n1 1 1 2\n\nAtoms", "precedes the atoms"),
        (PDB, "CONECT    8    7", "CONECT    8    6", "input:13:1: a bond to atom 6"),
        (MMCIF, "1 disulf A 1", "1 disulf B 1", "input:17:1: a bond to atom B 1 CYS SG"),
        (CIF, "Na1 Cl1 1.8", "Na2 Cl1 1.8", "input:22:1: a bond to atom Na2"),
        (CIF, "2_655", "3_655", "input:23:1: `3_655` is not the code"),
        (CIF, "2_655", "2_6", "input:23:1: `2_6` is not the code"),
        (SDF, "  3  1  4", "  3  9  4", "input:9:6: a bond to atom 9"),
        (SDF, "  3  1  4", "  3  0  4", "a bond to atom 0"),
        (SDF, "  3  1  4", "  3", "not the columns of a bond"),
        (SDF, "  3  2  0", "  3  4  0", "not the columns of a bond"),
        (V3000, "2 4 3 1", "2 4 3", "not the columns of a bond"),
        (V3000, "2 4 3 1", "2 4 3 7", "a bond to atom 7"),
        (MOL2, "2 7 5 ar", "2 7 8 ar", "input:10:5: a bond to atom 8"),
        (MOL2, "2 7 5 ar", "2 7 5", "not the columns of a bond"),
    ] {
        let content = content.replacen(from, to, 1);
        let error = File::new(&content).read("auto", "first").expect_err(to);
        assert!(error.contains(expected), "{to}: {error}");
    }
}

#[test]
fn crystals_have_bonds_where_others_are_not_asked_for() {
    let crystal = "salt\n1\n3 0 0\n0 3 0\n0 0 3\nZn S\n1 1\nDirect\n0.1 0.1 0.1\n0.6 0.6 0.6\n";
    let molecule = "2\n\nO 0 0 0\nH 0.9 0 0\n";
    let bonds = |content: &str, wanted: &[&str]| {
        let mut options = ReadOptions { bonds: BondSource::OfCrystals, ..ReadOptions::default() };
        options.columns.wanted = wanted.iter().map(|&name| name.to_owned()).collect();
        let frame = read_frame(&File::new(content).path(), &options).expect("a frame");
        assert_eq!(frame.numbers.len(), wanted.len());
        frame.bonds.map(|bonds| bonds.len())
    };
    let without_element = crystal.replace("Zn", "Xx");
    for wanted in [&[][..], &["coordination"]] {
        assert_eq!(bonds(crystal, wanted), Some(8));
        assert_eq!(bonds(molecule, wanted), None);
    }
    assert_eq!(bonds(&without_element, &[]), None);
}

#[test]
fn bonds_of_a_topology_follow_the_frames() {
    let frame = File::new("3\n\nO 0 0 0\nH 0.96 0 0\nH -0.24 0.93 0\n");
    for (topology, partial) in [(PSF, false), (SDF, false), (PDB, true)] {
        let topology = File::new(topology);
        let options = ReadOptions {
            topology: Some(topology.path()),
            bonds: BondSource::File,
            ..ReadOptions::default()
        };
        let bonds = read_frame(&frame.path(), &options).expect("a frame").bonds.expect("bonds");
        assert_eq!((bonds.first, bonds.second), (vec![0, 0], vec![1, 2]));
        assert_eq!(bonds.partial, partial);
    }
    for (from, to, expected) in [
        (" 1 2 3 1\n", " 1 2 3\n", "an atom without another one"),
        (" 1 2 3 1\n", " 1 2 3 4\n", "a bond to atom 4"),
        (" 1 2 3 1\n", " 1 2 3 1 2 3\n", "more bonds than the section has"),
        (" 2 !NBOND", " 9 !NBOND", "a bond to atom 0"),
    ] {
        let topology = File::new(&PSF.replace("\n2 !N", "\n 2 !N").replacen(from, to, 1));
        let options = ReadOptions {
            topology: Some(topology.path()),
            bonds: BondSource::Auto,
            ..ReadOptions::default()
        };
        let error = read_frame(&frame.path(), &options).expect_err(expected).to_string();
        assert!(error.contains(expected), "{error}");
    }
}
