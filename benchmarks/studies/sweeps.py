#!/usr/bin/env python3
"""Jumps of random responses beside those of their own slow sweeps in time (`[response] sweep = true`).

    python3 benchmarks/studies/sweeps.py PROGRAM [--count 10] [--seed 1] [--slow 4]

Rods of random damping before an elastic stop, or with a cubic spring, under a random force; sweeps take `--slow` times as long as by default. A row a jump: its
frequency on the curve, that of the sweep, and by how much the sweep is later, relative to it.
"""

import argparse
import json
import math
import pathlib
import random
import subprocess
import tempfile

SCENE = """[structure]
kind = "rod"
length_m = 1.0
elements = 4
start = "clamped"
material = {{ youngs_modulus_pa = 1.0, density_kg_m3 = 1.0 }}
section = {{ area_m2 = 1.0 }}
{law}
[damping]
ratio = {ratio}
[reduction]
modes = 2
[[force]]
at_m = 0.5
direction = "axial"
[[response]]
kind = "frequency"
frequency_hz = [{low}, {high}]
levels_n = [{level}]
sweep = true
sweep_s = {length}
[method]
harmonics = {harmonics}
[output]
figures = false
page = false
"""


def scene(draw, slow):
    ratio = draw.uniform(0.01, 0.03)
    # The first mode of the rod: 0.25 Hz.
    low, high, first = 0.24, 0.36, 0.25
    if draw.random() < 0.5:
        stiffness = draw.uniform(1.0, 4.0)
        law = f'[[contact]]\nat_m = 1.0\ndirection = "axial"\nside = "positive"\ngap_m = 1.0\nstiffness_n_m = {stiffness}'
        level, kind = ratio * draw.uniform(2.5, 4.0), f"stop of {stiffness:.2f} N/m"
    else:
        law = '[[spring]]\nat_m = 1.0\ndirection = "axial"\nlaw = { polynomial = [0.0, 0.0, 0.3] }'
        level, kind = ratio * draw.uniform(2.5, 4.0), "cubic spring"
    length = slow * (high - low) / (0.25 * (2 * ratio * first) ** 2)
    return kind, SCENE.format(law=law, ratio=ratio, low=low, high=high, level=level, length=length, harmonics=9)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program", type=lambda path: str(pathlib.Path(path).resolve()))
    parser.add_argument("--count", type=int, default=10)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--slow", type=float, default=4.0)
    words = parser.parse_args()
    draw = random.Random(words.seed)
    print("| system | sweep | jump of the curve, Hz | of the sweep, Hz | later by |\n| --- | --- | ---: | ---: | ---: |", flush=True)
    for number in range(words.count):
        kind, text = scene(draw, words.slow)
        with tempfile.TemporaryDirectory() as folder:
            (pathlib.Path(folder) / "scene.toml").write_text(text)
            done = subprocess.run([words.program, "run", "scene.toml", "--out", "out", "--quiet"], cwd=folder, capture_output=True, text=True)
            if done.returncode:
                print(f"| {number}: {kind} | | | | {done.stderr.strip().splitlines()[-1]} |", flush=True)
                continue
            jumps = json.loads((pathlib.Path(folder) / "out/summary.json").read_text())["levels"][0]["jumps"]
        if not jumps:
            print(f"| {number}: {kind} | no jump | | | |", flush=True)
        for jump in jumps:
            curve, swept = jump["frequency_hz"], jump.get("swept_frequency_hz", math.nan) or math.nan
            late = (swept / curve - 1.0) * (1.0 if jump["direction"] == "up" else -1.0)
            print(f"| {number}: {kind} | {jump['direction']} | {curve:.5f} | {swept:.5f} | {100 * late:.2f} % |", flush=True)


if __name__ == "__main__":
    main()
