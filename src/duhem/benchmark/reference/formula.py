"""A criterion in as many digits as asked for, with its derivatives by differences and its kinks by name.

Central differences at a step of h lose h^2; with 150 digits and h = 1e-45 some 90 digits of a gradient stay.  So one
evaluation of the formula is all that is trusted, and no rule of differentiation is shared with any method.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import sympy as sp

from duhem.errors import DuhemError, InputError
from duhem.expression import Neg, Pos, Where
from duhem.expression.mpmath_ import constant, table
from duhem.expression.recording import recorded

__all__ = ["Choices", "NoReference", "PreciseFormula", "Reading", "Slice", "steep", "within_reach"]

Choices = tuple[int, ...]


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


def steep(normal: Sequence[Any], digits: int) -> Any:
    """|normal|^2, which is not zero: NoReference where the boundary has no direction in so many digits."""
    square = sum(c * c for c in normal)
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
        return [sum(c * x for c, x in zip(row, w, strict=True)) for row in self.columns]

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


def _pos(told: int | None, x: Any) -> tuple[Any, int, Any]:
    choice = (1 if x >= 0 else 0) if told is None else told
    return (x if choice else 0 * x), choice, abs(x)


def _neg(told: int | None, x: Any) -> tuple[Any, int, Any]:
    choice = (1 if x < 0 else 0) if told is None else told
    return (-x if choice else 0 * x), choice, abs(x)


def _abs(told: int | None, x: Any) -> tuple[Any, int, Any]:
    choice = (1 if x >= 0 else -1) if told is None else told
    return choice * x, choice, abs(x)


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
_KINKS: dict[type, Callable[..., Any]] = {Pos: _pos, Neg: _neg, sp.Abs: _abs, sp.Max: _most, sp.Min: _least, Where: _where}
