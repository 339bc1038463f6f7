"""SciPy's sequential quadratic programming, point by point: what is written where no library is at hand.

    minimise (trial - sigma) . k^-1 (trial - sigma)/2   subject to   -g(sigma, sigma_n) >= 0

from the trial stress, with the gradients of both (D. Kraft 1988, DFVLR-FB 88-28).  Formula and gradient are duhem's programs over
arrays of one point, slower than a function written by hand.
"""

from __future__ import annotations

import numpy as np

from duhem.benchmark.peers.peer import PeerOptions, answered
from duhem.expression.jets import formula
from duhem.projection.increment import Increment
from duhem.projection.method import Method
from duhem.projection.result import Array, Solution

__all__ = ["SLSQP"]

_STEPS = 500


def _solve(question: Increment, options: PeerOptions) -> Solution:
    from scipy.optimize import minimize

    law = question.law
    jets = formula(question.g, law.force_symbols(), [law.symbols()[law.pressure]] if law.pressure else [])
    compliance = np.linalg.inv(question.stiffness)
    stress, failed = question.trial.copy(), np.zeros(len(question.trial), dtype=bool)
    settings = {"maxiter": _STEPS} | ({} if options.tolerance is None else {"ftol": options.tolerance})
    for i, trial in enumerate(question.trial):
        others = [question.pressure[i : i + 1]] if law.pressure else []

        def gap(x: Array, others: list[Array] = others) -> float:
            return -float(jets(x[None], others, second=False)[0].value[0])

        def slope(x: Array, others: list[Array] = others) -> Array:
            gradient = jets(x[None], others, second=False)[0].gradient
            assert gradient is not None
            return -gradient[0]

        def way(x: Array, trial: Array = trial) -> tuple[float, Array]:
            pull = compliance @ (x - trial)
            return 0.5 * float((x - trial) @ pull), pull

        if gap(trial) < 0.0:
            held = {"type": "ineq", "fun": gap, "jac": slope}
            found = minimize(way, trial, jac=True, method="SLSQP", constraints=[held], options=settings)
            stress[i], failed[i] = found.x, not found.success
    return answered(question, stress, failed)


SLSQP = Method("scipy SLSQP", lambda question: None, _solve, PeerOptions)
