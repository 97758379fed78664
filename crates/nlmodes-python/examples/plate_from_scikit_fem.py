"""A cantilever plate from scikit-fem, a corner of which meets a rigid stop."""

import sys

import nlmodes
import numpy as np
from skfem import Basis, BilinearForm, ElementHex2, ElementVector, MeshHex
from skfem.helpers import dot
from skfem.models.elasticity import lame_parameters, linear_elasticity


def plate(length=0.3, width=0.1, height=4e-3, cells=(8, 3)):
    """The clamped plate, steel; places in m."""
    mesh = MeshHex.init_tensor(np.linspace(0, length, cells[0] + 1), np.linspace(0, width, cells[1] + 1), np.array([0, height]))
    basis = Basis(mesh, ElementVector(ElementHex2()))
    stiffness = linear_elasticity(*lame_parameters(210e9, 0.3)).assemble(basis)
    mass = BilinearForm(lambda u, v, w: 7800.0 * dot(u, v)).assemble(basis)
    # Each place has three degrees of freedom behind each other: x, y, z.
    rows = np.arange(basis.N)
    dofs = np.column_stack((rows // 3 + 1, rows % 3 + 1, basis.doflocs.T))
    free = basis.complement_dofs(basis.get_dofs(lambda x: np.isclose(x[0], 0)))
    structure = nlmodes.Structure(stiffness[free][:, free], mass[free][:, free], dofs[free])
    return structure.contact(node=[length, width, height], normal=[0, 0, 1], gap_m=0.5e-3)


def main(figure="plate_from_scikit_fem.svg"):
    result = plate().mode(harmonics=3, max_energy_ratio=3.0)
    axes = result.plot()
    axes.figure.savefig(figure)
    return result


if __name__ == "__main__":
    main(*sys.argv[1:])
