"""Triangles: arrays of corners, sections, and meshes of PLY files."""

import pickle

import numpy as np
import pytest

import spherule

CORNERS = np.array([[[-1, -1, 0], [1, -1, 0], [0, 1, 0]], [[-1, -1, 1], [1, -1, 1], [0, 1, 1]]], float)
VIEW = {"camera": {"eye": [0, 0, 5], "target": [0, 0, 0]}, "render": {"size": [40, 30], "spp": 4, "denoise": "off"}}


def pixels(**options):
    return spherule.Scene(**options, **VIEW).render().pixels


def test_an_array_is_what_sections_are():
    sections = [dict(zip("abc", corners.tolist())) for corners in CORNERS]
    assert np.array_equal(pixels(triangles=CORNERS), pixels(triangle=sections))
    assert np.array_equal(pixels(triangles=CORNERS), spherule.render(triangles=CORNERS, **VIEW).pixels)
    red = [{**section, "color": "red"} for section in sections]
    assert np.array_equal(pixels(triangles={"corners": CORNERS, "color": "red"}), pixels(triangle=red))
    assert not np.array_equal(pixels(triangles=CORNERS), pixels(triangle=red))


def test_triangles_join_particles_and_survive_pickling():
    scene = spherule.Scene([[0, 0, 0], [1, 0, 0]], radius=0.3, triangles=CORNERS)
    again = pickle.loads(pickle.dumps(scene))
    options = {"size": (40, 30), "spp": 1}
    assert np.array_equal(scene.render(**options).pixels, again.render(**options).pixels)


def test_a_mesh_is_read(tmp_path):
    path = tmp_path / "one.ply"
    path.write_text(
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
        "element face 1\nproperty list uchar int vertex_indices\nend_header\n-1 -1 0\n1 -1 0\n0 1 0\n3 0 1 2\n"
    )
    assert np.array_equal(pixels(mesh=[{"path": str(path)}]), pixels(triangles=CORNERS[:1]))


@pytest.mark.parametrize(
    ("value", "words"),
    [
        (np.zeros((2, 3)), "(n, 3, 3)"),
        ([[[0, 0, 0], [1, 0, 0], [0, np.nan, 0]]], "triangles[0]"),
        ("abc", "triangles"),
        ({"corners": CORNERS, "radius": 1}, "radius"),
        ({"corners": CORNERS, "material": "gold"}, "gold"),
    ],
)
def test_what_is_no_triangle_is_refused(value, words):
    with pytest.raises(spherule.Error) as refused:
        spherule.Scene(triangles=value)
    assert words in str(refused.value)


def test_flat_ones_are_refused_and_none_is_none():
    flat = [*CORNERS, [[0, 0, 0], [1, 1, 1], [2, 2, 2]]]
    with pytest.raises(spherule.Error, match="triangle 2"):
        spherule.Scene(triangles=flat).render(spp=1)
    assert len(spherule.Scene([[0, 0, 0]], radius=1, triangles=np.zeros((0, 3, 3)))) == 1
