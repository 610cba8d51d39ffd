"""Reads what `grainlab bag export` wrote by readers of other projects, and compares it with the CSV of the same packing.

usage: read_exports.py FOLDER    with the folders csv, vtk, vtkhdf, xyz, lammps in it, one packing each

Positions and radii must be equal bit for bit where the reader holds double precision and
parses exactly, forces to 1e-12 of the
mean.
"""

import csv
import json
import pathlib
import sys

import h5py
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
    reader = vtk.vtkXMLPolyDataReader() if path.suffix == ".vtp" else vtk.vtkHDFReader()
    reader.SetFileName(str(path))
    reader.Update()
    return reader.GetOutput()


def array(data, name):
    return vtk_to_numpy(data.GetArray(name))


for kind, suffix in (("vtk", "vtp"), ("vtkhdf", "vtkhdf")):
    data = poly_data(folder / kind / f"grains_1.{suffix}")
    assert data.GetNumberOfVerts() == len(grains), (kind, data.GetNumberOfVerts())
    same(f"{kind} radii", array(data.GetPointData(), "radius"), radii)
    same(f"{kind} ids", array(data.GetPointData(), "id"), ids)
    same(f"{kind} positions", array(data.GetPointData(), "position_unwrapped"), positions)
    folded = vtk_to_numpy(data.GetPoints().GetData())
    steps = np.linalg.solve(cell, (positions - folded).T)
    assert np.abs(steps - np.round(steps)).max() < 1e-9
    same(f"{kind} cell", array(data.GetFieldData(), "cell"), cell.ravel())
    lines = poly_data(folder / kind / f"contacts_1.{suffix}")
    assert lines.GetNumberOfLines() == len(contacts)
    close(f"{kind} normal forces", array(lines.GetCellData(), "normal_force"), normal_forces)
    close(f"{kind} tangential forces", array(lines.GetCellData(), "tangential_force"), tangential)
    ends = vtk_to_numpy(lines.GetPoints().GetData()).reshape(-1, 2, 3)
    branch = ends[:, 1] - ends[:, 0]
    # The CSV has the normal from j to i.
    assert np.abs(branch / np.linalg.norm(branch, axis=1)[:, None] + contacts[:, 2:5]).max() < 1e-9

with h5py.File(folder / "vtkhdf/grains_1.vtkhdf") as file:
    same("h5py radii", file["VTKHDF/PointData/radius"], radii)
    assert file["grainlab"].attrs["contact_law"] in (b"hertz_mindlin", "hertz_mindlin")

frame = import_file(folder / "xyz/packings.xyz").compute(0)
same("OVITO, extended XYZ, ids", frame.particles.identifiers[...], ids)
rounded("OVITO, extended XYZ, positions", frame.particles.positions[...], positions)
rounded("OVITO, extended XYZ, radii in its precision", frame.particles["Radius"][...], radii)
assert np.array_equal(frame.cell[:, :3], cell)

pipeline = import_file(folder / "lammps/packings.dump")
frame = pipeline.compute(0)
rounded("OVITO, LAMMPS dump, positions", frame.particles.positions[...], positions)
