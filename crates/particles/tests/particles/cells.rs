//! Tests of the cells of layers: those with an edge without length.

use crate::common::file;
use spherule_particles::{Cell, ParticleFrame, ReadOptions, read_frame};

fn read(content: &str) -> Result<ParticleFrame, String> {
    read_frame(&file(content).path, &ReadOptions::default()).map_err(|error| error.to_string())
}

const PDB: &str = "\
CRYST1    6.000    5.000    0.000  90.00  90.00  90.00 P 1           1
HETATM    1  C   GRA A   1       0.500   1.000   0.000  1.00  0.00           C
";

const MMCIF: &str = "data_x\n_cell.length_a 6.0(2)\n_cell.length_b 5\n_cell.length_c 0\n_cell.angle_alpha 90\n\
    _cell.angle_beta 90\n_cell.angle_gamma 90\nloop_\n_atom_site.type_symbol\n_atom_site.Cartn_x\n\
    _atom_site.Cartn_y\n_atom_site.Cartn_z\nC 0.5 1 0\n";

const CIF: &str = "data_x\n_cell_length_a 6\n_cell_length_b 5\n_cell_length_c 0\nloop_\n_atom_site_label\n\
    _atom_site_fract_x\n_atom_site_fract_y\n_atom_site_fract_z\nC1 0.1 0.2 0\nC2 0.6 0.2 0\n";

const DUMP: &str = "ITEM: TIMESTEP\n0\nITEM: NUMBER OF ATOMS\n1\nITEM: BOX BOUNDS pp pp pp\n0 6\n0 5\n0 0\n\
    ITEM: ATOMS id type x y z\n1 1 0.5 1 0\n";

const DATA: &str =
    "layer\n\n1 atoms\n1 atom types\n0 6 xlo xhi\n0 5 ylo yhi\n\nAtoms # atomic\n\n1 1 0.5 1 0\n";

const RESTART: &str = "layer\n     1\n   0.5000000   1.0000000   0.0000000\n\
    \x20  6.0000000   5.0000000   0.0000000  90.0000000  90.0000000  90.0000000\n";

const MOL2: &str = "@<TRIPOS>MOLECULE\nlayer\n1 0\n@<TRIPOS>ATOM\n1 C 0.5 1 0 C.3\n@<TRIPOS>CRYSIN\n6 5 0 90 90 90 1 1\n";

const XSF: &str = "SLAB\nPRIMVEC\n6 0 0\n0 5 0\n0 0 0\nPRIMCOORD\n1 1\nC 0.5 1 0\n";

#[test]
fn cells_of_layers_have_a_thickness_and_are_not_periodic_there() {
    for content in [PDB, MMCIF, DUMP, DATA, RESTART, MOL2, XSF] {
        let frame = read(content).unwrap_or_else(|error| panic!("{content}{error}"));
        let Cell { origin, vectors, periodic } = frame.cell.expect(content);
        assert_eq!(periodic, [true, true, false], "{content}");
        let edges = vectors.map(|vector| vector.to_array());
        assert_eq!(edges, [[6.0, 0.0, 0.0], [0.0, 5.0, 0.0], [0.0, 0.0, 1.0]], "{content}");
        assert_eq!(origin.to_array(), [0.0, 0.0, -0.5], "{content}");
        assert!(frame.z.iter().all(|z| *z == 0.0), "{content}");
    }
}

#[test]
fn edges_that_are_not_given_are_no_cell() {
    let cut = PDB.replacen("    0.000  90.00  90.00  90.00 P 1           1", "", 1);
    let without = MMCIF.replacen("_cell.length_c 0\n", "", 1);
    let unknown = MMCIF.replacen("_cell.length_c 0", "_cell.length_c ?", 1);
    for content in [cut, without, unknown, MOL2.replacen(" 90 90 90 1 1", "", 1)] {
        assert_eq!(read(&content).expect("a frame").cell, None, "{content}");
    }
    // Symmetry may repeat atoms of a crystal beyond their plane.
    for (content, expected) in [
        (CIF.to_owned(), "there is no cell"),
        (MMCIF.replacen("6.0(2)", "6.o", 1), "`6.o` is not a number"),
        (DATA.replacen("0 6 xlo", "6 xlo", 1), "1 numbers"),
    ] {
        let error = read(&content).expect_err(expected);
        assert!(error.contains(expected), "{error}");
    }
}
