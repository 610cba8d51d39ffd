"""Recorded runs, campaigns of them, and their reports. The runs are processes of the program in this package."""

from __future__ import annotations

import json
import os
import re
import tempfile
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from . import _grainlab, tables
from ._grainlab import Recording
from .measurement import Page
from .program import call, flags
from .scenes import Scene, toml

PathOrText = str | os.PathLike[str]


def launch(
    scene: PathOrText | Scene = "demo",
    *,
    seed: int | None = None,
    set: Mapping[str, Any] | None = None,
    out: PathOrText = "recordings/runs",
    **options: Any,
) -> Recording:
    """A recorded run of a scene, with all nodes of the laboratory in one process: simulated, measured, inverted.

    ``scene``, ``seed`` and ``set`` are those of :func:`simulate`, in SI units; the run is a new folder SCENE-SEED-N in ``out``, and
    the answer its recording, with a ``summary``. Keywords are the
    flags of ``grainlab launch``: ``record="results"``, ``one_process=False`` for a process for each node over DDS. Data loss (exit code 3) and
    invalid physics (4) are a warning, with the run as it is. Raises SceneError for faults of the scene, and GrainlabError.

    >>> run = grainlab.launch("demo", seed=3, set={"grains.count": 300})
    """
    of = Scene(scene, seed=seed, set=set)
    sets = [word for setting in of.settings for word in ("--set", setting)]
    words = ["launch", "--scene", of.source, *sets, "--out", out, "--format=json"]
    options = {"one_process": True, "no_report": True, **options}
    return _grainlab.open(json.loads(call(*words, *flags(options), wrong=_grainlab.SceneError))["recording"])


class Campaign:
    """A campaign of runs: a folder with its members and tables of their states, in SI units. Made by :func:`campaign`, or from the folder.

    Its methods raise GrainlabError for what is no campaign.

    >>> grainlab.Campaign("recordings/campaigns/friction").status()["counts"]
    """

    def __init__(self, path: PathOrText) -> None:
        self.path = Path(path)

    def __repr__(self) -> str:
        return f"<grainlab.Campaign {self.path}>"

    def status(self) -> dict[str, Any]:
        """Members by state, also while they run, with seconds and the reason of each failure. Raises GrainlabError."""
        return json.loads(call("campaign", "status", self.path, "--format=json"))

    def gather(self) -> dict[str, Any]:
        """Columns of the states of all finished members, in SI units: arrays, of texts where one is no number. It also writes states.csv
        and groups.csv. Missing members are a warning. Raises GrainlabError."""
        call("campaign", "gather", self.path)
        return tables.parsed((self.path / "states.csv").read_text())

    @property
    def runs(self) -> list[Recording]:
        """The recordings of the finished members."""
        members = self.status()["members"]
        return [_grainlab.open(self.path / "members" / m["name"]) for m in members if m["state"] == "finished"]


def campaign(file: PathOrText | Mapping[str, Any], out: PathOrText | None = None, **options: Any) -> Campaign:
    """Runs many scenes with other seeds and values, each as a recorded run, on this machine or a cluster, and gathers their states.

    ``file`` is the path of a campaign, or a mapping with its keys, as ``grainlab campaign keys`` lists them, in SI units. ``out`` is its folder.
    Keywords are the flags of ``grainlab campaign``: ``jobs``, ``engine="slurm"``, ``member_time``. Called again, it continues. Failed members are
    a warning. Raises SceneError for faults of the campaign or of a scene, and GrainlabError.

    >>> made = grainlab.campaign({"name": "friction", "scenes": ["demo"], "seeds": [1, 2], "vary": {"friction": [0.1, 0.3]}})
    >>> made.gather()["z"]
    """
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "campaign.toml") if isinstance(file, Mapping) else Path(file)
        if isinstance(file, Mapping):
            path.write_text("".join(f"{key} = {toml(value)}\n" for key, value in file.items()))
        name = re.search(r"""^name\s*=\s*["']([^"']+)""", path.read_text() if path.is_file() else "", re.MULTILINE)
        out = Path("recordings/campaigns", name.group(1) if name else "") if out is None else Path(out)
        call("campaign", path, "--out", out, *flags(options), wrong=_grainlab.SceneError, answers=(0, 1, 3, 4))
    return Campaign(out)


def report(runs: PathOrText | Campaign | Iterable[PathOrText], out: PathOrText | None = None) -> Page:
    """Reports runs: a page with results, plots and packings of a run, or one row per run, with SI units; a notebook shows it.

    ``out`` is the file of the page; without it, none is left of a single run. Many runs have a page each in their folders. What could not be
    read is a warning, and named on the page. Raises GrainlabError for what is no run.

    >>> grainlab.report("recordings/runs/demo-1-1", "report.html")
    """
    runs = runs.runs if isinstance(runs, Campaign) else runs
    each = [runs] if isinstance(runs, (str, os.PathLike)) else list(runs)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "report.html") if out is None else Path(out)
        call("report", *each, "-o", path)
        return Page(path.read_text())


def reproduce(out: PathOrText | None = None, **options: Any) -> dict[str, Any]:
    """Reproduces the tables and figures of La Ragione & Magnanimo (2012): sixteen states, in SI units, as reproduction.json has them.

    Keywords are the flags of ``grainlab reproduce``: ``quick=True`` (500 grains, within a minute), ``seeds``. The page is index.html in ``out``.
    Raises GrainlabError.

    >>> grainlab.reproduce("paper", quick=True)
    """
    return json.loads(call("reproduce", "--format=json", *flags({"out": out, **options})))
