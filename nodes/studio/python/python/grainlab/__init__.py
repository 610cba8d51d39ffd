"""Packings of elastic spheres: recordings as numpy arrays, fabric and stiffness, inversion, simulation.

SI units. Stress is positive in compression. Voigt order is xx, yy, zz, yz, xz, xy. Arrays of a packing share its memory
and are read-only.

>>> import grainlab
>>> *_, packing = grainlab.simulate("demo", set={"grains.count": 200})   # doctest: +SKIP
>>> grainlab.stiffness(packing)                                          # doctest: +SKIP
"""

from ._grainlab import (
    FileError,
    GrainlabError,
    Packing,
    PhysicsError,
    Recording,
    SceneError,
    Simulation,
    __version__,
    analyze,
    invert,
    load,
    models,
    open,
    quantities,
    simulate,
    stiffness,
)
from .handover import to_freud, to_ovito

__all__ = [
    "FileError",
    "GrainlabError",
    "Packing",
    "PhysicsError",
    "Recording",
    "SceneError",
    "Simulation",
    "__version__",
    "analyze",
    "invert",
    "load",
    "models",
    "open",
    "quantities",
    "simulate",
    "stiffness",
    "to_freud",
    "to_ovito",
]
