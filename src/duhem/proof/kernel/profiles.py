"""Terms with logarithms of a load that is 0 at its end, and the ramps of networks.

where(y > 0, x^n w, 0), n > 0, is continuous where y >= 0, x and y being multiples of one load t and w made of logarithms of such by sums
and products: t^n |log t|^m tends to 0.  So it is convex there, or concave, if it is so for y > 0.

pos(x) + c exp(-b neg(x)), b, c >= 0, b c <= 1, is convex and does not fall in x: it is continuous, and its slope is b c exp(b x) for x < 0,
which lies between 0 and 1 and rises, and 1 for x > 0.  So it is convex where x is (the exponential linear units of networks).
"""

from __future__ import annotations

from dataclasses import replace

from duhem.proof.kernel.bounds import Facts
from duhem.proof.kernel.domain import NEGATIVE, POSITIVE, ZERO, Sign, StatedDomain
from duhem.proof.kernel.forms import apart, multiple
from duhem.proof.kernel.polynomial import Polynomial
from duhem.proof.kernel.term import Term, minus, number, product_of, sum_of

__all__ = ["closed_at_its_end", "convex_with_exponential_ramps", "scaled"]

_ONE = number(1)


def scaled(way: tuple[bool, bool], sign: Sign) -> tuple[bool, bool]:
    """What is so of f and of -f, for f times a constant of such a sign."""
    if not sign & NEGATIVE:
        return way
    return way[::-1] if not sign & POSITIVE else (False, False)


def convex_with_exponential_ramps(term: Term, domain: StatedDomain) -> bool:
    """Whether a sum is made of ramps with an exponential, pos(x) + c (exp(-b neg(x)) + d), x convex, and of what is convex itself."""
    rest = list(term.args)
    for ramp in [a for a in rest if a.op == "pos" and domain.facts(a.args[0]).convex]:
        if (below := next((a for a in rest if _goes_on(ramp, a, domain)), None)) is not None:
            rest.remove(ramp)  # one that is equal to it, where there are more
            rest.remove(below)
    return len(rest) < len(term.args) and all(domain.facts(a).convex for a in rest)


def _goes_on(ramp: Term, part: Term, domain: StatedDomain) -> bool:
    """Whether c (exp(-b neg(x)) + d) stands beside pos(x), with b, c >= 0 and b c <= 1."""
    c, inner = _apart(part, domain)
    moving = [a for each in inner for a in (each.args if each.op == "+" else (each,)) if not domain.constant(a)]
    if len(moving) != 1 or moving[0].op != "exp":
        return False
    b, below = _apart(moving[0].args[0], domain)
    known = [domain.facts(x) for x in (c, minus(b), sum_of(_ONE, product_of(b, c)))]
    return below == [Term("neg", ramp.args)] and all(x.defined and x.nonnegative for x in known)


def _apart(term: Term, domain: StatedDomain) -> tuple[Term, list[Term]]:
    """As :func:`apart`, of a large term too: it goes into products within its own and no deeper, as parts may be shared without end."""
    own = [b for a in (term.args if term.op == "*" else (term,)) for b in (a.args if a.op == "*" else (a,))]
    return product_of(*(a for a in own if domain.constant(a))), [a for a in own if not domain.constant(a)]


def closed_at_its_end(term: Term, domain: StatedDomain) -> Facts | None:
    """Of where(y > 0, x^n w, 0), y >= 0 and x multiples of a load, n > 0, w of logarithms: what holds for y > 0 does where it is 0 too."""
    condition, inner, other = term.args
    if condition.op not in (">", "<") or inner.op != "*":
        return None
    y, bound = condition.args if condition.op == ">" else condition.args[::-1]
    known = domain.facts(y)
    if any(domain.polynomial(nothing) or not domain.facts(nothing).defined for nothing in (bound, other)):
        return None
    if not (known.defined and known.affine and known.nonnegative) or domain.constant(y):
        return None
    load = domain.polynomial(y)
    moving = apart(inner, domain)[1]
    if not any(_vanishes(f, load, domain) for f in moving) or not all(_grows_slowly(f, load, domain) for f in moving):
        return None
    there = domain.where({y: True}).facts(inner)
    return replace(there, sign=there.sign | ZERO) if there.defined else None


def _vanishes(f: Term, load: Polynomial, domain: StatedDomain) -> bool:
    """Whether it is a power > 0 of a multiple of the load."""
    power = f.op == "**" and domain.constant(f.args[1]) and domain.facts(f.args[1]).sign == POSITIVE
    return multiple(domain.polynomial(f.args[0] if power else f), load, domain) is not None


def _grows_slowly(f: Term, load: Polynomial, domain: StatedDomain) -> bool:
    """Whether it is no more than a power of |log t| where the load t tends to 0."""
    if domain.constant(f) or _vanishes(f, load, domain):
        return True
    if f.op == "log":
        return multiple(domain.polynomial(f.args[0]), load, domain) is not None
    return f.op in ("+", "*") and all(_grows_slowly(a, load, domain) for a in f.args)
