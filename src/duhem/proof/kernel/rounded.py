"""Sets that are round where they end: K = {x in R: A(x) <= S(x)}, R = {all loads <= 0}, S = c (h_1 ... h_k)^e with c > 0, 0 < e < 1.

Let A >= 0 be convex and C^1 where it is not 0, S concave in R, the h_j concave, >= 0 and C^1 there, and A < S somewhere inside R.  Then
K is convex, and S > 0 inside R.  At a boundary point inside R, A = S is not 0, so that f = A - S is C^1 near it; and grad f is not 0,
f being convex and somewhere below 0.

Where a load is 0, let no other be, one h be 0 and the others be > 0.  Then A = 0 on K there, and into R along every d that does not
keep the load at 0, that h rises at least in proportion to the way t, being concave, and S like t^e, but A, being Lipschitz, like t.
All such d thus point into K: its only normal is that of the load.  A convex set with one normal at each boundary point has a C^1
boundary (Rockafellar 1970, theorem 25.5).  Bigoni and Piccolroaz's yield function (2004, IJSS 41, 2855) is such.
"""

from __future__ import annotations

from duhem.proof.kernel.curvature import facts, over
from duhem.proof.kernel.domain import NEGATIVE, POSITIVE, ZERO, StatedDomain, StatedLaw
from duhem.proof.kernel.loads import at_end_of
from duhem.proof.kernel.region import loads_and_others
from duhem.proof.kernel.regularity import smooth_but_where_zero
from duhem.proof.kernel.term import NotWritten, Term, factors, minus, number, product_of, sum_of

__all__ = ["round_at_its_ends"]


def round_at_its_ends(law: StatedLaw) -> bool:
    """Whether g is the greatest of loads and such an f = A - S, g being < 0 somewhere."""
    domain, inside = over(law), over(law)
    loads, others = loads_and_others(law.g, domain, facts)
    if not loads or len(others) != 1:
        return False
    inside.sides |= dict.fromkeys(map(minus, loads), False)
    shape, (gauge, parts) = facts(others[0], inside), _gauge_and_parts(others[0], domain)
    size = facts(gauge, domain)
    return (
        (shape.defined and shape.convex)
        and (size.defined and size.convex and size.nonnegative and smooth_but_where_zero(gauge, domain))
        and all(facts(h, inside).concave and facts(h, inside).nonnegative and smooth_but_where_zero(h, domain) for h in parts)
        and all(_ends_round(load, loads, parts, domain) for load in loads)
    )


def _gauge_and_parts(f: Term, domain: StatedDomain) -> tuple[Term, list[Term]]:
    """A and the h of f = A - c (h_1 ... h_k)^e; NotWritten where f is not of that form."""
    for root in f.args if f.op == "+" else ():
        scales, moving = _apart(factors(root), domain)
        if len(moving) != 1 or moving[0].op != "**" or facts(product_of(*scales), domain).sign != NEGATIVE:
            continue
        base, e = moving[0].args
        scales, parts = _apart(factors(base.args[0] if base.op == "pos" else base), domain)
        below_one = facts(sum_of(number(1), minus(e)), domain).sign
        if domain.constant(e) and facts(e, domain).sign == below_one == facts(product_of(*scales), domain).sign == POSITIVE:
            rest = [term for term in f.args if term is not root]
            return rest[0] if len(rest) == 1 else sum_of(*rest), parts
    raise NotWritten("no root is subtracted")


def _apart(parts: list[Term], domain: StatedDomain) -> tuple[list[Term], list[Term]]:
    """The constants among them, and the others."""
    constants = [f for f in parts if domain.constant(f)]
    return constants, [f for f in parts if f not in constants]


def _ends_round(load: Term, loads: list[Term], parts: list[Term], domain: StatedDomain) -> bool:
    """Whether the other loads are < 0 where this one is 0, and of the h one is 0 there and the others > 0."""
    others = [facts(at_end_of(load, other, domain), domain) for other in loads if other is not load]
    ends = [facts(at_end_of(load, h, domain), domain) for h in parts]
    signs = sorted(h.sign for h in ends)
    return (
        all(known.defined for known in (*others, *ends))
        and all(other.sign == NEGATIVE for other in others)
        and signs == [ZERO, *[POSITIVE] * (len(parts) - 1)]
    )
