#!/usr/bin/env python3
"""Gradients of curves against differences of whole runs.

    benchmarks/studies/gradients.py --program target/release/nlmodes-cli --out results/gradients

A rod, a beam and the plate from CalculiX, with one and with five stops, rigid and elastic ones in turn: the conservative
mode and the damped mode at the energy of their last point, the response at its last frequency, each in three systems of
units, those of the keys or of the matrices. For each parameter the derivatives of the last point are compared with the
difference quotient of fourth order of runs from the command line at four other values of it.
Needs Python 3.11, NumPy and SciPy.
"""

import argparse
import csv
import gzip
import json
import subprocess
from pathlib import Path

import numpy as np

QUOTIENT = {1: 8 / 12, -1: -8 / 12, 2: -1 / 12, -2: 1 / 12}
STEP = {"mode": 1e-3, "damped-mode": 1e-3, "response": 2e-4}
QUANTITIES = {"frequency": "frequency_hz", "amplitude": "fundamental_m", "peak": "peak_m",
              "peak_force": "peak_contact_force_n", "impulse": "impulse_ns", "damping_ratio": "damping_ratio"}
# Other spellings of keys in SI units, and what a number is multiplied by.
SPELLED = {
    "m": {},
    "mm": {"length_m": ("length_mm", 1e3), "at_m": ("at_mm", 1e3), "gap_m": ("gap_mm", 1e3), "mass_kg": ("mass_g", 1e3),
           "height_m": ("height_mm", 1e3), "area_m2": ("area_mm2", 1e6), "stiffness_n_m": ("stiffness_n_mm", 1e-3),
           "youngs_modulus_pa": ("youngs_modulus_gpa", 1e-9), "ratio": ("ratio_percent", 1e2)},
    "cm": {"length_m": ("length_cm", 1e2), "at_m": ("at_cm", 1e2), "gap_m": ("gap_um", 1e6), "mass_kg": ("mass_g", 1e3),
           "height_m": ("height_cm", 1e2), "area_m2": ("area_cm2", 1e4), "stiffness_n_m": ("stiffness_n_um", 1e-6),
           "youngs_modulus_pa": ("youngs_modulus_mpa", 1e-6)},
}
# Of matrices: metres, kilograms and seconds of one unit.
FILES = {"m-kg-s": (1.0, 1.0, 1.0), "mm-t-s": (1e-3, 1e3, 1.0), "um-kg-ms": (1e-6, 1.0, 1e-3)}
LENGTH = 0.5


class Scene:
    """Lines of a scene in its units, and the parameters by which it is differentiated: keys with their values."""

    def __init__(self, units):
        self.spelled, self.lines, self.parameters, self.places = SPELLED.get(units, {}), [], {}, {}

    def table(self, header, path, numbers, others=(), by=()):
        self.lines += [header, *others]
        for key, value in numbers.items():
            key_of, factor = self.spelled.get(key, (key, 1.0))
            self.lines.append(f"{key_of} = {value * factor!r}")
            if key in by:
                self.parameters[f"{path}.{key_of}"] = value * factor
            if key == "at_m":
                self.places[f"{path}.{key_of}"] = value * factor


def straight(kind, stops, units, _folder, _plate):
    scene = Scene(units)
    axis = "transverse" if kind == "beam" else "axial"
    section = {"width_m": 0.02, "height_m": 0.006} if kind == "beam" else {"area_m2": 1.2e-4}
    scene.table("[structure]", "structure", {"length_m": LENGTH}, [f'kind = "{kind}"', "elements = 20", 'start = "clamped"'], ["length_m"])
    scene.table("[structure.material]", "structure.material", {"youngs_modulus_pa": 210e9, "density_kg_m3": 7800.0},
                ["poissons_ratio = 0.3"] if kind == "beam" else [], ["youngs_modulus_pa", "density_kg_m3"])
    scene.table("[structure.section]", "structure.section", section, by=["height_m", "area_m2"])
    scene.table("[[structure.mass_point]]", "structure.mass_point.0", {"at_m": 0.3 * LENGTH, "mass_kg": 0.05}, by=["mass_kg"])
    gap, stiff = (1e-3, 3e4) if kind == "beam" else (1e-5, 5e7)
    for k in range(stops):
        x = 1.0 - 0.2 * k
        stop = {"at_m": x * LENGTH, "gap_m": gap * x**1.5 * (0.9 + 0.05 * k)}
        stop |= {"stiffness_n_m": stiff * (1 + k)} if k % 2 == 0 else {}
        side = "negative" if k % 2 else "positive"
        by = ["gap_m", "stiffness_n_m"] if k < 2 else []
        scene.table("[[contact]]", f"contact.{k}", stop, [f'direction = "{axis}"', f'side = "{side}"'], by)
    force = {"at_m": 0.5 * LENGTH, "amplitude_n": 5.0 if kind == "beam" else 2e3}
    return scene, (force, [f'direction = "{axis}"'])


def read_plate(folder):
    """Stiffness and mass of the plate as entries (row, column, value), in mm, t and s."""
    read = {}
    for name in ("sti", "mas"):
        with gzip.open(folder / f"plate.{name}.gz", "rt") as file:
            read[name] = np.array([[float(x) for x in line.split()] for line in file])
    labels = [tuple(map(int, line.strip().split("."))) for line in (folder / "plate.dof").read_text().split()]
    return read["sti"], read["mas"], labels


# A spring across the plate and an added mass, entries (matrix, row, column, share) of the parameter.
ENTRIES = ("rib", "pad")


def matrices(kind, stops, units, folder, plate):
    length, mass, second = FILES[units]
    scene = Scene(units)
    sti, mas, labels = plate
    z = [k for k, (_, component) in enumerate(labels) if component == 3]
    to_k, to_m = 1e3 / (mass / second**2), 1e3 / mass
    rib, pad = 2e3 * to_k, 4e-6 * to_m
    where = [z[len(z) // 3], z[2 * len(z) // 3]]
    directions = {"rib": [("stiffness", where[0], where[0], rib), ("stiffness", where[1], where[1], rib), ("stiffness", where[1], where[0], -rib)],
                  "pad": [("mass", where[1], where[1], pad)]}

    def write(changes, name):
        for matrix, entries, factor in (("stiffness", sti, to_k), ("mass", mas, to_m)):
            n = len(labels)
            more = [(i + 1, j + 1, times * value) for p, times in changes.items() for m, i, j, value in directions[p] if m == matrix]
            rows = [(max(int(i), int(j)), min(int(i), int(j)), value * factor) for i, j, value in entries] + [(max(i, j), min(i, j), v) for i, j, v in more]
            sums = {}
            for i, j, value in rows:
                sums[i, j] = sums.get((i, j), 0.0) + value
            with open(folder / f"{name}_{matrix}.mtx", "w", encoding="utf-8") as out:
                out.write(f"%%MatrixMarket matrix coordinate real symmetric\n{n} {n} {len(sums)}\n")
                out.writelines(f"{i} {j} {float(value)!r}\n" for (i, j), value in sums.items())

    (folder / "dofs.csv").write_text("".join(f"{k + 1},{node},{component}\n" for k, (node, component) in enumerate(labels)))
    with open(folder / "entries.csv", "w", encoding="utf-8") as out:
        out.write("parameter,matrix,node,component,other_node,other_component,value\n")
        for name, entries in directions.items():
            for matrix, i, j, value in entries:
                out.write(f"{name},{matrix},{labels[i][0]},{labels[i][1]},{labels[j][0]},{labels[j][1]},{value!r}\n")
    scene.write = write
    write({}, "own")
    scene.lines += ["[structure]", 'kind = "matrices"', 'stiffness = "own_stiffness.mtx"', 'mass = "own_mass.mtx"', 'dofs = "dofs.csv"', f'units = "{units}"']
    for k in range(stops):
        node = labels[z[len(z) - 1 - k * (len(z) // 7)]][0]
        stop = {"gap_m": 0.5e-3 * (1 - 0.1 * k)} | ({"stiffness_n_m": 1e5} if k % 2 == 0 else {})
        scene.table("[[contact]]", f"contact.{k}", stop, [f"node = {node}", f"normal = [0.0, 0.0, {-1.0 if k % 2 else 1.0}]"],
                    ["gap_m", "stiffness_n_m"] if k < 2 else [])
    for name in ENTRIES:
        scene.parameters[name] = 1.0
    return scene, ({"amplitude_n": 5.0}, [f"node = {labels[z[len(z) // 2]][0]}", "direction = [0.0, 0.0, 1.0]"])


KINDS = {"rod": straight, "beam": straight, "plate": matrices}


def run(program, folder, lines, sets=()):
    (folder / "scene.toml").write_text("\n".join(lines) + "\n")
    call = [program, "run", folder / "scene.toml", "--out", folder / "out", "--quiet", "--force"]
    for setting in sets:
        call += ["--set", setting]
    done = subprocess.run(call, capture_output=True, text=True, check=False)
    if done.returncode not in (0, 1):
        raise RuntimeError(f"{folder} {sets}: {done.stderr}")
    with open(folder / "out" / "branch.csv", newline="", encoding="utf-8") as table:
        row = list(csv.DictReader(table))[-1]
    return {key: float(value) for key, value in row.items() if value and key != "events" and _number(value)}, folder / "out"


def _number(text):
    try:
        float(text)
    except ValueError:
        return False
    return True


def compare(program, folder, plate, case):
    """The largest difference of each parameter over the quantities, as a share of the quantity's own change."""
    kind, stops, analysis, units = case
    folder.mkdir(parents=True, exist_ok=True)
    scene, (force, place) = KINDS[kind](kind, stops, units, folder, plate)
    sensitivities = [f'[[sensitivity]]\nkey = "{key}"' for key in scene.parameters if key not in ENTRIES]
    if kind == "plate":
        sensitivities.append('[[sensitivity]]\nentries = "entries.csv"')
    method = ["[method]\nharmonics = 5", "[reduction]\nmodes = 8", '[output]\nstability = "never"\nfigures = false\npage = false']
    probe = [*scene.lines, "[continuation]\nmax_energy_ratio = 1.01", *method]

    def grazing(sets):
        _, out = run(program, folder, probe, sets)
        first = json.loads((out / "summary.json").read_text())["grazing"]
        return first["energy_j"], first["frequency_hz"]

    energy, f = grazing([])
    if analysis != "mode":
        scene.table("[damping]", "damping", {"ratio": 0.01}, by=["ratio"])
        if analysis == "response":
            sensitivities += [f'[[sensitivity]]\nkey = "{key}"' for key in ("force.0.amplitude_n", *[k for k in scene.parameters if k.startswith("damping")])]
            scene.table("[[force]]", "force.0", force, place, ["amplitude_n"])
    if analysis == "response":
        end = ["[[response]]", 'kind = "frequency"', f"frequency_hz = [{0.8 * f!r}, {1.05 * f!r}]"]
        sets_of = lambda _: []  # noqa: E731
    else:
        end = (["[[response]]", 'kind = "damped-mode"'] if analysis == "damped-mode" else []) + ["[continuation]", "max_energy_ratio = 3.0"]
        sets_of = lambda sets: [f"continuation.max_energy_ratio={3.0 * energy / grazing(sets)[0]!r}"]  # noqa: E731
    rest = [*end, *method]
    base, _ = run(program, folder, [*scene.lines, *rest, *sensitivities])
    step, worst = STEP[analysis], {}
    for key, value in scene.parameters.items():
        if analysis == "damped-mode" and key.startswith("damping"):
            continue
        quotient = dict.fromkeys(QUANTITIES, 0.0)
        for times, weight in QUOTIENT.items():
            lines = list(scene.lines)
            if key in ENTRIES:
                scene.write({key: times * step}, "moved")
                sets = ['structure.stiffness="moved_stiffness.mtx"', 'structure.mass="moved_mass.mtx"']
            else:
                factor = 1 + times * step
                sets = [f"{key}={value * factor!r}"]
                if key.startswith("structure.length"):
                    sets += [f"{at}={own * factor!r}" for at, own in scene.places.items()]
            row, _ = run(program, folder, [*lines, *rest], sets + sets_of(sets))
            for name, of in QUANTITIES.items():
                quotient[name] += weight * row.get(of, np.nan) / (step * value)
        errors = {}
        for name, of in QUANTITIES.items():
            gradient = base.get(f"d_{name}_d_{key}")
            # Of a response over the frequency that is the derivative at constant amplitude.
            if gradient is None or (name, analysis) == ("frequency", "response") or not np.isfinite(quotient[name]):
                continue
            own = quotient[name] * (np.sign(base[of]) if name == "amplitude" else 1.0)
            size = max(abs(own), 1e-2 * abs(base[of] / value))
            errors[name] = abs(gradient - own) / size
        worst[key] = max(errors.items(), key=lambda item: item[1], default=("nothing", np.nan))
    return worst, base.get("peak_contact_force_n", 0.0)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default="target/release/nlmodes-cli", type=lambda path: str(Path(path).resolve()))
    parser.add_argument("--kinds", nargs="+", default=list(KINDS))
    parser.add_argument("--stops", nargs="+", type=int, default=[1, 5])
    parser.add_argument("--analyses", nargs="+", default=list(STEP))
    parser.add_argument("--out", type=Path, default=Path("results/gradients"))
    arguments = parser.parse_args()
    plate = read_plate(Path("configs/structures"))
    print("| structure | stops | curve | units | parameters | largest difference | of |\n|---|---|---|---|---|---|---|")
    for kind in arguments.kinds:
        for stops in arguments.stops:
            for analysis in arguments.analyses:
                for units in FILES if kind == "plate" else SPELLED:
                    folder = arguments.out / f"{kind}_{stops}_{analysis}_{units}"
                    worst, force = compare(arguments.program, folder, plate, (kind, stops, analysis, units))
                    key, (name, error) = max(worst.items(), key=lambda item: item[1][1])
                    touched = "" if force > 0.0 else " (nothing touches)"
                    print(f"| {kind} | {stops} | {analysis} | {units} | {len(worst)} | {error:.1e} | {name} by {key}{touched} |", flush=True)


if __name__ == "__main__":
    main()
