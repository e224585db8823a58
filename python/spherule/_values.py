"""Checks of single values, by the name of the argument."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Mapping
from typing import Any

from ._errors import Error


def shown(value: Any) -> str:
    """A value in a message, however long it is."""
    text = repr(value)
    return text if len(text) <= 80 else f"{text[:60]}..., of type {type(value).__name__}"


def integer(name: str, value: Any, least: int | None = None, most: int | None = None) -> int:
    """An integer of Python or NumPy, in a range."""
    import operator

    try:
        number = operator.index(value)
    except TypeError:
        number = None
    if number is None or isinstance(value, bool):
        raise Error(f"`{name}` is {shown(value)}, but must be an integer")
    if (least is not None and number < least) or (most is not None and number > most):
        limits = f"of at least {least}" if most is None else f"from {least} to {most}"
        raise Error(f"`{name}` is {number}, but must be an integer {limits}")
    return number


def number(name: str, value: Any) -> float:
    """A real number of Python or NumPy."""
    try:
        # A text is no number, though it may look like one.
        if isinstance(value, (str, bytes, bool)):
            raise TypeError
        return float(value)
    except (TypeError, ValueError, OverflowError):
        raise Error(f"`{name}` is {shown(value)}, but must be a number") from None


def text(name: str, value: Any) -> str:
    """A string."""
    if not isinstance(value, str):
        raise Error(f"`{name}` is {shown(value)}, but must be a string")
    return str(value)


def word(name: str, value: Any, words: Iterable[str]) -> str:
    """One of some words."""
    words = tuple(words)
    if not isinstance(value, str) or value not in words:
        raise Error(f"`{name}` is {shown(value)}, but must be {', '.join(words[:-1])} or {words[-1]}")
    return str(value)


def flag(name: str, value: Any) -> bool:
    """True or False, of Python or NumPy."""
    if isinstance(value, bool) or getattr(getattr(value, "dtype", None), "kind", None) == "b" and value.ndim == 0:
        return bool(value)
    raise Error(f"`{name}` is {shown(value)}, but must be True or False")


def path(name: str, value: Any) -> str:
    """The path of a file."""
    try:
        found = os.fspath(value)
    except TypeError:
        found = None
    if not isinstance(found, str):
        raise Error(f"`{name}` is {shown(value)}, but must be a path: a string or a pathlib.Path")
    return found


def items(name: str, value: Any, item: Callable[[str, Any], Any], count: int | None = None) -> list[Any]:
    """A list of values that `item` checks; a string stands for itself alone."""
    if isinstance(value, str) and count is None:
        value = [value]
    try:
        if isinstance(value, (str, bytes, Mapping)):
            raise TypeError
        values = list(value)
    except TypeError:
        values = []
        count = -1
    if count is not None and len(values) != count:
        many = "a list" if count < 0 else f"a list of {count}"
        raise Error(f"`{name}` is {shown(value)}, but must be {many}")
    return [item(f"{name}[{row}]", one) for row, one in enumerate(values)]


def table(name: str, value: Any) -> dict[str, Any]:
    """A dict whose keys are strings."""
    if not isinstance(value, Mapping):
        raise Error(f"`{name}` is {shown(value)}, but must be a dict")
    for key in value:
        if not isinstance(key, str):
            raise Error(f"`{name}` has the key {shown(key)}, but its keys must be strings")
    return dict(value)
