"""Movies: the frames of a trajectory as a video, or as numbered pictures."""

from __future__ import annotations

import itertools
import os
from collections.abc import Iterable, Iterator, Sized
from typing import TYPE_CHECKING, Any

from . import _options, _values
from ._errors import Error, from_call
from ._particles import Particles, frames as frames_of_file
from ._progress import Report, reporting
from ._render import rendered
from ._scene import Scene, file_options
from .structures import from_mdtraj

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from ._options import AllOptions


@from_call
def movie(
    frames: Any, path: str | os.PathLike[str], *, fps: float = 30.0, **options: Unpack[AllOptions]
) -> None:
    """Renders the frames of a trajectory as a video, or as numbered pictures.

    All frames are seen by one camera, which frames all of them, and share the ranges and the meaning of colors, guessed
    radii, what is up, and the number of samples, as the sequences of the program do. For that they are gone through
    twice; of an iterator, such as a generator, only the first frame is seen beforehand.

    Args:
        frames: The path of a particle file, or what can be gone through and yields what :func:`spherule.render` takes:
            arrays, :class:`Particles`, objects of ASE and other packages. Frames that are a :class:`Scene` have cameras
            and colors of their own. A ``Universe`` or an ``AtomGroup`` of MDAnalysis is its trajectory.
        path: A name that ends in .mp4, .mov, .webm or .gif, for which the program ``ffmpeg`` is needed; or one of
            pictures with their number, as in ``"frame-%04d.png"``.
        fps: Frames per second of a video.
        **options: Those of :func:`spherule.render`. ``progress`` is that of all frames.

    Raises:
        Error: Anything that cannot be used, or there is no ``ffmpeg``.
        KeyboardInterrupt: Ctrl-C: there is no video.

    Example:
        >>> import numpy as np, pathlib, tempfile
        >>> folder = pathlib.Path(tempfile.mkdtemp())
        >>> walk = np.random.default_rng(1).normal(size=(3, 20, 3)).cumsum(axis=0)
        >>> movie(walk, folder / "walk-%d.png", radius=0.3, size=(80, 60), spp=4)
        >>> sorted(file.name for file in folder.iterdir())
        ['walk-0.png', 'walk-1.png', 'walk-2.png']
    """
    from . import _native

    given: dict[str, Any] = {name: value for name, value in options.items() if value is not None}
    _options.check(given, _options.PARTICLES, _options.STYLE, _options.SECTIONS, _options.RENDER, _options.RUN)
    name = _values.path("path", path)
    fps = _values.number("fps", fps)
    if not 0 < fps < float("inf"):
        raise Error(f"`fps` is {fps:g}, but must be more than 0")
    for unfit in ("layers", "on_interrupt"):
        if unfit in given:
            raise Error(f"`{unfit}` is for single pictures; remove it")
    table = _options.render_table(given)
    looks = _options.part(given, _options.PARTICLES | _options.STYLE | _options.SECTIONS)
    looks["render"] = {**looks.get("render", {}), **_options.part(given, _options.RENDER)}
    numbered = _is_numbered(name)
    video = None if numbered else _native.Video(name, fps)
    try:
        with reporting(given.get("progress")) as report:
            shots = _Shots(_passes(frames, looks), looks)
            for number, scene in enumerate(shots):
                part = None if report is None else _part(report, number, shots.count)
                picture = rendered(scene, table, given, part, shots.first)
                if not picture.complete:
                    raise KeyboardInterrupt
                if part is not None:
                    part(1.0, picture.rays, picture.seconds, picture.error)
                if video is None:
                    picture.save(name % number)
                elif picture.pixels.shape[2] == 4:
                    raise Error("a video has no transparent background; save numbered pictures, as in frame-%04d.png")
                else:
                    video.add(picture.pixels, float(picture.exposure), picture.tone == "filmic")
        if shots.first is None:
            raise Error("`frames` has no frame")
        if video is not None:
            video.finish()
    except BaseException:
        if video is not None:
            video.discard()
        raise


_options.signed(movie, _options.PARTICLES, _options.STYLE, _options.SECTIONS, _options.RENDER, _options.RUN)


def _is_numbered(name: str) -> bool:
    """Whether a name has the number of a picture."""
    if "%" not in os.path.basename(name):
        return False
    try:
        return name % 0 != name % 1
    except (TypeError, ValueError):
        raise Error(f"`path` is {name!r}, but must have one number, as in frame-%04d.png") from None


class _Trajectory:
    """The frames of an MDAnalysis Universe or AtomGroup."""

    def __init__(self, group: Any) -> None:
        self.group = group

    def __len__(self) -> int:
        return len(self.group.universe.trajectory)

    def __iter__(self) -> Iterator[Any]:
        for _ in self.group.universe.trajectory:
            yield self.group


class _Slices:
    """The frames of an mdtraj Trajectory."""

    def __init__(self, trajectory: Any) -> None:
        self.trajectory = trajectory

    def __len__(self) -> int:
        return len(self.trajectory)

    def __iter__(self) -> Iterator[Particles]:
        for frame in range(len(self.trajectory)):
            yield from_mdtraj(self.trajectory, frame)


class _File:
    """The frames of a particle file."""

    def __init__(self, name: str, looks: dict[str, Any]) -> None:
        self.name = name
        self.options = file_options(looks)

    def __iter__(self) -> Iterator[Particles]:
        return frames_of_file(self.name, **self.options)


def _passes(frames: Any, looks: dict[str, Any]) -> Iterable[Any]:
    """The frames, which can be gone through twice unless they are an iterator."""
    if isinstance(frames, (str, os.PathLike)):
        name = os.fspath(frames)
        looks.setdefault("title", os.path.basename(name))
        return _File(name, looks)
    if hasattr(frames, "atoms") and hasattr(getattr(frames, "universe", None), "trajectory"):
        return _Trajectory(frames)
    if hasattr(frames, "unitcell_vectors"):
        return _Slices(frames)
    if isinstance(frames, (Scene, Particles)) or not hasattr(frames, "__iter__"):
        raise Error(f"`frames` is {_values.shown(frames)}, but must be a list or another iterable of frames, or a file")
    return frames  # type: ignore[no-any-return]


class _Shots:
    """The scenes of the frames, by what all of them share."""

    def __init__(self, frames: Iterable[Any], looks: dict[str, Any]) -> None:
        from . import _native

        self.looks = looks
        self.sequence = _native.FrameSequence()
        self.first: int | None = None
        self.count = len(frames) if isinstance(frames, Sized) else None
        self.frames = frames
        if iter(frames) is frames:
            one = list(itertools.islice(frames, 1))
            self.frames = itertools.chain(one, frames)
            surveyed: Iterable[Any] = one
        else:
            surveyed = frames
        seen = 0
        for frame in surveyed:
            seen += 1
            if not isinstance(frame, Scene):
                self.sequence.survey(Scene.arguments(frame, looks))
        if surveyed is frames:
            self.count = seen

    def __iter__(self) -> Iterator[Scene]:
        for frame in self.frames:
            if isinstance(frame, Scene):
                scene = frame
                if looks := set(self.looks) - {"render"}:
                    raise Error(f"`{sorted(looks)[0]}` belongs to the scenes: give it to Scene")
            else:
                scene = Scene.of_native(self.sequence.scene(Scene.arguments(frame, self.looks)))
            if self.first is None:
                self.first = len(scene)
            yield scene


def _part(report: Report, number: int, count: int | None) -> Report:
    """The report of a frame as that of all of them; of one frame if their number is not known."""

    def told(done: float, rays: int, seconds: float, error: float | None) -> object:
        total = done if count is None else (number + done) / max(count, 1)
        return report(total, rays, seconds, error)

    return told
