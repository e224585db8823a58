"""Particles of other packages, which are imported by whoever has them: here only their attributes are read."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from ._attributes import components, need, optional
from ._errors import Error, from_call
from ._particles import Particles
from .structures import from_mdtraj, from_pymatgen

#: Names of columns of data frames, by role.
_COORDINATES = (
    ("x", "y", "z"),
    ("X", "Y", "Z"),
    ("pos_x", "pos_y", "pos_z"),
    ("xu", "yu", "zu"),
    ("x_coord", "y_coord", "z_coord"),
)
_KINDS = ("type", "element", "element_symbol", "species", "kind", "atom_name")


@from_call
def from_ase(atoms: Any) -> Particles:
    """The particles of ASE's ``Atoms``: positions in angstrom, elements, the cell, and its per-atom arrays as columns.

    Args:
        atoms: ``ase.Atoms``.

    Raises:
        Error: It is something else.

    Example:
        >>> from ase.build import bulk
        >>> copper = from_ase(bulk("Cu", cubic=True))
        >>> len(copper), copper.elements.tolist()[0], copper.cell[2]
        (4, 'Cu', (True, True, True))
    """
    import numpy as np

    what = "ase.Atoms"
    positions = need(atoms, "positions", what)
    symbols = need(atoms, "get_chemical_symbols", what)()
    cell = np.asarray(need(atoms, "cell", what)[:])
    columns = {}
    for name, values in getattr(atoms, "arrays", {}).items():
        if name not in ("positions", "numbers"):
            columns.update(components(name, values))
    has_cell = bool(abs(np.linalg.det(cell)) > 0)
    return Particles(
        positions,
        kinds=symbols,
        columns=columns,
        cell=cell if has_cell else None,
        periodic=np.asarray(need(atoms, "pbc", what)),
        unit="angstrom",
    )


@from_call
def from_mdanalysis(group: Any) -> Particles:
    """The particles of an MDAnalysis ``Universe`` or ``AtomGroup``, in its current frame, in angstrom.

    Elements are those of the topology, or else follow from the types and names. The cell and bonds are kept, and
    names, residues and charges become columns where the topology has them.

    Args:
        group: ``MDAnalysis.Universe`` or ``AtomGroup``.

    Raises:
        Error: It is something else.

    Example:
        >>> import MDAnalysis
        >>> universe = MDAnalysis.Universe.empty(2, trajectory=True)
        >>> universe.add_TopologyAttr("elements", ["O", "H"])
        >>> universe.atoms.positions = [[0, 0, 0], [0.96, 0, 0]]
        >>> from_mdanalysis(universe).elements.tolist()
        ['O', 'H']
    """
    import numpy as np

    from . import _native

    atoms = need(group, "atoms", "an MDAnalysis Universe or AtomGroup")
    kinds = elements = None
    for name in ("elements", "types", "names"):
        values = optional(atoms, name)
        if values is not None and any(str(value) for value in values):
            kinds = [str(value) for value in values]
            break
    if kinds is not None:
        distinct = list(dict.fromkeys(kinds))
        elements = [_native.element_of(name) or _native.element_of(name.rstrip("0123456789*+-'")) for name in distinct]
    columns = {}
    for name, column in (
        ("names", "name"),
        ("resnames", "resname"),
        ("resids", "resid"),
        ("chainIDs", "chain"),
        ("segids", "segid"),
        ("charges", "charge"),
        ("masses", "mass"),
    ):
        values = optional(atoms, name)
        if values is not None:
            columns[column] = values
    box = optional(atoms, "dimensions")
    has_cell = box is not None and bool(np.all(np.asarray(box)[:3] > 0))
    timestep = optional(optional(atoms, "universe"), "trajectory")
    # Rows of the universe as rows of the group; bonds to atoms outside of it are left out.
    bonds = optional(optional(atoms, "bonds"), "indices")
    if bonds is not None:
        places = {int(index): row for row, index in enumerate(atoms.indices)}
        bonds = [(places[a], places[b]) for a, b in np.asarray(bonds).tolist() if a in places and b in places]
    return Particles(
        need(atoms, "positions", "an MDAnalysis Universe or AtomGroup"),
        kinds=kinds,
        elements=elements,
        columns=columns,
        bonds=bonds,
        cell=box if has_cell else None,
        unit="angstrom",
        step=optional(timestep, "frame"),
        time=optional(timestep, "time"),
    )


@from_call
def from_ovito(data: Any) -> Particles:
    """The particles of OVITO's ``DataCollection``, as ``pipeline.compute()`` returns it.

    Positions, types with their names, radii, shapes and colors of particles, or else of their types, bonds, the cell, the time
    step, and all other properties as columns. OVITO's colors are those of the screen: they are taken as sRGB.

    Args:
        data: ``ovito.data.DataCollection``.

    Raises:
        Error: It is something else, or has no particles.

    Example:
        >>> from ovito.data import DataCollection
        >>> data = DataCollection()
        >>> particles = data.create_particles(count=2)
        >>> _ = particles.create_property("Position", data=[[0, 0, 0], [1, 0, 0]])
        >>> _ = particles.create_property("Radius", data=[0.5, 0.25])
        >>> from_ovito(data).radius.tolist()
        [0.5, 0.25]
    """
    import numpy as np

    from . import _native

    found = need(data, "particles", "an OVITO DataCollection")
    if found is None:
        raise Error("the OVITO DataCollection has no particles")
    properties = {name: found[name] for name in found.keys()}
    if "Position" not in properties:
        raise Error("the OVITO particles have no property `Position`")
    count = len(np.asarray(properties["Position"]))
    kinds = elements = color = None
    radius = np.zeros(count)
    if "Particle Type" in properties:
        property = properties["Particle Type"]
        distinct, rows = np.unique(np.asarray(property), return_inverse=True)
        types = {int(kind.id): kind for kind in optional(property, "types") or ()}
        styles = [types.get(int(code)) for code in distinct]
        names = [str(optional(style, "name") or code) for code, style in zip(distinct, styles)]
        kinds = np.array(names, np.str_)[rows]
        elements = [_native.element_of(name) for name in dict.fromkeys(kinds.tolist())]
        radius = np.array([float(optional(style, "radius") or 0.0) for style in styles])[rows]
        known = [style for style in styles if style is not None]
        if count and len(known) == len(styles):
            color = np.array([style.color for style in known])[rows]
    if "Color" in properties:
        color = np.asarray(properties["Color"])
    if "Radius" in properties:
        own = np.asarray(properties["Radius"], np.float64)
        radius = np.where(own > 0, own, radius)
    columns = {}
    for name, property in properties.items():
        if name not in ("Position", "Particle Type", "Radius", "Color"):
            columns.update(components(name, np.asarray(property)))
    semi_axes = orientation = None
    if "Aspherical Shape" in properties and np.asarray(properties["Aspherical Shape"]).any():
        semi_axes = np.asarray(properties["Aspherical Shape"], np.float64)
        # Its longest semi-axis is the radius of an ellipsoid; the radius of OVITO is that of spheres.
        radius = np.where(semi_axes.any(axis=1), semi_axes.max(axis=1), radius)
        if "Orientation" in properties:
            orientation = np.asarray(properties["Orientation"], np.float64)[:, [3, 0, 1, 2]]
            orientation = np.where(orientation.any(axis=1, keepdims=True), orientation, [1.0, 0.0, 0.0, 0.0])
    bonds = shifts = None
    listed = optional(found, "bonds")
    if listed is not None and "Topology" in listed.keys():
        bonds = np.asarray(listed["Topology"])
        if "Periodic Image" in listed.keys():
            shifts = np.asarray(listed["Periodic Image"])
    cell = optional(data, "cell")
    matrix = None if cell is None else np.asarray(cell)
    if matrix is not None and not abs(np.linalg.det(matrix[:, :3])) > 0:
        # That of a plane.
        cell = matrix = None
    attributes = optional(data, "attributes") or {}
    return Particles(
        np.asarray(properties["Position"]),
        kinds=kinds,
        elements=elements,
        radius=radius if count and bool(np.all(radius > 0)) else None,
        semi_axes=semi_axes,
        orientation=orientation,
        bonds=bonds,
        bond_shifts=shifts,
        color=None if color is None else np.rint(np.clip(color, 0.0, 1.0) * 255.0).astype(np.uint8),
        columns=columns,
        cell=None if matrix is None else matrix[:, :3].T,
        origin=(0.0, 0.0, 0.0) if matrix is None else matrix[:, 3],
        periodic=True if cell is None else tuple(bool(flag) for flag in cell.pbc),
        step=attributes.get("Timestep"),
        time=attributes.get("Time"),
    )


@from_call
def from_gsd(frame: Any) -> Particles:
    """The particles of a frame of ``gsd.hoomd``: positions, diameters, ellipsoids, types, bonds, the box, and other properties as
    columns.

    Args:
        frame: ``gsd.hoomd.Frame``, an item of ``gsd.hoomd.open(...)``.

    Raises:
        Error: It is something else, or has no particles.

    Example:
        >>> import gsd.hoomd
        >>> frame = gsd.hoomd.Frame()
        >>> frame.particles.N = 2
        >>> frame.particles.position = [[0, 0, 0], [1, 0, 0]]
        >>> frame.particles.types, frame.particles.typeid = ["A", "B"], [0, 1]
        >>> frame.configuration.box = [4, 4, 4, 0, 0, 0]
        >>> from_gsd(frame).kinds.tolist()
        ['A', 'B']
    """
    import numpy as np

    what = "a gsd.hoomd frame"
    particles = need(frame, "particles", what)
    configuration = need(frame, "configuration", what)
    positions = need(particles, "position", what)
    if positions is None:
        raise Error("the frame of gsd has no positions")
    count = len(positions)
    names, codes = optional(particles, "types"), optional(particles, "typeid")
    kinds = None
    if names is not None and codes is not None:
        kinds = [names[int(code)] for code in codes]
    diameter = optional(particles, "diameter")
    columns: dict[str, Any] = {}
    for name in ("mass", "charge", "body", "velocity", "image", "angmom", "orientation", "moment_inertia"):
        values = optional(particles, name)
        if values is not None and len(values) == count:
            columns.update(components(name, values))
    radius = None if diameter is None or len(diameter) != count else np.asarray(diameter, np.float64) / 2
    semi_axes = None
    described = optional(particles, "type_shapes")
    if described and codes is not None:
        ellipsoids = [shape if shape.get("type") == "Ellipsoid" else {} for shape in described]
        each = np.array([[float(shape.get(axis, 0.0)) for axis in "abc"] for shape in ellipsoids])
        if each.any():
            # Types after the last one that is described are spheres.
            each = np.vstack([each, np.zeros((max(map(int, codes)) + 1, 3))])
            semi_axes = each[np.asarray(codes, np.int64)]
            if radius is not None:
                radius = np.where(semi_axes.any(axis=1), semi_axes.max(axis=1), radius)
    orientation = optional(particles, "orientation")
    bonds = optional(optional(frame, "bonds"), "group")
    cell, origin = None, np.zeros(3)
    periodic: bool | tuple[bool, bool, bool] = True
    box = optional(configuration, "box")
    if box is not None:
        lx, ly, lz, xy, xz, yz = (float(value) for value in box)
        # HOOMD-blue, "Periodic boundary conditions": the box is centered at the origin.
        flat = lz == 0.0
        edges = np.array([[lx, 0.0, 0.0], [xy * ly, ly, 0.0], [xz * lz, yz * lz, 1.0 if flat else lz]])
        cell, origin = edges, -edges.sum(axis=0) / 2
        if flat:
            periodic = (True, True, False)
    return Particles(
        positions,
        kinds=kinds,
        radius=radius,
        semi_axes=semi_axes,
        orientation=orientation if semi_axes is not None else None,
        columns=columns,
        bonds=bonds if bonds is not None and len(bonds) else None,
        cell=cell,
        origin=origin,
        periodic=periodic,
        step=optional(configuration, "step"),
    )


@from_call
def from_pandas(
    frame: Any,
    *,
    positions: Sequence[str] | None = None,
    radius: str | None = None,
    kinds: str | None = None,
    cell: Any = None,
    periodic: Any = True,
) -> Particles:
    """The particles of a data frame, a row each.

    Args:
        frame: ``pandas.DataFrame``.
        positions: The names of the columns of coordinates; by default x, y and z, in either case.
        radius: The name of the column of radii; by default ``radius``, or half of ``diameter``, if there is one.
        kinds: The name of the column of types; by default ``type``, ``element`` or ``species``.
        cell, periodic: As for :class:`Particles`.

    Raises:
        Error: It is something else, or lacks the columns.

    Example:
        >>> import pandas
        >>> table = pandas.DataFrame({"x": [0.0, 1.0], "y": 0.0, "z": 0.0, "radius": 0.5, "charge": [-1.0, 1.0]})
        >>> particles = from_pandas(table)
        >>> particles.radius.tolist(), list(particles.columns)
        ([0.5, 0.5], ['charge'])
    """
    import numpy as np

    names = [str(name) for name in need(frame, "columns", "a pandas DataFrame")]
    if positions is None:
        positions = next((triple for triple in _COORDINATES if set(triple) <= set(names)), None)
        if positions is None:
            raise Error(
                f"the data frame has no columns x, y and z; name them, as in positions=['a', 'b', 'c']: "
                f"it has {', '.join(names)}"
            )
    for name in (*positions, *(name for name in (radius, kinds) if name)):
        if name not in names:
            raise Error(f"the data frame has no column `{name}`; it has {', '.join(names)}")
    kinds = kinds or next((name for name in _KINDS if name in names), None)
    radii = None
    if radius or "radius" in names:
        radius = radius or "radius"
        radii = frame[radius].to_numpy()
    elif "diameter" in names:
        radius = "diameter"
        radii = frame["diameter"].to_numpy() / 2
    used = {*positions, radius, kinds}
    columns = {
        name: frame[name].to_numpy()
        for name in names
        if name not in used and frame[name].to_numpy().dtype.kind in "fiubOUST"
    }
    if kinds is not None and (missing := frame[kinds].isna().to_numpy()).any():
        raise Error(f"`{kinds}` is missing in row {int(missing.argmax())} of the data frame; leave such rows out")
    return Particles(
        tuple(np.asarray(frame[name].to_numpy()) for name in positions),
        radius=radii,
        kinds=None if kinds is None else frame[kinds].to_numpy(),
        columns=columns,
        cell=cell,
        periodic=periodic,
    )


#: Packages by the attributes that only their objects have, in the order in which these are looked for.
_FRIENDS = (
    ("get_chemical_symbols", from_ase),
    ("unitcell_vectors", from_mdtraj),
    ("cart_coords", from_pymatgen),
    ("atoms", from_mdanalysis),
)


def particles_of(thing: Any) -> Any:
    """The particles of an object of another package, by the attributes that only these have; anything else as it is."""
    if isinstance(thing, Particles):
        return thing
    for name, taken in _FRIENDS:
        if hasattr(thing, name):
            return taken(thing)
    if hasattr(thing, "iloc"):
        names = {str(name) for name in getattr(thing, "columns", ())}
        return from_pandas(thing) if any(names.issuperset(own) for own in _COORDINATES) else thing
    if hasattr(thing, "particles"):
        if hasattr(thing.particles, "keys"):
            return from_ovito(thing)
        return from_gsd(thing) if hasattr(thing.particles, "position") else thing
    return thing
