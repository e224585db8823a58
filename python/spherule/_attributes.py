"""Attributes of objects of other packages."""

from __future__ import annotations

from typing import Any

from ._errors import Error


def need(thing: Any, name: str, what: str) -> Any:
    """An attribute, without which the object is not what is expected."""
    try:
        return getattr(thing, name)
    except AttributeError:
        raise Error(f"expected {what}, but {type(thing).__name__} has no `{name}`") from None


def optional(thing: Any, name: str) -> Any:
    """An attribute, or None; packages raise errors of their own for those that a topology lacks."""
    try:
        return getattr(thing, name)
    except Exception:  # noqa: BLE001
        return None


def components(name: str, values: Any) -> dict[str, Any]:
    """Columns of a property, as the readers name its components."""
    import numpy as np

    array = np.asarray(values)
    if array.ndim == 1:
        return {name: array}
    if array.ndim != 2 or array.dtype.kind not in "fiub":
        return {}
    width = array.shape[1]
    parts = "xyz" if width == 3 else [str(part + 1) for part in range(width)]
    return {f"{name}_{part}": array[:, row] for row, part in enumerate(parts)}
