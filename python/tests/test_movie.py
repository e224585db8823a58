"""Movies: their pictures are those of the program's sequences."""

import os
import subprocess

import numpy as np
import pytest

import spherule


def trajectory(path):
    """Four atoms that drift apart, with a charge; the second frame has them in another order."""
    lines = []
    for frame in range(3):
        atoms = [(name, (1 + frame) * row, 0.3 * row * row, 0.1 * frame, row - frame) for row, name in enumerate("CONH")]
        if frame == 1:
            atoms.reverse()
        lines += ["4", "Properties=species:S:1:pos:R:3:charge:R:1"]
        lines += [f"{name} {x} {y} {z} {charge}" for name, x, y, z, charge in atoms]
    path.write_text("\n".join(lines) + "\n")
    return path


OPTIONS = [
    ({}, []),
    ({"color_by": "charge", "color_bar": True}, ["--color-by", "charge", "--color-bar", "bottom-right"]),
    ({"legend": True, "preset": "studio"}, ["--legend", "--preset", "studio"]),
    ({"arrows": "x,y,charge"}, ["--arrows", "x,y,charge"]),
    ({"select": "charge > 0.5", "model": "ball-and-stick"}, ["--select", "charge > 0.5", "--model", "ball-and-stick"]),
]


@pytest.mark.parametrize(("options", "words"), OPTIONS)
@pytest.mark.filterwarnings("ignore")
def test_movies_are_the_sequences_of_the_program(program, tmp_path, options, words):
    path = trajectory(tmp_path / "drift.extxyz")
    spherule.movie(path, tmp_path / "mine-%02d.pfm", size=(48, 36), spp=1, **options)
    command = [program, "render", path, "--frame", "all", "-o", tmp_path / "theirs-%02d.pfm", "--size", "48x36", "--spp", "1"]
    subprocess.run([*command, "--quiet", *words], check=True, timeout=60)
    for frame in range(3):
        mine, theirs = (tmp_path / f"{whose}-{frame:02}.pfm" for whose in ("mine", "theirs"))
        assert mine.read_bytes() == theirs.read_bytes(), frame


def test_frames_of_iterators_are_seen_by_the_camera_of_the_first(tmp_path):
    walk = np.random.default_rng(1).normal(size=(3, 9, 3)).cumsum(axis=0)
    options = {"radius": 0.2, "size": (40, 30), "spp": 1}
    told = []
    spherule.movie(walk, tmp_path / "all-%d.png", progress=lambda done, *_: told.append(done), **options)
    spherule.movie(iter(walk), tmp_path / "one-%d.png", **options)
    first = (tmp_path / "all-0.png").read_bytes()
    assert first != (tmp_path / "one-0.png").read_bytes()
    assert spherule.render(walk[0], **options).encode() == (tmp_path / "one-0.png").read_bytes()
    assert told == sorted(told) and told[-1] == 1.0


def test_scenes_and_particles_are_frames(tmp_path):
    particles = [spherule.Particles([[0, 0, 0], [x, 0, 0]], radius=0.5) for x in (1, 2)]
    spherule.movie(particles, tmp_path / "particles-%d.png", size=(40, 30), spp=1)
    scenes = [spherule.Scene(one) for one in particles]
    spherule.movie(scenes, tmp_path / "scenes-%d.png", size=(40, 30), spp=1)
    assert scenes[1].render(size=(40, 30), spp=1).encode() == (tmp_path / "scenes-1.png").read_bytes()
    with pytest.raises(spherule.Error, match="`preset` belongs to the scenes"):
        spherule.movie(scenes, tmp_path / "a-%d.png", preset="chalk")


def encoder(folder, monkeypatch, script):
    """An ``ffmpeg`` that is a script of the shell, in which ``$last`` is the file to write."""
    tools = folder / "tools"
    tools.mkdir(exist_ok=True)
    path = tools / "ffmpeg"
    path.write_text(f'#!/bin/sh\n[ "$1" = -version ] && exit 0\nfor last; do :; done\n{script}\n')
    path.chmod(0o755)
    monkeypatch.setenv("PATH", f"{tools}{os.pathsep}{os.environ['PATH']}")


def test_videos_are_piped_to_ffmpeg(tmp_path, monkeypatch):
    encoder(tmp_path, monkeypatch, 'cat > "$last"')
    frames = [[[0, 0, 0], [x, 0, 0]] for x in (1, 2, 3)]
    spherule.movie(frames, tmp_path / "a.mp4", radius=0.5, size=(40, 30), spp=1, fps=12)
    data = np.frombuffer((tmp_path / "a.mp4").read_bytes(), np.uint8).reshape(3, 30, 40, 3)
    spherule.movie(frames, tmp_path / "a-%d.ppm", radius=0.5, size=(40, 30), spp=1)
    assert (tmp_path / "a-2.ppm").read_bytes().endswith(data[2].tobytes())
    assert sorted(path.name for path in tmp_path.glob("a.*")) == ["a.mp4"]


def test_failed_videos_leave_the_old_file(tmp_path, monkeypatch):
    (tmp_path / "a.mp4").write_text("an older film")
    frames = [[[0, 0, 0]]]
    options = {"radius": 1, "size": (40, 30), "spp": 1}
    encoder(tmp_path, monkeypatch, "echo Unknown encoder >&2; exit 3")
    with pytest.raises(spherule.Error, match="Unknown encoder"):
        spherule.movie(frames, tmp_path / "a.mp4", **options)
    encoder(tmp_path, monkeypatch, 'cat > "$last"')
    with pytest.raises(spherule.Error, match="transparent"):
        spherule.movie(frames, tmp_path / "a.mp4", background="transparent", **options)

    def interrupt(*_):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        spherule.movie(frames * 3, tmp_path / "a.mp4", progress=interrupt, **{**options, "spp": 4096})
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(spherule.Error, match="apt install ffmpeg"):
        spherule.movie(frames, tmp_path / "a.mp4", **options)
    assert (tmp_path / "a.mp4").read_text() == "an older film"
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.mp4", "tools"]


@pytest.mark.parametrize(
    ("frames", "path", "options", "words"),
    [
        ([], "a-%d.png", {}, "no frame"),
        (5, "a-%d.png", {}, "iterable of frames"),
        ([[[0, 0, 0]]], "a.avi", {}, ".webm"),
        ([[[0, 0, 0]]], "a-%d-%d.png", {}, "one number"),
        ([[[0, 0, 0]]], "a-%d.png", {"fps": -1}, "`fps` is -1"),
        ([[[0, 0, 0]]], "a-%d.png", {"layers": "all"}, "`layers`"),
        ([[[0, 0, 0]], [[0, 0]]], "a-%d.png", {}, "shape"),
        ("nope.xyz", "a-%d.png", {}, "nope.xyz"),
    ],
)
def test_movies_that_cannot_be_made_are_refused(tmp_path, frames, path, options, words):
    with pytest.raises(spherule.Error, match=words):
        spherule.movie(frames, tmp_path / path, size=(8, 6), spp=1, **options)
