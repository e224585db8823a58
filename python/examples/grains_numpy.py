"""Ten million grains from NumPy: a heap, colored by height, at a few samples per pixel.

    python grains_numpy.py [COUNT]

It writes grains_numpy.png and says how long each step took.
"""

import sys
import time
from pathlib import Path

import numpy as np
import numpy.typing as npt

import spherule

RADIUS = 0.5


def heap(count: int) -> npt.NDArray[np.float32]:
    """Centers in layers of a triangular lattice under a cone, each moved a little."""
    slope = 0.55
    # A cone of this slope with as many cells of the lattice, whose packing is 0.74, and some more for its steps.
    volume = 1.01 * count * 4 / 3 * np.pi * RADIUS**3 / 0.74
    base = float((3 * volume / (np.pi * slope)) ** (1 / 3))
    rng = np.random.default_rng(7)
    layers = []
    height = np.sqrt(2 / 3) * 2 * RADIUS
    for layer in range(int(base * slope / height)):
        z = layer * height
        reach = base - z / slope
        most = int(reach / RADIUS / np.sqrt(3)) + 2
        steps = np.arange(-most, most + 1, dtype=np.float32)
        rows, columns = np.meshgrid(steps, steps, indexing="ij")
        x = (columns + rows % 2 / 2 + layer % 2 / 2) * 2 * RADIUS
        y = (rows + layer % 2 / 3) * np.sqrt(3) * RADIUS
        inside = x**2 + y**2 < reach**2
        layers.append(np.stack([x[inside], y[inside], np.full(np.count_nonzero(inside), z)], axis=1))
    centers = np.concatenate(layers).astype(np.float32)
    centers += rng.normal(0, 0.08 * RADIUS, centers.shape).astype(np.float32)
    return centers


def main() -> None:
    """Renders the heap."""
    start = time.perf_counter()
    centers = heap(int(float(sys.argv[1])) if len(sys.argv) > 1 else 10_000_000)
    made = time.perf_counter()
    picture = spherule.render(
        centers,
        radius=RADIUS,
        values=centers[:, 2],
        label_of_values="height",
        color_map="viridis",
        color_bar="right",
        preset="studio",
        up="z",
        size=(640, 360),
        spp=8,
        denoise="on",
    )
    print(f"{len(centers):,} grains: made in {made - start:.1f} s, rendered in {time.perf_counter() - made:.1f} s")
    picture.save(Path(__file__).with_suffix(".png"))


if __name__ == "__main__":
    main()
