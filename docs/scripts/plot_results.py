"""Frequency over energy with its events (Fig. 3 b of Peter et al. 2019), and the contact forces of one period.

    python plot_results.py results/rod/results.mat [POINT]

The file comes from a run with `[output] matlab = true`; POINT is one of `output.histories` or of the figures, by default the last of them.
Needs NumPy, SciPy and Matplotlib; writes frequency_energy.png and contact_forces.png beside the file.
"""

import pathlib
import sys

import numpy as np
from matplotlib import pyplot
from scipy.io import loadmat

file = pathlib.Path(sys.argv[1])
results = loadmat(file, simplify_cells=True)
branch, histories = results["branch"], results["histories"]

figure, axes = pyplot.subplots()
axes.semilogx(branch["energy_j"], branch["frequency_hz"])
happened = np.array([len(event) > 0 for event in branch["event"]])
axes.semilogx(branch["energy_j"][happened], branch["frequency_hz"][happened], "o", fillstyle="none")
axes.set(xlabel="averaged kinetic energy in J", ylabel="frequency in Hz")
figure.savefig(file.with_name("frequency_energy.png"))

points = np.atleast_1d(histories["point"])
row = len(points) - 1 if len(sys.argv) < 3 else list(points).index(float(sys.argv[2]))
shape = (len(points), np.size(histories["stop_m"]), -1)
figure, axes = pyplot.subplots()
axes.plot(1e3 * histories["time_s"].reshape(len(points), -1)[row], histories["force_n"].reshape(shape)[row].T)
axes.set(xlabel="time in ms", ylabel="contact force in N", title=f"point {points[row]:.0f}")
figure.savefig(file.with_name("contact_forces.png"))
