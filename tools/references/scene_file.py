"""Shared by all renderers: options, scene files of Spherule, as far as they can represent them exactly, and PFM images."""

import argparse
import csv
import functools
import hashlib
import struct
import tomllib
import zlib
from dataclasses import dataclass
from pathlib import Path

import numpy as np


class Unsupported(Exception):
    """A feature of a scene that the other renderer does not share."""


@dataclass
class Spheres:
    """The spheres of one material."""

    centers: np.ndarray
    radii: np.ndarray


@dataclass
class Scene:
    """A scene file, with its spheres grouped by material and its environment map read."""

    table: dict
    spheres: dict[str, Spheres]
    picture: np.ndarray | None

    @property
    def size(self):
        return self.table["render"]["size"]

    @property
    def materials(self):
        return self.table.get("material", {})

    @property
    def sky(self):
        """The radiance of a constant environment: white by default, but black if there are lights."""
        lit = "light" in self.table or any(material["kind"] == "emitter" for material in self.materials.values())
        return rgb(self.table.get("environment", {"color": 0 if lit else 1}).get("color", 1))

    def count(self):
        return sum(len(group.radii) for group in self.spheres.values())


def render_arguments(description):
    """Returns a parser of the options of a program that renders a scene file."""
    parser = argparse.ArgumentParser(description=description, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scene", type=Path)
    parser.add_argument("--folder", type=Path, required=True, help="output folder")
    parser.add_argument("--spp", type=int, default=16, help="samples per pixel [default: 16]")
    parser.add_argument("--seeds", type=int, nargs="+", default=[0], help="seed of each image [default: 0]")
    parser.add_argument("--threads", type=int, default=2, help="number of threads [default: 2]")
    return parser


def read_scene(path):
    """Reads a scene file and the files that it names."""
    table = tomllib.loads(path.read_text())
    check(table)
    rows = [(s["material"], *s["center"], s["radius"]) for s in table.get("sphere", [])]
    for file in table.get("file", []):
        with open(path.parent / file["path"], newline="") as lines:
            for row in csv.DictReader(lines):
                rows.append((row["material"], *(float(row[key]) for key in ("x", "y", "z", "radius"))))
    groups = {}
    for material, *numbers in rows:
        groups.setdefault(material, []).append(numbers)
    spheres = {}
    for material, numbers in groups.items():
        numbers = np.array(numbers)
        spheres[material] = Spheres(numbers[:, :3], numbers[:, 3])
    environment = table.get("environment", {})
    picture = None
    if environment.get("kind") == "picture":
        picture = read_pfm(path.parent / environment["file"]) * environment.get("scale", 1.0)
    return Scene(table, spheres, picture)


def check(table):
    """Raises `Unsupported` for features that no other renderer here shares."""
    render, camera, environment = table["render"], table["camera"], table.get("environment", {})
    if render.get("integrator", "path") != "path":
        raise Unsupported('the integrator must be "path"')
    if render.get("filter") != "box":
        raise Unsupported('the filter must be "box"')
    if camera.get("projection", "perspective") != "perspective" or "aperture" in camera or "eye" not in camera:
        raise Unsupported("the camera must be a pinhole with `eye` and `target`")
    if environment.get("kind", "constant") == "gradient" or not environment.get("illuminates", True):
        raise Unsupported("the environment must be constant or a picture, and illuminate the scene")
    if environment.get("rotation", 0) or environment.get("up", [0, 1, 0]) != [0, 1, 0]:
        raise Unsupported("an environment map must not be rotated")
    for section in ("generate", "slice", "look"):
        if section in table:
            raise Unsupported(f"the section `{section}`")


def fingerprint(path):
    """Returns a hash of a scene file and of all files that it names."""
    table = tomllib.loads(path.read_text())
    named = [file["path"] for file in table.get("file", [])]
    if "file" in table.get("environment", {}):
        named.append(table["environment"]["file"])
    contents = [path.read_bytes(), *((path.parent / name).read_bytes() for name in named)]
    return hashlib.blake2b(b"".join(hashlib.blake2b(content).digest() for content in contents), digest_size=8).hexdigest()


@functools.lru_cache
def internal_reflectance(ior):
    """Returns the reflectance of a dielectric for diffuse light from inside, by the midpoint rule."""
    cosine = (np.arange(1_000_000) + 0.5) / 1_000_000
    outside = np.sqrt(np.maximum(1 - (1 - cosine**2) * ior**2, 0))
    parallel = (cosine - ior * outside) / (cosine + ior * outside)
    perpendicular = (ior * cosine - outside) / (ior * cosine + outside)
    return float(np.mean((parallel**2 + perpendicular**2) * cosine))


def rgb(value):
    """Returns a color of a scene file as three numbers."""
    return [float(x) for x in value] if isinstance(value, list) else [float(value)] * 3


def read_pfm(path):
    """Returns a color image in PFM, its first row at the top."""
    with open(path, "rb") as file:
        if file.readline().strip() != b"PF":
            raise Unsupported(f"{path.name} is not a color image in PFM")
        width, height = map(int, file.readline().split())
        order = "<f4" if float(file.readline()) < 0 else ">f4"
        values = np.frombuffer(file.read(), dtype=order)
    return values.reshape(height, width, 3)[::-1].astype(np.float64)


def write_pfm(path: Path, image):
    """Writes a color image in PFM."""
    height, width, _ = image.shape
    with open(path, "wb") as file:
        file.write(f"PF\n{width} {height}\n-1.0\n".encode())
        file.write(np.ascontiguousarray(image[::-1], dtype="<f4").tobytes())


def write_png(path: Path, image):
    """Writes an image of numbers from 0 to 1, as they are, in PNG with 8 bits."""
    height, width, _ = image.shape
    rows = np.round(np.clip(image, 0, 1) * 255).astype(np.uint8).reshape(height, width * 3)
    # A byte before each row says that it is not filtered.
    data = np.hstack([np.zeros((height, 1), np.uint8), rows]).tobytes()
    header = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    with open(path, "wb") as file:
        file.write(b"\x89PNG\r\n\x1a\n")
        for kind, content in ((b"IHDR", header), (b"IDAT", zlib.compress(data)), (b"IEND", b"")):
            file.write(struct.pack(">I", len(content)) + kind + content + struct.pack(">I", zlib.crc32(kind + content)))
