"""The viewer in notebooks: what comes through its pipe, its traits, and a notebook in a real browser."""

import json
import os
import re
import shutil
import subprocess
import sys
import threading
import time
from pathlib import Path

import numpy as np
import pytest

import spherule
from spherule import _toml, _viewer
from spherule._session import Session

SALT = """4
Properties=id:I:1:species:S:1:pos:R:3:q:R:1
11 Na 0 0 0 1
12 Cl 3 0 0 -1
13 Cl 0 3 0 -2
14 K 0 0 3 1
"""


@pytest.fixture
def salt(tmp_path, program, monkeypatch):
    """A file of two frames, and the program to view it with."""
    monkeypatch.setenv("SPHERULE", program)
    path = tmp_path / "salt.extxyz"
    path.write_text(SALT + SALT.replace("3 0 0 -1", "4 0 0 -1"))
    return path


def heard(words):
    """A session, with what it says: texts, headers of images, and whether it has ended."""
    texts, images, ended = [], [], threading.Event()

    def receive(content):
        end = 4 + int.from_bytes(content[:4], "little")
        images.append((json.loads(content[4:end]), content[end:]))
        return False

    session = Session(words, lambda _, message: texts.append(message), receive, ended.set)
    return session, texts, images, ended


def test_a_session_sends_states_and_images(salt):
    session, texts, images, ended = heard([str(salt), "--spp", "2"])
    assert session.state["spheres"] == 4 and session.state["frames"] == 2
    assert 'id="view"' in session.page[""] and "#view" in session.page["page.css"]
    session.command("size 40x30", "set color-by q")
    session.wait(lambda: session.state["legend"] and not session.state["busy"], 60)
    told, pixels = session.pixels(2)
    assert told["shape"] == [30, 40, 3] and len(pixels) == 4 * 30 * 40 * 3 and told["samples"] == 2
    session.wait(lambda: any(header["finished"] and header["width"] == 40 for header, _ in images), 60)
    header, files = next((header, files) for header, files in images if header["finished"] and header["width"] == 40)
    assert header["kind"] == "image/png" and files[1:4] == b"PNG"
    for line in ("nonsense", "set output x.png", "set model cubes", "camera 'fov = 200'"):
        with pytest.raises(spherule.Error):
            session.command(line)
    session.close()
    assert ended.wait(60) and any("hello" in message for message in texts)
    with pytest.raises(spherule.Error, match="closed"):
        session.command("key 7")


def test_what_cannot_be_viewed_is_an_error(salt, monkeypatch):
    for words, text in (
        (["nothing.xyz"], "nothing.xyz"),
        ([str(salt), "--color-by", "nope"], "nope"),
        (["--nope"], "--nope"),
    ):
        with pytest.raises(spherule.Error, match=text):
            heard(words)
    monkeypatch.setenv("SPHERULE", "/nowhere/spherule")
    with pytest.raises(spherule.Error, match="/nowhere/spherule"):
        heard([str(salt)])


def test_arguments_are_options_of_the_program_where_it_has_them():
    given = {"color_by": "q", "legend": True, "axes": False, "styles": ["H: color=red", "O: opacity=0.5"], "zoom": 2}
    assert _viewer._words(given) == [
        "--color-by=q", "--legend", "--style=H: color=red", "--style=O: opacity=0.5", "--zoom=2",
    ]  # fmt: skip
    for other in ({"camera": {"fov": 20}}, {"color_range": (0, 1)}, {"color_map": ["red", "blue"]}, {"view": (30, 20)}):
        assert _viewer._words(other) is None


def test_cameras_are_lines():
    camera = {"eye": [1, 2.5, -3e-7], "target": [0, 0, 0], "projection": "orthographic", "height": 4.0}
    assert _viewer._keys(_toml.line("camera", camera)) == camera


def test_without_anywidget_it_says_what_to_install():
    code = "import sys; sys.modules['anywidget'] = None\nimport spherule\ntry: spherule.Viewer()\nexcept spherule.Error as e: print(e)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60, check=True)
    assert "pip install anywidget" in done.stdout


def test_the_viewer_is_not_imported_with_the_package():
    code = (
        "import sys, spherule; print([name for name in sys.modules if name in ('anywidget', 'traitlets', 'asyncio')])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60, check=True)
    assert done.stdout.strip() == "[]"


@pytest.fixture
def viewer(salt):
    pytest.importorskip("anywidget")
    viewer = spherule.Viewer(salt, spp=4, radius="1.2")
    viewer.command("size 64x48")
    yield viewer
    viewer.close()


def test_traits_move_the_view(viewer):
    seen = []
    viewer.observe(lambda change: seen.append(change["new"]), "camera")
    eye = [9.0, 8.0, 7.0]
    viewer.camera = {**viewer.camera, "eye": eye}
    assert viewer.camera["eye"] == eye and seen[0]["eye"] == eye
    viewer.command("turn 90 0")
    assert viewer.camera["eye"] != eye and seen[-1] == viewer.camera
    before = viewer.camera
    with pytest.raises(spherule.Error, match="fov"):
        viewer.camera = {"fov": 200}
    assert viewer.camera == before
    assert viewer.frame == 0
    viewer.frame = 1
    assert viewer.frame == 1
    assert viewer.picture().pixels.shape == (48, 64, 3)


def test_selections_are_set_and_followed(viewer):
    seen = []
    viewer.observe(lambda change: seen.append(change["new"]), "selection")
    viewer.picture()
    viewer.selection = [14, 11]
    assert viewer.selection == [14, 11] and "11" in viewer.picked and len(viewer._session.state["drawn"]["marks"]) == 2
    assert "distance" in viewer._session.state["measures"][0]["text"]
    viewer.command("pick 'q < 0'")
    assert viewer.selection == [12, 13] and seen[-1] == [12, 13]
    with pytest.raises(spherule.Error, match="99"):
        viewer.selection = [11, 99]
    viewer.selection = []
    assert viewer.selection == [] and viewer.picked is None


def test_the_picture_is_that_of_the_camera(viewer, salt):
    picture = viewer.picture(spp=4)
    assert picture.spp == (4, 4) and picture.pixels.dtype == np.float32
    options = {"radius": "1.2", "size": (64, 48), "spp": 4, "denoise": "on" if picture.denoised else "off"}
    rendered = spherule.render(salt, camera=viewer.camera, **options)
    assert picture.encode()[1:4] == b"PNG" and np.array_equal(picture.srgb(), rendered.srgb())


def test_scenes_of_arrays_are_viewed(program, monkeypatch):
    pytest.importorskip("anywidget")
    monkeypatch.setenv("SPHERULE", program)
    viewer = spherule.Viewer([[0, 0, 0], [1, 0, 0]], radius=0.5, color=["tomato", "steelblue"], spp=16)
    viewer.command("size 40x30")
    assert viewer.picture().pixels.std() > 0.01
    for line, count in (("click 14,15", 1), ("click 1,1", 0)):
        viewer.command(line)
        viewer._session.wait(lambda count=count: viewer._apply() or len(viewer.selection) == count, 20)
    viewer.close()
    with pytest.raises(spherule.Error, match="closed"):
        viewer.picture()
    with pytest.raises(spherule.Error, match="`layers`"):
        spherule.Viewer([[0, 0, 0]], layers="all")


def test_a_notebook_shows_it_and_follows_the_mouse(salt, program, tmp_path):
    """JupyterLab in Chromium: the image, a drag that changes the camera, and a cell that moves it."""
    pytest.importorskip("anywidget")
    pytest.importorskip("jupyterlab")
    sync = pytest.importorskip("playwright.sync_api")
    chromium = os.environ.get("CHROMIUM") or shutil.which("chromium") or shutil.which("google-chrome")
    if chromium is None:
        pytest.skip("Chromium is not there; set CHROMIUM to its path")
    import nbformat

    cells = [
        f"import spherule\nviewer = spherule.Viewer({str(salt)!r}, spp=16, color_by='q')\nviewer",
        "print('camera', viewer.camera['eye'], 'frame', viewer.frame)",
        "viewer.frame = 1\nprint('now', viewer.frame, viewer.picture().pixels.shape)",
    ]
    notebook = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(cell) for cell in cells])
    notebook.metadata["kernelspec"] = {"name": "python3", "display_name": "Python 3", "language": "python"}
    nbformat.write(notebook, tmp_path / "view.ipynb")
    package = str(Path(spherule.__file__).parents[1])
    environment = {
        **os.environ,
        "SPHERULE": program,
        "HOME": str(tmp_path / "home"),
        "JUPYTER_PLATFORM_DIRS": "0",
        "PYTHONPATH": os.pathsep.join([package, os.environ.get("PYTHONPATH", "")]),
    }
    log = (tmp_path / "server.log").open("w")
    flags = [
        "--no-browser",
        "--allow-root",
        "--ip=127.0.0.1",
        "--port=0",
        "--ServerApp.password=",
        "--IdentityProvider.token=test",
    ]
    server = subprocess.Popen(
        [sys.executable, "-m", "jupyterlab", *flags], cwd=tmp_path, env=environment, stderr=log, stdout=log
    )
    try:
        address = served(tmp_path / "server.log", server)
        with sync.sync_playwright() as play:
            browser = play.chromium.launch(executable_path=chromium, args=["--no-sandbox", "--disable-gpu"])
            page = browser.new_page(viewport={"width": 1280, "height": 1000})
            page.set_default_timeout(90_000)
            page.goto(f"{address}lab/tree/view.ipynb?token=test")
            page.wait_for_selector(".jp-Notebook .jp-Cell")
            page.wait_for_selector("text=/\\| Idle/")
            page.locator(".jp-Notebook .jp-Cell .cm-content").first.click()
            page.keyboard.press("Shift+Enter")
            canvas = page.locator("#image")
            page.wait_for_function(
                "() => { const own = [...document.querySelectorAll('.jp-OutputArea *')].find(e => e.shadowRoot);"
                " return own?.shadowRoot.getElementById('image').dataset.finished === 'true' }"
            )
            page.keyboard.press("Shift+Enter")
            before = page.locator("text=/camera \\[/").first.inner_text()
            box = canvas.bounding_box()
            x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
            page.mouse.move(x, y)
            page.mouse.down()
            page.mouse.move(x + 80, y + 20, steps=8)
            page.mouse.up()
            # Of the view, not of the notebook: it inserts no cell.
            page.keyboard.press("a")
            page.wait_for_timeout(500)
            assert page.locator(".jp-Notebook .jp-CodeCell").count() == 3
            page.locator(".jp-Notebook .jp-Cell .cm-content").nth(1).click()
            page.keyboard.press("Shift+Enter")
            page.wait_for_function(
                "before => { const all = [...document.querySelectorAll('.jp-OutputArea-output')].map(e => e.innerText);"
                " const own = all.find(text => text.startsWith('camera')); return own && own !== before }",
                arg=before.strip(),
            )
            page.keyboard.press("Shift+Enter")
            page.wait_for_selector("text=/now 1 \\(\\d+, \\d+, 3\\)/")
            if folder := os.environ.get("SPHERULE_SCREENSHOTS"):
                page.wait_for_timeout(1500)
                page.locator(".jp-Notebook .jp-Cell").first.scroll_into_view_if_needed()
                page.screenshot(path=f"{folder}/notebook.png")
            browser.close()
    finally:
        server.terminate()
        server.wait(30)
        log.close()


def served(log, server):
    """The address of a server of Jupyter, from its log."""
    for _ in range(600):
        found = re.search(r"http://127\.0\.0\.1:\d+/", log.read_text())
        if found:
            return found[0]
        assert server.poll() is None, log.read_text()
        time.sleep(0.1)
    raise AssertionError(log.read_text())
