"""A formula without what is done to it in the end and keeps its sign: {phi(f) <= 0} is {f <= 0} where phi has the sign of its argument."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction

from duhem.proof.kernel.curvature import facts, over
from duhem.proof.kernel.domain import NEGATIVE, POSITIVE, ZERO, Bounds, StatedDomain, StatedLaw
from duhem.proof.kernel.steps import pay
from duhem.proof.kernel.term import Term, factors, minus, number

__all__ = ["without_outer_map"]

_SIZE = Term("name", name="size of the inner formula")  # no name of a law has blanks


def without_outer_map(law: StatedLaw) -> StatedLaw:
    """The law with the innermost formula that has the sign of g wherever it is defined; g is defined there too."""
    domain = over(law._replace(parameters={**law.parameters, _SIZE.name: Bounds(Fraction(0), None, True)}))
    g: Term | None = law.g
    while g is not None:
        law = law._replace(g=g)
        g = _without_positive_factors(g, domain) or next((f for f in dict.fromkeys(_parts(g)) if _keeps_sign(g, f, domain)), None)
    return law


def _without_positive_factors(g: Term, domain: StatedDomain) -> Term | None:
    known = [(f, facts(f, domain)) for f in factors(g)]
    left = [f for f, shown in known if not (shown.defined and shown.sign == POSITIVE)]
    return left[0] if len(left) == 1 < len(known) else None


def _keeps_sign(g: Term, f: Term, domain: StatedDomain) -> bool:
    """Whether g is a formula in f alone that is defined, and > 0, = 0, < 0 where f is."""
    ways = ((number(0), ZERO), (_SIZE, POSITIVE), (minus(_SIZE), NEGATIVE))
    if domain.constant(f) or not _alone(g, f, domain):
        return False
    return all(facts(g.put({f: x}), domain).defined and facts(g.put({f: x}), domain).sign == sign for x, sign in ways)


def _alone(g: Term, f: Term, domain: StatedDomain) -> bool:
    """Whether the forces enter g by f alone."""
    pay(1)
    return g == f or domain.constant(g) or (g.op != "name" and all(_alone(a, f, domain) for a in g.args))


def _parts(term: Term) -> Iterator[Term]:
    for a in term.args:
        yield a
        yield from _parts(a)
