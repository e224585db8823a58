"""Scenes of what a plotter of PyVista shows."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from . import _meshes
from ._errors import Error, from_call, warn
from ._scene import Scene

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt
    from typing_extensions import Unpack

    from ._options import SceneOptions

    Floats = npt.NDArray[np.float64]
    Codes = npt.NDArray[np.uint8]

#: The name under which meshes carry the colors of their scalars.
_CODES = "_spherule_codes"

#: Colors of a map, at most, that scene files have.
_MAP_COLORS = 256


@from_call
def from_pyvista(plotter: Any, **options: Unpack[SceneOptions]) -> Scene:
    """The scene of a PyVista ``Plotter``: its camera, window size, background, colors, color bar and axes, in Spherule's light.

    Points, and vertices of meshes, are spheres of the size that they have on the screen; glyphs of spheres become spheres, and
    tubes of constant radius, lines and wireframes become sticks. All other surfaces become triangles, which are flat. Scalars
    have the colors of their map and range. What is left out, such as volumes and texts, is named in a warning.

    Args:
        plotter: ``pyvista.Plotter``, before ``show`` has closed it. Of several views, the active one is taken.
        **options: Those of :class:`Scene`, which go before what the plotter has.

    Raises:
        Error: It is something else, or shows nothing that can be drawn.

    Example:
        >>> import pyvista
        >>> plotter = pyvista.Plotter(off_screen=True, window_size=(320, 240))
        >>> _ = plotter.add_points(pyvista.PolyData([[0.0, 0, 0], [1, 0, 0]]), render_points_as_spheres=True)
        >>> scene = from_pyvista(plotter)
        >>> len(scene), scene.size
        (2, (320, 240))
    """
    renderer = getattr(plotter, "renderer", None)
    if renderer is None or not hasattr(renderer, "actors") or not hasattr(plotter, "window_size"):
        raise Error(f"expected a pyvista Plotter, but {type(plotter).__name__} has no `renderer`")
    width, height = (int(pixels) for pixels in plotter.window_size)
    view = _View(renderer, height)
    bodies = _Bodies(view)
    bar: dict[str, Any] | None = None
    for name, actor in renderer.actors.items():
        if not actor.GetVisibility():
            continue
        if hasattr(actor, "GetLookupTable") and hasattr(actor, "GetTitle"):
            bar, other = _color_bar(actor), bar
            if other is not None:
                bodies.leave_out("color bar", other["label"])
                bar = other
        elif hasattr(actor, "GetProperty") and hasattr(actor, "GetMapper") and hasattr(actor, "GetTexture"):
            bodies.add(name, actor)
        else:
            bodies.leave_out(_kind(actor), name)
    if renderer.GetGradientBackground():
        bodies.leave_out("gradient of the background", "")
    found = bodies.sections()
    if not found:
        raise Error("the plotter has nothing that can be drawn; add meshes, and call from_pyvista before `show` closes it")
    ours: dict[str, Any] = {
        "camera": view.section(),
        "background": [255 * value for value in renderer.GetBackground()],
        "render": {"size": [width, height]},
        **found,
    }
    import numpy as np

    ours["background"] = _hex(np.rint(ours["background"]).astype(np.uint8))
    if bar is not None:
        ours["color_bar"] = bar
    if getattr(renderer, "axes_enabled", False):
        ours["axes"] = True
    bodies.warn()
    particles = ours.pop("particles", None)
    for section in ("camera", "render", "material"):
        if isinstance(own := options.get(section), dict):
            ours[section] = {**ours.get(section, {}), **own}
            options = {name: value for name, value in options.items() if name != section}  # type: ignore[assignment]
    return Scene(particles, **{**ours, **options})


class _View:
    """The camera of a renderer, as ``show`` would set it."""

    def __init__(self, renderer: Any, height: int) -> None:
        import numpy as np

        camera = renderer.camera
        is_set = camera.is_set
        if not is_set:
            renderer.camera_position = renderer.get_default_cam_pos()
            renderer.ResetCamera()
        self.eye, self.target = np.array(camera.GetPosition()), np.array(camera.GetFocalPoint())
        self.up, self.fov = camera.GetViewUp(), float(camera.GetViewAngle())
        self.is_parallel, self.half_height = bool(camera.GetParallelProjection()), float(camera.GetParallelScale())
        # What is added later is framed by `show`, as if this had not been.
        camera.is_set = is_set
        self.pixels = height

    def pixel(self, points: Floats) -> Floats:
        """The size of a pixel at points."""
        import numpy as np

        if self.is_parallel:
            return np.full(len(points), 2 * self.half_height / self.pixels)
        forward = (self.target - self.eye) / np.linalg.norm(self.target - self.eye)
        depth = np.maximum((points - self.eye) @ forward, 0)
        found: Floats = 2 * depth * np.tan(np.radians(self.fov) / 2) / self.pixels
        return found

    def section(self) -> dict[str, Any]:
        """The section `camera`."""
        places = {"eye": self.eye.tolist(), "target": self.target.tolist(), "up": list(self.up)}
        if self.is_parallel:
            return {"projection": "orthographic", "height": 2 * self.half_height, **places}
        return {"projection": "perspective", "fov": self.fov, **places}


class _Bodies:
    """Spheres, sticks and triangles of all actors, in columns, and what is left out."""

    def __init__(self, view: _View) -> None:
        self.view = view
        self.spheres: list[tuple[Floats, Floats, Codes]] = []
        self.sticks: list[tuple[Floats, Floats, Codes]] = []
        self.triangles: list[tuple[Floats, Codes]] = []
        self.left_out: list[str] = []

    def leave_out(self, kind: str, name: str) -> None:
        """Notes what is not drawn; names that PyVista has made say nothing."""
        self.left_out.append(kind if not name or "Addr=" in name else f"{kind} `{name}`")

    def warn(self) -> None:
        """Warns of what is left out."""
        if self.left_out:
            kinds = {text: self.left_out.count(text) for text in self.left_out}
            texts = [text if count == 1 else f"{text} ({count} times)" for text, count in kinds.items()]
            warn(f"not drawn of the plotter: {', '.join(texts)}")

    def add(self, name: str, actor: Any) -> None:
        """Adds the mesh of an actor."""
        import numpy as np
        import pyvista

        mapper, look = actor.GetMapper(), actor.GetProperty()
        if mapper is None or mapper.GetInputDataObject(0, 0) is None:
            return
        mapper.Update()
        mesh: Any = pyvista.wrap(mapper.GetInputDataObject(0, 0))
        if isinstance(mesh, pyvista.MultiBlock):
            if mapper.GetScalarVisibility():
                self.leave_out("scalars of the blocks", name)
            mesh = mesh.combine()
        for kind, is_there in (
            ("texture", actor.GetTexture() is not None),
            ("edges", look.GetEdgeVisibility() and look.GetRepresentation() == 2),
            ("clipping planes", mapper.GetNumberOfClippingPlanes() > 0),
        ):
            if is_there:
                self.leave_out(kind, name)
        mesh = mesh.copy(deep=False)
        plain = np.rint(255 * np.array([*look.GetColor(), look.GetOpacity()])).astype(np.uint8)
        codes = _codes(mapper, mesh, float(look.GetOpacity()))
        if codes is not None:
            (mesh.cell_data if codes[0] else mesh.point_data)[_CODES] = codes[1]
        matrix = actor.GetMatrix()
        turn = np.array([[matrix.GetElement(row, column) for column in range(4)] for row in range(4)])

        def placed(points: Any) -> Floats:
            found: Floats = np.asarray(points, np.float64) @ turn[:3, :3].T + turn[:3, 3]
            return found

        if mapper.IsA("vtkPointGaussianMapper") or look.GetRepresentation() == 0:
            points = placed(mesh.points)
            if mapper.IsA("vtkPointGaussianMapper") and mapper.GetScaleFactor() > 0:
                radii = np.full(len(points), float(mapper.GetScaleFactor()))
                scale = mapper.GetScaleArray()
                if scale:
                    radii = radii * np.asarray(mesh.point_data[scale], np.float64)
            else:
                radii = look.GetPointSize() / 2 * self.view.pixel(points)
            colors = np.broadcast_to(plain, (len(points), 4))
            if codes is not None:
                over = mesh.cell_data_to_point_data() if codes[0] else mesh
                colors = np.asarray(over.point_data[_CODES]).astype(np.uint8)
            self.spheres.append((points, radii, colors))
            return
        surface = mesh if isinstance(mesh, pyvista.PolyData) else mesh.extract_surface(algorithm=None)
        if look.GetRepresentation() == 1:
            surface = surface.extract_all_edges()
        points = placed(surface.points)
        corners = _Corners(surface, plain, None if codes is None else bool(codes[0]))
        rows, cells = corners.of(surface.GetVerts(), 0)
        if len(rows):
            at = points[rows]
            self.spheres.append((at, look.GetPointSize() / 2 * self.view.pixel(at), corners.colors(rows[:, None], cells)))
        pairs, cells = corners.segments(surface.GetLines())
        if len(pairs):
            ends = points[pairs]
            radii = look.GetLineWidth() / 2 * self.view.pixel(ends.mean(axis=1))
            each = np.stack([corners.colors(pairs[:, side : side + 1], cells) for side in (0, 1)], axis=1)
            self.sticks.append((ends, radii, each))
        if surface.GetNumberOfPolys() or surface.GetNumberOfStrips():
            self._add_faces(surface.triangulate(), placed, plain, None if codes is None else bool(codes[0]))

    def _add_faces(self, mesh: Any, placed: Any, plain: Codes, of_cells: bool | None) -> None:
        """Adds the spheres and tubes among the faces, and the rest as triangles."""
        import numpy as np

        points = placed(mesh.points)
        faces = np.asarray(mesh.faces).reshape(-1, 4)[:, 1:]
        if not len(faces):
            return
        corners = _Corners(mesh, plain, of_cells)
        found = _meshes.parts(points, faces)
        of_face = found.run[faces[:, 0]]
        if found.is_sphere.any():
            # The first face is as good as any: a glyph has one color.
            runs, face = np.unique(of_face, return_index=True)
            face = face[found.is_sphere[runs]]
            runs = of_face[face]
            self.spheres.append((found.centers[runs], found.radii[runs], corners.colors(faces[face], face)))
        for tube in found.tubes:
            start = found.first[tube.run]
            rings = start + np.arange(len(tube.axis))[:, None] * tube.sides + np.arange(tube.sides)
            ends = np.stack([tube.axis[:-1], tube.axis[1:]], axis=1)
            if of_cells:
                face = np.flatnonzero(of_face == tube.run)[:1]
                each = np.broadcast_to(corners.colors(faces[face], face), (len(ends), 2, 4))
            else:
                of_ring = corners.colors(rings, None)
                each = np.stack([of_ring[:-1], of_ring[1:]], axis=1)
            self.sticks.append((ends, np.full(len(ends), tube.radius), each))
        rest = np.flatnonzero(~found.is_taken[of_face])
        if len(rest):
            self.triangles.append((points[faces[rest]], corners.colors(faces[rest], rest)))

    def sections(self) -> dict[str, Any]:
        """The particles and sections of all bodies; empty if there is none."""
        import numpy as np

        found: dict[str, Any] = {}
        materials: dict[str, Any] = {}

        def look(code: Any) -> dict[str, str]:
            """The color and the material of a body."""
            if code[3] == 255:
                return {"color": _hex(code)}
            name = f"opacity-{code[3]}"
            materials[name] = {"kind": "lambertian", "color": 1, "opacity": float(code[3]) / 255}
            return {"color": _hex(code), "material": name}

        if self.spheres:
            points, radii, codes = (np.concatenate(column) for column in zip(*self.spheres))
            drawn = np.isfinite(points).all(axis=1) & (radii > 0) & (codes[:, 3] > 0)
            if drawn.any():
                found |= {"particles": points[drawn], "radius": radii[drawn], "color": codes[drawn, :3]}
                if (codes[drawn, 3] < 255).any():
                    found |= {"columns": {"alpha": codes[drawn, 3] / 255}, "opacity": "alpha"}
        if self.sticks:
            ends, radii, codes = (np.concatenate(column) for column in zip(*self.sticks))
            sticks: list[dict[str, Any]] = []
            for row in np.flatnonzero((radii > 0) & (ends[:, 0] != ends[:, 1]).any(axis=1) & (codes[:, 0, 3] > 0)):
                one = {"from": ends[row, 0].tolist(), "to": ends[row, 1].tolist(), "radius": float(radii[row])}
                one |= look(codes[row, 0])
                if (codes[row, 0, :3] != codes[row, 1, :3]).any():
                    one["colors"] = [one.pop("color"), _hex(codes[row, 1])]
                sticks.append(one)
            if sticks:
                found["stick"] = sticks
        if self.triangles:
            corners, codes = (np.concatenate(column) for column in zip(*self.triangles))
            edges = corners[:, 1:] - corners[:, :1]
            area = np.linalg.norm(np.cross(edges[:, 0], edges[:, 1]), axis=1)
            drawn = (area > 1e-9 * (edges**2).sum(axis=2).max(axis=1)) & (codes[:, 3] > 0)
            corners, codes = corners[drawn], codes[drawn]
            colors, which = np.unique(codes, axis=0, return_inverse=True)
            if len(colors):
                # Those of the most frequent color are an array, which is read faster.
                most = int(np.bincount(which.reshape(-1)).argmax())
                found["triangles"] = {"corners": corners[which.reshape(-1) == most], **look(colors[most])}
                others = np.flatnonzero(which.reshape(-1) != most)
                looks = [look(color) for color in colors]
                kinds = which.reshape(-1)[others].tolist()
                listed = zip(corners[others].tolist(), kinds)
                found["triangle"] = [{"a": a, "b": b, "c": c, **looks[kind]} for (a, b, c), kind in listed]
        if materials:
            found["material"] = materials
        return found


class _Corners:
    """The colors of the points or of the cells of a mesh, or one for all, and its cells as rows of points."""

    def __init__(self, mesh: Any, plain: Codes, of_cells: bool | None) -> None:
        import numpy as np

        self.plain, self.of_cells = plain, of_cells
        self.codes = None
        if of_cells is not None:
            self.codes = np.asarray((mesh.cell_data if of_cells else mesh.point_data)[_CODES])
        # Cells are counted in this order.
        self.before = {"lines": mesh.GetNumberOfVerts()}

    @staticmethod
    def of(cells: Any, before: int) -> tuple[Any, Any]:
        """The points of cells, one after the other, and the cell of each."""
        import numpy as np

        if not cells.GetNumberOfCells():
            return np.zeros(0, np.intp), np.zeros(0, np.intp)
        starts = _array(cells.GetOffsetsArray()).astype(np.intp)
        rows = _array(cells.GetConnectivityArray()).astype(np.intp)
        return rows, before + np.repeat(np.arange(len(starts) - 1), np.diff(starts))

    def segments(self, lines: Any) -> tuple[Any, Any]:
        """The pairs of points of polylines, and the cell of each."""
        import numpy as np

        rows, cells = self.of(lines, self.before["lines"])
        same = cells[:-1] == cells[1:]
        return np.stack([rows[:-1], rows[1:]], axis=1)[same], cells[:-1][same]

    def colors(self, rows: Any, cells: Any) -> Codes:
        """The colors of cells that have these points, (n, 4): the mean of the points' where these have colors."""
        import numpy as np

        if self.codes is None:
            return np.broadcast_to(self.plain, (len(rows), 4))
        found: Codes = self.codes[cells] if self.of_cells else np.rint(self.codes[rows].mean(axis=1)).astype(np.uint8)
        return found


def _codes(mapper: Any, mesh: Any, opacity: float) -> tuple[bool, Codes] | None:
    """The colors of the scalars of a mesh in sRGB with alpha, and whether they are those of cells; None without scalars."""
    import numpy as np
    from vtkmodules.vtkCommonCore import reference

    if not mapper.GetScalarVisibility() or mapper.IsA("vtkCompositePolyDataMapper"):
        return None
    of_cells = reference(0)
    scalars = mapper.GetAbstractScalars(
        mesh, mapper.GetScalarMode(), mapper.GetArrayAccessMode(), mapper.GetArrayId(), mapper.GetArrayName(), of_cells
    )
    if scalars is None or int(of_cells) > 1:
        return None
    table = mapper.GetLookupTable()
    if not mapper.GetUseLookupTableScalarRange():
        table.SetRange(mapper.GetScalarRange())
    if hasattr(table, "BuildSpecialColors"):
        # The color of NaN, which otherwise follows with the first image.
        table.BuildSpecialColors()
    mapped = table.MapScalars(scalars, mapper.GetColorMode(), mapper.GetArrayComponent())
    codes = np.array(_array(mapped))
    if codes.shape[1] == 3:
        codes = np.hstack([codes, np.full((len(codes), 1), 255, np.uint8)])
    codes[:, 3] = np.rint(codes[:, 3] * opacity).astype(np.uint8)
    return bool(int(of_cells)), codes


def _color_bar(actor: Any) -> dict[str, Any]:
    """The section of a color bar."""
    import numpy as np

    table = actor.GetLookupTable()
    colors = _array(table.GetTable())
    count = len(colors)
    if count > _MAP_COLORS:
        colors = colors[np.linspace(0, count - 1, _MAP_COLORS).astype(int)]
    elif count <= _MAP_COLORS // 4:
        # Steps, as they are shown.
        colors = np.repeat(colors, _MAP_COLORS // count, axis=0)
    bar = {"range": list(table.GetRange()), "map": ",".join(map(_hex, colors)), "label": actor.GetTitle() or ""}
    return {**bar, "log": bool(table.GetScale()), "position": "right" if actor.GetOrientation() else "bottom"}


def _array(array: Any) -> Any:
    """An array of VTK as one of NumPy."""
    from vtkmodules.util import numpy_support

    convert: Any = numpy_support.vtk_to_numpy
    return convert(array)


def _hex(code: Any) -> str:
    return "#" + "".join(f"{int(value):02x}" for value in code[:3])


def _kind(actor: Any) -> str:
    """The kind of an actor in words, by the name of its class."""
    name = type(actor).__name__
    words = {"Volume": "volume", "Text": "text", "Corner": "text", "Cube": "bounds", "Label": "labels", "Legend": "legend"}
    for part, word in words.items():
        if part in name:
            return word
    return name
