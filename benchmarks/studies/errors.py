#!/usr/bin/env python3
"""Errors that runs state beside their numbers, against the same scenes with two and four times the harmonics.

    benchmarks/studies/errors.py --program target/release/nlmodes-cli --scenes 200 --out results/errors

The scenes are those of stability.py: rods, beams, chains and lattices with one to five stops, as conservative modes and
as responses. Of a mode, the point at which the run says most of what too few harmonics do to a number is sought on the
finer branch at the same energy (the nearest frequency where there are several), for frequency, displacement, impulse
and largest force; of a response, amplitude and frequency of the peak and the frequencies of the jumps. Each stated error is compared with the
difference to four times the harmonics, where twice as many are nearer to those than half of it: else nothing has
converged, and the finer computation is no reference.
Needs Python 3.11, NumPy and SciPy.
"""

import argparse
import csv
import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np

from stability import Scene

COLUMNS = {"frequency": "frequency_hz", "displacement": "peak_m", "impulse": "impulse_ns",
           "peak_force": "peak_contact_force_n"}
#: Relative differences that count as none: of tables with their digits, of solutions with their tolerance.
NOTHING = 1e-7
#: Largest difference of the modal amplitudes of two motions that are the same at one energy.
SAME = 0.05


def run(program, scene, times, limit, keep):
    """Summary and rows with so many times the harmonics; None where there are none."""
    out = scene.path.with_name(f"{scene.name}_x{times}")
    settings = [f"method.harmonics={times * scene.harmonics}", 'output.stability="never"']
    if times > 1 and not scene.forced:
        settings.append("continuation.max_energy_ratio=3.3")
    if keep and (out / "summary.json").exists():
        program, limit = "true", 5
    try:
        subprocess.run([program, "run", scene.path, "--out", out, "--quiet", "--force",
                        *(word for setting in settings for word in ("--set", setting))],
                       capture_output=True, timeout=limit, env={**os.environ, "RAYON_NUM_THREADS": "1"})
    except subprocess.TimeoutExpired:
        return None
    if not (out / "summary.json").exists():
        return None
    with open(out / "branch.csv", newline="") as rows:
        return json.loads((out / "summary.json").read_text()), list(csv.DictReader(rows))


def at_energy(rows, energy, near):
    """Quantities of a branch at an energy, where the frequency is nearest; None beyond its ends."""
    columns = {**COLUMNS, "amplitude": "modal_amplitude"}
    values = {name: np.array([float(row[column] or "nan") for row in rows]) for name, column in columns.items()}
    e = np.log([float(row["energy_j"]) for row in rows])
    best = None
    for i in range(len(e) - 1):
        low, high = sorted((e[i], e[i + 1]))
        if not low <= np.log(energy) <= high or low == high:
            continue
        share = (np.log(energy) - e[i]) / (e[i + 1] - e[i])
        found = {name: column[i] + share * (column[i + 1] - column[i]) for name, column in values.items()}
        if best is None or abs(found["frequency"] - near) < abs(best["frequency"] - near):
            best = found
    return best


def off(a, b):
    return abs(a - b) / abs(b) if b else float("nan")


def of_mode(runs):
    """What a run says that too few harmonics do to each number, and the difference to four times as many, at the point
    where the run says it; errors of the mesh and of modes left out are the same in all three runs."""
    summary, rows = runs[0]
    out = []
    for check in summary["certificate"]["checks"]:
        name = check.get("number")
        if check["name"] != "harmonics" or name not in COLUMNS or "point" not in check:
            continue
        row, error = rows[int(check["point"])], float("nan")
        own = float(row[COLUMNS[name]] or "nan")
        twice, four = (at_energy(finer, float(row["energy_j"]), float(row["frequency_hz"])) for _, finer in runs[1:])
        # With more harmonics a branch may leave for an internal resonance: that is another motion.
        if all(other and off(float(row["modal_amplitude"]), other["amplitude"]) <= SAME for other in (twice, four)):
            error = sure(off(own, twice[name]), off(own, four[name]), off(twice[name], four[name]))
        out.append((name, check["value"], error))
    return out


def of_response(runs):
    levels = [summary["levels"][0] if summary.get("levels") else None for summary, _ in runs]
    if any(level is None for level in levels):
        return []
    out = []
    peaks = [level["peak"] for level in levels]
    if all(peaks) and peaks[0].get("amplitude_error") is not None:
        a = [peak["amplitude_m"] for peak in peaks]
        error = sure(off(a[0], a[1]), off(a[0], a[2]), off(a[1], a[2]))
        out.append(("peak amplitude", peaks[0]["amplitude_error"], error))
    for jump in levels[0]["jumps"]:
        if jump.get("frequency_error") is None:
            continue
        near = []
        for level in levels[1:]:
            same = [other["frequency_hz"] for other in level["jumps"] if other["direction"] == jump["direction"]]
            near.append(min(same, key=lambda hz: off(hz, jump["frequency_hz"]), default=float("nan")))
        error = sure(off(jump["frequency_hz"], near[0]), off(jump["frequency_hz"], near[1]), off(*near))
        out.append(("jump", jump["frequency_error"], error))
    return out


def sure(twice, four, between):
    """The difference to four times the harmonics, unless twice as many are farther from those than half of it."""
    return four if between <= 0.5 * max(four, NOTHING) else float("nan")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default="target/release/nlmodes-cli")
    parser.add_argument("--scenes", type=int, default=200)
    parser.add_argument("--first", type=int, default=1000, help="first seed")
    parser.add_argument("--limit-s", type=float, default=30.0, help="longest time of a run, s")
    parser.add_argument("--most-harmonics", type=int, default=15, help="scenes with more are left out")
    parser.add_argument("--keep", action="store_true", help="take runs that are there already")
    parser.add_argument("--only", choices=["modes", "responses"])
    parser.add_argument("--out", type=Path, default=Path("results/errors"))
    arguments = parser.parse_args()
    arguments.out.mkdir(parents=True, exist_ok=True)
    rows, done = [], 0
    seed = arguments.first
    while done < arguments.scenes:
        forced = seed % 2 == 1 if arguments.only is None else arguments.only == "responses"
        scene = Scene(seed, arguments.out, forced)
        seed += 1
        if scene.harmonics > arguments.most_harmonics:
            continue
        done += 1
        runs = []
        for times in (1, 2, 4):
            runs.append(run(arguments.program, scene, times, arguments.limit_s, arguments.keep))
            if runs[-1] is None:
                break
        if runs[-1] is None:
            print(f"{scene.name}: no results with {2 ** (len(runs) - 1)} times the harmonics", flush=True)
            continue
        for name, stated, error in (of_response if forced else of_mode)(runs):
            rows.append({"scene": scene.name, "elastic": scene.elastic, "harmonics": scene.harmonics, "number": name,
                         "stated": stated, "error": error})
            print(rows[-1], flush=True)
    (arguments.out / "rows.json").write_text(json.dumps(rows, indent=1))
    for name in dict.fromkeys(row["number"] for row in rows):
        of = [row for row in rows if row["number"] == name and row["stated"] is not None]
        known = [row for row in of if np.isfinite(row["error"])]
        within = [row["error"] <= 3 * max(row["stated"], NOTHING) for row in known]
        both = [ok and row["stated"] <= 3 * max(row["error"], NOTHING) for ok, row in zip(within, known)]
        print(f"{name}: {len(of)}, {len(known)} with a reference; at most three times too small {np.mean(within):.2f}, "
              f"within a factor of three on both sides {np.mean(both):.2f}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
