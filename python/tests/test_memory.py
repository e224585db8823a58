"""Memory: arrays are read where they lie, and nothing is kept."""

import gc
import tracemalloc
from pathlib import Path

import numpy as np
import pytest

import spherule


def copied(call) -> int:
    """The most bytes that NumPy and Python allocate in a call."""
    call()
    tracemalloc.start()
    call()
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    return peak


def test_float32_arrays_are_read_where_they_lie():
    rng = np.random.default_rng(1)
    count = 200_000
    positions, radius = rng.random((count, 3), dtype=np.float32), np.full(count, 0.001, np.float32)
    column = positions[:, 0].nbytes
    colors, values = rng.random((count, 3), dtype=np.float32), rng.random(count, dtype=np.float32)
    assert copied(lambda: spherule.SphereTree(positions, radius)) < column / 4
    tree = spherule.SphereTree(positions, radius)
    assert copied(lambda: tree.intersect(positions, positions)) < column / 4
    assert copied(lambda: tree.occluded(positions, positions)) < column / 4
    assert copied(lambda: spherule.Scene(positions, radius=radius, color=colors)) < column / 4
    # Flags of finite values are a byte each.
    assert copied(lambda: spherule.Scene(positions, radius=radius, values=values)) < column
    assert copied(lambda: spherule.SphereTree(positions.astype(np.float64), radius)) > 3 * column, "what is converted"


def test_arrays_out_are_the_renderers_memory(cloud):
    picture = spherule.render(cloud, radius=0.05, size=(400, 300), spp=1, layers=["depth", "normal", "id"])
    for array in (picture.pixels, *picture.layers.values()):
        base = array
        while isinstance(base.base, np.ndarray):
            base = base.base
        assert not base.flags.owndata
    keep = picture.pixels[0, 0].copy()
    pixels = picture.pixels
    del picture
    gc.collect()
    assert np.array_equal(pixels[0, 0], keep), "they live as long as their arrays"


@pytest.mark.skipif(not Path("/proc/self/statm").exists(), reason="there is no /proc")
def test_four_hundred_renders_need_no_more_than_a_hundred():
    def resident() -> int:
        return int(Path("/proc/self/statm").read_text().split()[1]) * 4096

    positions = np.random.default_rng(1).random((2000, 3), dtype=np.float32)

    def renders(count):
        for _ in range(count):
            spherule.render(positions, radius=0.01, size=(64, 48), spp=1, layers=["depth"], threads=1)
        gc.collect()
        return resident()

    before = renders(100)
    after = renders(300)
    # A tenth of their pictures.
    assert after - before < 1 << 20, f"{(after - before) / 2**20:.1f} MiB more"
