"""The uniform bar by its waves: u(x, t) = f(t + x) − f(t − x) with L = c = EA = 1, clamped at x = 0, before a rigid
stop at x = 1.

The tip moves freely (no strain: f' changes its sign after a time of 2) or is held (no velocity: f' repeats itself after
2). With equal steps of time and space this is exact, in fractions, for motions whose slopes jump at points of the grid
only.
"""

from fractions import Fraction


def onward(slopes, gap, steps):
    """f' of the last two lengths after `steps` more, the steps in which the stop is touched, and the place of the
    tip."""
    h, length = list(slopes), len(slopes)
    size = Fraction(2, length)
    tip, touched = sum(h) * size, []
    for _ in range(steps):
        old = h[-length]
        if tip - 2 * old * size <= gap:
            h.append(-old)
            tip -= 2 * old * size
            touched.append(False)
        else:
            h.append(old)
            touched.append(True)
    return h, touched, tip


def mode(period, gap, parts):
    """The first nonsmooth mode: total energy and mean kinetic energy of the one height of waves with which the motion
    returns.

    It begins at the end of a touch with waves f' of one height, positive over T − 2 and negative over the rest of 2.
    Which height is found from the
    motion alone: of those with which a touch begins at a point of the grid, one returns after the period with a touch
    of 4 − T.
    """
    period, gap = Fraction(period), Fraction(gap)
    steps = int(period * parts)
    positive = int((period - 2) * parts)
    touching = int((4 - period) * parts)
    signs = [1] * positive + [-1] * (2 * parts - positive)

    def returns(height):
        start = [height * s for s in signs]
        h, touched, tip = onward(start, gap, steps)
        return h[-2 * parts :] == start and tip == sum(start) / parts and sum(touched) == touching, sum(touched), h

    heights = [gap * parts / (2 * k) for k in range(1, 2 * parts)]
    good = [height for height in heights if returns(height)[0]]
    if len(good) != 1:
        raise ArithmeticError(f"{len(good)} heights of waves return")
    height = good[0]
    one = [1 if v > 0 else -1 for v in returns(height)[2][-steps:]]
    correlation = [
        Fraction(sum(one[i] * one[(i + k) % steps] for i in range(steps)), steps) for k in range(2 * parts + 1)
    ]
    area = sum((a + b) / 2 for a, b in zip(correlation, correlation[1:])) / parts
    return 2 * height**2, height**2 * (1 - area / 2)
