"""Products that are convex or concave although two of their factors depend on the forces: profiles of bodies along a load.

x w with x affine and w a sum is the sum of x times its parts, and x y^n = k y^(n+1) for x = k y: so p (1 - b log(p/c)) is p less a multiple
of p log(p/c), and p (1 - (p/c)^n) is p less a power of p.

where(y > 0, x^n w, 0), n > 0, is continuous where y >= 0, x and y being multiples of one load t and w made of logarithms of such by sums
and products: t^n |log t|^m tends to 0.  So it is convex there, or concave, if it is so for y > 0.

x w^e, x >= 0 affine, w >= 0, 0 <= e <= 1, is the weighted geometric mean x^(1 - e) (x w)^e, and concave where x w is (Boyd, Vandenberghe
2004, 3.1.5): so are p (log(c/p))^e and p (1 - p/c)^e.

Let f, g >= 0 be concave and f rise in a load t, g fall in it, the forces entering both by t alone.  Then f g is concave: with
m = r x + s y, r + s = 1, f(m) g(m) >= (r f(x) + s f(y)) (r g(x) + s g(y)) = r f(x) g(x) + s f(y) g(y) - r s (f(x) - f(y)) (g(x) - g(y)),
and the last product is <= 0.  With f, g >= 0 convex, both rising or both falling, all signs turn: f g is convex (Boyd, Vandenberghe
2004, exercise 3.32).

pos(x) + c exp(-b neg(x)), b, c >= 0, b c <= 1, is convex and does not fall in x: it is continuous, and its slope is b c exp(b x) for x < 0,
which lies between 0 and 1 and rises, and 1 for x > 0.  So it is convex where x is (the exponential linear units of networks).
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from dataclasses import replace

from duhem.proof.kernel.bounds import Facts
from duhem.proof.kernel.constant_value import RISING
from duhem.proof.kernel.domain import NEGATIVE, POSITIVE, ZERO, Sign, StatedDomain
from duhem.proof.kernel.forms import apart, multiple, of_load, share_and_rest
from duhem.proof.kernel.polynomial import Polynomial, written
from duhem.proof.kernel.term import NotWritten, Term, minus, number, product_of, sum_of

__all__ = ["closed_at_its_end", "opened", "scaled", "shape_of_two", "times_load"]

_ONE = number(1)


def shape_of_two(f: Term, g: Term, domain: StatedDomain) -> tuple[bool, bool]:
    """Whether the product of two factors is convex, and concave."""
    with suppress(NotWritten):
        for x, w in ((f, g), (g, f)):
            if (whole := opened(x, w, domain)) is not None and (known := domain.facts(whole)) and (known.convex or known.concave):
                return known.convex, known.concave
        convex, concave = _together(f, g, domain)
        return convex, concave or _weighted_mean(f, g, domain) or _weighted_mean(g, f, domain)
    return False, False


def scaled(way: tuple[bool, bool], sign: Sign) -> tuple[bool, bool]:
    """What is so of f and of -f, for f times a constant of such a sign."""
    if not sign & NEGATIVE:
        return way
    return way[::-1] if not sign & POSITIVE else (False, False)


def opened(x: Term, w: Term, domain: StatedDomain) -> Term | None:
    """x w as a sum, for x affine and a sum w that is not; None for other factors."""
    if w.op != "+" or domain.constant(w) or domain.facts(w).affine or not domain.facts(x).affine:
        return None
    return sum_of(*(_times(x, part, domain) for part in w.args))


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


def _times(x: Term, part: Term, domain: StatedDomain) -> Term:
    """x c y^n as c k y^(n+1) where x = k y, k > 0; else their product."""
    scale, moving = apart(part, domain)
    if len(moving) == 1 and moving[0].op == "**" and domain.constant(moving[0].args[1]):
        y, n = moving[0].args
        k = multiple(domain.polynomial(x), domain.polynomial(y), domain)
        if k and domain.facts(written(k)).sign == POSITIVE:
            more = number(n.value + 1) if n.op == "number" else sum_of(n, _ONE)
            return product_of(scale, written(k), Term("**", (y, more)))
    return product_of(scale, x, *moving)


def _weighted_mean(x: Term, power: Term, domain: StatedDomain) -> bool:
    """x w^e = x^(1 - e) (x w)^e, 0 <= e <= 1, with x affine, w >= 0 and x w concave, both >= 0."""
    if power.op != "**" or not domain.constant(power.args[1]):
        return False
    w, e = power.args
    if domain.facts(e).sign & NEGATIVE or domain.facts(sum_of(_ONE, minus(e))).sign & NEGATIVE:
        return False
    load, known, whole = domain.facts(x), domain.facts(w), domain.facts(times_load(x, w, domain))
    return load.affine and load.nonnegative and known.defined and known.nonnegative and whole.defined and whole.concave


def times_load(x: Term, w: Term, domain: StatedDomain) -> Term:
    """x w, as a sum where w is one."""
    return opened(x, w, domain) or _times(x, w, domain)


def _together(f: Term, g: Term, domain: StatedDomain) -> tuple[bool, bool]:
    """Whether f g is convex, and concave, both being >= 0 and functions of one load."""
    one, two = domain.facts(f), domain.facts(g)
    if not (one.nonnegative and two.nonnegative and ((one.convex and two.convex) or (one.concave and two.concave))):
        return False, False
    for load in _loads(f, domain):
        if of_load(f, load, domain) and of_load(g, load, domain):
            (up, down), (rises, falls) = _trend(f, load, domain), _trend(g, load, domain)
            along, against = (up and rises) or (down and falls), (up and falls) or (down and rises)
            return along and one.convex and two.convex, against and one.concave and two.concave
    return False, False


def _loads(term: Term, domain: StatedDomain) -> Iterator[Polynomial]:
    """The innermost affine parts."""
    for part in term.parts():
        if part.op in ("name", "+", "*") and not domain.constant(part) and domain.facts(part).affine:
            yield domain.polynomial(part)


def _trend(term: Term, load: Polynomial, domain: StatedDomain) -> tuple[bool, bool]:
    """Whether a function of one load alone does not fall in it, and does not rise; wherever it has a value."""
    if domain.constant(term):
        return True, True
    if (split := share_and_rest(domain.polynomial(term), load, domain)) is not None:
        sign = domain.facts(written(split[0])).sign
        return not sign & NEGATIVE, not sign & POSITIVE
    if term.op == "*":
        scale, moving = apart(term, domain)
        return scaled(_trend(moving[0], load, domain), domain.facts(scale).sign) if len(moving) == 1 else (False, False)
    if term.op == "**" and domain.constant(term.args[1]) and domain.facts(term.args[0]).nonnegative:
        return scaled(_trend(term.args[0], load, domain), domain.facts(term.args[1]).sign)
    if term.op in ("+", "pos", "max", "min", *RISING):
        parts = [_trend(a, load, domain) for a in term.args]
        return all(up for up, _ in parts), all(down for _, down in parts)
    return False, False
