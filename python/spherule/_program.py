"""The program that the wheel installs among the scripts."""

from __future__ import annotations

import os
import shutil
import sysconfig


def find() -> str | None:
    """The path of the program: that of the variable SPHERULE, or of the package, or else of the search path."""
    name = "spherule" + (sysconfig.get_config_var("EXE") or "")
    own = os.environ.get("SPHERULE")
    return own or shutil.which(name, path=sysconfig.get_path("scripts")) or shutil.which(name)


MISSING = "the program `spherule` is not installed; a wheel of tools/wheel has it, as does cargo install"
