#!/usr/bin/env python3
"""The backbone of rod.toml by conventional harmonic balance with an elastic stop: processor times, and another program's points beside it (needs NumPy,
SciPy).

    python3 benchmarks/peers/rod_backbone.py PROGRAM [--harmonics 1,2,3] [--runs 9] [--beside POINTS.csv ...]

runs PROGRAM (a release build of nlmodes-cli) over configs/rod.toml: 100 elements, mass of the tip kept, a spring of 1e11 N/m in the place of the rigid stop,
to 15 grazing energies. A POINTS.csv, one for each number of harmonics, has a row a point: frequency (Hz), mean kinetic energy over that at grazing.
The computation is the shortest wall time of the runs without their files (`wall_time_s`); a further point is what is more than with three points only, over
the points that are more; processes are processor times, medians, with figures and page and without.
"""

import argparse
import csv
import json
import pathlib
import resource
import statistics
import subprocess
import tempfile

import numpy as np
from scipy.interpolate import CubicSpline

SCENE = pathlib.Path(__file__).parents[2] / "configs" / "rod.toml"
KEYS = [
    "method.kind=hbm",
    "method.contact_stiffness_n_m=1e11",
    "method.mass_redistribution=none",
    "method.switching=sampled",
    "method.samples=256",
    "continuation.max_energy_ratio=15",
    "continuation.frequency_hz=[50.0, 90.0]",
    "output.stability=never",
]

# Points of a run that is all start.
FIRST = 3


def used():
    """Processor time of the processes that were started and have ended, s."""
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def run(program, folder, keys):
    words = [program, "run", str(SCENE), "--out", folder, "--force", "--quiet"]
    before = used()
    # A branch that ends early is a result too.
    subprocess.run(words + [word for key in keys for word in ("--set", key)], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    return used() - before


def wall(folder):
    return json.loads((pathlib.Path(folder) / "summary.json").read_text())["wall_time_s"]


def difference(table, path):
    """Largest relative difference of frequency at the energies of another program's points beyond grazing, and their number."""
    energy = np.array([float(point["energy_j"]) for point in table])
    hertz = np.array([float(point["frequency_hz"]) for point in table])
    rising = np.maximum.accumulate(np.r_[0.0, energy[:-1]]) < energy
    curve = CubicSpline(np.log(energy[rising] / energy[0]), hertz[rising])
    points = np.loadtxt(path, delimiter=",", ndmin=2)
    within = points[(points[:, 1] > 1.0) & (points[:, 1] <= energy[-1] / energy[0])]
    return np.abs(curve(np.log(within[:, 1])) / within[:, 0] - 1.0).max(), len(points)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program")
    parser.add_argument("--harmonics", default="1,2,3")
    parser.add_argument("--runs", type=int, default=9)
    parser.add_argument("--beside", nargs="*", default=[])
    words = parser.parse_args()
    columns = ["harmonics", "points", "end, Hz", "computation, ms", "a further point, ms", "process, ms", "process without figures and page, ms"]
    print(f"| {' | '.join(columns)} | largest difference of frequency |")
    print("| ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |")
    for i, harmonics in enumerate(words.harmonics.split(",")):
        keys = [*KEYS, f"method.harmonics={harmonics}"]
        with tempfile.TemporaryDirectory() as folder:
            walls, first, whole, bare = [], [], [], []
            for _ in range(words.runs):
                whole.append(run(words.program, folder, keys))
                bare.append(run(words.program, folder, [*keys, "output.figures=false", "output.page=false"]))
                walls.append(wall(folder))
                run(words.program, folder, [*keys, "output.figures=false", "output.page=false", f"continuation.max_points={FIRST}"])
                first.append(wall(folder))
            run(words.program, folder, keys)
            with (pathlib.Path(folder) / "branch.csv").open() as table:
                table = list(csv.DictReader(table))
        beside = "" if i >= len(words.beside) else "{:.1e} at {} points".format(*difference(table, words.beside[i]))
        further = (min(walls) - min(first)) / (len(table) - FIRST)
        times = [1e3 * t for t in (min(walls), further, statistics.median(whole), statistics.median(bare))]
        end = float(table[-1]["frequency_hz"])
        print(f"| {harmonics} | {len(table)} | {end:.3f} | {times[0]:.1f} | {times[1]:.2f} | {times[2]:.0f} | {times[3]:.0f} | {beside} |", flush=True)


if __name__ == "__main__":
    main()
