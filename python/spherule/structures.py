"""Particles of mdtraj and pymatgen, which are imported by whoever has them."""

from __future__ import annotations

from typing import Any

from ._attributes import components, need, optional
from ._errors import Error, from_call, warn
from ._particles import Particles


@from_call
def from_mdtraj(trajectory: Any, frame: int = 0) -> Particles:
    """The particles of a frame of an mdtraj ``Trajectory``, in nanometers.

    Elements, bonds and the cell are kept; names, residues and chains become columns.

    Args:
        trajectory: ``mdtraj.Trajectory``.
        frame: The number of the frame, from 0; -1 is the last one.

    Raises:
        Error: It is something else, or has no such frame.

    Example:
        >>> import mdtraj
        >>> topology = mdtraj.Topology()
        >>> water = topology.add_residue("HOH", topology.add_chain())
        >>> atoms = [topology.add_atom(name, mdtraj.element.get_by_symbol(name), water) for name in "OH"]
        >>> topology.add_bond(*atoms)
        >>> particles = from_mdtraj(mdtraj.Trajectory([[[0, 0, 0], [0.096, 0, 0]]], topology))
        >>> particles.elements.tolist(), particles.bonds.tolist(), particles.unit
        (['O', 'H'], [[0, 1]], 'nanometer')
    """
    import numpy as np

    what = "an mdtraj Trajectory"
    positions = need(trajectory, "xyz", what)
    count = len(positions)
    if not -count <= frame < count:
        raise Error(f"`frame` is {frame}, but the trajectory has {count} frames")
    columns: dict[str, Any] = {}
    kinds = elements = bonds = None
    topology = optional(trajectory, "topology")
    if topology is not None:
        atoms = list(topology.atoms)
        symbols = [optional(optional(atom, "element"), "symbol") or "" for atom in atoms]
        # Virtual sites have no element, but a name.
        kinds = [atom.name if symbol in ("", "VS") else symbol for atom, symbol in zip(atoms, symbols)]
        known = {kind: None if symbol in ("", "VS") else symbol for kind, symbol in zip(kinds, symbols)}
        elements = [known[kind] for kind in dict.fromkeys(kinds)]
        columns = {
            "name": [atom.name for atom in atoms],
            "resname": [atom.residue.name for atom in atoms],
            "resid": np.array([atom.residue.resSeq for atom in atoms], np.int64),
            "chain": [str(optional(atom.residue.chain, "chain_id") or atom.residue.chain.index) for atom in atoms],
        }
        pairs = [(bond[0].index, bond[1].index) for bond in topology.bonds]
        bonds = pairs or None
    cells, times = optional(trajectory, "unitcell_vectors"), optional(trajectory, "time")
    return Particles(
        np.asarray(positions)[frame],
        kinds=kinds,
        elements=elements,
        columns=columns,
        bonds=bonds,
        cell=None if cells is None else np.asarray(cells)[frame],
        unit="nanometer",
        step=frame % count,
        time=None if times is None else float(times[frame]),
    )


@from_call
def from_pymatgen(structure: Any) -> Particles:
    """The particles of a pymatgen ``Structure`` or ``Molecule``, in angstrom: elements, the cell, and properties of sites as
    columns.

    A site that several elements share is drawn as the one that is most often there, with a warning.

    Args:
        structure: ``pymatgen.core.Structure`` or ``Molecule``.

    Raises:
        Error: It is something else.

    Example:
        >>> from pymatgen.core import Lattice, Structure
        >>> salt = Structure.from_spacegroup("Fm-3m", Lattice.cubic(5.64), ["Na", "Cl"], [[0, 0, 0], [0.5, 0.5, 0.5]])
        >>> particles = from_pymatgen(salt)
        >>> len(particles), particles.elements.tolist()[4], particles.cell[1][0]
        (8, 'Cl', (5.64, 0.0, 0.0))
    """
    import numpy as np

    what = "a pymatgen Structure or Molecule"
    sites = list(need(structure, "sites", what))
    mixed = 0
    kinds, occupancy = [], []
    for site in sites:
        shares = sorted(need(site, "species", what).items(), key=lambda pair: -pair[1])
        kinds.append(str(getattr(shares[0][0], "symbol", shares[0][0])))
        occupancy.append(float(sum(share for _, share in shares)))
        mixed += len(shares) > 1
    if mixed:
        warn(f"{mixed} sites are shared by several elements; drawn is the most frequent one of each")
    columns: dict[str, Any] = {}
    for name, values in (optional(structure, "site_properties") or {}).items():
        if not any(value is None for value in values) and np.asarray(values).dtype.kind in "fiubU":
            columns.update(components(name, values))
    if any(share != 1 for share in occupancy):
        columns["occupancy"] = np.array(occupancy)
    lattice = optional(structure, "lattice")
    return Particles(
        np.asarray(need(structure, "cart_coords", what), np.float64).reshape(-1, 3),
        kinds=kinds,
        columns=columns,
        cell=None if lattice is None else np.asarray(lattice.matrix),
        periodic=True if lattice is None else np.asarray(optional(lattice, "pbc") or (True, True, True)),
        unit="angstrom",
    )
