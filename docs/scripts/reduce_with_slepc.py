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
ksp.setType("preonly")
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

shape, answer = K.createVecRight(), K.createVecRight()
squares, rows = [], []
for k in range(MODES):
    squares.append(eps.getEigenpair(k, shape).real)
    rows.append([load_vector.dot(shape) for load_vector in loads])  # a line a mode
flexibility = []
for load_vector in loads:
    ksp.solve(load_vector, answer)  # the factor of K, since the target is 0
    flexibility.append([other.dot(answer) for other in loads])

if PETSc.COMM_WORLD.rank == 0:
    order = np.argsort(squares)
    frequencies = np.sqrt(np.array(squares)[order]) / (2 * np.pi)
    np.savez("modes.npz", frequencies=frequencies, rows=np.array(rows)[order], flexibility=flexibility)
