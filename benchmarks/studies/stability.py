#!/usr/bin/env python3
"""Stability that runs state against monodromy matrices of an own time integration, at random points in contact.

    benchmarks/studies/stability.py --program target/release/nlmodes-cli --points 300 --out results/stability

Rods, beams, chains and lattices with one to five stops, rigid and elastic, as conservative modes and as responses with
damping. The matrices are assembled here and reduced here to as many free-interface modes as the run took and the static
flexibility that is left. From the state of a point the motion is integrated from contact to contact (each instant by
root finding on the gaps and forces), Newton's method finds the periodic motion next to it, and the product of the
exponentials is its monodromy matrix. A point counts where that motion is shown to be its own: the fundamental of the
first contact within 1 %. `--check` compares the integration with that of SciPy (DOP853 with the contact forces
from the complementarity at each stage).
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
import scipy.linalg as sl
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

#: Largest relative difference of the fundamentals of two motions that are the same.
SAME = 1e-2
#: Cells in which changes of contact are sought at once.
CELLS = 32
#: A conservative motion is stable up to this distance of its multipliers from the unit circle, and unstable beyond the
#: second; what lies between is not judged here. The double multiplier +1 splits by the root of rounding.
ON_CIRCLE, OFF_CIRCLE = 1e-5, 1e-4


class Structure:
    """`K`, `M` of the free degrees of freedom, and what the scene calls it."""

    def __init__(self, kind, stiffness, mass, lines, places):
        self.kind, self.stiffness, self.mass, self.lines, self.places = kind, stiffness, mass, lines, places
        self.modes = None


def rod(rng):
    elements, length, young, density, area = int(rng.integers(8, 31)), 2.0, 70e9, 2700.0, 4e-4
    end = rng.choice(["free", "clamped"])
    h = length / elements
    nodes = elements + 1
    stiffness, mass = np.zeros((nodes, nodes)), np.zeros((nodes, nodes))
    for e in range(elements):
        two = np.ix_([e, e + 1], [e, e + 1])
        stiffness[two] += young * area / h * np.array([[1, -1], [-1, 1]])
        mass[two] += density * area * h / 6 * np.array([[2, 1], [1, 2]])
    last = nodes if end == "free" else nodes - 1
    lines = ["[structure]", 'kind = "rod"', f"length_m = {length}", f"elements = {elements}", 'start = "clamped"',
             f'end = "{end}"', "[structure.material]", f"youngs_modulus_pa = {young}", f"density_kg_m3 = {density}",
             "[structure.section]", f"area_m2 = {area}"]

    def place(dof):
        return [f"at_m = {(dof + 1) * h!r}", 'direction = "axial"']

    free = slice(1, last)
    return Structure("rod", stiffness[free, free], mass[free, free], lines, [place(i) for i in range(last - 1)])


def matrices(kind, stiffness, mass, dofs, folder, name, movable):
    """A structure of files: rows of its degrees of freedom as (node, component)."""
    for file, matrix in (("K", stiffness), ("M", mass)):
        rows, columns = np.nonzero(matrix)
        with open(folder / f"{name}_{file}.mtx", "w") as out:
            n = len(matrix)
            out.write(f"%%MatrixMarket matrix coordinate real general\n{n} {n} {len(rows)}\n")
            out.writelines(f"{i + 1} {j + 1} {matrix[i, j]:.17g}\n" for i, j in zip(rows, columns))
    text = "row,node,component\n" + "".join(f"{i},{node},{component}\n" for i, (node, component) in enumerate(dofs))
    (folder / f"{name}_dofs.csv").write_text(text)
    lines = ["[structure]", 'kind = "matrices"', f'stiffness = "{name}_K.mtx"', f'mass = "{name}_M.mtx"',
             f'dofs = "{name}_dofs.csv"', 'units = "m-kg-s"']
    places = [[f"node = {node}", "normal = [0.0, 0.0, 1.0]"] if i in movable else None
              for i, (node, _) in enumerate(dofs)]
    return Structure(kind, stiffness, mass, lines, places)


def beam(rng, folder, name):
    """An Euler-Bernoulli cantilever."""
    elements, length, ei, mass_per_m = int(rng.integers(6, 16)), 0.6, 210e9 * 0.012 * 0.02**3 / 12, 7850 * 0.012 * 0.02
    h = length / elements
    n = 2 * (elements + 1)
    stiffness, mass = np.zeros((n, n)), np.zeros((n, n))
    k = ei / h**3 * np.array([[12, 6 * h, -12, 6 * h], [6 * h, 4 * h * h, -6 * h, 2 * h * h],
                              [-12, -6 * h, 12, -6 * h], [6 * h, 2 * h * h, -6 * h, 4 * h * h]])
    m = mass_per_m * h / 420 * np.array([[156, 22 * h, 54, -13 * h], [22 * h, 4 * h * h, 13 * h, -3 * h * h],
                                         [54, 13 * h, 156, -22 * h], [-13 * h, -3 * h * h, -22 * h, 4 * h * h]])
    for e in range(elements):
        four = np.ix_(range(2 * e, 2 * e + 4), range(2 * e, 2 * e + 4))
        stiffness[four] += k
        mass[four] += m
    dofs = [(i // 2 + 1, 3 if i % 2 == 0 else 5) for i in range(2, n)]
    return matrices("beam", stiffness[2:, 2:], mass[2:, 2:], dofs, folder, name, range(0, n - 2, 2))


def masses(rng, folder, name):
    """A chain, or a lattice of masses on springs with a ground spring each."""
    lattice = rng.random() < 0.5
    n = 25 if lattice else int(rng.integers(12, 25))
    k, m, side = 1e5, 0.1, 5
    mass, stiffness = np.diag(m * rng.uniform(0.7, 1.3, n)), np.zeros((n, n))

    def spring(i, j, value):
        stiffness[i, i] += value
        if j is not None:
            stiffness[j, j] += value
            stiffness[i, j] -= value
            stiffness[j, i] -= value

    for i in range(n if lattice else n - 1):
        if lattice:
            spring(i, None, 0.05 * k * rng.uniform(0.5, 1.5))
            if i % side + 1 < side:
                spring(i, i + 1, k * rng.uniform(0.5, 1.5))
            if i + side < n:
                spring(i, i + side, k * rng.uniform(0.5, 1.5))
        else:
            spring(i, i + 1, k * rng.uniform(0.5, 1.5))
    if not lattice:
        spring(0, None, k)
    dofs = [(i + 1, 3) for i in range(n)]
    return matrices("lattice" if lattice else "chain", stiffness, mass, dofs, folder, name, range(n))


def numbers(row):
    return ", ".join(repr(float(v)) for v in row)


def reduced(structure, dofs, signs, rng):
    """The structure as modes, rows and flexibility: the coordinates of its results are then those of the modes here."""
    keep = int(rng.integers(6, min(len(structure.mass) - len(dofs), 30) + 1))
    values, shapes = sl.eigh(structure.stiffness, structure.mass)
    select = np.zeros((len(dofs), len(structure.mass)))
    for i, (dof, sign) in enumerate(zip(dofs, signs)):
        select[i, dof] = sign
    rows, flexibility = select @ shapes[:, :keep], select @ sl.solve(structure.stiffness, select.T)
    text = [f"[{numbers(row)}]" for row in rows]
    lines = ["[structure]", 'kind = "reduced"', f"frequencies_hz = [{numbers(np.sqrt(values[:keep]) / (2 * np.pi))}]",
             f"contact_rows = [{', '.join(text)}]", f"flexibility_m_n = [{', '.join(f'[{numbers(row)}]' for row in flexibility)}]"]
    structure.lines, structure.modes = lines, keep
    for i, dof in enumerate(dofs):
        structure.places[dof] = [f"row = {i + 1}"]


class Scene:
    """A structure with stops, and the load of a response; written as a scene."""

    def __init__(self, seed, folder, forced):
        rng = np.random.default_rng(seed)
        self.name, self.forced = f"{'r' if forced else 'm'}{seed}", forced
        kind = ["rod", "beam", "masses"][seed % 3]
        structure = rod(rng) if kind == "rod" else (beam if kind == "beam" else masses)(rng, folder, self.name)
        self.structure, self.stops = structure, 1 + seed // 3 % 5
        values, shapes = sl.eigh(structure.stiffness, structure.mass)
        shape = np.abs(shapes[:, 0]) / np.max(np.abs(shapes[:, 0]))
        able = [i for i, place in enumerate(structure.places) if place is not None]
        dofs = rng.choice(able, self.stops, replace=False)
        dofs[0] = max(able, key=lambda i: shape[i]) if rng.random() < 0.5 else dofs[0]
        dofs = list(dict.fromkeys(int(i) for i in dofs))
        self.dofs, self.signs = dofs, [1.0] + [float(rng.choice([-1, 1])) for _ in dofs[1:]]
        self.gaps = [1e-3 * (0.05 + shape[i]) * rng.uniform(0.8, 1.6) for i in dofs]
        self.elastic = rng.random() < 0.5
        omega = np.sqrt(values[0])
        modal = shapes[dofs, 0]
        self.stop = 10 ** rng.uniform(-0.5, 1.5) * omega**2 / modal[0] ** 2 if self.elastic else None
        self.harmonics = int(rng.choice([5, 9, 15, 30])) if not self.elastic else int(rng.choice([5, 9, 15, 20]))
        if not forced and kind != "rod":
            reduced(structure, dofs, self.signs, rng)
        lines = [f'title = "{self.name}"', *structure.lines]
        for dof, sign, gap in zip(dofs, self.signs, self.gaps):
            place = list(structure.places[dof])
            if "row" in place[0]:
                pass
            elif "normal" in place[1]:
                place[1] = f"normal = [0.0, 0.0, {sign}]"
            else:
                place.append(f'side = "{"positive" if sign > 0 else "negative"}"')
            lines += ["[[contact]]", *place, f"gap_m = {float(gap)!r}"]
            lines += [f"stiffness_n_m = {float(self.stop)!r}"] if self.stop else []
        lines += ["[method]", f"harmonics = {self.harmonics}"]
        if forced:
            self.ratio = 10 ** rng.uniform(-2.5, -1.5)
            self.force_dof = int(rng.choice(able))
            # The force that would move the first stop 1.3 to 3 times as far as its gap, at resonance.
            reach = min(gap / abs(row) for gap, row in zip(self.gaps, modal))
            drive = abs(shapes[self.force_dof, 0])
            self.force = rng.uniform(1.3, 3.0) * reach * 2 * self.ratio * omega**2 / drive
            place = [line.replace("normal", "direction") for line in structure.places[self.force_dof]]
            hz = omega / (2 * np.pi)
            lines += ["[damping]", f"ratio = {float(self.ratio)!r}", "[[force]]", *place,
                      f"amplitude_n = {float(self.force)!r}", "[[response]]", 'kind = "frequency"',
                      f"frequency_hz = [{float(0.92 * hz)!r}, {float(1.2 * hz)!r}]",
                      "[continuation]", "max_points = 300"]
        else:
            lines += ["[continuation]", "max_energy_ratio = 3.0", "max_points = 150"]
        lines += ["[output]", "figures = false", "page = false"]
        self.path = folder / f"{self.name}.toml"
        self.path.write_text("\n".join(lines) + "\n")

    def run(self, program, limit, again=True):
        out = self.path.with_suffix("")
        if not again and (out / "summary.json").exists():
            program, limit = "true", 5
        try:
            subprocess.run([program, "run", self.path, "--out", out, "--quiet", "--force"], capture_output=True, text=True,
                           timeout=limit, env={**os.environ, "RAYON_NUM_THREADS": "1"})
        except subprocess.TimeoutExpired:
            return None
        if not (out / "summary.json").exists():
            return None
        with open(out / "branch.csv", newline="") as rows:
            rows = list(csv.DictReader(rows))
        return rows, np.load(out / "harmonics.npz"), json.loads((out / "summary.json").read_text())


class Motion:
    """The reduced structure between contact instants, `w = (z, ż/ω, cos Ωt, sin Ωt, 1)`."""

    def __init__(self, scene, modes, omega):
        s = scene.structure
        values, shapes = sl.eigh(s.stiffness, s.mass)
        self.shapes, self.values, self.mass = shapes[:, :modes], values[:modes], s.mass
        select = np.zeros((len(scene.dofs), len(s.mass)))
        for i, (dof, sign) in enumerate(zip(scene.dofs, scene.signs)):
            select[i, dof] = sign
        self.rows = select @ self.shapes

        def left(columns):
            return sl.solve(s.stiffness, columns, assume_a="pos") - self.shapes @ ((self.shapes.T @ columns).T / self.values).T

        self.flexibility = select @ left(select.T)
        self.compliance = self.flexibility + (np.eye(len(scene.dofs)) / scene.stop if scene.stop else 0.0)
        self.gaps, self.omega, self.m = np.array(scene.gaps), omega, modes
        self.damping = 2 * scene.ratio * np.sqrt(self.values) if scene.forced else np.zeros(modes)
        self.modal_force, self.moved = np.zeros(modes), np.zeros(len(scene.dofs))
        if scene.forced:
            load = np.zeros(len(s.mass))
            load[scene.force_dof] = scene.force
            self.modal_force, self.moved = self.shapes.T @ load, select @ left(load)
        self.flows = {}

    def flow(self, closed):
        """Matrix, rows of forces and gaps of a set of closed contacts."""
        if closed in self.flows:
            return self.flows[closed]
        m, c, n = self.m, len(self.gaps), 2 * self.m + 3
        free = np.zeros((c, n))
        free[:, :m], free[:, 2 * m], free[:, -1] = self.rows, self.moved, -self.gaps
        on = list(closed)
        forces = np.zeros((c, n))
        if on:
            forces[on] = np.linalg.solve(self.compliance[np.ix_(on, on)], free[on])
        gaps = self.compliance @ forces - free
        b = np.zeros((n, n))
        b[:m, m:2 * m] = self.omega * np.eye(m)
        b[m:2 * m, :m] = -np.diag(self.values) / self.omega
        b[m:2 * m, m:2 * m] = -np.diag(self.damping)
        b[m:2 * m] -= self.rows.T @ forces / self.omega
        b[m:2 * m, 2 * m] += self.modal_force / self.omega
        b[2 * m, 2 * m + 1], b[2 * m + 1, 2 * m] = -self.omega, self.omega
        watched = gaps.copy()
        watched[on] = forces[on]
        fastest = np.max(np.abs(np.linalg.eigvals(b)))
        cell = min(2 * np.pi / self.omega / 400, 0.2 / fastest)
        powers, step = [np.eye(n)], sl.expm(b * cell)
        for _ in range(CELLS):
            powers.append(step @ powers[-1])
        self.flows[closed] = (b, watched, forces, np.array(powers), cell)
        return self.flows[closed]

    def closed(self, w):
        """The set of closed contacts at a state: complementarity by trying all sets, few at a time."""
        c = len(self.gaps)
        best = None
        for bits in range(1 << c):
            closed = tuple(i for i in range(c) if bits >> i & 1)
            _, watched, _, _, _ = self.flow(closed)
            worst = np.min(watched @ w * np.where(np.isin(range(c), closed), np.diag(self.compliance), 1.0))
            if best is None or worst > best[0]:
                best = (worst, closed)
            if worst >= 0.0:
                break
        return best[1]

    def change(self, flow, before, scale, left):
        """The first contact that changes its state within some cells, and when; None, with the time that passed."""
        b, watched, _, powers, cell = flow
        count = min(CELLS, int(np.ceil(left / cell * (1 - 1e-12))))
        states = powers[:count + 1] @ before
        values, rates = states @ watched.T, states @ (watched @ b).T
        crossed = values[1:] < -scale
        dips = (rates[:-1] < 0) & (rates[1:] > 0) & ~crossed
        for k in np.flatnonzero(np.any(crossed | dips, axis=1)):
            length, hit = min(cell, left - k * cell), None
            for i in np.flatnonzero(crossed[k] | dips[k]):

                def value(s, i=i, k=k):
                    return watched[i] @ (sl.expm(b * s) @ states[k])

                to = length
                if dips[k, i]:
                    def rate(s, i=i, k=k):
                        return (watched[i] @ b) @ (sl.expm(b * s) @ states[k])

                    if rate(length) <= 0:
                        continue
                    to = brentq(rate, 0.0, length, xtol=1e-16)
                if value(to) >= -scale[i]:
                    continue
                s = brentq(value, 0.0, to, xtol=1e-15 * (left + cell)) if values[k, i] > 0 else 0.0
                if hit is None or s < hit[0]:
                    hit = (s, i)
            if hit is not None:
                return k * cell + hit[0], hit[1]
        return min(count * cell, left), None

    def propagate(self, x, duration, shown=None):
        """State after a time, transition matrix, and the pieces of the motion."""
        m = self.m
        w = np.concatenate([x, [1.0, 0.0, 1.0]])
        over, t, closed = np.eye(2 * m), 0.0, self.closed(w)
        pieces, flips = [], 0
        while t < duration * (1 - 1e-14):
            flow = self.flow(closed)
            b, watched = flow[0], flow[1]
            scale = np.max(np.abs(watched), axis=1) * np.max(np.abs(w)) * 1e-13
            start, before, contact = t, w, None
            while start < duration * (1 - 1e-14) and contact is None:
                gone, contact = self.change(flow, before, scale, duration - start)
                if shown is not None:
                    # Short enough for a series of few terms.
                    parts = max(1, int(np.ceil(gone / flow[4])))
                    for k in range(parts):
                        pieces.append((start + k * gone / parts, gone / parts, b, closed, sl.expm(b * (k * gone / parts)) @ before))
                before = sl.expm(b * gone) @ before
                start += gone
            over = sl.expm(b * (start - t))[:2 * m, :2 * m] @ over
            flips = flips + 1 if start - t < 1e-12 * duration else 0
            if flips > 20:
                raise RuntimeError("contacts chatter")
            t, w = start, before
            if contact is not None:
                closed = tuple(sorted(set(closed) ^ {contact}))
        return w[:2 * m], over, pieces

    def fundamental(self, x, duration):
        """Amplitude of the first contact at the frequency of the motion."""
        _, _, pieces = self.propagate(x, duration, shown=True)
        total = 0.0 + 0.0j
        nodes, weights = np.polynomial.legendre.leggauss(4)
        for start, length, b, closed, before in pieces:
            forces = self.flow(closed)[2]
            row = np.zeros(2 * self.m + 3)
            row[:self.m], row[2 * self.m] = self.rows[0], self.moved[0]
            row = row - self.flexibility[0] @ forces
            for node, weight in zip(nodes, weights):
                s = 0.5 * length * (1 + node)
                w = before + s * (b @ before) + s**2 / 2 * (b @ (b @ before)) + s**3 / 6 * (b @ (b @ (b @ before)))
                total += 0.5 * length * weight * (row @ w) * np.exp(-2j * np.pi * (start + s) / duration)
        return abs(total * 2 / duration)

    def periodic_forced(self, x):
        duration = 2 * np.pi / self.omega
        end, over, _ = self.propagate(x, duration)
        size = np.max(np.abs(x))
        for _ in range(25):
            miss = np.max(np.abs(end - x))
            if miss < 1e-11 * size:
                return x, duration, over
            step = np.linalg.solve(over - np.eye(len(x)), x - end)
            share = 1.0
            while True:
                new = x + share * step
                new_end, new_over, _ = self.propagate(new, duration)
                if np.max(np.abs(new_end - new)) < miss or share < 1e-3:
                    break
                share *= 0.4
            if share < 1e-3:
                return (x, duration, over) if miss < 1e-9 * size else None
            x, end, over = new, new_end, new_over
        return None

    def periodic_free(self, x):
        """The nearest motion of the family: least change of the state, of any energy."""
        duration = 2 * np.pi / self.omega
        first, size = x.copy(), np.max(np.abs(x))

        def rate(x):
            w = np.concatenate([x, [1.0, 0.0, 1.0]])
            return (self.flow(self.closed(w))[0] @ w)[:len(x)] / self.omega

        along = rate(first)
        along /= np.linalg.norm(along)
        end, over, _ = self.propagate(x, duration)
        for _ in range(25):
            miss = np.append(x - end, along @ (x - first))
            most = np.max(np.abs(miss))
            if most < 1e-11 * size:
                return x, duration, over
            jacobian = np.zeros((len(x) + 1, len(x) + 1))
            jacobian[:-1, :-1], jacobian[:-1, -1], jacobian[-1, :-1] = over - np.eye(len(x)), rate(end), along
            step = np.linalg.lstsq(jacobian, miss, rcond=1e-9)[0]
            share = 1.0
            while True:
                new, new_duration = x + share * step[:-1], duration + share * step[-1] / self.omega
                new_end, new_over, _ = self.propagate(new, new_duration)
                if np.max(np.abs(np.append(new - new_end, along @ (new - first)))) < most or share < 1e-3:
                    break
                share *= 0.4
            if share < 1e-3:
                return (x, duration, over) if most < 1e-9 * size else None
            x, duration, end, over = new, new_duration, new_end, new_over
        return None

    def integrated(self, x, duration):
        """The same period by SciPy's integrator, contact forces from the complementarity at each stage."""

        def rate(t, x):
            w = np.concatenate([x, [np.cos(self.omega * t), np.sin(self.omega * t), 1.0]])
            return (self.flow(self.closed(w))[0] @ w)[:len(x)]

        return solve_ivp(rate, (0, duration), x, method="DOP853", rtol=1e-9, atol=1e-12 * np.max(np.abs(x)),
                         max_step=duration / 200).y[:, -1]


def state(scene, motion, arrays, point):
    """State of a point at the beginning of its period."""
    q = arrays["coefficients"][point]
    order = np.arange(q.shape[1])
    if scene.structure.modes:
        z = q[:scene.structure.modes]
        return np.concatenate([np.sum(z.real, axis=1), np.sum((1j * order * z).real, axis=1)])
    load = 0.0
    if scene.forced:
        s = scene.structure
        unit = np.zeros(len(s.mass))
        unit[scene.force_dof] = scene.force
        load = sl.solve(s.stiffness, unit) - motion.shapes @ (motion.shapes.T @ unit / motion.values)
    here, fast = np.sum(q.real, axis=1) - load, np.sum((1j * order * q).real, axis=1)
    project = motion.shapes.T @ motion.mass
    return np.concatenate([project @ here, project @ fast])


def recorded(scene, arrays):
    """The recorded degrees of freedom that are those of the matrices here: all but the supports of a rod."""
    q, n = arrays["coefficients"], len(scene.structure.mass)
    if scene.structure.modes:
        return {"coefficients": q}
    keep = np.arange(q.shape[1])
    if q.shape[1] != n:
        keep = [i for i in keep if np.any(q[:, i] != 0)]
    return {"coefficients": q[:, keep]} if len(keep) == n else None


def judge(scene, motion, row, x, check):
    found = motion.periodic_forced(x) if scene.forced else motion.periodic_free(x)
    if found is None:
        return {"motion": "none"}
    x, duration, over = found
    own = abs(float(row["fundamental_m"]))
    off = abs(motion.fundamental(x, duration) / own - 1)
    hz = abs(1 / duration / float(row["frequency_hz"]) - 1)
    values = np.linalg.eigvals(over)
    if not scene.forced:
        # The pair at +1.
        values = np.delete(values, np.argsort(np.abs(values - 1))[:2])
    largest = float(np.max(np.abs(values))) if len(values) else 1.0
    out = {"motion": "same" if off < SAME and hz < SAME else "other", "off": float(off), "exact": largest}
    out["stable"] = largest < 1 if scene.forced else (True if largest < 1 + ON_CIRCLE else False if largest > 1 + OFF_CIRCLE else None)
    if check:
        out["scipy"] = float(np.max(np.abs(motion.integrated(x, duration) - motion.propagate(x, duration)[0])) / np.max(np.abs(x)))
    return out


def survey(scene, program, rng, most, limit, check, again):
    ran = scene.run(program, limit, again)
    if ran is None:
        print(f"{scene.name}: no results", flush=True)
        return
    rows, arrays, summary = ran
    of = recorded(scene, arrays)
    modes = (summary.get("reduction") or {}).get("modes") or scene.structure.modes
    # Fewer than were given are kept where a contact has too little flexibility beside them.
    scene.structure.modes = scene.structure.modes and modes
    if of is None or modes is None:
        print(f"{scene.name}: {arrays['coefficients'].shape} {modes}", flush=True)
        return
    able = [i for i, row in enumerate(rows) if float(row["contact_fraction"] or 0) > 0 or int(row["contact_intervals"] or 0) > 0]
    for k, i in enumerate(sorted(rng.choice(able, min(most, len(able)), replace=False))):
        row = rows[i]
        base = {"scene": scene.name, "kind": scene.structure.kind, "stops": len(scene.dofs), "elastic": scene.elastic,
                "harmonics": scene.harmonics, "modes": modes, "point": int(i), "hz": float(row["frequency_hz"]),
                "said": {"true": True, "false": False}.get(row["stable"]),
                "multiplier": float(row["largest_multiplier"] or "nan"),
                "error": float(row.get("multiplier_error") or "nan")}
        motion = Motion(scene, modes, 2 * np.pi * float(row["frequency_hz"]))
        try:
            found = judge(scene, motion, row, state(scene, motion, of, i), check and k == 0)
        except (RuntimeError, np.linalg.LinAlgError, ValueError) as error:
            found = {"motion": "none", "why": str(error)}
        yield {**base, **found}


def figures(rows, words):
    same = [row for row in rows if row["motion"] == "same"]
    judged = [row for row in same if row["stable"] is not None]
    wrong = [row for row in judged if row["said"] is not None and row["said"] != row["stable"]]
    unsaid = [row for row in rows if row["said"] is None]
    unsaid_same = [row for row in same if row["said"] is None]
    off = [(abs(row["multiplier"] - row["exact"]), row["error"]) for row in same
           if np.isfinite(row["multiplier"]) and np.isfinite(row["error"])]
    within = [true <= 3 * max(error, 1e-7 * 1) for true, error in off]
    both = [true <= 3 * error and error <= 3 * max(true, 1e-6) for true, error in off]
    print(f"{words}: {len(rows)} points, {len(same)} with a motion of their own, "
          f"{sum(row['motion'] == 'other' for row in rows)} with another, {sum(row['motion'] == 'none' for row in rows)} "
          f"with none; wrong {len(wrong)} of {len(judged)}; unsaid {len(unsaid)} of {len(rows)}, {len(unsaid_same)} of {len(same)}; "
          f"error at most three times too small {np.mean(within) if off else 1:.3f}, within a factor of three on both sides "
          f"{np.mean(both) if off else 1:.3f} of {len(off)}")
    for row in wrong:
        print("  wrong", row)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default="target/release/nlmodes-cli")
    parser.add_argument("--points", type=int, default=300)
    parser.add_argument("--first", type=int, default=0, help="first seed")
    parser.add_argument("--each", type=int, default=5, help="points of a scene")
    parser.add_argument("--limit-s", type=float, default=20.0, help="longest time of a run, s")
    parser.add_argument("--only", choices=["modes", "responses"])
    parser.add_argument("--keep", action="store_true", help="take runs that are there already")
    parser.add_argument("--check", action="store_true", help="compare one motion of each scene with SciPy's integrator")
    parser.add_argument("--out", type=Path, default=Path("results/stability"))
    arguments = parser.parse_args()
    arguments.out.mkdir(parents=True, exist_ok=True)
    rows, seed, rng = [], arguments.first, np.random.default_rng(1)
    while len(rows) < arguments.points and seed < arguments.first + arguments.points:
        forced = seed % 2 == 1 if arguments.only is None else arguments.only == "responses"
        scene = Scene(seed, arguments.out, forced)
        rows += survey(scene, arguments.program, rng, arguments.each, arguments.limit_s, arguments.check, not arguments.keep)
        (arguments.out / "rows.json").write_text(json.dumps(rows, indent=1))
        seed += 1
    rows = rows[:arguments.points]
    (arguments.out / "rows.json").write_text(json.dumps(rows, indent=1))
    figures([row for row in rows if row["scene"][0] == "m"], "modes")
    figures([row for row in rows if row["scene"][0] == "r"], "responses")
    figures(rows, "all")
    print("SciPy's integrator differs by at most", max((row["scipy"] for row in rows if "scipy" in row), default=None))
    return 0


if __name__ == "__main__":
    sys.exit(main())
