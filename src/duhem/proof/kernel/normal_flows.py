"""Flows of a law's own that are normal to K without evidence: multiples of grad g, and of one force those that have its sign.

Let K be convex, grad g != 0 where g = 0, and the flow c grad g there with c > 0.  If it rose from sigma towards some tau in K, so would g;
but g <= 0 on the way.

Let g of one force rise with the size of that, on both sides of 0.  Where g = 0 and the force is not 0 it is the end of K on its side, and
what has its sign is normal there; if the force is 0, K is zero force alone, to which everything is normal.
"""

from __future__ import annotations

from itertools import combinations

from duhem.proof.kernel.curvature import over, within_ranges
from duhem.proof.kernel.definedness import undecided_beside
from duhem.proof.kernel.domain import NEGATIVE, POSITIVE, StatedDomain
from duhem.proof.kernel.gradient import gradient
from duhem.proof.kernel.identity import in_order, vanishes
from duhem.proof.kernel.pieces import CHOICES, chooses, pieces
from duhem.proof.kernel.regularity import tips
from duhem.proof.kernel.semidefinite import only_at_zero_force
from duhem.proof.kernel.stated_law import StatedLaw
from duhem.proof.kernel.term import Term, factors, minus, number, product_of, sum_of

__all__ = ["follows_the_gradient", "has_the_sign_of_the_force"]

_ZERO = number(0)


def follows_the_gradient(law: StatedLaw) -> bool:
    """Whether the flow is a multiple > 0 of grad g wherever no tip of g is 0, for a law with g < 0 at zero force.

    It is a constant multiple; or parallel to grad g and not against it, and 0 at zero force alone.
    """
    if law.flow is None:
        return False
    domain, slopes = over(law), gradient(law.g, law.forces)
    above = dict.fromkeys(tips(law.g, domain), True)
    flow = [_beside(d, above) for d in law.flow]
    if undecided_beside((*flow, *slopes), above, domain) is not None:
        return False

    def same(a: Term, b: Term) -> bool:
        return vanishes(in_order(sum_of(a, minus(b)), domain), domain)

    pairs = [*zip(flow, slopes, strict=True)]
    for c, k in dict.fromkeys((_scale(d, domain), _scale(slope, domain)) for d, slope in pairs):
        if domain.sign(product_of(c, k)) == POSITIVE and all(same(product_of(k, d), product_of(c, slope)) for d, slope in pairs):
            return True
    beside, square = domain.where(above), sum_of(*(product_of(d, d) for d in flow))
    moves = beside.sign(square) == POSITIVE or only_at_zero_force(square, domain)
    ahead = moves and beside.never_negative(sum_of(*(product_of(d, slope) for d, slope in pairs)))
    return ahead and all(same(product_of(d, q), product_of(e, p)) for (d, p), (e, q) in combinations(pairs, 2))


def _beside(term: Term, above: dict[Term, bool]) -> Term:
    """The same with what is chosen where a tip is > 0."""
    choices = (x for x in term.parts() if x.op == "where")
    return term.put({x: x.args[1] for x in choices if x.args[0].op == ">" and x.args[0].args[0] in above and x.args[0].args[1] == _ZERO})


def _scale(term: Term, domain: StatedDomain) -> Term:
    """The constants among its factors."""
    return product_of(number(1), *(f for f in factors(term) if domain.constant(f)))


def has_the_sign_of_the_force(law: StatedLaw) -> bool:
    """Whether g of one force rises with the size of that, and the flow has its sign, each piece of both where it holds."""
    domain = within_ranges(law)
    if len(law.forces) > 1 or law.flow is None or law.surfaces or chooses(law.g, domain):
        return False
    force = Term("name", name=law.forces[0])
    for piece, sides in pieces(Term(",", (law.g, *law.flow)), domain, CHOICES):
        g, flow = piece.args
        for way in (number(1), number(-1)):
            away = domain.where({product_of(way, force): True})
            if any(away.facts(side).sign == NEGATIVE for side in sides):
                continue  # the formula is another there
            there, (slope,) = away.where(dict.fromkeys(sides, False)), gradient(g, law.forces)
            rise = there.facts(product_of(way, slope))
            if not (rise.defined and rise.sign == there.sign(product_of(way, flow)) == POSITIVE):
                return False
    return True
