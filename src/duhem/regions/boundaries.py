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
from duhem.proof.kernel.domain import NEGATIVE, POSITIVE, StatedDomain
from duhem.proof.kernel.forms import principal_minors
from duhem.proof.kernel.polynomial import Polynomial, in_powers, replaced
from duhem.proof.kernel.signs import RAY
from duhem.proof.kernel.stated_law import StatedLaw
from duhem.proof.kernel.term import UNREADABLE, NotWritten, parse

__all__ = ["boundaries", "deciding_parameters"]

_MOST_MINORS, _MOST_DEGREE, _MOST_TERMS, _MOST_FOUND = 4, 6, 40, 24


def boundaries(law: StatedLaw, names: Sequence[str], dents: Iterable[Dent]) -> list[str]:
    """Polynomials in ``names``, as text, the shorter first; ``law`` is at plain values of its other parameters."""
    found = dict[str, int]()
    for poly in (*_minors(law), *(part for dent in dents for part in _of_dent(dent)), *_sums(names)):
        for factor, _ in sp.factor_list(poly)[1] if not poly.is_number else ():
            if {x.name for x in factor.free_symbols} <= {*names} and len(sp.Add.make_args(factor)) <= _MOST_TERMS:
                found.setdefault(str(factor), len(sp.Add.make_args(sp.expand(factor))))
    return sorted(found, key=lambda text: (found[text], len(text)))[:_MOST_FOUND]


def deciding_parameters(law: StatedLaw) -> tuple[str, ...]:
    """Those in the factors of the minors of a quadratic g that may have either sign; none for another g."""
    domain, names = over(law), set[str]()
    for minor in _minors(law):
        for factor, _ in sp.factor_list(minor)[1]:
            sign = domain.facts(term := parse(str(factor))).sign
            names |= term.names() if sign & POSITIVE and sign & NEGATIVE else set()
    return tuple(name for name, own in law.parameters.items() if name in names and not own.single)


def _sums(names: Sequence[str]) -> Iterator[sp.Expr]:
    for one, two in combinations([sp.Symbol(name) for name in names], 2):
        yield one - two
        yield one + two


def _minors(law: StatedLaw) -> Iterator[sp.Expr]:
    with suppress(*UNREADABLE):
        domain = over(law)
        for _, minor in principal_minors(form_of(law), domain, _MOST_MINORS):
            with suppress(NotWritten):
                yield sp.fraction(sp.together(_expression(minor, domain)))[0]


def _of_dent(dent: Dent) -> Iterator[sp.Expr]:
    with suppress(*UNREADABLE):
        for end in dent.between:
            yield sp.fraction(sp.together(_expression(replaced(dent.poly, RAY, {(): end} if end else {}), dent.domain)))[0]
        if len(in_powers(dent.poly, RAY)) <= _MOST_DEGREE + 1:
            ray = sp.Symbol(_RAY)
            yield sp.discriminant(sp.fraction(sp.together(_expression(dent.poly, dent.domain)))[0], ray)


_RAY = "ray of the dent"


def _expression(poly: Polynomial, domain: StatedDomain) -> sp.Expr:
    """As SymPy's; NotWritten where something else is in it than whole powers of names and even ones of roots."""
    parts = list[sp.Expr]()
    for m, c in poly.items():
        powers = [sp.Symbol(_RAY if x == RAY else x.name) ** n for x, n in m if x.op == "name"]
        for x, n in ((x, n) for x, n in m if x.op != "name"):
            if x.op != "**" or x.args[1].op != "number" or (k := x.args[1].value * n).denominator != 1:
                raise NotWritten("it is no polynomial of names")
            powers.append(_expression(domain.polynomial(x.args[0]), domain) ** int(k))
        parts.append(sp.Rational(c.numerator, c.denominator) * sp.Mul(*powers))
    return sp.Add(*parts)
