#!/usr/bin/env python3
"""Holds Spherule's pictures against those of Mitsuba 3: the same scene files, the same camera, linear radiance.

    pip install mitsuba
    cargo build --release
    tools/references/compare.py                       # the scenes beside this file
    tools/references/compare.py --spp 1024 my.toml    # what maps one to one, or else it says what does not

Both render every scene several times with other seeds, so the spread of the pictures tells the errors of their means. For each scene
it prints the means, their difference in standard errors, and the mean over squares of 4 x 4 pixels of the squared difference by its
variance, which is 1 if no place differs, with how many standard errors it is off that; then the processor's time for a picture, its
relative mean squared error, and how many times as much time Mitsuba takes to the same error. It fails if anything differs by more than
five standard errors, or without noise by 1e-4 of the mean.

Mitsuba is fastest with a late LLVM, such as 19 (DRJIT_LIBLLVM_PATH says where it is); without, --variant scalar_rgb.
"""

import argparse
import math
import resource
import subprocess
import sys
import tempfile
import time
import tomllib
from pathlib import Path

import mitsuba as mi
import numpy as np

HERE = Path(__file__).resolve().parent
# Half the edge of what stands for an infinite plane, in the scene's unit. A camera should not see its horizon, which is too near; but
# of larger ones Mitsuba's single precision makes stripes.
PLANE = 1e4


class Unmapped(Exception):
    """Something that the two do not have in common."""


def main():
    options = arguments()
    mi.set_variant(options.variant)
    scenes = options.scenes or sorted((HERE / "scenes").glob("*.toml"))
    print("| scene | Spherule | Mitsuba | sigma | places, squared | ms : ms | error : error | time to equal error |")
    print("|---|--:|--:|--:|--:|--:|--:|--:|")
    worst = max([compare(path, options) for path in scenes], default=0.0)
    return 1 if worst > 5.0 else 0


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenes", nargs="*", type=Path)
    parser.add_argument("--spherule", type=Path, default=HERE.parents[1] / "target/release/spherule")
    parser.add_argument("--variant", default="llvm_ad_rgb", help="of Mitsuba")
    parser.add_argument("--sampler", default="multijitter", help="of Mitsuba")
    parser.add_argument("--spp", type=int, default=256, help="samples per pixel of each picture")
    parser.add_argument("--seeds", type=int, default=24, help="pictures of each")
    return parser.parse_args()


def compare(path, options):
    """Prints a row; returns the largest difference in standard errors."""
    scene = tomllib.loads(path.read_text())
    try:
        ours, theirs = spherule(path, options), mitsuba(scene, options)
    except Unmapped as why:
        print(f"| {path.stem} | not compared: {why} |")
        return 0.0
    count, freedom = options.seeds, 2 * options.seeds - 2
    means = [pictures.mean(axis=(1, 2, 3)) for pictures, _ in (ours, theirs)]
    scale = means[1].mean()
    spread = math.hypot(*[mean.std(ddof=1) / math.sqrt(count) for mean in means])
    sigma = (means[0].mean() - scale) / max(spread, 1e-7 * scale)
    blocks = [in_blocks(pictures) for pictures, _ in (ours, theirs)]
    error = sum(block.var(axis=0, ddof=1) for block in blocks) / count
    off = (blocks[0].mean(axis=0) - blocks[1].mean(axis=0)) ** 2
    # Where neither has any noise, single precision decides.
    noisy = error > (1e-5 * scale) ** 2
    silent = math.sqrt(off[~noisy].max(initial=0.0)) / scale
    # Student's: the errors are estimates too.
    squared = (off[noisy] / error[noisy]).mean() * (freedom - 2) / freedom
    places = (squared - 1.0) / math.sqrt(2.0 * (freedom - 1) / (freedom - 4) / noisy.sum())
    # As `spherule compare` has it: else the edges of lamps are all of the error.
    by = ((ours[0].mean(axis=0) + theirs[0].mean(axis=0)) / 2) ** 2 + 0.01
    squares = [(pictures.var(axis=0, ddof=1) / by).mean() for pictures, _ in (ours, theirs)]
    seconds = [seconds for _, seconds in (ours, theirs)]
    ratio = squares[1] * seconds[1] / max(squares[0] * seconds[0], 1e-30)
    print(
        f"| {path.stem} | {means[0].mean():.6f} | {means[1].mean():.6f} | {sigma:+.2f} | {squared:.3f} ({places:+.1f}) | "
        f"{seconds[0] * 1e3:.0f} : {seconds[1] * 1e3:.0f} | {squares[0]:.2e} : {squares[1]:.2e} | {ratio:.1f} |",
        flush=True,
    )
    return max(abs(sigma), places, 6.0 if silent > 1e-4 else 0.0)


def in_blocks(pictures):
    """Means over squares of 4 x 4 pixels and over channels: single pixels are less Gaussian."""
    count, height, width, channels = pictures.shape
    height, width = height // 4, width // 4
    whole = pictures[:, : 4 * height, : 4 * width]
    return whole.reshape(count, height, 4, width, 4, channels).mean(axis=(2, 4, 5))


def spherule(path, options):
    """Pictures of all seeds, and the processor's seconds for one, of all threads together."""
    pictures, seconds = [], []
    with tempfile.TemporaryDirectory() as folder:
        for seed in range(options.seeds):
            picture = Path(folder) / "picture.pfm"
            command = [options.spherule, "render", path, "--spp", options.spp, "--seed", seed, "--quiet", "-o", picture]
            before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
            subprocess.run(list(map(str, command)), check=True)
            seconds.append(resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before)
            pictures.append(np.array(mi.Bitmap(str(picture)).convert(mi.Bitmap.PixelFormat.RGB, mi.Struct.Type.Float32)))
    return np.array(pictures, dtype=np.float64), float(np.median(seconds))


def mitsuba(scene, options):
    """The same of Mitsuba, whose first picture takes compiling, and is not counted."""
    loaded = mi.load_dict(mapped(scene, options))
    pictures, seconds = [], []
    for seed in range(-1, options.seeds):
        start = time.process_time()
        picture = np.array(mi.render(loaded, spp=options.spp, seed=seed + 1))
        if seed >= 0:
            seconds.append(time.process_time() - start)
            pictures.append(picture)
    return np.array(pictures, dtype=np.float64), float(np.median(seconds))


def mapped(scene, options):
    """A scene as Mitsuba takes it."""
    render = scene.get("render", {})
    if render.get("integrator", "path") != "path":
        raise Unmapped("the integrator")
    if render.get("filter") != "box":
        raise Unmapped('the filter; say filter = "box"')
    depth = render.get("depth", "unlimited")
    made = {
        "type": "scene",
        "integrator": {"type": "path", "max_depth": -1 if depth == "unlimited" else depth + 1},
        "sensor": camera(scene["camera"], render["size"], options),
        **environment(scene.get("environment", {})),
    }
    for i, light in enumerate(scene.get("light", [])):
        made[f"light{i}"] = light_of(light)
    materials = scene.get("material", {})
    for i, sphere in enumerate(scene.get("sphere", [])):
        made[f"sphere{i}"] = {
            "type": "sphere",
            "center": sphere["center"],
            "radius": sphere["radius"],
            **surface(materials[sphere["material"]]),
        }
    if "ground" in scene:
        made["ground"] = plane(scene["ground"], materials)
    for name in ("generate", "file"):
        if name in scene:
            raise Unmapped(name)
    return made


def camera(told, size, options):
    if told.get("projection", "perspective") != "perspective" or "aperture" in told or "eye" not in told:
        raise Unmapped("the camera; it must be a pinhole with `eye` and `target`")
    transform = mi.ScalarTransform4f().look_at(origin=told["eye"], target=told["target"], up=told.get("up", [0, 1, 0]))
    return {
        "type": "perspective",
        "fov": told.get("fov", 40),
        "fov_axis": "y",
        "near_clip": 1e-3,
        "far_clip": 1e7,
        "to_world": transform,
        "sampler": {"type": options.sampler, "sample_count": options.spp},
        "film": {
            "type": "hdrfilm",
            "width": size[0],
            "height": size[1],
            "rfilter": {"type": "box"},
            "pixel_format": "rgb",
            "component_format": "float32",
        },
    }


def environment(told):
    if told.get("kind", "constant") != "constant" or not told.get("illuminates", True):
        raise Unmapped("the environment; it must be constant, and light the scene")
    color = rgb(told.get("color", 1))
    return {"environment": {"type": "constant", "radiance": color}} if any(color["value"]) else {}


def light_of(told):
    if told["kind"] == "sun" and told.get("angular_radius", 0) == 0:
        return {
            "type": "directional",
            "direction": [-x for x in told["direction"]],
            "irradiance": rgb(told["irradiance"]),
        }
    if told["kind"] == "point" and told.get("falloff", "square") == "square":
        return {"type": "point", "position": told["position"], "intensity": rgb(told["intensity"])}
    raise Unmapped("a light; they must be points or suns without extent")


def surface(told):
    kind = told["kind"]
    if kind == "lambertian":
        return {"bsdf": {"type": "diffuse", "reflectance": rgb(told.get("color", 1))}}
    if kind == "emitter":
        return {
            "emitter": {"type": "area", "radiance": rgb(told["radiance"])},
            "bsdf": {"type": "diffuse", "reflectance": rgb(told.get("albedo", 0))},
        }
    if kind == "conductor" and told.get("fresnel") == "constant" and told.get("roughness", 0) == 0:
        return {"bsdf": {"type": "conductor", "material": "none", "specular_reflectance": rgb(told.get("color", 1))}}
    if kind == "dielectric" and told.get("color", 1) == 1:
        return {"bsdf": {"type": "dielectric", "int_ior": float(told["ior"]), "ext_ior": 1.0}}
    if kind == "plastic":
        return {
            "bsdf": {
                "type": "plastic",
                "diffuse_reflectance": rgb(told.get("color", 1)),
                "int_ior": float(told.get("ior", 1.5)),
                "ext_ior": 1.0,
                "nonlinear": True,
            }
        }
    raise Unmapped(f"a material of kind {kind} with these parameters")


def plane(told, materials):
    normal = np.array(told.get("normal", [0, 1, 0]), dtype=float)
    normal /= np.linalg.norm(normal)
    middle = normal * told.get("height", 0)
    beside = [1, 0, 0] if abs(normal[0]) < 0.5 else [0, 0, 1]
    transform = mi.ScalarTransform4f().look_at(origin=list(middle), target=list(middle + normal), up=beside)
    bsdf = surface(materials[told["material"]])
    return {"type": "rectangle", "to_world": transform @ mi.ScalarTransform4f().scale([PLANE, PLANE, 1]), **bsdf}


def rgb(value):
    return {"type": "rgb", "value": [float(x) for x in value] if isinstance(value, list) else [float(value)] * 3}


if __name__ == "__main__":
    sys.exit(main())
