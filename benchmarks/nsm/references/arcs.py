"""The same periodic motions as a boundary-value problem with 50 digits: states at the start, and the durations between
events, are unknowns.

The order of the events is given (it is that which `flight.py` has found) and checked in the end. A piece is the
exponential of a matrix, computed by FLINT (package python-flint) with bounds of its rounding; nothing is shared with
`flight.py` but the problem.
"""

from flint import acb_mat, arb, arb_mat, ctx, fmpq

ctx.prec = 200


def matrix(rows):
    return arb_mat([[number(x) for x in row] for row in rows])


def number(x):
    return x if isinstance(x, arb) else arb(fmpq(*float(x).as_integer_ratio()))


def mid(m):
    return arb_mat([[m[i, j].mid() for j in range(m.ncols())] for i in range(m.nrows())])


def column(values):
    return arb_mat([[v] for v in values])


def legendre(count):
    """Nodes and weights of Gauss's quadrature on 0 to 1."""
    found = []
    for k in range(count):
        x, w = arb.legendre_p_root(count, k, weight=True)
        found.append(((1 + x) / 2, w / 2))
    return found


class Arcs:
    """Periodic motion of a system with events in a given order.

    `patterns` are the closed stops of each piece; `known` has what is prescribed of `omega`, `level`, `xi` (else it is
    an unknown), and `conditions`
    are functions of (self, x) that make up for further unknowns. `periods` is that of the motion over that of the load;
    of a free motion None.
    """

    def __init__(self, system, patterns, known, unknowns, conditions, periods=None):
        self.n, self.patterns, self.periods = system.n, patterns, periods
        self.mass, self.damping = matrix(system.mass), matrix(system.damping)
        self.k, self.force = matrix(system.stiffness), [number(f) for f in system.force]
        self.inverse = self.mass.inv()
        self.stops = [([number(w) for w in s.direction], number(s.gap), number(s.stiffness)) for s in system.stops]
        self.known = {name: number(value) for name, value in known.items()}
        self.unknowns, self.conditions = list(unknowns), list(conditions)

    def value(self, x, name):
        """A parameter, prescribed or among the unknowns."""
        if name in self.known:
            return self.known[name]
        return x[2 * self.n + len(self.patterns) + self.unknowns.index(name)]

    def durations(self, x):
        return x[2 * self.n : 2 * self.n + len(self.patterns)]

    def generator(self, pattern, omega, level, xi):
        """The matrix of the piece for the state (q, v, cos Ωt, sin Ωt, 1)."""
        n = self.n
        k, push = [[self.k[i, j] for j in range(n)] for i in range(n)], [arb(0)] * n
        for closed, (w, gap, stiffness) in zip(pattern, self.stops):
            if closed:
                for i in range(n):
                    push[i] += stiffness * gap * w[i]
                    for j in range(n):
                        k[i][j] += stiffness * w[i] * w[j]
        damping = self.damping - self.mass * xi
        qq, qv = self.inverse * arb_mat(k), self.inverse * damping
        load = self.inverse * column([level * f for f in self.force])
        rest = self.inverse * column(push)
        a = [[arb(0)] * (2 * n + 3) for _ in range(2 * n + 3)]
        for i in range(n):
            a[i][n + i] = arb(1)
            for j in range(n):
                a[n + i][j], a[n + i][n + j] = -qq[i, j], -qv[i, j]
            a[n + i][2 * n], a[n + i][2 * n + 2] = load[i, 0], rest[i, 0]
        a[2 * n][2 * n + 1], a[2 * n + 1][2 * n] = -omega, omega
        return arb_mat(a)

    def pieces(self, x):
        """Generator, duration and first state of each piece, with the state after the last one."""
        omega, level, xi = (self.value(x, name) for name in ("omega", "level", "xi"))
        z = column(list(x[: 2 * self.n]) + [arb(1), arb(0), arb(1)])
        found = []
        for pattern, duration in zip(self.patterns, self.durations(x)):
            a = self.generator(pattern, omega, level, xi)
            flow = (a * duration).exp()
            found.append((a, duration, z, flow))
            z = flow * z
        return found, z

    def depth(self, z, j):
        w, gap, _ = self.stops[j]
        return sum((w[i] * z[i, 0] for i in range(self.n)), arb(0)) - gap

    def residual(self, x):
        pieces, end = self.pieces(x)
        r = [end[i, 0] - x[i] for i in range(2 * self.n)]
        for k in range(1, len(pieces)):
            changed = [j for j, pair in enumerate(zip(self.patterns[k - 1], self.patterns[k])) if pair[0] != pair[1]]
            r.append(self.depth(pieces[k][2], changed[0]))
        if self.periods is not None:
            r.append(sum(self.durations(x), arb(0)) * self.value(x, "omega") - 2 * arb.pi() * self.periods)
        return r + [condition(self, x) for condition in self.conditions]

    def solve(self, start, steps=60, small=1e-45):
        """The root of the residual from a start in double precision, by Newton's method with one-sided differences of
        1e-30."""
        x = [number(v) for v in start]
        h = arb("1e-30")
        for _ in range(steps):
            r = self.residual(x)
            if len(r) != len(x):
                raise ValueError(f"{len(r)} equations for {len(x)} unknowns")
            columns = []
            for i in range(len(x)):
                moved = list(x)
                moved[i] = moved[i] + h
                columns.append([(b - a) / h for a, b in zip(r, self.residual(moved))])
            j = mid(arb_mat([[columns[c][i] for c in range(len(x))] for i in range(len(x))]))
            step = j.solve(mid(column(r)))
            x = [(x[i] - step[i, 0]).mid() for i in range(len(x))]
            self.jacobian = j
            if max(abs(float(step[i, 0])) for i in range(len(x))) < small:
                return x
        raise ArithmeticError("Newton's method did not converge")

    def check(self, x, samples=300):
        """Whether the stops are open and closed as assumed, at samples of each piece."""
        for pattern, (a, duration, z, _) in zip(self.patterns, self.pieces(x)[0]):
            if not duration > 0:
                raise ArithmeticError("a piece has no duration")
            flow = (a * (duration / samples)).exp()
            for _ in range(samples - 1):
                z = mid(flow * z)
                for j, closed in enumerate(pattern):
                    if not (self.depth(z, j) > 0) == closed:
                        raise ArithmeticError("a stop is not as assumed")

    def quantities(self, x, omega):
        n = self.n
        kinetic = arb(0)
        fourier, mean = [[arb(0), arb(0)] for _ in range(n)], [arb(0)] * n
        impulse, share = [arb(0)] * len(self.stops), [arb(0)] * len(self.stops)
        period = sum(self.durations(x), arb(0))
        t, rule = arb(0), legendre(24)
        for pattern, (a, duration, z, _) in zip(self.patterns, self.pieces(x)[0]):
            parts = max(
                1,
                int(float(duration) * float(max(abs(a[i, j]) for i in range(2 * n) for j in range(2 * n))) ** 0.5 / 2),
            )
            h = duration / parts
            flows = [((a * (h * node)).exp(), node, weight) for node, weight in rule]
            step = (a * h).exp()
            for _ in range(parts):
                for flow, node, weight in flows:
                    y, w = flow * z, weight * h
                    phase = omega * (t + node * h)
                    c, s = phase.cos(), phase.sin()
                    v = column([y[n + i, 0] for i in range(n)])
                    kinetic += w * (v.transpose() * self.mass * v)[0, 0] / 2
                    for i in range(n):
                        fourier[i][0] += w * c * y[i, 0]
                        fourier[i][1] -= w * s * y[i, 0]
                        mean[i] += w * y[i, 0]
                    for j, closed in enumerate(pattern):
                        if closed:
                            impulse[j] += w * self.stops[j][2] * self.depth(y, j)
                z = step * z
                t += h
            for j, closed in enumerate(pattern):
                if closed:
                    share[j] += duration / period
        return {
            "mean_kinetic_energy": kinetic / period,
            "fundamental": [tuple(2 * part / period for part in f) for f in fourier],
            "mean": [m / period for m in mean],
            "impulse": impulse,
            "contact_share": share,
        }

    def monodromy(self, x):
        n = self.n
        total = arb_mat([[arb(int(i == j)) for j in range(2 * n)] for i in range(2 * n)])
        for _, _, _, flow in self.pieces(x)[0]:
            total = arb_mat([[flow[i, j] for j in range(2 * n)] for i in range(2 * n)]) * total
        return total

    def largest_multiplier(self, x):
        m = mid(self.monodromy(x))
        values = acb_mat(m).eig(multiple=True, tol=arb("1e-40"))
        return max((abs(v).mid() for v in values), key=float)
