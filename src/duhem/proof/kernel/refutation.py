"""That polynomial conditions exclude each other, shown by an identity (Stengle 1974, Math. Ann. 207, 87).

A product of conditions h > 0, plus sums of squares times products of conditions h >= 0, plus multiples of what is 0, cannot be
0 where all of them hold.  A sum of squares is z' G z, G symmetric, positive semidefinite and of fractions.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from fractions import Fraction
from functools import reduce
from math import lcm
from typing import Any

from duhem.proof.kernel.curvature import facts
from duhem.proof.kernel.domain import ANY, POSITIVE, ZERO, Sign, StatedDomain, exact
from duhem.proof.kernel.polynomial import ONE, Polynomial, times, total
from duhem.proof.kernel.term import NotWritten, parse

__all__ = ["Condition", "Identity", "shown"]

Condition = tuple[Polynomial, str]  # and how it stands to 0: ">", ">=" or "=="
Identity = Mapping[str, Any]
_MOST_PRODUCTS = 4_000_000  # of terms, in a product of an identity
_GOAL = "the goal"  # no formula: it names what is to be refuted
_ENOUGH = {">": ((">",), POSITIVE), ">=": ((">", ">="), POSITIVE | ZERO), "==": (("==",), ZERO)}  # conditions, or signs


def shown(poly: Polynomial, sense: str, given: Mapping[str, Condition], identities: Sequence[Identity], domain: StatedDomain) -> bool:
    """Whether some identity refutes that ``poly`` is not ``sense`` 0 (">" or ">=") somewhere in the domain where ``given`` holds."""
    against = (times({(): Fraction(-1)}, poly), ">=" if sense == ">" else ">")
    return any(_speaks({**given, _GOAL: against}, identity, domain) for identity in identities)


def _speaks(conditions: Mapping[str, Condition], identity: Identity, domain: StatedDomain) -> bool:
    """Whether the identity is about these conditions, not those of another place, and refutes them."""
    try:
        return _refuted(conditions, identity, domain)
    except NotWritten:
        return False


def _refuted(conditions: Mapping[str, Condition], identity: Identity, domain: StatedDomain) -> bool:
    """Whether the conditions cannot hold together anywhere in the domain, the identity being checked.

    It speaks of a condition by its name in ``conditions`` or by its formula; formulas whose sign the domain shows are
    conditions too.  ``strict`` lists those of the first product; each of ``sums`` those it is multiplied by (``times``), the
    formulas ``of`` its squares and their ``gram`` matrix; each of ``multiples`` what is 0 (``of``) and the formula ``by``
    which it is multiplied.
    """

    def condition(text: str, op: str) -> Polynomial:
        poly, sign = (conditions[text][0], ANY) if text in conditions else _read(text, domain)
        ops, signs = _ENOUGH[op]
        if not any(own == poly and stands in ops for own, stands in conditions.values()) and (not sign or sign & ~signs):
            raise NotWritten(f"{text} {op} 0 is no condition")
        return poly

    grams = list[list[list[Fraction]]]()
    parts = [_product(condition(text, ">") for text in identity["strict"])]
    for entry in identity["sums"]:
        grams.append([[exact(x) for x in row] for row in entry["gram"]])
        if {len(entry["of"])} != {len(grams[-1]), *map(len, grams[-1])}:
            return False
        form = _quadratic_form([_read(text, domain)[0] for text in entry["of"]], grams[-1])
        parts.append(_product((form, *(condition(text, ">=") for text in entry["times"]))))
    parts += [_product((condition(entry["of"], "=="), _read(entry["by"], domain)[0])) for entry in identity["multiples"]]
    return not total(*parts) and all(map(_positive_semidefinite, grams))


def _product(factors: Iterable[Polynomial]) -> Polynomial:
    return reduce(lambda one, two: times(one, two, _MOST_PRODUCTS), factors, ONE)


def _quadratic_form(squares: Sequence[Polynomial], gram: Sequence[Sequence[Fraction]]) -> Polynomial:
    """z' G z for the polynomials z."""
    rows = [total(*(times({(): g}, z) for g, z in zip(row, squares, strict=True) if g)) for row in gram]
    return total(*(_product(pair) for pair in zip(squares, rows, strict=True)))


def _read(text: str, domain: StatedDomain) -> tuple[Polynomial, Sign]:
    """A formula that is defined everywhere, and the signs it may have."""
    known = facts(term := parse(text), domain)
    if not known.defined:
        raise NotWritten(f"{text} is not defined everywhere")
    return domain.polynomial(term), known.sign


def _positive_semidefinite(gram: list[list[Fraction]]) -> bool:
    """By elimination, the greatest entry of the diagonal first: what is left in the end must be 0.

    In whole numbers: each step divides by the pivot before (Bareiss 1968, Math. Comp. 22, 565), which is > 0.
    """
    if gram != [list(column) for column in zip(*gram, strict=True)]:
        return False
    below, before = lcm(*(x.denominator for row in gram for x in row)), 1
    rows = [[x.numerator * (below // x.denominator) for x in row] for row in gram]
    while rows:
        k = max(range(len(rows)), key=lambda i: rows[i][i])
        if (pivot := rows[k][k]) <= 0:
            return not any(map(any, rows))
        left = [i for i in range(len(rows)) if i != k]
        rows = [[(pivot * rows[i][j] - rows[i][k] * rows[k][j]) // before for j in left] for i in left]
        before = pivot
    return True
