"""The gauge of a few harmonics of the angle of force that is nearest to the gauge of K, by least squares of the limit load.

gamma(theta) = sum a_k cos k theta + b_k sin k theta is convex where gamma + gamma'' >= 0 (R. Schneider 2014, section 1.7): linear in the
coefficients, asked with a margin at many angles, so that the rounded coefficients satisfy it everywhere, which the kernel proves.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from math import gcd

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from duhem.errors import InputError
from duhem.law.formula_law import Criterion
from duhem.regions.mending.formulas import decimal, power, total
from duhem.regions.mending.limit_load import LoadScale, limit_loads, plain_values, ways_of

__all__ = ["by_harmonics"]

Array = NDArray[np.float64]
_DIGITS = 12  # that Chebyshev's polynomials make of the short coefficients
_MARGIN, _LEAST, _SEEN = 1e-3, 1e-6, 1e-7  # of the mean gauge; a harmonic below the last is forbidden by a symmetry


def by_harmonics(law: Criterion, scale: LoadScale, most: int) -> Iterator[tuple[str, str]]:
    """g of the nearest law with ``most`` harmonics; of a symmetric law it has the same symmetry."""
    import cvxpy as cp

    ways, values = ways_of(law), plain_values(law)
    loads = limit_loads(law, values, ways) / scale.size(values)
    gauge, angle, size = 1.0 / loads, np.arctan2(ways[:, 1], ways[:, 0]), float((1.0 / loads).mean())
    waves = [(k, turn) for k, turn in _symmetric(gauge) if k <= most]
    table = np.column_stack([turn(k * angle) for k, turn in waves])
    bends = table * (1.0 - np.array([k for k, _ in waves]) ** 2)
    a = cp.Variable(len(waves))
    off = cp.multiply(loads**2 * size, table @ a - gauge / size)  # the limit load changes by -load^2 times what the gauge does
    with suppress(cp.SolverError):
        cp.Problem(cp.Minimize(cp.sum_squares(off)), [bends @ a >= _MARGIN, table @ a >= _MARGIN]).solve(solver=cp.CLARABEL)
    if a.value is None:
        raise InputError("no such gauge was found", where=law.name, remedy="ask for another number of harmonics")
    found = [(k, turn is np.sin, decimal(x * size, 4)) for (k, turn), x in zip(waves, a.value, strict=True) if abs(x) > _LEAST]
    yield _formula(law, scale, found), f"the nearest gauge of {most} harmonics"


def _symmetric(gauge: Array) -> list[tuple[int, np.ufunc]]:
    """The waves that the symmetries of a gauge allow: turns by a part of a circle, reflections of the one force or the other."""
    found = np.fft.rfft(gauge) / len(gauge)
    sizes = {np.cos: np.abs(found.real), np.sin: np.abs(found.imag)}
    seen = {turn: [k for k in range(1, len(found)) if part[k] > _SEEN * found[0].real] for turn, part in sizes.items()}
    step = gcd(*seen[np.cos], *seen[np.sin]) or 1
    mirrored = all(k % 2 == 0 for k in seen[np.cos]) and all(k % 2 for k in seen[np.sin])  # theta -> pi - theta
    waves = [(k, turn) for k in range(0, len(found), step) for turn in (np.cos, np.sin) if k or turn is np.cos]
    waves = [wave for wave in waves if wave[1] is np.cos or seen[np.sin]]  # theta -> -theta
    return [(k, turn) for k, turn in waves if not mirrored or (turn is np.cos) is (k % 2 == 0)]


def _formula(law: Criterion, scale: LoadScale, waves: list[tuple[int, bool, str]]) -> str:
    """r^N gamma - S r^(N - 1), r the norm of the forces: polynomials and norms, without a quotient that is 0/0 at zero force.

    cos k theta = T_k(cos theta) and sin k theta = sin theta U_(k - 1)(cos theta), Chebyshev's polynomials.
    """
    x, norm, last, terms = sp.Symbol("x"), f"norm({', '.join(law.forces)})", max(1, *(k for k, _, _ in waves)), list[str]()
    even = sp.Poly(sum(sp.Rational(c) * sp.chebyshevt_poly(k, x) for k, is_sine, c in waves if not is_sine), x)
    odd = sp.Poly(sum(sp.Rational(c) * sp.chebyshevu_poly(k - 1, x) for k, is_sine, c in waves if is_sine), x)
    for poly, sine in ((even, []), (odd, [law.forces[1]])):
        for (n,), c in poly.terms() if poly else ():
            rest = last - n - len(sine)
            factors = [*sine, *([power(law.forces[0], n)] if n else []), *([power(norm, rest)] if rest else [])]
            terms.append("*".join([decimal(float(c), _DIGITS), *factors]))
    return f"{total(terms)} - {'*'.join([scale.text, *([power(norm, last - 1)] if last > 1 else [])])}"
