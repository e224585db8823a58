//! Tests of CIF of crystals.

use super::*;

/// Rutile (Baur and Khan, Acta Crystallographica B27, 1971), as databases write it.
const RUTILE: &str = "\
#------------------------------------------------------------------------------
data_rutile
_chemical_formula_sum            'O2 Ti'
_chemical_name_mineral           Rutile
_chemical_name_common            ?
_symmetry_space_group_name_H-M   'P 42/m n m'
_cell_length_a                   4.594(3)
_cell_length_b                   4.594(3)
_cell_length_c                   2.9586(2)
_cell_angle_alpha                90
_cell_angle_beta                 90
loop_
_symmetry_equiv_pos_site_id
_symmetry_equiv_pos_as_xyz
1 x,y,z
2 '-x, -y, z'
3 '1/2-y, 1/2+x, z+1/2'
4 '1/2+y, 1/2-x, z+1/2'
5 '1/2-x, 1/2+y, 1/2-z'
6 '1/2+x, 1/2-y, 1/2-z'
7 y,x,-z
8 -y,-x,-z
9 -x,-y,-z
10 x,y,-z
11 1/2+y,1/2-x,1/2-z
12 1/2-y,1/2+x,1/2-z
13 1/2+x,1/2-y,1/2+z
14 1/2-x,1/2+y,1/2+z
15 -y,-x,z
16 y,x,z
loop_
_atom_site_label
_atom_site_fract_x
_atom_site_fract_y
_atom_site_fract_z
_atom_site_U_iso_or_equiv
Ti1 0 0 0 0.0055(2)
O1a 0.3051(1) 0.3051(1) 0.00000 .
Du ? ? ? .
loop_
_geom_bond_atom_site_label_1
_geom_bond_distance
Ti1 1.95
";

#[test]
fn symmetry_makes_all_atoms_of_the_cell() {
    let frame = frame_with(RUTILE, &columns("U_iso_or_equiv")).expect("a frame");
    let titanium = ("Ti1", "Ti");
    let oxygen = ("O1a", "O");
    assert_eq!(kinds(&frame), [titanium, titanium, oxygen, oxygen, oxygen, oxygen]);
    let (a, c) = (4.594, 2.9586);
    let near = |row: usize, x: f64, y: f64, z: f64| {
        let away = frame.position(row) - DVec3::new(x * a, y * a, z * c);
        assert!(away.length() < 1e-12, "{row}: {away}");
    };
    near(0, 0.0, 0.0, 0.0);
    near(1, 0.5, 0.5, 0.5);
    near(2, 0.3051, 0.3051, 0.0);
    near(3, 0.6949, 0.6949, 0.0);
    near(4, 0.1949, 0.8051, 0.5);
    near(5, 0.8051, 0.1949, 0.5);
    // Every titanium has six neighbors at 1.95 to 1.98 angstrom, also across the cell's faces.
    let cell = frame.cell.expect("a cell");
    let bonds = (2..6).flat_map(|row| {
        let shares = cell.fractional(frame.position(row) - frame.position(1));
        let nearest = cell.cartesian((shares - shares.round()).to_array());
        [nearest.length()]
    });
    assert_eq!(bonds.filter(|length| (1.9..2.0).contains(length)).count(), 4);
    assert_eq!((frame.unit, &frame.title[..]), (LengthUnit::Angstrom, "Rutile"));
    assert_eq!((frame.numbers[0].values[1], frame.numbers[0].values.len()), (0.0055, 6));
    assert!(frame.numbers[0].values[5].is_nan());
    assert!(frame.warnings[0].starts_with("1 atoms without coordinates"), "{:?}", frame.warnings);
    assert_eq!(frame.warnings.len(), 1, "{:?}", frame.warnings);
}

#[test]
fn atoms_stay_where_they_are_without_symmetry() {
    let start = RUTILE.find("loop_\n_symmetry").expect("operations");
    let end = RUTILE.find("loop_\n_atom_site").expect("atoms");
    let listed = format!("{}{}", &RUTILE[..start], &RUTILE[end..]);
    let listed = listed.replace("0 0 0 0.0055", "-1 0 2 0.0055");
    let unknown = frame(listed.replace("P 42/m n m", "P 42/m n q"));
    assert_eq!((unknown.len(), unknown.position(0)), (2, DVec3::new(-4.594, 0.0, 2.0 * 2.9586)));
    assert!(unknown.warnings.iter().any(|text| text.contains("P 42/m n q")));
    // According to the symbol, atoms are those that the operations make.
    let (by_symbol, by_list) = (frame(&listed), frame(RUTILE));
    assert_eq!(by_symbol.len(), 6);
    for row in 0..6 {
        let near = |other: usize| (by_symbol.position(other) - by_list.position(row)).length();
        assert!((0..6).any(|other| near(other) < 1e-9), "{row}");
    }
    let plain = frame(listed.replace("P 42/m n m", "P 1"));
    assert_eq!((plain.len(), plain.warnings.len()), (2, 1), "{:?}", plain.warnings);
}

#[test]
fn new_names_blocks_and_centering_are_read() {
    let cell = "_cell.length_a 4\n_cell.length_b 4\n_cell.length_c 4\n";
    let operations = "loop_\n_space_group_symop.id\n_space_group_symop.operation_xyz\n";
    let centered = "1 x,y,z\n2 x,y+1/2,z+1/2\n3 x+1/2,y,z+1/2\n4 x+1/2,y+1/2,z\n";
    let atoms = "loop_\n_atom_site.type_symbol\n_atom_site.fract_x\n_atom_site.fract_y\n\
                 _atom_site.fract_z\nCu2+ 0 0 0\n";
    // Atoms may come before the data that is needed to place them.
    let first = format!("data_a\n{atoms}{operations}{centered}{cell}");
    let second = format!("data_b\n{cell}{atoms}");
    let all = frames(format!("{first}data_empty\n_nothing 1\n{second}"));
    assert_eq!(all, [vec![0.0, 0.0, 2.0, 2.0], vec![0.0]]);
    assert_eq!(kinds(&frame(&first))[0], ("Cu2+", "Cu"));
}

#[test]
fn faulty_crystals_are_refused() {
    let many = "1 x,y,z\n".repeat(200);
    for (text, line, message) in [
        (RUTILE.replace("7 y,x,-z", "7 y,x"), 21, "`y,x` is not a symmetry operation"),
        (RUTILE.replace("1 x,y,z\n", &many), 207, "more than 192 symmetry operations"),
        (RUTILE.replace("4.594(3)", "4.5.94"), 7, "`4.5.94` is not a number"),
        (RUTILE.replace("Ti1 0 0 0", "Ti1 0 a 0"), 37, "`a` is not a number"),
        (RUTILE.replace("_atom_site_fract_z\n", ""), 36, "no _atom_site_fract_z in this loop"),
        (RUTILE.replace("2.9586(2)", "0"), 0, "there is no cell with edges [4.594, 4.594, 0.0]"),
        (RUTILE.replace("_cell_length_c ", "_some_thing "), 0, "there is no cell"),
    ] {
        let (found, _, reported) = fault(text);
        assert!(found == line && reported.starts_with(message), "{found}: {reported}");
    }
    assert!(fault("data_a\n_cell_length_a 4\n").2.starts_with("holds no particles"));
}

/// A crystal of these sites, by default in a cubic cell of 8 angstrom.
fn crystal(symmetry: &str, columns: &str, sites: &str) -> String {
    let cell = "_cell_length_a 8\n_cell_length_b 8\n_cell_length_c 8\n";
    let columns = columns.split(' ').map(|column| format!("_atom_site_{column}\n"));
    let columns: String = columns.collect();
    format!("data_a\n{cell}{symmetry}\nloop_\n{columns}{sites}")
}

const SITES: &str = "label fract_x fract_y fract_z";
const OCCUPIED: &str = "label fract_x fract_y fract_z occupancy";

#[test]
fn symmetry_comes_from_the_strongest_declaration() {
    let operations = "_symmetry_equiv_pos_as_xyz x,y,z";
    let hall = "_symmetry_space_group_name_Hall '-P 1'";
    let symbol = "_symmetry_space_group_name_H-M 'P m -3 m'";
    let number = "_symmetry_Int_Tables_number 16";
    let site = "Po 0.1 0.2 0.3\n";
    let count = |declared: &[&str]| frame(crystal(&declared.join("\n"), SITES, site));
    for (declared, atoms, warnings) in [
        (&[number][..], 4, 0),
        (&[number, symbol], 48, 1),
        (&[number, symbol, hall], 2, 2),
        (&[number, symbol, hall, operations], 1, 3),
        (&[], 1, 1),
        (&["_symmetry_space_group_name_H-M 'P 7 q'"], 1, 1),
        (&["_symmetry_space_group_name_H-M 'P 7 q'", number], 4, 1),
        (&["_symmetry_Int_Tables_number 231"], 1, 1),
        (&["_symmetry_space_group_name_H-M ?", "_symmetry_Int_Tables_number 1"], 1, 0),
        (&["_symmetry_equiv_pos_as_xyz ?", symbol], 48, 0),
        (&["_symmetry_space_group_name_Hall 'P 9'", symbol], 48, 1),
        // A cubic cell has no hexagonal symmetry.
        (&["_symmetry_space_group_name_H-M 'P 6'"], 6, 1),
    ] {
        let frame = count(declared);
        assert_eq!(frame.len(), atoms, "{declared:?}");
        assert_eq!(frame.warnings.len(), warnings, "{declared:?}: {:?}", frame.warnings);
    }
    let conflict = count(&[number, symbol, hall, operations]).warnings.concat();
    for source in ["P m -3 m", "-P 1", "16"] {
        assert!(conflict.contains(source), "{source}: {conflict}");
    }
    let misfit = count(&["_symmetry_space_group_name_H-M 'P 6'"]).warnings.concat();
    assert!(misfit.contains("P 6"), "{misfit}");
    let unknown = count(&["_symmetry_space_group_name_H-M 'P 7 q'"]);
    assert!(unknown.warnings[0].contains("`P 7 q`"), "{:?}", unknown.warnings);
}

#[test]
fn screw_axes_have_the_right_handedness() {
    // The second atom of a right-handed four-fold screw lies a quarter of the cell higher, rotated by a
    // quarter; with the opposite handedness, it would be at -1/4.
    for symmetry in [
        "_symmetry_space_group_name_H-M 'P 41'",
        "loop_\n_symmetry_equiv_pos_as_xyz\nx,y,z\n-y,x,z+1/4\n-x,-y,z+1/2\ny,-x,z+3/4",
    ] {
        let frame = frame(crystal(symmetry, SITES, "Se 0.25 0.125 0\n"));
        let mut places: Vec<[f64; 3]> = (0..4).map(|row| frame.position(row).to_array()).collect();
        places.sort_by(|one, other| one[2].total_cmp(&other[2]));
        assert_eq!(places, [[2.0, 1.0, 0.0], [7.0, 2.0, 2.0], [6.0, 7.0, 4.0], [1.0, 6.0, 6.0]]);
    }
}

#[test]
fn shared_sites_are_drawn_once_by_the_greatest_occupancy() {
    let body = "_symmetry_space_group_name_H-M 'I m m m'";
    let shared = |sites: &str| frame_with(crystal(body, OCCUPIED, sites), &columns("occupancy"));
    for (sites, label, count, warnings) in [
        ("Fe 0 0 0 0.11\nCo 0 0 0 0.87(2)\nNi 0 0 0 0.02\n", "Co", 2, 1),
        // An image, a split site, equal occupancies, and unknown ones.
        ("Fe 0 0 0 0.4\nNi 0.5 0.5 0.5 0.6\n", "Ni", 2, 1),
        ("Fe 0 0 0 0.3\nNi 0.03 0 0 0.35\n", "Ni", 2, 1),
        ("Fe 0 0 0 0.5\nNi 0 0 0 0.5\n", "Fe", 2, 1),
        ("Fe 0 0 0 ?\nNi 0 0 0 0.1\n", "Ni", 2, 1),
        ("Fe 0 0 0 0.3\nNi 0 0 0 .\n", "Ni", 2, 1),
        // Too far from each other for one site.
        ("Fe 0 0 0 0.5\nNi 0 0 0.25 0.5\n", "Fe", 6, 0),
        ("Fe 0 0 0 1\nNi 0 0 0.05 1\n", "Fe", 6, 0),
    ] {
        let frame = shared(sites).expect("a crystal");
        let names: Vec<&str> = kinds(&frame).iter().map(|(name, _)| *name).collect();
        assert_eq!((frame.len(), names.contains(&label)), (count, true), "{sites}");
        assert_eq!(frame.warnings.len(), warnings, "{sites}: {:?}", frame.warnings);
        assert_eq!(frame.numbers[0].values.len(), count, "{sites}");
        if count == 2 {
            assert_eq!(names, [label; 2], "{sites}");
            assert!(frame.warnings[0].starts_with("2 sites"), "{:?}", frame.warnings);
        }
    }
    let cobalt = shared("Fe 0 0 0 0.11\nCo 0 0 0 0.87(2)\n").expect("a crystal");
    assert_eq!(cobalt.numbers[0].values, [0.87; 2]);
}

#[test]
fn disorder_is_drawn_by_its_main_groups() {
    let columns = "label fract_x fract_y fract_z occupancy disorder_assembly disorder_group";
    let labels = |sites: &str| -> Vec<String> {
        let frame = frame(crystal("_space_group_IT_number 1", columns, sites));
        kinds(&frame).iter().map(|(name, _)| (*name).to_owned()).collect()
    };
    let base = "C 0 0 0 1 . .\n";
    let pair = "N .2 0 0 0.3 A 1\nO .3 0 0 0.7 A 2\n";
    assert_eq!(labels(&format!("{base}{pair}")), ["C", "O"]);
    // Another disorder of the same groups, with occupancies of its own.
    let second = "F .6 0 0 0.6 A 1\nCl .7 0 0 0.4 A 2\n";
    assert_eq!(labels(&format!("{base}{pair}{second}")), ["C", "O", "F"]);
    let equal = "N .2 0 0 0.5 . 1\nO .3 0 0 0.5 . 2\n";
    assert_eq!(labels(&format!("{base}{equal}")), ["C", "N"]);
    // The mean decides, not the number of atoms.
    let pairs = "N .2 0 0 0.4 A 1\nN .3 0 0 0.4 A 1\nO .4 0 0 0.6 A 2\nO .5 0 0 0.6 A 2\n";
    assert_eq!(labels(&format!("{base}{pairs}")), ["C", "O", "O"]);
    let many = "N .2 0 0 0.5 A 1\nO .3 0 0 0.3 A 2\nO .4 0 0 0.3 A 2\nF .5 0 0 0.2 A 3\n";
    assert_eq!(labels(&format!("{base}{many}")), ["C", "N"]);
    let many = "N .2 0 0 0.5 A 1\nN .6 0 0 0.5 A 1\nO .3 0 0 0.3 A 2\nO .4 0 0 0.3 A 2\n\
                O .7 0 0 0.3 A 2\nF .5 0 0 0.2 A 3\n";
    assert_eq!(labels(&format!("{base}{many}")), ["C", "N", "N"]);
    let three = "N .2 0 0 0.2 A 1\nO .3 0 0 0.5 A 2\nF .4 0 0 0.3 A 3\n";
    assert_eq!(labels(&format!("{base}{three}")), ["C", "O"]);
}

#[test]
fn magnetic_operations_and_their_centerings_are_read() {
    let symmetry = "loop_\n_space_group_symop_magn_operation.id\n\
                    _space_group_symop_magn_operation.xyz\n1 x,y,z,+1\n2 -x,-y,-z,-1\n\
                    loop_\n_space_group_symop_magn_centering.id\n\
                    _space_group_symop_magn_centering.xyz\n1 x,y,z,+1\n2 x+1/2,y+1/2,z,-1";
    assert_eq!(frame(crystal(symmetry, SITES, "Mn 0.1 0.2 0.3\n")).len(), 4);
}

#[test]
fn displacements_are_counted_and_bonds_are_not_read() {
    let bonds = "loop_\n_geom_bond_atom_site_label_1\n_geom_bond_distance\nC 1\nC 2\n";
    let displacements = "loop_\n_atom_site_aniso_label\n_atom_site_aniso_U_11\nC 0.1\n";
    let text = crystal("_space_group_IT_number 1", SITES, "C 0 0 0\n");
    let frame = frame(format!("{text}{bonds}{displacements}"));
    assert_eq!(frame.warnings.len(), 1, "{:?}", frame.warnings);
    assert!(frame.warnings[0].starts_with("1 displacement"), "{:?}", frame.warnings);
}

#[test]
fn shared_sites_are_found_everywhere_in_the_cell() {
    let site = |index: u32| {
        let (x, y, away) = (index % 13, f64::from(index / 13) / 13.0, 0.002);
        let x = f64::from(x) / 13.0;
        let greater = format!("Fe {} {y} .5 0.6\n", x - away);
        let lesser = format!("Co {} {y} .5 0.4\n", x + away);
        if index.is_multiple_of(2) { greater + &lesser } else { lesser + &greater }
    };
    let sites = (0..169).map(site).collect::<Vec<_>>().concat();
    let frame = frame(crystal("_space_group_IT_number 1", OCCUPIED, &sites));
    assert_eq!(frame.len(), 169, "{:?}", frame.warnings);
    assert!(kinds(&frame).iter().all(|(name, _)| *name == "Fe"));
}
