"""A molecule from ASE: buckminsterfullerene around a water molecule, seen through a transparent background.

Run it with ASE installed; it writes molecule_ase.png.
"""

from pathlib import Path

from ase.build import molecule  # type: ignore[import-untyped,unused-ignore]

import spherule


def main() -> None:
    """Renders the molecule."""
    cage = molecule("C60")  # type: ignore[no-untyped-call,unused-ignore]
    water = molecule("H2O")  # type: ignore[no-untyped-call,unused-ignore]
    water.translate(cage.get_center_of_mass() - water.get_center_of_mass())
    picture = spherule.render(
        spherule.from_ase(cage + water),
        preset="glossy",
        background="transparent",
        types={"C": {"color": "#5a6d80", "radius": 0.55}, "O": {"radius": 0.8}, "H": {"radius": 0.5}},
        view="x",
        size=(480, 480),
        spp=64,
        denoise="on",
    )
    picture.save(Path(__file__).with_suffix(".png"))


if __name__ == "__main__":
    main()
