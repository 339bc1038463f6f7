"""A law as a notebook shows it: what it states, and its boundary in LaTeX."""

from __future__ import annotations

from typing import Any

import sympy as sp

from duhem.expression.text import formula
from duhem.law.curve_law import Law, ParametricCriterion
from duhem.law.formula_law import Criterion
from duhem.law.stated import stated
from duhem.law.yield_surface import YieldSurface
from duhem.show.notation import latex_name
from duhem.show.printing import latex, plain, sheet
from duhem.show.sheet import Sheet, Typeset

__all__ = ["as_dict", "as_latex", "as_sheet"]


@sheet.register(Criterion)
@sheet.register(ParametricCriterion)
def as_sheet(law: Law) -> Sheet:
    """The fields of :func:`duhem.law.stated.stated`, the boundary as a formula."""
    (title, boundary), *rest = stated(law)
    fields: tuple[tuple[str, str | Typeset], ...] = ((title, Typeset(boundary, as_latex(law))), *rest)
    return Sheet(f"{law.name}: {law.summary}" if law.summary else law.name, fields)


@latex.register(Criterion)
@latex.register(ParametricCriterion)
def as_latex(law: Law) -> str:
    """g <= 0, or the boundary curve, as SymPy writes it; names as in derivations."""
    names = {known: latex_name(name) for name, known in law.symbols().items()}
    if isinstance(law, ParametricCriterion):
        size = rf"\left|{names[law.symbols()[law.pressure]]}\right|"
        forces, curve = (", ".join(sp.latex(x, symbol_names=names) for x in point) for point in (law.force_symbols(), law.boundary))
        return rf"\left({forces}\right) = {size} \left({curve}\right)"
    return rf"{sp.latex(law.g, symbol_names=names)} \leq 0"


@plain.register(Criterion)
@plain.register(ParametricCriterion)
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
    domain = {name: own.plain() for name, own in law.domain.items()}
    return {"g": formula(law.g), "surfaces": [_surface(s) for s in law.surfaces], "domain": domain}


def _surface(surface: YieldSurface) -> dict[str, Any]:
    return {"g": formula(surface.g), "flow": None if surface.flow is None else [formula(x) for x in surface.flow]}
