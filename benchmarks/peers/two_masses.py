#!/usr/bin/env python3
"""Responses of two masses before a one-sided spring: errors beside exact motions, and processor times (needs NumPy).

    python3 benchmarks/peers/two_masses.py PROGRAM [--harmonics 3,7,21] [--runs 5] [--beside CURVE.csv ...]

runs PROGRAM (a release build of nlmodes-cli) over two_masses.toml for each number of harmonics. A CURVE.csv is one that another program computed for the
same equations: a row a point, the angular frequency and then the mean of both masses and cosine and sine of both for each harmonic.

Exact motions owe nothing to either: harmonic arcs between contacts in closed form, their ends by Newton's method in time, and the state at the beginning
of the period by Newton's method with the product of the arcs' exponentials. Each point of a curve that touches starts its own, at its own frequency.
"""

import argparse
import pathlib
import resource
import statistics
import subprocess
import tempfile

import numpy as np

K = np.array([[1.0, -1.0], [-1.0, 2.0]])
DAMPING, STOP, GAP, FORCE = 0.03, 100.0, 1.0, 0.1
SCENE = pathlib.Path(__file__).with_name("two_masses.toml")
# An error beyond this is another motion.
CLOSE = 0.05


class Arc:
    """z' = A z + b + Re(f exp(iΩt)) for z = (q, q'), with the stop open or closed."""

    def __init__(self, omega, closed):
        k = K + np.diag([STOP, 0.0]) * closed
        self.matrix = np.block([[np.zeros((2, 2)), np.eye(2)], [-k, -DAMPING * K]])
        self.omega = omega
        self.values, self.vectors = np.linalg.eig(self.matrix)
        self.inverse = np.linalg.inv(self.vectors)
        self.rest = -np.linalg.solve(self.matrix, [0.0, 0.0, STOP * GAP * closed, 0.0])
        self.forced = np.linalg.solve(1j * omega * np.eye(4) - self.matrix, [0.0, 0.0, 0.0, FORCE])

    def after(self, t0, z, times):
        """The state at `times`, from `z` at `t0`."""
        times = np.atleast_1d(times)
        particular = lambda t: np.real(self.forced[:, None] * np.exp(1j * self.omega * t)) + self.rest[:, None]
        free = self.inverse @ (z - particular(np.array([t0]))[:, 0])
        return np.real(self.vectors @ (free[:, None] * np.exp(np.outer(self.values, times - t0)))) + particular(times)

    def exponential(self, t):
        return np.real(self.vectors * np.exp(self.values * t) @ self.inverse)


def period(omega, z):
    """The state after a period, its derivative, and the fundamental of the second mass."""
    arcs = [Arc(omega, closed) for closed in (False, True)]
    whole, t, derivative, fundamental = 2 * np.pi / omega, 0.0, np.eye(4), 0j
    nodes, weights = np.polynomial.legendre.leggauss(12)
    closed = bool(z[0] > GAP or (z[0] == GAP and z[2] > 0.0))
    while t < whole:
        arc = arcs[closed]
        times = np.linspace(t, whole, 2000)
        gap = arc.after(t, z, times)[0] - GAP
        # The first sample is where the arc before ended.
        off = np.flatnonzero((gap[1:] > 0.0) != closed)
        end = whole
        if off.size:
            low, high = times[off[0]], times[off[0] + 1]
            for _ in range(60):
                middle = 0.5 * (low + high)
                past = (arc.after(t, z, middle)[0, 0] > GAP) != closed
                low, high = (low, middle) if past else (middle, high)
            end = high
        edges = np.linspace(t, end, 2 + int(20 * (end - t) / whole))
        for a, b in zip(edges[:-1], edges[1:]):
            at = 0.5 * (a + b) + 0.5 * (b - a) * nodes
            fundamental += 0.5 * (b - a) * np.sum(weights * arc.after(t, z, at)[1] * np.exp(-1j * omega * at))
        derivative = arc.exponential(end - t) @ derivative
        z, t, closed = arc.after(t, z, end)[:, 0], end, closed != bool(off.size)
    return z, derivative, fundamental * 2 / whole


def exact(omega, z):
    """The fundamental of the second mass in the exact motion near a state; none where Newton's method finds none."""
    for _ in range(30):
        end, derivative, fundamental = period(omega, z)
        if np.abs(end - z).max() < 1e-12:
            return abs(fundamental)
        z = z - np.linalg.solve(derivative - np.eye(4), end - z)
        if not np.isfinite(z).all() or np.abs(z).max() > 100.0:
            return None
    return None


def used():
    """Processor time of the processes that were started and have ended, s."""
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def ours(program, harmonics, runs):
    """Frequencies and complex coefficients of both masses, and processor times of whole runs, s."""
    with tempfile.TemporaryDirectory() as folder:
        def timed(*words):
            before = used()
            subprocess.run([program, *words], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            return used() - before

        scene = [str(SCENE), "--set", f"method.harmonics={harmonics}"]
        times = [timed("run", *scene, "--out", folder, "--force") for _ in range(runs)]
        found = np.load(pathlib.Path(folder) / "harmonics.npz")
        return found["omega"], found["coefficients"][:, :2], times


def beside(path):
    rows = np.loadtxt(path, delimiter=",", ndmin=2)
    omega, values = rows[:, 0], rows[:, 1:].reshape(len(rows), -1, 2)
    coefficients = np.concatenate([values[:, :1] + 0j, values[:, 1::2] - 1j * values[:, 2::2]], axis=1)
    return omega, coefficients.transpose(0, 2, 1)


def errors(omega, coefficients):
    """Relative errors of the fundamental of the second mass where the first one touches; the points for which no exact motion is near."""
    orders = np.arange(coefficients.shape[2])
    phases = np.exp(2j * np.pi * np.outer(orders, np.arange(1024) / 1024))
    found, lost = [], 0
    for w, q in zip(omega, coefficients):
        if np.real(q[0] @ phases).max() <= GAP:
            continue
        state = np.concatenate([np.real(q.sum(1)), np.real((1j * w * orders * q).sum(1))])
        amplitude, computed = exact(w, state), abs(q[1, 1])
        error = None if amplitude is None else abs(computed / amplitude - 1.0)
        if error is None or error > CLOSE:
            lost += 1
        else:
            found.append(error)
    return np.array(found), lost


def row(name, omega, coefficients, times):
    found, lost = errors(omega, coefficients)
    peak = max(abs(coefficients[:, 1, 1]))
    cpu = "" if times is None else f"{statistics.median(times) * 1e3:.0f}"
    print(f"| {name} | {len(omega)} | {np.median(found):.1e} | {np.quantile(found, 0.9):.1e} | {lost} | {peak:.7f} | {cpu} |", flush=True)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program")
    parser.add_argument("--harmonics", default="3,7,15,21,31,63")
    parser.add_argument("--runs", type=int, default=5)
    parser.add_argument("--beside", nargs="*", default=[])
    words = parser.parse_args()
    print("| curve | points | median error | nine of ten below | no exact motion near | largest point, m | CPU, ms |")
    print("| --- | ---: | ---: | ---: | ---: | ---: | ---: |")
    for harmonics in map(int, filter(None, words.harmonics.split(","))):
        row(f"{harmonics} harmonics", *ours(words.program, harmonics, words.runs))
    for path in words.beside:
        row(pathlib.Path(path).stem, *beside(path), None)


if __name__ == "__main__":
    main()
