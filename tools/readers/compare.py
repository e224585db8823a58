#!/usr/bin/env python3
"""Holds Spherule's readers of particle files against other programs: counts, frames, cells, first and last rows.

    pip install ase biotite chemfiles gemmi gsd h5py MDAnalysis plyfile pyyaml
    cargo build --release
    tools/readers/compare.py FOLDER ...       # all files that Spherule reads, folders within them too
    tools/readers/compare.py --answers        # write tests/data/particles/answers.toml

For each file it prints what differs, by file and program. CIF of crystals is read by gemmi and ASE, whose atoms come in another order:
they are compared as sets. It fails if anything differs.
"""

import argparse
import json
import subprocess
import sys
import warnings
from pathlib import Path

import numpy as np

HERE = Path(__file__).resolve().parent
DATA = HERE.parents[1] / "tests/data/particles"
ROWS = 3
# Settings of crystals whose symbols leave the setting open, or are spelled as gemmi does not read them.
SETTINGS = {
    "diamond_fd3m_origin1": "F d -3 m:1",
    "magnetite_fd3m": "F d -3 m:2",
    "scheelite_i41a": "I 41/a:2",
    "scheelite_i41a_origin1": "I 41/a:1",
    "magnesite_r3c": "R -3 c:H",
    "calcite_r3c_rhombohedral": "R -3 c:R",
    "monoclinic_unique_c": "P 1 1 21/b",
    "quartz_p3121": "P 31 2 1",
    "screw_p41": "P 41",
}


class Unread(Exception):
    """A file that a program does not read."""


def main():
    warnings.simplefilter("ignore")
    options = arguments()
    if options.answers:
        return write_answers()
    files = [file for folder in options.folders for file in (sorted(folder.rglob("*")) if folder.is_dir() else [folder])]
    read, different = 0, 0
    for file in files:
        if not file.is_file() or file.suffix in (".py", ".pyc"):
            continue
        try:
            own = spherule(options, file)
        except Unread as fault:
            if options.verbose:
                print(f"- {file}: {fault}")
            continue
        for program in programs(file, own["format"]):
            try:
                other = program(file)
            except Exception as fault:
                if options.verbose:
                    print(f"- {file}: {program.__name__}: {str(fault).splitlines()[:1]}")
                continue
            read += 1
            faults = list(differences(own, other))
            different += bool(faults)
            for fault in faults:
                print(f"{file} ({own['format']}, {program.__name__}): {fault}")
    print(f"{read} comparisons, {different} with differences")
    return 1 if different else 0


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folders", nargs="*", type=Path)
    parser.add_argument("--spherule", type=Path, default=HERE.parents[1] / "target/release/spherule")
    parser.add_argument("--answers", action="store_true", help="write answers.toml instead")
    parser.add_argument("--verbose", action="store_true", help="name the files that are not compared, too")
    return parser.parse_args()


def spherule(options, file):
    own = spherule_frame(options, file, "first")
    if own["format"] in ("dcd", "xtc", "trr", "netcdf", "hdf5", "ase") or file.suffix == ".yaml":
        last = spherule_frame(options, file, "last")
        own |= {"last_frame": last["rows"], "last_cell": last["cell"]}
    return own


def spherule_frame(options, file, frame):
    rows = "1000000" if ".cif" in file.name else str(ROWS)
    command = [options.spherule, "info", file, "--json", "--rows", rows, "--frame", frame]
    done = subprocess.run(command, capture_output=True, text=True, timeout=600)
    if done.returncode:
        raise Unread(done.stderr.strip().splitlines()[:1])
    info = json.loads(done.stdout)
    particles = info["particles"]
    if particles is None:
        raise Unread("is a scene")
    # Lengths in angstrom, as the other programs have them.
    scale = {"nanometer": 10.0, "bohr": 0.529177210544}.get(particles["unit"], 1.0)
    cell = particles["cell"]
    rows = particles["rows"]
    return {
        "format": particles["format"],
        "frames": particles["frames"],
        "count": info["spheres"],
        "cell": None if cell is None else np.array(cell["vectors"]) * scale,
        "rows": np.array([row["position"] for row in rows["first"] + rows["last"]]) * scale,
        "any_order": particles["format"] == "cif",
        "warnings": info["warnings"],
    }


def differences(own, other):
    if own["frames"] is not None and other["frames"] is not None and own["frames"] != other["frames"]:
        yield f"{own['frames']} frames, not {other['frames']}"
    if own["count"] != other["count"]:
        yield f"{own['count']} atoms, not {other['count']} {own['warnings']}"
        return
    cells = [cell for cell in (own["cell"], other["cell"]) if cell is not None]
    if len(cells) == 1:
        yield f"cell {own['cell']}, not {other['cell']}"
    # The axes of other programs may be turned: lengths and angles count.
    elif cells and not np.allclose(cells[0] @ cells[0].T, cells[1] @ cells[1].T, rtol=1e-4, atol=1e-2):
        yield f"cell {cells[0].tolist()}, not {cells[1].tolist()}"
    if "last_frame" in other:
        if not np.allclose(own["last_frame"][:ROWS], other["last_frame"][:ROWS], rtol=1e-4, atol=2e-3):
            yield f"last frame {own['last_frame'].tolist()}, not {other['last_frame'].tolist()}"
        cells = [cell for cell in (own["last_cell"], other["last_cell"]) if cell is not None]
        if len(cells) == 1 or cells and not np.allclose(*cells, rtol=1e-4, atol=1e-2):
            yield f"last cell {own['last_cell']}, not {other['last_cell']}"
    if other["any_order"]:
        if not same_sets(own["rows"], other["rows"], cells[0], cells[-1]):
            yield "other positions"
        return
    rows = np.concatenate([other["rows"][:ROWS], other["rows"][max(ROWS, other["count"] - ROWS):]])
    own_rows = own["rows"]
    if len(own_rows) > 2 * ROWS:
        own_rows = np.concatenate([own_rows[:ROWS], own_rows[-ROWS:]])
    if other["reordered"]:
        return
    if len(own_rows) != len(rows) or len(rows) and not np.allclose(own_rows, rows, rtol=1e-4, atol=2e-3):
        yield f"rows {own_rows.tolist()}, not {rows.tolist()}"


def same_sets(own, other, own_cell, other_cell):
    """Whether two lists of positions are the same but for lattice translations and their order."""
    if len(own) != len(other):
        return False
    own, other = own @ np.linalg.inv(own_cell), other @ np.linalg.inv(other_cell)
    for place in other:
        away = own - place
        away -= away.round()
        if np.linalg.norm(away @ own_cell, axis=1).min() > 0.02:
            return False
    return True


def programs(file, format):
    return {
        "cif": [by_gemmi_crystal, by_ase],
        "pdb": [by_gemmi, by_mdanalysis],
        "mmcif": [by_gemmi],
        "gro": [by_mdanalysis],
        "xyz": [by_ase, by_mdanalysis],
        "lammps-dump": [by_yaml] if file.suffix == ".yaml" else [by_ase_dump, by_mdanalysis_dump],
        "lammps-data": [by_ase_data],
        "gsd": [by_gsd],
        "ply": [by_plyfile],
        "npy": [by_numpy],
        "npz": [by_numpy],
        "csv": [by_numpy_text],
        "xyzr": [by_numpy_text],
        "dcd": [by_mdanalysis_trajectory],
        "xtc": [by_mdanalysis_trajectory],
        "trr": [by_mdanalysis_trajectory],
        "netcdf": [by_mdanalysis_trajectory],
        "hdf5": [by_h5py if file.suffix in (".h5", ".hdf5", ".nc") or "latest" in file.name else by_mdanalysis_trajectory],
        "pqr": [by_mdanalysis],
        "poscar": [by_ase_poscar],
        "xsf": [by_ase_xsf],
        "cfg": [by_ase_cfg],
        "sdf": [by_chemfiles],
        "mol2": [by_chemfiles],
        "bcif": [by_biotite],
        "rst7": [by_mdanalysis_restart],
        "ase": [by_ase_trajectory],
        "namd": [by_mdanalysis_coordinates],
    }[format]


def answer(program, positions, cell=None, frames=1, **more):
    positions = np.asarray(positions, dtype=float)
    return {"program": program, "frames": frames, "count": len(positions), "cell": cell, "rows": positions,
            "any_order": False, "reordered": False} | more


def unpacked(file):
    """The text of a file that may be packed."""
    import bz2
    import gzip
    opener = {".gz": gzip.open, ".bz2": bz2.open}.get(file.suffix, open)
    with opener(file, "rt", encoding="utf-8", errors="replace") as stream:
        return stream.read()


def by_gemmi_crystal(file):
    import gemmi
    block = next(block for block in gemmi.cif.read(str(file)) if block.find_values("_atom_site_fract_x"))
    if file.stem in SETTINGS:
        loop = block.init_loop("_symmetry_equiv_pos_", ["as_xyz"])
        for operation in gemmi.SpaceGroup(SETTINGS[file.stem]).operations():
            loop.add_row([f"'{operation.triplet()}'"])
    structure = gemmi.make_small_structure_from_block(block)
    if structure.symops:
        structure.determine_and_set_spacegroup("s")
    else:
        structure.determine_and_set_spacegroup("h2n" if structure.spacegroup_hm else "an")
    sites = structure.get_all_unit_cell_sites()
    cell = np.array(structure.cell.orth.mat.tolist()).T
    positions = np.array([structure.cell.orthogonalize(site.fract).tolist() for site in sites])
    keep = greatest([site.occ for site in sites], positions, cell)
    elements = [sites[at].element.name for at in keep]
    return answer(f"gemmi {gemmi.__version__}", positions[keep], cell, None, any_order=True, elements=elements)


def greatest(occupancies, positions, cell):
    """Of the positions that are shared, those of the greatest occupancy."""
    keep = []
    for at in np.argsort(-np.array(occupancies), kind="stable"):
        away = (positions[keep] - positions[at]) @ np.linalg.inv(cell)
        away = (away - away.round()) @ cell
        if not len(keep) or np.linalg.norm(away, axis=1).min() > 0.1:
            keep.append(at)
    return sorted(keep)


def by_gemmi(file):
    import gemmi
    structure = gemmi.read_structure(str(file))
    model = structure[0]
    kept = []
    for chain in model:
        residues = {}
        for residue in chain:
            for atom in residue:
                residues.setdefault(str(residue.seqid), []).append((residue.name, atom))
        for atoms in residues.values():
            kept += main_conformer(atoms)
    if not kept:
        raise Unread("no atoms")
    kept.sort(key=lambda atom: atom.serial)
    cell = structure.cell
    has_cell = cell.is_crystal()
    matrix = np.array(cell.orth.mat.tolist()).T if has_cell else None
    return answer(f"gemmi {gemmi.__version__}", [atom.pos.tolist() for atom in kept], matrix, len(structure))


def main_conformer(atoms):
    """The atoms of a residue without those at alternate locations of lesser occupancy."""
    means = {}
    for _, atom in atoms:
        if atom.has_altloc():
            means.setdefault(atom.altloc, []).append(atom.occ)
    if not means:
        return [atom for _, atom in atoms]
    order = sorted(means, key=lambda altloc: -np.mean(means[altloc]))
    main = next(name for name, atom in atoms if atom.altloc == order[0])
    best = {}
    for name, atom in atoms:
        if atom.has_altloc() and name == main:
            other = best.get(atom.name)
            if other is None or order.index(atom.altloc) < order.index(other.altloc):
                best[atom.name] = atom
    chosen = {id(atom) for atom in best.values()}
    return [atom for _, atom in atoms if not atom.has_altloc() or id(atom) in chosen]


def by_ase(file, **options):
    import ase
    import ase.io
    frames = ase.io.read(file, index=":", **options)
    atoms = frames[0]
    cell = atoms.cell.array if atoms.cell.rank == 3 else None
    crystal = ".cif" in file.name
    return answer(f"ASE {ase.__version__}", atoms.positions, cell, None if crystal else len(frames), any_order=crystal,
                  elements=atoms.get_chemical_symbols())


def by_ase_poscar(file):
    return by_ase(file, format="vasp-xdatcar" if "Direct configuration" in unpacked(file) else "vasp")


def by_ase_xsf(file):
    return by_ase(file, format="xsf")


def by_ase_cfg(file):
    return by_ase(file, format="cfg")


def by_chemfiles(file):
    import chemfiles
    with chemfiles.Trajectory(str(file)) as source:
        # Positions are a view of the frame.
        frame = source.read()
        return answer(f"chemfiles {chemfiles.__version__}", frame.positions.copy(), None, source.nsteps)


def by_ase_dump(file):
    return by_ase(file, format="lammps-dump-text", order=False)


def by_ase_data(file):
    import re
    style = re.search(r"^Atoms\s*#\s*(\S+)", unpacked(file), re.M)
    if not style:
        raise Unread("no atom style")
    return by_ase(file, format="lammps-data", atom_style=style[1], sort_by_id=False)


def by_mdanalysis(file, **options):
    import MDAnalysis
    universe = MDAnalysis.Universe(str(file), **options)
    cell = universe.trajectory.ts.triclinic_dimensions
    return answer(f"MDAnalysis {MDAnalysis.__version__}", universe.atoms.positions, cell, len(universe.trajectory))


def by_mdanalysis_trajectory(file):
    """The first and the last frame of a trajectory. MDAnalysis writes an index beside it, so it reads a copy."""
    import MDAnalysis
    import shutil
    import tempfile
    if file.name == "wide_markers.dcd":
        # It does not read markers of 64 bits: the file has the frames of another.
        file = file.with_name("water.dcd")
    with tempfile.TemporaryDirectory() as folder:
        copy = shutil.copy(file, folder)
        universe = MDAnalysis.Universe(copy, copy, topology_format="MINIMAL")
        cell = universe.trajectory.ts.triclinic_dimensions
        positions = universe.atoms.positions.copy()
        count = len(universe.trajectory)
        universe.trajectory[-1]
        return answer(f"MDAnalysis {MDAnalysis.__version__}", positions, cell, count, last_frame=universe.atoms.positions.copy(),
                      last_cell=universe.trajectory.ts.triclinic_dimensions)


def by_h5py(file):
    """Conventions that MDAnalysis does not read: several groups of H5MD, and those of Amber and of Gadget."""
    import h5py
    with h5py.File(file) as data:
        program = f"h5py {h5py.__version__}"
        if "PartType0" in data:
            places = np.concatenate([data[name]["Coordinates"][:] for name in data if name.startswith("PartType")])
            cell = np.eye(3) * data["Header"].attrs["BoxSize"] if "Header" in data else None
            return answer(program, places, cell, 1)
        if "particles" in data:
            groups = data["particles"].values()
            places = np.concatenate([group["position/value"][:] for group in groups], axis=1)
            cells = next(iter(groups))["box/edges/value"]
            return answer(program, places[0], cells[0], len(places), last_frame=places[-1], last_cell=cells[-1])
        scale = 10.0 if "nano" in str(data["coordinates"].attrs["units"]) else 1.0
        places = data["coordinates"][:] * scale
        cells = [edges_of([*(data["cell_lengths"][frame] * scale), *data["cell_angles"][frame]]) for frame in (0, -1)]
        return answer(program, places[0], cells[0], len(places), last_frame=places[-1], last_cell=cells[1])


def edges_of(lengths):
    from MDAnalysis.lib.mdamath import triclinic_vectors
    return triclinic_vectors(lengths)


def by_mdanalysis_restart(file):
    import MDAnalysis
    from MDAnalysis.coordinates.INPCRD import INPReader
    frame = INPReader(str(file)).ts
    # It does not read the box.
    lengths = [float(word) for word in unpacked(file).splitlines()[-1].split()]
    return answer(f"MDAnalysis {MDAnalysis.__version__}", frame.positions, edges_of(lengths), 1)


def by_mdanalysis_coordinates(file):
    import MDAnalysis
    from MDAnalysis.coordinates.NAMDBIN import NAMDBINReader
    return answer(f"MDAnalysis {MDAnalysis.__version__}", NAMDBINReader(str(file)).ts.positions)


def by_ase_trajectory(file):
    import ase.io
    last = ase.io.read(file, index=-1)
    return by_ase(file) | {"last_frame": last.positions, "last_cell": last.cell.array}


def by_yaml(file):
    import yaml
    frames = [frame for frame in yaml.safe_load_all(unpacked(file)) if frame]

    def positions(frame):
        columns = [frame["keywords"].index(axis) for axis in "xyz"]
        return np.array([[row[column] for column in columns] for row in frame["data"]])

    (x, x_high), (y, y_high), (z, z_high), (xy, xz, yz) = frames[0]["box"]
    x_high, x = x_high - max(0, xy, xz, xy + xz), x - min(0, xy, xz, xy + xz)
    y_high, y = y_high - max(0, yz), y - min(0, yz)
    cell = np.array([[x_high - x, 0, 0], [xy, y_high - y, 0], [xz, yz, z_high - z]])
    return answer(f"PyYAML {yaml.__version__}", positions(frames[0]), cell, len(frames), origin=[x, y, z],
                  last_frame=positions(frames[-1]), last_cell=cell)


def by_biotite(file):
    """BinaryCIF, which biotite decodes to text and gemmi reads."""
    import biotite
    import tempfile
    from biotite.structure.io import pdbx
    text = pdbx.CIFFile({
        block: pdbx.CIFBlock({
            name: pdbx.CIFCategory({
                key: pdbx.CIFColumn(pdbx.CIFData(column.as_array(str)), column.mask and pdbx.CIFData(column.mask.array))
                for key, column in category.items()
            }) for name, category in blocks.items()
        }) for block, blocks in pdbx.BinaryCIFFile.read(str(file)).items()
    })
    with tempfile.NamedTemporaryFile(suffix=".cif", mode="w") as copy:
        text.write(copy.name)
        return by_gemmi(copy.name) | {"program": f"biotite {biotite.__version__}"}


def by_mdanalysis_dump(file):
    # It sorts by ids, and moves the box to the origin.
    return by_mdanalysis(file, topology_format="LAMMPSDUMP", format="LAMMPSDUMP") | {"reordered": True}


def by_gsd(file):
    import gsd.hoomd
    import gsd.version
    with gsd.hoomd.open(file) as frames:
        frame, count = frames[0], len(frames)
    x, y, z, xy, xz, yz = frame.configuration.box
    cell = np.array([[x, 0, 0], [xy * y, y, 0], [xz * z, yz * z, z]])
    origin = -cell.sum(axis=0) / 2
    return answer(f"gsd {gsd.version.version}", frame.particles.position, cell, count, origin=origin,
                  radii=frame.particles.diameter / 2)


def by_plyfile(file):
    import plyfile
    vertex = plyfile.PlyData.read(file)["vertex"]
    return answer("plyfile", np.column_stack([vertex[axis] for axis in "xyz"]))


def by_numpy(file):
    arrays = np.load(file)
    frames, cell, more = 1, None, {}
    if file.suffix == ".npz":
        names = ["position", "positions", "pos", "xyz", "points", "coordinates"]
        places = next(arrays[name] for name in names if name in arrays)
        if "radius" in arrays:
            more["radii"] = arrays["radius"]
        box = arrays.get("box")
        if box is not None and box.shape == (6,):
            x, y, z, xy, xz, yz = box
            cell = np.array([[x, 0, 0], [xy * y, y, 0], [xz * z, yz * z, z]])
            more["origin"] = -cell.sum(axis=0) / 2
        elif box is not None and box.shape == (3, 3):
            cell = box
    else:
        places = arrays
    if places.ndim == 3:
        places, frames = places[0], len(places)
    return answer(f"NumPy {np.__version__}", places[:, :3], cell, frames, **more)


def by_numpy_text(file):
    text = unpacked(file)
    skip = 1 if file.suffix == ".csv" else 0
    rows = np.loadtxt(text.splitlines(), delimiter="," if skip else None, skiprows=skip, ndmin=2)
    more = {"radii": rows[:, 3]} if rows.shape[1] == 4 else {}
    return answer(f"NumPy {np.__version__}", rows[:, :3], None, 1, **more)


FORMATS = {".h5md": "hdf5", ".h5": "hdf5", ".hdf5": "hdf5", ".nc": "hdf5", ".dcd": "dcd", ".xtc": "xtc", ".trr": "trr", ".ncdf": "netcdf", ".pqr": "pqr", ".poscar": "poscar", ".xdatcar": "poscar", ".sdf": "sdf", ".xsf": "xsf", ".axsf": "xsf", ".cfg": "cfg",
           ".mol2": "mol2",
           ".extxyz": "xyz", ".xyz": "xyz", ".data": "lammps-data", ".lammpstrj": "lammps-dump", ".gro": "gro", ".pdb": "pdb",
           ".gsd": "gsd", ".ply": "ply", ".npy": "npy", ".npz": "npz", ".csv": "csv", ".txt": "xyzr", ".cif": "cif",
           ".bcif": "bcif", ".rst7": "rst7", ".traj": "ase", ".coor": "namd", ".yaml": "lammps-dump"}


def write_answers():
    """Writes what other programs read from each file, beside the files."""
    lines = ["# Written by tools/readers/compare.py --answers; lengths in angstrom where the format has a unit."]
    for file in sorted(DATA.iterdir()):
        format = FORMATS.get(file.suffix)
        if format is None or file.name in ("answers.toml", "space_groups.csv"):
            continue
        if format == "cif" and "_atom_site.Cartn_x" in file.read_text():
            format = "mmcif"
        found = first_answer(file, format)
        lines += ["", "[[file]]", f'name = "{file.name}"', f'format = "{format}"', f'program = "{found["program"]}"']
        if found["frames"] is not None:
            lines.append(f"frames = {found['frames']}")
        lines.append(f"count = {found['count']}")
        if found["cell"] is not None:
            lines.append(f"cell = {rounded(found['cell'])}")
        if "origin" in found:
            lines.append(f"origin = {rounded(found['origin'])}")
        rows = found["rows"]
        if found["any_order"]:
            lines.append("any_order = true")
            lines.append(f"elements = {json.dumps(found['elements'])}")
            lines.append(f"first = {rounded(rows)}")
        else:
            lines += [f"first = {rounded(rows[:ROWS])}", f"last = {rounded(rows[-ROWS:])}"]
            if "last_frame" in found:
                lines.append(f"last_frame = {rounded(found['last_frame'][:ROWS])}")
            if found.get("last_cell") is not None:
                lines.append(f"last_cell = {rounded(found['last_cell'])}")
            if "radii" in found:
                lines.append(f"radii = {rounded(found['radii'][:ROWS])}")
    (DATA / "answers.toml").write_text("\n".join(lines) + "\n")
    return 0


def first_answer(file, format):
    """What the first program that reads the file reads from it."""
    faults = []
    for program in programs(file, format):
        try:
            return program(file)
        except Exception as fault:
            faults.append(f"{program.__name__}: {fault}")
    raise SystemExit(f"{file}: {faults}")


def rounded(values):
    return json.dumps((np.asarray(values, dtype=float).round(5) + 0.0).tolist())


if __name__ == "__main__":
    sys.exit(main())
