"""The gauge of a few harmonics of the angle of force that is nearest to the gauge of K, least squares of the limit load.

gamma(theta) = sum a_k cos k theta + b_k sin k theta is convex where gamma + gamma'' >= 0 (R. Schneider 2014, section 1.7): linear in the
coefficients, asked with a margin at many angles, so that the rounded coefficients satisfy it everywhere, which the kernel proves.
"""

from __future__ import annotations

from collections.abc import Iterator
from math import gcd

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from duhem.errors import InputError
from duhem.law.formula_law import Criterion
from duhem.mending.formulas import decimal, norm_of, power, total
from duhem.mending.limit_load import LoadScale, limit_loads, plain_values, ways_of

__all__ = ["by_harmonics"]

Array = NDArray[np.float64]
_MARGIN, _LEAST = 1e-3, 1e-6  # of the mean gauge
_SEEN = 1e-7  # of the mean gauge: a harmonic below is forbidden by a symmetry


def by_harmonics(law: Criterion, scale: LoadScale, most: int) -> Iterator[tuple[str, str]]:
    """g of the nearest law with ``most`` harmonics; of a symmetric law it has the same symmetry."""
    import cvxpy as cp

    ways, values = ways_of(law), plain_values(law)
    loads = limit_loads(law, values, ways) / scale.size(values)
    if not np.isfinite(loads).all():
        raise InputError("K has no end in some directions", where=law.name, remedy="mend it by hull or by parameters")
    gauge, angle = 1.0 / loads, np.arctan2(ways[:, 1], ways[:, 0])
    waves = [(k, turn) for k, turn in _symmetric(gauge) if k <= most]
    size = gauge.mean()
    table = np.column_stack([turn(k * angle) for k, turn in waves])
    bends = table * (1.0 - np.array([k for k, _ in waves]) ** 2)
    a = cp.Variable(len(waves))
    weights = loads**2 * size  # the limit load changes by -load^2 times what the gauge does
    problem = cp.Problem(
        cp.Minimize(cp.sum_squares(cp.multiply(weights, table @ a - gauge / size))), [bends @ a >= _MARGIN, table @ a >= _MARGIN]
    )
    problem.solve(solver=cp.CLARABEL)
    if a.value is None:
        raise InputError("no such gauge was found", where=law.name, remedy="ask for another number of harmonics")
    found = [(k, turn is np.sin, decimal(x * size)) for (k, turn), x in zip(waves, a.value, strict=True) if abs(x) > _LEAST]
    yield _formula(law, scale, found), f"the nearest gauge of {most} harmonics"


def _symmetric(gauge: Array) -> list[tuple[int, np.ufunc]]:
    """The waves that the symmetries of a gauge allow: turns by a part of a circle, reflections of the one force or the other."""
    found = np.fft.rfft(gauge) / len(gauge)
    seen = [k for k in range(1, len(found)) if abs(found[k]) > _SEEN * found[0].real]
    step = gcd(*seen) if seen else 1
    even = np.abs(found.imag).max() < _SEEN * found[0].real  # theta -> -theta
    odd = all(abs(found[k].imag if k % 2 == 0 else found[k].real) < _SEEN * found[0].real for k in range(1, len(found)))  # theta -> pi - theta
    waves = [(k, turn) for k in range(0, len(found), step) for turn in (np.cos, np.sin) if k or turn is np.cos]
    return [
        (k, turn) for k, turn in waves if not (even and turn is np.sin) and not (odd and (turn is np.sin) is (k % 2 == 0))
    ]


def _formula(law: Criterion, scale: LoadScale, waves: list[tuple[int, bool, str]]) -> str:
    """r^N gamma - S r^(N - 1), r the norm of the forces: polynomials and norms, without a quotient that is 0/0 at zero force."""
    x, y = sp.symbols(law.forces, real=True)
    norm, last = norm_of(law.forces), max(1, *(k for k, _, _ in waves))
    terms = list[str]()
    for k, is_sine, c in waves:
        wave = sp.expand((x + sp.I * y) ** k)
        part = sp.im(wave) if is_sine else sp.re(wave)
        terms.append("*".join([c, *([f"({part})"] if k else []), *([power(norm, last - k)] if last > k else [])]))
    return f"{total(terms)} - {'*'.join([scale.text, *([power(norm, last - 1)] if last > 1 else [])])}"
