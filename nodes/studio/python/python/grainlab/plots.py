"""Figures of runs, by matplotlib."""

from __future__ import annotations

import os
from typing import Any

from . import _grainlab

#: Figures by name: label of the ordinate, and curves by label as functions of a message of the topic `stress`.
FIGURES: dict[str, tuple[str, dict[str, Any]]] = {
    "stress": ("stress, kPa", {c: lambda m, c=c: m["stress"][c] / 1e3 for c in ("xx", "yy", "zz", "yz", "xz", "xy")}),
    "strain": ("strain", {c: lambda m, c=c: m["strain"][c] for c in ("xx", "yy", "zz", "yz", "xz", "xy")}),
    "solid_fraction": ("solid fraction", {"": lambda m: m["solid_fraction"]}),
    "coordination": ("contacts per grain", {"": lambda m: m["coordination"]}),
}
#: Stamp of the start of a run, s.
START = 10**9


def plot(run: str | os.PathLike[str], what: str = "stress", axes: Any = None) -> Any:
    """Draws a curve of a recorded run over its simulated time, s, by matplotlib.

    ``what`` is one of stress (kPa, positive in compression), strain (positive in extension), solid_fraction and coordination. ``axes`` are
    those to draw into. Returns the axes. Raises ValueError for another name, and FileError for a run that recorded results only.

    >>> grainlab.plot("recordings/runs/demo-1-1", "stress")
    """
    if what not in FIGURES:
        raise ValueError(f"no figure {what!r}; there are: {', '.join(FIGURES)}")
    import matplotlib.pyplot

    messages = [fields for _, _, fields in _grainlab.open(run).messages("stress")]
    stamps = [message["header"]["stamp"] for message in messages]
    times = [stamp["sec"] - START + stamp["nanosec"] * 1e-9 for stamp in stamps]
    ordinate, curves = FIGURES[what]
    axes = matplotlib.pyplot.figure().add_subplot() if axes is None else axes
    for label, value in curves.items():
        axes.plot(times, [value(message) for message in messages], label=label or None)
    axes.set(xlabel="time, s", ylabel=ordinate)
    if len(curves) > 1:
        axes.legend()
    return axes
