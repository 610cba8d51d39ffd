"""YADE: the package of a distribution."""

import json
import shutil
from functools import partial
from pathlib import Path
from typing import Optional, Union

from peers.measurement import Case, Job, Measurement, Missing
from peers.packing import State
from peers.process import RunFailed, last_words, loopback_only, run

NAME = "YADE"
INSTALL = "apt install yade"
SCRIPT = Path(__file__).resolve().parent.parent / "inputs" / "loop_yade.py"
RATE = 1.2e6
"""Expected particle-steps/s on a core."""


class Yade:
    """An installed YADE: its launcher, and the interpreter of the launcher."""

    name = NAME

    def __init__(self, launcher: Path, directory: Path):
        self.launcher = launcher.resolve()
        with open(self.launcher, errors="replace") as file:
            first = file.readline()
        if not first.startswith("#!") or "python" not in first:
            raise RunFailed(f"{launcher} is not YADE's launcher: it does not start with the path of a Python")
        self.interpreter = first[2:].split()
        text = run([self.launcher, "--version"], directory, loopback_only(1), 60.0)
        self.version = text.strip().splitlines()[-1].removeprefix("Yade version: ")

    @classmethod
    def find(cls, given: Optional[Path], directory: Path) -> Union["Yade", Missing]:
        """`given`, or `yade` on PATH."""
        path = given or shutil.which("yade")
        if path is None:
            return Missing(NAME, "no yade on PATH", INSTALL)
        return cls(Path(path), directory)

    def cases(self, threads: int) -> list[Union[Case, Missing]]:
        """Mindlin contacts, with and without its servo for periodic cells."""
        found = []
        for servo in (True, False):
            name = f"YADE Mindlin{' + servo' if servo else ''}"
            name += f", {threads} OpenMP threads" if threads > 1 else ""
            found.append(Case(name, servo, threads * RATE, partial(self._run, servo)))
        return found

    def _run(self, servo: bool, job: Job) -> Measurement:
        order = {
            "launcher": str(self.launcher),
            "packing": str(job.data),
            "replicas": job.replicas,
            "threads": job.threads,
            "warmup": job.warmup,
            "steps": job.steps,
            "servo": servo,
            "setting": job.setting.values(),
        }
        command = [*self.interpreter, SCRIPT, json.dumps(order)]
        text = run(command, job.directory, loopback_only(job.threads), job.timeout)
        lines = [line.removeprefix("yade: ") for line in text.splitlines() if line.startswith("yade: ")]
        if len(lines) != 1:
            raise RunFailed(f"YADE printed no result:\n{last_words(text)}")
        result = json.loads(lines[0])
        return Measurement(
            grains=result["grains"],
            steps=result["steps"],
            wall_s=result["wall_s"],
            cpu_s=result["cpu_s"],
            start=State(**result["start"]),
            end=State(**result["end"]),
        )
