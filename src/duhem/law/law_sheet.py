"""What a law states: as titled fields in words, as a sheet with its boundary in LaTeX, and in plain values.

In which power of the unit of stress its parameters are, the formula says: sums, sizes and comparisons are of like terms.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from decimal import Context
from fractions import Fraction
from typing import Any

import sympy as sp

from duhem.expression.dimensions import Conditions, Weight, combined
from duhem.expression.number import InertNumber
from duhem.expression.text import formula
from duhem.law.curve_law import Law, ParametricCriterion
from duhem.law.domain import Domain
from duhem.law.formula_law import Criterion, DeclaredLaw, YieldSurface
from duhem.show.page import tied
from duhem.show.printing import Sheet, Typeset, latex, latex_name, plain, sheet

__all__ = [
    "UNIT", "as_dict", "as_latex", "as_sheet", "number_in_short", "number_in_words", "stated", "stress_powers", "unit_in_words",
    "units_in_words",
]  # fmt: skip

_DIGITS = Context(prec=8)
_SHORT = 12  # characters of an exact number that a cell of a table shows whole


def stated(law: Law) -> Iterator[tuple[str, str]]:
    """Titles and contents, the boundary of K first; spaces that a line may not break at are tied."""
    yield _boundary(law)
    pressure = f"; pressure {law.pressure} <= 0 in compression, held fixed" if law.pressure else "; no pressure"
    yield "forces", ", ".join(law.forces) + pressure
    state = {} if isinstance(law, ParametricCriterion) else law.variables
    yield "parameters", ", ".join(_in_domain(n, d) for n, d in law.parameters.items() if n not in state) or "none"
    if state:
        yield "variables", ", ".join(f"{_in_domain(n, law.parameters[n])} ({own.describe()})" for n, own in state.items())
    if isinstance(law, Criterion):
        if law.energy is not None:
            yield "energy", f"psi = {formula(law.energy)}"
        if law.domain:
            yield "restricted to", ", ".join(d.stated(n) for n, d in law.domain.items())
    if law.constraints:
        yield "constraints", ", ".join(formula(c) for c in law.constraints)
    yield "slip", _direction(law)
    if isinstance(law, Criterion):
        yield from ((f"rate of {name}", f"{formula(rate)} for a unit of the multiplier") for name, rate in law.unforced.items())
        yield from ((f"rate of {name}", f"{formula(rate)} without a multiplier") for name, rate in law.rates.items())
        yield from ((f"heat at {name}", f"({formula(h)}) ({name} - {law.temperature}) into the interface") for name, h in law.heat.items())
    if law.source:
        yield "source", law.source


def number_in_words(exact: str) -> str:
    """A rational in decimals and exactly: ``= 0.15 = 3/20``, or ``~ 0.33333333 = 1/3`` where decimals do not end."""
    decimal = _decimal(exact)
    return f"= {exact}" if decimal is None or Fraction(exact).denominator == 1 else f"{decimal} = {exact}"


def number_in_short(exact: str) -> str:
    """The same in a cell of a table: exactly, ``= 3/20``, but ``~ 0.20000315`` where that is long; what is no number stays as it is."""
    decimal = _decimal(exact) if len(exact) > _SHORT else None
    return f"= {exact}" if decimal is None else decimal


def _decimal(exact: str) -> str | None:
    """A rational to eight digits, after the sign that says whether these are all; None for what is none."""
    try:
        fraction = Fraction(exact)
    except (ValueError, ZeroDivisionError):
        return None
    decimal = _DIGITS.divide(*(_DIGITS.create_decimal(x) for x in fraction.as_integer_ratio()))
    return f"= {decimal.normalize()}" if Fraction(decimal) == fraction else f"~ {decimal}"


def _direction(law: Law) -> str:
    if isinstance(law, Criterion) and law.viscous:
        return "each rate is the derivative of Phi* by its force"
    if isinstance(law, Criterion) and law.forces_of_rates:
        return "the forces are functions of the rates"
    if law.associated:
        return "normal to the boundary (associated)"
    if isinstance(law, ParametricCriterion) or not law.surfaces:
        return _slip(law)
    return "any sum of: " + "; ".join(f"{_slip(surface)} where {formula(surface.g)} = 0" for surface in law.surfaces)


def _slip(own: Law | YieldSurface) -> str:
    if not isinstance(own, ParametricCriterion) and own.potential is not None:
        return f"gradient of {' '.join(own.potential.split())}"
    return "normal" if own.flow is None else f"({', '.join(formula(c) for c in own.flow)})"


def _boundary(law: Law) -> tuple[str, str]:
    """What bounds K: the formula, or the curve at |pressure| = 1."""
    if isinstance(law, ParametricCriterion):
        return "boundary", f"|{law.pressure}| ({', '.join(formula(x) for x in law.boundary)}), {law.angle} from 0 to 2 pi"
    if law.forces_of_rates:
        return "resistance", "; ".join(f"{force} = {formula(expr)}" for force, expr in law.forces_of_rates.items())
    return ("potential", f"Phi* = {formula(law.g)}") if law.viscous else ("criterion", f"{formula(law.g)} <= 0")


def _in_domain(name: str, domain: Domain) -> str:
    return domain.stated(name) if domain.value is None else tied(f"{name} {number_in_words(str(domain.value))}")


@sheet.register(DeclaredLaw)
def as_sheet(law: Law) -> Sheet:
    """The fields of :func:`stated`, the boundary as a formula."""
    (title, boundary), *rest = stated(law)
    fields: tuple[tuple[str, str | Typeset], ...] = ((title, Typeset(boundary, as_latex(law))), *rest)
    return Sheet(f"{law.name}: {law.summary}" if law.summary else law.name, fields)


@latex.register(DeclaredLaw)
def as_latex(law: Law) -> str:
    """g <= 0, or the boundary curve, as SymPy writes it; names as in derivations."""
    known = law.symbols()
    names = {x: latex_name(name) for name, x in known.items()}
    if isinstance(law, ParametricCriterion):
        size = rf"\left|{names[law.symbols()[law.pressure]]}\right|"
        forces, curve = (", ".join(sp.latex(x, symbol_names=names) for x in point) for point in (law.force_symbols(), law.boundary))
        return rf"\left({forces}\right) = {size} \left({curve}\right)"
    if law.forces_of_rates:
        return r",\quad ".join(f"{names[known[f]]} = {sp.latex(x, symbol_names=names)}" for f, x in law.forces_of_rates.items())
    return rf"{sp.latex(law.g, symbol_names=names)} \leq 0"


@plain.register(DeclaredLaw)
def as_dict(law: Law) -> dict[str, Any]:
    """What the law states, formulas as text in the words of a criterion file; ``domains`` of the parameters in numbers, too."""
    return {
        "name": law.name,
        "summary": law.summary,
        "source": law.source,
        "forces": list(law.forces),
        "pressure": law.pressure,
        **_bounds(law),
        "parameters": {name: domain.plain() for name, domain in law.parameters.items()},
        "domains": {name: domain.numbers() for name, domain in law.parameters.items()},
        "constraints": [formula(c) for c in law.constraints],
        "flow": None if law.flow is None else [formula(x) for x in law.flow],
    }


def _bounds(law: Law) -> dict[str, Any]:
    """What only a curve or only a formula states."""
    if isinstance(law, ParametricCriterion):
        return {"boundary": [formula(x) for x in law.boundary], "angle": law.angle}
    surfaces = [{"g": formula(s.g), "flow": None if s.flow is None else [formula(x) for x in s.flow]} for s in law.surfaces]
    return {"g": formula(law.g), "surfaces": surfaces, "domain": {name: own.plain() for name, own in law.domain.items()}}


# -- units of the parameters -------------------------------------------------------------------------------------------


UNIT = "unit of stress"  # no law states one: all its stresses share it


def stress_powers(law: Law) -> Mapping[str, Fraction | None]:
    """By parameter 0 for a pure number, 1 for a stress, and so on; None where the formula leaves it open, or is of unlike terms."""
    table = law.symbols()
    power = {table[name]: sp.Dummy() for name in law.parameters}
    known = power | {table[name]: sp.S.One for name in law.coordinates}
    conditions = _Conditions()
    for expr in _formulas(law):
        found = conditions.weigh(expr)
        if not isinstance(law, Criterion):
            conditions.pure(expr, found)  # a boundary curve is in units of the pressure
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
