"""Sections of a scene as TOML, which the reader of scene files checks."""

from __future__ import annotations

import operator
import os
from collections.abc import Mapping
from typing import Any

from ._errors import Error
from .sections import Sections

_ESCAPES = {'"': '\\"', "\\": "\\\\", "\n": "\\n", "\r": "\\r", "\t": "\\t", "\b": "\\b", "\f": "\\f"}


def _text(value: str) -> str:
    def escaped(letter: str) -> str:
        if letter in _ESCAPES:
            return _ESCAPES[letter]
        return f"\\u{ord(letter):04x}" if ord(letter) < 0x20 or ord(letter) == 0x7F else letter

    return '"' + "".join(escaped(letter) for letter in value) + '"'


def _value(name: str, value: Any) -> str:
    """A value on one line."""
    if hasattr(value, "tolist"):
        # NumPy's scalars and arrays.
        value = value.tolist()
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, float):
        return repr(float(value))
    if hasattr(value, "__index__"):
        # Integers, and members of enumerations of these.
        return repr(operator.index(value))
    if isinstance(value, str):
        return _text(value)
    if isinstance(value, os.PathLike):
        return _text(os.fspath(value))
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(_value(name, item) for item in value) + "]"
    if isinstance(value, Mapping):
        pairs = (f"{_text(key)} = {_value(name, item)}" for key, item in value.items())
        return "{ " + ", ".join(pairs) + " }"
    raise Error(f"`{name}` is of type {type(value).__name__}, which a scene cannot hold")


def _table(name: str, table: Mapping[str, Any]) -> str:
    if not isinstance(table, Mapping):
        raise Error(f"`{name}` must be a dict of its keys, as in scene files, not {type(table).__name__}")
    lines = []
    for key, value in table.items():
        if not isinstance(key, str):
            raise Error(f"`{name}` has the key {key!r}, but keys are strings")
        if value is not None:
            plain = key.isascii() and key.replace("_", "").replace("-", "").isalnum()
            lines.append(f"{key if plain else _text(key)} = {_value(f'{name}.{key}', value)}\n")
    return "".join(lines)


def line(name: str, table: Mapping[str, Any]) -> str:
    """The keys of a section on one line, as options of the program take them."""
    return _table(name, table).rstrip("\n").replace("\n", ", ")


#: Sections of which there may be several.
LISTS = frozenset(name for name, kind in Sections.__annotations__.items() if "Sequence[" in str(kind))


def document(sections: Mapping[str, Any]) -> tuple[str, dict[str, list[str]]]:
    """The sections as a scene file, and the keys of each."""
    text = ""
    keys: dict[str, list[str]] = {}
    if sections.get("title") is not None:
        text += f"title = {_value('title', sections['title'])}\n"
    for name, section in sections.items():
        if section is None or name == "title":
            continue
        if name in LISTS:
            if isinstance(section, Mapping) or not isinstance(section, (list, tuple)):
                raise Error(f"`{name}` must be a list of dicts, one for each [[{name}]] of a scene file")
            keys[name] = []
            text += "".join(f"[[{name}]]\n{_table(name, row)}" for row in section)
        elif name == "material":
            if not isinstance(section, Mapping):
                raise Error("`material` must be a dict of names, and a dict of keys for each")
            keys[name] = list(section)
            for key, row in section.items():
                text += f"[material.{_text(key)}]\n{_table(f'material.{key}', row)}"
        else:
            body = _table(name, section)
            keys[name] = [key for key, value in section.items() if value is not None]
            text += f"[{name}]\n{body}"
    return text, keys
