"""A picture of a million particles, from NumPy and by the program from an NPY file, by turns.

    python million.py [--program target/release/spherule] [--particles 1000000] [--rounds 7]

The picture has 512 x 512 pixels of one sample. Each turn is a process of its own. Of Python there are the time of the
call and of the process as a whole, and the memory at its peak: less the array, and less what Python and NumPy take by
themselves. Medians count.
"""

from __future__ import annotations

import argparse
import json
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

CODE = """
import json, sys, time
import numpy as np

def peak():
    # Not that of getrusage, which begins with the parent's.
    with open("/proc/self/status") as file:
        return next(int(line.split()[1]) for line in file if line.startswith("VmHWM"))

before = peak()
positions = np.load(sys.argv[1])
import spherule
start = time.perf_counter()
spherule.render(positions, radius=float(sys.argv[2]), size=(512, 512), spp=1, progress=False)
seconds = time.perf_counter() - start
print(json.dumps({"call": seconds, "peak": peak() - positions.nbytes // 1024, "before": before}))
"""


def turn(command: list[str]) -> tuple[float, int, str]:
    """Seconds, the peak of memory in KiB, and the output of a process."""
    meter = "import resource, subprocess, sys; subprocess.run(sys.argv[1:], check=True)"
    meter += "; print(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss)"
    start = time.perf_counter()
    run = subprocess.run(command, check=True, capture_output=True, text=True)
    seconds = time.perf_counter() - start
    again = subprocess.run([sys.executable, "-c", meter, *command], check=True, capture_output=True, text=True)
    return seconds, int(again.stdout.split()[-1]), run.stdout


def main() -> None:
    """Prints the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default=shutil.which("spherule"))
    parser.add_argument("--particles", type=int, default=1_000_000)
    parser.add_argument("--rounds", type=int, default=7)
    options = parser.parse_args()
    radius = str(0.4 * options.particles ** (-1 / 3))
    found: dict[str, list[float]] = {}
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "particles.npy"
        np.save(path, np.random.default_rng(1).random((options.particles, 3), dtype=np.float32))
        picture = str(Path(folder) / "picture.png")
        words = ["--radii", radius, "--size", "512x512", "--spp", "1", "--quiet", "-o", picture]
        for _ in range(options.rounds):
            seconds, peak, _ = turn([options.program, "render", str(path), *words])
            whole, _, output = turn([sys.executable, "-c", CODE, str(path), radius])
            facts = json.loads(output)
            for name, value in (
                ("program, s", seconds),
                ("Python's call, s", facts["call"]),
                ("Python's process, s", whole),
                ("program, MB", peak * 1024 / 1e6),
                ("Python beside the array, MB", facts["peak"] * 1024 / 1e6),
                ("Python and NumPy by themselves, MB", facts["before"] * 1024 / 1e6),
            ):
                found.setdefault(name, []).append(value)
    for name, values in found.items():
        print(f"{name}: {statistics.median(values):.2f}")


if __name__ == "__main__":
    main()
