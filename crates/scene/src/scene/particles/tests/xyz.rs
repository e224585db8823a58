//! Tests of XYZ and extended XYZ.

use super::*;

#[test]
fn properties_name_columns() {
    let text = "2\nLattice=\"2 0 0 0.5 3 0 0 0 4\" Origin=\"-1 0 0\" pbc=\"T F T\" Time=1.5 \
                Properties=id:I:1:species:S:1:pos:R:3:radius:R:1:color:R:3:q:R:1:ok:L:1 Step=7\n\
                1 Fe 0.5 1 2 .25 1 0.5 0 -1 T\n2 C 1 2 3 .5 0 0 1 2 F\n";
    let frame = frame_with(text, &columns("q,ok")).expect("a frame");
    assert_eq!((frame.position(0), frame.radius[1]), (DVec3::new(0.5, 1.0, 2.0), 0.5));
    assert_eq!(kinds(&frame), [("Fe", "Fe"), ("C", "C")]);
    assert_eq!(frame.color[0].to_array(), [1.0, 0.5, 0.0]);
    assert_eq!((frame.numbers[0].values[0], frame.texts[0].text(1)), (-1.0, "F"));
    assert_eq!((frame.step, frame.time), (Some(7), Some(1.5)));
    let cell = frame.cell.expect("a cell");
    assert_eq!((cell.origin, cell.periodic), (DVec3::NEG_X, [true, false, true]));
    assert_eq!(cell.vectors[1], DVec3::new(0.5, 3.0, 0.0));
    assert_eq!(frame.unit, LengthUnit::Angstrom);
}

#[test]
fn plain_files_have_symbols_numbers_or_neither() {
    assert_eq!(kinds(&frame("2\n\nC 1 2 3 4 5\n8 1 2 3\n")), [("C", "C"), ("8", "O")]);
    assert_eq!(frame("2\r\n\r\n1 2 3\r\n4 5 6").x, [1.0, 4.0]);
    let lammps = frame("2\nAtoms. Timestep: 500\n1 0 0 0\n6 1 1 1\n");
    assert_eq!(kinds(&lammps), [("1", "-"), ("6", "-")]);
    assert_eq!(lammps.step, Some(500));
    let water = particles("4\nTIP4P\nO 0 0 0\nH 1 0 0\nH 0 1 0\nM 0 0 .1\n");
    assert_eq!(water.spheres.len(), 3);
    assert!(
        water.frame.warnings[0].contains("1 sites without an atom"),
        "{:?}",
        water.frame.warnings
    );
}

#[test]
fn frames_are_chosen_by_number() {
    let text = "1\na\nC 1 0 0\n2\nb\nC 2 0 0\nC 3 0 0\n1\nc\nC 4 0 0\n\n";
    assert_eq!(frames(text), [vec![1.0], vec![2.0, 3.0], vec![4.0]]);
    for (choice, x) in [("first", 1.0), ("1", 2.0), ("2", 4.0), ("last", 4.0)] {
        assert_eq!(frame_with(text, &at_frame(choice)).expect("a frame").x[0], x, "{choice}");
    }
    let missing = frame_with(text, &at_frame("3")).expect_err("three frames");
    assert_eq!(missing.message, "has no frame 3, only 3 (the first is 0)");
    let count = |text: &str| in_file(text, |path| count_frames(path, &ReadOptions::default()));
    assert_eq!(count(text).expect("a count"), 3);
    // Of a file whose last frame is cut off, the last complete frame is read.
    let cut = &text[..text.len() - 12];
    assert_eq!(count(cut).expect("a count"), 2);
    assert_eq!(frame_with(cut, &at_frame("last")).expect("a frame").x, [2.0, 3.0]);
}

#[test]
fn lattices_without_volume_are_ignored() {
    assert_eq!(frame("1\nLattice=\"0 0 0 0 0 0 0 0 0\"\nC 1 2 3\n").cell, None);
    assert_eq!(frame("1\nLattice=\"1 0 0 0 1 0 0 0 nan\"\nC 1 2 3\n").cell, None);
}

#[test]
fn counts_of_columns_that_no_file_has_are_refused() {
    for count in ["10001", "18446744073709551615", "18446744073709551614", "9223372036854775807"] {
        for properties in [format!(":I:1::S:{count}"), format!("pos:R:3:q:R:{count}")] {
            let (line, _, message) = fault(format!("2\nProperties={properties}\n"));
            assert_eq!((line, message.contains("10000 columns")), (2, true), "{message}");
        }
    }
    assert!(fault("2\nProperties=pos:R:18446744073709551616\n").2.contains("invalid Properties"));
}

#[test]
fn scales_reach_positions_radii_and_the_cell() {
    let options = ReadOptions { scale: 2.0, radius_scale: 3.0, ..ReadOptions::default() };
    let lattice = "Lattice=\"2 0 0 0.5 3 0 0 0 4\" Origin=\"1 1 1\"";
    let carbon = format!("1\n{lattice}\nC 1 2 3\n");
    let row = |i: u32| format!("{} {} {}\n", i % 3, i / 3 % 3, i / 9);
    let rows = (0..27).map(row).collect::<Vec<_>>().concat();
    let unnamed = format!("27\n{lattice}\n{rows}");
    // Radii of an element, and radii that are estimated from the distances, to two digits.
    for (text, tolerance) in [(&carbon, 1e-12), (&unnamed, 0.2)] {
        let (plain, scaled) = (particles(text), read_with(text, &options).expect("particles"));
        assert_eq!(scaled.spheres.center(0), plain.spheres.center(0) * 2.0);
        assert!((scaled.spheres.radius[0] / plain.spheres.radius[0] - 6.0).abs() < tolerance);
        let cell = scaled.frame.cell.expect("a cell");
        assert_eq!(cell.origin, DVec3::splat(2.0));
        assert_eq!(cell.vectors[1], DVec3::new(1.0, 6.0, 0.0));
    }
}

#[test]
fn comments_are_titles_and_frames_may_be_empty() {
    assert_eq!(frame("1\nwater at 300 K\nO 0 0 0\n").title, "water at 300 K");
    assert_eq!(frames("0\nnone\n1\none\nC 1 0 0\n"), [vec![], vec![1.0]]);
    assert_eq!(frames("1\none\nC 1 0 0\n0\nnone\n"), [vec![1.0], vec![]]);
}
