"""That polynomial conditions exclude each other, shown by an identity (Stengle 1974, Math. Ann. 207, 87).

A product of conditions h > 0, plus sums of squares times products of conditions h >= 0, plus multiples of what is 0, cannot be
0 where all of them hold.  A sum of squares is z' G z, G symmetric, positive semidefinite and of fractions.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from fractions import Fraction
from functools import reduce
from typing import Any

from duhem.proof.kernel.curvature import facts
from duhem.proof.kernel.domain import Bounds, StatedDomain, exact
from duhem.proof.kernel.polynomial import ONE, Polynomial, times, total
from duhem.proof.kernel.term import NotWritten, Term, minus, number, parse, sum_of

__all__ = ["Condition", "Identity", "shown"]

Condition = tuple[Polynomial, str]  # and how it stands to 0: ">", ">=" or "=="
Identity = Mapping[str, Any]
_GOAL = "the goal"  # no formula: it names what is to be refuted


def shown(poly: Polynomial, sense: str, given: Mapping[str, Condition], identities: Sequence[Identity], domain: StatedDomain) -> bool:
    """Whether some identity refutes that ``poly`` is not ``sense`` 0 (">" or ">=") somewhere in the domain where ``given`` holds."""
    against = (times({(): Fraction(-1)}, poly), ">=" if sense == ">" else ">")
    return any(_refuted({**given, _GOAL: against}, identity, domain) for identity in identities)


def _refuted(conditions: Mapping[str, Condition], identity: Identity, domain: StatedDomain) -> bool:
    """Whether the conditions and those of the domain cannot hold together, the identity being checked.

    It speaks of a condition by its name in ``conditions`` or by its formula: ``strict`` lists those of the first product;
    each of ``sums`` those it is multiplied by (``times``), the formulas ``of`` its squares and their ``gram`` matrix; each
    of ``multiples`` what is 0 (``of``) and the formula it is multiplied ``by``.
    """
    stated = [*conditions.values(), *_of_domain(domain)]

    def condition(text: str, *ops: str) -> Polynomial:
        poly = conditions[text][0] if text in conditions else _read(text, domain)
        if not any(own == poly and op in ops for own, op in stated):
            raise NotWritten(f"{text} is no condition")
        return poly

    parts = [reduce(times, (condition(text, ">") for text in identity["strict"]), ONE)]
    for entry in identity["sums"]:
        squares = [_read(text, domain) for text in entry["of"]]
        gram = [[exact(x) for x in row] for row in entry["gram"]]
        if len(gram) != len(squares) or not _positive_semidefinite(gram):
            return False
        rows = (total(*(times({(): x}, z) for x, z in zip(row, squares, strict=True))) for row in gram)
        form = total(*(times(z, row) for z, row in zip(squares, rows, strict=True)))
        parts.append(reduce(times, (condition(text, ">", ">=") for text in entry["times"]), form))
    parts += [times(condition(entry["of"], "=="), _read(entry["by"], domain)) for entry in identity["multiples"]]
    return not total(*parts)


def _of_domain(domain: StatedDomain) -> Iterator[Condition]:
    """What the parameters and the pressure satisfy."""
    law = domain.law
    ranges = {**law.parameters, **({law.pressure: Bounds(None, Fraction(0))} if law.pressure else {})}
    for name, (low, high, away) in ranges.items():
        x = Term("name", name=name)
        if low is not None:
            yield domain.polynomial(sum_of(x, number(-low))), ">" if away else ">="
        if high is not None:
            yield domain.polynomial(sum_of(number(high), minus(x))), ">" if name == law.pressure else ">="
    for c in law.constraints:
        gap = sum_of(c.args[0], minus(c.args[1]))
        if facts(gap, domain).defined:
            yield domain.polynomial(gap if c.op[0] == ">" else minus(gap)), c.op.replace("<", ">")


def _read(text: str, domain: StatedDomain) -> Polynomial:
    """A formula that is defined everywhere."""
    term = parse(text)
    if not facts(term, domain).defined:
        raise NotWritten(f"{text} is not defined everywhere")
    return domain.polynomial(term)


def _positive_semidefinite(rows: list[list[Fraction]]) -> bool:
    """By elimination, the greatest entry of the diagonal first: what is left in the end must be 0."""
    if rows != [list(column) for column in zip(*rows, strict=True)]:
        return False
    while rows:
        k = max(range(len(rows)), key=lambda i: rows[i][i])
        if (pivot := rows[k][k]) <= 0:
            return not any(map(any, rows))
        left = [i for i in range(len(rows)) if i != k]
        rows = [[rows[i][j] - rows[i][k] * rows[k][j] / pivot for j in left] for i in left]
    return True
