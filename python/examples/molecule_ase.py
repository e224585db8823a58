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
        radius="covalent",
        preset="glossy",
        background="transparent",
        types={"C": {"color": "#404040"}},
        size=(480, 480),
        spp=64,
        denoise="on",
    )
    picture.save(Path(__file__).with_suffix(".png"))


if __name__ == "__main__":
    main()
