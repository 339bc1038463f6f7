"""What is said beside the verdicts: what each ranges over, which parts a law does not need, what is odd about it.

Odd are sets that are hardly what was meant: nothing, everything, one point, no inside, no end.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import chain, product
from random import Random
from typing import Any

import flint
import sympy as sp

from duhem.expression import UNDEFINED, Norm, Where, defined_at
from duhem.expression.ball_series import compiled, derivatives
from duhem.expression.balls import ball, certain_sign, enclose
from duhem.expression.elementary import ELEMENTARY
from duhem.expression.text import formula
from duhem.law.curve_law import Law
from duhem.law.formula_law import Criterion
from duhem.omitted import LeftOut
from duhem.proof.certificate import law_as_text
from duhem.proof.decide import Question, Sense
from duhem.proof.facts.formula_subject import FormulaSubject, RateSubject
from duhem.proof.facts.special_places import limits_taken, singular_places, undefined_place
from duhem.proof.facts.subject import Subject
from duhem.proof.kernel.state import convex_in_each_variable
from duhem.proof.kernel.stated_law import StatedLaw
from duhem.proof.kernel.steps import TooDearError, within
from duhem.proof.kernel.term import NotWritten
from duhem.proof.statement import as_written
from duhem.proof.verdict import Evidence, Verdict

__all__ = ["Extent", "extent", "not_needed", "remarks", "scope"]

_CONTINUED = "Where g is 0/0 and has a limit, duhem uses this limit, because K is closed. "
_NOT_SHOWN_OF_THE_FLOW = "duhem could not show that the flow has a value on the whole boundary"
_STEPS = 8_000_000  # for what is asked here and in no claim
_NEAR, _FAR = Fraction(1, 2**20), Fraction(2**40)
_MOST_FORCES = 3  # of the directions along which it looks there are 3^n
_MOST_RAYS = 4
_POINTS, _SCALES = 6, (Fraction(1, 4), Fraction(1), Fraction(4))  # of gradients, for each force, at each scale
_ANALYTIC = {word.node for word in ELEMENTARY.values() if word.analytic}
Row = list[Any]


def scope(law: Law, verdict: Verdict) -> str:
    """The parameters, and ranges of pressure and forces, over which a verdict holds."""
    if verdict is Verdict.REFUTED:
        return "at the witness"
    if verdict is Verdict.TESTED:
        return "sampled parameters"
    fixed = [f"{n} = {d.value}" for n, d in law.parameters.items() if d.value is not None]
    ranges = [d.stated(n) for n, d in law.domain.items()] if isinstance(law, Criterion) else []
    every = [] if fixed and len(fixed) == len(law.parameters) else ["all other parameters" if fixed else "all parameters"]
    return ", ".join([*every, *fixed, *ranges])


def not_needed(law: Law, verdicts: Iterable[Verdict]) -> Iterator[LeftOut]:
    """Parts of the examination that this law, or what was decided of it, makes needless."""
    if law.temperature is None:
        yield LeftOut("thermal", "the law is isothermal: it has no temperature, so thermal dissipation and entropy do not enter")
    elif isinstance(law, Criterion) and not law.heat:
        yield LeftOut("thermal", "the law has no [heat]: no body exchanges heat with it, so there is no thermal dissipation")
    if law.associated:
        yield LeftOut("flow check", "the law is associated: the normality rule defines its slip")
    if isinstance(law, Criterion) and law.forces_of_rates:
        yield LeftOut("K", "the forces are functions of the rates, so nothing is asked about a set of admissible forces")
        return
    if law.pressure is None:
        yield LeftOut("pressure", "the law has no pressure, so K is a single set")
    if len(law.forces) == 1:
        yield LeftOut("seams", "the law has one force, so the boundary has no seam (a line where the formula of g changes)")
    found = set(verdicts)
    if Verdict.PROVED in found and found <= {Verdict.PROVED, Verdict.NOT_APPLICABLE}:
        yield LeftOut("numerical search", "every examined claim has a proof, so no verdict rests on samples")


def remarks(subject: Subject, settled: Mapping[str, Evidence]) -> tuple[tuple[str, ...], bool]:
    """What a reader should know first: what is odd about the law, and what holds of it with an exception.

    And whether K has no boundary point but 0, so that nothing is said when nothing is found to dissipate less than 0.
    """
    if not isinstance(subject, FormulaSubject):
        return (), False
    of_state = tuple(_of_state(subject.of, settled))
    if subject.law.viscous or isinstance(subject, RateSubject):
        return of_state, False
    if not subject.law.around_zero:  # what is odd is said of all of K
        return (*of_state, *_singular(subject)), False
    subject.allow(_STEPS)
    odd = extent(subject)
    return (*_oddities(subject, odd, settled), *of_state, *_singular(subject)), odd is not None and not odd.boundary


def _of_state(law: Criterion, settled: Mapping[str, Evidence]) -> Iterator[str]:
    """Which variables the claims about K hold frozen, which have no force, and whether an energy that is not convex is so in each alone."""
    used = _in_criterion_and_flow(law)
    if frozen := [name for name in law.variables if law.symbols()[name] in used]:
        about, part = ("Phi*", "it") if law.viscous else ("K and the flow", "g or the flow")
        about, part = ("the forces", "their functions") if law.forces_of_rates else (about, part)
        yield f"The claims about {about} hold at every frozen value of {', '.join(frozen)}, on which {part} depends"
    if unforced := [name for name, own in law.variables.items() if own.internal and own.force is None]:  # such as wear
        yield f"Normality says nothing of the variables without a force: {', '.join(unforced)}"
    refuted = "state_laws" in settled and settled["state_laws"].verdict is Verdict.REFUTED
    with suppress(NotWritten, OverflowError, RecursionError, TooDearError), within(_STEPS):
        if refuted and convex_in_each_variable(StatedLaw.read(law_as_text(law))):
            each = "each variable" if law.temperature is None else "each variable but the temperature"
            yield f"psi is separately convex: in {each} alone, at every value of the others"


def _in_criterion_and_flow(law: Criterion) -> set[sp.Basic]:
    """The symbols of g and of every flow of the law's own."""
    flows = (law.flow, *(surface.flow for surface in law.surfaces))
    return law.g.free_symbols.union(*(c.free_symbols for flow in flows for c in flow or ()))


def _oddities(subject: FormulaSubject, odd: Extent | None, settled: Mapping[str, Evidence]) -> Iterator[str]:
    law = subject.law
    proved = any(evidence.verdict is Verdict.PROVED for claim, evidence in settled.items() if claim != "state_laws")
    if subject.doubtful:
        places = ((doubt, place) for doubt in subject.doubtful if (place := undefined_place(subject, doubt)))
        first, place = next(places, (subject.doubtful[0], ""))
        yield (
            f"duhem could not show that g has a value for all forces: it {first.does} {formula(_stated(subject, first.expr))}. "
            + (f"g has no value {place}. " if place else "")
            + (_CONTINUED if proved else "A point where g has no value does not belong to K. ")
            + "For such a formula, duhem reports only proofs that the kernel confirms"
        )
    elif subject.doubtful_flow:
        broken = next(((o, at) for o in subject.doubtful_flow if (at := subject.broken_at(o)) is not None), None)
        first = broken[0] if broken else subject.doubtful_flow[0]
        part = formula(_stated(subject, first.expr))
        has = f"The flow has no value at {_admitted(subject, broken[1])}" if broken else _NOT_SHOWN_OF_THE_FLOW
        yield f"{has}: it {first.does} {part}. For such a flow, duhem reports only proofs that the kernel confirms"
    if proved:
        yield from limits_taken(subject)
    if odd is not None:
        yield odd.what
    elsewhere = (*law.rates.values(), *law.heat.values(), *([] if law.energy is None else [law.energy]))
    used = _in_criterion_and_flow(law).union(*(x.free_symbols for x in elsewhere))
    used |= {law.symbols()[name] for name in (*law.variables, *law.heat)}
    if unused := [name for name, x in law.symbols().items() if x not in used]:
        yield f"g does not depend on {', '.join(unused)}"


def _singular(subject: FormulaSubject) -> Iterator[str]:
    """Where g is not differentiable, and that K's boundary does not touch the place if that is so."""
    pressure = subject.law.pressure
    for place in singular_places(subject):
        where = ", ".join(f"{x} = {formula(_stated(subject, value))}" for x, value in place.forces.items() if value != x)
        points = "those points are" if any(value.free_symbols & set(place.forces) for value in place.forces.values()) else "that point is"
        inside = f"; {points} inside K{f' for {pressure} < 0' if pressure else ''}, so the boundary is not touched" if place.inside else ""
        yield f"g is not differentiable at {where if any(place.forces.values()) else 'zero force'}{inside}"


def _admitted(subject: FormulaSubject, values: Mapping[sp.Symbol, sp.Rational]) -> str:
    """Values of parameters and of the size of the pressure, in the law's own names."""
    magnitude, pressure = subject.problem.magnitude, subject.law.pressure
    return ", ".join(f"{pressure} = {-v}" if x is magnitude else f"{x} = {v}" for x, v in values.items())


def _stated(subject: FormulaSubject, expr: sp.Expr) -> sp.Expr:
    """An expression of the problem in the law's own names."""
    magnitude, pressure = subject.problem.magnitude, subject.law.pressure
    return expr if magnitude is None or pressure is None else expr.xreplace({magnitude: sp.Abs(sp.Symbol(pressure, real=True))})


# -- sets that are hardly what was meant -----------------------------------------------------------------------------
# They are told of K alone, whatever the flow: a law with a flow of its own is looked at as the associated law with the same g.


@dataclass(frozen=True)
class Extent:
    """``what`` K is for every parameter value and pressure; ``boundary`` False where it has no boundary point but 0."""

    what: str
    boundary: bool


def extent(subject: FormulaSubject) -> Extent | None:
    """What is out of the ordinary about K, suspected at a few points and proved; None where nothing is, or nothing is shown."""
    if subject.doubtful:
        return None
    if not subject.law.associated:  # the same K, and perhaps a simpler problem
        subject = FormulaSubject(without_flow(subject.law), subject.effort)
        subject.allow(_STEPS)
    problem, forces, here = subject.simple, subject.simple.forces, subject.at_origin
    if here is None:
        return None
    away = sp.StrictGreaterThan(sp.Add(*(x**2 for x in forces)), 0)
    signs = _Signs(subject)
    if signs.all({1}, _NEAR, Fraction(1), _FAR) and subject.ask(problem.g, Sense.POSITIVE, away).holds is True:
        if subject.positive(here):
            return Extent(f"K is empty: g > 0 for all forces{_cause(subject)}", False)
        return _subspace(subject) if subject.nonnegative(-here) else None
    if signs.all({0, -1}, _FAR, Fraction(1), _NEAR) and subject.ask(-problem.g, Sense.NONNEGATIVE).holds is True:
        return Extent("K contains all forces: g <= 0 everywhere", False)
    if signs.all({0, 1}, Fraction(0), _NEAR, Fraction(1), _FAR) and subject.ask(problem.g, Sense.NONNEGATIVE).holds is True:
        # g is 0 in all of K, which is another thing than no inside: max(0, f) is 0 wherever f <= 0
        thin = Extent("K has no interior points: g >= 0 for all forces, and g = 0 in K", True)
        return thin if zeros_are_thin(problem.g, subject) else None
    return _unbounded(subject, here, signs)


def without_flow(law: Criterion) -> Criterion:
    """The associated law with the same g."""
    surfaces = tuple(replace(s, flow=None, potential=None, written_flow=()) for s in law.surfaces)
    return replace(law, flow=None, potential=None, written_flow=(), surfaces=surfaces, unforced={}, written_unforced={})


class _Signs:
    """Signs of g at one parameter choice: at zero force, near it and far away, along axes and diagonals; each found when asked for."""

    def __init__(self, subject: FormulaSubject) -> None:
        d = len(subject.simple.forces)
        axes = [tuple(s * (i == k) for i in range(d)) for k in range(d) for s in (1, -1)]
        self.ways = axes if d > _MOST_FORCES else [way for way in product((0, 1, -1), repeat=d) if any(way)]
        self._subject, self._known = subject, dict[tuple[Fraction, ...], int | None]()
        self._parameters = next(subject.choices(1), None)

    def at(self, reach: Fraction, way: tuple[int, ...]) -> int | None:
        """The sign at so far a point in that direction; None where it is not certain."""
        if self._parameters is None:
            return None
        if (point := tuple(reach * w for w in way)) not in self._known:
            here = self._subject.values_at(self._parameters, point)
            self._known[point] = certain_sign(enclose(self._subject.problem.stated, {x: ball(v) for x, v in here.items()}))
        return self._known[point]

    def all(self, wanted: set[int], *reaches: Fraction) -> bool:
        """Whether every point looked at has such a sign."""
        return self._parameters is None or all(self.at(r, way) in wanted for r in reaches for way in self.ways)


def _subspace(subject: FormulaSubject) -> Extent:
    """K where g > 0 in all of the simple problem's forces but 0: what the problem is a slice of is flat."""
    if not (d := flat_directions(subject)):
        return Extent("K is the point 0: g > 0 elsewhere", False)
    shape = "a line" if d == 1 else f"a space of {d} dimensions"
    return Extent(f"K is {shape} without interior points: g > 0 elsewhere", True)


def _cause(subject: FormulaSubject) -> str:
    """The likely reason: a pressure taken for positive."""
    law = subject.law
    if law.pressure is None or subject.problem.magnitude is None or f"abs({law.pressure})" in as_written(law)[0].replace(" ", ""):
        return ""
    turned = law.g.xreplace({law.symbols()[law.pressure]: subject.problem.magnitude, **law.settled()})
    there = turned.xreplace(dict.fromkeys(law.force_symbols(), sp.S.Zero))
    if there.has(*UNDEFINED) or not subject.nonnegative(-there.xreplace(dict(subject.simple.slice))):
        return ""
    return f" ({law.pressure} <= 0 in compression: write abs({law.pressure}))"


def _unbounded(subject: FormulaSubject, here: sp.Expr, signs: _Signs) -> Extent | None:
    """Along forces that the simple problem has set to 0, or all the way in one of the directions."""
    if (d := flat_directions(subject)) and subject.nonnegative(-here):
        count = f"{'' if all_directions_found(subject) else 'at least '}{d} direction{'s' * (d > 1)}"
        return Extent(f"K is unbounded: g does not change along {count} of the forces", True)
    for way in [way for way in signs.ways if signs.at(_FAR, way) in (-1, 0)][:_MOST_RAYS]:
        if _inside_along(subject, way):
            along = dict(zip(subject.simple.forces, way, strict=True))
            ray = ", ".join(f"{x} = {'-' * (w < 0)}t" if (w := along.get(x, 0)) else f"{x} = 0" for x in subject.problem.forces)
            return Extent(f"K is unbounded: g <= 0 at {ray} for all t > 0", True)
    return None


def _inside_along(subject: FormulaSubject, way: Sequence[int]) -> bool:
    """Whether g <= 0 all along a ray, for the parameters as they are: a change of units would turn it."""
    t, problem = sp.Dummy("t", positive=True), subject.problem.principal().quotient()
    g = problem.g.xreplace({x: w * t for x, w in zip(subject.simple.forces, way, strict=True)})
    return not g.has(*UNDEFINED) and subject.decided(Question(-g, Sense.NONNEGATIVE, problem.given)).holds is True


def flat_directions(subject: FormulaSubject) -> int:
    """How many independent ones are found, for every parameter value and pressure; the law has no flow of its own.

    Of a law that is isotropic in six components the simple problem has the principal stresses: one direction among them is the
    pressure's, and two are all deviators, of which there are five in six components.
    """
    problem = subject.problem.principal()
    found = len(problem.forces) - len(subject.simple.forces)
    return {0: 0, 1: 1, 2: 5}[found] if len(problem.forces) < len(subject.problem.forces) else found


def all_directions_found(subject: FormulaSubject) -> bool:
    """Whether the gradients of the simple problem's g span its forces, at one choice of the parameters: then no direction is flat in it."""
    forces, values = subject.simple.forces, next(subject.choices(1), None)
    if values is None:
        return False
    known = {x: ball(v) for x, v in subject.values_at(values, subject.nowhere).items()}
    names = [*forces, *(x for x in known if x not in forces)]
    run, rng, rows = compiled([subject.simple.g], names), Random(5), list[Row]()
    for scale in _SCALES:
        for _ in range(_POINTS * len(forces)):
            point = [scale * Fraction(rng.randint(-999, 999), 500) for _ in forces]
            rows.append([_slope(run, [ball(v) for v in point], i, [known[x] for x in names[len(forces) :]]) for i in range(len(forces))])
    known_slopes = [row for row in rows if all(x.is_finite() for x in row)]
    slopes = flint.arb_mat(known_slopes or [[ball(Fraction(0)) for _ in forces]])  # the determinant of no rows would be 1
    return certain_sign((slopes.transpose() * slopes).det()) == 1


def _slope(run: Any, point: Row, i: int, others: Row) -> Any:
    """The derivative of g by one of the forces."""
    moved = [flint.arb_series([x, 1], prec=2) if k == i else x for k, x in enumerate(point)]
    return derivatives(run(*moved, *others)[0], 1)[1]


def zeros_are_thin(expr: sp.Expr, subject: FormulaSubject) -> bool:
    """Whether no ball of the simple problem's forces consists of zeros, whatever the parameters and the pressure (False if open).

    An analytic function that is not 0 somewhere is 0 in no ball (the identity theorem).  Zeros of a product, a choice or a maximum
    are among those of its parts; of a norm, and of a sum of terms >= 0, they are zeros of every part, so that one with thin zeros
    is enough.
    """
    forces = set(subject.simple.forces)
    if not expr.free_symbols & forces:
        return subject.positive(expr**2)
    if _analytic(expr, subject) and _somewhere_not_zero(expr, subject):
        return True
    if isinstance(expr, sp.Abs) or (expr.is_Pow and not expr.exp.free_symbols & forces and subject.positive(expr.exp)):
        return zeros_are_thin(expr.args[0], subject)
    if isinstance(expr, sp.Mul | sp.Max | sp.Min | Where):
        return all(zeros_are_thin(part, subject) for part in expr.args[isinstance(expr, Where) :])
    together = isinstance(expr, Norm) or (expr.is_Add and all(subject.ask(x, Sense.NONNEGATIVE).holds is True for x in expr.args))
    return together and any(zeros_are_thin(part, subject) for part in expr.args)


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
    return (expr.is_Add or expr.is_Mul or type(expr) in _ANALYTIC) and all(_analytic(part, subject) for part in expr.args)


def _somewhere_not_zero(expr: sp.Expr, subject: FormulaSubject) -> bool:
    """Whether at one point it is 0 for no parameter value and no pressure."""
    forces = subject.simple.forces
    axes = ([sp.Integer(i == k) for i in range(len(forces))] for k in range(len(forces)))
    points = chain([[sp.S.Zero] * len(forces)], axes, [[sp.Integer(3 * i + 2) for i in range(len(forces))]])
    values = (defined_at(expr, dict(zip(forces, point, strict=True))) for point in points)
    return any(value is not None and subject.positive(value**2) for value in values)
