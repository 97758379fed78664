#!/usr/bin/env python3
"""Frequencies, rows and static flexibility of K and M, for nlmodes."""
import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg as spla

K = sp.load_npz("K.npz").tocsc()  # free degrees of freedom, N/m
M = sp.load_npz("M.npz").tocsc()  # kg
MODES = 20
# A row each: degrees of freedom (from 0) with weights. A contact counts toward its obstacle: the first one is a node
# before a wall on the positive side, the second one two nodes that approach each other, the third one a force.
ROWS = [{8123: 1.0}, {411: 1.0, 977: -1.0}, {77: 0.6, 78: 0.8}]

n = K.shape[0]
entries = [(dof, row, weight) for row, places in enumerate(ROWS) for dof, weight in places.items()]
dofs, rows, weights = zip(*entries)
L = sp.csc_matrix((weights, (dofs, rows)), shape=(n, len(ROWS)))


def modes(shift):
    """Lowest squares and shapes with Φᵀ M Φ = 1, and the solver with K + shift M."""
    shifted = (K + shift * M).tocsc()
    factor = spla.splu(shifted)

    def solve(b):  # once more for what rounding has left: 1e-9 of large models
        x = factor.solve(b)
        return x + factor.solve(b - shifted @ x)

    inverse = spla.LinearOperator(K.shape, solve)
    squares, shapes = spla.eigsh(K, MODES, M, sigma=-shift, OPinv=inverse, tol=1e-12)
    order = np.argsort(squares)
    return squares[order], shapes[:, order], solve


FLOATS, FIRST_HZ = 0, 10.0  # number of rigid-body motions, and about the first frequency beyond them
shift = (2 * np.pi * FIRST_HZ) ** 2 if FLOATS else 0.0
squares, shapes, solve = modes(shift)
squares[:FLOATS] = 0.0


def beyond_modes(x):
    return x - shapes @ (shapes.T @ (M @ x))


# Not Lᵀ K⁻¹ L less what the modes have of it: of that difference rounding would leave fewer digits.
loads = L.toarray() - M @ (shapes @ (shapes.T @ L.toarray()))
x = beyond_modes(solve(loads))
for _ in range(30 if FLOATS else 0):  # each time what is missing shrinks by shift/(ω² + shift), ω the first mode left out
    x = beyond_modes(solve(loads + shift * (M @ x)))

np.savez("modes.npz", frequencies=np.sqrt(squares) / (2 * np.pi), rows=L.T @ shapes, residual=L.T @ x)
