"""Entry points that ASE finds by itself: ``ase.visualize.view(atoms, viewer="spherule")`` and ``ase.io.write("a.png", atoms,
format="spherule")``.

For ASE alone, which imports this module when it is asked for them.
"""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import tempfile
from collections.abc import Mapping, Sequence
from io import StringIO
from typing import Any

from ase.utils.plugins import ExternalIOFormat, ExternalViewer

from . import _program, _render, _scene, _values
from ._errors import Error, warn
from ._progress import in_notebook

#: The entry points of the groups ``ase.visualize`` and ``ase.ioformats``.
VIEWER = ExternalViewer(desc="Page of the browser, ray traced.", module=__name__)
FORMAT = ExternalIOFormat(desc="Picture that Spherule renders", code="1S", module=__name__)

#: Options of the program that have other names than in Python.
_OPTIONS = {"show_cell": "cell", "slices": "slice", "styles": "style"}


def view_spherule(atoms: Any, data: Any = None, repeat: Any = None, **options: Any) -> Any:
    """Shows atoms, or a trajectory of them, in the page of ``spherule view``; in a notebook, as a scene that displays itself.

    Args:
        atoms: ``ase.Atoms``, or a list of these.
        data: Must be None: volumes are not drawn.
        repeat: Copies along the edges of the cell.
        **options: Those of :func:`spherule.render` that say how particles are drawn, as in ``model="ball-and-stick"``.

    Returns:
        The process of the viewer, whose ``wait`` returns when it ends; in a notebook a :class:`spherule.Scene`.

    Raises:
        Error: Something cannot be shown, or the program is not there.
    """
    if data is not None:
        raise Error("`data` cannot be drawn; draw an isosurface of it by `triangles` of spherule.render")
    frames = list(atoms) if isinstance(atoms, (list, tuple)) else [atoms]
    if not frames:
        raise Error("`atoms` is an empty list")
    if repeat is not None:
        frames = [frame.repeat(repeat) for frame in frames]
    if in_notebook():
        if len(frames) > 1:
            warn(f"shows the first of {len(frames)} frames; spherule.movie makes a video of all")
        return _scene.Scene(frames[0], **options)
    name = _program.find()
    if name is None:
        raise Error("the program `spherule` is not installed; its folder must be in PATH")
    from ase.io import write

    text = StringIO()
    write(text, frames, format="extxyz")
    title = frames[0].get_chemical_formula(empirical=False)[:40] or "atoms"
    # By itself: the page is there until its own Ctrl-C, also after the script that shows it.
    command = [sys.executable, "-m", __name__, f"{title}.xyz", name, *_words(options)]
    process = subprocess.Popen(command, stdin=subprocess.PIPE, text=True)
    if process.stdin is not None:
        process.stdin.write(text.getvalue())
        process.stdin.close()
    return process


def write_spherule(path: str, images: Sequence[Any], **options: Any) -> None:
    """Renders the last of the images to a file, whose name tells the format.

    Args:
        path: The file of a picture, as ``"a.png"`` or ``"a.pdf"``.
        images: What ASE writes: ``ase.Atoms``, or a list of these.
        **options: Those of :func:`spherule.render`.

    Raises:
        Error: As for :func:`spherule.render`, or the name has no format.
    """
    atoms = images[-1] if isinstance(images, (list, tuple)) else images
    _render.render(atoms, **options).save(path)


def _words(options: Mapping[str, Any]) -> list[str]:
    """The options of the program for keyword arguments of Python."""
    words: list[str] = []
    for name, value in options.items():
        option = "--" + _OPTIONS.get(name, name).replace("_", "-")
        if name == "styles":
            texts = _scene.style_texts(value)
            if any(color is not None for _, color in texts):
                raise Error("`styles` has a color that is numbers, but for the viewer must have names or #rrggbb")
            values = [text for text, _ in texts]
        elif name == "complete" and isinstance(value, bool):
            values = ["yes" if value else "no"]
        elif value is None or value is False:
            continue
        elif value is True:
            words.append(option)
            continue
        elif name == "size" and isinstance(value, (list, tuple)):
            values = ["x".join(str(item) for item in value)]
        elif isinstance(value, (list, tuple)) and name in ("slices", "label", "polyhedra"):
            values = [_values.text(name, item) for item in value]
        elif isinstance(value, (list, tuple)):
            values = [",".join(str(item) for item in value)]
        elif isinstance(value, (str, int, float)):
            values = [str(value)]
        else:
            raise Error(f"`{name}` is {_values.shown(value)}, but for the viewer must be a text, a number, or several of these")
        words += [f"{option}={text}" for text in values]
    return words


def _run(name: str, command: str, options: Sequence[str]) -> int:
    """Shows the atoms of standard input, which are a file as long as the viewer runs."""
    with tempfile.TemporaryDirectory(prefix="spherule-view-") as folder:
        path = os.path.join(folder, name)
        with open(path, "wb") as file:
            file.write(sys.stdin.buffer.read())
        process = subprocess.Popen([command, "view", path, *options], stdin=subprocess.DEVNULL)
        signal.signal(signal.SIGTERM, lambda *_: process.terminate())
        while True:
            try:
                code = process.wait()
                # As shells have the signal that ended it.
                return code if code >= 0 else 128 - code
            except KeyboardInterrupt:
                # It has the interrupt of the terminal, too, and ends by it.
                continue


if __name__ == "__main__":
    sys.exit(_run(sys.argv[1], sys.argv[2], sys.argv[3:]))
