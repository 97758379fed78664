"""Each motion of the suite twice: by shooting in double precision (`flight.py`), and with 50 digits from there
(`arcs.py`)."""

import dataclasses

import arcs
import flight
import numpy as np
import scipy.linalg as sl


@dataclasses.dataclass
class Motion:
    """One periodic motion: the shooting, its pieces, and the quantities of both computations by name."""

    flight: object
    pieces: list
    period: float
    omega: float
    coarse: dict
    fine: dict
    arcs: object
    x: list


def linear_mode(system, number):
    """Frequency and shape of a linear mode with all stops open."""
    squares, shapes = sl.eigh(system.stiffness, system.mass)
    return float(np.sqrt(squares[number - 1])), shapes[:, number - 1]


def free_start(system, amplitude, ref, number):
    """States and parameters of the linear mode whose coordinate `ref` begins at rest at `amplitude`: (q, v, T, ξ)."""
    omega, shape = linear_mode(system, number)
    q = shape * amplitude / shape[ref]
    return np.concatenate([q, 0 * q, [2 * np.pi / omega, 0.0]])


def free(system, amplitude, ref, x):
    """A free motion of a damped or undamped system near `x`, with the coordinate `ref` at rest at `amplitude` in the
    beginning."""
    n = system.n

    def fly(z, period, xi):
        one = flight.Flight(system, level=0.0, xi=xi)
        pieces, end = one.fly(z, period)
        return one, pieces, end

    def residual(x):
        one, pieces, end = fly(x[: 2 * n], x[2 * n], x[-1])
        jacobian = np.zeros((2 * n + 2, 2 * n + 2))
        jacobian[: 2 * n, : 2 * n] = one.monodromy(pieces) - np.eye(2 * n)
        jacobian[: 2 * n, 2 * n] = one.rate(pieces, end)
        h = 1e-6
        jacobian[: 2 * n, -1] = (fly(x[: 2 * n], x[2 * n], x[-1] + h)[2] - fly(x[: 2 * n], x[2 * n], x[-1] - h)[2]) / (
            2 * h
        )
        jacobian[2 * n, ref] = jacobian[2 * n + 1, n + ref] = 1.0
        return np.concatenate([end - x[: 2 * n], [x[ref] - amplitude, x[n + ref]]]), jacobian

    return flight.newton(residual, x)


def follow(family, ref, x, step=0.05, smallest=1e-5):
    """The free motion at the end of a family of (system, amplitude) over 0 to 1, each begun at those before; steps
    halve where that fails."""
    system, amplitude = family(0.0)
    known = [(0.0, free(system, amplitude, ref, x))]
    while known[-1][0] < 1.0:
        s, x = known[-1]
        new = min(1.0, s + step)
        guess = x
        if len(known) > 1:
            before, old = known[-2]
            guess = x + (x - old) * (new - s) / (s - before)
        system, amplitude = family(new)
        try:
            found = free(system, amplitude, ref, guess)
            if np.abs(found - x).max() > 0.5 * np.abs(x).max():
                raise ArithmeticError("another motion")
        except (ArithmeticError, np.linalg.LinAlgError):
            step /= 2
            if step < smallest:
                raise
            continue
        known.append((new, found))
        step = min(2 * step, 0.1)
    return known[-1][1]


def stiffening(system, amplitude):
    """The family that begins without stops and ends with those of the system, at one amplitude."""
    return lambda s: (
        dataclasses.replace(
            system, stops=[dataclasses.replace(p, stiffness=p.stiffness * max(s, 1e-9) ** 2) for p in system.stops]
        ),
        amplitude,
    )


def twice_free(system, amplitude, ref, x):
    n = system.n
    one = flight.Flight(system, level=0.0, xi=x[-1])
    period = x[2 * n]
    pieces, _ = one.fly(x[: 2 * n], period)
    coarse = one.quantities(pieces, period, 2 * np.pi / period)
    coarse.update(frequency=2 * np.pi / period, damping_ratio=x[-1] * period / (4 * np.pi))
    conditions = [lambda s, x: x[ref] - arcs.number(amplitude), lambda s, x: x[s.n + ref]]
    patterns = [piece[2] for piece in pieces]
    many = arcs.Arcs(system, patterns, {"omega": 1.0, "level": 0.0}, ["xi"], conditions)
    exact = many.solve(np.concatenate([x[: 2 * n], [piece[1] for piece in pieces], [x[-1]]]))
    many.check(exact)
    total = sum(many.durations(exact), arcs.arb(0))
    omega = 2 * arcs.arb.pi() / total
    fine = many.quantities(exact, omega)
    fine.update(frequency=omega, damping_ratio=exact[-1] / (2 * omega))
    return Motion(one, pieces, period, 2 * np.pi / period, coarse, fine, many, exact)


class Driven:
    """Responses of a system to its load at `level`, of `periods` periods."""

    def __init__(self, system, level=1.0, periods=1):
        self.system, self.level, self.periods = system, level, periods

    def end(self, z, omega):
        one = flight.Flight(self.system, omega, self.level)
        pieces, end = one.fly(z, 2 * np.pi * self.periods / omega)
        return one, pieces, end

    def residual(self, z, omega):
        """The state after the period less that before it, and its derivative with respect to that."""
        one, pieces, end = self.end(z, omega)
        return end - z, one.monodromy(pieces) - np.eye(len(z))

    def by_omega(self, z, omega):
        """The derivative of the state after the period with respect to the frequency, by a difference."""
        h = 1e-6 * omega
        return (self.end(z, omega + h)[2] - self.end(z, omega - h)[2]) / (2 * h)

    def linear(self, omega):
        s = self.system
        q = np.linalg.solve(s.stiffness - omega**2 * s.mass + 1j * omega * s.damping, self.level * s.force)
        return np.concatenate([q.real, (1j * omega * q).real])

    def at(self, z, omega):
        return flight.newton(lambda z: self.residual(z, omega), z)

    def _bordered(self, y, guess, tangent):
        r, jacobian = self.residual(y[:-1], y[-1])
        whole = np.block([[jacobian, self.by_omega(y[:-1], y[-1])[:, None]], [tangent[None]]])
        return np.append(r, tangent @ (y - guess)), whole

    def curve(self, start, omega, ds, stop, most=4000):
        """Points (z, Ω) along a curve by arc length, until `stop(point)`."""
        x = np.append(self.at(start, omega), omega)
        points = [x]
        tangent = np.zeros(len(x))
        tangent[-1] = np.sign(ds)
        ds = abs(ds)
        while len(points) < most and not stop(points[-1]):
            guess = x + ds * tangent
            try:
                new = flight.newton(lambda y: self._bordered(y, guess, tangent), guess, 12)
                step = new - x
                if np.linalg.norm(step) > 3 * ds or step @ tangent < 0.5 * np.linalg.norm(step):
                    raise ArithmeticError
            except (ArithmeticError, np.linalg.LinAlgError):
                ds /= 2
                if ds < 1e-7:
                    raise
                continue
            tangent, x = step / np.linalg.norm(step), new
            points.append(x)
            ds = min(ds * 1.3, 0.04)
        return np.array(points)


def crossings(points, omega):
    """States at which a curve passes a frequency, in its order, interpolated."""
    found = []
    for a, b in zip(points, points[1:]):
        if (a[-1] - omega) * (b[-1] - omega) < 0:
            s = (omega - a[-1]) / (b[-1] - a[-1])
            found.append(a[:-1] + s * (b[:-1] - a[:-1]))
    return found


def twice_driven(driven, z, omega, known=("omega", "level"), unknowns=(), conditions=()):
    """Both computations of a response near the state `z`; `unknowns` among omega and level come with as many conditions
    of `arcs`."""
    system = driven.system
    z = driven.at(z, omega)
    one = flight.Flight(system, omega, driven.level)
    period = 2 * np.pi * driven.periods / omega
    pieces, _ = one.fly(z, period)
    coarse = one.quantities(pieces, period, omega)
    coarse["frequency"] = omega
    coarse["multiplier"] = np.abs(np.linalg.eigvals(one.monodromy(pieces))).max()
    values = {"omega": omega, "level": driven.level, "xi": 0.0}
    many = arcs.Arcs(
        system,
        [p[2] for p in pieces],
        {k: values[k] for k in (*known, "xi")},
        list(unknowns),
        list(conditions),
        driven.periods,
    )
    start = np.concatenate([z, [p[1] for p in pieces], [values[k] for k in unknowns]])
    exact = many.solve(start)
    many.check(exact)
    omega_exact = many.value(exact, "omega")
    fine = many.quantities(exact, omega_exact)
    fine["frequency"], fine["level"] = omega_exact, many.value(exact, "level")
    fine["multiplier"] = many.largest_multiplier(exact)
    return Motion(one, pieces, period, omega, coarse, fine, many, exact)


def root(function, a, b, small=1e-13, steps=60):
    """A root of a function of one number by the secant method, in the numbers of the function."""
    fa, fb = function(a), function(b)
    for _ in range(steps):
        if fb == fa:
            return b
        a, fa, b = b, fb, b - fb * (b - a) / (fb - fa)
        if abs(float(b - a)) <= small * abs(float(b)):
            return b
        fb = function(b)
    raise ArithmeticError("the secant method did not converge")


def fold(driven, point, ref):
    """The frequency at a fold near a point of a curve, where it is stationary over the coordinate `ref` at the start; a
    number each."""

    def slope(a):
        x = point.copy()
        border = np.zeros(len(x))
        border[ref] = 1.0

        def residual(y):
            r, jacobian = driven.residual(y[:-1], y[-1])
            whole = np.block([[jacobian, driven.by_omega(y[:-1], y[-1])[:, None]], [border[None]]])
            return np.append(r, y[ref] - a), whole

        slope.x = flight.newton(residual, x)
        return np.linalg.solve(residual(slope.x)[1], np.append(np.zeros(len(x) - 1), 1.0))[-1]

    start = point[ref]
    root(slope, start, start * (1 + 1e-4), 1e-9)
    z, omega = slope.x[:-1], slope.x[-1]
    pieces = driven.end(z, omega)[1]

    def exact_slope(a):
        conditions = [lambda s, x: x[ref] - a]
        many = arcs.Arcs(
            driven.system,
            [p[2] for p in pieces],
            {"level": driven.level, "xi": 0.0},
            ["omega"],
            conditions,
            driven.periods,
        )
        x = many.solve(exact_slope.start)
        many.check(x)
        exact_slope.omega = many.value(x, "omega")
        exact_slope.start = [float(v) for v in x]
        step = many.jacobian.solve(arcs.column([arcs.arb(0)] * (len(x) - 1) + [arcs.arb(1)]))
        return step[len(x) - 1, 0].mid()

    exact_slope.start = np.concatenate([z, [p[1] for p in pieces], [omega]])
    a = arcs.number(z[ref])
    root(exact_slope, a, a * (1 + arcs.arb("1e-9")), 1e-25)
    return omega, exact_slope.omega


def where(driven, z, omega, measure, step=1e-5):
    """The frequency at which `measure(quantities, monodromy)` of a response vanishes, near one; both computations,
    motion included."""

    def coarse(w):
        coarse.z = driven.at(coarse.z, w)
        one, pieces, _ = driven.end(coarse.z, w)
        period = 2 * np.pi * driven.periods / w
        return measure(one.quantities(pieces, period, w), lambda: one.monodromy(pieces))

    coarse.z = z
    found = root(coarse, omega, omega * (1 + step), 1e-11)
    pieces = driven.end(coarse.z, found)[1]

    def fine(w):
        many = arcs.Arcs(
            driven.system,
            [p[2] for p in pieces],
            {"omega": w, "level": driven.level, "xi": 0.0},
            [],
            [],
            driven.periods,
        )
        x = many.solve(fine.start)
        fine.start = [float(v) for v in x]
        return measure(many.quantities(x, w), lambda: arcs.mid(many.monodromy(x)))

    fine.start = np.concatenate([coarse.z, [p[1] for p in pieces]])
    w = arcs.number(found)
    exact = root(fine, w, w * (1 + arcs.arb("1e-12")), 1e-28)
    return found, exact, twice_driven(driven, coarse.z, found)
