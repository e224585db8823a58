"""Exact ray queries on arrays."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

from . import _arrays, _options, _values
from ._errors import Error, from_call

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt

#: The sphere of a ray that hits nothing, and the id of a pixel that shows nothing.
NOTHING = 0xFFFF_FFFF
#: The id of a pixel that shows the ground.
GROUND = 0xFFFF_FFFE


class Hits(NamedTuple):
    """The first hits of rays.

    Attributes:
        t: (n,) float64: distances in units of the direction's length, each the double nearest to the true one; infinite
            where nothing is hit.
        sphere: (n,) uint32: rows of the spheres; :data:`spherule.NOTHING` where nothing is hit.
        points, normals: (n, 3) float64: where the sphere is hit, and its outward unit normal there; NaN where nothing
            is hit. None unless they were asked for.
    """

    t: npt.NDArray[np.float64]
    sphere: npt.NDArray[np.uint32]
    points: npt.NDArray[np.float64] | None
    normals: npt.NDArray[np.float64] | None

    @property
    def hit(self) -> npt.NDArray[np.bool_]:
        """(n,): whether anything is hit."""
        hit: npt.NDArray[np.bool_] = self.sphere != NOTHING
        return hit


class SphereTree:
    """Spheres, ready for exact ray queries: which one a ray hits first, as arithmetic without rounding would say.

    Args:
        positions: (n, 3) centers, or a tuple of the columns x, y and z, finite; float32 is read where it lies, anything
            else is rounded to it.
        radius: A number or (n,) numbers, finite and more than 0; in single precision, too.
        threads: How many threads build the tree.

    Raises:
        Error: A wrong shape or length.
        ValueError: A value that is not finite, or a radius that is not more than 0, by name and row.

    Example:
        >>> tree = SphereTree([[0, 0, 0], [3, 0, 0]], [1, 0.5])
        >>> hits = tree.intersect([[-5, 0, 0], [9, 0, 0], [0, 5, 0]], [[2, 0, 0], [-1, 0, 0], [1, 0, 0]])
        >>> hits.t.tolist(), hits.hit.tolist(), hits.sphere[:2].tolist()
        ([2.0, 5.5, inf], [True, True, False], [0, 1])
    """

    @from_call
    def __init__(self, positions: Any, radius: Any, *, threads: int | None = None) -> None:
        from . import _native

        centers = _arrays.table("positions", positions)
        radii = _arrays.column("radius", radius, len(centers))
        self._tree = _native.SphereTree(_arrays.single("positions", centers), _arrays.single("radius", radii), _options.threads(threads))

    def __len__(self) -> int:
        """The number of spheres."""
        return len(self._tree)

    def __repr__(self) -> str:
        return f"<spherule.SphereTree: {len(self)} spheres>"

    @property
    def nbytes(self) -> int:
        """Bytes of the tree and its spheres."""
        return self._tree.nbytes

    @from_call
    def intersect(
        self, origins: Any, directions: Any, *, t_max: Any = None, surface: bool = False, threads: int | None = None
    ) -> Hits:
        """The first sphere that each ray hits.

        Columns are fastest: a tuple of x, y and z, or an array in Fortran order. Rays in no order are put in one where
        that pays; the answers come in yours.

        Args:
            origins, directions: (n, 3) numbers, or tuples of columns; in single precision, as positions. Directions may
                have any length but 0. One row stands for all rays.
            t_max: A number or (n,): hits that are not nearer do not count, in units of the direction's length.
            surface: Whether points and normals are wanted.
            threads: How many threads.

        Returns:
            The hits. Rays with a number that is not finite, and those without a direction, hit nothing.

        Raises:
            Error: Wrong shapes or lengths.

        Example:
            >>> tree = SphereTree([[0, 0, 0]], 1)
            >>> tree.intersect([[0, 0, 5]], [[0, 0, -1]], surface=True).normals.tolist()
            [[0.0, 0.0, 1.0]]
        """
        rays = self._rays(origins, directions, t_max)
        surface = _values.flag("surface", surface)
        t, sphere, surfaces = self._tree.intersect(*rays, surface, _options.threads(threads))
        points, normals = surfaces or (None, None)
        return Hits(t, sphere, points, normals)

    @from_call
    def occluded(
        self, origins: Any, directions: Any, *, t_max: Any = None, threads: int | None = None
    ) -> npt.NDArray[np.bool_]:
        """Find the rays that hit anything: faster than the first hit.

        Args:
            origins, directions, t_max, threads: As for :meth:`intersect`.

        Returns:
            (n,) bool.

        Raises:
            Error: Wrong shapes or lengths.

        Example:
            >>> SphereTree([[0, 0, 0]], 1).occluded([[-5, 0, 0], [-5, 0, 0]], [1, 0, 0], t_max=[9, 3]).tolist()
            [True, False]
        """
        return self._tree.occluded(*self._rays(origins, directions, t_max), _options.threads(threads))

    @from_call
    def count(self, origins: Any, directions: Any, *, t_max: Any = None, threads: int | None = None) -> int:
        """Count the rays that hit anything.

        Args:
            origins, directions, t_max, threads: As for :meth:`intersect`.

        Raises:
            Error: Wrong shapes or lengths.

        Example:
            >>> SphereTree([[0, 0, 0]], 1).count([[-5, 0, 0], [-5, 2, 0]], [1, 0, 0])
            1
        """
        return self._tree.count(*self._rays(origins, directions, t_max), _options.threads(threads))

    @staticmethod
    def _rays(origins: Any, directions: Any, t_max: Any) -> tuple[Any, Any, Any]:
        import numpy as np

        tables = {}
        for name, value in (("origins", origins), ("directions", directions)):
            if not isinstance(value, tuple):
                array = _arrays.floats(name, value)
                value = array.reshape(1, 3) if array.shape == (3,) else array
            tables[name] = _arrays.single(name, _arrays.table(name, value))
        count = max((len(table) for table in tables.values()), default=0)
        for name, table in tables.items():
            if len(table) == 1 and count != 1:
                tables[name] = np.broadcast_to(table, (count, 3))
            elif len(table) != count:
                raise Error(f"`{name}` has {len(table)} rows, but must have {count}, one for each ray")
        bound = None
        if t_max is not None:
            bound = _arrays.column("t_max", t_max, count).astype(np.float64)
            if (wrong := np.isnan(bound)).any():
                row = f"[{int(wrong.argmax())}]" if np.ndim(t_max) else ""
                raise Error(f"t_max{row} is nan, but must be a number; inf is no limit")
        return tables["origins"], tables["directions"], bound
