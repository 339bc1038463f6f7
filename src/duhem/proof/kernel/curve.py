"""A law given by a boundary curve, as its text says it: signs all around, and how often a vector turns.

With T the boundary and ' the derivative by the angle, part by part, enclosed over boxes that cover the circle: it is (c, s) and (-c, -s)
with c = (1 - t^2)/(1 + t^2), s = 2 t/(1 + t^2), |t| <= 1.  Theorems: a closed curve whose tangent turns once and to the
left throughout is simple and bounds a convex set; one that runs around 0 in polar order once is simple and bounds a set
star-shaped about 0 (M. P. do Carmo 1976, section 5-7).  A curve run clockwise is turned round first: T(-phi) with the
flow d(-phi) has the same points, each with the same slip, and winds around the same set.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from fractions import Fraction
from itertools import pairwise
from typing import Any, NamedTuple

from duhem.proof.kernel.bounds import NEGATIVE, POSITIVE, Bounds
from duhem.proof.kernel.constant_value import Enclosure, enclosed
from duhem.proof.kernel.domain import as_list, declared
from duhem.proof.kernel.gradient import gradient
from duhem.proof.kernel.term import NotWritten, Term, minus, number, parse, product_of, sum_of

__all__ = ["StatedCurve"]

_MOST_BOXES, _NARROWEST = 4096, Fraction(1, 2**24)  # in t; what is not shown there hardly ever is in narrower boxes
_COSINE, _SINE = (Term("name", name=f"{word} of the angle") for word in ("cosine", "sine"))  # no name of a law has blanks
_SMOOTH = ("number", "name", "+", "*", "**", "norm", "exp", "log", "sin", "cos", "tan", "sinh", "cosh", "tanh", "atan", "asin", "acos")
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
        one, two = (parse(text).put(fixed) for text in as_list(given["boundary"]))
        flow = None if given["flow"] is None else tuple(parse(text).put(fixed) for text in as_list(given["flow"]))
        if len(forces) != 2 or (flow is not None and len(flow) != 2):
            raise NotWritten("a boundary curve takes two forces")
        if any(not x.names() <= {given["angle"], *parameters, "pi"} for x in (one, two, *(flow or ()))):
            raise NotWritten("a name is not declared")
        return cls(forces, given["pressure"], given["angle"], (one, two), flow, parameters, constraints)

    def convex(self) -> bool:
        """T' x T'' > 0 and T' turns once, run one way or the other."""
        return self._turns_once(1, 2)

    def star_shaped(self) -> bool:
        """T x T' > 0 and T turns once, run one way or the other."""
        return self._turns_once(0, 1)

    def around_zero(self) -> bool:
        """T turns once around 0, which it never meets, run one way or the other."""
        return self._turns_once(0)

    def powered(self) -> bool:
        """T . d > 0."""
        if self.flow is None:
            return False
        power = sum_of(*map(product_of, self.derivative(0), (self._on_circle(x) for x in self.flow)))
        return self.turns((number(1), number(0)), power) is not None

    def reversed(self) -> StatedCurve:
        """The same law by T(-phi) and d(-phi), whose angle enters through its cosine and sine only."""
        sine = Term("sin", (Term("name", name=self.angle),))
        turn = {sine: minus(sine)}
        flow = None if self.flow is None else tuple(x.put(turn) for x in self.flow)
        return self._replace(boundary=tuple(x.put(turn) for x in self.boundary), flow=flow)

    def derivative(self, order: int) -> Vector:
        """T, T' or T'', by cosine and sine; NotWritten for what may have a kink."""
        x, y = map(self._on_circle, self.boundary)
        for _ in range(order):
            x, y = map(_along, (x, y))
        return x, y

    def _on_circle(self, term: Term) -> Term:
        here = (Term("name", name=self.angle),)
        return term.put({Term("cos", here): _COSINE, Term("sin", here): _SINE})

    def _turns_once(self, order: int, after: int | None = None) -> bool:
        """Whether a derivative turns once, to the left as one of a higher order says all around; of the curve or of its reverse."""
        for curve in (self, self.reversed()):
            x, y = vector = curve.derivative(order)
            u, v = curve.derivative(order if after is None else after)
            positive = number(1) if after is None else sum_of(product_of(x, v), minus(product_of(y, u)))
            if curve.turns(vector, positive) == 1:
                return True
        return False

    def turns(self, vector: Vector, positive: Term) -> int | None:
        """How often a vector turns (0 for none), where ``positive`` is > 0 and the vector is not 0 all around; None if not shown."""
        steps, quadrants, known = Steps(), list[int](), dict(self._enclosed_parameters())
        ends = _parts((positive, *vector), steps, {_COSINE.name, _SINE.name, "pi", *known})
        boxes = [(-1, Fraction(-1), Fraction(1)), (1, Fraction(-1), Fraction(1))]  # which half, and t from where to where
        while boxes:
            half, low, high = boxes.pop()
            found = _half_plane(steps, ends, {**known, **_circle(half, low, high)})
            if found is not None:
                quadrants.append(found)
                continue
            if high - low < _NARROWEST or len(quadrants) > _MOST_BOXES:
                return None
            middle = (low + high) / 2
            boxes += [(half, middle, high), (half, low, middle)]
        turned = [(after - before + 1) % 4 - 1 for before, after in pairwise([*quadrants, quadrants[0]])]
        return sum(turned) // 4 if max(map(abs, turned)) <= 1 else None

    def _enclosed_parameters(self) -> Iterator[tuple[str, Enclosure]]:
        for name, (low, high, *_) in self.parameters.items():
            if low is not None and high is not None:
                yield name, Enclosure.between(low, high)


def _along(term: Term) -> Term:
    """The derivative by the angle."""
    by_cosine, by_sine = gradient(term, (_COSINE.name, _SINE.name))
    return sum_of(product_of(minus(_SINE), by_cosine), product_of(_COSINE, by_sine))


def _parts(terms: tuple[Term, ...], steps: Steps, known: set[str]) -> list[Term]:
    """The terms by names of their parts, each of which stands once in ``steps``; what is ``known`` has bounds, and exponents stay."""
    named = dict[Term, Term]()

    def enter(term: Term) -> Term:
        if term.op not in _SMOOTH:
            raise NotWritten(f"no rule for {term.op}")
        if not term.names() <= known:
            raise NotWritten("a parameter has no bounds, or the angle stands alone")
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
