"""Piecewise linear systems: masses on springs and dampers before one-sided elastic stops.

    M q'' + (C − ξ M) q' + K q + Σ_j k_j (w_jᵀ q − g_j)₊ w_j = f cos Ωt

A rigid stop before a coordinate without mass is the same as an elastic stop, of the spring that moves the coordinate:
it is condensed here.
"""

from dataclasses import dataclass, field

import numpy as np


@dataclass
class Stop:
    direction: np.ndarray
    gap: float
    stiffness: float


@dataclass
class System:
    mass: np.ndarray
    stiffness: np.ndarray
    damping: np.ndarray
    force: np.ndarray
    stops: list = field(default_factory=list)

    @property
    def n(self):
        return len(self.mass)


def of_problem(problem):
    """The system of a problem file, with coordinates that have mass only; others are condensed."""
    given = problem["system"]
    mass = np.array(given["mass"], dtype=float)
    stiffness = np.array(given["stiffness"], dtype=float)
    n = len(mass)
    damping = np.array(given.get("damping", np.zeros((n, n))), dtype=float)
    force = np.array(problem.get("load", {}).get("vector", np.zeros(n)), dtype=float)
    stops = [Stop(np.array(s["direction"], dtype=float), float(s["gap"]), s["stiffness"]) for s in problem["contacts"]]
    return condensed(System(mass, stiffness, damping, force, stops))


def condensed(system):
    """Coordinates without mass follow the others; a rigid stop before one becomes an elastic one before those that move
    it."""
    light = [i for i in range(system.n) if not system.mass[i].any()]
    if not light:
        if any(stop.stiffness is None for stop in system.stops):
            raise ValueError("a rigid stop before a coordinate with mass is an impact, which is treated elsewhere")
        return system
    heavy = [i for i in range(system.n) if i not in light]
    stops = []
    if len(light) != len({int(np.flatnonzero(s.direction)[0]) for s in system.stops if s.stiffness is None}):
        raise ValueError("one rigid stop before each coordinate without mass was expected")
    k_ll = system.stiffness[np.ix_(light, light)]
    if np.count_nonzero(k_ll - np.diag(np.diag(k_ll))):
        raise ValueError("coordinates without mass are connected")
    k_hl = system.stiffness[np.ix_(heavy, light)]
    follow = -np.linalg.solve(k_ll, k_hl.T)
    for stop in system.stops:
        if stop.stiffness is not None:
            stops.append(Stop(stop.direction[heavy] + follow.T @ stop.direction[light], stop.gap, stop.stiffness))
            continue
        at = light.index(int(np.flatnonzero(stop.direction)[0]))
        sign = stop.direction[light[at]]
        stops.append(Stop(sign * follow[at], stop.gap, float(k_ll[at, at])))
    k_hh = system.stiffness[np.ix_(heavy, heavy)] + k_hl @ follow
    part = np.ix_(heavy, heavy)
    return System(system.mass[part], k_hh, system.damping[part], system.force[heavy], stops)
