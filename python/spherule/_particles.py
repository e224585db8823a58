"""Particles in NumPy columns, and the files that they come from."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from . import _arrays, _values
from ._errors import Error, from_call, warn

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt

#: Units of length.
UNITS = ("unknown", "angstrom", "nanometer", "bohr", "micrometer", "centimeter", "meter")

Cell = tuple[tuple[float, float, float], tuple[tuple[float, float, float], ...], tuple[bool, bool, bool]]


def _triple(name: str, value: Any) -> tuple[float, float, float]:
    array = _arrays.floats(name, value)
    if array.shape != (3,):
        raise Error(f"`{name}` has the shape {array.shape}, but must have (3,)")
    return (float(array[0]), float(array[1]), float(array[2]))


def _periodic(value: Any) -> tuple[bool, bool, bool]:
    import numpy as np

    array = np.asarray(value)
    if array.dtype.kind not in "biu":
        raise Error(f"`periodic` is {_values.shown(value)}, but must be True or False, or three of these")
    if array.shape == ():
        return (bool(array),) * 3
    if array.shape != (3,):
        raise Error(f"`periodic` has the shape {array.shape}, but must have (3,): one flag for each edge of the cell")
    return (bool(array[0]), bool(array[1]), bool(array[2]))


def _cell(cell: Any, origin: Any, periodic: Any) -> Cell | None:
    """A cell from three edges, three lengths, or three lengths and three angles in degrees."""
    import numpy as np

    if cell is None:
        return None
    edges = _arrays.floats("cell", cell).astype(np.float64)
    if edges.shape == (6,):
        lengths, (alpha, beta, gamma) = edges[:3], edges[3:]
        cosines = [0.0 if angle == 90.0 else float(np.cos(np.radians(angle))) for angle in (alpha, beta, gamma)]
        sine = float(np.sqrt(1.0 - cosines[2] ** 2))
        tilt = (cosines[0] - cosines[1] * cosines[2]) / sine if sine else float("nan")
        height = float(np.sqrt(max(0.0, 1.0 - cosines[1] ** 2 - tilt**2)))
        rows = np.array([[1.0, 0.0, 0.0], [cosines[2], sine, 0.0], [cosines[1], tilt, height]])
        edges = rows * lengths[:, None]
    elif edges.shape == (3,):
        edges = np.diag(edges)
    if edges.shape != (3, 3):
        raise Error(f"`cell` has the shape {edges.shape}, but must have (3,), (6,) or (3, 3)")
    a, b, c = (_triple("cell", row) for row in edges)
    return _triple("origin", origin), (a, b, c), _periodic(periodic)


class Particles:
    """Particles in columns: row ``i`` of each belongs to particle ``i``.

    Args:
        positions: (n, 3) numbers, or a tuple of the columns x, y and z; any unit of length.
        radius: One number or (n,), more than 0, in the unit of the positions.
        semi_axes: (n, 3) numbers that make particles ellipsoids, or three zeros for a sphere; or one triple for all. The
            radius is that of the longest semi-axis, and one that is given scales all three.
        orientation: (n, 4) quaternions w, x, y, z of any length but 0, which turn ellipsoids.
        color: A CSS color, ``"#rrggbb"``, a list of those, or (n, 3): floats are linear RGB from 0 to 1, uint8 are
            sRGB codes.
        kinds: (n,) strings or integers: the types. Symbols of elements give radii and colors.
        elements: The symbol of the element of each distinct kind, in the order in which the kinds first occur, where
            their names are no symbols.
        materials: A name or (n,) names of materials.
        columns: Other columns by name, (n,) numbers or strings each, for colors and selections.
        cell: The periodic cell: three edges (3, 3), three lengths (3,), or lengths and angles in degrees (6,).
        bonds: (m, 2) rows of bonded particles, which models with sticks draw: those of the source, without which bonds
            are found by distance.
        bond_shifts: (m, 3) integers, -127 to 127: the edges of the cell to add to the second particle of each bond; by
            default those to its nearest image.
        origin: The corner of the cell at which its edges begin.
        periodic: Whether the simulation is periodic along each edge.
        title, step, time, unit: Facts of the frame. The unit scales the radii of elements: ``"angstrom"``,
            ``"nanometer"``, ``"bohr"``, ``"micrometer"``, ``"centimeter"``, ``"meter"`` or ``"unknown"``, which counts
            as angstrom.

    Raises:
        Error: A wrong shape, length or type, by name.

    Example:
        >>> water = Particles([[0, 0, 0], [0.96, 0, 0], [-0.24, 0.93, 0]], kinds=["O", "H", "H"])
        >>> len(water), water.kinds.tolist()
        (3, ['O', 'H', 'H'])
    """

    positions: npt.NDArray[Any]
    radius: npt.NDArray[Any] | None
    semi_axes: npt.NDArray[Any] | None
    orientation: npt.NDArray[Any] | None
    color: npt.NDArray[Any] | None
    columns: dict[str, npt.NDArray[Any]]
    cell: Cell | None
    bonds: npt.NDArray[np.uint32] | None
    bond_shifts: npt.NDArray[np.int8] | None
    title: str
    step: int | None
    time: float | None
    unit: str
    format: str | None
    warnings: list[str]
    _kinds: tuple[list[str], npt.NDArray[np.uint32]] | None
    _elements: list[str | None]
    _element_from: list[str]
    _virtual_sites: list[bool]
    #: The choices that all frames of the file have in common, and the positions for which they hold.
    _first_frame: tuple[dict[str, Any], npt.NDArray[Any]] | None
    _materials: tuple[list[str], npt.NDArray[np.uint32]] | None

    @from_call
    def __init__(
        self,
        positions: Any,
        *,
        radius: Any = None,
        semi_axes: Any = None,
        orientation: Any = None,
        color: Any = None,
        kinds: Any = None,
        elements: Sequence[str | None] | None = None,
        materials: Any = None,
        columns: Mapping[str, Any] | None = None,
        bonds: Any = None,
        bond_shifts: Any = None,
        cell: Any = None,
        origin: Any = (0.0, 0.0, 0.0),
        periodic: Any = True,
        title: str = "",
        step: int | None = None,
        time: float | None = None,
        unit: str = "unknown",
    ) -> None:
        from . import _native

        self.positions = _arrays.table("positions", positions)
        count = len(self.positions)
        self.radius = None if radius is None else _arrays.column("radius", radius, count)
        self.semi_axes, self.orientation = _arrays.shapes(semi_axes, orientation, count)
        self.color = None if color is None else _arrays.colors("color", color, count)
        self._kinds = None if kinds is None else _arrays.coded("kinds", kinds, count)
        if elements is not None and (self._kinds is None or len(elements) != len(self._kinds[0])):
            raise Error("`elements` must have an entry for each distinct kind, in the order of first occurrence")
        names = self._kinds[0] if self._kinds else []
        self._elements = list(elements) if elements is not None else [_native.element_of(name) for name in names]
        source = "symbol" if elements is None else "given"
        self._element_from = [source if element else "" for element in self._elements]
        self._virtual_sites = []
        self._first_frame = None
        self.bonds, self.bond_shifts = None, None
        if bonds is not None:
            self.bonds, self.bond_shifts = _arrays.bonds(bonds, bond_shifts, count)
        elif bond_shifts is not None:
            raise Error("`bond_shifts` needs `bonds`")
        self._materials = None if materials is None else _arrays.coded("materials", materials, count)
        self.columns = {}
        for name, values in _values.table("columns", {} if columns is None else columns).items():
            self.columns[name] = _column(name, values, count)
        self.cell = _cell(cell, origin, periodic)
        self.title = _values.text("title", title)
        self.step = None if step is None else _values.integer("step", step)
        self.time = None if time is None else _values.number("time", time)
        self.unit = _values.word("unit", unit, UNITS)
        self.format = None
        self.warnings = []

    def __len__(self) -> int:
        return len(self.positions)

    def __repr__(self) -> str:
        facts = [f"{len(self)} particles"]
        if self._kinds:
            facts.append("kinds " + ", ".join(self._kinds[0][:5]) + (", ..." if len(self._kinds[0]) > 5 else ""))
        if self.columns:
            facts.append("columns " + ", ".join(self.columns))
        if self.semi_axes is not None:
            facts.append(f"{int((self.semi_axes > 0).all(axis=1).sum())} ellipsoids")
        if self.bonds is not None:
            facts.append(f"{len(self.bonds)} bonds")
        if self.cell:
            facts.append("periodic cell" if any(self.cell[2]) else "cell")
        return f"<spherule.Particles: {'; '.join(facts)}>"

    @property
    def x(self) -> npt.NDArray[Any]:
        """The first coordinates, (n,)."""
        return self.positions[:, 0]

    @property
    def y(self) -> npt.NDArray[Any]:
        """The second coordinates, (n,)."""
        return self.positions[:, 1]

    @property
    def z(self) -> npt.NDArray[Any]:
        """The third coordinates, (n,)."""
        return self.positions[:, 2]

    @property
    def kinds(self) -> npt.NDArray[np.str_] | None:
        """The name of the type of each particle, (n,), or None."""
        return _texts(self._kinds)

    @property
    def elements(self) -> npt.NDArray[np.str_] | None:
        """The symbol of the element of each particle, (n,), empty where it is unknown; None without types."""
        if self._kinds is None:
            return None
        return _texts(([element or "" for element in self._elements], self._kinds[1]))

    @property
    def element_from(self) -> npt.NDArray[np.str_] | None:
        """The fact from which the element of each particle is known, (n,), or None without types: ``"symbol"``,
        ``"atomic number"``, ``"name"`` (of the atom and its residue), ``"type"``, ``"mass"``, or ``"given"`` as
        ``elements``; empty where it is unknown."""
        return _texts(None if self._kinds is None else (self._element_from, self._kinds[1]))

    @property
    def materials(self) -> npt.NDArray[np.str_] | None:
        """The name of the material of each particle, (n,), or None."""
        return _texts(self._materials)

    def _table(self, radii: str | None, radius_scale: float) -> dict[str, Any]:
        """The columns for the extension module."""
        numbers, texts = [], []
        first_frame, positions = self._first_frame or (None, None)
        if positions is not self.positions:
            first_frame = None
        for name, values in self.columns.items():
            if values.dtype.kind == "U":
                texts.append((name, _arrays.coded(name, values, len(self))))
            else:
                numbers.append((name, values))
        return {
            "positions": self.positions,
            "radii": radii,
            "radius": self.radius,
            "radius_scale": radius_scale,
            "semi_axes": self.semi_axes,
            "orientation": self.orientation,
            "color": self.color,
            "kinds": self._kinds,
            "elements": self._elements,
            "virtual_sites": self._virtual_sites,
            "first_frame": first_frame,
            "bonds": None if self.bonds is None else _arrays.bonds(self.bonds, self.bond_shifts, len(self)),
            "format": self.format,
            "materials": self._materials,
            "numbers": numbers,
            "texts": texts,
            "cell": self.cell,
            "title": self.title,
            "unit": self.unit,
        }


def _texts(coded: tuple[list[str], npt.NDArray[np.uint32]] | None) -> npt.NDArray[np.str_] | None:
    import numpy as np

    return None if coded is None else np.array(coded[0], np.str_)[coded[1]]


def _column(name: str, values: Any, count: int) -> npt.NDArray[Any]:
    """A column of numbers or of strings."""
    import numpy as np

    _arrays.refuse_masked(name, values)
    array = np.asarray(values)
    if array.dtype.kind in "OS":
        array = np.array([item.decode() if isinstance(item, bytes) else str(item) for item in array.tolist()], np.str_)
    if array.dtype.kind != "U":
        return _arrays.column(name, array, count)
    if array.shape != (count,):
        raise Error(f"`{name}` has the shape {array.shape}, but must have ({count},), one entry for each position")
    return array


def _options(
    format: str | None,
    columns: str | None,
    atom_style: str | None,
    topology: str | os.PathLike[str] | None,
    elements: Mapping[str, str] | None = None,
    bonds: str | None = None,
) -> dict[str, Any]:
    path = None if topology is None else _values.path("topology", topology)
    for name, value in (("format", format), ("columns", columns), ("atom_style", atom_style), ("bonds", bonds)):
        if value is not None:
            _values.text(name, value)
    given = _values.table("elements", {} if elements is None else elements)
    symbols = [(name, _values.text(f'elements["{name}"]', symbol)) for name, symbol in given.items()]
    return {
        "format": format,
        "columns": columns,
        "atom_style": atom_style,
        "topology": path,
        "elements": symbols,
        "bonds": bonds,
    }


@from_call
def read(
    path: str | os.PathLike[str],
    frame: int = 0,
    *,
    format: str | None = None,
    columns: str | None = None,
    atom_style: str | None = None,
    topology: str | os.PathLike[str] | None = None,
    elements: Mapping[str, str] | None = None,
    bonds: str | None = None,
) -> Particles:
    """Reads a frame of a particle file into NumPy columns.

    All formats of the program are read, compressed or not: XYZ, LAMMPS dumps and data, GRO, PDB, mmCIF, CIF, GSD, PLY,
    NPY, NPZ, CSV, plain columns, PQR, POSCAR, SDF, MOL2, XSF, CFG, HDF5 of Gadget, and the trajectories DCD, XTC, TRR,
    NetCDF of Amber and H5MD.

    Args:
        path: The file.
        frame: The number of the frame, from 0; -1 is the last one.
        format: The format; by default it is found by the content.
        columns: Roles of columns, as in ``"x=px,type=species"``.
        atom_style: The atom style of a LAMMPS data file, as ``"full"``.
        topology: The file that names the particles of a trajectory.
        elements: Symbols of the elements of types, by their names, where the file does not tell or tells others, as in
            ``{"1": "Si", "2": "O"}``.
        bonds: Whether bonds are read: ``"file"`` for those of the file, ``"auto"`` for those or else by covalent radii,
            or rules such as ``"C-C<1.7"``; by default none are.

    Returns:
        All columns in the file's units, nothing scaled or dropped. Numbers are float64.

    Raises:
        Error: The file cannot be read, or is malformed: the text names the line.

    Example:
        >>> import pathlib, tempfile
        >>> path = pathlib.Path(tempfile.mkdtemp()) / "water.xyz"
        >>> _ = path.write_text("3\\nwater\\nO 0 0 0\\nH 0.96 0 0\\nH -0.24 0.93 0\\n")
        >>> water = read(path)
        >>> water.x.tolist(), water.elements.tolist()
        ([0.0, 0.96, -0.24], ['O', 'H', 'H'])
    """
    from . import _native

    frame = _values.integer("frame", frame, -(2**63), 2**63 - 1)
    options = _options(format, columns, atom_style, topology, elements, bonds)
    name = _values.path("path", path)
    return _particles(name, _native.read(name, frame, options))


def _particles(name: str, table: dict[str, Any]) -> Particles:
    """The particles of a frame that was read from the file of this name."""
    particles = Particles.__new__(Particles)
    particles.positions = table["positions"].T
    particles.radius, particles.color = table["radius"], table["color"]
    particles.semi_axes, particles.orientation = table["semi_axes"], table["orientation"]
    particles._kinds, particles._elements = table["kinds"], table["elements"]
    particles._element_from = table["element_from"]
    particles._materials, particles._virtual_sites = table["materials"], table["virtual_sites"]
    particles._first_frame = (table["first_frame"], particles.positions) if table["first_frame"] else None
    particles.bonds, particles.bond_shifts = table["bonds"] or (None, None)
    particles.columns = dict(table["numbers"])
    for label, texts in table["texts"].items():
        column = _texts(texts)
        if column is not None:
            particles.columns[label] = column
    particles.cell = table["cell"]
    particles.title, particles.step, particles.time = table["title"], table["step"], table["time"]
    particles.unit, particles.format = table["unit"], table["format"]
    particles.warnings = [text.replace("--frame chooses", "`frame` chooses") for text in table["warnings"]]
    for text in particles.warnings:
        if "`frame` chooses" not in text:
            warn(f"{name}: {text}")
    return particles


@from_call
def count_frames(
    path: str | os.PathLike[str],
    *,
    format: str | None = None,
    columns: str | None = None,
    atom_style: str | None = None,
    topology: str | os.PathLike[str] | None = None,
) -> int:
    """The number of complete frames of a particle file.

    Args:
        path, format, columns, atom_style, topology: As for :func:`read`.

    Raises:
        Error: The file cannot be read, or its format is unknown.

    Example:
        >>> import pathlib, tempfile
        >>> path = pathlib.Path(tempfile.mkdtemp()) / "two.xyz"
        >>> _ = path.write_text("1\\n\\nHe 0 0 0\\n1\\n\\nHe 1 0 0\\n")
        >>> count_frames(path)
        2
    """
    from . import _native

    return _native.count_frames(_values.path("path", path), _options(format, columns, atom_style, topology))


def frames(
    path: str | os.PathLike[str],
    *,
    format: str | None = None,
    columns: str | None = None,
    atom_style: str | None = None,
    topology: str | os.PathLike[str] | None = None,
    elements: Mapping[str, str] | None = None,
    bonds: str | None = None,
) -> Iterator[Particles]:
    """The frames of a particle file, one after the other. Up to two are read ahead while one is used.

    Args:
        path, format, columns, atom_style, topology, elements, bonds: As for :func:`read`.

    Raises:
        Error: As for :func:`read`.

    Example:
        >>> import pathlib, tempfile
        >>> path = pathlib.Path(tempfile.mkdtemp()) / "two.xyz"
        >>> _ = path.write_text("1\\n\\nHe 0 0 0\\n1\\n\\nHe 1 0 0\\n")
        >>> [float(frame.x[0]) for frame in frames(path)]
        [0.0, 1.0]
    """
    from . import _native

    name = _values.path("path", path)
    file = _native.FrameFile(name, _options(format, columns, atom_style, topology, elements, bonds))
    for number in range(file.count()):
        yield _particles(name, file.read(number))
