//! Tests that readers say what they leave out, and refuse options that have no effect.

use crate::common::file;
use spherule_particles::{BondSource, FrameChoice, Radii, ReadOptions, count_frames, read_frame};

/// Returns the number of particles and all warnings.
fn warnings(content: &str) -> (usize, String) {
    let options = ReadOptions::default();
    let frame = read_frame(&file(content).path, &options).unwrap_or_else(|error| panic!("{error}"));
    (frame.len(), frame.warnings.join("; "))
}

const DATA: &str = "salt\n\n2 atoms\n1 atom types\n0 9 xlo xhi\n0 9 ylo yhi\n0 9 zlo zhi\n\nAtoms # atomic\n\n\
    1 1 0.5 1 1\n2 1 3 1 1\n";

const SDF: &str = "water\n\n\n  2  1  0  0  0  0            999 V2000\n\
    \x20   0.0000    0.0000    0.0000 O   0  0\n    0.9600    0.0000    0.0000 H   0  0\n  1  2  1  0\nM  END\n";

const V3000: &str = "water\n\n\n  0  0  0     0  0            999 V3000\nM  V30 BEGIN CTAB\nM  V30 COUNTS 2 0 0 0 0\n\
    M  V30 BEGIN ATOM\nM  V30 1 O 0.0 0.0 0.0 0\nM  V30 2 H 0.96 0.0 0.0 0\nM  V30 END ATOM\nM  V30 END CTAB\nM  END\n";

const MOL2: &str = "@<TRIPOS>MOLECULE\nwater\n2 0\n@<TRIPOS>ATOM\n1 O 0 0 0 O.3\n2 H 0.96 0 0 H\n";

const POSCAR: &str =
    "salt\n1\n4 0 0\n0 4 0\n0 0 4\nNa Cl\n1 1\nDirect\n0 0 0\n0.5 0.5 0.5\n\n0 0 0\n0 0 0\n";

const CFG: &str = "Number of particles = 2\nA = 1.0 Angstrom\nH0(1,1) = 4\nH0(2,2) = 4\nH0(3,3) = 4\n\
    .NO_VELOCITY.\nentry_count = 3\n22.99\nNa\n0 0 0\n35.45\nCl\n0.5 0.5 0.5\n";

const EXTENDED: &str = "2\nProperties=species:S:1:pos:R:3 pbc=\"F F F\"\nNa 0 0 0\nCl 1 1 1\n";

const DUMP: &str = "ITEM: TIMESTEP\n0\nITEM: NUMBER OF ATOMS\n2\nITEM: BOX BOUNDS pp pp pp\n0 9\n0 9\n0 9\n\
    ITEM: ATOMS id type x y z\n1 1 0.5 1 0\n2 1 3 1 0\n";

const CIF: &str = "data_a\n_cell_length_a 4\n_cell_length_b 4\n_cell_length_c 4\nloop_\n_atom_site_label\n\
    _atom_site_fract_x\n_atom_site_fract_y\n_atom_site_fract_z\nNa1 0 0 0\nCl1 0.5 0.5 0.5\n";

#[test]
fn files_that_are_whole_have_no_warnings() {
    for content in [DATA, SDF, V3000, MOL2, POSCAR, CFG, EXTENDED, DUMP, CIF] {
        let (count, said) = warnings(content);
        assert_eq!(count, 2, "{content}");
        assert!(!said.contains("rows") && !said.contains("header"), "{content}{said}");
    }
}

#[test]
fn rows_beyond_a_count_are_told() {
    let again = CIF.replacen("data_a", "data_b", 1);
    for (content, from, to, expected) in [
        (DATA, "2 1 3 1 1\n", "2 1 3 1 1\n3 1 5 1 1\n", "rows follow the 2 atoms"),
        (DATA, "0 9 ylo yhi", "0 9 ylo yhii", "not known: `0 9 ylo yhii`"),
        (SDF, "  1  2  1  0\n", "    0.1000    0.0000    0.0000 H   0  0\n", "rows follow"),
        (V3000, "M  V30 END ATOM", "M  V30 3 H 0.0 0.5 0.0 0\nM  V30 END ATOM", "rows follow"),
        (MOL2, "2 0\n", "3 0\n", "has 2 atoms, but counts 3"),
        (POSCAR, "\n\n0 0 0", "\n0.2 0.2 0.2\n\n0 0 0", "rows follow the 2 atoms"),
        (CFG, "0.5 0.5 0.5\n", "0.5 0.5 0.5\n0.2 0.2 0.2\n", "rows follow the 2 atoms"),
        (CFG, "A = 1.0", "Transform(1,2) = 0.1\nA = 1.0", "`Transform` and `eta`"),
        (EXTENDED, "Na 0 0 0", "Na 0 0 0 7", "5 columns, of which 4 are named"),
        (DUMP, "1 1 0.5 1 0", "1 1 0.5 1 0 7", "6 columns, of which 5 are named"),
        (CIF, "Cl1 0.5 0.5 0.5\n", &format!("Cl1 0.5 0.5 0.5\n{again}"), "first of several frames"),
    ] {
        assert!(content.contains(from), "{from}");
        let (count, said) = warnings(&content.replacen(from, to, 1));
        assert!(count == 2 && said.contains(expected), "{to}: {said}");
    }
    // What follows the first block does not turn it away.
    let broken = format!("{CIF}{}", again.replacen("0.5 0.5 0.5", "0.5 x 0.5", 1));
    assert_eq!(warnings(&broken).0, 2);
}

#[test]
fn rows_that_are_no_atoms_are_refused() {
    let axsf = "ATOMS\nNa 0.0 0.0 0.0\nCl 1.0O 1.0 1.0\n";
    let error = read_frame(&file(axsf).path, &ReadOptions::default()).expect_err("a letter");
    assert!(error.to_string().contains("input:3:4: `1.0O` is not a number"), "{error}");
}

#[test]
fn columns_that_mix_numbers_and_texts_are_named() {
    let mut options = ReadOptions::default();
    options.columns.rest = Some(100);
    let table = file("x,y,z,q,r2\n0,0,0,1,1\n1,1,1,one,2\n");
    let frame = read_frame(&table.path, &options).expect("a frame");
    assert_eq!(frame.warnings, ["columns that mix numbers and texts are not read: q"]);
    assert_eq!(frame.numbers.len(), 1);
}

#[test]
fn roles_without_effect_are_refused() {
    let table = "a,b,c,d,e\n0,0,0,1,1\n1,1,1,2,2\n";
    for (columns, expected) in [
        ("x=a,y=a,z=c", "cannot be x, since it is y"),
        ("x=a,y=b,z=c,radius=a", "cannot be radius, since it is x"),
        ("x=a,y=b,z=c,x=d", "x is the column `a`, and cannot be `d`, too"),
        ("x=a,y=b,z=c,radius=d,diameter=e", "radius and diameter are given"),
        ("x=a,y=b,z=c,red=d", "all three of red, green and blue"),
    ] {
        let columns = columns.parse().expect("columns");
        let options = ReadOptions { columns, ..ReadOptions::default() };
        let error = read_frame(&file(table).path, &options).expect_err(expected);
        assert!(error.to_string().contains(expected), "{error}");
    }
    let columns = "x=a,y=b,z=c,radius=d".parse().expect("columns");
    let options = ReadOptions { columns, ..ReadOptions::default() };
    assert_eq!(read_frame(&file(table).path, &options).expect("radii").radius, [1.0, 2.0]);
    let radii = Radii::Column("e".to_owned());
    let error = read_frame(&file(table).path, &ReadOptions { radii, ..options });
    assert!(error.is_err_and(|error| error.to_string().contains("radius is the column `e`")));
    // Positions of these formats are where they are.
    let columns = "x=q".parse().expect("columns");
    let options = ReadOptions { columns, ..ReadOptions::default() };
    for content in [POSCAR, CFG] {
        let error = read_frame(&file(content).path, &options).expect_err("fixed");
        assert!(error.to_string().contains("`x=q` has no effect"), "{error}");
    }
}

#[test]
fn cells_without_a_volume_are_left_out_with_a_warning() {
    let flat = |lattice: &str| {
        format!("1\nLattice=\"{lattice}\" Properties=species:S:1:pos:R:3\nNa 0 0 0\n")
    };
    let cryst = |angles: &str| {
        format!(
            "CRYST1   10.000   10.000   10.000{angles} P 1           1\n\
             HETATM    1  C   GRA A   1       0.500   1.000   0.000  1.00  0.00           C\n"
        )
    };
    for (content, expected) in [
        (flat("1 0 0 2 0 0 0 0 3"), "no volume"),
        (flat("1 0 0 2 0 0 0 0 0"), "no volume"),
        (cryst(" 150.00 150.00 150.00"), "such angles"),
        (
            DUMP.replace("ITEM: BOX BOUNDS pp pp pp", "ITEM: BOX BOUNDS xy xz yz pp pp pp")
                .replace("0 9\n0 9\n0 9", "0 9 9\n0 9 0\n0 0 0"),
            "",
        ),
        (flat("0 0 0 0 0 0 0 0 0"), ""),
        (cryst("  90.00  90.00  90.00"), ""),
    ] {
        let found = warnings(&content).1;
        let has = found.contains("its cell is left out") && found.contains(expected);
        assert_eq!(has, !expected.is_empty(), "{content}{found}");
    }
}

#[test]
fn models_of_pqr_and_blocks_of_mmcif_are_frames() {
    let atom = "ATOM 1 N NTR 0 63.889 69.990 133.214 0.1414 1.8240\n";
    let block = |name: &str, cell: &str| {
        format!(
            "data_{name}\n{cell}loop_\n_atom_site.type_symbol\n_atom_site.Cartn_x\n_atom_site.Cartn_y\n\
             _atom_site.Cartn_z\nC 0.5 1 0\n"
        )
    };
    let cell = "_struct.title first\n_cell.length_a 6\n_cell.length_b 5\n_cell.length_c 4\n_cell.angle_alpha 90\n\
        _cell.angle_beta 90\n_cell.angle_gamma 90\n";
    for content in [
        format!("MODEL 1\n{atom}ENDMDL\nMODEL 2\n{atom}{atom}ENDMDL\n"),
        format!("MODEL 1\n{atom}MODEL 2\n{atom}{atom}"),
        block("a", cell) + &block("b", "") + "C 0.5 2 0\n",
    ] {
        let file = file(&content);
        let count = count_frames(&file.path, &ReadOptions::default()).expect("frames");
        assert_eq!(count, 2, "{content}");
        let (first, found) = warnings(&content);
        assert!(first == 1 && found.contains("only the first of several frames"), "{found}");
        let options = ReadOptions { frame: FrameChoice::Index(1), ..ReadOptions::default() };
        let second = read_frame(&file.path, &options).expect("the second frame");
        assert_eq!((second.len(), second.cell, second.title.as_str()), (2, None, ""), "{content}");
    }
    assert_eq!(warnings(&atom.repeat(2)), (2, String::new()));
}

#[test]
fn bonds_of_labels_that_repeat_are_left_out() {
    let bonds =
        "loop_\n_geom_bond_atom_site_label_1\n_geom_bond_atom_site_label_2\nNa1 Cl1\nCl1 K1\n";
    let content = format!("{CIF}Na1 0.1 0.5 0.5\nK1 0.9 0.5 0.5\n{bonds}");
    let options = ReadOptions { bonds: BondSource::File, ..ReadOptions::default() };
    let frame = read_frame(&file(&content).path, &options).expect("a frame");
    assert_eq!(frame.bonds.map(|bonds| (bonds.first, bonds.second)), Some((vec![1], vec![3])));
    let told = frame.warnings.iter().any(|warning| warning.contains("1 bond"));
    assert!(told, "{:?}", frame.warnings);
}

#[test]
fn ellipsoids_of_no_atom_are_left_out() {
    let data = DATA.replace("1 atom types", "1 atom types\n1 ellipsoids");
    let atoms = data.replace("Atoms # atomic", "Atoms # ellipsoid");
    let atoms =
        atoms.replace("1 1 0.5 1 1", "1 1 1 1.0 0.5 1 1").replace("2 1 3 1 1", "2 1 0 1.0 3 1 1");
    let (count, found) =
        warnings(&format!("{atoms}\nEllipsoids\n\n1 1 2 3 1 0 0 0\n7 1 2 3 1 0 0 0\n"));
    assert_eq!(count, 2);
    assert!(found.contains("1 ellipsoid is left out"), "{found}");
}

#[test]
fn comments_may_follow_numbers() {
    let poscar = POSCAR
        .replace("\n1\n", "\n1 ! scale\n")
        .replace("Na Cl\n1 1\n", "Na Cl ! species\n1 1 # counts\n")
        .replace("\n\n0 0 0\n0 0 0\n", "\n");
    assert_eq!(warnings(&poscar), (2, String::new()));
    let cfg =
        CFG.replace("35.45\n", "# the other\n35.45 # mass\n").replace("Cl\n", "Cl # symbol\n");
    assert_eq!(warnings(&cfg), (2, String::new()));
}
