"""Periodic motions by event-driven shooting in double precision: which stop closes when is found on the way.

Between two events the motion is linear and is evaluated in its eigenvectors; events are bracketed by samples and found
by Newton's method. The periodic motion is found by Newton's method with differences.
"""

from functools import lru_cache

import numpy as np

NODES, WEIGHTS = np.polynomial.legendre.leggauss(24)


class Flight:
    def __init__(self, system, omega=1.0, level=1.0, xi=0.0):
        """`omega` and `level` are those of the load, `xi` the negative damping in proportion to the mass."""
        self.s, self.omega, self.level, self.xi = system, omega, level, xi
        self.inverse = np.linalg.inv(system.mass)
        self.linear = lru_cache(None)(self._linear)
        top = system.stiffness + sum(
            (s.stiffness * np.outer(s.direction, s.direction) for s in system.stops), 0 * system.mass
        )
        self.step = 0.25 / np.sqrt(np.linalg.eigvals(self.inverse @ top).real.max())

    def _linear(self, pattern):
        """Eigenvectors and values of the state with these stops closed, its rest, and its answer to the load."""
        s, n = self.s, self.s.n
        stiffness, push = s.stiffness.copy(), np.zeros(n)
        for closed, stop in zip(pattern, s.stops):
            if closed:
                stiffness += stop.stiffness * np.outer(stop.direction, stop.direction)
                push += stop.stiffness * stop.gap * stop.direction
        damping = s.damping - self.xi * s.mass
        a = np.block([[np.zeros((n, n)), np.eye(n)], [-self.inverse @ stiffness, -self.inverse @ damping]])
        values, vectors = np.linalg.eig(a)
        rest = np.concatenate([np.linalg.solve(stiffness, push), np.zeros(n)])
        q = np.zeros(n, dtype=complex)
        if self.level and s.force.any():
            q = np.linalg.solve(stiffness - self.omega**2 * s.mass + 1j * self.omega * damping, self.level * s.force)
        return values, vectors, np.linalg.inv(vectors), rest, np.concatenate([q, 1j * self.omega * q])

    def state(self, pattern, t0, z0, dt):
        """States (times, 2n) after the durations `dt` from the state `z0` at `t0`."""
        values, vectors, inverse, rest, load = self.linear(pattern)
        dt = np.atleast_1d(dt)
        y0 = inverse @ (z0 - rest - (load * np.exp(1j * self.omega * t0)).real)
        free = (vectors @ (np.exp(np.outer(values, dt)) * y0[:, None])).real
        forced = (load[:, None] * np.exp(1j * self.omega * (t0 + dt))).real
        return (free + forced + rest[:, None]).T

    def gaps(self, z):
        """Penetrations (times, stops) of states, and their rates."""
        n = self.s.n
        w = np.array([s.direction for s in self.s.stops]).T
        return z[:, :n] @ w - np.array([s.gap for s in self.s.stops]), z[:, n:] @ w

    def fly(self, z0, t_end):
        """Pieces (start, duration, pattern, state at the start) up to `t_end`, and the state there."""
        t, z, pieces = 0.0, np.array(z0, dtype=float), []
        depth, rate = self.gaps(z[None])
        pattern = tuple(bool(d > 0 or (d == 0 and r > 0)) for d, r in zip(depth[0], rate[0]))
        while True:
            left = t_end - t
            dt, j = self._next(pattern, t, z, left)
            pieces.append((t, dt, pattern, z))
            z = self.state(pattern, t, z, dt)[0]
            if j is None:
                return pieces, z
            t += dt
            pattern = tuple(c != (i == j) for i, c in enumerate(pattern))

    def _next(self, pattern, t, z, left):
        """Duration up to the next event and the stop that closes or opens, or all that is left."""
        at = 0.0
        while at < left:
            times = at + self.step * np.arange(0, 65)
            times = np.append(times[times < left], min(left, at + 64 * self.step))
            depth, rate = self.gaps(self.state(pattern, t, z, times))
            found = []
            for j, closed in enumerate(pattern):
                d = depth[:, j] * (-1 if closed else 1)
                r = rate[:, j] * (-1 if closed else 1)
                # Just after an event of this stop the depth is a rounding from zero: there the rate tells.
                for k in range(len(times) - 1):
                    a, b = times[k], times[k + 1]
                    if d[k + 1] > 0 and (d[k] <= 0 or a > 0):
                        if a == 0.0 and abs(d[k]) < 1e-13 and r[k] < 0:
                            a += 1e-3 * (b - a)
                        found.append((self._root(pattern, t, z, j, a, b), j))
                        break
                    if d[k] <= 0 and d[k + 1] <= 0 and r[k] > 0 > r[k + 1]:
                        top = self._top(pattern, t, z, j, a, b)
                        peak = self.gaps(self.state(pattern, t, z, top))[0][0, j] * (-1 if closed else 1)
                        if peak > 0 and top > 1e-9:
                            found.append((self._root(pattern, t, z, j, a, top), j))
                            break
            if found:
                return min(found)
            at = times[-1]
        return left, None

    def _root(self, pattern, t, z, j, a, b):
        sign = -1 if pattern[j] else 1
        for _ in range(200):
            mid = 0.5 * (a + b)
            depth, rate = self.gaps(self.state(pattern, t, z, mid))
            d, r = sign * depth[0, j], sign * rate[0, j]
            if d > 0:
                b = mid
            else:
                a = mid
            newton = mid - d / r if r else mid
            if a < newton < b:
                depth, rate = self.gaps(self.state(pattern, t, z, newton))
                if abs(depth[0, j]) < 1e-15 or abs(depth[0, j] / rate[0, j]) < 1e-16 * (t + b):
                    return newton
                if sign * depth[0, j] > 0:
                    b = newton
                else:
                    a = newton
            if b - a < 4e-16 * (t + b):
                break
        return 0.5 * (a + b)

    def _top(self, pattern, t, z, j, a, b):
        for _ in range(80):
            mid = 0.5 * (a + b)
            rate = self.gaps(self.state(pattern, t, z, mid))[1][0, j] * (-1 if pattern[j] else 1)
            a, b = (mid, b) if rate > 0 else (a, mid)
        return 0.5 * (a + b)

    def quantities(self, pieces, period, omega):
        """What problems ask for, by Gauss's quadrature of the pieces: of the coordinates with mass."""
        s, n = self.s, self.s.n
        kinetic, fourier, mean = 0.0, np.zeros(n, complex), np.zeros(n)
        impulse, share, peak = np.zeros(len(s.stops)), np.zeros(len(s.stops)), np.full(len(s.stops), -np.inf)
        damped = 0.0
        for t0, duration, pattern, z0 in pieces:
            parts = max(1, int(np.ceil(duration / (8 * self.step))))
            for part in range(parts):
                h = duration / parts
                times = h * (part + 0.5 + 0.5 * NODES)
                z, w = self.state(pattern, t0, z0, times), 0.5 * h * WEIGHTS
                q, v = z[:, :n], z[:, n:]
                kinetic += 0.5 * w @ np.einsum("ti,ij,tj->t", v, s.mass, v)
                damped += w @ np.einsum("ti,ij,tj->t", v, s.damping, v)
                fourier += (w * np.exp(-1j * omega * (t0 + times))) @ q
                mean += w @ q
                depth = self.gaps(z)[0]
                for j, stop in enumerate(s.stops):
                    if pattern[j]:
                        impulse[j] += stop.stiffness * (w @ depth[:, j])
            fine = self.gaps(self.state(pattern, t0, z0, np.linspace(0, duration, 400)))
            for j, closed in enumerate(pattern):
                share[j] += closed * duration / period
                peak[j] = max(peak[j], self._largest(pattern, t0, z0, j, duration, fine) + s.stops[j].gap)
        return {
            "mean_kinetic_energy": kinetic / period,
            "damping_power": damped / period,
            "fundamental": 2 * fourier / period,
            "mean": mean / period,
            "impulse": impulse,
            "contact_share": share,
            "peak": peak,
        }

    def _largest(self, pattern, t0, z0, j, duration, fine):
        depth, rate = fine[0][:, j], fine[1][:, j]
        best = depth.max()
        times = np.linspace(0, duration, 400)
        for k in range(len(times) - 1):
            if rate[k] > 0 >= rate[k + 1]:
                a, b = times[k], times[k + 1]
                for _ in range(60):
                    mid = 0.5 * (a + b)
                    a, b = (mid, b) if self.gaps(self.state(pattern, t0, z0, mid))[1][0, j] > 0 else (a, mid)
                best = max(best, self.gaps(self.state(pattern, t0, z0, a))[0][0, j])
        return best

    def rate(self, pieces, end):
        """The derivative (2n,) of the state at the end of the pieces, of a free motion."""
        values, vectors, inverse, rest, _ = self.linear(pieces[-1][2])
        return (vectors @ (values * (inverse @ (end - rest)))).real

    def monodromy(self, pieces):
        """The derivative (2n, 2n) of the state after the pieces with respect to that before them; the force of a stop
        is continuous."""
        total = np.eye(2 * self.s.n)
        for _, duration, pattern, _ in pieces:
            values, vectors, inverse, _, _ = self.linear(pattern)
            total = ((vectors * np.exp(values * duration)) @ inverse).real @ total
        return total


def newton(residual, x, steps=40):
    """A root by Newton's method; `residual` returns itself and its derivative, and the iteration ends where it gets no
    smaller."""
    x = np.array(x, dtype=float)
    best, at = np.inf, x
    for _ in range(steps):
        r, jacobian = residual(x)
        norm = np.abs(r).max()
        if norm < best:
            best, at = norm, x
        elif best < 1e-10:
            break
        x = x - np.linalg.solve(jacobian, r)
    if not best < 1e-9:
        raise ArithmeticError(f"no periodic motion: {best:.1e}")
    return at
