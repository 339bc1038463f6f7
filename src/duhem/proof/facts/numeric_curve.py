r"""A closed curve with numbers for all its parameters, in balls: a proof by subdivision of the angle.

Power series over balls carry T, T', T'', ... over a whole arc at once, so each sign is shown arc by arc with directed
rounding.  Angles are in units of pi, from -1 to 1.  Where a kink (abs, pos, ...) may lie in the arc, the arc stays open.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise
from typing import Any

import flint
import sympy as sp

from duhem.expression.ball_series import compiled, derivatives
from duhem.expression.balls import ball, certain_sign
from duhem.proof.decide import Budget

__all__ = [
    "LEAD",
    "LEAN",
    "POWER",
    "STAR",
    "TURNING",
    "Ball",
    "CurveJet",
    "Greatest",
    "NumericCurve",
    "Quantity",
    "Span",
    "Vector",
    "cross",
    "dot",
]

Ball = Any
Vector = tuple[Any, Any]
Span = tuple[Fraction, Fraction]
_TURN: Span = (Fraction(-1), Fraction(1))
_NODE = 8  # steps of each node of the formulas over an arc
_MOST, _NARROWEST = 8192, Fraction(1, 2**40)  # how many arcs are looked at, and how narrow ones, before a question is left open


def dot(a: Sequence[Ball], b: Sequence[Ball]) -> Ball:
    """a . b."""
    return a[0] * b[0] + a[1] * b[1]


def cross(a: Sequence[Ball], b: Sequence[Ball]) -> Ball:
    """a x b = a_1 b_2 - a_2 b_1."""
    return a[0] * b[1] - a[1] * b[0]


@dataclass(frozen=True)
class CurveJet:
    """Boundary and flow at an angle with their derivatives by it: ``boundary[k]``, ``flow[k]``; of numbers, balls or formulas."""

    boundary: tuple[Vector, ...]
    flow: tuple[Vector, ...]


@dataclass(frozen=True)
class Quantity:
    """A sign that decides a claim, as a function of a jet of this order.

    With T the boundary, d the flow and ' the derivative by the angle (the curve runs counter-clockwise):
    power T . d, star T x T' (> 0: the curve runs around 0 in polar order), turning T' x T'' (> 0: it turns left throughout),
    lead d x T' (> 0: the flow is less than a right angle from the outward normal), lean d . T' (0: the flow is normal).
    """

    name: str
    order: int
    of: Callable[[CurveJet], Any]


POWER = Quantity("T . d", 0, lambda j: dot(j.boundary[0], j.flow[0]))
STAR = Quantity("T x T'", 1, lambda j: cross(j.boundary[0], j.boundary[1]))
TURNING = Quantity("T' x T''", 2, lambda j: cross(j.boundary[1], j.boundary[2]))
LEAD = Quantity("d x T'", 1, lambda j: cross(j.flow[0], j.boundary[1]))
LEAN = Quantity("d . T'", 1, lambda j: dot(j.flow[0], j.boundary[1]))


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
        self, boundary: Sequence[sp.Expr], flow: Sequence[sp.Expr] | None, cosine: sp.Symbol, sine: sp.Symbol, budget: Budget
    ) -> None:
        self._run = compiled([*boundary, *(flow or ())], (cosine, sine))
        self._budget = budget
        self._price = _NODE * sum(1 for x in (*boundary, *(flow or ())) for _ in sp.preorder_traversal(x))

    def over(self, span: Span, order: int) -> CurveJet:
        """Boundary and flow with derivatives up to ``order``, over the arc."""
        return self._along(flint.arb.pi() * ball(*span), order)

    def at(self, t: Fraction, order: int = 0) -> CurveJet:
        """The same at the one angle 2 atan t."""
        return self._along(2 * ball(t).atan(), order)

    def point(self, t: Fraction) -> Vector:
        """The boundary point at the angle 2 atan t."""
        return self.at(t).boundary[0]

    def _along(self, turn: Ball, order: int) -> CurveJet:
        angle = flint.arb_series([turn, 1], prec=order + 2)
        rows = [derivatives(component, order + 1) for component in self._run(angle.cos(), angle.sin())]
        boundary = tuple(zip(rows[0], rows[1], strict=True))
        flow = zip(rows[2], rows[3], strict=True) if len(rows) == 4 else normals(boundary)
        return CurveJet(boundary[: order + 1], tuple(flow)[: order + 1])

    def positive(self, quantity: Callable[[CurveJet], Ball], order: int) -> bool:
        """Whether ``quantity`` is > 0 at every angle; False also when that stays open."""
        if any(quantity(self.over((x, x), order)) <= 0 for x, _ in _pieces(32)):
            return False

        def settled(span: Span) -> bool | None:
            value = quantity(self.over(span, order))
            return None if value <= 0 else bool(value.is_finite() and value > 0)

        return self._covered(8, settled)

    def _covered(self, n: int, settled: Callable[[Span], bool | None], narrowest_first: bool = False) -> bool:
        """Whether each of n arcs is settled, halved where it is open; an arc that says None ends it.

        Where a sign changes, halving never ends, so the widest arcs are looked at first.  Whom one arc that is never settled stops, as
        a pole does, sees it sooner with the ``narrowest_first``.
        """
        queue, looked = deque(_pieces(n)), 0
        while queue:
            span = queue.pop() if narrowest_first else queue.popleft()
            looked += 1
            if known := settled(span):
                continue
            if known is None or looked > _MOST or span[1] - span[0] < _NARROWEST or not self._budget.pays(self._price):
                return False
            queue.extend(_halves(span))
        return True

    def winding(self, vector: Callable[[CurveJet], Vector], order: int) -> int | None:
        """How often a vector that never vanishes turns around 0 while the angle runs once; None if that stays open.

        On an arc where the vector stays in the open half-plane of its value at the start, it turns by the angle between
        its values at the ends.
        """
        turned = [flint.arb(0)]

        def settled(span: Span) -> bool:
            start, end = (vector(self.over((x, x), order)) for x in span)
            lead = dot(start, vector(self.over(span, order)))
            within = bool(lead.is_finite() and lead > 0)
            turned.append(flint.arb.atan2(cross(start, end), dot(start, end)) if within else flint.arb(0))
            return within

        turns = (sum(turned) / (2 * flint.arb.pi())).unique_fmpz() if self._covered(16, settled, narrowest_first=True) else None
        return None if turns is None else int(turns)

    def greatest(self, quantity: Callable[[CurveJet], Sequence[Ball]], order: int, width: float) -> Greatest | None:
        """The greatest size of a quantity over all angles, to within ``width`` or as well as time allows; None if it stays open.

        ``quantity`` gives value, slope and second derivative; what is not finite says nothing.  Arcs that cannot hold the
        greatest size are dropped: their enclosure lies below one met, or their slope has one sign.
        """
        best, queue = flint.arb("-inf"), _pieces(32)
        found: Greatest | None = None
        while queue:
            kept: list[tuple[Span, Ball]] = []
            for span in queue:
                if not self._budget.pays(self._price):
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


def _pieces(n: int) -> list[Span]:
    low, high = _TURN
    ends = [low + (high - low) * k / n for k in range(n + 1)]
    return list(pairwise(ends))


def _halves(span: Span) -> list[Span]:
    middle = (span[0] + span[1]) / 2
    return [(span[0], middle), (middle, span[1])]
