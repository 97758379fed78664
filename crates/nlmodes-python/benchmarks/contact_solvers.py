"""`contact.solve` beside solvers of quadratic programs, on the conformance suite: time and violation.

    pip install quadprog daqp piqp clarabel
    python contact_solvers.py [AT_MOST]

Each solves min ½ λᵀ A λ + bᵀ λ over λ ≥ 0, whose solutions are those of the contact problem, with its tightest usual tolerances, scaled alike: the
diagonal of A and the largest entry of b near one. The violation is max |min(λ, g)| there. A problem counts as solved below 1e-9.
"""

import sys
import time

import numpy as np
from nlmodes import contact
from scipy import sparse
from scipy.optimize import lsq_linear


def ours(a, b):
    return contact.solve(a, b).lambda_


def with_scipy(a, b):
    values, vectors = np.linalg.eigh(a)
    root = np.sqrt(np.maximum(values, 0))
    kept = root > 1e-8 * root.max()
    factor = (vectors[:, kept] * root[kept]).T
    return lsq_linear(factor, -(vectors[:, kept] / root[kept]).T @ b, (0, np.inf), method="bvls", tol=1e-14).x


def with_quadprog(a, b):
    import quadprog

    return quadprog.solve_qp(a, -b, np.eye(len(b)), np.zeros(len(b)))[0]


def with_daqp(a, b):
    import daqp

    n = len(b)
    x, _, status, _ = daqp.solve(a, b, np.zeros((0, n)), np.full(n, 1e30), np.zeros(n), np.zeros(n, dtype=np.int32), primal_tol=1e-13, dual_tol=1e-13)
    if status != 1:
        raise ArithmeticError(status)
    return x


def with_piqp(a, b):
    import piqp

    n = len(b)
    solver = piqp.DenseSolver()
    solver.settings.eps_abs = solver.settings.eps_rel = 1e-13
    solver.setup(a, b, None, None, None, None, None, np.zeros(n), np.full(n, np.inf))
    solver.solve()
    return solver.result.x


def with_clarabel(a, b):
    import clarabel

    n = len(b)
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    settings.tol_gap_abs = settings.tol_gap_rel = settings.tol_feas = 1e-13
    cone = [clarabel.NonnegativeConeT(n)]
    p, g = sparse.csc_matrix(np.triu(a)), sparse.csc_matrix(-np.eye(n))
    return np.array(clarabel.DefaultSolver(p, b, g, np.zeros(n), cone, settings).solve().x)


SOLVERS = {"nlmodes": ours, "SciPy bvls": with_scipy, "quadprog": with_quadprog, "DAQP": with_daqp, "PIQP": with_piqp, "Clarabel": with_clarabel}


def scaled(a, b):
    d = 1 / np.sqrt(np.where(np.diag(a) > 0, np.diag(a), 1))
    return a * d[:, None] * d, b * d / max(np.abs(b * d).max(), 1e-300)


def main(at_most=100):
    cases = [case for case in contact.conformance_cases(at_most) if case.solvable and np.any(case.b)]
    problems = [scaled(case.A, case.b) for case in cases]
    print(f"{len(problems)} problems of up to {at_most} contacts\n\n| solver | solved | median time, µs | largest violation of those solved |\n| --- | --- | --- | --- |")
    for name, solve in SOLVERS.items():
        times, violations = [], []
        for a, b in problems:
            try:
                began = time.perf_counter()
                found = solve(a, b)
                times.append(time.perf_counter() - began)
                violations.append(np.abs(np.minimum(found, a @ found + b)).max())
            except ImportError:
                break
            except Exception:
                violations.append(np.inf)
        if not times:
            print(f"| {name} | not installed | | |")
            continue
        good = np.array([v for v in violations if v < 1e-9] or [np.nan])
        print(f"| {name} | {np.count_nonzero(np.array(violations) < 1e-9)} of {len(problems)} | {1e6 * np.median(times):.0f} | {good.max():.1e} |")


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
