#!/usr/bin/env python3
"""Generates the large scenes of the comparison: a scene file, its spheres in CSV, and environment maps in PFM.

    tools/references/scenes.py                         # all scenes, into target/references
    tools/references/scenes.py --size 256 grains       # one scene, as a smaller image
    tools/references/scenes.py --seed 7 white-diffuse  # one scene with other random numbers

The same seed gives the same files.
"""

import argparse
import math
from pathlib import Path

import numpy as np

from scene_file import write_pfm

HERE = Path(__file__).resolve().parent
FOLDER = HERE.parents[1] / "target/references"

# Diffuse colors; each sphere has one of them, so that renderers need few materials.
PALETTE = [[0.75, 0.75, 0.75], [0.7, 0.3, 0.2], [0.25, 0.45, 0.65], [0.65, 0.6, 0.3], [0.3, 0.55, 0.3], [0.5, 0.3, 0.5]]
GROUND = {"kind": "lambertian", "color": [0.38, 0.36, 0.34]}
GLASS = {"kind": "dielectric", "ior": 1.5}
MIRROR = {"kind": "conductor", "fresnel": "constant", "color": 0.9}
# Aluminum, by its complex index of refraction.
METAL = {"kind": "conductor", "eta": [1.35, 0.97, 0.62], "k": [7.47, 6.4, 5.3]}
# Frames a field of 20 x 20 spheres from above, so that the horizon of the ground is not in the image.
FIELD_CAMERA = {"fov": 40, "eye": [0, 14, 19], "target": [0, 0, 0.5]}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenes", nargs="*", metavar="SCENE", help=", ".join(ALL))
    parser.add_argument("--folder", type=Path, default=FOLDER, help="output folder [default: target/references]")
    parser.add_argument("--seed", type=int, default=1, help="seed of the random numbers [default: 1]")
    parser.add_argument("--size", type=int, default=512, help="width and height in pixels [default: 512]")
    options = parser.parse_args()
    unknown = [name for name in options.scenes if name not in ALL]
    if unknown:
        parser.error(f"there is no scene {unknown[0]}; the scenes are {', '.join(ALL)}")
    for name in options.scenes or ALL:
        print(generate(name, options.folder, options.seed, options.size))


def paths(names, seed, size):
    """Returns scene files, after generating those that are given by name."""
    for name in names:
        yield generate(name, FOLDER, seed, size) if name in ALL else Path(name)


def generate(name, folder, seed, size=512):
    """Writes a scene and the files that it names; returns the path of the scene file."""
    folder.mkdir(parents=True, exist_ok=True)
    scene = ALL[name](np.random.default_rng(seed))
    sections = [("render", {"size": [size, size], "filter": "box"}), ("camera", scene["camera"])]
    environment = scene.get("environment", {"color": 0})
    if "picture" in scene:
        write_pfm(folder / f"{name}-environment.pfm", scene["picture"])
        environment = {"kind": "picture", "file": f"{name}-environment.pfm"}
    sections.append(("environment", environment))
    if "ground" in scene:
        sections += [("ground", {"material": "ground", "height": scene.get("height", 0)}), ("material.ground", scene["ground"])]
    sections += [("[light]", light) for light in scene.get("lights", [])]
    sections += [(f"material.{key}", material) for key, material in scene["materials"].items()]
    for center, radius, material in scene.get("lamps", []):
        sections.append(("[sphere]", {"center": center, "radius": radius, "material": material}))
    sections.append(("[file]", {"path": f"{name}.csv", "format": "csv"}))
    with open(folder / f"{name}.csv", "w") as file:
        file.write("x,y,z,radius,material\n")
        for (x, y, z, radius), material in zip(scene["spheres"].tolist(), scene["names"]):
            file.write(f"{x},{y},{z},{radius},{material}\n")
    path = folder / f"{name}.toml"
    lines = [f"# {ALL[name].__doc__.splitlines()[0]}"]
    for section, keys in sections:
        lines += [f"\n[{section}]", *(f"{key} = {value_text(value)}" for key, value in keys.items())]
    path.write_text("\n".join(lines) + "\n")
    return path


def value_text(value):
    """Returns a value of a scene file as TOML."""
    return f'"{value}"' if isinstance(value, str) else str(value)


def field(rng, columns, rows):
    """Returns x, y, z and radius of spheres on the plane y = 0, each in a unit square of its own."""
    count = columns * rows
    radius = rng.uniform(0.1, 0.45, count)
    column, row = np.arange(count) % columns, np.arange(count) // columns
    x = column - columns / 2 + radius + rng.random(count) * (1 - 2 * radius)
    z = row - rows / 2 + radius + rng.random(count) * (1 - 2 * radius)
    return np.stack([x, radius, z, radius], axis=1)


def shares(rng, count, parts):
    """Returns a material's name for each sphere, in exact shares and random order."""
    names = [name for name, share in parts for _ in range(round(share * count))]
    names = (names + [parts[-1][0]] * count)[:count]
    return [names[i] for i in rng.permutation(count)]


def painted(rng, names, kind, parameters=None):
    """Gives each sphere of a kind of material a color of the palette; returns the materials for these."""
    for i, name in enumerate(names):
        if name == kind:
            names[i] = f"{kind}-{rng.integers(len(PALETTE))}"
    return {f"{kind}-{i}": {"kind": "lambertian", "color": color, **(parameters or {})} for i, color in enumerate(PALETTE)}


def diffuse_field(rng, columns, rows):
    """Returns a field of diffuse spheres, and their materials."""
    names = ["diffuse"] * (columns * rows)
    spheres = field(rng, columns, rows)
    materials = painted(rng, names, "diffuse")
    return {"camera": FIELD_CAMERA, "spheres": spheres, "names": names, "materials": materials}


def latlong(width, radiance):
    """Returns an environment map of the radiance from each direction, given as columns and cosines to up."""
    height = width // 2
    cosine = np.cos((np.arange(height) + 0.5) / height * math.pi)
    return np.broadcast_to(radiance(cosine)[:, None, :], (height, width, 3)).copy()


def gradient(bottom, top):
    """Returns the radiance of a sky that is linear in the cosine of the angle to up."""
    return lambda cosine: np.outer((1 - cosine) / 2, bottom) + np.outer((1 + cosine) / 2, top)


def small_lamp(rng):
    """Glass, mirrors, plastic and diffuse spheres, 100 of each, on a ground under one small emissive sphere."""
    return four_materials(rng, 0.25, 3000)


def large_lamp(rng):
    """The spheres of small-lamp under a large emissive sphere, whose light paths find by chance, too."""
    return four_materials(rng, 2.5, 30)


def four_materials(rng, radius, radiance):
    """Returns spheres of four materials under an emissive sphere."""
    names = shares(rng, 400, [("glass", 0.25), ("mirror", 0.25), ("plastic", 0.25), ("diffuse", 0.25)])
    spheres = field(rng, 20, 20)
    materials = painted(rng, names, "diffuse") | painted(rng, names, "plastic", {"kind": "plastic", "ior": 1.5})
    return {
        "camera": FIELD_CAMERA,
        "spheres": spheres,
        "names": names,
        "ground": GROUND,
        "materials": {"glass": GLASS, "mirror": MIRROR, "lamp": {"kind": "emitter", "radiance": radiance}, **materials},
        "lamps": [([4, 15, 12], radius, "lamp")],
    }


def many_lamps(rng):
    """50 000 spheres at night: diffuse ones on a ground, and 200 emissive ones above them."""
    scene = diffuse_field(rng, 250, 200)
    for i in rng.choice(len(scene["names"]), 200, replace=False):
        scene["names"][i] = "lamp"
        scene["spheres"][i, 1] = rng.uniform(2, 4)
    scene["camera"] = {"fov": 40, "eye": [0, 90, 110], "target": [0, 0, 5]}
    scene["ground"] = GROUND
    scene["materials"]["lamp"] = {"kind": "emitter", "radiance": [300, 270, 225]}
    return scene


def picture_sky(rng):
    """400 diffuse spheres on a ground under an environment map, a sky whose sun is four pixels."""
    scene = diffuse_field(rng, 20, 20)
    sky = latlong(512, gradient([0.3, 0.28, 0.26], [0.2, 0.4, 0.8]))
    sky[70:72, 190:192] = [9000, 8400, 7200]
    return scene | {"ground": GROUND, "picture": sky}


def ground_lamp(rng):
    """400 diffuse spheres on a ground under one emissive sphere."""
    scene = diffuse_field(rng, 20, 20)
    scene["materials"]["lamp"] = {"kind": "emitter", "radiance": [75, 71, 64]}
    return scene | {"ground": GROUND, "lamps": [([12, 22, 12], 3, "lamp")]}


def default_field(rng):
    """The field of `spherule render`: plastic, metal and glass under a blue sky and a sun of 10 degrees.

    The camera has no lens and does not see the horizon, metal is smooth, and the sun is a distant emissive sphere.
    """
    names = shares(rng, 400, [("plastic", 0.68), ("metal", 0.2), ("glass", 0.12)])
    spheres = field(rng, 20, 20)
    materials = painted(rng, names, "plastic", {"kind": "plastic", "ior": 1.5})
    sine = math.sin(math.radians(10))
    radiance = [round(x / (math.pi * sine**2), 6) for x in (3.2, 2.75, 2.2)]
    direction = np.array([-0.7547319081399414, 0.5534700659692904, 0.3522082237986393])
    return {
        "camera": FIELD_CAMERA,
        "spheres": spheres,
        "names": names,
        "ground": GROUND,
        "picture": latlong(512, gradient([0.95, 0.9, 0.85], [0.05, 0.22, 0.7])),
        "materials": {"metal": METAL, "glass": GLASS, "sun": {"kind": "emitter", "radiance": radiance}, **materials},
        "lamps": [((1000 * direction).round(6).tolist(), round(1000 * sine, 6), "sun")],
    }


def white_diffuse(rng):
    """400 diffuse spheres under a white sky."""
    return diffuse_field(rng, 20, 20) | {"environment": {"color": 1}}


def white_thirds(rng):
    """Mirrors, glass and diffuse spheres, a third of 400 each, under a white sky."""
    names = shares(rng, 400, [("mirror", 1 / 3), ("glass", 1 / 3), ("diffuse", 1 / 3)])
    spheres = field(rng, 20, 20)
    materials = painted(rng, names, "diffuse")
    return {
        "camera": FIELD_CAMERA,
        "spheres": spheres,
        "names": names,
        "environment": {"color": 1},
        "materials": {"mirror": MIRROR, "glass": GLASS, **materials},
    }


def white_volume(rng):
    """10 000 diffuse spheres in a cube under a white sky."""
    count = 10_000
    edge = count ** (1 / 3)
    names = ["diffuse"] * count
    spheres = np.column_stack([rng.uniform(-edge / 2, edge / 2, (count, 3)), rng.uniform(0.2, 0.4, count)])
    return {
        "camera": {"fov": 40, "eye": [26, 18, 40], "target": [0, 0, 0]},
        "spheres": spheres,
        "names": names,
        "environment": {"color": 1},
        "materials": painted(rng, names, "diffuse"),
    }


def protein(rng):
    """4000 overlapping diffuse spheres, like the atoms of a protein, on a ground under a white sky."""
    count, spacing = 4000, 1.9
    cells = (np.indices((40, 40, 40)).reshape(3, -1).T - 19.5) * spacing
    places = cells + rng.uniform(-0.35, 0.35, cells.shape) * spacing
    # Lumps of about 15 units.
    lumps = np.sin(places[:, 0] / 5 + 1) + np.sin(places[:, 1] / 4) + np.sin(places[:, 2] / 4.5 + 2)
    order = np.argsort(np.linalg.norm(places * [0.8, 1.05, 1], axis=1) - 2.5 * lumps)
    centers = places[order[:count]]
    # Carbon, nitrogen, oxygen and sulfur: share, van der Waals radius and color.
    elements = {
        "carbon": (0.63, 1.7, [0.28, 0.28, 0.28]),
        "nitrogen": (0.17, 1.55, [0.03, 0.08, 0.75]),
        "oxygen": (0.19, 1.52, [0.8, 0.01, 0.01]),
        "sulfur": (0.01, 1.8, [0.8, 0.62, 0.03]),
    }
    names = shares(rng, count, [(name, share) for name, (share, _, _) in elements.items()])
    radii = np.array([elements[name][1] for name in names])
    return {
        "camera": {"fov": 30, "eye": [45, 50, 110], "target": [0, -4, 0]},
        "spheres": np.column_stack([centers, radii]),
        "names": names,
        "environment": {"color": 1},
        "ground": GROUND,
        "height": float((centers[:, 1] - radii).min()),
        "materials": {name: {"kind": "lambertian", "color": color} for name, (_, _, color) in elements.items()},
    }


def grains(rng):
    """3000 diffuse grains with lognormal radii, dropped on a ground, under a sky and a sun of 30 degrees."""
    count, edge = 3000, 24
    radii = np.clip(rng.lognormal(math.log(0.3), 0.35, count), 0.12, 0.9)
    spheres = np.empty((count, 4))
    for i, radius in enumerate(radii):
        # The lowest of some places, each on what lies there.
        places = rng.uniform(-edge / 2, edge / 2, (12, 2))
        x, y, z, r = spheres[:i].T
        sums = radius + r
        gaps = sums**2 - (places[:, :1] - x) ** 2 - (places[:, 1:] - z) ** 2
        heights = np.max(np.where(gaps > 0, y + np.sqrt(np.maximum(gaps, 0)), radius), axis=1, initial=radius)
        lowest = np.argmin(heights)
        spheres[i] = places[lowest, 0], heights[lowest], places[lowest, 1], radius
    colors = [[0.62, 0.5, 0.33], [0.45, 0.33, 0.2], [0.7, 0.65, 0.55], [0.35, 0.32, 0.3]]
    names = shares(rng, count, [(f"grain-{i}", 0.25) for i in range(len(colors))])
    return {
        "camera": {"fov": 40, "eye": [6, 15, 17], "target": [0, 0.5, 0.5]},
        "spheres": spheres,
        "names": names,
        "environment": {"color": 0.5},
        "ground": GROUND,
        "lights": [{"kind": "sun", "direction": [-0.6, 1.4, 0.5], "irradiance": 1.91, "angular_radius": 30}],
        "materials": {f"grain-{i}": {"kind": "lambertian", "color": color} for i, color in enumerate(colors)},
    }


def crystal(_rng):
    """A crystal of 2744 diffuse spheres of two kinds, like rock salt, under an overcast sky."""
    edge = 14
    cells = np.indices((edge, edge, edge)).reshape(3, -1).T
    large = cells.sum(axis=1) % 2 == 0
    radii = np.where(large, 0.59, 0.4)
    return {
        "camera": {"fov": 33, "eye": [17, 15, 30], "target": [0, -0.5, 0]},
        "spheres": np.column_stack([cells - (edge - 1) / 2, radii]),
        "names": ["chlorine" if is_large else "sodium" for is_large in large],
        "picture": latlong(512, gradient([0.1] * 3, [1.25] * 3)),
        "materials": {
            "chlorine": {"kind": "lambertian", "color": [0.1, 0.7, 0.1]},
            "sodium": {"kind": "lambertian", "color": [0.33, 0.13, 0.71]},
        },
    }


# Those for which Spherule is compared with Mitsuba.
SCENES = {
    "white-diffuse": white_diffuse,
    "white-thirds": white_thirds,
    "white-volume": white_volume,
    "ground-lamp": ground_lamp,
    "many-lamps": many_lamps,
    "small-lamp": small_lamp,
    "large-lamp": large_lamp,
    "picture-sky": picture_sky,
    "default-field": default_field,
}
# Particles in looks like those of the program's presets.
PARTICLES = {"protein": protein, "grains": grains, "crystal": crystal}
ALL = SCENES | PARTICLES
# Those whose long renders converge: caustics of lamps take too many samples.
CONVERGING = [name for name in ALL if name not in ("small-lamp", "large-lamp")]


if __name__ == "__main__":
    main()
