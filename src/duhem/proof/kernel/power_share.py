"""A flow of the law's own whose power is a constant times g and something >= 0: wherever g = 0 it is >= 0.

Where a tip of g is 0, as at the apex of a cone, g has a cone of normals, and the formula of a flow like the gradient of a potential no
value.  There the slip is any mean of limits of the flow from around (Koiter 1953): g being continuous, their power is >= 0 too.
"""

from __future__ import annotations

from fractions import Fraction

from duhem.proof.kernel.curvature import facts, over
from duhem.proof.kernel.domain import ZERO, Bounds, StatedDomain, StatedLaw
from duhem.proof.kernel.identity import vanishes
from duhem.proof.kernel.pieces import chooses
from duhem.proof.kernel.polynomial import written
from duhem.proof.kernel.regularity import tips
from duhem.proof.kernel.term import Term, minus, product_of, sum_of

__all__ = ["flows_with_a_share_of_g"]


def flows_with_a_share_of_g(law: StatedLaw, share: Term, rest: Term) -> bool:
    """Whether sigma . d = ``share`` g + ``rest`` with a constant share and rest >= 0, d having a value but where a tip of g is 0."""
    domain = over(law)
    if law.flow is None or not (domain.constant(share) and facts(rest, domain).nonnegative and _defined_but_at_tips(law)):
        return False
    if chooses(law.g, domain):
        return False
    power = sum_of(*(product_of(Term("name", name=x), d) for x, d in zip(law.forces, law.flow, strict=True)))
    gap = sum_of(power, minus(product_of(share, law.g)), minus(rest))
    return all(facts(part, domain).defined for part in (law.g, share, rest)) and vanishes(_with_plain_bases(gap, domain), domain)


def _with_plain_bases(term: Term, domain: StatedDomain) -> Term:
    """With what stands under a power multiplied out, so that roots of one thing are one."""
    args = tuple(_with_plain_bases(a, domain) for a in term.args)
    return Term("**", (written(dict(sorted(domain.polynomial(args[0]).items()))), args[1])) if term.op == "**" else term._replace(args=args)


def _defined_but_at_tips(law: StatedLaw) -> bool:
    """Whether the flow has a value wherever tips of g are not 0, hence everywhere around; in the place of a tip stands a number > 0."""
    domain = over(law)
    open_tips = [tip for tip in sorted(tips(law.g, domain)) if facts(tip, domain).nonnegative and _rarely_zero(tip, domain)]
    sizes = [Term("name", name=f"tip {i}") for i in range(len(open_tips))]  # no name of a law has blanks
    parameters = {**law.parameters, **{size.name: Bounds(Fraction(0), None, True) for size in sizes}}
    wider = over(law._replace(parameters=parameters))
    return all(facts(d.put(dict(zip(open_tips, sizes, strict=True))), wider).defined for d in law.flow or ())


def _rarely_zero(tip: Term, domain: StatedDomain) -> bool:
    """Whether it is 0 on no open set: a polynomial in the forces with a coefficient that is never 0, or a norm with such a part."""
    if tip.op == "norm":
        return any(_rarely_zero(part, domain) for part in tip.args)
    poly = domain.polynomial(tip)
    if any(x.op != "name" and not domain.constant(x) for m in poly for x, _ in m):
        return False
    moving = [tuple((x, n) for x, n in m if not domain.constant(x)) for m in poly]
    alone = [{tuple((x, n) for x, n in m if domain.constant(x)): c} for m, c in poly.items()]
    return any(moving.count(of) == 1 and not facts(written(c), domain).sign & ZERO for of, c in zip(moving, alone, strict=True))
