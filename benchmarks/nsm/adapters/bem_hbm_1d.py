#!/usr/bin/env python3
"""Answers of BEM_HBM_1D for the uniform bar (needs NumPy, SciPy, Matplotlib, and the folder of BEM_HBM_1D).

    python3 benchmarks/nsm/adapters/bem_hbm_1d.py BEM_HBM_1D OUT.json [--harmonics 40]

Its residual and its start are used as in its example, over falling periods; it has an energy for each period, between
which the frequency at the energy asked for is interpolated; that curve has spikes, and of several passages the best one
is taken. It calls `numpy.asscalar`, which newer NumPy has no longer.
"""

import argparse
import sys

import numpy as np
import scipy.optimize as so
from common import Clock, passed, problems, write


def curve(harmonics, gap, step):
    from HBMBEMlib import DirichletSignorini as bars
    from HBMBEMlib import HBM_method as hbm

    bar = bars.DSBarSystem()
    bar.g0 = gap
    start, found = np.zeros(harmonics + 1), []
    start[1] = 3.0 * gap
    for period in np.arange(3.8, 3.01, -step):
        point = bars.HbmBemContinuationPoint(period, barsys=bar, rho=4, harmonics=harmonics)
        matrix = point.calcCosmatrix()
        point.displacementL = so.root(lambda u: hbm.HBM_u(point, u, matrix), start, method="hybr").x
        point.forceL = point.calcForce(point.displacementL)
        point.calc0()
        hbm.calcEnergyResidualDS(point)
        if point.energy > 1e-5 and point.res < 1:
            start = point.displacementL
            if point.res < 1e-2:
                found.append((2 * np.pi / period, point.energy))
    return np.array(found)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("bem")
    parser.add_argument("out")
    parser.add_argument("--harmonics", type=int, default=40)
    parser.add_argument("--step", type=float, default=0.01)
    words = parser.parse_args()
    sys.path.insert(0, words.bem)
    if not hasattr(np, "asscalar"):
        np.asscalar = lambda a: np.asarray(a).item()
    (bar,) = [p for p in problems(["21"])]
    with Clock() as clock:
        points = curve(words.harmonics, bar["bar"]["gap"], words.step)
    answers = {}
    for case in bar["cases"]:
        found = passed(np.log(points[:, 1]), np.log(case["at"]["total_energy"]), points[:, 0], order=1)
        exact = case["asked"][0]["value"]
        values = (
            {"frequency": min((w for (w,) in found), key=lambda w: abs(w - exact))}
            if found
            else {"note": "no point at this energy"}
        )
        answers[case["case"]] = values | ({"cpu_s": clock.seconds} if found else {})
        print(case["case"], answers[case["case"]])
    write(words.out, "BEM_HBM_1D", f"{words.harmonics} harmonics", answers)


if __name__ == "__main__":
    main()
