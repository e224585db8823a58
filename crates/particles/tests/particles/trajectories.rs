//! Tests of trajectories and their topologies, on files that `tools/readers/trajectories.py` wrote. What
//! other programs read from them is compared in `tests/library/readers.rs`.

use spherule_particles::{
    BondSource, Columns, Element, FileError, Format, FrameChoice, Frames, LengthUnit,
    ParticleFrame, ReadOptions, count_frames, read_frame,
};
use std::path::{Path, PathBuf};

/// Trajectories with the four frames of `water.dcd`.
const SAME: [&str; 15] = [
    "water.dcd",
    "water.xtc",
    "water.trr",
    "water.ncdf",
    "chemfiles.dcd",
    "chemfiles.xtc",
    "chemfiles.trr",
    "big_endian.dcd",
    "wide_markers.dcd",
    "water.h5md",
    "water_latest.h5md",
    "water_links.h5md",
    "water_old_links.h5md",
    "water_mdtraj.h5",
    "water_netcdf4.nc",
];

/// Trajectories with other frames.
const OTHERS: [&str; 4] = ["fixed_atoms.dcd", "no_cell.dcd", "no_cell.ncdf", "six.xtc"];

/// Structures.
const STRUCTURES: [&str; 8] = [
    "water.coor",
    "water.pqr",
    "zns.poscar",
    "zns.xdatcar",
    "zns.axsf",
    "zns.cfg",
    "molecules.sdf",
    "molecules.mol2",
];

fn data(folder: &str, name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/data").join(folder).join(name)
}

fn trajectory(name: &str) -> PathBuf {
    data("particles", name)
}

fn with_topology(name: &str, columns: &str) -> ReadOptions {
    let columns = columns.parse().expect("columns");
    let topology = Some(data("topologies", name));
    ReadOptions { columns, topology, ..ReadOptions::default() }
}

fn at(frame: u64) -> ReadOptions {
    ReadOptions { frame: FrameChoice::Index(frame), ..ReadOptions::default() }
}

fn read(name: &str, options: &ReadOptions) -> ParticleFrame {
    read_frame(&trajectory(name), options).unwrap_or_else(|error| panic!("{error}"))
}

/// The greatest difference of coordinates, in angstrom.
fn difference(one: &ParticleFrame, other: &ParticleFrame) -> f64 {
    let [own, others] = [one, other].map(|frame| frame.unit.per_angstrom());
    let differences = (0..one.len())
        .map(|row| (one.position(row) / own - other.position(row) / others).abs().max_element());
    assert_eq!(one.len(), other.len());
    differences.fold(0.0, f64::max)
}

#[test]
fn all_formats_have_the_same_frames() {
    for name in SAME {
        // XTC has hundredths of an angstrom.
        let tolerance = if name.ends_with("xtc") { 0.006 } else { 1e-5 };
        for index in 0..4 {
            let (own, expected) = (read(name, &at(index)), read("water.dcd", &at(index)));
            let difference = difference(&own, &expected);
            assert!(difference < tolerance, "{name} {index}: {difference}");
            let [own, expected] = [own, expected].map(|frame| {
                let cell = frame.cell.unwrap_or_else(|| panic!("{name}: a cell"));
                cell.vectors.map(|edge| edge / frame.unit.per_angstrom())
            });
            for (own, expected) in own.iter().zip(expected) {
                assert!((*own - expected).length() < 1e-4, "{name}: {own} {expected}");
            }
        }
    }
}

#[test]
fn fixed_atoms_stay_where_they_are_in_the_first_frame() {
    for index in 0..4 {
        let [fixed, all, first] =
            [("fixed_atoms.dcd", index), ("water.dcd", index), ("water.dcd", 0)]
                .map(|(name, index)| read(name, &at(index)));
        for row in 0..all.len() {
            let expected = if row % 3 == 2 { &all } else { &first };
            assert_eq!(fixed.position(row), expected.position(row), "{index} {row}");
        }
        assert_eq!(fixed.cell, all.cell);
    }
}

#[test]
fn frames_are_read_in_any_order() {
    for name in SAME.into_iter().chain(OTHERS) {
        let path = trajectory(name);
        let options = ReadOptions::default();
        let all: Result<Vec<ParticleFrame>, FileError> =
            Frames::open(&path, &options).expect("a trajectory").collect();
        let all = all.unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(count_frames(&path, &options).ok(), Some(all.len() as u64), "{name}");
        for (index, frame) in all.iter().enumerate().rev() {
            let own = read(name, &at(index as u64));
            assert!(own.x == frame.x && own.cell == frame.cell, "{name} {index}");
            assert_eq!((own.step, own.time), (frame.step, frame.time), "{name} {index}");
        }
        let beyond = read_frame(&path, &at(all.len() as u64)).expect_err("no more frames");
        assert!(beyond.message.starts_with("has no frame"), "{name}: {beyond}");
        // A file after its first frame is not decoded where a later frame is asked for.
        let mut skipped = Frames::open(&path, &options).expect("a trajectory");
        assert!(skipped.skip_frame().expect("a frame"), "{name}");
        let second = skipped.next().expect("a second frame").expect("a frame");
        assert_eq!(second.x, all[1].x, "{name}");
    }
}

#[test]
fn steps_and_times_are_those_of_the_file() {
    let times =
        |name: &str| [0, 3].map(|index| (read(name, &at(index)).step, read(name, &at(index)).time));
    assert_eq!(times("water.dcd"), [(Some(100), None), (Some(130), None)]);
    assert_eq!(times("water.xtc"), [(Some(0), Some(0.0)), (Some(3), Some(6.0))]);
    assert_eq!(times("water.trr"), [(Some(0), Some(0.0)), (Some(3), Some(6.0))]);
    assert_eq!(times("water.ncdf"), [(None, Some(0.0)), (None, Some(6.0))]);
    assert_eq!(times("water_netcdf4.nc"), times("water.ncdf"));
    assert_eq!(times("water.h5md"), times("water.trr"));
    assert_eq!(times("water_links.h5md"), times("water.trr"));
    assert_eq!(times("water_old_links.h5md"), times("water.trr"));
    // Steps at a constant distance, from an offset on.
    assert_eq!(times("water_latest.h5md"), [(Some(100), None), (Some(115), None)]);
    let units =
        ["water.dcd", "water.xtc", "water.trr", "water.ncdf"].map(|name| read(name, &at(0)).unit);
    let [angstrom, nanometer] = [LengthUnit::Angstrom, LengthUnit::Nanometer];
    assert_eq!(units, [angstrom, nanometer, nanometer, angstrom]);
}

#[test]
fn topologies_name_particles() {
    for topology in ["water.gro", "water.pdb", "water.pqr", "water.psf", "water.parm7"] {
        for name in SAME {
            let options = with_topology(topology, "resname,resid");
            let frame = read(name, &ReadOptions { frame: FrameChoice::Index(2), ..options });
            let bare = read(name, &at(2));
            assert!(
                frame.x == bare.x && frame.cell == bare.cell && frame.unit == bare.unit,
                "{name}"
            );
            let symbols: Vec<&str> = (0..frame.len())
                .filter_map(|row| frame.kinds.kind(row).and_then(|kind| kind.element))
                .map(Element::symbol)
                .collect();
            assert_eq!(symbols[..4], ["O", "H", "H", "O"], "{name} {topology}");
            assert_eq!((symbols.len(), symbols[183]), (184, "Na"), "{name} {topology}");
            let column = |name: &str| frame.texts.iter().find(|column| column.name == name);
            let residue = column("residue").expect("a column");
            assert_eq!((residue.text(0), residue.text(183)), ("SOL", "NA"));
            assert!(frame.warnings.is_empty(), "{:?}", frame.warnings);
        }
    }
    let bare = read("water.xtc", &at(1));
    assert!(bare.kinds.codes.is_empty());
    assert!(bare.warnings.iter().any(|text| text.contains("--topology")), "{:?}", bare.warnings);
}

#[test]
fn radii_of_topologies_are_in_the_unit_of_the_trajectory() {
    let radii = |name: &str| {
        let radius = read(name, &with_topology("water.pqr", "")).radius;
        [radius[0], radius[1], radius[183]]
    };
    assert_eq!(radii("water.dcd"), [1.768, 0.2, 1.369]);
    for (own, expected) in radii("water.xtc").into_iter().zip([0.1768, 0.02, 0.1369]) {
        assert!((own - expected).abs() < 1e-12, "{own} {expected}");
    }
}

#[test]
fn topologies_without_positions_are_no_particle_files() {
    for (name, segments) in [("water.psf", &["W"][..]), ("water.parm7", &[])] {
        let path = data("topologies", name);
        let error = read_frame(&path, &ReadOptions::default()).expect_err("no positions");
        assert_eq!(error.message, "is a topology, without positions");
        assert!(error.help.is_some_and(|help| help.contains("--topology")));
        let columns = if segments.is_empty() { "mass,charge" } else { "segid,mass,charge" };
        let frame = read("water.dcd", &with_topology(name, columns));
        let value = |name: &str| {
            let column = frame.numbers.iter().find(|column| column.name == name).expect("a column");
            column.values[183]
        };
        assert!((value("charge") - 1.0).abs() < 1e-8, "{name}");
        assert_eq!((value("mass"), frame.numbers.len()), (22.9898, 2), "{name}");
        let texts: Vec<_> = frame.texts.iter().map(|column| column.text(0)).collect();
        assert_eq!(texts, segments, "{name}");
        assert!(frame.position(0).is_finite());
    }
}

#[test]
fn topologies_of_amber_have_the_bonds_of_others() {
    let bonds = |topology: &str| {
        let options = ReadOptions { bonds: BondSource::File, ..with_topology(topology, "") };
        read("water.dcd", &options).bonds.expect("bonds")
    };
    let (own, other) = (bonds("water.parm7"), bonds("water.psf"));
    assert_eq!(own.len(), other.len());
    assert!(own.len() > 100 && own == other);
}

#[test]
fn dangling_bonds_of_topologies_of_amber_are_left_out() {
    let text = std::fs::read_to_string(data("topologies", "water.parm7")).expect("a file");
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("a.parm7");
    // Of atom 201, and between atoms.
    for other in ["       0     600       1", "       0       4       1"] {
        std::fs::write(&path, text.replacen("       0       3       1", other, 1)).expect("a file");
        let topology = Some(path.clone());
        let options = ReadOptions { topology, bonds: BondSource::File, ..ReadOptions::default() };
        let frame = read("water.dcd", &options);
        assert_eq!(frame.bonds.map(|bonds| bonds.len()), Some(119));
        assert!(frame.warnings.iter().any(|text| text.contains("1 bond")), "{:?}", frame.warnings);
    }
}

#[test]
fn elements_of_topologies_of_amber_come_from_numbers_or_names_and_masses() {
    let text = std::fs::read_to_string(data("topologies", "water.parm7")).expect("a file");
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("a.parm7");
    let light = "1.59994000E+01  1.00800000E+00";
    assert!(text.contains(light));
    let repartitioned = "1.29754000E+01  3.02400000E+00";
    for (has_numbers, masses, warnings) in
        [(false, light, 0), (true, repartitioned, 0), (false, repartitioned, 1)]
    {
        let flag = if has_numbers { "%FLAG ATOMIC_NUMBER" } else { "%FLAG OLD" };
        let other = text.replacen("%FLAG ATOMIC_NUMBER", flag, 1).replacen(light, masses, 1);
        std::fs::write(&path, other).expect("a file");
        let options = ReadOptions { topology: Some(path.clone()), ..ReadOptions::default() };
        let frame = read("water.dcd", &options);
        let symbols: Vec<&str> = types(&frame).into_iter().map(|(_, symbol)| symbol).collect();
        assert_eq!(symbols, ["O", "H", "H", "O"], "{flag}");
        // Another is of the frames that are not read.
        let named = frame.warnings.iter().filter(|text| text.contains("3.024")).count();
        assert_eq!(named, warnings, "{:?}", frame.warnings);
    }
}

#[test]
fn damaged_topologies_and_restart_files_are_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let fault = |source: PathBuf, from: &str, to: &str| {
        let text = std::fs::read_to_string(source).expect("a file");
        assert!(text.contains(from), "{from}");
        let path = folder.path().join("damaged");
        std::fs::write(&path, text.replacen(from, to, 1)).expect("a file");
        path
    };
    for (from, to, expected) in [
        ("%FLAG POINTERS", "%FLAG POINTS", "POINTERS"),
        ("     184       1", "     185       1", "185 atoms"),
        ("%FORMAT(20a4)\nOW", "%FORMAT(20)\nOW", "format"),
    ] {
        let topology = Some(fault(data("topologies", "water.parm7"), from, to));
        let options = ReadOptions { topology, bonds: BondSource::File, ..ReadOptions::default() };
        let error = read_frame(&trajectory("water.dcd"), &options).expect_err(from);
        assert!(error.to_string().contains(expected), "{from}: {error}");
    }
    for (from, to, expected) in [
        ("   12", "   11", "neither velocities nor a box"),
        ("   12", "  112", "of 112 atoms"),
        ("   9.0000000", "   9.000x000", "not a number"),
    ] {
        let path = fault(trajectory("water.rst7"), from, to);
        let options = ReadOptions { format: Some(Format::Restart), ..ReadOptions::default() };
        let error = read_frame(&path, &options).expect_err(from);
        assert!(error.to_string().contains(expected), "{from}: {error}");
    }
}

#[test]
fn restart_files_and_trajectories_of_ase_have_velocities() {
    let columns = |columns: &str| ReadOptions {
        columns: columns.parse().expect("columns"),
        ..ReadOptions::default()
    };
    let frame = read("water.rst7", &columns("vx,vy,vz"));
    assert_eq!((frame.title.as_str(), frame.time), ("four molecules", Some(12.5)));
    assert!(frame.numbers.iter().all(|column| (column.values[11] - 0.25).abs() < 1e-5));
    let options = ReadOptions { frame: FrameChoice::Last, ..columns("momenta_x,charges") };
    let frame = read("water.traj", &options);
    assert_eq!(types(&frame), [("O", "O"), ("H", "H"), ("H", "H"), ("O", "O")]);
    // Momenta are masses times velocities.
    let values: Vec<f64> = frame.numbers.iter().map(|column| column.values[0]).collect();
    assert!((values[0] - 0.02 * 15.999).abs() < 1e-9 && values[1] == -1.6, "{values:?}");
    assert_eq!(frame.cell.map(|cell| cell.periodic), Some([true, true, false]));
}

#[test]
fn coordinates_of_namd_need_a_topology_and_are_no_velocities() {
    let frame = read("water.coor", &at(0));
    assert_eq!((frame.len(), frame.unit), (12, LengthUnit::Angstrom));
    assert!((frame.position(11).z - 6.19513).abs() < 1e-4 && frame.cell.is_none());
    assert!(frame.warnings.iter().any(|warning| warning.contains("--topology")));
    let content = std::fs::read(trajectory("water.coor")).expect("a file");
    let folder = tempfile::tempdir().expect("a folder");
    let error = |name: &str, content: &[u8]| {
        let path = folder.path().join(name);
        std::fs::write(&path, content).expect("a file");
        read_frame(&path, &ReadOptions::default()).expect_err("a fault").message
    };
    assert!(error("run.restart.vel", &content).contains("velocities"));
    assert!(error("run.coor", &content[..200]).contains("cut off"));
    let longer = [&content[..], &[0; 8]].concat();
    assert!(error("run.coor", &longer).contains("300 bytes"));
}

#[test]
fn titles_of_dcd_may_be_longer_than_their_record_says() {
    let content = std::fs::read(trajectory("water.dcd")).expect("a file");
    // The record follows the header: its length, its number of lines, these, and its length.
    let (header, rest) = content.split_at(92);
    let length = u32::from_le_bytes(rest[..4].try_into().expect("a length"));
    let after = &rest[8 + length as usize..];
    let claimed = 164_u32.to_le_bytes();
    let title = [&claimed[..], &3_u32.to_le_bytes(), &[0; 240], &claimed].concat();
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("title.dcd");
    std::fs::write(&path, [header, &title, after].concat()).expect("a file");
    let frame = read_frame(&path, &ReadOptions::default()).expect("a frame");
    assert_eq!(difference(&frame, &read("water.dcd", &at(0))), 0.0);
}

/// Names of types and symbols of elements of the first rows.
fn types(frame: &ParticleFrame) -> Vec<(&str, &str)> {
    let kinds = (0..frame.len().min(4)).filter_map(|row| frame.kinds.kind(row));
    kinds.map(|kind| (kind.name.as_str(), kind.element.map_or("-", Element::symbol))).collect()
}

#[test]
fn structures_have_elements_and_columns() {
    let names =
        ["zns.poscar", "zns_cartesian.poscar", "zns.xdatcar", "zns.xsf", "zns.axsf", "zns.cfg"];
    for name in names {
        let frame = read(name, &at(0));
        let symbols: Vec<&str> = types(&frame).into_iter().map(|(_, symbol)| symbol).collect();
        assert_eq!(symbols, ["Zn", "S", "Zn", "S"], "{name}");
    }
    let ethanol = [("C", "C"), ("C", "C"), ("O", "O"), ("H", "H")];
    for name in ["molecules.sdf", "molecules.mol2"] {
        assert_eq!(types(&read(name, &at(0))), ethanol, "{name}");
        assert_eq!(read(name, &at(1)).len(), 12, "{name}");
    }
    let columns = "charge,chain".parse().expect("columns");
    let water = read("water.pqr", &ReadOptions { columns, ..ReadOptions::default() });
    assert_eq!(types(&water)[..2], [("OW", "O"), ("HW1", "H")]);
    assert_eq!((water.radius[1], water.numbers[0].values[1]), (0.2, 0.417));
    assert_eq!(water.texts[0].text(0), "W");
}

#[test]
fn variants_of_poscar_are_read() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("POSCAR");
    let read = |text: &str| {
        std::fs::write(&path, text).expect("a file");
        read_frame(&path, &ReadOptions::default())
    };
    // A volume for a scale, symbols in the title, fixed atoms and velocities.
    let text = "Na Cl\n-8\n1 0 0\n0 1 0\n0 0 1\n1 2\nSelective dynamics\nCartesian\n\
                0.5 0 0 T T F\n1 0 0 T T T\n0 1 0 F F F\n\n0 0 0\n0 0 0\n0 0 0\n";
    let frame = read(text).expect("a frame");
    assert_eq!(types(&frame), [("Na", "Na"), ("Cl", "Cl"), ("Cl", "Cl")]);
    assert!((frame.x[0] - 1.0).abs() < 1e-12 && (frame.y[2] - 2.0).abs() < 1e-12, "{frame:?}");
    assert_eq!(count_frames(&path, &ReadOptions::default()).ok(), Some(1));
    let cell = "what\n1\n4 0 0\n0 4 0\n0 0 4\n";
    let frame = read(&format!("{cell}Fe_pv O/1234\n1 1\nDirect\n0.5 0 0\n0 0.25 1\n"));
    let frame = frame.expect("a frame");
    assert_eq!(types(&frame), [("Fe", "Fe"), ("O", "O")]);
    assert_eq!((frame.x[0], frame.y[1], frame.z[1]), (2.0, 1.0, 4.0));
    let frame = read(&format!("{cell}1 1\nDirect\n0.5 0 0\n0 0.25 1\n"));
    assert_eq!(types(&frame.expect("a frame")), [("1", "-"), ("2", "-")]);
    let flat = "a\n1\n4 0 0\n0 4 0\n0 4 0\nC\n1\nD\n0 0 0\n";
    for (text, line, message) in [
        (flat.to_owned(), 6, "the lattice vectors before have no volume"),
        (format!("{cell}C O\n1\nD\n0 0 0\n"), 7, "1 numbers of atoms, but 2 species"),
        (format!("{cell}C\n2\nD\n0 0 0\n"), 10, "the file ends before its last position"),
        (format!("{cell}C\n1\nD\n0 0\n"), 9, "three numbers are expected here"),
    ] {
        let error = read(&text).expect_err(message);
        assert_eq!((error.line(), error.message.as_str()), (Some(line), message));
    }
}

#[test]
fn variants_of_molfiles_are_read() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("molecule");
    let text = "name\n  tool\n\n  0  0  0     0  0            999 V3000\nM  V30 BEGIN CTAB\n\
                M  V30 COUNTS 2 1 0 0 0\nM  V30 BEGIN ATOM\nM  V30 1 C 1 2 3 0\nM  V30 2 Cl 4 5 6 0\n\
                M  V30 END ATOM\nM  V30 END CTAB\nM  END\n";
    let two = text.repeat(2).replace("M  END\n", "M  END\n$$$$\n");
    std::fs::write(&path, two).expect("a file");
    let options = ReadOptions::default();
    assert_eq!(count_frames(&path, &options).ok(), Some(2));
    let frame = read_frame(&path, &at(1)).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!((types(&frame), frame.title.as_str()), (vec![("C", "C"), ("Cl", "Cl")], "name"));
    assert_eq!((&frame.x[..], &frame.z[..]), (&[1.0, 4.0][..], &[3.0, 6.0][..]));
    std::fs::write(&path, text.replace("1 C 1 2 3 0", "1 C 1 2")).expect("a file");
    let error = read_frame(&path, &options).expect_err("a row that is too short");
    assert_eq!((error.line(), error.message.as_str()), (Some(8), "not the columns of an atom"));
}

#[test]
fn columns_come_from_both_files() {
    let options = with_topology("water.pdb", "vx,resname,vz");
    let frame = read("water.trr", &options);
    let values = |name: &str| {
        let column = frame.numbers.iter().find(|column| column.name == name).expect("a column");
        [column.values[0], column.values[183]]
    };
    // In nanometers per picosecond: a tenth of what MDAnalysis reads.
    for (name, [first, last]) in
        [("vx", [0.085_502_96, 0.010_786_242]), ("vz", [0.074_53, -0.069_355_69])]
    {
        let [own_first, own_last] = values(name);
        assert!((own_first - first).abs() < 1e-7 && (own_last - last).abs() < 1e-7, "{name}");
    }
    assert_eq!(frame.texts[0].name, "residue");
    // Amber's unit differs: the file has the factor to angstrom per picosecond.
    let of_amber = read("water.ncdf", &with_topology("water.pdb", "vx"));
    assert!((of_amber.numbers[0].values[0] - 0.855_029_6).abs() < 1e-6, "{of_amber:?}");
    let missing = read_frame(&trajectory("water.xtc"), &with_topology("water.gro", "vx"));
    let message = missing.expect_err("no velocities").message;
    assert!(message.starts_with("no column is named `vx`"), "{message}");
    let missing = read_frame(&trajectory("water.xtc"), &with_topology("water.gro", "speed"));
    let message = missing.expect_err("no such column").message;
    assert!(message.contains("there are x, y, z, residue_number, residue, name"), "{message}");
}

#[test]
fn groups_of_h5md_are_read_together() {
    let columns = "group,mass".parse().expect("columns");
    let frame = read("water_latest.h5md", &ReadOptions { columns, ..at(1) });
    assert_eq!(types(&frame), [("O", "O"), ("H", "H"), ("H", "H"), ("O", "O")]);
    assert_eq!(
        frame.kinds.kind(183).and_then(|kind| kind.element).map(Element::symbol),
        Some("Na")
    );
    assert_eq!(
        [0, 179, 180, 183].map(|row| frame.texts[0].text(row)),
        ["bulk", "bulk", "ions", "ions"]
    );
    assert_eq!([0, 179, 180, 183].map(|row| frame.numbers[0].values[row]), [0.0, 179.0, 0.0, 3.0]);
    assert_eq!(frame.cell.map(|cell| cell.periodic), Some([true, true, false]));
    assert!(frame.warnings.is_empty(), "{:?}", frame.warnings);
}

#[test]
fn values_of_hdf5_are_the_same_in_every_layout() {
    let rest = Some(1 << 20);
    let columns = Columns { rest, ..Columns::default() };
    let frame = read("layouts.hdf5", &ReadOptions { columns, ..ReadOptions::default() });
    assert_eq!((frame.len(), frame.numbers.len()), (90, 13));
    for column in &frame.numbers {
        let expected: Vec<f64> = (0..90).map(f64::from).collect();
        assert_eq!(column.values, expected, "{}", column.name);
    }
    assert_eq!(frame.position(89).to_array(), [89.0, 178.0, -89.0]);
    assert_eq!(types(&frame)[0], ("PartType0", "-"));
}

#[test]
fn snapshots_of_gadget_have_types_and_a_cell() {
    let columns = "Density,vx".parse().expect("columns");
    let frame = read("snapshot.hdf5", &ReadOptions { columns, ..ReadOptions::default() });
    let names = [0, 4, 5, 11].map(|row| frame.kinds.kind(row).map_or("", |kind| &kind.name));
    assert_eq!(names, ["PartType0", "PartType0", "PartType1", "PartType1"]);
    assert_eq!((frame.len(), frame.time), (12, Some(0.5)));
    let density = &frame.numbers[0].values;
    assert!(
        density[..5].iter().all(|value| *value > 0.0)
            && density[5..].iter().all(|value| value.is_nan())
    );
    assert_eq!(frame.cell.map(|cell| cell.vectors[1].to_array()), Some([0.0, 25.0, 0.0]));
}

#[test]
fn damaged_hdf5_is_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("run.h5md");
    let open = |bytes: &[u8]| {
        std::fs::write(&path, bytes).expect("a file");
        read_frame(&path, &at(1))
    };
    let whole = std::fs::read(trajectory("water_latest.h5md")).expect("a file");
    assert!(open(&whole).is_ok());
    let error = open(&whole[..whole.len() - 1]).expect_err("a file that is cut off");
    assert!(error.cut_off && error.message.starts_with("is cut off"), "{error}");
    // The signature of the root's object header, and that of a heap of links.
    for signature in [&b"OHDR"[..], b"FRHP", b"BTHD", b"EAHD", b"GCOL"] {
        let at = whole.windows(4).position(|bytes| bytes == signature);
        let mut damaged = whole.clone();
        damaged[at.unwrap_or_else(|| panic!("{signature:?}"))] = b'X';
        match open(&damaged) {
            Err(error) => assert!(error.message.starts_with("is damaged: "), "{error}"),
            // Texts are hints alone.
            Ok(frame) => assert!(signature == b"GCOL" && frame.len() == 184, "{signature:?}"),
        }
    }
    let root = whole.windows(9).position(|bytes| bytes == b"particles").expect("a link");
    let mut other = whole.clone();
    other[root] = b'q';
    let error = open(&other).expect_err("no particles");
    assert!(error.message.starts_with("is an HDF5 file, but neither H5MD"), "{error}");
    assert!(error.help.is_some_and(|help| help.contains("h5ls")));
}

#[test]
fn soft_links_of_hdf5_that_go_in_circles_are_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("run.h5md");
    let whole = std::fs::read(trajectory("water_old_links.h5md")).expect("a file");
    // The link that is called `alias`, and leads to /data, leads to itself.
    let link = whole.windows(6).position(|bytes| bytes == b"/data\0").expect("a link");
    let mut circular = whole.clone();
    circular[link..link + 6].copy_from_slice(b"alias\0");
    std::fs::write(&path, circular).expect("a file");
    let error = read_frame(&path, &at(1)).expect_err("a link to itself");
    assert!(error.message.contains("soft links") && error.message.contains("alias"), "{error}");
}

#[test]
fn topologies_with_other_counts_are_refused() {
    let options = with_topology("water.gro", "");
    let error = read_frame(&trajectory("no_cell.dcd"), &options).expect_err("another count");
    assert_eq!(error.message, "has 20 particles, but its topology 184");
    assert!(error.help.is_some_and(|help| help.contains("water.gro")));
    let missing = ReadOptions { topology: Some(PathBuf::from("none.gro")), ..options };
    let error = read_frame(&trajectory("water.xtc"), &missing).expect_err("no topology");
    assert!(error.path.ends_with("none.gro"), "{error}");
}

#[test]
fn rows_of_lammps_are_sorted_by_their_numbers() {
    let folder = tempfile::tempdir().expect("a folder");
    let topology = folder.path().join("run.data");
    let text = "LAMMPS data file\n\n3 atoms\n2 atom types\n0 9 xlo xhi\n0 9 ylo yhi\n0 9 zlo zhi\n\n\
                Masses\n\n1 15.9994\n2 1.008\n\nAtoms # atomic\n\n3 2 1 1 1\n1 1 2 2 2\n2 2 3 3 3\n";
    std::fs::write(&topology, text).expect("a file");
    let path = folder.path().join("run.xyz");
    std::fs::write(&path, "3\n\nA 7 0 0\nB 8 0 0\nB 9 0 0\n").expect("a file");
    let options = ReadOptions { topology: Some(topology), ..ReadOptions::default() };
    let frame = read_frame(&path, &options).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(frame.x, [7.0, 8.0, 9.0]);
    let symbols = [0, 1, 2].map(|row| frame.kinds.kind(row).and_then(|kind| kind.element));
    assert_eq!(symbols.map(|own| own.map_or("-", Element::symbol)), ["O", "H", "H"]);
    assert!(frame.numbers.is_empty(), "{:?}", frame.numbers);
}

#[test]
fn formats_are_told_by_content() {
    for (name, format) in [
        ("water.dcd", Format::Dcd),
        ("wide_markers.dcd", Format::Dcd),
        ("water.xtc", Format::Xtc),
        ("water.trr", Format::Trr),
        ("water.ncdf", Format::NetCdf),
        ("water.h5md", Format::Hdf5),
        ("water_mdtraj.h5", Format::Hdf5),
    ] {
        assert_eq!(read(name, &at(0)).format, format, "{name}");
        let asked = |format| ReadOptions { format: Some(format), ..ReadOptions::default() };
        assert_eq!(read(name, &asked(format)).len(), 184, "{name}");
        let other = read_frame(&trajectory(name), &asked(Format::Gsd)).expect_err("another format");
        assert_eq!(other.message, format!("is {}, not gsd", format.name()));
    }
    let text = read_frame(
        &data("topologies", "water.gro"),
        &ReadOptions { format: Some(Format::Xtc), ..ReadOptions::default() },
    );
    assert_eq!(text.expect_err("another format").message, "is not xtc");
}

/// Reads all frames of a file with this content, as far as they go.
fn read_all(path: &Path, content: &[u8]) -> (u64, Result<u64, FileError>) {
    // Truncating a file that is there would wait for the disk.
    _ = std::fs::remove_file(path);
    std::fs::write(path, content).expect("a file");
    let options = ReadOptions::default();
    let mut read = 0;
    let Ok(frames) = Frames::open(path, &options) else { return (0, Ok(0)) };
    for frame in frames {
        let Ok(frame) = frame else { break };
        assert!(frame.len() <= content.len(), "more particles than bytes");
        read += 1;
    }
    (read, count_frames(path, &options))
}

#[test]
fn truncated_files_have_the_frames_before() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("cut");
    for name in SAME.into_iter().chain(OTHERS) {
        let content = std::fs::read(trajectory(name)).expect("a file");
        let (whole, count) = read_all(&path, &content);
        assert_eq!(count.ok(), Some(whole), "{name}");
        let mut before = 0;
        let step = (content.len() / 60).max(1);
        for length in (0..content.len()).step_by(step).chain([content.len() - 1]) {
            let (read, count) = read_all(&path, &content[..length]);
            assert!(read >= before && read <= whole, "{name} {length}");
            // A frame may be read without the padding or the velocities at its end.
            let count = count.unwrap_or(read);
            assert!(count <= read && read <= count + 1, "{name} {length}: {count} {read}");
            before = read;
        }
    }
}

#[test]
fn damaged_files_do_not_panic_or_take_memory() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("damaged");
    for name in SAME.into_iter().chain(OTHERS).chain(STRUCTURES) {
        let content = std::fs::read(trajectory(name)).expect("a file");
        // Every byte of the first headers, some of those of frames, and a few of the rest.
        let step = (content.len() / 40).max(311);
        let headers = (0..content.len().min(300)).filter(|place| *place < 128 || place % 3 == 0);
        let places = headers.chain((300..content.len()).step_by(step));
        for place in places {
            let mut damaged = content.clone();
            damaged[place] = if place % 2 == 0 { 0xFF } else { content[place] ^ 1 };
            let (read, count) = read_all(&path, &damaged);
            assert!(count.is_err() || read <= content.len() as u64, "{name} {place}");
        }
    }
}
