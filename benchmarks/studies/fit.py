#!/usr/bin/env python3
"""Gap, modulus and damping from backbones with noise: how often the values lie within the stated covariance.

    benchmarks/studies/fit.py --program target/release/nlmodes-cli --seeds 100 --out results/fit

A cantilever before an elastic stop is followed at phase resonance; its frequency and amplitude at sixteen levels, with
normal noise, are what a test would give. From another gap, modulus and damping `study fit` has to find those of the
virtual test, and to say how well. Of 100 fits 95 % intervals of each value, and the 95 % ellipsoid of all three, should
hold the truth in 95; the squares of what is left should be those of chi squared. Each trial is a case with gradients, in
a directory of its own.
Needs Python 3.11, NumPy and SciPy.
"""

import argparse
import csv
import json
import shutil
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.stats import binom, chi2

SCENE = """
title = "Cantilever before an elastic stop, at phase resonance"
[structure]
kind = "beam"
length_m = 0.6
elements = 6
start = "clamped"
material = {{ youngs_modulus_gpa = {modulus!r}, density_kg_m3 = 7800.0, poissons_ratio = 0.3 }}
section = {{ width_mm = 12.0, height_mm = 20.0 }}
[[contact]]
at_m = 0.6
direction = "transverse"
side = "positive"
gap_mm = {gap!r}
stiffness_n_m = 2e4
[damping]
ratio = {ratio!r}
[[force]]
at_m = 0.1
direction = "transverse"
[[response]]
kind = "phase-resonance"
levels_n = [40.0]
[method]
harmonics = 5
[output]
stability = "never"
figures = false
page = false
"""

FIT = """
scene = "scene.toml"
[fit]
measured = "measured.csv"
over = "level"
[[vary]]
key = "contact.0.gap_mm"
[[vary]]
key = "structure.material.youngs_modulus_gpa"
[[vary]]
key = "damping.ratio"
[output]
keep = "tables"
"""

TRUTH = {"gap": 1.1, "modulus": 195.0, "ratio": 0.005}
START = {"gap": 1.0, "modulus": 200.0, "ratio": 0.006}
LEVELS = np.linspace(4.0, 26.0, 16)
NOISE = {"frequency_hz": 0.02, "fundamental_m": 2e-5}


def exact(program, place):
    """Frequency and amplitude of the virtual test at the levels, without noise."""
    place.mkdir(parents=True, exist_ok=True)
    (place / "scene.toml").write_text(SCENE.format(**TRUTH))
    subprocess.run([program, "run", "scene.toml", "--out", "out", "--quiet", "--force"], cwd=place, check=True)
    rows = list(csv.DictReader((place / "out/branch.csv").open()))
    level = np.array([float(row["level"]) for row in rows])
    touching = np.array([float(row["peak_contact_force_n"]) > 0.0 for row in rows])
    found = {}
    for name in NOISE:
        values = np.array([float(row[name]) for row in rows])
        # The curve has a corner where the stop is first touched.
        pieces = [CubicSpline(level[own], values[own]) for own in (~touching, touching)]
        first = level[touching][0]
        found[name] = np.array([pieces[int(at > first)](at) for at in LEVELS])
    return found


def one(program, place, clean, seed):
    """The fit of the test with this seed."""
    random = np.random.default_rng(seed)
    noisy = {name: values + random.normal(0.0, NOISE[name], len(LEVELS)) for name, values in clean.items()}
    place.mkdir(parents=True, exist_ok=True)
    lines = [",".join(["level"] + [f"{name},{name}_std" for name in NOISE])]
    for k, level in enumerate(LEVELS):
        cells = [f"{noisy[name][k]!r},{NOISE[name]!r}".replace("np.float64(", "").replace(")", "") for name in NOISE]
        lines.append(",".join([repr(float(level))] + cells))
    (place / "measured.csv").write_text("\n".join(lines) + "\n")
    (place / "scene.toml").write_text(SCENE.format(**START))
    (place / "fit.toml").write_text(FIT)
    began = time.monotonic()
    call = [program, "study", "fit", "fit.toml", "--out", "out", "--quiet"]
    done = subprocess.run(call, cwd=place, capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"seed {seed}: {done.stderr}")
    found = json.loads((place / "out/fit.json").read_text())
    found["seconds"] = time.monotonic() - began
    shutil.rmtree(place / "out/cases")
    return found


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--program", type=Path, default=Path("target/release/nlmodes-cli"))
    parser.add_argument("--out", type=Path, default=Path("results/fit"))
    parser.add_argument("--seeds", type=int, default=100)
    parser.add_argument("--jobs", type=int, default=1)
    arguments = parser.parse_args()
    program, out = arguments.program.resolve(), arguments.out
    clean = exact(program, out / "exact")
    with ThreadPoolExecutor(arguments.jobs) as pool:
        run = lambda seed: one(program, out / f"seed{seed}", clean, seed)
        fits = list(pool.map(run, range(arguments.seeds)))
    truth = np.array(list(TRUTH.values()))
    values = np.array([[own["value"] for own in fit["parameters"]] for fit in fits])
    deviations = np.array([[own["std"] for own in fit["parameters"]] for fit in fits])
    z = (values - truth) / deviations
    distances = [d @ np.linalg.solve(np.array(fit["covariance"]), d) for d, fit in zip(values - truth, fits)]
    inside = sum(distance <= chi2.ppf(0.95, len(truth)) for distance in distances)
    n = len(fits)
    low, high = binom.ppf([0.025, 0.975], n, 0.95)
    print(f"{n} seeds; 95 % of such counts are {low:.0f} to {high:.0f} of {n} where the covariance is right")
    print(f"| value | truth | start | stated deviation | scatter of the fits | mean error | within 95 % |")
    print(f"| --- | --- | --- | --- | --- | --- | --- |")
    for k, name in enumerate(TRUTH):
        held = int(np.sum(np.abs(z[:, k]) <= 1.959964))
        print(
            f"| {name} | {truth[k]} | {START[name]} | {deviations[:, k].mean():.3e} | {values[:, k].std(ddof=1):.3e} |"
            f" {(values[:, k] - truth[k]).mean():+.1e} | {held} |"
        )
    print(f"all three within the 95 % ellipsoid: {inside} of {n}")
    free = fits[0]["degrees_of_freedom"]
    left = np.array([fit["chi_squared"] for fit in fits])
    print(f"squares of what is left: mean {left.mean():.2f} of {free}, above the 95 % quantile {np.sum(left > chi2.ppf(0.95, free))}")
    curves = [fit["curves"] for fit in fits]
    steps = [fit["iterations"] for fit in fits]
    print(f"{min(steps)} to {max(steps)} steps, {min(curves)} to {max(curves)} curves")
    print(f"interpolation: at most {max(fit['interpolation'] for fit in fits):.1e} of a deviation")
    print(f"{np.mean([fit['seconds'] for fit in fits]):.2f} s a fit")


if __name__ == "__main__":
    main()
