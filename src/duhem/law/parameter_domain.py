"""Whether the domain of a law holds any parameter values at all: a claim over an empty domain would hold of anything."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import sympy as sp

from duhem.errors import InputError
from duhem.expression import Neg, Pos, fold
from duhem.law.curve_law import Law
from duhem.law.formula_law import Domain

__all__ = ["check_domain", "simple_points"]

_MILLISECONDS = 1000


def check_domain(law: Law, *, where: str = "") -> None:
    """Raise InputError if no parameter values satisfy the domains and the constraints of ``law`` together.

    A common solution is first looked for among simple values; then z3 is asked for a contradiction in real
    arithmetic.  Constraints outside that arithmetic, and questions z3 gives up, count as satisfiable.
    """
    if not law.constraints or any(_holds(law, point) for point in simple_points(law)):
        return
    free = [s for s in _parameters(law) if law.parameters[s.name].value is None]
    if not free or _contradictory(law):
        listed = ", ".join([*(str(c) for c in law.constraints), *_bounds(law)])
        raise InputError(f"no parameter values satisfy {listed} together", where=where or law.name, remedy="relax one of them")


def _parameters(law: Law) -> tuple[sp.Symbol, ...]:
    table = law.symbols()
    return tuple(table[name] for name in law.parameters)


def _bounds(law: Law) -> Iterator[str]:
    """The domains of the parameters that the constraints mention, in words."""
    used = set[sp.Symbol]().union(*(c.free_symbols for c in law.constraints))
    for s in _parameters(law):
        domain = law.parameters[s.name]
        if s in used and domain != Domain():
            words = domain.describe()
            yield f"{s} {words}" if words.startswith("=") else f"{s} positive" if words == "positive" else f"{s} in {words}"


def simple_points(law: Law) -> Iterator[dict[sp.Symbol, sp.Rational]]:
    """A few places inside the domains: values rising in the order of declaration, falling, and all in the middle."""
    symbols = _parameters(law)
    rising = [sp.Rational(i + 1, len(symbols) + 1) for i in range(len(symbols))]
    for shares in (rising, rising[::-1], [sp.Rational(1, 2)] * len(symbols)):
        yield {s: _inside(law.parameters[s.name], share) for s, share in zip(symbols, shares, strict=True)}


def _inside(domain: Domain, share: sp.Rational) -> sp.Rational:
    low, high = domain.low, domain.high
    if low is None:
        return share if high is None else high - share
    return low + share * (1 if high is None else high - low)


def _holds(law: Law, point: dict[sp.Symbol, sp.Rational]) -> bool:
    return all(c.subs(point) == sp.true for c in law.constraints)


def _contradictory(law: Law) -> bool:
    import z3

    context = z3.Context()
    symbols = _parameters(law)
    names = {s: z3.Real(f"x{i}", ctx=context) for i, s in enumerate(symbols)}

    def leaf(x: Any) -> Any:
        if x in (sp.true, sp.false):
            return z3.BoolVal(bool(x), ctx=context)
        if x.is_Rational:
            return z3.RealVal(f"{x.p}/{x.q}", ctx=context)
        if x not in names:
            raise InputError(f"{x} is outside real arithmetic")
        return names[x]

    table = _arithmetic(z3)
    solver = z3.Solver(ctx=context)
    solver.set("timeout", _MILLISECONDS)
    for s in symbols:
        for relation in law.parameters[s.name].relations(s):
            solver.add(fold(relation, table, leaf))
    for constraint in law.constraints:
        try:
            solver.add(fold(constraint, table, leaf))
        except InputError:  # leaving a constraint out never makes the rest contradictory
            continue
    try:
        result = solver.check()
    except z3.Z3Exception:
        return False
    if result == z3.unknown and solver.reason_unknown() == "interrupted from keyboard":  # z3 catches Ctrl-C itself
        raise KeyboardInterrupt
    return bool(result == z3.unsat)


def _arithmetic(z3: Any) -> dict[type, Callable[..., Any]]:
    def least(_: Any, first: Any, *rest: Any) -> Any:
        for x in rest:
            first = z3.If(x < first, x, first)
        return first

    def greatest(_: Any, first: Any, *rest: Any) -> Any:
        for x in rest:
            first = z3.If(x > first, x, first)
        return first

    def power(node: sp.Pow, base: Any, _: Any) -> Any:
        if not (node.exp.is_Integer and 0 < abs(node.exp) <= 16):
            raise InputError(f"{node} is outside real arithmetic")
        raised = z3.Product([base] * int(abs(node.exp)))
        return raised if node.exp > 0 else 1 / raised

    return {
        sp.Add: lambda _, *a: z3.Sum(a),
        sp.Mul: lambda _, *a: z3.Product(a),
        sp.Pow: power,
        sp.Abs: lambda _, a: z3.If(a >= 0, a, -a),
        sp.Min: least,
        sp.Max: greatest,
        Pos: lambda _, a: z3.If(a >= 0, a, 0 * a),
        Neg: lambda _, a: z3.If(a <= 0, -a, 0 * a),
        sp.StrictLessThan: lambda _, a, b: a < b,
        sp.LessThan: lambda _, a, b: a <= b,
        sp.StrictGreaterThan: lambda _, a, b: a > b,
        sp.GreaterThan: lambda _, a, b: a >= b,
    }
