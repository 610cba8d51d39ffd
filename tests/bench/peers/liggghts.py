"""LIGGGHTS-PUBLIC: the package of a distribution, with Open MPI."""

import os
import shutil
from functools import partial
from pathlib import Path
from typing import Optional, Union

from peers.lammps import find_mpiexec, last_loop, rebuilds, state
from peers.measurement import Case, Job, Measurement, Missing
from peers.process import RunFailed, loopback_only, run

NAME = "LIGGGHTS"
INSTALL = "apt install liggghts openmpi-bin"
INPUT = Path(__file__).resolve().parent.parent / "inputs" / "in.liggghts"
RATE = 5.0e6
"""Expected particle-steps/s on a core."""

# Gives the input the id of the process that reads it: the shell becomes that process.
WITH_PID = ["sh", "-c", 'exec "$0" "$@" -var pid $$']


class Liggghts:
    """An installed LIGGGHTS."""

    name = NAME

    def __init__(self, executable: Path, directory: Path):
        self.executable = executable
        environment = loopback_only(1)
        (directory / "in.version").write_text('print "ready"\n')
        text = run([executable, "-in", "in.version", "-log", "none"], directory, environment, 60.0)
        if "LIGGGHTS" not in text:
            raise RunFailed(f"{executable} does not call itself LIGGGHTS")
        self.version = text.split("LIGGGHTS-", 1)[-1].split(",")[0].strip()
        self.mpiexec, self.mpi_options = find_mpiexec(executable.parent, directory, environment)

    @classmethod
    def find(cls, given: Optional[Path], directory: Path) -> Union["Liggghts", Missing]:
        """`given`, or `liggghts` on PATH."""
        path = given or shutil.which("liggghts")
        if path is None:
            return Missing(NAME, "no liggghts on PATH", INSTALL)
        return cls(Path(path).absolute(), directory)

    def cases(self, threads: int) -> list[Union[Case, Missing]]:
        """The one configuration; the program has no servo for the sides of a periodic box."""
        name = "LIGGGHTS hertz history"
        if threads == 1:
            return [Case(name, False, RATE, partial(self._run, 1))]
        name = f"{name}, {threads} ranks"
        if not self.mpiexec:
            return [Missing(name, "no mpiexec on PATH", INSTALL)]
        return [Case(name, False, threads * RATE, partial(self._run, threads))]

    def _run(self, ranks: int, job: Job) -> Measurement:
        data = job.directory / f"packing_{job.grains}.liggghts"
        if not data.exists():
            job.packing.write_liggghts(data, job.replicas)
        clock = job.directory / "cpu_clock"
        clock.unlink(missing_ok=True)
        setting = job.setting
        variables = {
            "data": data,
            "warmup": job.warmup,
            "steps": job.steps,
            "young": repr(setting.young),
            **{k: repr(getattr(setting, k)) for k in ("poisson", "friction", "restitution", "time_step", "skin")},
        }
        command = [self.mpiexec, *self.mpi_options, "-n", ranks] if ranks > 1 else []
        command += [*WITH_PID, self.executable, "-in", INPUT, "-log", "none"]
        for key, value in variables.items():
            command += ["-var", key, value]
        text = run(command, job.directory, loopback_only(1), job.timeout)
        loop = last_loop(text)
        if loop["processors"] != ranks:
            raise RunFailed(f"{loop['processors']} ranks ran, not {ranks}: {self.mpiexec} belongs to another MPI")
        return Measurement(
            grains=loop["grains"],
            steps=loop["steps"],
            wall_s=loop["wall_s"],
            # Only the first rank runs shell commands; the others spin while waiting, so that their CPU time is the same.
            cpu_s=cpu_seconds(clock) * ranks,
            start=state(text, "start"),
            end=state(text, "end"),
            rebuilds=rebuilds(text),
        )


def cpu_seconds(clock: Path) -> float:
    """CPU time between the two /proc/PID/stat lines of a file, s, to a hundredth."""
    try:
        lines = clock.read_text().splitlines()
        # Fields 14 and 15 (user, system), counted after the name in parentheses, which may contain blanks.
        ticks = [sum(map(int, line.rsplit(")", 1)[1].split()[11:13])) for line in lines]
        first, last = ticks
    except (OSError, ValueError, IndexError) as error:
        raise RunFailed(f"{clock.name} does not hold the CPU time before and after the loop: {error}") from error
    return (last - first) / os.sysconf("SC_CLK_TCK")
