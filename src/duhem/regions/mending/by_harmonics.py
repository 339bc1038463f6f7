"""The gauge of a few harmonics of the angle of force that is nearest to the gauge of K, by least squares of the limit load.

gamma(theta) = sum a_k cos k theta + b_k sin k theta is convex where gamma + gamma'' >= 0 (R. Schneider 2014, section 1.7): linear in the
coefficients, asked with a margin at many angles, so that the rounded coefficients satisfy it everywhere, which the kernel proves.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress

import numpy as np
import sympy as sp

from duhem.errors import InputError
from duhem.regions.mending.formulas import decimal, times, total
from duhem.regions.mending.limit_load import ScaledLaw

__all__ = ["by_harmonics"]

_DIGITS = 12  # that Chebyshev's polynomials make of the short coefficients
_MARGIN, _LEAST = 1e-3, 1e-6  # of the mean gauge; a harmonic below the last is left out


def by_harmonics(scaled: ScaledLaw, most: int) -> Iterator[tuple[str, str]]:
    """g of the nearest law with ``most`` harmonics.

    Of a symmetric law it has the same symmetry: the nearest gauge is the only one.
    """
    import cvxpy as cp

    gauge, angle = 1.0 / scaled.loads, np.arctan2(scaled.ways[:, 1], scaled.ways[:, 0])
    size, waves = float(gauge.mean()), [(k, turn) for k in range(most + 1) for turn in (np.cos, np.sin) if k or turn is np.cos]
    table = np.column_stack([turn(k * angle) for k, turn in waves])
    bends = table * (1.0 - np.array([k for k, _ in waves]) ** 2)
    a = cp.Variable(len(waves))
    off = cp.multiply((scaled.loads * size) ** 2, table @ a - gauge / size)  # the limit load changes by -load^2 times what the gauge does
    with suppress(cp.SolverError):
        cp.Problem(cp.Minimize(cp.sum_squares(off)), [bends @ a >= _MARGIN, table @ a >= _MARGIN]).solve(solver=cp.CLARABEL)
    if a.value is None:
        raise InputError("no such gauge was found", where=scaled.law.name, remedy="ask for another number of harmonics")
    found = [(k, turn is np.sin, decimal(x * size, 4)) for (k, turn), x in zip(waves, a.value, strict=True) if abs(x) > _LEAST]
    yield _formula(scaled, found), f"the nearest gauge of {most} harmonic{'s' * (most > 1)}"


def _formula(scaled: ScaledLaw, waves: list[tuple[int, bool, str]]) -> str:
    """r^N gamma - S r^(N - 1), r the norm of the forces: polynomials and norms, without a quotient that is 0/0 at zero force.

    cos k theta = T_k(cos theta) and sin k theta = sin theta U_(k - 1)(cos theta), Chebyshev's polynomials.
    """
    first, second = scaled.law.forces
    x, norm, last, terms = sp.Symbol("x"), f"norm({first}, {second})", max(1, *(k for k, _, _ in waves)), list[str]()
    for sine in (0, 1):
        wave = sp.chebyshevu_poly if sine else sp.chebyshevt_poly
        poly = sp.Poly(sum(sp.Rational(c) * wave(k - sine, x) for k, is_sine, c in waves if is_sine == sine), x)
        for (n,), c in poly.terms() if poly else ():
            terms.append(times(decimal(float(c), _DIGITS), (second, sine), (first, n), (norm, last - n - sine)))
    return f"{total(terms)} - {times(scaled.text, (norm, last - 1))}"
