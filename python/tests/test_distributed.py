"""Parts on other processes: the bytes of the whole, also after a worker has died."""

import os
import signal
import time

import numpy as np
import pytest

import spherule
from spherule.distributed import merge, render, render_part

SIZE = {"size": (160, 120), "spp": 32}


@pytest.fixture
def scene(cloud):
    return spherule.Scene(cloud, radius=0.05, preset="outline")


def test_merged_parts_are_the_whole(scene):
    whole = scene.render(**SIZE).pixels
    for count in (1, 2, 7):
        pieces = [render_part(scene, part, count, **SIZE) for part in range(1, count + 1)]
        assert np.array_equal(merge(scene, pieces[::-1], **SIZE).pixels, whole), count


@pytest.mark.parametrize(
    ("call", "text"),
    [
        (lambda scene: render_part(scene, 3, 2, **SIZE), "there is no part 3 of 2; parts are 1 to 2"),
        (lambda scene: render_part(scene, 1, 2), "parts need `spp`"),
        (lambda scene: render_part(scene, 1, 2, spp=4, time=1), "`time` needs the whole picture"),
        (lambda scene: merge(scene, [], **SIZE), "no parts to merge"),
        (lambda scene: merge(scene, [b"spherule"], **SIZE), "part"),
        (lambda scene: merge(scene, [render_part(scene, 1, 2, **SIZE)] * 2, **SIZE), "part 2: has"),
    ],
)
def test_what_is_wrong_is_named(scene, call, text):
    with pytest.raises(spherule.Error) as refused:
        call(scene)
    assert text in str(refused.value)


@pytest.fixture
def cluster():
    distributed = pytest.importorskip("dask.distributed")
    with distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=":0") as cluster:
        with distributed.Client(cluster) as client:
            yield client


@pytest.mark.filterwarnings("ignore")
def test_dask_renders_the_whole_although_a_worker_dies(scene, cluster):
    assert np.array_equal(render(scene, cluster, **SIZE).pixels, scene.render(**SIZE).pixels)
    pids = list(cluster.run(os.getpid).values())
    long = {"size": (320, 240), "spp": 512}
    import threading

    threading.Timer(1.0, lambda: os.kill(pids[0], signal.SIGKILL)).start()
    start = time.monotonic()
    picture = render(scene, cluster, parts=12, **long)
    assert time.monotonic() - start > 1.0, "the worker died meanwhile"
    assert np.array_equal(picture.pixels, scene.render(**long).pixels)
