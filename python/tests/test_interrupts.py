"""Ctrl-C, forks and imports, in processes of their own."""

import os
import signal
import subprocess
import sys
import textwrap
import threading
import time

import pytest

LONG = """
    import warnings
    import numpy as np
    import spherule

    warnings.simplefilter("ignore")
    cloud = np.random.default_rng(1).random(({count}, 3), dtype=np.float32)
    print("ready", flush=True)
    told = []
    def report(*facts):
        told.append(facts)
        # The interrupt may come while this prints, and the next report is not to print again.
        if len(told) == 1:
            print("begun", flush=True)
    try:
        picture = spherule.render(cloud, radius=0.02, size=(800, 600), spp=100_000, progress=report, {options})
        print("picture", picture.complete, float(picture.pixels.max()) > 0, picture.samples > 0, flush=True)
    except spherule.Interrupted as interrupted:
        print("raised", interrupted.picture.complete, interrupted.picture.samples > 0, flush=True)
    except KeyboardInterrupt:
        print("nothing", flush=True)
"""


def interrupted(wait=None, count=1000, options=""):
    """What a render says after Ctrl-C, some seconds after its start or once it has samples, and the seconds until then."""
    code = textwrap.dedent(LONG.format(count=count, options=options))
    with subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, text=True) as process:
        # Lines of a process that is killed are empty.
        limit = threading.Timer(60, process.kill)
        limit.start()
        try:
            assert process.stdout.readline() == "ready\n"
            if wait is None:
                assert process.stdout.readline() == "begun\n"
            else:
                time.sleep(wait)
            start = time.monotonic()
            process.send_signal(signal.SIGINT)
            line = process.stdout.readline().strip()
            return line, time.monotonic() - start
        finally:
            limit.cancel()
            process.kill()


def test_interrupts_return_the_picture_so_far():
    for _ in range(3):
        line, seconds = interrupted()
        assert line == "picture False True True"
        assert seconds < 2


FIRST_PASS = """
    import warnings
    import numpy as np
    import spherule

    def report(done, rays, seconds, error):
        # A second interrupt would not wait for the picture.
        if not told:
            told.append(done)
            raise KeyboardInterrupt

    told = []
    # Thousands of tiles, of which few have a sample by the first report.
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        picture = spherule.render(
            [[0, 0, 0]], radius=1, size=(2000, 1500), spp=4096, denoise="off", progress=report, threads=1,
            background="#ff8000", zoom=4,
        )
    codes = picture.srgb()
    without = (codes == [255, 128, 0]).all(axis=2).mean()
    print(0 < picture.sampled < 1, abs(without - (1 - picture.sampled)) < 0.01, "sampled" in str(caught[-1].message))
"""


def test_pictures_without_samples_show_the_background():
    run = subprocess.run(
        [sys.executable, "-c", textwrap.dedent(FIRST_PASS)], check=True, capture_output=True, text=True, timeout=60
    )
    assert run.stdout == "True True True\n"


def test_interrupts_are_raised_if_asked_for():
    line, _ = interrupted(options='on_interrupt="raise"')
    assert line == "raised False True"


def test_interrupts_before_the_first_sample_leave_nothing():
    line, seconds = interrupted(0.25, count=3_000_000)
    assert line == "nothing"
    assert seconds < 2


FINISHING = """
    import time, warnings
    import numpy as np
    import spherule

    warnings.simplefilter("ignore")
    cloud = np.random.default_rng(1).random((1000, 3), dtype=np.float32)
    scene = spherule.Scene(cloud, radius=0.02, preset="outline")
    options = {"size": (200, 150), "spp": 16, "denoise": "on", "layers": ["normal", "id", "samples"]}
    stop = spherule.Stop()
    stop.set()
    # Stopped before it begins: nothing, or the samples of a first task.
    try:
        print(scene.render(stop=stop, **options).complete)
    except spherule.Error:
        print("stopped")
    whole = scene.render(**options)
    print(whole.complete, whole.denoised, *whole.layers)
    told = []

    def report(done, rays, seconds, error):
        told.append(done)
        if done == 1.0:
            raise KeyboardInterrupt

    start = time.monotonic()
    picture = scene.render(progress=report, on_interrupt="return", **options)
    # All samples are taken, but what follows is not done if the interrupt came before.
    print(picture.samples == whole.samples or not picture.complete)
    print(picture.complete or (not picture.denoised and "normal" not in picture.layers and picture.pixels.max() > 0))
"""


def test_interrupts_while_a_picture_is_finished_leave_its_samples():
    code = textwrap.dedent(FINISHING)
    run = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True, timeout=120)
    first, whole, *last = run.stdout.splitlines()
    assert first in ("False", "stopped") and whole == "True True normal id samples" and last == ["True", "True"]


@pytest.mark.skipif(not hasattr(os, "fork"), reason="there are no forks")
def test_pools_of_forks_render_encode_and_query():
    code = """
        import multiprocessing, warnings
        import numpy as np
        import spherule

        warnings.simplefilter("ignore")
        tree = spherule.SphereTree([[0, 0, 0]], 1)

        def work(number):
            picture = spherule.render([[0, 0, 0]], radius=1, size=(64, 48), spp=16, denoise="on", layers=["id"])
            hits = tree.intersect(np.full((3000, 3), [0, 0, 5]), [0, 0, -1])
            return picture.encode("png"), picture.encode("exr"), picture.srgb().tobytes(), float(hits.t.sum())

        if __name__ == "__main__":
            before = work(0)
            with multiprocessing.get_context("fork").Pool(2) as pool:
                found = pool.map_async(work, range(6)).get(timeout=50)
            assert all(one == before for one in found) and before[3] == 12000
    """
    subprocess.run([sys.executable, "-c", textwrap.dedent(code)], check=True, timeout=60)


@pytest.mark.skipif(not hasattr(os, "fork"), reason="there are no forks")
def test_children_of_forks_render_with_threads_of_their_own():
    code = """
        import os, sys, warnings
        import numpy as np
        import spherule

        warnings.simplefilter("ignore")
        def pixels():
            return spherule.render([[0, 0, 0]], radius=1, size=(64, 48), spp=16).pixels
        before = pixels()
        child = os.fork()
        if child == 0:
            os._exit(0 if np.array_equal(pixels(), before) else 1)
        assert os.waitpid(child, 0)[1] == 0
        assert np.array_equal(pixels(), before)
    """
    subprocess.run([sys.executable, "-c", textwrap.dedent(code)], check=True, timeout=60)


def test_imports_are_fast_and_bring_nothing():
    code = """
        import sys, time
        start = time.perf_counter()
        import spherule
        seconds = time.perf_counter() - start
        heavy = {"numpy", "ase", "MDAnalysis", "ovito", "gsd", "pandas", "dask", "tqdm"} & set(sys.modules)
        print(seconds, *heavy)
    """
    command = [sys.executable, "-c", textwrap.dedent(code)]
    runs = [subprocess.run(command, check=True, capture_output=True, text=True, timeout=60) for _ in range(5)]
    words = [run.stdout.split() for run in runs]
    assert all(len(row) == 1 for row in words), words
    assert min(float(row[0]) for row in words) < 0.1
