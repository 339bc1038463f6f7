"""One law's increment as C functions: what numba compiles for it, and what a finite-element program needs around it, translated."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache, lru_cache
from typing import Any

import numpy as np
import sympy as sp

from duhem.errors import InputError
from duhem.export import increment_kernel
from duhem.export.c_translation import Array, c_functions
from duhem.expression import UNDEFINED
from duhem.expression.scalar_bounds import Name, statements
from duhem.expression.scalar_jets import scalar_jets, scalar_values
from duhem.law.formula_law import Criterion
from duhem.law.shapes import Disk, Quadrants
from duhem.law.state import check_stateless
from duhem.projection.closed_form import centre, own_entries
from duhem.projection.compiled_newton import KERNEL
from duhem.projection.module_text import module_text
from duhem.projection.quarter_ellipse import formulas
from duhem.projection.scaled_formula import scaled
from duhem.proof.decide import Sense
from duhem.proof.facts.formula_subject import FormulaSubject

__all__ = ["Routine", "closes", "conditions", "function_text", "routine"]

_D, _SQUARE = Array("double", ("D",)), Array("double", ("D", "D"))
_ARRAYS: Mapping[str, Array] = {
    "v": Array("double", ("ROWS", "D")),
    "m": Array("double", ("MATRICES", "D", "D")),
    "a": Array("double", ("2 * D", "2 * D + 1")),
    "q": Array("double", ("1",)),
    "w": Array("double", ("1",)),
    "out": Array("double", ("1",)),
    "axes": Array("double", ("4", "3")),
    "held": Array("signed char", ("D + 1", "KINKS + 1")),
    "choices": Array("signed char", ("D + 1", "KINKS + 1")),
    "data": Array("double", ("1", "DATA + 1")),
    "trial": Array("double", ("1", "D")),
    "stress": Array("double", ("1", "D")),
    "slip": Array("double", ("1", "D")),
    **dict.fromkeys(("start", "found", "slips"), Array("double", ("1", "D"))),
    "multiplier": Array("double", ("1",)),
    "dissipation": Array("double", ("1",)),
    "seen": Array("double", ("1",)),
    "tangent": Array("double", ("D * D",)),
    "increment.trial": Array("double", ("D",), read_only=True),
    "increment.stiffness": Array("double", ("D * D",), read_only=True),
    "increment.parameters": Array("double", ("PARAMETERS",), read_only=True),
    **{f"{where}.{name}": _D for where in ("increment", "nothing", "beyond") for name in ("stress", "slip")},
    **dict.fromkeys(("root", "inverse", "k", "matrix", "free"), _SQUARE),
}
_PLAIN = dict.fromkeys(("x", "c", "n", "slopes", "bends", "natural"), "int") | {"size": "float"}
_BELOW = """\
/* The power of two below, 2^-1022 at least. */
static double below(double size)
{
    return ldexp(1.0, binary_exponent(larger(size, DBL_MIN)) - 1);
}"""


@dataclass(frozen=True)
class Routine:
    """The C functions of one law, all static, ``increment`` or ``step`` last; ``parameters`` are those that are arguments, in order."""

    text: str
    parameters: tuple[str, ...]


@lru_cache(maxsize=16)
def routine(law: Criterion) -> Routine:
    """The increment of ``law``, its open parameters arguments.

    InputError for a law with a flow of its own, one whose formula has no derivatives as text, and for an open exponent: which
    powers are smooth, and where, is part of the algorithm.
    """
    check_stateless(law, "an exported routine")
    if not law.associated:
        what = f"{law.name} has its own flow direction, but the closest point is the slip increment of associated laws only"
        raise InputError(what, where="law", remedy="export the same criterion without its flow")
    settled, table = law.settled(), law.symbols()
    g = law.g.xreplace(settled)
    names = tuple(name for name, domain in law.parameters.items() if domain.value is None)
    powers = {x.name for power in g.atoms(sp.Pow) for x in power.exp.free_symbols}
    if open_ := [name for name in names if name in powers]:
        remedy = f"give {' '.join(f'--set {name}=VALUE' for name in open_)}"
        raise InputError(
            f"{', '.join(open_)} occurs in an exponent, and cannot be an argument of the routine", where=law.name, remedy=remedy
        )
    if g.has(sp.zoo, sp.nan, sp.oo, -sp.oo):
        raise InputError("g is not defined at these parameters", where=law.name, remedy="set others")
    own, pressure = tuple(table[name] for name in names), table[law.pressure] if law.pressure else None
    formula = scaled(g, law.force_symbols(), pressure)
    jets = scalar_jets(formula.expr, law.force_symbols(), (*formula.data, *own))
    data, relations = [datum.expr for datum in formula.data.values()], conditions(law, settled, names)
    shape = [sp.sympify(entry).xreplace(settled) for entry in _quarters(law)]
    stated, numbers = scalar_values("stated", [*data, *relations, *shape], (pressure or sp.Dummy("none"), *own))
    counts = {
        "PARAMETERS": len(own),
        "CONSTANTS": len(jets.constants),
        "NUMBERS": len(numbers),
        "CONDITIONS": len(relations),
        "CLOSES": int(closes(law)),
        "SHAPE": len(data) + len(relations),
        "DEGREE": formula.degree,
    }
    behind = [("q", len(data) + len(own), jets.constants), ("w", 1 + len(own), numbers)]
    functions = [
        jets.level,
        jets.piece,
        "\n".join(f"{name} = {value!r}" for name, value in counts.items()),
        stated,
        function_text("placed(q, w)", [f"{array}[{start + k}] = {x!r}" for array, start, each in behind for k, x in enumerate(each)]),
        function_text("beyond(stress, slack: float) -> bool", [f"if {past}: return True" for past in _beyond(law)], "return False"),
    ]
    text = module_text(
        formula, len(law.forces), jets, [*functions, *_on_ellipse()], (*KERNEL, increment_kernel), ("increment",), QUARTERS=int(bool(shape))
    )
    return Routine(c_functions(text, "increment", _ARRAYS, _PLAIN, {"below": _BELOW}), names)


def _quarters(law: Criterion) -> tuple[object, ...]:
    """The coefficients of four quarter ellipses about no stress and their load, where that is the shape of K; else nothing."""
    shape = law.closed_form
    if len(law.forces) != 2 or not isinstance(shape, Disk | Quadrants) or centre(shape):
        return ()
    own = own_entries(shape)
    return *own * (4 // len(own)), shape.load


_OF_ELLIPSE = {"on_grid": ("x", "mx", "y", "my", "e"), "direction": ("px", "py", "ly", "e", "r"), "multiplier": ("f", "wx", "wy", "e", "r")}


@cache
def _on_ellipse() -> list[str]:
    """The formulas of :mod:`duhem.projection.quarter_ellipse` as functions of numbers, with the axis of the smaller mu^2/k first."""
    known = formulas(where=np.where, roots=(lambda x: x ** (1.0 / 3.0), np.sqrt))
    return [_lines(name, getattr(known, name), given) for name, given in _OF_ELLIPSE.items()]


def _lines(name: str, formula: Callable[..., Any], given: Sequence[str]) -> str:
    """A formula over numbers that fills ``seen`` with what it returns."""
    lines: dict[str, str] = {}
    found = formula(*(Name(lines, one) for one in given))
    ends = [f"seen[{k}] = {one.name}" for k, one in enumerate(found if isinstance(found, tuple) else (found,))]
    return function_text(f"{name}({', '.join(f'{one}: float' for one in given)}, seen)", [*map(str.strip, statements(lines)), *ends])


def conditions(law: Criterion, settled: Mapping[sp.Symbol, sp.Expr], names: Sequence[str]) -> list[sp.Basic]:
    """What must hold of the open parameters, of these ``names``, and of the pressure for the law to say anything."""
    table = law.symbols()
    found = [relation for name in names for relation in law.parameters[name].relations(table[name])]
    found += [relation.xreplace(settled) for relation in law.constraints]
    if law.pressure is not None:
        own = law.domain.get(law.pressure)
        found += [sp.LessThan(table[law.pressure], 0, evaluate=False), *(own.relations(table[law.pressure]) if own else ())]
    return [relation for relation in found if relation != sp.true]


def _beyond(law: Criterion) -> Iterator[str]:
    """When a stress lies outside a range."""
    for i, name in enumerate(law.forces):
        if name in law.domain:
            (low, high), own = law.domain[name].ends, law.domain[name]
            if own.low is not None:
                yield f"stress[{i}] < {low!r} - slack"
            if own.high is not None:
                yield f"stress[{i}] > {high!r} + slack"


def function_text(head: str, lines: Sequence[str], last: str = "return") -> str:
    """A function of these lines."""
    return "\n".join([f"def {head}:", *(f"    {line}" for line in [*lines, last])])


def closes(law: Criterion) -> bool:
    """Whether K is the point 0 where the pressure is 0, proved: g = 0 at no force, and g > 0 at any other, for all parameters."""
    if law.pressure is None:
        return False
    g = law.g.xreplace({law.symbols()[law.pressure]: sp.S.Zero, **law.settled()})
    if g.has(*UNDEFINED) or not g.free_symbols & set(law.force_symbols()):
        return False
    bare = Criterion(name=law.name, g=g, forces=law.forces, pressure=None, parameters=law.parameters, constraints=law.constraints)
    subject = FormulaSubject(bare)
    forces = subject.simple.forces
    if subject.doubtful or len(forces) != len(law.forces) or subject.at_origin is None or not subject.nonnegative(-subject.at_origin):
        return False
    away = sp.StrictGreaterThan(sp.Add(*(x**2 for x in forces)), 0)
    return subject.ask(subject.simple.g, Sense.POSITIVE, away).holds is True
