"""Checks that all codes simulate the same packing, which a comparison of rates requires."""

import math
from dataclasses import dataclass
from typing import Optional

from peers.measurement import Measurement
from peers.packing import State

START_PRESSURE = 1e-6
"""Relative: all codes have Hertz contacts at the same positions; the rest is rounding of their output."""
START_COORDINATION = 1e-6
"""Relative: exactly the same contacts."""
END_COORDINATION = 0.01
"""Relative to the start: the tangential springs start empty, so that some contacts open as the packing settles."""
END_PRESSURE = 0.03
"""Relative to the start: the same settling costs 2 % of the pressure; a servo brings it back."""


@dataclass(frozen=True)
class Check:
    """One quantity of one run with its expected value."""

    what: str
    found: float
    expected: float
    tolerance: float
    """Relative; 0: equal."""

    @property
    def holds(self) -> bool:
        return math.isfinite(self.found) and abs(self.found - self.expected) <= self.tolerance * abs(self.expected)

    def __str__(self) -> str:
        return f"{self.what}: {self.found:.8g}, expected {self.expected:.8g} within {self.tolerance:g} of it"


def checks(name: str, run: Measurement, grains: int, reference: State) -> list[Check]:
    """Checks of one run against the state computed from the positions."""
    found = [Check(f"{name}: grains run", run.grains, grains, 0.0)]

    def compare(what: str, value: Optional[float], expected: float, tolerance: float) -> None:
        if value is not None:
            found.append(Check(f"{name}, {grains} grains: {what}", value, expected, tolerance))

    if run.start:
        compare("pressure at the start, Pa", run.start.pressure, reference.pressure, START_PRESSURE)
        compare("coordination at the start", run.start.coordination, reference.coordination, START_COORDINATION)
    if run.end:
        compare("pressure at the end, Pa", run.end.pressure, reference.pressure, END_PRESSURE)
        compare("coordination at the end", run.end.coordination, reference.coordination, END_COORDINATION)
    # Rebuilding a list is work that the other codes did not do.
    compare("neighbour lists built while timed", run.rebuilds, 0.0, 0.0)
    return found
