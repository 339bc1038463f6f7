"""What is marked in a section: one increment (the trial stress, the closest point of K and the slip), or the witness of a refuted claim."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from fractions import Fraction

import numpy as np
import sympy as sp
from numpy.typing import ArrayLike, NDArray

from duhem.errors import InputError
from duhem.expression.numpy_ import compiled
from duhem.law.catalogue import load_formula
from duhem.law.curve_law import Law, ParametricCriterion
from duhem.law.formula_law import Criterion
from duhem.portrait.lines import Window
from duhem.portrait.plane import Plane, oblique
from duhem.portrait.section import NOTHING, SLENDER, Numbered, View, beside, numbered, section
from duhem.projection.increment import Convexity, posed
from duhem.projection.projector import Projector
from duhem.projection.result import Status
from duhem.proof.verdict import Verdict, Witness
from duhem.proof.verification import ClaimResult, Verification, verify

__all__ = ["TrialStep", "Violation", "drawable", "step", "violation"]

Array = NDArray[np.float64]
_PART = 0.6  # of the way from trial to end that a slip may lie on
_LEAST = 0.35  # of its length that it keeps


@dataclass(frozen=True)
class TrialStep:
    """Trial and end (2,) of an increment in a plane; ``slip`` (2,) the slip's part in it at some length, None at 0."""

    trial: Array
    stress: Array
    slip: Array | None
    status: str


def step(given: Numbered, trial: ArrayLike, stiffness: ArrayLike, plane: Plane, length: float, pressure: float = -1.0) -> TrialStep:
    """An increment from one trial stress (d,) as a plane of forces shows it: what lies across is left out.

    The slip gets ``length``, or less where it would hide the way from trial to end.
    A law of one force has no plane of forces: there it is drawn along the pressure, at ``pressure``.  Its status is that of
    :func:`duhem.project`.  InputError for another plane along the pressure and for input that it refuses.
    """
    law = load_formula(given.law)
    alone = plane.pressed and len(law.forces) == 1
    base = np.array([0.0, pressure]) if alone else plane.base
    if not (plane.slips or alone):
        remedy = f"name such a plane first, for example {','.join(law.forces[:2])}"
        raise InputError("an increment can only be drawn in a plane of forces", where="trial", remedy=remedy)
    prepared = Projector.of(law, stiffness)
    question = posed(prepared.setting, trial, float(base[-1]) if law.pressure else None)
    if len(question.trial) != 1:
        raise InputError(f"{len(question.trial)} trial stresses are given", where="trial", remedy="give one")
    if not prepared.method.convex:
        question = replace(question, convexity=Convexity(loaded=_shown_convex(law), unloaded=False))
    done = prepared.at(question)
    n, status = len(plane.names), Status(int(done.status[0]))

    def full(force: Array) -> Array:
        return np.concatenate([force, base[len(force) :]])[:n]

    slip = np.concatenate([done.slip[0], np.zeros(n - len(done.slip[0]))])
    size = float(np.linalg.norm(slip))
    ends = plane.within(full(question.trial[0])), plane.within(full(done.stress[0]))
    length = max(_LEAST * length, min(length, _PART * float(np.linalg.norm(ends[1] - ends[0]))))
    way = length * plane.shares(slip) / size if size > 0.0 and np.isfinite(size) else None
    return TrialStep(*ends, way, status.name.lower())


def _shown_convex(law: Criterion) -> bool:
    """Whether K is proved to be convex, its ranges of forces aside: beyond them another point may be nearer."""
    everywhere = replace(law, domain={name: own for name, own in law.domain.items() if name == law.pressure})
    return verify(everywhere, claims="convexity", effort="quick")["convexity"].verdict is Verdict.PROVED


_WAYS = (("p", "q"), ("sigma", "tau"), ("inside", "tau"), ("corner", "inside"), ("u", "v"))
"""Roles of which a witness has two: what is drawn as a way from one to the other, first found first."""
_ASIDE = ("opposite", "corner")
"""Roles of a point that the plane through such a way should hold too."""
_INSIDE = ("p", "q", "inside", "tau")
"""Roles of points that lie in K."""
_FREE = 0.05  # of the window's size that is left free around a point
_NARROWEST = 0.6  # side of a window by the other, where the axes have one scale: narrower, numbers and notes find no room
_SMALL = 0.08  # share of the window below which a way is drawn larger, in a window of its own
_FLAT = 0.03  # share of the window below which the depth of a dent is drawn larger than its length
_DEPTHS = 6.0  # depths of such a dent on either side of its chord


@dataclass(frozen=True)
class Violation:
    """A section of K with the ``points`` (2,) of a witness by role, two of them the ends of the ``way`` (2, 2) that tells."""

    claim: str
    numbered: Numbered
    section: View
    points: dict[str, Array]
    way: Array | None


def drawable(found: Verification) -> tuple[ClaimResult, ...]:
    """The refuted claims whose witness can be drawn, in order."""
    return tuple(r for r in found.results if r.witness is not None and _points(found.criterion, r.witness))


def violation(law: Law, result: ClaimResult) -> Violation:
    """The picture of a refuted claim of ``law``, at the numbers of its witness."""
    witness = result.witness
    assert witness is not None
    at = numbered(law, dict(witness.parameters))
    points = _points(at.law, witness)
    ends = next(((points[a], points[b]) for a, b in _WAYS if a in points and b in points), None)
    aside = next((points[role] for role in _ASIDE if role in points and ends is not None), None)
    first = next(iter(points.values()))
    p, q = ends if ends is not None and (ends[0] != ends[1]).any() else (first, first + np.eye(len(first))[0])
    plane = oblique(law, p, q, aside)
    whole = section(at, plane, needed=False)
    flat = {role: plane.within(point) for role, point in points.items()}
    if ends is not None and result.claim == "smoothness":
        ends = None  # the corner is what is seen
    way = None if ends is None else np.array([plane.within(ends[0]), plane.within(ends[1])])
    window = _dent(whole, flat) or _around(whole, flat.values(), way)
    shown = whole if window is None else section(at, plane, window)
    told = next((flat[role] for role in ("sigma", "inside") if role in flat and result.claim in ("normality", "dissipation")), None)
    bare = replace(shown, normals=(), slips=()) if told is None else beside(at, shown, told)
    if bare.remark == NOTHING and not points.keys().isdisjoint(_INSIDE):
        bare = replace(bare, remark="only the points of the counterexample that lie in $K$ are found here")
    return Violation(result.claim, at, bare, flat, way)


def _dent(section_of_all: View, points: Mapping[str, Array]) -> Window | None:
    """A window that stretches a flat dent across its chord, where that is along an axis; None where the dent is deep enough to be seen."""
    if not {"p", "q", "midpoint"} <= points.keys() or not section_of_all.lines:
        return None
    middle, chord = points["midpoint"], np.abs(points["q"] - points["p"])
    along = int(chord.argmax())
    long, across = float(chord[along]), 1 - along
    boundary = np.vstack([line.points for line in section_of_all.lines])
    near = boundary[np.abs(boundary[:, along] - middle[along]) < 0.1 * long]
    if chord[across] > 1e-3 * long or not len(near):
        return None
    depth = float(np.abs(near[:, across] - middle[across]).min())
    if not 0.0 < depth < _FLAT * section_of_all.size:
        return None
    free = np.full(2, 1.1 * long)
    free[across] = min(_DEPTHS * depth, 0.9 * free[along] / SLENDER)
    (a, c), (b, d) = (middle - free).tolist(), (middle + free).tolist()
    return (a, b, c, d)


def _around(section_of_all: View, points: Iterable[Array], way: Array | None) -> Window | None:
    """A window for points too close together to be told apart, or out of sight; None where the whole of K shows them."""
    whole = section_of_all.window
    every = np.array([*points])
    low, high = every.min(axis=0), every.max(axis=0)
    wide, tall = whole[1] - whole[0], whole[3] - whole[2]
    size = float(max(wide, tall))
    told = every if way is None else way
    long = float(np.hypot(*np.ptp(told, axis=0)))
    if 0.0 < long < _SMALL * size:
        middle = (told.min(axis=0) + told.max(axis=0)) / 2.0
        return (middle[0] - 1.1 * long, middle[0] + 1.1 * long, middle[1] - 1.1 * long, middle[1] + 1.1 * long)
    sides = np.maximum(high, whole[1::2]) - np.minimum(low, whole[::2])
    free = _FREE * (sides if section_of_all.slender else np.full(2, sides.max()))  # not to scale: each axis has its own
    low, high = np.minimum(low - free, whole[::2]), np.maximum(high + free, whole[1::2])
    if not section_of_all.slender:
        more = np.maximum(_NARROWEST * (high - low).max() - (high - low), 0.0) / 2.0
        low, high = low - more, high + more
    (a, c), (b, d) = low.tolist(), high.tolist()
    box = (a, b, c, d)
    return None if box == whole else box


def _points(law: Law, witness: Witness) -> dict[str, Array]:
    """The points (n,) of a witness by role; those that give no stress, such as an angle alone, by the boundary curve."""
    found: dict[str, Array] = {}
    for role, point in witness.points.items():
        if role in ("outside", "beside", "opposite") and "inside" in witness.points and "corner" not in witness.points:
            continue  # beside `inside`, on the other side of the boundary
        if set(law.coordinates) <= set(point):
            found[role] = np.array([float(Fraction(point[name])) for name in law.coordinates])
        elif isinstance(law, ParametricCriterion) and "tan_half_phi" in point:
            found[role] = _on_curve(law, witness, point["tan_half_phi"])
    return found


def _on_curve(law: ParametricCriterion, witness: Witness, half: str) -> Array:
    known = law.symbols()
    angle = 2.0 * np.arctan(float(Fraction(half)))
    fixed = {known[name]: sp.Rational(value) for name, value in witness.parameters.items()}
    fixed |= {known[name]: domain.value for name, domain in law.parameters.items() if domain.value is not None}
    return np.array([*(float(compiled(part.xreplace(fixed), [known[law.angle]])(angle)) for part in law.boundary), -1.0])
