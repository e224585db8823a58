"""The examples with other packages, which run with small pictures where the package is there."""

import shutil
import runpy
from pathlib import Path

import pytest

import spherule

EXAMPLES = Path(__file__).parents[1] / "examples"


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize(
    ("name", "package"),
    [
        ("molecule_ase", "ase"),
        ("order_freud", "freud"),
        ("peptide_mdtraj", "mdtraj"),
        ("structure_pymatgen", "pymatgen.core"),
        ("trajectory_mdanalysis", "MDAnalysis"),
    ],
)
def test_examples_with_other_packages_run(name, package, tmp_path, monkeypatch):
    pytest.importorskip(package)
    render = spherule.render

    def small(*values, **options):
        return render(*values, **{**options, "size": (60, 48), "spp": 1, "denoise": "off"})

    monkeypatch.setattr(spherule, "render", small)
    script = tmp_path / f"{name}.py"
    shutil.copy(EXAMPLES / script.name, script)
    runpy.run_path(str(script), run_name="__main__")
    assert script.with_suffix(".png").stat().st_size > 500
