//! Readers of particle files, compared with other programs. `tools/readers/compare.py --answers` wrote the
//! expected results to files in `tests/data/particles`.

use glam::{DMat3, DVec3};
use serde::Deserialize;
use spherule_render::scene::particles::{
    Cell, Element, FrameChoice, LengthUnit, ParticleFrame, ReadOptions, count_frames, read_frame,
};
use std::collections::BTreeSet;
use std::path::PathBuf;

#[derive(Deserialize)]
struct Answers {
    file: Vec<Answer>,
}

/// Contents that another program reads from a file; lengths are in angstrom if the format has a unit.
#[derive(Deserialize)]
struct Answer {
    name: String,
    format: String,
    frames: Option<u64>,
    count: usize,
    cell: Option<[[f64; 3]; 3]>,
    origin: Option<[f64; 3]>,
    /// The first positions, or all of them if their order is not defined.
    first: Vec<[f64; 3]>,
    #[serde(default)]
    last: Vec<[f64; 3]>,
    /// The first positions of the last frame, and its cell.
    #[serde(default)]
    last_frame: Vec<[f64; 3]>,
    last_cell: Option<[[f64; 3]; 3]>,
    #[serde(default)]
    radii: Vec<f64>,
    #[serde(default)]
    any_order: bool,
    #[serde(default)]
    elements: Vec<String>,
}

/// Tolerance: expected results have five decimals, files at least three.
const TOLERANCE: f64 = 2e-3;

fn folder() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/data/particles")
}

fn answers() -> Vec<Answer> {
    let text = std::fs::read_to_string(folder().join("answers.toml")).expect("answers");
    toml::from_str::<Answers>(&text).expect("answers").file
}

fn near(one: DVec3, other: DVec3) -> bool {
    (one - other).length() < TOLERANCE
}

#[test]
fn all_files_have_expected_results() {
    let answers: BTreeSet<String> = answers().into_iter().map(|answer| answer.name).collect();
    let files = std::fs::read_dir(folder()).expect("a folder");
    let files = files.map(|file| file.expect("a file").file_name().into_string().expect("a name"));
    let lists = ["answers.toml", "space_groups.csv"];
    let files: BTreeSet<String> = files.filter(|file| !lists.contains(&&file[..])).collect();
    assert_eq!(files, answers);
    assert!(files.len() > 40);
}

#[test]
fn files_are_read_as_other_programs_read_them() {
    for answer in answers() {
        let (name, path) = (&answer.name, folder().join(&answer.name));
        let options = ReadOptions::default();
        let frame = read_frame(&path, &options).unwrap_or_else(|error| panic!("{name}: {error}"));
        let per_angstrom = match frame.unit {
            LengthUnit::Nanometer => 0.1,
            _ => 1.0,
        };
        assert_eq!(frame.format.name(), answer.format, "{name}");
        assert_eq!(frame.len(), answer.count, "{name}");
        if let Some(frames) = answer.frames {
            assert_eq!(count_frames(&path, &options).ok(), Some(frames), "{name}");
        }
        let positions: Vec<DVec3> =
            (0..frame.len()).map(|row| frame.position(row) / per_angstrom).collect();
        let cell = check_cell(&answer, &frame, per_angstrom);
        if !answer.last_frame.is_empty() {
            let options = ReadOptions { frame: FrameChoice::Last, ..options };
            let last =
                read_frame(&path, &options).unwrap_or_else(|error| panic!("{name}: {error}"));
            let rows = 0..answer.last_frame.len();
            let positions: Vec<DVec3> = rows.map(|row| last.position(row) / per_angstrom).collect();
            let (first, cell) = (answer.last_frame.clone(), answer.last_cell);
            let answer = Answer { name: name.clone(), first, last: Vec::new(), cell, ..answer };
            check_rows(&answer, &positions);
            check_cell(&answer, &last, per_angstrom);
            continue;
        }
        if answer.any_order {
            check_set(&answer, &frame, &positions, cell.expect("a crystal's cell"));
        } else {
            check_rows(&answer, &positions);
        }
        // The radius of an ellipsoid is its longest semi-axis, and not half of a diameter beside it.
        let rows = frame.radius.iter().zip(&answer.radii).enumerate();
        for (_, (radius, expected)) in rows.filter(|(row, _)| frame.shapes.is_sphere(*row)) {
            assert!((radius - expected).abs() < 1e-4, "{name}: {radius}");
        }
        assert!(answer.radii.is_empty() || !frame.radius.is_empty(), "{name}");
    }
}

fn check_cell(answer: &Answer, frame: &ParticleFrame, per_angstrom: f64) -> Option<Cell> {
    let name = &answer.name;
    assert_eq!(frame.cell.is_some(), answer.cell.is_some(), "{name}");
    let cell = frame.cell?;
    for (own, expected) in cell.vectors.into_iter().zip(answer.cell?) {
        assert!(near(own / per_angstrom, DVec3::from_array(expected)), "{name}: {cell:?}");
    }
    if let Some(origin) = answer.origin {
        assert!(near(cell.origin, DVec3::from_array(origin)), "{name}: {cell:?}");
    }
    Some(cell)
}

fn check_rows(answer: &Answer, positions: &[DVec3]) {
    let last = &positions[positions.len() - answer.last.len()..];
    for (own, expected) in [(positions, &answer.first), (last, &answer.last)] {
        for (own, expected) in own.iter().zip(expected) {
            assert!(near(*own, DVec3::from_array(*expected)), "{}: {own}", answer.name);
        }
    }
}

/// Asserts that every expected atom exists, up to lattice translations.
fn check_set(answer: &Answer, frame: &ParticleFrame, positions: &[DVec3], cell: Cell) {
    let [a, b, c] = cell.vectors;
    let edges = DMat3::from_cols(a, b, c);
    for (expected, element) in answer.first.iter().zip(&answer.elements) {
        let found = positions.iter().enumerate().filter(|(row, position)| {
            let away = edges.inverse() * (**position - DVec3::from_array(*expected));
            let kind = frame.kinds.kind(*row).expect("a type");
            near(edges * (away - away.round()), DVec3::ZERO)
                && kind.element.map(Element::symbol) == Some(&element[..])
        });
        assert_eq!(found.count(), 1, "{}: {element} at {expected:?}", answer.name);
    }
}
