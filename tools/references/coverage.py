#!/usr/bin/env python3
"""Measures whether the error that Spherule states covers the true one.

    pip install numpy
    cargo build --release
    tools/references/coverage.py                               # ten scenes, 20 images of each with 16 samples per pixel
    tools/references/coverage.py --spp 4 64 default grains     # several numbers of samples, and where the program stops by itself
    tools/references/coverage.py --scenes my.toml --seeds 100  # a scene file; generated scenes are given by name

Each image of a scene has another seed. Its true error, as the program defines it, is the root mean squared error of linear
radiance over pixels and channels, divided by the mean radiance: measured against a long render without denoising, whose own noise
is subtracted. The image is covered if that is at most the bound that the program states with 95 % confidence.

Long renders are kept in target/references/kept, so that a second run is quick. Delete them after the program has changed.
"""

import argparse
import json
import math
import sys
import tempfile
from pathlib import Path

import references
import scenes
from errors import Reference, mean
from renderers import Failed, add_arguments, render_spherule


def main():
    options = arguments()
    print("| scene | samples | true error | stated | stated / true | bound | covered | largest true / bound |")
    print("|---|--:|--:|--:|--:|--:|--:|--:|")
    rows, runs = [], []
    for path in scenes.paths(options.scenes, options.seed, options.size):
        with tempfile.TemporaryDirectory() as folder:
            try:
                for spp in options.spp:
                    row = measure(path, Path(folder), options, spp)
                    rows.append(row)
                    runs += row["runs"]
                    print(table_row(row), flush=True)
            except Failed as error:
                print(f"{path.stem}: left out: {error}", file=sys.stderr)
        if options.json:
            options.json.write_text(json.dumps(rows, indent=1))
    if not runs:
        sys.exit("no image was measured")
    covered = sum(run["covered"] for run in runs)
    print(f"covered: {covered} of {len(runs)}, {100 * covered / len(runs):.1f} %")


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    add_arguments(parser)
    names = f"scene files, or names of generated scenes [default: {' '.join(scenes.CONVERGING)}]"
    parser.add_argument("--scenes", nargs="+", default=scenes.CONVERGING, help=names)
    parser.add_argument("--seed", type=int, default=1, help="seed of the generated scenes [default: 1]")
    samples = 'numbers of samples per pixel, or "default" for no options [default: 16]'
    parser.add_argument("--spp", nargs="+", type=stop, default=[16], help=samples)
    parser.add_argument("--seeds", type=int, default=20, help="images of each scene and number of samples [default: 20]")
    parser.add_argument("--size", type=int, default=256, help="width and height of the images, in pixels [default: 256]")
    parser.add_argument("--long-images", type=int, default=4, help="images of each long render, 2 or more [default: 4]")
    parser.add_argument("--long-spp", type=int, default=4096, help="samples per pixel of each of these [default: 4096]")
    parser.add_argument("--json", type=Path, metavar="FILE", help="also write all measurements to FILE")
    options = parser.parse_args()
    if options.long_images < 2:
        parser.error("--long-images must be 2 or more, since their differences are the long render's noise")
    return options


def stop(text):
    """Returns a number of samples, or None for the program's own choice."""
    return None if text == "default" else int(text)


def measure(path, folder, options, spp):
    """Renders images of one scene with many seeds; returns their true errors and what the program states."""
    size = ["--size", f"{options.size}x{options.size}"]

    def long_image(seed):
        return render_spherule(path, folder, options, options.long_spp, [seed], [*size, "--denoise", "off"])[0]["image"]

    name = f"spherule-{options.long_spp}"
    long = references.kept(path, name, options.long_images, long_image, options.size)
    reference, radiance = Reference([long]), float(long.mean.mean())
    runs = []
    for seed in range(1, options.seeds + 1):
        flags = [*size, *([] if spp is None else ["--denoise", "on"])]
        run = render_spherule(path, folder, options, spp, [seed], flags)[0]
        noise = run["report"]["noise"]
        if noise is None:
            raise Failed("the program states no error with these options")
        true = math.sqrt(max(reference.squared_error(run["image"]), 0)) / radiance
        stated = {key: noise[key] for key in ("error", "bound", "mean_samples", "denoised")}
        runs.append({"seed": seed, "true": true, "covered": true <= noise["bound"], **stated})
    floor = math.sqrt(long.variance.mean()) / radiance
    return {"scene": path.stem, "spp": spp, "runs": runs, "long_error": floor}


def table_row(row):
    """Returns the results of one scene and number of samples as a row of a table in Markdown."""
    runs = row["runs"]
    true, stated, bound = (mean(run[key] for run in runs) for key in ("true", "error", "bound"))
    # Of root mean squares, since squared errors are what is estimated without bias.
    ratio = math.sqrt(mean(run["error"] ** 2 for run in runs) / max(mean(run["true"] ** 2 for run in runs), 1e-30))
    worst = max(run["true"] / run["bound"] if run["bound"] else math.inf for run in runs)
    samples = f"{mean(run['mean_samples'] for run in runs):.4g}{' (default)' if row['spp'] is None else ''}"
    return (
        f"| {row['scene']} | {samples} | {true:.2%} | {stated:.2%} | {ratio:.2f} | {bound:.2%} | "
        f"{sum(run['covered'] for run in runs)} of {len(runs)} | {worst:.2f} |"
    )


if __name__ == "__main__":
    main()
