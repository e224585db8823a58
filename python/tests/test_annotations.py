"""Annotations by a word, particles of other packages taken as they are, and what completion shows."""

import inspect
import pickle
import re
import traceback

import numpy as np
import pytest

import spherule

POINTS = [[0, 0, 0], [3, 0, 0], [0, 3, 0]]
OPTIONS = {"kinds": ["C", "O", "N"], "size": (120, 90), "spp": 2}


def pixels(**options):
    return spherule.render(POINTS, **OPTIONS, **options).pixels


@pytest.mark.parametrize(
    ("name", "usual", "other"),
    [
        ("legend", "top-right", "left"),
        ("axes", "bottom-left", "top"),
        ("scale_bar", "bottom-right", "2:top"),
    ],
)
def test_annotations_are_asked_for_by_true_or_a_position(name, usual, other):
    plain = pixels()
    drawn = pixels(**{name: True})
    assert not np.array_equal(plain, drawn)
    assert np.array_equal(drawn, pixels(**{name: usual}))
    assert not np.array_equal(drawn, pixels(**{name: other}))
    assert np.array_equal(plain, pixels(**{name: False}))
    with pytest.raises(spherule.Error, match=name):
        pixels(**{name: "middle"})


def test_a_length_is_one_of_a_scale_bar():
    assert np.array_equal(pixels(scale_bar=2), pixels(scale_bar="2:bottom-right"))


def test_labels_are_texts():
    assert np.array_equal(pixels(label="top:a"), pixels(label=["top:a"]))
    assert np.array_equal(pixels(label="top:a"), pixels(label=[{"text": "a", "position": "top"}]))
    with pytest.raises(spherule.Error, match=r"label\[1\]"):
        pixels(label=["a", "{pressure}"])


def test_annotations_without_a_meaning_are_refused():
    with pytest.raises(spherule.Error, match="color_bar"):
        spherule.render(POINTS, values=[1, 2, 3], legend=True, size=(40, 30), spp=1)
    with pytest.raises(spherule.Error, match="cell"):
        pixels(axes="cell")
    assert pixels(axes="cell", cell=[9, 9, 9]).shape == (90, 120, 3)


class Atoms:
    """As much of ASE's class as is read."""

    positions = np.array(POINTS, float)
    cell = np.zeros((3, 3))
    pbc = np.array([False] * 3)
    arrays = {"numbers": np.array([6, 8, 7])}

    def get_chemical_symbols(self):
        return ["C", "O", "N"]


def test_objects_of_other_packages_are_taken():
    own = spherule.render(spherule.from_ase(Atoms()), size=(40, 30), spp=2).pixels
    assert np.array_equal(own, spherule.render(Atoms(), size=(40, 30), spp=2).pixels)
    assert len(spherule.Scene(Atoms())) == 3


def test_colors_of_matplotlib_have_their_names():
    def colored(color):
        return spherule.render(POINTS, radius=1, color=color, size=(40, 30), spp=2).pixels

    assert np.array_equal(colored("C0"), colored("#1f77b4"))
    assert np.array_equal(colored(["C1", "C11", "tab:orange"]), colored("#ff7f0e"))
    for wrong in ("C", "Cx", "tab:teal", "C-1"):
        with pytest.raises(spherule.Error, match="CSS color"):
            colored(wrong)


def test_all_layers_have_a_word():
    layers = spherule.render(POINTS, radius=1, size=(40, 30), spp=2, layers="all").layers
    assert set(layers) == {"albedo", "normal", "depth", "coverage", "id", "variance", "samples"}


def test_signatures_show_options():
    for function in (spherule.render, spherule.refine, spherule.Scene):
        names = inspect.signature(function).parameters
        assert {"color_by", "styles", "view", "camera"} <= set(names)
    assert "spp" in inspect.signature(spherule.render).parameters
    assert "spp" not in inspect.signature(spherule.Scene).parameters


def test_bonds_that_a_style_draws_are_read(tmp_path):
    path = tmp_path / "water.xyz"
    path.write_text("3\n\nO 0 0 0\nH 0.96 0 0\nH -0.24 0.93 0\n")
    plain = spherule.render(path, size=(40, 30), spp=2).pixels
    styled = spherule.render(path, styles={"all": {"model": "licorice"}}, size=(40, 30), spp=2).pixels
    assert not np.array_equal(plain, styled)
    assert np.array_equal(styled, spherule.render(path, model="licorice", size=(40, 30), spp=2).pixels)
    red = {"element H": {"color": (1.0, 0.0, 0.0), "scale": 0.5}}
    assert not np.array_equal(plain, spherule.render(path, styles=red, size=(40, 30), spp=2).pixels)
    for wrong in ({"element H": {"colour": "red"}}, ["element H"], {"element H": 3}, {"element N": "color=red"}):
        with pytest.raises(spherule.Error):
            spherule.render(path, styles=wrong, size=(40, 30), spp=1)


@pytest.mark.parametrize("background", ["white", "transparent"])
def test_pages_have_annotations_as_vectors(tmp_path, background):
    camera = {"eye": [1.5, 0, 20], "target": [1.5, 0, 0]}
    options = {"radius": [1, 2], "size": (200, 150), "spp": 1, "background": background, "camera": camera}
    plain = spherule.render([[0, 0, 0], [3, 0, 0]], **options)
    picture = spherule.render([[0, 0, 0], [3, 0, 0]], label="top:argon", **options)
    pages = [one.encode("svg").decode() for one in (picture, plain)]
    assert [">argon<" in page for page in pages] == [True, False]
    # The picture on the page has no letters.
    mine, theirs = (re.search(r'base64,([^"]*)"', page)[1] for page in pages)
    assert mine == theirs and picture.encode() != plain.encode()
    picture.save(tmp_path / "a.pdf")
    assert (tmp_path / "a.pdf").read_bytes().startswith(b"%PDF-")
    # What is cut has them as pixels.
    picture.pixels = picture.pixels[:100]
    if background == "white":
        assert ">argon<" not in picture.encode("svg").decode()
        assert ">argon<" not in pickle.loads(pickle.dumps(picture)).encode("svg").decode()


def test_errors_are_raised_from_the_call():
    """A traceback has the user's line and the one that raises; nothing of what is in between."""
    calls = [
        lambda: spherule.render(POINTS, radius=-1),
        lambda: spherule.Scene(POINTS, camera={"fov": 200}),
        lambda: spherule.Scene.load("nope.xyz"),
        lambda: spherule.read("nope.xyz"),
        lambda: spherule.render(POINTS, colour="red"),
        lambda: spherule.movie([POINTS], "a-%d.png", radius="x"),
    ]
    for call in calls:
        with pytest.raises((spherule.Error, TypeError)) as caught:
            call()
        frames = traceback.extract_tb(caught.tb)
        assert len(frames) == 3 and frames[2].name == "call", frames
        assert type(caught.value).__module__ == "spherule" and caught.value.__suppress_context__


def test_warnings_are_of_the_line_of_the_call():
    for call in (lambda: spherule.render(POINTS, size=(8, 6), spp=1), lambda: spherule.Scene(POINTS)):
        with pytest.warns(spherule.SpheruleWarning) as caught:
            call()
        assert {one.filename for one in caught} == {__file__}
