"""Exceptions and warnings of the package."""

from __future__ import annotations

from typing import TYPE_CHECKING

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
