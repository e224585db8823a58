"""Pictures: those of the program, to the byte, in every way to ask for them."""

import asyncio
import base64
import pickle
import subprocess
import threading
import time

import numpy as np
import pytest

import spherule

SMALL = {"size": (60, 40), "spp": 2}


def of_program(program, folder, source, *options):
    out = folder / "program.pfm"
    subprocess.run([program, "render", source, "-o", out, "--quiet", *options], check=True, cwd=folder, timeout=120)
    return out.read_bytes()


@pytest.mark.filterwarnings("ignore::spherule.SpheruleWarning")
@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({}, []),
        ({"spp": 3}, ["--spp", "3"]),
        ({"until_error": 0.05}, ["--until-error", "5%"]),
        ({"spp": 4, "denoise": "on", "seed": 9}, ["--spp", "4", "--denoise", "on", "--seed", "9"]),
        ({"spp": 2, "radius": 0.1, "preset": "studio"}, ["--spp", "2", "--radii", "0.1", "--preset", "studio"]),
        ({"spp": 2, "view": "iso", "up": "y"}, ["--spp", "2", "--view", "iso", "--up", "y"]),
        (
            {"spp": 2, "slices": ["x>50%"], "slice_mode": "caps"},
            ["--spp", "2", "--slice", "x>50%", "--slice-mode", "caps"],
        ),
        (
            {"spp": 2, "color_by": "z", "color_map": "magma_r", "color_bar": "right"},
            ["--spp", "2", "--color-by", "z", "--color-map", "magma_r", "--color-bar", "right"],
        ),
        (
            {"spp": 2, "preset": "outline", "select": "z > 0.5"},
            ["--spp", "2", "--preset", "outline", "--select", "z > 0.5"],
        ),
        (
            {"spp": 2, "bonds": "*-*<0.2", "bond_radius": 0.01},
            ["--spp", "2", "--bonds", "*-*<0.2", "--bond-radius", "0.01"],
        ),
        (
            {"spp": 2, "integrator": "ao", "ao_distance": 0.3},
            ["--spp", "2", "--integrator", "ao", "--ao-distance", "0.3"],
        ),
    ],
)
def test_pictures_are_those_of_the_program(program, tmp_path, cloud, options, words):
    np.save(tmp_path / "cloud.npy", cloud)
    expected = of_program(program, tmp_path, "cloud.npy", "--size", "120x80", *words)
    assert spherule.render(cloud, size=(120, 80), **options).encode("pfm") == expected


def test_molecules_are_drawn_with_their_bonds():
    water = [[0, 0, 0], [0.757, 0.586, 0], [-0.757, 0.586, 0]]
    kinds = ["O", "H", "H"]
    pixels = {
        model: spherule.render(water, kinds=kinds, model=model, **SMALL).pixels
        for model in ("space-filling", "ball-and-stick", "licorice")
    }
    assert not np.array_equal(pixels["space-filling"], pixels["ball-and-stick"])
    assert not np.array_equal(pixels["licorice"], pixels["ball-and-stick"])
    rules = spherule.render(water, kinds=kinds, bonds="O-H<1", **SMALL).pixels
    assert np.array_equal(rules, pixels["ball-and-stick"])
    for wrong in ({"model": "wires"}, {"bonds": "file"}, {"bonds": "O-X<1"}, {"bond_radius": 0}):
        with pytest.raises(spherule.Error, match="wires|no bonds|`X`|bond_radius"):
            spherule.render(water, kinds=kinds, **wrong, **SMALL)


def test_sticks_are_sections():
    stick = {"from": [0, 0, 0], "to": [2, 1, 0], "radius": 0.3, "colors": ["red", "blue"]}
    picture = spherule.Scene(stick=[stick]).render(layers=["id", "albedo"], **SMALL)
    ids = picture.layers["id"]
    assert set(np.unique(ids)) == {0, ids.max()}
    red, blue = (picture.layers["albedo"][..., channel].max() for channel in (0, 2))
    assert red > 0 and blue > 0


def test_scene_files_give_the_pictures_of_the_program(program, tmp_path):
    scene = spherule.Scene(
        title="a pair",
        render={"size": [80, 60], "spp": 4, "depth": 5},
        camera={"eye": [0, 1, 6], "target": [0, 0, 0], "fov": 30, "aperture": 0.1},
        environment={"kind": "gradient", "bottom": 1, "top": [0.5, 0.7, 1]},
        light=[{"kind": "sun", "direction": [1, 1, 1], "irradiance": 2}],
        material={"gold": {"kind": "conductor", "color": [1, 0.77, 0.34], "roughness": 0.2}},
        sphere=[
            {"center": [0, 0, 0], "radius": 1, "material": "gold"},
            {"center": [2, 0, 0], "radius": 0.5, "color": "tomato"},
        ],
        ground={"height": -1},
        slice=[{"normal": [0, 0, 1], "distance": 0.5, "mode": "caps"}],
        label=[{"text": 'two "spheres" \\ one plane'}],
    )
    scene.save(tmp_path / "pair.toml")
    ours = scene.render().encode("pfm")
    assert ours == spherule.Scene.load(tmp_path / "pair.toml").render().encode("pfm")
    assert ours == of_program(program, tmp_path, "pair.toml")


def test_sections_replace_what_a_preset_has(cloud):
    plain = spherule.Scene(cloud, radius=0.05).render(**SMALL).pixels
    for section in (
        {"camera": {"projection": "orthographic"}},
        {"camera": {"eye": [3, 3, 3], "target": [0.5, 0.5, 0.5]}},
        {"light": [{"kind": "point", "position": [2, 2, 2], "intensity": 5}]},
        {"environment": {"color": 0.3}},
        {"look": {"outline": True}},
        {"sphere": [{"center": [0.5, 0.5, 1.2], "radius": 0.3, "color": "red"}]},
        {"material": {"gold": {"kind": "conductor", "color": "gold"}}, "materials": "gold"},
        {"axes": {}},
    ):
        assert not np.array_equal(spherule.Scene(cloud, radius=0.05, **section).render(**SMALL).pixels, plain), section


def test_pictures_do_not_depend_on_threads(cloud):
    pictures = [spherule.render(cloud, radius=0.05, threads=threads, **SMALL) for threads in (1, 2, 5)]
    assert all(np.array_equal(pictures[0].pixels, picture.pixels) for picture in pictures)


def test_layers_are_arrays_by_name(cloud):
    names = ["albedo", "normal", "depth", "coverage", "id", "variance", "samples"]
    picture = spherule.render(cloud, radius=0.05, layers=names, **SMALL)
    shapes = {name: (layer.shape, str(layer.dtype)) for name, layer in picture.layers.items()}
    triple, single, whole = ((40, 60, 3), "float32"), ((40, 60), "float32"), ((40, 60), "uint32")
    assert shapes == dict(zip(names, [triple, triple, single, single, whole, triple, whole]))
    ids = picture.layers["id"]
    seen = ids[ids != spherule.NOTHING]
    assert len(seen) > 100 and seen.max() < 1000
    assert np.array_equal(picture.layers["samples"], np.full((40, 60), 2))
    assert not picture.pixels.flags.owndata and picture.pixels.flags.writeable


@pytest.mark.parametrize(
    ("options", "seen"),
    [
        ({}, {0, 1, 2}),
        ({"select": "x > 1"}, {1, 2}),
        ({"slices": ["x < 1"]}, {1, 2}),
        ({"select": "x > 1", "slices": ["x > 4"]}, {1}),
        ({"select": "x > 1", "cell": [9, 9, 9], "replicate": (1, 2, 1)}, {1, 2}),
        ({"sphere": [{"center": [0, 3, 0], "radius": 1}], "select": "x > 1"}, {1, 2, 3}),
        ({"radius_scale": 0.5}, {0, 1, 2}),
    ],
)
def test_ids_are_rows_of_the_arrays(options, seen):
    scene = spherule.Scene([[0, 0, 0], [3, 0, 0], [6, 0, 0]], radius=1, view="z", **options)
    for copy in (scene, pickle.loads(pickle.dumps(scene))):
        ids = copy.render(layers="id", size=(80, 60), spp=1).layers["id"]
        assert set(ids.ravel().tolist()) - {spherule.NOTHING, spherule.GROUND} == seen


def test_ids_of_sections_are_their_order():
    sphere = [{"center": [x, 0, 0], "radius": 1} for x in (0, 3, 6)]
    scene = spherule.Scene(sphere=sphere, slice=[{"normal": [-1, 0, 0], "distance": -1.5, "mode": "remove"}])
    ids = scene.render(layers="id", size=(80, 60), spp=1).layers["id"]
    assert set(ids.ravel().tolist()) - {spherule.NOTHING, spherule.GROUND} == {1, 2}


def test_all_layers_at_once_are_those_of_one_after_the_other(cloud):
    names = ["albedo", "normal", "depth", "coverage", "id"]
    scene = spherule.Scene(cloud, radius=0.05)
    whole = scene.render(layers=names, **SMALL).layers
    for name in names:
        assert np.array_equal(whole[name], scene.render(layers=name, **SMALL).layers[name]), name


def test_transparent_pictures_have_alpha(cloud):
    picture = spherule.render(cloud, radius=0.05, background="transparent", **SMALL)
    assert picture.pixels.shape == (40, 60, 4)
    alpha = picture.pixels[..., 3]
    assert alpha.min() == 0 and alpha.max() == 1
    assert picture.encode("png")[25] == 6, "PNG with alpha"
    with pytest.raises(spherule.Error):
        picture.encode("jpg")


def test_pictures_display_and_save_themselves(tmp_path, cloud):
    picture = spherule.render(cloud, radius=0.05, **SMALL)
    assert picture._repr_png_() == picture.encode("png")
    assert np.asarray(picture) is picture.pixels
    for name in ("a.png", "a.exr", "a.jpg", "a.tiff", "a.webp", "a.ppm", "a.PFM"):
        picture.save(tmp_path / name)
        assert (tmp_path / name).read_bytes() == picture.encode(name[2:])
    for name in ("a.bmp", "a"):
        with pytest.raises(spherule.Error, match=rf'{name}"; .*\.ppm, \.pdf or \.svg'):
            picture.save(tmp_path / name)
    with pytest.raises(OSError):
        picture.save(tmp_path / "missing" / "a.png")
    assert sorted(file.name for file in tmp_path.iterdir()) == sorted(
        ["a.png", "a.exr", "a.jpg", "a.tiff", "a.webp", "a.ppm", "a.PFM"]
    )
    codes = picture.srgb()
    ppm = picture.encode("ppm")
    assert ppm.endswith(codes.tobytes()), "the codes of the program's files"
    before = picture.encode("png")
    picture.pixels[:] = 0
    assert picture.encode("png") != before


def test_sizes_on_paper_are_those_of_the_program(program, tmp_path, cloud):
    path = tmp_path / "cloud.npy"
    np.save(path, cloud)
    options = {"size": "30mm", "dpi": 100, "spp": 1, "axes": "top-left", "scale_bar": "0.5"}
    picture = spherule.render(cloud, radius=0.05, **options)
    assert (picture.width, picture.height, picture.dpi) == (118, 89, 100)
    words = ["--size", "30mm", "--dpi", "100", "--spp", "1", "--axes", "top-left", "--scale-bar", "0.5", "--radii", "0.05"]
    subprocess.run([program, "render", path, "-o", tmp_path / "a.pfm", "--quiet", *words], check=True)
    assert picture.encode("pfm") == (tmp_path / "a.pfm").read_bytes()
    at = (png := picture.encode("png")).index(b"pHYs")
    assert int.from_bytes(png[at + 4 : at + 8], "big") == 3937
    assert picture.encode("jpg")[13:16] == bytes([1, 0, 100])
    scene = spherule.Scene(cloud, radius=0.05, lettering={"size": "8pt"}, scale_bar=True, render={"size": (200, 100)})
    assert scene.render(spp=1).dpi == 300, "for letters on paper"
    wide = scene.render(size="1in", spp=1)
    assert (wide.width, wide.height) == (300, 150), "the aspect of the scene"
    assert spherule.render(cloud, radius=0.05, **SMALL).dpi is None
    for wrong in ({"size": "85"}, {"dpi": 0}, {"lettering": {"size": "7px"}}, {"axes": "middle"}, {"scale_bar": 0}):
        with pytest.raises(spherule.Error, match=next(iter(wrong))):
            spherule.render(cloud, radius=0.05, **{**SMALL, **wrong})


def test_refinement_ends_with_the_picture(cloud):
    options = {"radius": 0.05, "size": (120, 90), "spp": 32}
    pictures = list(spherule.refine(cloud, 0.01, **options))
    assert len(pictures) > 1 and not pictures[0].complete
    assert pictures[-1].complete
    assert np.array_equal(pictures[-1].pixels, spherule.render(cloud, **options).pixels)


def test_stop_ends_a_render_from_another_thread(cloud):
    stop = spherule.Stop()
    threading.Timer(0.3, stop.set).start()
    start = time.monotonic()
    picture = spherule.render(cloud, radius=0.05, size=(400, 300), spp=100_000, stop=stop)
    assert time.monotonic() - start < 2
    assert not picture.complete and picture.pixels.max() > 0


def test_other_threads_run_meanwhile(cloud):
    count, done = 0, threading.Event()

    def spin():
        nonlocal count
        while not done.is_set():
            count += 1
            time.sleep(0.001)

    # No interpreter waits for it if the render fails.
    thread = threading.Thread(target=spin, daemon=True)
    thread.start()
    spherule.render(cloud, radius=0.05, size=(300, 200), time=0.5)
    done.set()
    thread.join()
    assert count > 50


def test_renders_of_several_threads_are_equal(cloud):
    scene = spherule.Scene(cloud, radius=0.05)
    pictures = [None] * 4

    def work(row):
        pictures[row] = scene.render(**SMALL).pixels

    threads = [threading.Thread(target=work, args=(row,)) for row in range(4)]
    [thread.start() for thread in threads]
    [thread.join() for thread in threads]
    assert all(np.array_equal(pictures[0], other) for other in pictures)


def test_progress_is_told_and_its_errors_are_raised(cloud):
    told = []
    options = {"radius": 0.05, "size": (150, 100), "spp": 100}
    spherule.render(cloud, progress=lambda *facts: told.append(facts), **options)
    assert told and all(0 <= done <= 1 and rays > 0 and seconds > 0 for done, rays, seconds, _ in told)

    def fail(*_):
        raise RuntimeError("enough")

    with pytest.raises(RuntimeError, match="enough"):
        spherule.render(cloud, progress=fail, **options)


def test_async_renders_leave_the_loop_running(cloud):
    async def both():
        ticks = 0

        async def tick():
            nonlocal ticks
            while True:
                ticks += 1
                await asyncio.sleep(0.005)

        ticking = asyncio.create_task(tick())
        picture = await spherule.render_async(cloud, radius=0.05, size=(300, 200), time=0.3)
        ticking.cancel()
        return ticks, picture

    ticks, picture = asyncio.run(both())
    assert ticks > 10 and picture.complete


def test_cancelled_tasks_end_their_renders(cloud):
    async def cancelled():
        task = asyncio.create_task(spherule.render_async(cloud, radius=0.05, size=(300, 200), spp=1_000_000, stop=None))
        await asyncio.sleep(0.3)
        task.cancel()
        with pytest.raises(asyncio.CancelledError):
            await task

    start = time.monotonic()
    asyncio.run(cancelled())
    assert time.monotonic() - start < 3


def test_pickles_may_have_buffers_between_numbers(cloud):
    scene = spherule.Scene(cloud, radius=0.05)
    buffers = []
    data = pickle.dumps(scene, protocol=5, buffer_callback=buffers.append)
    assert buffers
    moved = [memoryview(b"." + buffer.raw().tobytes())[1:] for buffer in buffers]
    copy = pickle.loads(data, buffers=moved)
    size = {"size": (40, 30), "spp": 2}
    assert np.array_equal(copy.render(**size).pixels, scene.render(**size).pixels)
    empty = np.frombuffer(b".", np.float64, count=0, offset=1).reshape(0, 3)
    with pytest.raises(spherule.Error, match="no particles|no spheres|empty"):
        spherule.Scene(empty, radius=empty[:, 0])


def test_scenes_are_pickled(cloud):
    scene = spherule.Scene(cloud, radius=0.05, kinds=["C", "O"] * 500, preset="glossy", show_cell=True, cell=[1, 1, 1])
    copy = pickle.loads(pickle.dumps(scene))
    assert len(copy) == 1000
    assert np.array_equal(scene.render(**SMALL).pixels, copy.render(**SMALL).pixels)


def test_pages_are_those_of_the_program(program, tmp_path):
    """The same page, but for what the picture's file says of itself."""
    path = tmp_path / "salt.extxyz"
    path.write_text("3\nProperties=id:I:1:species:S:1:pos:R:3:q:R:1\n7 Na 0 0 0 0.5\n9 Cl 3 0 0 -1\n11 K 0 3 1 2\n")
    options = {"size": (48, 36), "spp": 2}
    command = [program, "render", path, "-o", tmp_path / "theirs.html", "--size", "48x36", "--spp", "2", "--quiet"]
    subprocess.run(command, check=True, timeout=60)
    scene = spherule.Scene.load(path)
    scene.save(tmp_path / "mine.html", **options)

    def parts(name):
        page = (tmp_path / name).read_text()
        before, _, rest = page.partition('src="data:image/png;base64,')
        image, _, after = rest.partition('"')
        return before, after, [chunk for chunk in chunks(base64.b64decode(image)) if chunk[0] == b"IDAT"]

    assert parts("mine.html") == parts("theirs.html")
    with pytest.raises(spherule.Error, match="scene.save"):
        scene.render(**options).save(tmp_path / "other.html")
    with pytest.raises(spherule.Error, match="`spp`"):
        scene.save(tmp_path / "scene.toml", spp=2)


def chunks(file):
    """The chunks of a PNG file: kinds and contents."""
    at = 8
    while at < len(file):
        length = int.from_bytes(file[at : at + 4], "big")
        yield file[at + 4 : at + 8], file[at + 8 : at + 8 + length]
        at += 12 + length
