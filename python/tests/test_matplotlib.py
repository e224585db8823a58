"""Colors, maps and ranges of matplotlib, by name and as objects."""

import numpy as np
import pytest

import spherule

VALUES = np.linspace(0.01, 1, 7)
POSITIONS = np.arange(21.0).reshape(7, 3)


def pixels(**options):
    return spherule.render(POSITIONS, radius=0.9, size=(48, 36), spp=1, **options).pixels


def test_lists_of_colors_are_maps():
    mine = pixels(values=VALUES, color_map=["navy", "white", "C3"])
    assert np.array_equal(mine, pixels(values=VALUES, color_map="navy,white,#d62728"))
    assert not np.array_equal(mine, pixels(values=VALUES, color_map="navy,white"))
    with pytest.raises(spherule.Error, match=r"color_map\[1\] is 'wite'"):
        pixels(values=VALUES, color_map=["navy", "wite"])
    with pytest.raises(spherule.Error, match="`color_map` is 5"):
        pixels(values=VALUES, color_map=5)


def test_rgba_is_srgb():
    """As matplotlib's maps return it; rows of three are linear."""
    assert np.array_equal(pixels(color=(1.0, 0.5, 0.0, 1.0)), pixels(color=(1.0, 0.21404114, 0.0)))
    codes = np.array([[255, 128, 0, 255]] * 7, np.uint8)
    assert np.array_equal(pixels(color=codes), pixels(color=codes[:, :3]))
    with pytest.raises(spherule.Error, match="alpha"):
        pixels(color=(1, 1, 1, 0.5))


def test_maps_are_those_of_matplotlib():
    matplotlib = pytest.importorskip("matplotlib")
    for name in ("RdBu", "tab10", "viridis_r"):
        found = matplotlib.colormaps[name]
        mine = pixels(values=VALUES, color_map=found, color_range=(0, 1))
        assert np.array_equal(mine, pixels(values=VALUES, color_map=name, color_range=(0, 1)))
        # To the rounding to eight bits, and between the rows of a table.
        theirs = pixels(color=found(VALUES))
        assert np.abs(mine - theirs).max() < 0.03 and np.abs(mine - theirs).mean() < 0.002, name
    styled = {"all": {"color": "x", "map": "RdBu"}}
    assert np.array_equal(pixels(styles=styled), pixels(color_by="x", color_map="RdBu"))
    with pytest.raises(spherule.Error, match="did you mean `RdBu`"):
        pixels(values=VALUES, color_map="RdBuu")


def test_ranges_are_norms():
    colors = pytest.importorskip("matplotlib.colors")
    linear = pixels(values=VALUES, color_range=colors.Normalize(0.2, 0.8))
    assert np.array_equal(linear, pixels(values=VALUES, color_range=(0.2, 0.8)))
    log = pixels(values=VALUES, color_range=colors.LogNorm(vmax=1))
    assert np.array_equal(log, pixels(values=VALUES, color_range=("auto", 1), color_log=True))
    with pytest.raises(spherule.Error, match="PowerNorm"):
        pixels(values=VALUES, color_range=colors.PowerNorm(0.5))
