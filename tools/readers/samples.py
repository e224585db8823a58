#!/usr/bin/env python3
"""Writes the small particle files of tests/data/particles, by the programs whose formats they are.

    pip install ase biotite gemmi gsd MDAnalysis parmed plyfile
    tools/readers/samples.py
    tools/readers/compare.py --answers        # what those programs read from them

Symmetry is checked for every setting of a space group against gemmi: space_groups.csv.
"""

import sys
from pathlib import Path

import ase
import ase.build
import ase.io
import gemmi
import gsd.hoomd
import numpy as np

OUT = Path(__file__).resolve().parents[2] / "tests/data/particles"

# Name, symmetry as CIF lines, Hall symbol by which it is expanded to list operations, cell, and sites:
# label, x, y, z and, if it is not 1, the occupancy.
QUARTZ = (4.9134, 4.9134, 5.4052, 90, 90, 120)
CRYSTALS = {
    "quartz_p3221": ("_space_group_name_H-M_alt 'P 32 2 1'", QUARTZ,
                     ["Si 0.4697 0 0.6666667", "O 0.4133 0.2672 0.7855"]),
    "quartz_p3121": ("_symmetry_space_group_name_H-M 'P3(1)21'", QUARTZ,
                     ["Si 0.4697 0 0.3333333", "O 0.4133 0.2672 0.2145"]),
    "screw_p31": ("_symmetry_Int_Tables_number 144", (6.1, 6.1, 7.3, 90, 90, 120),
                  ["P 0.11 0.27 0.05", "S 0.42 0.13 0.31"]),
    "screw_p41": ("_space_group_name_Hall 'P 4w'", (5.2, 5.2, 9.1, 90, 90, 90), ["Se 0.13 0.29 0.07"]),
    "screw_p61": ("_space_group_IT_number 169", (5.9, 5.9, 14.2, 90, 90, 120), ["Te 0.17 0.35 0.04"]),
    "screw_p43212": ("_symmetry_space_group_name_H-M P43212", (4.97, 4.97, 6.92, 90, 90, 90),
                     ["Si 0.3003 0.3003 0", "O 0.2392 0.1049 0.1789"]),
    "scheelite_i41a": ("_symmetry_space_group_name_H-M 'I 41/a :2'", (5.243, 5.243, 11.376, 90, 90, 90),
                       ["Ca 0 0.25 0.625", "W 0 0.25 0.125", "O 0.1507 0.0086 0.2106"]),
    "scheelite_i41a_origin1": ("_symmetry_space_group_name_H-M 'I 41/a'", (5.243, 5.243, 11.376, 90, 90, 90),
                               ["Ca 0 0 0.5", "W 0 0 0", "O 0.2414 0.1507 0.0856"]),
    "diamond_fd3m_origin1": ("_symmetry_space_group_name_H-M 'F d 3 m'", (3.567,) * 3 + (90,) * 3, ["C 0 0 0"]),
    "magnetite_fd3m": ("_symmetry_space_group_name_H-M 'F d -3 m'", (8.3941,) * 3 + (90,) * 3,
                       ["Fe1 0.125 0.125 0.125", "Fe2 0.5 0.5 0.5", "O 0.2549 0.2549 0.2549"]),
    "magnesite_r3c": ("_symmetry_space_group_name_H-M 'R -3 c'", (4.6328, 4.6328, 15.0129, 90, 90, 120),
                      ["Mg 0 0 0", "C 0 0 0.25", "O 0.2778 0 0.25"]),
    "calcite_r3c_rhombohedral": ("_symmetry_space_group_name_H-M 'R -3 c'", (6.375,) * 3 + (46.08,) * 3,
                                 ["Ca 0 0 0", "C 0.25 0.25 0.25", "O 0.5069 -0.0069 0.25"]),
    "gypsum_i2a": ("_symmetry_space_group_name_H-M 'I 1 2/a 1'", (5.679, 15.202, 6.522, 90, 118.43, 90),
                   ["Ca 0.5 0.0797 0.25", "S 0 0.0772 0.75", "O1 0.9632 0.1319 0.5505", "O2 0.7582 0.0222 0.6671",
                    "O 0.3796 0.1821 0.4588"]),
    "monoclinic_unique_c": ("_symmetry_space_group_name_H-M 'P 21/b'", (7.1, 9.3, 5.4, 90, 90, 104.2),
                            ["Cu 0.13 0.27 0.41", "Cl 0.38 0.05 0.22"]),
    "albite_c1": ("_symmetry_space_group_name_H-M 'C -1'", (8.142, 12.785, 7.159, 94.19, 116.61, 87.68),
                  ["Na 0.2682 0.9888 0.1459", "Al 0.0088 0.1684 0.2080"]),
    "skutterudite_shared": ("_symmetry_space_group_name_H-M 'I m -3'", (8.2055,) * 3 + (90,) * 3,
                            ["Fe 0.25 0.25 0.25 0.11", "Co 0.25 0.25 0.25 0.87", "Ni 0.25 0.25 0.25 0.02",
                             "As 0 0.3442 0.1514"]),
}


def main():
    OUT.mkdir(parents=True, exist_ok=True)
    for name, (symmetry, cell, sites) in CRYSTALS.items():
        (OUT / f"{name}.cif").write_text(crystal(name, symmetry, cell, sites))
    listed = gemmi.symops_from_hall('P 32 2"')
    loop = "loop_\n_symmetry_equiv_pos_as_xyz\n" + "".join(f"'{op.triplet()}'\n" for op in listed)
    _, cell, sites = CRYSTALS["quartz_p3221"]
    (OUT / "quartz_listed.cif").write_text(crystal("quartz_listed", loop.strip(), cell, sites))
    xyz()
    lammps()
    proteins()
    binary()
    amber()
    namd()
    ase_trajectory()
    space_groups()


def crystal(name, symmetry, cell, sites):
    keys = ["length_a", "length_b", "length_c", "angle_alpha", "angle_beta", "angle_gamma"]
    lines = [f"data_{name}", *(f"_cell_{key} {value}" for key, value in zip(keys, cell)), symmetry, "loop_"]
    columns = ["label", "fract_x", "fract_y", "fract_z"]
    if any(len(site.split()) == 5 for site in sites):
        columns.append("occupancy")
    rows = [site.split() for site in sites]
    rows = [row + ["1"] * (len(columns) - len(row)) for row in rows]
    lines += [f"_atom_site_{column}" for column in columns] + [" ".join(row) for row in rows]
    return "\n".join(lines) + "\n"


def water(count=4):
    """Water molecules in a triclinic cell, with charges."""
    random = np.random.default_rng(7)
    cell = np.array([[9.0, 0, 0], [1.5, 8.0, 0], [-1.0, 0.7, 7.0]])
    molecules = []
    for _ in range(count):
        molecule = ase.build.molecule("H2O")
        molecule.rotate(random.uniform(0, 360), random.normal(size=3))
        molecule.translate(random.uniform(0.1, 0.9, 3) @ cell)
        molecules.append(molecule)
    atoms = molecules[0]
    for molecule in molecules[1:]:
        atoms += molecule
    atoms.set_cell(cell)
    atoms.set_pbc([True, True, False])
    atoms.set_initial_charges([0.8 if symbol == "H" else -1.6 for symbol in atoms.get_chemical_symbols()])
    return atoms


def xyz():
    atoms = water()
    ase.io.write(OUT / "water.xyz", atoms, format="xyz", comment="four molecules")
    frames = []
    for step in range(3):
        frame = atoms.copy()
        frame.set_velocities(np.full((len(atoms), 3), 0.01 * step))
        frame.positions += 0.25 * step
        frame.info["Time"] = 0.5 * step
        frames.append(frame)
    ase.io.write(OUT / "water_frames.extxyz", frames, format="extxyz")
    surface = ase.build.fcc111("Cu", (2, 2, 2), vacuum=4.0, orthogonal=False)
    ase.io.write(OUT / "surface.extxyz", surface, format="extxyz")
    rows = [f"{symbol} {x:.5f} {y:.5f} {z:.5f}" for symbol, (x, y, z) in
            zip(atoms.numbers, atoms.positions)]
    (OUT / "numbers.xyz").write_text(f"{len(rows)}\natomic numbers\n" + "\n".join(rows) + "\n")


def lammps():
    atoms = water()
    atoms.set_pbc(True)
    for style in ["atomic", "charge", "full"]:
        ase.io.write(OUT / f"water_{style}.data", atoms, format="lammps-data", atom_style=style,
                     specorder=["H", "O"], masses=True)
    cell = atoms.cell.array
    # As LAMMPS writes boxes: bounds around the tilted one.
    xy, xz, yz = cell[1, 0], cell[2, 0], cell[2, 1]
    bounds = [[min(0, xy, xz, xy + xz), cell[0, 0] + max(0, xy, xz, xy + xz), xy],
              [min(0, yz), cell[1, 1] + max(0, yz), xz], [0, cell[2, 2], yz]]
    box = "ITEM: BOX BOUNDS xy xz yz pp pp pp\n" + "".join("%.6f %.6f %.6f\n" % tuple(row) for row in bounds)
    types = [1 if symbol == "H" else 2 for symbol in atoms.get_chemical_symbols()]
    for name, columns in [("x", "x y z"), ("xs", "xs ys zs"), ("xu", "xu yu zu")]:
        text = ""
        for step in range(2):
            places = atoms.get_scaled_positions(wrap=False) if name == "xs" else atoms.positions
            places = places + 0.01 * step
            rows = [f"{at + 1} {kind} {x:.6f} {y:.6f} {z:.6f}\n"
                    for at, (kind, (x, y, z)) in enumerate(zip(types, places))]
            text += (f"ITEM: TIMESTEP\n{step * 100}\nITEM: NUMBER OF ATOMS\n{len(atoms)}\n{box}"
                     f"ITEM: ATOMS id type {columns}\n" + "".join(rows))
        (OUT / f"water_{name}.lammpstrj").write_text(text)
    (OUT / "water.yaml").write_text("".join(lammps_yaml(atoms, types, bounds, step) for step in range(2)))


def lammps_yaml(atoms, types, bounds, step):
    """A frame as `DumpYAML` of LAMMPS writes it."""
    box = "".join("  - [ %.6f, %.6f ]\n" % tuple(row[:2]) for row in bounds)
    rows = "".join(f"  - [ {at + 1}, {kind}, {x:.6f}, {y:.6f}, {z:.6f}, ]\n"
                   for at, (kind, (x, y, z)) in enumerate(zip(types, atoms.positions + 0.01 * step)))
    return (f"---\ncreator: LAMMPS\ntimestep: {step * 100}\nunits: real\ntime: {step * 0.5}\nnatoms: {len(atoms)}\n"
            f"boundary: [ p, p, p, p, p, p, ]\nthermo:\n  - keywords: [ Step, Temp, ]\n  - data: [ {step * 100}, 300.5, ]\n"
            f"box:\n{box}  - [ {', '.join('%.6f' % row[2] for row in bounds)} ]\n"
            f"keywords: [ id, type, x, y, z,  ]\ndata:\n{rows}...\n")


PDB_ATOM = "ATOM  {:5d} {:4s}{:1s}{:3s} {:1s}{:4d}    {:8.3f}{:8.3f}{:8.3f}{:6.2f}{:6.2f}          {:>2s}"
# Serine with two conformers of which the second is occupied more, and a threonine that shares its place.
SERINE = [("N", "", "SER", 1, 0), ("CA", "", "SER", 1, 0), ("CB", "A", "SER", 1, 0.3), ("OG", "A", "SER", 1, 0.3),
          ("CB", "B", "SER", 1, 0.7), ("OG", "B", "SER", 1, 0.7), ("O", "C", "HOH", 2, 0.5),
          ("O", "D", "HOH", 2, 0.5), ("CB", "A", "SER", 3, 0.6), ("OG", "A", "SER", 3, 0.6),
          ("CB", "B", "THR", 3, 0.4), ("CG2", "B", "THR", 3, 0.4)]


def proteins():
    random = np.random.default_rng(11)
    places = random.uniform(1, 19, (len(SERINE), 3)).round(3)
    rows = [PDB_ATOM.format(at + 1, f" {name:<3s}", alt, residue, "A", number, *place, occupancy or 1.0, 10.0, name[0])
            for at, ((name, alt, residue, number, occupancy), place) in enumerate(zip(SERINE, places))]
    cell = "CRYST1   20.000   21.000   22.000  90.00 101.50  90.00 P 1 21 1      2\n"
    (OUT / "alternates.pdb").write_text(cell + "\n".join(rows) + "\nEND\n")
    structure = gemmi.read_structure(str(OUT / "alternates.pdb"))
    structure.make_mmcif_document().write_file(str(OUT / "alternates.cif"))
    binary_cif()
    models = "".join(f"MODEL     {model + 1:4d}\n" + "\n".join(rows[:2 + model]) + "\nENDMDL\n" for model in range(3))
    (OUT / "models.pdb").write_text(cell + models + "END\n")
    import MDAnalysis
    atoms = water()
    universe = MDAnalysis.Universe.empty(len(atoms), n_residues=4, atom_resindex=np.repeat(range(4), 3), trajectory=True)
    universe.add_TopologyAttr("names", ["OW", "HW1", "HW2"] * 4)
    universe.add_TopologyAttr("resnames", ["SOL"] * 4)
    universe.add_TopologyAttr("resids", range(1, 5))
    universe.atoms.positions = atoms.positions
    universe.dimensions = atoms.cell.cellpar()
    universe.atoms.write(str(OUT / "water.gro"))
    universe.atoms.write(str(OUT / "water.pdb"))


def binary_cif():
    """`alternates.cif`, with the encodings that biotite finds best for each column."""
    from biotite.structure.io import pdbx
    block = pdbx.CIFFile.read(str(OUT / "alternates.cif")).block
    file = pdbx.BinaryCIFFile()
    file["alternates"] = pdbx.BinaryCIFBlock()
    for name, category in block.items():
        file["alternates"][name] = pdbx.BinaryCIFCategory({
            key: pdbx.BinaryCIFColumn(column_data(column), column.mask and pdbx.BinaryCIFData(column.mask.array))
            for key, column in category.items()
        })
    pdbx.compress(file).write(str(OUT / "alternates.bcif"))


def column_data(column):
    from biotite.structure.io import pdbx
    for kind in (int, float, str):
        try:
            return pdbx.BinaryCIFData(column.as_array(kind))
        except ValueError:
            continue


def amber():
    """A restart file with velocities and a box."""
    from parmed.amber import AmberAsciiRestart
    atoms = water()
    file = AmberAsciiRestart(str(OUT / "water.rst7"), "w", natom=len(atoms), title="four molecules", time=12.5)
    file.coordinates = atoms.positions
    file.velocities = np.full((len(atoms), 3), 0.25)
    file.box = atoms.cell.cellpar()
    file.close()


def namd():
    """Binary coordinates."""
    import MDAnalysis
    from MDAnalysis.coordinates.NAMDBIN import NAMDBINWriter
    atoms = MDAnalysis.Universe.empty(len(water()), trajectory=True).atoms
    atoms.positions = water().positions
    with NAMDBINWriter(str(OUT / "water.coor"), len(atoms)) as file:
        file.write(atoms)


def ase_trajectory():
    atoms = water()
    with ase.io.Trajectory(OUT / "water.traj", "w") as file:
        for step in range(3):
            atoms.set_velocities(np.full((len(atoms), 3), 0.01 * step))
            file.write(atoms)
            atoms.positions += 0.25
            atoms.set_cell(atoms.cell * 1.01)


def binary():
    random = np.random.default_rng(3)
    places = random.uniform(-2, 2, (10, 3)).astype(np.float32)
    frame = gsd.hoomd.Frame()
    frame.particles.N = 10
    frame.particles.position = places
    frame.particles.types = ["A", "B"]
    frame.particles.typeid = [0, 1] * 5
    frame.particles.diameter = random.uniform(0.5, 1.0, 10)
    frame.configuration.box = [5, 6, 7, 0.1, -0.2, 0.3]
    with gsd.hoomd.open(OUT / "spheres.gsd", "w") as file:
        for step in range(2):
            frame.configuration.step = step * 10
            frame.particles.position = places + 0.1 * step
            file.append(frame)
    frame.particles.orientation = np.tile([0.6, 0.8, 0, 0], (10, 1))
    frame.particles.type_shapes = [{"type": "Sphere", "diameter": 1.0},
                                   {"type": "Ellipsoid", "a": 1.0, "b": 0.5, "c": 0.5}]
    frame.bonds.N = 2
    frame.bonds.types = ["bond"]
    frame.bonds.group = [[0, 1], [1, 2]]
    with gsd.hoomd.open(OUT / "bonds.gsd", "w") as file:
        file.append(frame)
    np.save(OUT / "rows.npy", places.astype(np.float64))
    np.save(OUT / "frames.npy", np.stack([places, places + 1]))
    box = np.array([5, 6, 7, 0.1, -0.2, 0.3])
    np.savez(OUT / "box.npz", position=places, radius=np.linspace(0.1, 0.5, 10), box=box)
    np.savez(OUT / "rods.npz", position=places, orientation=np.tile([1.0, 0, 0, 0], (10, 1)), mass=np.ones(10),
             bonds=np.array([[0, 1], [1, 2]]), notes=np.arange(7))
    np.savez(OUT / "matrix.npz", positions=places.astype(">f8"), box=np.array([[5, 0, 0], [0.5, 6, 0], [0, 0, 7.0]]))
    radii = np.linspace(0.1, 0.5, 10)
    table = np.column_stack([places, radii])
    np.savetxt(OUT / "columns.csv", table, delimiter=",", header="x,y,z,radius", comments="", fmt="%.6f")
    np.savetxt(OUT / "rows.txt", table, fmt="%.6f")
    from plyfile import PlyData, PlyElement
    vertices = np.array([tuple(row) for row in places], dtype=[("x", "f4"), ("y", "f4"), ("z", "f4")])
    faces = np.array([([0, 1, 2],), ([2, 3, 4],)], dtype=[("vertex_indices", "i4", (3,))])
    elements = [PlyElement.describe(vertices, "vertex"), PlyElement.describe(faces, "face")]
    PlyData(elements, text=True).write(str(OUT / "text.ply"))
    PlyData(elements, byte_order="<").write(str(OUT / "little.ply"))
    PlyData(elements[::-1], byte_order=">").write(str(OUT / "big.ply"))


def space_groups():
    """Orders and structure factors of all settings, by gemmi."""
    table = Path(__file__).resolve().parents[2] / "crates/particles/src/cif/space_groups.txt"
    lines = ["number;hall;operations;re_123;im_123;re_428;im_428"]
    for line in filter(None, table.read_text().splitlines()):
        number, hall, _ = line.split("\t")
        operations = list(gemmi.symops_from_hall(hall))
        factors = []
        for index in [(1, 2, 3), (4, 2, 8)]:
            images = [operation.apply_to_xyz([0.0613, 0.1327, 0.2719]) for operation in operations]
            factor = sum(np.exp(2j * np.pi * np.dot(index, image)) for image in images)
            factors += [f"{factor.real:.3f}", f"{factor.imag:.3f}"]
        lines.append(";".join([number, hall, str(len(operations)), *factors]).replace("-0.000", "0.000"))
    (OUT / "space_groups.csv").write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    sys.exit(main())
