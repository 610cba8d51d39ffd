"""grainlab itself, through its bench `dem`."""

import json
import os
from functools import partial
from pathlib import Path
from typing import Optional, Union

from peers.measurement import Case, Job, Measurement, Missing
from peers.packing import State
from peers.process import RunFailed, last_words, run

NAME = "grainlab"
INSTALL = "cargo build --release -p grainlab_bench, or --grainlab PATH, or --without-grainlab"
REPOSITORY = Path(__file__).resolve().parents[3]
RATE = 2.0e7
"""Expected particle-steps/s on a core."""


class Grainlab:
    """A built grainlab_bench."""

    name = NAME

    def __init__(self, executable: Path, packing: Path, directory: Path):
        self.executable = executable
        self.packing = packing
        try:
            run([executable, "dem", "--help"], directory, dict(os.environ), 60.0)
        except RunFailed as error:
            raise RunFailed(f"no bench `dem` in {executable} ({INSTALL}):\n{error}") from error
        self.version = run([executable, "--version"], directory, dict(os.environ), 60.0).strip()

    @classmethod
    def find(cls, given: Optional[Path], packing: Path, directory: Path) -> Union["Grainlab", Missing]:
        """`given`, or the newest release build of this checkout."""
        targets = [REPOSITORY / "target", *map(Path, filter(None, [os.environ.get("CARGO_TARGET_DIR")]))]
        built = [p for t in targets if (p := t / "release" / "grainlab_bench").exists()]
        path = given or max(built, key=lambda p: p.stat().st_mtime, default=None)
        if path is None:
            return Missing(NAME, f"no target/release/grainlab_bench in {REPOSITORY}", INSTALL)
        return cls(path.absolute(), packing.absolute(), directory)

    def cases(self, threads: int) -> list[Union[Case, Missing]]:
        """The frictional kernel, with and without its servo."""
        on = f", {threads} threads" if threads > 1 else ""
        return [
            Case("grainlab + servo" + on, True, threads * RATE, partial(self._run, True), ours=True),
            Case("grainlab" + on, False, threads * RATE, partial(self._run, False), ours=True),
        ]

    def _run(self, servo: bool, job: Job) -> Measurement:
        command = [self.executable, "dem", "--packing", self.packing]
        command += ["--grains", job.grains, "--threads", job.threads, "--features", "coulomb"]
        command += ["--servo"] if servo else []
        command += ["--steps", job.steps, "--simd", "best", "--format", "json"]
        text = run(command, job.directory, dict(os.environ), job.timeout)
        try:
            rows = json.loads(text)["rows"]
            [row] = [r for r in rows if r["grains"] == job.grains and r["threads"] == job.threads]
            work = job.grains * job.steps
            cpu_rate = row.get("cpu_particle_steps_per_second")
            return Measurement(
                grains=job.grains,
                steps=job.steps,
                wall_s=work / row["particle_steps_per_second"],
                cpu_s=work / cpu_rate if cpu_rate else None,
                end=State(row.get("pressure"), row["coordination"]),
            )
        except (ValueError, KeyError, TypeError, ZeroDivisionError) as error:
            problem = f"not the JSON of the bench `dem` for {job.grains} grains on {job.threads} threads"
            raise RunFailed(f"{problem}: {error!r}\n{last_words(text)}") from error
