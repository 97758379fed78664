#!/usr/bin/env python3
"""Answers of TMDSimPy (needs NumPy, SciPy, and the folder of TMDSimPy).

    python3 benchmarks/nsm/adapters/tmdsimpy_hbm.py TMDSIMPY OUT.json [--harmonics 21] [--samples 1024] [01 02 ...]

Its `epmc_res`, `hbm_res`, `UnilateralSpring` and `Continuation` compute; the last point is refined by Newton's method
on its residual with the condition that the case adds. Rigid stops before coordinates without mass are given as the
elastic stops that they are to the others.
"""

import argparse
import contextlib
import io
import math
import signal
import sys

import numpy as np
from common import Clock, grazing, mode_number, problems, system_of, write
from harmonic import impulses, kinetic, of_curve, passages, refined
from nlvib import WINDOWS


class Tmd:
    def __init__(self, system, harmonics, samples):
        from tmdsimpy.nlforces.unilateral_spring import UnilateralSpring
        from tmdsimpy.vibration_system import VibrationSystem

        self.s, self.h, self.samples = system, np.arange(harmonics + 1), samples
        self.vib = VibrationSystem(system.mass, system.stiffness, system.damping)
        for stop in system.stops:
            w = stop.direction[None]
            self.vib.add_nl_force(UnilateralSpring(w, w.T, np.array([stop.stiffness]), delta=np.array([stop.gap])))
        self.size = system.n * (2 * harmonics + 1)

    def follow(self, residual, x, begins, ends, ds):
        from tmdsimpy.continuation import Continuation
        from tmdsimpy.solvers import NonlinearSolver
        from tmdsimpy.utils.harmonic import harmonic_wise_conditioning

        solver = NonlinearSolver()
        x = solver.nsolve(lambda u: residual(np.append(u, begins))[:2], x, verbose=False)[0]
        start = np.append(x, begins)
        scales = harmonic_wise_conditioning(start, self.s.n, self.h, delta=1e-3)
        config = {
            "DynamicCtoP": True,
            "TargetNfev": 200,
            "MaxSteps": 2000,
            "dsmin": ds / 1000,
            "dsmax": 5 * ds,
            "verbose": -1,
            "corrector": "Ortho",
        }
        return Continuation(solver, ds0=ds, CtoP=scales, config=config).continuation(residual, start, begins, ends)

    def coefficients(self, x):
        return x[: self.size].reshape(-1, self.s.n)

    def whole(self, residual):
        """Residual and derivative with respect to everything."""

        def both(x):
            r, by_x, by_last = residual(x)
            return r, np.column_stack([by_x, by_last])

        return both


def free(tmd, case, begin):
    omega, shape, _, low = begin
    energy = case["at"]["mean_kinetic_energy"]
    s, n = tmd.s, tmd.s.n
    phase = np.zeros(tmd.size)
    phase[2 * n + int(np.argmax(np.abs(shape)))] = 1.0
    residual = lambda x: tmd.vib.epmc_res(x, phase, tmd.h, Nt=tmd.samples)
    x = np.zeros(tmd.size + 2)
    x[n : 2 * n] = shape / math.sqrt(shape @ s.mass @ shape)
    x[-2] = omega
    x[-1] = float(np.diag(s.damping) @ np.ones(n)) and (shape @ s.damping @ shape) / (shape @ s.mass @ shape)
    scale = lambda x: np.where(np.arange(2 * len(tmd.h) - 1)[:, None] == 0, 1.0, 10.0 ** x[-1]) * tmd.coefficients(x)
    of = lambda x: kinetic(scale(x), x[-3], s.mass)
    at = lambda e: math.log10(math.sqrt(4 * e) / omega)
    points = tmd.follow(residual, x, at(0.8 * low), at(3 * energy), 0.01)
    k, share = passages([of(p) for p in points], energy)[0]
    x = points[k] + share * (points[k + 1] - points[k])
    x = refined(tmd.whole(residual), lambda x: of(x) / energy - 1, x)
    values = {"frequency": x[-3], "damping_ratio": x[-2] / (2 * x[-3])}
    return values | {f"impulse[{j}]": v for j, v in enumerate(impulses(scale(x), x[-3], s.stops))}


def driven(tmd, problem, case, heavy):
    s, n = tmd.s, tmd.s.n
    begins, ends = WINDOWS[problem["id"]]
    load = np.zeros(tmd.size)
    load[n : 2 * n] = s.force
    residual = lambda x: tmd.vib.hbm_res(x, load, tmd.h, Nt=tmd.samples)
    q = np.linalg.solve(s.stiffness - begins**2 * s.mass + 1j * begins * s.damping, s.force)
    x = np.zeros(tmd.size)
    x[n : 2 * n], x[2 * n : 3 * n] = q.real, -q.imag
    points = tmd.follow(residual, x, begins, ends, 0.03)
    return of_curve(points, tmd.whole(residual), problem, case, s, heavy)


def answer(problem, case, words):
    if problem["kind"] in ("impact", "bar", "subharmonic") or "doubling" in case["branch"]:
        return {"note": "not computed"}
    system, heavy = system_of(problem)
    tmd = Tmd(system, words.harmonics, words.samples)
    with Clock() as clock, contextlib.redirect_stdout(io.StringIO()):
        try:
            signal.alarm(int(words.timeout))
            if "load" in problem:
                values = driven(tmd, problem, case, heavy)
            elif begin := grazing(system, mode_number(case)):
                values = free(tmd, case, begin)
            else:
                return {"note": "not tried: there is no linear mode to begin from"}
        except TimeoutError:
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
    parser.add_argument("tmdsimpy")
    parser.add_argument("out")
    parser.add_argument("numbers", nargs="*")
    parser.add_argument("--harmonics", type=int, default=21)
    parser.add_argument("--samples", type=int, default=1024)
    parser.add_argument("--timeout", type=float, default=120.0)
    words = parser.parse_args()
    sys.path.insert(0, words.tmdsimpy)
    signal.signal(signal.SIGALRM, late)
    answers = {}
    for problem in problems(words.numbers):
        for case in problem["cases"]:
            answers[case["case"]] = answer(problem, case, words)
            print(case["case"], answers[case["case"]], flush=True)
            write(words.out, "TMDSimPy", f"{words.harmonics} harmonics, {words.samples} samples", answers)


if __name__ == "__main__":
    main()
