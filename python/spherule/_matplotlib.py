"""Colors, color maps and ranges of matplotlib, by name and as objects; it is imported only for names that Spherule lacks."""

from __future__ import annotations

import difflib
from typing import TYPE_CHECKING, Any, get_args

from . import _values
from ._errors import Error
from .sections import ColorMap

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt

#: The colors "C0" to "C9" of matplotlib, and its names for them after "tab:".
_CYCLE = {
    "blue": "#1f77b4",
    "orange": "#ff7f0e",
    "green": "#2ca02c",
    "red": "#d62728",
    "purple": "#9467bd",
    "brown": "#8c564b",
    "pink": "#e377c2",
    "gray": "#7f7f7f",
    "olive": "#bcbd22",
    "cyan": "#17becf",
}

#: Colors of a map that is taken from matplotlib.
_ROWS = 256


def color_of(word: str) -> Any:
    """The linear color of a CSS name, of #rrggbb, or of a name of matplotlib; None if it is none."""
    from . import _native

    if word[:1] == "C" and word[1:].isascii() and word[1:].isdigit():
        word = list(_CYCLE.values())[int(word[1:]) % len(_CYCLE)]
    return _native.color_of(_CYCLE.get(word.removeprefix("tab:"), word) if word.startswith("tab:") else word)


def linear(encoded: npt.NDArray[Any]) -> npt.NDArray[np.float32]:
    """Linear colors of sRGB values from 0 to 1 (IEC 61966-2-1)."""
    import numpy as np

    low, high = encoded / 12.92, ((encoded + 0.055) / 1.055) ** 2.4
    return np.where(encoded <= 0.04045, low, high).astype(np.float32)


def map_words(name: str, value: Any) -> str:
    """A color map as the program has it: a name, or colors with commas between them.

    Maps of matplotlib are taken by name or as objects, and a list is one of colors.
    """
    import numpy as np

    if isinstance(value, str):
        own = [*get_args(ColorMap), "categories"]
        if value.lower() in own or "," in value:
            return value
        try:
            import matplotlib

            maps = matplotlib.colormaps
        except (ImportError, AttributeError):
            # Who has no matplotlib hears of our own maps.
            return value
        if value not in maps:
            near = difflib.get_close_matches(value, [*own, *maps], 1)
            if near and near[0] not in own:
                raise Error(f"unknown color map `{value}`; did you mean `{near[0]}`?")
            return value
        value = maps[value]
    if isinstance(value, (list, tuple)) and all(isinstance(word, str) for word in value):
        colors = [color_of(word) for word in value]
        if None in colors:
            row = colors.index(None)
            raise Error(f"{name}[{row}] is {value[row]!r}, but must be a CSS color or #rrggbb")
        return ",".join(_code(map(_encoded, color)) for color in colors)
    if not callable(value) or not hasattr(value, "N"):
        what = "the name of a color map, a map of matplotlib, or a list of colors"
        raise Error(f"`{name}` is {_values.shown(value)}, but must be {what}")
    return ",".join(_code(color[:3]) for color in np.asarray(value(np.linspace(0.0, 1.0, _ROWS))).tolist())


def _encoded(value: float) -> float:
    """The sRGB value of a linear one."""
    return 12.92 * value if value <= 0.0031308 else 1.055 * value ** (1 / 2.4) - 0.055


def _code(encoded: Any) -> str:
    return "#" + "".join(f"{round(255 * float(value)):02x}" for value in encoded)


def range_of(value: Any) -> tuple[tuple[float | str, float | str], bool] | None:
    """The ends of a ``Normalize`` or ``LogNorm``, and whether it is logarithmic; None for anything else."""
    if not (hasattr(value, "vmin") and hasattr(value, "vmax")):
        return None
    kind = type(value).__name__
    if kind not in ("Normalize", "LogNorm"):
        raise Error(f"`color_range` is a {kind} of matplotlib, but must be Normalize or LogNorm")
    low, high = ("auto" if end is None else float(end) for end in (value.vmin, value.vmax))
    return (low, high), kind == "LogNorm"
