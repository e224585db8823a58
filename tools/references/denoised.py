#!/usr/bin/env python3
"""Measures how long renderers take to an image that looks right, denoised: Spherule, Cycles and, without denoising, Mitsuba.

    pip install mitsuba numpy flip-evaluator
    cargo build --release
    tools/references/denoised.py --cycles PYTHON          # all ten scenes; PYTHON can import bpy
    tools/references/denoised.py crystal my.toml          # a generated scene and a scene file
    tools/references/denoised.py --size 128 --pictures .  # also writes the images that are compared, side by side

Every renderer has its own reference, a long render of the same scene file without denoising, so that small differences of materials
do not count. Each renders images of more and more samples, in processes of their own; their times from the start of the process to
the written file, mean FLIP and root mean square error are measured. The last line has the least ratio of the times and the geometric
mean.

References are kept in target/references/kept, so that a second run is quick. Delete them after a renderer has changed.
"""

import argparse
import itertools
import json
import math
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Callable

import numpy as np

import errors
import references
import scenes
from errors import mean, number
from renderers import (
    Failed, add_arguments, add_cycles, cycles_command, cycles_python, fastest_variant, mitsuba_command, render_spherule,
    render_worker,
)
from scene_file import read_scene, write_png

# Samples of Cycles, denoised, whose errors the times are for.
TARGETS = [16, 64]
# Factor from one level of samples to the next.
STEP = 4
# Errors, their keys in levels, and the power of samples with which they fall.
METRICS = {"FLIP": ("flip", 0.5), "RMSE": ("squared", 1.0)}
RENDERERS = ["spherule", "cycles", "mitsuba"]
# Resolutions of Cycles' importance map of an environment map, relative to it.
MAPS = [1, 2, 4, 8]


@dataclass
class Contender:
    """A renderer with settings."""

    name: str
    """For tables."""
    reference: str
    """Name of the long renders of this renderer."""
    render: Callable
    """Renders an image with a number of samples and a seed; returns it and the times `total` and `alone`."""
    spp: list[int | None] | None = None
    """The numbers of samples; by default more and more of them. None stands for the program's own choice."""


def main():
    options = arguments()
    if "mitsuba" in options.renderers:
        print(mitsuba_denoiser(), file=sys.stderr)
    rows = []
    for path in scenes.paths(options.scenes or scenes.CONVERGING, options.seed, options.size):
        with tempfile.TemporaryDirectory() as folder:
            row = measure_scene(path, Path(folder), options)
        rows.append(row)
        print("\n".join(scene_tables(row)), flush=True)
        if options.json:
            options.json.write_text(json.dumps(rows, indent=1))
    print(last_line(rows))


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    names = f"scene files, or names of generated scenes [default: {' '.join(scenes.CONVERGING)}]"
    parser.add_argument("scenes", nargs="*", help=names)
    add_arguments(parser)
    add_cycles(parser)
    parser.add_argument("--renderers", nargs="+", choices=RENDERERS, default=RENDERERS, help="[default: all]")
    parser.add_argument("--seed", type=int, default=1, help="seed of the generated scenes [default: 1]")
    parser.add_argument("--size", type=int, default=512, help="edge of the generated scenes' images [default: 512]")
    parser.add_argument("--images", type=int, default=2, help="images of each number of samples [default: 2]")
    parser.add_argument("--long-images", type=int, default=2, help="images of each reference, 2 or more [default: 2]")
    parser.add_argument("--long-spp", type=int, default=1024, help="samples per pixel of each of these [default: 1024]")
    parser.add_argument("--most-seconds", type=float, default=30, help="wall-clock time of the longest image [default: 30]")
    parser.add_argument("--pictures", type=Path, metavar="FOLDER", help="also write images side by side, of each scene")
    parser.add_argument("--json", type=Path, metavar="FILE", help="also write all measurements to FILE")
    options = parser.parse_args()
    if options.long_images < 2:
        parser.error("--long-images must be 2 or more, since their differences are the reference's noise")
    return options


def mitsuba_denoiser():
    """Returns a line that says why Mitsuba is not denoised."""
    test = "import mitsuba; mitsuba.set_variant('cuda_ad_rgb'); mitsuba.OptixDenoiser([16, 16])"
    if subprocess.run([sys.executable, "-c", test], capture_output=True).returncode == 0:
        return "Mitsuba is not denoised: its OptixDenoiser runs on the GPU, and processors are compared"
    return "Mitsuba is not denoised: its OptixDenoiser needs an NVIDIA GPU, and cannot run here"


def measure_scene(path, folder, options):
    """Measures all contenders in one scene."""
    row = {"scene": path.stem, "long": [options.long_images, options.long_spp], "floors": {}, "levels": {}, "left_out": []}
    sheet = {}
    for renderer in options.renderers:
        try:
            found = contenders(renderer, path, folder, options)
            if not found:
                continue
            long = long_render(found, path, options)
            reference = errors.Reference([long])
            row["floors"][renderer] = references.halves(long)
            for contender in found:
                row["levels"][contender.name] = levels(contender, reference, options)
            if options.pictures:
                shown = [contender.render((contender.spp or TARGETS)[0], 0)["image"] for contender in found]
                sheet[renderer] = [reference.mean, *shown]
        except Failed as error:
            row["left_out"].append(f"{renderer}: {error}")
            print(f"{path.stem}: without {renderer}: {error}", file=sys.stderr)
    if options.pictures:
        write_sheet(options.pictures / f"{path.stem}.png", list(sheet.values()))
    row["ratios"] = ratios(row["levels"])
    for ratio in row["ratios"]:
        # The noise of the whole reference is about half of that between its halves.
        if ratio["metric"] == "FLIP" and ratio["error"] < max(row["floors"][renderer] for renderer in ("spherule", "cycles")):
            print(f"{path.stem}: references have too much noise for FLIP {ratio['error']:.4f} (--long-spp)", file=sys.stderr)
    return row


def contenders(renderer, path, folder, options):
    """Returns a renderer with all its settings; the last is not denoised, and renders the reference."""
    if renderer == "spherule":
        def spherule(flags, spp, seed):
            run = render_spherule(path, folder, options, spp, [seed], flags)[0]
            return {"image": run["image"], "total": run["wall"], "alone": run["loaded"], "spp": samples(run, spp)}

        return [
            Contender("Spherule, denoised", renderer, partial(spherule, ["--denoise", "on"])),
            Contender("Spherule, no options", renderer, partial(spherule, []), spp=[None]),
            Contender("Spherule, not denoised", renderer, partial(spherule, ["--denoise", "off"])),
        ]

    def worker(command, spp, seed):
        run = render_worker(command, folder, spp, [seed])[0]
        return {"image": run["image"], "total": run["total"], "alone": run["wall"], "spp": spp}

    if renderer == "cycles":
        if not cycles_python(options):
            return []
        scale = best_map(path, folder, options)
        chosen = ["--map-scale", scale]
        result = []
        for prefilter in ("ACCURATE", "FAST"):
            for adaptive in (False, True):
                flags = [*chosen, "--prefilter", prefilter, *(["--adaptive"] if adaptive else [])]
                name = f"Cycles, {prefilter}{', adaptive' if adaptive else ''}"
                render = partial(worker, cycles_command(path, folder, options, flags))
                result.append(Contender(name, renderer, render, spp=TARGETS if adaptive else None))
        plain = partial(worker, cycles_command(path, folder, options, chosen))
        return [*result, Contender("Cycles, not denoised", f"cycles-map{scale}", plain)]
    settings = fastest_variant(path, folder, options, ["llvm_ad_rgb"])
    plain = partial(worker, mitsuba_command(path, folder, settings, options))
    return [Contender("Mitsuba, not denoised", renderer, plain)]


def best_map(path, folder, options):
    """Returns the resolution of Cycles' importance map with the least product of noise and time."""
    if read_scene(path).picture is None:
        return MAPS[0]
    costs = {}
    for scale in MAPS:
        command = cycles_command(path, folder, options, ["--map-scale", scale])
        first, second = render_worker(command, folder, TARGETS[0], [0, 1])
        costs[scale] = ((first["image"] - second["image"]) ** 2).mean() * first["total"]
    return min(costs, key=costs.get)


def samples(run, spp):
    """Returns the mean number of samples per pixel of an image of Spherule."""
    noise = run["report"].get("noise") or {}
    return noise.get("mean_samples", spp)


def long_render(found, path, options):
    """Returns the long render of a renderer, from those of earlier runs if they are there."""
    plain = found[-1]
    name = f"{plain.reference}-{options.long_spp}"
    return references.kept(path, name, options.long_images, lambda seed: plain.render(options.long_spp, seed)["image"])


def levels(contender, reference, options):
    """Renders images of more and more samples; returns the times and errors of each number of samples."""
    result = []
    for spp in contender.spp or (STEP**i for i in itertools.count()):
        runs = [contender.render(spp, seed) for seed in range(options.images)]
        result.append(
            {
                "spp": mean(run["spp"] for run in runs),
                "total": min(run["total"] for run in runs),
                "alone": min(run["alone"] for run in runs),
                "flip": mean(errors.flip(reference.mean, run["image"]) for run in runs),
                "squared": mean(reference.squared_error(run["image"]) for run in runs),
            }
        )
        if not contender.spp and spp >= TARGETS[-1] and STEP * result[-1]["total"] > options.most_seconds:
            break
    return result


def ratios(levels):
    """Returns how many times Spherule's time Cycles takes to each error of its own, with the settings that suit it best."""
    result = []
    ours = levels.get("Spherule, denoised")
    theirs = {name: measured for name, measured in levels.items() if name.startswith("Cycles") and "not" not in name}
    if not ours or not theirs:
        return result
    for spp in TARGETS:
        for metric, (key, power) in METRICS.items():
            rows = []
            for name, measured in theirs.items():
                at = next(level for level in measured if level["spp"] == spp)
                row = {"metric": metric, "spp": spp, "settings": name.removeprefix("Cycles, "), "error": root(metric, at[key])}
                for time in ("total", "alone"):
                    seconds, sign = errors.time_to(ours, at[key], key, time, power)
                    # A bound on Spherule's time is the opposite bound on the ratio.
                    opposite = {"<": ">", ">": "<"}.get(sign, sign)
                    ratio = {"ratio": at[time] / seconds, "bound": opposite}
                    row[time] = {"cycles": at[time], "spherule": seconds, "sign": sign, **ratio}
                rows.append(row)
            result.append(min(rows, key=lambda row: row["total"]["ratio"]))
    return result


def root(metric, value):
    """Returns an error as it is shown."""
    return math.sqrt(max(value, 0)) if metric == "RMSE" else value


def scene_tables(row):
    """Returns the results of one scene as tables in Markdown."""
    images, spp = row["long"]
    floors = ", ".join(f"{renderer} {floor:.4f}" for renderer, floor in row["floors"].items())
    lines = [f"## {row['scene']}", "", f"References: {images} images of {spp} samples per pixel. FLIP between their halves: {floors}."]
    lines += [f"Left out: {reason}." for reason in row["left_out"]]
    lines += ["", "| renderer | samples | start to file, s | render alone, s | FLIP | RMSE |", "|---|--:|--:|--:|--:|--:|"]
    for name, measured in row["levels"].items():
        for level in measured:
            times = f"{level['total']:.2f} | {level['alone']:.2f}"
            rmse = root("RMSE", level["squared"])
            lines.append(f"| {name} | {level['spp']:.4g} | {times} | {level['flip']:.4f} | {rmse:.4g} |")
    if row["ratios"]:
        lines += [
            "",
            "| error of Cycles with | settings | | start to file, s | ratio | render alone, s | ratio |",
            "|---|---|--:|--:|--:|--:|--:|",
        ]
    for ratio in row["ratios"]:
        cells = []
        for time in ("total", "alone"):
            at = ratio[time]
            cells += [f"{at['sign']}{number(at['spherule'])} : {number(at['cycles'])}", at["bound"] + number(at["ratio"])]
        lines.append(
            f"| {ratio['spp']} samples | {ratio['settings']} | {ratio['metric']} {ratio['error']:.4g} | {' | '.join(cells)} |"
        )
    return [*lines, ""]


def last_line(rows):
    """Returns the least ratio and the geometric mean of all, for each kind of error."""
    parts = []
    for metric in METRICS:
        found = [(ratio["total"], row["scene"]) for row in rows for ratio in row["ratios"] if ratio["metric"] == metric]
        if found:
            least, scene = min(found, key=lambda pair: pair[0]["ratio"])
            signs = {at["bound"] for at, _ in found} - {""}
            sign = signs.pop() if len(signs) == 1 else "~" if signs else ""
            geometric = math.exp(mean(math.log(at["ratio"]) for at, _ in found))
            smallest = f"{least['bound']}{number(least['ratio'])} ({scene})"
            parts.append(f"{metric}: least ratio {smallest}, geometric mean {sign}{number(geometric)}")
    return "; ".join(parts) or "no ratios: Spherule or Cycles was left out"


def write_sheet(path, rows):
    """Writes a picture: a row for each renderer, of its reference and its images with few samples."""
    width = max(len(row) for row in rows)
    blank = np.zeros_like(rows[0][0])
    image = np.vstack([np.hstack(row + [blank] * (width - len(row))) for row in rows])
    path.parent.mkdir(parents=True, exist_ok=True)
    write_png(path, errors.srgb(image))


if __name__ == "__main__":
    main()
