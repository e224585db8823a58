"""Ten million grains from NumPy: dunes, colored by height, at a few samples per pixel.

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


def dunes(count: int) -> npt.NDArray[np.float32]:
    """Centers in layers of a triangular lattice below a surface of dunes, each moved a little."""
    # Twice as wide as deep, and a tenth as high at a mean; a sphere has 1 / sqrt(2) of the cube of its diameter.
    depth = float((count / np.sqrt(2) / 0.2) ** (1 / 3))
    rng = np.random.default_rng(7)
    layers = []
    for layer in range(int(0.2 * depth / np.sqrt(2 / 3)) + 1):
        z = layer * np.sqrt(2 / 3)
        rows, columns = np.meshgrid(
            np.arange(int(depth / np.sqrt(0.75))), np.arange(int(2 * depth)), indexing="ij", sparse=True
        )
        x = columns + rows % 2 / 2 + layer % 2 / 2
        y = (rows + layer % 2 / 3) * np.sqrt(0.75)
        u, v = x / depth * 2 * np.pi, y / depth * 2 * np.pi
        # Crests that wander, steep on one side.
        phase = 1.5 * u + 0.9 * np.sin(v + 0.4 * u) + 0.5 * np.sin(0.7 * u)
        surface = depth * (0.1 + 0.045 * np.sin(phase + 0.6 * np.sin(phase)) + 0.025 * np.sin(1.3 * v - 0.6 * u))
        inside = z < surface
        x, y = np.broadcast_arrays(x, y)
        layers.append(np.stack([x[inside], y[inside], np.full(np.count_nonzero(inside), z)], axis=1))
    centers = np.concatenate(layers).astype(np.float32)
    centers += rng.normal(0, 0.08 * RADIUS, centers.shape).astype(np.float32)
    return centers


def main() -> None:
    """Renders the dunes."""
    start = time.perf_counter()
    centers = dunes(int(float(sys.argv[1])) if len(sys.argv) > 1 else 10_000_000)
    made = time.perf_counter()
    low, high = centers.min(axis=0), centers.max(axis=0)
    middle, width = (low + high) / 2, float(high[0] - low[0])
    picture = spherule.render(
        centers,
        radius=RADIUS,
        values=centers[:, 2],
        label_of_values="height",
        color_map="viridis",
        color_bar="right",
        camera={
            "eye": [middle[0] - 0.35 * width, middle[1] - 0.85 * width, middle[2] + 0.5 * width],
            "target": [middle[0], middle[1], low[2]],
            "up": [0, 0, 1],
            "fov": 38,
        },
        light=[{"kind": "sun", "direction": [-0.9, -0.25, 0.45], "irradiance": 2.2}],
        environment={"color": 0.45},
        background="white",
        size=(960, 480),
        spp=8,
        denoise="on",
    )
    print(f"{len(centers):,} grains: made in {made - start:.1f} s, rendered in {time.perf_counter() - made:.1f} s")
    picture.save(Path(__file__).with_suffix(".png"))


if __name__ == "__main__":
    main()
