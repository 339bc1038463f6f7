"""The nearest law of a kind, by least squares of the limit load: a sos-convex polynomial, or a gauge of a few harmonics.

The polynomial has the monomials of a polynomial g.  Of another law of more than two forces it has degree 4, and is a form where K is
symmetric about zero force.  P is sos-convex if y . Hess P(x) y is a sum of squares of polynomials in x and y, which are linear in y; then
it is convex (Helton, Nie 2010, Math. Program. 122, 21).  That is a semidefinite condition on the coefficients.

A gauge gamma(theta) = sum a_k cos k theta + b_k sin k theta of the angle of force is convex where gamma + gamma'' >= 0 (R. Schneider 2014,
section 1.7): linear in the coefficients, asked at many angles.  Both conditions are asked with a margin, so that the rounded coefficients
satisfy them, which the kernel proves.
"""

from __future__ import annotations

from collections.abc import Iterator, Set
from contextlib import suppress
from itertools import combinations, combinations_with_replacement, product
from typing import Any
from warnings import catch_warnings, simplefilter

import numpy as np
import sympy as sp

from duhem.errors import InputError
from duhem.regions.mending.formulas import decimal, times, total
from duhem.regions.mending.limit_load import ScaledLaw, limit_loads

__all__ = ["by_coefficients", "by_harmonics"]

Monomial = tuple[int, ...]
_SOLVED = ("optimal", "optimal_inaccurate")
_MARGINS = (1e-5, 1e-4, 1e-3)  # of the mean coefficient of a Gram matrix
_LEAST, _POINTS, _MOST_SQUARES, _MOST_FORCES = 1e-9, 1000, 120, 6


def by_coefficients(scaled: ScaledLaw) -> Iterator[tuple[str, str]]:
    """g with other coefficients, the farther inside the border of sos-convexity the later; InputError for a g that is no polynomial."""
    import cvxpy as cp

    law, powers = scaled.law, _monomials(scaled)
    some = np.flatnonzero(np.isfinite(scaled.loads))[:: max(1, len(scaled.loads) // _POINTS)]
    ways, loads, degrees = scaled.ways[some], scaled.loads[some], np.array([sum(m) for m in powers])
    size, most = float(loads.mean()), int(degrees.max())
    table = np.column_stack([np.prod((ways * (loads / size)[:, None]) ** np.array(m), axis=1) for m in powers])
    old = np.linalg.lstsq(table, np.ones(len(table)))[0]
    rate = table @ (old * degrees)  # sigma . grad g, over which what g changes is what the limit load does
    a, margin = cp.Variable(len(powers)), cp.Parameter(nonneg=True)
    sides: dict[Monomial, list[Any]] = {}
    for n, m in enumerate(powers):
        for i, j in product(range(len(m)), repeat=2):  # of y . Hess(x^m) y
            place = (*(x - (k == i) - (k == j) for k, x in enumerate(m)), *((k == i) + (k == j) for k in range(len(m))))
            if min(place) >= 0:
                sides.setdefault(place, []).append(-m[i] * (m[j] - (i == j)) * a[n])
    squares = [_needed(block, set(sides)) for block in _squares(powers, len(law.forces))]
    if sum(map(len, squares)) > _MOST_SQUARES:
        raise InputError("its polynomial has too many terms for sums of squares", where=law.name, remedy="mend it by parameters")
    for block in filter(None, squares):
        gram = cp.Variable((len(block), len(block)), PSD=True)
        for (i, p), (j, q) in combinations_with_replacement(enumerate(block), 2):
            sides.setdefault(tuple(np.add(p, q)), []).append(gram[i, j] + margin if i == j else 2 * gram[i, j])
    off = cp.multiply(loads / size / rate, table @ a - 1.0)
    problem = cp.Problem(cp.Minimize(cp.sum_squares(off)), [sum(side) == 0 for side in sides.values()])
    for least in _MARGINS:
        margin.value = least * np.abs(old).mean()
        with catch_warnings(), suppress(cp.SolverError):
            simplefilter("ignore")  # that a solution may be inaccurate: it is proved, or not
            problem.solve(solver=cp.CLARABEL)
        if problem.status in _SOLVED:
            rounded = {m: decimal(x / size ** sum(m)) for m, x in zip(powers, a.value, strict=True) if abs(x) > _LEAST}
            scales = ([] if scaled.text == "1" else [(f"({scaled.text})", most - n)] for n in map(sum, rounded))
            terms = (times(c, *zip(law.forces, m, strict=True), *unit) for (m, c), unit in zip(rounded.items(), scales, strict=True))
            yield total([*terms, f"-({scaled.text})**{most}"]), f"the nearest sos-convex polynomial of degree {most}"


def _monomials(scaled: ScaledLaw) -> list[Monomial]:
    """Those of g, where it is a polynomial of the forces with numbers for coefficients; of another K with more forces those of degree 4.

    Where K is not symmetric these are of less degrees too; no change of signs alters them that leaves K as it is.
    """
    law, ways, n = scaled.law, scaled.ways[:_POINTS], len(scaled.law.forces)
    with suppress(sp.PolynomialError):
        poly = sp.Poly(law.g.xreplace(law.settled()), *law.force_symbols())
        if poly.total_degree() >= 2 and all(c.is_Rational for m, c in poly.terms() if any(m)):
            return [m for m in poly.monoms() if any(m)]
    if not (2 < n <= _MOST_FORCES and law.pressure is None and np.isfinite(scaled.loads).all()):
        raise InputError("g is no polynomial of the forces with numbers for coefficients", where=law.name, remedy="mend it in another way")
    loads = {s: limit_loads(law, scaled.values, ways * (1 - 2 * np.array(s))) for s in product((0, 1), repeat=n)}
    signs = [s for s, own in loads.items() if np.allclose(own, loads[(0,) * n])]
    least = 4 if (1,) * n in signs else 1
    return [m for m in product(range(5), repeat=n) if least <= sum(m) <= 4 and all(np.dot(s, m) % 2 == 0 for s in signs)]


def _squares(powers: list[Monomial], n: int) -> list[list[Monomial]]:
    """Monomials x^p y_j whose products stand in the form, in blocks that the changes of sign which leave P alone keep apart."""
    sizes = [sum(m) for m in powers if sum(m) >= 2]
    signs = [s for s in product((0, 1), repeat=n) if all(np.dot(s, m) % 2 == 0 for m in powers)]
    blocks: dict[tuple[int, ...], list[Monomial]] = {}
    for p in product(range(max(sizes) // 2), repeat=n):
        if (min(sizes) - 1) // 2 <= sum(p) <= max(sizes) // 2 - 1:
            for y in np.eye(n, dtype=int).tolist():
                blocks.setdefault(tuple(int(np.dot(s, np.add(p, y)) % 2) for s in signs), []).append((*p, *y))
    return list(blocks.values())


def _needed(block: list[Monomial], form: Set[Monomial]) -> list[Monomial]:
    """Without those whose square stands alone, so that it has the coefficient 0 (J. Loefberg 2009, IEEE Trans. Autom. Control 54, 1007)."""
    others = {tuple(np.add(p, q)) for p, q in combinations(block, 2)}
    kept = [p for p in block if tuple(np.add(p, p)) in form | others]
    return block if kept == block else _needed(kept, form)


_DIGITS = 12  # that Chebyshev's polynomials make of the short coefficients
_MARGIN, _SMALLEST = 1e-3, 1e-6  # of the mean gauge; a harmonic below the last is left out


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
    found = [(k, turn is np.sin, decimal(x * size, 4)) for (k, turn), x in zip(waves, a.value, strict=True) if abs(x) > _SMALLEST]
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
