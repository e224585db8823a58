"""Plotters of PyVista: what becomes spheres, sticks and triangles, and pictures beside PyVista's own."""

import numpy as np
import pytest

import spherule
from spherule import _meshes

pv = pytest.importorskip("pyvista")
pytestmark = pytest.mark.filterwarnings("ignore::DeprecationWarning", "ignore::pyvista.PyVistaDeprecationWarning")

RNG = np.random.default_rng(5)


@pytest.fixture
def plotter():
    found = pv.Plotter(off_screen=True, window_size=(200, 150))
    found.set_background("white")
    yield found
    found.close()


def saved(scene, folder):
    scene.save(folder / "scene.toml")
    return (folder / "scene.toml").read_text()


def same_silhouette(plotter, scene, share):
    """Compares which pixels are not background with those of the screenshot."""
    plotter.render()
    theirs = (np.asarray(plotter.screenshot(return_img=True))[..., :3] < 250).any(axis=2)
    mine = (scene.render(spp=16, denoise="off").srgb() < 200).any(axis=2)
    assert theirs.sum() > 200
    assert (mine & theirs).sum() > share * (mine | theirs).sum()


def parts(mesh):
    mesh = mesh.triangulate()
    return _meshes.parts(np.asarray(mesh.points, float), np.asarray(mesh.faces).reshape(-1, 4)[:, 1:])


def test_glyphs_of_spheres_are_spheres():
    points = pv.PolyData(100 + 10 * RNG.random((20, 3)))
    points["r"] = 0.1 + RNG.random(20)
    for geom in (pv.Sphere(radius=1), pv.Sphere(radius=1, theta_resolution=8, phi_resolution=8), pv.Icosphere(nsub=2)):
        found = parts(points.glyph(geom=geom, scale="r", orient=False))
        assert found.is_sphere.all() and len(found.radii) == 20
        assert np.allclose(found.centers, points.points, atol=1e-4)
        assert np.allclose(found.radii, points["r"] * np.linalg.norm(geom.points, axis=1).mean(), rtol=1e-3)


@pytest.mark.parametrize(
    "mesh",
    [
        lambda: pv.Cube(),
        lambda: pv.Icosahedron(),
        lambda: pv.Icosahedron().subdivide(1),
        lambda: pv.Sphere(end_phi=90),
        lambda: pv.ParametricEllipsoid(1, 1, 0.9),
        lambda: pv.Plane(),
        lambda: pv.Disc(),
        lambda: pv.Cone(resolution=40),
    ],
)
def test_other_shapes_are_not(mesh):
    found = parts(mesh())
    assert not found.is_sphere.any() and not found.tubes


def test_tubes_are_segments():
    line = pv.Spline(RNG.random((5, 3)), 30)
    for sides in (8, 20):
        found = parts(line.tube(radius=0.02, n_sides=sides))
        assert len(found.tubes) == 1 and found.is_taken.all() and not found.is_sphere.any()
        tube = found.tubes[0]
        assert tube.sides == sides and abs(tube.radius - 0.02) < 1e-4
        assert np.allclose(tube.axis, line.points, atol=1e-5)
    line["r"] = np.linspace(1, 3, 30)
    assert not parts(line.tube(radius=0.02, scalars="r")).tubes


def test_pictures_are_beside_those_of_pyvista(plotter):
    points = pv.PolyData(RNG.random((30, 3)))
    points["r"] = 0.1 + RNG.random(30)
    plotter.add_mesh(points.glyph(geom=pv.Sphere(radius=0.08), scale="r", orient=False), show_scalar_bar=False)
    plotter.add_points(RNG.random((20, 3)), render_points_as_spheres=True, point_size=14, color="navy")
    plotter.add_mesh(pv.Line((0, 0, 0), (1, 1, 0)), line_width=6, render_lines_as_tubes=True, color="green")
    plotter.add_mesh(pv.Spline(RNG.random((4, 3)), 20).tube(radius=0.02), color="tomato")
    actor = plotter.add_mesh(pv.Cube(), color="tan")
    actor.scale, actor.position = 0.4, (1, 0.2, 0.3)
    before = spherule.from_pyvista(plotter)
    assert len(before) == 50 and not plotter.camera_set
    same_silhouette(plotter, before, 0.9)
    plotter.camera.zoom(1.3)
    plotter.camera.azimuth = 70
    same_silhouette(plotter, spherule.from_pyvista(plotter), 0.9)
    plotter.enable_parallel_projection()
    same_silhouette(plotter, spherule.from_pyvista(plotter), 0.9)


def test_gaussian_points_have_the_radius_of_their_splats(plotter):
    plotter.add_mesh(
        pv.PolyData(RNG.random((12, 3))), style="points_gaussian", render_points_as_spheres=True, point_size=60, color="red"
    )
    # Splats face the camera, spheres are seen in perspective.
    plotter.enable_parallel_projection()
    same_silhouette(plotter, spherule.from_pyvista(plotter), 0.9)


def test_scalars_have_their_map_and_range(plotter, tmp_path):
    mesh = pv.PolyData(np.arange(15.0).reshape(5, 3))
    values = np.array([-1, 0, 0.5, 1, np.nan])
    plotter.add_mesh(
        mesh, scalars=values, cmap="plasma", clim=(0, 1), nan_color="lime", point_size=9, scalar_bar_args={"title": "c"}
    )
    scene = spherule.from_pyvista(plotter)
    colors = pytest.importorskip("matplotlib").colormaps["plasma"](np.clip(values, 0, 1), bytes=True)
    colors[4] = (0, 255, 0, 255)
    expected = spherule.Scene(mesh.points, color=colors, radius=1)
    rows = [np.asarray(one._native.columns()[3], float).reshape(-1, 3) for one in (scene, expected)]
    assert len(rows[0]) == 5 and np.abs(rows[0] - rows[1]).max() < 0.03
    text = saved(scene, tmp_path)
    bar = text.split("[color_bar]")[1].split("\n[")[0]
    assert "range = [0, 1]" in bar.replace(".0", "") and 'label = "c"' in bar and "#0c0786" in bar


def test_faces_have_colors_and_opacity(plotter, tmp_path):
    mesh = pv.Plane(i_resolution=2, j_resolution=1)
    plotter.add_mesh(mesh, scalars=np.array([0.0, 1.0]), cmap=["red", "blue"], opacity=0.5, show_scalar_bar=False)
    plotter.add_mesh(pv.Cube(), style="wireframe", color="black")
    text = saved(spherule.from_pyvista(plotter), tmp_path)
    assert text.count("[[triangle]]") == 4 and text.count("[[stick]]") == 12
    assert text.count("opacity = 0.5") == 1
    plotter.clear_actors()
    line = pv.Line((0, 0, 0), (1, 0, 0), resolution=2)
    line["v"] = [0.0, 0.5, 1.0]
    plotter.add_mesh(line.tube(radius=0.1, n_sides=12), scalars="v", cmap=["red", "blue"], show_scalar_bar=False)
    text = saved(spherule.from_pyvista(plotter), tmp_path)
    assert "colors = [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]" in text and "colors = [[0.0, 0.0, 1.0], [0.0, 0.0, 1.0]]" in text
    plotter.clear_actors()
    points = pv.PolyData(RNG.random((3, 3)))
    plotter.add_points(points, opacity=0.4, color="red")
    assert len(spherule.from_pyvista(plotter)) == 3


def test_what_is_left_out_is_named(plotter):
    plotter.add_mesh(pv.Sphere(), show_edges=True, name="ball")
    plotter.add_text("title")
    plotter.add_volume(pv.Wavelet(), name="cloud", show_scalar_bar=False)
    with pytest.warns(spherule.SpheruleWarning, match="edges `ball`, text.*, volume `cloud`"):
        scene = spherule.from_pyvista(plotter)
    assert len(scene) == 1


def test_options_go_before_the_plotter(plotter, tmp_path):
    plotter.add_mesh(pv.Sphere(), name="ball")
    plotter.set_background("red")
    scene = spherule.from_pyvista(plotter, render={"spp": 2}, background="white", camera={"fov": 60}, preset="chalk")
    assert scene.size == (200, 150)
    picture = scene.render()
    assert picture.srgb()[0, 0].min() > 250 and picture.spp == (2, 2)


def test_what_is_no_plotter_is_refused(plotter):
    with pytest.raises(spherule.Error, match="nothing that can be drawn"):
        spherule.from_pyvista(plotter)
    with pytest.raises(spherule.Error, match="a pyvista Plotter"):
        spherule.from_pyvista([1])
    with pytest.raises(spherule.ArgumentError, match="unknown argument `colour`"):
        plotter.add_mesh(pv.Sphere())
        spherule.from_pyvista(plotter, colour="red")
