"""Where a formula certainly has no value, and what to write if the limit of a part of it is meant there."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import sympy as sp

from duhem.expression import Where
from duhem.expression.text import formula
from duhem.expression.weights import degree
from duhem.law.formula_law import Criterion
from duhem.proof.decide import Sense
from duhem.proof.decide.needs import Obligation, obligations
from duhem.proof.facts.formula_subject import FormulaSubject

__all__ = ["limits_taken", "undefined_at_zero", "undefined_place"]


def undefined_place(subject: FormulaSubject, obligation: Obligation) -> str:
    """The hydrostatic axis or zero force, with the remedy, where what is divided by or under a logarithm is 0 there; else ""."""
    normal, shear = subject.problem.forces[:3], subject.problem.forces[3:]
    remedy = "; if its limit is meant there, write where({} > 0, ..., 0) around the part that it stands in"
    axis = dict.fromkeys(normal, sp.Dummy("p", nonzero=True, real=True)) | dict.fromkeys(shear, sp.S.Zero)
    if len(normal) == 3 and len(shear) in (0, 3) and _vanishes(obligation, axis):
        equal = " = ".join(map(str, normal)) + "".join(f", {x} = 0" for x in shear)
        return f"where {equal}{remedy.format(_size(subject.law))}"
    if _vanishes(obligation, dict.fromkeys(subject.problem.forces, sp.S.Zero)):
        return f"at zero force{remedy.format('...')}"
    return ""


def limits_taken(subject: FormulaSubject) -> Iterator[str]:
    """That g, as written, has no value at zero force and what is proved is of the formula with its limit there."""
    zero = dict.fromkeys(subject.problem.forces, sp.S.Zero)
    part = next((o for o in obligations(subject.problem.stated) if _vanishes(o, zero)), None)
    if part is not None and not subject.doubtful:
        yield f"g has no value at zero force, for it {part.does} {formula(part.expr)}: there it is read as its limit, and K is closed"


def _size(law: Criterion) -> str:
    """What is 0 on the axis alone: J2, or six times it."""
    if law.stress is not None:
        return f"J2({law.stress.name})"
    x, y, z, *shear = law.forces
    return f"({x} - {y})**2 + ({y} - {z})**2 + ({z} - {x})**2" + "".join(f" + 6*{s}**2" for s in shear)


def undefined_at_zero(subject: FormulaSubject) -> str:
    """That g has no value at zero force, and what to write for it; "" where it has one, or where that is not seen."""
    zero = dict.fromkeys(subject.problem.forces, sp.S.Zero)
    if (doubtful := next((o for o in subject.doubtful if _vanishes(o, zero)), None)) is not None:
        return f"g has no value {undefined_place(subject, doubtful)}"
    part = next((o for o in obligations(subject.problem.stated) if _vanishes(o, zero)), None)
    if part is None:
        return ""
    law, forces = subject.law, subject.law.forces
    away = (f"norm({', '.join(forces)})" if len(forces) > 1 else f"abs({forces[0]})") + " > 0"
    if small := _vanishing_quotients(law.g, law.force_symbols()):
        several = len(small) > 1
        return (
            f"g has no value at zero force: {' and '.join(map(formula, small))} {'are' if several else 'is'} 0/0 there, with the limit 0; "
            f"write where({away}, ..., 0) around {'each' if several else 'it'}"
        )
    return (
        f"g has no value at zero force: it {part.does} {formula(part.expr)}, which is 0 there; "
        f"write where({away}, ..., ...) around it, with what g is there at the end"
    )


def _vanishing_quotients(g: sp.Expr, forces: Sequence[sp.Symbol]) -> list[sp.Expr]:
    """All quotients in g with a divisor that is 0 at zero force, if each tends to 0 there; else none.

    Of a positive degree it does: it is defined, and without a ``where`` continuous, on the unit sphere of the forces, so bounded there.
    """
    found = list[sp.Expr]()
    walk = sp.preorder_traversal(g)
    for part in walk:
        if any(divisor.subs(dict.fromkeys(forces, sp.S.Zero)).is_zero for divisor in _divisors(part)):
            order = degree(part, forces)
            if order is None or not order.is_positive or part.has(Where):
                return []
            found.append(part)
            walk.skip()
    return found


def _divisors(part: sp.Basic) -> list[sp.Expr]:
    factors = [f for f in sp.Mul.make_args(part) if isinstance(f, sp.Pow)]
    return [f.base for f in factors if f.exp.is_negative]


def _vanishes(obligation: Obligation, place: dict[sp.Symbol, sp.Expr]) -> bool:
    """Whether it asks that something is not 0 which is 0 at a place, for all parameters."""
    here = obligation.put(place)
    if here.sense is Sense.NONNEGATIVE or here.instead or any(r != sp.true for r in here.given):
        return False
    return sp.simplify(here.expr) == 0
