"""The extension module for this processor.

A wheel holds one for each processor level, of which the lowest is ``_spherule`` itself; the highest that the processor
has is imported. ``SPHERULE_LEVEL`` chooses another, as for the program.
"""

from __future__ import annotations

import importlib
import importlib.util
import os
from types import ModuleType
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ._spherule import (
        Drawn as Drawn,
        FrameFile as FrameFile,
        FrameSequence as FrameSequence,
        Matte as Matte,
        Refinement as Refinement,
        Scene as Scene,
        SphereTree as SphereTree,
        Stop as Stop,
        Video as Video,
        color_of as color_of,
        compiled_level as compiled_level,
        count_frames as count_frames,
        display_codes as display_codes,
        element_of as element_of,
        encode as encode,
        linear_color as linear_color,
        material_names as material_names,
        merge as merge,
        missing_features as missing_features,
        packaged_levels as packaged_levels,
        read as read,
        refine as refine,
        render as render,
        render_part as render_part,
    )

_PACKAGE = __name__.rpartition(".")[0]
_VARIABLE = "SPHERULE_LEVEL"


def _name(level: str) -> str:
    return f"{_PACKAGE}._levels.{level}._spherule"


def _is_there(level: str) -> bool:
    try:
        return importlib.util.find_spec(_name(level)) is not None
    except ModuleNotFoundError:
        return False


def _chosen() -> ModuleType:
    """The module of the level that is asked for, or of the highest that the processor has."""
    lowest = importlib.import_module(f"{_PACKAGE}._spherule")
    asked = os.environ.get(_VARIABLE, "")
    others = [level for level in lowest.packaged_levels() if _is_there(level)]
    if not others:
        # Built for one level, or for this processor alone.
        return lowest
    levels = [*others, lowest.compiled_level()]
    suited = [level for level in levels if not lowest.missing_features(level)]
    if asked and asked not in levels:
        raise ImportError(f"{_VARIABLE} is `{asked}`; use one of {', '.join(reversed(levels))}, or unset it")
    if asked and asked not in suited:
        lacks = ", ".join(lowest.missing_features(asked))
        raise ImportError(
            f"{_VARIABLE} is `{asked}`, but this processor lacks {lacks}; use one of "
            f"{', '.join(reversed(suited))}, or unset it"
        )
    level = asked or suited[0]
    return lowest if level == levels[-1] else importlib.import_module(_name(level))


if not TYPE_CHECKING:
    globals().update({name: value for name, value in vars(_chosen()).items() if not name.startswith("_")})
