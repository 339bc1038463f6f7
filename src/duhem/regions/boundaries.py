"""Polynomials of several parameters that may tell where a claim holds from where it fails.  Nothing here is trusted.

They are the principal minors of a quadratic g; of a dent, its values where its ray ends and its discriminant, which vanishes where the dent
touches zero; and of two parameters the sum and the difference.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from contextlib import suppress
from itertools import combinations

import sympy as sp

from duhem.proof.kernel.curvature import over
from duhem.proof.kernel.dents import Dent, form_of
from duhem.proof.kernel.forms import principal_minors
from duhem.proof.kernel.polynomial import Polynomial, in_powers, replaced
from duhem.proof.kernel.signs import RAY
from duhem.proof.kernel.stated_law import StatedLaw
from duhem.proof.kernel.term import UNREADABLE, NotWritten

__all__ = ["boundaries"]

_MOST_MINORS, _MOST_DEGREE, _MOST_TERMS, _MOST_FOUND = 4, 6, 40, 24


def boundaries(law: StatedLaw, names: Sequence[str], dents: Iterable[Dent]) -> list[str]:
    """Polynomials in ``names``, as text, the shorter first; ``law`` is at plain values of its other parameters."""
    found = dict[str, int]()
    for poly in (*_minors(law), *(part for dent in dents for part in _of_dent(dent)), *_sums(names)):
        for factor, _ in sp.factor_list(poly)[1] if not poly.is_number else ():
            if {x.name for x in factor.free_symbols} <= {*names} and len(sp.Add.make_args(factor)) <= _MOST_TERMS:
                found.setdefault(str(factor), len(sp.Add.make_args(sp.expand(factor))))
    return sorted(found, key=lambda text: (found[text], len(text)))[:_MOST_FOUND]


def _sums(names: Sequence[str]) -> Iterator[sp.Expr]:
    for one, two in combinations([sp.Symbol(name) for name in names], 2):
        yield one - two
        yield one + two


def _minors(law: StatedLaw) -> Iterator[sp.Expr]:
    with suppress(*UNREADABLE):
        for _, minor in principal_minors(form_of(law), over(law), _MOST_MINORS):
            with suppress(NotWritten):
                yield sp.fraction(sp.together(_expression(minor)))[0]


def _of_dent(dent: Dent) -> Iterator[sp.Expr]:
    with suppress(*UNREADABLE):
        for end in dent.between:
            yield sp.fraction(sp.together(_expression(replaced(dent.poly, RAY, {(): end} if end else {}))))[0]
        if len(in_powers(dent.poly, RAY)) <= _MOST_DEGREE + 1:
            ray = sp.Symbol(_RAY)
            yield sp.discriminant(sp.fraction(sp.together(_expression(dent.poly)))[0], ray)


_RAY = "ray of the dent"


def _expression(poly: Polynomial) -> sp.Expr:
    """As SymPy's; NotWritten where something else than names is in it."""
    parts = list[sp.Expr]()
    for m, c in poly.items():
        if any(x.op != "name" for x, _ in m):
            raise NotWritten("it is no polynomial of names")
        powers = (sp.Symbol(_RAY if x == RAY else x.name) ** n for x, n in m)
        parts.append(sp.Rational(c.numerator, c.denominator) * sp.Mul(*powers))
    return sp.Add(*parts)
