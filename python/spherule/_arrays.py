"""Arrays as the extension module takes them: of floats, with the right shape.

Arrays of float32 and float64 are passed as they are, whatever their strides; all others are converted to float64.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from . import _matplotlib
from ._errors import Error

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt


#: The most rows of names that are put in order between two looks at signals: some hundredths of a second.
_CHUNK = 1 << 17


def floats(name: str, value: Any) -> npt.NDArray[Any]:
    """An array of float32 or float64, in this machine's byte order."""
    import numpy as np

    array: npt.NDArray[Any]
    refuse_masked(name, value)
    try:
        array = np.asarray(value)
    except ValueError as error:
        raise Error(f"`{name}` is not an array of numbers: {error}") from None
    if array.dtype.kind not in "fiub":
        raise Error(f"`{name}` is an array of {array.dtype}, but must be one of real numbers")
    if array.dtype.kind == "f" and array.dtype.itemsize in (4, 8) and array.dtype.isnative:
        return aligned(array)
    converted: npt.NDArray[np.float64] = array.astype(np.float64)
    return converted


def aligned(array: npt.NDArray[Any]) -> npt.NDArray[Any]:
    """The array, or a copy if its numbers do not begin where the processor wants them."""
    import numpy as np

    # NumPy takes any place of an array without numbers for aligned.
    places = (array.ctypes.data, *array.strides)
    return array if all(place % array.itemsize == 0 for place in places) else np.array(array)


def refuse_masked(name: str, value: Any) -> None:
    """Refuses a masked array with entries that are masked: NumPy would take what is behind the mask."""
    import numpy as np

    if isinstance(value, np.ma.MaskedArray) and (mask := np.ma.getmaskarray(value)).any():
        row = ", ".join(str(int(index)) for index in np.argwhere(mask)[0])
        raise Error(f"{name}[{row}] is masked, but must be a value; leave such rows out")


def refuse_missing(name: str, array: npt.NDArray[Any]) -> None:
    """Refuses an array of objects with None, NaN or pandas' NA in place of a name."""
    import numpy as np

    if array.dtype.kind not in "OT":
        return
    wrong = [not isinstance(item, (str, bytes, int, np.integer)) for item in array.tolist()]
    if any(wrong):
        row = wrong.index(True)
        raise Error(f"{name}[{row}] is {array[row]}, but must be a string or an integer; leave such rows out")


def bonds(value: Any, shifts: Any, count: int) -> tuple[npt.NDArray[np.uint32], npt.NDArray[np.int8] | None]:
    """Pairs of rows, the lesser one first, sorted, each once; and the edges of the cell to add to the second one."""
    import numpy as np

    refuse_masked("bonds", value)
    pairs = np.asarray(value)
    if pairs.size == 0:
        return np.zeros((0, 2), np.uint32), None
    if pairs.ndim != 2 or pairs.shape[1] != 2:
        raise Error(f"`bonds` has the shape {pairs.shape}, but must have (n, 2): the rows of both particles")
    if pairs.dtype.kind not in "iu":
        raise Error(f"`bonds` is an array of {pairs.dtype}, but must be one of integers")
    wrong = np.flatnonzero(((pairs < 0) | (pairs >= count)).any(axis=1))
    if len(wrong):
        first, second = pairs[wrong[0]].tolist()
        raise Error(f"bonds[{wrong[0]}] is {first}, {second}, but must be rows of the {count} particles")
    pairs = pairs.astype(np.int64)
    edges = np.zeros((len(pairs), 0), np.int64)
    if shifts is not None:
        edges = np.asarray(shifts)
        if edges.shape != (len(pairs), 3) or edges.dtype.kind not in "iu" or (abs(edges.astype(np.int64)) > 127).any():
            raise Error(f"`bond_shifts` must be ({len(pairs)}, 3) integers from -127 to 127")
        edges = edges.astype(np.int64)
    same = pairs[:, 0] == pairs[:, 1]
    if (wrong := np.flatnonzero(same & ~edges.any(axis=1))).size:
        raise Error(f"bonds[{wrong[0]}] bonds particle {pairs[wrong[0], 0]} to itself")
    back = pairs[:, 0] > pairs[:, 1]
    if edges.shape[1]:
        # Of the two ways to name a bond to an image of the same particle, the one whose first edge is negative.
        leading = edges[np.arange(len(edges)), (edges != 0).argmax(axis=1)]
        back |= same & (leading > 0)
    table = np.hstack([np.sort(pairs, axis=1), np.where(back[:, None], -edges, edges)])
    table = table[np.lexsort(table.T[::-1])]
    table = table[np.append(True, (table[1:] != table[:-1]).any(axis=1))]
    found = None if shifts is None else np.ascontiguousarray(table[:, 2:], np.int8)
    return np.ascontiguousarray(table[:, :2], np.uint32), found


def shapes(
    semi_axes: Any, orientation: Any, count: int
) -> tuple[npt.NDArray[Any] | None, npt.NDArray[Any] | None]:
    """Semi-axes and quaternions, a row for each of `count` particles."""
    import numpy as np

    if semi_axes is None:
        if orientation is not None:
            raise Error("`orientation` needs `semi_axes`")
        return None, None

    def rows(name: str, value: Any, width: int) -> npt.NDArray[Any]:
        array = floats(name, value)
        if array.shape == (width,):
            return np.broadcast_to(array, (count, width))
        if array.shape != (count, width):
            raise Error(f"`{name}` has the shape {array.shape}, but must have ({count}, {width}), one row per position")
        return array

    axes = rows("semi_axes", semi_axes, 3)
    if orientation is None:
        return axes, None
    quaternions = rows("orientation", orientation, 4)
    if (wrong := np.flatnonzero(~quaternions.any(axis=1))).size:
        raise Error(f"orientation[{wrong[0]}] is 0, but must be a quaternion w, x, y, z")
    return axes, quaternions


def triangles(value: Any) -> tuple[npt.NDArray[np.float64] | None, dict[str, Any] | None]:
    """Corners of all triangles but the first, and this one as a section, whose material and color all have."""
    import numpy as np

    if value is None:
        return None, None
    section = dict(value) if isinstance(value, Mapping) else {"corners": value}
    corners = floats("triangles", section.pop("corners", ())).astype(np.float64)
    if corners.ndim != 3 or corners.shape[1:] != (3, 3):
        raise Error(f"`triangles` has the shape {corners.shape}, but must have (n, 3, 3): three corners each")
    wrong = np.flatnonzero(~np.isfinite(corners).all(axis=(1, 2)))
    if len(wrong):
        raise Error(f"triangles[{wrong[0]}] has a corner that is not finite")
    if not len(corners):
        return None, None
    return corners[1:].reshape(-1), {**dict(zip("abc", corners[0].tolist())), **section}


def table(name: str, value: Any, width: int = 3) -> npt.NDArray[Any]:
    """Rows of `width` numbers, from rows or from a tuple of `width` columns."""
    import numpy as np

    if isinstance(value, tuple) and len(value) == width and all(getattr(item, "ndim", 0) == 1 for item in value):
        columns = [floats(f"{name}[{row}]", column) for row, column in enumerate(value)]
        lengths = [len(column) for column in columns]
        if len(set(lengths)) > 1:
            raise Error(
                f"the columns of `{name}` have {', '.join(map(str, lengths))} entries, but must have equally many"
            )
        rows: npt.NDArray[Any] = np.stack(columns).T
        return rows
    array = floats(name, value)
    if array.ndim != 2 or array.shape[1] != width:
        raise Error(f"`{name}` has the shape {array.shape}, but must have (n, {width})")
    return array


def column(name: str, value: Any, count: int) -> npt.NDArray[Any]:
    """A number for each of `count` rows; one number is one for all."""
    import numpy as np

    array = floats(name, value)
    if array.ndim == 0:
        return np.broadcast_to(array, (count,))
    if array.ndim != 1 or len(array) != count:
        raise Error(f"`{name}` has the shape {array.shape}, but must have ({count},), one entry for each position")
    return array


def single(name: str, array: npt.NDArray[Any]) -> npt.NDArray[np.float32]:
    """The array in single precision; without a copy if it is already. Refuses what is too large for it."""
    import numpy as np

    if array.dtype == np.float32:
        return array
    with np.errstate(over="ignore"):
        found: npt.NDArray[np.float32] = array.astype(np.float32)
    if (over := np.isinf(found) & np.isfinite(array)).any():
        place = tuple(int(index) for index in np.argwhere(over)[0])
        at = ", ".join(map(str, place))
        raise Error(f"{name}[{at}] is {array[place]:g}, which is too large for single precision: at most 3.4e38")
    return found


def coded(name: str, value: Any, count: int) -> tuple[list[str], npt.NDArray[np.uint32]]:
    """Names in the order in which they first occur, and the row in them of each particle."""
    import numpy as np

    refuse_masked(name, value)
    array = np.asarray(value)
    if array.ndim == 0:
        return [str(array[()])], np.zeros(count, np.uint32)
    if array.ndim != 1 or len(array) != count:
        raise Error(f"`{name}` has the shape {array.shape}, but must have ({count},), one entry for each position")
    if array.dtype.kind not in "iuUSOT":
        raise Error(f"`{name}` is an array of {array.dtype}, but must be one of strings or integers")
    refuse_missing(name, array)
    known: dict[str, int] = {}
    codes = np.empty(count, np.uint32)
    for start in range(0, count, _CHUNK):
        part = array[start : start + _CHUNK]
        if part.dtype.kind in "SO":
            part = np.array(
                [item.decode() if isinstance(item, bytes) else str(item) for item in part.tolist()], np.str_
            )
        unique, first, inverse = np.unique(part, return_index=True, return_inverse=True)
        ranks = np.empty(len(unique), np.uint32)
        for row in np.argsort(first):
            ranks[row] = known.setdefault(str(unique[row]), len(known))
        codes[start : start + _CHUNK] = ranks[inverse.reshape(-1)]
    return list(known), codes


def colors(name: str, value: Any, count: int) -> npt.NDArray[Any]:
    """Linear colors of all particles, from a name, `#rrggbb`, one triple, or a row for each.

    Rows of four are RGBA as matplotlib has them, which are sRGB.
    """
    import numpy as np

    from . import _native

    if isinstance(value, str):
        found = _matplotlib.color_of(value)
        if found is None:
            raise Error(
                f"`{name}` is {value!r}, but must be a CSS color, #rrggbb, or an array of linear RGB from 0 to 1"
            )
        return np.broadcast_to(np.array(found, np.float32), (count, 3))
    texts = getattr(getattr(value, "dtype", None), "kind", None) in ("U", "T", "O")
    if texts or (isinstance(value, Sequence) and value and all(isinstance(item, str) for item in value)):
        names, codes = coded(name, value, count)
        rows = []
        for row, word in enumerate(names):
            found = _matplotlib.color_of(word)
            if found is None:
                raise Error(f"{name}[{int(np.argmax(codes == row))}] is {word!r}, but must be a CSS color or #rrggbb")
            rows.append(found)
        return np.array(rows, np.float32)[codes]
    encoded = getattr(value, "dtype", None) == np.uint8
    array = floats(name, value)
    if encoded and array.ndim:
        levels = np.array([_native.linear_color((code / 255.0,) * 3)[0] for code in range(256)], np.float32)
        array = np.concatenate([levels[array[..., :3].astype(int)], array[..., 3:] / 255.0], axis=-1)
    if array.shape in ((4,), (count, 4)):
        if (array[..., 3] != 1).any():
            raise Error(f"`{name}` has colors with an alpha other than 1; give `opacity` instead")
        array = array[..., :3] if encoded else _matplotlib.linear(array[..., :3])
    if array.ndim == 1 and array.shape == (3,):
        return np.broadcast_to(array, (count, 3))
    if array.ndim != 2 or array.shape != (count, 3):
        raise Error(f"`{name}` has the shape {array.shape}, but must have (3,) or ({count}, 3)")
    return array
