import os
import shutil
from pathlib import Path

import numpy as np
import pytest


@pytest.fixture
def cloud() -> np.ndarray:
    """A thousand positions in the unit cube."""
    return np.random.default_rng(1).random((1000, 3), dtype=np.float32)


@pytest.fixture
def program() -> str:
    """The program: that of SPHERULE, of the checkout, or of the wheel."""
    built = Path(__file__).parents[2] / "target" / "release" / "spherule"
    found = os.environ.get("SPHERULE") or (str(built) if built.is_file() else shutil.which("spherule"))
    if not found:
        pytest.skip("the program is not there; set SPHERULE to its path")
    return found
