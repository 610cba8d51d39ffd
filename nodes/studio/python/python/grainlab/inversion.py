"""From moduli and wave speeds to microstructure."""

from __future__ import annotations

import json
import os
import tempfile
from collections.abc import Mapping
from os import PathLike
from pathlib import Path
from typing import Any

from . import _grainlab, tables
from .program import call, flags
from .scenes import toml, warn, whole

#: Columns of `grainlab invert --table` by the keywords of `invert`.
COLUMNS = {
    **{m: f"{m}_pa" for m in ("g12", "g13", "theta", "c11", "c33", "c13", "pressure")},
    **{f"{m}_sigma": f"{m}_sigma_pa" for m in ("g12", "g13", "theta", "c11", "c33", "c13", "pressure")},
    **{name: name for name in ("phi", "phi_sigma", "size_spread", "grains", "probe", "sample")},
    **{"stress_ratio": "axial_q_over_p", "stress_ratio_sigma": "axial_q_over_p_sigma"},
    **{"gamma": "gamma_over_delta", "gamma_sigma": "gamma_over_delta_sigma"},
    **{"shear_modulus": "grain_shear_modulus_pa", "shear_modulus_sigma": "grain_shear_modulus_sigma_pa"},
    **{"poisson_ratio": "poisson", "poisson_ratio_sigma": "poisson_sigma"},
}


def invert(
    *,
    table: Any = None,
    speeds: Any = None,
    error: float | None = None,
    model: str = "relaxed",
    calibration: str | PathLike[str] = "default",
    prior: str | None = None,
    draws: int | None = None,
    seed: int = 0,
    **given: Any,
) -> Any:
    """Coordination and anisotropy from moduli or wave speeds of one state or many.

    Keywords of a state, each a number or an array (n,): ``pressure``; the moduli ``g12 g13 theta c11 c33 c13``; ``shear_modulus`` of the
    grains, all in Pa; ``poisson_ratio``, ``phi``, ``stress_ratio`` (axial minus lateral stress over pressure), ``size_spread``, ``gamma`` (deviatoric over volumetric strain),
    all without unit; ``grains``, their number, any from 100 to 20,000 if unknown; ``probe``, "sticking" if no contact slid while the moduli
    were measured, else "unknown", which widens the errors; ``sample``. Only emt and hertz-mindlin use ``phi``, only emt and the ratios ``gamma``. Each may have an error, a standard deviation in its unit: ``g12_sigma``. NaN, None
    and what a mask hides are not known. ``error`` is the relative error of each modulus without its own, or of each speed; None, as on the command
    line: unknown, which a warning says, and 0.01 for speeds whose contacts are not known.

    Numbers give a dict: ``k``, ``z``, ``eps`` and others with ``_sigma`` and the 95 % ``_interval``, None if undetermined; ``status`` (ok,
    extrapolated or contradictory) and ``warnings``. Raises PhysicsError for moduli without a solution, and ValueError for wrong input.
    ``z_interval`` and its like: value +- 1.96 sigma; a skewed posterior: see ``draws``.

    Arrays give arrays (n,) by the same keys, with ``z_low`` and ``z_high`` for the interval. A row without an answer has NaN, the status
    unknown, and its reason in ``reason``; it raises nothing. So does ``table``: a mapping of arrays, a list of rows, a data frame, which
    gives a data frame with the same index, or the path of a CSV file, with the columns of ``grainlab invert --table`` (``g12_pa``,
    ``pressure_pa``, the 36 entries of a stiffness, ...), as ``analyze`` of a list of packings has them. Columns
    of other names are not used; one that is almost the name of a column is an error.

    ``speeds`` is a table or path with the columns of ``grainlab invert --speeds`` (``pressure_pa``, ``mode``, ``speed``, m/s, ...); further
    keywords are the flags of that command (``density``, kg/m3; ``contact``), and the answer is its JSON: a list of samples, or with
    ``contact="hertz"`` and one pressure a dict.

    ``calibration`` is a name, a path, or the text that ``calibrate`` returns, and ``prior`` the text of a prior file, as ``grainlab invert
    --print-prior`` prints it. With ``draws``, the key of this name has so many independent draws from the posterior in each of four
    chains, the same for the same seed: ``grainlab.to_arviz(found["draws"])``. Its log_likelihood is that of each modulus given the
    others, for moduli in MPa.

    >>> found = grainlab.invert(g12=104.2e6, g13=112.4e6, theta=136e6, pressure=50e3, probe="sticking")
    >>> found["z"], found["z_sigma"]
    >>> frame = grainlab.invert(table=pandas.read_csv("states.csv"))
    """
    if speeds is not None:
        if table is not None or draws is not None or seed:
            raise ValueError("table, draws and seed are not for speeds")
        return _of_speeds(speeds, error, model, calibration, prior, given)
    unknown = [name for name in given if name not in COLUMNS]
    if unknown:
        raise TypeError(f"invert() has no keyword {unknown[0]!r}; of a state there are: {', '.join(COLUMNS)}")
    given = {name: value for name, value in given.items() if value is not None}
    tables.aligned({**({"table": table} if hasattr(table, "columns") else table if isinstance(table, Mapping) else {}), **given})
    of_keywords = {COLUMNS[name]: tables.column(name, value) for name, value in given.items()}
    if isinstance(table, (str, PathLike)):
        if of_keywords:
            raise ValueError(f"{', '.join(given)}: the columns of a file have the states")
        text = _bytes(table)
    else:
        of_table = {} if table is None else tables.columns(table)
        twice = [name for name in of_keywords if name in of_table]
        if twice:
            raise ValueError(f"{twice[0]} is a column of the table, and a keyword")
        text = tables.csv_text({**of_table, **of_keywords}, numbered=True).encode()
    is_table = table is not None or any(isinstance(column, list) for column in of_keywords.values())
    if draws is not None and is_table:
        raise ValueError("draws are of one state")
    drawn_by = None if draws is None else (whole("draws", draws, least=1), whole("seed", seed))
    by = (model, os.fspath(calibration), prior, error)
    answers, drawn = _grainlab.inverted(text, by, drawn_by)
    failed, warnings, contradictions = (answers.pop(key) for key in ("failed", "warnings", "contradictions"))
    if is_table:
        return tables.like(table, answers)
    if failed[0]:
        raise (ValueError if failed[0] == 2 else _grainlab.PhysicsError)(answers["reason"][0])
    found = {key: _single(value[0]) for key, value in answers.items() if key != "reason"}
    for low in [key for key in found if key.endswith("_low")]:
        bounds = (found.pop(low), found.pop(low.removesuffix("low") + "high"))
        found[low.removesuffix("low") + "interval"] = None if None in bounds else bounds
    found["warnings"] = warnings[0]
    if found["status"] == "contradictory":
        warn(["the estimate is contradictory: " + "; ".join(contradictions[0])])
    return found if drawn is None else {**found, "draws": drawn}


def _single(value: Any) -> Any:
    return value if isinstance(value, str) else None if value != value else float(value)


def _bytes(path: str | PathLike[str]) -> bytes:
    try:
        return Path(path).read_bytes()
    except OSError as error:
        raise _grainlab.FileError(f"{path}: {error.strerror}") from None


def _of_speeds(speeds: Any, error: Any, model: str, calibration: Any, prior: str | None, given: dict[str, Any]) -> Any:
    names = {"shear_modulus": "grain_shear_modulus", "shear_modulus_sigma": "grain_shear_modulus_sigma"}
    names |= {"poisson_ratio": "poisson", "poisson_ratio_sigma": "poisson_sigma", "gamma": "gamma_over_delta"}
    options = {names.get(name, name): value for name, value in given.items()}
    if options.get("contact") == "hertz":
        options |= {"model": model}
    is_path = isinstance(speeds, (str, PathLike))
    with tempfile.TemporaryDirectory() as folder:
        for flag, text in (("prior", prior), ("calibration", os.fspath(calibration))):
            if text is not None and "\n" in text:
                options[flag] = Path(folder, flag + ".toml")
                options[flag].write_text(text)
            elif text not in (None, "default"):
                options[flag] = text
        words = ["invert", f"--speeds={speeds if is_path else '-'}", "--format=json", *flags({"error": error, **options})]
        return json.loads(call(*words, input=None if is_path else tables.csv_text(tables.columns(speeds))))


def plan(plan: str | PathLike[str] | Mapping[str, Any], *, shear_modulus: float, poisson_ratio: float, **options: Any) -> dict[str, Any]:
    """Expected errors of z, eps and contacts by speeds that are planned, the speed that would help most, and the errors that are wanted.

    ``plan`` is a mapping, or the path of a file, with the keys of ``grainlab invert --plan``: ``pressures`` in Pa, ``error`` relative,
    ``speeds``. The shear modulus of the grains is in Pa. Further keywords are flags of that command. Takes seconds. Raises ValueError.

    >>> grainlab.plan({"error": 0.01, "pressures": [1e5, 4e5], "speeds": [{"mode": "p"}, {"mode": "s"}]},
    ...               shear_modulus=29e9, poisson_ratio=0.2)["quantities"][0]["sigma"]
    """
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "plan.toml") if isinstance(plan, Mapping) else Path(plan)
        if isinstance(plan, Mapping):
            path.write_text("".join(f"{key} = {toml(value)}\n" for key, value in plan.items()))
        options = {"grain_shear_modulus": shear_modulus, "poisson": poisson_ratio, **options}
        return json.loads(call("invert", "--plan", path, "--format=json", *flags(options)))


def calibrate(isotropic: Any, anisotropic: Any = None, other: Any = None, *, name: str = "mine", **options: Any) -> str:
    """Learns the constants of the models from measured packings: the text of a calibration, for ``invert(calibration=...)`` or a file.

    Each table is a path, a mapping of arrays, a list of rows or a data frame, with the columns of ``grainlab analyze --format csv``, in SI
    units (``pressure_pa``, ``g12_pa``, ...), and columns that identify the preparation and the packing, named by ``preparation`` and
    ``packing``. Without anisotropic packings only Eqs. 21 and 22 are fitted, not the model relaxed. Raises ValueError for wrong tables,
    and PhysicsError for packings that determine no calibration.

    >>> mine = grainlab.calibrate("isotropic.csv", "anisotropic.csv", preparation=["preparation"])
    >>> grainlab.invert(g12=104.2e6, g13=112.4e6, theta=136e6, pressure=50e3, calibration=mine)
    """
    with tempfile.TemporaryDirectory() as folder:
        for flag, table in (("isotropic", isotropic), ("anisotropic", anisotropic), ("other", other)):
            if table is not None and not isinstance(table, (str, PathLike)):
                table, rows = Path(folder, flag + ".csv"), tables.csv_text(tables.columns(table))
                table.write_text(rows)
            options[flag] = table
        return call("calibrate", *flags({"name": name, **options}), answers=(0,))


def pick(records: str | PathLike[str], **options: Any) -> list[dict[str, Any]]:
    """Picks arrivals in records of an oscilloscope: speeds of long waves, m/s, with errors.

    ``records`` is the path of the table that ``grainlab pick --help`` describes. Keywords are its flags: ``out`` for the speeds as a file of
    ``invert(speeds=...)``, ``plot`` for a folder of figures, ``seed``. Raises ValueError for wrong tables.

    >>> picks = grainlab.pick("records.csv", out="speeds.csv")
    """
    return json.loads(call("pick", records, "--format=json", *flags(options)))
