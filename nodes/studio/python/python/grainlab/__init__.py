"""Packings of elastic spheres: recordings as numpy arrays, simulation, fabric and stiffness, waves, inversion, campaigns, reports.

SI units. Stress is positive in compression, strain in extension. Voigt order is xx, yy, zz, yz, xz, xy. Arrays of a packing share its
memory and are read-only. Recorded runs, campaigns and reports are made by processes of the program ``grainlab``, which this package has.

>>> import grainlab
>>> *_, packing = grainlab.simulate("demo", set={"grains.count": 200})
>>> grainlab.stiffness(packing)
"""

from ._grainlab import FileError, GrainlabError, Packing, PhysicsError, Recording, SceneError, __version__
from ._grainlab import load, models, open, quantities, stiffness
from .handover import to_arviz, to_freud, to_ovito
from .inversion import calibrate, invert, pick, plan
from .measurement import Page, analyze, export, probe, view
from .plots import plot
from .program import command
from .recordings import Packings
from .runs import Campaign, campaign, launch, report, reproduce
from .scenes import Scene, scene_check, scene_keys, scenes
from .simulation import Simulation, simulate

__all__ = [
    "Campaign", "FileError", "GrainlabError", "Packing", "Packings", "Page", "PhysicsError", "Recording", "Scene", "SceneError",
    "Simulation", "__version__", "analyze", "calibrate", "campaign", "command", "export", "invert", "launch", "load", "models", "open",
    "pick", "plan", "plot", "probe", "quantities", "report", "reproduce", "scene_check", "scene_keys", "scenes", "simulate", "stiffness",
    "to_arviz", "to_freud", "to_ovito", "view",
]


def __getattr__(name: str) -> object:
    if name == "verify":
        raise AttributeError("grainlab.verify was removed: in a checkout, cargo run --release -p grainlab_verify")
    raise AttributeError(f"module 'grainlab' has no attribute {name!r}")
