"""Rays per second, beside trimesh and embreex in one run.

    python rays.py [--rays 1000000] [--rounds 3] [--dump FOLDER]

Embree through Python traces triangles: each sphere becomes an icosphere of 80 or 320, inscribed in it, so its answers
are those of other shapes. All use the same threads: as many as each finds by itself. The best of the rounds counts,
which go in turn. `--dump` writes spheres and rays as raw float32, for a program in another language.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import trimesh
from embreex import rtcore_scene  # type: ignore[import-untyped]
from embreex.mesh_construction import TriangleMesh  # type: ignore[import-untyped]

import spherule

Rows = npt.NDArray[np.float32]


def scene(count: int) -> tuple[Rows, Rows]:
    """Random spheres in a unit cube, which fill some tenth of it."""
    rng = np.random.default_rng(1)
    radius = rng.uniform(0.2, 0.4, count) * count ** (-1 / 3)
    return rng.random((count, 3), dtype=np.float32), radius.astype(np.float32)


def rays(kind: str, count: int) -> tuple[Rows, Rows]:
    """Rays of a camera by pixels, or from random points in random directions."""
    rng = np.random.default_rng(2)
    if kind == "camera":
        side = int(np.sqrt(count))
        v, u = np.meshgrid(np.linspace(-0.3, 0.3, side), np.linspace(-0.3, 0.3, side), indexing="ij")
        directions = np.stack([u.ravel(), v.ravel(), np.full(side * side, -1.0)], axis=1)
        origins = np.broadcast_to([0.5, 0.5, 2.5], directions.shape)
    else:
        origins, directions = rng.random((count, 3)), rng.normal(size=(count, 3))
    return np.ascontiguousarray(origins, np.float32), np.ascontiguousarray(directions, np.float32)


def mesh(positions: Rows, radius: Rows, subdivisions: int) -> trimesh.Trimesh:
    """An icosphere for each sphere."""
    one = trimesh.creation.icosphere(subdivisions)
    vertices = positions[:, None] + radius[:, None, None] * one.vertices[None]
    faces = one.faces[None] + (np.arange(len(positions)) * len(one.vertices))[:, None, None]
    return trimesh.Trimesh(vertices.reshape(-1, 3), faces.reshape(-1, 3), process=False)


def main() -> None:
    """Prints the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rays", type=int, default=1_000_000)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--dump", type=Path)
    options = parser.parse_args()
    print("| spheres | rays | spherule, rows | spherule, columns | embreex, 80 | embreex, 320 | trimesh, 80 |")
    print("|--:|---|--:|--:|--:|--:|--:|")
    for count in (1_000, 10_000):
        positions, radius = scene(count)
        tree = spherule.SphereTree(positions, radius)
        coarse, fine = (mesh(positions, radius, subdivisions) for subdivisions in (1, 2))
        embree = []
        for model in (coarse, fine):
            embree.append(rtcore_scene.EmbreeScene())
            TriangleMesh(embree[-1], model.vertices[model.faces].astype(np.float32))
        for kind in ("camera", "random"):
            origins, directions = rays(kind, options.rays)
            columns = np.asfortranarray(origins), np.asfortranarray(directions)
            if options.dump:
                for name, table in (("origins", origins), ("directions", directions), ("positions", positions)):
                    table.T.astype("<f4").tofile(options.dump / f"{count}-{kind}-{name}.f32")
                radius.astype("<f4").tofile(options.dump / f"{count}-{kind}-radius.f32")
            runs: list[Callable[[], Any]] = [
                lambda: tree.intersect(origins, directions),
                lambda: tree.intersect(*columns),
                lambda: embree[0].run(origins, directions),
                lambda: embree[1].run(origins, directions),
                lambda: coarse.ray.intersects_first(origins, directions),
            ]
            best = [float("inf")] * len(runs)
            for _ in range(options.rounds):
                for row, run in enumerate(runs):
                    start = time.perf_counter()
                    run()
                    best[row] = min(best[row], time.perf_counter() - start)
            cells = (f"{len(origins) / seconds / 1e6:.2f}" for seconds in best)
            print(f"| {count:,} | {kind} | " + " | ".join(cells) + " |", flush=True)


if __name__ == "__main__":
    main()
