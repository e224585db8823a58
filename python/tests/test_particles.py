"""Files and other packages: NumPy columns, with radii, elements and the cell."""

import subprocess

import numpy as np
import pytest

import spherule

FILES = {
    "a.xyz": "3\nwater\nO 0 0 0\nH 0.96 0 0\nH -0.24 0.93 0\n",
    "a.csv": "x,y,z,radius,charge\n0,0,0,1,-1\n1,2,3,0.5,1\n",
    "a.lammpstrj": "ITEM: TIMESTEP\n5\nITEM: NUMBER OF ATOMS\n2\nITEM: BOX BOUNDS pp pp ff\n0 4\n0 5\n-1 5\n"
    "ITEM: ATOMS id type x y z q\n1 1 0 0 0 0.5\n2 2 1 2 3 -0.5\n"
    "ITEM: TIMESTEP\n9\nITEM: NUMBER OF ATOMS\n1\nITEM: BOX BOUNDS pp pp ff\n0 4\n0 5\n-1 5\n"
    "ITEM: ATOMS id type x y z q\n7 2 3 2 1 0.25\n",
    "a.gro": "t\n1\n    1SOL     OW    1   0.100   0.200   0.300\n   1.0 1.0 1.0\n",
    "a.pdb": "ATOM      1  CA  GLY A   1      11.000  12.000  13.000  1.00 20.00           C  \nEND\n",
    "a.txt": "0 0 0 1\n1 2 3 0.5\n",
    "a.ply": "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
    "end_header\n1 2 3\n",
}


@pytest.fixture
def folder(tmp_path):
    for name, text in FILES.items():
        (tmp_path / name).write_text(text)
    np.save(tmp_path / "a.npy", np.array([[0, 0, 0], [1, 2, 3.5]]))
    np.savez(tmp_path / "a.npz", positions=np.array([[1, 2, 3.0]]), radii=np.array([0.25]))
    return tmp_path


def test_files_become_columns(folder):
    water = spherule.read(folder / "a.xyz")
    assert water.positions.tolist() == [[0, 0, 0], [0.96, 0, 0], [-0.24, 0.93, 0]]
    assert water.x.flags.c_contiguous and water.x.base is not None
    assert (water.kinds.tolist(), water.elements.tolist()) == (["O", "H", "H"],) * 2
    assert (water.format, water.title, water.cell) == ("xyz", "water", None)
    table = spherule.read(folder / "a.csv")
    assert (table.radius.tolist(), table.columns["charge"].tolist()) == ([1, 0.5], [-1, 1])
    for name in FILES:
        assert len(spherule.read(folder / name)) >= 1, name
    assert spherule.read(folder / "a.npy").z.tolist() == [0, 3.5]
    assert spherule.read(folder / "a.npz").radius.tolist() == [0.25]


def test_elements_are_known_from_a_fact_or_given(folder):
    facts = {name: set(spherule.read(folder / name).element_from.tolist()) for name in ("a.xyz", "a.gro", "a.lammpstrj")}
    assert facts == {"a.xyz": {"symbol"}, "a.gro": {"name"}, "a.lammpstrj": {""}}
    given = spherule.read(folder / "a.lammpstrj", elements={"1": "Si", "7": "O"})
    assert given.elements.tolist() == ["Si", ""] and given.element_from.tolist() == ["given", ""]
    later = [frame.elements.tolist() for frame in spherule.frames(folder / "a.lammpstrj", elements={"2": "O"})]
    assert later == [["", "O"], ["O"]]
    own = spherule.Particles([[0, 0, 0], [1, 0, 0]], kinds=["O", "x"], elements=["O", None])
    assert own.element_from.tolist() == ["given", ""]
    assert spherule.Particles([[0, 0, 0]], kinds=["O"]).element_from.tolist() == ["symbol"]
    assert spherule.Particles([[0, 0, 0]]).element_from is None
    for elements, text in (({"1": "Xx"}, r'elements\["1"\] is "Xx"'), ({"1": 8}, r'elements\["1"\]'), ("O", "a dict")):
        with pytest.raises(spherule.Error, match=text):
            spherule.read(folder / "a.lammpstrj", elements=elements)


def test_frames_are_numbered_from_either_end(folder):
    path = folder / "a.lammpstrj"
    assert spherule.count_frames(path) == 2
    assert [frame.step for frame in spherule.frames(path)] == [5, 9]
    long = folder / "long.xyz"
    long.write_text("".join(f"2\n\nH{number % 3} {number} 0 0\nO 0 1 0\n" for number in range(40)))
    frames = list(spherule.frames(long))
    assert [frame.x[0] for frame in frames] == list(range(40))
    for number in (0, 1, 2, 7, 39):
        alone = spherule.read(long, number)
        own = frames[number]
        assert (own.kinds.tolist(), own.elements.tolist()) == (alone.kinds.tolist(), alone.elements.tolist())
        assert own._kinds[0] == alone._kinds[0] and own._first_frame[0] == alone._first_frame[0]
    with long.open("a") as file:
        file.write("2\n\nC 1 2 x\nC 1 2 3\n1\n\nC 1 2 3\n")
    assert spherule.count_frames(long) == 42
    several = spherule.frames(long)
    assert [next(several).x[0] for _ in range(40)] == list(range(40))
    with pytest.raises(spherule.Error, match=r"long\.xyz:163:7: `x`"):
        next(several)
    first, last = spherule.read(path), spherule.read(path, np.int64(-1))
    assert spherule.read(path, -2).step == first.step == 5 and last.step == spherule.read(path, 1).step == 9
    assert last.columns["q"].tolist() == [0.25] and first.kinds.tolist() == ["1", "2"]
    origin, edges, periodic = first.cell
    assert (origin, edges) == ([0, 0, -1], [[4, 0, 0], [0, 5, 0], [0, 0, 6]]) or (
        list(origin),
        [list(e) for e in edges],
    ) == (
        [0, 0, -1],
        [[4, 0, 0], [0, 5, 0], [0, 0, 6]],
    )
    assert list(periodic) == [True, True, False]
    for frame, text in ((2, "has no frame 2, only 2"), (-3, "has no frame -3, only 2")):
        with pytest.raises(spherule.Error, match=text):
            spherule.read(path, frame)


def test_errors_of_files_have_path_and_line(folder):
    (folder / "bad.xyz").write_text("2\nx\nO 0 0 0\nH 0 zero 0\n")
    with pytest.raises(spherule.Error) as refused:
        spherule.read(folder / "bad.xyz")
    assert refused.value.path == str(folder / "bad.xyz") and refused.value.line == 4
    with pytest.raises(spherule.Error, match="cannot be read: No such file"):
        spherule.read(folder / "missing.xyz")
    with pytest.raises(spherule.Error, match='unknown format "xzy"; formats are xyzr'):
        spherule.read(folder / "a.xyz", format="xzy")


def test_what_is_read_renders_as_the_file(folder):
    # What is up follows from the format of a file, which arrays do not have.
    options = {"size": (60, 40), "spp": 2, "view": "z", "up": "y"}
    ways = (
        spherule.render(folder / "a.xyz", **options),
        spherule.render(spherule.read(folder / "a.xyz"), **options),
        spherule.render(
            [[0, 0, 0], [0.96, 0, 0], [-0.24, 0.93, 0]], kinds=["O", "H", "H"], unit="angstrom", **options
        ),
    )
    assert all(np.array_equal(ways[0].pixels, picture.pixels) for picture in ways)


def test_cells_of_lengths_and_angles():
    cell = spherule.Particles([[0, 0, 0]], cell=[2, 3, 4, 80, 95, 120]).cell
    a, b, c = (np.array(edge) for edge in cell[1])
    assert np.allclose([np.linalg.norm(edge) for edge in (a, b, c)], [2, 3, 4])
    angles = [np.degrees(np.arccos(p @ q / np.linalg.norm(p) / np.linalg.norm(q))) for p, q in ((b, c), (a, c), (a, b))]
    assert np.allclose(angles, [80, 95, 120])


def test_structures_of_ase():
    build = pytest.importorskip("ase.build")
    crystal = build.bulk("NaCl", "rocksalt", a=5.64, cubic=True)
    particles = spherule.from_ase(crystal)
    assert np.array_equal(particles.positions, crystal.positions)
    assert set(particles.elements) == {"Na", "Cl"} and particles.unit == "angstrom"
    assert np.allclose(particles.cell[1], crystal.cell[:]) and particles.cell[2] == (True,) * 3
    assert spherule.from_ase(build.molecule("H2O")).cell is None
    picture = spherule.render(particles, size=(60, 40), spp=2, show_cell=True, replicate=(2, 1, 1))
    assert picture.pixels.shape == (40, 60, 3)


@pytest.mark.filterwarnings("ignore")
def test_structures_of_mdanalysis(folder):
    mdanalysis = pytest.importorskip("MDAnalysis")
    universe = mdanalysis.Universe(str(folder / "a.pdb"))
    particles = spherule.from_mdanalysis(universe.atoms)
    assert particles.positions.tolist() == [[11, 12, 13]] and particles.positions.dtype == np.float32
    assert particles.elements.tolist() == ["C"] and particles.columns["resname"].tolist() == ["GLY"]
    assert particles.bonds is None
    pair = mdanalysis.Universe.empty(3, trajectory=True)
    pair.atoms.positions = np.eye(3)
    pair.add_TopologyAttr("bonds", [(0, 1), (1, 2)])
    assert spherule.from_mdanalysis(pair).bonds.tolist() == [[0, 1], [1, 2]]
    assert spherule.from_mdanalysis(pair.atoms[[2, 1]]).bonds.tolist() == [[0, 1]]
    universe.dimensions = [10, 10, 10, 90, 90, 90]
    assert np.allclose(spherule.from_mdanalysis(universe).cell[1], np.eye(3) * 10)


def test_frames_of_gsd(tmp_path):
    hoomd = pytest.importorskip("gsd.hoomd")
    frame = hoomd.Frame()
    frame.particles.N = 3
    frame.particles.position = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], np.float32)
    frame.particles.types, frame.particles.typeid = ["A", "B"], [0, 1, 0]
    frame.particles.diameter = [1, 2, 1]
    frame.particles.type_shapes = [{"type": "Ellipsoid", "a": 1, "b": 2, "c": 3}]
    frame.particles.orientation = [[1, 0, 0, 0], [1, 0, 0, 0], [0.6, 0, 0.8, 0]]
    frame.configuration.box = [6, 6, 6, 0.1, 0, 0]
    frame.bonds.N, frame.bonds.group, frame.bonds.types, frame.bonds.typeid = 1, [[2, 0]], ["b"], [0]
    with hoomd.open(tmp_path / "a.gsd", "w") as file:
        file.append(frame)
    with hoomd.open(tmp_path / "a.gsd") as file:
        ours = spherule.from_gsd(file[0])
    theirs = spherule.read(tmp_path / "a.gsd", bonds="file")
    assert ours.bonds.tolist() == theirs.bonds.tolist() == [[0, 2]]
    assert np.array_equal(ours.positions, theirs.positions) and np.array_equal(ours.radius, theirs.radius)
    assert np.array_equal(ours.kinds, theirs.kinds)
    assert ours.semi_axes.tolist() == [[1, 2, 3], [0, 0, 0], [1, 2, 3]]
    assert np.allclose(ours.semi_axes, theirs.semi_axes) and np.allclose(ours.orientation, theirs.orientation)
    assert np.allclose(ours.cell[1], theirs.cell[1]) and np.allclose(ours.cell[0], theirs.cell[0])


def test_tables_of_pandas():
    pandas = pytest.importorskip("pandas")
    table = pandas.DataFrame(
        {"X": [0.0, 1], "Y": [0, 2], "Z": [0, 3], "diameter": [1, 2], "type": ["a", "b"], "q": [1, 2]}
    )
    particles = spherule.from_pandas(table)
    assert particles.positions.tolist() == [[0, 0, 0], [1, 2, 3]] and particles.radius.tolist() == [0.5, 1]
    assert particles.kinds.tolist() == ["a", "b"] and list(particles.columns) == ["q"]
    with pytest.raises(spherule.Error, match="no columns x, y and z"):
        spherule.from_pandas(table.drop(columns="X"))
    with pytest.raises(spherule.Error, match="no column `r`; it has X, Y"):
        spherule.from_pandas(table, radius="r")


@pytest.fixture
def ovito():
    """OVITO's module, which is large and needs libraries of displays: python-check tries it where it can be had."""
    pytest.importorskip("ovito.data", exc_type=ImportError)
    return pytest.importorskip("ovito.io", exc_type=ImportError)


def test_collections_of_ovito(ovito, folder):
    (folder / "b.xyz").write_text(
        '3\nLattice="4 0 0 0 5 0 1 0 6" Origin="-1 -2 -3" pbc="T T F" Time=2.5 '
        "Properties=species:S:1:pos:R:3:radius:R:1:velo:R:3:mol:I:1\n"
        "O 0 0 0 0.5 1 2 3 7\nH 0.96 0 0 0.25 1 2 3 7\nH -0.24 0.93 0 0.25 4 5 6 8\n"
    )
    particles = spherule.from_ovito(ovito.import_file(str(folder / "b.xyz")).compute())
    assert particles.elements.tolist() == ["O", "H", "H"] == particles.kinds.tolist()
    assert particles.radius.tolist() == [0.5, 0.25, 0.25] and particles.time == 2.5
    assert particles.columns["Velocity_z"].tolist() == [3, 3, 6] and particles.columns["mol"].tolist() == [7, 7, 8]
    assert particles.cell == ((-1, -2, -3), ((4, 0, 0), (0, 5, 0), (1, 0, 6)), (True, True, False))
    # OVITO's red of oxygen is 255, 13, 13 on the screen.
    assert np.allclose(particles.color, [[1, 0.004025, 0.004025], [1, 1, 1], [1, 1, 1]], atol=1e-6)
    assert spherule.render(particles, size=(60, 40), spp=2).pixels.max() > 0


def test_frames_of_ovito_are_those_that_are_read(ovito, folder):
    pipeline = ovito.import_file(str(folder / "a.lammpstrj"))
    for frame in (0, 1):
        theirs, ours = pipeline.compute(frame), spherule.read(folder / "a.lammpstrj", frame)
        particles = spherule.from_ovito(theirs)
        assert np.array_equal(particles.positions, ours.positions) and particles.step == ours.step
        assert particles.kinds.tolist() == ours.kinds.tolist() and particles.radius is None
        assert particles.columns["Charge"].tolist() == ours.columns["q"].tolist()
        assert np.allclose(particles.cell[1], ours.cell[1]) and particles.cell[2] == tuple(ours.cell[2])
    assert particles.bonds is None
    theirs.particles_.create_property("Color", data=[(0.5, 0, 1)])
    assert np.allclose(spherule.from_ovito(theirs).color, [[0.215861, 0, 1]], atol=1e-6)


def test_shapes_of_ovito_are_those_that_are_read(ovito, folder):
    (folder / "shapes.lammpstrj").write_text(SHAPES)
    ours = spherule.read(folder / "shapes.lammpstrj")
    theirs = spherule.from_ovito(ovito.import_file(str(folder / "shapes.lammpstrj")).compute())
    assert np.allclose(ours.semi_axes, theirs.semi_axes) and np.allclose(ours.orientation, theirs.orientation)
    assert np.allclose(ours.radius, theirs.radius)


def test_bonds_of_ovito_cross_the_cell(ovito):
    data = pytest.importorskip("ovito.data").DataCollection()
    particles = data.create_particles(count=3)
    particles.create_property("Position", data=[[0.2, 0, 0], [3.8, 0, 0], [1.5, 0, 0]])
    data.create_cell(np.hstack([np.eye(3) * 4, np.zeros((3, 1))]), pbc=(True, True, True))
    data.apply(pytest.importorskip("ovito.modifiers").CreateBondsModifier(cutoff=1.5))
    found = spherule.from_ovito(data)
    assert found.bonds.tolist() == [[0, 1], [0, 2]] and found.bond_shifts.tolist() == [[-1, 0, 0], [0, 0, 0]]


def test_other_things_are_refused():
    for take in (
        spherule.from_ase,
        spherule.from_mdanalysis,
        spherule.from_ovito,
        spherule.from_gsd,
        spherule.from_pandas,
    ):
        with pytest.raises(spherule.Error, match="but object has no"):
            take(object())


def same_as_the_program(program, path, tmp_path, options, arguments):
    out = tmp_path / "theirs.pfm"
    command = [program, "render", path, "-o", out, "--size", "60x40", "--spp", "2", *arguments]
    subprocess.run(command, check=True, timeout=120)
    mine = tmp_path / "mine.pfm"
    spherule.render(path, size=(60, 40), spp=2, **options).save(mine)
    assert mine.read_bytes() == out.read_bytes()


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("name", [*FILES, "a.npy", "a.npz", "bonds.mol2", "water.gro", "zero.csv", "shapes.lammpstrj"])
def test_pictures_of_files_are_those_of_the_program(program, folder, tmp_path, name):
    (folder / "bonds.mol2").write_text(
        "@<TRIPOS>MOLECULE\nm\n3 1 0 0 0\nSMALL\nNO_CHARGES\n@<TRIPOS>ATOM\n1 C1 0 0 0 C.3\n2 C2 1.5 0 0 C.3\n"
        "3 C3 0 1.5 0.3 C.3\n@<TRIPOS>BOND\n1 2 3 1\n"
    )
    # The site of the charge is not drawn, and neither is what has no radius.
    (folder / "water.gro").write_text(
        "t\n4\n    1SOL     OW    1   0.100   0.200   0.300\n    1SOL    HW1    2   0.190   0.200   0.300\n"
        "    1SOL    HW2    3   0.080   0.290   0.310\n    1SOL     MW    4   0.500   0.900   0.100\n   1.0 1.0 1.0\n"
    )
    (folder / "zero.csv").write_text("x,y,z,radius\n0,0,0,1\n5,5,5,0\n1,2,3,0.5\n")
    (folder / "shapes.lammpstrj").write_text(SHAPES)
    same_as_the_program(program, folder / name, tmp_path, {}, [])
    if name in ("a.xyz", "bonds.mol2", "water.gro"):
        same_as_the_program(
            program, folder / name, tmp_path, {"model": "ball-and-stick"}, ["--model", "ball-and-stick"]
        )
        same_as_the_program(
            program, folder / name, tmp_path, {"color_by": "coordination"}, ["--color-by", "coordination"]
        )


#: An ellipsoid, a sphere, and an ellipsoid that is turned.
SHAPES = (
    "ITEM: TIMESTEP\n0\nITEM: NUMBER OF ATOMS\n3\nITEM: BOX BOUNDS ff ff ff\n0 9\n0 9\n0 9\n"
    "ITEM: ATOMS id type x y z radius shapex shapey shapez quatw quati quatj quatk\n"
    "1 1 1 1 1 1 1 2 3 1 0 0 0\n2 2 4 1 1 0.5 0 0 0 1 0 0 0\n3 1 7 1 1 1 1 2 3 0.6 0.8 0 0\n"
)


def test_files_with_shapes_become_ellipsoids(folder):
    (folder / "a.dump").write_text(SHAPES)
    particles = spherule.read(folder / "a.dump")
    assert particles.semi_axes.tolist() == [[0.5, 1, 1.5], [0, 0, 0], [0.5, 1, 1.5]]
    assert np.allclose(particles.orientation, [[1, 0, 0, 0], [1, 0, 0, 0], [0.6, 0.8, 0, 0]])
    assert particles.radius.tolist() == [1.5, 0.5, 1.5]
    assert "2 ellipsoids" in repr(particles)


def test_ellipsoids_keep_the_rows_of_their_arrays():
    positions = np.array([[0, 0, 0], [3, 0, 0], [6, 0, 0.0]])
    axes = np.array([[1, 0.5, 0.5], [0, 0, 0], [0.4, 1.2, 0.4]], np.float32)
    options = dict(size=(90, 30), spp=1, layers="id", view="z", preset="chalk")
    picture = spherule.render(positions, semi_axes=axes, radius=[1, 0.5, 1.2], **options)
    ids = picture.layers["id"]
    assert set(np.unique(ids[ids < spherule.GROUND]).tolist()) == {0, 1, 2}
    columns = [ids[:, left : left + 30] for left in (0, 30, 60)]
    middle = [np.unique(part[part < spherule.GROUND]).tolist() for part in columns]
    assert middle == [[0], [1], [2]]
    # Sticks of sections are numbered between spheres and ellipsoids, and keep the rows of both.
    stick = {"from": [0, 9, 0], "to": [6, 9, 0], "radius": 0.1}
    cone = {"apex": [0, 8, 0], "base": [0, 7, 0], "radius": 0.1}
    with_others = spherule.Scene(positions, semi_axes=axes, radius=[1, 0.5, 1.2], stick=[stick], cone=[cone], view="z")
    ids = with_others.render(size=(90, 150), spp=1, layers="id").layers["id"]
    assert set(np.unique(ids[ids < spherule.GROUND]).tolist()) == {0, 1, 2, 3, 4}
    # A radius is that of the longest semi-axis, and one triple is for all.
    scene = spherule.Scene(positions, semi_axes=[1, 2, 4], radius=2)
    assert len(scene) == 3
    assert np.allclose(scene.bounds, ([-0.5, -1, -2], [6.5, 1, 2]))
    turned = spherule.Scene(positions, semi_axes=[1, 2, 4], orientation=[1, 0, 0, 1])
    assert np.allclose(turned.bounds, ([-2, -1, -4], [8, 1, 4]))


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (dict(semi_axes=[[1, 1, 1], [1, -1, 1]]), r"semi_axes\[1\] is .*greater than 0"),
        (dict(semi_axes=[[1, 1, 1], [1, 0, 1]]), r"semi_axes\[1\]"),
        (dict(semi_axes=[[1, 1, np.nan], [1, 1, 1]]), r"semi_axes\[0\]"),
        (dict(semi_axes=[[1, 1, 1]]), r"`semi_axes` has the shape \(1, 3\)"),
        (dict(semi_axes="long"), "`semi_axes`"),
        (dict(orientation=[1, 0, 0, 0]), "`orientation` needs `semi_axes`"),
        (dict(semi_axes=[1, 2, 3], orientation=[[1, 0, 0, 0], [0, 0, 0, 0]]), r"orientation\[1\] is 0"),
        (dict(semi_axes=[1, 2, 3], orientation=[[1, 0, 0], [0, 0, 0]]), r"`orientation` has the shape \(2, 3\)"),
        (dict(semi_axes=[1, 2, 3], orientation=[[1, np.inf, 0, 0], [1, 0, 0, 0]]), r"orientation\[0, 1\] is inf"),
        (dict(semi_axes=[1, 1, 1e5]), "ellipsoid 0"),
    ],
)
def test_shapes_that_are_none_are_refused_by_row(options, message):
    with pytest.raises(spherule.Error, match=message):
        spherule.render([[0, 0, 0], [5, 0, 0]], size=(20, 10), spp=1, **options)


def test_rows_that_are_not_drawn_keep_the_numbers_of_others(folder):
    (folder / "zero.csv").write_text("x,y,z,radius\n0,0,0,0\n1,2,3,0.5\n")
    with pytest.warns(spherule.SpheruleWarning):
        picture = spherule.render(folder / "zero.csv", layers="id", size=(60, 40), spp=1)
    ids = picture.layers["id"]
    assert set(np.unique(ids[ids < spherule.GROUND]).tolist()) == {1}


def test_vectors_are_drawn_as_arrows(program, tmp_path):
    positions = np.array([[0, 0, 0], [3, 0, 0], [6, 0, 0.0]])
    vectors = np.array([[0, 2, 0], [0, 0, 0], [0, 4, 0]], np.float32)
    options = dict(size=(60, 50), spp=4, view="z", radius=0.5)
    plain = spherule.render(positions, **options)
    columns = dict(zip(("vx", "vy", "vz"), vectors.T))
    pictures = [
        spherule.render(positions, arrows=vectors, **options),
        spherule.render(positions, arrows=tuple(vectors.T), **options),
        spherule.render(positions, arrows="velocity", columns=columns, **options),
        spherule.render(positions, arrows=("vx", "vy", "vz"), columns=columns, arrow_center="tail", **options),
    ]
    for picture in pictures:
        assert np.array_equal(picture.pixels, pictures[0].pixels)
    assert not np.array_equal(plain.pixels, pictures[0].pixels)
    rows = ["x,y,z,radius,vx,vy,vz", *(",".join(map(str, (*p, 0.5, *v))) for p, v in zip(positions, vectors))]
    (tmp_path / "a.csv").write_text("\n".join(rows) + "\n")
    same_as_the_program(
        program,
        tmp_path / "a.csv",
        tmp_path,
        {"arrows": "velocity", "arrow_scale": 0.5, "arrow_radius": 0.1, "arrow_color": "red", "arrow_center": "middle"},
        "--arrows velocity --arrow-scale 0.5 --arrow-radius 0.1 --arrow-color red --arrow-center middle".split(),
    )


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (dict(arrows=[[1, 0, 0]]), r"`arrows` has the shape \(1, 3\)"),
        (dict(arrows="velocity"), "`vx`"),
        (dict(arrows=["vx", "vy"]), "`arrows`"),
        (dict(arrow_scale=2.0), "`arrow_scale` needs `arrows`"),
        (dict(arrows=[[1, 0, 0]] * 2, arrow_scale=-1.0), "`arrow_scale` is -1"),
        (dict(arrows=[[1, 0, 0]] * 2, arrow_center="side"), "`arrow_center`"),
        (dict(arrows=[[1, 0, 0]] * 2, arrow_color="rde"), "rde"),
    ],
)
def test_arrows_that_are_none_are_refused_by_name(options, message):
    with pytest.raises(spherule.Error, match=message):
        spherule.render([[0, 0, 0], [5, 0, 0]], radius=1, size=(20, 10), spp=1, **options)


def test_crystals_are_balls_and_sticks_in_their_cell(tmp_path):
    rows = "0 0 0\n0 .5 .5\n.5 0 .5\n.5 .5 0\n.5 .5 .5\n.5 0 0\n0 .5 0\n0 0 .5\n"
    (tmp_path / "POSCAR").write_text(f"NaCl\n5.64\n1 0 0\n0 1 0\n0 0 1\nNa Cl\n4 4\nDirect\n{rows}")

    def saved(**options):
        scene = spherule.Scene.load(tmp_path / "POSCAR", **options)
        scene.save(tmp_path / "scene.toml")
        text = (tmp_path / "scene.toml").read_text()
        return len(scene), "[[stick]]" in text, "\ncell = " in text

    assert saved() == (27, True, True)
    assert saved(model="space-filling") == saved(bonds="none") == (27, False, False)
    assert saved(model="ball-and-stick") == (27, True, False)
    assert saved(complete=False) == (8, True, True)
    assert saved(complete=False, replicate=(2, 1, 1)) == (16, True, True)
    assert saved(replicate=(2, 1, 1)) == (45, True, True)
    assert saved(outside="whole")[0] > 27
    scene = spherule.Scene.load(tmp_path / "POSCAR", polyhedra=["Na-Cl"], polyhedra_opacity=1)
    ids = scene.render(layers="id", size=(60, 60), spp=1).layers["id"]
    # The centers, sodium, are inside of opaque faces.
    assert {row for row in ids.ravel().tolist() if row < 8} == set(range(4, 8))


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"polyhedra": "Cu"}, "two types"),
        ({"polyhedra": "Cu-Xx<2"}, "no type `Xx`"),
        ({"polyhedra": "Cu-Cu<3", "polyhedra_opacity": 2}, "0 to 1"),
        ({"polyhedra_opacity": 0.5}, "needs `polyhedra`"),
        ({"outside": "some"}, "molecules, whole, none, halves"),
        ({"complete": True}, "no cell"),
    ],
)
def test_boundaries_and_polyhedra_that_cannot_be_are_refused_by_name(options, message):
    with pytest.raises(spherule.Error, match=message):
        spherule.Scene([[0, 0, 0], [2, 0, 0]], kinds=["Cu", "Cu"], **options)
