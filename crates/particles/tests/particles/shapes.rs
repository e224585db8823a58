//! Tests of ellipsoids in files of several programs: the same two, one of them turned, in each format.

use crate::common::file;
use glam::{DQuat, DVec3};
use spherule_particles::{AlignBy, FrameChoice, ParticleFrame, ReadOptions, read_frame};

fn frame(content: &str) -> ParticleFrame {
    let file = file(content);
    read_frame(&file.path, &ReadOptions::default()).expect("a frame")
}

/// A turn by a right angle about z, and semi-axes of 1, 2 and 4.
fn check(frame: &ParticleFrame, first: usize) {
    let second = 1 - first;
    assert_eq!(frame.shapes.semi_axes, [DVec3::new(0.25, 0.5, 1.0); 2]);
    assert_eq!(frame.radius, [4.0, 4.0]);
    assert_eq!(frame.shapes.orientation_of(first), DQuat::IDENTITY);
    let turned = frame.shapes.orientation_of(second) * DVec3::X;
    assert!(turned.distance(DVec3::Y) < 1e-12, "{turned}");
    assert_eq!(frame.x[second], 7.0);
    assert!(frame.numbers.is_empty());
}

const DUMP: &str =
    "ITEM: TIMESTEP\n0\nITEM: NUMBER OF ATOMS\n2\nITEM: BOX BOUNDS pp pp pp\n0 9\n0 9\n0 9\n";

#[test]
fn dumps_have_diameters_and_quaternions() {
    let columns = "ITEM: ATOMS id x y z shapex shapey shapez quatw quati quatj quatk\n";
    let rows = "2 7 1 1 2 4 8 1 0 0 1\n1 1 1 1 2 4 8 1 0 0 0\n";
    let named = frame(&format!("{DUMP}{columns}{rows}"));
    check(&named, 1);
    assert!(named.warnings.is_empty(), "{:?}", named.warnings);
    let columns = "ITEM: ATOMS id x y z c_shape[1] c_shape[2] c_shape[3] c_orient[1] c_orient[2] c_orient[3] c_orient[4]\n";
    let rows = "1 1 1 1 2 4 8 0 0 0 1\n2 7 1 1 2 4 8 0 0 1 1\n";
    let computed = frame(&format!("{DUMP}{columns}{rows}"));
    check(&computed, 0);
    // What diameters and the order of quaternions are taken for.
    assert_eq!(computed.warnings.len(), 2, "{:?}", computed.warnings);
}

const DATA: &str = "data\n\n2 atoms\n1 atom types\n2 ellipsoids\n\n0 9 xlo xhi\n0 9 ylo yhi\n0 9 zlo zhi\n\n\
                    Atoms # ellipsoid\n\n5 1 1 1.0 1 1 1\n3 1 1 1.0 7 1 1\n\n";

#[test]
fn data_files_have_a_section_of_ellipsoids() {
    let section = "Ellipsoids\n\n3 2 4 8 1 0 0 1\n5 2 4 8 1 0 0 0\n";
    check(&frame(&format!("{DATA}{section}")), 0);
    for (row, place) in [("5 2 4 8 1 0 0", "19"), ("5 2 4 x 1 0 0 0", "19:7")] {
        let file = file(format!(
            "{DATA}Ellipsoids

3 2 4 8 1 0 0 1
{row}
"
        ));
        let error = read_frame(&file.path, &ReadOptions::default()).expect_err(row).to_string();
        assert!(error.contains(&format!("input:{place}")), "{row}: {error}");
    }
}

#[test]
fn spheres_among_ellipsoids_need_neither_shape_nor_orientation() {
    let sections = [
        // All of them are round, or points.
        "Ellipsoids\n\n3 2 2 2 1 0 0 1\n5 2 2 2 1 0 0 0\n",
        "Ellipsoids\n\n3 0 0 0 1 0 0 1\n5 0 0 0 0 0 0 0\n",
    ];
    for section in sections {
        let own = frame(&format!("{DATA}{section}"));
        assert!(own.shapes.is_empty() && own.warnings.is_empty(), "{:?}", own.warnings);
    }
    let one = frame(&format!("{DATA}Ellipsoids\n\n3 2 4 8 1 0 0 1\n"));
    assert!(one.shapes.is_sphere(0) && !one.shapes.is_sphere(1));
    assert_eq!(one.warnings.len(), 1, "{:?}", one.warnings);
    assert!(one.warnings[0].starts_with("1 particle has no shape"), "{:?}", one.warnings);
}

#[test]
fn extended_xyz_has_semi_axes_and_the_real_part_last() {
    let text = "2\nProperties=species:S:1:pos:R:3:aspherical_shape:R:3:orientation:R:4\n\
                X 1 1 1 1 2 4 0 0 0 1\nX 7 1 1 1 2 4 0 0 1 1\n";
    check(&frame(text), 0);
}

#[test]
fn orientations_turn_with_frames_that_are_aligned() {
    let columns = "ITEM: ATOMS id x y z shapex shapey shapez\n";
    let dump = |rows: &str| {
        let dump = DUMP.replace("ATOMS\n2", "ATOMS\n3");
        format!("{dump}{columns}{rows}")
    };
    let first = dump("1 0 0 0 2 4 8\n2 1 0 0 2 4 8\n3 0 2 0 2 4 8\n");
    // A right angle about z later.
    let later = dump("1 5 5 0 2 4 8\n2 5 6 0 2 4 8\n3 3 5 0 2 4 8\n");
    let file = file(format!("{first}{later}"));
    let options = ReadOptions {
        align: Some(AlignBy::all()),
        frame: FrameChoice::Index(1),
        ..ReadOptions::default()
    };
    let frame = read_frame(&file.path, &options).expect("a frame");
    let back = frame.shapes.orientation_of(0) * DVec3::Y;
    assert!(back.distance(DVec3::X) < 1e-9, "{back}");
    // Vectors of columns, which stay as they are, are turned by the same rotation where they are drawn.
    assert!((frame.rotation * DVec3::Y).distance(DVec3::X) < 1e-9);
}
