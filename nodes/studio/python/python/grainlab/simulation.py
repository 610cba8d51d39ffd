"""Runs of scenes in this process."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Callable, Iterator, Mapping
from typing import TYPE_CHECKING, Any

from . import _grainlab
from .scenes import Scene, warn, whole

if TYPE_CHECKING:
    import numpy as np

    from ._grainlab import Packing

#: Time between two looks for a signal such as Ctrl-C, s.
SIGNAL_PERIOD = 0.05


class Simulation(Iterator["Packing"]):
    """A run of a scene: an iterator over the packings that the scene publishes, which can also be advanced and looked at.

    Made by :func:`simulate`. SI units, stress positive in compression. Raises PhysicsError where the run cannot go on.

    >>> run = grainlab.simulate("demo")
    >>> packings = run.run(20_000)
    >>> run.phase, run.time, run.stress[2, 2]
    """

    def __init__(self, run: _grainlab.Run, on_phase: Callable[[Simulation, str], Any] | None) -> None:
        self._run = run
        self._on_phase = on_phase

    def __repr__(self) -> str:
        return f"<grainlab.Simulation of {self.name}, step {self.steps}>"

    def __next__(self) -> Packing:
        while not self.finished:
            found = self._advance(SIGNAL_PERIOD)
            if found is not None:
                return found
        raise StopIteration

    def _advance(self, limit: float) -> Packing | None:
        before = self.phase
        found = self._run.advance(limit)
        if self._on_phase is not None and before is not None and self.phase != before:
            try:
                self._on_phase(self, before)
            except StopIteration as error:
                # Python would take it as the end of the run (PEP 479).
                raise RuntimeError("on_phase raised StopIteration") from error
        return found

    def step(self) -> Packing | None:
        """Goes on for one control period of the scene; the packing that it publishes there, or None. Raises PhysicsError."""
        return self._advance(0.0)

    def run(self, steps: int | None = None) -> list[Packing]:
        """Goes on for so many solver steps or a few more, to the next control period, or to the end: the packings published on the
        way. Raises PhysicsError, and ValueError for steps that are no whole number."""
        end, packings = None if steps is None else self.steps + whole("steps", steps), []
        while not self.finished and (end is None or self.steps < end):
            found = self._advance(SIGNAL_PERIOD if end is None else 0.0)
            packings += [found] if found is not None else []
        return packings

    def run_until(self, met: Callable[[Simulation], Any], *, every: int = 1) -> list[Packing]:
        """Goes on until ``met(run)`` is true, which is asked every so many solver steps or a few more, or to the end: the packings
        published on the way. Raises PhysicsError, and ValueError for a wrong ``every``."""
        packings, every = [], whole("every", every, least=1)
        while not self.finished and not met(self):
            packings += self.run(every)
        return packings

    @property
    def name(self) -> str:
        """Name of the scene."""
        return self._run.names()[0]

    @property
    def phase(self) -> str | None:
        """Name of the phase under way; None at the end."""
        return self._run.names()[1]

    @property
    def steps(self) -> int:
        """Solver steps done."""
        return self._run.clock()[0]

    @property
    def time(self) -> float:
        """Simulated time, s."""
        return self._run.clock()[1]

    @property
    def progress(self) -> float | None:
        """Share of the phase that is done, 0 to 1; None where its end is not known beforehand."""
        return self._run.clock()[2]

    @property
    def finished(self) -> bool:
        """True once the path is done."""
        return self._run.clock()[3]

    @property
    def stress(self) -> np.ndarray:
        """Stress of the contacts, Pa, (3, 3), positive in compression."""
        return self._run.stress()

    @property
    def strain(self) -> np.ndarray | None:
        """Logarithmic strain, (3, 3), positive in extension, since the reference state of the scene, or since the first step until a
        phase sets one."""
        return self.packing.strain

    @property
    def packing(self) -> Packing:
        """The present packing, whether the scene publishes it or not."""
        return self._run.packing()


def simulate(
    scene: str | os.PathLike[str] | Scene = "demo",
    *,
    seed: int | None = None,
    set: Mapping[str, Any] | None = None,
    start: Packing | str | os.PathLike[str] | None = None,
    threads: int = 1,
    on_phase: Callable[[Simulation, str], Any] | None = None,
) -> Simulation:
    """A run of a scene in this process: the name of a built-in one, a path, the text of a TOML file, or a :class:`Scene`.

    ``set`` has keys such as ``"grains.count": 500``, in SI units, with numbers, texts, lists or mappings as values. ``start`` is a packing,
    or a file of one, that the path starts from instead of a gas: for scenes without ``[grains]``. ``on_phase(run, name)`` is called when a
    phase has ended. The packings are those of ``grainlab launch``, bit for bit. Raises SceneError
    for faults of the scene, and PhysicsError for a run that cannot go on.

    >>> for packing in grainlab.simulate("demo", seed=2, set={"grains": {"count": 300}}):
    ...     print(packing.phase, packing.stress[2, 2])
    """
    if on_phase is not None and not callable(on_phase):
        raise TypeError(f"on_phase is {on_phase!r}; it must be a function of (run, name)")
    with tempfile.TemporaryDirectory() as folder:
        if isinstance(start, _grainlab.Packing):
            _grainlab.export([start], "csv", folder)
            start = os.path.join(folder, "packing_1.csv")
        of = Scene(Scene(scene, set=None if start is None else {"start.packing": start}), seed=seed, set=set)
        run, notes = _grainlab.begin(of.source, of.settings, whole("threads", threads))
    warn([note.replace(os.path.join(folder, "packing_1.csv"), "the packing given as start") for note in notes])
    return Simulation(run, on_phase)
