"""DIRT: crates of the Rust registry, built with the loop in inputs/loop_dirt in a folder that the user names."""

import json
import os
import re
import shutil
from pathlib import Path
from typing import Optional, Union

from peers.measurement import Case, Job, Measurement, Missing
from peers.packing import State
from peers.process import RunFailed, last_words, loopback_only, run

NAME = "DIRT"
INSTALL = "--dirt FOLDER: builds it there by cargo, once, in some minutes"
SOURCES = Path(__file__).resolve().parent.parent / "inputs" / "loop_dirt"
RATE = 4.5e6
"""Expected particle-steps/s on a core."""
BUILD_TIMEOUT = 3600.0
"""s."""


class Dirt:
    """A loop built from the crates."""

    name = NAME

    def __init__(self, executable: Path):
        self.executable = executable
        self.version = re.search(r'dirt_core = .*?"=([\d.]+)"', (SOURCES / "Cargo.toml").read_text())[1]

    @classmethod
    def find(cls, given: Optional[Path], directory: Path) -> Union["Dirt", Missing]:
        """The loop in the folder `given`, built there if it is not, or not from the present sources."""
        if given is None:
            return Missing(NAME, "no folder to build it in", INSTALL)
        cargo = shutil.which("cargo")
        folder = given.absolute()
        built = folder / "target" / "release" / "loop_dirt"
        source = (SOURCES / "main.rs").read_text()
        present = folder / "main.rs"
        if built.exists() and present.exists() and present.read_text() == source:
            return cls(built)
        if cargo is None:
            return Missing(NAME, "no cargo on PATH", "https://rustup.rs")
        build(Path(cargo), folder)
        return cls(built)

    def cases(self, threads: int) -> list[Union[Case, Missing]]:
        """The one configuration; the program has no servo for the sides of a periodic box."""
        name = "DIRT Hertz-Mindlin history"
        if threads == 1:
            return [Case(name, False, RATE, self._run)]
        return [Missing(f"{name}, {threads} ranks", "built without MPI", "its feature mpi_backend")]

    def _run(self, job: Job) -> Measurement:
        (job.directory / "dirt.csv").write_text(table(job))
        (job.directory / "dirt.toml").write_text(configuration(job))
        environment = loopback_only(1) | {"LOOP_WARMUP": str(job.warmup), "LOOP_STEPS": str(job.steps)}
        text = run([self.executable, "dirt.toml"], job.directory, environment, job.timeout)
        return measurement(text)


def build(cargo: Path, folder: Path) -> None:
    """Builds the loop in `folder`. RunFailed if cargo fails.

    As published, dirt 0.1.4 reads fields of soil_core 0.1.4 that are private there, and does not compile; in the copy of
    soil_core that is built here they are public. Nothing else is changed.
    """
    folder.mkdir(parents=True, exist_ok=True)
    environment = {k: v for k, v in os.environ.items() if k != "CARGO_TARGET_DIR"}
    shutil.copy(SOURCES / "main.rs", folder)
    manifest = (SOURCES / "Cargo.toml").read_text()
    (folder / "Cargo.toml").write_text(manifest)
    metadata = run([cargo, "metadata", "--format-version", "1"], folder, environment, BUILD_TIMEOUT)
    [package] = [p for p in json.loads(metadata)["packages"] if p["name"] == "soil_core"]
    copy = folder / "soil_core"
    shutil.rmtree(copy, ignore_errors=True)
    shutil.copytree(Path(package["manifest_path"]).parent, copy)
    atom = copy / "src" / "atom.rs"
    atom.write_text(opened(atom.read_text()))
    (folder / "Cargo.toml").write_text(manifest + '\n[patch.crates-io]\nsoil_core = { path = "soil_core" }\n')
    try:
        run([cargo, "build", "--release"], folder, environment, BUILD_TIMEOUT)
    except RunFailed:
        # Not taken for built the next time.
        (folder / "main.rs").unlink()
        raise


def opened(atom: str) -> str:
    """The source of soil_core's atoms with the members public that dirt 0.1.4 uses."""
    atom, fields = re.subn(r"(?m)^    (?:pub\(crate\) )?((?:natoms|nlocal|nghost): u\d+,)$", r"    pub \1", atom)
    atom, functions = re.subn(r"pub\(crate\) fn try_register\b", "pub fn try_register", atom)
    if (fields, functions) != (3, 1):
        raise RunFailed(f"soil_core is not the known 0.1.4: {fields} fields and {functions} functions found, not 3 and 1")
    return atom


def table(job: Job) -> str:
    """The replicated packing as CSV: x, y, z, radius, m."""
    rows = (f"{x!r},{y!r},{z!r},{job.packing.radius!r}\n" for x, y, z in job.packing.replicated(job.replicas))
    return "x,y,z,radius\n" + "".join(rows)


def configuration(job: Job) -> str:
    """The input of DIRT."""
    setting, packing = job.setting, job.packing
    diameter = 2.0 * packing.radius
    reach = 1.0 + setting.skin / diameter
    sides = "".join(
        f'{axis}_low = 0.0\n{axis}_high = {job.replicas * side!r}\nboundary_{axis} = "periodic"\n'
        for axis, side in zip("xyz", packing.sides)
    )
    return f"""[domain]
{sides}
[neighbor]
skin_fraction = {reach!r}
bin_size = {reach * diameter!r}
every = 0
[dem]
contact_model = "hertz"
[[dem.materials]]
name = "glass"
youngs_mod = {setting.young!r}
poisson_ratio = {setting.poisson!r}
restitution = {setting.restitution!r}
friction = {setting.friction!r}
[[particles.insert]]
source = "file"
file = "dirt.csv"
format = "csv"
material = "glass"
density = {packing.density!r}
columns = {{ x = 0, y = 1, z = 2, radius = 3 }}
[run]
steps = {1 + job.warmup + job.steps}
thermo = 1000000000
dt = {setting.time_step!r}
"""


def measurement(text: str) -> Measurement:
    """The line that the loop prints."""
    lines = [line.removeprefix("dirt: ") for line in text.splitlines() if line.startswith("dirt: ")]
    if len(lines) != 1:
        raise RunFailed(f"DIRT printed no result:\n{last_words(text)}")
    result = json.loads(lines[0])
    states = {key: State(**result.pop(key)) for key in ("start", "end")}
    return Measurement(**result, **states)
