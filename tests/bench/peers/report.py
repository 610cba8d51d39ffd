"""Medians, ranges and ratios of the repetitions, as a table and as JSON."""

import statistics
from dataclasses import asdict, dataclass, field
from typing import Optional

from peers.measurement import Case, Measurement


@dataclass(frozen=True)
class Spread:
    """Statistics of the repetitions."""

    median: float
    minimum: float
    maximum: float

    @classmethod
    def of(cls, values: list[Optional[float]]) -> Optional["Spread"]:
        values = [v for v in values if v is not None]
        return cls(statistics.median(values), min(values), max(values)) if values else None

    def text(self, scale: float, digits: int) -> str:
        return " ".join(f"{v / scale:.{digits}f}" for v in (self.median, self.minimum, self.maximum))


@dataclass
class Group:
    """The repetitions of every code at one size on one number of threads."""

    grains: int
    threads: int
    cases: list[Case]
    runs: dict[str, list[Optional[Measurement]]] = field(default_factory=dict)
    """By name of the case, one per repetition; None if a run failed."""

    def rates(self, name: str, clock: str) -> Optional[Spread]:
        """Particle-steps per second of `clock`, "wall" or "cpu"."""
        return Spread.of([getattr(run, f"{clock}_rate") for run in self.runs.get(name, []) if run])

    def ratios(self, case: Case, clock: str) -> Optional[Spread]:
        """Rate of grainlab over that of `case`, both with or both without servo, in the same repetition."""
        ours = next((c for c in self.cases if c.ours and c.servo == case.servo), None)
        if ours is None or case.ours:
            return None
        ratios = []
        for mine, theirs in zip(self.runs.get(ours.name, []), self.runs.get(case.name, [])):
            rates = [getattr(run, f"{clock}_rate") if run else None for run in (mine, theirs)]
            ratios.append(rates[0] / rates[1] if all(rates) else None)
        return Spread.of(ratios)

    def table(self) -> str:
        """One line per code: median, least and largest of the repetitions."""
        millions = "M particle-steps/s"
        lines = [
            f"N = {self.grains}, {self.threads} thread{'s' * (self.threads > 1)}",
            f"  {'median min max':52} {'wall, ' + millions:>24} {'CPU, ' + millions:>24} {'ours/it, wall':>15}"
            f" {'ours/it, CPU':>15} {'z':>7} {'p/kPa':>7}",
        ]
        for case in self.cases:
            done = [run for run in self.runs.get(case.name, []) if run]
            if not done:
                lines.append(f"  {case.name:52} failed")
                continue
            cells = []
            for spread, scale, width in (
                (self.rates(case.name, "wall"), 1e6, 24),
                (self.rates(case.name, "cpu"), 1e6, 24),
                (self.ratios(case, "wall"), 1.0, 15),
                (self.ratios(case, "cpu"), 1.0, 15),
            ):
                cells.append(f"{spread.text(scale, 2) if spread else '-':>{width}}")
            end = done[-1].end
            z = f"{end.coordination:.3f}" if end else "-"
            p = f"{end.pressure / 1e3:.2f}" if end and end.pressure is not None else "-"
            lines.append(f"  {case.name:52} {' '.join(cells)} {z:>7} {p:>7}")
        return "\n".join(lines)

    def rows(self) -> list[dict]:
        """Results as data, with every run."""
        rows = []
        for case in self.cases:
            spreads = {f"{clock}_particle_steps_per_second": self.rates(case.name, clock) for clock in ("wall", "cpu")}
            spreads |= {f"ours_over_this_{clock}": self.ratios(case, clock) for clock in ("wall", "cpu")}
            rows.append(
                {
                    "code": case.name,
                    "ours": case.ours,
                    "servo": case.servo,
                    "grains": self.grains,
                    "threads": self.threads,
                    **{key: asdict(spread) if spread else None for key, spread in spreads.items()},
                    "runs": [asdict(run) if run else None for run in self.runs.get(case.name, [])],
                }
            )
        return rows
