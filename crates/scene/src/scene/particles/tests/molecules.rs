//! GRO, PDB and mmCIF.

use super::*;

const GRO: &str = "\
Water, t=   2.50000 step= 40
    5
    1SOL     OW    1   0.126   1.624   1.679  0.1227 -0.0580  0.0434
    1SOL    HW1    2   0.190   1.661   1.747  0.8085  0.3191 -0.7791
    1SOL     MW    3   0.190   1.661  -1.747  0.8085  0.3191 -0.7791
    2NA+     NA  100   1.000   2.000   3.000  0.0000  0.0000  0.0000
    3ALA     CA99999   1.500   2.000   3.000  0.0000  0.0000  0.0000
   2.00000   3.00000   4.00000   0.00000   0.00000   0.50000   0.00000   0.25000   0.75000
";

#[test]
fn gro_has_fixed_columns_in_nanometers() {
    let frame = frame_with(GRO, &columns("vy,residue")).expect("a frame");
    assert_eq!(frame.x, [0.126, 0.19, 0.19, 1.0, 1.5]);
    let expected = [("OW", "O"), ("HW1", "H"), ("MW", "-"), ("NA", "Na"), ("CA", "C")];
    assert_eq!(kinds(&frame), expected);
    assert_eq!((frame.numbers[0].values[1], frame.texts[0].text(3)), (0.3191, "NA+"));
    assert_eq!((frame.time, frame.step), (Some(2.5), Some(40)));
    let cell = frame.cell.expect("a cell");
    assert_eq!(cell.vectors[1], DVec3::new(0.5, 3.0, 0.0));
    assert_eq!(cell.vectors[2], DVec3::new(0.25, 0.75, 4.0));
    let spheres = particles(GRO).spheres;
    // A site of the water is not drawn, and radii are in nanometers.
    assert_eq!(spheres.len(), 4);
    assert!((spheres.radius[0] - 0.150).abs() < 1e-15 && (spheres.radius[3] - 0.177).abs() < 1e-15);
}

#[test]
fn gro_may_have_more_digits_and_no_velocities() {
    let text = "1\r\n1\r\n    1LIG     C1    1   1.12345   2.00000 -13.50000\r\n 1 1 1";
    let frame = frame(text);
    assert_eq!((frame.position(0), &frame.title[..]), (DVec3::new(1.12345, 2.0, -13.5), "1"));
    let two = format!("{GRO}{GRO}");
    assert_eq!(frames(&two).len(), 2);
    assert_eq!(frame_with(&two, &at_frame("last")).expect("a frame").len(), 5);
}

#[test]
fn beads_of_coarse_grained_models_have_no_elements() {
    let bead = |name: &str| format!("    1DPPC {name:>5}    1   8.292   9.013   7.832\n");
    let names = ["NC3", "PO4", "GL1", "GL2", "C1A", "C2A", "C3A"];
    let text = format!("lipid\n7\n{}  9 9 9\n", names.map(bead).concat());
    assert!(kinds(&frame(&text)).iter().all(|(_, symbol)| *symbol == "-"));
}

#[test]
fn faulty_gro_is_refused() {
    let lines: Vec<&str> = GRO.lines().collect();
    let broken = GRO.replace("1.661   1.747", "1.661   1.7x7");
    let short = GRO.replace("   1.661   1.747  0.8085  0.3191 -0.7791", "");
    for (text, place, message) in [
        (&lines[..4].join("\n"), (5, 1), "the file ends after 2 of 5 atoms"),
        (&broken, (4, 40), "`1.7x7` is not a number"),
        (&short, (4, 1), "no y in this row"),
        (&GRO.replace("   2.00000   3.00000", " 2.0 x"), (8, 6), "`x` is not a number"),
    ] {
        assert_eq!(fault(text), (place.0, place.1, message.to_owned()));
    }
    let wrong = ReadOptions { format: Some(Format::Gro), ..ReadOptions::default() };
    for text in
        ["a\n1\nno position\n", "a\nmany\n", "a\n", "a\n1\n    1SOL     OW    1   \u{e4}.1\n"]
    {
        assert!(frame_with(text, &wrong).is_err(), "{text}");
    }
    assert!(frame_with(GRO.replace("    5\n", "18446744073709551615\n"), &wrong).is_err());
}

const PDB: &str = "\
HEADER    A TEST
TITLE     ONE TITLE
TITLE    2 IN TWO LINES
CRYST1   20.000   30.000   40.000  90.00  90.00 120.00 P 1           1
MODEL        1
ATOM      1  N   MET A   1     -12.345   1.000   2.000  1.00 20.50           N
ATOM      2  CA AMET A   1       1.000   2.000   3.000  0.50 21.50           C
ATOM      3  CA BMET A   1       1.500   2.000   3.000  0.50 22.50           C
HETATM***** CA    CA A   2       4.000   5.000   6.000
HETATM186a0  CL  LIG A   3       7.000   8.000   9.000  1.00  0.00
ATOM  A0000  OW  SOL B   4       1.000   1.000   1.000
ATOM  A0001  MW  SOL B   4       1.000   1.000   1.100
TER
ENDMDL
MODEL        2
ATOM      1  N   MET A   1       9.000   1.000   2.000  1.00 20.50           N
ENDMDL
END
";

#[test]
fn pdb_has_fixed_columns() {
    let frame = frame_with(PDB, &columns("b_factor,chain,number")).expect("a frame");
    assert_eq!(frame.x, [-12.345, 1.0, 4.0, 7.0, 1.0, 1.0]);
    let expected = [("N", "N"), ("CA", "C"), ("CA", "Ca"), ("CL", "Cl"), ("OW", "O"), ("MW", "-")];
    assert_eq!(kinds(&frame), expected);
    assert_eq!(frame.numbers[0].values[1], 21.5);
    assert!(frame.numbers[0].values[2].is_nan());
    assert_eq!((frame.texts[0].text(4), frame.texts[1].text(3)), ("B", "186a0"));
    assert_eq!(frame.title, "ONE TITLE IN TWO LINES");
    let cell = frame.cell.expect("a cell");
    assert!((cell.vectors[1] - DVec3::new(-15.0, 30.0 * 0.75_f64.sqrt(), 0.0)).length() < 1e-12);
    assert_eq!(particles(PDB).spheres.len(), 5);
    assert_eq!(particles(PDB).spheres.radius[2], 2.62);
}

#[test]
fn models_of_pdb_are_frames() {
    assert_eq!(frames(PDB)[1], [9.0]);
    let last = frame_with(PDB, &at_frame("last")).expect("a frame");
    assert_eq!((&last.x[..], &last.title[..]), (&[9.0][..], "ONE TITLE IN TWO LINES"));
    let none = PDB.replace("20.000   30.000   40.000", " 1.000    1.000    1.000");
    assert_eq!(frame(none.replace("120.00", " 90.00")).cell, None);
    // Trajectories with END alone between frames.
    let atom = "ATOM      1  N   MET A   1       9.000   1.000   2.000\n";
    assert_eq!(frames(format!("REMARK\n{atom}END\n{atom}END\n")).len(), 2);
    assert_eq!(frames(format!("{atom}{atom}").replace('\n', "\r\n")), [[9.0, 9.0]]);
}

#[test]
fn faulty_pdb_is_refused() {
    for (text, place, message) in [
        ("ATOM      1  N   MET A   1       9.000   1.0\n", (1, 1), "no z in this row"),
        (
            "ATOM      1  N   MET A   1       9.0 0   1.000   2.000\n",
            (1, 34),
            "`9.0 0` is not a number",
        ),
        ("HEADER    NOTHING\nEND\n", (0, 0), "holds no particles"),
    ] {
        assert_eq!(fault(text), (place.0, place.1, message.to_owned()), "{text}");
    }
}

const MMCIF: &str = "\
data_TEST
# a comment
_struct.title 'It''s a test'
_cell.length_a 20.0
_cell.length_b 30.0
_cell.length_c 40.0
_cell.angle_alpha 90
_cell.angle_beta 90
_cell.angle_gamma 90
_some.text
;several
lines
;
loop_
_other.a
_other.b
1 'two words'
;text;
; 4
loop_
_atom_site.group_PDB
_atom_site.type_symbol
_atom_site.label_atom_id
_atom_site.label_alt_id
_atom_site.Cartn_x
_atom_site.Cartn_y
_atom_site.Cartn_z
_atom_site.B_iso_or_equiv
_atom_site.pdbx_PDB_model_num
ATOM N  N      . 1.5 2 3 ? 1
ATOM C  CA     A 2.5 2 3 1.5 1
ATOM C  CA     B 9.5 2 3 1.5 1
ATOM O  \"O5'\"  . 3.5 2
3 2.5 1
ATOM Zn ZN     . 4.5 2 3 2.5 2
#
_after.loop 1
";

#[test]
fn mmcif_has_a_loop_of_atoms() {
    let options = columns("B_iso_or_equiv,label_atom_id");
    let frame = frame_with(MMCIF, &options).expect("a frame");
    assert_eq!(frame.x, [1.5, 2.5, 3.5]);
    assert_eq!(kinds(&frame), [("N", "N"), ("C", "C"), ("O", "O")]);
    assert!(frame.numbers[0].values[0].is_nan());
    assert_eq!((frame.numbers[0].values[2], frame.texts[0].text(2)), (2.5, "O5'"));
    assert_eq!((&frame.title[..], frame.unit), ("It''s a test", LengthUnit::Angstrom));
    assert_eq!(frame.cell.map(|cell| cell.vectors[2]), Some(DVec3::Z * 40.0));
    assert!(
        frame.warnings[0].starts_with("1 atoms at alternate locations"),
        "{:?}",
        frame.warnings
    );
    assert_eq!(frames(MMCIF)[1], [4.5]);
    assert_eq!(frame_with(MMCIF, &at_frame("last")).expect("a frame").x, [4.5]);
    assert_eq!(super::frame(MMCIF.replace('\n', "\r\n")).x, [1.5, 2.5, 3.5]);
}

#[test]
fn faulty_mmcif_is_refused() {
    let x = MMCIF.replace("2.5 2 3 1.5", "2.5x 2 3 1.5");
    let names = MMCIF.replace("Cartn_z", "Cartn_zz");
    let lines: Vec<&str> = MMCIF.lines().collect();
    for (text, line, message) in [
        (x.as_str(), 31, "`2.5x` is not a number"),
        (&MMCIF.replace("\"O5'\"", "\"O5'"), 33, "this quote is not closed"),
        (&lines[..33].join("\n"), 34, "a row of 6 values, but there are 9 columns"),
        (&lines[..11].join("\n"), 12, "the text that begins at line 11 does not end"),
        (&lines[..19].join("\n"), 0, "holds no particles"),
        (
            "data_a\nloop_\n_atom_site_fract_x\n0.5\n",
            4,
            "no _atom_site_fract_y in this loop of atoms",
        ),
    ] {
        let (found, _, reported) = fault(text);
        assert_eq!((found, reported.as_str()), (line, message));
    }
    assert!(fault(names).2.starts_with("no column is named `z`"));
}

#[test]
fn conformers_are_chosen_by_their_mean_occupancy() {
    let atom = |name: &str, location: char, x: u32, occupancy: &str| {
        format!(
            "ATOM      1  {name}{location}MET A   1    {x:>4}.000   2.000   3.000  {occupancy}  1.00           C\n"
        )
    };
    let lone = atom("CA ", 'A', 1, "0.50");
    let two = |occupancy: &str| atom("CA ", 'B', 2, occupancy) + &atom("CB ", 'B', 3, occupancy);
    // One atom against two; what only the lesser conformer has is drawn, too.
    assert_eq!(frame(lone.clone() + &two("0.40")).x, [1.0, 3.0]);
    assert_eq!(frame(lone.clone() + &two("0.60")).x, [2.0, 3.0]);
    // Of equals, the first.
    assert_eq!(frame(lone.clone() + &two("0.50")).x, [1.0, 3.0]);
    assert_eq!(frame(two("0.50") + &lone).x, [2.0, 3.0]);
}
