"""Choices that no force enters: at each value of parameters and pressure the law is one of two, each where its condition holds.

A claim is made at every such value.  So it holds of the law if it holds of either, the condition being one constraint more.
"""

from __future__ import annotations

from duhem.proof.kernel.curvature import facts, over
from duhem.proof.kernel.definedness import AGAINST
from duhem.proof.kernel.domain import StatedDomain, StatedLaw
from duhem.proof.kernel.term import Term

__all__ = ["cases"]


def cases(law: StatedLaw) -> tuple[StatedLaw, ...]:
    """The two laws that a choice leaves, none where every choice is by the forces."""
    written = (law.g, *(law.flow or ()), *(part for g, flow in law.surfaces for part in (g, *(flow or ()))))
    domain = over(law)
    for term in (*written, *([] if law.potential is None else [law.potential])):
        choice = _choice(term, domain)
        if choice is not None and facts(choice.args[0], domain).defined:
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
