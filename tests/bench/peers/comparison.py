"""Every code in turn, repetition by repetition."""

import os
import platform
import sys
from dataclasses import dataclass, field
from pathlib import Path
from typing import Callable

from peers.checks import Check, checks
from peers.measurement import Case, Job, Missing
from peers.packing import Packing, PackingError
from peers.process import RunFailed
from peers.report import Group
from peers.setting import Setting


@dataclass
class Comparison:
    """The runs, the codes that are missing, and the errors."""

    setting: Setting
    packing: Packing
    data: Path
    """The packing as a plain data file."""
    directory: Path
    """Temporary, for the codes' files."""
    repetitions: int
    seconds: float
    """Approximate duration of a timed loop, s."""
    timeout: float
    """For one run, s."""
    codes: list = field(default_factory=list)
    groups: list[Group] = field(default_factory=list)
    missing: list[Missing] = field(default_factory=list)
    failures: list[str] = field(default_factory=list)
    checks: list[Check] = field(default_factory=list)
    loads: list[tuple] = field(default_factory=list)
    """Load averages before and after."""

    def __post_init__(self):
        self.reference = self.packing.state(self.setting)

    def find(self, name: str, finder: Callable) -> None:
        """Adds the code found by `finder`, or reports that it is missing or fails."""
        try:
            code = finder()
        except (RunFailed, OSError) as error:
            self._fail(f"{name}: {error}")
            return
        if isinstance(code, Missing):
            self._miss(code)
        else:
            say(f"{code.name} {code.version}")
            self.codes.append(code)

    def run(self, sizes: list[int], threads: list[int], only: list[str]) -> None:
        """Every size on every number of threads: codes whose names contain one of `only` (empty: all), and grainlab."""
        self.loads = [os.getloadavg()]
        if self.loads[0][0] > 0.5:
            load = f"{self.loads[0][0]:.2f}"
            say(f"WARNING: load average {load}: others use the cores; wall rates suffer, on several cores most")
        for size, copies in replicas_of(sizes, len(self.packing.positions)).items():
            for count in threads:
                group = Group(size, count, self._cases(count, only))
                self.groups.append(group)
                for repetition in range(1, self.repetitions + 1):
                    for case in group.cases:
                        say(f"N {size}, {count} thread(s), repetition {repetition}/{self.repetitions}: {case.name}")
                        self._run_one(group, case, copies)
        self.loads.append(os.getloadavg())

    @property
    def broken(self) -> list[Check]:
        """Failed checks."""
        return [check for check in self.checks if not check.holds]

    @property
    def measured(self) -> bool:
        """True if any run succeeded."""
        return any(run for group in self.groups for runs in group.runs.values() for run in runs)

    def result(self) -> dict:
        """The result as data."""
        return {
            "machine": {
                "processor": processor(),
                "cores": os.cpu_count(),
                "system": platform.platform(),
                "load_average_before": self.loads[0],
                "load_average_after": self.loads[-1],
            },
            "versions": {code.name: code.version for code in self.codes},
            "setting": self.setting.values(),
            "positions_alone": vars(self.reference),
            "repetitions": self.repetitions,
            "rows": [row for group in self.groups for row in group.rows()],
            "not_run": [vars(missing) for missing in self.missing],
            "checks": {"done": len(self.checks), "failed": [vars(check) for check in self.broken]},
            "failures": self.failures,
        }

    def _cases(self, threads: int, only: list[str]) -> list[Case]:
        cases = []
        for case in (case for code in self.codes for case in code.cases(threads)):
            if isinstance(case, Missing):
                if wanted(case.name, only):
                    self._miss(case)
            elif case.ours or wanted(case.name, only):
                cases.append(case)
        # grainlab with servo if another code runs with servo, and likewise without; both without other codes.
        kinds = {case.servo for case in cases if not case.ours} or {True, False}
        return [case for case in cases if not case.ours or case.servo in kinds]

    def _run_one(self, group: Group, case: Case, copies: int) -> None:
        steps = max(20, round(self.seconds * case.nominal_rate / group.grains))
        job = Job(
            self.packing, self.data, copies, group.threads, steps, self.directory, self.timeout, self.setting
        )
        run = None
        try:
            run = case.run(job)
            self.checks += checks(case.name, run, group.grains, self.reference)
        except RunFailed as error:
            self._fail(f"{case.name}, N {group.grains}: {error}")
        group.runs.setdefault(case.name, []).append(run)

    def _miss(self, missing: Missing) -> None:
        if missing not in self.missing:
            self.missing.append(missing)
            say(f"NOT RUN: {missing.name}: {missing.reason}. To have it: {missing.remedy}")

    def _fail(self, what: str) -> None:
        self.failures.append(what)
        say(f"FAILED: {what}")


def wanted(name: str, only: list[str]) -> bool:
    return not only or any(part.lower() in name.lower() for part in only)


def replicas_of(sizes: list[int], grains: int) -> dict[int, int]:
    """Copies per axis of a packing of `grains` for each size."""
    replicas = {}
    for size in sizes:
        copies = round((size / grains) ** (1 / 3))
        if copies < 1 or copies**3 * grains != size:
            possible = ", ".join(str(grains * k**3) for k in (1, 2, 3, 4))
            raise PackingError(f"--sizes: {size} is not {grains} times a cube ({possible}, ...)")
        replicas[size] = copies
    return replicas


def processor() -> str:
    """The processor's name in /proc/cpuinfo."""
    try:
        for line in Path("/proc/cpuinfo").read_text().splitlines():
            if line.startswith("model name"):
                return line.split(":", 1)[1].strip()
    except OSError:
        pass
    return platform.processor() or platform.machine()


def say(text: str) -> None:
    """Prints progress on standard error."""
    print(text, file=sys.stderr, flush=True)
