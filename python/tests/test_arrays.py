"""Arrays in: every type and stride gives the same picture, and what is wrong is named."""

import numpy as np
import pytest

import spherule

SMALL = {"size": (60, 40), "spp": 2}


def picture(positions, **options):
    return spherule.render(positions, **{"radius": 0.05, **SMALL, **options}).pixels


def unaligned(array):
    buffer = bytearray(array.nbytes + 1)
    view = np.frombuffer(buffer, np.uint8)[1:].view()
    view[:] = np.frombuffer(array.tobytes(), np.uint8)
    return np.ndarray(array.shape, array.dtype, buffer, 1)


def readonly(array):
    copy = array.copy()
    copy.flags.writeable = False
    return copy


@pytest.mark.parametrize(
    "convert",
    [
        pytest.param(np.asfortranarray, id="fortran"),
        pytest.param(readonly, id="readonly"),
        pytest.param(lambda a: np.repeat(a, 2, axis=0)[::2], id="strided"),
        pytest.param(lambda a: a[::-1].copy()[::-1], id="negative stride"),
        pytest.param(lambda a: np.hstack([a, a])[:, :3], id="part of a table"),
        pytest.param(lambda a: a.astype(np.float64), id="float64"),
        pytest.param(lambda a: a.astype(">f4"), id="other byte order"),
        pytest.param(lambda a: a.astype(np.longdouble), id="longdouble"),
        pytest.param(unaligned, id="unaligned"),
        pytest.param(lambda a: a.tolist(), id="lists"),
        pytest.param(lambda a: (a[:, 0], a[:, 1], a[:, 2]), id="columns"),
        pytest.param(lambda a: memoryview(a), id="buffer"),
    ],
)
def test_every_layout_gives_the_same_picture(cloud, convert):
    assert np.array_equal(picture(cloud), picture(convert(cloud)))


def test_integers_and_halves_are_converted():
    grid = np.array([[0, 0, 0], [2, 0, 0], [0, 2, 0]])
    expected = picture(grid.astype(np.float64), radius=1)
    for dtype in (np.int8, np.uint16, np.int64, np.float16):
        assert np.array_equal(picture(grid.astype(dtype), radius=1), expected), dtype


def test_arrays_are_not_changed_and_not_kept(cloud):
    import sys

    before, references = cloud.copy(), sys.getrefcount(cloud)
    scene = spherule.Scene(cloud, radius=np.full(1000, 0.05, np.float32))
    assert np.array_equal(cloud, before) and sys.getrefcount(cloud) == references
    cloud[:] = 0
    assert np.array_equal(scene.render(**SMALL).pixels, picture(before))


@pytest.mark.parametrize(
    ("options", "text"),
    [
        ({"positions": [[0, 0]]}, "`positions` has the shape (1, 2), but must have (n, 3)"),
        ({"positions": 1.0}, "`positions` has the shape (), but must have (n, 3)"),
        ({"positions": [["a", "b", "c"]]}, "`positions` is an array of <U1, but must be one of real numbers"),
        ({"positions": np.zeros((2, 3), complex)}, "`positions` is an array of complex128"),
        ({"positions": [[0, 0, 0], [0, np.nan, 0]]}, "positions[1, 1] is NaN, but must be finite"),
        ({"positions": [[0, 0, np.inf]]}, "positions[0, 2] is inf, but must be finite"),
        ({"positions": ([0.0], [0.0])}, "`positions` has the shape (2, 1), but must have (n, 3)"),
        (
            {"positions": (np.zeros(1), np.zeros(2), np.zeros(1))},
            "the columns of `positions` have 1, 2, 1 entries, but must have equally many",
        ),
        ({"radius": [1, -2]}, "radius[1] is -2, but must be finite and greater than 0"),
        ({"radius": [np.nan, 1]}, "radius[0] is NaN"),
        ({"radius": 0}, "`radius` is 0, but must be finite and greater than 0"),
        ({"radius": np.array(np.inf)}, "`radius` is inf"),
        ({"radius": [1, 2, 3]}, "`radius` has the shape (3,), but must have (2,)"),
        ({"radius": [[1], [2]]}, "`radius` has the shape (2, 1), but must have (2,)"),
        ({"radius": "vdW"}, "did you mean"),
        ({"radius": "column:r"}, "`radius` is 'column:r', but there is no column `r`; columns are none"),
        ({"radius": "column:r", "columns": {"r": [1, 0]}}, "radius[1] is 0, but must be finite and greater than 0"),
        ({"radius": "column:r", "columns": {"r": ["a", "b"]}}, "`radius` is an array of <U1"),
        ({"color": "gren"}, "`color` is 'gren', but must be a CSS color"),
        ({"color": ["red", "gren"]}, "color[1] is 'gren'"),
        ({"color": [[0, 0, 0], [0, 2, 0]]}, "color[1] is [0, 2, 0], but must be 0 to 1"),
        ({"color": [[0, 0, 0], [0, np.nan, 0]]}, "color[1, 1] is NaN, but must be finite"),
        ({"color": [0.5, 0.5]}, "`color` has the shape (2,), but must have (3,) or (2, 3)"),
        ({"values": [1, np.nan]}, "values[1] is nan, but must be finite"),
        ({"values": [1, 2, 3]}, "`values` has the shape (3,), but must have (2,)"),
        ({"values": [1, 2], "color_map": "jet"}, 'unknown color map `jet`; maps are: viridis'),
        ({"values": [1, 2], "color_range": (3, 1)}, "`color_range` is 3 to 1, but the lower number comes first"),
        ({"color_bar": True}, "`color_bar` needs colors that stand for numbers"),
        ({"positions": np.ma.array([[0, 0, 0], [0, 9, 0]], mask=[[0] * 3, [0, 1, 0]])}, "positions[1, 1] is masked"),
        ({"radius": np.ma.array([1.0, 2], mask=[0, 1])}, "radius[1] is masked, but must be a value"),
        ({"kinds": np.ma.array(["H", "O"], mask=[1, 0])}, "kinds[0] is masked"),
        ({"positions": np.array([[0, 0, None]])}, "`positions` is an array of object"),
        ({"radius": [1, 2**70]}, "`radius` is an array of object"),
        ({"threads": 2.5}, "`threads` is 2.5, but must be an integer"),
        ({"kinds": ["H"]}, "`kinds` has the shape (1,), but must have (2,)"),
        ({"kinds": [1.5, 2.5]}, "`kinds` is an array of float64, but must be one of strings or integers"),
        ({"cell": [1, 1, 0]}, "`cell` must be finite, with three edges that span a volume"),
        ({"cell": [1, 1]}, "`cell` has the shape (2,), but must have (3,), (6,) or (3, 3)"),
        ({"show_cell": True}, "has no simulation cell to draw"),
        ({"select": "index >"}, "index >"),
        ({"spp": 0}, "[render] spp = 0: `spp` is 0, but must be an integer from 1 to 16777216"),
        ({"size": (0, 5)}, "[render] size = [0, 5]"),
        ({"until_error": 2}, "[render] until_error = 2"),
        ({"threads": 0}, "`threads` is 0, but must be an integer from 1 to 4096"),
        ({"layers": ["deep"], "radius": 1}, 'unknown layer "deep"; layers are albedo'),
        ({"camera": {"fov": 200}}, "[camera] fov = 200: `fov` is 200, but must be more than 0 and less than 180"),
        ({"camera": {"eyes": [0, 0, 1]}}, "[camera] eyes = [0, 0, 1]: "),
        ({"light": {"kind": "sun"}}, "`light` must be a list of dicts"),
        ({"background": "whit"}, 'did you mean "white"?'),
        ({"camera": {"up": object()}}, "`camera.up` is of type object, which a scene cannot hold"),
    ],
)
def test_what_is_wrong_is_named(options, text):
    positions = options.pop("positions", [[0, 0, 0], [3, 0, 0]])
    with pytest.raises(spherule.Error) as refused:
        spherule.render(positions, **{**SMALL, **options})
    assert text in str(refused.value)


def test_numbers_without_dimensions_stand_for_all(cloud):
    expected = picture(cloud, radius=np.full(1000, 0.05))
    for radius in (0.05, np.float64(0.05), np.array(0.05)):
        assert np.array_equal(picture(cloud, radius=radius), expected)
    column = {"r": np.full(1000, 0.05, np.float32)}
    assert np.array_equal(picture(cloud, radius="column:r", columns=column), picture(cloud, radius=np.float32(0.05)))
    assert np.array_equal(picture(cloud, kinds=np.array("C"), radius=0.05), picture(cloud, kinds=["C"] * 1000))


def test_names_are_numbered_as_they_first_occur():
    # More rows than are put in order at once.
    names = np.array(["b", "a", "c", "long name"])[np.random.default_rng(1).permutation(np.arange(300_000) % 4)]
    first = list(dict.fromkeys(names.tolist()))
    for values in (names, names.astype("S"), names.astype(object), names.tolist()):
        found = spherule.Particles(np.zeros((300_000, 3)), kinds=values)
        assert np.array_equal(found.kinds, names) and found._kinds[0] == first
    numbers = spherule.Particles(np.zeros((300_000, 3)), kinds=np.arange(300_000)[::-1] % 70_000)
    assert numbers.kinds[:3].tolist() == ["19999", "19998", "19997"] and len(numbers._kinds[0]) == 70_000


def test_unknown_arguments_are_refused_with_the_nearest():
    with pytest.raises(TypeError, match="unknown argument `raduis`; did you mean `radius`?"):
        spherule.render([[0, 0, 0]], raduis=1)


def test_no_particles_are_refused():
    with pytest.raises(spherule.Error, match="holds no particles"):
        spherule.render(np.zeros((0, 3)))


def test_integers_of_numpy_and_tables_of_bits_are_numbers():
    grid = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]])
    expected = picture(grid.astype(float), radius=0.4)
    assert np.array_equal(picture(grid.astype(bool), radius=0.4), expected)
    assert np.array_equal(picture(np.ma.array(grid), radius=0.4, threads=np.int32(1)), expected)


def test_values_come_before_a_column_of_their_name(cloud):
    values = np.linspace(0, 1, 1000)
    expected = picture(cloud, values=values, label_of_values="height")
    particles = spherule.Particles(cloud, radius=0.05, columns={"height": np.zeros(1000)})
    shown = spherule.render(particles, values=values, label_of_values="height", **SMALL).pixels
    assert np.array_equal(shown, expected)


@pytest.mark.parametrize(
    ("bonds", "shifts", "text"),
    [
        ([0, 1], None, "`bonds` has the shape (2,), but must have (n, 2)"),
        ([[0, 1.5]], None, "`bonds` is an array of float64"),
        ([[0, 1], [1, 3]], None, "bonds[1] is 1, 3, but must be rows of the 3 particles"),
        ([[-1, 1]], None, "bonds[0] is -1, 1"),
        ([[0, 1], [2, 2]], None, "bonds[1] bonds particle 2 to itself"),
        ([[0, 1]], [[0, 0, 200]], "`bond_shifts` must be (1, 3) integers from -127 to 127"),
        (None, [[0, 0, 0]], "`bond_shifts` needs `bonds`"),
    ],
)
def test_bonds_that_cannot_be_drawn_are_named(bonds, shifts, text):
    with pytest.raises(spherule.Error) as refused:
        spherule.Particles(np.eye(3), bonds=bonds, bond_shifts=shifts)
    assert text in str(refused.value)


def test_bonds_are_sorted_and_drawn_from_either_end():
    places = np.array([[0.0, 0, 0], [1.5, 0, 0], [0, 1.5, 0]])
    bonded = spherule.Particles(places, bonds=[[2, 0], [0, 1], [1, 0]], kinds=["C"] * 3)
    assert bonded.bonds.tolist() == [[0, 1], [0, 2]] and bonded.bond_shifts is None
    image = spherule.Particles(places, bonds=[[1, 1], [2, 0]], bond_shifts=[[1, 0, 0], [0, 1, 0]], cell=[3, 3, 3])
    assert image.bonds.tolist() == [[0, 2], [1, 1]] and image.bond_shifts.tolist() == [[0, -1, 0], [-1, 0, 0]]
    options = {"radius": 0.5, "model": "ball-and-stick", **SMALL}
    drawn = spherule.render(bonded, **options).pixels
    by_distance = spherule.render(places, kinds=["C"] * 3, bonds="C-C<1.6", **options).pixels
    assert np.array_equal(drawn, by_distance)
    assert np.array_equal(spherule.render(bonded, bonds="file", **options).pixels, drawn)
    fewer = spherule.Particles(places, bonds=[[0, 1]], kinds=["C"] * 3)
    assert not np.array_equal(spherule.render(fewer, **options).pixels, drawn)
    columns = spherule.render(fewer, radius=0.5, color_by="coordination", color_range=(0, 2), **SMALL).pixels
    given = spherule.render(fewer, radius=0.5, values=[1, 1, 0], color_range=(0, 2), **SMALL).pixels
    assert np.array_equal(columns, given)
