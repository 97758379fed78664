"""Structures that were reduced elsewhere: frequencies, rows of the contacts and flexibility from SLEPc, SciPy or another program."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from . import _arguments
from ._analyses import Analyses
from ._result import Result
from ._run import Progress


class ReducedStructure(Analyses):
    """Modes with open contacts and the flexibility between some displacements, its rows, of a model of any size.

    Parameters
    ----------
    frequencies_hz
        Frequencies of the modes with open contacts (m,), ascending, 0 for each rigid-body motion.
    rows
        Displacements of the c rows in the modes of unit modal mass, 1/√kg: (c, m), ``Lᵀ Φ``, or (m, c).
    flexibility_m_n
        Static displacements of the rows under unit forces along them, m/N (c, c), ``Lᵀ K⁻¹ L``: the share of the modes included.
    residual_flexibility_m_n
        In its place, what the modes leave of it; the only one that a structure has which floats.
    title
        Title of tables and figures.

    Examples
    --------
    A mass of 1 kg on 1 N/m, with a second mode, whose tip of 20 N/m touches a rigid stop at rest:

    >>> import numpy as np
    >>> import nlmodes
    >>> structure = nlmodes.ReducedStructure([0.5 / np.pi, 50.0], [[1.0, 0.0]], residual_flexibility_m_n=[[0.05]])
    >>> result = structure.contact(row=1, gap_m=0.0).mode(harmonics=20, max_energy_ratio=2.0)
    >>> both = np.sqrt(21.0)
    >>> bool(abs(result.frequency_hz[0] * np.pi / (both / (1.0 + both)) - 1.0) < 1e-5)
    True
    """

    def __init__(
        self,
        frequencies_hz: ArrayLike,
        rows: ArrayLike,
        flexibility_m_n: ArrayLike | None = None,
        *,
        residual_flexibility_m_n: ArrayLike | None = None,
        title: str = "structure reduced elsewhere",
    ) -> None:
        if (flexibility_m_n is None) == (residual_flexibility_m_n is None):
            raise TypeError("either flexibility_m_n or residual_flexibility_m_n was expected")
        kind = "residual_flexibility_m_n" if flexibility_m_n is None else "flexibility_m_n"
        given = residual_flexibility_m_n if flexibility_m_n is None else flexibility_m_n
        self._arrays: dict[str, Any] = {
            "frequencies_hz": _arguments.floats("frequencies_hz", frequencies_hz, ("modes",)),
            "contact_rows": _arguments.floats("rows", rows, ("rows", "modes")),
            kind: _arguments.floats(kind, given, ("rows", "rows")),
        }
        self._title = _arguments.text("title", title)
        self._contacts: list[dict[str, Any]] = []

    def __repr__(self) -> str:
        modes = len(self._arrays["frequencies_hz"])
        return f"<ReducedStructure of {modes} modes with {len(self._contacts)} contacts>"

    def contact(
        self,
        row: int,
        gap_m: float,
        *,
        side: str = "positive",
        stiffness_n_m: float | None = None,
        damping_n_s_m: float | None = None,
    ) -> ReducedStructure:
        """The same structure with one more contact; can be chained.

        It limits the positive displacements of a ``row``, counted from 1, or with ``side="negative"`` the negative ones. A ``gap_m`` of 0
        touches at rest, a negative one presses. Without ``stiffness_n_m`` (N/m) it is rigid; ``damping_n_s_m`` is a damper beside its stiffness.
        """
        table: dict[str, Any] = {"row": _arguments.count("row", row, least=1), "side": _arguments.text("side", side, ("positive", "negative"))}
        for name, value in (("gap_m", gap_m), ("stiffness_n_m", stiffness_n_m), ("damping_n_s_m", damping_n_s_m)):
            if value is not None:
                table[name] = _arguments.number(name, value)
        more = object.__new__(ReducedStructure)
        more.__dict__.update(self.__dict__, _contacts=[*self._contacts, table])
        return more

    def response(
        self,
        row: int,
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
        """Responses to a harmonic force along a ``row``, counted from 1: a branch for each level, with its folds and stability.

        All else is as of :meth:`nlmodes.Structure.response`.
        """
        method = {"mode": mode, "harmonics": harmonics}
        own = self._response({"row": _arguments.count("row", row, least=1)}, levels_n, frequency_hz, damping, kind, method, response)
        return self._run(own, out, force, progress, overrides)

    def _scene(self, place: Path, own: Mapping[str, Any]) -> dict[str, Any]:
        path = place / "modes.npz"
        np.savez(path, **self._arrays)
        structure = {"kind": "reduced", **{name: f"{path}#{name}" for name in self._arrays}}
        return {"title": self._title, "structure": structure, "contact": self._contacts, **own}
