"""The result of one run of one code."""

from dataclasses import dataclass
from pathlib import Path
from typing import Callable, Optional

from peers.packing import Packing, State
from peers.setting import Setting


@dataclass(frozen=True)
class Measurement:
    """A timed stepping loop, set-up and warm-up left out."""

    grains: int
    steps: int
    wall_s: float
    """By the clock of the code."""
    cpu_s: Optional[float]
    """CPU time of all ranks and threads together."""
    start: Optional[State] = None
    """Before the first step."""
    end: Optional[State] = None
    rebuilds: Optional[int] = None
    """Neighbour lists built in the loop."""

    @property
    def wall_rate(self) -> float:
        """Particle-steps per second."""
        return self.grains * self.steps / self.wall_s

    @property
    def cpu_rate(self) -> Optional[float]:
        """Particle-steps per CPU second of all ranks and threads: comparable on a busy machine."""
        return self.grains * self.steps / self.cpu_s if self.cpu_s else None


@dataclass(frozen=True)
class Job:
    """One run to make."""

    packing: Packing
    data: Path
    """The packing as a plain LAMMPS data file, in `directory`."""
    replicas: int
    """Copies per axis."""
    threads: int
    steps: int
    directory: Path
    """Temporary."""
    timeout: float
    """s."""
    setting: Setting

    @property
    def grains(self) -> int:
        return len(self.packing.positions) * self.replicas**3

    @property
    def warmup(self) -> int:
        """Steps before the timed loop."""
        return max(10, self.steps // 10)


@dataclass(frozen=True)
class Case:
    """A code in one configuration."""

    name: str
    servo: bool
    """True if the stress is evaluated and the sides move at every step."""
    nominal_rate: float
    """Expected particle-steps per second, from which the number of steps follows."""
    run: Callable[[Job], Measurement]
    ours: bool = False


@dataclass(frozen=True)
class Missing:
    """A code, or a configuration of one, that cannot run here."""

    name: str
    reason: str
    remedy: str
