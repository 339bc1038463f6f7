"""A flow of the law's own whose power is a constant times g and something >= 0: wherever g = 0 it is >= 0.

Where a tip of g is 0, as at the apex of a cone, g has a cone of normals, and the formula of a flow like the gradient of a potential no
value; see :mod:`limits`.  The power of a mean of its limits from around is >= 0 too, g being continuous.
"""

from __future__ import annotations

from duhem.proof.kernel.curvature import facts, over
from duhem.proof.kernel.domain import StatedDomain, StatedLaw
from duhem.proof.kernel.identity import vanishes
from duhem.proof.kernel.limits import undecided_beside
from duhem.proof.kernel.pieces import chooses
from duhem.proof.kernel.polynomial import written
from duhem.proof.kernel.regularity import tips
from duhem.proof.kernel.term import Term, minus, product_of, sum_of

__all__ = ["flows_with_a_share_of_g"]


def flows_with_a_share_of_g(law: StatedLaw, share: Term, rest: Term) -> bool:
    """Whether sigma . d = ``share`` g + ``rest`` with a constant share and rest >= 0, d having a value but where a tip of g is 0."""
    domain = over(law)
    if law.flow is None or not (domain.constant(share) and facts(rest, domain).nonnegative):
        return False
    if undecided_beside(law.flow, tips(law.g, domain), domain, facts, over) is not None or chooses(law.g, domain):
        return False
    power = sum_of(*(product_of(Term("name", name=x), d) for x, d in zip(law.forces, law.flow, strict=True)))
    gap = sum_of(power, minus(product_of(share, law.g)), minus(rest))
    return all(facts(part, domain).defined for part in (law.g, share, rest)) and vanishes(_with_plain_bases(gap, domain), domain)


def _with_plain_bases(term: Term, domain: StatedDomain) -> Term:
    """With what stands under a power multiplied out, so that roots of one thing are one."""
    args = tuple(_with_plain_bases(a, domain) for a in term.args)
    return Term("**", (written(dict(sorted(domain.polynomial(args[0]).items()))), args[1])) if term.op == "**" else term._replace(args=args)
