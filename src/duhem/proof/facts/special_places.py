"""Places at which a formula certainly has no value, or no gradient."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

import sympy as sp

from duhem.expression import Norm, Where, defined_at
from duhem.expression.text import formula
from duhem.proof.decide import Question, Sense
from duhem.proof.decide.question import Obligation, obligations
from duhem.proof.facts.formula_subject import FormulaSubject

__all__ = ["SingularPlace", "limits_taken", "singular_places", "undefined_at_zero", "undefined_place"]

_MOST_PLACES, _LONGEST = 4, 300  # how many are looked at, and in how long a formula
_JUMPS = (sp.sign, sp.Heaviside, sp.DiracDelta, sp.Derivative, sp.Piecewise, Where, sp.Subs)
Place = Mapping[sp.Symbol, sp.Expr]


def undefined_place(subject: FormulaSubject, obligation: Obligation) -> str:
    """The hydrostatic axis or zero force, where what is divided by or under a logarithm is 0 there; else ""."""
    normal, shear = subject.problem.forces[:3], subject.problem.forces[3:]
    axis = dict.fromkeys(normal, sp.Dummy("p", nonzero=True, real=True)) | dict.fromkeys(shear, sp.S.Zero)
    if len(normal) == 3 and len(shear) in (0, 3) and _vanishes(obligation, axis):
        return f"where {' = '.join(map(str, normal))}" + "".join(f", {x} = 0" for x in shear)
    return "at zero force" if _vanishes(obligation, dict.fromkeys(subject.problem.forces, sp.S.Zero)) else ""


def limits_taken(subject: FormulaSubject) -> Iterator[str]:
    """That g, as written, has no value at zero force and what is proved is of the formula with its limit there."""
    if not subject.doubtful and (why := undefined_at_zero(subject)):
        yield f"{why}; duhem uses the limit of g there, and K is closed"


def undefined_at_zero(subject: FormulaSubject) -> str:
    """That g has no value at zero force, and why; "" where it has one, or where that is not seen."""
    zero = dict.fromkeys(subject.problem.forces, sp.S.Zero)
    part = next((o for o in (*subject.doubtful, *obligations(subject.problem.stated)) if _vanishes(o, zero)), None)
    return "" if part is None else f"g has no value at zero force: it {part.does} {formula(part.expr)}, which is 0 there"


def _vanishes(obligation: Obligation, place: dict[sp.Symbol, sp.Expr]) -> bool:
    """Whether it asks that something is not 0 which is 0 at a place, for all parameters."""
    here = obligation.put(place)
    if here.sense is Sense.NONNEGATIVE or here.instead or any(r != sp.true for r in here.given):
        return False
    return sp.simplify(here.expr) == 0


class SingularPlace(NamedTuple):
    """A value for each force, in which others may stand; ``inside`` where g < 0 there for all parameters and pressures."""

    forces: Place
    inside: bool


def singular_places(subject: FormulaSubject) -> tuple[SingularPlace, ...]:
    """Those that are found, and are not certainly outside K: the slopes of g along a line are not the same on either side.

    A norm or a root is looked at where it is 0, at zero force or where linear forms of the forces vanish.  From such a place g is
    taken along a line, forward and backward; there both are formulas in one variable s > 0, and where their derivatives have
    values at s = 0 those are the one-sided slopes.  A differentiable g would have two slopes whose sum is 0.
    """
    g = subject.problem.g
    if subject.doubtful or g.count_ops() > _LONGEST:
        return ()
    found = list[SingularPlace]()
    for place in _suspects(subject):
        here = defined_at(g, place)
        if here is None or any(_holds(place, known.forces) for known in found) or not _bends(subject, place, here):
            continue
        if not _decided(subject, here, Sense.POSITIVE):
            found.append(SingularPlace(place, not g.has(Where) and _decided(subject, -here, Sense.POSITIVE)))
    return tuple(found)


def _suspects(subject: FormulaSubject) -> Iterator[Place]:
    """Zero force last: it is among the others where these are more than points."""
    g, forces = subject.problem.g, subject.problem.forces
    rooted = [node for node in g.atoms(Norm, sp.Pow) if node.free_symbols & set(forces) and not (node.is_Pow and node.exp.is_Integer)]
    if not rooted:
        return
    places = dict.fromkeys(point for node in sorted(rooted, key=sp.default_sort_key) for point in _zeros(node, forces))
    zero = (sp.S.Zero,) * len(forces)
    for point in [*[p for p in places if p != zero][:_MOST_PLACES], zero]:
        yield dict(zip(forces, point, strict=True))


def _zeros(node: sp.Expr, forces: Sequence[sp.Symbol]) -> Iterator[tuple[sp.Expr, ...]]:
    """Where the parts of a norm are 0, or the slopes of a quadratic form under a root, and it is 0 itself."""
    base = node.args[0]
    if isinstance(node, Norm):
        forms = node.args
    elif base.is_polynomial(*forces) and sp.Poly(base, *forces).total_degree() == 2:
        forms = tuple(sp.diff(base, x) for x in forces)
    else:
        return
    if not all(form.is_polynomial(*forces) and sp.Poly(form, *forces).total_degree() <= 1 for form in forms):
        return
    for point in sp.linsolve([sp.expand(form) for form in forms], *forces):
        value = defined_at(base if node.is_Pow else node, dict(zip(forces, point, strict=True)))
        if value is not None and sp.expand(value) == 0:
            yield tuple(point)


def _holds(place: Place, wider: Place) -> bool:
    """Whether a place is one of those of a wider one: in it the free forces of that are put in."""
    return all(sp.expand(value.xreplace(dict(place)) - place[x]) == 0 for x, value in wider.items())


def _bends(subject: FormulaSubject, place: Place, here: sp.Expr) -> bool:
    """Whether the slopes forward and backward along some line are shown to have a sum other than 0."""
    slopes = ([_slope(subject.problem.g, place, [side * w for w in way], here) for side in (1, -1)] for way in _ways(len(place)))
    return any(None not in pair and _decided(subject, sp.expand(sp.Add(*pair)) ** 2, Sense.POSITIVE) for pair in slopes)


def _ways(n: int) -> list[list[int]]:
    """An axis, along which the formulas are short, and a direction that few kinks are parallel to."""
    return [[int(i == 0) for i in range(n)], [(-1) ** i * (2 * i + 1) for i in range(n)]]


def _slope(g: sp.Expr, place: Place, way: Sequence[int], here: sp.Expr) -> sp.Expr | None:
    """The slope of g along a way from a place; None where it is not found."""
    s = sp.Dummy("s", positive=True)
    along = defined_at(g, {x: value + w * s for (x, value), w in zip(place.items(), way, strict=True)})
    if along is None:
        return None
    along = _rooted(along, s)
    start = defined_at(along, {s: sp.S.Zero})
    if start is None or sp.expand(start - here) != 0:
        return None
    rate = sp.diff(along, s)
    if any(node.has(s) for node in rate.atoms(*_JUMPS)):
        return None  # it may jump at s = 0
    return defined_at(rate, {s: sp.S.Zero})


def _rooted(expr: sp.Basic, s: sp.Symbol) -> sp.Expr:
    """The formula with powers of s > 0 drawn out of norms and roots."""
    if not expr.has(s) or not expr.args:
        return expr
    if isinstance(expr, Norm):
        expr = expr.rewrite(sp.Pow)
    parts = [_rooted(part, s) for part in expr.args]
    if expr.is_Pow and not parts[1].is_Integer and not parts[1].has(s) and parts[0].is_polynomial(s):
        least = min(m for (m,), _ in sp.Poly(parts[0], s).terms())
        rest = sp.factor_terms(sp.expand(sp.expand(parts[0]) / s**least))
        return s ** (least * parts[1]) * rest ** parts[1]
    return expr.func(*parts)


def _decided(subject: FormulaSubject, expr: sp.Expr, sense: Sense) -> bool:
    """Whether it is so for every parameter value and pressure, and for all values of forces in it."""
    return subject.decided(Question(expr, sense, subject.problem.given)).holds is True
