//! Tests of the bonds that covalent radii find in crystals, with published cells and sites.

use crate::common::file;
use spherule_particles::{BondSource, ParticleFrame, ReadOptions, read_frame};
use std::collections::BTreeMap;
use std::fmt::Write;

fn read(content: &str) -> ParticleFrame {
    let options = ReadOptions { bonds: BondSource::Auto, ..ReadOptions::default() };
    read_frame(&file(content).path, &options).unwrap_or_else(|error| panic!("{error}"))
}

/// A CIF of these edges, angles, and sites with their labels.
fn cif(group: &str, edges: [f64; 3], angles: [f64; 3], sites: &str) -> String {
    let ([a, b, c], [alpha, beta, gamma]) = (edges, angles);
    format!(
        "data_x\n_symmetry_space_group_name_H-M '{group}'\n_cell_length_a {a}\n_cell_length_b {b}\n\
         _cell_length_c {c}\n_cell_angle_alpha {alpha}\n_cell_angle_beta {beta}\n_cell_angle_gamma {gamma}\n\
         loop_\n_atom_site_label\n_atom_site_fract_x\n_atom_site_fract_y\n_atom_site_fract_z\n{sites}"
    )
}

const RIGHT: [f64; 3] = [90.0; 3];
const HEXAGONAL: [f64; 3] = [90.0, 90.0, 120.0];

/// Returns the number of bonds between the atoms of each pair of elements, as in `O-Ti 12`.
fn bonds(content: &str) -> String {
    let frame = read(content);
    let bonds = frame.bonds.as_ref().expect("bonds");
    let symbol = |row: u32| {
        let kind = &frame.kinds.table[frame.kinds.codes.code(row as usize) as usize];
        kind.element.expect("an element").symbol()
    };
    let mut counts: BTreeMap<[&str; 2], usize> = BTreeMap::new();
    for (&first, &second) in bonds.first.iter().zip(&bonds.second) {
        let mut pair = [symbol(first), symbol(second)];
        pair.sort_unstable();
        *counts.entry(pair).or_default() += 1;
    }
    let counts = counts.iter().map(|([one, other], count)| format!("{one}-{other} {count}"));
    counts.collect::<Vec<_>>().join(", ")
}

#[test]
fn metals_are_not_bonded_across_anions() {
    let cubic = |group: &str, edge: f64, sites: &str| cif(group, [edge; 3], RIGHT, sites);
    let perovskite = "A 0 0 0\nB .5 .5 .5\nX .5 .5 0\n";
    let perovskite =
        |[a, b, x]: [&str; 3]| perovskite.replace('A', a).replace('B', b).replacen('X', x, 1);
    for (name, content, expected) in [
        ("halite", cubic("F m -3 m", 5.6402, "Na 0 0 0\nCl .5 .5 .5\n"), "Cl-Na 24"),
        ("sylvite", cubic("F m -3 m", 6.2931, "K 0 0 0\nCl .5 .5 .5\n"), "Cl-K 24"),
        (
            "magnesium hydride",
            cif("P 42/m n m", [4.517, 4.517, 3.0205], RIGHT, "Mg 0 0 0\nH .304 .304 0\n"),
            "H-Mg 12",
        ),
        ("LiH", cubic("F m -3 m", 4.083, "Li 0 0 0\nH .5 .5 .5\n"), "H-Li 24"),
        ("NaH", cubic("F m -3 m", 4.89, "Na 0 0 0\nH .5 .5 .5\n"), "H-Na 24"),
        ("KH", cubic("F m -3 m", 5.7, "K 0 0 0\nH .5 .5 .5\n"), "H-K 24"),
        ("CsH", cubic("F m -3 m", 6.376, "Cs 0 0 0\nH .5 .5 .5\n"), "Cs-H 24"),
        ("SrTiO3", cubic("P m -3 m", 3.905, &perovskite(["Sr", "Ti", "O"])), "O-Sr 12, O-Ti 6"),
        ("CsPbBr3", cubic("P m -3 m", 5.874, &perovskite(["Cs", "Pb", "Br"])), "Br-Pb 6"),
        (
            "rutile",
            cif("P 42/m n m", [4.594, 4.594, 2.9586], RIGHT, "Ti 0 0 0\nO .3051 .3051 0\n"),
            "O-Ti 12",
        ),
        (
            "stishovite",
            cif("P 42/m n m", [4.1772, 4.1772, 2.6651], RIGHT, "Si 0 0 0\nO .3061 .3061 0\n"),
            "O-Si 12",
        ),
        (
            "quartz",
            cif(
                "P 32 2 1",
                [4.916, 4.916, 5.4054],
                HEXAGONAL,
                "Si .4697 0 .666667\nO .4135 .2669 .785767\n",
            ),
            "O-Si 12",
        ),
        (
            "sodalite",
            cubic(
                "P -4 3 n",
                8.882,
                "Na .1777 .1777 .1777\nAl .25 0 .5\nSi .25 .5 0\nO .139 .1494 .4383\nCl 0 0 0\n",
            ),
            "Al-O 24, Cl-Na 8, Na-O 24, O-Si 24",
        ),
        (
            "fluorapatite",
            cif(
                "P 63/m",
                [9.397, 9.397, 6.878],
                HEXAGONAL,
                "Ca1 .666667 .333333 .001\nCa2 -.0071 .2423 .25\nP .3981 .3688 .25\nO1 .3262 .4843 .25\n\
                 O2 .588 .4668 .25\nO3 .3415 .2569 .0704\nF 0 0 .25\n",
            ),
            "Ca-F 6, Ca-O 72, O-P 24",
        ),
        (
            "ice XI",
            cif(
                "C m c 21",
                [4.465, 7.858, 7.292],
                RIGHT,
                "O1 0 .6646 .0631\nO2 .5 .8255 -.0631\nH1 0 .6636 .1963\nH2 0 .5363 .0183\nH3 .6766 -.2252 -.0183\n",
            ),
            "H-O 16",
        ),
    ] {
        assert_eq!(bonds(&content), expected, "{name}");
    }
}

#[test]
fn metals_without_anions_between_them_are_bonded() {
    let alloy = cif("P m -3 m", [3.572; 3], RIGHT, "Al 0 0 0\nNi .5 .5 0\n");
    assert_eq!(bonds(&alloy), "Al-Ni 12, Ni-Ni 12");
    assert_eq!(bonds(&cif("F m -3 m", [3.615; 3], RIGHT, "Cu 0 0 0\n")), "Cu-Cu 24");
    // The quadruple bond of octachlorodirhenate, and copper bridged by two atoms (a paddle wheel).
    let mut rhenium = "10\n\nRe 0 0 1.12\nRe 0 0 -1.12\n".to_owned();
    let mut copper = "18\n\nCu 0 0 1.31\nCu 0 0 -1.31\n".to_owned();
    for (x, y) in [(1.0, 1.0), (-1.0, 1.0), (1.0, -1.0), (-1.0, -1.0)] {
        let [near, far] = [1.38, 1.8].map(|at| [at * x, at * y]);
        writeln!(copper, "C {} {} 0", far[0], far[1]).expect("a row");
        for z in [1.12, -1.12] {
            writeln!(rhenium, "Cl {} {} {}", 1.6 * x, 1.6 * y, 1.5 * z).expect("a row");
            writeln!(copper, "O {} {} {z}", near[0], near[1]).expect("a row");
        }
    }
    copper = copper.replacen("18", "14", 1);
    assert_eq!(bonds(&rhenium), "Cl-Re 8, Re-Re 1");
    assert_eq!(bonds(&copper), "C-O 8, Cu-Cu 1, Cu-O 8");
}

/// Sodium beside a molecule of water, whose hydrogen is no hydride.
#[test]
fn alkali_metals_are_not_bonded_to_hydrogen_of_water() {
    let at = |distance: f64| {
        format!(
            "4\n\nNa 0 0 0\nH {distance} 0 0\nO {} 0.3 0\nH {} 0.1 0\n",
            distance + 0.9,
            distance + 1.8
        )
    };
    assert_eq!(bonds(&at(2.5)), "H-O 2");
    assert_eq!(bonds("2\n\nNa 0 0 0\nH 2.5 0 0\n"), "H-Na 1");
}

#[test]
fn clusters_of_frameworks_have_no_bonds_of_metals() {
    // The node of UiO-66: six zirconium atoms, and an oxygen over each of the eight faces of their octahedron.
    let mut node = "14\n\n".to_owned();
    for axis in 0..3 {
        for sign in [2.5, -2.5] {
            let mut at = [0.0; 3];
            at[axis] = sign;
            writeln!(node, "Zr {} {} {}", at[0], at[1], at[2]).expect("a row");
        }
    }
    for corner in 0..8 {
        let at = [0, 1, 2].map(|axis| if corner >> axis & 1 == 0 { 1.27 } else { -1.27 });
        writeln!(node, "O {} {} {}", at[0], at[1], at[2]).expect("a row");
    }
    assert_eq!(bonds(&node), "O-Zr 24");
    // A carboxylate that chelates zinc, whose carbon is within the radii.
    let chelate = "4\n\nZn 0 0 0\nO 1.1 1.75 0\nO -1.1 1.75 0\nC 0 2.41 0\n";
    assert_eq!(bonds(chelate), "C-O 2, O-Zn 2");
    // Carbon that is bonded to a metal beside its oxygen stays so.
    let acyl = "3\n\nZr 0 0 0\nC 2.18 0 0\nO 1.95 1.2 0\n";
    assert_eq!(bonds(acyl), "C-O 1, C-Zr 1, O-Zr 1");
}
