"""A criterion in as many digits as asked for: its derivatives by differences, its kinks by name, and where rays leave its K.

Central differences at a step of h lose h^2; with 150 digits and h = 1e-45 some 90 digits of a gradient stay.  So one
evaluation of the formula is all that is trusted, and no rule of differentiation is shared with any method.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from typing import Any

import sympy as sp

from duhem.errors import DuhemError, InputError
from duhem.expression import Neg, Pos, Where
from duhem.expression.fold import recorded
from duhem.expression.mpmath_ import constant, table

__all__ = [
    "Choices",
    "NoReference",
    "PreciseFormula",
    "Reading",
    "Slice",
    "Vector",
    "dot",
    "extents",
    "reach",
    "root",
    "steep",
    "within_reach",
]

Choices = tuple[int, ...]

_FARTHEST = 14  # 2^(2^14): how far a ray is followed for the boundary

Vector = list[Any]


class NoReference(DuhemError):
    """No reference can be had for this question, and why; never a number instead."""


@contextmanager
def within_reach(digits: int) -> Iterator[None]:
    """What cannot be computed in ``digits`` is no reference: a division by zero, a singular matrix, a number beyond bounds."""
    try:
        yield
    except DuhemError:
        raise
    except (ArithmeticError, ValueError) as fault:
        said = f"{fault}" or ("a division by zero" if isinstance(fault, ZeroDivisionError) else type(fault).__name__)
        raise NoReference(f"{digits} digits do not suffice: {said}") from None


def dot(a: Sequence[Any], b: Sequence[Any]) -> Any:
    """The scalar product."""
    return sum(x * y for x, y in zip(a, b, strict=True))


def steep(normal: Sequence[Any], digits: int) -> Any:
    """|normal|^2, which is not zero: NoReference where the boundary has no direction in so many digits."""
    square = dot(normal, normal)
    if not square > 0:
        raise NoReference(f"the gradient of g vanishes on the boundary, in {digits} digits")
    return square


@dataclass(frozen=True)
class Reading:
    """The value of a formula; which branch each kink took; how far each is from taking another (>= 0)."""

    value: Any
    choices: Choices
    margins: tuple[Any, ...]


class _Notes:
    """The branches told or taken during one reading, and their margins, in the order of the kinks."""

    def __init__(self, told: Choices | None) -> None:
        self.told = told
        self.taken: list[int] = []
        self.margins: list[Any] = []


class PreciseFormula:
    """``expr`` over ``symbols``, computed in ``context``'s precision; walked once, read often."""

    def __init__(self, expr: sp.Expr, symbols: Sequence[sp.Symbol], context: Any) -> None:
        self.context = context
        self.step = context.mpf(10) ** -(3 * context.dps // 10)
        rows = {kind: _smooth(row) for kind, row in table(context).items()}
        rows |= dict.fromkeys(_COMPARISONS, _difference) | {kind: _kinked(row) for kind, row in _KINKS.items()}
        self._recording = recorded(expr, symbols, rows, lambda node: _constant(node, context))

    def read(self, point: Sequence[Any], choices: Choices | None = None) -> Reading:
        """The formula at ``point``; ``choices`` names the branch of each kink, which else is the one that holds."""
        notes = _Notes(choices)
        value = self._recording.value(point, notes)
        return Reading(value, tuple(notes.taken), tuple(notes.margins))


@dataclass(frozen=True)
class Slice:
    """A formula over coordinates of its own size: forces = columns . w, what follows them fixed in ``tail``.

    ``columns`` (d, m) by rows.  Derivatives are taken by w, so that their step means the same at every scale.
    """

    formula: PreciseFormula
    columns: Sequence[Sequence[Any]]
    tail: Sequence[Any]

    def forces(self, w: Sequence[Any]) -> list[Any]:
        """The forces at ``w``."""
        return [dot(row, w) for row in self.columns]

    def read(self, w: Sequence[Any], choices: Choices | None = None) -> Reading:
        """The formula at ``w``."""
        return self.formula.read([*self.forces(w), *self.tail], choices)

    def gradient(self, w: Sequence[Any], choices: Choices) -> list[Any]:
        """First derivatives on the piece that ``choices`` name."""
        return [(self._moved(w, choices, (i, 1)) - self._moved(w, choices, (i, -1))) / (2 * self.formula.step) for i in range(len(w))]

    def hessian(self, w: Sequence[Any], choices: Choices) -> list[list[Any]]:
        """Second derivatives likewise."""
        m = len(w)
        rows = [[self.formula.context.mpf(0)] * m for _ in range(m)]
        signs = ((1, 1, 1), (1, -1, -1), (-1, 1, -1), (-1, -1, 1))
        for i in range(m):
            for j in range(i + 1):
                total = sum(s * self._moved(w, choices, (i, a), (j, b)) for a, b, s in signs)
                rows[i][j] = rows[j][i] = total / (4 * self.formula.step**2)
        return rows

    def _moved(self, w: Sequence[Any], choices: Choices, *moves: tuple[int, int]) -> Any:
        there = list(w)
        for i, way in moves:
            there[i] = there[i] + way * self.formula.step
        return self.read(there, choices).value


def _constant(node: Any, context: Any) -> Callable[..., Any]:
    try:
        value = constant(context, node)
    except InputError:
        raise NoReference(f"{node} has no value", remedy="give every parameter a value") from None
    return lambda _: value


def _smooth(row: Callable[..., Any]) -> Callable[[Any], Callable[..., Any]]:
    return lambda node: lambda _, *arguments: row(node, *arguments)


def _kinked(row: Callable[..., Any]) -> Callable[[Any], Callable[..., Any]]:
    def follow(notes: _Notes, *arguments: Any) -> Any:
        value, choice, margin = row(None if notes.told is None else notes.told[len(notes.taken)], *arguments)
        notes.taken.append(choice)
        notes.margins.append(margin)
        return value

    return lambda _: follow


def _difference(node: Any) -> Callable[..., Any]:
    """What is positive where a comparison holds; on the border it takes the side of the comparison."""
    return (lambda _, a, b: a - b) if isinstance(node, (sp.StrictGreaterThan, sp.GreaterThan)) else (lambda _, a, b: b - a)


def _bent(above: int, below: int, told: int | None, x: Any) -> tuple[Any, int, Any]:
    """A function with these slopes on either side of zero."""
    choice = int(x >= 0) if told is None else told
    return (above if choice else below) * x, choice, abs(x)


def _most(told: int | None, *x: Any) -> tuple[Any, int, Any]:
    order = sorted(range(len(x)), key=lambda i: -x[i])
    choice = order[0] if told is None else told
    return x[choice], choice, x[order[0]] - x[order[1]]


def _least(told: int | None, *x: Any) -> tuple[Any, int, Any]:
    value, choice, margin = _most(told, *(-v for v in x))
    return -value, choice, margin


def _where(told: int | None, difference: Any, a: Any, b: Any) -> tuple[Any, int, Any]:
    choice = (1 if difference > 0 else 0) if told is None else told
    return (a if choice else b), choice, abs(difference)


_COMPARISONS = (sp.StrictGreaterThan, sp.GreaterThan, sp.StrictLessThan, sp.LessThan)
_KINKS: dict[type, Callable[..., Any]] = {
    Pos: partial(_bent, 1, 0),
    Neg: partial(_bent, 0, -1),
    sp.Abs: partial(_bent, 1, -1),
    sp.Max: _most,
    sp.Min: _least,
    Where: _where,
}


def extents(plain: Slice, y: Vector) -> Vector | None:
    """How far K reaches along each coordinate; None where it is the origin alone."""
    m, mp = len(y), plain.formula.context
    if plain.read([0 * c for c in y]).value > 100 * mp.eps * abs(plain.read(y).value):
        raise NoReference("the origin is not inside K")
    hint = max(abs(c) for c in y)
    axes = [[s * (1 if i == j else 0) for j in range(m)] for i in range(m) for s in (1, -1)]
    ends = [reach(plain, [mp.mpf(c) for c in axis], hint, digits=3) for axis in axes]
    toward = reach(plain, y, mp.mpf(1), digits=3)
    if toward is None:
        if any(r is not None for r in ends):
            raise NoReference("the origin is not inside K")
        return None
    sizes = []
    for i in range(m):
        both = [r for r in ends[2 * i : 2 * i + 2] if r is not None]
        sizes.append(max(both) if both else toward * hint)
    return sizes


def reach(slice_: Slice, direction: Vector, hint: Any, digits: int) -> Any:
    """The t > 0 at which g(t direction) = 0, to ``digits``; None where no point of the ray lies in K."""
    mp = slice_.formula.context

    def at(t: Any) -> Any:
        value = slice_.read([t * c for c in direction]).value
        return mp.inf if mp.isnan(value) else value

    low = high = hint
    f_low = f_high = at(hint)
    for power in range(_FARTHEST):
        factor = mp.mpf(2) ** (2**power)
        if f_low > 0:
            high, f_high = low, f_low
            low = low / factor
            f_low = at(low)
        elif f_high <= 0:
            low, f_low = high, f_high
            high = high * factor
            f_high = at(high)
        else:
            break
    if f_low > 0:
        return None
    if f_high <= 0:
        raise NoReference("K does not end along a ray")
    while high > 4 * low:  # brackets found by growing factors are wide
        middle = mp.sqrt(low * high)
        f = at(middle)
        low, f_low, high, f_high = (middle, f, high, f_high) if f <= 0 else (low, f_low, middle, f)
    return root(at, low, f_low, high, f_high, mp.mpf(10) ** -digits)


def root(at: Any, low: Any, f_low: Any, high: Any, f_high: Any, tolerance: Any) -> Any:
    """Regula falsi with the Illinois weights, a halving wherever it dawdles."""
    side = 0
    for turn in range(400):
        if f_low == 0 or high - low <= tolerance * high:
            return low
        infinite = f_high - f_low == f_high.context.inf if hasattr(f_high, "context") else False
        t = (low + high) / 2 if turn % 3 == 2 or infinite else (low * f_high - high * f_low) / (f_high - f_low)
        if not low < t < high:
            t = (low + high) / 2
        f = at(t)
        if f == 0:
            return t
        if f < 0:
            low, f_low = t, f
            f_high = f_high / 2 if side < 0 else f_high
            side = -1
        else:
            high, f_high = t, f
            f_low = f_low / 2 if side > 0 else f_low
            side = 1
    return low
