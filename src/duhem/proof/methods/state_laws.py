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
    factor = sp.Matrix(d, d, lambda i, j: sp.Symbol(f"l{i + 1}{j + 1}", real=True) if i >= j else 0)
    stiffness = factor * factor.T
    elastic = u - inelastic
    energy = sp.expand((elastic.T * stiffness * elastic)[0] / 2)
    stress = stiffness * elastic
    derived = all(
        sp.expand(sp.diff(energy, u[i]) - stress[i]) == 0 == sp.expand(sp.diff(energy, inelastic[i]) + stress[i]) for i in range(d)
    )
    squares = sum((r**2 for r in factor.T * elastic), sp.S.Zero) / 2
    if not derived or sp.expand(energy - squares) != 0:
        return None
    return Evidence(
        Verdict.PROVED,
        "symbolic",
        "sigma = k (u - u_in) = dpsi/du = -dpsi/du_in; psi = |L^T (u - u_in)|^2/2 with k = L L^T is a sum of squares",
    )
