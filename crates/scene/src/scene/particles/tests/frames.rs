//! Tests of files with one and with several frames, in every format that may have several.

use super::*;

const CELL: &str = "CRYST1   20.000   30.000   40.000  90.00  90.00  90.00 P 1           1\n";

fn atom(x: u32) -> String {
    format!("ATOM      1  N   MET A   1    {:>8}   1.000   2.000\n", format!("{x}.000"))
}

fn gro(x: u32) -> String {
    let row = format!("    1SOL     OW    1   {x}.000   1.624   1.679\n");
    format!("Water\n    1\n{row}   2.00000   3.00000   4.00000\n")
}

fn dump(x: u32) -> String {
    format!(
        "ITEM: TIMESTEP\n0\nITEM: NUMBER OF ATOMS\n1\nITEM: BOX BOUNDS pp pp pp\n0 9\n0 9\n0 9\n\
         ITEM: ATOMS id type x y z\n1 1 {x} 2 3\n"
    )
}

fn mmcif(models: &[u32]) -> String {
    let row = |(at, x): (usize, &u32)| format!("ATOM N N {x}.0 2 3 {}\n", at + 1);
    let names = ["group_PDB", "type_symbol", "label_atom_id", "Cartn_x", "Cartn_y", "Cartn_z"];
    let names = names.map(|name| format!("_atom_site.{name}\n")).concat();
    let rows: String = models.iter().enumerate().map(row).collect();
    format!("data_a\nloop_\n{names}_atom_site.pdbx_PDB_model_num\n{rows}#\n")
}

/// Files with the first x of each of their frames.
fn files() -> Vec<(String, Vec<f64>)> {
    let model = |x: u32| format!("MODEL     {x:>4}\n{}ENDMDL\n", atom(x));
    let unclosed = |x: u32| format!("MODEL     {x:>4}\n{}", atom(x));
    let ended = |x: u32| format!("{}END\n", atom(x));
    let with_cell =
        |x: u32| format!("{}{}", CELL.replace("20.000", &format!("2{x}.000")), model(x));
    let two = vec![1.0, 2.0];
    let three = vec![1.0, 2.0, 3.0];
    vec![
        (format!("{}{}{}END\n", model(1), model(2), model(3)), three.clone()),
        (format!("{}{}{}END\n", unclosed(1), unclosed(2), unclosed(3)), three.clone()),
        (format!("REMARK\n{}{}{}", ended(1), ended(2), ended(3)), three.clone()),
        (format!("{}{}{}", with_cell(1), with_cell(2), with_cell(3)), three),
        (format!("REMARK\nENDMDL\n{}TER\nHETNAM     HOH\n{}END\n\n", atom(1), atom(2)), vec![1.0]),
        (format!("{}END\nCONECT    1    2\nEND\n", atom(1)), vec![1.0]),
        (gro(1) + &gro(2), two.clone()),
        (gro(1) + "\n", vec![1.0]),
        ("1\n\nC 1 0 0\n1\n\nC 2 0 0\n".to_owned(), two.clone()),
        ("1\n\nC 1 0 0\n\n".to_owned(), vec![1.0]),
        (dump(1) + &dump(2), two.clone()),
        (dump(1) + "\n", vec![1.0]),
        (mmcif(&[1, 2]), two),
        (mmcif(&[1]), vec![1.0]),
    ]
}

#[test]
fn frames_are_counted_skipped_and_announced() {
    for (text, xs) in files() {
        in_file(&text, |path| {
            let options = ReadOptions::default();
            let count = count_frames(path, &options).unwrap_or_else(|error| panic!("{error}"));
            assert_eq!(count, xs.len() as u64, "{text}");
            let read: Vec<ParticleFrame> = Frames::open(path, &options)
                .expect("frames")
                .map(|frame| frame.unwrap_or_else(|error| panic!("{error}: {text}")))
                .collect();
            assert_eq!(read.iter().map(|frame| frame.x[0]).collect::<Vec<_>>(), xs, "{text}");
            for (index, frame) in read.iter().enumerate() {
                let skipped_to = read_frame(path, &at_frame(&index.to_string())).expect("a frame");
                assert_eq!((&skipped_to.x, skipped_to.cell), (&frame.x, frame.cell), "{text}");
            }
            let beyond = read_frame(path, &at_frame(&xs.len().to_string()));
            assert!(beyond.is_err_and(|error| error.message.contains("has no frame")), "{text}");
            let first = read_frame(path, &options).expect("a frame");
            let announced = first.warnings.iter().any(|warning| warning.contains("--frame"));
            assert_eq!(announced, xs.len() > 1, "{text}");
            let others = first.warnings.iter().filter(|text| !text.contains("bond")).count();
            assert_eq!(others, usize::from(announced), "{:?}", first.warnings);
        });
    }
    assert_eq!(frame(&files()[4].0).x, [1.0, 2.0]);
    assert_eq!(frame(&files()[0].0).unit, LengthUnit::Angstrom);
}

#[test]
fn binary_frames_are_announced() {
    for (content, count) in [
        (gsd::example(), 2),
        (gsd::one_frame(), 1),
        (numpy::frames_of_one(1), 1),
        (numpy::frames_of_one(3), 3),
    ] {
        assert_eq!(frames(&content).len(), count);
        let warnings = frame(&content).warnings;
        let announced = warnings.iter().any(|warning| warning.contains("--frame"));
        assert_eq!(announced, count > 1, "{warnings:?}");
    }
}

/// Lengths of first edges, frame by frame and by skipping.
fn edges(text: &str) -> Vec<Option<f64>> {
    let edge = |frame: ParticleFrame| frame.cell.map(|cell| cell.vectors[0].x);
    in_file(text, |path| {
        let frames = Frames::open(path, &ReadOptions::default()).expect("frames");
        let read: Vec<_> = frames.map(|frame| edge(frame.expect("a frame"))).collect();
        let skipped = (0..read.len())
            .map(|index| edge(read_frame(path, &at_frame(&index.to_string())).expect("a frame")));
        assert_eq!(skipped.collect::<Vec<_>>(), read, "{text}");
        read
    })
}

#[test]
fn cells_of_pdb_come_before_or_after_their_models() {
    let model = |x: u32| format!("MODEL     {x:>4}\n{}ENDMDL\n", atom(x));
    let cell = |x: u32| CELL.replace("20.000", &format!("2{x}.000"));
    let before = format!("{}{}{}{}", cell(1), model(1), cell(2), model(2));
    assert_eq!(edges(&before), [Some(21.0), Some(22.0)]);
    // As in MDAnalysis, whose file `model_then_cryst.pdb` has them.
    let after = format!("{}{}{}{}END\n", model(1), cell(1), model(2), cell(2));
    assert_eq!(edges(&after), [Some(21.0), Some(22.0)]);
    let once = format!("{}{}{}", cell(1), model(1), model(2));
    assert_eq!(edges(&once), [Some(21.0), Some(21.0)]);
    // Concatenated files: data after `END` belongs to the next.
    let files = format!("{}END\n{}{}END\n", atom(1), cell(2), atom(2));
    assert_eq!(edges(&files), [None, Some(22.0)]);
    let files = format!("{}END\n{}{}END\n", model(1), cell(2), model(2));
    assert_eq!(edges(&files), [None, Some(22.0)]);
}

#[test]
fn invalid_lines_of_gro_are_refused() {
    let options = ReadOptions { format: Some(Format::Gro), ..ReadOptions::default() };
    for box_line in ["2.0 3.0", "2.0 3.0 4.0 1.0", "2.0 3.0 4.0 1 1 1 1 1"] {
        let text = gro(1).replace("   2.00000   3.00000   4.00000", box_line);
        assert_eq!(fault(text), (4, 1, "no box".to_owned()), "{box_line}");
    }
    for (from, to) in [("OW", "\u{d6}W"), ("   1.624   1.679", "       1")] {
        assert!(frame_with(gro(1).replace(from, to), &options).is_err(), "{to}");
    }
    // Data after the last frame is not a frame, unless it is blank.
    in_file(gro(1) + "more\n", |path| {
        let mut frames = Frames::open(path, &options).expect("frames");
        assert!(frames.next().is_some_and(|frame| frame.is_ok()));
        let error = frames.next().expect("a fault").expect_err("a fault");
        assert!(error.cut_off, "{error}");
    });
}

#[test]
fn units_of_lammps_have_lengths() {
    for (style, unit, per_angstrom) in [
        ("real", LengthUnit::Angstrom, 1.0),
        ("metal", LengthUnit::Angstrom, 1.0),
        ("electron", LengthUnit::Bohr, 1.889_726_124_6),
        ("si", LengthUnit::Meter, 1e-10),
        ("cgs", LengthUnit::Centimeter, 1e-8),
        ("micro", LengthUnit::Micrometer, 1e-4),
        ("nano", LengthUnit::Nanometer, 0.1),
        ("lj", LengthUnit::Unknown, 1.0),
    ] {
        let frame = frame(format!("ITEM: UNITS\n{style}\n{}", dump(1)));
        assert_eq!(frame.unit, unit, "{style}");
        assert!((unit.per_angstrom() / per_angstrom - 1.0).abs() < 1e-9, "{style}");
        let name = format!("{unit:?}").to_lowercase();
        assert_eq!(unit.name(), name);
    }
}

#[test]
fn frames_are_counted_up_to_a_number_or_a_fault() {
    let whole = dump(1) + &dump(2) + &dump(3);
    let count = |text: &str, most: u64| {
        in_file(text, |path| FrameCount::of(path, &ReadOptions::default(), most).expect("a count"))
    };
    for (most, expected) in [(0, 0), (2, 2), (3, 3), (9, 3)] {
        let found = count(&whole, most);
        assert_eq!((found.whole, found.rest.is_some()), (expected, false), "{most}");
    }
    let broken = "1\n\nC 1 0 0\n1\n\nC 2 0 0\nmany\n";
    let found = count(broken, 9);
    assert_eq!((found.whole, found.rest.is_some()), (2, true));
    in_file(broken, |path| {
        let mut frames = Frames::open(path, &ReadOptions::default()).expect("frames");
        assert!(matches!(frames.skip_frame(), Ok(true)) && matches!(frames.skip_frame(), Ok(true)));
        assert!(frames.skip_frame().is_err());
        // After an error there is nothing more.
        assert!(matches!(frames.skip_frame(), Ok(false)) && frames.next().is_none());
    });
}

#[test]
fn progress_is_a_fraction_of_the_file() {
    let options = ReadOptions::default();
    assert_eq!(options.progress.fraction(), None);
    frame_with(dump(1), &options).expect("a frame");
    assert_eq!(options.progress.fraction(), Some(1.0));
}

/// A frame of a lattice of points without an element, 5 in each direction, `spacing` apart along z.
fn lattice(spacing: f64, names: [&str; 2]) -> String {
    let rows = (0..125).map(|i| {
        let (x, y, z) = (i / 25, i / 5 % 5, f64::from(i % 5) * spacing);
        format!("{} {x} {y} {z}\n", names[usize::from(i % 2 == 1)])
    });
    format!("125\nLattice=\"9 0 0 0 9 0 0 0 40\"\n{}", rows.collect::<String>())
}

#[test]
fn guesses_are_those_of_the_first_frame_that_has_particles() {
    let empty = "0\n\n".to_owned();
    // The second frame is a single layer, and has its names in another order.
    let text = empty
        + &lattice(1.0, ["Xa", "Xb"])
        + &lattice(0.0, ["Xb", "Xa"])
        + &lattice(8.0, ["Xa", "Xb"]);
    let options = |frame: &str| ReadOptions { allow_empty: true, ..at_frame(frame) };
    let of = |frame: &str| read_with(&text, &options(frame)).expect("a frame");
    let first = of("1");
    let radius = first.guessed_radius.expect("a guess");
    for frame in ["1", "2", "3", "last"] {
        let particles = of(frame);
        assert_eq!(particles.spheres.radius, vec![radius; 125], "{frame}");
        let film = particles.first_frame.expect("the first frame");
        assert_eq!((film.spheres, film.guessed_radius), (125, Some(radius)));
        assert_eq!(film.orientation, Orientation::of(&first), "{frame}");
        let names = particles.frame.kinds.table.iter().map(|kind| kind.name.as_str());
        assert_eq!(names.collect::<Vec<_>>(), ["Xa", "Xb"], "{frame}");
    }
    assert_eq!(Orientation::of(&of("2")).reason, UpReason::Layer);
    // A single frame has guesses of its own.
    let alone = particles(lattice(8.0, ["Xa", "Xb"]));
    assert!(alone.first_frame.is_none() && alone.guessed_radius > Some(radius));
    // A first frame that cannot be read is that of others.
    let broken = text.replacen("Xa 0 0 0", "Xa zero 0 0", 1);
    assert!(read_with(&broken, &options("1")).is_err());
    assert_eq!(read_with(&broken, &options("2")).expect("a frame").spheres.len(), 125);
}

#[test]
fn readers_of_trajectories_remember_the_first_frame() {
    let text = lattice(1.0, ["Xa", "Xb"]) + &lattice(3.0, ["Xa", "Xb"]);
    in_file(&text, |path| {
        let mut reader = TrajectoryReader::default();
        let mut at = |frame: &str| reader.read(path, &at_frame(frame), None).expect("a frame");
        let last = at("1");
        assert_eq!(last.guessed_radius, at("0").guessed_radius);
        assert_eq!(last.first_frame, at("1").first_frame);
        let (_, first) =
            TrajectoryReader::default().read_frame(path, &at_frame("0")).expect("a frame");
        assert_eq!(first, last.first_frame);
    });
}

#[test]
fn elements_of_types_may_be_given() {
    let oxygen = Element::from_symbol("O").expect("an element");
    let elements = vec![("A".to_owned(), oxygen)];
    let options = ReadOptions { elements, ..ReadOptions::default() };
    let particles = read_with("2\n\nA 0 0 0\nB 5 0 0\n", &options).expect("particles");
    assert_eq!(kinds(&ParticleFrame { x: vec![0.0; 2], ..particles.frame.clone() })[0].1, "O");
    assert_eq!(particles.spheres.radius[0], oxygen.van_der_waals_radius().expect("a radius"));
}
