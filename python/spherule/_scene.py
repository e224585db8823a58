"""Scenes: particles with a style, sections as in scene files, or both."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Mapping
from typing import TYPE_CHECKING, Any

from . import _arrays, _matplotlib, _options, _toml, _values, friends
from ._errors import Error, from_call, warn
from ._particles import Particles, read

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from ._native import Scene as NativeScene
    from ._options import RenderOptions, SceneOptions
    from ._picture import Picture

    Arguments = tuple[dict[str, Any], dict[str, Any] | None, dict[str, Any], dict[str, Any]]


class Scene:
    """A scene: what is rendered, from where, in which light.

    A scene of particles looks as the program draws a particle file: the preset ``figure``, a camera that frames all
    particles, radii and colors by element or type. Sections replace parts of that; their names, keys and checks are
    those of scene files, as in ``camera={"projection": "orthographic"}`` or
    ``light=[{"kind": "sun", "direction": [1, 1, 1], "irradiance": 3}]``. Without particles, a scene consists of its
    sections alone.

    Args:
        particles: :class:`Particles`, (n, 3) positions, a tuple of the columns x, y and z, or None; or what ASE,
            MDAnalysis, OVITO, GSD and pandas have (see :func:`spherule.from_ase` and its kin).
        radius: A number or (n,) numbers, more than 0, in the unit of the positions; or ``"vdw"``, ``"covalent"`` or
            ``"ionic"``, radii of elements; or ``"column:NAME"``, of which the name may be an expression as in
            ``"column:0.3 * mass^(1/3)"``. By default the particles' own, or those of elements, or half of the
            mean spacing.
        semi_axes, orientation: Semi-axes and quaternions of ellipsoids, as for :class:`Particles`.
        color, kinds, materials, columns, cell, origin, periodic, unit, title: As for :class:`Particles`, whose own
            color and materials they replace.
        values: (n,) finite numbers that a color map turns into colors; ``label_of_values`` names them in the color bar.
        color_by: The name of a column that gives the colors, or an expression over columns, as in
            ``"norm(velocity)"`` or ``"c_pe / mass"``: ``+ - * / ^``, ``abs``, ``sqrt``, ``exp``, ``log``, ``log10``,
            ``min``, ``max`` and ``norm``.
        color_map, color_range, color_log: The map, its ends, and whether it is logarithmic. A map is a name, also of
            matplotlib, a ``Colormap`` of matplotlib, or a list of colors; a ``Normalize`` or ``LogNorm`` is a range. An end is a number, a
            percentile of the values as in ``("2%", "98%")``, or ``"auto"``. The map ``"categories"`` is a color for each
            integer; at most 12 different integers of labels such as ``cluster`` or ``mol`` have them without it.
        color_title: The title of the color bar; ``v_x`` and ``m^2`` have subscripts and superscripts.
        color_bar: True or a position, as in ``"top-left"`` or ``"right"``: draw the bar of these colors. A dict is the
            section of a scene file.
        legend, axes, scale_bar: True or a position: draw the names that colors stand for, the directions of axes
            (``"cell"`` or ``"cell:top-left"`` for those of the cell), a length (``20`` or ``"20:bottom"`` for one of
            20). A dict is the section of a scene file.
        colors: ``"jmol"`` or ``"cpk"``: colors of elements.
        types: For names of types or elements: ``{"radius": 1.2, "color": "gold", "material": "metal"}``, and
            ``"opacity"``.
        model: ``"space-filling"``, ``"ball-and-stick"`` or ``"licorice"``: whether bonds are drawn, as sticks. Without
            it and without ``bonds``, crystals from CIF, POSCAR, XSF or CFG are balls and sticks in their cell: at most
            10,000 atoms of known elements, periodic in all directions.
        polyhedra: Coordination polyhedra to draw, as in ``"Ti-O"`` or ``"Ti-O<2.5,Si-O<2"``, or a list of such: the hulls of
            the neighbors of each center, which are bonded to it or closer than a distance. ``polyhedra_opacity`` is
            that of their faces, 0.7 by default.
        bonds: ``"auto"`` for those of the particles, or else by covalent radii, of metals not across anions;
            ``"file"`` for those of the particles alone, ``"none"``, or rules such as ``"C-C<1.7,*-H<1.2"``;
            ``bond_radius`` is the radius of their sticks.
        opacity: A number from 0 to 1, or the name of a column or an expression whose numbers it is, perhaps with those
            that become 0 and 1, as in ``"charge:-1,1"``: what is behind is seen without refraction.
        arrows: Vectors to draw: (n, 3) numbers; ``"velocity"``, ``"force"``, ``"dipole"`` or ``"spin"``; three names of
            columns or expressions, or what these have in common before x, y and z. ``arrow_scale`` is the length for a
            vector of length 1, ``arrow_radius`` that of shafts, ``arrow_color`` a color for all, and ``arrow_center`` the part
            at the particle: ``"tail"``, ``"middle"`` or ``"head"``.
        hide: Do not draw particles for which this is true, as for ``select``.
        styles: Styles of selections, of which later ones win: ``{"resname ATP": {"model": "ball-and-stick", "color":
            "magenta"}}``, or texts such as ``"chain A: opacity=0.3"``. Properties are ``model``, ``color`` (a color,
            ``"element"``, or a column or an expression, with ``map``, ``range`` and ``log``), ``radius``, ``scale``,
            ``bonds``, ``bond_radius``, ``opacity``, ``polyhedra`` with ``polyhedra_opacity``, ``material`` and ``visible``.
        translucent: Draw only particles for which this is true with ``opacity`` (0.2 if that is not given).
        select: Draw only particles for which this is true, as in ``"element != H and z > 10"``.
        radius_scale: A factor on all radii.
        preset: ``"figure"``, ``"chalk"``, ``"studio"``, ``"cloudy"``, ``"glossy"``, ``"depthcue"``, ``"outline"``,
            ``"ghost"`` or ``"x-ray"``.
        background: A color, ``"transparent"`` or ``"sky"``.
        view: The direction from which the camera sees everything: ``"auto"``, ``"iso"``, ``"x"``, ``"-x"`` and so on;
            azimuth and elevation in degrees, ``(30, 20)``: (0, 0) is from x if z is up, and (90, 0) from y, as in
            matplotlib; or a vector, ``(1, 1, 0)``.
        look_at: The particles that the camera frames, as for ``select``, or a point, ``(x, y, z)``, that it looks at.
        zoom: A magnification: 2 is twice as large. ``roll`` turns the camera clockwise, in degrees.
        camera: The section, or the scene file that the camera is taken from, as the viewer saves it.
        up: The direction of particles that is up.
        wrap, replicate, show_cell: Wrap particles into the cell; repeat it; draw its edges.
        complete: Whether particles on faces, edges and corners of the cell are drawn on the opposite ones, too; by default
            for small crystals of files.
        outside: Bonds that leave the cell: ``"molecules"``, which are whole if their centers are in the cell, ``"whole"``,
            with the particles at their other ends, ``"none"``, or ``"halves"``; by default molecules in a completed cell,
            and else halves.
        slices: Planes that cut spheres away, as in ``["z > 50%"]``; ``slice_mode`` is ``"remove"``, ``"caps"`` or
            ``"hide"``.
        label: A text or several, as in ``"top:{title}"``, or sections; ``"resname LIG: {name}"`` is at each of these
            particles.
        measure: Particles by their ids, as in ``"12-48"``, or several: the distance of two, the angle of three, the
            dihedral of four, drawn as lines with the value; ``"12-48:periodic"`` is between nearest images. Or sections.
        render, look, lettering, environment, ground, slice, light, material,
            sphere, stick, ellipsoid, cone, triangle, mesh, generate, file, style: Sections, as :mod:`spherule.sections` types
            them.
        triangles: (n, 3, 3) corners of triangles, such as the faces of a wall or of an isosurface; or a dict of these
            ``corners``, a ``material`` and a ``color`` for all.

    Raises:
        Error: Anything that cannot be used, by name and row, with the text of the program.
        TypeError: An unknown argument.

    Example:
        >>> scene = Scene([[0, 0, 0], [1.5, 0, 0]], kinds=["C", "O"], background="#f0f4ff")
        >>> len(scene), scene.size
        (2, (800, 600))
        >>> Scene(camera={"fov": 200}, sphere=[{"center": [0, 0, 0], "radius": 1}])
        Traceback (most recent call last):
            ...
        spherule.Error: [camera] fov = 200: `fov` is 200, but must be more than 0 and less than 180
    """

    @from_call
    def __init__(self, particles: Any = None, **options: Unpack[SceneOptions]) -> None:
        from . import _native

        self._made(_native.Scene(*self.arguments(particles, options)))

    @staticmethod
    def arguments(particles: Any, options: Mapping[str, Any]) -> Arguments:
        """What the extension module makes a scene of; for the package alone."""
        given: dict[str, Any] = {name: value for name, value in options.items() if value is not None}
        triangles, first = _arrays.triangles(given.pop("triangles", None))
        _options.check(given, _options.PARTICLES, _options.STYLE, _options.SECTIONS)
        sections = _options.part(given, _options.SECTIONS)
        color_bar = given.pop("color_bar", None)
        if isinstance(color_bar, Mapping):
            sections["color_bar"] = color_bar
            color_bar = None
        placed = {name: sections.pop(name) for name in _PLACED if not isinstance(sections.get(name, {}), Mapping)}
        texts = {f"{name}s": _texts(sections, name) for name in ("label", "measure")}
        camera = None
        if "camera" in sections and not isinstance(sections["camera"], Mapping):
            camera = _values.path("camera", sections.pop("camera"))
        if "background" in given:
            sections["look"] = {**sections.get("look", {}), "background": given["background"]}
        if first is not None:
            sections["triangle"] = [*sections.get("triangle", []), first]
        text, keys = _toml.document(sections)
        if particles is None and (idle := (set(given) & _options.PARTICLES) | ({"values"} & set(given))):
            raise Error(f"`{sorted(idle)[0]}` needs particles; give their positions first")
        columns = None
        if particles is not None:
            columns = _columns(particles, given, sections)
        return (
            {"text": text, "folder": os.getcwd(), "keys": keys, "triangles": triangles},
            columns,
            _style(given),
            _view(given, {"color_bar": color_bar, **placed}, texts, camera),
        )

    @classmethod
    def of_native(cls, native: NativeScene) -> Scene:
        """The scene that the extension module has made; for the package alone."""
        scene = cls.__new__(cls)
        scene._made(native)
        return scene

    _native: NativeScene

    def _made(self, native: NativeScene) -> None:
        self._native = native
        for text in self._native.warnings:
            warn(text)

    @classmethod
    @from_call
    def load(cls, path: str | os.PathLike[str], **options: Unpack[SceneOptions]) -> Scene:
        """Reads a scene file, or a particle file, which options then style.

        Args:
            path: A ``.toml`` file is a scene, any other a particle file, of which the first frame is read.
            **options: Those of :class:`Scene`, for particle files.

        Raises:
            Error: The file cannot be read or is not a valid scene; the text names the line.

        Example:
            >>> import pathlib, tempfile
            >>> path = pathlib.Path(tempfile.mkdtemp()) / "one.toml"
            >>> _ = path.write_text("[[sphere]]\\ncenter = [0, 0, 0]\\nradius = 1\\n")
            >>> len(Scene.load(path))
            1
        """
        from . import _native

        name = _values.path("path", path)
        if not name.lower().endswith(".toml"):
            options.setdefault("title", os.path.basename(name))
            return cls(read(name, **file_options(options)), **options)
        if options:
            raise Error("options for particles need a particle file; a scene defines its own colors and materials")
        return cls.of_native(_native.Scene.load(name))

    @from_call
    def save(self, path: str | os.PathLike[str], **options: Unpack[RenderOptions]) -> None:
        """Writes a scene file that loads as the same scene, with a ``.csv`` file of its spheres beside it; or a page of HTML.

        Args:
            path: A name that ends in ``.toml``, or in ``.html``: a page that needs no server, with the picture, which tells
                the particle under the pointer.
            **options: Of a page, those of :meth:`render`.

        Raises:
            Error: The file cannot be written, or anything that cannot be used.

        Example:
            >>> import pathlib, tempfile
            >>> path = pathlib.Path(tempfile.mkdtemp()) / "pair.toml"
            >>> Scene([[0, 0, 0], [1, 0, 0]], radius=0.5).save(path)
            >>> len(Scene.load(path))
            2
        """
        from ._picture import is_page, write_whole

        name = _values.path("path", path)
        if is_page(name):
            picture = self.render(**options)
            given = {own: value for own, value in options.items() if value is not None}
            write_whole(name, self._native.page(_options.render_table(given), picture.encode()).encode())
            return
        if options:
            raise Error(f"`{next(iter(options))}` is for pages, as in scene.save('figure.html')")
        self._native.save(name)

    def __len__(self) -> int:
        """The number of spheres and ellipsoids."""
        return len(self._native)

    def __repr__(self) -> str:
        width, height = self.size
        title = f" {self.title!r}" if self.title else ""
        return f"<spherule.Scene{title}: {len(self)} spheres, {width} x {height} pixels>"

    @property
    def title(self) -> str:
        """The title; empty if there is none."""
        return str(self._native.title)

    @property
    def size(self) -> tuple[int, int]:
        """Width and height of pictures in pixels."""
        return self._native.size

    @property
    def bounds(self) -> tuple[tuple[float, float, float], tuple[float, float, float]] | None:
        """The lower and the upper corner of the box of all spheres and ellipsoids; None without any."""
        found = self._native.bounds
        return found

    @from_call
    def render(self, **options: Unpack[RenderOptions]) -> Picture:
        """Renders the scene: see :func:`spherule.render`, of which this has the arguments of renders.

        Example:
            >>> Scene([[0, 0, 0]], radius=1).render(size=(40, 30), spp=4).pixels.shape
            (30, 40, 3)
        """
        from ._render import render

        return render(self, **options)

    @from_call
    def refine(self, seconds: float = 0.5, **options: Unpack[RenderOptions]) -> Iterator[Picture]:
        """Renders the scene step by step: see :func:`spherule.refine`.

        Example:
            >>> pictures = list(Scene([[0, 0, 0]], radius=1).refine(size=(40, 30), spp=64))
            >>> pictures[-1].complete
            True
        """
        from ._render import refine

        return refine(self, seconds, **options)

    def _repr_png_(self) -> bytes:
        """A quick look, for notebooks."""
        return self.render(spp=16, progress=False)._repr_png_()

    def __reduce__(self) -> tuple[Any, tuple[Any, ...]]:
        return _restored, self._native.columns()


_options.signed(Scene, _options.PARTICLES, _options.STYLE, _options.SECTIONS)


def _restored(*columns: Any) -> Scene:
    """A scene from what its pickle holds. Buffers of pickles may lie anywhere, also between numbers."""
    import numpy as np

    from . import _native

    def aligned(value: Any) -> Any:
        return _arrays.aligned(value) if isinstance(value, np.ndarray) else value

    text, places, *others = columns
    scene = Scene.__new__(Scene)
    scene._native = _native.Scene.of_columns(text, [aligned(column) for column in places], *map(aligned, others))
    return scene


def file_options(options: Mapping[str, Any]) -> dict[str, Any]:
    """How a file is read for a scene with these options."""
    bonds = options.get("bonds")
    if bonds is None and _may_need_bonds(options):
        bonds = "auto"
    return {"bonds": None if bonds == "none" else bonds}


def _may_need_bonds(options: Mapping[str, Any]) -> bool:
    """Whether bonds are drawn, or counted by a selection or an expression."""
    texts = " ".join(repr(options.get(name)) for name in _options.STYLE).lower()
    counts = any(word in texts for word in ("coordination", "cluster"))
    draws = any(word in repr(options.get("styles")) for word in ("ball-and-stick", "licorice", "bonds"))
    return counts or draws or options.get("model") not in (None, "space-filling")


def _columns(particles: Any, given: dict[str, Any], sections: Mapping[str, Any]) -> dict[str, Any]:
    """The particles for the extension module."""
    import numpy as np

    radius = given.get("radius")
    radii = None
    if isinstance(radius, str):
        radii, radius = radius, None
    elif radius is not None and np.ndim(radius) == 0:
        number = float(_arrays.floats("radius", radius))
        if not 0 < number < float("inf"):
            raise Error(f"`radius` is {number:g}, but must be finite and greater than 0")
        radii, radius = repr(number), None
    own = _options.part(given, _options.PARTICLES)
    own.pop("radius", None)
    particles = friends.particles_of(particles)
    over: dict[str, Any] = {}
    if isinstance(particles, Particles):
        over = {name: own.pop(name) for name in ("color", "materials") if name in own}
        if own:
            raise Error(f"`{sorted(own)[0]}` belongs to the particles: give it to Particles")
    else:
        particles = Particles(particles, **own)
    count = len(particles)
    if radii is not None and radii.startswith("column:"):
        name = radii.removeprefix("column:")
        is_expression = any(sign in name for sign in "+-*/^(")
        if name not in particles.columns and not is_expression:
            there = ", ".join(particles.columns) or "none"
            raise Error(f"`radius` is {radii!r}, but there is no column `{name}`; columns are {there}")
        if name in particles.columns:
            radii, radius = None, particles.columns[name]
    table: dict[str, Any] = particles._table(radii, _values.number("radius_scale", given.get("radius_scale", 1.0)))
    if radius is not None:
        table["radius"] = _arrays.column("radius", radius, count)
    if "color" in over:
        table["color"] = _arrays.colors("color", over["color"], count)
    if "materials" in over:
        table["materials"] = _arrays.coded("materials", over["materials"], count)
    if "materials" in over or particles.format is None:
        _check_materials(table["materials"], sections)
    if (title := sections.get("title")) is not None:
        table["title"] = _values.text("title", title)
    if (values := given.get("values")) is not None:
        if "color_by" in given:
            raise Error("give either `values` or `color_by`")
        name = _values.text("label_of_values", given.get("label_of_values", "values"))
        column = _arrays.column("values", values, count)
        wrong = np.flatnonzero(~np.isfinite(column))
        if len(wrong):
            raise Error(f"values[{wrong[0]}] is {column[wrong[0]]}, but must be finite")
        # By this name they are found before any other column.
        table["numbers"] = [(name, column), *(own for own in table["numbers"] if own[0] != name)]
        given["color_by"] = name
        given.setdefault("color_title", name)
        # Numbers that are given as values are for a map.
        given.setdefault("color_map", "viridis")
    arrows = given.get("arrows")
    if arrows is not None and not isinstance(arrows, str) and np.ndim(arrows) > 1:
        vectors = _arrays.table("arrows", arrows)
        if vectors.shape[0] != count:
            raise Error(f"`arrows` has the shape {vectors.shape}, but must have ({count}, 3)")
        own_names = [f"arrows_{axis}" for axis in "xyz"]
        columns = [(name, np.ascontiguousarray(vectors[:, axis])) for axis, name in enumerate(own_names)]
        table["numbers"] = [*columns, *(own for own in table["numbers"] if own[0] not in own_names)]
        given["arrows"] = own_names
    return table


def _check_materials(coded: Any, sections: Mapping[str, Any]) -> None:
    """Refuses names of materials that neither the scene nor Spherule knows; those of files are replaced with a warning."""
    import numpy as np

    from . import _native

    if coded is None:
        return
    own = sections.get("material")
    known = [*(own if isinstance(own, Mapping) else ()), *_native.material_names()]
    for row, name in enumerate(coded[0]):
        if name and name not in known and name.lower() not in _native.material_names():
            at = f"[{int(np.argmax(coded[1] == row))}]" if len(coded[0]) > 1 else ""
            raise Error(f"materials{at} is {name!r}, but must be a name of `material` or one of {', '.join(known)}")


def _style(given: Mapping[str, Any]) -> dict[str, Any]:
    types = []
    for name, look in _values.table("types", given.get("types", {})).items():
        look = _values.table(f"types[{name!r}]", look)
        unknown = set(look) - {"radius", "color", "material", "opacity"}
        if unknown:
            raise Error(f"type `{name}`: `{sorted(unknown)[0]}` is not radius, color, material or opacity")
        color = look.get("color")
        if color is not None:
            color = tuple(float(value) for value in _arrays.colors(f"types[{name!r}].color", color, 1)[0])
        radius, opacity = (
            None if (value := look.get(key)) is None else _values.number(f"types[{name!r}].{key}", value)
            for key in ("radius", "opacity")
        )
        material = look.get("material")
        if material is not None:
            material = _values.text(f"types[{name!r}].material", material)
        types.append((name, radius, color, material, opacity))
    ends = given.get("color_range")
    color_log = _values.flag("color_log", given.get("color_log", False))
    if (norm := _matplotlib.range_of(ends)) is not None:
        ends, is_log = norm
        color_log |= is_log
    if ends is not None:
        low, high = _values.items("color_range", ends, _end, 2)
        if not (isinstance(low, str) or isinstance(high, str) or low <= high):
            raise Error(f"`color_range` is {low:g} to {high:g}, but the lower number comes first")
        ends = ",".join(end if isinstance(end, str) else repr(end) for end in (low, high))
    names = ("select", "hide", "colors", "color_by", "color_title", "model", "bonds", "translucent")
    for name, place in (("color_by", "`values`"), ("bonds", "`Particles(..., bonds=...)`")):
        if not (given.get(name) is None or isinstance(given[name], str)):
            raise Error(f"`{name}` is {_values.shown(given[name])}, but must be a string; arrays go into {place}")
    style: dict[str, Any] = {name: _optional(given, name, _values.text) for name in names}
    style["color_map"] = _optional(given, "color_map", _matplotlib.map_words)
    through = given.get("opacity")
    if not (through is None or isinstance(through, str)):
        through = repr(_values.number("opacity", through))
    style["opacity"] = through
    polyhedra = given.get("polyhedra")
    if not (polyhedra is None or isinstance(polyhedra, str)):
        polyhedra = ",".join(_values.items("polyhedra", polyhedra, _values.text))
    style["polyhedra"] = polyhedra
    style["polyhedra_opacity"] = _optional(given, "polyhedra_opacity", _values.number)
    if polyhedra is None and style["polyhedra_opacity"] is not None:
        raise Error("`polyhedra_opacity` needs `polyhedra`")
    style.update(_arrows(given))
    style["bond_radius"] = _optional(given, "bond_radius", _values.number)
    styles = style_texts(given.get("styles"))
    return {**style, "color_range": ends, "color_log": color_log, "types": types, "styles": styles}


def style_texts(styles: Any) -> list[tuple[str, tuple[float, ...] | None]]:
    """The styles of selections as texts of the program's option ``--style``, and the color that replaces theirs."""
    if styles is None:
        return []
    if isinstance(styles, str):
        return [(styles, None)]
    if isinstance(styles, Mapping):
        return [_selected(_values.text("styles", select), look) for select, look in styles.items()]
    return [(_values.text(f"styles[{row}]", style), None) for row, style in enumerate(styles)]


def _selected(select: str, look: Any) -> tuple[str, tuple[float, ...] | None]:
    """A style that is given as its selection, and its properties as a text or by name."""
    if isinstance(look, str):
        return f"{select}: {look}", None
    name = f"styles[{select!r}]"
    color = None
    words = []
    # Maps belong to the color, which comes first.
    for key, value in sorted(_values.table(name, look).items(), key=lambda pair: pair[0] != "color"):
        at = f"{name}.{key}"
        if key == "color" and not isinstance(value, str):
            color = tuple(float(channel) for channel in _arrays.colors(at, value, 1)[0])
            value = "white"
        elif key == "map":
            value = _matplotlib.map_words(at, value)
        elif isinstance(value, bool):
            value = "yes" if value else "no"
        elif key == "polyhedra" and isinstance(value, (tuple, list)):
            value = ",".join(_values.items(at, value, _values.text))
        elif isinstance(value, (tuple, list)):
            value = _numbers(at, value)
        elif not isinstance(value, str):
            value = repr(_values.number(at, value))
        words.append(f"{key.replace('_', '-')}={value}")
    return f"{select}: {' '.join(words)}", color


def _end(name: str, value: Any) -> float | str:
    """An end of a color map: a number, a percentile, or ``auto``."""
    if not isinstance(value, str):
        return _values.number(name, value)
    percent = value.strip().removesuffix("%").strip()
    if value.strip() == "auto" or value.strip().endswith("%") and percent.replace(".", "", 1).isdecimal():
        return value.strip()
    raise Error(f'`{name}` is {value!r}, but must be a number, a percentile as in "2%", or "auto"')


def _arrows(given: Mapping[str, Any]) -> dict[str, Any]:
    """The arguments of arrows."""
    columns = given.get("arrows")
    if columns is not None and not isinstance(columns, str):
        columns = ",".join(_values.items("arrows", columns, _values.text, 3))
    chosen: dict[str, Any] = {name: _optional(given, name, _values.number) for name in ("arrow_scale", "arrow_radius")}
    chosen["arrow_center"] = _optional(given, "arrow_center", _values.text)
    color = given.get("arrow_color")
    if color is not None:
        color = tuple(float(value) for value in _arrays.colors("arrow_color", color, 1)[0])
    chosen["arrow_color"] = color
    for name, value in chosen.items():
        if columns is None and value is not None:
            raise Error(f"`{name}` needs `arrows`")
    return {"arrows": columns, **chosen}


def _optional(given: Mapping[str, Any], name: str, check: Callable[[str, Any], Any]) -> Any:
    """A checked value, or None if it is not given."""
    value = given.get(name)
    return None if value is None else check(name, value)


def _numbers(name: str, value: Any) -> str:
    """A text, or numbers as the program takes them: with commas between them."""
    if isinstance(value, str):
        return str(value)
    return ",".join(repr(number) for number in _values.items(name, value, _values.number))


#: Annotations that are sections, or words as the program has them, and the position of each where none is given.
_PLACED = {"legend": "top-right", "axes": "bottom-left", "scale_bar": "bottom-right"}


def _placed(name: str, value: Any, usual: str) -> str | None:
    """The words of an annotation: a position, perhaps after something else."""
    if value is None or isinstance(value, str):
        return value
    if name == "scale_bar" and not isinstance(value, bool):
        return repr(_values.number(name, value))
    return usual if _values.flag(name, value) else None


def _texts(sections: dict[str, Any], name: str) -> list[str]:
    """Takes annotations that are texts from the sections; dicts stay."""
    given = sections.get(name, ())
    texts = [given] if isinstance(given, str) else given
    if not isinstance(texts, (list, tuple)) or not all(isinstance(text, str) for text in texts):
        return []
    sections.pop(name, None)
    return list(texts)


def _view(
    given: Mapping[str, Any], annotations: Mapping[str, Any], texts: Mapping[str, list[str]], camera: str | None
) -> dict[str, Any]:
    usual = {"color_bar": "bottom-right", **_PLACED}
    placed = {name: _placed(name, annotations.get(name), position) for name, position in usual.items()}
    flags = {name: _values.flag(name, given.get(name, False)) for name in ("wrap", "show_cell")}
    words = {name: _optional(given, name, _values.text) for name in ("preset", "up", "slice_mode", "outside")}
    words |= {name: _optional(given, name, _numbers) for name in ("view", "look_at")}
    words["camera"] = camera
    numbers = {name: _optional(given, name, _values.number) for name in ("zoom", "roll")}
    replicate = given.get("replicate")
    if replicate is not None:
        replicate = _values.items(
            "replicate", replicate, lambda name, copies: _values.integer(name, copies, 1, 2**32 - 1), 3
        )
    words["complete"] = _optional(given, "complete", _values.flag)
    slices = _values.items("slices", given.get("slices", ()), _values.text)
    return {**words, **numbers, **flags, "replicate": replicate, **placed, **texts, "slices": slices}
