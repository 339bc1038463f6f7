"""Which part of a formula no rule of the kernel reads: the smallest one, with what would be needed of it.

As CVXPY names the expression that is not DCP.  The way down follows the rules of composition: it asks of each part what the rule for
the whole needs of it, and ends where every part gives what it can.
"""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from fractions import Fraction
from math import gcd, lcm
from typing import NamedTuple

from duhem.proof.kernel.curvature import over, within_ranges
from duhem.proof.kernel.definedness import Reader
from duhem.proof.kernel.domain import NEGATIVE, POSITIVE, ZERO, StatedDomain
from duhem.proof.kernel.forms import degree_at_most, principal_minors, quadratic
from duhem.proof.kernel.gradient import gradient
from duhem.proof.kernel.identity import multiplied_out, multiplied_through
from duhem.proof.kernel.polynomial import written
from duhem.proof.kernel.region import where_loads_allow
from duhem.proof.kernel.regularity import regularity, smooth_near_the_boundary
from duhem.proof.kernel.signs import without_content
from duhem.proof.kernel.state import energy_differentiable, epigraph, in_state, rate_epigraph
from duhem.proof.kernel.stated_law import StatedLaw
from duhem.proof.kernel.term import COMPARISONS, UNREADABLE, NotWritten, Term, minus, number, product_of, sum_of

__all__ = ["Blocked", "blocked", "required"]

_OF_THE_ENERGY = ("state_laws", "dissipation")
_CONVEX, _CONCAVE, _SIZE = "convex", "concave", "convex in size"
_NEEDS = {"**": "is a power, root or quotient", "log": "is a logarithm", "atan2": "is an angle"}
_LARGEST = 4  # of a matrix whose minors are looked at


class Blocked(NamedTuple):
    """The ``part`` of the formula, and ``why`` no rule reads it; conditions on constants that might help are of ``signs`` >= 0, or > 0.

    ``beside`` are other constants of the formula whose sign is not known, each before its opposite.
    """

    part: Term
    why: str
    signs: tuple[Term, ...] = ()
    strict: bool = False
    beside: tuple[Term, ...] = ()


def _in_forces(claim: str, law: StatedLaw) -> StatedLaw:
    """The law whose g the claim is about: psi <= z, Phi* <= z, or with the forces of its energy put in."""
    if claim == "state_laws":
        return law.once(epigraph) or law
    if law.viscous:
        return rate_epigraph(law, claim == "dissipation")
    return (law.once(in_state) if claim == "dissipation" else None) or law


def blocked(claim: str, law: StatedLaw) -> Blocked | None:
    """The smallest part of the law's formulas that keeps the rules from the claim; None where none is found, or it needs too much."""
    with suppress(*UNREADABLE):
        if claim in _OF_THE_ENERGY and law.once(energy_differentiable):
            return _energy(law)
        if claim == "origin" and law.viscous:
            return _least_at_zero(law)
        read = _in_forces(claim, law)
        found = _FINDERS[claim](read) if claim in _FINDERS else None
        return found and found._replace(beside=_open_signs(read.power or read.g, over(read)))
    return None


def _energy(law: StatedLaw) -> Blocked | None:
    """Forces are derivatives of psi: where it has none, no rule speaks of them."""
    stored = epigraph(law)
    if law.energy is None or stored is None:
        return None
    domain = over(stored)
    found = _undefined((law.energy, *gradient(law.energy, stored.forces[:-1])), domain) or _rough(law.energy, domain, "in some state")
    return found and found._replace(why=f"{found.why}; the forces are derivatives of psi")


def _least_at_zero(law: StatedLaw) -> Blocked:
    """Name the part of a potential of rates that keeps it from being 0 at zero force and >= 0 elsewhere."""
    domain, zero = over(law), {Term("name", name=f): number(0) for f in law.forces}
    if (undefined := _undefined((law.g,), domain)) is not None:
        return undefined
    if domain.facts(start := multiplied_out(law.g.put(zero), domain)).sign != ZERO:
        return Blocked(start, "is Phi* at zero force, and is not shown to be 0", (start, minus(start)))
    why = "is the part of Phi* that is not shown to be >= 0, even with what stands beside it"
    return Blocked(_negative(law.g, domain), why, beside=_open_signs(law.g, domain))


def _undefined(terms: Sequence[Term], domain: StatedDomain) -> Blocked | None:
    """A part that is not shown to have a value."""
    part = next((x for term in terms if (x := Reader(domain).undecided(term)) is not None), None)
    if part is None:
        return None
    inner = part.args[0]
    why = f"{_NEEDS.get(part.op, 'is a word')} that is not shown to have a value everywhere"
    if part.op == "**" and part.args[1].op == "number" and part.args[1].value > 0 and (minors := _minors(inner, domain)):
        return Blocked(part, why, minors)
    return Blocked(part, why, (_plain(inner, domain),) if domain.constant(inner) else (), True)


def _origin(law: StatedLaw) -> Blocked | None:
    nothing = {Term("name", name=f): number(0) for f in law.forces}
    zero, domain = law.g.put(nothing), over(law)
    if (undefined := _undefined((zero,), domain)) is not None:
        own = next((x for x in law.g.parts() if x.put(nothing) == undefined.part), undefined.part)
        return Blocked(own, f"{_NEEDS.get(own.op, 'is a word')} that is not shown to have a value at zero force", undefined.signs, True)
    value = multiplied_out(zero, domain)
    return Blocked(value, "is g at zero force, and is not shown to be <= 0", (minus(value),))


def _convexity(law: StatedLaw) -> Blocked | None:
    others, inside = [law.g], over(law)
    with suppress(NotWritten):  # a polynomial in it has too many terms
        _, others, inside = where_loads_allow(law)
    return _undefined(others, inside) or next((found for part in others if (found := _below(part, _CONVEX, inside)) is not None), None)


def _power(law: StatedLaw) -> Blocked | None:
    """Of force . flow of a flow of the law's own; of an associated law what convexity lacks."""
    flow = law.flow
    if law.power is None and flow is None:
        return _convexity(law) or Blocked(law.g, "is not shown to rise along the rays from zero force where it is 0, or to be <= 0 there")
    domain = within_ranges(law)
    if (undefined := _undefined((law.g, *(flow or ())), domain)) is not None:
        return undefined
    power = law.power or sum_of(*(product_of(Term("name", name=x), d) for x, d in zip(law.forces, flow or (), strict=True)))
    part = _negative(power, domain)
    if law.of_rates or flow is None:  # of a potential the rates are the gradient
        return Blocked(part, "is the part of force . rate that is not shown to be >= 0")
    return Blocked(part, "is the part of force . flow that is not shown to be >= 0 where g = 0, even with a multiple of g taken from it")


def _negative(term: Term, domain: StatedDomain) -> Term:
    """The terms of a sum that may be < 0; the whole where each is seen to be >= 0."""
    whole = multiplied_out(term, domain)
    negative = [part for part in (whole.args if whole.op == "+" else (whole,)) if domain.facts(part).sign & NEGATIVE]
    return negative[0] if len(negative) == 1 else sum_of(*negative) if negative else term


def _open_signs(term: Term, domain: StatedDomain) -> tuple[Term, ...]:
    """Return constants of unknown sign that are factors or summands of a formula, without lone parameters, each with its opposite."""
    found, pressure = dict[Term, None](), {domain.law.pressure}

    def look(part: Term) -> None:
        if domain.constant(part) and not part.names() & pressure:
            known = domain.facts(part)
            if part.op != "name" and known.defined and known.sign & NEGATIVE and known.sign & POSITIVE:
                found.update(dict.fromkeys(_plain(way, domain) for way in (part, minus(part))))
            return
        fixed = [a for a in part.args if domain.constant(a) and not a.names() & pressure]
        for a in (*([sum_of(*fixed)] if part.op == "+" and len(fixed) > 1 else fixed), *(a for a in part.args if a not in fixed)):
            look(a)

    look(term)
    return tuple(found)


def required(needed: Sequence[Term], law: StatedLaw) -> Blocked | None:
    """What the closed form of the dissipation potential needs to be > 0, and is not shown to be."""
    domain = over(law)
    open_ = [_plain(x, domain) for x in needed if domain.facts(x).sign != POSITIVE]
    if not open_:
        return None
    signs = tuple(dict.fromkeys(x for x in open_ if domain.constant(x) and not x.names() & {law.pressure}))
    why = "must be > 0 in the closed form of the dissipation potential, and is not shown to be"
    return Blocked(open_[0], why, signs, True, _open_signs(law.g, domain))


def _normality(law: StatedLaw) -> Blocked | None:
    """Name what keeps the flow from being normal: its own flow, the convexity of an associated law, or forces that fall with the rates."""
    if law.of_rates:
        return _resistance(law)
    if law.flow is None:
        found = _convexity(law) if law.associated else None
        return found and found._replace(why=f"{found.why}; what settles convexity settles normality")
    found = _undefined((law.g, *law.flow), within_ranges(law))
    return found or Blocked(Term(",", law.flow), "is the flow, and is not shown to be a multiple >= 0 of grad g where g = 0")


def _resistance(law: StatedLaw) -> Blocked | None:
    """Each force should depend on its own rate alone, and not decrease."""
    domain = over(law)
    for rate, force in zip(law.forces, law.flow or (), strict=True):
        if (found := _undefined((force,), domain) or _rough(force, domain, "at some rate")) is not None:
            return found
        if force.names() & ({*law.forces} - {rate}):
            return Blocked(force, f"depends on other rates than {rate}: no rule shows that such forces have a potential")
        (slope,) = gradient(force, (rate,))
        if not domain.never_negative(slope):
            return Blocked(_negative(slope, domain), f"is the part of d force/d {rate} that is not shown to be >= 0")
    return None


def _rough(g: Term, domain: StatedDomain, where: str) -> Blocked | None:
    """The smallest part of a formula that is not shown to be C^1; None where it is."""
    known = regularity(g, domain)
    for part in (part for part in dict.fromkeys(g.parts()) if part.op not in COMPARISONS):
        own = regularity(part, domain)
        if known is None and own is None:
            word = {"**": "a power", "+": "a sum", "*": "a product", "where": "a choice"}.get(part.op, part.op)
            return Blocked(part, f"is no formula of which a rule shows that it is C^1 ({word})")
        if known is not None and own is not None and own.kinks & known.kinks:
            return Blocked(part, "has a kink that no rule shows to cancel")
    if known is not None and known.tips:
        return Blocked(min(known.tips, key=Term.size), f"may be 0 {where}, and need have no gradient there")
    return None


def _smoothness(law: StatedLaw) -> Blocked | None:
    """Name what may have no gradient; else what convexity lacks: the gradient of a convex g is 0 at its least value alone."""
    domain = within_ranges(law)
    rough = None if smooth_near_the_boundary(law.g, domain) else _rough(law.g, domain, "on the boundary")
    found = _undefined((law.g,), domain) or rough
    return found or (_convexity(law) or Blocked(law.g, ""))._replace(part=law.g, why=_FLAT)


_FLAT = "is C^1, but no rule shows that its gradient is not 0 where g = 0"
_FINDERS = {
    "origin": _origin, "convexity": _convexity, "state_laws": _convexity, "smoothness": _smoothness, "normality": _normality,
    "dissipation": _power,
}  # fmt: skip


# -- the way down --------------------------------------------------------------------------------------------------------


def _below(term: Term, want: str, domain: StatedDomain) -> Blocked | None:
    """The part to blame that a term is not shown to be what is wanted of it; None where it is."""
    known = domain.facts(term)
    if {_CONVEX: known.convex or (want == _CONVEX and known.quasiconvex), _CONCAVE: known.concave, _SIZE: known.convex_in_size}[want]:
        return None
    moving = [a for a in term.args if not domain.constant(a)]
    wanted = {"exp": _CONVEX, "log": _CONCAVE, "pos": _CONVEX, "neg": _CONCAVE, "max": _CONVEX, "min": _CONCAVE, "+": want}
    if want == _SIZE:
        return _below(term, _CONVEX, domain) or Blocked(term, _NO_SIZE)
    if term.op == "*" and len(moving) == 1:
        own = [a for a in term.args if domain.constant(a)]
        scale = own[0] if len(own) == 1 else product_of(*own)
        sign = domain.facts(scale).sign
        if sign & NEGATIVE and sign & POSITIVE:
            ways = tuple(_plain(way, domain) for way in (scale, minus(scale)))
            return Blocked(scale, "is a factor whose sign is not known", ways)
        return _below(moving[0], want if not sign & NEGATIVE else _CONCAVE if want == _CONVEX else _CONVEX, domain)
    if term.op == "**":
        return _below_a_power(term, want, domain)
    if term.op in wanted and (want == wanted[term.op] or term.op == "+"):
        inner = next((found for a in moving if (found := _below(a, wanted[term.op], domain)) is not None), None)
        if inner is not None:
            minors = _minors(term, domain) if term.op == "+" else ()
            return inner._replace(part=term if minors else inner.part, why=_MATRIX if minors else inner.why, signs=(*minors, *inner.signs))
    return Blocked(term, f"is {_said(term, len(moving))}, and no rule shows that it is {want}")


_NO_SIZE = "is convex but not shown to be >= 0, as what stands in a size or a power must be"
_MATRIX = "is quadratic in the forces, and its matrix is not shown to be positive semidefinite"


def _below_a_power(term: Term, want: str, domain: StatedDomain) -> Blocked:
    base, exponent = term.args
    known = domain.facts(base)
    if domain.constant(exponent):
        more = sum_of(exponent, number(-1))
        rising = not domain.facts(more).sign & NEGATIVE
        if want == _CONVEX and rising:
            even = exponent.op == "number" and exponent.value % 2 == 0
            found = _below(base, _SIZE if even else _CONVEX, domain)
            if found is not None:
                return found
            if not known.nonnegative:
                return Blocked(base, "is not shown to be >= 0, and its power is convex only where it is", ())
        if exponent.op != "number" and not rising:
            return Blocked(exponent, "is an exponent that is not shown to be >= 1", (more, minus(more)))
        if want == _CONCAVE and not rising and (found := _below(base, _CONCAVE, domain)) is not None:
            return found
    return Blocked(term, f"is {_said(term, 1)}, and no rule shows that it is {want}")


def _said(term: Term, moving: int) -> str:
    """What a part is that no rule reads."""
    if term.op == "*":
        return f"a product of {moving} parts that all depend on the forces"
    if term.op == "**":
        e = term.args[1].value if term.args[1].op == "number" else None
        return "a quotient by what depends on the forces" if e is not None and e < 0 else "a root" if e is not None and e < 1 else "a power"
    return {"+": "a sum", "where": "a choice by the forces", "<": "a choice"}.get(term.op, f"{term.op} of what depends on the forces")


def _minors(term: Term, domain: StatedDomain) -> tuple[Term, ...]:
    """Of a quadratic sum the principal minors of its matrix whose sign is open."""
    if degree_at_most(term, domain) != 2:
        return ()
    with suppress(NotWritten):
        matrix = quadratic(term, sorted(term.names() & set(domain.law.forces)), domain)[0]
        every = (written(minor) for _, minor in principal_minors(matrix, domain, _LARGEST))
        return tuple(dict.fromkeys(_plain(minor, domain) for minor in every if domain.facts(minor).sign & NEGATIVE))
    return ()


def _plain(constant: Term, domain: StatedDomain) -> Term:
    """A constant times what is > 0, without divisors and with whole numbers: of the same sign."""
    with suppress(NotWritten):
        poly = without_content(multiplied_through(domain.polynomial(constant), domain, signed=True), domain)
        scale = Fraction(lcm(*(c.denominator for c in poly.values())), gcd(*(c.numerator for c in poly.values())) or 1)
        return written({m: c * scale for m, c in poly.items()})
    return constant
