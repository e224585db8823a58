"""The manuals: every block of Python runs, and every key of scene files is a typed argument."""

import importlib.util
import re
import typing
from pathlib import Path

import numpy as np
import pytest

from spherule import _options, _program, _toml, sections

MANUAL = Path(__file__).parents[2] / "docs" / "python.md"


@pytest.mark.filterwarnings("ignore")
def test_the_examples_of_the_manual_run(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("run.lammpstrj").write_text(
        "ITEM: TIMESTEP\n5\nITEM: NUMBER OF ATOMS\n1\nITEM: BOX BOUNDS pp pp pp\n0 4\n0 5\n0 5\n"
        "ITEM: ATOMS id type x y z q\n1 1 0 0 0 0.5\n"
    )
    atoms = [("CA", "GLY A   1", 0.0), ("C1", "LIG B   2", 4.0), ("O1", "LIG B   2", 5.2), ("O", "HOH C   3", 9.0)]
    Path("complex.pdb").write_text(
        "".join(
            f"ATOM  {row:5}  {name:<3} {residue}    {x:8.3f}   0.000   0.000  1.00  0.00           {name[0]}\n"
            for row, (name, residue, x) in enumerate(atoms, 1)
        )
    )
    blocks = re.findall(r"```python\n(.*?)```", MANUAL.read_text(), re.S)
    assert len(blocks) == 9
    rng = np.random.default_rng(4)
    names = {"origins": rng.random((9, 3)), "directions": rng.normal(size=(9, 3))}
    for block in blocks:
        if "IPython" in block:
            pytest.importorskip("IPython")
        if "Viewer" in block and not (_program.find() and importlib.util.find_spec("anywidget")):
            continue
        # Fewer samples than one would look at.
        exec(block.replace("picture(spp=64)", "picture()"), names)
    assert Path("cloud.png").is_file() and Path("gold.csv").is_file() and names["hits"].t.shape == (9,)
    assert len(names["seen"]) > 100 and names["positions"][names["seen"], 0].min() > 0.5


def documented():
    """The keys of each section of scene files, by the tables of their manual; and those that take a few words."""
    text = (MANUAL.parents[1] / "scenes" / "README.md").read_text()
    keys, words = {}, {}
    for name, body in re.findall(r"^## `\[+([a-z_]+)(?:\.NAME)?\]+`\n(.*?)(?=^## )", text, re.M | re.S):
        table = re.search(r"^\| key \|.*?(?=\n\n)", body, re.M | re.S)
        rows = [row.split("|") for row in table[0].splitlines()[2:]]
        keys[name] = {key for row in rows for key in re.findall(r"`(\w+)`", row[1])}
        for row in rows:
            if len(row) == 6 and re.fullmatch(r' `"[^"]*"`(, `"[^"]*"`)* ', row[3]):
                words[name, row[1].strip(" `")] = set(re.findall(r'"([^"]*)"', row[3]))
    top = {re.search(r"[a-z_]+", key)[0] for key in re.findall(r"^\| (?:\[)?`([^`]+)`", text.split("## ")[2], re.M)}
    return keys, words, top


def literals(annotation):
    if typing.get_origin(annotation) is typing.Literal:
        return set(typing.get_args(annotation))
    return set().union(*(literals(part) for part in typing.get_args(annotation)))


def test_every_key_of_scene_files_is_a_typed_argument():
    keys, words, top = documented()
    assert len(keys) == 24 and len(words) > 8 and top == {"title", *keys}
    # `color_bar` takes more than its section; `from`, a keyword of Python, cannot be a key of these classes.
    assert set(typing.get_type_hints(sections.Sections)) | {"color_bar"} == top
    assert _options.SECTIONS | {"color_bar"} == top and _options.RENDER == keys["render"]
    bodies = {"sphere", "stick", "ellipsoid", "cone", "triangle", "mesh"}
    assert set(_toml.LISTS) == {"slice", "light", "label", "measure", "generate", "file", "style"} | bodies
    for name, expected in keys.items():
        hints = typing.get_type_hints(getattr(sections, name.title().replace("_", "")))
        assert set(hints) == expected - {"from"}, name
        for key in hints:
            if (name, key) in words and (found := literals(hints[key])):
                assert found == words[name, key], (name, key)
