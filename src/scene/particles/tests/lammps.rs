//! Dumps and data files of LAMMPS.

use super::*;

fn dump(bounds: &str, columns: &str, rows: &str) -> String {
    let count = rows.lines().count();
    format!(
        "ITEM: UNITS\nmetal\nITEM: TIME\n0.25\nITEM: TIMESTEP\n500\nITEM: NUMBER OF ATOMS\n{count}\n\
         ITEM: BOX BOUNDS{bounds}\nITEM: ATOMS {columns}\n{rows}"
    )
}

const BOX: &str = " pp ff pp\n1 3\n2 6\n3 11";

#[test]
fn positions_are_found_in_all_their_forms() {
    for (names, row) in [
        ("x y z", "2 4 7"),
        ("xs ys zs", "0.5 0.5 0.5"),
        ("xu yu zu", "2 4 7"),
        ("xsu ysu zsu", "0.5 0.5 0.5"),
        ("xu yu zu x y z xs ys zs", "9 9 9 2 4 7 1 1 1"),
    ] {
        let text = dump(BOX, &format!("id type {names} q"), &format!("7 2 {row} -0.5\n"));
        let frame = frame_with(&text, &columns("q,id")).expect("a frame");
        assert_eq!(frame.position(0), DVec3::new(2.0, 4.0, 7.0), "{names}");
        assert_eq!(frame.numbers[0].values, [-0.5]);
        assert_eq!((frame.step, frame.time), (Some(500), Some(0.25)));
        assert_eq!((frame.unit, kinds(&frame)[0]), (LengthUnit::Angstrom, ("2", "-")));
        let cell = frame.cell.expect("a cell");
        assert_eq!((cell.origin, cell.periodic), (DVec3::new(1.0, 2.0, 3.0), [true, false, true]));
    }
    let unwrapped = dump(BOX, "x y z xu yu zu", "1 1 1 2 2 2\n");
    let chosen = frame_with(&unwrapped, &columns("x=xu,y=yu,z=zu")).expect("a frame");
    assert_eq!(chosen.x, [2.0]);
    let shares = dump(BOX, "x y z xs ys zs", "9 9 9 0.5 0.5 0.5\n");
    let chosen = frame_with(&shares, &columns("x=xs,y=ys,z=zs")).expect("a frame");
    assert_eq!(chosen.x, [2.0]);
}

#[test]
fn tilted_boxes_are_those_of_the_bounds() {
    // The box of edges 2, 3 and 4 at the origin, tilted by 1, -0.5 and 0.25.
    let bounds = " xy xz yz pp pp pp\n-0.5 3 1\n0 3.25 -0.5\n0 4 0.25";
    let corner = frame(dump(bounds, "id type xs ys zs", "1 1 1 1 1\n"));
    assert_eq!(corner.position(0), DVec3::new(2.5, 3.25, 4.0));
    assert_eq!(corner.cell.map(|cell| cell.vectors[2]), Some(DVec3::new(-0.5, 0.25, 4.0)));
    let general = " abc origin pp pp pp\n2 0 0 -1\n0 3 1 0\n1 0 4 5";
    let corner = frame(dump(general, "id type xs ys zs", "1 1 1 1 1\n"));
    assert_eq!(corner.position(0), DVec3::new(2.0, 3.0, 10.0));
}

#[test]
fn elements_and_radii_have_columns() {
    let text = dump(BOX, "id element x y z radius", "1 C 1 2 3 .5\n2 O 2 3 4 .25\n");
    let frame = frame(&text);
    assert_eq!((kinds(&frame)[1], &frame.radius[..]), (("O", "O"), &[0.5, 0.25][..]));
}

#[test]
fn frames_of_dumps_follow_each_other() {
    let frame = |x: f64| dump(BOX, "x y z", &format!("{x} 0 0\n{x} 1 1\n"));
    let text = [frame(1.0), frame(2.0), frame(3.0)].concat();
    assert_eq!(frames(&text), [vec![1.0; 2], vec![2.0; 2], vec![3.0; 2]]);
    assert_eq!(frame_with(&text, &at_frame("last")).expect("a frame").x, [3.0; 2]);
    let cut = &text[..text.len() - 7];
    assert_eq!(frame_with(cut, &at_frame("last")).expect("a frame").x, [2.0; 2]);
}

#[test]
fn faulty_dumps_are_refused() {
    let many = dump(BOX, "x y z", "1 2 3\n").replace("ATOMS\n1", "ATOMS\n18446744073709551615");
    let number = "the file ends after 1 of 18446744073709551615 atoms";
    for (text, line, message) in [
        (many.as_str(), 15, number),
        (&dump(BOX, "id type", "1 1\n"), 13, "no column is named `x`; there are id, type"),
        (&dump(BOX, "x y z", "1 2\n"), 14, "2 columns, but a row has x, y, z"),
        (&dump(BOX, "x y z", "1 2 z3\n"), 14, "`z3` is not a number"),
        (&dump(" pp\n1 2\n3 4", "x y z", ""), 12, "`ITEM:` is not a number"),
        ("ITEM: TIMESTEP\n0\n", 3, "the file ends within the section ITEM: ATOMS"),
        ("ITEM: TIMESTEP\n0\nrows\n", 3, "not the beginning of a section"),
        (
            "ITEM: NUMBER OF ATOMS\n1\nITEM: ATOMS xs ys zs\n0 0 0\n",
            4,
            "positions in shares of a box that has no volume",
        ),
    ] {
        let (found, _, said) = fault(text);
        assert_eq!((found, said.as_str()), (line, message), "{text}");
    }
}

#[test]
fn data_files_have_sections_in_any_order() {
    let text = "a title, units = real, of nothing\n\n# comment\n2 atoms\n 2 atom types # two\n1 bonds\n\
                -1 1 xlo xhi\n0 3 ylo yhi\n0 4 zlo zhi\n0.5 0 0 xy xz yz\n\nAtoms  # full\n\n\
                1 1 1 -0.8 0.5 1 2 0 0 -1 # O\n2 1 2 0.4 1.5 2 3\n\nBonds\n\n1 1 1 2\n\n\
                Masses\n\n1 15.9994 # O\n2 1.008\n";
    let frame = frame_with(text, &columns("q,mol")).expect("a frame");
    assert_eq!(kinds(&frame), [("1", "O"), ("2", "H")]);
    assert_eq!((frame.x[1], frame.numbers[0].values[0]), (1.5, -0.8));
    assert_eq!(frame.unit, LengthUnit::Angstrom);
    let cell = frame.cell.expect("a cell");
    assert_eq!((cell.origin, cell.vectors[1]), (DVec3::NEG_X, DVec3::new(0.5, 3.0, 0.0)));
}

#[test]
fn atom_styles_are_named_guessed_or_asked_for() {
    let text = |style: &str, row: &str| {
        format!("LAMMPS\n\n1 atoms\n1 atom types\n\nAtoms{style}\n\n{row}\n")
    };
    let sphere = frame(text(" # sphere", "16 1 27.5 1 21.5 19.25 0.5 0 0 0"));
    assert_eq!((sphere.radius[0], sphere.x[0]), (13.75, 21.5));
    let guessed = frame(text("", "1 1 27.5 1 21.5 19.25 0.5"));
    assert_eq!(guessed.radius, [13.75]);
    assert!(guessed.warnings[0].contains("look like `sphere`"), "{:?}", guessed.warnings);
    let unclear = fault(text("", "1 1 1 1.0 0.5 1.5 2.5"));
    assert_eq!(unclear.2, "names no atom style, and its columns may be of full or sphere");
    let options = ReadOptions { atom_style: Some("full".to_owned()), ..ReadOptions::default() };
    let asked = frame_with(text("", "1 1 1 1.0 0.5 1.5 2.5"), &options).expect("a frame");
    assert!(asked.radius.is_empty());
    assert_eq!(
        fault(text(" # unheard/of", "1 1 0 0 0")).2,
        "the atom style `unheard/of` is not known"
    );
}

#[test]
fn faulty_data_files_are_refused() {
    for (text, message) in [
        ("t\n2 atoms\n\nAtoms # atomic\n\n1 1 0 0 0\n", "the file ends after 1 of 2 atoms"),
        (
            "t\n2 atoms\n\nAtoms # atomic\n\n1 1 0 0 0\n\nBonds\n",
            "the section ends after 1 of 2 atoms",
        ),
        ("t\n2 atoms\n", "no section `Atoms`"),
        ("t\n1 atoms\n\nAtoms # atomic\n\n1 1 0 0 z\n", "`z` is not a number"),
        ("t\n1 atoms\n\nMasses\n\n1 heavy\n", "`heavy` is not a number"),
    ] {
        assert_eq!(fault(text).2, message, "{text}");
    }
    // Masses that are not those of elements say nothing of them.
    for masses in ["1 1.0", "1 72.0", "1 1.0\n2 2.0"] {
        let text = format!("t\n1 atoms\n\nMasses\n\n{masses}\n\nAtoms # atomic\n\n1 1 0 0 0\n");
        assert_eq!(kinds(&frame(&text)), [("1", "-")], "{masses}");
    }
}

const MOVING: &str = "\
a title

3 atoms
1 atom types

Atoms # atomic

7 1 1.0 2.0 3.0
3 1 4.0 5.0 6.0
5 1 7.0 8.0 9.0

Velocities

5 0.5 -1 2e1
7 1.5 -2 3e1

Bonds

1 1 3 5
";

#[test]
fn velocities_are_told_by_ids() {
    let frame = frame_with(MOVING, &columns("vz,VX")).expect("a frame");
    let column = |at: usize| (&frame.numbers[at].name[..], &frame.numbers[at].values[..]);
    let (name, vz) = column(0);
    assert!(name == "vz" && (vz[0], vz[2]) == (30.0, 20.0) && vz[1].is_nan(), "{vz:?}");
    assert_eq!((column(1).0, column(1).1[2], frame.numbers.len()), ("VX", 0.5, 2));
    assert_eq!(frame.columns, ["id", "type", "x", "y", "z", "vx", "vy", "vz"]);
    let ids = frame_with(MOVING, &columns("id,vy")).expect("a frame").numbers;
    assert_eq!((&ids[0].values[..], ids[1].values[0]), (&[7.0, 3.0, 5.0][..], -2.0));
    // Nobody asks, so nobody looks.
    assert!(super::frame(MOVING.replace("5 0.5", "5 what")).numbers.is_empty());
}

#[test]
fn velocities_that_are_missing_or_broken_are_told() {
    let asked = columns("vx");
    let message = |text: &str| match frame_with(text, &asked) {
        Err(error) => (error.line().unwrap_or(0), error.message),
        Ok(frame) => panic!("this is accepted: {frame:?}"),
    };
    let none = MOVING.replace("Velocities", "Forces");
    assert!(message(&none).1.starts_with("no column is named `vx`; there are id, type, x"));
    let broken = message(&MOVING.replace("7 1.5", "7 1,5"));
    assert_eq!(broken, (15, "`1,5` is not a number".to_owned()));
    let short = message(&MOVING.replace(" 2e1", ""));
    assert_eq!(short, (14, "a row of velocities has an id and vx, vy, vz".to_owned()));
}
