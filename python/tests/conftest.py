import os
import shutil
import signal
from pathlib import Path

import numpy as np
import pytest

# Processes inherit the signals that their parent ignores, as background jobs of shells and what `nohup` starts do, but
# have the default action for those that it catches.
for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
    if signal.getsignal(number) == signal.SIG_IGN:
        signal.signal(number, lambda *_: None)


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
