//! CIF of crystals.

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
    // Every titanium has six neighbors at 1.95 to 1.98 angstrom, across the cell's faces too.
    let cell = frame.cell.expect("a cell");
    let bonds = (2..6).flat_map(|row| {
        let shares = cell.shares(frame.position(row) - frame.position(1));
        let nearest = cell.point((shares - shares.round()).to_array());
        [nearest.length()]
    });
    assert_eq!(bonds.filter(|length| (1.9..2.0).contains(length)).count(), 4);
    assert_eq!((frame.unit, &frame.title[..]), (LengthUnit::Angstrom, "Rutile"));
    assert_eq!((frame.numbers[0].values[1], frame.numbers[0].values.len()), (0.0055, 6));
    assert!(frame.numbers[0].values[5].is_nan());
    assert_eq!(frame.warnings, ["1 atoms without a place are left out"]);
}

#[test]
fn without_operations_atoms_stay_where_they_are() {
    let start = RUTILE.find("loop_\n_symmetry").expect("operations");
    let end = RUTILE.find("loop_\n_atom_site").expect("atoms");
    let listed = format!("{}{}", &RUTILE[..start], &RUTILE[end..]);
    let frame = frame(listed.replace("0 0 0 0.0055", "-1 0 2 0.0055"));
    assert_eq!((frame.len(), frame.position(0)), (2, DVec3::new(-4.594, 0.0, 2.0 * 2.9586)));
    assert!(frame.warnings.iter().any(|text| text.contains("P 42/m n m")), "{:?}", frame.warnings);
    let plain = super::frame(listed.replace("P 42/m n m", "P 1"));
    assert_eq!(plain.warnings.len(), 1);
}

#[test]
fn new_names_blocks_and_centering_are_read() {
    let cell = "_cell.length_a 4\n_cell.length_b 4\n_cell.length_c 4\n";
    let operations = "loop_\n_space_group_symop.id\n_space_group_symop.operation_xyz\n";
    let centered = "1 x,y,z\n2 x,y+1/2,z+1/2\n3 x+1/2,y,z+1/2\n4 x+1/2,y+1/2,z\n";
    let atoms = "loop_\n_atom_site.type_symbol\n_atom_site.fract_x\n_atom_site.fract_y\n\
                 _atom_site.fract_z\nCu2+ 0 0 0\n";
    // Atoms may come before what is needed to place them.
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
        (RUTILE.replace("7 y,x,-z", "7 y,x"), 21, "`y,x` is no operation of symmetry"),
        (RUTILE.replace("1 x,y,z\n", &many), 207, "more than 192 operations of symmetry"),
        (RUTILE.replace("4.594(3)", "4.5.94"), 7, "`4.5.94` is not a number"),
        (RUTILE.replace("Ti1 0 0 0", "Ti1 0 a 0"), 37, "`a` is not a number"),
        (RUTILE.replace("_atom_site_fract_z\n", ""), 36, "no _atom_site_fract_z in this loop"),
        (RUTILE.replace("2.9586(2)", "0"), 0, "there is no cell with edges [4.594, 4.594, 0.0]"),
        (RUTILE.replace("_cell_length_c ", "_some_thing "), 0, "there is no cell"),
    ] {
        let (found, _, said) = fault(text);
        assert!(found == line && said.starts_with(message), "{found}: {said}");
    }
    assert!(fault("data_a\n_cell_length_a 4\n").2.starts_with("holds no particles"));
}
