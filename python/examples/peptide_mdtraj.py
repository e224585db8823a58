"""A peptide from mdtraj, whose side chains are balls and sticks along a backbone of licorice.

The helix is built here, by ideal angles of its backbone, with a carbon for each side chain. Run it with mdtraj installed; it writes
peptide_mdtraj.png.
"""

from pathlib import Path

import mdtraj
import numpy as np

import spherule

#: Atoms of a residue of an alpha helix: distance from the axis in nanometers, angle in degrees and height in nanometers.
RESIDUE = {"N": (0.155, -27.3, -0.086), "CA": (0.228, 0.0, 0.0), "C": (0.161, 26.3, 0.108), "O": (0.174, 25.9, 0.232), "CB": (0.329, -17.9, 0.034)}  # fmt: skip


def helix(residues: int) -> mdtraj.Trajectory:
    """Alanines in a helix, 100 degrees and 0.15 nanometers apart."""
    topology, positions = mdtraj.Topology(), []
    chain = topology.add_chain()
    before = None
    for number in range(residues):
        residue = topology.add_residue("ALA", chain)
        atoms = {name: topology.add_atom(name, mdtraj.element.get_by_symbol(name[0]), residue) for name in RESIDUE}
        for radius, angle, height in RESIDUE.values():
            turn = np.radians(angle + 100 * number)
            positions.append((radius * np.cos(turn), radius * np.sin(turn), height + 0.15 * number))
        for a, b in (("N", "CA"), ("CA", "C"), ("C", "O"), ("CA", "CB")):
            topology.add_bond(atoms[a], atoms[b])
        if before is not None:
            topology.add_bond(before, atoms["N"])
        before = atoms["C"]
    return mdtraj.Trajectory(np.array([positions]), topology)


def main() -> None:
    """Renders the helix."""
    picture = spherule.render(
        helix(18),
        model="licorice",
        styles={"name CB": {"model": "ball-and-stick", "color": "orange"}, "name O": {"model": "ball-and-stick"}},
        view="x",
        up="z",
        size=(360, 640),
        spp=32,
        denoise="on",
    )
    picture.save(Path(__file__).with_suffix(".png"))


if __name__ == "__main__":
    main()
