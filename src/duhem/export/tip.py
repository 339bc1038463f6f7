"""What is left of K where the contact is not pressed: of most laws of friction the origin alone, the tip of a cone."""

from __future__ import annotations

import sympy as sp

from duhem.expression import UNDEFINED
from duhem.law.formula_law import Criterion
from duhem.proof.decide import Sense
from duhem.proof.facts.formula_subject import FormulaSubject

__all__ = ["closes"]


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
