"""What all adapters share: problems, linear modes with the stops open, answers."""

import json
import pathlib
import resource
import sys
import time

import numpy as np

HERE = pathlib.Path(__file__).resolve().parents[1]
sys.path.insert(0, str(HERE / "references"))

import system as _system  # noqa: E402
from twice import linear_mode  # noqa: E402


def problems(numbers):
    """The problems of these numbers, or all."""
    paths = sorted((HERE / "problems").glob("*.json"))
    found = [json.loads(path.read_text()) for path in paths]
    return [p for p in found if not numbers or p["id"] in numbers]


def system_of(problem):
    """Its system with elastic stops and coordinates that have mass only, and their numbers in the problem."""
    heavy = [i for i, row in enumerate(problem["system"]["mass"]) if any(row)]
    return _system.of_problem(problem), heavy


def mode_number(case):
    """The number of the linear mode at which its branch begins."""
    return 2 if "mode 2" in case["branch"] else 1


def grazing(system, number):
    """Frequency, shape, amplitude and mean kinetic energy of the linear mode that just reaches a stop; None where a
    stop touches or presses at rest."""
    omega, shape = linear_mode(system, number)
    ratios = [abs(s.direction @ shape) / s.gap for s in system.stops if s.gap > 0]
    if len(ratios) < len(system.stops):
        return None
    amplitude = 1.0 / max(ratios)
    energy = 0.25 * omega**2 * amplitude**2 * shape @ system.mass @ shape
    return omega, shape, amplitude, energy


def passed(x, level, *columns, order=3):
    """Values of the columns where the curve x passes a level, in its order, by polynomials over the length of the
    curve."""
    found = []
    x, columns = np.asarray(x, dtype=float), [np.asarray(c, dtype=float) for c in columns]
    for k in range(len(x) - 1):
        if (x[k] - level) * (x[k + 1] - level) > 0 or x[k] == x[k + 1] or (x[k] == level and k > 0):
            continue
        a, b = max(0, k - order + 1), min(len(x), k + order + 1)
        part = slice(a, b)
        size = np.ptp(x[part]) or 1.0
        steps = [np.diff(c[part]) / (np.ptp(c[part]) or 1.0) for c in columns] + [np.diff(x[part]) / size]
        s = np.concatenate([[0.0], np.cumsum(np.sqrt(sum(d**2 for d in steps)) + 1e-300)])
        low, high = s[k - a], s[k + 1 - a]
        fit = lambda values: np.polynomial.polynomial.Polynomial(
            np.linalg.solve(np.vander(s / s[-1], increasing=True), values)
        )
        curve = fit(x[part])
        for _ in range(80):
            mid = 0.5 * (low + high)
            if (curve(mid / s[-1]) - level) * (x[k] - level) > 0:
                low = mid
            else:
                high = mid
        found.append([float(fit(c[part])(low / s[-1])) for c in columns])
    return found


class Clock:
    """Processor time of this process and those that it started, s."""

    def __enter__(self):
        self.start = self.now()
        return self

    def __exit__(self, *_):
        self.seconds = round(self.now() - self.start, 4)

    @staticmethod
    def now():
        children = resource.getrusage(resource.RUSAGE_CHILDREN)
        return time.process_time() + children.ru_utime + children.ru_stime


def write(path, program, settings, answers):
    pathlib.Path(path).write_text(
        json.dumps({"program": program, "settings": settings, "answers": answers}, indent=1) + "\n"
    )
