#!/usr/bin/env python3
"""Branches of random structures: how many reach the end that was asked for, in which time, and why the others do not.

    benchmarks/studies/random_branches.py --program target/release/nlmodes-cli --seeds 30 --out results/random

Rods, beams and, as matrices, chains and lattices of random properties in four systems of units, with 1, 2, 3, 5 or 10
stops on both sides. `--analysis mode` (the default) computes the conservative mode to five energies at grazing, for five
numbers of harmonics, each with `internal_resonance` as its default and as "follow". `--analysis damped-mode` and
`--analysis response` compute the damped mode to five energies at grazing and the response to a force at the first stop
that would move it twice as far as grazing, with 1 % of damping, 5 and 15 harmonics, rigid and elastic stops.
Needs Python 3.11 and NumPy.
"""

import argparse
import json
import os
import resource
import statistics
import subprocess
import sys
from pathlib import Path

import numpy as np

STOPS = [1, 2, 3, 5, 10]
HARMONICS = [1, 3, 5, 9, 15]
UNITS = {"m-kg-s": (1.0, 1.0, 1.0), "mm-t-s": (1e-3, 1e3, 1.0), "mm-kg-ms": (1e-3, 1.0, 1e-3), "um-kg-ms": (1e-6, 1.0, 1e-3)}


def straight(rng, stops):
    """A rod or a beam with stops at some of its nodes: text of the structure and its contacts."""
    kind = rng.choice(["rod", "beam"])
    elements = int(rng.integers(max(8, stops), 41))
    length = 10 ** rng.uniform(-1, 1)
    height = length * rng.uniform(0.01, 0.05)
    start = rng.choice(["clamped", "pinned"]) if kind == "beam" else "clamped"
    end = "pinned" if start == "pinned" else rng.choice(["free", "free", "clamped"])
    axis = "transverse" if kind == "beam" else "axial"
    last = elements if end == "free" else elements - 1
    lines = ["[structure]", f'kind = "{kind}"', f"length_m = {float(length)!r}", f"elements = {elements}",
             f'start = "{start}"', f'end = "{end}"', "[structure.material]",
             f"youngs_modulus_pa = {float(10 ** rng.uniform(9.5, 11.5))!r}", f"density_kg_m3 = {float(10 ** rng.uniform(3, 4))!r}"]
    if kind == "beam":
        lines += ["poissons_ratio = 0.3", "[structure.section]", f"width_m = {float(height)!r}", f"height_m = {float(height)!r}"]
    else:
        lines += ["[structure.section]", f"area_m2 = {float(height**2)!r}"]
    nodes = rng.choice(np.arange(1, last + 1), stops, replace=False)
    if end == "free":
        nodes[0] = last if last not in nodes else nodes[0]
    for node in nodes:
        # Gaps near the shape of a cantilever or an arch, so that several stops are met.
        x = node / elements
        shape = x**1.5 if end == "free" else np.sin(np.pi * x) if end != "clamped" or start != "clamped" else np.sin(np.pi * x) ** 2
        gap = 1e-3 * length * (0.05 + shape) * rng.uniform(0.8, 2.0)
        lines += ["[[contact]]", f"at_m = {float(length * x)!r}", f'direction = "{axis}"',
                  f'side = "{rng.choice(["positive", "negative"])}"', f"gap_m = {float(gap)!r}"]
    return kind, lines


def matrices(rng, stops, folder, name):
    """A chain, or a lattice of masses on springs with a ground spring each, as matrices."""
    lattice = rng.random() < 0.5
    n = int(rng.integers(max(12, stops + 2), 37))
    k, m = 10 ** rng.uniform(4, 7), 10 ** rng.uniform(-2, 0)
    side = int(np.ceil(np.sqrt(n)))
    n = side * side if lattice else n
    stiffness, mass = np.zeros((n, n)), np.diag(m * rng.uniform(0.7, 1.3, n))

    def spring(i, j, value):
        stiffness[i, i] += value
        if j is not None:
            stiffness[j, j] += value
            stiffness[i, j] -= value
            stiffness[j, i] -= value

    if lattice:
        for i in range(n):
            spring(i, None, 0.05 * k * rng.uniform(0.5, 1.5))
            if i % side + 1 < side:
                spring(i, i + 1, k * rng.uniform(0.5, 1.5))
            if i + side < n:
                spring(i, i + side, k * rng.uniform(0.5, 1.5))
    else:
        spring(0, None, k)
        for i in range(n - 1):
            spring(i, i + 1, k * rng.uniform(0.5, 1.5))
    unit = rng.choice(list(UNITS))
    length, kilo, second = UNITS[unit]
    force = kilo * length / second**2
    for file, matrix in (("K", stiffness / (force / length)), ("M", mass / kilo)):
        rows, columns = np.nonzero(matrix)
        with open(folder / f"{name}_{file}.mtx", "w") as out:
            out.write(f"%%MatrixMarket matrix coordinate real general\n{n} {n} {len(rows)}\n")
            out.writelines(f"{i + 1} {j + 1} {matrix[i, j]:.17g}\n" for i, j in zip(rows, columns))
    (folder / f"{name}_dofs.csv").write_text("row,node,component\n" + "".join(f"{i},{i + 1},3\n" for i in range(n)))
    values, shapes = np.linalg.eigh(stiffness / np.sqrt(np.outer(np.diag(mass), np.diag(mass))))
    shape = np.abs(shapes[:, 0]) / np.max(np.abs(shapes[:, 0]))
    lines = ["[structure]", 'kind = "matrices"', f'stiffness = "{name}_K.mtx"', f'mass = "{name}_M.mtx"',
             f'dofs = "{name}_dofs.csv"', f'units = "{unit}"']
    for node in rng.choice(n, stops, replace=False):
        gap = 1e-4 * (0.05 + shape[node]) * rng.uniform(0.8, 2.0)
        sign = float(rng.choice([-1.0, 1.0]))
        lines += ["[[contact]]", f"node = {node + 1}", f"normal = [0.0, 0.0, {sign}]", f"gap_m = {float(gap)!r}"]
    return ("lattice" if lattice else "chain"), lines, np.sqrt(values[0]) / (2 * np.pi)


def damped(program, analysis, base, text, rng, harmonics, elastic):
    """Lines of the damped mode or response of a scene, from its linear mode at grazing; None where that is not found."""
    probe = base.with_name(f"{base.name}_probe.toml")
    probe.write_text("\n".join([*text, "[method]", "harmonics = 1", "[continuation]",
                               "max_energy_ratio = 1.1", "[output]",
                               "figures = false", "page = false"]) + "\n")
    run(program, probe, 60)
    rows = probe.with_suffix("") / "branch.csv"
    if not rows.exists():
        return None
    header, first, *_ = rows.read_text().splitlines()
    row = dict(zip(header.split(","), first.split(",")))
    f, q, u = float(row["frequency_hz"]), float(row["modal_amplitude"]), abs(float(row["fundamental_m"]))
    first = text.index("[[contact]]")
    place = text[first + 1:first + 3]
    if elastic:
        # Between a third and thirty times the stiffness of the first mode at the first stop.
        stiffness = 10 ** rng.uniform(-0.5, 1.5) * (2 * np.pi * f * q / u) ** 2
        text = [out for line in text
                for out in ([line, f"stiffness_n_m = {float(stiffness)!r}"] if line == "[[contact]]" else [line])]
    if "direction" not in place[1]:
        place[1] = place[1].replace("normal", "direction")
    force = 2.0 * 2.0 * 0.01 * (2 * np.pi * f) ** 2 * q * q / u
    lines = [*text, "[damping]", "ratio = 0.01", "[[force]]", *place, f"amplitude_n = {force!r}", "[method]",
             f"harmonics = {harmonics}", "[response]"]
    if analysis == "response":
        return [*lines, 'kind = "frequency"', f"frequency_hz = [{0.85 * f!r}, {1.3 * f!r}]"]
    return [*lines, 'kind = "damped-mode"', "[continuation]", "max_energy_ratio = 5.0"]


def damped_scenes(arguments, folder):
    for seed in range(arguments.first, arguments.first + arguments.seeds):
        rng = np.random.default_rng(seed)
        stops, name = STOPS[seed % len(STOPS)], f"s{seed}"
        kind, lines, *_ = matrices(rng, stops, folder, name) if rng.random() < 0.5 else straight(rng, stops)
        for harmonics in (5, 15):
            for way in ("rigid", "elastic"):
                text = [f'title = "{name}"', *lines]
                text = damped(arguments.program, arguments.analysis, folder / name, text, rng, harmonics, way == "elastic")
                if text is None:
                    print(f"{name}: no linear mode that touches")
                    continue
                path = folder / f"{name}_{kind}_c{stops}_h{harmonics}_{way}.toml"
                path.write_text("\n".join([*text, "[output]", "figures = false", "page = false"]) + "\n")
                yield path, kind, stops, harmonics, way


def scenes(arguments, folder):
    for seed in range(arguments.first, arguments.first + arguments.seeds):
        rng = np.random.default_rng(seed)
        stops = STOPS[seed % len(STOPS)]
        name = f"s{seed}"
        kind, lines, *_ = matrices(rng, stops, folder, name) if rng.random() < 0.5 else straight(rng, stops)
        for harmonics in HARMONICS:
            for way in arguments.ways:
                text = [f'title = "{name}"', *lines, "[method]", "mode = 1", f"harmonics = {harmonics}", "[continuation]",
                        "max_energy_ratio = 5.0"]
                if way != "default":
                    text.append(f'internal_resonance = "{way}"')
                text += ["[output]", "figures = false", "page = false"]
                path = folder / f"{name}_{kind}_c{stops}_h{harmonics}_{way}.toml"
                path.write_text("\n".join(text) + "\n")
                yield path, kind, stops, harmonics, way


def run(program, path, limit):
    """Exit status, CPU time, points and why it ended."""
    out = path.with_suffix("")
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    status = subprocess.run([program, "run", path, "--out", out, "--quiet", "--force"], capture_output=True,
                            text=True, preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_CPU, (limit, limit)),
                            env={**os.environ, "RAYON_NUM_THREADS": "1"})
    code, words = status.returncode, (status.stderr or status.stdout).strip()
    if code < 0:
        code, words = "time", f"not done after {limit} s of CPU time"
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    seconds = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    points = sum(1 for _ in open(out / "branch.csv")) - 1 if (out / "branch.csv").exists() else 0
    lines = words.splitlines() or [""]
    reason = next((line for line in lines if "ended" in line or line.startswith("error")), lines[-1])
    return code, seconds, points, reason


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default="target/release/nlmodes-cli")
    parser.add_argument("--seeds", type=int, default=30)
    parser.add_argument("--first", type=int, default=1, help="first seed")
    parser.add_argument("--analysis", choices=["mode", "damped-mode", "response"], default="mode")
    parser.add_argument("--ways", nargs="+", default=["default", "follow"])
    parser.add_argument("--limit-s", type=int, default=60, help="longest CPU time of a branch, s")
    parser.add_argument("--out", type=Path, default=Path("results/random_branches"))
    arguments = parser.parse_args()
    arguments.out.mkdir(parents=True, exist_ok=True)
    rows = []
    for path, kind, stops, harmonics, way in (scenes if arguments.analysis == "mode" else damped_scenes)(arguments, arguments.out):
        code, seconds, points, words = run(arguments.program, path, arguments.limit_s)
        rows.append({"scene": path.stem, "kind": kind, "stops": stops, "harmonics": harmonics, "way": way, "exit": code,
                     "cpu_s": round(seconds, 3), "points": points, "words": words if code else ""})
        if code:
            print(f"{path.stem}: {code}, {seconds:.1f} s, {points} points: {words}", flush=True)
        (arguments.out / "rows.json").write_text(json.dumps(rows, indent=1))
    for key in ("way", "stops", "harmonics", "kind"):
        for value in sorted({row[key] for row in rows}, key=str):
            of = [row for row in rows if row[key] == value]
            times = sorted(row["cpu_s"] for row in of)
            print(f"{key} {value}: {sum(row['exit'] == 0 for row in of)} of {len(of)}, CPU median "
                  f"{statistics.median(times):.2f} s, 90th percentile {times[int(0.9 * (len(times) - 1))]:.2f} s")
    return 0 if all(row["exit"] == 0 for row in rows) else 1


if __name__ == "__main__":
    sys.exit(main())
