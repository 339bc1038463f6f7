"""Whether a formula is the support function of K, for gauges of separate forces.

A positively homogeneous function of one force is h(x) = a pos(x) + b neg(x) with a = h(1), b = h(-1).  The norm, the
greatest and the sum of such functions of separate forces, a, b > 0, have as polars the norm, the sum and the greatest of
pos(d)/a + neg(d)/b, and K = {gauge <= R} has R times the polar as its support function (Rockafellar 1970, sections 13, 15).
"""

from __future__ import annotations

from collections.abc import Mapping

from duhem.proof.kernel.curvature import facts
from duhem.proof.kernel.domain import POSITIVE, StatedDomain
from duhem.proof.kernel.term import Term, minus, number

__all__ = ["is_support_function"]

_DUAL = {"norm": "norm", "max": "+", "+": "max"}
Weights = Mapping[str, tuple[Term, Term]]  # of each variable: the factors of pos and of neg


def is_support_function(potential: Term, dual: Mapping[str, str], domain: StatedDomain) -> bool:
    """Whether ``potential`` = sup {sigma . d : g <= 0} with g of ``domain``'s law; ``dual`` names the slip of each force."""
    g, forces = domain.law.g, domain.law.forces
    terms = g.args if g.op == "+" else (g,)
    moving, still = ([t for t in terms if domain.constant(t) is c] for c in (False, True))
    radius = minus(Term("+", (number(0), *still)))
    if set(dual) != set(forces) or len(set(dual.values())) != len(forces) or set(dual.values()) & (g.names() | set(forces)):
        return False
    gauge = _separate(moving[0] if len(moving) == 1 else Term("+", tuple(moving)), set(forces), domain)
    other = _separate(potential, set(dual.values()), domain)
    if gauge is None or other is None or not (facts(radius, domain).defined and facts(radius, domain).sign == POSITIVE):
        return False
    if len(forces) > 1 and _DUAL[gauge[0]] != other[0]:
        return False
    if set(gauge[1]) != set(forces) or set(other[1]) != set(dual.values()):
        return False
    for force, slip in dual.items():
        for a, b in zip(gauge[1][force], other[1][slip], strict=True):
            known = facts(a, domain)
            if not (known.defined and known.sign == POSITIVE and facts(b, domain).defined):
                return False
            if domain.polynomial(Term("+", (Term("*", (a, b)), minus(radius)))):
                return False
    return True


def _separate(term: Term, names: set[str], domain: StatedDomain) -> tuple[str, Weights] | None:
    """How the functions of one variable each are put together, and their weights; None for anything else."""
    used = term.names() & names
    if term.op == "*":
        factors = _factors(term)
        moving = [a for a in factors if a.names() & names]
        scale = Term("*", tuple(a for a in factors if a not in moving) or (number(1),))
        inner = _separate(moving[0], names, domain) if len(moving) == 1 else None
        if inner is None or not facts(scale, domain).defined or facts(scale, domain).sign != POSITIVE:
            return None
        return inner[0], {x: (Term("*", (scale, p)), Term("*", (scale, m))) for x, (p, m) in inner[1].items()}
    if len(used) == 1 and _homogeneous(term, names):
        (x,) = used
        here = Term("name", name=x)
        return "+", {x: (term.put({here: number(1)}), term.put({here: number(-1)}))}
    parts = [_separate(a, names, domain) if a.names() & names else None for a in term.args] if term.op in _DUAL else [None]
    weights: dict[str, tuple[Term, Term]] = {}
    for part in parts:
        if part is None or len(part[1]) != 1:
            return None
        for x, (plus, negative) in part[1].items():
            sized = (Term("abs", (plus,)), Term("abs", (negative,)))
            weights[x] = sized if term.op == "norm" else (plus, negative)
    if len(weights) != len(parts):
        return None
    return term.op, weights


def _factors(term: Term) -> list[Term]:
    return [f for a in term.args for f in _factors(a)] if term.op == "*" else [term]


def _homogeneous(term: Term, names: set[str]) -> bool:
    """Of degree 1 under positive factors."""
    if term.op == "name":
        return term.name in names
    if term.op == "*":
        moving = [a for a in term.args if a.names() & names]
        return len(moving) == 1 and _homogeneous(moving[0], names)
    return term.op in ("+", "abs", "pos", "neg", "norm", "max", "min") and all(_homogeneous(a, names) for a in term.args)
