"""Structures from matrices: closed forms, rods as scenes of their own, rotations, pairs, units, and what is refused."""

import nlmodes
import numpy as np
import pytest
from scipy import sparse

K2 = np.array([[1.0, -1.0], [-1.0, 2.0]])


def chain(n, k=1e6, m=0.1):
    """A clamped chain of n equal masses."""
    stiffness = sparse.diags([2.0 * np.ones(n), -np.ones(n - 1), -np.ones(n - 1)], [0, 1, -1], format="lil") * k
    stiffness[n - 1, n - 1] = k
    return sparse.csr_matrix(stiffness), m * sparse.identity(n, format="coo")


def test_the_branch_begins_at_the_linear_mode_at_grazing():
    stiffness, mass = chain(6)
    result = nlmodes.Structure(stiffness, mass).contact(node=6, normal=[1, 0, 0], gap_m=1e-3).mode(max_energy_ratio=3.0)
    squares, shapes = np.linalg.eigh(stiffness.toarray() / 0.1)
    assert result.frequency_hz[0] == pytest.approx(np.sqrt(squares[0]) / (2 * np.pi), rel=1e-9)
    # Ē = ¼ ω² Σ m q² with the tip at the gap.
    amplitude = shapes[:, 0] / shapes[5, 0] * 1e-3
    assert result.energy_j[0] == pytest.approx(0.25 * squares[0] * 0.1 * (amplitude**2).sum(), rel=1e-9)
    assert result.energy_j[-1] == pytest.approx(3 * result.energy_j[0], rel=1e-6) and result.complete
    assert np.diff(result.frequency_hz)[5:].min() > 0
    frequencies = nlmodes.Structure(stiffness, mass).contact(6, [1, 0, 0], 1e-3).linear_frequencies()
    assert frequencies[:3] == pytest.approx(np.sqrt(squares[:3]) / (2 * np.pi), rel=1e-8)


@pytest.mark.parametrize("kind", ["csr_matrix", "csc_matrix", "coo_matrix", "lil_matrix", "dia_matrix", "csr_array", "dense", "int"])
def test_every_kind_of_matrix_is_the_same_structure(kind):
    stiffness, mass = chain(4)
    if kind == "dense":
        given = stiffness.toarray(), np.asfortranarray(mass.toarray())
    elif kind == "int":
        given = stiffness.astype(np.int64), sparse.csr_matrix(mass.astype(np.float64))
    else:
        given = getattr(sparse, kind)(stiffness), getattr(sparse, kind)(mass)
    found = nlmodes.Structure(*given).contact(4, [1, 0, 0], 1e-3).mode(max_energy_ratio=1.5)
    expected = nlmodes.Structure(stiffness, mass).contact(4, [1, 0, 0], 1e-3).mode(max_energy_ratio=1.5)
    assert np.array_equal(found.frequency_hz, expected.frequency_hz)


def test_a_turned_structure_has_the_same_branch_and_another_size_a_scaled_one():
    stiffness, mass = chain(4)
    straight = nlmodes.Structure(stiffness, mass).contact(4, [1, 0, 0], 1e-3).mode(max_energy_ratio=2.0)
    # Each mass moves in a plane; across the chain it is held by springs of its own.
    angle = 0.3
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    both = np.kron(stiffness.toarray(), np.diag([1.0, 0.0])) + np.kron(np.eye(4), np.diag([0.0, 3e6]))
    rotation = np.kron(np.eye(4), turn)
    dofs = [(node, component) for node in range(1, 5) for component in ("ux", "uy")]
    turned = nlmodes.Structure(rotation @ both @ rotation.T, np.kron(mass.toarray(), np.eye(2)), dofs)
    turned = turned.contact(4, [2 * np.cos(angle), 2 * np.sin(angle), 0.0], 1e-3).mode(max_energy_ratio=2.0, modes=3)
    straight3 = nlmodes.Structure(stiffness, mass).contact(4, [1, 0, 0], 1e-3).mode(max_energy_ratio=2.0, modes=3)
    assert straight.frequency_hz[0] == pytest.approx(turned.frequency_hz[0], rel=1e-9)
    at = np.linspace(1.05, 1.95, 9)
    ours, theirs = (np.interp(at, r.energy_j / r.energy_j[0], r.frequency_hz) for r in (turned, straight3))
    assert np.allclose(ours, theirs, rtol=1e-4)
    small = nlmodes.Structure(stiffness * 1e-3, mass * 1e-9).contact(4, [1, 0, 0], 1e-6).mode(max_energy_ratio=2.0)
    ours, theirs = (np.interp(at, r.energy_j / r.energy_j[0], r.frequency_hz / r.frequency_hz[0]) for r in (small, straight))
    assert small.frequency_hz[0] == pytest.approx(1e3 * straight.frequency_hz[0], rel=1e-9) and np.allclose(ours, theirs, rtol=1e-4)


def test_a_pair_of_equal_chains_in_antiphase_is_one_before_a_wall():
    stiffness, mass = chain(3)
    dofs = [(i + 1, 1, 0.1 * i, 0.0, 0.0) for i in range(3)] + [(i + 11, 1, 0.5 - 0.1 * i, 0.0, 0.0) for i in range(3)]
    two = nlmodes.Structure(sparse.block_diag([stiffness, 1.0000001 * stiffness]), sparse.block_diag([mass, mass]), dofs)
    two = two.contact(nodes=[3], against=[13], normal=[1, 0, 0], gap_m=2e-3)
    frequencies = two.linear_frequencies()
    assert frequencies[0] == pytest.approx(frequencies[1], rel=1e-6)


def test_a_saved_structure_is_a_scene_of_the_command_line(tmp_path):
    stiffness, mass = chain(5)
    structure = nlmodes.Structure(stiffness, mass).contact(5, [1, 0, 0], 1e-3)
    path = structure.save(tmp_path / "chain", continuation={"max_energy_ratio": 2.0})
    of_scene = nlmodes.run(path, out=tmp_path / "results")
    assert np.array_equal(of_scene.frequency_hz, structure.mode(max_energy_ratio=2.0).frequency_hz)
    with pytest.raises(FileExistsError):
        structure.save(tmp_path / "chain")


def test_a_linear_response_is_that_of_the_matrices_and_a_damped_mode_begins_with_their_damping():
    stiffness, mass = chain(4)
    structure = nlmodes.Structure(stiffness, mass).contact(4, [1, 0, 0], 1e-3)
    first = float(structure.linear_frequencies()[0])
    window = (0.7 * first, 1.3 * first)
    # So weak a force that nothing touches; Rayleigh damping, so that C is a matrix.
    damping = {"stiffness_s": 1e-5}
    found = structure.response(2, [1, 0, 0], [1e-3], window, damping, harmonics=2).branches[0]
    k, m = stiffness.toarray(), mass.toarray()
    for point in range(0, len(found), max(1, len(found) // 7)):
        omega = 2 * np.pi * found.frequency_hz[point]
        q = np.linalg.solve(k + 1j * omega * 1e-5 * k - omega**2 * m, 1e-3 * np.eye(4)[1])
        # The mode that is left out answers statically: (ω/ω₄)² of its share of some percent.
        assert found.drive_fundamental_m[point] == pytest.approx(abs(q[1]), rel=5e-3)
    assert found.contact_fraction.max() == 0
    damped = structure.damped_mode(0.02, window, harmonics=3, max_energy_ratio=1.5).branches[0]
    assert damped.damping_ratio[0] == pytest.approx(0.02, rel=1e-6) and damped.frequency_hz[0] == pytest.approx(first, rel=1e-6)


@pytest.mark.parametrize(
    ("k", "m", "dofs", "error", "message"),
    [
        (K2[:1], np.eye(2), None, ValueError, r"K has the shape \(1, 2\)"),
        (K2, np.eye(3), None, ValueError, r"M has the shape \(3, 3\)"),
        (K2 * 1j, np.eye(2), None, TypeError, "K has the type complex128"),
        (sparse.csr_matrix(K2 * np.nan), np.eye(2), None, ValueError, r"K\[0, 0\] is nan"),
        (sparse.csr_matrix((0, 0)), np.eye(2), None, ValueError, "K is empty"),
        (K2, None, None, TypeError, "M"),
        (K2, np.eye(2), [(1, 1)], ValueError, "dofs has the shape"),
        (K2, np.eye(2), [(1, 7), (2, 1)], ValueError, "components are 1 to 6"),
        (K2, np.eye(2), [(1, "up"), (2, 1)], ValueError, "component 'up'"),
        (K2, np.eye(2), [(1.5, 1), (2, 1)], ValueError, "whole numbers"),
    ],
)
def test_what_is_no_structure_is_refused_by_name(k, m, dofs, error, message):
    with pytest.raises(error, match=message):
        nlmodes.Structure(k, m, dofs)


def test_what_is_no_contact_is_refused_by_name():
    structure = nlmodes.Structure(K2, np.eye(2))
    for arguments, error, message in [
        ({"node": 9, "normal": [1, 0, 0], "gap_m": 0.1}, ValueError, "node is 9"),
        ({"node": 1, "normal": [1, 0], "gap_m": 0.1}, ValueError, "normal has the shape"),
        ({"node": 1, "normal": [1, 0, 0], "gap_m": np.nan}, ValueError, "gap_m is nan"),
        ({"node": 1, "nodes": [1], "normal": [1, 0, 0], "gap_m": 0.1}, TypeError, "either node or nodes"),
        ({"node": 1, "gap_m": 0.1}, TypeError, "normal is missing"),
        ({"node": 1, "normal": [1, 0, 0]}, TypeError, "either gap_m or wall_point_m"),
        ({"nodes": [], "normal": [1, 0, 0], "gap_m": 0.1}, ValueError, "nodes is empty"),
    ]:
        with pytest.raises(error, match=message):
            structure.contact(**arguments)
    with pytest.raises(nlmodes.SceneError):
        structure.mode()
    unsymmetric = nlmodes.Structure(K2 + [[0, 0.5], [0, 0]], np.eye(2)).contact(1, [1, 0, 0], 1.0)
    with pytest.raises((nlmodes.SceneError, nlmodes.RunError), match="symmetric"):
        unsymmetric.mode(max_energy_ratio=2.0)
    assert structure.contact(1, [1, 0, 0], 1.0) is not structure and "0 contact" in repr(structure)


def test_a_place_is_the_node_that_is_there():
    stiffness, mass = chain(4)
    dofs = np.array([(10 + i, 1, 0.1 * i, 0.0, 2.0) for i in range(4)])
    structure = nlmodes.Structure(stiffness, mass, dofs)
    by_place = structure.contact(node=(0.1 + 0.2, 0.0, 2.0), normal=[1, 0, 0], gap_m=1e-3)
    by_number = structure.contact(node=13, normal=[1, 0, 0], gap_m=1e-3)
    assert np.array_equal(by_place.mode(max_energy_ratio=1.5).frequency_hz, by_number.mode(max_energy_ratio=1.5).frequency_hz)
    several = structure.contact(nodes=[11, np.array([0.2, 0.0, 2.0])], normal=[1, 0, 0], gap_m=1e-3)
    assert "1 contact" in repr(several) and several._contacts[0]["nodes"] == [11, 12]
    with pytest.raises(ValueError, match=r"node: no node is at \(0.31, 0, 2\) m; the nearest is 13 at \(0.3, 0, 2\) m"):
        structure.contact(node=[0.31, 0.0, 2.0], normal=[1, 0, 0], gap_m=1e-3)
    with pytest.raises(ValueError, match="node is a place, but dofs has no places"):
        nlmodes.Structure(stiffness, mass).contact(node=[0.3, 0.0, 2.0], normal=[1, 0, 0], gap_m=1e-3)
    with pytest.raises(ValueError, match=r"node has the shape \(2,\)"):
        structure.contact(node=[0.3, 0.0], normal=[1, 0, 0], gap_m=1e-3)
    dofs[2, 2:] = dofs[3, 2:]
    with pytest.raises(ValueError, match="the nodes 12, 13 are all at"):
        nlmodes.Structure(stiffness, mass, dofs).contact(node=[0.3, 0.0, 2.0], normal=[1, 0, 0], gap_m=1e-3)
