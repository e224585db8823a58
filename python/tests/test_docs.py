"""The manual: every block of Python in it runs."""

import re
from pathlib import Path

import numpy as np
import pytest

MANUAL = Path(__file__).parents[2] / "docs" / "python.md"


@pytest.mark.filterwarnings("ignore")
def test_the_examples_of_the_manual_run(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("run.lammpstrj").write_text(
        "ITEM: TIMESTEP\n5\nITEM: NUMBER OF ATOMS\n1\nITEM: BOX BOUNDS pp pp pp\n0 4\n0 5\n0 5\n"
        "ITEM: ATOMS id type x y z q\n1 1 0 0 0 0.5\n"
    )
    blocks = re.findall(r"```python\n(.*?)```", MANUAL.read_text(), re.S)
    assert len(blocks) == 6
    rng = np.random.default_rng(4)
    names = {"origins": rng.random((9, 3)), "directions": rng.normal(size=(9, 3))}
    for block in blocks:
        if "IPython" in block:
            pytest.importorskip("IPython")
        exec(block, names)
    assert Path("cloud.png").is_file() and Path("gold.csv").is_file() and names["hits"].t.shape == (9,)
    assert len(names["seen"]) > 100 and names["positions"][names["seen"], 0].min() > 0.5
