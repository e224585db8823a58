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

/// Returns the warnings that bonds are left out.
fn dangling(frame: &ParticleFrame) -> Vec<&str> {
    let warnings = frame.warnings.iter().map(String::as_str);
    warnings.filter(|warning| warning.contains("bond") && warning.contains("left out")).collect()
}

#[test]
fn bonds_that_end_nowhere_are_left_out_and_counted() {
    let two_of_cif = ["1.8 .\nCl1 Cl1 0.4 2_655", "1.8 7_555\nNa1 H1 1 ."];
    let connected = "CONECT    8    7";
    // What replaces what in a file, and what is then said of the bonds that are left out.
    let (one, several) = ("1 bond ends at no atom", "1 bond ends at an atom whose number");
    for (content, said, left, changes) in [
        (LAMMPS, one, 1, &[["1 2 10 30", "1 2 10 31"]][..]),
        (LAMMPS, several, 1, &[["30 1 1 0.5 5 5\n", "30 1 1 0.5 5 5\n10 1 1 7 5 5\n"]]),
        (PDB, one, 2, &[[connected, "CONECT    8    7    6    6"]]),
        (PDB, several, 0, &[["HETATMA0009", "HETATM    8"]]),
        (MMCIF, one, 2, &[["1 disulf A 1", "1 disulf B 1"]]),
        (CIF, one, 1, &[["Na1 Cl1 1.8", "Na2 Cl1 1.8"]]),
        (CIF, one, 2, &[["2_655", "3_655"], ["2_655", "2_6"], ["2_655", "0_655"]]),
        (CIF, "2 bonds end at no atom", 0, &[two_of_cif]),
        (SDF, one, 1, &[["  3  1  4", "  3  9  4"], ["  3  1  4", "  3  0  4"]]),
        (V3000, one, 1, &[["2 4 3 1", "2 4 3 7"]]),
        (MOL2, one, 1, &[["2 7 5 ar", "2 7 8 ar"]]),
        (MOL2, several, 0, &[["7 H2", "6 H2"]]),
    ] {
        for [from, to] in changes {
            let content =
                content.replacen("\n3 atoms", "\n4 atoms", usize::from(to.contains('\n')));
            let content = content.replacen(from, to, 1);
            let file = File::new(&content);
            let frame = file.read("file", "first").unwrap_or_else(|error| panic!("{to}: {error}"));
            let warnings = dangling(&frame);
            assert!(warnings.iter().any(|warning| warning.starts_with(said)), "{to}: {warnings:?}");
            assert_eq!(frame.bonds.as_ref().map(Bonds::len), Some(left), "{content}");
            for bonds in ["none", "*-*<1.1"] {
                let frame = file.read(bonds, "first").expect("a frame");
                assert!(dangling(&frame).is_empty(), "{to}");
            }
        }
    }
    let molecule = File::new("3\n\nO 0 0 0\nH 0.96 0 0\nH -0.24 0.93 0\n");
    let topology = File::new(&PSF.replacen(" 1 2 3 1\n", " 1 2 3 4\n", 1));
    for (bonds, expected) in [(BondSource::File, 1), (BondSource::OfCrystals, 0)] {
        let topology = Some(topology.path());
        let options = ReadOptions { topology, bonds, ..ReadOptions::default() };
        let frame = read_frame(&molecule.path(), &options).expect("a frame");
        assert_eq!(dangling(&frame).len(), expected);
        assert_eq!(frame.bonds.map_or(0, |bonds| bonds.len()), expected);
    }
    // Bonds of GSD are pairs of rows.
    let sample = concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/data/particles/bonds.gsd");
    let mut bytes = std::fs::read(sample).expect("a file");
    let group = [0_u32, 1, 1, 2].map(u32::to_le_bytes).concat();
    let at = bytes.windows(group.len()).position(|window| window == group).expect("bonds");
    bytes[at] = 200;
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("input");
    std::fs::write(&path, bytes).expect("a file");
    let options = ReadOptions { bonds: BondSource::File, ..ReadOptions::default() };
    let frame = read_frame(&path, &options).expect("a frame");
    assert_eq!((dangling(&frame).len(), frame.bonds.map_or(0, |bonds| bonds.len())), (1, 1));
}

#[test]
fn pictures_without_bonds_read_none() {
    for content in [LAMMPS, PDB, MMCIF, SDF, V3000, MOL2] {
        // Rows of bonds that could not be read.
        let broken = content
            .replace("1 2 10 30", "1 x")
            .replace("  1  2  1  0", "  x")
            .replace("M  V30 1 1 1 2", "M  V30 x")
            .replace("1 5 6 1", "x");
        for bonds in [BondSource::None, BondSource::OfCrystals] {
            let options = ReadOptions { bonds, ..ReadOptions::default() };
            let frame = read_frame(&File::new(&broken).path(), &options).expect("a frame");
            assert_eq!(frame.bonds, None);
            assert!(frame.warnings.iter().all(|warning| !warning.contains("bond")), "{content}");
        }
    }
}

#[test]
fn connections_find_atoms_by_what_their_rows_give() {
    let atoms = "data_t\nloop_\n_atom_site.type_symbol\n_atom_site.label_atom_id\n_atom_site.label_comp_id\n\
        _atom_site.label_asym_id\n_atom_site.label_seq_id\n_atom_site.auth_seq_id\n_atom_site.auth_asym_id\n\
        _atom_site.Cartn_x\n_atom_site.Cartn_y\n_atom_site.Cartn_z\n\
        S SG CYS A 1 11 B 0 0 0\nS SG CYS A 7 17 B 2.0 0 0\nS SG CYS C 7 17 D 9.0 0 0\n\
        loop_\n_struct_conn.conn_type_id\n";
    for (columns, row, expected) in [
        ("auth_asym_id auth_seq_id label_atom_id", "B 11 SG B 17 SG", 1),
        ("label_asym_id label_seq_id label_atom_id", "A 1 SG A 7 SG", 1),
        ("label_seq_id label_comp_id label_atom_id", "1 CYS SG 7 CYS SG", 0),
        ("auth_asym_id label_seq_id label_comp_id label_atom_id", "B 1 CYS SG B 7 ? SG", 1),
        ("auth_asym_id auth_seq_id label_atom_id", "B 11 SG B 18 SG", 0),
        ("auth_asym_id auth_seq_id label_atom_id", "B 11 SG B 17 CB", 0),
    ] {
        let tags = [1, 2].map(|atom| {
            let tag = |name| format!("_struct_conn.ptnr{atom}_{name}\n");
            columns.split(' ').map(tag).collect::<String>()
        });
        let content = format!("{atoms}{}disulf {row}\n", tags.concat());
        let frame = File::new(&content).read("file", "first").expect("a frame");
        assert_eq!(dangling(&frame).len(), 1 - expected, "{row}");
        assert_eq!(frame.bonds.map_or(0, |bonds| bonds.len()), expected, "{row}");
    }
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

const COMPONENTS: &str = "data_XYZ\n_chem_comp.id XYZ\n_chem_comp.name 'a ligand'\nloop_\n_chem_comp_atom.comp_id\n\
    _chem_comp_atom.atom_id\n_chem_comp_atom.type_symbol\n_chem_comp_atom.model_Cartn_x\n\
    _chem_comp_atom.model_Cartn_y\n_chem_comp_atom.model_Cartn_z\n\
    _chem_comp_atom.pdbx_model_Cartn_x_ideal\n_chem_comp_atom.pdbx_model_Cartn_y_ideal\n\
    _chem_comp_atom.pdbx_model_Cartn_z_ideal\nXYZ C1 C 0 0 0 ? ? ?\nXYZ O1 O 1.2 0 0 7 7 7\nXYZ H1 H 0 -1 0 ? ? ?\n\
    loop_\n_chem_comp_bond.comp_id\n_chem_comp_bond.atom_id_1\n_chem_comp_bond.atom_id_2\n\
    _chem_comp_bond.value_order\nXYZ C1 O1 DOUB\nXYZ C1 H1 SING\n\
    data_NA\n_chem_comp_atom.comp_id NA\n_chem_comp_atom.atom_id NA\n_chem_comp_atom.type_symbol NA\n\
    _chem_comp_atom.model_Cartn_x ?\n_chem_comp_atom.model_Cartn_y ?\n_chem_comp_atom.model_Cartn_z ?\n\
    _chem_comp_atom.pdbx_model_Cartn_x_ideal 5\n_chem_comp_atom.pdbx_model_Cartn_y_ideal 6\n\
    _chem_comp_atom.pdbx_model_Cartn_z_ideal 7\n";

#[test]
fn ligand_definitions_are_frames() {
    let file = File::new(COMPONENTS);
    let frame = file.read("auto", "0").expect("a frame");
    assert_eq!((&frame.x[..], &frame.title[..]), (&[0.0, 1.2, 0.0][..], "a ligand"));
    let symbols = |frame: &ParticleFrame| -> Vec<&str> {
        let kinds = frame.kinds.table.iter();
        kinds.filter_map(|kind| Some(kind.element?.symbol())).collect()
    };
    assert_eq!(symbols(&frame), ["C", "O", "H"]);
    let bonds = frame.bonds.as_ref().expect("bonds");
    assert_eq!(rows(bonds), [(0, 1, [0; 3], "doub"), (0, 2, [0; 3], "sing")]);
    assert!(!bonds.partial);
    assert!(frame.warnings.iter().any(|warning| warning.contains("--frame")));
    let ion = file.read("auto", "last").expect("a frame");
    assert_eq!((ion.position(0).to_array(), symbols(&ion)), ([5.0, 6.0, 7.0], vec!["Na"]));
    let count =
        |file: &File| spherule_particles::count_frames(&file.path(), &ReadOptions::default());
    assert_eq!(count(&file).ok(), Some(2));
    // Loops and items that do not belong together.
    for table in [
        "loop_\n_chem_comp_atom.x\n_a\n1 2\n_chem_comp_atom.y 5\n_chem_comp_atom.z 6\n",
        "_chem_comp_atom.x 5\nloop_\n_chem_comp_atom.y\n_chem_comp_atom.z\n",
        "loop_\n_struct_conn.id\n_a\n1 2\n",
    ] {
        let none = File::new(&format!("data_a\n{table}")).read("auto", "first");
        assert!(none.is_err() || none.is_ok_and(|frame| frame.is_empty()), "{table}");
    }
    // Definitions after or beside the atoms of a structure are not drawn.
    let beside =
        MMCIF.replacen("data_x\n", &COMPONENTS[..COMPONENTS.find("data_NA").expect("an ion")], 1);
    for content in [format!("{MMCIF}{COMPONENTS}"), beside] {
        let file = File::new(&content);
        assert_eq!(count(&file).ok(), Some(1), "{content}");
        assert_eq!(file.read("auto", "first").expect("a frame").len(), 4);
    }
}

#[test]
fn malformed_bonds_are_reported_at_their_line() {
    for (content, from, to, expected) in [
        (LAMMPS, "1 2 10 30", "1 2 10", "input:18:1: not the columns of a bond"),
        (LAMMPS, "1 2 10 30", "1 2 ten 30", "input:18:5: `ten` is not a whole number"),
        (LAMMPS, "Atoms # molecular", "Bonds\n\n1 1 1 2\n\nAtoms", "precedes the atoms"),
        (SDF, "  3  1  4", "  3", "not the columns of a bond"),
        (SDF, "  3  2  0", "  3  4  0", "not the columns of a bond"),
        (V3000, "2 4 3 1", "2 4 3", "not the columns of a bond"),
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
        (" 1 2 3 1\n", " 1 2 3 1 2 3\n", "more bonds than the section has"),
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
