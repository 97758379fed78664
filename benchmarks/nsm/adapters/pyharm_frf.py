#!/usr/bin/env python3
"""Answers of pyHarm (`pip install pyHarm-os`).

    python3 benchmarks/nsm/adapters/pyharm_frf.py OUT.json [--harmonics 21] [--samples 1024] [22 23 ...]

Its `FRF_NonLinear` with arc length follows the response; the last point is refined by Newton's method on its residual
with the condition that the case adds. Stops are its penalty gaps, `PenaltyUnilateralGap`: the rigid one, `DLFTUniGap`,
raises at the first evaluation in version 1.2.2. Rigid stops before coordinates without mass are given as the elastic
stops that they are to the others. Free motions and damped modes are not among its analyses: its backbones are motions
under a modal force in phase resonance.
"""

import argparse
import logging
import signal
import warnings

import numpy as np
from common import Clock, problems, system_of, write
from harmonic import of_curve
from nlvib import WINDOWS


def gaps(stops):
    """Its elements of the stops: the ground is always on the positive side, or on both."""
    found = {}
    for j, stop in enumerate(stops):
        (node,) = np.flatnonzero(stop.direction)
        kind, sign = "PenaltyUnilateralGap", stop.direction[node]
        facing = [o for o in stops if np.array_equal(o.direction, -stop.direction)]
        if facing and (facing[0].gap, facing[0].stiffness) == (stop.gap, stop.stiffness):
            kind = "PenaltyBilateralGap"
            if sign < 0:
                continue
        elif sign < 0:
            raise ValueError("a stop on the negative side alone cannot be given")
        connect = {"structure": [int(node)]}
        found[f"stop_{j}"] = {"type": kind, "connect": connect, "dirs": [0], "g": stop.gap, "k": stop.stiffness}
    return found


def inputs(system, load, window, words):
    """What `Maestro` takes."""
    matrix = {"M": system.mass, "C": system.damping, "K": system.stiffness, "G": np.zeros_like(system.mass)}
    one = {"matrix": matrix, "nnodes": system.n, "ndofs": 1, "nmodes": 0, "matching": [0]}
    connectors = gaps(system.stops)
    for node in np.flatnonzero(load):
        connectors[f"force_{node}"] = {
            "type": "CosinusForcing",
            "connect": {"structure": [int(node)]},
            "dirs": [0],
            "ho": 1,
            "amp": load[node],
        }
    begins, ends = window
    study = {
        "study": "frf",
        "puls_inf": min(window),
        "puls_sup": max(window),
        "sign_ds": 1 if ends > begins else -1,
        "ds0": words.step,
        "ds_max": words.step,
        "ds_min": 1e-8,
        "verbose": False,
    }
    return {
        "system": {"type": "Base", "nh": words.harmonics, "nti": words.samples},
        "substructures": {"structure": one},
        "connectors": connectors,
        "analysis": {"curve": study},
    }


def curve(system, window, words):
    """Accepted points of the response, and the residual with its derivative."""
    from pyHarm.Maestro import Maestro

    maestro = Maestro(inputs(system, system.force, window, words))
    maestro.operate()
    points = np.array([s.x for s in maestro.nls["curve"].SolList if s.flag_accepted])

    def residual(x):
        by_x, by_omega = maestro.system.Jacobian(x)
        return maestro.system.Residual(x), np.column_stack([by_x, np.ravel(by_omega)])

    return points, residual


def answer(problem, case, words):
    if problem["id"] not in WINDOWS or "doubling" in case["branch"]:
        return {"note": "not computed"}
    system, heavy = system_of(problem)
    with Clock() as clock:
        try:
            signal.alarm(int(words.timeout))
            points, residual = curve(system, WINDOWS[problem["id"]], words)
            values = of_curve(points, residual, problem, case, system, heavy)
        except (TimeoutError, SystemError):  # the latter where the alarm comes within compiled code
            return {"note": f"not within {words.timeout:g} s"}
        except (ArithmeticError, ValueError, IndexError, np.linalg.LinAlgError) as error:
            return {"note": "lost the branch: " + str(error)[:80]}
        finally:
            signal.alarm(0)
    got = {a["name"]: float(values[a["name"]]) for a in case["asked"] if a["name"] in values}
    return {**got, "cpu_s": clock.seconds}


def late(*_):
    raise TimeoutError


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("out")
    parser.add_argument("numbers", nargs="*")
    parser.add_argument("--harmonics", type=int, default=21)
    parser.add_argument("--samples", type=int, default=1024)
    parser.add_argument("--step", type=float, default=0.05)
    parser.add_argument("--timeout", type=float, default=120.0)
    words = parser.parse_args()
    logging.disable(logging.CRITICAL)
    warnings.simplefilter("ignore")
    signal.signal(signal.SIGALRM, late)
    answers = {}
    for problem in problems(words.numbers):
        for case in problem["cases"]:
            answers[case["case"]] = answer(problem, case, words)
            print(case["case"], answers[case["case"]], flush=True)
            write(words.out, "pyHarm 1.2.2", f"{words.harmonics} harmonics, {words.samples} samples", answers)


if __name__ == "__main__":
    main()
