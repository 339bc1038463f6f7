"""Whether a law has values for its parameters, or its domain holds any: a claim over an empty domain would hold of anything."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Literal

import sympy as sp

from duhem.errors import InputError
from duhem.expression import Where, holds_at
from duhem.expression.smt import Reals
from duhem.law.curve_law import Law
from duhem.law.domain import Domain

__all__ = ["check_domain", "check_fixed", "simple_points", "solution"]

_STEPS = 2_000_000  # z3's own, about a second: never a clock, so that a busy machine says what an idle one says
_MOST_EXPONENT = 16


def check_domain(law: Law, *, where: str = "") -> None:
    """Raise InputError if no parameter values satisfy the domains and the constraints of ``law`` together.

    A common solution is first looked for among simple values; then z3 is asked for a contradiction in real
    arithmetic.  Constraints outside that arithmetic, and questions z3 gives up, count as satisfiable.
    """
    if not law.constraints or any(all(holds_at(c, point) for c in law.constraints) for point in simple_points(law)):
        return
    symbols = _parameters(law)
    ranges = (relation for s in symbols for relation in law.parameters[s.name].relations(s))
    if not law.free() or solution(symbols, [*ranges, *law.constraints]) is False:
        listed = ", ".join([*(str(c) for c in law.constraints), *_bounds(law)])
        raise InputError(f"no parameter values satisfy {listed} together", where=where or law.name, remedy="relax one of them")


def check_fixed(law: Law, remedy: str = "") -> None:
    """InputError where a parameter has no value; the ``remedy`` left out is that of the command line."""
    if missing := law.free():
        remedy = remedy or f"give {' '.join(f'--set {x}=VALUE' for x in missing)}"
        raise InputError(f"no value is given for {', '.join(map(str, missing))}", where=law.name, remedy=remedy)


def _parameters(law: Law) -> tuple[sp.Symbol, ...]:
    return tuple(domain.symbol(name) for name, domain in law.parameters.items())


def _bounds(law: Law) -> Iterator[str]:
    """The domains of the parameters that the constraints mention, in words."""
    used = set[sp.Symbol]().union(*(c.free_symbols for c in law.constraints))
    return (law.parameters[s.name].stated(s.name) for s in _parameters(law) if s in used and law.parameters[s.name] != Domain())


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


def solution(symbols: Sequence[sp.Symbol], relations: Iterable[sp.Basic]) -> Mapping[sp.Symbol, sp.Rational] | Literal[False] | None:
    """Values at which all relations hold; False where there are none, None where that stays open."""
    import z3

    reals = Reals(symbols)
    solver = z3.Solver(ctx=reals.context)
    solver.set("rlimit", _STEPS)
    whole = True
    for relation in relations:
        try:
            if any(abs(power.exp) > _MOST_EXPONENT for power in relation.atoms(sp.Pow) if power.exp.is_Integer):
                raise InputError("an exponent is too large")
            solver.add(reals.term(relation))
            divisors = () if relation.has(Where) else (power.base for power in relation.atoms(sp.Pow) if power.exp.is_negative)
            for divisor in divisors:  # z3 gives x/0 some value; here a relation without a value does not hold
                solver.add(reals.term(divisor) != 0)
        except InputError:
            whole = False  # leaving a relation out never makes the rest contradictory
    try:
        result = solver.check()
    except z3.Z3Exception:
        return None
    if result == z3.unknown and solver.reason_unknown() == "interrupted from keyboard":  # z3 catches Ctrl-C itself
        raise KeyboardInterrupt
    return False if result == z3.unsat else reals.point(solver.model()) if result == z3.sat and whole else None
