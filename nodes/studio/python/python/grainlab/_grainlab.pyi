"""Types of the compiled module. Shapes: n grains, m contacts. SI units."""

from collections.abc import Iterator, Mapping
from os import PathLike
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

__version__: str

class GrainlabError(Exception):
    """Any error of grainlab."""

class FileError(GrainlabError):
    """A file that cannot be read, or is not what it should be."""

class SceneError(GrainlabError):
    """A scene with faults, or keys that it does not have."""

class PhysicsError(GrainlabError):
    """Physics that cannot go on: a packing that is not jammed, an unstable run, moduli without a solution."""

class Packing:
    """A packing of spheres in a periodic cell, which never changes. ``len(packing)`` is the number of grains.

    Its arrays share its memory, without copies, and are read-only; each keeps the packing in memory.
    """

    def __init__(
        self,
        cell: NDArray[np.float64],
        positions: NDArray[np.float64],
        radii: NDArray[np.float64],
        *,
        velocities: NDArray[np.float64] | None = None,
        shear_modulus: float = 29e9,
        poisson_ratio: float = 0.2,
        density: float = 2500.0,
        friction: float = 0.0,
    ) -> None:
        """From arrays: cell (3, 3) with its edge vectors as columns, positions (n, 3), radii (n,), m; velocities (n, 3), m/s;
        shear modulus, Pa; density, kg/m3.

        Contacts are those of overlapping spheres, with Hertz forces and without tangential forces.
        Raises ValueError for wrong shapes, numbers that are not finite, and spheres that coincide.
        """

    def __len__(self) -> int: ...
    @property
    def source(self) -> str:
        """Where it comes from."""
    @property
    def notes(self) -> list[str]:
        """Remarks of the reader of its file."""
    @property
    def step(self) -> int:
        """Solver steps done."""
    @property
    def time(self) -> float:
        """Simulated time, s."""
    @property
    def solid_fraction(self) -> float:
        """Volume of the spheres over that of the cell."""
    @property
    def friction(self) -> float:
        """Friction coefficient in force; may be infinite."""
    @property
    def shear_modulus(self) -> float:
        """Of the grains, Pa."""
    @property
    def poisson_ratio(self) -> float:
        """Of the grains."""
    @property
    def density(self) -> float:
        """Of the grains, kg/m3."""
    @property
    def contact_law(self) -> str:
        """Name of the contact law."""
    @property
    def cell(self) -> NDArray[np.float64]:
        """Edge vectors of the cell as columns, m, (3, 3): a copy."""
    @property
    def deformation(self) -> NDArray[np.float64] | None:
        """Deformation gradient since the reference state, or since the first step of the run until a phase sets one,
        (3, 3): a copy. None for a packing that has neither."""
    @property
    def ids(self) -> NDArray[np.uint32]:
        """Persistent ids, (n,)."""
    @property
    def radii(self) -> NDArray[np.float64]:
        """m, (n,)."""
    @property
    def positions(self) -> NDArray[np.float64]:
        """Centres, unwrapped, m, (n, 3)."""
    @property
    def velocities(self) -> NDArray[np.float64]:
        """Relative to the affine motion, m/s, (n, 3)."""
    @property
    def angular_velocities(self) -> NDArray[np.float64]:
        """rad/s, (n, 3)."""
    @property
    def wrapped_positions(self) -> NDArray[np.float64]:
        """Centres folded into the cell, m, (n, 3): a copy."""
    @property
    def contact_first(self) -> NDArray[np.uint32]:
        """Index of the first grain i of each contact, (m,)."""
    @property
    def contact_second(self) -> NDArray[np.uint32]:
        """Index of the second grain j >= i, (m,)."""
    @property
    def contact_images(self) -> NDArray[np.int8]:
        """Cell vectors added to j, (m, 3)."""
    @property
    def contact_normals(self) -> NDArray[np.float64]:
        """Unit vector from i to the image of j, (m, 3)."""
    @property
    def contact_overlaps(self) -> NDArray[np.float64]:
        """Full overlap, m, (m,)."""
    @property
    def contact_normal_forces(self) -> NDArray[np.float64]:
        """N, positive in compression, (m,)."""
    @property
    def contact_tangential_forces(self) -> NDArray[np.float64]:
        """On i, N, (m, 3)."""
    @property
    def contact_branches(self) -> NDArray[np.float64]:
        """From the centre of i to the image of j, m, (m, 3): a copy."""
    @property
    def rattlers(self) -> NDArray[np.bool_]:
        """Whether each grain carries no force, (n,): a copy."""

class Recording:
    """An opened recording."""

    @property
    def path(self) -> PathLike[str]:
        """The path that it was opened by."""
    @property
    def topics(self) -> dict[str, dict[str, Any]]:
        """By topic: type, messages, published, lost (None where no recorder counted them)."""
    @property
    def warnings(self) -> list[str]:
        """Parts that could not be read so far."""
    @property
    def scene(self) -> str | None:
        """Text of the scene."""
    def packings(self, topic: str = "packing") -> Iterator[Packing]:
        """Its packings, read one by one. Raises FileError for a topic that it does not have."""
    def last_packing(self, topic: str = "packing") -> Packing:
        """Its last packing. Raises IndexError if it has none."""
    def messages(self, *topics: str) -> Iterator[tuple[str, int, dict[str, Any]]]:
        """(topic, time of arrival in ns since 1970, fields) of the messages of these topics, or of all, of any type."""

class Simulation(Iterator[Packing]):
    """A run of a scene: iterate over the packings that it publishes."""

    def __next__(self) -> Packing: ...

def open(path: str | PathLike[str]) -> Recording:
    """Opens a recording: an MCAP file or a run directory. Raises FileError."""

def load(
    path: str | PathLike[str],
    *,
    cell: NDArray[np.float64] | None = None,
    shear_modulus: float | None = None,
    poisson_ratio: float | None = None,
    density: float | None = None,
    friction: float | None = None,
    radius: float | None = None,
    topic: str | None = None,
) -> list[Packing]:
    """All packings of a recording, CSV, LAMMPS dump or data file, or YADE export; keywords give what the file lacks, in SI
    units. Raises FileError."""

def analyze(
    packing: Packing,
    *,
    axis: ArrayLike = (0.0, 0.0, 1.0),
    springs: Literal["carried", "both", "normal"] = "carried",
    tolerance: float | None = None,
) -> dict[str, Any]:
    """Structure, stress and stiffness: all that ``grainlab analyze`` reports, by key (see :func:`quantities`). Unknown values
    are None, stiffnesses arrays (6, 6), Pa. Springs: "carried" are those that the contacts carry, no tangential ones in a
    packing without friction. The tolerance is the relative residual of the solve; None: 1e-9, and 1e-5 from 50,000 grains. Raises
    PhysicsError."""

def stiffness(
    packing: Packing,
    *,
    affine: bool = False,
    springs: Literal["carried", "both", "normal"] = "carried",
    tolerance: float | None = None,
) -> NDArray[np.float64]:
    """Stiffness of the contact network, Pa, (6, 6), Voigt order with engineering shear: with relaxation of the grains, or
    affine; tolerance as in :func:`analyze`. Raises PhysicsError if the packing is not jammed."""

def quantities() -> dict[str, tuple[str, str, str]]:
    """The keys of :func:`analyze`: symbol, unit, meaning."""

def models() -> list[str]:
    """Names of the models of :func:`invert`."""

def invert(
    *,
    pressure: float,
    g12: float | None = None,
    g13: float | None = None,
    theta: float | None = None,
    c11: float | None = None,
    c33: float | None = None,
    c13: float | None = None,
    phi: float | None = None,
    stress_ratio: float | None = None,
    size_spread: float | None = None,
    gamma: float | None = None,
    error: float = 0.01,
    shear_modulus: float | None = None,
    poisson_ratio: float | None = None,
    pressure_sigma: float = 0.0,
    stress_ratio_sigma: float = 0.0,
    shear_modulus_sigma: float = 0.0,
    poisson_ratio_sigma: float = 0.0,
    model: str = "relaxed",
    prior: str | None = None,
    draws: int | None = None,
    seed: int = 0,
) -> dict[str, Any]:
    """Coordination and anisotropy from moduli and pressure, Pa, each modulus with this relative error. ``k``, ``z``, ``eps`` and
    others with ``_sigma`` and the 95 % ``_interval``; None is undetermined. ``status`` is ok, extrapolated or contradictory, with the
    reason in ``warnings``. Raises PhysicsError for moduli without a solution. The standard deviations of pressure and shear modulus
    are in Pa; 0 takes a value as exact.

    ``prior`` is the text of a prior file, as ``grainlab invert --print-prior`` prints it. With ``draws``, the key of this name has
    so many independent draws from the posterior in each of four chains, the same for the same seed:
    ``arviz.from_dict(**found["draws"])``. Its log_likelihood is that of each modulus given the others, for moduli in MPa."""

def simulate(
    scene: str,
    *,
    seed: int | None = None,
    set: Mapping[str, Any] | None = None,
    threads: int = 1,
) -> Simulation:
    """A run of a scene: the name of a built-in one, a path, or the text of a TOML file. ``set`` has keys such as
    ``"grains.count": 500``. The packings are those of ``grainlab launch``, bit for bit. Raises SceneError."""
