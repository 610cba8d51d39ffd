"""The packing that all codes start from, read from a LAMMPS data file of equal spheres at rest."""

import gzip
import itertools
import math
from collections import defaultdict
from dataclasses import dataclass
from pathlib import Path
from typing import Iterator, Optional

from peers.setting import Setting

Vector = tuple[float, float, float]


class PackingError(Exception):
    """A packing that cannot be used, with file, line and reason."""


@dataclass(frozen=True)
class State:
    """State of a packing that must agree between all codes before the first step."""

    pressure: Optional[float]
    """Pa; None if a code does not print it."""
    coordination: float
    """2 contacts / grains, all grains."""


@dataclass(frozen=True)
class Packing:
    """Equal spheres in a rectangular periodic cell."""

    origin: Vector
    """Lower corner, m."""
    sides: Vector
    """m."""
    radius: float
    """m."""
    density: float
    """kg/m^3."""
    positions: list[Vector]
    """From the lower corner, m, in the order of the file."""

    @staticmethod
    def text(path: Path) -> str:
        """The data file as text, decompressed if its name ends in .gz."""
        try:
            with gzip.open(path, "rt") if path.suffix == ".gz" else open(path) as file:
                return file.read()
        except (OSError, EOFError, UnicodeDecodeError) as error:
            raise PackingError(f"{path}: cannot be read: {error}") from error

    @classmethod
    def read(cls, path: Path) -> "Packing":
        """The packing of a data file (atom_style sphere; `.gz` too)."""
        expected, bounds, rows, inside = None, {}, [], False
        for number, line in enumerate(cls.text(path).splitlines(), 1):
            words = line.split("#")[0].split()
            if number == 1 or not words:
                continue
            try:
                if words[0][0].isalpha():
                    inside = words[0] == "Atoms"
                elif inside:
                    _, _, diameter, density, x, y, z = (float(w) for w in words[:7])
                    rows.append((diameter, density, (x, y, z)))
                elif words[1:] == ["atoms"]:
                    expected = int(words[0])
                elif len(words) == 4 and words[2][1:] == "lo":
                    bounds[words[2][0]] = (float(words[0]), float(words[1]))
                elif words[3:] == ["xy", "xz", "yz"] and any(float(w) for w in words[:3]):
                    raise PackingError(f"{path}:{number}: the box is tilted: LIGGGHTS and YADE get rectangular ones")
            except ValueError as error:
                raise PackingError(f"{path}:{number}: {error} in {line.strip()!r}") from error
        if sorted(bounds) != ["x", "y", "z"]:
            raise PackingError(f"{path}: not a LAMMPS data file: no xlo xhi, ylo yhi, zlo zhi lines")
        if len(rows) != expected or not rows:
            raise PackingError(f"{path}: {len(rows)} atoms found, {expected} announced")
        if len({row[:2] for row in rows}) != 1:
            raise PackingError(f"{path}: grains of several diameters or densities: one of each is supported")
        origin = tuple(bounds[axis][0] for axis in "xyz")
        sides = tuple(bounds[axis][1] - bounds[axis][0] for axis in "xyz")
        positions = [tuple(x - o for x, o in zip(row[2], origin)) for row in rows]
        return cls(origin, sides, 0.5 * rows[0][0], rows[0][1], positions)

    def replicated(self, replicas: int) -> Iterator[Vector]:
        """Positions of the packing repeated `replicas` times along each axis, m."""
        for shift in itertools.product(range(replicas), repeat=3):
            for position in self.positions:
                yield tuple(x + k * side for x, k, side in zip(position, shift, self.sides))

    def write_liggghts(self, path: Path, replicas: int) -> None:
        """A data file for LIGGGHTS' atom_style granular: no tilt line, no image flags."""
        with open(path, "w") as file:
            file.write(f"packing\n\n{len(self.positions) * replicas**3} atoms\n1 atom types\n\n")
            for axis, side in zip("xyz", self.sides):
                file.write(f"0 {replicas * side!r} {axis}lo {axis}hi\n")
            file.write("\nAtoms\n\n")
            for k, (x, y, z) in enumerate(self.replicated(replicas), 1):
                file.write(f"{k} 1 {2 * self.radius!r} {self.density!r} {x!r} {y!r} {z!r}\n")

    def state(self, setting: Setting) -> State:
        """Pressure of the Hertz forces computed from the positions, and coordination.

        Independent of every compared code: p = sum of F |x_j - x_i| / (3 V) with F = (4/3) E* sqrt(R*) overlap^(3/2).
        Tangential forces do not enter the pressure of spheres.
        """
        diameter = 2.0 * self.radius
        counts = [max(1, int(side / diameter)) for side in self.sides]
        if min(counts) < 3:
            raise PackingError(f"a cell of sides {self.sides} m is below three diameters: contacts would be ambiguous")
        cells = defaultdict(list)
        for k, position in enumerate(self.positions):
            key = (int(x / side * n) % n for x, side, n in zip(position, self.sides, counts))
            cells[tuple(key)].append(k)
        stiffness = 4.0 / 3.0 * setting.effective_young * math.sqrt(0.5 * self.radius)
        contacts, virial = 0, 0.0
        for cell, members in cells.items():
            for step in itertools.product((-1, 0, 1), repeat=3):
                others = cells.get(tuple((c + s) % n for c, s, n in zip(cell, step, counts)), ())
                for i, j in itertools.product(members, others):
                    if i < j and (distance := self._distance(i, j)) < diameter:
                        contacts += 1
                        virial += stiffness * (diameter - distance) ** 1.5 * distance
        volume = math.prod(self.sides)
        return State(virial / (3.0 * volume), 2.0 * contacts / len(self.positions))

    def _distance(self, i: int, j: int) -> float:
        square = 0.0
        for a, b, side in zip(self.positions[i], self.positions[j], self.sides):
            square += (a - b - side * round((a - b) / side)) ** 2
        return math.sqrt(square)
