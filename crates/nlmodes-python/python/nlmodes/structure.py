"""Structures from matrices: stiffness and mass from SciPy, scikit-fem, FEniCS, pyNastran or by hand, and contacts of their nodes."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _arguments, _matrices
from ._analyses import Analyses
from ._files import Scratch
from ._result import Result
from ._run import Progress, linear_frequencies


class Structure(Analyses):
    """Stiffness and mass matrices with one-sided contacts.

    Parameters
    ----------
    K, M
        Stiffness (N/m) and mass (kg) (n, n), symmetric: sparse matrices of SciPy of any format, or arrays. Rows of supports are left out, or
        their nodes are given in ``fixed`` of a scene.
    dofs
        What each row is: (n, 2) node and component, or (n, 5) with the place x, y, z of the node (m) behind them; components are 1 to 6 or
        ``ux`` … ``rotz``. A table of pandas with these names as columns does too. Left out, row i is the node i + 1 that moves along x.
    title
        Title of tables and figures.

    Examples
    --------
    Two masses on springs, the first one 1 mm before a wall:

    >>> import numpy as np
    >>> import nlmodes
    >>> K, M = 1e6 * np.array([[1.0, -1.0], [-1.0, 2.0]]), np.eye(2)
    >>> structure = nlmodes.Structure(K, M).contact(node=1, normal=[1, 0, 0], gap_m=1e-3)
    >>> result = structure.mode(harmonics=5, max_energy_ratio=2.0, modes=1)
    >>> bool(abs(result.frequency_hz[0] - np.sqrt(np.linalg.eigvalsh(K)[0]) / (2 * np.pi)) < 1e-9)
    True
    """

    def __init__(self, K: Any, M: Any, dofs: Any = None, *, title: str = "structure from matrices") -> None:
        self._matrices = {"stiffness": _matrices.sparse_of("K", K), "mass": _matrices.sparse_of("M", M)}
        n = self._matrices["stiffness"].shape[0]
        if self._matrices["mass"].shape != (n, n):
            raise ValueError(f"M has the shape {self._matrices['mass'].shape}; ({n}, {n}) was expected, as of K")
        self._dofs = _matrices.dofs_of(dofs, n)
        self._title = _arguments.text("title", title)
        self._contacts: list[dict[str, Any]] = []

    @property
    def n_dofs(self) -> int:
        """Number of degrees of freedom n."""
        return len(self._dofs)

    def __repr__(self) -> str:
        return f"<Structure of {self.n_dofs} degrees of freedom with {len(self._contacts)} contact tables>"

    def contact(
        self,
        node: int | ArrayLike | None = None,
        normal: ArrayLike | None = None,
        gap_m: float | None = None,
        *,
        nodes: Iterable[int | ArrayLike] | None = None,
        against: Iterable[int | ArrayLike] | None = None,
        wall_point_m: ArrayLike | None = None,
        pair_tolerance_m: float | None = None,
        stiffness_n_m: float | None = None,
    ) -> Structure:
        """The same structure with more contacts; can be chained.

        One ``node``, or each of several ``nodes``, before a rigid wall, or ``against`` the nearest of other nodes along the normal. A node is
        given by its number, or by its place (3,) in m.

        Parameters
        ----------
        normal
            Direction (3,) from the nodes to what they touch, of any length.
        gap_m
            Clearance at rest, m; 0 touches, a negative one presses. Left out beside ``against``, it is the distance of each pair along the normal.
        wall_point_m
            A point (3,) of the wall instead: each node has its own clearance. Needs the places of the nodes, as ``against`` does.
        pair_tolerance_m
            How far beside the normal a partner may be, m.
        stiffness_n_m
            Contact stiffness of each, N/m; left out they are rigid.
        """
        if (node is None) == (nodes is None):
            raise TypeError("contact: either node or nodes was expected")
        if normal is None:
            raise TypeError("contact: normal is missing")
        if (gap_m is None) == (wall_point_m is None) and not (gap_m is None and against is not None):
            raise TypeError("contact: either gap_m or wall_point_m was expected")
        own = list(nodes) if nodes is not None else [node]
        table: dict[str, Any] = {"nodes": [self._node("node" if nodes is None else "nodes", one) for one in own]}
        if against is not None:
            table["against"] = [self._node("against", one) for one in against]
        table["normal"] = _arguments.floats("normal", normal, (3,)).tolist()
        if wall_point_m is not None:
            table["wall_point_m"] = _arguments.floats("wall_point_m", wall_point_m, (3,)).tolist()
        for name, value in (("gap_m", gap_m), ("pair_tolerance_m", pair_tolerance_m), ("stiffness_n_m", stiffness_n_m)):
            if value is not None:
                table[name] = _arguments.number(name, value)
        if not table["nodes"]:
            raise ValueError("nodes is empty")
        more = object.__new__(Structure)
        more.__dict__.update(self.__dict__, _contacts=[*self._contacts, table])
        return more

    def _node(self, name: str, node: Any) -> int:
        return _matrices.node_of(name, node, self._dofs)

    def response(
        self,
        node: int | ArrayLike,
        direction: ArrayLike,
        levels_n: float | Sequence[float],
        frequency_hz: float | tuple[float, float],
        damping: float | Sequence[float] | Mapping[str, float],
        *,
        kind: str = "frequency",
        harmonics: int = 5,
        mode: int = 1,
        response: Mapping[str, Any] | None = None,
        out: str | os.PathLike[str] | None = None,
        force: bool = False,
        progress: Progress = None,
        **overrides: Any,
    ) -> Result:
        """Responses to a harmonic force at a node: a branch for each level, with its folds and stability.

        Parameters
        ----------
        node, direction
            Where the force acts, the number of a node or its place (3,) in m, and its direction (3,).
        levels_n
            Amplitudes of the force, N.
        frequency_hz
            Window of its frequency, Hz; one value with ``kind="force"``.
        damping
            As of :meth:`damped_mode`.
        kind
            ``frequency``: over the frequency, a curve a level; ``force``: over the force at one frequency; ``phase-resonance``.
        response
            More keys of ``[response]``: ``lag_deg``, ``subharmonic``, …
        """
        place = {"node": self._node("node", node), "direction": _arguments.floats("direction", direction, (3,)).tolist()}
        own = self._response(place, levels_n, frequency_hz, damping, kind, {"mode": mode, "harmonics": harmonics}, response)
        return self._run(own, out, force, progress, overrides)

    def linear_frequencies(self) -> NDArray[np.float64]:
        """Lowest linear frequencies with open contacts, Hz."""
        scratch = Scratch()
        found = linear_frequencies(self._scene(scratch.path, {"method": {"harmonics": 1}, "continuation": {"max_energy_ratio": 2.0}}))
        return np.array(found["mass_kept"])

    def _scene(self, place: Path, own: Mapping[str, Any]) -> dict[str, Any]:
        """A scene of the files that it writes."""
        from scipy.sparse import save_npz

        files = {name: str(place / f"{name}.npz") for name in self._matrices}
        for name, matrix in self._matrices.items():
            save_npz(files[name], matrix, compressed=False)
        table = place / "dofs.csv"
        placed = len(self._dofs.dtype.names or ()) == 5
        columns = [np.arange(1, self.n_dofs + 1), *(self._dofs[name] for name in self._dofs.dtype.names or ())]
        header = "row,node,component" + ",x,y,z" * placed
        form = ["%d", "%d", "%d", *["%.17g"] * (3 * placed)]
        np.savetxt(table, np.column_stack(columns), fmt=form, delimiter=",", header=header, comments="")
        structure = {"kind": "matrices", "format": "npz", **files, "dofs": str(table)}
        return {"title": self._title, "structure": structure, "contact": self._contacts, **own}
