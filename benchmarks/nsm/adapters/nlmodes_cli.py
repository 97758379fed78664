#!/usr/bin/env python3
"""Answers of nlmodes (needs NumPy, SciPy, and the command line).

    python3 benchmarks/nsm/adapters/nlmodes_cli.py PROGRAM OUT.json [--harmonics 63] [--method ms-hbm] [01 02 ...]

Each case is a scene of matrices, written to a temporary folder. A free motion is the last point of a branch that ends
at the energy asked for; responses are interpolated between the points of a curve. With `--method shooting` free motions
are exact ones.
"""

import argparse
import csv
import math
import pathlib
import subprocess
import tempfile

import numpy as np
from common import Clock, grazing, mode_number, passed, problems, system_of, write

TAU = 2 * math.pi


class Refused(Exception):
    """The program did not compute a case, with its reason."""


def matrix_market(path, matrix):
    rows, columns = np.nonzero(np.tril(matrix))
    lines = [f"{i + 1} {j + 1} {float(matrix[i, j])!r}" for i, j in zip(rows, columns)]
    n = len(matrix)
    path.write_text(
        "\n".join(["%%MatrixMarket matrix coordinate real symmetric", f"{n} {n} {len(lines)}", *lines]) + "\n"
    )


def scene(folder, problem, tables, harmonics, method):
    """Writes matrices and scene; `tables` are the lines of what is computed."""
    given = problem["system"]
    mass, stiffness = np.array(given["mass"]), np.array(given["stiffness"])
    matrix_market(folder / "k.mtx", stiffness)
    matrix_market(folder / "m.mtx", mass)
    n = len(mass)
    (folder / "dofs.csv").write_text("row,node,component\n" + "".join(f"{i},{i + 1},ux\n" for i in range(n)))
    lines = [
        f'title = "{problem["title"]}"',
        "[structure]",
        'kind = "matrices"',
        'stiffness = "k.mtx"',
        'mass = "m.mtx"',
    ]
    lines += ['dofs = "dofs.csv"', 'units = "m-kg-s"']
    for stop in problem["contacts"]:
        node = int(np.flatnonzero(stop["direction"])[0])
        lines += [
            "[[contact]]",
            f"node = {node + 1}",
            f"normal = [{stop['direction'][node]}, 0.0, 0.0]",
            f"gap_m = {float(stop['gap'])}",
        ]
        lines += [f"stiffness_n_m = {stop['stiffness']}"] * (stop["stiffness"] is not None)
    lines += damping(problem, mass, stiffness)
    lines += ["[reduction]", 'kind = "open-modes"', f"modes = {sum(1 for row in mass if row.any())}"]
    lines += ["[output]", "figures = false", "page = false", *tables]
    number = mode_number(problem["cases"][0])
    lines += ["[method]", f'kind = "{method}"', f"mode = {number}", f"harmonics = {harmonics}"]
    (folder / "scene.toml").write_text("\n".join(lines) + "\n")
    return folder / "scene.toml"


def damping(problem, mass, stiffness):
    """Damping of a problem as a sum of parts of mass and stiffness, or as dashpots to the ground."""
    if "damping" not in problem["system"]:
        return []
    given = np.array(problem["system"]["damping"])
    for name, matrix in (("stiffness_s", stiffness), ("mass_1_s", mass)):
        if matrix.any():
            share = np.vdot(given, matrix) / np.vdot(matrix, matrix)
            if np.abs(given - share * matrix).max() <= 1e-14 * np.abs(given).max():
                return ["[damping]", f"rayleigh = {{ {name} = {float(share)!r} }}"]
    if np.count_nonzero(given - np.diag(np.diag(given))):
        raise Refused("damping that is neither of mass, stiffness nor dashpots")
    lines = []
    for i in np.flatnonzero(np.diag(given)):
        lines += [
            "[[damping.dashpot]]",
            f"node = {i + 1}",
            "direction = [1.0, 0.0, 0.0]",
            f"damping_n_s_m = {float(given[i, i])!r}",
        ]
    return lines


def run(program, folder, path):
    out = folder / "out"
    ended = subprocess.run(
        [program, "run", str(path), "--out", str(out), "--force", "--quiet"], capture_output=True, text=True
    )
    if ended.returncode == 2 or not (out / "branch.csv").exists():
        said = (
            [line for line in ended.stderr.splitlines() if line.startswith("error")]
            or ended.stderr.splitlines()
            or ["nothing was said"]
        )
        raise Refused(said[0].removeprefix("error: ")[:160])
    with open(out / "branch.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    table = {name: np.array([number(row[name]) for row in rows]) for name in rows[0]}
    table["events"] = [row["event"] for row in rows]
    with open(out / "contacts.csv", newline="") as file:
        stops = list(csv.DictReader(file))
    count = 1 + max(int(row["contact"]) for row in stops)
    for j in range(count):
        own = [row for row in stops if int(row["contact"]) == j]
        table[f"impulse[{j}]"] = np.array([number(row["impulse_ns"]) for row in own])
    return table


def number(text):
    try:
        return float(text)
    except ValueError:
        return math.nan


def asked_of(case, values):
    return {
        a["name"]: float(values[a["name"]]) for a in case["asked"] if math.isfinite(values.get(a["name"], math.nan))
    }


def free(program, folder, problem, case, harmonics, method):
    system, _ = system_of(problem)
    begin = grazing(system, mode_number(case))
    energy = case["at"]["mean_kinetic_energy"]
    damped = problem["kind"] == "damped-mode"
    tables = ["[continuation]", 'internal_resonance = "follow"']
    if begin:
        tables += [f"max_energy_ratio = {float(energy / begin[3])!r}"]
        window = [0.5 * begin[0], 3.0 * begin[0]]
    else:
        tables += [f"max_energy_ratio = {1e6 if any(s.gap < 0 for s in system.stops) else 10.0}"]
        window = [0.2, 10.0]
    if damped:
        tables += [
            "[[response]]",
            'kind = "damped-mode"',
            f"frequency_hz = [{float(window[0] / TAU)!r}, {float(window[1] / TAU)!r}]",
        ]
    table = run(program, folder, scene(folder, problem, tables, harmonics, method))
    names = ["frequency_hz", *(f"impulse[{j}]" for j in range(len(problem["contacts"])))]
    names += ["damping_ratio"] * damped
    last = table["energy_j"][-1]
    if abs(last / energy - 1) < 1e-9:
        found = [table[name][-1] for name in names]
    elif not begin and len(table["energy_j"]) and np.ptp(table["frequency_hz"]) < 1e-9 * table["frequency_hz"][0]:
        # Any energy is as good: impulses grow with its root.
        scale = math.sqrt(energy / last)
        found = [table[name][-1] * (1.0 if name == "frequency_hz" else scale) for name in names]
    else:
        points = passed(np.log(table["energy_j"]), math.log(energy), *(table[name] for name in names))
        if not points:
            raise Refused(f"the branch ends at {last:.4g} J")
        found = points[0]
    values = dict(zip(names, found))
    values["frequency"] = TAU * values.pop("frequency_hz")
    return values


def bar(program, folder, problem, case, harmonics, method, elements=40):
    """The bar as a rod of elements whose tip has lost its mass; internal resonances are left out, of which a bar has
    one at each energy."""
    given, energy = problem["bar"], case["at"]["mean_kinetic_energy"]
    lines = [
        "[structure]",
        'kind = "rod"',
        f"length_m = {given['length']}",
        f"elements = {elements}",
        'start = "clamped"',
    ]
    lines += [
        "[structure.material]",
        f"youngs_modulus_pa = {given['tensile_stiffness']}",
        f"density_kg_m3 = {given['mass_per_length']}",
    ]
    lines += [
        "[structure.section]",
        "area_m2 = 1.0",
        "[[contact]]",
        f"at_m = {given['length']}",
        'direction = "axial"',
        'side = "positive"',
    ]
    lines += [
        f"gap_m = {given['gap']}",
        "[output]",
        "figures = false",
        "page = false",
        "[continuation]",
        'internal_resonance = "skip"',
    ]
    # Just touching, the mean kinetic energy is π²/32.
    lines += [f"max_energy_ratio = {1.05 * energy / (math.pi**2 / 32)!r}", "[method]", f'kind = "{method}"', "mode = 1"]
    lines += [f"harmonics = {harmonics}", 'mass_redistribution = "drop"']
    (folder / "scene.toml").write_text("\n".join(lines) + "\n")
    table = run(program, folder, folder / "scene.toml")
    points = passed(np.log(table["energy_j"]), math.log(energy), table["frequency_hz"])
    if not points:
        raise Refused(f"the branch ends at {table['energy_j'][-1]:.4g} J")
    return {"frequency": TAU * points[0][0]}


def driven(program, folder, problem, case, harmonics, method):
    load = np.array(problem["load"]["vector"], dtype=float)
    node = int(np.flatnonzero(load)[0])
    omega = case["at"].get("frequency")
    near = case.get("near", {})
    centre = omega or near["frequency"]
    window = {
        "22": (0.7, 1.6),
        "23": (0.7, 1.8),
        "24": (0.55, 0.8),
        "25": (0.55, 0.8),
        "29": (0.6, 0.8),
        "26": (1.6, 2.3),
    }
    low, high = window.get(problem["id"], (0.9 * centre, 1.1 * centre))
    kind = "phase-resonance" if problem["kind"] == "phase-resonance" else "frequency"
    tables = ["[[force]]", f"node = {node + 1}", "direction = [1.0, 0.0, 0.0]", "[[response]]", f'kind = "{kind}"']
    tables += [f"frequency_hz = [{low / TAU!r}, {high / TAU!r}]", f"levels_n = [{float(load[node])!r}]"]
    if problem["kind"] == "subharmonic":
        tables += ["subharmonic = 2"]
    asks = {a["name"] for a in case["asked"]}
    path = scene(folder, problem, tables, harmonics, method)
    if "multiplier" in asks or "multiplier" in case["branch"]:
        path.write_text(path.read_text().replace("page = false", 'page = false\nstability = "always"'))
    table = run(program, folder, path)
    w = TAU * table["frequency_hz"]
    names = [f"impulse[{j}]" for j in range(len(problem["contacts"]))] + ["drive_fundamental_m", "largest_multiplier"]
    if kind == "phase-resonance":
        points = passed(table["level"], load[node], w, table["drive_fundamental_m"]) if np.ptp(table["level"]) else []
        found = points[0] if points else [w[-1], table["drive_fundamental_m"][-1]]
        return {"frequency": found[0], f"amplitude[{node}]": found[1]}
    if not omega:
        return {"frequency": event_at(table, w, case, near["frequency"])}
    points = passed(w, omega, *(table[name] for name in names))
    if not points:
        raise Refused("no point at this frequency")
    best = min(points, key=lambda p: abs(math.log(max(p[-2], 1e-300) / near[f"amplitude[{node}]"])))
    values = dict(zip(names, best))
    return {**values, f"amplitude[{node}]": values["drive_fundamental_m"], "multiplier": values["largest_multiplier"]}


def event_at(table, w, case, near):
    """The frequency of the event of a curve that is nearest to one."""
    wanted = "period-doubling" if "doubling" in case["branch"] else "fold"
    found = [w[i] for i, names in enumerate(table["events"]) if wanted in names.split()]
    if not found:
        raise Refused(f"no {wanted} was found")
    return min(found, key=lambda x: abs(x - near))


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program")
    parser.add_argument("out")
    parser.add_argument("numbers", nargs="*")
    parser.add_argument("--harmonics", type=int, default=63)
    parser.add_argument("--method", default="ms-hbm")
    words = parser.parse_args()
    version = subprocess.run([words.program, "--version"], capture_output=True, text=True).stdout.split()[-1]
    answers = {}
    for problem in problems(words.numbers):
        for case in problem["cases"]:
            with tempfile.TemporaryDirectory() as place, Clock() as clock:
                try:
                    if problem["kind"] == "impact":
                        raise Refused("not computed")
                    compute = bar if problem["kind"] == "bar" else driven if "load" in problem else free
                    values = compute(words.program, pathlib.Path(place), problem, case, words.harmonics, words.method)
                    answer = asked_of(case, values)
                except Refused as reason:
                    answer = {"note": str(reason)}
            if any(name in answer for name in (a["name"] for a in case["asked"])):
                answer["cpu_s"] = clock.seconds
            answers[case["case"]] = answer
            print(case["case"], answer, flush=True)
            write(words.out, f"nlmodes {version}", f"{words.method}, {words.harmonics} harmonics", answers)


if __name__ == "__main__":
    main()
