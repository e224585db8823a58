"""Spheres and tubes that are recognized in meshes of triangles, as glyphs and filters for tubes make them."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt

    Floats = npt.NDArray[np.float64]
    Rows = npt.NDArray[np.intp]

#: Largest deviation of a point from its sphere or ring, in radii, and that by rounding, in coordinates of single precision.
_TOLERANCE, _ROUNDING = 2e-3, 5e-7

#: Least number of points of a sphere, and least distance from its center of the middle of a face, in radii: less are polyhedra.
_SPHERE_POINTS = 24
_SPHERE_SAG = 0.82

#: Least and most sides of a tube: less are prisms, such as boxes.
_LEAST_SIDES, _SIDES = 8, 64


class Parts(NamedTuple):
    """Runs of consecutive points whose faces reach no other run, and what they are."""

    #: The run of each point, and the first point of each run.
    run: Rows
    first: Rows
    #: For each run, whether it is a sphere, its center and radius.
    is_sphere: npt.NDArray[np.bool_]
    centers: Floats
    radii: Floats
    tubes: list[Tube]
    #: For each run, whether its faces are part of a sphere or a tube.
    is_taken: npt.NDArray[np.bool_]


class Tube(NamedTuple):
    """A tube of constant radius: the axis, and the rings of points about it."""

    run: int
    axis: Floats
    radius: float
    sides: int


def parts(points: Floats, faces: Rows) -> Parts:
    """The connected runs of a mesh of triangles, with the spheres and tubes among them."""
    import numpy as np

    count = len(points)
    # A gap between two points begins a run if no face spans it.
    spans = np.zeros(count + 1, np.int64)
    np.add.at(spans, faces.min(axis=1) + 1, 1)
    np.add.at(spans, faces.max(axis=1) + 1, -1)
    begins = np.cumsum(spans)[:count] == 0
    begins[:1] = True
    first = np.flatnonzero(begins)
    run = np.cumsum(begins) - 1
    lengths = np.diff(np.append(first, count))
    is_sphere = np.zeros(len(first), bool)
    centers, radii = np.zeros((len(first), 3)), np.zeros(len(first))
    for length in np.unique(lengths[lengths >= _SPHERE_POINTS]):
        rows = np.flatnonzero(lengths == length)
        # Some at a time, so that a million glyphs need no copy of all their points.
        for some in np.array_split(rows, max(1, len(rows) * int(length) // 2_000_000)):
            each = points[first[some][:, None] + np.arange(length)]
            centers[some], radii[some], is_sphere[some] = _spheres(each)
    _refuse_polyhedra(points, faces, run, is_sphere, centers, radii)
    is_taken = is_sphere.copy()
    tubes: list[Tube] = []
    for row in np.flatnonzero(~is_sphere & (lengths >= 2 * _LEAST_SIDES)):
        tube = _tube(points[first[row] : first[row] + lengths[row]])
        if tube is not None:
            tubes.append(Tube(int(row), *tube))
            is_taken[row] = True
    _take_caps(points, first, lengths, tubes, is_taken)
    return Parts(run, first, is_sphere, centers, radii, tubes, is_taken)


def _spheres(each: Floats) -> tuple[Floats, Floats, npt.NDArray[np.bool_]]:
    """The least-squares spheres of sets of equally many points: p^2 = 2 c.p + (r^2 - c^2) is linear."""
    import numpy as np

    middle = each.mean(axis=1, keepdims=True)
    size = np.abs(each - middle).max(axis=(1, 2), keepdims=True)
    local = (each - middle) / np.where(size > 0, size, 1)
    ones = np.ones((*local.shape[:2], 1))
    left = np.concatenate([2 * local, ones], axis=2)
    right = (local**2).sum(axis=2)
    normal = np.einsum("npi,npj->nij", left, left)
    # Flat sets have no sphere of their own: a little of the identity keeps theirs far from the points.
    solution = np.linalg.solve(normal + 1e-9 * np.eye(4), np.einsum("npi,np->ni", left, right)[..., None])[..., 0]
    center = solution[:, None, :3]
    distance = np.linalg.norm(local - center, axis=2)
    radius = distance.mean(axis=1)
    rounding = _ROUNDING * np.abs(each).max(axis=(1, 2)) / np.where(size > 0, size, 1)[:, 0, 0]
    slack = np.minimum(_TOLERANCE * radius + rounding, radius / 10)
    is_sphere = (np.abs(distance - radius[:, None]) <= slack[:, None]).all(axis=1) & (size[:, 0, 0] > 0)
    return (middle + center * size)[:, 0], radius * size[:, 0, 0], is_sphere


def _refuse_polyhedra(
    points: Floats, faces: Rows, run: Rows, is_sphere: npt.NDArray[np.bool_], centers: Floats, radii: Floats
) -> None:
    """Takes what has its corners on a sphere, but flat faces within it, or is open, from the spheres."""
    import numpy as np

    of_face = run[faces[:, 0]]
    among = is_sphere[of_face]
    of_face, corners = of_face[among], points[faces[among]]
    sag = np.linalg.norm(corners.mean(axis=1) - centers[of_face], axis=1) / radii[of_face]
    cut = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    area = np.bincount(of_face, np.linalg.norm(cut, axis=1) / 2, len(radii))
    # Repeated points at poles and seams have faces without area, whose middle may be anywhere on the sphere.
    flat = np.bincount(of_face, sag < _SPHERE_SAG, len(radii)) > 0
    closed = area > 0.8 * 4 * np.pi * radii**2
    is_sphere &= closed & ~flat


def _tube(points: Floats) -> tuple[Floats, float, int] | None:
    """The axis, radius and number of sides of points that are rings of equal radius, one after the other."""
    import numpy as np

    rounding = _ROUNDING * float(np.abs(points).max())
    for sides in range(_LEAST_SIDES, min(_SIDES, len(points) // 2) + 1):
        if len(points) % sides:
            continue
        start = points[:sides]
        away = np.linalg.norm(start - start.mean(axis=0), axis=1)
        if not np.ptp(away) <= _TOLERANCE * away.mean() + rounding:
            continue
        rings = points.reshape(-1, sides, 3)
        axis = rings.mean(axis=1)
        distance = np.linalg.norm(rings - axis[:, None], axis=2)
        steps = np.linalg.norm(rings - np.roll(rings, 1, axis=1), axis=2)
        radius = float(distance.mean())
        # At bends, rings are in the plane between both directions, and where they are as far around as along, no tube.
        even = np.abs(distance - radius).max() <= 2 * _TOLERANCE * radius + rounding
        regular = np.abs(steps - 2 * radius * np.sin(np.pi / sides)).max() <= 0.02 * radius
        length = np.linalg.norm(np.diff(axis, axis=0), axis=1)
        return (axis, radius, sides) if even and regular and (length > 0).all() else None
    return None


def _take_caps(
    points: Floats, first: Rows, lengths: Rows, tubes: list[Tube], is_taken: npt.NDArray[np.bool_]
) -> None:
    """Takes the rings that close tubes, which have points of their own after those of the tube."""
    import numpy as np

    for tube in tubes:
        for row in range(tube.run + 1, min(tube.run + 3, len(first))):
            if lengths[row] != tube.sides or is_taken[row]:
                break
            middle = points[first[row] : first[row] + tube.sides].mean(axis=0)
            if np.linalg.norm(tube.axis[[0, -1]] - middle, axis=1).min() > _TOLERANCE * tube.radius + 1e-6:
                break
            is_taken[row] = True
