"""K where g need not be quasiconvex everywhere: g = max(f, loads), or g has a logarithm of a load.

K lies where all loads in the maximum are <= 0, and where those under a logarithm are > 0: elsewhere g is > 0 or has no value.  That
region is convex, and so is K where g is defined and each part of the maximum quasiconvex in it, a power below a product, a body
with a convex profile or of which the others leave one side.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from fractions import Fraction
from math import prod

from duhem.proof.kernel.domain import StatedDomain, StatedLaw
from duhem.proof.kernel.one_side import left_on_one_side
from duhem.proof.kernel.product_bound import convex_below_a_product
from duhem.proof.kernel.profile import convex_by_its_profile
from duhem.proof.kernel.shape import Shown
from duhem.proof.kernel.term import Term, factors, minus, number, product_of

__all__ = ["convex_in_its_region", "loads_and_others", "where_loads_allow"]

Over = Callable[[StatedLaw], StatedDomain]
_ONE = Fraction(1)


def convex_in_its_region(law: StatedLaw, shown: Shown, over: Over) -> bool:
    """Whether every part of g is quasiconvex, or of a convex set, where all of its loads allow it to be <= 0; g has a value there."""
    domain = over(law)
    loads, others, inside = where_loads_allow(law, shown, over)
    found = [(part, shown(part, inside)) for part in others]
    return all(
        (known.defined and known.quasiconvex)
        or convex_below_a_product(part, inside, shown)
        or convex_by_its_profile(part, [*inside.sides], inside, shown)
        or left_on_one_side(part, [other for other in (*loads, *others) if other is not part], domain)
        for part, known in found
    )


def where_loads_allow(law: StatedLaw, shown: Shown, over: Over) -> tuple[list[Term], list[Term], StatedDomain]:
    """The loads and the other parts of g, and the domain where the loads allow K."""
    inside = over(law)
    loads, others = loads_and_others(law.g, inside, shown)
    sides = dict.fromkeys(map(minus, loads), False)
    for part in others:
        sides |= dict.fromkeys((x for x in _under_logarithms(part, inside) if not inside.constant(x) and shown(x, inside).affine), True)
    inside = over(law)
    inside.sides |= sides
    return loads, others, inside


def loads_and_others(g: Term, domain: StatedDomain, shown: Shown) -> tuple[list[Term], list[Term]]:
    """What a maximum is taken of: loads, which are affine and defined everywhere, and the rest."""
    parts = [*_greatest(g)]
    loads = [part for part in parts if not domain.constant(part) and shown(part, domain).affine and shown(part, domain).defined]
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
