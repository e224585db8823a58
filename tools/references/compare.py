#!/usr/bin/env python3
"""Compares images of Spherule with those of Mitsuba 3 and Cycles: the same scene files, camera and pixels, in linear radiance.

    pip install mitsuba numpy
    cargo build --release
    tools/references/compare.py                    # all generated scenes, and the small ones beside this file
    tools/references/compare.py small-lamp         # one generated scene
    tools/references/compare.py my.toml            # a scene file; reports features that Mitsuba does not share

For each scene, long renders of both must agree, as a whole and block by block, and together are the reference. Then each renders
images of more and more samples, whose errors and times are measured. The exit code is 1 if the renderers differ by more than five
standard errors.

Mitsuba needs LLVM for its fastest variant; DRJIT_LIBLLVM_PATH names the library if it is not found.
"""

import argparse
import json
import math
import sys
import tempfile
from functools import partial
from pathlib import Path

import errors
import scenes
from errors import mean, number
from renderers import (
    HERE, LONG, Failed, add_arguments, add_cycles, cycles_command, cycles_python, fastest_variant, mitsuba_command, render_mitsuba,
    render_spherule, render_worker,
)
from scene_file import read_scene

VARIANTS = ["llvm_ad_rgb", "scalar_rgb"]
SAMPLERS = ["multijitter", "orthogonal", "ldsampler", "independent"]
# Greatest number of spheres for which long renders have Mitsuba's shape `sphere`: more take too long. Its `ellipsoids` are faster, but
# some pixels are wrong.
MOST_EXACT = 1000
# Greatest factor from one level of samples to the next.
STEP = 4


def main():
    options = arguments()
    rows, worst = [], 0.0
    for path in scene_paths(options):
        with tempfile.TemporaryDirectory() as folder:
            try:
                row = compare(path, Path(folder), options)
            except Failed as error:
                print(f"{path.stem}: not compared: {error}", file=sys.stderr)
                continue
        rows.append(row)
        worst = max(worst, abs(row["sigma"]), row["worst"])
        print(f"{path.stem}: {summary(row)}", file=sys.stderr, flush=True)
        if options.json:
            options.json.write_text(json.dumps(rows, indent=1))
    print(tables(rows))
    return 1 if worst > 5 else 0


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenes", nargs="*", help="scene files, or names of generated scenes [default: all]")
    add_arguments(parser)
    parser.add_argument("--seed", type=int, default=1, help="seed of the generated scenes [default: 1]")
    parser.add_argument("--size", type=int, default=512, help="edge of the generated scenes' images [default: 512]")
    parser.add_argument("--spp", type=int, default=64, help="samples per pixel of the images compared [default: 64]")
    parser.add_argument("--images", type=int, default=2, help="images of each number of samples [default: 2]")
    parser.add_argument("--long-images", type=int, default=4, help="images of each long render [default: 4]")
    parser.add_argument("--long-spp", type=int, default=128, help="samples per pixel of each of these [default: 128]")
    parser.add_argument("--most-seconds", type=float, default=40, help="processor time of the longest image [default: 40]")
    parser.add_argument("--variant", help="variant of Mitsuba [default: the faster of llvm_ad_rgb and scalar_rgb]")
    parser.add_argument("--sampler", help="sampler of Mitsuba [default: the one with the least error in equal time]")
    add_cycles(parser)
    parser.add_argument("--json", type=Path, metavar="FILE", help="also write all results to FILE")
    return parser.parse_args()


def scene_paths(options):
    """Returns the scene files to compare, after generating those that are given by name."""
    names = options.scenes or [*sorted((HERE / "scenes").glob("*.toml")), *scenes.SCENES]
    return scenes.paths(names, options.seed, options.size)


def compare(path, folder, options):
    """Measures one scene; returns its row of all tables."""
    ours = partial(render_spherule, path, folder, options)
    long_seeds = range(LONG, LONG + options.long_images)
    spherule = errors.LongRender([run["image"] for run in ours(options.long_spp, long_seeds)])
    variants = [options.variant] if options.variant else VARIANTS
    settings = fastest_variant(path, folder, options, variants)
    exact = settings | {"shapes": "sphere"} if read_scene(path).count() <= MOST_EXACT else settings
    runs = render_mitsuba(path, folder, options, exact, options.long_spp, long_seeds)
    mitsuba = errors.LongRender([run["image"] for run in runs])
    agreement = errors.agreement(spherule, mitsuba)
    reference = errors.Reference([spherule, mitsuba])
    settings["sampler"] = options.sampler or best_sampler(path, folder, options, settings, reference)
    theirs = partial(render_mitsuba, path, folder, options, settings)
    row = {
        "scene": path.stem,
        "spheres": read_scene(path).count(),
        "means": agreement.means,
        "sigma": agreement.sigma,
        "squared": agreement.squared,
        "worst": agreement.worst,
        "settings": settings,
        "spherule": measure(ours, reference, options),
        "mitsuba": measure(theirs, reference, options) | whole(mitsuba_command(path, folder, settings, options), folder, options),
    }
    if cycles_python(options):
        try:
            command = cycles_command(path, folder, options, ["--exact"])
            cycles = partial(render_worker, command, folder)
            images = [run["image"] for run in cycles(options.long_spp, long_seeds)]
            row["cycles_agreement"] = vars(errors.agreement(errors.LongRender(images), spherule))
            row["cycles"] = measure(cycles, reference, options) | whole(command, folder, options)
        except Failed as error:
            print(f"{path.stem}: left out of the table of Cycles: {error}", file=sys.stderr)
    return row


def measure(render, reference, options):
    """Renders images of more and more samples; returns the times and errors of each number of samples."""
    levels, spp = [], 1
    while True:
        runs = render(spp, range(options.images))
        images = [run["image"] for run in runs]
        levels.append(
            {
                "spp": spp,
                "cpu": min(run["cpu"] for run in runs),
                "wall": min(run["wall"] for run in runs),
                "alone": min(run.get("alone", run["wall"]) for run in runs),
                "squared": mean(reference.squared_error(image) for image in images),
                "relative": mean(reference.relative_error(image) for image in images),
                "fireflies": mean(reference.fireflies(image) for image in images),
            }
        )
        last = levels[-1]
        reached = math.sqrt(max(last["squared"], 0)) < 0.01
        if spp >= options.spp and (reached or STEP * last["cpu"] > options.most_seconds):
            at = next(level for level in levels if level["spp"] == options.spp)
            # Spherule's processes render one image each; those of others, several.
            return {"levels": levels, "at": at, "total": at["wall"], "alone": at["alone"]}
        spp *= STEP


def whole(command, folder, options):
    """Returns the wall-clock time of a process from its start to its written image, and of the render alone."""
    run = render_worker(command, folder, options.spp, [0])[0]
    return {"total": run["total"], "alone": run["wall"]}


def best_sampler(path, folder, options, settings, reference):
    """Returns the sampler of Mitsuba with the least product of error and time."""
    costs = {}
    for sampler in SAMPLERS:
        runs = render_mitsuba(path, folder, options, settings | {"sampler": sampler}, 16, range(1))
        error = mean(reference.relative_error(run["image"]) for run in runs)
        costs[sampler] = error * min(run["cpu"] for run in runs)
    return min(costs, key=costs.get)


def summary(row):
    ours, theirs = row["spherule"]["at"], row["mitsuba"]["at"]
    return f"sigma {row['sigma']:+.2f}, cpu {ours['cpu']:.2f} : {theirs['cpu']:.2f} s, equal error {equal_error(row)}"


def tables(rows):
    """Returns all results as tables in Markdown."""
    lines = [
        "| scene | spheres | Spherule | Mitsuba | sigma | blocks | worst block |",
        "|---|--:|--:|--:|--:|--:|--:|",
    ]
    for row in rows:
        lines.append(
            f"| {row['scene']} | {row['spheres']} | {row['means'][0]:.6f} | {row['means'][1]:.6f} | {row['sigma']:+.2f} | "
            f"{row['squared']:.2f} | {row['worst']:.1f} |"
        )
    for name in ("mitsuba", "cycles"):
        if any(name in row for row in rows):
            lines += ["", *renderer_table([row for row in rows if name in row], name)]
    return "\n".join(lines)


def renderer_table(rows, name):
    """Returns the table of times and errors beside one renderer."""
    lines = [
        "| scene | settings | processor s | render alone, s | start to file, s | error | fireflies | equal error | RMSE 0.01, s |",
        "|---|---|--:|--:|--:|--:|--:|--:|--:|",
    ]
    for row in rows:
        ours, theirs = row["spherule"], row[name]
        a, b = ours["at"], theirs["at"]
        lines.append(
            f"| {row['scene']} | {', '.join(row['settings'].values()) if name == 'mitsuba' else 'points'} | "
            f"{number(a['cpu'])} : {number(b['cpu'])} | {number(ours['alone'])} : {number(theirs['alone'])} | "
            f"{number(ours['total'])} : {number(theirs['total'])} | {a['relative']:.2e} : {b['relative']:.2e} | "
            f"{a['fireflies']:.0f} : {b['fireflies']:.0f} | {equal_error(row, name)} | "
            f"{seconds_to(ours)} : {seconds_to(theirs)} |"
        )
    return lines


def equal_error(row, name="mitsuba"):
    """Returns how many times Spherule's processor time the other renderer takes to the error of its own image."""
    theirs = row[name]["at"]
    seconds, sign = errors.time_to(row["spherule"]["levels"], theirs["relative"], "relative", "cpu")
    # A bound on Spherule's time is the opposite bound on the ratio.
    return {"<": ">", ">": "<"}.get(sign, sign) + number(theirs["cpu"] / max(seconds, 1e-9))


def seconds_to(measured):
    """Returns the processor time to a root mean square error of 0.01."""
    seconds, sign = errors.time_to(measured["levels"], 1e-4, "squared", "cpu")
    return sign + number(seconds)


if __name__ == "__main__":
    sys.exit(main())
