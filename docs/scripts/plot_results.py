"""Frequency over energy as in Fig. 3 b of Peter et al. 2019 and in the figure of the run, and the contact forces of one period.

    python plot_results.py results/rod/results.mat [POINT]

The file comes from a run with `[output] matlab = true`; POINT is one of `output.histories` or of the figures, by default the last of them.
Needs NumPy, SciPy and Matplotlib; writes frequency_energy.png and contact_forces.png beside the file.
"""

import pathlib
import sys

import numpy as np
from matplotlib import pyplot, ticker
from scipy.interpolate import PchipInterpolator
from scipy.io import loadmat

CORNERS = {"kink", "contact-change", "branch-point"}
MARKERS = "o^sDvP*Xp<>h"


def smooth(x, y, corners):
    """The curve through the points, smooth but where it may turn, over its length in the figure."""
    place = np.column_stack([np.log(x) / np.ptp(np.log(x)), y / (np.ptp(y) or 1.0)])
    length = np.concatenate([[0.0], np.cumsum(np.maximum(np.hypot(*np.diff(place, axis=0).T), 1e-12))])
    ends = [0, *[k for k in corners if 0 < k < len(x) - 1], len(x) - 1]
    pieces = []
    for start, end in zip(ends[:-1], ends[1:]):
        own = slice(start, end + 1)
        fine = np.linspace(length[start], length[end], 20 * (end - start) + 1)
        pieces.append([np.exp(PchipInterpolator(length[own], np.log(x[own]))(fine)), PchipInterpolator(length[own], y[own])(fine)])
    return np.hstack(pieces)


file = pathlib.Path(sys.argv[1])
results = loadmat(file, simplify_cells=True)
branch, histories = results["branch"], results["histories"]
energy, frequency = branch["energy_j"], branch["frequency_hz"]
events = [str(names).split() if len(names) else [] for names in branch["event"]]

figure, axes = pyplot.subplots(layout="constrained")
resumed = [k for k, names in enumerate(events) if "resumed" in names]
for first, last in zip([0, *resumed], [*resumed, len(energy)]):
    own = slice(first, last)
    corners = [k - first for k in range(first, last) if CORNERS & set(events[k])]
    curve = smooth(energy[own], frequency[own], corners) if last - first > 2 else (energy[own], frequency[own])
    axes.semilogx(*curve, color="#0072b2", label="branch" if first == 0 else None)
left, right = np.exp(np.log([energy.min(), energy.max()]) + np.ptp(np.log(energy)) * np.array([-0.15, 0.05]))
grazing = [k for k in (0, len(energy) - 1) if "grazing" in events[k]]
if grazing:
    axes.semilogx([left, energy[grazing[0]]], [frequency[grazing[0]]] * 2, "--", color="#0072b2", label="linear mode")
for marker, name in zip(MARKERS * 4, dict.fromkeys(name for names in events for name in names)):
    at = [k for k, names in enumerate(events) if name in names]
    axes.semilogx(energy[at], frequency[at], marker, fillstyle="none", label=name.replace("-", " "))
axes.set(xlabel="averaged kinetic energy in J", ylabel="frequency in Hz", xlim=(left, right))
if right / left < 30:
    # Less than two decades: numbers in between.
    axes.xaxis.set_major_locator(ticker.MaxNLocator(6))
    axes.xaxis.set_major_formatter(ticker.ScalarFormatter())
    axes.xaxis.set_minor_locator(ticker.NullLocator())
axes.ticklabel_format(axis="y", useOffset=False)
axes.grid(alpha=0.4)
axes.legend()
figure.savefig(file.with_name("frequency_energy.png"), dpi=150)

points = np.atleast_1d(histories["point"])
row = len(points) - 1 if len(sys.argv) < 3 else list(points).index(float(sys.argv[2]))
shape = (len(points), np.size(histories["stop_m"]), -1)
figure, axes = pyplot.subplots(layout="constrained")
lines = axes.plot(1e3 * histories["time_s"].reshape(len(points), -1)[row], histories["force_n"].reshape(shape)[row].T)
axes.legend(lines, [f"stop {stop}" for stop in range(len(lines))])
axes.set(xlabel="time in ms", ylabel="contact force in N", title=f"point {points[row]:.0f}, {frequency[int(points[row])]:.4f} Hz")
axes.grid(alpha=0.4)
figure.savefig(file.with_name("contact_forces.png"), dpi=150)
