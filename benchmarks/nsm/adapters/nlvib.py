#!/usr/bin/env python3
"""Answers of NLvib in GNU Octave (needs NumPy, SciPy, Octave and NLvib, whose folder is given).

    python3 benchmarks/nsm/adapters/nlvib.py NLVIB OUT.json [--harmonics 21] [--samples 48] [01 02 ...]

Samples a period are a power of two, at least so many times the harmonics. Rigid stops before coordinates without mass
are given as the elastic stops that they are to the others. Motions that do not begin at grazing, subharmonic ones and
multipliers are not asked of it.
"""

import argparse
import json
import math
import pathlib
import subprocess
import tempfile

import numpy as np
from common import grazing, mode_number, problems, system_of, write
from scipy.io import savemat
from system import Stop, System

WINDOWS = {"22": (0.7, 1.6), "23": (0.7, 1.8), "24": (0.8, 0.55), "26": (1.6, 2.3), "29": (0.8, 0.7), "28": (0.8, 1.8)}


def inputs(problem, case, words):
    """What `nlvib_case.m` reads, or the reason why there is nothing to compute."""
    if problem["kind"] in ("impact", "bar", "subharmonic"):
        return "not computed"
    if "doubling" in case["branch"]:
        return "not computed"
    system, heavy = system_of(problem)
    if system.n == 1 and any(s.direction[0] != 1.0 for s in system.stops):
        system = with_second(system)
    given = {
        "M": system.mass,
        "C": system.damping,
        "K": system.stiffness,
        "force": system.force,
        "ds": words.ds,
        "samples": words.samples,
        "harmonics": words.harmonics,
        "directions": np.array([s.direction for s in system.stops]).T,
        "is_free": float("load" not in problem),
        "gaps": np.array([s.gap for s in system.stops], dtype=float),
        "stiffnesses": np.array([s.stiffness for s in system.stops], dtype=float),
    }
    if "load" in problem:
        begins, ends = WINDOWS[problem["id"]]
        drive = heavy.index(int(np.flatnonzero(problem["load"]["vector"])[0]))
        near = list(case["near"].values())[0]
        fold = "fold" in case["branch"]
        return {
            **given,
            "begins": begins,
            "ends": ends,
            "drive": drive + 1.0,
            "near": near,
            "asks_fold": float(fold),
            "asks_lag": float(problem["kind"] == "phase-resonance"),
            "omega": case["at"].get("frequency", 0.0),
        }
    begin = grazing(system, mode_number(case))
    if not begin:
        return "not tried: there is no linear mode to begin from"
    ref = int(np.argmax(np.abs(begin[1])))
    return {
        **given,
        "omega": begin[0],
        "shape": begin[1],
        "grazing_energy": begin[3],
        "energy": case["at"]["mean_kinetic_energy"],
        "ref": ref + 1.0,
    }


def with_second(system):
    """The same with a second coordinate that is not connected: with one coordinate NLvib takes all directions of forces
    as 1."""
    pair = lambda matrix, share: np.diag([matrix[0, 0], share * matrix[0, 0]])
    stops = [Stop(np.array([s.direction[0], 0.0]), s.gap, s.stiffness) for s in system.stops]
    return System(
        pair(system.mass, 1.0),
        pair(system.stiffness, 7.3),
        pair(system.damping, 1.0),
        np.append(system.force, 0.0),
        stops,
    )


def answer(problem, case, words, folder):
    given = inputs(problem, case, words)
    if isinstance(given, str):
        return {"note": given}
    savemat(folder / "case.mat", given)
    out = folder / "out.json"
    here = pathlib.Path(__file__).resolve().parent
    call = f"warning('off', 'all'); addpath('{here}'); nlvib_case('{words.nlvib}', '{folder / 'case.mat'}', '{out}')"
    try:
        ended = subprocess.run(
            ["octave-cli", "--no-init-file", "--quiet", "--eval", call],
            capture_output=True,
            text=True,
            timeout=words.timeout,
        )
    except subprocess.TimeoutExpired:
        return {"note": f"not within {words.timeout} s"}
    if not out.exists():
        said = [line for line in ended.stderr.splitlines() if line.startswith("error:")] or ["nothing was said"]
        return {"note": "lost the branch: " + said[0].removeprefix("error: ")[:80]}
    found = json.loads(out.read_text())
    values = {"frequency": found.get("frequency"), "damping_ratio": found.get("damping_ratio")}
    impulses = found.get("impulses", [])
    for j, value in enumerate(impulses if isinstance(impulses, list) else [impulses]):
        values[f"impulse[{j}]"] = value
    for a in case["asked"]:
        if a["name"].startswith("amplitude"):
            values[a["name"]] = found.get("amplitude")
    got = {a["name"]: values[a["name"]] for a in case["asked"] if values.get(a["name"]) is not None}
    return (
        {**got, "cpu_s": round(found["cpu_s"], 3)}
        if all(map(math.isfinite, got.values())) and got
        else {"note": "no number"}
    )


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("nlvib")
    parser.add_argument("out")
    parser.add_argument("numbers", nargs="*")
    parser.add_argument("--harmonics", type=int, default=21)
    parser.add_argument("--samples", type=int, default=48)
    parser.add_argument("--ds", type=float, default=0.003)
    parser.add_argument("--timeout", type=float, default=300.0)
    words = parser.parse_args()
    answers, samples = {}, 2 ** math.ceil(math.log2(words.samples * words.harmonics))
    for problem in problems(words.numbers):
        for case in problem["cases"]:
            with tempfile.TemporaryDirectory() as place:
                answers[case["case"]] = answer(problem, case, words, pathlib.Path(place))
            print(case["case"], answers[case["case"]], flush=True)
            write(words.out, "NLvib 1.3", f"{words.harmonics} harmonics, {samples} samples", answers)


if __name__ == "__main__":
    main()
