"""Closed forms: oscillators with one degree of freedom from their harmonic arcs, and the uniform bar from its waves
(with mpmath)."""

from mpmath import mp, mpf

mp.dps = 40


def arc(k, centre, turn, border):
    """Time (s) and twice the kinetic energy's integral (J s) of a mass of 1 kg on `k` about `centre` from rest at
    `turn` to `border`."""
    w, a = mp.sqrt(mpf(k)), mpf(turn) - centre
    phase = mp.acos((mpf(border) - centre) / a)
    return phase / w, a**2 * w * (phase / 2 - mp.sin(2 * phase) / 4)


def assembled(pieces):
    """Frequency (rad/s) and mean kinetic energy (J) of a period of arcs (time, integral, how often)."""
    period = sum(t * times for t, _, times in pieces)
    return 2 * mp.pi / period, sum(e * times for _, e, times in pieces) / (2 * period)


def one_stop(k, k_c, gap, turn):
    """A mass of 1 kg on `k` that turns at `turn` on its free side, before a stop of `k_c` at `gap`; ω, mean kinetic
    energy."""
    k, k_c, gap, turn = map(mpf, (k, k_c, gap, turn))
    free = arc(k, 0, turn, gap)
    centre = k_c * gap / (k + k_c)
    top = centre + mp.sqrt((k * (turn**2 - gap**2)) / (k + k_c) + (gap - centre) ** 2)
    return assembled([(*free, 2), (*arc(k + k_c, centre, top, gap), 2)])


def two_stops(k, stops, top):
    """The same between stops (gap, stiffness) on the positive and negative side, with its turn at `top` in the first
    one."""
    k, top = mpf(k), mpf(top)
    (g1, k1), (g2, k2) = [tuple(map(mpf, s)) for s in stops]
    c1, c2 = k1 * g1 / (k + k1), k2 * g2 / (k + k2)
    energy = (k * top**2 + k1 * (top - g1) ** 2) / 2
    turn = c2 + mp.sqrt((2 * energy - k * g2**2) / (k + k2) + (g2 - c2) ** 2)
    a, w = mp.sqrt(2 * energy / k), mp.sqrt(k)
    p1, p2 = mp.asin(g1 / a), mp.asin(g2 / a)
    t = (p1 + p2) / w
    e = a**2 * w * ((p1 + p2) / 2 + (mp.sin(2 * p1) + mp.sin(2 * p2)) / 4)
    return assembled([(*arc(k + k1, c1, top, g1), 2), (t, e, 2), (*arc(k + k2, c2, turn, g2), 2)])


def impact(gap, turn):
    """A mass of 1 kg on 1 N/m that turns at −`turn` and is thrown back by a rigid stop at `gap` without loss."""
    return assembled([(*arc(1, 0, -mpf(turn), mpf(gap)), 2)])


def impact_two_sided(gap, swing):
    """The same between two rigid stops at ±`gap`, as fast as if it swung to `swing`."""
    a = mpf(swing)
    p = mp.asin(mpf(gap) / a)
    return assembled([(p, a**2 * (p / 2 + mp.sin(2 * p) / 4), 4)])


def bar_energy(gap, period):
    """Total energy of the first nonsmooth mode of the bar with L = c = EA = 1 that is clamped at one end: 3 < period <
    4."""
    return mpf(gap) ** 2 / (2 * (mpf(period) - 3) ** 2)
