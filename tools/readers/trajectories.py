#!/usr/bin/env python3
"""Writes the small trajectories and structures of tests/data/particles and the files in tests/data/topologies that name their particles.

    pip install ase MDAnalysis chemfiles h5py mdtraj netCDF4 parmed tables
    tools/readers/trajectories.py
    tools/readers/compare.py --answers        # what MDAnalysis reads from them

Variants of DCD that no program here writes are made from the bytes of one that MDAnalysis wrote. MDAnalysis reads them too, except
for markers of 64 bits: that file is compared with the one it was made from.
"""

import struct
import sys
import warnings
from pathlib import Path

import ase.build
import ase.io
import chemfiles
import h5py
import MDAnalysis
import mdtraj
import netCDF4
import numpy as np
import parmed

DATA = Path(__file__).resolve().parents[2] / "tests/data"
OUT = DATA / "particles"
TOPOLOGIES = DATA / "topologies"
FRAMES = 4
WATERS = 60
EDGES = np.array([14.0, 13.0, 12.0])


def main():
    warnings.simplefilter("ignore")
    TOPOLOGIES.mkdir(exist_ok=True)
    universe = water()
    atoms = universe.atoms
    for name, options in [("water.dcd", {"nsavc": 10, "istart": 100}), ("water.xtc", {}), ("water.trr", {}), ("water.ncdf", {"velocities": True})]:
        with MDAnalysis.Writer(str(OUT / name), len(atoms), **options) as file:
            for _ in universe.trajectory:
                file.write(atoms)
    chemfiles_copies()
    mdtraj_copies()
    small = atoms[:6]
    with MDAnalysis.Writer(str(OUT / "six.xtc"), 6) as file:
        for _ in universe.trajectory:
            file.write(small)
    universe.trajectory[0]
    atoms.write(str(TOPOLOGIES / "water.gro"))
    atoms.write(str(TOPOLOGIES / "water.pdb"))
    atoms.write(str(TOPOLOGIES / "water.pqr"))
    variants((OUT / "water.dcd").read_bytes())
    structures(atoms)
    hdf5()


def water():
    """Water and four sodium ions in a triclinic cell that changes, with velocities."""
    random = np.random.default_rng(24)
    count = 3 * WATERS + 4
    residues = np.concatenate([np.repeat(np.arange(WATERS), 3), np.arange(WATERS, WATERS + 4)])
    universe = MDAnalysis.Universe.empty(count, n_residues=WATERS + 4, atom_resindex=residues,
                                         residue_segindex=[0] * (WATERS + 4), trajectory=True, velocities=True)
    universe.add_TopologyAttr("name", ["OW", "HW1", "HW2"] * WATERS + ["NA"] * 4)
    universe.add_TopologyAttr("resname", ["SOL"] * WATERS + ["NA"] * 4)
    universe.add_TopologyAttr("resid", np.arange(1, WATERS + 5))
    universe.add_TopologyAttr("segid", ["W"])
    universe.add_TopologyAttr("chainID", ["W"] * count)
    universe.add_TopologyAttr("record_type", ["ATOM"] * count)
    universe.add_TopologyAttr("occupancy", np.ones(count))
    universe.add_TopologyAttr("charge", [-0.834, 0.417, 0.417] * WATERS + [1.0] * 4)
    universe.add_TopologyAttr("radius", [1.768, 0.2, 0.2] * WATERS + [1.369] * 4)
    universe.add_TopologyAttr("mass", [15.9994, 1.008, 1.008] * WATERS + [22.98977] * 4)
    oxygen = random.uniform(0, 1, (WATERS, 1, 3)) * EDGES
    shape = np.array([[0, 0, 0], [0.9572, 0, 0], [-0.24, 0.9266, 0]])
    turns = np.linalg.qr(random.normal(size=(WATERS, 3, 3)))[0]
    molecules = (oxygen + np.einsum("wij,aj->wai", turns, shape)).reshape(-1, 3)
    places = np.concatenate([molecules, random.uniform(0, 1, (4, 3)) * EDGES])
    frames = places + np.cumsum(random.normal(0, 0.1, (FRAMES, count, 3)), axis=0)
    cells = np.array([[*(EDGES + 0.125 * step), 90, 80, 70] for step in range(FRAMES)])
    universe.load_new(frames.astype(np.float32), dimensions=cells, velocities=random.normal(0, 1, (FRAMES, count, 3)), dt=2.0)
    return universe


def chemfiles_copies():
    """The same frames by chemfiles, whose DCD has angles of cells where that of MDAnalysis has their cosines."""
    for name in ["chemfiles.xtc", "chemfiles.trr", "chemfiles.dcd"]:
        with chemfiles.Trajectory(str(OUT / "water.dcd")) as source, chemfiles.Trajectory(str(OUT / name), "w") as copy:
            for step in range(source.nsteps):
                copy.write(source.read_step(step))


def mdtraj_copies():
    """The same frames, without a cell in DCD, by mdtraj."""
    frames = mdtraj.formats.DCDTrajectoryFile(str(OUT / "water.dcd")).read()[0]
    with mdtraj.formats.DCDTrajectoryFile(str(OUT / "no_cell.dcd"), "w") as file:
        file.write(frames[:2, :20])
    with mdtraj.formats.NetCDFTrajectoryFile(str(OUT / "no_cell.ncdf"), "w", force_overwrite=True) as file:
        file.write(frames[:2, :20])


def hdf5():
    """H5MD by MDAnalysis; its frames by h5py with the newest structures of HDF5, by mdtraj and as NetCDF 4; a snapshot of Gadget."""
    # A trajectory in memory has no units, which H5MD needs.
    universe = MDAnalysis.Universe(str(TOPOLOGIES / "water.gro"), str(OUT / "water.trr"))
    atoms = universe.atoms
    writer = MDAnalysis.Writer(str(OUT / "water.h5md"), len(atoms), positions=True, velocities=True, compression="gzip")
    for _ in universe.trajectory:
        writer.write(atoms)
    writer.close()
    del writer
    frames = np.array([atoms.positions for _ in universe.trajectory])
    cells = np.array([step.triclinic_dimensions for step in universe.trajectory])
    species = np.array(["ONaH".index(name[0]) for name in atoms.names])
    with h5py.File(OUT / "water_latest.h5md", "w", libver="latest") as file:
        for group, own in [("bulk", slice(0, 180)), ("ions", slice(180, 184))]:
            particles = file.create_group(f"particles/{group}")
            position = particles.create_group("position")
            part = frames[:, own]
            value = position.create_dataset("value", data=part, maxshape=(None, *part.shape[1:]), chunks=(3, min(70, part.shape[1]), 2),
                                            compression="gzip", shuffle=True, fletcher32=True)
            value.attrs["unit"] = "Angstrom"
            position.create_dataset("step", data=5).attrs["offset"] = 100
            names = h5py.enum_dtype({"O": 0, "Na": 1, "H": 3}, basetype="i1")
            particles.create_dataset("species", data=species[own], dtype=names)
            # Names of more than eight links are in a heap.
            for column in "mass charge a b c d e f g h".split():
                particles[column] = np.arange(part.shape[1], dtype="f4")
            box = particles.create_group("box")
            box.attrs["boundary"] = ["periodic", "periodic", "none"]
            edges = box.create_group("edges")
            edges["value"], edges["step"] = cells, position["step"]
    copy = mdtraj.formats.HDF5TrajectoryFile(str(OUT / "water_mdtraj.h5"), "w")
    with mdtraj.formats.DCDTrajectoryFile(str(OUT / "water.dcd")) as source:
        places, lengths, angles = source.read()
    copy.write(places / 10, cell_lengths=lengths / 10, cell_angles=angles)
    copy.close()
    with netCDF4.Dataset(OUT / "water.ncdf") as source, netCDF4.Dataset(OUT / "water_netcdf4.nc", "w", format="NETCDF4") as copy:
        source.set_auto_maskandscale(False)
        for name, dimension in source.dimensions.items():
            copy.createDimension(name, None if dimension.isunlimited() else len(dimension))
        for name, variable in source.variables.items():
            own = copy.createVariable(name, variable.dtype, variable.dimensions, zlib=variable.dtype.kind == "f")
            own.set_auto_maskandscale(False)
            own.setncatts({key: variable.getncattr(key) for key in variable.ncattrs()})
            own[:] = variable[:]
    random = np.random.default_rng(4)
    with h5py.File(OUT / "snapshot.hdf5", "w") as file:
        header = file.create_group("Header")
        header.attrs.update({"BoxSize": 25.0, "Time": 0.5, "NumFilesPerSnapshot": 1, "NumPart_ThisFile": [5, 7, 0, 0, 0, 0]})
        for kind, count in [(0, 5), (1, 7)]:
            part = file.create_group(f"PartType{kind}")
            part["Coordinates"] = random.uniform(0, 25, (count, 3))
            part["Velocities"] = random.normal(size=(count, 3)).astype("f4")
            part["ParticleIDs"] = np.arange(count) + 10 * kind
            if kind == 0:
                part["Density"] = random.uniform(size=count)
    layouts()


def layouts():
    """A snapshot whose columns are the numbers of particles, in every layout and under every index of chunks."""
    count = 90
    numbers = np.arange(count)
    with h5py.File(OUT / "layouts.hdf5", "w", libver="latest") as file:
        part = file.create_group("PartType0")
        part["Coordinates"] = np.stack([numbers, 2 * numbers, -numbers], axis=1).astype("f4")
        options = {
            "fixed": {"maxshape": (count,), "chunks": (7,), "compression": "gzip", "shuffle": True},
            "fixed_raw": {"maxshape": (2 * count,), "chunks": (7,)},
            "extensible": {"maxshape": (None,), "chunks": (1,), "compression": "gzip"},
            "extensible_raw": {"maxshape": (None,), "chunks": (1,)},
            "single": {"maxshape": (count,), "chunks": (count,), "compression": "gzip"},
            "single_raw": {"maxshape": (count,), "chunks": (count,)},
            "lzf": {"maxshape": (count,), "chunks": (40,), "compression": "lzf", "fletcher32": True},
        }
        for name, own in options.items():
            part.create_dataset(name, data=numbers.astype(">i4"), **own)
        table = np.stack([numbers, numbers], axis=1).astype("u2")
        for name, filters in [("tree", {"compression": "gzip"}), ("tree_raw", {})]:
            part.create_dataset(name, data=table, maxshape=(None, None), chunks=(1, 1), **filters)
        # Chunks that are allocated at once are one after another, and compact values are in the header.
        for name, chunks in [("implicit", (7,)), ("compact", None)]:
            properties = h5py.h5p.create(h5py.h5p.DATASET_CREATE)
            if chunks:
                properties.set_chunk(chunks)
                properties.set_alloc_time(h5py.h5d.ALLOC_TIME_EARLY)
            else:
                properties.set_layout(h5py.h5d.COMPACT)
            space = h5py.h5s.create_simple((count,))
            dataset = h5py.h5d.create(part.id, name.encode(), h5py.h5t.NATIVE_DOUBLE, space, properties)
            dataset.write(space, space, numbers.astype("f8"))


def structures(atoms):
    """PQR by MDAnalysis, VASP's formats by ASE, molecules by chemfiles, a PSF topology by ParmEd."""
    atoms[:12].write(str(OUT / "water.pqr"))
    crystal = ase.build.bulk("ZnS", "zincblende", a=5.41, cubic=True)
    ase.io.write(OUT / "zns.poscar", crystal, format="vasp", direct=True)
    ase.io.write(OUT / "zns_cartesian.poscar", crystal, format="vasp", direct=False)
    frames = []
    for step in range(3):
        frame = crystal.copy()
        frame.rattle(0.05, seed=step)
        frames.append(frame)
    ase.io.write(OUT / "zns.xdatcar", frames, format="vasp-xdatcar")
    ase.io.write(OUT / "zns.xsf", frames[0], format="xsf")
    ase.io.write(OUT / "zns.axsf", frames, format="xsf")
    ase.io.write(OUT / "zns.cfg", frames[0], format="cfg")
    for suffix in ["sdf", "mol2"]:
        with chemfiles.Trajectory(str(OUT / f"molecules.{suffix}"), "w") as file:
            for name in ["CH3CH2OH", "C6H6"]:
                molecule = ase.build.molecule(name)
                frame = chemfiles.Frame()
                for symbol, place in zip(molecule.get_chemical_symbols(), molecule.positions):
                    frame.add_atom(chemfiles.Atom(symbol), place)
                file.write(frame)
    topology = parmed.load_file(str(TOPOLOGIES / "water.pdb"))
    for own, atom in zip(topology.atoms, atoms):
        own.charge, own.mass, own.type = atom.charge, atom.mass, atom.name
    topology.box = None
    parmed.charmm.CharmmPsfFile.from_structure(topology).write_psf(str(TOPOLOGIES / "water.psf"))
    (TOPOLOGIES / "water.parm7").write_text(amber(topology))


def amber(topology):
    """The sections of a topology of AMBER that tell atoms, residues and bonds; parmed writes none without a force field."""
    atoms, residues = topology.atoms, topology.residues
    bonds = [[3 * bond.atom1.idx, 3 * bond.atom2.idx, 1] for bond in topology.bonds]
    sections = [
        ("TITLE", "20a4", ["water"]),
        ("POINTERS", "10I8", [len(atoms), 1, len(bonds), 0] + [0] * 7 + [len(residues)] + [0] * 20),
        ("ATOM_NAME", "20a4", [atom.name for atom in atoms]),
        ("CHARGE", "5E16.8", [atom.charge * 18.2223 for atom in atoms]),
        ("ATOMIC_NUMBER", "10I8", [atom.atomic_number for atom in atoms]),
        ("MASS", "5E16.8", [atom.mass for atom in atoms]),
        ("RESIDUE_LABEL", "20a4", [residue.name for residue in residues]),
        ("RESIDUE_POINTER", "10I8", [residue.atoms[0].idx + 1 for residue in residues]),
        ("BONDS_INC_HYDROGEN", "10I8", sum(bonds, [])),
        ("BONDS_WITHOUT_HYDROGEN", "10I8", []),
        ("AMBER_ATOM_TYPE", "20a4", [atom.type for atom in atoms]),
    ]
    text = "%VERSION  VERSION_STAMP = V0001.000  DATE = 01/01/26  00:00:00\n"
    for name, form, values in sections:
        count, style = {"20a4": (20, "{:<4}"), "10I8": (10, "{:8d}"), "5E16.8": (5, "{:16.8E}")}[form]
        words = [style.format(value) for value in values]
        rows = ["".join(words[at:at + count]) for at in range(0, len(words), count)] or [""]
        text += f"%FLAG {name:<74}\n%FORMAT({form})\n" + "\n".join(rows) + "\n"
    return text


def records(data):
    """The Fortran records of a file with 32-bit markers."""
    at = 0
    while at < len(data):
        length, = struct.unpack_from("<i", data, at)
        yield data[at + 4:at + 4 + length]
        at += length + 8


def variants(data):
    """DCD files in another byte order, with other markers, and with fixed atoms."""
    def written(name, parts, order="<", marker="i"):
        (OUT / name).write_bytes(b"".join(
            struct.pack(order + marker, len(part)) + part + struct.pack(order + marker, len(part)) for part in parts))

    def swapped(part, size, start=0):
        numbers = part[start:]
        return part[:start] + b"".join(numbers[at:at + size][::-1] for at in range(0, len(numbers), size))

    parts = list(records(data))
    head, title, count, frames = parts[0], parts[1], parts[2], parts[3:]
    written("wide_markers.dcd", parts, marker="q")
    big = [swapped(head, 4, 4), swapped(title[:4], 4) + title[4:], swapped(count, 4)]
    big += [swapped(part, 8 if len(part) == 48 else 4) for part in frames]
    written("big_endian.dcd", big, order=">")
    # Every third atom moves.
    atoms, = struct.unpack("<i", count)
    free = np.arange(2, atoms, 3)
    words = list(struct.unpack("<20i", head[4:]))
    words[8] = atoms - len(free)
    fixed = [head[:4] + struct.pack("<20i", *words), title, count, struct.pack(f"<{len(free)}i", *(free + 1))]
    for place, part in enumerate(frames):
        if place > 3 and len(part) != 48:
            part = np.frombuffer(part, "<f4")[free].tobytes()
        fixed.append(part)
    written("fixed_atoms.dcd", fixed)


if __name__ == "__main__":
    sys.exit(main())
