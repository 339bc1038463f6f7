"""The free energy and its state laws (Antoni et al. 2007, Eqs. 25, 30, 31), for a full symmetric stiffness."""

from __future__ import annotations

import sympy as sp

from duhem.proof.facts.subject import Subject
from duhem.proof.verdict import Evidence, Verdict

__all__ = ["state_laws"]


def state_laws(subject: Subject) -> Evidence | None:
    """sigma = dpsi/du = -dpsi/du_in and psi convex, for psi = (u - u_in) . k (u - u_in)/2 with k = L L^T.

    Every positive semidefinite k has such a factor (Cholesky), so psi = |L^T (u - u_in)|^2/2 is a sum of squares of linear functions.
    """
    d = len(subject.law.forces)
    u, inelastic = (sp.Matrix(sp.symbols(f"{name}1:{d + 1}", real=True)) for name in ("u", "w"))
    factor = sp.Matrix(d, d, sp.symbols(f"l1:{d * d + 1}", real=True)).lower_triangular()
    elastic = u - inelastic
    stress = factor * factor.T * elastic
    energy = elastic.dot(stress) / 2
    squares = sum((r**2 for r in factor.T * elastic), sp.S.Zero) / 2
    differences = [energy - squares, *(energy.diff(u) - stress), *(energy.diff(inelastic) + stress)]
    if any(map(sp.expand, differences)):
        return None
    return Evidence(
        Verdict.PROVED,
        "symbolic",
        "sigma = k (u - u_in) = dpsi/du = -dpsi/du_in; psi = |L^T (u - u_in)|^2/2 with k = L L^T is a sum of squares",
    )
