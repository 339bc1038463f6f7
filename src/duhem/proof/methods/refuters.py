"""Refuters: a place that a search suggests counts where an exact check confirms a violation; and last, what was tried in vain.

The origin outside K; a chord of K whose midpoint is outside; a corner, or a point to which K narrows; a slip that is not normal
to K, or does not dissipate.  For an associated law the flow is the normality rule itself (Moreau 1970; Antoni et al. 2007,
Eqs. 28, 36): it lies in the normal cone of K exactly when K is convex there.
"""

from __future__ import annotations

import itertools
import math
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from fractions import Fraction
from typing import TYPE_CHECKING

import sympy as sp

from duhem.expression.abbreviations import names_in
from duhem.expression.number import DECIMAL, fraction, rational
from duhem.law.domain import POSITIVE
from duhem.law.formula_law import Criterion
from duhem.proof.facts.formula_subject import FormulaSubject, RateSubject
from duhem.proof.facts.graph_subject import GraphSubject
from duhem.proof.facts.plane_section import PlaneSection
from duhem.proof.facts.special_places import undefined_at_zero
from duhem.proof.facts.subject import Point, Subject, Values
from duhem.proof.in_state import Spent, epigraph, heat_in_states, spent_by_rates, spent_in_states, two_forces
from duhem.proof.verdict import Evidence, Verdict, Witness
from duhem.proof.witness.corners import corner, sharp_point
from duhem.proof.witness.points import (
    EnclosedPoint,
    chord,
    enclosed,
    enclosed_flow,
    enclosed_normal,
    less_than_0,
    of_energy,
    origin_outside,
    over_box,
    rounded,
    two_forces_at,
    violation,
    with_variables,
)

if TYPE_CHECKING:
    from duhem.proof.search.boundary_points import BoundaryScout, Chord, Exit
    from duhem.proof.search.corners import SectionCorner

__all__ = [
    "convexity_at_clear_dents", "convexity_at_deepest_dents", "convexity_at_dents", "convexity_at_far_points", "convexity_at_seams",
    "convexity_beside_edges", "convexity_between_exact_rays", "convexity_by_sampling", "convexity_by_scouting",
    "convexity_by_thorough_scouting", "convexity_of_graph", "convexity_of_graph_left_open", "dissipation_at_points",
    "dissipation_by_sampling", "dissipation_in_states", "dissipation_of_rates", "duality_of_graph_left_out", "energy_at_bends",
    "energy_in_temperature", "energy_of_two_forces", "heat_uphill", "normality_at_chord", "normality_at_points", "normality_by_sampling",
    "normality_of_rates", "origin_at_parameters", "origin_of_graph", "origin_out_of_range", "origin_undefined", "smoothness_at_corners",
    "smoothness_at_sharp_points", "smoothness_at_switches", "without_k",
]  # fmt: skip

_PLAIN = 2  # choices of the parameters that are plain
_NO_POINT = "a chord leaves K, so K is not convex, but no boundary point was confirmed where grad g leaves the normal cone of K"
_CHORD = (
    "the way from `inside` to the midpoint of a chord of K crosses the boundary outward, at a sigma between `inside` and `outside`, "
    "so grad g . (tau - sigma) > 0 there for one end tau of the chord: the normal is not in the normal cone of K"
)
_NORMALITY = "the flow at the boundary point between `inside` and `outside` points towards tau, a point of K: it is not in the normal cone"
_SAGS = "psi is not convex: between the states p and q it lies above the chord from one to the other, whose ends are at the heights z"
_HEATED = "psi is not concave in the temperature: between the states p and q it lies below the chord from one to the other"
_HEIGHTS = "psi <= z at both ends p and q, yet psi > z at their midpoint, z included: psi is not convex in its variables together"
_HEATS = "-psi <= z at both ends p and q, yet -psi > z at their midpoint, z included: psi is not concave in the temperature"
_RATES = "in this state, which lies in K, the sum of Y . rate over the rates that act there without a multiplier is < 0"
_TWO_FORCES = "the sum of both derivatives must be 0, for the force is +dpsi/du of the observable and -dpsi/du_in of its slip"
_NEGATIVE = "at these rates the sum of force . rate is < 0"
_FALLS = "a convex potential of the rates has a gradient for which this is >= 0 at any two rates; here it is < 0"
_MOST_ENERGIES = 200
_UPHILL = "the sum of h_k (T_k - T)^2/T_k over the bodies is < 0 at these temperatures, which are > 0"
_MOST_STATES = 20_000
_FLOW_OF_STATE = "in this state g = 0, and the sum of Y . rate for a unit of the multiplier is < 0"
_STEPS = 8_000_000
_SAMPLING = 4_000_000  # steps after every proof has failed
_DISSIPATION = "force . flow < 0 at the boundary point between `inside` and `outside`"


def _of_k(subject: FormulaSubject, detail: str) -> str:
    """Return the detail; for a law without a K of its own it says which set K is."""
    return f"with K = {{Phi* <= {subject.law.forces[-1]}}}: {detail}" if subject.of.viscous else detail


# -- the origin -------------------------------------------------------------------------------------------------------


def origin_at_parameters(subject: FormulaSubject) -> Evidence | None:
    """Refute by parameters at which g(0) > 0."""
    from duhem.proof.search.margins import highest_at_zero

    found = (origin_outside(subject, parameters) for parameters in subject.choices(40, highest_at_zero(subject)))
    return Evidence.refuted_by(found, "witness-point", _of_k(subject, "zero force is outside K"))


def origin_out_of_range(subject: Subject) -> Evidence | None:
    """Answer that the claim does not apply where the ranges of the forces leave out zero force."""
    if not isinstance(subject.law, Criterion) or subject.law.around_zero:
        return None
    return Evidence(Verdict.NOT_APPLICABLE, "none", "zero force is outside the ranges of the forces in which the claims are asked")


def origin_undefined(subject: FormulaSubject) -> Evidence | None:
    """Say that the claim stays open because g has no value at zero force."""
    said = undefined_at_zero(subject)
    return Evidence(Verdict.UNDECIDED, "none", said) if said else None


# -- chords -----------------------------------------------------------------------------------------------------------
# Searches with floats in them are imported only when something is looked for: numpy comes with them.


def _refuted(subject: FormulaSubject, suggested: Iterable[Chord], touching: bool = False) -> Evidence | None:
    """Refute by the first suggested chord that passes the exact check."""
    found = (chord(subject, *one, touching) for one in suggested)
    return Evidence.refuted_by(found, "witness-chord", _of_k(subject, "a chord between two points of K leaves K"))


def convexity_by_scouting(subject: FormulaSubject, choices: int = 6, steps: int | None = None) -> Evidence | None:
    """Try sampled chords at a few choices of the parameters."""
    from duhem.proof.search.long_chords import sampled_chords

    return _refuted(subject, sampled_chords(subject, choices, steps))


def convexity_by_thorough_scouting(subject: FormulaSubject) -> Evidence | None:
    """Try chords where walks downhill end, and sampled ones at many choices of the parameters: no rule has proved the claim by then."""
    from duhem.proof.search.long_chords import chords_downhill

    found = _refuted(subject, chords_downhill(subject))
    return found or convexity_by_scouting(subject, 60, int(_SAMPLING * subject.effort))


def convexity_at_far_points(subject: FormulaSubject) -> Evidence | None:
    """Try chords from the point where a ball in a maximum lies farthest along a load."""
    from duhem.proof.search.long_chords import chords_from_far_points

    return _refuted(subject, chords_from_far_points(subject), touching=True)


def convexity_between_exact_rays(subject: FormulaSubject) -> Evidence | None:
    """Try chords between points of faces, edges or whiskers of K that no sample meets."""
    from duhem.proof.search.long_chords import chords_between_exact_rays

    return _refuted(subject, chords_between_exact_rays(subject))


def convexity_beside_edges(subject: FormulaSubject) -> Evidence | None:
    """Try chords beside an edge where g rises a little less than in proportion, as powers a little below 1 do."""
    from duhem.proof.search.precise_chords import chords_beside_edges

    return _refuted(subject, chords_beside_edges(subject))


def convexity_at_clear_dents(subject: FormulaSubject, thorough: bool = False) -> Evidence | None:
    """Try chords where the boundary of a polynomial law bends outward in one of many directions."""
    from duhem.proof.search.dents import chords_across_dents

    return _refuted(subject, chords_across_dents(subject, 24, thorough))


def convexity_at_deepest_dents(subject: FormulaSubject) -> Evidence | None:
    """Try chords where the boundary of a polynomial law bends outward most, however little."""
    return convexity_at_clear_dents(subject, thorough=True)


def convexity_at_dents(subject: FormulaSubject) -> Evidence | None:
    """Try chords where the boundary of any law bends outward most, between its kinks."""
    from duhem.proof.search.dents import chords_across_smooth_dents

    return _refuted(subject, chords_across_smooth_dents(subject))


def convexity_at_seams(subject: FormulaSubject) -> Evidence | None:
    """Try chords across a seam at which the boundary has a kink inward (two forces)."""
    if len(subject.simple.forces) != 2 or subject.pieces is None or len(subject.pieces) < 2:
        return None
    from duhem.proof.search.precise_chords import kink_chords

    return _refuted(subject, kink_chords(subject))


def energy_at_bends(subject: FormulaSubject) -> Evidence | None:
    """Try chords of the epigraph of an energy along a direction in which its second derivative is < 0."""
    return None if subject.of.energy is None else _bent(subject, subject, "psi", _SAGS, _HEIGHTS)


def energy_in_temperature(subject: FormulaSubject) -> Evidence | None:
    """Try chords of the epigraph of -psi along the temperature where the second derivative of psi by it is > 0."""
    if (heated := epigraph(subject.of, of_heat=True)) is None:
        return None
    along = FormulaSubject(heated, subject.effort, of=subject.of)
    along.allow(_STEPS)
    return _bent(subject, along, "-psi", _HEATED, _HEATS)


def _bent(subject: FormulaSubject, along: FormulaSubject, name: str, detail: str, statement: str) -> Evidence | None:
    """Refute by the first chord of an epigraph that passes the exact check."""
    from duhem.proof.search.plain_states import chords_across_bends

    found = (of_energy(subject, one, name, statement) for ends in chords_across_bends(along) if (one := chord(along, *ends)) is not None)
    return Evidence.refuted_by(found, "witness-state", detail)


def energy_of_two_forces(subject: FormulaSubject, choices: int = 12) -> Evidence | None:
    """Refute by a state at which the derivatives of an energy by an observable and by its slip are two different forces."""
    law, gaps = subject.of, two_forces(subject.of)
    if all(sp.expand(gap) == 0 for gap in gaps.values()):
        return None
    from duhem.proof.search.plain_states import plain_states

    table = law.symbols()
    moving = [name for name in law.variables if law.parameters[name].value is None]
    states = plain_states([law.parameters[name] for name in moving], _MOST_ENERGIES)
    for parameters in subject.choices(choices):
        others = {x.name: v for x, v in subject.values_at(parameters, subject.nowhere).items()}
        known = (others | dict(zip(moving, state, strict=True)) for state in states)
        values = ({x: here[name] for name, x in table.items() if name in here} for here in known)
        if found := two_forces_at(subject, gaps, values, _TWO_FORCES):
            return Evidence(Verdict.REFUTED, "witness-state", "the energy gives two forces where the law has one", found)
    return None


# -- corners ----------------------------------------------------------------------------------------------------------


def smoothness_at_corners(subject: FormulaSubject | GraphSubject) -> Evidence | None:
    """Refute by a boundary point on a seam where the one-sided normals differ: for two forces on any seam, for more in some planes."""
    if isinstance(subject, GraphSubject):
        return None if subject.written_out is None else smoothness_at_corners(subject.written_out)
    choices = subject.choices(6 if len(subject.simple.forces) == 2 else 2, _at_extreme_exponents(subject))
    found = (corner(subject, *one) for parameters in choices for one in _suggested(subject, parameters))
    return _not_smooth(subject, found, "witness-corner", "the outward normal jumps at a corner of the boundary")


def smoothness_at_switches(subject: FormulaSubject) -> Evidence | None:
    """Refute by a corner where the boundary meets a switch of the formula, in more than two forces at many choices of the parameters."""
    from duhem.proof.search.corners import section_corners  # numpy, only when something is looked for

    choices = subject.choices(12) if len(subject.simple.forces) > 2 else ()
    found = (corner(subject, *one) for parameters in choices for one in section_corners(subject, parameters, drawn=False))
    return _not_smooth(subject, found, "witness-corner", "the outward normal jumps at a corner of the boundary")


def smoothness_at_sharp_points(subject: FormulaSubject) -> Evidence | None:
    """Refute by an exact boundary point to which K narrows: the tip of a cone or of a drop, a cusp, or a saddle of g."""
    from duhem.proof.search.corners import centred_choices, sharp_points  # numpy, only when something is looked for

    choices = subject.choices(2, [*_at_extreme_exponents(subject), *centred_choices(subject)])
    found = (sharp_point(subject, *one) for parameters in choices for one in sharp_points(subject, parameters))
    return _not_smooth(subject, found, "witness-sharp-point", "the boundary has a sharp point")


def _at_extreme_exponents(subject: FormulaSubject) -> list[Values]:
    """Return the plainest choices with each exponent at its least value, at which |x|^a may have a kink, and with each at its greatest."""
    exponents = {x for power in subject.simple.g.atoms(sp.Pow) for x in power.exp.free_symbols}
    own = {x: domain for x in exponents if (domain := subject.law.parameters.get(x.name)) is not None}
    sides = ({x: fraction(end) for x, domain in own.items() if (end := getattr(domain, side)) is not None} for side in ("low", "high"))
    found = ({**plain, **ends} for ends in sides for plain in itertools.islice(subject.choices(_PLAIN), _PLAIN if ends else 0))
    return list({tuple(one.items()): one for one in found}.values())


def _not_smooth(subject: FormulaSubject, found: Iterable[Witness | None], method: str, detail: str) -> Evidence | None:
    """Refute by the first witness that lies in the ranges of the law, a corner with its sides and a sharp point with its ways."""
    within = (one for one in found if one is not None and subject.may_refute("smoothness", one.points))
    return Evidence.refuted_by(within, method, _of_k(subject, detail))


def _suggested(subject: FormulaSubject, parameters: Values) -> Iterator[SectionCorner]:
    from duhem.proof.search.corners import crossings, section_corners  # numpy, only when something is looked for

    forces = subject.simple.forces
    if len(forces) > 2 or (len(forces) == 2 and subject.pieces is None):  # too many to look at each
        yield from section_corners(subject, parameters)
    elif len(forces) == 2:
        plane = PlaneSection.whole((forces[0], forces[1]))
        yield from ((parameters, plane, point) for _, point in crossings(subject, parameters))


# -- the slip ---------------------------------------------------------------------------------------------------------


def normality_at_chord(subject: FormulaSubject, settled: Mapping[str, Evidence]) -> Evidence | None:
    """Refute normality of an associated flow if K is not convex: where a chord leaves K, the normal points towards one end of it."""
    left = settled["convexity"].witness
    if not subject.problem.associated or left is None:
        return None
    parameters, p, q, middle = _read(subject, left)
    # n . (midpoint - sigma) > 0 where a segment to the midpoint leaves K, whatever it comes from; so for p or q as well
    zero = (Fraction(0),) * len(p)
    starts = [p, q, zero, *(tuple(c * s for c in end) for s in (Fraction(1, 2), Fraction(7, 8)) for end in (p, q))]
    starts += [tuple(s * c for c in _beside(len(p))) for s in (Fraction(1, 2**6), Fraction(1, 2**30), Fraction(1, 2**60))]
    tried = ((start, target) for start in itertools.chain(starts, _centre(subject, parameters)) for target in (q, p) if start is not target)
    found = (_leans(subject, (parameters, start, middle), target, enclosed_normal, "grad g", _CHORD) for start, target in tried)
    detail = _of_k(subject, "grad g is not in the normal cone where a chord leaves K")
    return Evidence.refuted_by(found, "witness-normal", detail) or Evidence(Verdict.UNDECIDED, "witness-chord", _NO_POINT)


def _leans(
    subject: FormulaSubject,
    crossed: tuple[Values, Point, Point],
    target: Point,
    vector: Callable[[FormulaSubject, EnclosedPoint], tuple[sp.Expr, ...] | None],
    name: str,
    statement: str,
    measures: Callable[[EnclosedPoint], dict[str, float]] = lambda point: {},
) -> Witness | None:
    """Return a witness that the ``vector`` points towards the target where the boundary crosses a segment."""

    def lean(point: EnclosedPoint) -> sp.Expr | None:
        found, forces = vector(subject, point), subject.simple.forces
        return None if found is None else sp.Add(*(d * (rational(t) - x) for d, t, x in zip(found, target, forces, strict=True)))

    return violation(subject, *crossed, lean, f"{name} . (tau - sigma)", statement, target, measures)


def _beside(n: int) -> list[int]:
    """Return whole numbers of many sizes: a point beside 0 in this direction lies on few kinks."""
    return [(-1) ** (i // 2) * (1 + i * i % 7 + 10 * i) for i in range(n)]


def _centre(subject: FormulaSubject, parameters: Values) -> Iterator[Point]:
    """Yield points well inside K, for the ends of a chord may lie on its boundary, with no way into K between them."""
    from duhem.proof.search.boundary_points import scouts

    yield from (exit.inside for scout in scouts(subject, 6) if scout.parameters == parameters for exit in scout.towards_zero_force())


def _read(subject: FormulaSubject, left: Witness) -> tuple[Values, Point, Point, Point]:
    """Return the parameters, the ends and the midpoint of a chord that leaves K."""
    table, simple = subject.law.symbols(), subject.simple
    parameters = {table[name]: Fraction(value) for name, value in left.parameters.items() if table[name] in simple.parameters}
    if simple.magnitude is not None and simple.magnitude in simple.parameters:
        parameters[simple.magnitude] = -Fraction(left.points["p"][str(subject.law.pressure)])
    p, q, middle = (tuple(Fraction(left.points[role][str(x)]) for x in simple.forces) for role in ("p", "q", "midpoint"))
    return parameters, p, q, middle


def normality_at_points(subject: FormulaSubject, choices: int = 12, near: bool = True) -> Evidence | None:
    """Refute by a boundary point whose flow points towards another point of K; the worst direction is tried first.

    The other point is first sought all along the boundary, then it is zero force, towards which a flow of negative power
    points, then (if ``near``) close by, at the scale of the deviation itself; at so many choices of the parameters.
    """
    if subject.simple.associated:
        return None
    from duhem.proof.search.boundary_points import scouts

    return _leaning(subject, scouts(subject, choices), near)


def _leaning(subject: FormulaSubject, scouts: Iterable[BoundaryScout], near: bool = True) -> Evidence | None:
    """Refute by the first boundary point of the scouts whose flow points towards another point of K."""
    for scout in (scout for scout in scouts if len(scout.boundary) > 1):
        at_rest = ((exit, subject.nowhere) for exit in scout.least_power(5))
        for exit, target in itertools.chain(scout.far_targets(), at_rest, _on_the_boundary(subject, scout) if near else ()):
            if (witness := _leans_towards(subject, exit, target)) and subject.may_refute("normality", witness.points):
                taus = (tau for tau in rounded(target) if subject.admits(subject.values_at(exit.parameters, tau)))
                short = (_leans_towards(subject, exit, tau) for tau in taus)
                fit = (one for one in short if one and subject.may_refute("normality", one.points))
                return Evidence(Verdict.REFUTED, "witness-flow", "the flow leaves the normal cone of K", next(fit, witness))
    return None


def _on_the_boundary(subject: FormulaSubject, scout: BoundaryScout) -> Iterator[tuple[Exit, Point]]:
    """Yield targets close by, as points that are surely in K."""
    for exit, turned in scout.near_targets():
        if found := enclosed(subject, *turned, 80):
            yield exit, found.inside


def _leans_towards(subject: FormulaSubject, exit: Exit, target: Point) -> Witness | None:
    return _leans(subject, exit, target, enclosed_flow, "flow", _NORMALITY, lambda point: _angles(subject, point))


def _angles(subject: FormulaSubject, point: EnclosedPoint) -> dict[str, float]:
    """Return by how many degrees the flow leaves the normal at the enclosed point and, for two forces, the angle of the flow."""
    normal, flow = enclosed_normal(subject, point), enclosed_flow(subject, point)
    if normal is None or flow is None:
        return {}
    n, d = ([float(over_box(c, subject, point).mid()) for c in vector] for vector in (normal, flow))
    n_size, d_size = math.hypot(*n), math.hypot(*d)
    apart, along = (math.hypot(*(a / n_size + way * b / d_size for a, b in zip(n, d, strict=True))) for way in (-1, 1))
    measures = {"deviation_degrees": math.degrees(2 * math.atan2(apart, along))}  # exact for small angles too (Kahan 2006)
    if len(d) == 2:
        measures["slip_angle_degrees"] = math.degrees(math.atan2(d[1], d[0]))
    return measures


def dissipation_at_points(subject: FormulaSubject, choices: int = 12) -> Evidence | None:
    """Refute by a boundary point where force . flow < 0, at so many choices of the parameters."""
    from duhem.proof.search.boundary_points import scouts

    ways = ((s.towards_zero_force(), s.least_power(5)) for s in scouts(subject, choices))
    return _power(subject, (exit for both in ways for way in both for exit in way))


def _power(subject: FormulaSubject, exits: Iterable[Exit]) -> Evidence | None:
    """Refute by the first crossing of the boundary where force . flow < 0 is certain."""

    def power(point: EnclosedPoint) -> sp.Expr | None:
        flow = enclosed_flow(subject, point)
        return None if flow is None else subject.power(flow)

    tried = (violation(subject, *exit, power, "force . flow", _DISSIPATION) for exit in exits)
    found = (with_variables(subject, witness) for witness in tried if witness is not None)
    found = (witness for witness in found if subject.may_refute("dissipation", witness.points))
    return Evidence.refuted_by(found, "witness-power", _of_k(subject, "force . flow is negative on the boundary"))


def dissipation_in_states(subject: FormulaSubject, choices: int = 12) -> Evidence | None:
    """Refute by a state whose forces dissipate less than 0 with the rates without a multiplier in K, or with the flow on g = 0."""
    ways = spent_in_states(subject.of, subject.problem.compressed)
    found = (_spent_less(subject, way, "sum of Y . rate", _FLOW_OF_STATE if way.on_it else _RATES, choices) for way in ways)
    return Evidence.refuted_by(found, "witness-state", "in an admissible state less than 0 is dissipated")


def heat_uphill(subject: FormulaSubject, choices: int = 12) -> Evidence | None:
    """Refute by temperatures at which the heat of the bodies dissipates less than 0."""
    found = _spent_less(subject, heat_in_states(subject.of, subject.problem.compressed), "D_th", _UPHILL, choices)
    return Evidence.refuted_by([found], "witness-state", "heat flows from the colder to the warmer")


def without_k(subject: RateSubject) -> Evidence:
    """Answer that a claim about K does not apply to forces that are functions of the rates."""
    detail = "the law gives forces as functions of the rates, so it has no K; what is claimed of them is normality and dissipation"
    return Evidence(Verdict.NOT_APPLICABLE, "none", detail)


def dissipation_of_rates(subject: RateSubject) -> Evidence:
    """Refute by rates at which force . rate < 0."""
    return _of_rates(subject, 0, "force . rate", _NEGATIVE, "at these rates less than 0 is dissipated")


def normality_of_rates(subject: RateSubject) -> Evidence:
    """Refute by two rates between which the forces decrease, so that they derive from no convex potential."""
    return _of_rates(subject, 1, "(force - force of the other) . (rate - rate of the other)", _FALLS, "the forces decrease with the rate")


def _of_rates(subject: RateSubject, which: int, name: str, statement: str, detail: str, choices: int = 12) -> Evidence:
    spent = spent_by_rates(subject.of, subject.problem.compressed)[which]
    if found := _spent_less(subject, spent, name, statement, choices):
        return Evidence(Verdict.REFUTED, "witness-rates", detail, found)
    return Evidence(Verdict.UNDECIDED, "none", "no rule of the kernel proves it, and no plain rates were found that refute it")


def _spent_less(subject: FormulaSubject, spent: Spent, name: str, statement: str, choices: int) -> Witness | None:
    """Refute by a state in which the quantity is certainly < 0; values that it does not depend on are those of the chosen parameters."""
    from duhem.proof.search.plain_states import plain_states, states_of_negative

    formulas = [e for e in (spent.power, spent.bound) if e is not None]
    sliced = {x: subject.of.parameters.get(x.name, POSITIVE) for x in subject.simple.slice}  # a slice is one of g alone
    spans = {**spent.chosen, **{x: span for x, span in sliced.items() if span.value is None}}
    moving = {x: span for x, span in spans.items() if any(x in e.free_symbols for e in formulas)}
    states = plain_states(list(moving.values()), _MOST_STATES)
    for parameters in subject.choices(choices):
        others = subject.values_at(parameters, subject.nowhere)
        others |= {x: Fraction(0) for x in spent.chosen if x not in others}  # forces without an energy
        fixed = {x: rational(v) for x, v in others.items() if x not in moving}
        power, *bound = (e.xreplace(fixed) for e in formulas)
        for state in states_of_negative(power, bound[0] if bound else None, spent.on_it, list(moving), states):
            if found := less_than_0(subject, spent, others | dict(zip(moving, state, strict=True)), name, statement):
                return found
    return None


# -- what was tried in vain: it proves nothing and says so -------------------------------------------------------------


def convexity_by_sampling(subject: FormulaSubject) -> Evidence | None:
    """Say between how many boundary points, at how many choices of the parameters, chords were tried in vain; None if there were none."""
    from duhem.proof.search.long_chords import looked_between

    return _tested("no chord was found that leaves K between", looked_between(subject))


def normality_by_sampling(subject: FormulaSubject) -> Evidence | None:
    """Say where the slip was looked at in vain; for an associated law, say it of the chords, because normality is convexity there."""
    if subject.problem.associated:
        return convexity_by_sampling(subject)
    from duhem.proof.search.margins import WALK, least_margin

    found = least_margin("normality", subject, WALK)
    if found is not None and (refuted := _leaning(subject, [found.scout])) is not None:
        return refuted
    return _flow(subject, "normality", "the slip leans towards another point of K")


def dissipation_by_sampling(subject: FormulaSubject) -> Evidence | None:
    """Refute where walks downhill end; else say at how many boundary points the slip was looked at in vain; None if none were found.

    None too where no state may have the forces that would be looked at.
    """
    from duhem.proof.search.downhill import entered
    from duhem.proof.search.margins import WALK, least_margin

    found = least_margin("dissipation", subject, WALK)
    exits = itertools.chain(() if found is None else found.scout.least_power(5), entered(subject) if subject.problem.associated else ())
    if (refuted := _power(subject, exits)) is not None:
        return refuted
    return _flow(subject, "dissipation", "the power is negative") if subject.onto else None


def _flow(subject: FormulaSubject, claim: str, what: str) -> Evidence | None:
    from duhem.proof.search.boundary_points import scouts
    from duhem.proof.search.margins import failures

    looked = [scout for scout in scouts(subject, 12) if scout.found > 0]
    for scout in looked:
        if count := failures(claim, scout):
            detail = f"in floats {what} at {count} of {scout.found} boundary points, but no exact counterexample confirms this"
            return Evidence(Verdict.UNDECIDED, "sampling", detail)
    return _tested("no violation at", [scout.found for scout in looked])


def _tested(what: str, found: Sequence[int]) -> Evidence | None:
    if not found:
        return None
    choices = "1 parameter choice" if len(found) == 1 else f"{len(found)} parameter choices"
    detail = f"{what} {sum(found)} boundary points of {choices} (fixed random seeds); this is not a proof"
    return Evidence(Verdict.TESTED, "sampling", detail)


# -- a law kept as a graph ---------------------------------------------------------------------------------------------

_CHOICES_OF_A_GRAPH = 3  # of parameters
_WORD = re.compile(r"\w\s*\(|\*\*")
_NEGATIVE_WEIGHT = re.compile(rf"-\s*(?P<number>{DECIMAL})\)?\s*\*\s*(?P<of>[^\W\d]\w*)(?!\s*\()")


def origin_of_graph(subject: GraphSubject) -> Evidence | None:
    """Refute by parameters at which g(0) > 0."""
    found = (origin_outside(subject, parameters) for parameters in subject.choices(_CHOICES_OF_A_GRAPH))
    return Evidence.refuted_by(found, "witness-point", "zero force is outside K")


def convexity_of_graph(subject: GraphSubject) -> Evidence | None:
    """Refute by a chord that leaves K."""
    from duhem.proof.search.long_chords import graph_chords

    found = (chord(subject, values, *ends) for values in subject.choices(_CHOICES_OF_A_GRAPH) for ends in graph_chords(subject, values))
    return Evidence.refuted_by(found, "witness-chord", "a chord between two points of K leaves K")


def convexity_of_graph_left_open(subject: GraphSubject) -> Evidence | None:
    """Say which weight of a network is negative, if one is, so that convexity does not follow from its structure."""
    graph = subject.law.graph
    nodes = () if graph is None else (*graph.nodes, ("g", graph.last))
    curved = set[str]()  # of words, or of what is
    for name, text in nodes:
        found = next((part for part in _NEGATIVE_WEIGHT.finditer(text) if part["of"] in curved), None)
        curved |= {name} if _WORD.search(text) or names_in(text) & curved else set()
        if found is not None:
            weight = f"the weight of {found['of']} in {name} is -{found['number']}"
            said = f"{weight}: convexity does not follow from the structure, and duhem found no chord that leaves K. K may be convex or not"
            return Evidence(Verdict.UNDECIDED, "none", f"{said}; if it is to be convex, train with weights >= 0 between layers")
    return None


def duality_of_graph_left_out(_: GraphSubject) -> Evidence:
    """Answer that there is no closed form to ask about."""
    return Evidence(Verdict.NOT_APPLICABLE, "polar-gauge", "g is kept as a graph, and no closed form is looked for of one")
