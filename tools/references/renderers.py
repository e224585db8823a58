"""Runs the renderers, each in processes of its own, and measures their times."""

import json
import resource
import shutil
import subprocess
import sys
import time
from pathlib import Path

from scene_file import read_pfm

HERE = Path(__file__).resolve().parent
# Seeds of long renders; other images have small seeds.
LONG = 1000


class Failed(Exception):
    """A renderer that could not render a scene."""


def add_arguments(parser):
    """Adds the options that say what runs, and how."""
    parser.add_argument("--spherule", type=Path, default=HERE.parents[1] / "target/release/spherule")
    parser.add_argument("--threads", type=int, default=2, help="threads of every renderer [default: 2]")


def add_cycles(parser):
    """Adds the option that says where Cycles is."""
    parser.add_argument("--cycles", metavar="PYTHON", help="Python that can import bpy [default: this one, if it can]")


def render_spherule(path, folder, options, spp, seeds, flags=()):
    """Renders an image for each seed, in a process of its own.

    `alone` is the time of the render without denoising; `loaded`, all but reading the scene.
    """
    runs = []
    for seed in seeds:
        image = folder / "image.pfm"
        before, start = children_seconds(), time.perf_counter()
        output = execute(spherule_command(path, image, spp, seed, options, flags))
        wall, cpu = time.perf_counter() - start, children_seconds() - before
        report = json.loads(output)
        statistics = report["statistics"]
        times = {"cpu": cpu, "wall": wall, "alone": statistics["render_seconds"], "loaded": wall - statistics["load_seconds"]}
        runs.append({"seed": seed, "image": read_pfm(image), "report": report, **times})
    return runs


def children_seconds():
    """Returns the user and system time of all finished child processes."""
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def spherule_command(path, image, spp, seed, options, flags=()):
    """Returns the command that renders an image; without samples, it stops where the program does by itself."""
    samples = [] if spp is None else ["--spp", spp]
    settings = [*samples, "--seed", seed, "--threads", options.threads, *flags]
    return [options.spherule, "render", path, *settings, "--quiet", "--json", "-o", image]


def render_mitsuba(path, folder, options, settings, spp, seeds):
    """Renders an image for each seed in one process, whose start and compilation are not counted."""
    command = mitsuba_command(path, folder, settings, options)
    # Long renders are not timed, and the scalar variant does not compile.
    if seeds[0] < LONG and settings["variant"].startswith("llvm"):
        command.append("--warm-up")
    return render_worker(command, folder, spp, seeds)


def mitsuba_command(path, folder, settings, options):
    chosen = [f"--{key}={value}" for key, value in settings.items()]
    return [sys.executable, HERE / "mitsuba_render.py", path, "--folder", folder, f"--threads={options.threads}", *chosen]


def fastest_variant(path, folder, options, variants):
    """Returns the variant and the shapes of Mitsuba that take the least time."""
    trials, failure = [], None
    for variant in variants:
        for shapes in ("sphere", "ellipsoids"):
            settings = {"variant": variant, "shapes": shapes, "sampler": "multijitter"}
            try:
                runs = render_mitsuba(path, folder, options, settings, 4, range(1))
            except Failed as error:
                failure = error
                break
            trials.append((min(run["cpu"] for run in runs), settings))
    if not trials:
        raise failure
    return min(trials, key=lambda trial: trial[0])[1]


def cycles_command(path, folder, options, flags=()):
    command = [cycles_python(options), "-W", "ignore", HERE / "cycles_render.py", path, "--folder", folder]
    return [*command, f"--threads={options.threads}", *flags]


def cycles_python(options):
    """Returns the Python that runs Cycles, if there is one."""
    if not hasattr(options, "cycles_found"):
        python = options.cycles or sys.executable
        works = shutil.which(python) and subprocess.run([python, "-c", "import bpy"], capture_output=True).returncode == 0
        if not works:
            print("Cycles is left out: this Python cannot import bpy (pip install bpy; --cycles)", file=sys.stderr)
        options.cycles_found = python if works else None
    return options.cycles_found


def render_worker(command, folder, spp, seeds):
    """Renders an image for each seed in one process of a renderer.

    Each run's `total` is the wall-clock time from the start of the process to the written image, of the first one only if there are
    several.
    """
    start = time.time()
    output = execute([*command, "--spp", spp, "--seeds", *seeds])
    runs = [json.loads(line) for line in output.splitlines() if line.startswith("{")]
    for run in runs:
        run["image"] = read_pfm(folder / f"{run['seed']}.pfm")
        run["total"] = run["written"] - start
    return runs


def execute(command):
    """Runs a program; returns its standard output."""
    done = subprocess.run([str(part) for part in command], capture_output=True, text=True)
    if done.returncode:
        lines = done.stderr.strip().splitlines() or [f"exit code {done.returncode}"]
        raise Failed(lines[-1])
    return done.stdout
