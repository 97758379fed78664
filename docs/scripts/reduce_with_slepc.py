#!/usr/bin/env python3
"""Frequencies, rows and static flexibility of K and M, for nlmodes: mpiexec -n 64 python3 reduce_with_slepc.py"""
import sys

import slepc4py

slepc4py.init(sys.argv)
import numpy as np
from petsc4py import PETSc
from slepc4py import SLEPc


def load(name):
    viewer = PETSc.Viewer().createBinary(name, "r")
    return PETSc.Mat().load(viewer)


K, M = load("K.petsc"), load("M.petsc")  # free degrees of freedom, N/m and kg; nothing floats
MODES = 40
ROWS = [{8123: 1.0}, {411: 1.0, 977: -1.0}, {77: 0.6, 78: 0.8}]  # degrees of freedom (from 0) with weights

eps = SLEPc.EPS().create()
eps.setOperators(K, M)
eps.setProblemType(SLEPc.EPS.ProblemType.GHEP)  # eigenvectors with φᵀ M φ = 1
eps.setDimensions(MODES)
eps.setTolerances(1e-12)
eps.setWhichEigenpairs(SLEPc.EPS.Which.TARGET_MAGNITUDE)
eps.setTarget(0.0)
st = eps.getST()
st.setType(SLEPc.ST.Type.SINVERT)
ksp = st.getKSP()
ksp.setType("richardson")  # the second time with what rounding has left: 1e-9 of large models
ksp.setNormType(PETSc.KSP.NormType.NONE)
ksp.setTolerances(max_it=2)
ksp.getPC().setType("cholesky")
ksp.getPC().setFactorSolverType("mumps")
eps.setFromOptions()
eps.solve()
assert eps.getConverged() >= MODES

loads = []
for places in ROWS:
    load_vector = K.createVecRight()
    first, last = load_vector.getOwnershipRange()
    for dof, weight in places.items():
        if first <= dof < last:
            load_vector.setValue(dof, weight)
    load_vector.assemble()
    loads.append(load_vector)

shapes, inertias, squares = [K.createVecRight() for _ in range(MODES)], [], []
for k, shape in enumerate(shapes):
    squares.append(eps.getEigenpair(k, shape).real)
    inertias.append(M * shape)
rows = [[load_vector.dot(shape) for load_vector in loads] for shape in shapes]  # a line a mode

# Not Lᵀ K⁻¹ L less what the modes have of it: of that difference rounding would leave fewer digits.
answer, residual = K.createVecRight(), []
for row, load_vector in enumerate(loads):
    beyond = load_vector.copy()
    beyond.maxpy([-line[row] for line in rows], inertias)
    ksp.solve(beyond, answer)  # the factor of K, since the target is 0
    answer.maxpy([-inertia.dot(answer) for inertia in inertias], shapes)
    residual.append([other.dot(answer) for other in loads])

if PETSc.COMM_WORLD.rank == 0:
    order = np.argsort(squares)
    frequencies = np.sqrt(np.array(squares)[order]) / (2 * np.pi)
    np.savez("modes.npz", frequencies=frequencies, rows=np.array(rows)[order], residual=residual)
