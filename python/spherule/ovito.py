"""A layer of viewports of OVITO, which renders the particles of a pipeline as the viewport sees them.

OVITO Pro lists it among its viewport layers where the package is installed; in scripts it belongs to ``Viewport.overlays``.
"""

from __future__ import annotations

import math
from typing import Any, get_args

import numpy as np
import traits.api
from ovito.vis import ViewportOverlayInterface

from . import _render
from ._errors import Error
from .friends import from_ovito
from .sections import Preset


class SpheruleOverlay(ViewportOverlayInterface):  # type: ignore[misc, unused-ignore]
    """Renders the particles of the overlay's pipeline by Spherule, in the place of what the viewport shows.

    The camera is that of the viewport; radii, colors and the cell are those that OVITO has. With the option
    ``background="transparent"`` the layer is drawn over OVITO's own image, or under other layers.

    Args:
        preset: As for :func:`spherule.render`.
        spp: Samples per pixel of the image that OVITO saves; in interactive viewports there are 4.
        options: Other keyword arguments of :func:`spherule.render`, which go before the viewport's.

    Example:
        >>> from ovito.vis import PythonViewportOverlay, Viewport
        >>> viewport = Viewport(type=Viewport.Type.Perspective)
        >>> layer = SpheruleOverlay(preset="chalk", spp=32, options={"model": "ball-and-stick"})
        >>> viewport.overlays.append(PythonViewportOverlay(delegate=layer))
    """

    preset = traits.api.Enum(*get_args(Preset), label="Preset")
    spp = traits.api.Range(low=1, high=65536, value=64, label="Samples per pixel")
    options: Any = traits.api.Dict(key_trait=traits.api.Str, label="Options")

    def render(self, canvas: Any, *, data: Any = None, interactive: bool = False, **_: Any) -> None:
        """Draws the picture over the whole canvas; OVITO calls it."""
        from ovito.qt_compat import QtGui

        if data is None or data.particles is None or not data.particles.count:
            return
        # Pictures are made larger than they are saved, so that pixels have fewer samples.
        (width, height), logical = canvas.physical_size, canvas.logical_size
        share = min(1.0, logical[0] * logical[1] / (width * height))
        given: dict[str, Any] = {
            "preset": self.preset,
            "spp": 4 if interactive else math.ceil(self.spp * share),
            "denoise": "on",
            "size": (int(width), int(height)),
            "progress": False,
            **_looks(data),
            "camera": _camera(canvas, data),
            **self.options,
        }
        picture = _render.render(given.pop("particles"), **given)
        image = QtGui.QImage.fromData(picture.encode("png"), "PNG")
        if image.isNull():
            raise Error("OVITO cannot read the picture")
        canvas.draw_image(image.convertToFormat(canvas.preferred_qimage_format), pos=(0.0, 0.0), size=(1.0, 1.0))


def _looks(data: Any) -> dict[str, Any]:
    """The particles, with the radii that OVITO draws, and whether it draws the cell."""
    particles = from_ovito(data)
    found: dict[str, Any] = {"particles": particles}
    visual = data.particles.vis
    if visual is not None:
        if particles.radius is None:
            # Where neither particles nor types have a radius.
            found["radius"] = float(visual.radius)
        found["radius_scale"] = float(visual.scaling)
    cell = data.cell
    found["show_cell"] = bool(particles.cell is not None and cell.vis is not None and cell.vis.enabled and cell.vis.render_cell)
    return found


def _camera(canvas: Any, data: Any) -> dict[str, Any]:
    """The section `camera` of the viewport."""
    # Of world to camera, which looks along -z.
    view = np.asarray(canvas.view_tm, np.float64)
    turn, shift = view[:, :3], view[:, 3]
    eye, forward, up = -turn.T @ shift, -turn[2], turn[1]
    if canvas.is_perspective:
        places = {"eye": eye.tolist(), "target": (eye + forward).tolist(), "up": up.tolist()}
        return {"projection": "perspective", "fov": float(np.degrees(canvas.field_of_view)), **places}
    # Parallel views have no place along their direction: before all particles.
    positions = np.asarray(data.particles["Position"])
    low, high = positions.min(axis=0), positions.max(axis=0)
    back = float(np.linalg.norm(high - low) + np.linalg.norm((low + high) / 2 - eye)) + canvas.field_of_view
    eye = eye - back * forward
    places = {"eye": eye.tolist(), "target": (eye + back * forward).tolist(), "up": up.tolist()}
    # The field of view is half of the height.
    return {"projection": "orthographic", "height": 2 * float(canvas.field_of_view), **places}
