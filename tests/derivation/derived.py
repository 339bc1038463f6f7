"""The derivations of the built-in laws, each made once for the tests of the whole folder, and the value of a formula in them."""

from __future__ import annotations

from functools import cache
from typing import Any

import mpmath
import sympy as sp

from duhem.derivation import Derivation, derive
from duhem.expression import mpmath_
from duhem.law.catalogue import load

__all__ = ["DPS", "EVERY_RUN", "LAWS", "at", "derived", "holds"]

DPS = 40

LAWS = (
    "antoni2007", "antoni2007-1d", "box", "capped", "cohesive", "coulomb", "drucker1949", "hosford", "limacon", "lobes", "matchstick",
    "orthotropic", "polygon", "quartic", "radial-flow", "regularised", "rotated-flow", "shifted-ellipse", "superellipse", "tresca",
    "von-mises",
)  # fmt: skip
EVERY_RUN = (  # of smooth laws, of some with corners, of each flow: those that are derived soonest
    "antoni2007", "antoni2007-1d", "box", "coulomb", "limacon", "matchstick", "radial-flow",
)  # fmt: skip


@cache
def derived(name: str, stiffness: str = "orthotropic") -> Derivation:
    return derive(load(name), stiffness=stiffness)


def at(expr: sp.Basic, point: dict[sp.Symbol, Any]) -> Any:
    """An expression, possibly by branches, at a point."""
    if isinstance(expr, sp.Piecewise):
        return next(at(e, point) for e, c in expr.args if holds(c, point))
    if isinstance(expr, sp.Mul | sp.Add) and expr.has(sp.Piecewise):
        return (mpmath.fprod if isinstance(expr, sp.Mul) else mpmath.fsum)(at(a, point) for a in expr.args)
    return mpmath_.evaluate(expr, point, DPS)


def holds(condition: sp.Basic, point: dict[sp.Symbol, Any]) -> bool:
    if isinstance(condition, sp.And):
        return all(holds(c, point) for c in condition.args)
    if condition in (sp.true, sp.false):
        return bool(condition)
    return bool(mpmath_.evaluate(type(condition)(condition.lhs - condition.rhs, 0, evaluate=False), point, DPS) == 1)
