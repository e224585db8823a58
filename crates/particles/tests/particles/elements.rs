//! Tests of elements by the evidence that files have: names, types and masses.

use crate::common::file;
use spherule_particles::{Columns, Element, ParticleFrame, ReadOptions, read_frame};

fn frame(content: &str) -> ParticleFrame {
    read_frame(&file(content).path, &ReadOptions::default()).expect("a frame")
}

/// Returns the symbols of the elements of all particles, `-` for none.
fn symbols(frame: &ParticleFrame) -> String {
    let symbol = |row| frame.kinds.kind(row)?.element.map(Element::symbol);
    (0..frame.len()).map(|row| symbol(row).unwrap_or("-")).collect::<Vec<_>>().join(" ")
}

fn warnings<'f>(frame: &'f ParticleFrame, part: &str) -> Vec<&'f str> {
    let warnings = frame.warnings.iter().map(String::as_str);
    warnings.filter(|warning| warning.contains(part)).collect()
}

#[test]
fn types_of_force_fields_are_no_elements() {
    let mol2 = |atoms: &[[&str; 2]]| {
        let row = |(number, [name, kind]): (usize, &[&str; 2])| {
            format!("{number} {name} {number}.0 0 0 {kind} 1 MOL 0.0\n")
        };
        let rows: String = atoms.iter().enumerate().map(row).collect();
        symbols(&frame(&format!("@<TRIPOS>MOLECULE\nM\n{}\n@<TRIPOS>ATOM\n{rows}", atoms.len())))
    };
    let gaff = [
        ["C1", "ca"],
        ["C2", "cd"],
        ["N1", "no"],
        ["N2", "nd"],
        ["O1", "os"],
        ["H1", "ho"],
        ["Cl1", "cl"],
        ["H2", "hc"],
    ];
    assert_eq!(mol2(&gaff), "C C N N O H Cl H");
    let amber =
        [["C1", "CA"], ["N3", "NA"], ["H4", "HO"], ["O5", "OS"], ["CL6", "CL"], ["X7", "BR"]];
    assert_eq!(mol2(&amber), "C N H O Cl Br");
    let sybyl =
        [["CA", "C.3"], ["CA", "Ca"], ["X", "N.ar"], ["C9", "Co.oh"], ["D1", "Du"], ["H", "H"]];
    assert_eq!(mol2(&sybyl), "C Ca N Co - H");
}

#[test]
fn types_of_autodock_are_in_their_columns() {
    let atom = |name: &str, charge: &str, kind: &str| {
        format!(
            "ATOM      1 {name:4} LIG A   1       0.000   0.000   0.000  1.00  0.00    {charge} {kind}\n"
        )
    };
    let text = [
        atom(" C1 ", " 0.100", "A "),
        atom(" O1 ", "-0.300", "OA"),
        atom("CL1 ", "-0.100", "Cl"),
        atom(" X1 ", "+0.100", "Br"),
        atom("FE  ", " 1.000", "Fe"),
        atom(" N1 ", "-0.200", "NA"),
        atom(" H1 ", " 0.200", "HD"),
    ];
    let text = format!("REMARK  made up\nROOT\n{}ENDROOT\n", text.concat());
    assert_eq!(symbols(&frame(&text)), "C O Cl Br Fe N H");
    let columns = Columns { kept: vec!["charge".into(), "atom_type".into()], ..Columns::default() };
    let options = ReadOptions { columns, ..ReadOptions::default() };
    let own = read_frame(&file(&text).path, &options).expect("a frame");
    assert_eq!(own.numbers[0].values, [0.1, -0.3, -0.1, 0.1, 1.0, -0.2, 0.2]);
    assert_eq!(own.texts[0].names, ["A", "OA", "Cl", "Br", "Fe", "NA", "HD"]);
    // No segment, of which there is none where the charge is.
    assert!(own.columns.iter().all(|name| name != "segment" && name != "element"));
    // In PDB, a segment and an element are there.
    let pdb = "ATOM      1  C1  LIG A   1       0.000   0.000   0.000  1.00  0.00      A1.0 O\n";
    assert_eq!(symbols(&frame(pdb)), "O");
}

#[test]
fn residues_of_one_ion_are_named_for_it() {
    let names = ["POT", "CES", "SOD", "CLA", "CAL", "LIT", "RUB", "BAR"];
    let atom =
        |name: &&str| format!("ATOM      1 {name}  {name} I   1       0.000   0.000   0.000\n");
    let text: String = names.iter().map(atom).collect();
    assert_eq!(symbols(&frame(&text)), "K Cs Na Cl Ca Li Rb Ba");
}

#[test]
fn names_count_where_masses_are_repartitioned() {
    let psf = "PSF\n\n 1 !NTITLE\n REMARKS x\n\n 7 !NATOM\n\
        1 A 1 GLY N NH1 0.0 11.9910 0\n2 A 1 GLY HN H 0.0 3.0240 0\n3 A 1 GLY CA CT1 0.0 9.9950 0\n\
        4 A 1 GLY C C 0.0 12.0110 0\n5 A 1 GLY O O 0.0 15.9990 0\n6 A 2 LIG NA X 0.0 22.9900 0\n\
        7 A 2 LIG Q X 0.0 32.0600 0\n";
    let topology = file(psf);
    let positions = file("7\n\nX 0 0 0\nX 1 0 0\nX 2 0 0\nX 3 0 0\nX 4 0 0\nX 5 0 0\nX 6 0 0\n");
    let options = ReadOptions { topology: Some(topology.path.clone()), ..ReadOptions::default() };
    let named = read_frame(&positions.path, &options).expect("a frame");
    assert_eq!(symbols(&named), "N H C C O Na S");
    let found = warnings(&named, "3 atoms have");
    assert_eq!(found.len(), 1, "{:?}", named.warnings);
    for name in ["`N` of mass 11.991", "`HN` of mass 3.024", "`CA` of mass 9.995"] {
        assert!(found[0].contains(name), "{found:?}");
    }
}

fn data(masses: &str, style: &str, types: &[u8]) -> ParticleFrame {
    let atom = |(number, kind): (usize, &u8)| match style {
        "charge" => format!("{} {kind} 0.5 {number} 1 1\n", number + 1),
        _ => format!("{} {kind} {number} 1 1\n", number + 1),
    };
    let rows: String = types.iter().enumerate().map(atom).collect();
    let count = types.len();
    frame(&format!(
        "t\n\n{count} atoms\n3 atom types\n0 9 xlo xhi\n0 9 ylo yhi\n0 9 zlo zhi\n\nMasses\n\n{masses}\n\
         Atoms # {style}\n\n{rows}"
    ))
}

#[test]
fn names_in_comments_and_masses_are_weighed() {
    let named = data("1 9.995 # C\n2 3.024 # HA atoms\n3 15.999\n", "atomic", &[1, 2, 2, 3]);
    assert_eq!(symbols(&named), "C H H O");
    assert_eq!(warnings(&named, "3 atoms have the mass").len(), 1, "{:?}", named.warnings);
    // One mass that is no element's leaves others their elements; most do not.
    let masses = "1 12.011\n2 15.999\n3 0.0001\n";
    assert_eq!(symbols(&data(masses, "atomic", &[1, 2, 3])), "C O -");
    assert_eq!(symbols(&data(masses, "atomic", &[1, 3, 3])), "- - -");
    // Names of beads and of other elements do not say what atoms they are.
    assert_eq!(
        symbols(&data("1 12.011 # Ca\n2 72.0 # C1\n3 1.008 # x\n", "atomic", &[1, 2, 3])),
        "C - H"
    );
}

#[test]
fn small_whole_masses_are_no_elements() {
    let whole = "1 1.0\n2 4.0\n3 12.0\n";
    let grains = data(whole, "atomic", &[1, 2, 3]);
    assert_eq!(symbols(&grains), "- - -");
    assert_eq!(warnings(&grains, "whole numbers").len(), 1, "{:?}", grains.warnings);
    assert_eq!(symbols(&data(whole, "charge", &[1, 2, 3])), "H He C");
    assert_eq!(symbols(&data("1 1.0\n2 16.0\n3 12.011\n", "atomic", &[1, 2, 3])), "H O C");
    let commented = "1 1 # H\n2 16 # OW\n3 12 # C\n";
    assert_eq!(symbols(&data(commented, "atomic", &[1, 2, 3])), "H O C");
    let ones = data("1 1\n2 1\n3 1\n", "atomic", &[1, 2, 3]);
    assert_eq!((symbols(&ones), warnings(&ones, "whole").len()), ("- - -".to_owned(), 0));
}

const CRYSTAL: &str = "data_a\n_cell_length_a 5\n_cell_length_b 6\n_cell_length_c 7\nloop_\n_atom_site_label\n\
    _atom_site_type_symbol\n_atom_site_fract_x\n_atom_site_fract_y\n_atom_site_fract_z\n_atom_site_occupancy\n\
    _atom_site_calc_flag\n";

#[test]
fn dummies_and_vacant_sites_are_no_atoms() {
    let rows = "C1 C 0.5 0.5 0.5 1 d\nCg1 C 0.1 0.1 0.1 1 dum\nO1 O 0.5 0.2 0.5 0 d\n\
                O2 OH2 0.1 0.9 0.1 ? d\nO3 O2-(H2O) 0.9 0.1 0.9 . calc\n";
    let crystal = frame(&format!("{CRYSTAL}{rows}"));
    assert_eq!(symbols(&crystal), "C O O");
    for expected in ["1 dummy", "1 site of occupancy 0"] {
        assert_eq!(warnings(&crystal, expected).len(), 1, "{:?}", crystal.warnings);
    }
    // An unknown column of occupancies, perhaps.
    assert_eq!(symbols(&frame(&format!("{CRYSTAL}C1 C 0.5 0.5 0.5 0 d\n"))), "C");
}

#[test]
fn small_letters_of_type_labels_are_no_symbols() {
    let dump = |labels: [&str; 3]| {
        let rows = [1, 2, 3].map(|row| format!("{row} {} {row} 1 1\n", labels[row - 1])).concat();
        symbols(&frame(&format!(
            "ITEM: TIMESTEP\n0\nITEM: NUMBER OF ATOMS\n3\nITEM: BOX BOUNDS pp pp pp\n0 9\n0 9\n0 9\n\
             ITEM: ATOMS id typelabel x y z\n{rows}"
        )))
    };
    assert_eq!(dump(["ca", "os", "ho"]), "- - -");
    assert_eq!(dump(["Ca", "O", "H"]), "Ca O H");
}

#[test]
fn names_of_atoms_of_proteins_in_xyz_are_no_symbols() {
    let xyz = |names: &str| {
        let names: Vec<&str> = names.split(' ').collect();
        let atom = |(row, name)| format!("{name} {row} 0 0\n");
        let rows: String = names.iter().enumerate().map(atom).collect();
        symbols(&frame(&format!("{}\n\n{rows}", names.len())))
    };
    assert_eq!(xyz("N CA C O CB HA CD NE"), "N C C O C H C N");
    assert_eq!(xyz("CA O C"), "Ca O C");
    // Labels with notes, and ghosts without a nucleus.
    assert_eq!(xyz("Fe_1 H(Iso=2) O Bq"), "Fe H O -");
}

/// Names of what the elements of all types are known from.
fn sources(frame: &ParticleFrame) -> String {
    let names = frame.kinds.table.iter().map(|kind| match kind.element {
        Some(_) => kind.source.name(),
        None => "-",
    });
    names.collect::<Vec<_>>().join(", ")
}

#[test]
fn elements_tell_what_they_are_known_from() {
    let atom = |name: &str, symbol: &str| {
        format!(
            "ATOM      1 {name} ALA A   1       0.000   0.000   0.000  1.00  0.00          {symbol}\n"
        )
    };
    let pdb = frame(&[atom(" N  ", " N"), atom(" CB ", "")].concat());
    assert_eq!(sources(&pdb), "symbol, name");
    assert_eq!(sources(&frame("2\n\n8 0 0 0\nH 1 0 0\n")), "atomic number, symbol");
    let masses = "1 9.995 # C\n2 3.024 # HA atoms\n3 15.999\n";
    assert_eq!(sources(&data(masses, "atomic", &[1, 2, 3])), "name, name, mass");
    let mol2 = "@<TRIPOS>MOLECULE\nM\n2\n@<TRIPOS>ATOM\n1 C1 0 0 0 C.3\n2 N1 1 0 0 no\n";
    assert_eq!(sources(&frame(mol2)), "type, name");
    let given = ReadOptions {
        elements: vec![("1".to_owned(), Element::from_symbol("Si").expect("silicon"))],
        ..ReadOptions::default()
    };
    let text = "ITEM: TIMESTEP\n0\nITEM: NUMBER OF ATOMS\n1\nITEM: BOX BOUNDS pp pp pp\n0 9\n0 9\n0 9\n\
        ITEM: ATOMS id type x y z\n1 1 0.5 1 0\n";
    let frame = read_frame(&file(text).path, &given).expect("a frame");
    assert_eq!((sources(&frame), symbols(&frame)), ("given".to_owned(), "Si".to_owned()));
}
