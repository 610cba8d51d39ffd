"""Types of the compiled module. Shapes: n grains, m contacts. SI units. tests/test_texts.py writes the texts."""

from collections.abc import Iterator
from os import PathLike
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .recordings import Packings

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
    """A packing of spheres in a periodic cell, which never changes. ``len(packing)`` is the number of grains n; m is that of contacts. SI units.

    Arrays of a packing share its memory, without copies, and are read-only; each keeps the packing in memory. It can be pickled, without loss.

    Made from arrays or lists: cell (3, 3) with its edge vectors as columns, positions (n, 3), radii (n,) or one, m; velocities (n, 3), m/s; shear modulus,
    Pa; density, kg/m3. Contacts are those of overlapping spheres, with Hertz forces and without tangential forces. Raises ValueError for
    wrong shapes, numbers that are not finite, and spheres that coincide.

    >>> packing = grainlab.Packing(1e-3 * numpy.eye(3), centres, radii, friction=0.3)
    >>> packing.contact_normals @ packing.stress
    """

    def __new__(
        cls,
        cell: ArrayLike,
        positions: ArrayLike,
        radii: ArrayLike,
        *,
        velocities: ArrayLike | None = None,
        shear_modulus: float = 29e9,
        poisson_ratio: float = 0.2,
        density: float = 2500.0,
        friction: float = 0.0,
    ) -> Packing: ...

    def __len__(self) -> int: ...
    @property
    def source(self) -> str:
        """Origin of the packing, as text."""
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
    def stress(self) -> NDArray[np.float64]:
        """Stress, Pa, shape (3, 3), positive in compression: a new array."""
    @property
    def strain(self) -> NDArray[np.float64] | None:
        """Logarithmic strain, shape (3, 3), positive in extension, of the same origin as the deformation: a new array. None for a packing
        that has none.
        """
    @property
    def phase(self) -> int | None:
        """Number of the phase of its scene, from 1; 0 for the packing that a run started from; None for a packing of no run."""
    @property
    def end_of_phase(self) -> bool | None:
        """True if the phase met its end conditions at this packing; one within a phase need not be at rest. None for a packing of no run."""
    def _png(self, color: str, size: str) -> bytes: ...
    @property
    def friction(self) -> float:
        """Friction coefficient in force; may be infinite."""
    @property
    def shear_modulus(self) -> float:
        """Shear modulus of the grains, Pa."""
    @property
    def poisson_ratio(self) -> float:
        """Poisson ratio of the grains."""
    @property
    def density(self) -> float:
        """Density of the grains, kg/m3."""
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
        """Radii of the grains, m, (n,)."""
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
        """True for each grain that carries no force, (n,): a copy."""

class PackingIterator(Iterator[Packing]):
    def after(self, passed: int) -> Packing:
        """The packing after the next ``passed`` ones, which are not decoded. Raises FileError for damage before it, which would shift its
        number, and if there is none."""
    def __next__(self) -> Packing: ...

class Recording:
    """An opened recording: its packings, and its messages of any type. SI units. Made by :func:`open`, which raises FileError.

    >>> recording = grainlab.open("recordings/runs/demo-1-1")
    >>> recording.topics["/packing"]["messages"]
    """

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
    def summary(self) -> dict[str, Any]:
        """Summary of a launched run: states with measurements and estimates, topics, messages lost, exit code. Raises FileError for others."""
    def __fspath__(self) -> str: ...
    @property
    def scene(self) -> str | None:
        """Text of the scene."""
    def _packings(self, topic: str) -> PackingIterator: ...
    def packings(self, topic: str = "packing") -> Packings:
        """Packings: a sequence, read as they are asked for. Raises FileError for a topic that it does not have."""
    def last_packing(self, topic: str = "packing") -> Packing:
        """Last packing of the topic. Raises IndexError if it has none, and FileError for damage."""
    def messages(self, *topics: str) -> Iterator[tuple[str, int, dict[str, Any]]]:
        """(topic, time of arrival in ns since 1970, fields) of the messages of these topics, or of all, of any type. Raises FileError."""

def open(path: str | PathLike[str]) -> Recording:
    """Opens a recording: an MCAP file or a run directory. Its values are in SI units. Raises FileError.

    >>> recording = grainlab.open("recordings/runs/demo-1-1")
    """

def load(
    path: str | PathLike[str],
    *,
    cell: ArrayLike | None = None,
    shear_modulus: float | None = None,
    poisson_ratio: float | None = None,
    density: float | None = None,
    friction: float | None = None,
    radius: float | None = None,
    topic: str | None = None,
) -> list[Packing]:
    """All packings of a recording, CSV, LAMMPS dump or data file, or YADE export; keywords give what the file lacks, in SI
    units: cell (3, 3) and radius, m; shear modulus, Pa; density, kg/m3. Raises FileError.

    >>> (packing,) = grainlab.load("packing.data", shear_modulus=29e9, poisson_ratio=0.2, friction=0.3)
    """

def stiffness(
    packing: Packing,
    *,
    affine: bool = False,
    springs: Literal["carried", "both", "normal"] = "carried",
    tolerance: float | None = None,
) -> NDArray[np.float64]:
    """Stiffness of the contact network, Pa, (6, 6), Voigt order with engineering shear: with relaxation of the grains, or
    affine. Springs and tolerance are those of :func:`analyze`. Raises PhysicsError if the packing is not jammed.

    >>> grainlab.stiffness(packing)[2, 2]
    """
def quantities() -> dict[str, tuple[str, str, str]]:
    """The keys of :func:`analyze`, each with (symbol, unit, meaning). Raises nothing.

    >>> grainlab.quantities()["phi"]
    ('φ', '1', 'solid fraction')
    """
def models() -> list[str]:
    """Names of the models of :func:`invert`, the one with the smallest error on held-out packings first. It has no units and raises nothing.

    >>> grainlab.models()[0]
    'relaxed'
    """

class Run:
    """A run of a scene."""
    def advance(self, limit: float) -> Packing | None:
        """Goes on until a packing is due, a phase or the path has ended, or this time has passed, s, for one exchange at least."""
    def packing(self) -> Packing:
        """The present packing."""
    def names(self) -> tuple[str, str | None]:
        """Name of the scene, and of the phase."""
    def clock(self) -> tuple[int, float, float | None, bool]:
        """Steps, time (s), share of the phase that is done, and whether the path is done."""
    def stress(self) -> NDArray[np.float64]:
        """Stress, Pa, shape `(3, 3)`."""

def begin(scene: str, settings: list[str], threads: int) -> tuple[Run, list[str]]:
    """Starts a run of a scene with settings such as `grains.count=500`; it and the notes on its start."""
def scene(scene: str, settings: list[str]) -> tuple[str, str, list[str]]:
    """The complete text of a scene with settings, its name, and notes on it."""
def scenes_built_in() -> dict[str, str]:
    """The built-in scenes: by name, the description."""
def unpickled(bytes: bytes, source: str, notes: list[str]) -> Packing:
    """A packing from its bytes in a pickle."""
def page(name: str, packings: list[Packing]) -> str:
    """A page that shows packings in three dimensions: HTML."""
def analyze_one(packing: Packing, axis: Any, springs: str, tolerance: float | None) -> tuple[dict[str, Any], list[str]]:
    """Everything that `grainlab analyze` reports of a packing, by key, and its warnings."""
def analyze_all(packings: list[Packing], axis: Any, springs: str, tolerance: float | None) -> str:
    """The text of `grainlab analyze --format csv`, a row for each packing, with its status and reason."""
def probe_all(packings: list[Packing], flags: list[tuple[str, str]]) -> tuple[str, str | None]:
    """The text of `grainlab probe --format csv`, a row for each packing, with its status and reason; and the JSON of the first, if it has any."""
def export(packings: list[Packing], format: str, folder: str | PathLike[str]) -> list[str]:
    """Writes packings in a format of `grainlab bag export` into a folder; notes on them."""
def inverted(
    table: bytes, by: tuple[str, str, str | None, float | None], draws: tuple[int, int] | None
) -> tuple[dict[str, Any], dict[str, Any] | None]:
    """Inverts the rows of a table, the text of a file: columns of the answers, and draws from the posterior of the first row, if a number of
    them in each chain and a seed are given. `by` has model, calibration, prior and relative error.
    """
def run(words: list[str], again: list[str], ends_with_parent: bool) -> int:
    """Runs a command line, whose first word is the program; its exit code. The program starts itself again by the words of `again`. With
    `ends_with_parent` it is told to end, by SIGTERM, when the process that started it has.
    """
