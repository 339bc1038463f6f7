"""The sos-convex polynomial with the monomials of g whose limit load is nearest to that of a polynomial law.

P is sos-convex if y . Hess P(x) y is a sum of squares of polynomials in x and y, which are linear in y; then it is convex (Helton, Nie 2010,
Math. Program. 122, 21).  That is a semidefinite condition on the coefficients, asked with a margin, so that rounded ones satisfy it.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import combinations_with_replacement, product
from warnings import catch_warnings, simplefilter

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from duhem.errors import InputError
from duhem.expression.text import formula
from duhem.law.formula_law import Criterion
from duhem.mending.formulas import decimal, power, total
from duhem.mending.limit_load import limit_loads, plain_values, ways_of

__all__ = ["by_coefficients"]

Array = NDArray[np.float64]
Monomial = tuple[int, ...]
_MARGINS = (1e-5, 1e-4, 1e-3)  # of the mean coefficient of a Gram matrix
_LEAST, _POINTS, _MOST_SQUARES = 1e-9, 1000, 120


def by_coefficients(law: Criterion) -> Iterator[tuple[str, str]]:
    """g with other coefficients, the farther inside the border of sos-convexity the later; InputError for a g that is no polynomial."""
    import cvxpy as cp

    poly, ways = _polynomial(law), ways_of(law)[:: max(1, len(ways_of(law)) // _POINTS)]
    loads = limit_loads(law, plain_values(law), ways)
    ways, loads = ways[np.isfinite(loads)], loads[np.isfinite(loads)]
    powers = [m for m in poly.monoms() if any(m)]
    size = float(loads.mean())
    old = np.array([float(poly.coeff_monomial(m)) * size ** sum(m) for m in powers])
    points = ways * (loads / size)[:, None]
    table = np.column_stack([np.prod(points ** np.array(m), axis=1) for m in powers])
    rate = table @ (old * np.array([sum(m) for m in powers]))  # sigma . grad g, by which what g changes moves the limit load
    squares = _squares(powers, len(law.forces))
    if sum(map(len, squares)) > _MOST_SQUARES:
        raise InputError("the polynomial has too many terms for sums of squares", where=law.name, remedy="mend it by parameters")
    a, grams = cp.Variable(len(powers)), [cp.Variable((len(block), len(block)), PSD=True) for block in squares]
    margin = cp.Parameter(nonneg=True)
    sides: dict[Monomial, list[object]] = {}
    for block, gram in zip(squares, grams, strict=True):
        for (i, p), (j, q) in combinations_with_replacement(enumerate(block), 2):
            entry = gram[i, j] + margin if i == j else 2 * gram[i, j]
            sides.setdefault(tuple(np.add(p, q)), []).append(entry)
    for n, m in enumerate(powers):
        for place, factor in _second_derivative(m):
            sides.setdefault(place, []).append(-factor * a[n])
    weights = (loads / size / rate)[:, None] * table
    problem = cp.Problem(cp.Minimize(cp.sum_squares(weights @ (a - old))), [sum(side) == 0 for side in sides.values()])
    for least in _MARGINS:
        margin.value = least * np.abs(old).mean()
        with catch_warnings():
            simplefilter("ignore")  # that a solution may be inaccurate: it is proved, or not
            problem.solve(solver=cp.CLARABEL)
        if a.value is None:
            continue
        terms = [_term(decimal(x / size ** sum(m)), m, law.forces) for m, x in zip(powers, a.value, strict=True) if abs(x) > _LEAST]
        yield total([*terms, formula(poly.coeff_monomial(1))]), "the nearest sos-convex polynomial with the same monomials"


def _polynomial(law: Criterion) -> sp.Poly:
    try:
        poly = sp.Poly(law.g.xreplace(law.settled()), *law.force_symbols())
        if poly.total_degree() >= 2 and all(c.is_Rational for m, c in poly.terms() if any(m)):
            return poly
    except sp.PolynomialError:
        pass
    what = "g is no polynomial of the forces with numbers for coefficients"
    raise InputError(what, where=law.name, remedy="mend it in another way, or fix parameters with --set")


def _second_derivative(m: Monomial) -> Iterator[tuple[Monomial, int]]:
    """y . Hess(x^m) y: the powers of x and then of y, each with its factor."""
    for i, j in product(range(len(m)), repeat=2):
        left = [n - (k == i) - (k == j) for k, n in enumerate(m)]
        if min(left) >= 0:
            yield (*left, *((k == i) + (k == j) for k in range(len(m)))), m[i] * (m[j] - (i == j))


def _squares(powers: list[Monomial], n: int) -> list[list[Monomial]]:
    """Monomials x^p y_j whose products stand in the form, in blocks that the changes of sign which leave P alone keep apart."""
    halves = {sum(m) // 2 - 1 for m in powers if sum(m) >= 2}
    low, high = min((sum(m) - 1) // 2 for m in powers if sum(m) >= 2), max(halves)
    signs = [s for s in product((0, 1), repeat=n) if all(np.dot(s, m) % 2 == 0 for m in powers)]
    blocks: dict[tuple[int, ...], list[Monomial]] = {}
    for p in product(range(high + 1), repeat=n):
        if min(low, high) <= sum(p) <= high:
            for j in range(n):
                y = tuple(int(k == j) for k in range(n))
                blocks.setdefault(tuple(int(np.dot(s, np.add(p, y)) % 2) for s in signs), []).append((*p, *y))
    return list(blocks.values())


def _term(c: str, m: Monomial, forces: Sequence[str]) -> str:
    return "*".join([c, *(power(f, k) for f, k in zip(forces, m, strict=True) if k)])
