"""Processor time of whole runs, scene by scene, beside another build of the program and beside what the points alone would take.

    python benchmarks/times.py target/release/nlmodes-cli [--beside OTHER_BUILD] [--only PART_OF_A_NAME]

Each scene is run in turn by both programs, five times where it takes less than a second, and the least processor time counts. "Evaluations" are those of
residual and Jacobian. Needs Python and Linux; prints a Markdown table.
"""

import argparse
import json
import math
import os
import subprocess
import sys
import tempfile
from pathlib import Path

CONFIGS = Path(__file__).resolve().parents[1] / "configs"


def cantilever(stops, elements, harmonics, energy_ratio):
    """A cantilever over a row of stops whose gaps follow its first mode, the tip's being touched first."""
    lines = [
        '[structure]\nkind = "beam"\nlength_m = 0.6\n' f'elements = {elements}\nstart = "clamped"\nend = "free"',
        "[structure.material]\nyoungs_modulus_pa = 210e9\ndensity_kg_m3 = 7800.0\npoissons_ratio = 0.3",
        "[structure.section]\nwidth_m = 0.012\nheight_m = 0.020\nshear_factor = 0.8333333333333334",
    ]
    for stop in range(stops, 0, -1):
        x = stop / stops
        gap = 1e-3 * deflection(x) / deflection(1.0) * (1.0 + 0.2 * (1.0 - x))
        lines.append(f'[[contact]]\nat_m = {0.6 * x!r}\ndirection = "transverse"\nside = "positive"\ngap_m = {gap:.5e}')
    lines.append(f'[method]\nkind = "ms-hbm"\nmode = 1\nharmonics = {harmonics}\n[continuation]\nmax_energy_ratio = {energy_ratio}')
    return "\n\n".join(lines) + "\n"


def deflection(x):
    """First mode of a cantilever of length one."""
    a, b = 1.8751040687, 0.7340955138
    return math.cosh(a * x) - math.cos(a * x) - b * (math.sinh(a * x) - math.sin(a * x))


def rod(**changes):
    return CONFIGS / "rod.toml", changes


def lattice(parameters, n=25):
    """Writes a lattice of n x n masses on springs before a stop at a corner, differentiated by so many entries of its stiffness."""

    def write(folder):
        k = {}
        for a in range(n * n):
            ends = ([a + 1] if (a + 1) % n else []) + ([a + n] if a + n < n * n else []) + ([None] if a < n else [])
            for j, b in enumerate(ends):
                s = 1e6 * (1.0 + 0.1 * math.sin(3.0 * a + j))
                k[a, a] = k.get((a, a), 0.0) + s
                if b is not None:
                    k[b, b] = k.get((b, b), 0.0) + s
                    k[b, a] = k.get((b, a), 0.0) - s
        for name, entries in {"k": k, "m": {(a, a): 0.01 for a in range(n * n)}}.items():
            lines = [f"{a + 1} {b + 1} {value!r}" for (a, b), value in entries.items()]
            head = f"%%MatrixMarket matrix coordinate real symmetric\n{n * n} {n * n} {len(lines)}\n"
            (folder / f"{name}.mtx").write_text(head + "\n".join(lines) + "\n")
        (folder / "dofs.csv").write_text("".join(f"{a},{a},uz\n" for a in range(1, n * n + 1)))
        rows = [f"k_{a + 1}_{b + 1},stiffness,{a + 1},uz,{b + 1},uz,1.0" for a, b in list(k)[:parameters]]
        head = "parameter,matrix,node,component,other_node,other_component,value\n"
        (folder / "entries.csv").write_text(head + "\n".join(rows) + "\n")
        asked = '[[sensitivity]]\nentries = "entries.csv"\n' if parameters else ""
        (folder / "lattice.toml").write_text(
            '[structure]\nkind = "matrices"\nstiffness = "k.mtx"\nmass = "m.mtx"\ndofs = "dofs.csv"\n'
            f"[[contact]]\nnode = {n * n}\nnormal = [0.0, 0.0, 1.0]\ngap_mm = 1.0\nstiffness_n_m = 1e6\n"
            f'[reduction]\nmodes = 30\n[output]\nfigures = false\npage = false\nstability = "never"\n{asked}'
        )
        return folder / "lattice.toml"

    return write


SCENES = {
    "rod.toml": rod(),
    "beam.toml": (CONFIGS / "beam.toml", {}),
    "beam_two_stops.toml": (CONFIGS / "beam_two_stops.toml", {}),
    "beam_ten_stops.toml": (CONFIGS / "beam_ten_stops.toml", {}),
    "20 stops on 200 elements, 3 harmonics": (cantilever(20, 200, 3, 3.0), {}),
    "100 stops on 200 elements, 3 harmonics": (cantilever(100, 200, 3, 1.05), {"continuation.max_points": 8}),
    "rod, 64 harmonics": rod(**{"method.harmonics": 64}),
    "rod of 10^4 elements, 20 harmonics": rod(**{"structure.elements": 10_000, "method.harmonics": 20}),
    "rod of 10^5 elements, 1 harmonic": rod(**{"structure.elements": 100_000, "method.harmonics": 1}),
    "rod of 10^6 elements, 1 harmonic": rod(**{"structure.elements": 1_000_000, "method.harmonics": 1}),
} | {
    f"lattice, {parameters} parameters, {ratio} grazing energies": (
        lattice(parameters),
        {"method.harmonics": 10, "continuation.max_energy_ratio": ratio},
    )
    for parameters in (0, 1, 1000)
    for ratio in (1.3, 40.0)
}


def measured(program, scene, changes, folder):
    """Least processor time of some runs, wall time of the computation, points, evaluations and end of the branch."""
    if callable(scene):
        scene = scene(folder)
    if isinstance(scene, str):
        path = folder / "scene.toml"
        path.write_text(scene)
        scene = path
    settings = [f"--set={key}={value}" for key, value in changes.items()]
    out, times, computation = folder / "out", [], []
    for _ in range(5):
        subprocess.run(["rm", "-rf", out], check=True)
        process = subprocess.Popen([program, "run", scene, "--quiet", "--out", out, *settings], stderr=subprocess.DEVNULL)
        _, status, used = os.wait4(process.pid, 0)
        times.append(used.ru_utime + used.ru_stime)
        summary = json.loads((out / "summary.json").read_text())
        computation.append(summary["wall_time_s"])
        if times[-1] > 1.0:
            break
    return min(times), min(computation), summary, used.ru_maxrss / 1024


def row(name, programs, folder):
    scene, changes = SCENES[name]
    now, computation, branch, memory = measured(programs[0], scene, changes, folder)
    points, evaluations = branch["points"], branch["evaluations"]
    cells = [name, points, f"{evaluations / points:.1f}", f"{1e3 * now:.0f}", f"{1e3 * computation:.1f}", f"{memory:.0f}"]
    if len(programs) > 1:
        before, _, other, _ = measured(programs[1], scene, changes, folder)
        cells += [other["points"], f"{1e3 * before:.0f}", f"{before / now:.1f}"]
    return cells


def main():
    options = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    options.add_argument("program")
    options.add_argument("--beside", metavar="PROGRAM")
    options.add_argument("--only", default="")
    options = options.parse_args()
    head = ["scene", "points", "evaluations a point", "process, ms", "computation, ms (wall)", "memory, MB"]
    head += ["points before", "process before, ms", "before over now"] if options.beside else []
    print("| " + " | ".join(head) + " |\n| --- |" + " ---: |" * (len(head) - 1))
    with tempfile.TemporaryDirectory() as folder:
        for name in (name for name in SCENES if options.only in name):
            cells = row(name, [program for program in (options.program, options.beside) if program], Path(folder))
            print("| " + " | ".join(str(cell) for cell in cells) + " |", flush=True)


if __name__ == "__main__":
    sys.exit(main())
