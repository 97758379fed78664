"""Tables of results: columns of NumPy from the bytes of a CSV file."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

_TEXTS = {"event", "resonance", "record", "findings", "label", "reason", "message", "name", "kind", "id", "status", "method"}
_FLAGS = {"true": 1.0, "false": 0.0, "": np.nan}


def _column(name: str, cells: list[str]) -> NDArray[Any]:
    if name in _TEXTS:
        return np.array(cells, dtype=np.str_)
    try:
        return np.array([int(cell) for cell in cells], dtype=np.int64)
    except ValueError:
        pass
    try:
        return np.array([float(cell) if cell else np.nan for cell in cells])
    except ValueError:
        pass
    if all(cell in _FLAGS for cell in cells):
        return np.array([_FLAGS[cell] for cell in cells])
    return np.array(cells, dtype=np.str_)


class Table:
    """A table whose columns are arrays of NumPy, one entry a row.

    ``table["frequency_hz"]`` or ``table.frequency_hz``; ``table.columns`` lists the names, which contain the units. Cells that are empty are
    NaN; true and false are 1.0 and 0.0, so that those which are not known can be NaN.
    """

    def __init__(self, content: bytes, rows: slice | None = None) -> None:
        self._content = content
        self._rows = rows or slice(None)
        self._cells: dict[str, list[str]] | None = None
        self._arrays: dict[str, NDArray[Any]] = {}

    def _texts(self) -> dict[str, list[str]]:
        if self._cells is None:
            rows = list(csv.reader(io.StringIO(self._content.decode())))
            names = rows[0] if rows else []
            own = rows[1:][self._rows]
            self._cells = {name: [row[i] for row in own] for i, name in enumerate(names)}
        return self._cells

    @property
    def columns(self) -> list[str]:
        """Names of the columns."""
        return list(self._texts())

    def __getitem__(self, name: str) -> NDArray[Any]:
        if name not in self._arrays:
            cells = self._texts().get(name)
            if cells is None:
                raise KeyError(f"there is no column {name!r}; there are: {', '.join(self.columns)}")
            array = _column(name, cells)
            array.flags.writeable = False
            self._arrays[name] = array
        return self._arrays[name]

    def __getattr__(self, name: str) -> NDArray[Any]:
        if not name.startswith("_") and name in self._texts():
            return self[name]
        raise AttributeError(f"{type(self).__name__!r} has no attribute or column {name!r}")

    def __contains__(self, name: object) -> bool:
        return name in self._texts()

    def __iter__(self) -> Iterator[str]:
        return iter(self._texts())

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self.columns]

    def __len__(self) -> int:
        """Number of rows."""
        return len(next(iter(self._texts().values()), []))

    def to_pandas(self) -> Any:
        """The table as a ``pandas.DataFrame`` with a column for each of its own."""
        import pandas

        return pandas.DataFrame({name: self[name] for name in self.columns})
