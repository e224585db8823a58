"""The wheel of a release: its files, and its processor levels. tools/release names it in SPHERULE_WHEEL."""

import base64
import csv
import hashlib
import io
import os
import re
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

import spherule

pytestmark = pytest.mark.skipif("SPHERULE_WHEEL" not in os.environ, reason="SPHERULE_WHEEL names no wheel")


@pytest.fixture(scope="module")
def wheel():
    with zipfile.ZipFile(os.environ["SPHERULE_WHEEL"]) as wheel:
        yield wheel


def info(wheel, name):
    """A file that tells what the wheel is."""
    return next(wheel.read(own) for own in wheel.namelist() if own.endswith(f".dist-info/{name}"))


def python(code, **environment):
    """What a Python says that has nothing of this environment."""
    return subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, env=environment, timeout=120)


def levels():
    folder = Path(spherule.__file__).parent / "_levels"
    if not folder.is_dir():
        pytest.skip("a wheel of one level")
    others = [path.name for path in folder.iterdir() if (path / "_spherule.abi3.so").is_file()]
    return [python("import spherule; print(spherule.level())", SPHERULE_LEVEL="v2").stdout.strip(), *sorted(others)]


def test_all_is_in_it(wheel):
    names = wheel.namelist()
    for name in ("py.typed", "_spherule.pyi", "_spherule.abi3.so", "__init__.py", "friends.py", "sections.py"):
        assert f"spherule/{name}" in names
    for name in ("LICENSE-MIT", "LICENSE-APACHE", "THIRD-PARTY-LICENSES.txt"):
        assert any(own.endswith(f".dist-info/licenses/{name}") for own in names), name
    assert any(own.endswith(".data/scripts/spherule") for own in names)
    facts = info(wheel, "METADATA").decode()
    assert "Requires-Python: >=3.10" in facts and "Requires-Dist: numpy>=1.23" in facts


def test_records_and_tags_hold(wheel):
    rows = csv.reader(io.StringIO(info(wheel, "RECORD").decode()))
    recorded = {name: (digest, size) for name, digest, size in rows}
    assert sorted(recorded) == sorted(wheel.namelist())
    for name, (digest, size) in recorded.items():
        if digest:
            content = wheel.read(name)
            found = base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=").decode()
            assert (f"sha256={found}", str(len(content))) == (digest, size), name
    tag = "-".join(Path(os.environ["SPHERULE_WHEEL"]).stem.split("-")[2:])
    assert re.fullmatch(r"cp310-abi3-manylinux_2_\d+_\w+", tag)
    assert f"Tag: {tag}\n" in info(wheel, "WHEEL").decode()


def test_no_paths_of_the_machine_are_in_it(wheel):
    home = str(Path.home())
    paths = {str(Path(__file__).parents[2]), os.environ.get("CARGO_HOME", f"{home}/.cargo"), f"{home}/.rustup"}
    # A check takes what tests have compiled for a level.
    tested = os.environ.get("SPHERULE_TESTED_LEVEL") or "none"
    for name in wheel.namelist():
        if f"/{tested}/" in name or name.endswith(f"-{tested}"):
            continue
        content = wheel.read(name)
        assert not [path for path in paths if path.encode() in content], name


def test_the_highest_level_of_the_processor_is_imported():
    from spherule import _native

    ordered = [level for level in _native.packaged_levels() if level in levels()]
    suited = [level for level in ordered if not _native.missing_features(level)]
    assert len(ordered) > 1 and python("import spherule; print(spherule.level())").stdout.strip() == suited[0]


def test_levels_render_the_same_bytes():
    from spherule import _native

    code = """if True:
        import hashlib, numpy as np, spherule
        rng = np.random.default_rng(1)
        positions, radius = rng.random((2000, 3), dtype=np.float32), rng.uniform(0.01, 0.05, 2000)
        picture = spherule.render(
            positions, radius=radius, values=positions[:, 2], preset="glossy", size=(160, 120), spp=8, denoise="on",
            layers=["normal", "id"],
        )
        tree = spherule.SphereTree(positions, radius)
        hits = tree.intersect(positions, rng.normal(size=(2000, 3)), surface=True)
        digest = hashlib.sha256(picture.pixels.tobytes())
        for array in (*picture.layers.values(), *hits):
            digest.update(array.tobytes())
        print(spherule.level(), digest.hexdigest())
    """
    found = {}
    for level in levels():
        if missing := _native.missing_features(level):
            refused = python("import spherule; spherule.level()", SPHERULE_LEVEL=level)
            assert refused.returncode != 0 and missing[0] in refused.stderr
            continue
        forced, digest = python(code, SPHERULE_LEVEL=level).stdout.split()
        assert forced == level
        found[level] = digest
    assert len(found) > 1 and len(set(found.values())) == 1, found


def test_unknown_levels_are_refused():
    refused = python("import spherule; spherule.level()", SPHERULE_LEVEL="v9")
    assert refused.returncode != 0 and "SPHERULE_LEVEL is `v9`; use one of v2, " in refused.stderr


def test_the_program_is_its_script():
    script = Path(sys.executable).parent / "spherule"
    for command in ([script], [sys.executable, "-m", "spherule"]):
        run = subprocess.run([*command, "--version"], check=True, capture_output=True, text=True, env={}, timeout=60)
        assert run.stdout == f"spherule {spherule.__version__}\n"
