"""Sets {u^n <= c v_1 ... v_m}, the v_i >= 0 and concave where it is asked, m <= n whole, c >= 0: Lade and Duncan (1975), I1^3 <= k I3.

(c v_1 ... v_m)^(1/n) is concave there, a geometric mean of the v_i and n - m constants (Boyd, Vandenberghe 2004, 3.2.4).  For odd n
it is u that lies below it, a convex function; for even n |u|.
"""

from __future__ import annotations

from itertools import permutations

from duhem.proof.kernel.domain import StatedDomain
from duhem.proof.kernel.shape import Shown
from duhem.proof.kernel.term import Term, factors, minus, product_of

__all__ = ["convex_below_a_product"]


def convex_below_a_product(part: Term, domain: StatedDomain, shown: Shown) -> bool:
    """Whether ``part`` is such a u^n - c v_1 ... v_m, as written, so that {part <= 0} is convex."""
    return part.op == "+" and len(part.args) == 2 and any(_below(power, rest, domain, shown) for power, rest in permutations(part.args))


def _below(power: Term, rest: Term, domain: StatedDomain, shown: Shown) -> bool:
    n = power.args[1].value if power.op == "**" and power.args[1].op == "number" else None
    if n is None or n.denominator > 1 or n <= 0:
        return False
    u, parts = shown(power.args[0], domain), factors(rest)
    c = shown(minus(product_of(*(f for f in parts if domain.constant(f)))), domain)
    concave = [shown(f, domain) for f in parts if not domain.constant(f)]
    convex = u.defined and (u.convex_in_size if n % 2 == 0 else u.convex)
    return (
        convex and c.defined and c.nonnegative and 0 < len(concave) <= n and all(v.defined and v.concave and v.nonnegative for v in concave)
    )
