"""A criterion as the text of a criterion file; :func:`duhem.law.criterion_file.reads` reads the same law back."""

from __future__ import annotations

import json
from collections.abc import Sequence

import sympy as sp

from duhem.errors import InputError
from duhem.expression.text import faithful
from duhem.law.curve_law import Law, ParametricCriterion
from duhem.law.domain import Domain
from duhem.law.formula_law import Criterion
from duhem.law.yield_surface import YieldSurface

__all__ = ["criterion_text"]


def criterion_text(law: Law) -> str:
    """The law in TOML: formula, surfaces or boundary curve, parameters with exact values or domains, constraints, flow.

    InputError for a value or an end of a domain that is no finite decimal.
    """
    lines = ["[criterion]", f"name = {_quoted(law.name)}"]
    lines += [f"{key} = {_quoted(value)}" for key, value in (("summary", law.summary), ("source", law.source)) if value]
    lines += [f"forces = [{', '.join(map(_quoted, law.forces))}]"]
    lines += [f"pressure = {_quoted(law.pressure) if law.pressure else 'false'}"]
    if isinstance(law, Criterion) and not law.surfaces:
        lines += [f"g = {_quoted(_text(law, law.g))}", *_potential(law)]
    if law.constraints:
        lines += [f"constraints = [{', '.join(_quoted(_text(law, c)) for c in law.constraints)}]"]
    lines += ["", "[parameters]", *(f"{name} = {_domain(domain, f'{law.name}: {name}')}" for name, domain in law.parameters.items())]
    if isinstance(law, ParametricCriterion):
        lines += ["", "[boundary]", f"angle = {_quoted(law.angle)}", f"T = {_list(law, law.boundary)}"]
        lines += [f"direction = {_list(law, law.flow)}"] if law.flow is not None else []
        return "\n".join(lines) + "\n"
    if law.domain:
        lines += ["", "[domain]", *(f"{name} = {_domain(own, f'{law.name}: {name}')}" for name, own in law.domain.items())]
    if law.flow is not None and law.potential is None:
        lines += ["", "[flow]", f"direction = {_list(law, law.flow)}"]
    for surface in law.surfaces:
        lines += ["", "[[surface]]", f"g = {_quoted(_text(law, surface.g))}", *_potential(surface)]
        lines += [f"flow = {_list(law, surface.flow)}"] if surface.flow is not None and surface.potential is None else []
    return "\n".join(lines) + "\n"


def _potential(stated: Criterion | YieldSurface) -> list[str]:
    return [] if stated.potential is None else [f"potential = {_quoted(stated.potential)}"]


def _list(law: Law, formulas: Sequence[sp.Expr]) -> str:
    return f"[{', '.join(_quoted(_text(law, x)) for x in formulas)}]"


def _text(law: Law, expr: sp.Basic) -> str:
    return faithful(expr, law.symbols().values())


def _quoted(text: str) -> str:
    return json.dumps(text, ensure_ascii=False)  # a JSON string of printable text is a basic string of TOML


def _domain(domain: Domain, where: str) -> str:
    if domain.value is not None:
        return f"{{ value = {_decimal(domain.value, where)} }}"
    ends = [f"max = {_decimal(domain.high, where)}"] if domain.high is not None else []
    if domain.positive:
        ends = ["positive = true", *ends]
    elif domain.low is not None:
        ends = [f"min = {_decimal(domain.low, where)}", *ends]
    return f"{{ {', '.join(ends)} }}" if ends else "{}"


def _decimal(x: sp.Rational, where: str) -> str:
    """``x`` in full, as TOML writes numbers."""
    rest, places = int(x.q), {2: 0, 5: 0}
    for prime in places:
        while rest % prime == 0:
            rest, places[prime] = rest // prime, places[prime] + 1
    if rest != 1:
        raise InputError(f"{x} is no finite decimal", where=where, remedy="give it as a decimal, such as 0.333333")
    scale = max(places.values())
    digits = str(abs(int(x.p)) * 10**scale // int(x.q)).rjust(scale + 1, "0")
    body = f"{digits[:-scale]}.{digits[-scale:]}" if scale else digits
    return f"-{body}" if x < 0 else body
