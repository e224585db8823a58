#!/usr/bin/env python3
"""Writes a trajectory of any length, for `frames.mjs`: atoms at random places in a cube, which move a little.

tools/viewer/trajectory.py run.dcd ATOMS FRAMES     (or .lammpstrj, .xyz, or .xtc of at most 9 atoms, which are not compressed)
"""

import pathlib
import struct
import sys

import numpy as np

path, atoms, frames = pathlib.Path(sys.argv[1]), int(sys.argv[2]), int(sys.argv[3])
edge = (10 * atoms) ** (1 / 3)
random = np.random.default_rng(1)
places, steps = edge * random.random((atoms, 3)), random.normal(0, 0.05, (atoms, 3))


def record(content: bytes) -> bytes:
    """A record of Fortran."""
    return struct.pack("<i", len(content)) + content + struct.pack("<i", len(content))


def dcd(number: int) -> bytes:
    words = [frames, 0, 1, *7 * [0], 1, *8 * [0], 24]
    head = [b"CORD" + struct.pack("<20i", *words), struct.pack("<i", 1) + 80 * b" ", struct.pack("<i", atoms)]
    own = [struct.pack("<6d", edge, 90, edge, 90, 90, edge), *(column.astype("<f4").tobytes() for column in places.T)]
    return b"".join(map(record, own if number else head + own))


def xtc(number: int) -> bytes:
    assert atoms <= 9
    cell = struct.pack(">9f", edge, 0, 0, 0, edge, 0, 0, 0, edge)
    return struct.pack(">iiif", 1995, atoms, number, number) + cell + struct.pack(">i", atoms) + places.astype(">f4").tobytes()


def lammpstrj(number: int) -> bytes:
    bounds = 3 * f"0 {edge}\n"
    head = f"ITEM: TIMESTEP\n{number}\nITEM: NUMBER OF ATOMS\n{atoms}\nITEM: BOX BOUNDS pp pp pp\n{bounds}ITEM: ATOMS id type x y z\n"
    return (head + "".join(f"{row + 1} {row % 2 + 1} {x:.4f} {y:.4f} {z:.4f}\n" for row, (x, y, z) in enumerate(places))).encode()


def xyz(number: int) -> bytes:
    return (f"{atoms}\n{number}\n" + "".join(f"Ar {x:.4f} {y:.4f} {z:.4f}\n" for x, y, z in places)).encode()


write = {".dcd": dcd, ".xtc": xtc, ".lammpstrj": lammpstrj, ".xyz": xyz}[path.suffix]
with path.open("wb") as file:
    for number in range(frames):
        file.write(write(number))
        places += steps
