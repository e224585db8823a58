use super::*;
use crate::scene::Rgb;
use glam::DVec3;
use proptest::prelude::*;

/// Reads a file with this content.
fn read_with(content: impl AsRef<[u8]>, options: &ReadOptions) -> Result<Particles, SceneError> {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("particles");
    std::fs::write(&path, content).expect("a file");
    read(&path, options)
}

fn particles(content: impl AsRef<[u8]>) -> Particles {
    read_with(content, &ReadOptions::default()).unwrap_or_else(|error| panic!("{error}"))
}

/// Line, column and message of what is wrong with a content.
fn fault(content: impl AsRef<[u8]>) -> (usize, usize, String) {
    match read_with(content, &ReadOptions::default()) {
        Err(error) => (error.line().unwrap_or(0), error.column().unwrap_or(0), error.message),
        Ok(read) => panic!("this is accepted: {read:?}"),
    }
}

#[test]
fn rows_of_numbers_are_read_whatever_stands_between_them() {
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
        ("x,y,z,r\n1,2,3,4\n1,2,,4\n", (3, 5, "z is ``, not a number")),
        ("x,y,z,r\n\n# c\n1,2,3,four\n", (4, 7, "r is `four`, not a number")),
        ("x,y,z,r\r\n1,2,3\r\n", (2, 1, "3 columns, but the header has 4")),
        ("x,y,z,r\r\n1,2,3,4\r\n\r\n1,\"2\", a ,4\r\n", (4, 8, "z is `a`, not a number")),
        ("x,y,z,r\n1,2,3,4\n\n#\n1,2,3", (5, 1, "3 columns, but the header has 4")),
        ("x,y,red\n1,2,3\n", (1, 1, "no column is named `z`")),
        (
            "x,y,z,red,green,blue\n1,2,3,0.5,255,0\n",
            (2, 11, "a color of 255, but colors are 0 to 1"),
        ),
        ("2\nc\nC 0 0 0\n", (4, 1, "the file ends after 1 of 2 atoms")),
        ("2\n", (2, 1, "the file ends before the comment line")),
        ("1\nc\nC 0 zero 0\n", (3, 5, "`zero` is not a number")),
        ("1\nc\nC 0 0\n", (3, 1, "an atom is `symbol x y z`")),
        (
            "1\nProperties=id:I:1:species:S:1:pos:R:3\n1 C 0 0 0\n",
            (2, 1, "columns in an order that is not read here"),
        ),
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
        (b"\x1F\x8B\x08rest", "is compressed (gzip)"),
        (b"BZh9rest", "is compressed (bzip2)"),
        (b"abc\0def", "zero bytes"),
        (b"BEGIN_SCENE\n", "no format known"),
        (b"1 2 3\n\xFF\xFE", "line 2 is not UTF-8"),
    ];
    for (content, message) in cases {
        assert!(fault(content).2.contains(message), "{message}: {:?}", fault(content));
    }
    let endless = format!("1 2 3\n{}", "1".repeat(100_000));
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
fn rows_that_are_no_spheres_are_dropped_and_counted() {
    let read =
        particles("0 0 0 1\nnan 0 0 1\n0 inf 0 1\n0 0 0 nan\n0 0 0 0\n0 0 0 -1\n1 1 1 1e-320\n");
    assert_eq!(read.spheres.radius, [1.0, 1e-320]);
    let warning = "5 of 7 rows were dropped: 3 not finite, 2 with a radius of 0 or less";
    assert!(read.warnings[0].ends_with(warning), "{:?}", read.warnings);
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
    assert!(read.warnings[0].ends_with("columns that are not used: id"), "{:?}", read.warnings);
}

#[test]
fn quoted_names_may_hold_anything() {
    let read = particles("x,y,z,radius,material\n0,0,0,1,\"a, \"\"b\"\"\"\n");
    assert_eq!(read.material_names, ["a, \"b\""]);
}

#[test]
fn atoms_have_radii_and_colors_of_their_elements() {
    let read = particles("3\nwater and more\r\nO 0 0 0 extra\nh1 1 0 0\nQx 2 0 0\n\n");
    assert_eq!(read.spheres.radius, [1.5, 1.2, 1.7]);
    assert_eq!(read.spheres.color[1], Rgb::ONE);
    assert_eq!(read.warnings.len(), 1);
    assert!(read.warnings[0].ends_with(": Qx"), "{:?}", read.warnings);
    let frames = particles("1\na\nC 0 0 0\n1\nb\nC 1 0 0\n");
    assert_eq!((frames.spheres.len(), frames.warnings.len()), (1, 1));
}

#[test]
fn options_give_radii_and_scale() {
    let options = ReadOptions { radius: Some(0.3), scale: 0.1, ..ReadOptions::default() };
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
    assert!(read.warnings[0].contains("radius = 0.75"), "{:?}", read.warnings);
}

#[test]
fn rows_without_end_are_faults_and_long_names_short_warnings() {
    let (_, _, message) = fault(format!("x,y,z\n1,2,3\n\n1,2,\"{}", "3,4,5\n".repeat(400_000)));
    assert_eq!(message, "a row, from line 3 on, is longer than 1048576 bytes");
    let read = particles(format!("x,y,z,{}\n1,2,3,4\n", "n".repeat(100_000)));
    assert!(read.warnings.iter().all(|warning| warning.len() < 1000));
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
