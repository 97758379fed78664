"""Contact problems: known solutions, every solver, redundant contacts, units, and SciPy beside them."""

import nlmodes
import numpy as np
import pytest
from nlmodes import contact


@pytest.fixture(params=[s for s in contact.SOLVERS if s != "closed-form"])
def solver(request):
    return request.param


def spread(c, seed, unit=1.0):
    """A compliance that is well conditioned, and gaps of 40 samples."""
    rng = np.random.default_rng(seed)
    x = rng.normal(size=(c, 2 * c))
    return unit * (x @ x.T / c), rng.normal(size=(40, c)) * 1e-3


@pytest.mark.parametrize("unit", [1.0, 1e-9, 1e6])
def test_every_solver_satisfies_the_conditions(solver, unit):
    a, b = spread(6, 1, unit)
    found = contact.solve(a, b, solver)
    assert np.allclose(found.gaps, found.lambda_ @ a + b, atol=1e-9 * np.abs(b).max())
    assert (found.lambda_ >= 0).all() and (found.gaps > -1e-13).all()
    assert np.abs(found.lambda_ * found.gaps).max() <= 1e-9 * np.abs(found.lambda_).max() * np.abs(b).max()
    assert found.violation.max() < 1e-10 and found.closed.dtype == np.bool_
    alone = contact.solve(a, b[7], solver)
    assert np.allclose(alone.lambda_, found.lambda_[7], rtol=1e-8) and alone.gaps.shape == (6,)


def test_forces_are_those_of_the_minimum_of_the_energy():
    """λ = argmin ½ λᵀ A λ + bᵀ λ over λ ≥ 0: least squares of a factor of A, which SciPy solves by itself."""
    from scipy.linalg import cholesky, solve_triangular
    from scipy.optimize import nnls

    a, b = spread(8, 2)
    root = cholesky(a)
    for gaps in b[:10]:
        expected, _ = nnls(root, -solve_triangular(root, gaps, trans=1))
        assert np.allclose(contact.solve(a, gaps).lambda_, expected, atol=1e-9 * np.abs(expected).max())


def test_responses_are_differences_of_forces_and_gaps():
    a, b = spread(5, 3)
    series = contact.Series(a)
    at = series.solve(b[3])
    response = series.response(at.closed)
    for j in range(5):
        step = np.zeros(5)
        step[j] = 1e-9
        above, below = series.solve(b[3] + step), series.solve(b[3] - step)
        assert np.allclose(response.lambda_[:, j], (above.lambda_ - below.lambda_) / 2e-9, atol=1e-4)
        assert np.allclose(response.gaps[:, j], (above.gaps - below.gaps) / 2e-9, atol=1e-4)


def test_redundant_contacts_have_forces_and_contradictions_none():
    twice = contact.solve(np.ones((2, 2)), [-1.0, -1.0])
    assert twice.lambda_.sum() == pytest.approx(1.0) and np.allclose(twice.gaps, 0.0)
    with pytest.raises(nlmodes.RunError, match="contradict"):
        contact.solve([[0.0]], [-1.0])
    with pytest.raises(nlmodes.RunError, match="sample 1"):
        contact.solve([[0.0]], [[1.0], [-1.0]])


def test_a_series_begins_where_the_last_one_ended():
    a, b = spread(10, 4)
    series = contact.Series(a)
    first = series.solve(b)
    again = series.solve(b, start="same-sample")
    assert again.iterations.max() <= 1 and np.allclose(again.lambda_, first.lambda_, rtol=1e-9)
    with pytest.raises(ValueError, match="start is 'warm'"):
        series.solve(b, start="warm")


def test_the_suite_is_solved_or_told_to_have_no_solution():
    solved = contradictory = 0
    for case in contact.conformance_cases(20):
        if case.solvable:
            found = contact.solve(case.A, case.b)
            assert found.violation < 1e-10 and np.allclose(found.gaps, case.A @ found.lambda_ + case.b, atol=1e-8 * np.abs(case.b).max(initial=0)), case.name
            solved += 1
        else:
            with pytest.raises(nlmodes.RunError, match="contradict"):
                contact.solve(case.A, case.b)
            contradictory += 1
    assert solved > 20 and contradictory > 0
