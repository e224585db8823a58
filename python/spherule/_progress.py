"""Progress of renders: a bar of tqdm if it is there, or else a line now and then."""

from __future__ import annotations

import sys
import time
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from . import _values

Report = Callable[[float, int, float, "float | None"], object]

#: Seconds before anything is shown, and between two lines.
_PATIENCE = 0.5
_PAUSE = 3.0


def in_notebook() -> bool:
    shell = sys.modules.get("IPython")
    if shell is None:
        return False
    running = shell.get_ipython()
    return running is not None and type(running).__name__ == "ZMQInteractiveShell"


@contextmanager
def reporting(progress: bool | Report | None) -> Iterator[Report | None]:
    """The function that hears of the progress; None if nobody wants to."""
    if callable(progress):
        yield progress
        return
    if progress is not None:
        progress = _values.flag("progress", progress)
    else:
        progress = in_notebook() or sys.stderr.isatty()
    if not progress:
        yield None
        return
    try:
        with warnings.catch_warnings():
            # In notebooks without widgets the bar is one of text, and the warning does not concern renders.
            warnings.simplefilter("ignore")
            from tqdm.auto import tqdm  # type: ignore[import-untyped,unused-ignore]
    except ImportError:
        yield _lines()
        return
    bar: Any = None

    def report(done: float, rays: int, seconds: float, error: float | None) -> None:
        nonlocal bar
        if bar is None:
            if seconds < _PATIENCE and done < 1.0:
                return
            bar = tqdm(total=100, unit="%", leave=False, bar_format="{l_bar}{bar}| {elapsed}<{remaining}{postfix}")
            # The render began before the bar.
            bar.start_t -= seconds
        rate = rays / max(seconds, 1e-9) / 1e6
        text = f"{rate:.1f} Mrays/s" + ("" if error is None else f", error {100 * error:.2f} %")
        bar.set_postfix_str(text, refresh=False)
        bar.update(100 * done - bar.n)

    try:
        yield report
    finally:
        if bar is not None:
            bar.close()


def _lines() -> Report:
    last = time.monotonic()

    def report(done: float, rays: int, seconds: float, error: float | None) -> None:
        nonlocal last
        now = time.monotonic()
        if now - last < _PAUSE:
            return
        last = now
        rate = rays / max(seconds, 1e-9) / 1e6
        text = f"{100 * done:.0f} %, {rate:.1f} Mrays/s" + ("" if error is None else f", error {100 * error:.2f} %")
        print(text, file=sys.stderr, flush=True)

    return report
