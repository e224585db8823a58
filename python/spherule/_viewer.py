"""The viewer in notebooks: a widget, whose images come from the program over the notebook's own channel."""

from __future__ import annotations

import asyncio
import json
import os
import re
import shlex
import tempfile
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from . import _options, _toml, _values
from ._errors import Error, from_call, warn
from ._picture import Picture
from ._render import scene_of
from ._session import Session

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from ._options import AllOptions

try:
    import anywidget
    import traitlets
except ImportError:
    _is_there = False
else:
    _is_there = True

#: Options of the program with the names of arguments, and others; its values are texts, numbers and flags.
_WORDS = {
    name: name.replace("_", "-")
    for name in (
        "select colors color_by color_map color_title color_log bonds bond_radius polyhedra polyhedra_opacity opacity "
        "translucent hide model arrows arrow_scale arrow_radius arrow_color arrow_center preset background zoom roll up wrap complete "
        "outside slice_mode radius_scale legend axes scale_bar label spp depth integrator sampler exposure tone denoise seed"
    ).split()
} | {"radius": "radii", "styles": "style", "slices": "slice", "show_cell": "cell", "view": "view", "look_at": "look-at"}


def _words(given: Mapping[str, Any]) -> list[str] | None:
    """Arguments as options of the program; None if it has others."""
    words = []
    for name, value in given.items():
        values = value if isinstance(value, (list, tuple)) else [value]
        if name not in _WORDS or not all(isinstance(own, (str, int, float)) for own in values):
            return None
        if isinstance(value, (list, tuple)) and name not in ("styles", "slices", "polyhedra", "label"):
            return None
        for own in values:
            if own is not False:
                words.append(f"--{_WORDS[name]}" + ("" if own is True else f"={own}"))
    return words


def _keys(line: str) -> dict[str, Any]:
    """Keys of a section and their values, on one line."""
    pairs = re.findall(r'(\w+) = (\[[^\]]*\]|"[^"]*"|[^,]+)', line)
    return {name: json.loads(value) for name, value in pairs}


def _camera(state: Mapping[str, Any]) -> dict[str, Any]:
    return _keys(state["camera"]["line"])


def _ids(state: Mapping[str, Any]) -> list[int]:
    """Ids of the selected particles; one that has a word for it is left out."""
    return [int(own["id"]) for own in state["picked"] if own["id"] is not None]


if TYPE_CHECKING or _is_there:

    class Viewer(anywidget.AnyWidget):
        """A view that one turns in a notebook: JupyterLab, Notebook, VS Code, Colab.

        It is the page of ``spherule view``, with all its options, keys and commands. The image is traced in a process
        beside the kernel, with the final light, and refines while nothing moves; it needs no port and no graphics
        card. The package ``anywidget`` must be installed.

        Args:
            source: What :func:`spherule.render` takes. The viewer reads a file itself: it has its frames, columns and types.
            **options: Those of :func:`spherule.render`, but for ``layers``, ``threads`` and the like.

        Attributes:
            camera: The keys of the section ``[camera]``. Setting it moves the camera, and
                ``spherule.render(..., camera=viewer.camera)`` renders with it.
            frame: The frame of a trajectory, from 0; setting it shows another one.
            selection: The ids of the particles that are selected, or their rows if they have none; in the order of their
                selection, if these are four at most. Setting it selects and marks others, 1000 at most;
                ``viewer.command("pick 'q < 0'")`` selects by a condition. ``picked`` is what the file says of the last one,
                or None.

        All four can be observed and linked to other widgets, as traits of :mod:`traitlets`; all but ``picked`` can be set.
        They follow the mouse while the kernel is idle.

        Raises:
            Error: As :func:`spherule.render`; or the program or ``anywidget`` is not installed.
        """

        _esm = traitlets.Unicode().tag(sync=True)
        _markup = traitlets.Unicode().tag(sync=True)
        _style = traitlets.Unicode().tag(sync=True)
        camera = traitlets.Dict()
        frame = traitlets.Int()
        selection: traitlets.List[int] = traitlets.List()
        picked = traitlets.Unicode(None, allow_none=True)

        _session: Session | None = None
        _folder: tempfile.TemporaryDirectory[str] | None = None
        # Whether a notebook shows it.
        _is_shown = False

        @from_call
        def __init__(self, source: Any = None, **options: Unpack[AllOptions]) -> None:
            given: dict[str, Any] = {name: value for name, value in options.items() if value is not None}
            for unfit in sorted(_options.RUN & set(given)):
                raise Error(f"`{unfit}` is for pictures; remove it")
            try:
                # What is told while a cell runs is handled once it is done.
                self._loop: asyncio.AbstractEventLoop | None = asyncio.get_running_loop()
            except RuntimeError:
                self._loop = None
            words = _words(given) if isinstance(source, (str, os.PathLike)) else None
            if words is not None:
                words = [_values.path("source", source), *words]
            else:
                scene, _ = scene_of(source, given)
                self._folder = tempfile.TemporaryDirectory(prefix="spherule-")
                name = os.path.join(self._folder.name, "view.toml")
                scene.save(name)
                words = [name]
                if "spp" in given:
                    # The viewer has its own number of samples, whatever the scene's is.
                    words.append(f"--spp={_values.integer('spp', given['spp'])}")
            self._session = session = Session(words, self._hear, self._receive, self._lose)
            for text in session.warnings:
                warn(text)
            page = session.page
            super().__init__(_esm=page["page.js"], _markup=page[""], _style=page["page.css"])
            self._apply()
            self.observe(self._place_camera, "camera")
            self.observe(self._go_to_frame, "frame")
            self.observe(self._select, "selection")
            self.on_msg(self._obey)

        @from_call
        def picture(self, spp: int = 1) -> Picture:
            """The picture that the view shows, in its size.

            Args:
                spp: Wait until it has so many samples per pixel, or is finished.

            Raises:
                Error: The background is transparent, or the viewer is closed.
            """
            import numpy as np

            header, pixels = self._open().pixels(_values.integer("spp", spp, 1))
            height, width, channels = header.pop("shape")
            samples = header.pop("samples")
            numbers = np.frombuffer(pixels, "<f4").astype(np.float32).reshape(height, width, channels)
            table = {
                **header,
                "pixels": numbers,
                "matte": None,
                "drawn": None,
                "layers": {},
                "complete": True,
                "spp": (samples, samples),
                "sampled": 1.0,
                "samples": samples * width * height,
                "rays": 0,
                "seconds": 0.0,
            }
            del table["file"]
            return Picture(table)

        @from_call
        def command(self, line: str) -> None:
            """Does what a line of a script of the viewer does, as in ``"set color-by q"`` or ``"key 7"``.

            Raises:
                Error: The line cannot be understood, or the viewer is closed.
            """
            self._open().command(_values.text("line", line))
            self._apply()

        def close(self) -> None:
            """Ends the view, and removes it from the notebook."""
            session, self._session = self._session, None
            if session is not None:
                session.close()
            if self._folder is not None:
                self._folder.cleanup()
            super().close()

        def _open(self) -> Session:
            if self._session is None:
                raise Error("the viewer is closed; open another one")
            return self._session

        def _hear(self, text: str, _: dict[str, Any]) -> None:
            if self._session is None:
                return
            if self._is_shown:
                self.send({"text": text})
            # Traits change on the thread of the kernel alone; without its loop, after commands.
            if self._loop is not None and not self._loop.is_closed():
                self._loop.call_soon_threadsafe(self._apply)

        def _receive(self, content: bytes) -> bool:
            if self._is_shown:
                self.send({"data": len(content)}, buffers=[content])
            return self._is_shown

        def _lose(self) -> None:
            if self._session is not None and self._is_shown:
                self.send({"lost": True})

        def _obey(self, _: Any, content: Any, buffers: Any) -> None:
            line = content.get("line") if isinstance(content, dict) else None
            if isinstance(line, str) and self._session is not None:
                self._is_shown |= line == "join"
                self._session.send(line)

        def _apply(self) -> None:
            """Sets the traits to what the session says."""
            if self._session is None:
                return
            state = self._session.state
            if self.camera != (camera := _camera(state)):
                self.camera = camera
            self.frame = state["frame"]
            picked = state["picked"]
            self.selection = _ids(state)
            self.picked = picked[-1]["text"] if picked else None

        def _place_camera(self, change: Any) -> None:
            if change["new"] == _camera(self._open().state):
                return
            keys = _toml.line("camera", change["new"])
            self._ask(f"camera {shlex.quote(keys)}")

        def _go_to_frame(self, change: Any) -> None:
            if change["new"] != self._open().state["frame"]:
                self._ask(f"frame {change['new']}")

        def _select(self, change: Any) -> None:
            if change["new"] == _ids(self._open().state):
                return
            ids = [_values.integer("selection", own, 0) for own in change["new"]]
            # Measures depend on the order of up to four.
            several = [f"'id {own}'" for own in ids] if len(ids) <= 4 else [f"'id {' '.join(map(str, ids))}'"]
            self._ask(" ".join(["pick", *several]))
            if missing := set(ids) - set(self.selection):
                raise Error(f"no particle {min(missing)} is shown")

        def _ask(self, line: str) -> None:
            try:
                self._open().command(line)
            finally:
                self._apply()

else:

    class Viewer:  # type: ignore[no-redef]
        """A view that one turns in a notebook; the package ``anywidget`` is not installed."""

        @from_call
        def __init__(self, source: Any = None, **options: Any) -> None:
            raise Error("the viewer in notebooks needs anywidget: pip install anywidget")


_options.signed(Viewer, _options.PARTICLES, _options.STYLE, _options.SECTIONS, _options.RENDER)
