"""Tables in and out: mappings of columns, lists of rows, data frames."""

from __future__ import annotations

import csv
import io
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import numpy as np


def text_of(value: Any) -> str:
    """A cell as text; empty if it is unknown."""
    if isinstance(value, bool):
        return str(value).lower()
    unknown = value is None or type(value).__name__ in ("NAType", "NaTType") or (isinstance(value, float) and value != value)
    return "" if unknown else str(value)


def column(name: str, values: Any) -> np.ndarray | list[str]:
    """A column as float64, shape () or (n,), or as texts, of which a list has one for each row."""
    import numpy as np

    try:
        array = np.asarray(values)
    except ValueError as error:
        raise ValueError(f"{name}: {error}") from None
    if array.ndim > 1:
        raise ValueError(f"{name} has shape {array.shape}; it must be one number, or (n,)")
    if array.dtype.kind in "iuf":
        return np.ascontiguousarray(array, dtype=np.float64).reshape(array.shape)
    if array.dtype.kind not in "bOUmM":
        raise ValueError(f"{name} has numbers of type {array.dtype}; they must be real")
    texts = [text_of(value) for value in array.reshape(-1).tolist()]
    return texts if array.ndim else texts[0]


def columns(table: Any) -> dict[str, np.ndarray | list[str]]:
    """The columns of a mapping of arrays, of a data frame, or of a list of rows, which are mappings."""
    if isinstance(table, (list, tuple)):
        if not all(hasattr(row, "keys") for row in table):
            raise ValueError("a list is a table if each row is a mapping of names to values")
        names = dict.fromkeys(name for row in table for name in row)
        table = {name: [row.get(name) for row in table] for name in names}
    elif not hasattr(table, "keys") and not hasattr(table, "columns"):
        raise ValueError(f"a table is a mapping of columns, a data frame, a list of rows or a path, not {type(table).__name__}")
    names = list(table.columns if hasattr(table, "columns") else table.keys())
    if len(set(map(str, names))) < len(names):
        raise ValueError(f"a column is there twice; there are: {', '.join(map(str, names))}")
    return {str(name): column(str(name), table[name]) for name in names}


def broadcast(given: dict[str, Any]) -> tuple[list[tuple[str, Any]], int, bool]:
    """Columns of one length, that length, and whether there is any but of single values. Raises ValueError for two lengths."""
    import numpy as np

    sizes = {name: len(c) for name, c in given.items() if isinstance(c, list) or getattr(c, "ndim", 0)}
    if len(set(sizes.values())) > 1:
        raise ValueError("columns have different lengths: " + ", ".join(f"{name} {size}" for name, size in sizes.items()))
    rows = next(iter(sizes.values()), 1)

    def spread(c: Any) -> Any:
        if isinstance(c, str):
            return [c] * rows
        return c if isinstance(c, list) or c.ndim else np.full(rows, float(c))

    return [(name, spread(c)) for name, c in given.items()], rows, bool(sizes)


def like(table: Any, answers: dict[str, Any]) -> Any:
    """Columns as a data frame if the table is one, with its index, else as arrays."""
    import numpy as np

    if hasattr(table, "columns") and not isinstance(table, dict):
        index = {"index": table.index} if hasattr(table, "index") else {}
        return type(table)(answers, **index)
    return {name: np.asarray(c) for name, c in answers.items()}


def csv_text(table: Any) -> str:
    """A table as CSV."""
    spread, rows, _ = broadcast(columns(table))
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow([name for name, _ in spread])
    writer.writerows([[text_of(v) for v in row] for row in zip(*(getattr(c, "tolist", lambda c=c: c)() for _, c in spread))])
    return text.getvalue()
