"""Renders scenes of spheres: particle simulations, molecules, random fields; and answers ray queries exactly.

    >>> import spherule
    >>> picture = spherule.render([[0, 0, 0], [1, 0, 0]], radius=0.5, size=(80, 60), spp=4)

:func:`render` makes a picture of positions, :func:`movie` a video of a trajectory, and :class:`Scene` says how.
:class:`Viewer` shows them in a notebook, where one turns them. :func:`read` reads particle files into NumPy
columns; :func:`from_ase` and its kin take the structures of other packages, :func:`from_pyvista` a plotter. :class:`SphereTree` answers which sphere a
ray hits first.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from ._errors import ArgumentError, Error, Interrupted, SpheruleWarning

if TYPE_CHECKING:
    from ._movie import movie
    from ._native import Stop
    from ._particles import Particles, count_frames, frames, read
    from ._picture import Picture
    from ._pyvista import from_pyvista
    from ._render import refine, render, render_async
    from ._scene import Scene
    from ._tree import GROUND, NOTHING, Hits, SphereTree
    from ._viewer import Viewer
    from .friends import from_ase, from_gsd, from_mdanalysis, from_ovito, from_pandas
    from .structures import from_mdtraj, from_pymatgen

__version__ = "0.1.0"

#: Where the other names are: they are imported when they are first used.
_PLACES = {
    "_movie": ("movie",),
    "_native": ("Stop",),
    "_particles": ("Particles", "count_frames", "frames", "read"),
    "_picture": ("Picture",),
    "_pyvista": ("from_pyvista",),
    "_render": ("refine", "render", "render_async"),
    "_scene": ("Scene",),
    "_tree": ("GROUND", "NOTHING", "Hits", "SphereTree"),
    "_viewer": ("Viewer",),
    "friends": ("from_ase", "from_gsd", "from_mdanalysis", "from_ovito", "from_pandas"),
    "structures": ("from_mdtraj", "from_pymatgen"),
}

__all__ = [
    "GROUND",
    "NOTHING",
    "ArgumentError",
    "Error",
    "Hits",
    "Interrupted",
    "Particles",
    "Picture",
    "Scene",
    "SphereTree",
    "SpheruleWarning",
    "Stop",
    "Viewer",
    "count_frames",
    "frames",
    "from_ase",
    "from_gsd",
    "from_mdanalysis",
    "from_mdtraj",
    "from_ovito",
    "from_pandas",
    "from_pymatgen",
    "from_pyvista",
    "level",
    "movie",
    "read",
    "refine",
    "render",
    "render_async",
]


def level() -> str:
    """The processor level of the extension module that is in use: ``"v2"``, ``"v3"``, ``"v4"`` or ``"baseline"``.

    Example:
        >>> level() in ("v2", "v3", "v4", "baseline")
        True
    """
    from . import _native

    return _native.compiled_level()


def __getattr__(name: str) -> object:
    import importlib

    for place, names in _PLACES.items():
        if name in names:
            value = getattr(importlib.import_module(f"{__name__}.{place}"), name)
            globals()[name] = value
            return value
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted(set(globals()) | set(__all__))
