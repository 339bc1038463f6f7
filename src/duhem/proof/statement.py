"""The question a law poses: g over its forces, with N = |sigma_n| > 0 and the parameters ranging over their domain.

Every simplification here passes to a slice of the same law (a parameter set to 1, a force set to 0), chosen so that
the admissibility of the slice is equivalent to that of the whole.  A violation found in the slice is therefore a
violation of the law as written.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import zip_longest
from typing import Any, NamedTuple

import sympy as sp

from duhem.errors import InputError
from duhem.expression import symbol
from duhem.expression.angles import algebraic_angles
from duhem.expression.dimensions import removable
from duhem.expression.invariance import invariant_directions, shears_of_isotropic
from duhem.expression.parse import parse_as_written
from duhem.expression.text import faithful
from duhem.law.curve_law import Law
from duhem.law.domain import Domain
from duhem.law.formula_law import Criterion, YieldSurface
from duhem.proof.decide.question import evaluated, obligations

__all__ = ["Face", "Problem", "as_written", "faces", "parsed_as_written", "state", "texts", "with_algebraic_angles"]


class Face(NamedTuple):
    """A part of K's boundary with one rule for the slip: where ``g`` = 0 and every one of ``others`` is <= 0.

    There ``flow`` is in the cone of slips (Koiter 1953); None for the normality rule: what is normal to {g <= 0} is, as K lies in
    that.  A law of one surface has one face.
    """

    g: sp.Expr
    flow: tuple[sp.Expr, ...] | None
    others: tuple[sp.Expr, ...] = ()

    def each(self, change: Callable[[sp.Expr], sp.Expr]) -> Face:
        """The same with a change of every formula."""
        flow = None if self.flow is None else tuple(map(change, self.flow))
        return Face(change(self.g), flow, tuple(map(change, self.others)))


def _put(expr: sp.Expr, values: Mapping[sp.Symbol, Any]) -> sp.Expr:
    """In one walk where only whole powers stand: SymPy's own takes one for each symbol, on whose order the form of a root may depend."""
    whole = all(power.exp.is_Integer for power in expr.atoms(sp.Pow))
    return expr.xreplace(values) if whole else expr.subs(values)


@dataclass(frozen=True)
class Problem:
    """``g`` over ``forces`` and ``magnitude`` (N = |sigma_n| > 0, None without pressure); ``given`` bounds the rest.

    ``stated`` is the formula's tree as it was written: g is what it becomes where all of its parts are defined.
    ``stated_flows`` are, for each face, those of its flow and of the potential whose gradient that is.
    ``slice`` holds what the simplifications fixed: symbols of the law set to a number.  The slip is told by ``faces``, which cover
    the boundary.
    """

    law: Criterion
    stated: sp.Expr
    stated_flows: tuple[tuple[sp.Expr, ...], ...]
    g: sp.Expr
    forces: tuple[sp.Symbol, ...]
    magnitude: sp.Symbol | None
    given: tuple[sp.Basic, ...]
    faces: tuple[Face, ...]
    slice: Mapping[sp.Symbol, sp.Rational]

    @property
    def associated(self) -> bool:
        """Whether the slip is normal to the boundary by definition."""
        return all(face.flow is None for face in self.faces)

    @property
    def parameters(self) -> tuple[sp.Symbol, ...]:
        """The law's parameters that no slice fixes, in declaration order, then N."""
        table = self.law.symbols()
        own = [*(table[name] for name in self.law.parameters), *([] if self.magnitude is None else [self.magnitude])]
        return tuple(s for s in own if s not in self.slice)

    @property
    def compressed(self) -> dict[sp.Expr, sp.Expr]:
        """The law's pressure as -N."""
        return {} if self.magnitude is None or self.law.pressure is None else {self.law.symbols()[self.law.pressure]: -self.magnitude}

    def simplest(self) -> Problem:
        """An equivalent slice: outer monotone maps dropped, shears of isotropic laws, invariant forces and scaling parameters fixed."""
        g = without_outer_map(self.g)
        faces = (self.faces[0]._replace(g=g),) if len(self.faces) == 1 else self.faces
        plain = replace(self, g=g, faces=faces)
        return plain.principal().quotient().dimensionless() if plain.associated else plain

    def principal(self) -> Problem:
        """Shear components set to 0 where g does not change when the stress is turned (Davis 1957, Lewis 1996)."""
        shears = shears_of_isotropic(self.g, self.forces)
        return self if shears is None else _replaced(self, dict.fromkeys(shears, sp.S.Zero))

    def quotient(self) -> Problem:
        """Forces set to 0 along directions in which g does not change (hydrostatic pressure for J2-J3 laws)."""
        current = self
        while len(current.forces) > 1 and (directions := invariant_directions(current.g, current.forces)):
            pivot = next(x for x, v in zip(reversed(current.forces), reversed(directions[0]), strict=True) if v != 0)
            current = _replaced(current, {pivot: sp.S.Zero})
        return current

    def dimensionless(self) -> Problem:
        """Positive parameters set to 1 where a change of units absorbs them (Buckingham's pi theorem)."""
        candidates = [s for s in reversed(self.parameters) if s in self.g.free_symbols]
        ones = removable((self.g,), self.given, [s for s in dict.fromkeys(candidates) if s.is_positive])
        return _replaced(self, dict.fromkeys(ones, sp.S.One)) if ones else self


def _replaced(problem: Problem, values: Mapping[sp.Symbol, Any]) -> Problem:
    given = tuple(r for r in (c.subs(values) for c in problem.given) if r is not sp.true)
    faces = tuple(face.each(partial(_put, values=values)) for face in problem.faces)
    return replace(
        problem,
        g=faces[0].g if len(faces) == 1 else problem.g.subs(values),  # a maximum takes long to put values in
        forces=tuple(x for x in problem.forces if x not in values),
        given=given,
        faces=faces,
        slice={**problem.slice, **values},
    )


def state(law: Criterion) -> Problem:
    """The law's problem: fixed parameters in place, sigma_n replaced by -N."""
    table = law.symbols()
    fixed: dict[sp.Symbol, Any] = law.settled()
    magnitude = None
    swap: dict[sp.Symbol, Any] = dict(fixed)
    if law.pressure is not None:
        magnitude = symbol(f"abs({law.pressure})", positive=True)  # no name that a law may declare
        swap[table[law.pressure]] = -magnitude
    given = [r for x, domain in law.free().items() for r in domain.relations(x)] + [c.subs(fixed) for c in law.constraints]
    if magnitude is not None and (span := law.domain.get(law.pressure or "")) is not None:
        given += _compressed(span).relations(magnitude)
    values = {name: swap.get(x, x) for name, x in table.items()}
    parts = tuple(face.each(partial(_put, values=swap)).each(algebraic_angles) for face in faces(law))
    return Problem(
        law=law,
        stated=_trees(law, law, values)[0],
        stated_flows=((),) if law.associated else tuple(tuple(_trees(law, s, values)[1:]) for s in law.surfaces or (law,)),
        g=parts[0].g if len(parts) == 1 else algebraic_angles(_put(law.g, swap)),
        forces=law.force_symbols(),
        magnitude=magnitude,
        given=tuple(r for r in given if r not in (sp.true, True)),
        faces=parts,
        slice=law.fixed_values(),
    )


def _compressed(span: Domain) -> Domain:
    """A range of the pressure as one of its magnitude; that this is > 0 its symbol knows."""
    return Domain(None if span.high is None or span.high >= 0 else -span.high, None if span.low is None else -span.low)


def faces(law: Criterion) -> tuple[Face, ...]:
    """The whole boundary {g = 0}, or the share of each surface where one of them has a flow of its own, in the law's symbols."""
    if law.associated or not law.surfaces:
        return (Face(law.g, law.flow),)
    bounds = [surface.g for surface in law.surfaces]
    return tuple(Face(s.g, s.flow, (*bounds[:i], *bounds[i + 1 :])) for i, s in enumerate(law.surfaces))


def as_written(law: Criterion, surface: Criterion | YieldSurface | None = None) -> tuple[str, ...]:
    """The formula and the flow of the law, or of a surface: the texts that were given, else what the law's expressions are printed as."""
    stated = surface or law
    return tuple(texts(law, (stated.g, *(stated.flow or ())), (stated.written, *stated.written_flow)))


def texts(law: Law, expressions: Sequence[sp.Basic], written: Sequence[str]) -> list[str]:
    """The texts that were given for expressions of a law, else what these are printed as."""
    given = zip_longest(expressions, written[: len(expressions)], fillvalue="")
    return [text or faithful(expr, tuple(law.symbols().values())) for expr, text in given]


def _trees(law: Criterion, stated: Criterion | YieldSurface, values: Mapping[str, sp.Expr]) -> list[sp.Expr]:
    """Of g, of each component of the flow, and of the potential it comes from."""
    formulas = zip(as_written(law, stated), (stated.g, *(stated.flow or ())), strict=True)
    found = [parsed_as_written(law, expr, text, values) for text, expr in formulas]
    return [*found, *([] if stated.potential is None else [parse_as_written(stated.potential, values)])]


def parsed_as_written(law: Criterion, expr: sp.Expr, text: str, values: Mapping[str, sp.Expr]) -> sp.Expr:
    """The tree of a formula of the law as written, over the values of its names; of ``expr``, where it was given without a text."""
    try:
        (text,) = texts(law, (expr,), (text,))
        return with_algebraic_angles(parse_as_written(text, values))
    except InputError:  # a formula made by other means may be longer than a text may be
        return expr.xreplace({law.symbols()[name]: value for name, value in values.items()})


def with_algebraic_angles(tree: sp.Basic) -> sp.Basic:
    """The tree with waves of a polar angle as algebra, which continues them to where the quotient under atan has a pole."""
    if isinstance(tree, sp.cos | sp.sin) and [o.does for o in obligations(tree)] == ["divides by"]:
        wave = evaluated(tree)
        if (algebra := algebraic_angles(wave)) != wave:
            return algebra
    return tree.func(*map(with_algebraic_angles, tree.args), evaluate=False) if tree.has(sp.atan) else tree


def without_outer_map(g: sp.Expr) -> sp.Expr:
    """g without positive factors and odd powers, whose gradient is 0 with them, so that {g <= 0} stays the same set."""
    core = g
    if g.is_Mul:
        core = sp.Mul(*(f for f in g.args if not f.is_positive))
    elif g.is_Pow and g.exp.is_Integer and g.exp > 0 and g.exp % 2 == 1:
        core = g.base
    return g if core == g or not core.free_symbols else without_outer_map(core)
