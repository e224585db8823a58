//! Tests of columns that follow from bonds, of whole molecules and of smoothed trajectories.

use crate::common::file;
use spherule_particles::{Columns, Frames, ParticleFrame, ReadOptions, Trails, read_frame};

fn wanted(names: &[&str]) -> ReadOptions {
    let wanted = names.iter().map(|&name| name.to_owned()).collect();
    ReadOptions { columns: Columns { wanted, ..Columns::default() }, ..ReadOptions::default() }
}

fn column<'f>(frame: &'f ParticleFrame, name: &str) -> &'f [f64] {
    let column = frame.numbers.iter().find(|column| column.name == name);
    &column.unwrap_or_else(|| panic!("no column {name}")).values
}

const WATERS: &str =
    "7\n\nO 0 0 0\nH 0.96 0 0\nAr 0 9 0\nH -0.24 0.93 0\nH 5 0 0\nO 5 0.96 0\nH 5 1.9 0\n";

#[test]
fn coordination_and_clusters_follow_from_bonds() {
    let waters = file(WATERS);
    let names = ["coordination", "Cluster", "coordination[1.6]", "cluster[5]"];
    let frame = read_frame(&waters.path, &wanted(&names)).expect("a frame");
    assert_eq!(column(&frame, "coordination"), [2.0, 1.0, 0.0, 1.0, 1.0, 2.0, 1.0]);
    assert_eq!(column(&frame, "Cluster"), [1.0, 1.0, 3.0, 1.0, 2.0, 2.0, 2.0]);
    // The hydrogens of a molecule are 1.52 apart.
    assert_eq!(column(&frame, "coordination[1.6]"), [2.0, 2.0, 0.0, 2.0, 1.0, 2.0, 1.0]);
    assert_eq!(column(&frame, "cluster[5]"), [1.0, 1.0, 2.0, 1.0, 1.0, 1.0, 1.0]);
    // Bonds that were not asked for are not kept.
    assert_eq!(frame.bonds, None);
    let kept = ReadOptions {
        columns: "coordination".parse().expect("columns"),
        bonds: "O-H<0.95".parse().expect("rules"),
        ..ReadOptions::default()
    };
    let frame = read_frame(&waters.path, &kept).expect("a frame");
    assert_eq!(column(&frame, "coordination"), [0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 1.0]);
    assert_eq!(frame.bonds.expect("bonds").len(), 1);
}

#[test]
fn columns_of_the_file_come_first() {
    let table = file("x,y,z,cluster\n0,0,0,7\n1,0,0,8\n");
    let frame = read_frame(&table.path, &wanted(&["cluster"])).expect("a frame");
    assert_eq!(column(&frame, "cluster"), [7.0, 8.0]);
    let error = read_frame(&table.path, &wanted(&["coordination"])).expect_err("no bonds");
    assert!(error.message.contains("`coordination[3.2]`"), "{error}");
    let within = read_frame(&table.path, &wanted(&["coordination[1.5]"])).expect("a frame");
    assert_eq!(column(&within, "coordination[1.5]"), [1.0, 1.0]);
}

const SPLIT: &str = "3\nLattice=\"10 0 0 0 10 0 0 0 10\" Properties=species:S:1:pos:R:3\n\
    O 9.8 5 5\nH 0.76 5 5\nH 9.56 5.93 5\n";

#[test]
fn molecules_are_made_whole() {
    let split = file(SPLIT);
    let options = ReadOptions { whole: true, ..ReadOptions::default() };
    let frame = read_frame(&split.path, &options).expect("a frame");
    assert!((frame.x[1] - 10.76).abs() < 1e-12 && frame.x[0] == 9.8, "{:?}", frame.x);
    assert_eq!(frame.bonds, None);
    let points = file("0 0 0\n1 0 0\n");
    let error = read_frame(&points.path, &options).expect_err("no bonds");
    assert!(error.message.contains("molecules could be made whole"), "{error}");
}

/// Frames of one particle that crosses the cell by 0.5 in each, with ids in changing order beside a second.
fn dump(frames: usize) -> String {
    let frame = |step: usize| {
        let x = (9.0 + 0.5 * step as f64).rem_euclid(10.0);
        let rows = [format!("1 1 {x} 5 5\n"), "2 1 3 3 3\n".to_owned()];
        let rows = if step.is_multiple_of(2) { rows.concat() } else { rows[1].clone() + &rows[0] };
        format!(
            "ITEM: TIMESTEP\n{step}\nITEM: NUMBER OF ATOMS\n2\nITEM: BOX BOUNDS pp pp pp\n0 10\n0 10\n0 10\n\
             ITEM: ATOMS id type x y z\n{rows}"
        )
    };
    (0..frames).map(frame).collect()
}

#[test]
fn positions_are_averaged_over_frames() {
    let moving = file(dump(6));
    let smooth = |half: u32, frame: &str| {
        let frame = frame.parse().expect("a frame");
        ReadOptions { smooth: half, frame, ..ReadOptions::default() }
    };
    let x = |half: u32, frame: &str| {
        let frame = read_frame(&moving.path, &smooth(half, frame)).expect("a frame");
        assert_eq!((frame.x[1], frame.y[1]), (3.0, 3.0));
        frame.x[0]
    };
    // In the middle, the mean of an even motion is the motion; at the ends, fewer frames are averaged.
    let expected = [(0, 9.25), (1, 9.5), (2, 0.0), (3, 0.5), (4, 1.0), (5, 1.25)];
    for (frame, expected) in expected {
        assert!((x(1, &frame.to_string()) - expected).abs() < 1e-12, "{frame}");
    }
    assert!((x(2, "last") - 1.0).abs() < 1e-12);
    let mut frames = Frames::open(&moving.path, &smooth(1, "0")).expect("frames");
    assert!(frames.skip_frame().expect("a frame") && frames.skip_frame().expect("a frame"));
    let rest: Vec<f64> = frames.map(|frame| frame.expect("a frame").x[0]).collect();
    assert_eq!(rest.len(), 4);
    assert!((rest[0] - 0.0).abs() < 1e-12 && (rest[3] - 1.25).abs() < 1e-12, "{rest:?}");
}

#[test]
fn frames_before_a_fault_are_returned() {
    let cut = dump(3) + "ITEM: TIMESTEP\n3\nITEM: NUMBER OF ATOMS\n2\n";
    let cut = file(&cut);
    let options = ReadOptions { smooth: 2, ..ReadOptions::default() };
    let frames: Vec<bool> =
        Frames::open(&cut.path, &options).expect("frames").map(|frame| frame.is_ok()).collect();
    assert_eq!(frames, [true, true, true, false]);
    let uneven = file("1\n\nC 0 0 0\n2\n\nC 0 0 0\nC 1 0 0\n");
    let error = read_frame(&uneven.path, &options).expect_err("another number");
    assert!(error.message.contains("one frame has 1 particles, and the next 2"), "{error}");
}

#[test]
fn frames_are_superposed_on_the_first() {
    let water = |places: [[f64; 3]; 3]| {
        let rows = places.map(|[x, y, z]| format!("O {x} {y} {z}\n"));
        format!("3\n\n{}", rows.concat())
    };
    let first = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 2.0, 0.0]];
    // Turned by a quarter about z, and moved.
    let second = [[5.0, 5.0, 1.0], [5.0, 6.0, 1.0], [3.0, 5.0, 1.0]];
    let turning = file(&(water(first) + &water(second)));
    let align = Some(spherule_particles::AlignBy::all());
    let options = |frame: &str, smooth: u32| {
        let frame = frame.parse().expect("a frame");
        ReadOptions { align: align.clone(), frame, smooth, ..ReadOptions::default() }
    };
    for (frame, smooth) in [("0", 0), ("1", 0), ("last", 0)] {
        let frame = read_frame(&turning.path, &options(frame, smooth)).expect("a frame");
        for (row, place) in first.iter().enumerate() {
            let expected = place.map(|value| (value * 1e9).round());
            let own = [frame.x[row], frame.y[row], frame.z[row]].map(|value| (value * 1e9).round());
            assert_eq!(own.map(|value| value + 0.0), expected.map(|value| value + 0.0));
        }
    }
    let all: Vec<ParticleFrame> = Frames::open(&turning.path, &options("0", 0))
        .expect("frames")
        .map(|frame| frame.expect("a frame"))
        .collect();
    assert!((all[1].y[2] - 2.0).abs() < 1e-12 && all[1].z[2].abs() < 1e-12);
    assert!(read_frame(&turning.path, &options("1", 1)).is_ok());
}

#[test]
fn trails_are_the_positions_before_as_nearest_images() {
    let moving = file(dump(6));
    let of = |trail: u32, smooth: u32, frame: &str| {
        let frame = frame.parse().expect("a frame");
        let options = ReadOptions { trail, smooth, frame, ..ReadOptions::default() };
        read_frame(&moving.path, &options).expect("a frame")
    };
    let along_x = |frame: &ParticleFrame, row: usize| -> Vec<f64> {
        frame.trails.of(row).map(|step| (step.x * 1e9).round() / 1e9 + 0.0).collect()
    };
    // The first particle moves by half, over the side of the cell; rows change places from frame to frame.
    let frame = of(3, 0, "4");
    assert_eq!(along_x(&frame, 0), [-0.5, -1.0, -1.5]);
    assert_eq!(along_x(&frame, 1), [0.0; 3]);
    assert!(frame.trails.of(0).all(|step| step.y == 0.0 && step.z == 0.0));
    // No further back than to the first frame, and without a trail in it.
    assert_eq!(along_x(&of(9, 0, "2"), 0), [-0.5, -1.0]);
    assert!(of(9, 0, "0").trails.is_empty() && of(0, 0, "4").trails.is_empty());
    // Of smoothed frames, they are the smoothed positions.
    assert_eq!(along_x(&of(2, 1, "3"), 0), [-0.5, -1.0]);
    // Frames that are passed over count.
    let options = ReadOptions { trail: 2, ..ReadOptions::default() };
    let mut frames = Frames::open(&moving.path, &options).expect("frames");
    assert!((0..3).all(|_| frames.skip_frame().expect("a frame")));
    let next = frames.next().expect("a frame").expect("a frame");
    assert_eq!(along_x(&next, 0), [-0.5, -1.0]);
    assert_eq!(spherule_particles::count_frames(&moving.path, &options).expect("frames"), 6);
}

#[test]
fn trails_end_where_the_number_of_particles_changes() {
    let growing = file("1\n\nC 0 0 0\n2\n\nC 0 0 0\nC 1 0 0\n2\n\nC 0 0 3\nC 1 0 0\n");
    let options = ReadOptions { trail: 5, ..ReadOptions::default() };
    let frames = Frames::open(&growing.path, &options).expect("frames");
    let steps: Vec<usize> =
        frames.map(|frame| frame.expect("a frame").trails.steps.len()).collect();
    assert_eq!(steps, [0, 0, 1]);
}

#[test]
fn trails_follow_the_rows_of_their_particles() {
    let steps = vec![[vec![1.0, 2.0, 3.0], vec![4.0, 5.0, 6.0], vec![7.0, 8.0, 9.0]]];
    let mut frame = ParticleFrame { trails: Trails { steps }, ..ParticleFrame::default() };
    frame.retain(&[true, false, true]);
    frame.repeat(2);
    frame.trails.scale(2.0);
    let rows: Vec<[f64; 3]> =
        (0..4).flat_map(|row| frame.trails.of(row)).map(|v| v.to_array()).collect();
    assert_eq!(rows, [[2.0, 8.0, 14.0], [6.0, 12.0, 18.0], [2.0, 8.0, 14.0], [6.0, 12.0, 18.0]]);
}
