"""Waves of an angle as algebra: cos(k atan2(q, p)) is Re (p + i q)^k / |(p, q)|^k for whole k, sin its Im (de Moivre 1722).

Both sides are undefined at p = q = 0, and there alone, so that the formula stays what it is.
"""

from __future__ import annotations

from fractions import Fraction
from math import comb, prod

from duhem.proof.kernel.term import Term, bounded, factors, number, product_of, sum_of

__all__ = ["without_angles"]

_MOST_TURNS = 24


def without_angles(term: Term) -> Term:
    """The formula with the waves of whole multiples of an angle as quotients; NotWritten where that is too large."""
    here = term._replace(args=tuple(map(without_angles, term.args)))
    if here.op not in ("cos", "sin"):
        return here
    (angle,) = here.args
    turns = prod((x.value for x in factors(angle) if x.op == "number"), start=Fraction(1))
    moving = [x for x in factors(angle) if x.op != "number"]
    if [x.op for x in moving] != ["atan2"] or turns.denominator > 1 or not 0 < abs(turns) <= _MOST_TURNS:
        return here
    ((q, p),), k, odd = (x.args for x in moving), abs(int(turns)), here.op == "sin"
    sense = -1 if odd and turns < 0 else 1
    parts = (
        product_of(number(sense * (-1) ** (j // 2) * comb(k, j)), Term("**", (p, number(k - j))), Term("**", (q, number(j))))
        for j in range(odd, k + 1, 2)
    )
    return bounded(product_of(sum_of(*parts), Term("**", (Term("norm", (p, q)), number(-k)))))
