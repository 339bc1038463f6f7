"""Formulas as CVXPY expressions, atom by atom, so that the DCP rules see their curvature.

``norm`` becomes a second-order cone, a p-norm ``(|x|**p + |y|**p)**(1/p)`` and general powers become exact power
cones, and a root of a sum of squares is read as the norm it is (SymPy spells it as a power, which DCP rejects).
What has no curvature (``where``, trigonometry) is accepted on numbers only.  CVXPY is imported when a row first runs.
"""

from __future__ import annotations

import inspect
import operator
from collections.abc import Callable, Mapping, Sequence
from functools import reduce
from typing import Any

import numpy as np
import sympy as sp

from duhem.errors import InputError
from duhem.expression import numpy_
from duhem.expression.elementary import ELEMENTARY
from duhem.expression.fold import Table, fold
from duhem.expression.pnorm import PNorm, recognised
from duhem.expression.text import formula
from duhem.expression.vocabulary import COMPARISONS, Atan2, EigMax, Neg, Norm, Pos, Where, rows

__all__ = ["NUMBERS_ONLY", "TABLE", "dcp_fault", "expression"]

Atom = Any  # a cvxpy.Expression; the module is not imported here
Row = Callable[..., Atom]


def expression(expr: sp.Basic, variables: Mapping[sp.Symbol, Any]) -> Atom:
    """The formula as a CVXPY expression, which need not be DCP (see :func:`dcp_fault`).

    ``variables`` maps every symbol to a variable, a parameter (of known sign where DCP needs it) or a number; scalars
    or all vectors of one length, for a batch.  Units are the caller's.  A power or a logarithm restricts its argument
    to where the formula is defined, as an implicit constraint of CVXPY.  Raises InputError for a symbol without a
    value and for what no DCP atom expresses.
    """
    return _build(expr, variables, lambda row: row)


def dcp_fault(expr: sp.Basic, variables: Mapping[sp.Symbol, Any]) -> str | None:
    """None if the formula is convex in the variables by the DCP rules, else the offending part and a remedy.

    A fault says that the rules do not apply; it never says that the set {expr <= 0} is not convex.
    """
    faults: list[sp.Basic] = []

    def watched(row: Row) -> Row:
        def run(node: sp.Basic, *values: Atom) -> Atom:
            value = row(node, *values)
            if not value.is_dcp():
                faults.append(node)
            return value

        return run

    try:
        value = _build(expr, variables, watched)
    except InputError as error:
        return str(error)
    if faults:  # arguments come before what they are in: the first fault is an innermost one
        return f"{formula(faults[0])} has no curvature by the DCP rules; {_REMEDIES.get(type(faults[0]), _REMEDY)}"
    return None if value.is_convex() else f"{formula(expr)} is concave; the set where it is <= 0 is not convex by the DCP rules"


def _build(expr: sp.Basic, variables: Mapping[sp.Symbol, Any], watch: Callable[[Row], Row]) -> Atom:
    import cvxpy as cp

    def leaf(node: Any) -> Atom:
        if node in variables:
            given = variables[node]
            return given if isinstance(given, cp.Expression) else cp.Constant(given)
        return cp.Constant(float(numpy_.evaluate(node, {})))

    table = {kind: watch(_or_number(kind, row)) for kind, row in TABLE.items()}
    return fold(recognised(expr), table, leaf)


def _or_number(kind: type, row: Row) -> Row:
    """The row, except on numbers: they have a value rather than a curvature."""
    import cvxpy as cp

    numeric = numpy_.TABLE.get(kind)

    def run(node: sp.Basic, *values: Atom) -> Atom:
        if numeric is None or not all(isinstance(value, cp.Constant) for value in values):
            return row(node, *values)
        with np.errstate(all="ignore"):
            result = numeric(node, *(value.value for value in values))
        if not np.all(np.isfinite(result)):
            raise InputError(f"{formula(node)} is not real and finite", remedy="correct the numbers given")
        return cp.Constant(result)

    return run


# -- the rows --------------------------------------------------------------------------------------------------------


def _cp() -> Any:
    import cvxpy as cp

    return cp


def _exact(atom: Callable[..., Atom]) -> dict[str, bool]:
    """The option for exact cones, where the installed CVXPY has it (older ones take rational exponents as they are)."""
    return {"approx": False} if "approx" in inspect.signature(atom).parameters else {}


def _number(node: sp.Basic, value: Atom, role: str) -> float:
    if not isinstance(value, _cp().Constant):
        raise InputError(f"the {role} of {formula(node)} is not a number", remedy="fix its value")
    return float(value.value)


def _power(node: Any, base: Atom, exponent: Atom) -> Atom:
    cp = _cp()
    if isinstance(base, cp.Constant) and not isinstance(exponent, cp.Constant) and base.is_nonneg():
        return cp.exp(exponent * float(np.log(base.value)))
    p = _number(node, exponent, "exponent")
    if p in (0, 1):
        return base if p == 1 else cp.Constant(1.0)
    if p == 2:
        return cp.square(base)
    if p == 0.5:
        return cp.sqrt(base)
    if p > 0 and p % 2 == 0:
        return cp.power(cp.abs(base), p, **_exact(cp.power))
    if p.is_integer() and not base.is_nonneg():  # CVXPY would cut the domain down to x >= 0, where the formula does not
        what = f"{formula(node)} has no curvature where its base may be negative"
        raise InputError(what, remedy="give the base a sign, for example with abs or pos")
    return cp.power(base, p, **_exact(cp.power))


def _alike(args: Sequence[Atom]) -> list[Atom]:
    """Scalars as they are, or else all as vectors of one length."""
    shape = max((a.shape for a in args), key=len)
    return [a if a.shape == shape else a * np.ones(shape) for a in args]


def _stack(*args: Atom) -> tuple[Atom, dict[str, int]]:
    """The arguments of a norm over each other, and over which axis to take it: scalars, or vectors point by point."""
    alike = _alike(args)
    return (_cp().vstack(alike), {"axis": 0}) if alike[0].shape else (_cp().hstack(alike), {})


def _norm(_: sp.Basic, *args: Atom) -> Atom:
    stacked, over = _stack(*args)
    return _cp().norm(stacked, 2, **over)


def _pnorm(node: sp.Basic, p: Atom, *args: Atom) -> Atom:
    cp = _cp()
    stacked, over = _stack(*args)
    value, exact = _number(node, p, "exponent"), _exact(cp.pnorm)
    if value == 1:
        return reduce(operator.add, map(cp.abs, args))
    if not over:
        return cp.pnorm(stacked, value, **exact)
    return cp.hstack([cp.pnorm(stacked[:, i], value, **exact) for i in range(stacked.shape[1])])  # the atom has no axis


def _eigmax(_: sp.Basic, *entries: Atom) -> Atom:
    cp, whole = _cp(), _alike(entries)
    if not whole[0].shape:
        return cp.lambda_max(cp.bmat(rows(*whole)))
    return cp.hstack([cp.lambda_max(cp.bmat(rows(*(a[i] for a in whole)))) for i in range(whole[0].shape[0])])


def _no_atom(node: sp.Basic, *_: Atom) -> Atom:
    raise InputError(f"{formula(node)} has no DCP atom", remedy="write it with norm, abs, pos, neg, max or a power, or fix its argument")


# Node classes that mean something on numbers only, and why.
NUMBERS_ONLY: dict[type, str] = dict.fromkeys(
    (Atan2, *(word.node for word in ELEMENTARY.values() if word.atom is None)), "neither convex nor concave"
) | dict.fromkeys((Where, *COMPARISONS), "a case distinction has no curvature")

TABLE: Table[Atom] = {
    sp.Add: lambda _, *x: reduce(operator.add, x),
    # constants first: (2/mu) x is a scaling, 2 (x/mu) a product of two expressions to the sign rules
    sp.Mul: lambda _, *factors: reduce(_cp().multiply, sorted(factors, key=lambda f: not f.is_constant())),
    sp.Pow: _power,
    sp.Abs: lambda _, x: _cp().abs(x),
    **{word.node: lambda _, x, atom=word.atom: atom(_cp(), x) for word in ELEMENTARY.values() if word.atom},
    sp.Min: lambda _, *x: _cp().minimum(*x),
    sp.Max: lambda _, *x: _cp().maximum(*x),
    Pos: lambda _, x: _cp().pos(x),
    Neg: lambda _, x: _cp().neg(x),
    Norm: _norm,
    EigMax: _eigmax,
    PNorm: _pnorm,
    **dict.fromkeys(NUMBERS_ONLY, _no_atom),
    Where: lambda node, condition, a, b: a if _number(node, condition, "condition") else b,
}

_REMEDY = "its arguments must be affine, or convex and non-negative such as pos(x)/m + neg(x)/n with positive m, n"
_REMEDIES: dict[type, str] = {
    sp.Add: "it adds convex and concave terms; rewrite the formula so that all have one curvature",
    sp.Mul: "keep one factor that is not constant, and give every parameter a sign",
    sp.Pow: "a root of a sum of squares is norm(x, y), and a power takes an affine argument or one of known sign",
    sp.Max: "its arguments must be convex",
    sp.Min: "its arguments must be concave",
    **{word.node: f"its argument must be {word.curvature if word.increasing else 'affine'}" for word in ELEMENTARY.values() if word.atom},
    EigMax: "its arguments must be affine",
}
