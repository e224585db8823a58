//! Tests that everything in a file except spheres is reported once.

use super::*;

/// Warnings of things that are not drawn.
fn undrawn(frame: &ParticleFrame) -> Vec<&str> {
    let is_undrawn = |text: &&str| {
        text.contains("not drawn") || text.contains("as spheres") || text.contains("not used")
    };
    frame.warnings.iter().map(String::as_str).filter(is_undrawn).collect()
}

fn check(frame: &ParticleFrame, starts: &[&str]) {
    let messages = undrawn(frame);
    assert_eq!(messages.len(), starts.len(), "{:?}", frame.warnings);
    for (text, start) in messages.iter().zip(starts) {
        assert!(text.starts_with(start), "{text} does not begin with {start}");
    }
}

/// A file of `tests/data/particles`.
fn sample(name: &str) -> ParticleFrame {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/data/particles");
    read_frame(&folder.join(name), &ReadOptions::default()).expect("a frame")
}

#[test]
fn bonds_of_pdb_are_no_models() {
    let atoms = "ATOM      1  C   LIG A   1       1.000   2.000   3.000\n\
                 ATOM      2  C   LIG A   1       2.000   2.000   3.000\n\
                 ATOM      3  O   LIG A   1       3.000   2.000   3.000\n";
    let bonds = "CONECT    1    2    2    3\nCONECT    2    1    1\nCONECT    3    1\n";
    for text in [
        format!("{atoms}{bonds}END\n"),
        format!("{atoms}END\n{bonds}"),
        format!("MODEL        1\n{atoms}ENDMDL\n{bonds}MASTER\nEND\n"),
    ] {
        check(&frame(&text), &[]);
        assert_eq!(frames(&text).len(), 1, "{text}");
    }
    let two = format!("MODEL        1\n{atoms}ENDMDL\nMODEL        2\n{atoms}ENDMDL\n{bonds}");
    assert_eq!(frames(&two).len(), 2);
}

#[test]
fn sections_of_lammps_data_are_counted() {
    let text = "data\n\n2 atoms\n1 atom types\n3 bonds\n0 10 xlo xhi\n0 10 ylo yhi\n0 10 zlo zhi\n\n\
                Atoms # ellipsoid\n\n1 1 1 1.0 1.5 2.5 3.5\n2 1 1 1.0 4.5 5.5 6.5\n\n\
                Ellipsoids\n\n1 1 2 3 1 0 0 0\n2 1 2 3 1 0 0 0\n\n\
                Bonds\n\n1 1 1 2\n2 1 2 1\n3 1 1 2\n\nAngles\n\n1 1 1 2 1\n";
    check(&frame(text), &["2 particles that may have other shapes"]);
    let bodies = text.replace("Ellipsoids", "Bodies").replace(
        "1 1 2 3 1 0 0 0\n2 1 2 3 1 0 0 0",
        "1 1 4\n2\n0.1 0.2\n0.3 0.4\n2 1 2\n5\n1.0 2.0",
    );
    check(&frame(bodies), &["2 particles that may have other shapes"]);
}

#[test]
fn columns_of_unknown_shapes_and_orientations_are_not_drawn() {
    let dump = "ITEM: TIMESTEP\n0\nITEM: NUMBER OF ATOMS\n2\nITEM: BOX BOUNDS pp pp pp\n0 9\n0 9\n0 9\n\
                ITEM: ATOMS id type x y z c_shape quatw quati quatj quatk\n\
                1 1 1.5 2 3 1 1 0 0 0\n2 1 2.5 3 4 1 1 0 0 0\n";
    check(&frame(dump), &["2 particles that may", "2 orientations are"]);
    let xyz = "1\nProperties=species:S:1:pos:R:3:orientation:R:4\nC 1 2 3 1 0 0 0\n";
    check(&frame(xyz), &["1 orientation is"]);
    check(&frame("x,y,z,q\n1,2,3,0.5\n"), &["columns that are not used"]);
}

#[test]
fn binary_files_report_other_content() {
    let bonds = sample("bonds.gsd");
    check(&bonds, &[]);
    assert_eq!((0..bonds.len()).filter(|&row| !bonds.shapes.is_sphere(row)).count(), 5);
    check(&sample("spheres.gsd"), &[]);
    for name in ["text.ply", "little.ply", "big.ply"] {
        check(&sample(name), &["2 faces"]);
    }
    check(&sample("rods.npz"), &["2 bonds", "arrays that are not used: notes", "10 orientations"]);
    check(&sample("box.npz"), &[]);
}

#[test]
fn the_conformer_with_the_greatest_occupancy_is_drawn() {
    let atom = |serial: u8, name: &str, location: char, residue: u8, x: u8, occupancy: &str| {
        format!(
            "ATOM  {serial:5}  {name:<3}{location}SER A{residue:4}    {:8.3}   2.000   3.000{occupancy:>6}\n",
            f64::from(x)
        )
    };
    let text = [
        atom(1, "CA", ' ', 1, 1, "1.00"),
        atom(2, "CB", 'A', 1, 2, "0.30"),
        atom(3, "CB", 'B', 1, 3, "0.70"),
        // Only the lesser conformer has it.
        atom(4, "OG", 'A', 1, 4, "0.30"),
        // Without a first one, and with equal occupancies, or none.
        atom(5, "CB", 'B', 2, 5, "0.50"),
        atom(6, "CB", 'C', 2, 6, "0.50"),
        atom(7, "CB", 'C', 3, 7, ""),
        atom(8, "CB", 'D', 3, 8, ""),
    ]
    .concat();
    let frame = frame(text);
    assert_eq!(frame.x, [1.0, 3.0, 4.0, 5.0, 7.0]);
    assert!(frame.warnings[0].starts_with("3 atoms at alternate"), "{:?}", frame.warnings);
}

#[test]
fn edges_of_ply_are_counted() {
    let header = "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n\
                  property float z\nelement edge 2\nproperty int a\nproperty int b\nend_header\n";
    check(&frame(format!("{header}1 2 3\n0 0\n0 0\n")), &["2 edges are"]);
}
