"""Entry points of ASE, and structures of mdtraj and pymatgen."""

import io
import os
import stat
from importlib.metadata import EntryPoint

import numpy as np
import pytest

import spherule


@pytest.fixture
def ase():
    """ASE with the entry points of the package, also where it is not installed by its wheel."""
    plugins = pytest.importorskip("ase.utils.plugins")
    if not hasattr(plugins, "ExternalViewer"):
        pytest.skip("ASE is too old for viewers of other packages")
    from ase.io import formats
    from ase.visualize import viewers

    if "spherule" not in viewers.VIEWERS:
        viewers.define_external_viewer(EntryPoint("spherule", "spherule._ase:VIEWER", "ase.visualize"))
    if "spherule" not in formats.ioformats:
        formats.define_external_io_format(EntryPoint("spherule", "spherule._ase:FORMAT", "ase.ioformats"))
    import ase

    return ase


@pytest.fixture
def water(ase):
    from ase.build import molecule

    return molecule("H2O")


@pytest.fixture
def fake(tmp_path, monkeypatch):
    """A program that says what it was started with, and the file that it shows."""
    program = tmp_path / "bin" / "spherule"
    program.parent.mkdir()
    program.write_text(f'#!/bin/sh\nprintf "%s\\n" "$@" > {tmp_path}/said\ncat "$2" > {tmp_path}/shown\n')
    program.chmod(program.stat().st_mode | stat.S_IXUSR)
    monkeypatch.setattr("spherule._program.sysconfig.get_path", lambda _: str(program.parent))
    monkeypatch.delenv("SPHERULE", raising=False)
    monkeypatch.setenv("PYTHONPATH", os.path.dirname(os.path.dirname(spherule.__file__)))
    return tmp_path


@pytest.mark.skipif(os.name != "posix", reason="a script stands for the program")
def test_ase_views_in_the_page(fake, water):
    from ase.visualize import view

    process = view([water, water], viewer="spherule", model="ball-and-stick", show_cell=True, slices=["x > 1", "y > 2"],
        size=(80, 60), complete=False, color_log=False, styles={"element O": {"color": "red"}}, view=(30, 20),
    )  # fmt: skip
    assert process.wait(60) == 0
    command, file, *options = (fake / "said").read_text().split("\n")[:-1]
    assert command == "view" and os.path.basename(file) == "H2O.xyz"
    assert options == ["--model=ball-and-stick", "--cell", "--slice=x > 1", "--slice=y > 2", "--size=80x60", "--complete=no",
        "--style=element O: color=red", "--view=30,20"]  # fmt: skip
    # The file is there while the viewer is.
    assert not os.path.exists(os.path.dirname(file))
    (fake / "again.xyz").write_bytes((fake / "shown").read_bytes())
    assert spherule.count_frames(fake / "again.xyz") == 2
    assert np.allclose(spherule.read(fake / "again.xyz").positions, water.positions)


def test_ase_says_what_it_cannot_view(fake, water):
    from ase.visualize import view

    for atoms, options, message in (
        (water, {"data": np.zeros((2, 2, 2))}, "`data`"),
        ([], {}, "empty"),
        (water, {"color_map": object()}, "`color_map`"),
        (water, {"styles": {"element O": {"color": (1, 0, 0)}}}, "`styles`"),
    ):
        with pytest.raises(spherule.Error, match=message):
            view(atoms, viewer="spherule", **options)
    (fake / "bin" / "spherule").unlink()
    os.environ["PATH"], path = "", os.environ["PATH"]
    try:
        with pytest.raises(spherule.Error, match="not installed"):
            view(water, viewer="spherule")
    finally:
        os.environ["PATH"] = path


def test_ase_views_scenes_in_notebooks(water, monkeypatch):
    from ase.visualize import view

    monkeypatch.setattr("spherule._ase.in_notebook", lambda: True)
    assert len(view(water, viewer="spherule", model="space-filling")) == 3
    with pytest.warns(spherule.SpheruleWarning, match="first of 2 frames"):
        assert len(view([water, water], viewer="spherule")) == 3


def test_ase_writes_pictures(ase, water, tmp_path):
    from ase.io import write

    write(tmp_path / "a.pfm", water, format="spherule", size=(40, 30), spp=1)
    spherule.render(water, size=(40, 30), spp=1).save(tmp_path / "b.pfm")
    assert (tmp_path / "a.pfm").read_bytes() == (tmp_path / "b.pfm").read_bytes()
    with pytest.raises(spherule.Error):
        write(tmp_path / "a.doc", water, format="spherule", size=(40, 30), spp=1)


@pytest.fixture
def trajectory():
    """Two frames of a water molecule and a site without a mass, in two chains."""
    mdtraj = pytest.importorskip("mdtraj")
    topology = mdtraj.Topology()
    water = topology.add_residue("HOH", topology.add_chain(), resSeq=7)
    atoms = [topology.add_atom(name, mdtraj.element.get_by_symbol(name[0]), water) for name in ("O", "H1", "H2")]
    for atom in atoms[1:]:
        topology.add_bond(atoms[0], atom)
    topology.add_atom("MW", mdtraj.element.virtual, topology.add_residue("LIG", topology.add_chain(), resSeq=8))
    positions = np.array([[0, 0, 0], [0.096, 0, 0], [-0.024, 0.093, 0], [0.5, 0, 0]])
    return mdtraj.Trajectory(
        np.array([positions, positions + 1]), topology, time=[0, 2.5], unitcell_lengths=[[2, 3, 4]] * 2,
        unitcell_angles=[[90, 90, 90]] * 2,
    )  # fmt: skip


@pytest.mark.filterwarnings("ignore")
def test_structures_of_mdtraj(trajectory, tmp_path):
    first, last = spherule.from_mdtraj(trajectory), spherule.from_mdtraj(trajectory, -1)
    assert np.allclose(last.positions - first.positions, 1) and (last.step, last.time) == (1, 2.5)
    assert first.elements.tolist() == ["O", "H", "H", ""] and first.kinds.tolist()[3] == "MW"
    assert first.bonds.tolist() == [[0, 1], [0, 2]] and np.allclose(first.cell[1], np.diag([2, 3, 4]))
    assert first.columns["resname"].tolist() == ["HOH"] * 3 + ["LIG"]
    assert first.columns["resid"].tolist() == [7, 7, 7, 8] and len(set(first.columns["chain"].tolist())) == 2
    with pytest.raises(spherule.Error, match="`frame` is 2"):
        spherule.from_mdtraj(trajectory, 2)
    with pytest.raises(spherule.Error, match="an mdtraj Trajectory"):
        spherule.from_mdtraj([[0, 0, 0]])
    # Radii of elements are those of nanometers.
    low, high = spherule.Scene(trajectory, select="resname HOH").bounds
    assert 0.2 < high[0] - low[0] < 0.5
    spherule.movie(trajectory, tmp_path / "%d.png", size=(40, 30), spp=1)
    assert {path.name for path in tmp_path.iterdir()} == {"0.png", "1.png"}


def test_structures_of_pymatgen():
    core = pytest.importorskip("pymatgen.core")
    lattice = core.Lattice.hexagonal(3, 5)
    structure = core.Structure(
        lattice, ["Ti4+", "O"], [[0, 0, 0], [1 / 3, 2 / 3, 0.5]], site_properties={"magmom": [1, -2.0]}
    )
    particles = spherule.from_pymatgen(structure)
    assert np.array_equal(particles.positions, structure.cart_coords)
    assert particles.elements.tolist() == ["Ti", "O"] and particles.columns["magmom"].tolist() == [1, -2]
    assert np.allclose(particles.cell[1], lattice.matrix) and particles.cell[2] == (True,) * 3
    molecule = core.Molecule(["C", "O"], [[0, 0, 0], [1.1, 0, 0]])
    assert spherule.from_pymatgen(molecule).cell is None and len(spherule.Scene(molecule)) == 2
    shared = core.Structure(lattice, [{"Cl": 0.6, "Br": 0.3}], [[0, 0, 0]])
    with pytest.warns(spherule.SpheruleWarning, match="1 sites are shared"):
        particles = spherule.from_pymatgen(shared)
    assert particles.elements.tolist() == ["Cl"] and np.allclose(particles.columns["occupancy"], 0.9)
    with pytest.raises(spherule.Error, match="a pymatgen Structure"):
        spherule.from_pymatgen(io)
