"""Tables in and out: mappings of columns, lists of rows, data frames, CSV."""

from __future__ import annotations

import csv
import io
from typing import Any


def text_of(value: Any) -> str:
    """A cell as text; empty if it is unknown."""
    if value is None or value != value or type(value).__name__ == "NaTType":
        return ""
    return str(value).lower() if isinstance(value, bool) else str(value)


def column(name: str, values: Any) -> list[str] | str:
    """A column as texts, or as one for every row. Raises ValueError for arrays of more dimensions, and for complex numbers."""
    import numpy as np

    if np.ma.isMaskedArray(values):
        values = values.astype(object).filled(np.nan)
    try:
        array = np.asarray(values)
    except ValueError as error:
        raise ValueError(f"{name}: {error}") from None
    if array.ndim > 1 or array.dtype.kind == "c":
        raise ValueError(f"{name} has shape {array.shape} and type {array.dtype}; it must be one real number, or (n,)")
    if array.dtype.kind == "O":
        array = np.array([None if type(v).__name__ == "NAType" else v for v in array.flat], dtype=object).reshape(array.shape)
    if array.dtype.kind in "iuf":
        numbers = ["" if value != value else repr(value) for value in array.reshape(-1).tolist()]
        return numbers if array.ndim else numbers[0]
    texts = [text_of(value) for value in array.reshape(-1).tolist()]
    if any("\n" in text or "\r" in text for text in texts):
        raise ValueError(f"{name}: a text has one line")
    return texts if array.ndim else texts[0]


def aligned(given: Any) -> None:
    """Raises ValueError for series of pandas that have other indexes, which would be paired by position."""
    indexes = [(name, values.index) for name, values in given.items() if hasattr(getattr(values, "index", None), "equals")]
    for name, index in indexes[1:]:
        if not index.equals(indexes[0][1]):
            raise ValueError(f"{indexes[0][0]} and {name} have different indexes: give them as columns of one data frame, or as arrays")


def columns(table: Any) -> dict[str, list[str] | str]:
    """The columns of a mapping of arrays, of a data frame, or of a list of rows, which are mappings."""
    if isinstance(table, (list, tuple)) and all(hasattr(row, "keys") for row in table):
        table = {name: [row.get(name) for row in table] for name in dict.fromkeys(name for row in table for name in row)}
    elif not hasattr(table, "keys") and not hasattr(table, "columns"):
        raise ValueError(f"a table is a mapping of columns, a data frame, a list of rows or a path, not {type(table).__name__}")
    names = list(table.columns if hasattr(table, "columns") else table.keys())
    if len(set(map(str, names))) < len(names):
        raise ValueError(f"a column is there twice; there are: {', '.join(map(str, names))}")
    aligned({name: table[name] for name in names})
    return {str(name): column(str(name), table[name]) for name in names}


def csv_text(given: dict[str, list[str] | str], numbered: bool = False) -> str:
    """Columns as CSV; a number before each row, of no input, keeps it from being blank, or a comment. Raises ValueError for two lengths."""
    sizes = {name: len(c) for name, c in given.items() if isinstance(c, list)}
    if len(set(sizes.values())) > 1:
        raise ValueError("columns have different lengths: " + ", ".join(f"{name} {size}" for name, size in sizes.items()))
    rows = next(iter(sizes.values()), 1)
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    given = {**({"_row": list(map(str, range(rows)))} if numbered else {}), **given}
    writer.writerow(given)
    writer.writerows(zip(*([c] * rows if isinstance(c, str) else c for c in given.values())))
    return text.getvalue()


def parsed(text: str) -> dict[str, Any]:
    """Columns of CSV as arrays, typed as pandas types them: of integers, of numbers with NaN for what is unknown, of flags, or of texts."""
    header, *rows = csv.reader(io.StringIO(text))
    return {name: typed(cells) for name, cells in zip(header, zip(*rows) if rows else [()] * len(header))}


def typed(cells: tuple[str, ...]) -> Any:
    """The cells of a column as an array."""
    import numpy as np

    if cells and all(cell.lstrip("-").isdecimal() for cell in cells):
        # A float has 53 bits: it would change a large seed.
        whole = np.array([int(cell) for cell in cells])
        if whole.dtype.kind in "iu":
            return whole
    try:
        return np.array([float(cell or "nan") for cell in cells])
    except ValueError:
        return np.array(cells) == "true" if set(cells) <= {"true", "false"} else np.array(cells)


def like(table: Any, answers: dict[str, Any]) -> Any:
    """Columns as a data frame if the table is one, with its index, else as arrays."""
    import numpy as np

    if hasattr(table, "columns") and not hasattr(table, "__fspath__"):
        index = {"index": table.index} if hasattr(table, "index") else {}
        return type(table)(answers, **index)
    return {name: np.asarray(c) for name, c in answers.items()}
