"""Single values of a wrong type or out of range are refused by name, before anything is rendered."""

import enum
import warnings

import numpy as np
import pytest

import spherule

PAIR = [[0, 0, 0], [1, 0, 0]]


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"radius_scale": "a"}, ["`radius_scale`", "'a'"]),
        ({"bond_radius": "x"}, ["`bond_radius`", "'x'"]),
        ({"types": 3}, ["`types`", "3"]),
        ({"types": {"C": 3}}, ["types['C']", "3"]),
        ({"types": {"C": {"radius": "wide"}}}, ["types['C'].radius", "wide"]),
        ({"types": {"C": {"material": 3}}}, ["types['C'].material", "3"]),
        ({"columns": 3}, ["`columns`", "3"]),
        ({"columns": {3: [1, 2]}}, ["`columns`", "3"]),
        ({"color_range": 5}, ["`color_range`", "5"]),
        ({"color_range": ("a", 2)}, ["color_range[0]", "'a'"]),
        ({"color_range": (1, 2, 3)}, ["`color_range`", "2"]),
        ({"color_range": ("2%", "x%")}, ["color_range[1]", "'x%'"]),
        ({"color_by": "x", "color_range": ("98%", "2%")}, ["`color_range`", "lower one first"]),
        ({"color_by": "x", "color_title": 3}, ["`color_title`", "3"]),
        ({"slices": 3}, ["`slices`", "3"]),
        ({"slices": [3]}, ["slices[0]", "3"]),
        ({"layers": 3}, ["`layers`", "3"]),
        ({"layers": [3]}, ["layers[0]", "3"]),
        ({"replicate": 2}, ["`replicate`", "2"]),
        ({"replicate": (2, 2)}, ["`replicate`", "3"]),
        ({"replicate": (2, 2.5, 1)}, ["replicate[1]", "2.5"]),
        ({"replicate": (2, -1, 1)}, ["replicate[1]", "-1"]),
        ({"preset": 3}, ["`preset`", "3"]),
        ({"title": 3}, ["`title`", "3"]),
        ({"values": [1, 2], "label_of_values": 3}, ["`label_of_values`", "3"]),
        ({"color_by": 3}, ["`color_by`", "3"]),
        ({"color_by": [1.0, 2.0]}, ["`color_by`", "`values`"]),
        ({"bonds": [[0, 1]]}, ["`bonds`", "Particles("]),
        ({"opacity": [0.5]}, ["`opacity`", "0.5"]),
        ({"opacity": True}, ["`opacity`", "True"]),
        ({"unit": "parsec"}, ["`unit`", "parsec", "angstrom"]),
        ({"periodic": "no", "cell": [2, 2, 2]}, ["`periodic`", "no"]),
        ({"wrap": "no"}, ["`wrap`", "no"]),
        ({"color_log": "no"}, ["`color_log`", "no"]),
        ({"color_bar": 3}, ["`color_bar`", "3"]),
        ({"progress": "x"}, ["`progress`", "'x'"]),
        ({"stop": 3}, ["`stop`", "3"]),
        ({"materials": "glas"}, ["materials", "glas", "glass"]),
        ({"materials": ["metal", "glas"]}, ["materials[1]", "glas"]),
        ({"threads": 0}, ["`threads`", "0"]),
        ({"threads": True}, ["`threads`", "True"]),
        ({"threads": 2**70}, ["`threads`", "4096"]),
        ({"size": (65535, 65535)}, ["`size`", "65535", "memory"]),
        ({"size": (65535, 65535), "denoise": "off", "spp": 1}, ["`size`", "65535", "memory"]),
        ({"kinds": ["C", None]}, ["kinds[1]", "None"]),
        ({"kinds": np.array(["C", np.nan], object)}, ["kinds[1]", "nan"]),
    ],
    ids=str,
)
def test_wrong_values_are_named(options, words):
    with pytest.raises(spherule.Error) as refused:
        spherule.render(PAIR, **{"radius": 0.5, "size": (40, 30), "spp": 2, **options})
    for word in words:
        assert word in str(refused.value), str(refused.value)


@pytest.mark.parametrize("frame", [2**70, -(2**70), 1.5, "last", None])
def test_wrong_frames_are_named(frame, tmp_path):
    path = tmp_path / "one.xyz"
    path.write_text("1\n\nHe 0 0 0\n")
    with pytest.raises(spherule.Error, match="`frame`"):
        spherule.read(path, frame)


@pytest.mark.parametrize("quality", ["a", 0, 101, 50.5, True])
def test_wrong_qualities_are_named(quality):
    picture = spherule.render(PAIR, radius=0.5, size=(40, 30), spp=2)
    with pytest.raises(spherule.Error, match="`quality`"):
        picture.encode("jpg", quality=quality)


def test_integers_of_every_kind_are_taken():
    class Count(enum.IntEnum):
        FEW = 2

    expected = spherule.render(PAIR, radius=0.5, size=(40, 30), spp=2).pixels
    for two in (Count.FEW, np.int64(2), np.uint8(2), np.array(2)):
        pixels = spherule.render(PAIR, radius=0.5, size=(40, 30), spp=two).pixels
        assert np.array_equal(pixels, expected), repr(two)


def test_materials_of_the_scene_and_known_ones_are_taken():
    gold = {"kind": "conductor", "color": [1.0, 0.8, 0.3], "roughness": 0.1}
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        spherule.Scene(PAIR, radius=0.5, materials=["gold", "Glass"], material={"gold": gold})


def test_arrays_of_names_of_colors_are_those_names():
    names = ["tomato", "steelblue"]
    expected = spherule.render(PAIR, radius=0.5, color=names, size=(40, 30), spp=2).pixels
    for array in (np.array(names), np.array(names, object), tuple(names)):
        pixels = spherule.render(PAIR, radius=0.5, color=array, size=(40, 30), spp=2).pixels
        assert np.array_equal(pixels, expected), repr(array)
    with pytest.raises(spherule.Error, match=r"color\[1\].*tomatoe"):
        spherule.render(PAIR, radius=0.5, color=np.array(["tomato", "tomatoe"]), size=(40, 30), spp=2)


def test_trees_name_what_is_too_large_or_no_number():
    tree = spherule.SphereTree(PAIR, 0.5)
    with pytest.raises(spherule.Error, match=r"positions\[1, 0\] is 1e\+39.*single precision"):
        spherule.SphereTree([[0, 0, 0], [1e39, 0, 0]], 0.5)
    with pytest.raises(spherule.Error, match=r"radius\[0\] is 1e\+39"):
        spherule.SphereTree(PAIR, np.array([1e39, 1.0]))
    for build in (
        lambda: spherule.SphereTree(PAIR, 0.5, threads=0),
        lambda: tree.intersect(PAIR, [1, 0, 0], threads=0),
        lambda: tree.count(PAIR, [1, 0, 0], threads=1.5),
    ):
        with pytest.raises(spherule.Error, match="`threads`"):
            build()
    with pytest.raises(spherule.Error, match="t_max is nan"):
        tree.occluded(PAIR, [1, 0, 0], t_max=float("nan"))
    with pytest.raises(spherule.Error, match=r"t_max\[1\] is nan"):
        tree.occluded(PAIR, [1, 0, 0], t_max=[1.0, float("nan")])
    # Rays with a number that is not finite hit nothing.
    assert not tree.occluded([[float("inf"), 0, 0]], [1, 0, 0], t_max=float("inf")).any()


def test_missing_types_of_data_frames_are_refused():
    pandas = pytest.importorskip("pandas")
    for missing in (None, float("nan"), pandas.NA):
        frame = pandas.DataFrame({"x": [0.0, 1.0], "y": 0.0, "z": 0.0, "type": ["C", missing]})
        with pytest.raises(spherule.Error, match="`type` is missing in row 1"):
            spherule.from_pandas(frame)
