r"""A closed curve with numbers for all its parameters, in balls: a proof by subdivision of the angle.

Power series over Arb balls carry T, T', T'', ... over a whole arc at once, so each sign is shown arc by arc with directed
rounding.  Angles are in units of pi, from -1 to 1.  Kinks (abs, pos, ...) are followed where the sign of what they bend is
certain on the arc; else the arc stays open.
"""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import partial
from itertools import pairwise
from typing import Any

import flint
import sympy as sp

from duhem.errors import InputError
from duhem.expression.balls import ball, certain_sign
from duhem.expression.fold import fold
from duhem.expression.vocabulary import Neg, Norm, Pos, Where

__all__ = ["Ball", "Greatest", "Jet", "NumericCurve", "Span", "Vector", "cross", "dot", "normals"]

Ball = Any
Vector = tuple[Any, Any]
Span = tuple[Fraction, Fraction]
_TURN: Span = (Fraction(-1), Fraction(1))
_MOST, _NARROWEST = 8192, Fraction(1, 2**40)  # how many arcs are looked at, and how narrow ones, before a question is left open


def dot(a: Sequence[Ball], b: Sequence[Ball]) -> Ball:
    """a . b."""
    return a[0] * b[0] + a[1] * b[1]


def cross(a: Sequence[Ball], b: Sequence[Ball]) -> Ball:
    """a x b = a_1 b_2 - a_2 b_1."""
    return a[0] * b[1] - a[1] * b[0]


@dataclass(frozen=True)
class Jet:
    """Boundary and flow at an angle with their derivatives by it: ``boundary[k]``, ``flow[k]``; of numbers, balls or formulas."""

    boundary: tuple[Vector, ...]
    flow: tuple[Vector, ...]


@dataclass(frozen=True)
class Greatest:
    """The greatest size of a function of the angle lies in ``value`` and is taken in ``arcs`` only (units of pi)."""

    value: Ball
    arcs: tuple[Span, ...]


class NumericCurve:
    """phi -> (boundary, flow) in balls; ``cosine`` and ``sine`` are the symbols that stand for those of the angle.

    Without a flow of its own the flow is the outward normal of a curve run counter-clockwise.
    """

    def __init__(
        self, boundary: Sequence[sp.Expr], flow: Sequence[sp.Expr] | None, cosine: sp.Symbol, sine: sp.Symbol, seconds: float = 8.0
    ) -> None:
        self._program = _Program([*boundary, *(flow or ())], cosine, sine)
        self._deadline = time.monotonic() + seconds

    def over(self, span: Span, order: int) -> Jet:
        """Boundary and flow with derivatives up to ``order``, over the arc."""
        return self._along(flint.arb.pi() * ball(*span), order)

    def at(self, t: Fraction, order: int = 0) -> Jet:
        """The same at the one angle 2 atan t."""
        return self._along(2 * ball(t).atan(), order)

    def point(self, t: Fraction) -> Vector:
        """The boundary point at the angle 2 atan t."""
        return self.at(t).boundary[0]

    def _along(self, turn: Ball, order: int) -> Jet:
        angle = flint.arb_series([turn, 1], prec=order + 2)
        rows = [_derivatives(component, order + 1) for component in self._program(angle.cos(), angle.sin())]
        boundary = tuple(zip(rows[0], rows[1], strict=True))
        flow = zip(rows[2], rows[3], strict=True) if len(rows) == 4 else normals(boundary)
        return Jet(boundary[: order + 1], tuple(flow)[: order + 1])

    def positive(self, quantity: Callable[[Jet], Ball], order: int) -> bool:
        """Whether ``quantity`` is > 0 at every angle; False also when that stays open."""
        if any(quantity(self.over((x, x), order)) <= 0 for x, _ in _pieces(32)):
            return False
        queue, looked = deque(_pieces(8)), 0  # widest first: where a sign changes, narrow arcs never end
        while queue:
            span = queue.popleft()
            looked += 1
            value = quantity(self.over(span, order))
            if value.is_finite() and value > 0:
                continue
            if self._spent(span, looked) or value <= 0:
                return False
            queue.extend(_halves(span))
        return True

    def _spent(self, span: Span, looked: int) -> bool:
        return looked > _MOST or span[1] - span[0] < _NARROWEST or time.monotonic() > self._deadline

    def winding(self, vector: Callable[[Jet], Vector], order: int) -> int | None:
        """How often a vector that never vanishes turns around 0 while the angle runs once; None if that stays open.

        On an arc where the vector stays in the open half-plane of its value at the start, it turns by the angle between
        its values at the ends.
        """
        total, queue, looked = flint.arb(0), _pieces(16), 0
        while queue:
            span = queue.pop()
            looked += 1
            start, end = (vector(self.over((x, x), order)) for x in span)
            lead = dot(start, vector(self.over(span, order)))
            if lead.is_finite() and lead > 0:
                total += flint.arb.atan2(cross(start, end), dot(start, end))
                continue
            if self._spent(span, looked):
                return None
            queue.extend(_halves(span))
        turns = (total / (2 * flint.arb.pi())).unique_fmpz()
        return None if turns is None else int(turns)

    def greatest(self, quantity: Callable[[Jet], Sequence[Ball]], order: int, width: float) -> Greatest | None:
        """The greatest size of a quantity over all angles, to within ``width`` or as well as time allows; None if it stays open.

        ``quantity`` gives value, slope and second derivative; what is not finite says nothing.  Arcs that cannot hold the
        greatest size are dropped: their enclosure lies below one met, or their slope has one sign.
        """
        best, queue = flint.arb("-inf"), _pieces(32)
        found: Greatest | None = None
        while queue:
            kept: list[tuple[Span, Ball]] = []
            for span in queue:
                if time.monotonic() > self._deadline:
                    return found
                middle = (span[0] + span[1]) / 2
                here, over = quantity(self.over((middle, middle), order)), quantity(self.over(span, order))
                if here[0].is_finite() and here[0].abs_lower() > best:
                    best = here[0].abs_lower()
                reach = flint.arb.pi() * ball((span[0] - span[1]) / 2, (span[1] - span[0]) / 2)
                slopes = (over[1], here[1] + over[2] * reach)
                if any(certain_sign(slope) in (1, -1) for slope in slopes):
                    continue
                bounds = [over[0], here[0] + slopes[0] * reach, here[0] + here[1] * reach + over[2] * reach * reach / 2]
                kept.append((span, min((x.abs_upper() for x in bounds if x.is_finite()), key=float, default=flint.arb("inf"))))
            kept = [(span, bound) for span, bound in kept if not bound < best]
            if not kept:
                return found
            if all(bound.is_finite() for _, bound in kept):
                top = max((bound for _, bound in kept), key=float)
                found = Greatest(best.union(top), tuple(sorted(span for span, _ in kept)))
                if float((top - best).upper()) < width:
                    return found
            queue = [half for span, _ in kept for half in _halves(span)] if len(kept) < _MOST // 4 else []
        return found


def normals(derivatives: Sequence[Vector]) -> list[Vector]:
    """Outward normals (T_b', -T_a') of a curve run counter-clockwise, from its derivatives 0, 1, 2, ...; one fewer."""
    return [(b, -a) for a, b in derivatives[1:]]


class _Program:
    """Formulas in cosine and sine as a list of steps, walked once and run often."""

    def __init__(self, exprs: Sequence[sp.Expr], cosine: sp.Symbol, sine: sp.Symbol) -> None:
        self._steps: list[tuple[Callable[..., Any], tuple[int, ...]]] = []
        places = {cosine: 0, sine: 1}

        def register(step: Callable[..., Any], arguments: tuple[int, ...]) -> int:
            self._steps.append((step, arguments))
            return len(self._steps) + 1

        def leaf(node: Any) -> int:
            return places[node] if node in places else register(lambda: _constant(node), ())

        def recorder(row: Callable[..., Any]) -> Callable[..., int]:
            return lambda node, *arguments: register(partial(row, node), arguments)

        self._last = fold(sp.Tuple(*exprs), {kind: recorder(row) for kind, row in _TABLE.items()}, leaf)

    def __call__(self, cosine: Any, sine: Any) -> tuple[Any, ...]:
        values = [cosine, sine]
        for step, arguments in self._steps:
            values.append(step(*[values[k] for k in arguments]))
        return tuple(values[self._last])


def _pieces(n: int) -> list[Span]:
    low, high = _TURN
    ends = [low + (high - low) * k / n for k in range(n + 1)]
    return list(pairwise(ends))


def _halves(span: Span) -> list[Span]:
    middle = (span[0] + span[1]) / 2
    return [(span[0], middle), (middle, span[1])]


def _derivatives(component: Any, order: int) -> list[Ball]:
    if not isinstance(component, flint.arb_series):
        return [component, *([flint.arb(0)] * order)]
    factorial, found = 1, []
    for k in range(order + 1):
        factorial *= max(k, 1)
        found.append(component[k] * factorial)
    return found


def _constant(node: Any) -> Ball:
    if node.is_Rational:
        return flint.arb(flint.fmpq(int(node.p), int(node.q)))
    if node is sp.pi:
        return flint.arb.pi()
    if node is sp.E:
        return flint.arb(1).exp()
    raise InputError(f"{node} has no value", remedy="fix every parameter")


def _power(node: sp.Pow, base: Any, exponent: Any) -> Any:
    if node.exp.is_Integer:
        raised = base ** abs(int(node.exp))
        return raised if node.exp > 0 else _inverse(raised)
    if node.exp == sp.S.Half:
        return base.sqrt()
    return base**exponent


def _inverse(x: Any) -> Any:
    """1/x; not a number where x may vanish, which a series would refuse."""
    if isinstance(x, flint.arb_series) and certain_sign(x[0]) not in (1, -1):
        return flint.arb_series([flint.arb("nan")] * x.prec, prec=x.prec)
    return 1 / x


def _signed(node: sp.Basic, x: Any, left: int, right: int) -> Any:
    """left * x below 0 and right * x above; where the sign is open the value is enclosed and no derivative known."""
    here = x[0] if isinstance(x, flint.arb_series) else x
    sign = certain_sign(here)
    if sign in (1, -1):
        return x * (left if sign == -1 else right)
    value = (here * left).union(here * right) if here.is_finite() else here
    return flint.arb_series([value, *([flint.arb("nan")] * (x.prec - 1))], prec=x.prec) if isinstance(x, flint.arb_series) else value


def _norm(node: sp.Basic, *parts: Any) -> Any:
    return sum((p * p for p in parts), flint.arb(0)).sqrt()


def _lattice(sense: int) -> Callable[..., Any]:
    def chosen(node: sp.Basic, first: Any, *rest: Any) -> Any:
        for x in rest:
            gap = first - x
            first = x + _signed(node, gap, 0, 1) if sense > 0 else x + _signed(node, gap, 1, 0)
        return first

    return chosen


def _total(node: sp.Basic, first: Any, *rest: Any) -> Any:
    for x in rest:
        first = first + x
    return first


def _product(node: sp.Basic, first: Any, *rest: Any) -> Any:
    for x in rest:
        first = first * x
    return first


def _tanh(node: sp.Basic, x: Any) -> Any:
    grown = (2 * x).exp()
    return (grown - 1) / (grown + 1)


def _compared(sense: int) -> Callable[..., bool | None]:
    def truth(node: sp.Basic, a: Any, b: Any) -> bool | None:
        gap = a - b
        sign = certain_sign(gap[0] if isinstance(gap, flint.arb_series) else gap)
        return None if not sign else sign == sense

    return truth


_TABLE: dict[type, Callable[..., Any]] = {
    sp.Tuple: lambda node, *parts: parts,
    sp.Add: _total,
    sp.Mul: _product,
    sp.Pow: _power,
    sp.exp: lambda node, x: x.exp(),
    sp.log: lambda node, x: x.log(),
    sp.sin: lambda node, x: x.sin(),
    sp.cos: lambda node, x: x.cos(),
    sp.tan: lambda node, x: x.tan(),
    sp.tanh: _tanh,
    sp.atan: lambda node, x: x.atan(),
    sp.Abs: lambda node, x: _signed(node, x, -1, 1),
    Pos: lambda node, x: _signed(node, x, 0, 1),
    Neg: lambda node, x: _signed(node, x, -1, 0),
    sp.Max: _lattice(1),
    sp.Min: _lattice(-1),
    Norm: _norm,
    Where: lambda node, condition, a, b: flint.arb("nan") * a if condition is None else a if condition else b,
    sp.StrictGreaterThan: _compared(1),
    sp.GreaterThan: _compared(1),
    sp.StrictLessThan: _compared(-1),
    sp.LessThan: _compared(-1),
}
