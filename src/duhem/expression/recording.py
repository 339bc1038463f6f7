"""A formula walked once into a straight list of steps over registers; each shared sub-expression is one step.

What the registers hold (arrays, jets, balls, numbers of many digits) is the affair of the interpreter, which gives a
table of its rows and says what a constant is.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import partial
from operator import itemgetter
from typing import Any

import sympy as sp

from duhem.expression.fold import Table, fold

__all__ = ["Recording", "bound", "recorded"]

Step = Callable[..., Any]


@dataclass(frozen=True)
class Recording:
    """Functions with what takes their arguments from the registers; the first are the symbols', each step fills the next.

    ``spent``: after each step the registers that no later one takes.
    """

    steps: tuple[tuple[Step, Callable[[list[Any]], Sequence[Any]]], ...]
    last: int
    spent: tuple[tuple[int, ...], ...]

    def run(self, values: Iterable[Any], *notes: Any) -> list[Any]:
        """All registers, from one value for each symbol; the formula's is number ``last``.  Every step is told the ``notes`` first."""
        registers = list(values)
        for step, taken in self.steps:
            registers.append(step(*notes, *taken(registers)))
        return registers

    def value(self, values: Iterable[Any], *notes: Any) -> Any:
        """The formula's register alone; memory of those that are spent goes to the next, so that it stays in the cache."""
        registers = list(values)
        for (step, taken), spent in zip(self.steps, self.spent, strict=True):
            registers.append(step(*notes, *taken(registers)))
            for place in spent:
                registers[place] = None
        return registers[self.last]


def recorded(expr: sp.Basic, symbols: Iterable[sp.Symbol], table: Table[Step], constant: Callable[[Any], Step]) -> Recording:
    """``expr`` over ``symbols``, in their order.

    ``table`` gives the step of a node from the node, called in the order of the walk; ``constant`` that of a number, so
    that it may depend on what holds when it runs, such as a working precision.  Raises what :func:`fold` raises.
    """
    order = tuple(symbols)
    steps: list[tuple[Step, Callable[[list[Any]], Sequence[Any]]]] = []
    used = dict[int, int]()

    def register(step: Step, arguments: tuple[int, ...]) -> int:
        used.update(dict.fromkeys(arguments, len(steps)))
        steps.append((step, _taking(arguments)))
        return len(order) + len(steps) - 1

    def recorder(step_of: Callable[..., Step]) -> Callable[..., int]:
        return lambda node, *arguments: register(step_of(node), arguments)

    def leaf(node: Any) -> int:
        return order.index(node) if node in order else register(constant(node), ())

    last = fold(expr, {kind: recorder(step_of) for kind, step_of in table.items()}, leaf)
    spent: list[list[int]] = [[] for _ in steps]
    for place in used.keys() - {last}:
        spent[used[place]].append(place)
    return Recording(tuple(steps), last, tuple(map(tuple, spent)))


def _taking(places: tuple[int, ...]) -> Callable[[list[Any]], Sequence[Any]]:
    """The registers at these places, in a sequence: no line of Python runs for it, as many formulas are run a million times."""
    return itemgetter(*places) if len(places) > 1 else itemgetter(slice(places[0], places[0] + 1) if places else slice(0))


def bound(table: Table[Any]) -> Table[Step]:
    """The steps of rows that take the node and the values of its arguments."""
    return {kind: partial(partial, row) for kind, row in table.items()}
