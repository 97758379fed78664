"""For adapters of programs that balance harmonics: quantities of Fourier coefficients, passages of a curve, and their
refinement.

Coefficients are (2H + 1, n): the mean, then cosine and sine of each harmonic.
"""

import math

import numpy as np


def kinetic(q, omega, mass):
    """Mean kinetic energy."""
    h = np.repeat(np.arange(1, (len(q) + 1) // 2), 2)
    return 0.25 * omega**2 * np.einsum("k,ki,ij,kj->", h**2, q[1:], mass, q[1:])


def impulses(q, omega, stops, samples=16384):
    """Integral of the force of each elastic stop over the period."""
    tau = 2 * np.pi * np.arange(samples) / samples
    found = []
    for stop in stops:
        u = q @ stop.direction
        motion = np.full(samples, u[0])
        for h in range(1, (len(q) + 1) // 2):
            motion += u[2 * h - 1] * np.cos(h * tau) + u[2 * h] * np.sin(h * tau)
        found.append(stop.stiffness * np.maximum(motion - stop.gap, 0).mean() * 2 * np.pi / omega)
    return found


def amplitude(q, i):
    """That of the fundamental of a coordinate."""
    return float(np.hypot(q[1, i], q[2, i]))


def refined(residual, condition, x, steps=30):
    """Newton's method for a residual with its derivative (r, J with as many columns as x) and one more condition."""
    for _ in range(steps):
        r, jacobian = residual(x)
        g = condition(x)
        if np.linalg.norm(np.append(r, g)) < 1e-12:
            break
        row = np.empty(len(x))
        for i in range(len(x)):
            h = 1e-7 * max(1.0, abs(x[i]))
            moved = x.copy()
            moved[i] += h
            row[i] = (condition(moved) - g) / h
        x = x - np.linalg.lstsq(np.vstack([jacobian, row]), np.append(r, g), rcond=None)[0]
    if not np.linalg.norm(np.append(r, g)) < 1e-8:
        raise ArithmeticError("no convergence at the last point")
    return x


def passages(values, level):
    """Places (k, share of the step) at which values along a curve pass a level."""
    v = np.asarray(values) - level
    return [(k, v[k] / (v[k] - v[k + 1])) for k in range(len(v) - 1) if v[k] * v[k + 1] <= 0 and v[k] != v[k + 1]]


def turning(values, near):
    """The extremum of a curve that is nearest to a value, by parabolas through three points."""
    found = []
    for k in range(1, len(values) - 1):
        a, b, c = values[k - 1 : k + 2]
        if (b - a) * (c - b) < 0:
            found.append(b - ((c - a) / 2) ** 2 / (2 * (c - 2 * b + a)))
    if not found:
        raise ArithmeticError("no fold was found")
    return min(found, key=lambda w: abs(w - near))


def of_curve(points, residual, problem, case, system, heavy):
    """What a case asks of a response curve: points (N, (2H + 1) n + 1) of coefficients and frequency, and the residual
    with its derivative, by which points between those of the curve are refined."""
    drive = int(np.flatnonzero(system.force)[0])
    name = f"amplitude[{heavy[drive]}]"
    coefficients = lambda x: x[:-1].reshape(-1, system.n)
    between = lambda at: points[at[0]] + at[1] * (points[at[0] + 1] - points[at[0]])
    if "fold" in case["branch"]:
        return {"frequency": turning(points[:, -1], case["near"]["frequency"])}
    if problem["kind"] == "phase-resonance":
        lag = lambda x: coefficients(x)[1, drive]
        largest = lambda at: amplitude(coefficients(points[at[0]]), drive)
        x = refined(residual, lag, between(max(passages([lag(p) for p in points], 0.0), key=largest)))
        return {"frequency": x[-1], name: amplitude(coefficients(x), drive)}
    omega = case["at"]["frequency"]
    found = [refined(residual, lambda x: x[-1] - omega, between(at)) for at in passages(points[:, -1], omega)]
    off = lambda x: abs(math.log(amplitude(coefficients(x), drive) / case["near"][name]))
    q = coefficients(min(found, key=off))
    return {name: amplitude(q, drive)} | {f"impulse[{j}]": v for j, v in enumerate(impulses(q, omega, system.stops))}
