"""Where a formula certainly has no value, and what to write if the limit of a part of it is meant there."""

from __future__ import annotations

import sympy as sp

from duhem.law.formula_law import Criterion
from duhem.proof.decide import Sense
from duhem.proof.facts.formula_subject import FormulaSubject
from duhem.proof.statement.obligations import Obligation

__all__ = ["undefined_at_zero", "undefined_place"]


def undefined_place(subject: FormulaSubject, obligation: Obligation) -> str:
    """The hydrostatic axis or zero force, with the remedy, where what is divided by or under a logarithm is 0 there; else ""."""
    normal, shear = subject.problem.forces[:3], subject.problem.forces[3:]
    remedy = "; if its limit is meant there, write where({} > 0, ..., 0) around the part that it stands in"
    axis = dict.fromkeys(normal, sp.S.One) | dict.fromkeys(shear, sp.S.Zero)
    if len(normal) == 3 and len(shear) in (0, 3) and _vanishes(obligation, axis):
        equal = " = ".join(map(str, normal)) + "".join(f", {x} = 0" for x in shear)
        return f"where {equal}{remedy.format(_size(subject.law))}"
    if _vanishes(obligation, dict.fromkeys(subject.problem.forces, sp.S.Zero)):
        return f"at zero force{remedy.format('...')}"
    return ""


def _size(law: Criterion) -> str:
    """What is 0 on the axis alone: J2, or six times it."""
    if law.stress is not None:
        return f"J2({law.stress.name})"
    x, y, z, *shear = law.forces
    return f"({x} - {y})**2 + ({y} - {z})**2 + ({z} - {x})**2" + "".join(f" + 6*{s}**2" for s in shear)


def undefined_at_zero(subject: FormulaSubject) -> Obligation | None:
    """A part that has no value at zero force, if there is one."""
    zero = dict.fromkeys(subject.problem.forces, sp.S.Zero)
    return next((o for o in subject.doubtful if _vanishes(o, zero)), None)


def _vanishes(obligation: Obligation, place: dict[sp.Symbol, sp.Expr]) -> bool:
    """Whether it asks that something is not 0 which is 0 at a place, for all parameters."""
    here = obligation.put(place)
    return here.sense is not Sense.NONNEGATIVE and all(r == sp.true for r in here.given) and sp.simplify(here.expr) == 0
