//! Tests of NumPy arrays.

use super::*;
use std::io::{Cursor, Write};
use zip::write::{SimpleFileOptions, ZipWriter};

fn npy(kind: &str, shape: &str, fortran: bool, numbers: &[u8]) -> Vec<u8> {
    let fortran = if fortran { "True" } else { "False" };
    let kind = if kind.starts_with('[') { kind.to_owned() } else { format!("'{kind}'") };
    let mut header = format!("{{'descr': {kind}, 'fortran_order': {fortran}, 'shape': {shape}, }}");
    header.push_str(&" ".repeat(63 - (10 + header.len()) % 64));
    header.push('\n');
    let length = (header.len() as u16).to_le_bytes();
    [&b"\x93NUMPY\x01\x00"[..], &length, header.as_bytes(), numbers].concat()
}

fn floats(values: &[f32]) -> Vec<u8> {
    values.iter().flat_map(|value| value.to_le_bytes()).collect()
}

fn doubles(values: &[f64]) -> Vec<u8> {
    values.iter().flat_map(|value| value.to_be_bytes()).collect()
}

fn npz(arrays: &[(&str, Vec<u8>)]) -> Vec<u8> {
    let mut writer = ZipWriter::new(Cursor::new(Vec::new()));
    for (name, bytes) in arrays {
        writer.start_file(format!("{name}.npy"), SimpleFileOptions::default()).expect("a file");
        writer.write_all(bytes).expect("memory");
    }
    writer.finish().expect("memory").into_inner()
}

/// Frames of one row each.
pub(super) fn frames_of_one(count: u8) -> Vec<u8> {
    npy("|u1", &format!("({count}, 1, 3)"), false, &(0..3 * count).collect::<Vec<_>>())
}

#[test]
fn rows_are_positions_with_radii_or_without() {
    let three = frame(npy("<f4", "(2, 3)", false, &floats(&[1.0, 2.0, 3.0, 4.0, 5.0, 6.0])));
    assert_eq!((three.position(1), three.radius.len()), (DVec3::new(4.0, 5.0, 6.0), 0));
    let four = frame(npy(">f8", "(1, 4)", false, &doubles(&[0.1, 2.0, 3.0, 0.5])));
    assert_eq!((four.x[0], four.radius[0]), (0.1, 0.5));
    let columns = floats(&[1.0, 4.0, 2.0, 5.0, 3.0, 6.0]);
    assert_eq!(frame(npy("<f4", "(2, 3)", true, &columns)), three);
    let bytes = [1_u8, 2, 3, 255];
    assert_eq!(frame(npy("|u1", "(1, 4)", false, &bytes)).radius, [255.0]);
    let chosen = super::columns("x=2,y=3,z=4,1");
    let five = npy("|u1", "(1, 5)", false, &[9, 1, 2, 3, 4]);
    let five = frame_with(five, &chosen).expect("a frame");
    assert_eq!((five.position(0), five.numbers[0].values[0]), (DVec3::new(1.0, 2.0, 3.0), 9.0));
}

#[test]
fn three_dimensions_are_frames_and_structures_have_names() {
    let values: Vec<f32> = (0..12_u8).map(f32::from).collect();
    let all = npy("<f4", "(2, 2, 3)", false, &floats(&values));
    assert_eq!(frames(&all), [[0.0, 3.0], [6.0, 9.0]]);
    assert_eq!(frame_with(&all, &at_frame("last")).expect("a frame").z, [8.0, 11.0]);
    let kind = "[('id', '<u2'), ('x', '<f4'), ('y', '<f4'), ('z', '>f8'), ('radius', '|i1')]";
    let row = [&7_u16.to_le_bytes()[..], &floats(&[1.0, 2.0]), &doubles(&[3.0]), &[4]].concat();
    let frame = frame_with(npy(kind, "(1,)", false, &row), &columns("id")).expect("a frame");
    assert_eq!((frame.position(0), frame.radius[0]), (DVec3::new(1.0, 2.0, 3.0), 4.0));
    assert_eq!(frame.numbers[0].values, [7.0]);
}

#[test]
fn archives_have_arrays_for_positions_radii_and_colors() {
    let position = npy("<f4", "(2, 3)", false, &floats(&[1.0, 2.0, 3.0, 4.0, 5.0, 6.0]));
    let diameters = npy("<f4", "(2,)", false, &floats(&[1.0, 0.5]));
    let color = npy("<f4", "(2, 3)", false, &floats(&[1.0, 0.5, 0.0, f32::NAN, 2.0, -1.0]));
    let kind = npy("|u1", "(2,)", false, &[3, 6]);
    let arrays = [
        ("position", position.clone()),
        ("diameters", diameters.clone()),
        ("color", color),
        ("typeid", kind),
        ("q", diameters.clone()),
    ];
    let frame = frame_with(npz(&arrays), &columns("q")).expect("a frame");
    assert_eq!((frame.x[1], &frame.radius[..]), (4.0, &[0.5, 0.25][..]));
    assert_eq!(frame.color[1].to_array(), [0.0, 1.0, 0.0]);
    assert_eq!(kinds(&frame), [("3", "-"), ("6", "-")]);
    assert_eq!(frame.numbers[0].values, [1.0, 0.5]);
    assert_eq!(super::frame(npz(&[("anything", position.clone())])).len(), 2);
    let several = npz(&[("a", position.clone()), ("b", position.clone())]);
    assert_eq!(fault(&several).2, "no array is named `position`; there are a, b");
    assert!(frame_with(&several, &columns("x=b")).is_ok());
    let wrong =
        npz(&[("position", position), ("radius", npy("<f4", "(1,)", false, &floats(&[1.0])))]);
    assert_eq!(fault(wrong).2, "the array `radius` has 1 numbers, but there are 2 particles");
    assert!(fault(&several[..several.len() - 30]).2.starts_with("is not a complete ZIP archive"));
}

#[test]
fn faulty_arrays_are_refused() {
    let values = floats(&[1.0, 2.0, 3.0]);
    for (content, message) in [
        (
            npy("<f4", "(2, 3)", false, &values),
            "ends before its last row: failed to fill whole buffer",
        ),
        (npy("<f4", "(1, 2)", false, &values), "is an array of 2 columns"),
        (npy("<f4", "(3,)", false, &values), "is an array of 1 columns"),
        (npy("<f4", "()", false, &values), "is an array of shape []"),
        (npy("<f4", "(1, 99999)", false, &values), "is an array of shape [1, 99999]"),
        (npy("<c8", "(1, 3)", false, &values), "has numbers of the type `<c8`"),
        (npy("|O", "(1, 3)", false, &values), "has numbers of the type `|O`"),
        (npy("<f4", "(18446744073709551615, 3)", true, &values), "ends before its last row"),
        (npy("<f4", "(18446744073709551615, 3)", false, &values), "ends before its last row"),
        (npy("<f4", "(18446744073709551615, 0, 3)", false, &[]), "holds no particles"),
        (b"\x93NUMPY\x02\x00\xFF\xFF\xFF\xFF".to_vec(), "has a header of 4294967295 bytes"),
        (b"\x93NUMPY\x01\x00\x02\x00{}".to_vec(), "has numbers of the type ``"),
        (b"\x93NUMPY\x01".to_vec(), "cannot be read"),
    ] {
        let found = fault(&content).2;
        assert!(found.starts_with(message), "{message}: {found}");
    }
}

#[test]
fn requested_arrays_are_kept() {
    let arrays = [
        ("position", npy("<f4", "(2, 3)", false, &floats(&[0.0, 0.0, 0.0, 3.0, 0.0, 0.0]))),
        ("charge", npy("<f4", "(2,)", false, &floats(&[1.0, -1.0]))),
    ];
    let wanted = ["charge", "speed"].map(str::to_owned).into();
    let options =
        ReadOptions { columns: Columns { wanted, ..Columns::default() }, ..ReadOptions::default() };
    let frame = frame_with(npz(&arrays), &options).expect("a frame");
    assert_eq!((frame.numbers.len(), &frame.numbers[0].values), (1, &vec![1.0, -1.0]));
}

fn letters(text: &str, count: usize) -> Vec<u8> {
    let codes = text.chars().map(|letter| letter as u32).chain([0; 8]).take(count);
    codes.flat_map(u32::to_le_bytes).collect()
}

#[test]
fn structures_and_archives_may_have_texts() {
    let kind = "[('name', '|S4'), ('x', '<f4'), ('y', '<f4'), ('z', '<f4'), ('element', '<U2')]";
    let row = |name: &[u8], x: f32, element: &str| {
        [name, &floats(&[x, 2.0, 3.0]), &letters(element, 2)].concat()
    };
    let rows = [row(b"CA\0\0", 1.0, "C"), row(b"NA12", 2.0, "Na")].concat();
    let frame = frame_with(npy(kind, "(2,)", false, &rows), &columns("name")).expect("a frame");
    assert_eq!((&frame.x[..], kinds(&frame)), (&[1.0, 2.0][..], vec![("C", "C"), ("Na", "Na")]));
    assert_eq!((frame.texts[0].text(0), frame.texts[0].text(1)), ("CA", "NA12"));
    let arrays = |count: usize| {
        npz(&[
            ("position", npy("<f4", "(2, 3)", false, &floats(&[0.0, 0.0, 0.0, 3.0, 0.0, 0.0]))),
            (
                "species",
                npy("<U3", "(2,)", false, &[letters("O", 3), letters("\u{3b1}x", 3)].concat()),
            ),
            ("chain", npy("|S1", &format!("({count},)"), false, &b"ABB"[..count])),
        ])
    };
    let frame = frame_with(arrays(2), &columns("chain")).expect("a frame");
    assert_eq!((kinds(&frame)[1], frame.texts[0].text(1)), (("\u{3b1}x", "-"), "B"));
    for (count, found) in [(1, "1 texts"), (3, "more texts")] {
        let error = frame_with(arrays(count), &columns("chain")).expect_err("too few or too many");
        assert!(error.message.contains(found), "{}", error.message);
    }
    let radii = ReadOptions { radii: "column:chain".parse().expect("radii"), ..columns("") };
    let error = frame_with(arrays(2), &radii).expect_err("texts");
    assert_eq!(error.message, "the array `chain` holds texts, but numbers are needed");
}

#[test]
fn texts_are_not_positions() {
    let kind = "[('x', '|S4'), ('y', '<f4'), ('z', '<f4')]";
    assert_eq!(fault(npy(kind, "(1,)", false, &[0; 12])).2, "holds texts in its column `x`");
    assert_eq!(fault(npy("|S4", "(1, 3)", false, &[0; 12])).2, "holds texts in its column `1`");
    let many = "[('x', '|S9999999'), ('y', '|S9999999'), ('z', '<f4')]";
    assert_eq!(fault(npy(many, "(1,)", false, &[])).2, "has rows of 20000002 bytes");
}

#[test]
fn arrays_of_columns_are_turned() {
    let values: Vec<f32> = (0..15_u8).map(f32::from).collect();
    let turned = frame(npy("<f4", "(3, 5)", false, &floats(&values)));
    assert_eq!((turned.len(), turned.position(1)), (5, DVec3::new(1.0, 6.0, 11.0)));
    assert!(turned.warnings[0].contains("(3, 5)"), "{:?}", turned.warnings);
    let fortran = frame(npy("<f4", "(3, 5)", true, &floats(&values)));
    assert_eq!(fortran.position(1), DVec3::new(3.0, 4.0, 5.0));
    let four: Vec<f32> = (0..8_u8).map(f32::from).collect();
    let four = frame(npy("<f4", "(4, 2)", false, &floats(&four)));
    assert_eq!((four.position(1), four.radius[1]), (DVec3::new(1.0, 3.0, 5.0), 7.0));
    // Arrays that may have rows are read by rows, and so are those with named columns.
    let rows = frame(npy("<f4", "(4, 3)", false, &floats(&values[..12])));
    assert_eq!((rows.len(), rows.position(1)), (4, DVec3::new(3.0, 4.0, 5.0)));
    let named = frame_with(npy("<f4", "(3, 5)", false, &floats(&values)), &columns("x=2,y=3,z=5"));
    assert_eq!(named.expect("a frame").position(1), DVec3::new(6.0, 7.0, 9.0));
    let large: Vec<f32> = (0..60_000).map(|value| value as f32).collect();
    let archive = npz(&[
        ("position", npy("<f4", "(3, 20000)", false, &floats(&large))),
        ("color", npy("<f4", "(3, 20000)", false, &floats(&vec![0.5; 60_000]))),
        ("radius", npy("<f4", "(20000, 1)", false, &floats(&large[..20_000]))),
    ]);
    let turned = frame(archive);
    assert_eq!((turned.len(), turned.x[7], turned.z[7]), (20_000, 7.0, 40_007.0));
    assert_eq!((turned.radius[9], turned.color.len()), (9.0, 20_000));
    let position = ("position", npy("<f4", "(2, 3)", false, &floats(&values[..6])));
    let color = ("color", npy("<f4", "(3, 2)", false, &floats(&[1.0, 0.0, 0.5, 0.25, 0.0, 1.0])));
    assert_eq!(frame(npz(&[position.clone(), color])).color[0].to_array(), [1.0, 0.5, 0.0]);
    let color = ("color", npy("<f4", "(6,)", false, &floats(&values[..6])));
    assert!(fault(npz(&[position, color])).2.contains("rows of 1 numbers"));
}

#[test]
fn archives_may_have_an_array_for_each_axis() {
    let array =
        |values: &[f32]| npy("<f4", &format!("({},)", values.len()), false, &floats(values));
    let (x, y, z) = (array(&[1.0, 4.0]), array(&[2.0, 5.0]), array(&[3.0, 6.0]));
    for names in [["x", "y", "z"], ["X", "Y", "Z"], ["pos_x", "pos_y", "pos_z"]] {
        let arrays = [
            (names[2], z.clone()),
            (names[0], x.clone()),
            (names[1], y.clone()),
            ("r", array(&[0.5, 0.25])),
        ];
        let frame = frame(npz(&arrays));
        assert_eq!((frame.position(1), frame.radius[1]), (DVec3::new(4.0, 5.0, 6.0), 0.25));
    }
    let column = npy("<f4", "(4, 1)", false, &floats(&[1.0, 2.0, 3.0, 4.0]));
    let columns_of_four = npz(&[("x", column.clone()), ("y", column.clone()), ("z", column)]);
    assert_eq!(frame(columns_of_four).x, [1.0, 2.0, 3.0, 4.0]);
    let named = npz(&[("a", x.clone()), ("b", y.clone()), ("c", z.clone()), ("q", x.clone())]);
    let frame = frame_with(&named, &columns("x=a,y=b,z=c,q")).expect("a frame");
    assert_eq!((frame.position(0), frame.numbers[0].values[1]), (DVec3::new(1.0, 2.0, 3.0), 4.0));
    let unnamed = frame_with(&named, &ReadOptions::default()).expect_err("no names");
    assert!(unnamed.help.is_some_and(|help| help.contains("--columns x=NAME,y=NAME,z=NAME")));
    let short = npz(&[("x", x), ("y", y), ("z", array(&[1.0]))]);
    assert_eq!(fault(short).2, "the array `z` has 1 numbers, but there are 2 particles");
    let empty = fault(npz(&[])).2;
    assert_eq!(empty, "is a ZIP archive without arrays of NumPy");
}

#[test]
fn structures_may_come_in_frames() {
    let kind = "[('x', '|u1'), ('y', '|u1'), ('z', '|u1')]";
    let bytes: Vec<u8> = (0..12).collect();
    assert_eq!(frames(npy(kind, "(2, 2)", false, &bytes)), [[0.0, 3.0], [6.0, 9.0]]);
    for (kind, shape, fortran) in [
        (kind, "(2, 2, 1)", false),
        (kind, "(4,)", true),
        ("|u1", "(2, 2, 3)", true),
        ("<U1", "(1, 3)", true),
        ("|u1", "(1, 2, 2, 3)", false),
    ] {
        let content = npy(kind, shape, fortran, &bytes);
        assert!(frame_with(content, &ReadOptions::default()).is_err(), "{kind} {shape}");
    }
    for shape in ["(0, 3)", "(2, 0, 3)"] {
        assert_eq!(fault(npy("|u1", shape, false, &[])).2, "holds no particles", "{shape}");
    }
}

#[test]
fn columns_of_diameters_are_halved() {
    let content = npy("|u1", "(1, 4)", false, &[1, 2, 3, 8]);
    let read = |text: &str| frame_with(&content, &columns(text)).expect("a frame").radius;
    assert_eq!(read("x=1,y=2,z=3,diameter=4"), [4.0]);
    assert_eq!(read("x=1,y=2,z=3,radius=4"), [8.0]);
}

/// Positions of two particles, and additional arrays.
fn with_arrays(arrays: &[(&str, Vec<u8>)]) -> Vec<u8> {
    let position = npy("|u1", "(2, 3)", false, &[1, 2, 3, 4, 5, 6]);
    npz(&[&[("position", position)][..], arrays].concat())
}

/// An array of bytes that count up from 0.
fn bytes(shape: &str, count: u8) -> Vec<u8> {
    npy("|u1", shape, false, &(0..count).collect::<Vec<_>>())
}

#[test]
fn arrays_with_a_row_for_each_particle_are_columns() {
    let record = "[('a', '|u1'), ('b', '|u1')]";
    let content = with_arrays(&[
        ("wide", bytes("(2, 64)", 128)),
        ("wider", bytes("(2, 65)", 130)),
        ("short", bytes("(1,)", 1)),
        ("long", bytes("(3,)", 3)),
        ("record", npy(record, "(2,)", false, &[1, 2, 3, 4])),
        ("q", bytes("(2,)", 2)),
    ]);
    let listed = frame(&content).columns;
    let wide = (1..=64).map(|column| format!("wide_{column}"));
    let expected = ["x", "y", "z"].map(|axis| format!("position_{axis}")).into_iter().chain(wide);
    assert_eq!(listed, expected.chain(["q".to_owned()]).collect::<Vec<_>>());
    let kept = frame_with(&content, &columns("WIDE_64,position_y,q")).expect("a frame").numbers;
    let kept: Vec<(&str, &[f64])> =
        kept.iter().map(|column| (column.name.as_str(), &column.values[..])).collect();
    let expected = [("wide_64", &[63.0, 127.0]), ("position_y", &[2.0, 5.0]), ("q", &[0.0, 1.0])];
    assert_eq!(kept, expected.map(|(name, values)| (name, &values[..])));
    for (name, message) in [
        ("wide", "the array `wide` has 64 columns"),
        ("short", "the array `short` has 1 numbers, but there are 2 particles"),
        ("long", "the array `long` has more rows, but there are 2 particles"),
    ] {
        let error = frame_with(&content, &columns(name)).expect_err(name);
        assert_eq!(error.message, message);
    }
    let wide = frame_with(&content, &columns("wide")).expect_err("many columns");
    assert!(wide.help.is_some_and(|help| help.ends_with("wide_1")));
}

#[test]
fn other_arrays_are_kept_once_within_the_memory_limit() {
    let content = with_arrays(&[
        ("radius", bytes("(2,)", 2)),
        ("m", bytes("(2,)", 2)),
        ("q", bytes("(2,)", 2)),
    ]);
    for (rest, expected) in [(1000, &["m", "q"][..]), (2, &["m", "q"]), (1, &["q"])] {
        let columns = Columns { rest: Some(rest), ..columns("q").columns };
        let options = ReadOptions { columns, ..ReadOptions::default() };
        let numbers = frame_with(&content, &options).expect("a frame").numbers;
        let names: Vec<&str> = numbers.iter().map(|column| column.name.as_str()).collect();
        assert_eq!(names, expected, "{rest}");
    }
}

#[test]
fn roles_of_arrays_are_recorded() {
    let colors = npy("<f4", "(2, 3)", false, &floats(&[0.0, 0.5, 1.0, 1.0, 0.5, 0.0]));
    let roles = |content: &[u8]| -> Vec<(Role, String)> { frame(content).roles };
    let named = |roles: &[(Role, &str)]| -> Vec<(Role, String)> {
        roles.iter().map(|(role, name)| (*role, (*name).to_owned())).collect()
    };
    let places = [(Role::X, "position_x"), (Role::Y, "position_y"), (Role::Z, "position_z")];
    let content = with_arrays(&[
        ("diameters", bytes("(2,)", 2)),
        ("typeid", bytes("(2,)", 2)),
        ("color", colors),
    ]);
    let more = [
        (Role::Kind, "typeid"),
        (Role::Diameter, "diameters"),
        (Role::Red, "color_x"),
        (Role::Green, "color_y"),
        (Role::Blue, "color_z"),
    ];
    assert_eq!(roles(&content), named(&[&places[..], &more].concat()));
    let both = with_arrays(&[("diameter", bytes("(2,)", 2)), ("r", bytes("(2,)", 2))]);
    assert_eq!(roles(&both), named(&[&places[..], &[(Role::Radius, "r")]].concat()));
    // An array of radii takes precedence over a fourth column of positions.
    let four = |more: &[(&str, Vec<u8>)]| {
        let position = ("xyz", bytes("(2, 4)", 8));
        npz(&[&[position][..], more].concat())
    };
    assert_eq!(frame(four(&[])).radius, [3.0, 7.0]);
    assert_eq!(roles(&four(&[]))[3], (Role::Radius, "xyz_4".to_owned()));
    let own = frame(four(&[("radii", bytes("(2,)", 2))]));
    assert_eq!((&own.radius[..], own.roles.len()), (&[0.0, 1.0][..], 4));
    assert_eq!(own.roles[3], (Role::Radius, "radii".to_owned()));
    let asked = ReadOptions { radii: "column:q".parse().expect("radii"), ..columns("") };
    let content =
        with_arrays(&[("radius", bytes("(2,)", 2)), ("q", npy("|u1", "(2,)", false, &[8, 9]))]);
    assert_eq!(frame_with(content, &asked).expect("a frame").radius, [8.0, 9.0]);
}

#[test]
fn arrays_of_axes_have_one_number_in_each_row() {
    let one = || bytes("(2,)", 2);
    let texts = npy("|S1", "(2,)", false, b"ab");
    for (x, found) in [(bytes("(2, 2)", 4), "has 2 columns"), (texts, "holds texts")] {
        let message = fault(npz(&[("x", x), ("y", one()), ("z", one())])).2;
        let expected = format!("the array `x` {found}, but x, y and z have one number in each row");
        assert_eq!(message, expected);
    }
    // Numbers of a grid are flattened row by row.
    let position = npy("|u1", "(4, 3)", false, &[0; 12]);
    let grid = npz(&[("position", position), ("radius", bytes("(2, 2)", 4))]);
    assert_eq!(frame(grid).radius, [0.0, 1.0, 2.0, 3.0]);
}

#[test]
fn the_first_array_of_a_cell_is_the_cell() {
    let edges = |lengths: [f32; 3]| npy("<f4", "(3,)", false, &floats(&lengths));
    let content =
        with_arrays(&[("box", edges([8.0, 9.0, 10.0])), ("lattice", edges([1.0, 2.0, 3.0]))]);
    let frame = frame(content);
    assert_eq!(frame.cell.map(|cell| cell.vectors[2].z), Some(10.0));
    assert!(frame.warnings.iter().any(|text| text.ends_with("not used: lattice")));
    let large = super::frame(with_arrays(&[("box", bytes("(10,)", 10))]));
    assert_eq!(large.cell, None);
    assert!(large.warnings.iter().any(|text| text.ends_with("not used: box")));
}
