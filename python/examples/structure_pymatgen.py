"""A crystal of pymatgen as crystallographers draw it: balls, sticks and octahedra of rutile in their cell.

Run it with pymatgen installed; it writes structure_pymatgen.png.
"""

from pathlib import Path

from pymatgen.core import Lattice, Structure  # type: ignore[attr-defined,unused-ignore]

import spherule


def main() -> None:
    """Renders the crystal."""
    rutile = Structure.from_spacegroup(
        "P4_2/mnm", Lattice.tetragonal(4.594, 2.959), ["Ti", "O"], [[0, 0, 0], [0.305, 0.305, 0]]
    )
    picture = spherule.render(
        rutile,
        replicate=(1, 1, 2),
        complete=True,
        outside="whole",
        model="ball-and-stick",
        polyhedra="Ti-O",
        polyhedra_opacity=0.75,
        types={"Ti": {"color": "cornflowerblue"}},
        show_cell=True,
        legend="top-right",
        axes="cell:bottom-left",
        view=(60, 15),
        camera={"projection": "orthographic"},
        size=(480, 480),
        spp=32,
        denoise="on",
    )
    picture.save(Path(__file__).with_suffix(".png"))


if __name__ == "__main__":
    main()
