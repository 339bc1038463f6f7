"""K where g need not be quasiconvex everywhere: g = max(f, loads), or g has a logarithm of a load.

K lies where all loads in the maximum are <= 0, and where those under a logarithm are > 0: elsewhere g is > 0 or has no value.  That region
is convex, and so is K where g is defined and each part of the maximum quasiconvex in it, a body with a convex profile or a set {u^n <= c
v_1 ... v_m}, the v_i >= 0 and concave in it, m <= n whole, c >= 0: Lade and Duncan (1975), I1^3 <= k I3.  (c v_1 ... v_m)^(1/n) is concave
there, a geometric mean of the v_i and n - m constants (Boyd, Vandenberghe 2004, 3.2.4).  For odd n it is u that lies below it, a convex
function; for even n |u|.

K = {x in R: A(x) <= S(x)}, R = {all loads <= 0}, S = c (h_1 ... h_k)^e with c > 0, 0 < e < 1, is round where it ends.  Let A >= 0 be
convex and C^1 where it is not 0, S concave in R, the h_j concave, >= 0 and C^1 there, and A < S somewhere inside R.  Then K is convex, and
S > 0 inside R.  At a boundary point inside R, A = S is not 0, so that f = A - S is C^1 near it; and grad f is not 0, f being convex and
somewhere below 0.

Where a load is 0, let no other be, one h be 0 and the others be > 0.  Then A = 0 on K there, and into R along every d that does not keep
the load at 0, that h rises at least in proportion to the way t, being concave, and S like t^e, but A, being Lipschitz, like t.  All such d
thus point into K: its only normal is that of the load.  A convex set with one normal at each boundary point has a C^1 boundary
(Rockafellar 1970, theorem 25.5).  Bigoni and Piccolroaz's yield function (2004, IJSS 41, 2855) is such.
"""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from itertools import permutations
from math import prod

from duhem.proof.kernel.curvature import over
from duhem.proof.kernel.domain import NEGATIVE, POSITIVE, ZERO, StatedDomain, StatedLaw
from duhem.proof.kernel.forms import at_end_of
from duhem.proof.kernel.profile import convex_by_its_profile
from duhem.proof.kernel.regularity import smooth_but_where_zero
from duhem.proof.kernel.term import NotWritten, Term, factors, minus, number, product_of, sum_of

__all__ = ["convex_in_its_region", "round_at_its_ends", "where_loads_allow"]

_ONE = Fraction(1)


def convex_in_its_region(law: StatedLaw) -> bool:
    """Whether every part of g is quasiconvex, or of a convex set, where all of its loads allow it to be <= 0; g has a value there."""
    _, others, inside = where_loads_allow(law)
    found = [(part, inside.facts(part)) for part in others]
    return all(
        (known.defined and known.quasiconvex)
        or _convex_below_a_product(part, inside)
        or convex_by_its_profile(part, [*inside.sides], inside)
        for part, known in found
    )


def where_loads_allow(law: StatedLaw) -> tuple[list[Term], list[Term], StatedDomain]:
    """The loads and the other parts of g, and the domain where the loads allow K."""
    domain = over(law)
    loads, others = _loads_and_others(law.g, domain)
    sides = dict.fromkeys(map(minus, loads), False)
    for part in others:
        sides |= dict.fromkeys((x for x in _under_logarithms(part, domain) if not domain.constant(x) and domain.facts(x).affine), True)
    return loads, others, domain.where(sides)


def _loads_and_others(g: Term, domain: StatedDomain) -> tuple[list[Term], list[Term]]:
    """What a maximum is taken of: loads, which are affine and defined everywhere, and the rest."""
    parts = [*_greatest(g)]
    loads = [part for part in parts if not domain.constant(part) and domain.facts(part).affine and domain.facts(part).defined]
    return loads, [part for part in parts if part not in loads]


def _greatest(term: Term, scale: Fraction = _ONE) -> Iterator[Term]:
    """What a maximum is taken of, times a number ``scale``: c max(a, b) = max(c a, c b) for c > 0, as in -(-max(a, b))."""
    if term.op == "*":
        numbers = [f for f in factors(term) if f.op == "number"]
        others = [f for f in factors(term) if f.op != "number"]
        if len(others) == 1 and others[0].op == "max":
            scale, term = prod((f.value for f in numbers), start=scale), others[0]
    if term.op != "max" or scale <= 0:
        yield term if scale == 1 else product_of(number(scale), term)
        return
    for a in term.args:
        yield from _greatest(a, scale)


def _under_logarithms(part: Term, domain: StatedDomain) -> Iterator[Term]:
    """What stands under logarithms that are added up, times something: of one that cancels K is not closed, and nothing is said of it."""
    for x in {x for m in domain.polynomial(part) for x, _ in m if x.op == "log"}:
        yield x.args[0]


def _convex_below_a_product(part: Term, domain: StatedDomain) -> bool:
    """Whether ``part`` is such a u^n - c v_1 ... v_m, as written, so that {part <= 0} is convex."""
    return part.op == "+" and len(part.args) == 2 and any(_below(power, rest, domain) for power, rest in permutations(part.args))


def _below(power: Term, rest: Term, domain: StatedDomain) -> bool:
    n = power.args[1].value if power.op == "**" and power.args[1].op == "number" else None
    if n is None or n.denominator > 1 or n <= 0:
        return False
    u, parts = domain.facts(power.args[0]), factors(rest)
    c = domain.facts(minus(product_of(*(f for f in parts if domain.constant(f)))))
    concave = [domain.facts(f) for f in parts if not domain.constant(f)]
    convex = u.defined and (u.convex_in_size if n % 2 == 0 else u.convex)
    return (
        convex and c.defined and c.nonnegative and 0 < len(concave) <= n and all(v.defined and v.concave and v.nonnegative for v in concave)
    )


def round_at_its_ends(law: StatedLaw) -> bool:
    """Whether g is the greatest of loads and such an f = A - S, g being < 0 somewhere."""
    domain = over(law)
    loads, others = _loads_and_others(law.g, domain)
    if not loads or len(others) != 1:
        return False
    inside = domain.where(dict.fromkeys(map(minus, loads), False))
    shape, (gauge, parts) = inside.facts(others[0]), _gauge_and_parts(others[0], domain)
    size = domain.facts(gauge)
    return (
        (shape.defined and shape.convex)
        and (size.defined and size.convex and size.nonnegative and smooth_but_where_zero(gauge, domain))
        and all(inside.facts(h).concave and inside.facts(h).nonnegative and smooth_but_where_zero(h, domain) for h in parts)
        and all(_ends_round(load, loads, parts, domain) for load in loads)
    )


def _gauge_and_parts(f: Term, domain: StatedDomain) -> tuple[Term, list[Term]]:
    """A and the h of f = A - c (h_1 ... h_k)^e; NotWritten where f is not of that form."""
    for root in f.args if f.op == "+" else ():
        scales, moving = _apart(factors(root), domain)
        if len(moving) != 1 or moving[0].op != "**" or domain.facts(product_of(*scales)).sign != NEGATIVE:
            continue
        base, e = moving[0].args
        scales, parts = _apart(factors(base.args[0] if base.op == "pos" else base), domain)
        below_one = domain.facts(sum_of(number(1), minus(e))).sign
        if domain.constant(e) and domain.facts(e).sign == below_one == domain.facts(product_of(*scales)).sign == POSITIVE:
            rest = [term for term in f.args if term is not root]
            return rest[0] if len(rest) == 1 else sum_of(*rest), parts
    raise NotWritten("no root is subtracted")


def _apart(parts: list[Term], domain: StatedDomain) -> tuple[list[Term], list[Term]]:
    """The constants among them, and the others."""
    constants = [f for f in parts if domain.constant(f)]
    return constants, [f for f in parts if f not in constants]


def _ends_round(load: Term, loads: list[Term], parts: list[Term], domain: StatedDomain) -> bool:
    """Whether the other loads are < 0 where this one is 0, and of the h one is 0 there and the others > 0."""
    others = [domain.facts(at_end_of(load, other, domain)) for other in loads if other is not load]
    ends = [domain.facts(at_end_of(load, h, domain)) for h in parts]
    signs = sorted(h.sign for h in ends)
    return (
        all(known.defined for known in (*others, *ends))
        and all(other.sign == NEGATIVE for other in others)
        and signs == [ZERO, *[POSITIVE] * (len(parts) - 1)]
    )
