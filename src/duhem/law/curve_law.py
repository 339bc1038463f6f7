r"""A law whose boundary is a curve: phi -> |sigma_n| T(phi), with the slip direction d(phi) that goes with each point.

Sign convention as everywhere: sigma_n <= 0 in compression.  K(sigma_n) = |sigma_n| K_1, where K_1 holds the points of the
closed curve T, run either way, and the points it winds around.  Such a law has no formula g.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from importlib import import_module
from itertools import chain, repeat
from typing import Any, ClassVar

import sympy as sp
from sympy.core.relational import Relational

from duhem.errors import InputError
from duhem.expression.abbreviations import NONE
from duhem.expression.syntax import spelled
from duhem.law.domain import Domain, Domains
from duhem.law.formula_law import FORCES, PRESSURE, Criterion, DeclaredLaw, as_expression, declared_symbols, swapped
from duhem.law.frozen_mapping import FrozenMapping
from duhem.law.given import listed, moved, moved_relations, relations, text_of

__all__ = ["ANGLE", "Law", "ParametricCriterion", "closes"]

ANGLE = "phi"


@dataclass(frozen=True, repr=False)
class ParametricCriterion(DeclaredLaw):
    """K(sigma_n) = |sigma_n| K_1 in two forces, K_1 enclosed by the curve ``boundary`` (angle), angle in [0, 2 pi).

    ``boundary``, ``flow`` and ``constraints`` are text in the vocabulary or SymPy expressions over :meth:`symbols`;
    boundary and flow may use the angle through its cosine and sine only, which closes the curve.  ``flow`` is the slip
    direction that goes with the point at the same angle; None means associated (normality rule).  ``instead`` names a
    law to take where a formula is needed, ``derivation`` (``module:attribute``) what derives the curve.  ``written`` and
    ``written_constraints`` are the components, those of the boundary first, and the constraints as they were given, where that was text.
    ``expect`` maps claims to the verdicts that are no failure, and ``whole`` is the law that this one is a part of, over wider domains
    (:class:`duhem.law.formula_law.Criterion`).
    """

    name: str
    boundary: tuple[sp.Expr, sp.Expr]
    parameters: Mapping[str, Domain] = Domains()
    forces: tuple[str, ...] = FORCES
    pressure: str = PRESSURE
    angle: str = ANGLE
    constraints: tuple[Relational, ...] = ()
    flow: tuple[sp.Expr, sp.Expr] | None = None
    summary: str = ""
    source: str = ""
    instead: str = ""
    derivation: str = ""
    written: tuple[str, ...] = field(default=(), repr=False, compare=False)
    written_constraints: tuple[str, ...] = field(default=(), repr=False, compare=False)
    expect: Mapping[str, str] = field(default=FrozenMapping(), repr=False, compare=False)
    whole: ParametricCriterion | None = field(init=False, default=None, repr=False, compare=False)

    def __post_init__(self) -> None:
        self._set(forces=tuple(map(spelled, self.forces)), pressure=spelled(self.pressure), angle=spelled(self.angle))
        self._set(parameters=Domains(self.parameters), expect=FrozenMapping(self.expect))
        names = [*self.coordinates, self.angle, *self.parameters]
        if len(self.forces) != 2 or len(set(names)) < len(names) or not all(n.isidentifier() for n in names):
            what = "a boundary curve takes two forces and different names throughout"
            raise InputError(what, where=self.name, remedy="correct its names")
        known = self.symbols()
        boundary = listed(self.boundary, "boundary", self.name)
        flow = () if self.flow is None else listed(self.flow, "flow", self.name)
        self._set(boundary=tuple(self._in_angle(x, known, "boundary") for x in boundary))
        constraints, texts = relations(self.constraints, self.written_constraints, known, self.name)
        self._set(constraints=constraints, written_constraints=texts)
        if self.flow is not None:
            self._set(flow=tuple(self._in_angle(x, known, "flow") for x in flow))
        if any(len(pair) != 2 for pair in (self.boundary, self.flow or (0, 0))):
            raise InputError("boundary and flow have two components each", where=self.name, remedy="give one expression per force")
        parts = zip((*boundary, *flow), self.components(), chain(self.written, repeat("")), strict=False)
        self._set(written=tuple(text_of(given, expr, text, known, NONE) for given, expr, text in parts))

    def _in_angle(self, given: Any, known: Mapping[str, sp.Symbol], what: str) -> sp.Expr:
        expr = as_expression(given, known, f"{what} of {self.name}", NONE)
        inside = {known[self.angle], *(known[name] for name in self.parameters)}
        if stray := expr.free_symbols - inside:
            raise InputError(f"{what} uses {sorted(map(str, stray))}", where=self.name, remedy="use the angle and the parameters only")
        if not closes(expr, turn := known[self.angle]):
            what = f"{what} uses {turn} otherwise than as cos({turn}) and sin({turn})"
            raise InputError(what, where=self.name, remedy="expand multiples of the angle")
        return expr

    temperature: ClassVar[None] = None

    def components(self) -> tuple[sp.Expr, ...]:
        """Those of the boundary, then those of a flow."""
        return (*self.boundary, *(self.flow or ()))

    def symbols(self) -> dict[str, sp.Symbol]:
        """Every declared name with its symbol: forces, pressure, angle, parameters, in this order."""
        return declared_symbols((*self.coordinates, self.angle), self.pressure, self.parameters)

    @property
    def associated(self) -> bool:
        """Whether the slip is normal to the boundary by definition: no flow is stated."""
        return self.flow is None

    def derive(self) -> Any:
        """What ``derivation`` names, called: the derivation of the curve, where the law states one."""
        module, _, attribute = self.derivation.partition(":")
        return getattr(import_module(module), attribute)()

    def fix(self, values: Mapping[str, Any] | None) -> ParametricCriterion:
        """The same law with some parameters fixed; a value outside its domain is an InputError."""
        domains = Domains(self.parameters).fixed(values, self.name)
        swap, known = swapped(self.symbols(), domains)
        found = tuple(moved(x, text, swap, known) for x, text in zip(self.components(), self.written, strict=True))
        constraints, texts = moved_relations(self.constraints, self.written_constraints, swap, known)
        over: dict[str, Any] = {"parameters": domains, "constraints": constraints, "written_constraints": texts}
        return self._with_part(replace(self, boundary=found[:2], flow=found[2:] or None, **over))


def closes(expr: sp.Expr, angle: sp.Symbol) -> bool:
    """Whether the angle enters through its cosine and sine only, so that a curve in it closes."""
    return not expr.xreplace({sp.cos(angle): sp.S.One, sp.sin(angle): sp.S.One}).has(angle)


Law = Criterion | ParametricCriterion
