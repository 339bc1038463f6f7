"""A law given by a boundary curve, as its text says it: signs all around, and how often a vector turns.

With T the boundary and ' the derivative by the angle, part by part, enclosed over boxes that cover the circle: it is (c, s) and (-c, -s)
with c = (1 - t^2)/(1 + t^2), s = 2 t/(1 + t^2), |t| <= 1.  Where parameters have no ends, or enclosures show too little, signs are
those of polynomials in t and the parameters.  Theorems: a closed curve whose tangent turns once and to the
left throughout is simple and bounds a convex set; one that runs around 0 in polar order once is simple and bounds a set
star-shaped about 0; the tangent of a simple closed curve turns once (Hopf 1935, Compositio Math. 2, 50; M. P. do Carmo 1976, section
5-7).  A curve run clockwise is turned round first: T(-phi) with the flow d(-phi) has the same points, each with the same slip, and winds
around the same set.  A vector that moves continuously with the parameters, and is never 0, turns equally often at parameters that can be
joined; two that are nowhere opposite turn equally often.
"""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import suppress
from fractions import Fraction
from itertools import pairwise
from typing import Any, NamedTuple

from duhem.proof.kernel.bounds import ANY, NEGATIVE, POSITIVE, Bounds, Sign
from duhem.proof.kernel.constant_value import Enclosure, enclosed
from duhem.proof.kernel.curvature import over, shown
from duhem.proof.kernel.definedness import Reader
from duhem.proof.kernel.domain import StatedDomain, gap
from duhem.proof.kernel.gradient import gradient
from duhem.proof.kernel.identity import multiplied_through
from duhem.proof.kernel.plane_function import power_of
from duhem.proof.kernel.polynomial import ONE, Polynomial, in_powers, joined, negated, times, total, written
from duhem.proof.kernel.signs import RAY, nonnegative
from duhem.proof.kernel.stated_law import StatedLaw, as_list, declared, formula_over
from duhem.proof.kernel.term import HALF, NotWritten, Term, minus, number, parse, product_of, sum_of

__all__ = ["Stated", "StatedCurve"]

_FEW_BOXES, _MOST_BOXES = 256, 4096  # before polynomials are asked, and after
_NARROWEST = Fraction(1, 2**24)  # in t; what is not shown there hardly ever is in narrower boxes
_LONGEST = 4000  # parts of a formula; what is longer is too dear to multiply out
_COSINE, _SINE = (Term("name", name=f"{word} of the angle") for word in ("cosine", "sine"))  # no name of a law has blanks
_CONTINUOUS = (  # wherever they have a value; a derivative of what has a kink has a choice in it
    "number", "name", "+", "*", "**", "norm", "abs", "pos", "neg", "max", "min", "exp", "log", "sin", "cos", "tan", "sinh", "cosh",
    "tanh", "atan", "asin", "acos",
)  # fmt: skip
Vector = tuple[Term, Term]
Steps = list[tuple[str, Term]]  # names of parts, each with a formula of others before it


class StatedCurve(NamedTuple):
    """The law of a certificate: K = |pressure| times what the curve ``boundary`` (angle) winds around; ``flow`` its slip."""

    forces: tuple[str, ...]
    pressure: str
    angle: str
    boundary: tuple[Term, ...]
    flow: tuple[Term, ...] | None
    parameters: Mapping[str, Bounds]
    constraints: tuple[Term, ...]

    @classmethod
    def read(cls, given: Mapping[str, Any]) -> StatedCurve:
        """From the ``law`` of a certificate; NotWritten for what is no law or has no parameter values."""
        forces, parameters, constraints, fixed = declared(given, (given["pressure"], given["angle"]), {"angle", "boundary", "flow"})
        known = (given["angle"], *parameters, "pi")
        one, two = (formula_over(known, parse(text), fixed) for text in as_list(given["boundary"]))
        flow = None if given["flow"] is None else tuple(formula_over(known, parse(text), fixed) for text in as_list(given["flow"]))
        if len(forces) != 2 or (flow is not None and len(flow) != 2):
            raise NotWritten("a boundary curve takes two forces")
        return cls(forces, given["pressure"], given["angle"], (one, two), flow, parameters, constraints)

    def around_zero(self) -> bool:
        """T turns around 0, which it never meets: as is counted, as T x T' > 0 says, or as a flow does with which T . d > 0."""
        curve, reverse = self.both_ways()
        place, slips = curve.derivative(0), curve.slips()
        if curve.turns(place, number(1)):
            return True
        if slips is not None and curve.turns(slips, number(1)) and curve.continuous(*place) and curve.positive(_dot(place, slips)):
            return True
        return curve.bends_left(0) or reverse.bends_left(0)

    def convex(self) -> bool:
        """T' x T'' > 0 and T' turns once, run one way or the other; so does T' of every simple curve."""
        return any((curve.turns_once(0) and curve.bends_left(1)) or curve.turns_once(1) for curve in self.both_ways())

    def star_shaped(self) -> bool:
        """T x T' > 0 and T turns once, run one way or the other."""
        return any(curve.turns_once(0) for curve in self.both_ways())

    def powered(self) -> bool:
        """T . d >= 0; the normal of a curve run to the left is d = (T_b', -T_a'), and T . d = T x T'."""
        ways = self.both_ways()
        if (slips := ways[0].slips()) is None:
            return any(curve.bends_left(0) for curve in ways)
        return ways[0].positive(_dot(ways[0].derivative(0), slips), strict=False)

    def parallel(self) -> bool:
        """d . T' = 0 and d x T' > 0, where the curve is run so that T' x T'' > 0: d is the outward normal."""
        for curve in self.both_ways():
            if (slips := curve.slips()) is None:
                return False
            along = curve.derivative(1)
            lean, lead = _dot(slips, along), _cross(slips, along)
            if not curve.around().vanishes(lean):
                return False
            if curve.positive(lead) and curve.bends_left(1):
                return True
        return False

    def both_ways(self) -> tuple[StatedCurve, StatedCurve]:
        """The curve, and its reverse, over a domain with as few constraints as can be."""
        curve = self.by_shares()
        return curve, curve.reversed()

    def reversed(self) -> StatedCurve:
        """The same law by T(-phi) and d(-phi), whose angle enters through its cosine and sine only."""
        sine = Term("sin", (Term("name", name=self.angle),))
        return self.put({sine: minus(sine)})

    def by_shares(self) -> StatedCurve:
        """The same law without a constraint k m x < b: in the place of x > 0 stands q b/(k m) with 0 < q < 1, m a product of others > 0."""
        domain = over(self.on_forces(()))
        for i, constraint in enumerate(self.constraints):
            gaps = domain.polynomial(gap(constraint))
            limit, terms = gaps.get((), Fraction(0)), [(m, c) for m, c in gaps.items() if m]
            if limit <= 0 or len(terms) != 1 or terms[0][1] > 0 or any(domain.of(x) != POSITIVE for x, _ in terms[0][0]):
                continue
            ((product, factor),) = terms
            for x, n in product:
                if n != 1 or self.parameters.get(x.name) != Bounds(Fraction(0), None, True):
                    continue
                share, others = Term("name", name=f"share {i} of {x.name}"), tuple((y, -k) for y, k in product if y != x)
                swap = {x: written({joined(((share, 1),), others): -limit / factor})}
                bounds = {name: own for name, own in self.parameters.items() if name != x.name}
                bounds[share.name] = Bounds(Fraction(0), Fraction(1), True, len(constraint.op) == 1)
                rest = tuple(c.put(swap) for c in (*self.constraints[:i], *self.constraints[i + 1 :]))
                return self.put(swap)._replace(parameters=bounds, constraints=rest).by_shares()
        return self

    def on_forces(self, constraints: tuple[Term, ...]) -> StatedLaw:
        """Of a law given by a formula what it shares with this one, cosine and sine being parameters."""
        bounds = {**self.parameters, **dict.fromkeys((_COSINE.name, _SINE.name), Bounds(Fraction(-1), Fraction(1)))}
        return StatedLaw(self.forces, self.pressure, number(0), None, bounds, constraints)

    def put(self, swap: Mapping[Term, Term]) -> StatedCurve:
        """The same with boundary and flow in other terms."""
        one, two = (x.put(swap) for x in self.boundary)
        return self._replace(boundary=(one, two), flow=None if self.flow is None else tuple(x.put(swap) for x in self.flow))

    def derivative(self, order: int) -> Vector:
        """T, T' or T'', by cosine and sine; NotWritten for what has none."""
        x, y = map(self._on_circle, self.boundary)
        for _ in range(order):
            x, y = map(_along, (x, y))
        return x, y

    def bend(self, order: int) -> Term:
        """T x T', or T' x T''."""
        return _cross(self.derivative(order), self.derivative(order + 1))

    def slips(self) -> Vector | None:
        """d, by cosine and sine."""
        if self.flow is None:
            return None
        x, y = map(self._on_circle, self.flow)
        return x, y

    def _on_circle(self, term: Term) -> Term:
        here = (Term("name", name=self.angle),)
        found = term.put({Term("cos", here): _COSINE, Term("sin", here): _SINE})
        if self.angle in found.names():
            raise NotWritten("the angle stands alone")
        return found

    def bends_left(self, order: int) -> bool:
        """Whether T x T' > 0 (0), or T' x T'' > 0 (1), the derivatives being continuous."""
        return self.continuous(*self.derivative(order + 1)) and self.positive(self.bend(order))

    def continuous(self, *terms: Term) -> bool:
        """Whether formulas are continuous in the angle and the parameters wherever they have values."""
        return all(part.op in _CONTINUOUS for term in terms for part in term.parts())

    def turns_once(self, order: int) -> bool:
        """Whether T (0) or T' (1) turns once, to the left throughout.

        As it is never 0 where it bends to the left, it turns as often for all parameters, of which no constraint parts the domain.
        """
        vector, bend = self.derivative(order), self.bend(order)
        if self.turns(vector, bend, _FEW_BOXES) == 1:
            return True
        if not self.constraints:
            point = {Term("name", name=name): number(value) for name, value in self.point().items()}
            one, two = (x.put(point) for x in vector)
            if self.turns((one, two), number(1)) == 1 and self.bends_left(order):
                return True
        return self.turns(vector, bend) == 1

    def positive(self, term: Term, strict: bool = True) -> bool:
        """Whether it has a value and is > 0, or >= 0, at every angle."""
        ahead, around = (number(1), number(0)), self.around()
        if self.turns(ahead, term, _FEW_BOXES) is not None:
            return True
        with suppress(NotWritten):
            if term.size() <= _LONGEST and around.defined(term) and around.above(term, strict):
                return True
        return self.turns(ahead, term) is not None

    def point(self) -> dict[str, Fraction]:
        """Values well inside the ranges of the parameters, perhaps against a constraint."""
        return {name: _within(own) for name, own in self.parameters.items()}

    def around(self) -> _Around:
        """Signs at every angle."""
        return _Around(self.on_forces(self.constraints))

    def turns(self, vector: Vector, positive: Term, most: int = _MOST_BOXES) -> int | None:
        """How often a vector turns (0 for none), where ``positive`` is > 0 and the vector is not 0 all around.

        None if that is not shown in about ``most`` boxes.
        """
        ranges = ((name, own.low, own.high) for name, own in self.parameters.items())
        known = {name: Enclosure.between(low, high) for name, low, high in ranges if low is not None and high is not None}
        steps, quadrants = Steps(), list[int]()
        try:
            ends = _parts((positive, *vector), steps, {_COSINE.name, _SINE.name, "pi", *known})
        except NotWritten:
            return None
        boxes = [(-1, Fraction(-1), Fraction(1)), (1, Fraction(-1), Fraction(1))]  # which half, and t from where to where
        while boxes:
            half, low, high = boxes.pop()
            found = _half_plane(steps, ends, {**known, **_circle(half, low, high)})
            if found is not None:
                quadrants.append(found)
                continue
            if high - low < _NARROWEST or len(quadrants) > most:
                return None
            middle = (low + high) / 2
            boxes += [(half, middle, high), (half, low, middle)]
        turned = [(after - before + 1) % 4 - 1 for before, after in pairwise([*quadrants, quadrants[0]])]
        return sum(turned) // 4 if max(map(abs, turned)) <= 1 else None


Stated = StatedLaw | StatedCurve


def _within(bounds: Bounds) -> Fraction:
    """A number well inside."""
    low, high = bounds[:2]
    if low is None or high is None:
        return low + 1 if low is not None else Fraction(0) if high is None else high - 1
    return (low + high) / 2


def _dot(one: Vector, two: Vector) -> Term:
    return sum_of(*map(product_of, one, two))


def _cross(one: Vector, two: Vector) -> Term:
    return sum_of(product_of(one[0], two[1]), minus(product_of(one[1], two[0])))


def _along(term: Term) -> Term:
    """The derivative by the angle."""
    by_cosine, by_sine = gradient(term, (_COSINE.name, _SINE.name))
    return sum_of(product_of(minus(_SINE), by_cosine), product_of(_COSINE, by_sine))


def _parts(terms: tuple[Term, ...], steps: Steps, known: set[str]) -> list[Term]:
    """The terms by names of their parts, each of which stands once in ``steps``; what is ``known`` has bounds, and exponents stay."""
    named = dict[Term, Term]()

    def enter(term: Term) -> Term:
        if term.op not in _CONTINUOUS:
            raise NotWritten(f"no rule for {term.op}")
        if not term.names() <= known:
            raise NotWritten("a parameter has no bounds")
        if term.args and term not in named:
            inner = tuple(a if i and term.op == "**" else enter(a) for i, a in enumerate(term.args))
            steps.append((f"part {len(steps)}", term._replace(args=inner)))
            named[term] = Term("name", name=steps[-1][0])
        return named.get(term, term)

    return list(map(enter, terms))


def _half_plane(steps: Steps, ends: list[Term], box: dict[str, Enclosure]) -> int | None:
    """0 to 3 where, the first of three being > 0, of the others x > 0, y > 0, x < 0, y < 0 over a box; None where nothing is shown."""
    try:
        for name, formula in steps:
            box[name] = enclosed(formula, box)
        positive, x, y = (enclosed(end, box).sign for end in ends)
    except (ZeroDivisionError, ValueError):
        return None
    signs = ((x, POSITIVE), (y, POSITIVE), (x, NEGATIVE), (y, NEGATIVE)) if positive == POSITIVE else ()
    return next((i for i, (sign, wanted) in enumerate(signs) if sign == wanted), None)


def _circle(half: int, low: Fraction, high: Fraction) -> dict[str, Enclosure]:
    """Cosine and sine over a box: c falls with |t|, s rises with t."""
    far, near = max(abs(low), abs(high)), Fraction(0) if low <= 0 <= high else min(abs(low), abs(high))
    c = Enclosure.between((1 - far**2) / (1 + far**2), (1 - near**2) / (1 + near**2))
    s = Enclosure.between(2 * low / (1 + low**2), 2 * high / (1 + high**2))
    return {_COSINE.name: c if half > 0 else c.minus(), _SINE.name: s if half > 0 else s.minus()}


# -- all parameters together -------------------------------------------------------------------------------------------


class _Around(StatedDomain):
    """Signs of formulas in cosine and sine, all around the circle and wherever the parameters lie.

    A formula is multiplied out, and through with what it divides by.  It is >= 0, or > 0, where its terms show it, what is > 0 and divided
    by being a constraint; where with c = (1 - t^2)/(1 + t^2) and s = 2 t/(1 + t^2), or their opposites, it is a polynomial that is so for
    |t| <= 1; or where it is A + w B with a root w, A >= 0, and B or A^2 - w^2 B^2 is so.
    """

    def __init__(self, law: StatedLaw, signs: dict[Term, Sign] | None = None) -> None:
        """``signs`` are known already."""
        self._signs = dict[Term, Sign]() if signs is None else signs
        super().__init__(law, shown)

    def defined(self, term: Term) -> bool:
        """Whether it has a value, as it is written."""
        return Reader(self).undecided(term) is None

    def vanishes(self, term: Term) -> bool:
        """Whether it is 0 wherever it has a value."""
        return not _without_squares(multiplied_through(self.polynomial(term), self))

    def sign(self, term: Term) -> Sign:
        if term not in self._signs:
            self._signs[term] = ANY  # for who asks while it is found
            self._signs[term] = self._found_sign(term)
        return self._signs[term]

    def _found_sign(self, term: Term) -> Sign:
        for way, sign in ((term, POSITIVE), (minus(term), NEGATIVE)):
            with suppress(NotWritten):
                if self.above(way, strict=True):
                    return sign
        return self.facts(term).sign

    def above(self, term: Term, strict: bool) -> bool:
        """Whether it is >= 0, or > 0, where it has a value."""
        term = self._with_plain_divisors(term)
        divisors = dict.fromkeys(part.args[0] for part in term.parts() if part.op == "**" and part.args[1].value < 0)
        known = (x for x in divisors if self.sign(x) == POSITIVE and not self.nonnegative(x, strict=True))
        constraints = tuple(Term(">", (x, number(0))) for x in known)
        domain = _Around(self.law._replace(constraints=constraints), self._signs) if constraints else self
        return self._above(self.polynomial(term), strict, domain)

    def _with_plain_divisors(self, term: Term) -> Term:
        """The same, what is divided by being multiplied out and through with what it divides by itself."""
        term = term._replace(args=tuple(map(self._with_plain_divisors, term.args)))
        if term.op != "**" or term.args[1].value != -1:
            return term
        poly = self.polynomial(term.args[0])
        below = {x: -min(dict(m).get(x, 0) for m in poly) for m in poly for x, n in m if n < 0}
        lift = tuple(sorted(below.items()))
        base = written(dict(sorted((joined(m, lift), c) for m, c in poly.items())))
        return product_of(written({lift: Fraction(1)}), Term("**", (base, number(-1))))

    def _above(self, poly: Polynomial, strict: bool, domain: StatedDomain) -> bool:
        poly = _without_squares(multiplied_through(poly, self, signed=True))
        words = sorted({x for m in poly for x, _ in m if x.op != "name"})
        if not words and all(nonnegative(_along_half(poly, side), (Fraction(-1), Fraction(1)), self, strict) for side in (1, -1)):
            return True
        return domain.nonnegative(written(poly), strict) or any(self._above_with_root(root, poly, strict, domain) for root in words)

    def _above_with_root(self, root: Term, poly: Polynomial, strict: bool, domain: StatedDomain) -> bool:
        known = root.op in ("abs", "norm") or (root.op == "**" and root.args[1] == HALF)
        if not known or {dict(m).get(root, 0) for m in poly} - {0, 1}:
            return False
        (rest, share), square = in_powers(poly, root), self.polynomial(Term("**", (root, number(2))))
        if not self._above(rest, False, domain):
            return False
        if self._above(share, strict, domain) and (not strict or self._above(square, True, domain)):
            return True
        return self._above(total(times(rest, rest), negated(times(square, times(share, share)))), strict, domain)


def _without_squares(poly: Polynomial) -> Polynomial:
    """The polynomial with 1 - c^2 for s^2."""
    if any(n < 0 for m in poly for x, n in m if x in (_COSINE, _SINE)):
        raise NotWritten("it divides by a cosine or a sine")
    other = {(): Fraction(1), ((_COSINE, 2),): Fraction(-1)}
    parts = (
        times(times(part, power_of(other, n // 2)), {((_SINE, n % 2),) if n % 2 else (): Fraction(1)})
        for n, part in enumerate(in_powers(poly, _SINE))
    )
    return total(*parts)


def _along_half(poly: Polynomial, side: int) -> Polynomial:
    """The polynomial, by t and times a power of 1 + t^2, where c = side (1 - t^2)/(1 + t^2) and s = side 2 t/(1 + t^2)."""
    square: Polynomial = {((RAY, 2),): Fraction(1)}
    sine: Polynomial = {((RAY, 1),): Fraction(2)}
    cosine, both = total(ONE, negated(square)), total(ONE, square)
    powers = [(dict(m).get(_COSINE, 0), dict(m).get(_SINE, 0)) for m in poly]
    most = max((i + j for i, j in powers), default=0)
    found: Polynomial = {}
    for (m, factor), (i, j) in zip(poly.items(), powers, strict=True):
        part = {tuple((x, n) for x, n in m if x not in (_COSINE, _SINE)): factor * side ** (i + j)}
        for inner, n in ((cosine, i), (sine, j), (both, most - i - j)):
            part = times(part, power_of(inner, n))
        found = total(found, part)
    return found
