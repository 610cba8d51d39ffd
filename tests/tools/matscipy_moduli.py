#!/usr/bin/env python3
"""Moduli of a packing of equal smooth spheres by matscipy, with and without the term of the normal forces.

Usage: matscipy_moduli.py PACKING.csv[.gz] OUT.csv. Needs `pip install matscipy==1.3.1`. The Hertzian potential is typed in; what matscipy
computes of it are the pairs, the Hessian, the affine second derivative and the non-affine forces. The linear system is solved by scipy's
sparse factorisation.
"""

import csv
import gzip
import json
import sys
from pathlib import Path

import numpy as np
from ase import Atoms
from matscipy.calculators.pair_potential import PairPotential
from matscipy.calculators.pair_potential.calculator import CutoffInteraction
from scipy.sparse.linalg import splu

VOIGT = [(0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1)]
# matscipy works with numbers of the order of 1: lengths in diameters, stresses in units of E*.
CUTOFF = 1.0


class Hertz(CutoffInteraction):
    """U = (8/15) E* sqrt(R*) (d - r)^(5/2) of spheres of diameter d = 1, R* = 1/4, E* = 1; `stressed`: whether the first derivative counts."""

    def __init__(self, stressed):
        super().__init__(CUTOFF)
        self.stressed = stressed

    def __call__(self, r, *_):
        return 8 / 15 * 0.5 * np.maximum(CUTOFF - r, 0) ** 2.5

    def first_derivative(self, r, *_):
        force = 4 / 3 * 0.5 * np.maximum(CUTOFF - r, 0) ** 1.5
        return -force if self.stressed else 0 * force

    def second_derivative(self, r, *_):
        return 2 * 0.5 * np.maximum(CUTOFF - r, 0) ** 0.5


def load(path):
    """Positions (m), radius (m) and the JSON beside the file."""
    opened = gzip.open if path.suffix == ".gz" else open
    with opened(path, "rt") as lines:
        rows = [line.split(",") for line in lines if line.startswith("p,")]
    sidecar = path.parent / (path.name.split(".")[0] + ".json")
    values = np.array([[float(x) for x in row[2:6]] for row in rows])
    assert np.ptp(values[:, 3]) == 0, "spheres of one size"
    return values[:, :3], values[0, 3], json.loads(sidecar.read_text())


def without_rattlers(atoms):
    """The grains with at least four contacts, counted again until none is left out."""
    from matscipy.neighbours import neighbour_list
    while True:
        count = np.bincount(neighbour_list("i", atoms, CUTOFF), minlength=len(atoms))
        if (count >= 4).all():
            return atoms
        atoms = atoms[count >= 4]


def moduli(atoms, stressed):
    """C in Voigt order, in units of E*: the second derivative of the energy by symmetric strains, relaxed."""
    calculator = PairPotential({(1, 1): Hertz(stressed)})
    atoms.calc = calculator
    hessian = calculator.get_hessian(atoms, "sparse").tocsc()
    pairs, _, _, distance, _ = calculator.get_hessian(atoms, "neighbour-list")
    volume = atoms.get_volume()
    affine = -np.einsum("pac,pb,pd->abcd", pairs, distance, distance) / (2 * volume)
    affine = (affine + affine.transpose(1, 0, 2, 3)) / 2
    affine = (affine + affine.transpose(0, 1, 3, 2)) / 2
    forces = calculator.get_nonaffine_forces(atoms)
    forces = (forces + forces.transpose(0, 1, 3, 2)) / 2
    loads = np.stack([forces[:, :, a, b].ravel() for a, b in VOIGT], axis=1)
    # Three grains' worth of translations, and grains without contacts, are held: the loads have no part there.
    held = np.zeros(hessian.shape[0], bool)
    held[:3] = True
    held |= hessian.diagonal() == 0
    free = np.flatnonzero(~held)
    inner = hessian[free][:, free].tocsc()
    solver = splu(inner)
    motion = solver.solve(loads[free])
    for _ in range(3):
        motion += solver.solve(loads[free] - inner @ motion)
    relaxed = np.array([[affine[a, b, c, d] for c, d in VOIGT] for a, b in VOIGT])
    return relaxed - loads[free].T @ motion / volume


def main():
    positions, radius, sidecar = load(Path(sys.argv[1]))
    diameter = 2 * radius
    cell = np.array(sidecar["cell"]).T / diameter
    e_star = sidecar["G"] / (1 - sidecar["nu"])
    atoms = Atoms("H" * len(positions), positions=positions / diameter, cell=cell, pbc=True)
    with open(sys.argv[2], "w", newline="") as out:
        out.write("# matscipy 1.3.1, by tests/tools/matscipy_moduli.py: C of the packing beside, Voigt order xx yy zz yz xz xy, Pa.\n")
        out.write("# Six rows without the term of the normal forces, then six with it, without rattlers.\n")
        rows = csv.writer(out, lineterminator="\n")
        for stressed, grains in ((False, atoms), (True, without_rattlers(atoms))):
            for row in moduli(grains, stressed) * e_star:
                rows.writerow([repr(float(c)) for c in row])


if __name__ == "__main__":
    main()
