"""qpax, interior points for quadratic programs in JAX, all points at once (K. Tracy and Z. Manchester 2024, arXiv 2406.11749).

    minimise sigma . k^-1 sigma/2 - (k^-1 trial) . sigma   subject to   n_i . sigma <= b_i(sigma_n)

In doubles, which JAX has to be asked for.  What is compiled is compiled anew for each number of points.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache
from typing import Any

import numpy as np

from duhem.benchmark.peers.peer import PeerOptions, answered
from duhem.projection.affine_faces import planes
from duhem.projection.increment import Increment
from duhem.projection.method import Method
from duhem.projection.result import Solution

__all__ = ["QPAX"]


def _applies(question: Increment) -> str | None:
    return "it takes sets that are bounded by planes" if planes(question) is None else None


def _solve(question: Increment, options: PeerOptions) -> Solution:
    import jax

    found = planes(question)
    assert found is not None  # as applies has it
    normals, offsets = found
    compliance = np.linalg.inv(question.stiffness)
    with jax.enable_x64(True):
        point, done = _batched(options.tolerance)(compliance, -question.trial @ compliance, normals, offsets)
        return answered(question, np.array(point, dtype=np.float64), np.array(done) != 1)


@lru_cache(maxsize=4)
def _batched(tolerance: float | None) -> Callable[..., Any]:
    import jax
    import jax.numpy as jnp
    import qpax

    settings = {} if tolerance is None else {"solver_tol": tolerance}

    def one(quadratic: Any, linear: Any, normals: Any, offsets: Any) -> tuple[Any, Any]:
        d = linear.shape[0]
        point, _, _, _, done, _ = qpax.solve_qp(quadratic, linear, jnp.zeros((0, d)), jnp.zeros(0), normals, offsets, **settings)
        return point, done

    batched: Callable[..., Any] = jax.jit(jax.vmap(one, in_axes=(None, 0, None, 0)))
    return batched


QPAX = Method("qpax", _applies, _solve, PeerOptions)
