#!/usr/bin/env python3
"""Sensitivity of a frequency by SALib, which asks nlmodes for the cases that it wants.

    pip install SALib
    python3 configs/studies/sensitivity_salib.py

`study serve` answers a line of JSON for each case; what is there is not computed again, so a second call only reads.
"""

import json
import subprocess
import sys

import numpy as np
from SALib.analyze import rbd_fast
from SALib.sample import latin

STUDY = sys.argv[1] if len(sys.argv) > 1 else "configs/gap_study.toml"
PROGRAM = sys.argv[2] if len(sys.argv) > 2 else "nlmodes-cli"
PROBLEM = {
    "num_vars": 3,
    "names": ["gap_m", "other_gap_m", "modulus_pa"],
    "bounds": [[0.9e-3, 1.15e-3], [1.16e-3, 1.24e-3], [179e9, 184e9]],
}


def frequencies(points):
    """The quantity f_10mJ of each point, all of them asked for at once."""
    lines = [json.dumps({"id": k, "set": dict(zip(PROBLEM["names"], map(float, point)))}) for k, point in enumerate(points)]
    served = subprocess.run([PROGRAM, "study", "serve", STUDY], input="\n".join(lines), capture_output=True, text=True, check=True)
    answers = sorted(map(json.loads, served.stdout.splitlines()), key=lambda answer: answer["id"])
    for answer in answers:
        if answer["quantities"]["f_10mJ"] is None:
            sys.exit(f"case {answer['id']}: {answer['reason']}")
    return [answer["quantities"]["f_10mJ"] for answer in answers]


points = latin.sample(PROBLEM, 128, seed=1)
found = rbd_fast.analyze(PROBLEM, points, np.array(frequencies(points)), seed=1)
for name, index, confidence in zip(PROBLEM["names"], found["S1"], found["S1_conf"]):
    print(f"{name:14} {index:6.3f} ± {confidence:.3f}")
