"""Complementarity problems of frictionless contact: ``0 ≤ g ⊥ λ ≥ 0``, ``g = A λ + b``.

``A`` (c, c) is the compliance of a body at its contacts, m/N, symmetric and positive semidefinite; ``b`` (c,) or (samples, c) are the gaps
without contact forces, m; ``λ`` the forces, N; ``g`` the gaps, m. A stop of stiffness k adds 1/k to the diagonal of ``A``.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _arguments, _native

SOLVERS = ("active-set", "proximal", "clarabel", "lemke", "closed-form")
"""Names of the solvers, the default first."""

_STARTS = ("previous-sample", "same-sample", "cold")


class Solution(NamedTuple):
    """Forces and gaps; with the leading axis of the samples where ``b`` has one."""

    lambda_: NDArray[np.float64]
    """Contact forces (…, c), N."""
    gaps: NDArray[np.float64]
    """Gaps (…, c), m."""
    closed: NDArray[np.bool_]
    """Closed contacts (…, c); where contacts are redundant an independent subset of them."""
    violation: NDArray[np.float64]
    """Scaled complementarity violation (…), recomputed outside of the solver: 1e-10 at most."""
    iterations: NDArray[np.int64]
    """Iterations (…), in the unit of the solver."""


class Response(NamedTuple):
    """Derivatives with the closed contacts kept closed."""

    lambda_: NDArray[np.float64]
    """dλ/db (c, c), N/m."""
    gaps: NDArray[np.float64]
    """dg/db (c, c)."""


def solve(A: ArrayLike, b: ArrayLike, solver: str = "active-set", start: str = "previous-sample") -> Solution:
    """Solves one contact problem, or a series with one matrix.

    ``start`` says where the search for the closed contacts of a sample begins: with those that the ``previous-sample`` lets expect, or
    ``cold``. Raises :class:`nlmodes.RunError` where there is no solution or none can be verified, ``ValueError`` where the arguments are no
    contact problem.

    >>> from nlmodes import contact
    >>> found = contact.solve([[2.0, 1.0], [1.0, 2.0]], [-1.0, 1.0])
    >>> found.lambda_, found.gaps, found.closed
    (array([0.5, 0. ]), array([0. , 1.5]), array([ True, False]))
    """
    return Series(A, solver).solve(b, start)


class Series:
    """Many contact problems with one matrix, which is checked and factored once."""

    def __init__(self, A: ArrayLike, solver: str = "active-set") -> None:
        matrix = _arguments.floats("A", A, ("c", "c"))
        if matrix.shape[0] != matrix.shape[1]:
            raise ValueError(f"A has the shape {matrix.shape}; as many rows as columns were expected")
        self._c = len(matrix)
        self._native = _native.Series(matrix, _arguments.text("solver", solver, SOLVERS))

    def solve(self, b: ArrayLike, start: str = "previous-sample") -> Solution:
        """Solves for ``b`` (c,) or (samples, c), m; ``start="same-sample"`` begins with the closed contacts of the last solution."""
        single = np.ndim(_sized(b)) == 1
        given = _arguments.floats("b", b, (self._c,) if single else ("samples", self._c))
        start = _arguments.text("start", start, _STARTS)
        found = self._native.solve(given.reshape(-1, self._c), start)
        return Solution(*(array[0] for array in found)) if single else Solution(*found)

    def response(self, closed: ArrayLike) -> Response:
        """Derivatives of forces and gaps by ``b`` with these contacts (c,) closed and all others open."""
        flags = np.asarray(closed)
        if flags.dtype != np.bool_ or flags.shape != (self._c,):
            raise ValueError(f"closed has the type {flags.dtype} and the shape {flags.shape}; ({self._c},) flags were expected")
        return Response(*self._native.response(np.ascontiguousarray(flags)))


class Case(NamedTuple):
    """A problem of the conformance suite."""

    name: str
    A: NDArray[np.float64]
    b: NDArray[np.float64]
    solvable: bool
    """Whether it has a solution; the gaps contradict each other otherwise."""


def conformance_cases(at_most: int = 30) -> list[Case]:
    """The suite that every solver of this package passes, problems of at most so many contacts: to try one of your own."""
    return [Case(*case) for case in _native.conformance_cases(_arguments.count("at_most", at_most, least=1, most=1000))]


def _sized(b: Any) -> Any:
    try:
        return np.asarray(b)
    except Exception:
        # Refused by its name later.
        return np.zeros((1, 1))
