#!/usr/bin/env python3
"""Renders a scene file of Spherule with Mitsuba 3, once per seed, and prints the times as lines of JSON.

Images are written to --folder as SEED.pfm. An image's times are those of `mi.render` and of copying its result; with --warm-up, an
image that is neither written nor counted is rendered first, so that the times contain no compilation.
"""

import json
import math
import sys
import time

import drjit as dr
import mitsuba as mi
import numpy as np

from scene_file import Unsupported, internal_reflectance, read_scene, render_arguments, rgb, write_pfm

# Half the edge of the square that represents the ground, in the scene's unit. On larger ones, the single precision of Mitsuba makes
# stripes. The camera should not see its edge, which is nearer than the horizon.
GROUND = 1e4
# Distance of suns, in the scene's unit.
SUN = 1e6
# Most samples of an image that are rendered at once.
MOST_SAMPLES = 2**25
# Difference of the seeds of an image's passes.
PASS = 2**16


def main():
    parser = render_arguments(__doc__)
    parser.add_argument("--variant", default="llvm_ad_rgb", help="variant of Mitsuba [default: llvm_ad_rgb]")
    parser.add_argument("--sampler", default="multijitter", help="sampler of Mitsuba [default: multijitter]")
    parser.add_argument("--shapes", choices=["sphere", "ellipsoids"], default="sphere", help="shapes of opaque spheres")
    parser.add_argument("--warm-up", action="store_true", help="render an image that does not count first")
    options = parser.parse_args()
    mi.set_variant(options.variant)
    mi.set_log_level(mi.LogLevel.Error)
    dr.set_thread_count(options.threads)
    try:
        scene = mi.load_dict(scene_dict(read_scene(options.scene), options))
    except Unsupported as error:
        sys.exit(f"Mitsuba cannot represent {options.scene.name}: {error}")
    if options.warm_up:
        render(scene, options.spp, 2**31)
    for seed in options.seeds:
        before, start = time.process_time(), time.perf_counter()
        image = render(scene, options.spp, seed)
        wall, cpu = time.perf_counter() - start, time.process_time() - before
        write_pfm(options.folder / f"{seed}.pfm", image)
        print(json.dumps({"seed": seed, "cpu": cpu, "wall": wall, "written": time.time()}), flush=True)


def render(scene, spp, seed):
    """Returns an image: the mean of passes, where all samples at once would take too much memory."""
    width, height = scene.sensors()[0].film().size()
    most = max(MOST_SAMPLES // (width * height), 1)
    passes = -(-spp // most)
    images = (np.array(mi.render(scene, spp=-(-spp // passes), seed=seed + PASS * i)) for i in range(passes))
    return sum(images) / passes


def scene_dict(scene, options):
    """Returns a scene as a dictionary for `mi.load_dict`."""
    depth = scene.table["render"].get("depth", "unlimited")
    result = {
        "type": "scene",
        "integrator": {"type": "path", "max_depth": -1 if depth == "unlimited" else depth + 1},
        "sensor": sensor(scene, options),
        **environment(scene),
    }
    for i, light in enumerate(scene.table.get("light", [])):
        result[f"light-{i}"] = emitter(light, scene)
    bsdfs = {name: bsdf(material) for name, material in scene.materials.items() if material["kind"] != "emitter"}
    for name, plugin in bsdfs.items():
        result[f"material-{name}"] = {**plugin, "id": f"material-{name}"}
    for name, spheres in scene.spheres.items():
        material = scene.materials[name]
        # Rays inside ellipsoids do not hit them, and ellipsoids do not emit.
        opaque = material["kind"] not in ("dielectric", "emitter")
        if options.shapes == "ellipsoids" and opaque and len(spheres.radii) > 1:
            result[f"spheres-{name}"] = {**ellipsoids(spheres), **surface(name, material)}
            continue
        for i, (center, radius) in enumerate(zip(spheres.centers.tolist(), spheres.radii.tolist())):
            result[f"sphere-{name}-{i}"] = {"type": "sphere", "center": center, "radius": radius, **surface(name, material)}
    if "ground" in scene.table:
        result["ground"] = ground(scene)
    return result


def sensor(scene, options):
    """Returns the camera, its film and its sampler."""
    camera, (width, height) = scene.table["camera"], scene.size
    return {
        "type": "perspective",
        "fov": camera.get("fov", 40),
        "fov_axis": "y",
        "near_clip": 1e-3,
        "far_clip": 1e7,
        "to_world": mi.ScalarTransform4f().look_at(
            origin=camera["eye"], target=camera["target"], up=camera.get("up", [0, 1, 0])
        ),
        "sampler": {"type": options.sampler, "sample_count": options.spp},
        "film": {
            "type": "hdrfilm",
            "width": width,
            "height": height,
            "rfilter": {"type": "box"},
            "pixel_format": "rgb",
            "component_format": "float32",
        },
    }


def environment(scene):
    """Returns the environment, unless it is black."""
    if scene.picture is not None:
        picture = at_poles(scene.picture).astype(np.float32)
        turn = mi.ScalarTransform4f().rotate([0, 1, 0], -90)
        return {"environment": {"type": "envmap", "bitmap": mi.Bitmap(picture), "to_world": turn}}
    return {"environment": {"type": "constant", "radiance": spectrum(scene.sky)}} if any(scene.sky) else {}


def at_poles(picture):
    """Returns the same radiance for a renderer whose first and last rows lie on the poles.

    Spherule's rows lie half a pixel from the poles, and between rows radiance is linear. So the same function has its old rows, the
    mean of each pair of neighbors between them, and the outer rows once more at the poles.
    """
    height = len(picture)
    result = np.empty((2 * height + 1, *picture.shape[1:]))
    result[1::2] = picture
    result[2:-1:2] = (picture[1:] + picture[:-1]) / 2
    result[0], result[-1] = picture[0], picture[-1]
    return result


def emitter(light, scene):
    """Returns a light that is not a sphere."""
    if light["kind"] == "sun":
        sine = math.sin(math.radians(light.get("angular_radius", 0.27)))
        if sine and scene.picture is not None:
            raise Unsupported("a sun with extent before an environment map, which it would hide")
        if sine:
            direction = np.array(light["direction"]) / math.hypot(*light["direction"])
            # A sphere hides the sky behind it.
            radiance = [x / (math.pi * sine**2) + sky for x, sky in zip(rgb(light["irradiance"]), scene.sky)]
            sun = {"type": "area", "radiance": spectrum(radiance)}
            return {"type": "sphere", "center": (SUN * direction).tolist(), "radius": SUN * sine, "emitter": sun}
        return {
            "type": "directional",
            "direction": [-x for x in light["direction"]],
            "irradiance": spectrum(light["irradiance"]),
        }
    if light["kind"] == "point" and light.get("falloff", "square") == "square":
        return {"type": "point", "position": light["position"], "intensity": spectrum(light["intensity"])}
    raise Unsupported("points of light without falloff")


def surface(name, material):
    """Returns what a shape has beside its geometry: its emitter, and its BSDF or a reference to it."""
    if material["kind"] == "emitter":
        return {
            "emitter": {"type": "area", "radiance": spectrum(material["radiance"])},
            "bsdf": {"type": "diffuse", "reflectance": spectrum(material.get("albedo", 0))},
        }
    return {"bsdf": {"type": "ref", "id": f"material-{name}"}}


def bsdf(material):
    """Returns the BSDF of a material."""
    kind, color = material["kind"], rgb(material.get("color", 1 if material["kind"] == "dielectric" else 0.7))
    if kind == "lambertian":
        return {"type": "diffuse", "reflectance": spectrum(color)}
    if kind == "conductor" and material.get("roughness", 0) == 0:
        if "eta" in material:
            return {"type": "conductor", "eta": spectrum(material["eta"]), "k": spectrum(material["k"])}
        if material.get("fresnel") == "constant":
            return {"type": "conductor", "material": "none", "specular_reflectance": spectrum(color)}
    if kind == "dielectric" and color == [1.0] * 3:
        return {"type": "dielectric", "int_ior": float(material["ior"]), "ext_ior": 1.0}
    if kind == "plastic":
        ior = float(material.get("ior", 1.5))
        return {
            "type": "plastic",
            "diffuse_reflectance": spectrum([base_reflectance(x, ior) for x in color]),
            "int_ior": ior,
            "ext_ior": 1.0,
            "nonlinear": True,
        }
    raise Unsupported(f"a material of kind {kind} with these parameters")


def base_reflectance(color, ior):
    """Returns the reflectance of the base for which Mitsuba's plastic is exactly that of a scene file.

    Mitsuba approximates the share of diffuse light that the coat reflects back down by a polynomial (0.5968 instead of 0.5964 for an
    index of 1.5); light leaves the coat in proportion to color / (1 - color * share).
    """
    series = color / (1 - color * internal_reflectance(ior))
    eta = 1 / ior
    polynomial = 0.0636 / eta + 0.6681 + eta * (0.7099 - 1.4399 * eta)
    return series / (1 + series * polynomial)


def ellipsoids(spheres):
    """Returns all spheres of an opaque material as one shape."""
    count = len(spheres.radii)
    rotations = np.tile(np.float32([0, 0, 0, 1]), (count, 1))
    return {
        "type": "ellipsoids",
        "centers": mi.TensorXf(spheres.centers.astype(np.float32)),
        "scales": mi.TensorXf(np.repeat(spheres.radii.astype(np.float32)[:, None], 3, axis=1)),
        "quaternions": mi.TensorXf(rotations),
        "extent": 1.0,
        "extent_adaptive_clamping": False,
    }


def ground(scene):
    """Returns a large square in place of the ground."""
    table = scene.table["ground"]
    normal = np.array(table.get("normal", [0, 1, 0]), dtype=float)
    normal /= math.hypot(*normal)
    center = normal * table.get("height", 0)
    up = [1, 0, 0] if abs(normal[0]) < 0.5 else [0, 0, 1]
    frame = mi.ScalarTransform4f().look_at(origin=list(center), target=list(center + normal), up=up)
    material = surface(table["material"], scene.materials[table["material"]])
    return {"type": "rectangle", "to_world": frame @ mi.ScalarTransform4f().scale([GROUND, GROUND, 1]), **material}


def spectrum(value):
    """Returns a color."""
    return {"type": "rgb", "value": rgb(value)}


if __name__ == "__main__":
    main()
