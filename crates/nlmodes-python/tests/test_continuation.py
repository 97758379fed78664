"""Branches of functions of Python: folds, branch points, bounds, units, and exceptions that come through."""

import math
import threading

import numpy as np
import pytest
from nlmodes import continuation

THETA = 1.1996786402577338  # θ tanh θ = 1
FOLD = 8 * (THETA / math.cosh(THETA)) ** 2


def bratu(n):
    """u″ + p eᵘ = 0 on n inner nodes by central differences, and its Jacobian."""
    h2 = 1.0 / (n + 1) ** 2

    def f(u, p):
        padded = np.concatenate(([0.0], u, [0.0]))
        return padded[:-2] - 2 * u + padded[2:] + h2 * p * np.exp(u)

    def jac(u, p):
        square = np.diag(h2 * p * np.exp(u) - 2) + np.eye(n, k=1) + np.eye(n, k=-1)
        return np.column_stack((square, h2 * np.exp(u)))

    return f, jac


@pytest.mark.parametrize("given", [True, False])
def test_the_fold_of_bratus_problem_is_found_with_and_without_a_jacobian(given):
    folds = []
    for n in [7, 15]:
        f, jac = bratu(n)
        found = continuation.trace(f, jac if given else None, np.zeros(n), 0.0, bounds={n // 2: (-1.0, 5.0)})
        assert found.complete and found.end_reason == "bound" and found.x[-1, n // 2] == pytest.approx(5.0, abs=1e-9)
        assert np.abs([f(x, p) for x, p in zip(found.x, found.p, strict=True)]).max() < 1e-9
        (fold,) = found.at("fold")
        folds.append(found.p[fold] - FOLD)
    # Central differences err with the square of the spacing.
    assert math.log2(folds[0] / folds[1]) == pytest.approx(2.0, abs=0.1)


@pytest.mark.parametrize(("x_size", "p_size"), [(1.0, 1.0), (1e-6, 1e9)])
def test_a_pitchfork_is_a_branch_point_with_three_arms(x_size, p_size):
    def f(x, p):
        x, p = x / x_size, p / p_size
        return p * x - x**3

    def jac(x, p):
        x, p = x / x_size, p / p_size
        return np.column_stack(((p - 3 * x**2) / x_size, x / p_size))

    scaling = ([x_size, p_size], [1.0])
    found = continuation.trace(f, jac, [0.0], -p_size, bounds={"p": (-p_size, p_size)}, scaling=scaling)
    (point,) = found.at("branch-point")
    assert abs(found.p[point]) < 1e-6 * p_size and len(found.crossings[0][1]) == 3
    assert np.abs(found.x).max() < 1e-9 * x_size and found.p[-1] == pytest.approx(p_size)
    # Where it leaves its own arm it goes along x² = p.
    other = continuation.trace(
        f, jac, [0.0], -p_size, bounds={"p": (-p_size, p_size), 0: (-x_size, x_size)}, scaling=scaling, at_branch_point="switch"
    )
    assert abs(other.x[-1, 0]) == pytest.approx(x_size, rel=1e-6) or other.p[-1] == pytest.approx(p_size)


def test_a_closed_curve_comes_back_and_a_direction_is_one():
    def circle(x, p):
        return [x[0] ** 2 + p**2 - 1]

    round_trip = continuation.trace(circle, None, [1.0], 0.0)
    assert round_trip.end_reason == "closed" and round_trip.complete
    down = continuation.trace(circle, None, [1.0], 0.0, direction=-1, bounds={"p": (-0.5, 1.0)})
    assert down.p[-1] == pytest.approx(-0.5) and (np.diff(down.p) < 0).all()
    few = continuation.trace(circle, None, [1.0], 0.0, max_points=3)
    assert few.end_reason == "max-points" and not few.complete and len(few) == 3


def test_where_there_is_no_value_a_shorter_step_is_tried():
    def root(x, p):
        return [x[0] - math.sqrt(1 - p)] if p <= 1 else [1 / 0]

    found = continuation.trace(lambda x, p: [x[0] - math.log(p)] if p > 0 else [1 / 0], None, [0.0], 1.0, direction=-1, max_points=50)
    assert np.allclose(found.x[:, 0], np.log(found.p), atol=1e-9) and (found.p > 0).all()
    ended = continuation.trace(root, None, [1.0], 0.0, max_points=2000)
    assert ended.p.max() <= 1 and np.allclose(ended.x[:, 0] ** 2, 1 - ended.p, atol=1e-8)


def test_exceptions_of_the_functions_come_through_and_other_threads_go_on():
    class Mine(Exception):
        pass

    seen = []

    def f(x, p):
        seen.append(p)
        if p > 0.3:
            raise Mine(p)
        return [x[0] - p]

    with pytest.raises(Mine):
        continuation.trace(f, None, [0.0], 0.0)
    assert seen[-1] > 0.3 and threading.active_count() >= 1
