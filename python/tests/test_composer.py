"""Scenes are composed alike by Python and by the program: each option by itself, and many of them together."""

import random
import subprocess

import pytest

import spherule

#: Options of Python, and the words of the program for them. Only one of a group is taken.
GROUPS = [
    [({"wrap": True}, ["--wrap"])],
    [({"replicate": (2, 1, 1)}, ["--replicate", "2,1,1"])],
    [({"show_cell": True}, ["--cell"])],
    [({"look": {"depth_cue": True}}, ["--depth-cue", "on"]), ({"look": {"outline": True}}, ["--outline", "on"])],
    [({"complete": True}, ["--complete", "yes"]), ({"complete": False}, ["--complete", "no"])],
    [({"outside": outside}, ["--outside", outside]) for outside in ("molecules", "whole", "none", "halves")],
    [
        ({"polyhedra": "Cu-*<3"}, ["--polyhedra", "Cu-*<3"]),
        ({"polyhedra": ["Ni-Cu", "Cu-Cu<3"], "polyhedra_opacity": 1.0}, ["--polyhedra", "Ni-Cu,Cu-Cu<3", "--polyhedra-opacity", "1"]),
    ],
    [({"up": axis}, ["--up", axis]) for axis in ("x", "-y", "z")],
    [({"view": side}, ["--view", side]) for side in ("auto", "iso", "-x", "y", "z")],
    [
        ({"preset": preset}, ["--preset", preset])
        for preset in ("figure", "chalk", "studio", "cloudy", "glossy", "depthcue", "outline", "ghost", "x-ray")
    ],
    [({"background": "#204060"}, ["--background", "#204060"]), ({"background": "sky"}, ["--background", "sky"])],
    [({"select": "z > 2"}, ["--select", "z > 2"])],
    [
        ({"color_by": "tags"}, ["--color-by", "tags"]),
        ({"color_by": "z", "color_bar": "left"}, ["--color-by", "z", "--color-bar", "left"]),
        ({"color_by": "tags", "color_map": "categories"}, ["--color-by", "tags", "--color-map", "categories"]),
        (
            {"color_by": "z", "color_range": ("10%", "auto"), "color_bar": "left", "color_title": "z_i (m^2)"},
            ["--color-by", "z", "--color-range", "10%,auto", "--color-bar", "left", "--color-title", "z_i (m^2)"],
        ),
        ({"color_by": "x", "color_range": (-1, 3)}, ["--color-by", "x", "--color-range", "-1,3"]),
        ({"color_by": "x", "color_map": "magma_r"}, ["--color-by", "x", "--color-map", "magma_r"]),
        ({"colors": "cpk"}, ["--colors", "cpk"]),
    ],
    [({"radius_scale": 0.5}, ["--radius-scale", "0.5"])],
    [
        ({"model": "ball-and-stick"}, ["--model", "ball-and-stick"]),
        ({"model": "licorice", "bond_radius": 0.1}, ["--model", "licorice", "--bond-radius", "0.1"]),
        ({"bonds": "*-*<3"}, ["--bonds", "*-*<3"]),
    ],
    [
        ({"opacity": 0.5}, ["--opacity", "0.5"]),
        ({"opacity": "30%"}, ["--opacity", "30%"]),
        ({"translucent": "z > 5"}, ["--translucent", "z > 5"]),
    ],
    [
        (
            {"styles": {"tags == 1": {"color": "gold", "opacity": 0.5}, "element O": {"visible": False}}},
            ["--style", "tags == 1: color=gold opacity=0.5", "--style", "element O: visible=no"],
        ),
        (
            {"styles": ["z > 5: model=licorice bond-radius=0.2"]},
            ["--style", "z > 5: model=licorice bond-radius=0.2"],
        ),
        (
            {"styles": {"all": {"color": "tags + z", "map": "magma", "range": (0, 9)}}},
            ["--style", "all: color=tags + z map=magma range=0,9"],
        ),
        (
            {"styles": {"element Ni": {"polyhedra": ["Ni-Cu<3", "Ni-Ni<3"], "polyhedra_opacity": 0.4, "color": "teal"}}},
            ["--style", "element Ni: color=teal polyhedra=Ni-Cu<3,Ni-Ni<3 polyhedra-opacity=0.4"],
        ),
        ({"styles": {"element Cu": "radius=2"}}, ["--style", "element Cu: radius=2"]),
    ],
    [({"hide": "element O"}, ["--hide", "element O"])],
    [({"types": {"Cu": {"color": "teal", "radius": 0.9}}}, ["--type", "Cu:color=teal,radius=0.9"])],
    [
        ({"slices": ["z > 60%"]}, ["--slice", "z > 60%"]),
        ({"slices": ["x > 2"], "slice_mode": "caps"}, ["--slice", "x > 2", "--slice-mode", "caps"]),
        ({"slices": ["y < 1"], "slice_mode": "hide"}, ["--slice", "y < 1", "--slice-mode", "hide"]),
    ],
    [({"integrator": "ao"}, ["--integrator", "ao"]), ({"depth": 1}, ["--depth", "1"])],
    [({"exposure": 1.0}, ["--exposure", "1"])],
    [
        ({"legend": "top-left"}, ["--legend", "top-left"]),
        ({"axes": True}, ["--axes"]),
        ({"axes": "cell:left"}, ["--axes", "cell:left"]),
        ({"scale_bar": "2:bottom"}, ["--scale-bar", "2:bottom"]),
        ({"label": "element Cu and tags > 1: {id} {tags:.1}"}, ["--label", "element Cu and tags > 1: {id} {tags:.1}"]),
        ({"measure": "0-4:periodic"}, ["--measure", "0-4:periodic"]),
        ({"measure": ["0-1-2", "3-4-5-6"]}, ["--measure", "0-1-2", "--measure", "3-4-5-6"]),
    ],
]

#: Eight atoms in a cell that is periodic along two edges.
SURFACE = """8
Lattice="5.1 0 0 2.55 4.42 0 0 0 10.08" Properties=species:S:1:pos:R:3:tags:I:1 pbc="T T F"
Cu 0 1.47 4 2
Cu 2.55 1.47 4 2
Cu 1.28 3.69 4 1
Cu 3.83 3.69 4 1
Ni 0 0 6.08 1
Ni 2.55 0 6.08 1
O 6.3 2.2 7.5 0
H -0.9 2.3 8.2 0
"""


def chosen():
    """Each option by itself, and two hundred random choices."""
    cases = [[option] for group in GROUPS for option in group]
    some = random.Random(7)
    for _ in range(200):
        cases.append([some.choice(group) for group in GROUPS if some.random() < 0.4])
    return cases


@pytest.mark.filterwarnings("ignore")
def test_pictures_of_any_options_are_those_of_the_program(program, tmp_path):
    path, out = tmp_path / "surface.extxyz", tmp_path / "theirs.pfm"
    path.write_text(SURFACE)
    agreed = refused = 0
    for case in chosen():
        options = {name: value for given, _ in case for name, value in given.items()}
        words = [word for _, words in case for word in words]
        command = [program, "render", path, "-o", out, "--size", "16x12", "--spp", "1", "--quiet", *words]
        run = subprocess.run(command, capture_output=True, text=True, timeout=60)
        try:
            mine = spherule.render(path, size=(16, 12), spp=1, **options).encode("pfm")
        except spherule.Error as error:
            assert run.returncode != 0, (options, error)
            refused += 1
            continue
        assert run.returncode == 0, (options, run.stderr)
        assert mine == out.read_bytes(), options
        agreed += 1
    assert agreed > 150 and refused < agreed / 3, (agreed, refused)
