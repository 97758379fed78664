"""Matrices and tables of degrees of freedom as they are given."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _arguments

# Places are those of a node up to rounding: a share of the largest extent.
_SAME_PLACE = 1e-6
_COMPONENTS = {name: k for k, name in enumerate(("ux", "uy", "uz", "rotx", "roty", "rotz"), 1)}


def sparse_of(name: str, given: Any) -> Any:
    """A sparse matrix of doubles by columns, checked for what SciPy lets pass."""
    try:
        from scipy import sparse
    except ImportError:
        raise ImportError("nlmodes.Structure needs SciPy: pip install scipy") from None
    if not hasattr(given, "tocsc"):
        given = _arguments.floats(name, given, ("n", "n"))
    if given.ndim != 2 or given.shape[0] != given.shape[1]:
        raise ValueError(f"{name} has the shape {given.shape}; as many rows as columns were expected")
    if given.shape[0] == 0:
        raise ValueError(f"{name} is empty")
    if given.dtype.kind not in "iuf":
        raise TypeError(f"{name} has the type {given.dtype}; real numbers were expected")
    matrix = sparse.csc_matrix(given, dtype=np.float64, copy=True)
    matrix.sum_duplicates()
    if not np.isfinite(matrix.data).all():
        wrong = matrix.tocoo()
        at = int(np.flatnonzero(~np.isfinite(wrong.data))[0])
        raise ValueError(f"{name}[{wrong.row[at]}, {wrong.col[at]}] is {wrong.data[at]}; finite numbers were expected")
    return matrix


def dofs_of(given: Any, n: int) -> NDArray[Any]:
    """Node, component and place of each row."""
    plain = [("node", np.int64), ("component", np.int64)]
    placed = [*plain, ("x", np.float64), ("y", np.float64), ("z", np.float64)]
    if given is None:
        return np.array([(i + 1, 1) for i in range(n)], dtype=plain)
    if hasattr(given, "columns"):
        names = ["node", "component", *("x", "y", "z")[: 3 * ("x" in given.columns)]]
        missing = [name for name in names if name not in given.columns]
        if missing:
            raise ValueError(f"dofs has no column {missing[0]!r}")
        given = list(zip(*(given[name] for name in names), strict=True))
    if not isinstance(given, np.ndarray):
        given = [(row[0], _component(row[1]), *row[2:]) for row in map(tuple, given) if len(row) > 1]
    table = _arguments.floats("dofs", given, (n, "2 or 5"))
    if table.shape[1] not in (2, 5):
        raise ValueError(f"dofs has {table.shape[1]} columns; node, component, and perhaps x, y, z were expected")
    node, component = table[:, 0], table[:, 1]
    if (node < 0).any() or (node != np.floor(node)).any() or (node > 2**52).any():
        raise ValueError("dofs: whole numbers were expected as nodes, the first column")
    if not np.isin(component, range(1, 7)).all():
        raise ValueError("dofs: components are 1 to 6, the second column")
    found = np.empty(n, dtype=plain if table.shape[1] == 2 else placed)
    for name, column in zip(found.dtype.names or (), table.T, strict=True):
        found[name] = column
    return found


def _component(given: Any) -> Any:
    """The number of a component that may have a name."""
    if not isinstance(given, str):
        return given
    if given.lower() not in _COMPONENTS:
        raise ValueError(f"dofs: component {given!r}; expected 1 to 6 or one of: {', '.join(_COMPONENTS)}")
    return _COMPONENTS[given.lower()]


def node_of(name: str, given: Any, dofs: NDArray[Any]) -> int:
    """The number of a node that is given by it, or by its place."""
    if isinstance(given, (list, tuple)) or np.ndim(given) > 0:
        return _node_at(name, _arguments.floats(name, given, (3,)), dofs)
    found = _arguments.count(name, given)
    if not np.any(dofs["node"] == found):
        raise ValueError(f"{name} is {found}: no row of dofs belongs to this node")
    return found


def _node_at(name: str, place: NDArray[np.float64], dofs: NDArray[Any]) -> int:
    """The only node at a place."""
    if "x" not in (dofs.dtype.names or ()):
        raise ValueError(f"{name} is a place, but dofs has no places: x, y, z were expected behind node and component")
    places = np.column_stack([dofs[axis] for axis in "xyz"])
    distances = np.linalg.norm(places - place, axis=1)
    there = np.unique(dofs["node"][distances <= _SAME_PLACE * np.ptp(places, axis=0).max()])
    if len(there) == 1:
        return int(there[0])
    if len(there) > 1:
        raise ValueError(f"{name}: the nodes {', '.join(map(str, there[:5]))} are all at {_text(place)}; give the number of one")
    nearest = int(np.argmin(distances))
    raise ValueError(f"{name}: no node is at {_text(place)}; the nearest is {dofs['node'][nearest]} at {_text(places[nearest])}")


def _text(place: NDArray[np.float64]) -> str:
    return f"({', '.join(f'{x:.9g}' for x in place)}) m"
