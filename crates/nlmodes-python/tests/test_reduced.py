"""Structures that were reduced elsewhere: the same as their matrices, and what is refused."""

import nlmodes
import numpy as np
import pytest


def reduced(stiffness, mass, row, modes):
    """Frequencies, the row of one degree of freedom, and its flexibility."""
    root = np.sqrt(mass)
    squares, shapes = np.linalg.eigh(stiffness / np.outer(root, root))
    shapes = shapes[:, :modes] / root[:, None]
    flexibility = np.linalg.inv(stiffness)[row, row]
    return np.sqrt(squares[:modes]) / (2 * np.pi), shapes[[row]], [[flexibility]]


def chain(n):
    stiffness = 1e6 * (2.0 * np.eye(n) - np.eye(n, k=1) - np.eye(n, k=-1))
    stiffness[-1, -1] = 1e6
    return stiffness, np.full(n, 0.1)


def test_a_chain_reduced_here_is_that_of_its_matrices(tmp_path):
    stiffness, mass = chain(8)
    frequencies, rows, flexibility = reduced(stiffness, mass, 7, 4)
    structure = nlmodes.ReducedStructure(frequencies, rows, flexibility).contact(row=1, gap_m=1e-3)
    found = structure.mode(max_energy_ratio=3.0)
    expected = nlmodes.Structure(stiffness, np.diag(mass)).contact(8, [1, 0, 0], 1e-3).mode(max_energy_ratio=3.0, modes=4)
    assert len(found.frequency_hz) == len(expected.frequency_hz)
    assert np.allclose(found.frequency_hz, expected.frequency_hz, rtol=1e-8)
    saved = nlmodes.run(structure.save(tmp_path / "chain", continuation={"max_energy_ratio": 3.0}), out=tmp_path / "out")
    assert np.array_equal(saved.frequency_hz, found.frequency_hz)


def test_responses_act_at_rows():
    stiffness, mass = chain(8)
    frequencies, rows, flexibility = reduced(stiffness, mass, 7, 4)
    structure = nlmodes.ReducedStructure(frequencies, rows, flexibility).contact(1, 1e-3, stiffness_n_m=1e6)
    window = (0.9 * frequencies[0], 1.1 * frequencies[0])
    result = structure.response(1, [1.0], window, 0.02, output__stability="never")
    other = nlmodes.Structure(stiffness, np.diag(mass)).contact(8, [1, 0, 0], 1e-3, stiffness_n_m=1e6)
    beside = other.response(8, [1, 0, 0], [1.0], window, 0.02, reduction__modes=4, output__stability="never")
    peaks = [one.branches[0]["drive_fundamental_m"].max() for one in (result, beside)]
    assert peaks[0] == pytest.approx(peaks[1], rel=1e-6)


@pytest.mark.parametrize(
    ("make", "wanted"),
    [
        (lambda: nlmodes.ReducedStructure([1.0], [[1.0]]), "flexibility_m_n"),
        (lambda: nlmodes.ReducedStructure([1.0], [[1.0]], [[1.0]], residual_flexibility_m_n=[[1.0]]), "flexibility_m_n"),
        (lambda: nlmodes.ReducedStructure([[1.0]], [[1.0]], [[1.0]]), "frequencies_hz has the shape"),
        (lambda: nlmodes.ReducedStructure([1.0], [[np.nan]], [[1.0]]), "rows"),
        (lambda: nlmodes.ReducedStructure([1.0], [[1.0]], [[1.0]]).contact(0, 1e-3), "row is 0"),
        (lambda: nlmodes.ReducedStructure([1.0], [[1.0]], [[1.0]]).contact(1, 1e-3, side="above"), "side"),
    ],
)
def test_what_does_not_fit_is_refused_by_name(make, wanted):
    with pytest.raises((TypeError, ValueError), match=wanted):
        make()
