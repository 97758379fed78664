#!/usr/bin/env python3
"""NLvib's examples with laws of force beside `[[spring]]` (needs NumPy, SciPy, GNU Octave and NLvib, whose folder is given).

    python3 benchmarks/peers/cubic_springs.py PROGRAM NLVIB [--runs 3]

Examples 01 (Duffing), 02 (two masses, forced), 04 (their first nonlinear mode), 06 (two springs,
geometrically nonlinear: mode and response) and 09 (mode of a cantilever), with their numbers of harmonics. Points of nlmodes,
at most 60 of a curve (of 09 twelve), are the beginning of Newton's method across the curve on NLvib's own residual: what that changes, relative to the point, is the difference.
Times are processor times of `solve_and_continue` with the steps of the example, and of the whole process of nlmodes with its files.
"""

import argparse
import json
import pathlib
import resource
import statistics
import subprocess
import tempfile

import numpy as np
from scipy.io import loadmat, mmwrite, savemat
from scipy.sparse import coo_matrix

HERE = pathlib.Path(__file__).parent
HEAD = """[structure]
kind = "matrices"
stiffness = "k.mtx"
mass = "m.mtx"
dofs = "dofs.csv"
units = "m-kg-s"
[output]
figures = false
page = false
stability = "never"
directory = "out"
[continuation]
max_points = 2000
"""
X = "direction = [1.0, 0.0, 0.0]\n"
CUBIC = "law = {{ polynomial = [0.0, 0.0, {}] }}\n"


def geometric(s):
    """Springs of one direction each for `½ (x² + y²)(s₁ x + s₂ y) + ⅛ (s₁ + s₂)(x² + y²)²`: sums of powers of linear forms."""
    angles = np.pi * np.arange(4) / 4
    rows = lambda c, d: [c**3, 3 * c * c * d, 3 * c * d * d, d**3]
    cubes = np.linalg.solve(np.array([rows(np.cos(a), np.sin(a)) for a in angles]).T, 0.5 * np.array([s[0], s[1], s[0], s[1]]))
    laws = [(a, [0.0, 3 * c]) for a, c in zip(angles, cubes)]
    laws += [(np.pi * k / 3, [0.0, 0.0, 4 * sum(s) / 9]) for k in range(3)]
    text = ""
    for angle, law in laws:
        text += f"[[spring]]\nnode = 1\ndirection = [{float(np.cos(angle))!r}, {float(np.sin(angle))!r}, 0.0]\nlaw = {{ polynomial = {[float(v) for v in law]} }}\n"
    return text


def from_rest(q, of):
    """The harmonics of a motion from the instant on, near its beginning, at which a coordinate has no velocity."""
    k, tau = np.arange(q.shape[1]), 0.0
    for _ in range(20):
        turned = q[of] * np.exp(1j * k * tau)
        tau -= (k * turned).imag.sum() / (k * k * turned).real.sum()
    return q * np.exp(1j * k * tau)


def spring(node, value, other=None, direction=X):
    against = f"against = {{ node = {other}, {direction.strip()} }}\n" if other else ""
    return f"[[spring]]\nnode = {node}\n{direction}{against}{CUBIC.format(value)}"


def forced(node, level, low, high):
    window = f"[{low / (2 * np.pi)!r}, {high / (2 * np.pi)!r}]"
    return f"[[force]]\nnode = {node}\n{X}[[response]]\nkind = \"frequency\"\nfrequency_hz = {window}\nlevels_n = [{level}]\n"


def dashpot(node, value):
    return f"[[damping.dashpot]]\nnode = {node}\n{X}damping_n_s_m = {value}\n"


Y = "direction = [0.0, 1.0, 0.0]\n"
Z = "direction = [0.0, 0.0, 1.0]\n"
CASES = {
    "01": (7, spring(1, 0.1) + forced(1, 0.18, 0.5, 1.6) + "[damping]\nratio = 0.025\n"),
    # Dampers of 0.002 to the ground and 0.013 between the masses.
    "02": (7, spring(1, 1.0) + spring(1, 0.0042, 2) + forced(1, 0.11, 0.8, 1.4)
           + f"[[spring]]\nnode = 1\n{X}law = {{ damper = {{ coefficient = 0.002, exponent = 1 }} }}\n"
           + f"[[spring]]\nnode = 1\n{X}against = {{ node = 2, {X.strip()} }}\nlaw = {{ damper = {{ coefficient = 0.013, exponent = 1 }} }}\n"
           + "[damping]\nratio = 0.0\n"),
    "04": (9, spring(1, 0.5)),
    "06": (7, geometric([1.13**2, 4.0]) + "[damping]\nratios = [1e-3, 5e-3]\n[[response]]\nkind = \"damped-mode\"\n"),
    "06, forced": (7, geometric([1.13**2, 4.0]) + forced(1, 3e-3, 0.8, 1.6)
                   + f"[[force]]\nnode = 1\n{Y}amplitude_n = 1.0\n[damping]\nratios = [1e-3, 5e-3]\n"),
    "09": (5, spring(19, 6e9, direction=Z)),
}
# Coordinate that NLvib holds at rest at the beginning of a period of a damped mode.
PHASES = {"06": 0}
ENDS = {
    "04": "max_energy_ratio = 1e4\n",
    "06": "start_energy_j = 1e-6\nmax_energy_ratio = 1e5\n",
    "09": "max_energy_ratio = 1e6\n",
}


def octave(nlvib, folder, name, **more):
    savemat(folder / "case.mat", {"name": name, **more})
    call = f"addpath('{HERE}'); cubic_springs('{nlvib}', '{folder}')"
    subprocess.run(["octave-cli", "--quiet", "--eval", call], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def used():
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def compare(program, nlvib, name, runs):
    harmonics, rest = CASES[name]
    with tempfile.TemporaryDirectory() as made:
        folder = pathlib.Path(made)
        octave(nlvib, folder, name)
        system = loadmat(folder / "system.mat")
        n = len(system["K"])
        for file, matrix in (("k.mtx", system["K"]), ("m.mtx", system["M"])):
            full = matrix.toarray() if hasattr(matrix, "toarray") else matrix
            mmwrite(folder / file, coo_matrix(0.5 * (full + full.T)), symmetry="general")
        place = {"09": lambda i: (i // 2 + 1, 3 if i % 2 == 0 else 5), "06": lambda i: (1, i + 1)}
        place["06, forced"] = place["06"]
        component = place.get(name, lambda i: (i + 1, 1))
        rows = [f"{i},{component(i)[0]},{component(i)[1]}" for i in range(n)]
        (folder / "dofs.csv").write_text("row,node,component\n" + "\n".join(rows) + "\n")
        scene = HEAD + ENDS.get(name, "") + rest + f"[method]\nharmonics = {harmonics}\n"
        (folder / "scene.toml").write_text(scene)
        times = []
        for _ in range(runs):
            before = used()
            done = subprocess.run([program, "run", "scene.toml", "--force", "--quiet"], cwd=folder, capture_output=True, text=True)
            if done.returncode:
                raise SystemExit(done.stderr)
            times.append(used() - before)
        found = np.load(folder / "out/harmonics.npz")
        omega, z = found["omega"], found["coefficients"][:, :n]
        points = []
        table = np.genfromtxt(folder / "out/branch.csv", delimiter=",", names=True, dtype=None, encoding=None)
        damping = table["damping_ratio"] if name in PHASES else np.zeros(len(omega))
        for w, q, d in zip(omega, z, damping):
            if name in PHASES:
                q = from_rest(q, PHASES[name])
            x = [q[:, 0].real]
            for k in range(1, harmonics + 1):
                x += [q[:, k].real, -q[:, k].imag]
            x = np.concatenate(x)
            if name in ENDS:
                # NLvib's amplitude is that of all harmonics.
                mass = system["M"].toarray() if hasattr(system["M"], "toarray") else system["M"]
                a = np.sqrt(np.einsum("in,ij,jn->", q.conj(), mass, q).real)
                points.append(np.concatenate([x / a, [w, d, np.log10(a)]]))
            else:
                points.append(np.concatenate([x, [w]]))
        most = 12 if name == "09" else 60
        few = np.array(points)[:: max(1, -(-len(points) // most))]
        octave(nlvib, folder, name, points=few.T)
        answer = json.loads((folder / "answer.json").read_text())
        differences = np.atleast_1d(answer["differences"])
        ours = statistics.median(times)
        print(f"| {name} | {harmonics} | {len(omega)} | {np.median(differences):.1e} | {differences.max():.1e} | {ours:.2f} "
              f"| {answer['points']} | {answer['cpu_s']:.2f} | {answer['cpu_s'] / ours:.0f} |", flush=True)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program", type=lambda path: str(pathlib.Path(path).resolve()))
    parser.add_argument("nlvib", type=lambda path: str(pathlib.Path(path).resolve()))
    parser.add_argument("--runs", type=int, default=3)
    parser.add_argument("--cases", default=",".join(CASES))
    words = parser.parse_args()
    print("| example | harmonics | points | median difference | largest | CPU, s | NLvib: points | CPU, s | ratio |")
    print("| --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |")
    for name in words.cases.split(","):
        compare(words.program, words.nlvib, name, words.runs)


if __name__ == "__main__":
    main()
