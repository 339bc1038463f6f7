"""In which power of the unit of stress the parameters of a law are, as its formula says: sums, sizes and comparisons are of like terms."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from fractions import Fraction

import sympy as sp

from duhem.expression import Where
from duhem.expression.inert_number import InertNumber
from duhem.expression.vocabulary import EigMax, Neg, Norm, Pos
from duhem.law.curve_law import Law
from duhem.law.formula_law import Criterion

__all__ = ["UNIT", "stress_powers", "unit_in_words", "units_in_words"]

_ALIKE = (sp.Add, sp.Max, sp.Min, sp.Abs, Norm, Pos, Neg, EigMax)  # whose arguments and value have one unit
UNIT = "unit of stress"  # no law states one: all its stresses share it


def stress_powers(law: Law) -> Mapping[str, Fraction | None]:
    """By parameter 0 for a pure number, 1 for a stress, and so on; None where the formula leaves it open, or is of unlike terms."""
    table = law.symbols()
    power = {table[name]: sp.Dummy() for name in law.parameters}
    known = power | {table[name]: sp.S.One for name in (*law.forces, *([law.pressure] if law.pressure else []))}
    unlike: list[sp.Expr] = []

    def of(node: sp.Basic) -> sp.Expr:
        """The power of what stands there; what must vanish so that it has one is noted."""
        if node in known:
            return known[node]
        if isinstance(node, InertNumber) or node.is_Number:
            return sp.S.Zero
        if isinstance(node, sp.Mul):
            return sp.Add(*map(of, node.args))
        if isinstance(node, sp.Pow):
            unlike.append(of(node.exp))
            return (node.exp.value if isinstance(node.exp, InertNumber) else node.exp) * of(node.base)
        if isinstance(node, Where):
            for comparison in node.args[0].atoms(sp.core.relational.Relational):
                alike(comparison.args)
            return alike(node.args[1:])
        if isinstance(node, _ALIKE):
            return alike(node.args)
        unlike.extend(map(of, node.args))  # functions such as exp are of pure numbers
        return sp.S.Zero

    def alike(parts: Iterable[sp.Basic]) -> sp.Expr:
        """The one power of all of them; 0 has any."""
        each = [of(part) for part in parts if part != 0] or [sp.S.Zero]
        unlike.extend(other - each[0] for other in each[1:])
        return each[0]

    for formula in _formulas(law):
        found = of(formula)
        if not isinstance(law, Criterion):
            unlike.append(found)  # a boundary curve is in units of the pressure
    solved = next(iter(sp.linsolve(unlike, *power.values())), None) if unlike and power else tuple(power.values())
    values = [None] * len(power) if solved is None else [Fraction(int(x.p), int(x.q)) if x.is_Rational else None for x in solved]
    return dict(zip(law.parameters, values, strict=True))


def _formulas(law: Law) -> Iterator[sp.Expr]:
    """What is zero on the boundary, each by itself: K of several surfaces compares no values of theirs."""
    parts = [surface.g for surface in law.surfaces] or [law.g] if isinstance(law, Criterion) else law.components()[:2]
    for part in parts:
        yield from part.args if isinstance(part, sp.Max) else (part,)


def unit_in_words(power: Fraction | None) -> str | None:
    """The unit of a power, empty for a pure number; None where it is not known."""
    if power is None or power in (0, 1):
        return None if power is None else UNIT * int(power)
    return f"({UNIT})^({power})"


def units_in_words(law: Law) -> str:
    """The unit of each parameter of which it is known, alike ones together."""
    units = {name: unit_in_words(power) for name, power in stress_powers(law).items()}
    known = dict.fromkeys(unit for unit in units.values() if unit is not None)
    return "; ".join(f"{', '.join(name for name in units if units[name] == unit)}: {unit or 'pure numbers'}" for unit in known)
