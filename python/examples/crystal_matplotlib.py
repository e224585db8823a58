"""A crystal that is cut open, with a color bar, beside an axis of matplotlib with the same numbers.

Atoms are colored by their displacement around a vacancy. Run it with ASE and matplotlib installed; it writes
crystal_matplotlib.png.
"""

from pathlib import Path

import matplotlib

matplotlib.use("agg")

import matplotlib.pyplot as plt
import numpy as np
from ase.build import bulk  # type: ignore[import-untyped,unused-ignore]

import spherule


def main() -> None:
    """Draws the figure."""
    crystal = bulk("Cu", cubic=True) * (9, 9, 9)
    middle = crystal.get_center_of_mass()
    vacancy = int(np.argmin(np.linalg.norm(crystal.positions - middle, axis=1)))
    center = crystal.positions[vacancy].copy()
    del crystal[vacancy]
    offset = crystal.positions - center
    distance = np.linalg.norm(offset, axis=1)
    # Elastic relaxation toward the vacancy falls off with the square of the distance.
    displacement = 0.9 / distance**2
    crystal.positions -= offset / distance[:, None] * displacement[:, None]
    picture = spherule.render(
        spherule.from_ase(crystal),
        radius=1.28,
        values=displacement,
        label_of_values="displacement (angstrom)",
        color_map="plasma",
        color_log=True,
        color_bar="right",
        slices=[f"x > {center[0]:.3f}"],
        slice_mode="caps",
        view="iso",
        camera={"projection": "orthographic"},
        size=(560, 480),
        spp=48,
        denoise="on",
    )
    figure, (left, right) = plt.subplots(1, 2, figsize=(10, 4.2), width_ratios=[1.2, 1], layout="constrained")
    left.imshow(picture.srgb())
    left.set_axis_off()
    right.loglog(distance, displacement, ".", color="#6a00a8", markersize=4)
    right.set(xlabel="distance from the vacancy (angstrom)", ylabel="displacement (angstrom)")
    right.set_xticks([3, 5, 10, 20], ["3", "5", "10", "20"])
    right.minorticks_off()
    right.grid(alpha=0.3)
    figure.savefig(Path(__file__).with_suffix(".png"), dpi=100)


if __name__ == "__main__":
    main()
