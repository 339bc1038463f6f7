"""In which power of the unit of stress the parameters of a law are, as its formula says: sums, sizes and comparisons are of like terms."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from fractions import Fraction
from typing import Any

import sympy as sp

from duhem.expression.dimensions import Conditions, Weight, combined
from duhem.expression.inert_number import InertNumber
from duhem.law.curve_law import Law
from duhem.law.formula_law import Criterion

__all__ = ["UNIT", "stress_powers", "unit_in_words", "units_in_words"]

UNIT = "unit of stress"  # no law states one: all its stresses share it


def stress_powers(law: Law) -> Mapping[str, Fraction | None]:
    """By parameter 0 for a pure number, 1 for a stress, and so on; None where the formula leaves it open, or is of unlike terms."""
    table = law.symbols()
    power = {table[name]: sp.Dummy() for name in law.parameters}
    known = power | {table[name]: sp.S.One for name in law.coordinates}
    conditions = _Conditions()
    for formula in _formulas(law):
        found = conditions.weigh(formula)
        if not isinstance(law, Criterion):
            conditions.pure(formula, found)  # a boundary curve is in units of the pressure
    rows = [sp.Add(*(factor * known.get(x, 0) for x, factor in row.items())) for row in conditions.rows]
    solved = next(iter(sp.linsolve(rows, *power.values())), None) if rows and power else tuple(power.values())
    values = [None] * len(power) if solved is None else [Fraction(int(x.p), int(x.q)) if x.is_Rational else None for x in solved]
    return dict(zip(law.parameters, values, strict=True))


class _Conditions(Conditions):
    """Those of units, where an exponent may be a parameter too: (|a|^m + |b|^m)^(1/m) has the unit of a."""

    def power(self, node: Any, base: Weight | None, exponent: Weight | None) -> Weight | None:
        self.pure(node, exponent)
        return None if base is None else combined([(node.exp.value if isinstance(node.exp, InertNumber) else node.exp, base)])


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
