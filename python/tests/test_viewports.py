"""The layer of OVITO's viewports, beside what these draw themselves.

These tests come after those of files: once OVITO has rendered an image, it imports only the first frame of a file.
"""

import numpy as np
import pytest

vis = pytest.importorskip("ovito.vis", exc_type=ImportError)
pipelines = pytest.importorskip("ovito.pipeline", exc_type=ImportError)

from ovito.data import DataCollection  # noqa: E402

import spherule.ovito


@pytest.fixture
def pipeline():
    rng = np.random.default_rng(2)
    data = DataCollection()
    particles = data.create_particles(count=40)
    particles.create_property("Position", data=rng.random((40, 3)) * (9, 8, 7))
    particles.create_property("Radius", data=0.3 + rng.random(40) / 2)
    particles.create_property("Color", data=np.broadcast_to((0.9, 0.1, 0.1), (40, 3)))
    found = pipelines.Pipeline(source=pipelines.StaticSource(data=data))
    found.add_to_scene()
    yield found
    found.remove_from_scene()


def image(viewport):
    found = viewport.render_image(size=(160, 120), background=(1, 1, 1))
    found = found.convertToFormat(found.Format.Format_RGB888)
    return np.frombuffer(found.constBits(), np.uint8).reshape(120, -1)[:, :480].reshape(120, 160, 3).copy()


@pytest.mark.parametrize("kind", ["Ortho", "Perspective"])
def test_the_layer_sees_what_the_viewport_sees(pipeline, kind):
    viewport = vis.Viewport(type=getattr(vis.Viewport.Type, kind), camera_dir=(2, 1, -1))
    viewport.zoom_all(size=(160, 120))
    theirs = image(viewport)
    layer = spherule.ovito.SpheruleOverlay(preset="chalk", spp=16, options={"background": "white"})
    viewport.overlays.append(vis.PythonViewportOverlay(delegate=layer))
    mine = image(viewport)
    shown = [(picture.min(axis=2) < 150) for picture in (theirs, mine)]
    assert shown[0].sum() > 1000 and not np.array_equal(theirs, mine)
    assert (shown[0] & shown[1]).sum() > 0.93 * (shown[0] | shown[1]).sum()


def test_radii_are_those_that_ovito_draws():
    data = DataCollection()
    particles = data.create_particles(count=1)
    particles.create_property("Position", data=[[0, 0, 0]])
    particles.vis.radius, particles.vis.scaling = 2.5, 0.5
    looks = spherule.ovito._looks(data)
    assert looks["radius"] == 2.5 and looks["radius_scale"] == 0.5 and not looks["show_cell"]
    data.create_cell(np.hstack([np.eye(3), np.zeros((3, 1))]), pbc=(True, True, True))
    assert spherule.ovito._looks(data)["show_cell"]
    data.cell.vis.enabled = False
    assert not spherule.ovito._looks(data)["show_cell"]


def test_wrong_options_are_refused():
    with pytest.raises(Exception, match="preset"):
        spherule.ovito.SpheruleOverlay(preset="bright")
