"""Convexity of K by composition: what every part of the formula is follows from its arguments, one theorem a rule.

Rules: Grant, Boyd, Ye (2006), Disciplined convex programming; Agrawal, Boyd (2020), Disciplined quasiconvex programming.
A part counts only where it is shown to be defined, for all forces, the whole domain and every pressure sigma_n < 0.

Parts of a sum show something together: the matrix of a quadratic form; in the normal form a part that stands several times and kinks of one
x, for |x| - k x is (1 - k) pos(x) + (1 + k) neg(x) there (Cazacu, Plunkett, Barlat 2006, IJP 22, 1171).

c max(x, ...) - c min(x, ...) is >= 0 for c >= 0, as x lies between; so is the greatest less the least eigenvalue of a matrix.

A quadratic formula is convex where its matrix is positive semidefinite, >= 0 where it is so with 1 as a force more; a form of higher even
degree is convex where its matrix is (:mod:`semidefinite`).
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from dataclasses import replace
from fractions import Fraction
from functools import reduce
from operator import and_, or_

from duhem.proof.kernel.bounds import Facts, of_sum, signs_of_product
from duhem.proof.kernel.constant_value import RISING, below_right
from duhem.proof.kernel.definedness import has_value
from duhem.proof.kernel.deviatoric import convex_in_deviator
from duhem.proof.kernel.domain import ANY, NEGATIVE, POSITIVE, ZERO, Sign, StatedDomain
from duhem.proof.kernel.forms import affine, apart, degree_at_most, multiple, quadratic, sign_within
from duhem.proof.kernel.normal_form import normal
from duhem.proof.kernel.polynomial import written
from duhem.proof.kernel.profiles import closed_at_its_end, convex_with_exponential_ramps, scaled, shape_of_two
from duhem.proof.kernel.semidefinite import only_at_zero_force, semidefinite, sum_of_even_powers
from duhem.proof.kernel.signs import sign_of_constant
from duhem.proof.kernel.spectrum import quasiconvex_with_parts_freed
from duhem.proof.kernel.stated_law import StatedLaw
from duhem.proof.kernel.steps import pay
from duhem.proof.kernel.term import HALF, NotWritten, Term, minus, number, product_of, sum_of

__all__ = ["over", "shown", "within_ranges"]

_ONE = number(1)
_SIGN_KEPT = (  # words that are odd, rise, and are concave from 0 on; a new word is a row here
    "tanh", "atan",
)  # fmt: skip
_KINKS, _MOST_KINDS = ("abs", "pos", "neg"), 12  # of a sum, the parts that are not equal
_SHORT_SUM = 3  # terms
_PRICE = 100  # steps for a part of a formula, beside what its polynomials cost


def over(law: StatedLaw) -> StatedDomain:
    """The domain of a law, in which the rules below say what is shown of a term: one a law, so that it is shown once for all who ask."""
    return law.once(StatedDomain, shown)


def within_ranges(law: StatedLaw) -> StatedDomain:
    """The same where every force lies in its range: the claims are asked there alone."""
    sides = list[Term]()
    for x, own in ((Term("name", name=name), own) for name, own in law.ranges if name in law.forces):
        sides += [] if own.low is None else [sum_of(x, number(-own.low))]
        sides += [] if own.high is None else [sum_of(number(own.high), minus(x))]
    return over(law).where(dict.fromkeys(sides, False)) if sides else over(law)


def shown(term: Term, domain: StatedDomain) -> Facts:
    """What the rules show of a term over a domain; ``StatedDomain.facts`` keeps it."""
    pay(_PRICE)
    known, plain = _by_its_word(term, domain), domain.plain(term)
    if plain is not term:  # its value is simpler; what must be defined is what was written
        known = replace(domain.facts(plain), defined=known.defined)
    if domain.constant(term):
        known = Facts(known.defined, sign_of_constant(term, known.sign, domain), True, True, True)
    elif not term.large:
        known = _of_its_spelling(term, known, domain)
        known = known if known.defined and known.convex else _of_parts_together(term, known, domain)
    if domain.sides:
        known = replace(known, sign=known.sign & sign_within(term, known, domain))
        if known.sign == ZERO | POSITIVE and only_at_zero_force(term, domain):
            left_out = any(strict and only_at_zero_force(side, domain) for side, strict in domain.sides.items())
            known = replace(known, sign=POSITIVE if left_out else known.sign)
    return known


def _of_parts_together(term: Term, known: Facts, domain: StatedDomain) -> Facts:
    """What is shown of a term by rules that look at more than its parts one by one."""
    if term.op in ("+", "*", "**", "where") and (found := convex_in_deviator(term, domain)) is not None:
        return replace(found, defined=found.defined or known.defined)
    if term.op == "+" and known.defined and (squared := by_its_matrix(term, known, domain)) != known:
        return squared
    if known.defined and (found := quasiconvex_with_parts_freed(term, domain)) is not None:
        return replace(known, sign=known.sign & found.sign, convex=found.convex, quasiconvex=True)
    return known


def _of_its_spelling(term: Term, known: Facts, domain: StatedDomain) -> Facts:
    """What is shown of a term by its normal form, of a root that is not convex, and of a sum with kinks or with one part several times."""
    if not known.defined or known.affine or (known.convex and (known.nonnegative or term.op != "+")):
        return known
    parts = [(part, len(scales)) for part, scales in _summed(term, domain).items() if not domain.constant(part)] if term.op == "+" else []
    kinked = len(parts) <= _MOST_KINDS and any(part.op in _KINKS or (n > 1 and part.op != "name") for part, n in parts)
    rooted = term.op == "**" and term.args[1] == HALF and term.args[0].op in ("+", "*", "**")
    with suppress(NotWritten):
        form = normal(term, domain) if kinked or rooted else term
        found = [domain.facts(form)] if form != term and normal(form, domain) == form else []  # one that is its own
        found += [_by_its_word(spelled, domain) for spelled in _by_one_ramp(term, domain)] if kinked and form == term else []
        sign, convex = reduce(and_, (shape.sign for shape in found), known.sign), any(shape.convex for shape in (known, *found))
        return replace(known, sign=sign, convex=convex, quasiconvex=convex or any(shape.quasiconvex for shape in (known, *found)))
    return known


def _by_one_ramp(term: Term, domain: StatedDomain) -> Iterator[Term]:
    """A sum with neg(x) = pos(x) - x and |x| = 2 pos(x) - x, and with pos(x) = neg(x) + x and |x| = 2 neg(x) + x; every part once."""
    for ramp, way in (("pos", -1), ("neg", 1)):
        swapped = list[Term]()
        for part, scales in _summed(term, domain).items():
            ramps = [Term(ramp, part.args)] * (2 if part.op == "abs" else 1)
            turned = part.op in _KINKS and part.op != ramp and not domain.constant(part)
            swapped.append(product_of(sum_of(*scales), sum_of(*ramps, product_of(number(way), *part.args)) if turned else part))
        yield sum_of(*(product_of(sum_of(*scales), part) for part, scales in _summed(sum_of(*swapped), domain).items()))


def _by_its_word(term: Term, domain: StatedDomain) -> Facts:
    """What the word of a term says, by what is shown of its arguments."""
    if term.op == "number":
        return Facts(True, POSITIVE if term.value > 0 else NEGATIVE if term.value else ZERO, True, True, True)
    if term.op == "name":
        return Facts(True, domain.of(term), True, True, True)
    if term.op == "**":
        return _power(term, domain)
    parts = [domain.facts(a) for a in term.args]
    x, defined = parts[0], all(p.defined for p in parts) and has_value(term, lambda a: domain.facts(a).sign, domain)
    match term.op:
        case "+":
            return _total(term, parts, domain)
        case "*":
            return _product(term, parts, domain)
        case "abs" | "pos" if x.nonnegative and not domain.constant(term):
            return x
        case "norm" | "abs":
            convex, nonzero = all(p.convex_in_size for p in parts), any(not p.sign & ZERO for p in parts)
            sign = ZERO if all(p.sign == ZERO for p in parts) else POSITIVE if nonzero else ZERO | POSITIVE
            return Facts(defined, sign, convex, False, convex)
        case "max":
            return _greatest(parts)
        case "eigmax":  # the greatest of n . A n, affine in A
            if all(p.sign == ZERO for p in parts[3:]):
                return replace(_greatest(parts[:3]), defined=defined)
            return Facts(defined, ANY, all(p.affine for p in parts), False, all(p.affine for p in parts))
        case "min":
            return _greatest([p.negated() for p in parts]).negated()
        case "pos" | "neg":
            x = x if term.op == "pos" else x.negated()
            sign = x.sign & POSITIVE | (ZERO if x.sign & (ZERO | NEGATIVE) else 0)
            return Facts(x.defined, sign, x.convex, False, x.quasiconvex)
        case "exp":
            return Facts(x.defined, POSITIVE, x.convex, False, x.quasiconvex)
        case "log":
            convex = _log_convex(term.args[0], domain)
            return Facts(defined, _above_one(term.args[0], domain), convex, x.concave, convex or x.quasiconvex)
        case "asin" | "acos":
            shape = _risen(x if term.op == "asin" else x.negated())  # acos x = pi/2 + asin(-x)
            below = domain.facts(Term("+", (_ONE, minus(term.args[0]))))
            return replace(shape, defined=defined, sign=x.sign if term.op == "asin" else below.sign & (ZERO | POSITIVE))
        case "sinh":
            return _risen(x)
        case "cosh":
            return Facts(x.defined, POSITIVE, x.convex_in_size, False, x.convex_in_size)
        case "tan" if defined and below_right(term.args[0], domain.sign):  # beyond it has another sign than its angle
            return _risen(x)
        case word if word in _SIGN_KEPT:
            return Facts(x.defined, x.sign, x.convex and not x.sign & POSITIVE, x.concave and x.nonnegative, x.quasiconvex)
        case "sin" | "cos" if below_right(term.args[0], domain.sign):
            return Facts(x.defined, x.sign if term.op == "sin" else POSITIVE)
        case "sin" | "cos" | "tan" | "atan2" | "<" | "<=" | ">" | ">=":  # an angle jumps where the first is 0 and the second < 0
            return Facts(defined)
        case "where":
            chosen = domain.decided(term.args[0])  # what is chosen; else it may jump
            if chosen is None and (closed := closed_at_its_end(term, domain)) is not None:
                return closed
            return Facts(chosen is not None and x.defined and parts[1 if chosen else 2].defined, parts[1].sign | parts[2].sign)
    return Facts()


def _risen(x: Facts) -> Facts:
    """Of what is increasing and odd in x, convex from 0 on."""
    return Facts(x.defined, x.sign, x.convex and x.nonnegative, x.concave and not x.sign & POSITIVE, x.quasiconvex)


def _total(term: Term, parts: list[Facts], domain: StatedDomain) -> Facts:
    moving, still = ([p for a, p in zip(term.args, parts, strict=True) if domain.constant(a) is c] for c in (False, True))
    known = of_sum(moving, still)
    if not known.convex and convex_with_exponential_ramps(term, domain):
        known = replace(known, convex=True, quasiconvex=True)
    if term.large:
        return known
    if known.sign & NEGATIVE and nonnegative_as_a_spread(term, domain):
        known = replace(known, sign=known.sign & ~NEGATIVE)
    return replace(known, sign=POSITIVE) if known.defined and known.sign == ANY and _root_outweighs(term, domain) else known


def _root_outweighs(term: Term, domain: StatedDomain) -> bool:
    """Whether a sum is r + y with a root or norm r and r^2 > y^2, so that it is > 0, as sqrt(1 + u^2) + u is; of short ones alone."""
    roots = [part for part in term.args if part.op == "norm" or (part.op == "**" and part.args[1] == HALF)]
    rest = sum_of(*(part for part in term.args if part not in roots))
    with suppress(NotWritten):
        if len(roots) != 1 or len(domain.polynomial(rest)) > _SHORT_SUM:
            return False
        square = sum_of(*map(product_of, roots[0].args, roots[0].args)) if roots[0].op == "norm" else roots[0].args[0]
        gap = domain.polynomial(sum_of(square, minus(product_of(rest, rest))))
        return len(gap) <= _SHORT_SUM and domain.facts(written(gap)).sign == POSITIVE
    return False


def _product(term: Term, parts: list[Facts], domain: StatedDomain) -> Facts:
    moving, still = ([p for a, p in zip(term.args, parts, strict=True) if domain.constant(a) is c] for c in (False, True))
    sign, scale = (reduce(signs_of_product, (p.sign for p in some), POSITIVE) for some in (parts, still))
    defined = all(p.defined for p in parts)
    if len(moving) != 1:
        if len(moving) != 2 or term.large:
            return Facts(defined, sign)
        f, g = (a for a in term.args if not domain.constant(a))
        logarithmic = any(_size_by_its_logarithm(a, b, domain) for a, b in ((f, g), (g, f)))
        over_loads = (of(a, b, domain) for of in (_square_over_load, _affine_over_load) for a, b in ((f, g), (g, f)))
        way = POSITIVE if logarithmic else next(filter(None, over_loads), 0)
        shape = (way == POSITIVE, way == NEGATIVE) if way else shape_of_two(f, g, domain)
        convex, concave = scaled(shape, scale)
        return Facts(defined, sign, convex, concave, convex)
    x = moving[0] if not scale & NEGATIVE else moving[0].negated()
    if scale & NEGATIVE and scale & POSITIVE:
        return Facts(defined, sign, x.affine, x.affine, x.affine)
    ridge = bool(scale & NEGATIVE) and not term.large and _quasiconcave(next(a for a in term.args if not domain.constant(a)), domain)
    return replace(x, defined=defined, sign=sign, quasiconvex=x.quasiconvex or ridge)


def _quasiconcave(term: Term, domain: StatedDomain) -> bool:
    """Whether -f is quasiconvex: f is concave, or a function that rises of what is quasiconcave."""
    known = domain.facts(term)
    if known.concave or term.op not in ("pos", "min", "**", "*", *RISING):
        return known.concave
    if term.op == "*":
        scale, moving = apart(term, domain)
        return len(moving) == 1 and not domain.facts(scale).sign & NEGATIVE and _quasiconcave(moving[0], domain)
    if term.op == "**":
        base, exponent = (domain.facts(a).sign for a in term.args)
        return not base & NEGATIVE and domain.constant(term.args[1]) and exponent == POSITIVE and _quasiconcave(term.args[0], domain)
    return all(_quasiconcave(a, domain) for a in term.args)


def _above_one(term: Term, domain: StatedDomain) -> Sign:
    """The sign of x - 1; of a sum its numbers are taken together, so that 1 + exp(x) is seen to be above 1."""
    parts = term.args if term.op == "+" else (term,)
    still = sum((a.value for a in parts if a.op == "number"), Fraction(-1))
    return domain.facts(Term("+", (*(a for a in parts if a.op != "number"), number(still)))).sign


def _log_convex(term: Term, domain: StatedDomain) -> bool:
    """Whether log x is convex, or -inf: of exponentials of convex parts, their sums and products with constants >= 0.

    Boyd, Vandenberghe (2004), 3.5.2: sums and products of log-convex functions are log-convex, so that softplus and log-sum-exp of
    convex parts are convex.
    """
    known: dict[Term, bool] = domain.kept.setdefault("log-convex", {})
    if term not in known:
        if domain.constant(term):
            known[term] = domain.facts(term).nonnegative
        elif term.op == "exp":
            known[term] = domain.facts(term.args[0]).convex
        else:
            known[term] = term.op in ("+", "*") and all(_log_convex(a, domain) for a in term.args)
    return known[term]


def _size_by_its_logarithm(x: Term, logarithm: Term, domain: StatedDomain) -> bool:
    """x log(c x) with x affine and > 0, c > 0."""
    if logarithm.op != "log" or not (size := domain.facts(logarithm.args[0])).affine or size.sign != POSITIVE:
        return False
    share = multiple(domain.polynomial(x), domain.polynomial(logarithm.args[0]), domain)
    return bool(share and not domain.facts(written(share)).sign & NEGATIVE)


def _square_over_load(square: Term, under: Term, domain: StatedDomain) -> Sign:
    """The sign of x in h^2/x, h convex and >= 0, the root of the first factor, and x concave and > 0, or convex and < 0; 0 for others.

    It is convex for x > 0, concave for x < 0.
    """
    if under.op != "**" or under.args[1] != number(-1):
        return 0
    root = domain.facts(Term("**", (square, HALF)))
    if not (root.defined and root.convex):
        return 0
    load = domain.facts(under.args[0])
    shaped = (load.concave and load.sign == POSITIVE) or (load.convex and load.sign == NEGATIVE)
    return load.sign if shaped else 0


def _affine_over_load(part: Term, under: Term, domain: StatedDomain) -> Sign:
    """POSITIVE where u/v = a + b/v is convex, NEGATIVE where it is concave, for affine u = a v + b and v != 0; 0 for others.

    1/v is convex for v > 0 and concave for v < 0.
    """
    load = domain.facts(under.args[0]) if under.op == "**" and under.args[1] == number(-1) else Facts(False)
    if not (load.affine and load.sign in (POSITIVE, NEGATIVE) and domain.facts(part).affine):
        return 0
    with suppress(NotWritten):
        (u, c), (v, d) = (affine(x, domain.law.forces, domain) for x in (part, under.args[0]))
        steep = next((k for k, x in enumerate(v) if domain.facts(x).sign in (POSITIVE, NEGATIVE)), None)
        if steep is None or not all(domain.constant(x) for x in (*u, c, *v, d)):
            return 0
        rests = [sum_of(product_of(x, v[steep]), minus(product_of(u[steep], y))) for x, y in zip((*u, c), (*v, d), strict=True)]
        if not any(domain.polynomial(rest) for rest in rests[:-1]):
            sign = reduce(signs_of_product, (domain.facts(x).sign for x in (rests[-1], v[steep])), load.sign)
            return POSITIVE if not sign & NEGATIVE else NEGATIVE if not sign & POSITIVE else 0
    return 0


def _greatest(parts: list[Facts]) -> Facts:
    together = reduce(or_, (p.sign for p in parts))
    if any(p.sign == POSITIVE for p in parts):
        together = POSITIVE
    elif any(p.nonnegative for p in parts):
        together &= ~NEGATIVE
    convex, quasi = all(p.convex for p in parts), all(p.quasiconvex for p in parts)
    return Facts(all(p.defined for p in parts), together, convex, False, quasi)


def _power(term: Term, domain: StatedDomain) -> Facts:
    base, exponent = (domain.facts(a) for a in term.args)
    p = term.args[1].value if term.args[1].op == "number" else None
    whole = p is not None and p.denominator == 1
    defined = base.defined and exponent.defined and has_value(term, lambda a: domain.facts(a).sign, domain)
    if p == 0:
        return Facts(base.defined, POSITIVE, True, True, True)  # x**0 is 1, as in polynomials
    if p == 1:
        return base
    if not domain.constant(term.args[1]):
        return Facts(defined, POSITIVE if base.sign == POSITIVE else ANY)
    if exponent.sign == NEGATIVE and base.sign == POSITIVE and base.concave:  # Boyd, Vandenberghe (2004), 3.2.4
        return Facts(defined, POSITIVE, True, False, True)
    if whole and p and p % 2 == 0:
        sign = base.sign & ZERO | (POSITIVE if base.sign != ZERO else 0)
        return Facts(defined, sign, p > 0 and base.convex_in_size, False, p > 0 and base.convex_in_size)
    if not base.nonnegative:
        rising = bool(whole and p and p > 0)
        root = ANY if p is None else POSITIVE | (ZERO if p > 0 else 0)  # it has a value for a base >= 0 alone
        return Facts(defined, base.sign if whole else root, False, False, rising and base.quasiconvex)
    sign = base.sign if exponent.sign == POSITIVE else POSITIVE | (base.sign if exponent.sign & POSITIVE else 0)
    if not domain.facts(Term("+", (term.args[1], number(-1)))).sign & NEGATIVE:
        return Facts(defined, sign, base.convex, False, base.quasiconvex)
    if exponent.sign == POSITIVE:
        mean = _geometric_mean(term, domain)
        below_one = not domain.facts(Term("+", (_ONE, minus(term.args[1])))).sign & NEGATIVE
        convex = _minkowski(term, domain) or _root_of_quadratic(term, domain)
        return Facts(defined, sign, convex, (base.concave and below_one) or mean, base.quasiconvex or convex)
    return Facts(defined, sign)


def _geometric_mean(term: Term, domain: StatedDomain) -> bool:
    """(x y ...)^p, n factors that are concave and >= 0 and n p <= 1."""
    base, exponent = term.args
    if base.op == "pos" and domain.facts(base.args[0]).nonnegative:
        base = base.args[0]
    scale, parts = apart(base, domain)
    moving = [domain.facts(f) for f in parts]
    enough = domain.facts(Term("+", (_ONE, minus(Term("*", (number(len(moving)), exponent))))))
    return len(moving) > 1 and all(x.concave and x.nonnegative for x in moving) and domain.facts(scale).nonnegative and enough.nonnegative


def _root_of_quadratic(term: Term, domain: StatedDomain) -> bool:
    """sqrt(x . A x + b . x + c), what is under the root being >= 0 for all x, in no region alone: a seminorm of (x, 1)."""
    if domain.sides and not domain.over(domain.law).facts(term.args[0]).nonnegative:
        return False
    degrees = [[n if x.op == "name" else 3 for x, n in m if not domain.constant(x)] for m in domain.polynomial(term.args[0])]
    return domain.polynomial(term.args[1]) == {(): Fraction(1, 2)} and all(min(d, default=0) >= 0 and sum(d) <= 2 for d in degrees)


def _minkowski(term: Term, domain: StatedDomain) -> bool:
    """(sum c_i v_i^q)^(1/q), q >= 1, c_i >= 0, v_i convex and >= 0 (or |v_i| convex, q even): Minkowski's inequality."""
    base, out = term.args
    shared: Term | None = None
    for part in base.args if base.op == "+" else (base,):
        scale, moving = apart(part, domain)
        if not (domain.facts(scale).defined and domain.facts(scale).nonnegative):
            return False
        if not moving and out == HALF:
            continue  # the square of its root: one term more
        if len(moving) != 1 or moving[0].op != "**" or (shared is not None and moving[0].args[1] != shared):
            return False
        inner, shared = moving[0].args
        size, above = domain.facts(inner), domain.facts(Term("+", (shared, number(-1)))).sign
        even = shared.op == "number" and shared.value % 2 == 0
        if above & NEGATIVE or not ((size.convex and size.nonnegative) or (even and size.convex_in_size)):
            return False
    return shared is not None and domain.polynomial(Term("*", (out, shared))) == {(): Fraction(1)}


# -- parts of a sum together -------------------------------------------------------------------------------------------


def _summed(term: Term, domain: StatedDomain) -> dict[Term, list[Term]]:
    """What is added up, in sums within sums too, each part with the constants it is multiplied by."""
    found: dict[Term, list[Term]] = {}
    queue = [(term, number(1))]
    while queue:
        part, scale = queue.pop()
        moving = [a for a in part.args if not domain.constant(a)] if part.op == "*" else []
        if part.op == "+":
            queue += [(a, scale) for a in part.args]
        elif len(moving) == 1:
            queue.append((moving[0], product_of(scale, *(a for a in part.args if domain.constant(a)))))
        else:
            found.setdefault(part, []).append(scale)
    return found


def nonnegative_as_a_spread(term: Term, domain: StatedDomain) -> bool:
    """Whether a sum is made of greatest less least values of what has a part in common, and of what is >= 0 itself."""
    parts = _summed(term, domain)
    left = dict(parts)
    for top in [part for part in parts if part.op in ("max", "eigmax")]:
        low = next((part for part in left if part is not top and _beneath(part, top, domain)), None)
        if low is None or top not in left:
            continue
        above, below = (sum_of(*left.pop(part)) for part in (top, low))
        share = below if low.op == "eigmax" else minus(below)
        if domain.facts(above).sign & NEGATIVE or domain.polynomial(above) != domain.polynomial(share):
            return False
    others = (product_of(sum_of(*scales), part) for part, scales in left.items())
    return len(left) < len(parts) and all(domain.facts(other).nonnegative for other in others)


def _beneath(low: Term, top: Term, domain: StatedDomain) -> bool:
    """Whether the least of parts, or the negative of another greatest eigenvalue, is no more than the greatest."""
    if top.op == "max":
        return low.op == "min" and bool({*top.args} & {*low.args})
    return low.op == "eigmax" and all(not domain.polynomial(sum_of(a, b)) for a, b in zip(top.args, low.args, strict=True))


def by_its_matrix(term: Term, known: Facts, domain: StatedDomain) -> Facts:
    """What is ``known`` of a sum, and what matrices show: of its quadratic part where the rest is convex, or >= 0, too; of its forms."""
    parts = [product_of(scale, part) for part, scales in _summed(term, domain).items() for scale in scales]
    degrees = [degree_at_most(part, domain) for part in parts]
    square = sum_of(*(part for part, k in zip(parts, degrees, strict=True) if k in (0, 1, 2)))
    others = [domain.facts(part) for part, k in zip(parts, degrees, strict=True) if k not in (0, 1, 2)]
    names = sorted(square.names() & set(domain.law.forces))
    with suppress(NotWritten):
        if 2 in degrees:
            matrix, row, constant = quadratic(square, names, domain)
            if all(part.convex for part in others) and semidefinite(matrix, domain):
                known = replace(known, convex=True, quasiconvex=True)
            halves = [product_of(HALF, b) for b in row]
            wider = [*([*line, b] for line, b in zip(matrix, halves, strict=True)), [*halves, constant]]
            if all(part.nonnegative for part in others) and semidefinite(wider, domain):
                above = domain.facts(constant).sign == POSITIVE and all(domain.facts(b).sign == ZERO for b in row)
                known = replace(known, sign=known.sign & (POSITIVE if above else ZERO | POSITIVE))
        if not known.convex and max(k or 0 for k in degrees) > 2:
            forms = sum_of(*(part for part, k in zip(parts, degrees, strict=True) if k is not None))
            rest = (domain.facts(part) for part, k in zip(parts, degrees, strict=True) if k is None)
            if all(part.convex for part in rest) and sum_of_even_powers(forms, domain):
                known = replace(known, convex=True, quasiconvex=True)
    return known
