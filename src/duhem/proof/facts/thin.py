"""Whether the zeros of a formula have no inside.

An analytic function that is not 0 somewhere is 0 in no ball (the identity theorem).  Zeros of a product, a choice or a maximum are
among those of its parts; of a norm, and of a sum of terms >= 0, they are zeros of every part, so that one with thin zeros is enough.
"""

from __future__ import annotations

from itertools import chain

import sympy as sp

from duhem.expression import Norm, Where, defined_at
from duhem.proof.decide import Sense
from duhem.proof.facts.formula_subject import FormulaSubject

__all__ = ["zeros_are_thin"]

_ANALYTIC = (sp.exp, sp.sin, sp.cos, sp.sinh, sp.cosh, sp.tanh, sp.atan)


def zeros_are_thin(expr: sp.Expr, subject: FormulaSubject) -> bool:
    """Whether no ball of the simple problem's forces consists of zeros, whatever the parameters and the pressure (False if open)."""
    forces = set(subject.simple.forces)
    if not expr.free_symbols & forces:
        return subject.positive(expr**2)
    if _analytic(expr, subject) and _somewhere_not_zero(expr, subject):
        return True
    if isinstance(expr, sp.Abs) or (expr.is_Pow and not expr.exp.free_symbols & forces and subject.positive(expr.exp)):
        return zeros_are_thin(expr.args[0], subject)
    if isinstance(expr, sp.Mul | sp.Max | sp.Min):
        return all(zeros_are_thin(part, subject) for part in expr.args)
    if isinstance(expr, Where):
        return all(zeros_are_thin(part, subject) for part in expr.args[1:])
    if isinstance(expr, Norm):
        return any(zeros_are_thin(part, subject) for part in expr.args)
    if expr.is_Add and all(subject.ask(term, Sense.NONNEGATIVE).holds is True for term in expr.args):
        return any(zeros_are_thin(term, subject) for term in expr.args)
    return False


def _analytic(expr: sp.Expr, subject: FormulaSubject) -> bool:
    """Whether it is built from analytic functions alone, defined for all forces: no root of what may be 0 is one."""
    if not expr.free_symbols & set(subject.simple.forces) or expr.is_Symbol:
        return True
    if expr.is_Pow:
        base, power = expr.args
        whole = power.is_Integer and power.is_nonnegative
        nonzero = base**2 if power.is_Integer else base
        return _analytic(base, subject) and _analytic(power, subject) and (whole or subject.positive(nonzero))
    if isinstance(expr, sp.log):
        return _analytic(expr.args[0], subject) and subject.positive(expr.args[0])
    return isinstance(expr, (sp.Add, sp.Mul, *_ANALYTIC)) and all(_analytic(part, subject) for part in expr.args)


def _somewhere_not_zero(expr: sp.Expr, subject: FormulaSubject) -> bool:
    """Whether at one point it is 0 for no parameter value and no pressure."""
    forces = subject.simple.forces
    axes = ([sp.Integer(i == k) for i in range(len(forces))] for k in range(len(forces)))
    for point in chain([[sp.S.Zero] * len(forces)], axes, [[sp.Integer(3 * i + 2) for i in range(len(forces))]]):
        value = defined_at(expr, dict(zip(forces, point, strict=True)))
        if value is not None and subject.positive(value**2):
            return True
    return False
