//! Tests of dumps and data files of LAMMPS.

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
            "fractional positions, but the box has no volume",
        ),
    ] {
        let (found, _, reported) = fault(text);
        assert_eq!((found, reported.as_str()), (line, message), "{text}");
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

/// Returns a data file of these rows; `more` are lines of the header.
fn data(more: &str, style: &str, rows: &[&str]) -> String {
    let (count, rows) = (rows.len(), rows.join("\n"));
    format!(
        "LAMMPS\n\n{count} atoms\n{more}\n0 10 xlo xhi\n0 10 ylo yhi\n0 10 zlo zhi\n\nAtoms{style}\n\n{rows}\n"
    )
}

#[test]
fn atom_styles_are_named_guessed_or_asked_for() {
    let text = |style: &str, row: &str| data("1 atom types", style, &[row]);
    let sphere = frame(text(" # sphere", "16 1 27.5 1 1.5 9.25 0.5 0 0 0"));
    assert_eq!((sphere.radius[0], sphere.x[0], sphere.warnings.len()), (13.75, 1.5, 0));
    let guessed = frame(text("", "1 1 27.5 1 1.5 9.25 0.5"));
    assert_eq!(guessed.radius, [13.75]);
    assert!(guessed.warnings[0].contains("read as `sphere`"), "{:?}", guessed.warnings);
    let unclear = frame(text("", "1 1 1 1.0 0.5 1.5 2.5"));
    assert!(unclear.radius.is_empty());
    let [warning] = &unclear.warnings[..] else { panic!("{:?}", unclear.warnings) };
    assert!(
        ["`full`", "sphere", "--atom-style"].iter().all(|word| warning.contains(word)),
        "{warning}"
    );
    let asked = |style: &str, row: &str| {
        let options = ReadOptions { atom_style: Some(style.to_owned()), ..ReadOptions::default() };
        frame_with(text("", row), &options)
    };
    let sphere = asked("sphere", "1 1 1 1.0 0.5 1.5 2.5").expect("a frame");
    assert_eq!((sphere.radius, sphere.warnings), (vec![0.5], vec![]));
    let hybrid = asked("hybrid charge sphere", "1 1 0.5 1.5 2.5 -0.25 8 1").expect("a frame");
    assert_eq!((hybrid.x[0], hybrid.radius[0], hybrid.warnings.len()), (0.5, 4.0, 0));
    let wrong = asked("full", "1 1 3 1.0 0.5 1.5 2.5").expect("a frame");
    assert!(wrong.warnings[0].contains("a type would be 3"), "{:?}", wrong.warnings);
    let unknown = asked("unheard/of", "1 1 0 0 0").expect_err("no such style");
    assert_eq!(unknown.message, "the atom style `unheard/of` is not known");
    let help = unknown.help.expect("all styles");
    assert!(
        ["atomic", "wavepacket", "hybrid", "bpm/sphere"].iter().all(|style| help.contains(style))
    );
}

#[test]
fn comments_that_name_no_style_are_ignored() {
    let rows = ["1 7 1 -0.5 1.5 2.5 3.5", "2 7 2 0.5 4.5 5.5 6.5"];
    for comment in [
        "",
        " # water molecules",
        " # full",
        " # id mol type q x y z",
        " # unheard/of",
        " # FULL/kk",
    ] {
        let frame = frame(data("2 atom types", comment, &rows));
        assert_eq!((&frame.x[..], kinds(&frame)[1].0), (&[1.5, 4.5][..], "2"), "{comment}");
        let is_named = comment.to_lowercase().contains("full");
        assert_eq!(frame.warnings.is_empty(), is_named, "{comment}: {:?}", frame.warnings);
    }
    // A style that does not fit the rows.
    let frame = frame(data("2 atom types", " # atomic positions", &rows));
    assert_eq!(frame.x, [1.5, 4.5]);
    assert!(frame.warnings[0].contains("read as `full`"), "{:?}", frame.warnings);
    let error = frame_with(data("2 atom types", "", &["1 9 0.5 1.5 2.5"]), &ReadOptions::default());
    let error = error.expect_err("type 9 of 2");
    assert!(
        error.help.is_some_and(|help| help.contains("--atom-style") && help.contains("wavepacket"))
    );
}

#[test]
fn all_styles_place_particles() {
    for (style, more, row, expected) in [
        ("electron", "", "1 1 -1.0 1 2.5 1.5 2.5 3.5", true),
        ("wavepacket", "", "1 1 -1.0 1 2.5 7 0.5 0.25 1.5 2.5 3.5", true),
        ("line", "1 lines", "1 1 1 1 2.0 1.5 2.5 3.5", true),
        ("tri", "1 triangles", "1 1 1 1 2.0 1.5 2.5 3.5", true),
        ("body", "1 bodies", "1 1 1 2.0 1.5 2.5 3.5", true),
        ("ellipsoid", "1 ellipsoids", "1 1 1 2.0 1.5 2.5 3.5", true),
        ("template", "", "1 31 2 2 1 1.5 2.5 3.5", true),
        ("bpm/sphere", "", "1 31 1 3.0 2.0 1.5 2.5 3.5", true),
        ("dipole", "", "1 1 -1.0 1.5 2.5 3.5 0.5 0.5 0", true),
        ("spin", "", "1 1 1.5 2.5 3.5 0.0 0.6 0.8 2.2", true),
        ("smd", "", "1 1 31 2.0 2.0 0.5 0.5 1.5 2.5 3.5 1.5 2.5 3.5", true),
        ("mesont", "", "1 31 1 -1 2 0.5 0.5 3.5 0 1.5 2.5 3.5", true),
        ("dielectric", "", "1 31 1 -1.0 1.5 2.5 3.5 0 0 1 0.5 1 1 1 0", true),
        ("charge", "", "1 1 -1.0 1.5 2.5 3.5 0 -1 2", true),
        ("rheo/thermal", "", "1 1 0 1000.5 2.5 1.5 2.5 3.5", false),
        ("edpd", "", "1 1 0.5 1e5 1.5 2.5 3.5", false),
    ] {
        let header = format!("{more}\n1 atom types");
        for (comment, is_named) in [(format!(" # {style}"), true), (String::new(), expected)] {
            let frame = frame(data(&header, &comment, &[row]));
            assert_eq!(frame.position(0), DVec3::new(1.5, 2.5, 3.5), "{style} {comment}");
            assert_eq!(kinds(&frame)[0].0, "1", "{style} {comment}");
            let named =
                frame.warnings.iter().all(|warning| warning.contains(&format!("`{style}`")));
            assert_eq!(named, is_named, "{style}: {:?}", frame.warnings);
        }
    }
    let species = frame(data("1 atom types", " # tdpd 2", &["1 1 1.5 2.5 3.5 0.25 0.5"]));
    assert_eq!((species.x[0], species.warnings.len()), (1.5, 0));
}

#[test]
fn the_header_gives_the_number_of_types() {
    // As LAMMPS reads and writes molecules of a template, and as its manual has them.
    let written = ["1 31 1 1 2 1.5 2.5 3.5", "2 31 1 2 1 1.5 2.5 4.5", "3 32 1 1 2 5.5 2.5 3.5"];
    let in_manual = ["1 2 31 1 1 1.5 2.5 3.5", "2 1 31 1 3 1.5 2.5 4.5", "3 2 32 1 1 5.5 2.5 3.5"];
    for rows in [written, in_manual] {
        let frame = frame(data("2 atom types", "  # template", &rows));
        let names: Vec<&str> = kinds(&frame).iter().map(|kind| kind.0).collect();
        assert_eq!((names, frame.x[2], frame.warnings.len()), (vec!["2", "1", "2"], 5.5, 0));
    }
    let rows: Vec<String> =
        (0..40_000).map(|row| format!("{row} {} 1.5 2.5 3.5", row / 20_000 + 1)).collect();
    let rows: Vec<&str> = rows.iter().map(String::as_str).collect();
    let late = frame(data("1 atom types", " # atomic", &rows));
    assert!(late.warnings[0].contains("an atom is of type 2"), "{:?}", late.warnings);
    assert!(frame(data("2 atom types", " # atomic", &rows)).warnings.is_empty());
}

#[test]
fn labels_are_names_of_types() {
    let text = |sections: &str, comment: &str| {
        let rows = ["1 1 1.5 2.5 3.5", "2 O 4.5 5.5 6.5", "3 C1 7.5 8.5 9.5"];
        let text = data("2 atom types", comment, &rows);
        text.replace("\nAtoms", &format!("\n{sections}Atoms"))
    };
    let labels = "Atom Type Labels\n\n1 C1\n2 O\n\n";
    for comment in ["", " # atomic"] {
        let frame = frame(text(labels, comment));
        assert_eq!(kinds(&frame), [("C1", "C"), ("O", "O"), ("C1", "C")]);
        assert_eq!(frame.kinds.table.len(), 2);
    }
    for masses in ["1 12.011\n2 15.999\n", "C1 12.011\nO 15.999\n"] {
        let sections = format!("{labels}Masses\n\n{masses}\n");
        assert_eq!(kinds(&frame(text(&sections, " # atomic")))[2], ("C1", "C"));
    }
    let after =
        data("1 atom types", " # atomic", &["1 1 0.5 0.5 0.5"]) + "\nAtom Type Labels\n\n1 wax\n";
    assert_eq!(kinds(&frame(after)), [("wax", "-")]);
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
    // Masses of no element do not identify elements.
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
fn velocities_are_matched_by_ids() {
    let frame = frame_with(MOVING, &columns("vz,VX")).expect("a frame");
    let column = |at: usize| (&frame.numbers[at].name[..], &frame.numbers[at].values[..]);
    let (name, vz) = column(0);
    assert!(name == "vz" && (vz[0], vz[2]) == (30.0, 20.0) && vz[1].is_nan(), "{vz:?}");
    assert_eq!((column(1).0, column(1).1[2], frame.numbers.len()), ("VX", 0.5, 2));
    assert_eq!(frame.columns, ["id", "type", "x", "y", "z", "vx", "vy", "vz"]);
    let ids = frame_with(MOVING, &columns("id,vy")).expect("a frame").numbers;
    assert_eq!((&ids[0].values[..], ids[1].values[0]), (&[7.0, 3.0, 5.0][..], -2.0));
    // Velocities are read only if they are asked for.
    assert!(super::frame(MOVING.replace("5 0.5", "5 what")).numbers.is_empty());
}

#[test]
fn missing_or_invalid_velocities_are_reported() {
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

#[test]
fn data_files_may_have_general_boxes() {
    let data = |origin: &str| {
        frame(format!(
            "LAMMPS data\n\n1 atoms\n1 atom types\n\n2 0 0 avec\n0.5 3 0 bvec\n0 0.25 4 cvec\n\
             {origin}\n\nAtoms # atomic\n\n1 1 0.5 0.5 0.5\n"
        ))
    };
    let frame = data("-1 -2 -3 abc origin");
    let cell = frame.cell.expect("a cell");
    assert_eq!(cell.origin, DVec3::new(-1.0, -2.0, -3.0));
    let vectors = [DVec3::X * 2.0, DVec3::new(0.5, 3.0, 0.0), DVec3::new(0.0, 0.25, 4.0)];
    assert_eq!((cell.vectors, &frame.title[..]), (vectors, "LAMMPS data"));
    assert_eq!(data("").cell.map(|cell| cell.origin), Some(DVec3::ZERO));
}

#[test]
fn unknown_sections_of_dumps_are_skipped() {
    let text = dump(BOX, "id element x y z", "7 C 2 4 7\n").replace("ITEM: UNITS\nmetal\n", "");
    let frame = frame(format!("ITEM: NOTES\n1 2\n3 4\n{text}"));
    assert_eq!((frame.x[0], kinds(&frame)[0]), (2.0, ("C", "C")));
    // Elements imply a style in angstrom.
    assert_eq!(frame.unit, LengthUnit::Angstrom);
}

#[test]
fn styles_that_do_not_fit_the_rows_are_reported() {
    let at = |types: &str, comment: &str, row: &str| {
        frame_with(data(types, comment, &[row]), &ReadOptions::default())
    };
    // Rows that fit no other style either are read in the given style.
    for (row, reason) in [
        ("1.5 1 0.5 1.5 2.5", "column 1 cannot be `id`"),
        ("1 9 0.5 1.5 2.5", "a type would be 9"),
        ("1.5 1 0.5 1.5 2.5 7", "it has 5 columns, and the rows have 6"),
    ] {
        let frame = at("2 atom types", " # atomic", row).expect("a frame");
        let [warning] = &frame.warnings[..] else { panic!("{row}: {:?}", frame.warnings) };
        let start = format!("its rows do not fit the atom style of `Atoms # atomic`: {reason}");
        assert!(warning.starts_with(&start), "{warning}");
        assert_eq!(frame.x, [0.5], "{row}");
    }
    let short = at("2 atom types", " # full", "1 1 9").expect_err("three columns of seven");
    let message = "the atom style of the section `Atoms` is not known: it has 7 columns, and the \
                   rows have 3";
    assert_eq!(short.message, message);
    let other = at("2 atom types", " # full", "1 1 0.5 1.5 2.5").expect("a frame");
    assert!(other.warnings[0].contains("do not fit the atom style of `Atoms # full`"));
    let unknown = at("1 atom types", "", "1 2 0.5 1.5 2.5").expect_err("no style");
    assert!(unknown.message.ends_with("its rows of 5 columns fit no style"), "{unknown}");
}

#[test]
fn titles_of_data_files_contain_units() {
    let masses = "\nMasses\n\n1 15.9994\n";
    for (title, more, unit) in [
        ("units = si", "", LengthUnit::Meter),
        ("a title, units = nano, of 2", "", LengthUnit::Nanometer),
        ("a title", "", LengthUnit::Unknown),
        ("units = lj", "", LengthUnit::Unknown),
        // Elements imply a style in angstrom, unless the title names another.
        ("a title", masses, LengthUnit::Angstrom),
        ("units = electron", masses, LengthUnit::Bohr),
        // These are masses of no element.
        ("a title", "\nMasses\n\n1 72.0\n", LengthUnit::Unknown),
        ("a title", "\nMasses\n\n1 1.0\n", LengthUnit::Unknown),
    ] {
        let text = data("1 atom types", " # atomic", &["1 1 0.5 1.5 2.5"]) + more;
        let frame = frame(text.replacen("LAMMPS", title, 1));
        assert_eq!((frame.unit, frame.title.as_str()), (unit, title), "{more}");
    }
}

#[test]
fn tilts_and_corners_of_boxes_are_those_of_the_header() {
    let text = "t\n1 atoms\n1 3 xlo xhi\n2 6 ylo yhi\n3 11 zlo zhi\n0.5 -0.25 0.75 xy xz yz\n\n\
                Atoms # atomic\n\n1 1 0 0 0\n";
    let cell = frame(text).cell.expect("a cell");
    let vectors = [DVec3::X * 2.0, DVec3::new(0.5, 4.0, 0.0), DVec3::new(-0.25, 0.75, 8.0)];
    assert_eq!((cell.origin, cell.vectors), (DVec3::new(1.0, 2.0, 3.0), vectors));
    assert_eq!(frame(text.replace("1 3 xlo xhi\n", "")).cell, None);
}

#[test]
fn bodies_are_counted_by_their_rows() {
    let text = |section: &str| data("1 atom types", " # atomic", &["1 1 0.5 1.5 2.5"]) + section;
    let shapes = |section: &str| frame(text(section)).warnings;
    // Two bodies: one with an integer and four floats, and one with none.
    let bodies = shapes("\nBodies\n\n1 1 4\n2\n0.1 0.2\n0.3 0.4\n2 0 0\n");
    assert!(bodies[0].starts_with("2 particles that may have other shapes"), "{bodies:?}");
    for (section, start) in [
        ("Lines", "3 particles that may"),
        ("Triangles", "3 particles that may"),
        ("Ellipsoids", "3 particles that may"),
    ] {
        let warnings = shapes(&format!("\n{section}\n\n1 1 1 1\n2 1 1 1\n3 1 1 1\n"));
        assert!(warnings[0].starts_with(start), "{warnings:?}");
    }
    for section in ["Bonds\n\n1 1 1 1\n", "Angles\n\n1 1 1 2 1\n"] {
        assert!(shapes(&format!("\n{section}")).is_empty(), "{section}");
    }
}
