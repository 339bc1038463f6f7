"""The same law said more simply: as two laws, by a choice that no force enters, or without a map of its formula that keeps the sign.

Where no force enters a choice, the law at each value of parameters and pressure is one of two laws, each where its condition holds.  A
claim is made at every such value: so it holds of the law if it holds of either, the condition being one constraint more.

Where phi(f) has the sign of f, {phi(f) <= 0} is {f <= 0}, with the same boundary.
"""

from __future__ import annotations

from fractions import Fraction

from duhem.proof.kernel.curvature import over
from duhem.proof.kernel.definedness import AGAINST
from duhem.proof.kernel.domain import NEGATIVE, POSITIVE, ZERO, Bounds, StatedDomain, StatedLaw
from duhem.proof.kernel.steps import pay
from duhem.proof.kernel.term import Term, factors, minus, number

__all__ = ["cases", "without_outer_map"]

_SIZE = Term("name", name="size of the inner formula")  # no name of a law has blanks


def cases(law: StatedLaw) -> tuple[StatedLaw, ...]:
    """The two laws that a choice leaves, none where every choice is by the forces."""
    written = (law.g, *(law.flow or ()), *(part for g, flow in law.surfaces for part in (g, *(flow or ()))))
    domain = over(law)
    for term in (*written, *([] if law.potential is None else [law.potential])):
        choice = _choice(term, domain)
        if choice is not None and domain.facts(choice.args[0]).defined:
            condition, *values = choice.args
            against = Term(AGAINST[condition.op], condition.args)
            return tuple(_with(law, choice, value, holds) for value, holds in zip(values, (condition, against), strict=True))
    return ()


def _choice(term: Term, domain: StatedDomain) -> Term | None:
    """A choice whose condition has no other choice in it and no force, and is open."""
    within = next((found for a in term.args if (found := _choice(a, domain)) is not None), None)
    is_open = term.op == "where" and domain.constant(term.args[0]) and domain.decided(term.args[0]) is None
    return within or (term if is_open else None)


def _with(law: StatedLaw, choice: Term, value: Term, condition: Term) -> StatedLaw:
    def put(terms: tuple[Term, ...] | None) -> tuple[Term, ...] | None:
        return None if terms is None else tuple(term.put({choice: value}) for term in terms)

    return law._replace(
        g=law.g.put({choice: value}),
        flow=put(law.flow),
        surfaces=tuple((g.put({choice: value}), put(flow)) for g, flow in law.surfaces),
        potential=None if law.potential is None else law.potential.put({choice: value}),
        constraints=(*law.constraints, condition),
    )


def without_outer_map(law: StatedLaw) -> StatedLaw:
    """The law with the innermost formula that has the sign of g wherever it is defined; g is defined there too."""
    domain = over(law._replace(parameters={**law.parameters, _SIZE.name: Bounds(Fraction(0), None, True)}))
    g: Term | None = law.g
    while g is not None:
        law = law._replace(g=g)
        outer_first = dict.fromkeys(reversed([*g.parts()][:-1]))
        g = _without_positive_factors(g, domain) or next((f for f in outer_first if _keeps_sign(g, f, domain)), None)
    return law


def _without_positive_factors(g: Term, domain: StatedDomain) -> Term | None:
    known = [(f, domain.facts(f)) for f in factors(g)]
    left = [f for f, shown in known if not (shown.defined and shown.sign == POSITIVE)]
    return left[0] if len(left) == 1 < len(known) else None


def _keeps_sign(g: Term, f: Term, domain: StatedDomain) -> bool:
    """Whether g is a formula in f alone that is defined, and > 0, = 0, < 0 where f is."""
    ways = ((number(0), ZERO), (_SIZE, POSITIVE), (minus(_SIZE), NEGATIVE))
    if domain.constant(f) or not _alone(g, f, domain):
        return False
    return all(domain.facts(g.put({f: x})).defined and domain.facts(g.put({f: x})).sign == sign for x, sign in ways)


def _alone(g: Term, f: Term, domain: StatedDomain) -> bool:
    """Whether the forces enter g by f alone."""
    pay(1)
    return g == f or domain.constant(g) or (g.op != "name" and all(_alone(a, f, domain) for a in g.args))
