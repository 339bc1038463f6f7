"""An increment in six stresses as one in three principal stresses, where the law and the stiffness are isotropic.

The closest stress then has the axes of the trial, and its principal stresses are closest to those of the trial in the K that they have
(A. S. Lewis 1996, SIAM J. Optim. 6, 164-177).  There planes bound the K of Tresca and of Mohr and Coulomb, and edges where two principal
stresses are equal are corners.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from duhem.expression.vocabulary import EigMax, symbol
from duhem.law.formula_law import Criterion
from duhem.projection.increment import Increment, stiffness_matrix
from duhem.projection.metric import ROUNDING
from duhem.projection.result import Array, Solution
from duhem.projection.row_by_row import widest

__all__ = ["Principal", "principal"]

_ROWS, _COLUMNS = (0, 1, 2, 1, 0, 0), (0, 1, 2, 2, 2, 1)  # of the entries xx, yy, zz, yz, xz, xy
_MATRIX = np.array([[0, 5, 4], [5, 1, 3], [4, 3, 2]])
_FAR = 1e3  # stresses: the axes of a trial farther off leave rounding of its size
_NEAR = 1e-6  # of the trial: a way to the boundary that is shorter has lost as many digits


@dataclass(frozen=True, eq=False)
class Principal:
    """The increments in principal stresses, the ``axes`` (N, 3, 3) of the trials, and the ``places`` of the entries among the forces."""

    increment: Increment
    axes: Array
    places: NDArray[np.intp]

    def back(self, found: Solution) -> tuple[Solution, NDArray[np.bool_]]:
        """The solution in six stresses, and where it has its digits (N,)."""
        stress, slip = np.empty((2, len(self.axes), 6))
        for into, own in ((stress, found.stress), (slip, found.slip)):
            into[:, self.places] = ((self.axes * own[:, None]) @ np.swapaxes(self.axes, 1, 2))[:, _ROWS, _COLUMNS]
        slip[:, self.places[3:]] *= 2.0  # a shear strain of engineers is twice the entry
        far = widest(self.increment.trial)
        away = widest(self.increment.trial - found.stress)
        return Solution(stress, slip, found.multiplier, found.failed), (away > _NEAR * far) & (far / _FAR < widest(found.stress))


def principal(question: Increment) -> Principal | None:
    """Those of a question; None where the law is not known to be isotropic, or the stiffness is not."""
    if (made := _reduced(question.law)) is None:
        return None
    law, known, places = made
    k = question.stiffness[np.ix_(places, places)]
    shear, bulk = 2.0 * k[3, 3], 2.0 * k[3, 3] + 3.0 * k[0, 1]  # the two eigenvalues
    isotropic = np.diag([shear] * 3 + [k[3, 3]] * 3)
    isotropic[:3, :3] += k[0, 1]
    if np.abs(isotropic - k).max() > ROUNDING * min(shear, bulk):
        return None
    with np.errstate(over="ignore", invalid="ignore"):
        values, axes = np.linalg.eigh(question.trial[:, places[_MATRIX]])
    if not np.isfinite(values).all():
        return None
    stiffness, diagonal = stiffness_matrix(isotropic[:3, :3], law.forces)
    own = replace(question, law=law, g=question.g.xreplace(known), trial=values, stiffness=stiffness, diagonal=diagonal)
    return Principal(own, axes, places)


@lru_cache(maxsize=64)
def _reduced(law: Criterion) -> tuple[Criterion, dict[sp.Expr, sp.Expr], NDArray[np.intp]] | None:
    """The law in principal stresses, what takes the place of eigenvalues and entries in it, and where xx, yy, zz, yz, xz, xy stand.

    Of a law whose stresses stand in eigenvalues and in the trace alone, with ranges on none of them.
    """
    forces = law.force_symbols()
    entries = next((node.args for node in law.g.atoms(EigMax) if set(node.args) == set(forces)), None)
    names = "principal_1", "principal_2", "principal_3"
    if entries is None or law.domain or set(names) & set(law.symbols()):
        return None
    nodes, trace = (EigMax(*entries), EigMax(*(-x for x in entries))), sp.Dummy()
    rest = law.g.xreplace({**{node: sp.Dummy() for node in nodes}, entries[0]: trace - entries[1] - entries[2]})
    if rest.free_symbols & set(forces):
        return None
    s = [symbol(name) for name in names]
    known = {nodes[0]: sp.Max(*s), nodes[1]: sp.Max(*(-x for x in s)), **dict(zip(entries, s, strict=False))}
    made = Criterion(law.name, law.g.xreplace(known), law.parameters, names, law.pressure, law.constraints)
    return made, known, np.array([forces.index(x) for x in entries])
