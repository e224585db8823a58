"""How long Ctrl-C takes, at moments all over a render.

    python interrupts.py [--moments 12]

Each line is a kind of render, in a process of its own for each moment: of ten million spheres while they are read and
their tree is built, of many pixels while they are denoised, of one with layers. What counts is the time from the signal
until the call has returned or raised.
"""

from __future__ import annotations

import argparse
import signal
import statistics
import subprocess
import sys
import time

CODE = """
import signal, sys, time, warnings
import numpy as np
import spherule

# Background jobs of shells ignore the signal.
signal.signal(signal.SIGINT, signal.default_int_handler)
warnings.simplefilter("ignore")
cloud = np.random.default_rng(1).random(({count}, 3), dtype=np.float32)
kinds = np.arange({count}) % 3
print("ready", flush=True)
try:
    picture = spherule.render(cloud, {options})
    print("whole" if picture.complete else "picture", time.time(), flush=True)
except KeyboardInterrupt:
    print("nothing", time.time(), flush=True)
"""

#: Spheres, options, and the seconds within which signals are sent.
KINDS = {
    "ten million spheres": (10_000_000, "radius=0.002, size=(512, 512), spp=4", 2.5),
    "ten million colors and types": (
        10_000_000,
        "radius=0.002, values=cloud[:, 2], kinds=kinds, size=(512, 512), spp=4",
        4.0,
    ),
    "denoising of 3840 x 2160 pixels": (1_000, "radius=0.02, size=(3840, 2160), spp=4, denoise='on'", 4.0),
    "all layers of 1920 x 1080 pixels": (
        1_000,
        "radius=0.02, size=(1920, 1080), spp=8, layers=['albedo', 'normal', 'depth', 'coverage', 'id', 'variance']",
        4.0,
    ),
    "until an error": (1_000, "radius=0.02, size=(1600, 1200), until_error=0.002", 4.0),
    "outlines of 1920 x 1080 pixels": (1_000, "radius=0.02, size=(1920, 1080), spp=8, preset='outline'", 3.0),
}


def interrupted(kind: str, wait: float) -> tuple[str, float]:
    """What a render gives after a signal, and the seconds that it took."""
    count, options, _ = KINDS[kind]
    code = CODE.format(count=count, options=options)
    with subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout
        process.stdout.readline()
        time.sleep(wait)
        start = time.time()
        process.send_signal(signal.SIGINT)
        words = process.stdout.readline().split()
        process.kill()
        return (words[0], float(words[1]) - start) if words else ("nothing", float("nan"))


def main() -> None:
    """Prints the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--moments", type=int, default=12)
    options = parser.parse_args()
    print("| render | median, ms | worst, ms | after |\n|---|--:|--:|--:|")
    for kind, (_, _, span) in KINDS.items():
        found = []
        for moment in range(options.moments):
            wait = span * (moment + 0.5) / options.moments
            what, seconds = interrupted(kind, wait)
            if what != "whole":
                found.append((1000 * seconds, wait))
        worst, wait = max(found)
        median = statistics.median(milliseconds for milliseconds, _ in found)
        print(f"| {kind} | {median:.0f} | {worst:.0f} | {wait:.2f} s |", flush=True)


if __name__ == "__main__":
    main()
