//! Tests of additional columns: all columns that a file lists can be read without errors.

use super::*;

/// A file with columns that are missing in some rows, named twice, mixed, or wider than a number.
struct Sample {
    name: &'static str,
    content: &'static [u8],
    /// The columns that it lists, with `_` for a blank.
    listed: &'static str,
    /// The one of them that cannot be kept.
    mixed: &'static str,
}

macro_rules! sample {
    ($name:literal, $listed:literal, $mixed:literal) => {
        Sample {
            name: $name,
            content: include_bytes!(concat!(
                env!("CARGO_MANIFEST_DIR"),
                "/../../tests/data/",
                $name
            )),
            listed: $listed,
            mixed: $mixed,
        }
    };
}

const FILES: [Sample; 7] = [
    // Numbers that are too large for their column are written as asterisks.
    sample!("velocities.gro", "residue_number residue name number x y z vx vy vz", "number"),
    sample!("mixed.csv", "x y z a_name,_quoted label q red green blue material blank", "label"),
    sample!("ragged.xyz", "species x y z 5 6", ""),
    sample!("twice.ply", "x y z q red green blue", ""),
    sample!(
        "arrays.npz",
        "position_x position_y position_z velocity_x velocity_y velocity_z stress_1 stress_2 \
         stress_3 stress_4 stress_5 stress_6 name charge flags frames_x frames_y frames_z",
        ""
    ),
    sample!("structured.npy", "id x y z q tag", ""),
    sample!(
        "chunks.gsd",
        "x y z diameter type mass charge vx vy vz log/particles/energy log/particles/force_x \
         log/particles/force_y log/particles/force_z body image_x image_y image_z orientation_1 \
         orientation_2 orientation_3 orientation_4",
        ""
    ),
];

fn rest(values: usize) -> ReadOptions {
    let columns = Columns { rest: Some(values), ..Columns::default() };
    ReadOptions { columns, ..ReadOptions::default() }
}

#[test]
fn every_listed_column_can_be_kept() {
    for Sample { name, content, listed, mixed } in FILES {
        let expected: Vec<String> =
            listed.split_whitespace().map(|column| column.replace('_', " ")).collect();
        let spaced = |column: &str| column.replace('_', " ");
        let plain = read_with(content, &ReadOptions::default()).expect(name);
        assert_eq!(plain.frame.columns.iter().map(|own| spaced(own)).collect::<Vec<_>>(), expected);
        assert!(plain.frame.numbers.is_empty() && plain.frame.texts.is_empty(), "{name}");
        let all = read_with(content, &rest(1000)).expect(name);
        assert_eq!(
            (&all.frame.columns, &all.frame.roles),
            (&plain.frame.columns, &plain.frame.roles),
            "{name}"
        );
        for column in &all.frame.columns {
            assert_eq!(all.can_color_by(column), column != mixed, "{name}: {column}");
            let asked = Columns { kept: vec![column.clone()], ..Columns::default() };
            let asked = ReadOptions { columns: asked, ..ReadOptions::default() };
            // GRO and XYZ also have columns that are missing in some rows.
            if column != mixed && name != "ragged.xyz" {
                let asked = read_with(content, &asked).expect(column);
                assert!(asked.can_color_by(column), "{name}: {column}");
            }
        }
    }
}

#[test]
fn missing_values_are_nan() {
    let find = |particles: &Particles, name: &str| {
        let column = particles.frame.numbers.iter().find(|column| column.name == name);
        column.expect("a column").values.clone()
    };
    let gro = read_with(FILES[0].content, &rest(1000)).expect("atoms");
    let vx = find(&gro, "vx");
    assert!((vx[0], vx[2]) == (0.1227, -0.9999) && vx[1].is_nan());
    let xyz = read_with(FILES[2].content, &rest(1000)).expect("atoms");
    assert_eq!(find(&xyz, "5"), [-0.8, 0.4, 0.4]);
    assert_eq!((xyz.frame.texts[0].text(0), xyz.frame.texts[0].text(1)), ("first", ""));
    let npz = read_with(FILES[4].content, &rest(1000)).expect("rows");
    assert_eq!(find(&npz, "velocity_y"), [-1.0, -4.0, -7.0, -10.0]);
    assert_eq!(find(&npz, "stress_6")[1], 11.0);
    let gsd = read_with(FILES[6].content, &rest(1000)).expect("particles");
    assert_eq!(find(&gsd, "orientation_2"), [0.0, 0.0, 1.0]);
    assert_eq!(find(&gsd, "log/particles/force_z"), [2.0, 5.0, 8.0]);
}

#[test]
fn a_file_without_velocities_lists_none() {
    let content = FILES[0].content;
    let text = String::from_utf8_lossy(content);
    let short = |line: &str| line.chars().take(44).collect::<String>();
    let text = text.lines().map(|line| short(line) + "\n").collect::<String>();
    let frame = frame_with(&text, &rest(1000)).expect("atoms");
    assert_eq!(frame.columns.last().map(String::as_str), Some("z"));
    assert!(frame.numbers.iter().all(|column| column.name != "vx"));
    let error = frame_with(&text, &columns("vx")).expect_err("no velocities");
    assert!(error.message.starts_with("no column is named `vx`; there are"), "{}", error.message);
}

#[test]
fn unused_columns_of_large_files_are_omitted() {
    for Sample { name, content, .. } in FILES {
        let few = Columns { wanted: vec!["q".to_owned()], ..rest(1).columns };
        let options = ReadOptions { columns: few, ..ReadOptions::default() };
        let particles = read_with(content, &options).expect(name);
        let kept: Vec<&str> =
            particles.frame.numbers.iter().map(|column| column.name.as_str()).collect();
        let has_q = particles.frame.columns.iter().any(|column| column == "q");
        assert_eq!(kept, if has_q { vec!["q"] } else { vec![] }, "{name}");
        assert!(particles.frame.texts.is_empty(), "{name}");
    }
}

#[test]
fn colors_and_materials_are_columns() {
    let content = FILES[1].content;
    let particles = read_with(content, &ReadOptions::default()).expect("rows");
    for name in ["red", "green", "blue", "material"] {
        assert!(particles.can_color_by(name), "{name}");
    }
    let selection = "material == default and blue < 0.5".parse().expect("a condition");
    let style = ParticleStyle { select: Some(selection), ..ParticleStyle::default() };
    let mut some = particles.clone();
    style.apply(Path::new("test"), &mut some).expect("a row");
    assert_eq!((some.spheres.len(), some.spheres.x[0]), (1, 0.0));
}
