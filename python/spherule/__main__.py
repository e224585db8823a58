"""``python -m spherule``: the program, which the wheel installs among the scripts."""

from __future__ import annotations

import os
import sys

from . import _program


def main() -> None:
    """Becomes the program, with the arguments of this process."""
    program = _program.find()
    if program is None:
        sys.exit(f"error: {_program.MISSING}")
    os.execv(program, ["spherule", *sys.argv[1:]])


if __name__ == "__main__":
    main()
