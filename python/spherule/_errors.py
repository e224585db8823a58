"""Exceptions and warnings of the package."""

from __future__ import annotations

import functools
import sys
import types
import warnings
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, TypeVar

if TYPE_CHECKING:
    from ._picture import Picture


class Error(ValueError):
    """A scene, a file, an array or an option that cannot be used.

    Its text is that of the program: it names the thing, the place and what to write instead.

    Attributes:
        path: The file, or None if there is none.
        line: The line in it, from 1, or None.
    """

    path: str | None
    line: int | None

    def __init__(self, text: str, path: str | None = None, line: int | None = None) -> None:
        super().__init__(text)
        self.path = path
        self.line = line

    def __reduce__(self) -> tuple[type[Error], tuple[object, ...]]:
        return type(self), (self.args[0], self.path, self.line)


class ArgumentError(TypeError):
    """An argument that a function does not have."""


class Interrupted(KeyboardInterrupt):
    """A render that was interrupted, with ``on_interrupt="raise"``.

    Attributes:
        picture: The picture so far.
    """

    picture: Picture

    def __init__(self, picture: Picture) -> None:
        super().__init__("the render was interrupted")
        self.picture = picture


class SpheruleWarning(UserWarning):
    """Something that was left out or assumed, as the program says on its standard error."""


_Function = TypeVar("_Function", bound=Callable[..., Any])


def from_call(function: _Function) -> _Function:
    """Raises errors of the package from the call of a public function, without the frames in between."""
    ours = (Error, ArgumentError)

    def call(*values: Any, **keywords: Any) -> Any:
        try:
            return function(*values, **keywords)
        except ours as error:
            raise error.with_traceback(None) from None

    # With the globals of its module, by which doctest knows whose functions are.
    own = types.FunctionType(call.__code__, function.__globals__, function.__name__, None, call.__closure__)
    return functools.wraps(function)(own)  # type: ignore[return-value]


def warn(text: str) -> None:
    """Warns at the line that called the package."""
    frame, level = sys._getframe(1), 2
    while frame.f_back is not None and str(frame.f_globals.get("__name__")).partition(".")[0] == __package__:
        frame, level = frame.f_back, level + 1
    warnings.warn(text, SpheruleWarning, stacklevel=level)


for _class in (Error, ArgumentError, Interrupted, SpheruleWarning):
    # As users know them, also in tracebacks.
    _class.__module__ = str(__package__)
