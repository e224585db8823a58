"""``python -m spherule``: the program, which the wheel installs among the scripts."""

from __future__ import annotations

import os
import shutil
import sys
import sysconfig


def program() -> str | None:
    """The path of the program, of the wheel or else of PATH; None if it is not installed."""
    name = "spherule" + (sysconfig.get_config_var("EXE") or "")
    return shutil.which(name, path=sysconfig.get_path("scripts")) or shutil.which(name)


def main() -> None:
    """Becomes the program, with the arguments of this process."""
    path = program()
    if path is None:
        sys.exit("error: the program `spherule` is not installed; a wheel of tools/wheel has it, as does cargo install")
    os.execv(path, ["spherule", *sys.argv[1:]])


if __name__ == "__main__":
    main()
