//! Tests of rows without and with a header, and of features that all formats share.

use super::*;
use crate::scene::Rgb;
use proptest::prelude::*;

#[test]
fn rows_of_numbers_are_read_with_any_separators() {
    let expected = particles("1 2 3 4\n5 6 7 8\n").spheres;
    assert_eq!(expected.center(1), DVec3::new(5.0, 6.0, 7.0));
    assert_eq!(expected.radius, [4.0, 8.0]);
    for content in [
        "1,2,3,4\r\n5, 6, 7, 8",
        "\u{FEFF}# x y z r\n\n 1\t2 3\t 4 # one\n\n5;6;7;8\n#end",
        "1.0 +2 3e0 4.\n5 6 7 80e-1\n",
    ] {
        assert_eq!(particles(content).spheres, expected, "{content}");
    }
}

#[test]
fn faulty_rows_have_a_line_and_a_column() {
    let cases = [
        ("1 2 3 4\n1 2 x 4\n", (2, 5, "`x` is not a number")),
        ("1 2 3 4\n1 2 3\n", (2, 1, "3 columns, but the rows above have 4")),
        ("1 2\n", (1, 1, "2 columns, but a row is `x y z` or `x y z radius`")),
        ("# a\n1 2 3 4 5\n", (2, 1, "5 columns, but a row is `x y z` or `x y z radius`")),
        ("x,y,z,r\n1,2,3,4\n1,2,,4\n", (3, 5, "`` is not a number")),
        ("x,y,z,r\n\n# c\n1,2,3,four\n", (4, 7, "`four` is not a number")),
        ("x,y,z,r\r\n1,2,3\r\n", (2, 1, "3 columns, but the header has 4")),
        ("x,y,z,r\r\n1,2,3,4\r\n\r\n1,\"2\", a ,4\r\n", (4, 8, "`a` is not a number")),
        ("x,y,z,r\n1,2,3,4\n\n#\n1,2,3", (5, 1, "3 columns, but the header has 4")),
        ("x,y,red\n1,2,3\n", (1, 1, "no column is named `z`; there are x, y, red")),
        (
            "x,y,z,red,green,blue\n1,2,3,0.5,255,0\n",
            (2, 11, "a color of 255, but colors are 0 to 1"),
        ),
        ("2\nc\nC 0 0 0\n", (4, 1, "the file ends after 1 of 2 atoms")),
        ("2\n", (2, 1, "the file ends before the comment line")),
        ("1\nc\nC 0 zero 0\n", (3, 5, "`zero` is not a number")),
        ("1\nc\nC 0 0\n", (3, 1, "an atom is `symbol x y z`")),
        (
            "1\nProperties=id:I:1:pos:R:2\n1 0 0\n",
            (2, 1, "no column is named `x`; there are id, pos_1, pos_2"),
        ),
        ("1\nProperties=pos:R\n0 0 0\n", (2, 1, "invalid Properties `pos:R`")),
        (
            "1\nProperties=pos:R:99999999999\n0 0 0\n",
            (2, 1, "`pos:R:99999999999` makes more than 10000 columns"),
        ),
        ("1\nLattice=\"1 0 0\"\nC 0 0 0\n", (2, 1, "Lattice is `1 0 0`, but must be 9 numbers")),
    ];
    for (content, (line, column, message)) in cases {
        assert_eq!(fault(content), (line, column, message.to_owned()), "{content}");
    }
}

#[test]
fn garbage_is_refused_with_a_reason() {
    let cases: [(&[u8], &str); 9] = [
        (b"", "holds no particles"),
        (b"\n# nothing\n", "holds no particles"),
        (b"x,y,z\n", "holds no particles"),
        (b"0\nempty\n", "holds no particles"),
        (b"\x1F\x8B\x08rest", "the gzip data is damaged or cut off"),
        (b"BZh9rest", "the bzip2 data is damaged or cut off"),
        (b"abc\0def", "zero bytes"),
        (b"BEGIN_SCENERY\n", "unknown format"),
        (b"1 2 3\n\xFF\xFE 2 3", "is not a number"),
    ];
    for (content, message) in cases {
        assert!(fault(content).2.contains(message), "{message}: {:?}", fault(content));
    }
    let endless = format!("1 2 3\n{}", "1".repeat(2_000_000));
    assert!(fault(endless).2.contains("longer than"));
}

#[test]
fn claims_of_a_billion_atoms_reserve_nothing() {
    let (line, _, message) = fault("18446744073709551615\nc\nC 0 0 0\n");
    assert_eq!(
        (line, message.as_str()),
        (4, "the file ends after 1 of 18446744073709551615 atoms")
    );
    assert_eq!(fault("18446744073709551616\nc\n").0, 1);
}

#[test]
fn invalid_rows_are_dropped_and_counted() {
    let read =
        particles("0 0 0 1\nnan 0 0 1\n0 inf 0 1\n0 0 0 nan\n0 0 0 0\n0 0 0 -1\n1 1 1 1e-320\n");
    assert_eq!(read.spheres.radius, [1.0, 1e-320]);
    let warning = "5 of 7 rows were dropped: 3 not finite, 2 with a radius of 0 or less";
    assert!(read.frame.warnings[0].ends_with(warning), "{:?}", read.frame.warnings);
    let none = fault("nan 0 0 1\n0 0 0 0\n").2;
    assert_eq!(none, "none of its 2 rows is a sphere: 1 not finite, 1 with a radius of 0 or less");
}

#[test]
fn headers_name_columns_in_any_order() {
    let read =
        particles("B;G;R;Diameter;Z;Y;X;material;id\n.1;.2;.3;4;3;2;1;gold;7\n0;0;0;2;0;0;0;;8\n");
    assert_eq!(read.spheres.center(0), DVec3::new(1.0, 2.0, 3.0));
    assert_eq!(read.spheres.radius, [2.0, 1.0]);
    assert_eq!(read.spheres.color, [Rgb::new(0.3, 0.2, 0.1), Rgb::ZERO]);
    assert_eq!(read.material_names, ["gold", ""]);
    assert_eq!(read.spheres.material, [0, 1]);
    assert!(
        read.frame.warnings[0].ends_with("columns that are not used: id"),
        "{:?}",
        read.frame.warnings
    );
}

#[test]
fn quoted_names_may_contain_anything() {
    let read = particles("x,y,z,radius,material\n0,0,0,1,\"a, \"\"b\"\"\"\n");
    assert_eq!(read.material_names, ["a, \"b\""]);
}

#[test]
fn atoms_have_radii_and_colors_of_their_elements() {
    let read = particles("3\nwater and more\r\nO 0 0 0 extra\nh1 1 0 0\nQx 2 0 0\n\n");
    assert_eq!(read.spheres.radius, [1.5, 1.2, 1.7]);
    assert_eq!(read.spheres.color[1], Rgb::ONE);
    assert_eq!(read.frame.warnings.len(), 1);
    assert!(read.frame.warnings[0].ends_with(": Qx"), "{:?}", read.frame.warnings);
    let frames = particles("1\na\nC 0 0 0\n1\nb\nC 1 0 0\n");
    assert_eq!((frames.spheres.len(), frames.frame.warnings.len()), (1, 1));
}

#[test]
fn options_give_radii_and_scale() {
    let options = ReadOptions { radii: Radii::Missing(0.3), scale: 0.1, ..ReadOptions::default() };
    let read = |content: &str| read_with(content, &options).map(|read| read.spheres);
    let constant = read("1 2 3\n").ok().map(|spheres| (spheres.x, spheres.radius));
    assert_eq!(constant, Some((vec![0.1], vec![0.3])));
    let own = read("1 2 3 4\n").ok().map(|spheres| (spheres.x, spheres.radius));
    assert_eq!(own, Some((vec![0.1], vec![0.4])));
    let atoms = read("1\nc\nC 1 2 3\n").ok().map(|spheres| (spheres.x, spheres.radius));
    assert_eq!(atoms, Some((vec![0.1], vec![0.3])));
}

#[test]
fn missing_radii_are_guessed_with_a_warning() {
    let read = particles("0 0 0\n2 0 0\n4 0 0\n6 0 0\n");
    assert_eq!(read.spheres.radius, [0.75; 4]);
    assert!(read.frame.warnings[0].contains("radius = 0.75"), "{:?}", read.frame.warnings);
}

#[test]
fn unclosed_quotes_are_errors_and_long_names_are_shortened() {
    let unclosed = fault("x,y,z\n1,2,3\n\n1,2,\"3,4,5\n");
    assert_eq!(unclosed, (4, 1, "a quote is not closed".to_owned()));
    let read = particles(format!("x,y,z,{}\n1,2,3,4\n", "n".repeat(100_000)));
    assert!(read.frame.warnings.iter().all(|warning| warning.len() < 1000));
}

#[test]
fn a_format_that_is_asked_for_is_the_format() {
    let options = |format| ReadOptions { format: Some(format), ..ReadOptions::default() };
    assert!(read_with("5 6 7\n", &options(Format::Csv)).is_err());
    assert!(read_with("5 6 7\n", &options(Format::Xyz)).is_err());
    assert!(read_with("5 6 7\n", &options(Format::Xyzr)).is_ok());
}

proptest! {
    #[test]
    fn no_content_makes_a_reader_panic(
        head in prop::sample::select(vec!["", "x,y,z,r\n", "2\nc\n", "x;y;z;red;green;blue\n"]),
        body in prop_oneof!["[-0-9.,; #e\r\n\"nx]{0,80}", ".{0,40}"],
        format in prop::sample::select(
            vec![None, Some(Format::Xyzr), Some(Format::Csv), Some(Format::Xyz)],
        ),
    ) {
        let options = ReadOptions { format, ..ReadOptions::default() };
        match read_with([head, &body].concat(), &options) {
            Ok(read) => prop_assert!(!read.spheres.is_empty()),
            Err(error) => prop_assert!(!error.message.is_empty()),
        }
    }
}

#[test]
fn a_column_of_ids_is_distinguished_from_coordinates() {
    let read = particles("7 1.5 2 3\n2 2.5 1 0\n9 0.5 1 1\n");
    assert_eq!(read.spheres.x, [1.5, 2.5, 0.5]);
    assert!(read.frame.warnings.iter().any(|warning| warning.ends_with("is read as ids")));
    let with_radii = particles("1 1.5 2 3 0.5\n2 2.5 1 0 0.25\n");
    assert_eq!(with_radii.spheres.radius, [0.5, 0.25]);
    // Integer positions, and ids that occur twice.
    assert_eq!(particles("1 2 3 4\n5 6 7 8\n").spheres.x, [1.0, 5.0]);
    assert_eq!(particles("1 2.5 3 4\n1 6.5 7 8\n").spheres.radius, [4.0, 8.0]);
}

#[test]
fn columns_may_be_chosen() {
    let options = columns("x=2,y=3,z=4,diameter=6,5");
    let frame = frame_with("0 1 2 3 7 8\n0 4 5 6 9 10\n", &options).expect("a frame");
    assert_eq!((&frame.x[..], &frame.radius[..]), (&[1.0, 4.0][..], &[4.0, 5.0][..]));
    assert_eq!(frame.numbers[0].values, [7.0, 9.0]);
    let options = columns("x=px,y=py,z=pz,type=what,name,q");
    let text = "px,py,pz,what,name,q\n1,2,3,C,\u{e4}\u{3b1},.5\n4,5,6,O,b,?\n7,8,9,C,b,1\n";
    let frame = frame_with(text, &options).expect("a frame");
    assert_eq!(kinds(&frame), [("C", "C"), ("O", "O"), ("C", "C")]);
    assert_eq!((frame.texts[0].text(0), frame.texts[0].text(2)), ("\u{e4}\u{3b1}", "b"));
    assert!(frame.numbers[0].values[1].is_nan());
    let missing = frame_with("x,y,z\n1,2,3\n", &columns("charge"));
    let message = missing.expect_err("no such column").message;
    assert_eq!(message, "no column is named `charge`; there are x, y, z");
}

#[test]
fn radii_come_from_the_requested_source() {
    let text = "x,y,z,radius,element,size\n0,0,0,1,C,7\n1,0,0,2,O,8\n";
    let radii = |radii: &str, radius_scale| {
        let radii = radii.parse().expect("radii");
        let options = ReadOptions { radii, radius_scale, ..ReadOptions::default() };
        read_with(text, &options).expect("particles").spheres.radius
    };
    assert_eq!(radii("vdw", 1.0), [1.77, 1.5]);
    assert_eq!(radii("covalent", 2.0), [1.52, 1.32]);
    assert_eq!(radii("0.5", 1.0), [0.5, 0.5]);
    assert_eq!(radii("column:size", 0.5), [3.5, 4.0]);
    let options = ReadOptions { radii: Radii::VanDerWaals, ..ReadOptions::default() };
    let none = read_with("1 2 3\n", &options).expect_err("no elements");
    assert!(none.message.contains("no particle has an element"));
}

#[test]
fn types_have_colors_that_differ() {
    let read = particles("x,y,z,type\n0,0,0,1\n1,0,0,2\n0,1,0,1\n");
    let color = &read.spheres.color;
    assert!(color[0] == color[2] && color[0] != color[1]);
    assert!(particles("x,y,z,type\n0,0,0,1\n1,0,0,1\n").spheres.color.is_empty());
}

#[test]
fn other_file_formats_are_named() {
    let mut tar = vec![0; 1024];
    tar[257..262].copy_from_slice(b"ustar");
    for (content, message) in [
        (&tar[..], "is a tar archive"),
        (b"<!DOCTYPE html>\n<title>404</title>", "is a web page (HTML)"),
        (b"\n<html>", "is a web page (HTML)"),
        (b"{\"x\": 1}", "is a JSON file"),
        (b"version https://git-lfs.github.com/spec/v1\noid", "is a pointer to a file"),
    ] {
        assert!(fault(content).2.contains(message), "{message}");
    }
}

#[test]
fn the_first_present_value_decides_the_type_of_a_column() {
    let content = "x,y,z,q,name,none\n0,0,0,,.,\n1,0,0,?,?,\n2,0,0,2.5,A,.\n3,0,0,,.,\n";
    let frame = frame_with(content, &columns("q,name,none")).expect("a frame");
    let [q] = frame.numbers.as_slice() else { panic!("one of numbers: {:?}", frame.numbers) };
    assert!(q.name == "q" && q.values[0].is_nan() && q.values[1].is_nan() && q.values[3].is_nan());
    assert_eq!(q.values[2], 2.5);
    let [name, none] = frame.texts.as_slice() else { panic!("two of texts: {:?}", frame.texts) };
    let texts = |column: &TextColumn| -> Vec<String> {
        (0..4).map(|row| column.names[column.codes.code(row) as usize].clone()).collect()
    };
    assert_eq!(texts(name), [".", "?", "A", "."]);
    assert_eq!(texts(none), ["", "", ".", ""]);
}

#[test]
fn headers_of_plain_rows_name_their_columns() {
    for content in [
        "# x y z radius v\n1 2 3 4 5\n6 7 8 9 10\n",
        "# made by hand\n# x,y,z,radius,v\n1,2,3,4,5\n6,7,8,9,10\n",
        "#x y z radius v\n# in arbitrary units\n1 2 3 4 5\n6 7 8 9 10\n",
        "x y z radius v\n1 2 3 4 5\n6 7 8 9 10\n",
        "# x (nm) y (nm) z (nm) radius (nm) v (m/s)\n1 2 3 4 5\n6 7 8 9 10\n",
        "x [nm];y [nm];z [nm];radius [nm];v\n1;2;3;4;5\n6;7;8;9;10\n",
        "# v\n# radius z y x v\n4 3 2 1 5\n9 8 7 6 10\n",
        "% x y z radius v\n1 2 3 4 5\n6 7 8 9 10\n",
    ] {
        let frame = frame_with(content, &columns("v")).expect("a frame");
        assert_eq!(
            (frame.position(1), &frame.radius[..]),
            (DVec3::new(6.0, 7.0, 8.0), &[4.0, 9.0][..]),
            "{content}"
        );
        assert_eq!(frame.numbers[0].values, [5.0, 10.0], "{content}");
        let expected =
            if content.contains("nm") { LengthUnit::Nanometer } else { LengthUnit::Unknown };
        assert_eq!(frame.unit, expected, "{content}");
    }
    let elements = frame("element x y z\nC 1 2 3\nO 4 5 6\n");
    assert_eq!((kinds(&elements)[1], elements.x[1]), (("O", "O"), 4.0));
    // Names that are not positions do not matter.
    assert_eq!(frame("# a b c d\n1 2 3 4\n").radius, [4.0]);
    let chosen = frame_with("# a b c d\n1 2 3 4\n", &columns("x=c,y=b,z=a")).expect("a frame");
    assert_eq!(chosen.x, [3.0]);
    let numbered = frame_with("# a b c d\n1 2 3 4\n", &columns("x=4,y=2,z=1")).expect("a frame");
    assert_eq!(numbered.x, [4.0]);
    let unused = particles("# x y z radius charge\n1 2 3 4 5\n");
    assert!(
        unused.frame.warnings[0].ends_with("columns that are not used: charge"),
        "{:?}",
        unused.frame.warnings
    );
}

#[test]
fn unknown_columns_are_reported_with_options_to_type() {
    for (content, words) in [
        ("px,py,pz\n1,2,3\n", "--columns x=px,y=py,z=pz"),
        ("px py pz q\n1 2 3 4\n", "--columns x=px,y=py,z=pz"),
        ("# px py pz q v\n1 2 3 4 5\n", "--columns x=px,y=py,z=pz"),
        ("# x y mass\n1 2 3\n", "--columns"),
        ("1 2 3 4 5 6\n", "--columns x=1,y=2,z=3,radius=4"),
        ("1;2,5;3;4;5\n", "--columns x=1"),
        ("! x y z\n1 2 3\n", "--format"),
        ("1\nc\nC 1,5 2 3\n", "sed 's/"),
    ] {
        let error = frame_with(content, &ReadOptions::default()).expect_err(content);
        assert!(error.help.as_ref().is_some_and(|help| help.contains(words)), "{content}: {error}");
    }
}

#[test]
fn lengths_in_several_units_are_converted_or_refused() {
    let near = |found: f64, expected: f64| assert!((found - expected).abs() < 1e-15, "{found}");
    let mixed = frame("x (m),y (m),z (m),diameter (mm)\n1,2,3,4\n");
    near(mixed.radius[0], 0.002);
    let roles: Vec<Role> = mixed.roles.iter().map(|(role, _)| *role).collect();
    assert_eq!(
        (roles, mixed.unit),
        (vec![Role::X, Role::Y, Role::Z, Role::Diameter], LengthUnit::Meter)
    );
    near(frame("x (m),y (m),z (m),radius (um)\n1,2,3,4\n").radius[0], 4e-6);
    assert!(fault("x (m),y (mm),z (m)\n1,2,3\n").2.contains("different units"));
    assert!(fault("x (m),y (m),z (m),radius (px)\n1,2,3,4\n").2.contains("different units"));
    assert!(fault("x (m),x (px),y,z\n1,2,3,4\n").2.contains("no column is named `x`"));
    assert_eq!(frame("x (m),x,y,z\n1,2,3,4\n").x, [2.0]);
}

#[test]
fn commas_may_be_decimal_points() {
    for content in [
        "1,5;2,5;3,5\n4;5;6\n",
        "1,5\t2,5\t3,5\n4\t5\t6\n",
        "1,5 2,5  3,5\n4 5 6\n",
        "# x y z\n1,5 2,5 3,5 # one\n4 5 6\n",
        "x;y;z\n1,5;2,5;3,5\n4;5;6\n",
        "x\ty\tz\n1,5\t\"2,5\"\t3,5\n4\t5\t6\n",
        "x y z\n1,5 2,5 3,5\n4 5 6\n",
        "sep=;\nx;y;z\n1,5;2,5;3,5\n4;5;6\n",
    ] {
        let frame = frame(content);
        assert_eq!(
            (&frame.x[..], frame.position(0)),
            (&[1.5, 4.0][..], DVec3::new(1.5, 2.5, 3.5)),
            "{content}"
        );
        assert_eq!(frame.warnings, ["commas are read as decimal points"], "{content}");
    }
    for content in ["1, 2, 3\n", "1 ,2 ,3\n", "1,2,3\n", "1,2 3\n", " 1,2,3 \n"] {
        let frame = frame(content);
        assert_eq!(
            (frame.position(0), frame.warnings.len()),
            (DVec3::new(1.0, 2.0, 3.0), 0),
            "{content}"
        );
    }
    let texts = frame_with("x;y;z;name\n1,5;2;3;a,b\n", &columns("name")).expect("a frame");
    assert_eq!(texts.texts[0].text(0), "a,b");
    assert!(fault("x;y;z\n1.234,5;2;3\n").2.contains("is not a number"));
}

#[test]
fn long_preambles_are_skipped() {
    for (rows, format) in
        [("1 2 3 4\n5 6 7 8\n", Format::Xyzr), ("x,y,z,r\n1,2,3,4\n5,6,7,8\n", Format::Csv)]
    {
        for lines in [2_000, 60_000] {
            let content = "# a line of a long preamble of comments\n".repeat(lines) + rows;
            let frame = frame(&content);
            assert_eq!((frame.len(), frame.radius[1], frame.format), (2, 8.0, format), "{lines}");
        }
    }
    let xyz = "# comment\n".repeat(20_000) + "1\nC\nC 1 2 3\n";
    assert_eq!(kinds(&frame(xyz)), [("C", "C")]);
    let (line, ..) = fault("#\n".repeat(20_000) + "1 2 x\n");
    assert_eq!(line, 20_001);
}

#[test]
fn text_in_utf_16_is_read_or_named() {
    let text = "x;y;z;element\n1,5;2;3;O\n4;5;6;C\n";
    let encodings: [fn(u16) -> [u8; 2]; 2] = [u16::to_le_bytes, u16::to_be_bytes];
    for (encode, name) in encodings.into_iter().zip(["UTF-16LE", "UTF-16BE"]) {
        let bytes = |text: &str| -> Vec<u8> { text.encode_utf16().flat_map(encode).collect() };
        let frame = frame(bytes(&format!("\u{FEFF}{text}")));
        assert_eq!((frame.x[0], kinds(&frame)[1]), (1.5, ("C", "C")));
        let unmarked = frame_with(bytes(text), &ReadOptions::default()).expect_err(name);
        assert!(unmarked.message.contains(name), "{unmarked}");
        assert!(
            unmarked.help.is_some_and(|help| help.contains(&format!("iconv -f {name} -t UTF-8")))
        );
    }
}

#[test]
fn files_of_other_formats_come_with_a_command() {
    let tng = [&[0; 40][..], b"GENERAL INFO\0", &[0; 100]].concat();
    let mdcrd = "made up\n".to_owned() + &("   1.000".repeat(10) + "\n").repeat(3);
    for (content, name, command) in [
        (&tng[..], "TNG", "gmx trjconv"),
        (b"TITLE\nwater\nEND\nPOSITION\n", "G96", "gmx editconf"),
        (mdcrd.as_bytes(), "Amber", "MDAnalysis"),
    ] {
        let error = frame_with(content, &ReadOptions::default()).expect_err(name);
        assert!(
            error.message.contains(name) && error.help.is_some_and(|help| help.contains(command))
        );
    }
    // Titles may contain anything, and formats may be asked for.
    assert_eq!(frame("crystal\n1 atoms\n\nAtoms # atomic\n\n1 1 1 2 3\n").x, [1.0]);
    let gro = "CRYSTAL\n 1\n    1MET      N    1   5.202   4.356   3.155\n   9 9 9\n";
    assert_eq!(frame(gro).x, [5.202]);
    let options = ReadOptions { format: Some(Format::Pdb), ..ReadOptions::default() };
    let pqr = "ATOM      1  N   NTR     0      63.889  69.990 133.214  0.1414 1.8240\n";
    assert_eq!(frame_with(pqr, &options).expect("a frame").x, [63.889]);
}

#[test]
fn commas_are_decimal_points_unless_they_separate_columns() {
    let quoted = frame("x;y;z;type\n1,5;2;3;\"a\nb\"\n");
    assert_eq!((quoted.x[0], kinds(&quoted)[0].0), (1.5, "a\nb"));
    assert!(quoted.warnings.iter().any(|warning| warning.contains("decimal points")));
    // Names of types stay unchanged.
    assert_eq!(kinds(&frame("x;y;z;type\n1;2;3;1,5\n"))[0].0, "1,5");
    let error = read_with("x,y,z\n\"1,5\",2,3\n", &ReadOptions::default());
    let error = error.expect_err("a comma that may be either");
    assert_eq!(error.line(), Some(2));
    assert!(error.message.contains("1,5") && error.help.is_some(), "{error}");
}

#[test]
fn faults_behind_quoted_separators_are_where_they_are() {
    let error = read_with("type,x,y,z\n\"a,b\",1, 2x ,3\n", &ReadOptions::default());
    let place = error.expect_err("no number").place.expect("a place");
    assert_eq!((place.line, place.column), (2, 10));
    assert_eq!(&place.source_text[place.span], "2x");
}

#[test]
fn comments_name_columns_by_their_number_and_positions() {
    for (comments, name) in [
        ("# x y z q\n# some other words here\n", "q"),
        ("# x y z a\n# x y z q\n", "q"),
        ("# some other words here\n# x y z q\n", "q"),
        ("# x y z q\n# one word more than columns\n", "q"),
    ] {
        let frame = frame(format!("{comments}1 2 3 4\n5 6 7 8\n"));
        assert!(frame.columns.iter().any(|own| own == name), "{comments}: {:?}", frame.columns);
        assert_eq!(frame.x, [1.0, 5.0]);
    }
    assert_eq!(fault("x y z\nu v w\n1 2 3\n").0, 2);
}

#[test]
fn some_numbers_of_a_row_may_have_decimal_commas() {
    assert_eq!(frame("1,5 2,5 3\n4 5 6\n").x, [1.5, 4.0]);
}

#[test]
fn formats_of_the_content_are_not_overruled() {
    let asked = |format| ReadOptions { format: Some(format), ..ReadOptions::default() };
    let error = frame_with(gsd::example(), &asked(Format::Xyz)).expect_err("GSD");
    assert!(error.message.contains("is gsd, not xyz"), "{error}");
    assert_eq!(frame_with(gsd::example(), &asked(Format::Gsd)).expect("a frame").len(), 2);
    let error = frame_with("1 2 3\n", &asked(Format::Gsd)).expect_err("text");
    assert!(error.message.contains("is not gsd"), "{error}");
}
