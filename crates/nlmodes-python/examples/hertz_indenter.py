"""A rigid sphere pressed into an elastic half-space: pressures from `contact.solve`, beside Hertz's closed form.

Each of n × n squares under the sphere is a contact. A uniform pressure on one moves the surface by Love's (1929) solution, so that the
compliance A is known exactly, and the gap without forces is r²/2R − δ.
"""

import sys

import numpy as np
from nlmodes import contact

RADIUS_M, DEPTH_M, MODULUS_PA = 10e-3, 5e-6, 230e9  # of the sphere, of its tip below the surface, E/(1 − ν²)


def compliance(n, side):
    """Displacement of the middle of square i by a force of 1 N on square j (n², n²), m/N."""

    def corner(x, y):
        return x * np.arcsinh(y / np.abs(x)) + y * np.arcsinh(x / np.abs(y))

    middle = (np.arange(n) - (n - 1) / 2) * side
    x, y = (grid.ravel() for grid in np.meshgrid(middle, middle))
    dx, dy = x[:, None] - x, y[:, None] - y
    h = side / 2  # which no dx ± h or dy ± h cancels
    sums = corner(dx + h, dy + h) - corner(dx + h, dy - h) - corner(dx - h, dy + h) + corner(dx - h, dy - h)
    return np.hypot(x, y), sums / (np.pi * MODULUS_PA * side**2)


def main(figure="hertz_indenter.svg", n=24):
    edge = np.sqrt(RADIUS_M * DEPTH_M)  # Hertz: a² = R δ
    side = 2.6 * edge / n
    r, a = compliance(n, side)
    found = contact.solve(a, r**2 / (2 * RADIUS_M) - DEPTH_M)
    force = 4 / 3 * MODULUS_PA * np.sqrt(RADIUS_M * DEPTH_M**3)
    peak = 2 / np.pi * MODULUS_PA * np.sqrt(DEPTH_M / RADIUS_M)
    print(f"force {found.lambda_.sum():.2f} N, Hertz {force:.2f} N; {found.closed.sum()} of {n * n} closed, violation {found.violation:.1e}")

    import matplotlib.pyplot as plt

    axes = plt.subplots(layout="constrained")[1]
    radii = np.linspace(0, edge, 200)
    axes.plot(1e3 * radii, 1e-9 * peak * np.sqrt(1 - (radii / edge) ** 2), "k", label="Hertz")
    axes.plot(1e3 * r, 1e-9 * found.lambda_ / side**2, ".", label=f"{n} × {n} squares")
    axes.set(xlabel="distance from the axis / mm", ylabel="pressure / GPa")
    axes.legend()
    axes.figure.savefig(figure)
    return found.lambda_.sum() / force, found.lambda_.max() / side**2 / peak


if __name__ == "__main__":
    main(*sys.argv[1:])
