"""Branches of ``R(x, p) = 0``, n equations for n unknowns and a parameter, by pseudo-arclength.

The curve goes through folds, branch points and corners; what it passes is located and named. Functions are those of Python.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _arguments, _native

Function: TypeAlias = Callable[[NDArray[np.float64], float], Any]


@dataclass(frozen=True, eq=False)
class Trace:
    """A branch: always returned, with the reason why it ended."""

    x: NDArray[np.float64]
    """Unknowns (points, n)."""
    p: NDArray[np.float64]
    """Parameter (points,)."""
    tangent: NDArray[np.float64]
    """Unit tangents (points, n + 1), in the direction of travel."""
    residual: NDArray[np.float64]
    """Largest entry of the residual over the size of its equation (points,)."""
    events: list[list[str]]
    """What happens at each point: ``fold``, ``fold-of-x2``, ``branch-point``, ``pattern-change``, ``kink``."""
    crossings: list[tuple[int, list[list[float]]]]
    """Where more than two half-branches meet: index of the point, and the first point (n + 1) of each but that on which the branch came."""
    end_reason: str
    """``bound``, ``closed``, ``max-points`` or ``no-step``."""
    ended_because: str
    """The same as a sentence."""
    complete: bool
    """Whether it ended at a bound, or where it began."""
    evaluations: int
    refused_steps: int

    def __len__(self) -> int:
        return len(self.p)

    def at(self, event: str) -> list[int]:
        """Indices of the points at which this happens."""
        return [k for k, events in enumerate(self.events) if event in events]


def trace(
    f: Function,
    jac: Function | None,
    x0: ArrayLike,
    p0: float,
    *,
    direction: float | ArrayLike = 1.0,
    bounds: Mapping[int | str, tuple[float, float]] | None = None,
    scaling: tuple[ArrayLike, ArrayLike] | None = None,
    watched: tuple[int, ...] = (),
    at_branch_point: str = "stay",
    max_points: int = 5000,
    initial_step: float = 0.01,
    min_step: float = 1e-6,
    max_step: float = 0.1,
    tolerance: float = 1e-11,
    max_iterations: int = 8,
) -> Trace:
    """Follows the branch through ``(x0, p0)``.

    Parameters
    ----------
    f
        ``f(x, p)``: the residual (n,) for unknowns x (n,) and the parameter p. Where it has no value it may raise ``ArithmeticError``
        or give NaN: a shorter step is then tried. Anything else that it raises ends the branch and is raised.
    jac
        ``jac(x, p)``: (n, n + 1), ∂R/∂x and, last, ∂R/∂p; None for central differences, with which points are as exact but folds and
        branch points are located less sharply.
    x0, p0
        Where to start (n,): corrected first, across the direction.
    direction
        1 or −1: the parameter grows or falls at first; or a vector (n + 1).
    bounds
        Windows outside of which the branch ends, by the index of an unknown or ``"p"``: ``{"p": (0.0, 4.0)}``. The last point lies on it.
    scaling
        Sizes of unknowns and parameter (n + 1) and of the equations (n): steps and tolerances are shares of these. Left out, they are
        found from the start; unknowns of different kinds need sizes of their own.
    watched
        Unknowns whose turning points are events too.
    at_branch_point
        ``stay`` on the own branch, or ``switch`` to another.

    Examples
    --------
    >>> import numpy as np
    >>> from nlmodes import continuation
    >>> circle = lambda x, p: [x[0] ** 2 + p**2 - 1]
    >>> slope = lambda x, p: [[2 * x[0], 2 * p]]
    >>> found = continuation.trace(circle, slope, [1.0], 0.0)
    >>> found.end_reason, bool(abs(found.p[found.at("fold")[0]] - 1) < 1e-10)
    ('closed', True)
    """
    if not callable(f):
        raise TypeError(f"f is {f!r}; a function f(x, p) was expected")
    if jac is not None and not callable(jac):
        raise TypeError(f"jac is {jac!r}; a function jac(x, p) or None was expected")
    start = _arguments.floats("x0", x0, ("n",))
    n = len(start)
    settings = {
        "bounds": [_bound(key, window, n) for key, window in dict(bounds or {}).items()],
        "watched": [_arguments.count("watched", index, most=n - 1) for index in watched],
        "at_branch_point": _arguments.text("at_branch_point", at_branch_point, ("stay", "switch")),
        "max_points": _arguments.count("max_points", max_points, least=1),
        "initial_step": _arguments.number("initial_step", initial_step, above=0.0),
        "min_step": _arguments.number("min_step", min_step, above=0.0),
        "max_step": _arguments.number("max_step", max_step, above=0.0),
        "tolerance": _arguments.number("tolerance", tolerance, above=0.0),
        "max_iterations": _arguments.count("max_iterations", max_iterations, least=1, most=10_000),
        "scaling": None if scaling is None else _scaling(scaling, n),
    }
    found = _native.trace(f, jac, start.tolist(), _arguments.number("p0", p0), _direction(direction, n), settings)
    return Trace(**found)


def _bound(key: int | str, window: Any, n: int) -> tuple[int, float, float]:
    coordinate = n if key == "p" else _arguments.count("bounds", key, most=n)
    try:
        low, high = window
    except (TypeError, ValueError):
        raise TypeError(f"bounds[{key!r}] is {window!r}; two numbers were expected") from None
    ends = [_arguments.number(f"bounds[{key!r}]", end, finite=False) for end in (low, high)]
    return coordinate, ends[0], ends[1]


def _direction(direction: float | ArrayLike, n: int) -> list[float]:
    if np.ndim(direction) == 0:
        sign = _arguments.number("direction", direction)
        return [0.0] * n + [sign]
    return list(map(float, _arguments.floats("direction", direction, (n + 1,))))


def _scaling(scaling: Any, n: int) -> tuple[list[float], list[float]]:
    try:
        unknowns, equations = scaling
    except (TypeError, ValueError):
        raise TypeError("scaling: sizes of the unknowns and of the equations were expected") from None
    return (
        _arguments.floats("scaling[0]", unknowns, (n + 1,)).tolist(),
        _arguments.floats("scaling[1]", equations, (n,)).tolist(),
    )
