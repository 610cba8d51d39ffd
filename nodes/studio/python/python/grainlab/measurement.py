"""Measurements of packings, their pictures and their files."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable
from pathlib import Path
from typing import Any, Literal

from . import _grainlab, tables
from ._grainlab import Packing
from .scenes import warn

Packings = Packing | Iterable[Packing] | str | os.PathLike[str]


def packings_of(what: Packings) -> list[Packing]:
    """A packing, packings, or those of a file, as a list."""
    if isinstance(what, (str, os.PathLike)):
        return _grainlab.load(what)
    found = [what] if isinstance(what, Packing) else list(what)
    wrong = [type(packing).__name__ for packing in found if not isinstance(packing, Packing)]
    if wrong:
        raise TypeError(f"packings are needed, or the path of a file, not {wrong[0]}")
    return found


def analyze(
    packing: Packings,
    *,
    axis: Any = (0.0, 0.0, 1.0),
    springs: Literal["carried", "both", "normal"] = "carried",
    tolerance: float | None = None,
) -> dict[str, Any]:
    """Structure, stress and stiffness: all that ``grainlab analyze`` reports, by key, in SI units (see :func:`quantities`).

    One packing gives a dict: unknown values are None, and stiffnesses arrays (6, 6), Pa; doubts, as of a packing that is not at rest, are warnings.
    Raises PhysicsError. A list of packings, or the
    path of a file of them, gives the columns of ``grainlab analyze --format csv``, arrays (n,): ``pandas.DataFrame(...)`` takes them, and
    ``invert(table=...)``. There a packing without an answer has NaN, ``status`` unknown, and its ``reason``; it raises nothing. The
    packings are measured on all cores.

    Springs: "carried" are those that the contacts carry, no tangential ones in a packing without friction. The tolerance is the relative
    residual of the solve; None: 1e-9, and 1e-5 from 50,000 grains. The axis is that of the anisotropy.

    >>> grainlab.analyze(packing)["z"]
    >>> grainlab.analyze(recording.packings())["g13_pa"]
    """
    if isinstance(packing, Packing):
        found, doubts = _grainlab.analyze_one(packing, axis, springs, tolerance)
        warn(doubts)
        return found
    return tables.parsed(_grainlab.analyze_all(packings_of(packing), axis, springs, tolerance))


def probe(packing: Packings, **parameters: Any) -> dict[str, Any]:
    """Sends waves through packings: their speeds, m/s, and the moduli that follow, Pa.

    Keywords are the parameters of the node ``acoustic_probe``, as ``grainlab probe --help`` lists them: ``method``, ``speed_noise``
    (relative), ``wavelengths`` (mean diameters), ``seed``. One packing gives a dict: the JSON of that command, the waves in
    ``["acoustic"]``, None if no wave propagates. Raises PhysicsError. A list of packings, or the path of a file of them, gives the
    columns of its CSV, as :func:`analyze` does. Raises ValueError for wrong parameters.

    >>> grainlab.probe(packing, speed_noise=0.003)["acoustic"]["speeds"]
    """
    words = [(name, ",".join(map(str, v)) if isinstance(v, (list, tuple)) else str(v)) for name, v in parameters.items()]
    text, first = _grainlab.probe_all(packings_of(packing), words)
    columns = tables.parsed(text)
    if not isinstance(packing, Packing):
        return columns
    if first is None:
        raise _grainlab.PhysicsError(columns["reason"][0])
    return json.loads(first)


def export(packings: Packings, out: str | os.PathLike[str], *, format: str = "vtk") -> list[Path]:
    """Writes packings as files of other programs, in SI units, into the folder ``out``; the paths of the new files.

    Formats are csv, lammps, lammps-data, xyz and vtk; csv loses nothing but a strain without a reference state. Existing files are not overwritten. Notes on what
    a format leaves out are warnings. Raises ValueError for another format, and FileError for files that exist.

    >>> grainlab.export(recording.packings(), "paraview", format="vtk")
    """
    before = set(Path(out).glob("*"))
    warn(_grainlab.export(packings_of(packings), format, out))
    return sorted(set(Path(out).glob("*")) - before)


def view(
    packings: Packings,
    out: str | os.PathLike[str] | None = None,
    *,
    color: Literal["coordination", "force", "rattlers"] = "coordination",
    size: tuple[int, int] = (1200, 900),
) -> Path | Page:
    """Shows packings in three dimensions.

    ``out`` is the file of a page (.html), to turn and slice all packings, or of a picture of the last one (.png), of this size in pixels
    and with these colours. Without it, the page is shown by a notebook. A packing alone is a picture in a notebook. Raises ValueError.

    >>> grainlab.view(packing, "packing.png", color="force")
    """
    found = packings_of(packings)
    if not found:
        raise ValueError("there is no packing to show")
    path = None if out is None else Path(out)
    if path and path.suffix == ".png":
        path.write_bytes(found[-1]._png(color, f"{size[0]}x{size[1]}"))
        return path
    if path and path.suffix not in (".html", ".htm"):
        raise ValueError(f"{path}: a page is .html, and a picture .png")
    page = _grainlab.page(path.stem if path else "packings", found)
    return (path.write_text(page), path)[1] if path else Page(page)


class Page:
    """A page in HTML, which a notebook shows; ``text`` is the page. It has no units, and raises nothing.

    >>> grainlab.view(packing)
    """

    def __init__(self, text: str) -> None:
        self.text = text

    def _repr_html_(self) -> str:
        from html import escape

        return f'<iframe srcdoc="{escape(self.text)}" width="100%" height="600" style="border: 0"></iframe>'
