"""A trajectory from MDAnalysis: a cluster of argon that is heated until it evaporates, four frames side by side.

The trajectory is made here, by Langevin dynamics of a Lennard-Jones cluster, and read through a Universe in memory. Run
it with MDAnalysis installed; it writes trajectory_mdanalysis.png.
"""

from pathlib import Path

import MDAnalysis  # type: ignore[import-untyped,unused-ignore]
import numpy as np
import numpy.typing as npt
from MDAnalysis.coordinates.memory import MemoryReader  # type: ignore[import-untyped,unused-ignore]

import spherule

#: Lennard-Jones parameters of argon: angstrom, and the unit of energy.
SIGMA = 3.4


def dynamics(frames: int = 40, every: int = 50) -> npt.NDArray[np.float32]:
    """Positions of 108 atoms in reduced units, frame by frame, while the temperature rises."""
    rng = np.random.default_rng(5)
    grid = np.array([(x, y, z) for x in range(6) for y in range(6) for z in range(6) if (x + y + z) % 2 == 0], float)
    x = grid * 2 ** (1 / 6) / np.sqrt(2)
    v, step, saved = np.zeros_like(x), 0.004, []
    for frame in range(frames):
        saved.append(x.astype(np.float32))
        temperature = 0.1 + 1.4 * frame / frames
        for _ in range(every):
            apart = x[:, None] - x[None]
            squared = (apart**2).sum(axis=2)
            np.fill_diagonal(squared, np.inf)
            inverse = 1 / np.maximum(squared, 0.6)
            force = (24 * (2 * inverse**7 - inverse**4)[:, :, None] * apart).sum(axis=1)
            noise = rng.normal(size=x.shape) * np.sqrt(2 * temperature * step)
            v += step * (force - v) + noise
            x += step * v
    return np.array(saved) * np.float32(SIGMA)


def main() -> None:
    """Renders four frames from one camera."""
    positions = dynamics()
    universe = MDAnalysis.Universe.empty(positions.shape[1], trajectory=True)
    universe.add_TopologyAttr("elements", ["Ar"] * positions.shape[1])
    universe.load_new(positions, format=MemoryReader)
    middle = [float(value) for value in positions[0].mean(axis=0)]
    row = []
    for _ in universe.trajectory[:: len(positions) // 4]:
        particles = spherule.from_mdanalysis(universe)
        picture = spherule.render(
            particles,
            radius=SIGMA / 2,
            # How far each atom is from the middle, in diameters.
            values=np.linalg.norm(universe.atoms.positions - middle, axis=1) / SIGMA,
            color_map="turbo",
            color_range=(0, 5),
            camera={"eye": [middle[0] + 40, middle[1] + 30, middle[2] + 90], "target": middle, "fov": 20},
            label=[{"text": f"frame {particles.step}", "position": "bottom"}],
            size=(250, 270),
            spp=32,
            denoise="on",
        )
        row.append(picture.srgb())
    strip = np.hstack(row)
    linear = np.where(strip <= 10, strip / 255 / 12.92, ((strip / 255 + 0.055) / 1.055) ** 2.4)
    picture.pixels = linear.astype(np.float32)
    picture.save(Path(__file__).with_suffix(".png"))


if __name__ == "__main__":
    main()
