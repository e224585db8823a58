"""Renders: in one line, step by step, or beside other tasks of an event loop."""

from __future__ import annotations

import os
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from . import _options, _values
from ._errors import Error, Interrupted, from_call, warn
from ._picture import Picture
from ._progress import Report, reporting
from ._scene import Scene

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from ._options import AllOptions


def scene_of(source: Any, given: dict[str, Any]) -> tuple[Scene, bool]:
    """The scene, and whether it is of this call alone; for the package alone."""
    _options.check(given, _options.PARTICLES, _options.STYLE, _options.SECTIONS, _options.RENDER, _options.RUN)
    looks = _options.part(given, _options.PARTICLES | _options.STYLE | _options.SECTIONS)
    if isinstance(source, Scene):
        if looks:
            raise Error(f"`{sorted(looks)[0]}` belongs to the scene: give it to Scene")
        return source, False
    settings = _options.part(given, _options.RENDER)
    if settings and not (isinstance(source, (str, os.PathLike)) and os.fspath(source).lower().endswith(".toml")):
        # Lights and the camera may depend on the picture's size.
        looks["render"] = {**looks.get("render", {}), **settings}
    if isinstance(source, (str, os.PathLike)):
        return Scene.load(source, **looks), True
    return Scene(source, **looks), True


def _stop(given: dict[str, Any]) -> Any:
    from . import _native

    stop = given.get("stop")
    if stop is not None and not isinstance(stop, _native.Stop):
        raise Error(f"`stop` is {_values.shown(stop)}, but must be a spherule.Stop")
    return stop


def _shown(table: dict[str, Any]) -> Picture:
    for text in table["warnings"]:
        warn(text)
    return Picture(table)


def rendered(
    scene: Scene,
    table: dict[str, Any],
    given: dict[str, Any],
    report: Report | None,
    first_frame: int | None = None,
    *,
    is_own: bool = False,
) -> Picture:
    """The picture of a scene, which is used up if it is the call's own."""
    from . import _native

    return _shown(_native.render(scene._native, table, is_own, _stop(given), report, first_frame))


@from_call
def render(source: Any = None, **options: Unpack[AllOptions]) -> Picture:
    """Renders a picture.

    With nothing but positions, it is the figure that the program makes of a particle file: framed by the camera, in
    soft light before white, denoised, until its error is below 1 %. Equal scenes and settings give equal pixels, on any
    machine, with any number of threads, and in the program.

    Args:
        source: (n, 3) positions, a tuple of the columns x, y and z, :class:`Particles`, a :class:`Scene`, or the path
            of a scene or a particle file. None for a scene of sections alone.
        **options: Those of :class:`Scene`, unless the source is one, and:

            size: Width and height in pixels, 1 to 65535; or on paper, as in ``"85mm x 60mm"`` or ``"85mm"``, which keeps
                the aspect: in mm, cm, in or pt.
            dpi: Pixels per inch on paper, which files of the picture store; 300 if ``size`` is a length. Letters of
                annotations are then 7 points large.
            spp: Samples per pixel; the most, if an error or a time stops the render.
            until_error: Stop below this relative error, more than 0 and at most 1.
            time: Stop after so many seconds.
            denoise: ``"auto"``: unless samples or an error are chosen; ``"on"`` or ``"off"``.
            seed, depth, integrator, sampler, filter, roulette, light_choice, shadow_samples, ao_distance, caustics,
            exposure, tone: As in the section ``[render]`` of scene files.
            layers: Names of layers to render, or ``"all"``: see :class:`Picture`.
            threads: How many threads; by default as many as the process may use.
            progress: True or False, or a function of the fraction done, rays, seconds and error; by default a bar in
                terminals and notebooks, by tqdm if it is there.
            stop: A :class:`Stop` that ends the render from another thread.
            on_interrupt: ``"return"``: Ctrl-C ends the render and returns the picture so far, with ``complete`` false
                and a warning. ``"raise"``: it raises :class:`Interrupted`, which has the picture.

    Raises:
        Error: Anything that cannot be used, by name and row, with the text of the program.
        TypeError: An unknown argument.
        KeyboardInterrupt: Ctrl-C before there is a picture.

    Example:
        >>> picture = render([[0, 0, 0], [1, 0, 0]], radius=0.5, color=["tomato", "steelblue"], size=(80, 60), spp=4)
        >>> picture.pixels.shape, picture.pixels.dtype
        ((60, 80, 3), dtype('float32'))
    """
    given: dict[str, Any] = {name: value for name, value in options.items() if value is not None}
    on_interrupt = given.get("on_interrupt", "return")
    if on_interrupt not in ("return", "raise"):
        raise Error(f"`on_interrupt` is {on_interrupt!r}, but must be return or raise")
    table = _options.render_table(given)
    scene, is_own = scene_of(source, given)
    with reporting(given.get("progress")) as report:
        picture = rendered(scene, table, given, report, is_own=is_own)
    stop = _stop(given)
    if picture.complete or (stop is not None and stop.is_set()):
        return picture
    if on_interrupt == "raise":
        raise Interrupted(picture)
    gaps = ""
    if picture.sampled < 1:
        gaps = f": {100 * picture.sampled:.1f} % of its pixels are sampled, the others show the background"
    warn(f"interrupted: the picture is incomplete{gaps}")
    return picture


@from_call
def refine(source: Any = None, seconds: float = 0.5, **options: Unpack[AllOptions]) -> Iterator[Picture]:
    """Renders step by step: an iterator of pictures with less and less noise, for live display.

    Args:
        source, **options: As for :func:`render`.
        seconds: The time of a step, 0 or more.

    Yields:
        The picture so far; the last one is that of :func:`render`.

    Raises:
        Error: As :func:`render`.

    Example:
        >>> *_, last = refine([[0, 0, 0]], 0.05, radius=1, size=(80, 60), spp=64)
        >>> last.complete, last.spp
        (True, (64, 64))
    """
    from . import _native

    given: dict[str, Any] = {name: value for name, value in options.items() if value is not None}
    table = _options.render_table(given)
    scene, _ = scene_of(source, given)
    seconds = _values.number("seconds", seconds)
    return _steps(_native.refine(scene._native, table), seconds, _stop(given))


def _steps(refinement: Any, seconds: float, stop: Any) -> Iterator[Picture]:
    while (step := refinement.step(seconds, stop)) is not None:
        yield _shown(step)


async def render_async(source: Any = None, **options: Unpack[AllOptions]) -> Picture:
    """Renders on a thread while the event loop goes on; cancelling the task ends the render.

    Args:
        source, **options: As for :func:`render`.

    Raises:
        Error: As :func:`render`.

    Example:
        >>> import asyncio
        >>> asyncio.run(render_async([[0, 0, 0]], radius=1, size=(40, 30), spp=4)).complete
        True
    """
    import asyncio

    from . import _native

    stop = options.get("stop") or _native.Stop()
    options["stop"] = stop
    options.setdefault("progress", False)
    try:
        return await asyncio.to_thread(lambda: render(source, **options))
    except asyncio.CancelledError:
        stop.set()
        raise


for _function in (render, refine, render_async):
    _options.signed(
        _function, _options.PARTICLES, _options.STYLE, _options.SECTIONS, _options.RENDER, _options.RUN
    )
