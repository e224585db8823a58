"""Rays per second, beside trimesh and embreex in one run.

    python rays.py [--rays 1000000] [--rounds 3] [--batch target/release/examples/batch]

Embree through Python traces triangles: each sphere becomes an icosphere of 80 or 320, inscribed in it, so its answers
are those of other shapes. All use the same threads: as many as each finds by itself. The best of the rounds counts,
which go in turn. `--batch` names the program of `crates/core/examples/batch.rs`, which takes its turn, too: the same
rays by the Rust library.
"""

from __future__ import annotations

import argparse
import subprocess
import tempfile
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


class Batch:
    """The Rust library: a program that traces the same rays whenever it is asked to."""

    def __init__(self, program: Path, spheres: tuple[Rows, Rows], rays: tuple[Rows, Rows]) -> None:
        self.folder = tempfile.TemporaryDirectory()
        stem = Path(self.folder.name) / "batch"
        for name, table in zip(("positions", "radius", "origins", "directions"), (*spheres, *rays)):
            table.T.astype("<f4").tofile(f"{stem}-{name}.f32")
        self.process = subprocess.Popen([program, stem], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)

    def run(self) -> tuple[float, int]:
        """Seconds and hits of a batch."""
        assert self.process.stdin and self.process.stdout
        self.process.stdin.write("\n")
        self.process.stdin.flush()
        seconds, hits = self.process.stdout.readline().split()
        return float(seconds), int(hits)

    def close(self) -> None:
        """Ends the program."""
        self.process.communicate()
        self.folder.cleanup()


def timed(call: Callable[[], Any]) -> float:
    """Seconds of a call."""
    start = time.perf_counter()
    call()
    return time.perf_counter() - start


def main() -> None:
    """Prints the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rays", type=int, default=1_000_000)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--batch", type=Path)
    options = parser.parse_args()
    names = ["rows", "columns", "embreex, 80", "embreex, 320", "trimesh, 80"] + ["Rust"] * bool(options.batch)
    print(f"| spheres | rays | {' | '.join(names)} |")
    print("|--:|---|" + "--:|" * len(names))
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
            calls: list[Callable[[], Any]] = [
                lambda: tree.intersect(origins, directions),
                lambda: tree.intersect(*columns),
                lambda: embree[0].run(origins, directions),
                lambda: embree[1].run(origins, directions),
                lambda: coarse.ray.intersects_first(origins, directions),
            ]
            runs: list[Callable[[], float]] = [lambda call=call: timed(call) for call in calls]  # type: ignore[misc]
            batch = Batch(options.batch, (positions, radius), (origins, directions)) if options.batch else None
            if batch:
                assert batch.run()[1] == tree.count(*columns), "both must find the same hits"
                runs.append(lambda: batch.run()[0])
            best = [float("inf")] * len(runs)
            for _ in range(options.rounds):
                for row, run in enumerate(runs):
                    best[row] = min(best[row], run())
            if batch:
                batch.close()
            cells = (f"{len(origins) / seconds / 1e6:.2f}" for seconds in best)
            print(f"| {count:,} | {kind} | " + " | ".join(cells) + " |", flush=True)


if __name__ == "__main__":
    main()
