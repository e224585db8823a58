//! Tests of texts as programs and people write them: missing values, names of columns, line ends, numbers.

use crate::common::file;
use spherule_particles::{Columns, Element, Format, ParticleFrame, ReadOptions, read_frame};

fn all_columns() -> ReadOptions {
    ReadOptions {
        columns: Columns { rest: Some(1000), ..Columns::default() },
        ..ReadOptions::default()
    }
}

fn frame(content: &str) -> ParticleFrame {
    let file = file(content);
    read_frame(&file.path, &all_columns()).unwrap_or_else(|error| panic!("{error}: {content}"))
}

/// The values of a column; missing ones are -1.
fn column(frame: &ParticleFrame, name: &str) -> Vec<f64> {
    let column = frame.numbers.iter().find(|column| column.name == name);
    let values = &column.unwrap_or_else(|| panic!("no column {name}")).values;
    values.iter().map(|&value| if value.is_nan() { -1.0 } else { value }).collect()
}

#[test]
fn words_for_missing_values_are_no_texts() {
    for word in ["NA", "N/A", "n/a", "nan", "NaN", "null", "NULL", "None", "", ".", "?"] {
        let table = frame(&format!(
            "x,y,z,radius,q,s\n0,0,0,.5,{word},{word}\n1,1,1,.5,2.5,text\n2,2,2,.5,{word},b\n"
        ));
        assert_eq!(column(&table, "q"), [-1.0, 2.5, -1.0], "{word}");
        assert_eq!((table.texts[0].text(0), table.texts[0].text(1)), (word, "text"));
    }
    // A column without values is one of numbers if they are not a number.
    let table = frame("x,y,z,q,s\n0,0,0,nan,NA\n");
    assert_eq!((column(&table, "q"), table.texts[0].text(0)), (vec![-1.0], "NA"));
}

#[test]
fn missing_positions_and_radii_are_not_numbers() {
    for missing in ["NA", "null", "None", "nan"] {
        let table = frame(&format!("x,y,z,radius\n{missing},0,0,.5\n1,1,1,{missing}\n2,2,2,.5\n"));
        assert!(table.x[0].is_nan() && table.radius[1].is_nan(), "{missing}");
        assert_eq!((table.x[2], table.radius[2]), (2.0, 0.5));
    }
    assert!(frame("x,y,z,radius\n0,0,0,\n").radius[0].is_nan());
    let table = frame("1.5 2 3 .5\n4 5 6 NA\n");
    assert!(table.radius[1].is_nan() && table.format == Format::Xyzr);
    let file = file("x,y,z\n0,0,0\nn.d.,0,0\n");
    let error = read_frame(&file.path, &all_columns()).expect_err("a text");
    assert_eq!(error.message, "`n.d.` is not a number");
    let file = self::file("x,y,z\n0,,0\n");
    assert!(read_frame(&file.path, &all_columns()).is_err());
}

#[test]
fn coordinates_have_names_of_many_programs() {
    for names in [
        "Points_0,Points_1,Points_2",
        "Points:0,Points:1,Points:2",
        "x_coord,y_coord,z_coord",
        "pos_x,pos_y,pos_z",
        "Position.X,Position.Y,Position.Z",
        "coordinates_0,coordinates_1,coordinates_2",
        "X [m],Y [m],Z [m]",
        "\"Center X [mm]\",\"Center Y [mm]\",\"Center Z [mm]\"",
        "X Coordinate,Y Coordinate,Z Coordinate",
        "posX,posY,posZ",
        "coord_1,coord_2,coord_3",
        "pos1,pos2,pos3",
    ] {
        for table in [
            format!("{names},q\n1,2,3,7\n"),
            format!(",{names},q\n0,1,2,3,7\n"),
            format!("q,{names}\n7,1,2,3\n"),
        ] {
            let table = frame(&table);
            assert_eq!((table.x[0], table.y[0], table.z[0]), (1.0, 2.0, 3.0), "{names}");
            assert_eq!(column(&table, "q"), [7.0], "{names}");
        }
    }
    // Numbers from 0 come before those from 1, of which two look like others.
    let table = frame("pos_0,pos_1,pos_2,pos_3\n1,2,3,4\n");
    assert_eq!((table.x[0], table.y[0], table.z[0]), (1.0, 2.0, 3.0));
    // Plain names come first.
    assert_eq!(frame("center_x,center_y,center_z,x,y,z\n1,2,3,4,5,6\n").x, [4.0]);
    let typed =
        ReadOptions { columns: "x_coord".parse().expect("columns"), ..ReadOptions::default() };
    assert!(read_frame(&file("x_coord,y_coord,z_coord\n1,2,3\n").path, &typed).is_ok());
}

#[test]
fn rows_may_have_one_column_more_than_the_header() {
    // As R, and the texts of tables of pandas, have them.
    for content in [
        "x,y,z,q\n1,0.5,1,2,7\n2,1.5,2,3,8\n",
        "\"x\" \"y\" \"z\" \"q\"\n\"a\" 0.5 1 2 7\n\"b\" 1.5 2 3 8\n",
        "   x  y  z  q\n0  0.5  1  2  7\n1  1.5  2  3  8\n",
        "x\ty\tz\tq\nfirst\t0.5\t1\t2\t7\nlast\t1.5\t2\t3\t8\n",
    ] {
        let table = frame(content);
        assert_eq!((&table.x[..], &table.y[..]), (&[0.5, 1.5][..], &[1.0, 2.0][..]), "{content}");
        assert_eq!(column(&table, "q"), [7.0, 8.0]);
        assert_eq!(table.warnings.len(), 1, "{:?}", table.warnings);
        assert!(table.warnings[0].starts_with("the first column has no name"));
    }
    // What may be a position is not taken for a number of the row.
    for content in [
        "x,y,z\n0.1,0.5,1,2\n0.2,1.5,2,3\n",
        "x y z\n1 2 3 4\n2 3 4 5\n",
        "x,y,z\n1,0.5,1,2\n1,1,2,3\n",
    ] {
        assert!(read_frame(&file(content).path, &all_columns()).is_err(), "{content}");
    }
}

#[test]
fn lines_end_with_any_line_end() {
    let pdb = "USER  MOD made up\n\
        ATOM      1  N   ALA A   1       0.000   0.000   0.000  1.00  0.00           N\n\
        ATOM      2  CA  ALA A   1       1.500   0.000   0.000  1.00  0.00           C\nEND\n";
    let texts = [
        pdb,
        "x,y,z,name\n0,0,0,\"a\n\"\n1.5,0,0,b\n",
        "# x y z\n0 0 0\n1.5 0 0\n",
        "2\nmade up\nC 0 0 0\nO 1.5 0 0\n",
        "t\n 2\n   -3HIS      N    1   0.000   0.837   1.095\n   -3HIS     CA    2   1.500   0.896   1.030\n   3.0   3.0   3.0\n",
        " CRYSTAL # made up\n PRIMVEC\n# a comment\n 5 0 0\n 0 5 0 # b\n 0 0 5\n\n PRIMCOORD\n  2 1\n Si 0 0 0 # c d e f\n# g\n O 1.5 0 0\n",
        "ITEM: TIMESTEP\n1\nITEM: NUMBER OF ATOMS\n2\nITEM: BOX BOUNDS pp pp pp\n0 5\n0 5\n0 5\nITEM: ATOMS id typelabel x y z\n1 Na 0 0 0\n2 Cl 1.5 0 0\n",
    ];
    for text in texts {
        let expected = frame(text);
        assert_eq!(expected.x, [0.0, 1.5], "{text}");
        let mut ends = ["\r", "\n", "\r\n"].into_iter().cycle();
        let mixed = text
            .split_inclusive('\n')
            .map(|line| line.replace('\n', ends.next().unwrap_or_default()));
        for other in
            [text.replace('\n', "\r"), text.replace('\n', "\r\n"), mixed.collect::<String>()]
        {
            let found = frame(&other);
            assert_eq!(
                (&found.x, &found.kinds, found.cell),
                (&expected.x, &expected.kinds, expected.cell),
                "{other:?}"
            );
        }
    }
    let compressed = {
        let mut writer = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
        std::io::Write::write_all(&mut writer, pdb.replace('\n', "\r").as_bytes()).expect("bytes");
        writer.finish().expect("bytes")
    };
    let file = file("");
    std::fs::write(&file.path, compressed).expect("a file");
    assert_eq!(read_frame(&file.path, &all_columns()).expect("a frame").x, [0.0, 1.5]);
}

#[test]
fn labels_of_types_are_types() {
    let dump = |names: &str, rows: &str| {
        let frame = frame(&format!(
            "ITEM: TIMESTEP\n1\nITEM: NUMBER OF ATOMS\n2\nITEM: BOX BOUNDS pp pp pp\n0 5\n0 5\n0 5\nITEM: ATOMS {names}\n{rows}"
        ));
        let kinds = &frame.kinds;
        let symbol =
            |row: usize| kinds.kind(row).and_then(|kind| kind.element).map(Element::symbol);
        (
            [0, 1].map(|row| kinds.kind(row).map(|kind| kind.name.clone()).unwrap_or_default()),
            [0, 1].map(symbol),
        )
    };
    let salt = (["Na", "Cl"].map(str::to_owned), [Some("Na"), Some("Cl")]);
    assert_eq!(dump("id typelabel x y z", "1 Na 0 0 0\n2 Cl 1 1 1\n"), salt);
    assert_eq!(dump("id type x y z", "1 Na 0 0 0\n2 Cl 1 1 1\n"), salt);
    assert_eq!(dump("id type typelabel x y z", "1 1 Na 0 0 0\n2 2 Cl 1 1 1\n"), salt);
    assert_eq!(dump("id typelabel x y z", "1 1 0 0 0\n2 2 1 1 1\n").1, [None; 2]);
}

#[test]
fn numbers_have_exponents_of_many_programs() {
    let table = frame("2\n\nC 0 1.5D-3 1.5*^-3\nO 1.2 1.5+003 1.5E2\n");
    assert_eq!((&table.y[..], &table.z[..]), (&[0.0015, 1500.0][..], &[0.0015, 150.0][..]));
}

#[test]
fn lattices_without_quotes_are_refused_with_the_mend() {
    let file =
        file("1\nLattice=[[5,0,0],[0,5,0],[0,0,5]] Properties=species:S:1:pos:R:3\nSi 0 0 0\n");
    let error = read_frame(&file.path, &ReadOptions::default()).expect_err("nested lists");
    assert!(error.help.is_some_and(|help| help.contains("Lattice=\"5 0 0 0 5 0 0 0 5\"")));
    let file = self::file("1\nLattice=\"[[5,0,0],[0,5,0],[0,0,5]]\"\nSi 0 0 0\n");
    let frame = read_frame(&file.path, &ReadOptions::default()).expect("a frame");
    assert_eq!(frame.cell.map(|cell| cell.vectors[2].z), Some(5.0));
}

#[test]
fn columns_of_gro_files_may_touch() {
    let frame = frame("full\n1\n    1SOL     OW    1-123.456-789.012-345.678\n   10 10 10\n");
    let place = frame.position(0);
    for (found, expected) in [(place.y, 789.012), (place.z, 345.678)] {
        assert!((found / place.x - expected / 123.456).abs() < 1e-9, "{place:?}");
    }
    assert!(place.max_element() < 0.0, "{place:?}");
}
