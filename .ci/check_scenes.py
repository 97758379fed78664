"""Checks the results of the scenes against numbers that do not come from this program."""

import csv
import json
import pathlib
import sys
import xml.dom.minidom

FIGURES = ["frequency_energy", "frequency_amplitude", "motion_1", "history_P1", "history_P2"]


def near(what, found, expected, tolerance):
    print(f"  {what}: {found:.10g} (expected {expected:.10g} within {tolerance:g})")
    if not abs(found - expected) <= tolerance:
        sys.exit(f"{what} is {found}, not {expected} within {tolerance}")


def read(folder):
    rows = list(csv.DictReader((folder / "branch.csv").open()))
    for name in FIGURES:
        xml.dom.minidom.parse(str(folder / f"{name}.svg"))
    for row in rows:
        if not float(row["residual"]) < 1e-10:
            sys.exit(f"{folder}: residual {row['residual']} at point {row['point']}")
    return rows, json.loads((folder / "summary.json").read_text())


def value(row, key):
    return float(row[key])


def rod(folder):
    """Section 3: the loop of the 3:1 internal resonance, there and back."""
    rows, summary = read(folder)
    grazing = value(rows[0], "energy_j")
    near("rod, linear mode, Hz", value(rows[0], "frequency_hz"), 60.78660727, 1e-8)
    near("rod, grazing energy, J", grazing, 8.15055344e8, 1.0)
    tip = next(row for row in rows if "branch-point" in row["event"])
    near("rod, tip of the loop, Hz", value(tip, "frequency_hz"), 182.37496593 / 3, 1e-6)
    near("rod, tip of the loop, grazing energies", value(tip, "energy_j") / grazing, 9.0005, 1e-3)
    back = min(value(row, "energy_j") for row in rows[rows.index(tip) :])
    near("rod, end of the loop, grazing energies", back / grazing, 0.9, 0.02)
    near("rod, last frequency, Hz", value(rows[-1], "frequency_hz"), 66.5, 1e-9)
    if summary["end"]["reason"] != "frequency-window":
        sys.exit(f"rod ended by {summary['end']}")


def beam(folder):
    """Section 4: the first mode's backbone, smooth up to six times the grazing energy."""
    rows, summary = read(folder)
    near("beam, linear mode, Hz", value(rows[0], "frequency_hz"), 40.10, 0.005)
    near("beam, last frequency, Hz", value(rows[-1], "frequency_hz"), 52.1, 0.05)
    near("beam, last energy, grazing energies", value(rows[-1], "energy_j") / value(rows[0], "energy_j"), 6.0, 1e-9)
    frequencies = [value(row, "frequency_hz") for row in rows]
    if frequencies != sorted(frequencies):
        sys.exit("beam: the frequency does not rise along the branch")
    if summary["end"]["reason"] != "max-energy":
        sys.exit(f"beam ended by {summary['end']}")


def beam_hbm(folder):
    """Section 5: the same beam by conventional harmonic balance, against an independent program."""
    rows, summary = read(folder)
    near("beam, HBM, linear mode, Hz", value(rows[0], "frequency_hz"), 40.10, 0.005)
    near("beam, HBM, last frequency, Hz", value(rows[-1], "frequency_hz"), 51.39347204, 1e-6)
    if summary["end"]["reason"] != "max-energy":
        sys.exit(f"beam, HBM ended by {summary['end']}")


if __name__ == "__main__":
    rod(pathlib.Path(sys.argv[1]) / "rod")
    beam(pathlib.Path(sys.argv[1]) / "beam")
    beam_hbm(pathlib.Path(sys.argv[1]) / "beam_hbm")
    print("scenes as expected")
