"""ProxQP, an augmented Lagrangian for quadratic programs, all points in parallel (A. Bambade et al. 2022, Robotics: Science and Systems).

    minimise sigma . k^-1 sigma/2 - (k^-1 trial) . sigma   subject to   n_i . sigma <= b_i(sigma_n)

Its dense back end, on every core that may be used; setting up the programs from Python is part of the time.  By default it stops
without a look at the duality gap; where a tolerance is given, the gap has to meet it too.
"""

from __future__ import annotations

import numpy as np

from duhem.benchmark.machine import cores
from duhem.benchmark.peers.peer import PeerOptions, answered
from duhem.projection.affine_faces import planes
from duhem.projection.increment import Increment
from duhem.projection.method import Method
from duhem.projection.result import Solution

__all__ = ["PROXQP"]

_BLOCK = 10_000  # programs held at once


def _applies(question: Increment) -> str | None:
    return "it takes sets that are bounded by planes" if planes(question) is None else None


def _solve(question: Increment, options: PeerOptions) -> Solution:
    from proxsuite import proxqp

    found = planes(question)
    assert found is not None  # as applies has it
    normals, offsets = found
    n, d = question.trial.shape
    compliance, count = np.linalg.inv(question.stiffness), len(normals)
    linear, below = -question.trial @ compliance, np.full(count, -np.inf)
    stress, failed = np.empty((n, d)), np.zeros(n, dtype=bool)
    for start in range(0, n, _BLOCK):
        block = range(start, min(start + _BLOCK, n))
        programs = proxqp.dense.BatchQP(len(block))
        for i in block:
            program = programs.init_qp_in_place(d, 0, count)
            if options.tolerance is not None:
                program.settings.eps_abs = program.settings.eps_duality_gap_abs = options.tolerance
                program.settings.check_duality_gap = True
            program.init(compliance, linear[i], None, None, normals, below, offsets[i])
        proxqp.dense.solve_in_parallel(programs, cores())
        for i in block:
            results = programs.get(i - start).results
            stress[i], failed[i] = results.x, results.info.status != proxqp.PROXQP_SOLVED
    return answered(question, stress, failed)


PROXQP = Method("proxqp", _applies, _solve, PeerOptions)
