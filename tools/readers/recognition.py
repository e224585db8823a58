#!/usr/bin/env python3
"""Counts which of the test files of five readers Spherule recognizes and reads, beside those readers on their own files.

    pip install ase chemfiles gemmi MDAnalysis openbabel-wheel
    cargo build --release
    tools/readers/recognition.py FOLDER [--spherule PROGRAM] [--verbose]

The source packages are fetched from PyPI into the folder, if they are not there. Files of particles are told by their extensions;
of each package and extension the first hundred by name are taken. A file is

    read      its particles, or as a topology;
    named     not read, but the message says its format and a command that converts it;
    refused   its format is recognized, but not its content, with a message;
    unknown   its format is not recognized.

The last columns are the files that the package's own reader reads, and those of which it and Spherule read as many atoms.
"""

import argparse
import json
import multiprocessing
import re
import subprocess
import sys
import tarfile
import urllib.parse
import urllib.request
import warnings
from collections import Counter, defaultdict
from pathlib import Path

HERE = Path(__file__).resolve().parent
PACKAGES = ["ase", "chemfiles", "gemmi", "MDAnalysisTests", "openbabel"]
EXTENSIONS = set(
    "arc bcif car cfg cif cml coor crd cube data dcd dms dump ent extxyz g96 gro gsd h5md inpcrd lammpstrj mdcrd mdl mmcif mmtf mol mol2 "
    "nc ncdf ncrst parm7 pdb pdbqt poscar pqr prmtop psf rst7 sd sdf tng top traj trj trr trz txyz vasp xdatcar xsf xtc xyz".split())
PACKED = (".gz", ".bz2", ".xz")
MOST = 100
# Inputs that are made to be malformed, and a file of Python's packages.
LEFT_OUT = ("/fuzz", "setup.cfg")
# Seconds that a reader has for a file.
PATIENCE = 60


def main():
    warnings.simplefilter("ignore")
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--spherule", type=Path, default=HERE.parents[1] / "target/release/spherule")
    parser.add_argument("--verbose", action="store_true", help="name the files that are not read, with the messages")
    options = parser.parse_args()
    print("| package | files | read | named | refused | unknown | by its own reader | as many atoms |")
    print("|---|---|---|---|---|---|---|---|")
    for package in PACKAGES:
        counts, reader = Counter(), multiprocessing.Pool(1)
        for file in files(fetch(package, options.folder)):
            outcome, atoms, message = spherule(options.spherule, file)
            try:
                own = reader.apply_async(own_count, (package, file)).get(PATIENCE)
            except multiprocessing.TimeoutError:
                reader.terminate()
                own, reader = None, multiprocessing.Pool(1)
            counts[outcome] += 1
            counts["own"] += own is not None
            counts["both"] += own is not None and atoms is not None
            counts["same"] += own is not None and own == atoms
            if options.verbose and (outcome != "read" or own is not None and own != atoms):
                print(f"{outcome} {file} {atoms} {own} {message}", file=sys.stderr)
        total = sum(counts[outcome] for outcome in ("read", "named", "refused", "unknown"))
        print(f"| {package} | {total} | {counts['read']} | {counts['named']} | {counts['refused']} | {counts['unknown']} | "
              f"{counts['own']} | {counts['same']} of {counts['both']} |")


def fetch(package, folder):
    """The folder of the unpacked source package."""
    target = folder / package
    if not target.exists():
        address = f"https://pypi.org/pypi/{package}/json"
        with urllib.request.urlopen(address, timeout=60) as page:
            source = next(own for own in json.load(page)["urls"] if own["packagetype"] == "sdist")
        archive, _ = urllib.request.urlretrieve(urllib.parse.urljoin(address, source["url"]), folder / source["filename"])
        with tarfile.open(archive) as content:
            content.extractall(target, filter="data")
    return target


def extension(file):
    name = file.name.lower()
    for packed in PACKED:
        name = name.removesuffix(packed)
    return name if name in ("poscar", "contcar", "xdatcar") else name.rpartition(".")[2]


def files(folder):
    """The files of particles, at most a hundred of each extension."""
    kinds = defaultdict(list)
    for file in sorted(folder.rglob("*")):
        if file.is_file() and extension(file) in EXTENSIONS | {"poscar", "contcar", "xdatcar"}:
            if not any(part in str(file) for part in LEFT_OUT):
                kinds[extension(file)].append(file)
    return [file for kind in sorted(kinds) for file in kinds[kind][:MOST]]


def spherule(program, file):
    """What Spherule makes of a file: the outcome, the number of atoms, and the message."""
    try:
        done = subprocess.run([program, "info", file, "--json"], capture_output=True, text=True, timeout=PATIENCE)
    except subprocess.TimeoutExpired:
        return "refused", None, "no answer in a minute"
    if done.returncode == 0:
        return "read", json.loads(done.stdout)["spheres"], ""
    message = done.stderr.strip()
    if "is a topology, without positions" in message:
        return "read", None, message
    if "which is not supported" in message:
        return "named", None, message
    unknown = re.search(r"has an unknown format|is not a text file|is not UTF-8", message)
    return "unknown" if unknown else "refused", None, message.replace("\n", " | ")


def own_count(package, file):
    """The number of atoms that the package's reader finds; none if it fails."""
    try:
        return {"ase": by_ase, "chemfiles": by_chemfiles, "gemmi": by_gemmi, "MDAnalysisTests": by_mdanalysis,
                "openbabel": by_openbabel}[package](file)
    except KeyboardInterrupt:
        raise
    except BaseException:  # Errors of chemfiles are no exceptions of the usual kind.
        return None


def by_ase(file):
    import ase.io
    return len(ase.io.read(file, index=0))


def by_chemfiles(file):
    import chemfiles
    with chemfiles.Trajectory(str(file)) as source:
        return len(source.read().atoms)


def by_gemmi(file):
    import gemmi
    structure = gemmi.read_structure(str(file))
    count = structure[0].count_atom_sites() if len(structure) else 0
    return count or None


def by_mdanalysis(file):
    import MDAnalysis
    return len(MDAnalysis.Universe(str(file), to_guess=()).atoms)


def by_openbabel(file):
    from openbabel import openbabel
    openbabel.obErrorLog.SetOutputLevel(0)
    conversion, molecule = openbabel.OBConversion(), openbabel.OBMol()
    conversion.SetInFormat(openbabel.OBConversion.FormatFromExt(str(file)))
    return (conversion.ReadFile(molecule, str(file)) or None) and molecule.NumAtoms()


if __name__ == "__main__":
    sys.exit(main())
