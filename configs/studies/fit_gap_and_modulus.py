#!/usr/bin/env python3
"""Gap and Young's modulus from measured modal points: least squares by SciPy, which asks nlmodes for the branches.

    pip install scipy
    python3 configs/studies/fit_gap_and_modulus.py

The modal points below are frequencies at the modal amplitudes of configs/studies/fit.toml. They were made with a gap of 1.10 mm and
183.0 GPa, rounded to 1 mHz: the fit has to find these.
"""

import json
import subprocess
import sys

from scipy.optimize import least_squares

STUDY = sys.argv[1] if len(sys.argv) > 1 else "configs/studies/fit.toml"
PROGRAM = sys.argv[2] if len(sys.argv) > 2 else "nlmodes-cli"
MEASURED_HZ = [44.574, 47.166, 50.159]
NAMES = ["gap_m", "modulus_pa"]
SCALES = [1e-3, 200e9]

served = subprocess.Popen([PROGRAM, "study", "serve", STUDY], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
calls = 0


def residuals(scaled):
    """Computed minus measured frequencies, Hz."""
    global calls
    calls += 1
    values = {name: float(x * scale) for name, x, scale in zip(NAMES, scaled, SCALES)}
    served.stdin.write(json.dumps({"set": values}) + "\n")
    served.stdin.flush()
    answer = json.loads(served.stdout.readline())
    if None in answer["quantities"].values():
        sys.exit(f"{values}: {answer['reason']}")
    return [answer["quantities"][f"f_{k + 1}"] - hz for k, hz in enumerate(MEASURED_HZ)]


start = [1.03e-3 / SCALES[0], 181.36e9 / SCALES[1]]
found = least_squares(residuals, start, diff_step=1e-4)
served.stdin.close()
served.wait()
gap, modulus = (x * scale for x, scale in zip(found.x, SCALES))
print(f"gap {gap * 1e3:.4f} mm, modulus {modulus * 1e-9:.3f} GPa, {calls} branches")
