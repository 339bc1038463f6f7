"""Yield surfaces from any direction, none unsolved: python -m tests.campaigns.yield_surfaces

10^4 directions a law and step; prints failures, the worst residual and the time.
"""

from __future__ import annotations

import time

import numpy as np

from duhem.projection import newton
from tests.oracles.optimality import R, increment, radii, shortfall

YIELD = [*(("hosford", {"m": R(m)}) for m in (6, 10, 20, 50, 100)), ("tresca", {})]


def campaign(law, values, size, n, seed=0):
    """Failures, worst residual relative to the yield stress, and seconds, over ``n`` random directions of |trial| = ``size``."""
    trial = np.random.default_rng(seed).standard_normal((n, 3))
    trial *= size / np.linalg.norm(trial, axis=1)[:, None]
    limit = R(3, 2000)
    question = increment(law, trial, yield_stress=limit, **values)
    start = time.perf_counter()
    got = newton.solve(question)
    seconds = time.perf_counter() - start
    corners = np.random.default_rng(1).standard_normal((400, 3))
    corners *= radii(increment(law, corners, yield_stress=limit, **values), corners)[:, None]
    residual = np.abs(trial - got.slip - got.stress).max() / float(limit)
    return int(got.failed.sum()), max(residual, shortfall(question, got, corners)), seconds


if __name__ == "__main__":
    for law_, values_ in YIELD:
        for size_ in (5e-3, 1e-2, 5e-2):
            failures_, worst_, seconds_ = campaign(law_, values_, size_, 10_000)
            print(f"{law_} {values_.get('m', '')} |trial| {size_}: {failures_} failures, worst {worst_:.1e}, {seconds_:.1f} s")
