"""Renders in parts, on other processes and machines, merged to the bytes of the whole.

:func:`render_part` renders one part of a picture to bytes, and :func:`merge` puts all of them together: by any engine
that calls functions elsewhere. :func:`render` does so as tasks of ``dask.distributed``: a worker that dies costs its
part alone, which another one renders.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from . import _options
from ._errors import Error, from_call
from ._picture import Picture
from ._render import _shown
from ._scene import Scene

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from ._options import RenderOptions


def _table(scene: Scene, options: Any) -> dict[str, Any]:
    given = {name: value for name, value in options.items() if value is not None}
    _options.check(given, _options.RENDER, _options.RUN)
    if not isinstance(scene, Scene):
        raise Error(f"parts are of a Scene, not of {type(scene).__name__}")
    for name in ("until_error", "time", "layers"):
        if name in given:
            raise Error(f"`{name}` needs the whole picture; parts take `spp`")
    if "spp" not in given:
        raise Error("parts need `spp`, the samples per pixel of the whole picture")
    return _options.render_table({"denoise": "off", **given})


@from_call
def render_part(scene: Scene, part: int, parts: int, **options: Unpack[RenderOptions]) -> bytes:
    """Renders one of several parts of a picture.

    Args:
        scene: The scene, the same for all parts.
        part: The number of this part, from 1.
        parts: How many parts there are: at most as many as samples per pixel or tiles of 16 x 16 pixels.
        **options: Those of :func:`spherule.render`, with ``spp``, the same for all parts.

    Returns:
        The part, as a checkpoint file of the program.

    Raises:
        Error: There is no such part, or an option needs the whole picture.

    Example:
        >>> from spherule import Scene
        >>> scene = Scene([[0, 0, 0]], radius=1)
        >>> pieces = [render_part(scene, part, 3, size=(64, 48), spp=4) for part in (1, 2, 3)]
        >>> merge(scene, pieces, size=(64, 48), spp=4).spp
        (4, 4)
    """
    from . import _native

    return _native.render_part(scene._native, _table(scene, options), part, parts, options.get("stop"))


@from_call
def merge(scene: Scene, pieces: Sequence[bytes], **options: Unpack[RenderOptions]) -> Picture:
    """Merges all parts of a picture, in any order.

    Args:
        scene: The scene of the parts.
        pieces: What :func:`render_part` returned, for every part.
        **options: Those of the parts.

    Returns:
        The picture, with the bytes of one that was rendered as a whole.

    Raises:
        Error: A part is missing, damaged, twice there, or of another render.

    Example:
        >>> from spherule import Scene
        >>> scene = Scene([[0, 0, 0]], radius=1)
        >>> merge(  # doctest: +ELLIPSIS
        ...     scene, [render_part(scene, 1, 2, size=(64, 48), spp=4)], size=(64, 48), spp=4
        ... )
        Traceback (most recent call last):
            ...
        spherule.Error: no part has samples 1 to 4 of tiles 7 to 12; render the missing parts, ...
    """
    from . import _native

    return _shown(_native.merge(scene._native, _table(scene, options), list(pieces)))


@from_call
def render(
    scene: Scene,
    client: Any = None,
    *,
    parts: int | None = None,
    **options: Unpack[RenderOptions],
) -> Picture:
    """Renders a picture in parts, as tasks of Dask.

    Args:
        scene: The scene, which is sent to every worker once.
        client: ``dask.distributed.Client``; by default the current one.
        parts: How many parts; by default four for each worker, so that fast workers take more.
        **options: Those of :func:`spherule.render`, with ``spp``; ``threads`` is that of each task, by default as many
            as its worker has.

    Returns:
        The picture, with the bytes of one that was rendered here.

    Raises:
        Error: As :func:`render_part`; and what Dask raises if its workers are gone.

    Example:
        >>> from dask.distributed import Client, LocalCluster
        >>> from spherule import Scene
        >>> cluster = LocalCluster(n_workers=1, processes=False, dashboard_address=":0")
        >>> with cluster, Client(cluster) as client:
        ...     render(Scene([[0, 0, 0]], radius=1), client, size=(64, 48), spp=4).complete
        True
    """
    if client is None:
        from dask.distributed import get_client

        client = get_client()
    # Before anything is sent.
    _table(scene, options)
    workers = client.scheduler_info(n_workers=-1)["workers"]
    if not workers:
        raise Error("the Dask cluster has no workers")
    if parts is None:
        parts = min(4 * len(workers), _most_parts(scene, options))
    given = {"threads": min(worker["nthreads"] for worker in workers.values()), **options}
    sent = client.scatter(scene, broadcast=True, hash=False)
    tasks = [client.submit(_task, sent, part, parts, given, pure=False) for part in range(1, parts + 1)]
    try:
        return merge(scene, client.gather(tasks), **options)
    finally:
        client.cancel([*tasks, sent])


def _task(scene: Scene, part: int, parts: int, options: dict[str, Any]) -> bytes:
    return render_part(scene, part, parts, **options)


def _most_parts(scene: Scene, options: Any) -> int:
    width, height = options.get("size") or scene.size
    tiles = -(-int(width) // 16) * -(-int(height) // 16)
    return max(tiles, int(options["spp"]))
