"""One walk over the tree for every back end: a table maps node classes to functions, nothing else differs.

The walk may be recorded into a straight list of steps over registers, each shared sub-expression one step.  What the registers hold
(arrays, jets, balls, numbers of many digits) is the affair of the interpreter, which gives a table of its rows and says what a constant is.

A formula that is too long to be written out is kept as a graph: names, each with a formula of those before it, and the formula of the
whole.  SymPy is shown one node, :class:`Shared`, over the names of the law; the walk goes inside, through each shared part once.  What
needs the formula in symbols refuses it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache, partial
from operator import itemgetter
from typing import Any, TypeVar

import sympy as sp

from duhem.errors import InputError
from duhem.expression.number import InertNumber

__all__ = ["Graph", "Recording", "Shared", "Table", "bound", "fold", "graph_of", "once_a_precision", "recorded", "same"]

T = TypeVar("T")
Table = Mapping[type, Callable[..., T]]


def fold(expr: sp.Basic, table: Table[T], leaf: Callable[[Any], T]) -> T:
    """Value of ``expr`` under ``table``: ``table[type(node)](node, *values of its arguments)``.

    ``leaf`` gives the value of symbols, numbers and constants.  Equal subtrees are evaluated once, and the walk is
    iterative, so depth is no limit.  A node class the table lacks raises InputError naming the sub-expression.  Of a formula kept as a
    graph the walk goes inside, with the values of its names.
    """
    done: dict[sp.Basic, T] = {}
    stack: list[tuple[sp.Basic, bool]] = [(expr, False)]
    while stack:
        node, ready = stack.pop()
        if node in done:
            continue
        if not node.args:
            done[node] = leaf(node.value if isinstance(node, InertNumber) else node)
        elif isinstance(node, Shared):
            values = {x: fold(part, table, leaf) for x, part in zip(node.graph.names, node.parts, strict=True)}
            done[node] = fold(node.graph.formula, table, partial(_named, values, leaf))
        elif isinstance(node, sp.cot):  # which SymPy makes of tan(x + pi/2), and is no word of the language
            done[node] = fold(1 / sp.tan(node.args[0]), table, leaf)
        elif ready:
            if (row := table.get(type(node))) is None:
                raise InputError(f"no meaning is given to {type(node).__name__} in {node}", remedy="rewrite that part of the formula")
            done[node] = row(node, *(done[a] for a in node.args))
        else:
            stack.append((node, True))
            stack.extend((a, False) for a in reversed(node.args))
    return done[expr]


def _named(values: Mapping[Any, T], leaf: Callable[[Any], T], node: Any) -> T:
    """What stands for a name of a graph, or the value of another leaf."""
    return values[node] if node in values else leaf(node)


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


def same(value: Any, *_: Any) -> Any:
    """The step of a number that does not depend on what holds when it runs."""
    return value


def once_a_precision(precision: Callable[[], int], worked_out: Callable[[], Any]) -> Step:
    """The step of a number that is worked out anew at each precision, and once at that."""
    known = lru_cache(maxsize=None)(lambda _: worked_out())
    return lambda: known(precision())


def bound(table: Table[Any]) -> Table[Step]:
    """The steps of rows that take the node and the values of its arguments."""
    return {kind: partial(partial, row) for kind, row in table.items()}


# -- formulas kept as graphs --------------------------------------------------------------------------------------------


class Graph(sp.Atom):
    """``nodes`` are names with formulas, in order; ``last`` is the formula of the whole, over the law's ``names``.

    ``read`` makes of it an expression.  SymPy carries it about as something without parts.
    """

    nodes: tuple[tuple[str, str], ...]
    last: str
    names: tuple[sp.Symbol, ...]
    read: Callable[[Graph], sp.Expr]

    def __new__(cls, *given: Any) -> Graph:
        made: Graph = super().__new__(cls)
        made.nodes, made.last, made.names, made.read = given
        return made

    def __getnewargs__(self) -> tuple[Any, ...]:
        return self.nodes, self.last, self.names, self.read

    def _hashable_content(self) -> tuple[Any, ...]:
        return self.nodes, self.last

    @cached_property
    def formula(self) -> sp.Expr:
        """The expression as it is written, whose shared parts are the same objects; made when it is first asked for."""
        return self.read(self)

    def _sympystr(self, _: Any) -> str:
        return f"{self.last} with {len(self.nodes)} definitions"


class Shared(sp.Expr):
    """The formula of a graph over symbols, which may be replaced by other expressions; real, and a variable of its own to SymPy."""

    is_commutative = is_extended_real = True

    @property
    def graph(self) -> Graph:
        """What it is the formula of."""
        graph: Graph = self.args[0]
        return graph

    @property
    def parts(self) -> tuple[sp.Basic, ...]:
        """What stands for the names, in the order in which the graph's formula has them."""
        return self.args[1:]

    def _eval_derivative(self, _: sp.Symbol) -> sp.Expr:
        raise InputError("a formula kept as a graph has no derivative in symbols", remedy="write a shorter formula")

    def _sympystr(self, _: Any) -> str:
        return str(self.graph)

    def _latex(self, printer: Any, exp: str | None = None) -> str:
        body = rf"\operatorname{{graph}}_{{{len(self.graph.nodes)}}}\left({', '.join(printer.doprint(x) for x in self.parts)}\right)"
        return rf"{body}^{{{exp}}}" if exp else body


def graph_of(expr: Any) -> Graph | None:
    """The graph that an expression is kept as; None where it is an expression like others."""
    return expr.graph if isinstance(expr, Shared) else None
