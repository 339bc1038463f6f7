"""K where g need not be quasiconvex everywhere: g = max(f, loads), or g has a logarithm of a load.

K lies where all loads in the maximum are <= 0, and where those under a logarithm are > 0, and those under a power between 0 and 1 >= 0:
elsewhere g is > 0 or has no value.  That region is convex, and so is K where g is defined and each part of the maximum quasiconvex in it,
a body with a convex profile or a set {u^n <= c v_1 ... v_m}, the v_i >= 0 and concave in it, m <= n whole, c >= 0: Lade and Duncan
(1975), I1^3 <= k I3.  (c v_1 ... v_m)^(1/n) is concave there, a geometric mean of the v_i and n - m constants (Boyd, Vandenberghe 2004,
3.2.4).  For odd n it is u that lies below it, a convex function; for even n |u|.  u^n/(v_1 ... v_m) <= c says the same where the v_i are
> 0.

So is {A <= c x^2 w}, sqrt A being convex, c > 0, x >= 0 affine, and v = x w concave in it: where x > 0 it is v >= 0, where x = 0 too, so
that it is {sqrt A <= sqrt(c x v)} and {v >= 0}, and both are convex.  Where A - c x h <= 0 with A >= 0, c > 0 and h >= 0, x is >= 0, or h
is 0.

So is {(|u|/x)^n <= w}, n >= 1, x > 0 affine, |u| convex and x w concave: it is {|u| <= x w^(1/n)} in {w >= 0} = {x w >= 0}, where
x w^(1/n) = x^(1 - 1/n) (x w)^(1/n) is concave.

A body with a profile is {Q <= H(t)}, t a load and Q a sum of squares of affine functions of the forces, H a polynomial.  It is
{sqrt Q <= sqrt H(t)}, and sqrt Q is a seminorm of (forces, 1): the body is convex where H >= 0 on an interval alone and sqrt H is concave
there, that is H'^2 - 2 H H'' >= 0 where H > 0.  Other loads may leave a part of the line to t.

K = {x in R: A(x) <= S(x)}, R = {all loads <= 0}, S = c (h_1 ... h_k)^e with c > 0, 0 < e < 1, is round where it ends.  Let A be
convex and C^1 where it is not 0, S concave in R, the h_j concave, >= 0 and C^1 there, and A < S somewhere inside R.  If A is >= 0, or no h
is 0 on an open set, K is convex, and S > 0 inside R.  At a boundary point inside R, A = S is not 0, so that f = A - S is C^1 near it; and
grad f is not 0, f being convex and somewhere below 0.

Where something >= 0 is 0 by which g divides, no point of K lies.  What is left need not be convex.  But let g be made of parts that have a
degree, so that it has a value on all of a ray from zero force or on none of it, and rise along each ray wherever it is 0.  Then K, and its
closure too, holds with each point all of the way to zero force, but perhaps its end: so sigma . n >= 0 for each normal n at sigma.

Where a load is 0, let no other be, one h be 0 and the others be > 0.  Then A <= 0 on K there, and into R along every d that does not keep
the load at 0, that h rises at least in proportion to the way t, being concave, and S like t^e, but A, being Lipschitz, like t.  All such d
thus point into K: its only normal is that of the load.  A convex set with one normal at each boundary point has a C^1 boundary
(Rockafellar 1970, theorem 25.5).  Bigoni and Piccolroaz's yield function (2004, IJSS 41, 2855) is such.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator
from contextlib import suppress
from fractions import Fraction
from itertools import chain, pairwise
from math import prod

from duhem.proof.kernel import signs
from duhem.proof.kernel.bounds import Facts
from duhem.proof.kernel.curvature import over, within_ranges
from duhem.proof.kernel.definedness import rarely_zero
from duhem.proof.kernel.domain import NEGATIVE, POSITIVE, ZERO, StatedDomain
from duhem.proof.kernel.forms import apart, at_end_of, inverse, multiple
from duhem.proof.kernel.polynomial import ONE, Polynomial, divided, in_powers, negated, replaced, slope, times, total, written
from duhem.proof.kernel.profiles import times_load
from duhem.proof.kernel.regularity import smooth_but_where_zero
from duhem.proof.kernel.signs import RAY, Line
from duhem.proof.kernel.stated_law import StatedLaw
from duhem.proof.kernel.term import HALF, NotWritten, Term, factors, minus, number, product_of, sum_of

__all__ = ["convex_by_its_profile", "convex_in_its_region", "region_of", "round_at_its_ends", "where_it_has_a_value", "where_loads_allow"]

_ONE = Fraction(1)


# -- bodies with a profile ---------------------------------------------------------------------------------------------


def convex_by_its_profile(f: Term, loads: Collection[Term], domain: StatedDomain) -> bool:
    """Whether f is defined and {f <= 0} is convex where the ``loads`` of the law are >= 0."""
    with suppress(NotWritten):
        poly, sides = domain.polynomial(f), [domain.polynomial(load) for load in loads]
        _moving(poly, domain)  # NotWritten where forces divide
        return domain.facts(f).defined and any(_by_load(poly, t, sides, domain) for t in chain(sides, _leading(poly, domain)))
    return False


def _by_load(poly: Polynomial, load: Polynomial, sides: Collection[Polynomial], domain: StatedDomain) -> bool:
    """Whether the body has a profile along this load, and one that makes it convex."""
    with suppress(NotWritten):
        x, place = _solved(load, domain)
        profile = _profile(replaced(poly, x, place), domain)
        along = [side for side in (replaced(side, x, place) for side in sides) if not _moving(side, domain)]
        return any(_rounded(h, lines, domain) for h, lines in _measured(profile, along, domain))
    return False


def _moving(poly: Polynomial, domain: StatedDomain) -> list[Term]:
    """The forces in a polynomial; NotWritten where they do not enter as such."""
    found = {x: n for m in poly for x, n in m if not domain.constant(x)}
    if any(x.op != "name" for x in found) or any(n < 0 for m in poly for x, n in m if x in found):
        raise NotWritten("it is no polynomial in the forces")
    return sorted(found)


def _leading(poly: Polynomial, domain: StatedDomain) -> Iterator[Polynomial]:
    """The load of whose power the terms of the highest degree are a multiple, if they are; x with the shares of the others in it."""
    forces = _moving(poly, domain)
    degree = max((_degree(m, forces) for m in poly), default=0)
    if degree < 3:
        return
    top = {m: c for m, c in poly.items() if _degree(m, forces) == degree}
    x = next((x for x in forces if any(dict(m).get(x) == degree for m in top)), None)
    if x is None:
        return
    *_, beside, own = in_powers(top, x)
    yield total({((x, 1),): Fraction(1)}, times({(): Fraction(1, degree)}, times(_inverse(own, domain), beside)))


def _degree(m: tuple[tuple[Term, int], ...], forces: Collection[Term]) -> int:
    return sum(n for x, n in m if x in forces)


def _inverse(constant: Polynomial, domain: StatedDomain) -> Polynomial:
    """1/c of a product of constants that are > 0, times a number."""
    if len(constant) != 1:
        raise NotWritten("a constant is not to be divided by")
    ((m, c),) = constant.items()
    if any(domain.of(y) & ~POSITIVE for y, _ in m):
        raise NotWritten("a constant may be <= 0")
    return divided(ONE, m, c)


def _solved(load: Polynomial, domain: StatedDomain) -> tuple[Term, Polynomial]:
    """A force, and what stands for it where the load is t."""
    for x in _moving(load, domain):
        rest, *own = in_powers(load, x)
        if len(own) == 1 and not _moving(own[0], domain):
            return x, times(_inverse(own[0], domain), total({((RAY, 1),): Fraction(1)}, negated(rest)))
    raise NotWritten("the load has no force to be solved for")


def _profile(poly: Polynomial, domain: StatedDomain) -> Polynomial:
    """H: with f = a y^2 + b y + c, a > 0, b affine, 4 a f = (2 a y + b)^2 + 4 a c - b^2; so one force after the other is removed."""
    while forces := _moving(poly, domain):
        y = forces[0]
        free, once, *twice = in_powers(poly, y)
        if len(twice) != 1 or _moving(twice[0], domain) or any(RAY in dict(m) for m in twice[0]):
            raise NotWritten("a force does not enter by its square alone")
        if any(_degree(m, (*forces, RAY)) > 1 for m in once) or domain.facts(written(twice[0])).sign != POSITIVE:
            raise NotWritten("no square of an affine function is left")
        poly = total(times({(): Fraction(4)}, times(twice[0], free)), negated(times(once, once)))
    return negated(poly)


def _measured(profile: Polynomial, sides: Collection[Polynomial], domain: StatedDomain) -> Iterator[tuple[Polynomial, list[Line]]]:
    """The profile without positive factors, and the sides in which no constants are left; t is measured in a constant > 0, if need be."""
    names = {x for m in profile for x, _ in m if x != RAY and domain.of(x) == POSITIVE}
    for unit in (None, *sorted(names)) if profile else ():
        scaled: Polynomial = {tuple(sorted([(RAY, 1), *([] if unit is None else [(unit, 1)])])): Fraction(1)}
        h, *others = (signs.without_content(replaced(p, RAY, scaled), domain) for p in (profile, *sides) if p)
        yield h, [line for line in map(signs.on_the_line, others) if line is not None]


def _rounded(h: Polynomial, sides: Collection[Line], domain: StatedDomain) -> bool:
    """Whether sqrt H is concave where H >= 0, or H > 0 between two sides and sqrt H concave, for all parameters; at a side it may be 0."""
    bend, (low, high) = _bend(h), _between(sides)
    line, bent = signs.on_the_line(h), signs.on_the_line(bend)
    if line is not None and bent is not None and _concave_root(line, bent, sides):
        return True
    if low is None or high is None or low >= high:
        return False
    return signs.nonnegative(_without_ends(h, low, high), (low, high), domain, strict=True) and signs.nonnegative(bend, (low, high), domain)


def _without_ends(h: Polynomial, low: Fraction, high: Fraction) -> Polynomial:
    """H without its factors t - low and high - t."""
    for end, sign in ((low, Fraction(1)), (high, Fraction(-1))):
        while h and not (split := signs.divided_by(h, (-end, 1)))[1]:
            h = times({(): sign}, split[0])
    return h


def _bend(h: Polynomial) -> Polynomial:
    """H'^2 - 2 H H''."""
    first = slope(h, RAY)
    return total(times(first, first), times({(): Fraction(-2)}, times(h, slope(first, RAY))))


def _concave_root(line: Line, bend: Line, sides: Collection[Line]) -> bool:
    """Whether sqrt H is concave, by its ``bend``, where H >= 0 and the sides, of degree 1 at most, are >= 0, which is an interval then."""
    shares = (Fraction(abs(c), abs(p[-1])) for p in (line, bend, *sides) for c in p[:-1])
    far = 2 + max(shares, default=Fraction(0))  # beyond it nothing changes any more (Cauchy's bound)
    low, high = (end * far if x is None else x for end, x in zip((-1, 1), _between(sides), strict=True))
    if low >= high:
        return True  # no more than one value of t is left
    ends = [(low, low), *signs.roots(signs.parts(line)[0], low, high), (high, high)]
    zeros = {i for i, (a, b) in enumerate(ends) if 0 < i < len(ends) - 1 or signs.sign_at(line, a) == 0}
    above = [i for i, ((_, a), (b, _)) in enumerate(pairwise(ends)) if signs.sign_at(line, (a + b) / 2) > 0]
    if not above:
        return len(zeros) < 2
    first, last = above[0], above[0] + 1
    return len(above) == 1 and zeros <= {first, last} and signs.nonnegative_on_the_line(bend, ends[first][0], ends[last][1])


def _between(sides: Collection[Line]) -> tuple[Fraction | None, Fraction | None]:
    """Where t lies; None for no end."""
    low, high = ([Fraction(-p[0], p[1]) for p in sides if len(p) == 2 and p[1] * way > 0] for way in (1, -1))
    return max(low, default=None), min(high, default=None)


# -- the region that loads leave of K ------------------------------------------------------------------------------------


def convex_in_its_region(law: StatedLaw) -> bool:
    """Whether every part of g is quasiconvex, or of a convex set, where all of its loads allow it to be <= 0; g has a value there."""
    _, others, inside = law.once(where_loads_allow)
    return all(
        _shown(part, inside).quasiconvex or _convex_below_a_product(part, inside) or convex_by_its_profile(part, [*inside.sides], inside)
        for part in others
    )


def where_loads_allow(law: StatedLaw) -> tuple[list[Term], list[Term], StatedDomain]:
    """The loads and the other parts of g, and the domain where the loads allow K."""
    domain = over(law)
    loads, others = _loads_and_others(law.g, domain)
    sides = {**within_ranges(law).sides, **dict.fromkeys(map(minus, loads), False)}
    for part in others:
        sides |= {x: strict for x, strict in _under_words(part, domain) if not domain.constant(x) and domain.facts(x).affine}
    for part in others:
        below = [domain.polynomial(f) for f in _divisors(part, domain)]
        sides |= dict.fromkeys((load for load in sides if any(multiple(f, domain.polynomial(load), domain) for f in below)), True)
    inside = domain.where(sides)
    more = dict.fromkeys((x for part in others for x in _loads_of_a_product(part, inside)), False)
    return loads, others, inside.where(more) if more else inside


def where_it_has_a_value(law: StatedLaw) -> StatedDomain:
    """Where the loads allow K and what is >= 0 and divided by in g is > 0: elsewhere g is > 0 or has no value.  It need not be convex."""
    _, others, inside = law.once(where_loads_allow)
    below = dict.fromkeys(f for part in others for f in _divisors(part, inside))
    return inside.where(dict.fromkeys((f for f in below if over(law).facts(f).nonnegative), True))


def _divisors(part: Term, domain: StatedDomain) -> Iterator[Term]:
    """What a part divides by wherever it is read: where one of them is 0 it has no value, and no point of K lies there."""
    power = domain.facts(part.args[1]).sign if part.op == "**" else POSITIVE
    if power == NEGATIVE:
        yield from (_under_roots(f, domain) for f in _repeated(part.args[0]) if not domain.constant(f))
    for a in part.args[:1] if part.op in ("**", "where") else part.args:
        if not domain.constant(a) and not power & ZERO:  # x^0 is 1
            yield from _divisors(a, domain)


def _under_roots(term: Term, domain: StatedDomain) -> Term:
    """What a term is a power > 0 of, or the part of that which is > 0."""
    while term.op == "pos" or (term.op == "**" and domain.facts(term.args[1]).sign == POSITIVE):
        term = term.args[0]
    return term


def _loads_of_a_product(part: Term, domain: StatedDomain) -> Iterator[Term]:
    """Each x of ``part`` = A - c x h with A >= 0, c > 0 and h >= 0, that is >= 0 where h is 0 too."""
    for rest, product in _without_one(part) if part.op == "+" else ():
        scale, moving = apart(product, domain)
        if len(moving) < 2 or domain.facts(scale).sign != NEGATIVE or not domain.facts(rest).nonnegative:
            continue
        for i, x in enumerate(moving):
            others = [*moving[:i], *moving[i + 1 :]]  # x among them, where it stands twice: x x >= 0 on either side of 0
            if domain.facts(x).affine and domain.facts(x).sign & NEGATIVE and all(_leaves(x, h, domain) for h in others):
                yield x


def _leaves(x: Term, h: Term, domain: StatedDomain) -> bool:
    """Whether h >= 0, and x >= 0 where it is 0: that is where a load is 0."""
    known = _shown(h, domain)
    if not known.nonnegative:
        return False
    if known.sign == POSITIVE:
        return True
    base = _under_roots(h, domain)
    shares = ((side, multiple(domain.polynomial(base), domain.polynomial(side), domain)) for side in domain.sides)
    loads = [side for side, share in shares if share and domain.facts(written(share)).sign == POSITIVE]
    with suppress(NotWritten):
        return any(domain.facts(at_end_of(load, x, domain)).nonnegative for load in loads)
    return False


def region_of(law: StatedLaw) -> frozenset[object]:
    """What is >= 0, or > 0, where the loads of g allow K, each multiplied out."""
    _, _, inside = law.once(where_loads_allow)
    return frozenset((frozenset(inside.polynomial(side).items()), strict) for side, strict in inside.sides.items())


def _loads_and_others(g: Term, domain: StatedDomain) -> tuple[list[Term], list[Term]]:
    """What a maximum is taken of: loads, which are affine and defined everywhere, and the rest."""
    parts = [*_greatest(g)]
    loads = [part for part in parts if not domain.constant(part) and _shown(part, domain).affine]
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


def _under_words(part: Term, domain: StatedDomain) -> Iterator[tuple[Term, bool]]:
    """What is > 0, under logarithms that are added up, times something, or >= 0, under powers between 0 and 1: else they have no value.

    Of one that cancels K is not closed, and nothing is said of it.
    """
    for x in {x for m in domain.polynomial(part) for x, _ in m}:
        if x.op == "log":
            c, moving = apart(inverse(x.args[0], domain) or x.args[0], domain)
            yield product_of(*moving) if domain.facts(c).sign == POSITIVE else x.args[0], True
        elif x.op == "**" and domain.facts(x.args[1]).sign == POSITIVE == domain.facts(sum_of(number(1), minus(x.args[1]))).sign:
            yield x.args[0], False


def _convex_below_a_product(part: Term, domain: StatedDomain) -> bool:
    """Whether ``part`` is such a u^n - c v_1 ... v_m, A - c x^2 w or (|u|/x)^n - w, as written, so that {part <= 0} is convex."""
    if part.op != "+":
        return False
    ways = [*_without_one(part)]
    ways += [cleared for rest, product in ways if (cleared := _cleared(product, rest, domain)) is not None]
    return any(_below(rest, product, domain) or _below_a_load(rest, product, domain) for rest, product in ways)


def _without_one(whole: Term) -> Iterator[tuple[Term, Term]]:
    """What is left of a sum without one of its terms, and that term."""
    for i, term in enumerate(whole.args):
        rest = [*whole.args[:i], *whole.args[i + 1 :]]
        yield rest[0] if len(rest) == 1 else sum_of(*rest), term


def _cleared(product: Term, rest: Term, domain: StatedDomain) -> tuple[Term, Term] | None:
    """c u^n and -k v_1 ... v_m of c u^n/(v_1 ... v_m) - k, c > 0 and the v_i > 0: they add up to what has its sign."""
    scale, moving = apart(product, domain)
    under = [f for f in moving if f.op == "**" and f.args[1].op == "number" and f.args[1].value < 0 and f.args[1].value.denominator == 1]
    above = [f for f in moving if f not in under]
    if not under or len(above) != 1 or not domain.constant(rest) or any(domain.facts(f).sign != POSITIVE for f in (scale, *under)):
        return None
    divisors = [part for f in under for part in _repeated(f.args[0]) * -int(f.args[1].value)]
    return above[0], product_of(rest, Term("**", (scale, number(-1))), *divisors)


def _repeated(term: Term) -> list[Term]:
    """Its factors, whole powers as such."""
    found = list[Term]()
    for f in factors(term):
        n = f.args[1].value if f.op == "**" and f.args[1].op == "number" else None
        found += [f] if n is None or n.denominator > 1 or n < 1 else [f.args[0]] * int(n)
    return found


def _below(power: Term, rest: Term, domain: StatedDomain) -> bool:
    n = power.args[1].value if power.op == "**" and power.args[1].op == "number" else None
    if n is None or n.denominator > 1 or n <= 0:
        return False
    scale, moving = apart(rest, domain)
    u, c, concave = _shown(power.args[0], domain), _shown(minus(scale), domain), [_shown(f, domain) for f in moving]
    convex = u.convex_in_size if n % 2 == 0 else u.convex
    return convex and c.nonnegative and 0 < len(concave) <= n and all(v.concave and v.nonnegative for v in concave)


def _below_a_load(rest: Term, product: Term, domain: StatedDomain) -> bool:
    """Whether they are A and -c x^2 w, or -w and (|u|/x)^n with x > 0, n >= 1."""
    (scale, moving), found = apart(product, domain), list[tuple[Term, Term, Term]]()  # sqrt A or |u|, x and c w
    sign, squares = _shown(scale, domain).sign, [f for f in moving if f.op == "**" and f.args[1] == number(2)]
    if squares and len(moving) == 2 and sign in (NEGATIVE, POSITIVE):
        other = moving[moving[0] is squares[0]]
        found.append((Term("**", (rest, HALF)), squares[0].args[0], other if sign == NEGATIVE else minus(other)))
    if product.op == "**" and domain.constant(n := product.args[1]) and not domain.facts(sum_of(n, number(-1))).sign & NEGATIVE:
        _, parts = apart(product.args[0], domain)
        under = [y for f in parts if f.op == "**" and f.args[1] == number(-1) for y in apart(f.args[0], domain)[1]]
        above = [f for f in parts if f.op != "**" or f.args[1] != number(-1)]
        if len(under) == len(above) == 1 and _shown(product.args[0], domain).nonnegative and _shown(under[0], domain).sign == POSITIVE:
            found.append((above[0], under[0], minus(rest)))

    def convex(size: Term, load: Term, w: Term) -> bool:
        u, x, whole = (_shown(term, domain) for term in (size, load, times_load(load, w, domain)))
        return u.convex and u.nonnegative and x.affine and x.nonnegative and domain.facts(w).defined and whole.concave

    return any(convex(*way) for way in found)


def _shown(term: Term, domain: StatedDomain) -> Facts:
    """What is shown of a part that has a value; of another nothing is."""
    known = domain.facts(term)
    return known if known.defined else Facts()


def round_at_its_ends(law: StatedLaw) -> bool:
    """Whether g is the greatest of loads and such an f = A - S, g being < 0 somewhere; outside some loads S may have no value."""
    domain, (loads, others) = over(law), _loads_and_others(law.g, over(law))
    loads = loads or [minus(h) for part in others for h, strict in _under_words(part, domain) if not strict and domain.facts(h).affine]
    if not loads or len(others) != 1:
        return False
    inside = domain.where(dict.fromkeys(map(minus, loads), False))
    gauge, parts = _gauge_and_parts(others[0], domain)
    size = _shown(gauge, domain)
    return (
        (_shown(others[0], inside).convex and size.convex and smooth_but_where_zero(gauge, domain))
        and (size.nonnegative or all(rarely_zero(h, domain) for h in parts))
        and all(inside.facts(h).concave and inside.facts(h).nonnegative and smooth_but_where_zero(h, domain) for h in parts)
        and all(_ends_round(load, loads, parts, domain) for load in loads)
    )


def _gauge_and_parts(f: Term, domain: StatedDomain) -> tuple[Term, list[Term]]:
    """A and the h of f = A - c (h_1 ... h_k)^e; NotWritten where f is not of that form."""
    for rest, root in _without_one(f) if f.op == "+" else ():
        scale, moving = apart(root, domain)
        if len(moving) != 1 or moving[0].op != "**" or domain.facts(scale).sign != NEGATIVE:
            continue
        base, e = moving[0].args
        scale, parts = apart(base.args[0] if base.op == "pos" else base, domain)
        below_one = domain.facts(sum_of(number(1), minus(e))).sign
        if domain.constant(e) and domain.facts(e).sign == below_one == domain.facts(scale).sign == POSITIVE:
            return rest, parts
    raise NotWritten("no root is subtracted")


def _ends_round(load: Term, loads: list[Term], parts: list[Term], domain: StatedDomain) -> bool:
    """Whether the other loads are < 0 where this one is 0, and of the h one is 0 there and the others > 0."""
    others = [_shown(at_end_of(load, other, domain), domain) for other in loads if other is not load]
    beside = sorted(_shown(at_end_of(load, h, domain), domain).sign for h in parts)
    return all(other.sign == NEGATIVE for other in others) and beside == [ZERO, *[POSITIVE] * (len(parts) - 1)]
