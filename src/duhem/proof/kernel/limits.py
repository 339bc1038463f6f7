"""The one theorem on limits: where a formula has no value at a tip, and what it is there by continuity.

A tip is where a form that is >= 0 is 0, on a set without an inside: J2 of a tensor that the forces may be, which is 0 on an axis.
Let a formula g have a value wherever the tip is not 0, every obligation being decided there, and let each part of g that has none
on the axis stand in a function rho^k f, k > 0, rho = sqrt(J2), f bounded: it tends to 0 there.  Then g, with 0 for these functions,
which must have a value on the axis too, is what g extends to, continuously.  Nothing else that divides 0 by 0 is given a value.
K is the set where g, so extended, is <= 0.

At zero force alone a gauge A <= B of :mod:`plane_gauge` may have no value: A tends to 0 there and B is of less degree.  K holds 0 then.
The slip of a law's own, having no value where a tip of g is 0, is there any mean of its limits from around (Koiter 1953): it is asked
for a value where the tip is > 0 alone.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from contextlib import suppress

from duhem.proof.kernel.definedness import Reader
from duhem.proof.kernel.deviatoric import deviatoric_readers
from duhem.proof.kernel.domain import ANY, NEGATIVE, ZERO, Sign, StatedDomain, StatedLaw
from duhem.proof.kernel.loads import by_forces
from duhem.proof.kernel.polynomial import written
from duhem.proof.kernel.shape import Shown
from duhem.proof.kernel.term import NotWritten, Term, number

__all__ = ["continued", "divides_by_zero_force", "rarely_zero", "sign_on_axis", "undecided_beside"]

Over = Callable[[StatedLaw], StatedDomain]


def continued(term: Term, domain: StatedDomain, shown: Shown, over: Over) -> Iterator[Term]:
    """What a formula is where J2 = 0, as its parts may be read, by continuity, if it has a value everywhere else where it is read."""
    for reader in deviatoric_readers(term, domain, shown, over):
        with suppress(NotWritten):
            tip, there = written(reader.second), reader.emptied(term)
            decided = rarely_zero(tip, domain, shown) and (
                Reader(_where(domain, [tip], over), shown, over, reader.sign).undecided(term) is None
                and Reader(_where(domain, [], over), shown, over).undecided(there) is None
            )
            if decided:
                yield there


def undecided_beside(terms: Iterable[Term], tips: Iterable[Term], domain: StatedDomain, shown: Shown, over: Over) -> Term | None:
    """A part of formulas that is not shown to have a value where no tip is 0."""
    tips = (tip for tip in tips if shown(tip, domain).nonnegative and rarely_zero(tip, domain, shown))
    reader = Reader(_where(domain, tips, over), shown, over)
    return next((x for term in terms if (x := reader.undecided(term)) is not None), None)


def sign_on_axis(g: Term, tip: Term, domain: StatedDomain, shown: Shown, over: Over) -> Sign:
    """Where ``tip`` is 0 only where J2 = 0, and g, by continuity, is a constant there: its sign; else any."""
    for reader in deviatoric_readers(g, domain, shown, over):
        size, there = reader.value(tip), reader.emptied(g)
        if size is None or not domain.constant(there) or not reader.above(size.poly, strict=True):
            continue
        value = shown(there, domain)
        if value.defined:
            return value.sign
    return ANY


def divides_by_zero_force(g: Term, domain: StatedDomain, shown: Shown) -> bool:
    """Whether a formula divides by 0 at zero force, wherever it stands."""

    def divides(term: Term) -> bool:
        if term.op == "**" and shown(term.args[1], domain).sign == NEGATIVE and shown(term.args[0], domain).sign == ZERO:
            return True
        return term.op != "where" and any(map(divides, term.args))

    return divides(g.put({Term("name", name=f): number(0) for f in domain.law.forces}))


def rarely_zero(tip: Term, domain: StatedDomain, shown: Shown) -> bool:
    """Whether it is 0 on no open set: a polynomial in the forces with a coefficient that is never 0, or a norm with such a part."""
    if tip.op == "norm":
        return any(rarely_zero(part, domain, shown) for part in tip.args)
    parts = by_forces(domain.polynomial(tip), domain)
    if any(x.op != "name" for moving in parts for x, _ in moving):
        return False
    return any(not shown(written(c), domain).sign & ZERO for c in parts.values())


def _where(domain: StatedDomain, tips: Iterable[Term], over: Over) -> StatedDomain:
    """The domain where also every tip is > 0."""
    inside = over(domain.law)
    inside.sides |= domain.sides | dict.fromkeys(tips, True)
    return inside
