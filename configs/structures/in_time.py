#!/usr/bin/env python3
"""Goes through one period of points of a branch again, with the full model of a scene integrated in time (needs NumPy and SciPy).

    python3 configs/structures/in_time.py SCENE.toml RESULTS POINT [POINT ...]

For scenes of matrices with one contact of one node before a wall. Nothing of nlmodes is used but the shapes' coefficients of the point: all degrees of
freedom move, the touching node with its mass, by the midpoint rule with 4000 steps a period, and the contact is one of velocities without rebound
(J. J. Moreau). The motion starts half a period from the contact, where everything is at rest, and should be back after the period.
"""

import csv
import gzip
import pathlib
import sys
import tomllib

import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg as sl

STEPS = 4000


def matrix(path):
    """.npz of SciPy, or the lines `row column value` of a triangle that CalculiX writes, packed or not."""
    if path.suffix == ".npz":
        return sp.load_npz(path).tocsc()
    rows = np.loadtxt(gzip.open(path) if path.suffix == ".gz" else path)
    i, j, v = rows[:, 0].astype(int) - 1, rows[:, 1].astype(int) - 1, rows[:, 2]
    off, n = i != j, 1 + max(i.max(), j.max()).astype(int)
    return sp.coo_matrix((np.r_[v, v[off]], (np.r_[i, j[off]], np.r_[j, i[off]])), (n, n)).tocsc()


def labels(path):
    """Node and direction, 1 to 3, of each row."""
    lines = path.read_text().split()
    if path.suffix == ".dof":
        return [tuple(map(int, line.split("."))) for line in lines]
    return [tuple(map(int, line.split(",")[1:3])) for line in lines]


def node_of(scene, contact):
    """The node of `node`, or the only one of a set of the mesh."""
    if "node" in contact:
        return contact["node"]
    text = (scene.parent / tomllib.loads(scene.read_text())["structure"]["mesh"]).read_text()
    block = text.upper().split(f"*NSET,NSET={contact['nodes'].upper()}")[1].split("*")[0]
    return int(block.replace(",", " ").split()[0])


def main(scene, results, points):
    table = tomllib.loads(scene.read_text())
    structure, contact = table["structure"], table["contact"][0]
    unit = {"m-kg-s": 1.0, "mm-t-s": 1e3}[structure.get("units", "m-kg-s")]
    stiffness, mass = (unit * matrix(scene.parent / structure[key]) for key in ("stiffness", "mass"))
    normal, node, gap = np.array(contact["normal"]), node_of(scene, contact), contact["gap_m"]
    w = np.zeros(stiffness.shape[0])
    for row, (of, direction) in enumerate(labels(scene.parent / structure["dofs"])):
        if of == node:
            w[row] = -normal[direction - 1] / np.linalg.norm(normal)
    found = np.load(results / "harmonics.npz")
    modes = [str(kind) for kind in found["dof_kind"]].count("modal")
    squares, shapes = sl.eigsh(stiffness, k=modes, M=mass, sigma=0, tol=1e-12)
    shapes = shapes[:, np.argsort(squares)]
    shapes *= np.sign(shapes[np.abs(shapes).argmax(0), range(modes)])
    computed = list(csv.DictReader((results / "branch.csv").open()))
    for point in points:
        coefficients, period = found["coefficients"][point][:modes], 2 * np.pi / found["omega"][point]
        start = shapes @ (coefficients.real * np.cos(np.pi * np.arange(coefficients.shape[1]))).sum(1)
        assert gap + w @ start > 0, "the contact is closed half a period from the largest displacement"
        h = period / STEPS
        factor = sl.splu((mass + 0.25 * h * h * stiffness).tocsc())
        pushed = factor.solve(w)
        x, v, closed, impulse = start.copy(), np.zeros_like(start), 0, 0.0
        for _ in range(STEPS):
            free = factor.solve(mass @ v - 0.25 * h * h * (stiffness @ v) - h * (stiffness @ x))
            touches = gap + w @ x + 0.5 * h * (w @ v) <= 0
            push = max(0.0, -(w @ free) / (w @ pushed)) if touches else 0.0
            after = free + push * pushed
            x, v = x + 0.5 * h * (v + after), after
            closed, impulse = closed + (push > 0), impulse + push
        whole = 0.5 * start @ (stiffness @ start)
        back = np.linalg.norm(x - start) / np.linalg.norm(start)
        lost = 1 - 0.5 * (x @ (stiffness @ x) + v @ (mass @ v)) / whole
        print(
            f"point {point}: {1 / period:.6f} Hz; back to {back:.2e} of the displacement, {lost:.1e} of the energy lost; closed "
            f"{closed / STEPS:.4f} of the period ({float(computed[point]['contact_fraction']):.4f} computed), mean force {impulse / period:.4f} N"
        )


if __name__ == "__main__":
    main(pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2]), [int(point) for point in sys.argv[3:]])
