"""The boundary of K as the surface g = 0: whether it rises outward and curves inward, and which sums in a formula are convex.

If g < 0 at the origin and sigma . grad g > 0 wherever g = 0, each ray leaves K once, and K is convex if it is so near every
point of its boundary (Tietze 1928, Nakajima 1928): the second derivative of g along every tangent is >= 0 there.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import replace
from fractions import Fraction

from duhem.proof.kernel.curvature import facts, over
from duhem.proof.kernel.domain import NEGATIVE, StatedDomain, StatedLaw
from duhem.proof.kernel.pieces import pieces
from duhem.proof.kernel.polynomial import Polynomial, slope, times, total
from duhem.proof.kernel.refutation import Condition, Identity, shown
from duhem.proof.kernel.term import NotWritten, Term, product_of, sum_of

__all__ = ["curves_inward", "flows_outward", "rises_outward", "with_convex_sums"]

_BOUNDARY, _TANGENT = "the boundary", "the tangent"


def rises_outward(law: StatedLaw, identities: Sequence[Identity]) -> bool:
    """Whether sigma . grad g > 0 wherever g = 0, on every piece of g."""
    domain = over(law)
    return facts(law.g, domain).defined and all(
        shown(_along(law.forces, g, domain), ">", _on_boundary(g, sides, domain), identities, domain) for g, sides in pieces(law.g, domain)
    )


def flows_outward(law: StatedLaw, identities: Sequence[Identity]) -> bool:
    """Whether sigma . d >= 0 wherever g = 0, d being the law's own flow."""
    domain, flow = over(law), law.flow or ()
    power = sum_of(*(product_of(Term("name", name=x), d) for x, d in zip(law.forces, flow, strict=True)))
    if not all(facts(part, domain).defined for part in (law.g, *flow)):
        return False
    return domain.nonnegative(power) or all(
        shown(domain.polynomial(both.args[1]), ">=", _on_boundary(both.args[0], sides, domain), identities, domain)
        for both, sides in pieces(Term(",", (law.g, power)), domain)
    )


def curves_inward(law: StatedLaw, directions: Sequence[str], identities: Sequence[Identity]) -> bool:
    """Whether v . Hess g v >= 0 for every v with v . grad g = 0 wherever g = 0; ``directions`` are names for the components of v."""
    domain = _wider(law, directions)
    given = {**_on_boundary(law.g, (), domain), _TANGENT: (_along(directions, law.g, domain), "==")}
    return facts(law.g, domain).defined and shown(_bend(directions, law.g, domain), ">=", given, identities, domain)


def with_convex_sums(law: StatedLaw, directions: Sequence[str], identities: Sequence[Identity]) -> StatedDomain:
    """The domain of the law, knowing which sums f in g are >= 0, and which are convex: v . Hess f v >= 0 for all v."""
    domain, wider = over(law), _wider(law, directions)
    for f in _sums(law.g):
        known = facts(f, domain)
        with suppress(NotWritten):  # a sum with a kink, a root or a word
            if known.defined and not known.nonnegative and shown(wider.polynomial(f), ">=", {}, identities, wider):
                known = replace(known, sign=known.sign & ~NEGATIVE)
            if known.defined and not known.convex and shown(_bend(directions, f, wider), ">=", {}, identities, wider):
                known = replace(known, convex=True, quasiconvex=True)
        domain.shown[f] = known
    return domain


def _sums(term: Term) -> Iterator[Term]:
    """The sums in a formula, the inner first."""
    for a in term.args:
        yield from _sums(a)
    if term.op == "+":
        yield term


def _along(v: Sequence[str], f: Term, domain: StatedDomain) -> Polynomial:
    """v . grad f; NotWritten where f is no polynomial in the forces."""
    return _derived(v, domain.polynomial(f), domain)


def _bend(v: Sequence[str], f: Term, domain: StatedDomain) -> Polynomial:
    """v . Hess f v."""
    return _derived(v, _along(v, f, domain), domain)


def _derived(v: Sequence[str], f: Polynomial, domain: StatedDomain) -> Polynomial:
    if any(x.op != "name" and not domain.constant(x) for m in f for x, _ in m):
        raise NotWritten("a kink, a root or a word of the forces has no slope here")
    forces = domain.law.forces[: len(v)]  # the components of v may follow them
    return total(
        *(times({((Term("name", name=d), 1),): Fraction(1)}, slope(f, Term("name", name=x))) for x, d in zip(forces, v, strict=True))
    )


def _wider(law: StatedLaw, directions: Sequence[str]) -> StatedDomain:
    """The law's domain where the components of v may be any numbers too."""
    if not len({*directions}) == len(directions) == len(law.forces) or {*directions} & {*law.forces, *law.parameters, law.pressure, "pi"}:
        raise NotWritten("the directions have no names of their own")
    return over(law._replace(forces=(*law.forces, *directions)))


def _on_boundary(g: Term, sides: Sequence[Term], domain: StatedDomain) -> dict[str, Condition]:
    """What holds where the piece g, whose ``sides`` are >= 0, is 0."""
    conditions = {f"side {i}": (domain.polynomial(side), ">=") for i, side in enumerate(sides)}
    return {_BOUNDARY: (domain.polynomial(g), "=="), **conditions}
