"""The pictures of laws: the portrait of one on a sheet or in panels of a page, and the atlas on a sheet.

Sections are drawn in the house style (extra ``plot``).  In one may be marked an increment (the trial stress, the closest point of K and the
slip), or the witness of a refuted claim.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import sympy as sp
from numpy.typing import ArrayLike, NDArray

from duhem.errors import InputError
from duhem.expression.numpy_ import compiled
from duhem.law.catalogue import load, load_formula, load_named
from duhem.law.curve_law import Law, ParametricCriterion
from duhem.law.formula_law import Criterion
from duhem.law.law_sheet import UNIT
from duhem.law.state import check_has_k
from duhem.portrait.lines import Vertex, Window, closed
from duhem.portrait.plane import Plane, elsewhere, named, oblique, usual
from duhem.portrait.section import NOTHING, SLENDER, Arrow, Numbered, View, beside, numbered, section
from duhem.projection.increment import Convexity, posed
from duhem.projection.projector import Projector
from duhem.projection.result import Status
from duhem.proof.verdict import Verdict, Witness
from duhem.proof.verification import ClaimResult, Verification, verify
from duhem.show import figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from duhem.law.atlas.entry import AtlasEntry
    from duhem.show.document import Drawing

__all__ = ["atlas_sheet", "cut", "has_section", "panels", "plot", "stated", "step", "violation"]

# -- what is marked in a section ---------------------------------------------------------------------------------------


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


Painter = Callable[["Axes"], None]
_VALUES = 8  # of parameters in a title


def plot(
    law: Law | str | Path,
    file: figure.Target | None = None,
    *,
    parameters: Mapping[str, Any] | None = None,
    pressure: float | None = None,
    planes: str | Sequence[str] = (),
    trial: ArrayLike | None = None,
    stiffness: ArrayLike = 1.0,
    witness: bool = False,
    unit: str = "",
    axes: Iterable[Axes] | None = None,
    on_remark: Callable[[str], object] = lambda text: None,
) -> tuple[Axes, ...]:
    """Draw K = {g <= 0} of a law, and return the axes.

    Each panel shows a section of K with its boundary, outward normals, seams (lines where the formula of g changes) and slip directions
    that are not normal.  ``parameters`` fixes some values; every other parameter gets a simple number from its domain, which the title
    shows. ``pressure`` is sigma_n <= 0 of the sections (default -1); for a law without pressure that declares a stress tensor, it is
    the mean stress of the deviatoric plane.  ``planes``: two forces, or the pressure and a force, as ``a,b``; ``deviatoric`` and
    ``meridian`` (p, q) for a stress tensor; or ``all``.  By default duhem chooses them, at most as many as there are ``axes``.
    ``trial`` (d,) and ``stiffness``, as for :func:`duhem.project`, draw one increment.  ``witness`` verifies the law and draws the
    counterexample of each refuted claim, at its own parameters.  ``unit`` is the unit of stresses; "Pa" gets prefixes.  ``on_remark``
    is called with a line about each part of K that a section does not show; the section has this line as a title too.

    Raises InputError for arguments that do not fit the law and for a file that cannot be written, MissingExtraError without matplotlib.
    """
    figure.check(file)
    chosen = load(law)
    if not has_section(chosen):
        check_has_k(chosen)
        what = f"{chosen.name} has a potential of rates and no criterion, so that there is no K to draw"
        raise InputError(what, where="law", remedy="draw the criterion that its potential has in it")
    refuted: tuple[Violation, ...] = ()
    if witness:
        found = verify(chosen, parameters)
        refuted = tuple(violation(found.criterion, result) for result in drawable(found))
    given = refuted[0].numbered if refuted else numbered(chosen, parameters)
    asked = [planes] if isinstance(planes, str) else list(planes)
    _check_pressure(chosen, pressure)
    given_axes = None if axes is None else figure.listed(axes)
    shown = [p for text in asked for p in named(chosen, text, pressure)] or list(usual(chosen, pressure))
    if given_axes is not None and not asked:
        shown = shown[: max(1, len(given_axes) - len(refuted))]
    painters: list[Painter] = []
    every = [cut(given, plane, moves=pressure is None, reach=abs(pressure or 0.0) if plane.pressed else 0.0) for plane in shown]
    size = max((seen.outermost for seen in every if not seen.slender), default=0.0)
    for i, seen in enumerate(every):
        plane = seen.plane
        if seen.remark:
            on_remark(f"{plane.plain}: {seen.remark.replace('$', '')}")
        if trial is not None and i == 0:
            taken = step(given, trial, stiffness, plane, 0.22 * seen.size, -1.0 if pressure is None else pressure)
            painters.append(partial(_increment, seen=_reaching(given, seen, taken), taken=taken, unit=unit, size=size))
        else:
            painters.append(partial(paint_section, found=seen, unit=unit, size=size))
    for each in refuted:
        if each.section.remark:
            on_remark(f"{each.claim} refuted, {each.section.plane.plain}: {each.section.remark.replace('$', '')}")
        painters.append(partial(paint_violation, seen=each, unit=unit, title=_refuted(each, given)))

    def paint(*places: Axes) -> None:
        for place, painter in zip(places, painters, strict=True):
            painter(place)
        if given_axes is None:
            figure.snug(places)
        figure.legend_below(places)

    many = len(painters)
    columns = many if many < 4 else 2 if many == 4 else 3
    return figure.drawn(paint, file, given_axes, panels=many, columns=columns, size=(4.9, 4.7), title=stated(given))


def cut(given: Numbered, plane: Plane, *, moves: bool = True, reach: float = 0.0) -> View:
    """The section by a plane, or where K has none there and the plane ``moves``, by one beside it; ``reach`` is :func:`section`'s."""
    every = [plane, *(elsewhere(given.law, plane, given.size) if moves else ())]
    for each in every[:-1]:
        if (found := section(given, each, needed=False, reach=reach)).lines:
            return found
    return section(given, every[-1], reach=reach)


def stated(given: Numbered, between: str = "\n") -> str:
    """The law, what stands ``between``, and its numbers, as a title says it; those that nobody gave are marked."""
    values, said = given.values(), _listed(given.values())
    note = f" (chosen for the picture: {', '.join(given.chosen[:_VALUES])})" if given.chosen and len(given.chosen) < len(values) else ""
    note = " (chosen for the picture)" if given.chosen and not note else note
    return between.join(filter(None, (given.law.name, said + note)))


def _refuted(each: Violation, given: Numbered) -> str:
    """What a panel of a witness shows, with the numbers that are not those of the sheet's title."""
    other = {name: value for name, value in each.numbered.values().items() if value != given.values().get(name)}
    return f"{each.claim} refuted" + (f" at {_listed(other)}" if other else "")


def _listed(values: Mapping[str, Any]) -> str:
    more = f", and {len(values) - _VALUES} more" if len(values) > _VALUES else ""
    return ", ".join(f"{name} = {_short(value)}" for name, value in list(values.items())[:_VALUES]) + more


def _short(value: Any) -> str:
    """A number in decimals, ``0.6``; a short fraction whose decimals do not end as it is, ``1/3``."""
    text, decimals = str(value), f"{float(value):.6g}"
    return text if Fraction(decimals) != value and len(text) <= 8 else decimals


def _check_pressure(law: Law, pressure: float | None) -> None:
    if pressure is None:
        return
    if not np.isfinite(pressure):
        raise InputError(f"{pressure} is not a pressure", where="pressure", remedy="give a finite number")
    if law.pressure is None and not any(p.guides for p in usual(law, None)):
        raise InputError(f"{law.name} has no pressure", where="pressure", remedy="remove it")
    if law.pressure is not None and pressure > 0.0:
        raise InputError(f"{law.pressure} = {pressure:g} is tension", where="pressure", remedy="give it <= 0: compression is negative")


def _reaching(given: Numbered, seen: View, taken: TrialStep) -> View:
    """The section in a window that holds the increment too."""
    points = np.array([taken.trial, taken.stress, *([taken.stress + taken.slip] if taken.slip is not None else [])])
    free = 0.06 * max(seen.size, float(np.abs(points).max()))
    (a, c), (b, d) = points.min(axis=0) - free, points.max(axis=0) + free
    box = (min(a, seen.window[0]), max(b, seen.window[1]), min(c, seen.window[2]), max(d, seen.window[3]))
    return seen if box == seen.window else section(given, seen.plane, tuple(map(float, box)))  # type: ignore[arg-type]


def _increment(axes: Axes, seen: View, taken: TrialStep, unit: str, size: float) -> None:
    paint_section(axes, seen, unit, size=size)
    paint_step(axes, taken)


def panels(found: Verification) -> tuple[Drawing, ...]:
    """The witnesses of what is refuted, at their numbers, and then what :func:`duhem.plot` shows of the law if nobody says what.

    Raises MissingExtraError without matplotlib, InputError where no numbers are found for what is left open.
    """
    figure.check(None)
    return tuple(_drawn(found))


def _drawn(found: Verification) -> Iterator[Drawing]:
    refuted = tuple(violation(found.criterion, result) for result in drawable(found))
    for each in refuted:
        about = f"The counterexample for {each.claim}; {stated(each.numbered, ' with ')}"
        yield _panel(partial(paint_violation, seen=each, unit="", title=f"{each.claim} refuted"), about)
    given = refuted[0].numbered if refuted else numbered(found.criterion)
    for plane in usual(given.law, None):
        seen = cut(given, plane)
        yield _panel(partial(paint_section, found=seen), f"K in {seen.plane.plain}; {stated(given, ' with ')}")


def _panel(paint: Callable[[Axes], None], caption: str) -> Drawing:
    from duhem.show.document import Drawing

    def whole(place: Axes) -> None:
        paint(place)
        figure.snug((place,))
        figure.legend_below((place,))

    return Drawing(figure.as_svg(figure.drawn(whole, size=(4.5, 4.3))), caption)


_COLUMNS = 8
_TITLE = "The atlas: one section of each law for simple parameter values; the verdicts cover the whole domain of the law"
_LOOKS: dict[str, dict[str, Any]] = {
    "proved": {"facecolor": figure.palette(0), "alpha": 0.3, "label": "$K$ convex: proved"},
    "refuted": {"facecolor": figure.palette(1), "alpha": 0.45, "lines": "xxx", "label": "$K$ convex: refuted"},
    "open": {"facecolor": "0.75", "alpha": 0.6, "lines": "...", "label": "$K$ convex: open"},
}
_TOLD = ("origin", "normality", "dissipation", "state_laws")


def atlas_sheet(
    laws: Sequence[AtlasEntry], file: figure.Target | None = None, on_law: Callable[[str], object] = lambda name: None
) -> tuple[Axes, ...]:
    """One section of each law at plain numbers, filled by whether K is convex; below its name the other claims that do not hold.

    Laws with a potential of rates have no K, and no section.  ``on_law`` is called with the name of each law before it is drawn.
    Raises what :func:`duhem.portrait.plot` raises.
    """
    figure.check(file)
    views, laws = [], [law for law in laws if has_section(load_named(law.name))]
    for law in laws:
        on_law(law.name)
        views.append(_first(numbered(load_named(law.name))))

    def paint(*places: Axes) -> None:
        for place, law, view in zip(places, laws, views, strict=True):
            _small(place, law, view)
        figure.legend_below(places)

    columns = min(_COLUMNS, len(laws))
    return figure.drawn(paint, file, panels=len(laws), columns=columns, size=(2.0, 2.15), title=_TITLE)


def has_section(law: Law) -> bool:
    """Whether a law has a K to draw."""
    return not (isinstance(law, Criterion) and (law.viscous or law.forces_of_rates))


def _first(at: Numbered) -> View:
    *others, last = usual(at.law, None)
    for plane in others:
        with suppress(InputError):  # this plane holds no point of K; another does
            return cut(at, plane)
    return cut(at, last)


def _small(axes: Axes, law: AtlasEntry, view: View) -> None:
    a, b, c, d = view.window
    convex = law.verdicts["convexity"]
    look = _LOOKS[convex if convex in _LOOKS else "open"]
    fill(axes, view, **look)
    for line in view.lines:
        axes.plot(*line.points.T, color="black", linewidth=0.9, zorder=3)
    axes.set(xlim=(a, b), ylim=(c, d), xticks=[], yticks=[])
    axes.set_aspect("equal" if 0.125 < (b - a) / (d - c) < 8.0 else "auto", adjustable="box")
    axes.set_xlabel(view.plane.x_symbol, fontsize=8.6, labelpad=2)
    axes.set_ylabel(view.plane.y_symbol, fontsize=8.6, labelpad=2)
    others = [
        f"{claim} {_word(law.verdicts[claim])}" for claim in _TOLD if law.verdicts.get(claim, "proved") not in ("proved", "not_applicable")
    ]
    axes.set_title("\n".join([figure.shortened(law.name, 24), *others]), fontsize=7.5)


def _word(verdict: str) -> str:
    return verdict if verdict == "refuted" else "open"


# -- sections ----------------------------------------------------------------------------------------------------------


Array = NDArray[np.float64]
_DARK = "0.25"  # of normals: pink beside it is grey to one reader in twenty
_ARROW = 0.085  # of the window's size
_SHAFT = 0.0135  # inches
_BLUE, _RED, _GREEN, _ORANGE = (figure.palette(i) for i in (0, 1, 2, 4))
_REMARK = 3.2  # inches: no wider than a panel among others
_SPREAD = 3  # normals of a fan beside its two sides
_ROLES = {"sigma": r"$\sigma$", "inside": r"$\sigma$", "tau": r"$\tau$", "midpoint": "midpoint", "origin": "$0$"}


def paint_section(axes: Axes, found: View, unit: str = "", title: str = "", *, fans: bool = True, size: float = 0.0) -> None:
    """K, its boundary, normals with fans at corners, seams, and slips that are not normal; ``size`` as in :func:`frame`."""
    frame(axes, found, unit, title, size)
    fill(axes, found)
    for i, seam in enumerate(found.seams):
        axes.plot(*seam.T, color=figure.GREY, linestyle=(0, (1, 2)), linewidth=1.2, label="_" if i else "seam of $g$", zorder=2)
    for i, line in enumerate(found.lines):
        axes.plot(*line.points.T, color=_BLUE, linewidth=1.8, label="_" if i else "boundary of $K$", zorder=3, gid=figure.EDGE)
    a, b, c, d = found.window
    x, y = found.points.T
    shown = found.points[(x >= a) & (x <= b) & (y >= c) & (y <= d)]
    if len(shown):
        axes.plot(*shown.T, ".", color=_BLUE, markersize=4, label="points of $K$", zorder=3)
    if found.slender:
        return  # a normal would not look like one
    long = _ARROW * found.size
    if found.plane.slips and found.plane.y_symbol:
        if fans:
            _fans(axes, [corner for corner in found.corners if corner.convex], long)
        _arrows(axes, _whole(found, found.normals, long), long, _DARK, "normal", found.slips == ())
    if found.slips:
        _arrows(axes, _whole(found, found.slips, 1.25 * long), 1.25 * long, _RED, "slip direction (not normal)", True)


def frame(axes: Axes, found: View, unit: str, title: str = "", size: float = 0.0) -> None:
    """The window with its axes through 0, to scale, and what is measured on them, in a unit that suits the ``size`` of a whole sheet."""
    a, b, c, d = found.window
    for rule, ends in ((axes.axhline, (c, d)), (axes.axvline, (a, b))):
        if ends[0] < 0.0 < ends[1]:
            rule(0.0, color="0.85", linewidth=0.7, zorder=0)
    for symbol, way in found.plane.guides.items():
        far = [edge / part for edge, part in ((b if way[0] > 0 else a, way[0]), (d if way[1] > 0 else c, way[1])) if part]
        x, y = (0.94 * min(far) * part for part in way)
        axes.plot([0.0, x], [0.0, y], color="0.7", linewidth=0.8, zorder=0.5)
        paper = {"facecolor": "white", "linewidth": 0, "pad": 1.0}
        axes.text(x, y, f"${symbol}$", fontsize="small", color="0.35", ha="center", va="center", bbox=paper, zorder=0.6)
    axes.set_xlim(a, b)
    axes.set_ylim(c, d)
    wide, high = max(abs(a), abs(b)), max(abs(c), abs(d))
    if not (found.slender or found.plane.pressed):  # along the pressure there are no normals, whose angles would have to be right
        axes.set_aspect("equal", adjustable="box")
        wide = high = max(wide, high, size)  # one scale, one unit
    figure.measure(axes.xaxis, found.plane.x_symbol, unit or UNIT, wide)
    figure.measure(axes.yaxis, found.plane.y_symbol, unit or UNIT, high)
    if not found.plane.y_symbol:
        axes.yaxis.set_visible(False)
    said, remark = (figure.wrapped(text, _REMARK) for text in (title, found.remark))
    lines = [said, found.plane.told(unit), "different scales on the two axes" if found.slender else "", remark]
    axes.set_title("\n".join(line for line in lines if line))


def fill(axes: Axes, found: View, lines: str = "", **look: Any) -> None:
    """The area of K, perhaps with ``lines`` over it: what its boundary encloses, or where that leaves the window, what the grid says."""
    from matplotlib.patches import PathPatch
    from matplotlib.path import Path

    look = {"facecolor": _BLUE, "alpha": 0.14, "linewidth": 0, "zorder": 1, "label": "$K$"} | look
    if all(closed(line.points) for line in found.lines) and found.lines and not _filled_edge(found):
        paths = [Path(line.points, closed=True) for line in found.lines]
    elif found.grid is not None:
        from contourpy import FillType, contour_generator

        made: Any = contour_generator(*found.grid, fill_type=FillType.OuterOffset).filled(-np.inf, 0.0)
        paths = [
            Path(points[s:e], closed=True)
            for points, places in zip(*made, strict=True)
            for s, e in zip(places[:-1].astype(int), places[1:].astype(int), strict=True)
        ]
    else:
        return
    if not paths:
        return
    area = PathPatch(Path.make_compound_path(*paths), **look)
    if lines:
        figure.hatched(axes, area, lines, "black")
    else:
        axes.add_patch(area)


def _filled_edge(found: View) -> bool:
    """Whether K reaches the edge of the window."""
    if found.grid is None:
        return False
    value = found.grid[2]
    return bool((value[0] <= 0).any() or (value[-1] <= 0).any() or (value[:, 0] <= 0).any() or (value[:, -1] <= 0).any())


def _fans(axes: Axes, corners: Iterable[Vertex], size: float) -> None:
    from matplotlib.patches import Polygon

    for i, corner in enumerate(corners):
        turn = np.arctan2(corner.before[0] * corner.after[1] - corner.before[1] * corner.after[0], corner.before @ corner.after)
        start = np.arctan2(corner.before[1], corner.before[0])
        angles = start + np.linspace(0.0, turn, 24)
        rim = corner.point + size * np.column_stack([np.cos(angles), np.sin(angles)])
        area = np.vstack([corner.point, rim])
        label = "_" if i else "normal cone at a corner"
        cone = Polygon(area, closed=True, facecolor=_ORANGE, alpha=0.35, linewidth=0, zorder=2.5, label=label)
        figure.hatched(axes, cone, "///", _DARK)
        ways = start + np.linspace(0.0, turn, 2 + (_SPREAD if abs(turn) > 0.8 else 0))
        _arrows(axes, [Arrow(corner.point, np.array([np.cos(w), np.sin(w)])) for w in ways], size, _DARK, "", True)


def _whole(found: View, arrows: Sequence[Arrow], size: float) -> Sequence[Arrow]:
    """The arrows that the window holds whole; all of them where it holds none so."""
    a, b, c, d = found.window
    tips = ((arrow, arrow.at + size * arrow.along) for arrow in arrows)
    return [arrow for arrow, (x, y) in tips if a <= x <= b and c <= y <= d] or arrows


def _arrows(axes: Axes, arrows: Iterable[Arrow], size: float, colour: str, label: str, first: bool) -> None:
    """Arrows of one length; a legend shows a line with a head."""
    every, wide = list(arrows), 1.0 if colour == _DARK else 1.5
    if not every:
        return
    x, y = np.array([a.at for a in every]).T.tolist()
    u, v = (size * np.array([a.along for a in every])).T.tolist()
    axes.quiver(
        x, y, u, v, angles="xy", scale_units="xy", scale=1.0, units="inches", width=wide * _SHAFT, headwidth=4.2, headlength=5.0,
        headaxislength=4.6, color=colour, zorder=4 if first else 3.5, clip_on=True,
    )  # fmt: skip
    if label:
        axes.plot([], [], color=colour, linewidth=wide, marker=">", markersize=2.5 + 1.5 * wide, label=label)


def paint_step(axes: Axes, step: TrialStep) -> None:
    """A trial stress, the closest point of K and the way between them."""
    _way(axes, step.trial, step.stress, color=_GREEN, linewidth=1.2, linestyle="--", zorder=6)
    axes.plot(*step.trial, "s", color=_GREEN, markersize=6, label=r"trial stress $\sigma^\mathrm{tr}$", zorder=6)
    axes.plot(*step.stress, "o", color="black", markersize=5, label=f"stress at the end ({step.status})", zorder=6)
    if step.slip is not None:
        _way(axes, step.stress, step.stress + step.slip, color=_RED, linewidth=1.8, zorder=6.5)
        axes.plot([], [], color=_RED, linewidth=1.8, marker=">", markersize=4, label=r"direction of the slip $\Delta u^\mathrm{in}$")


def _way(axes: Axes, start: Array, end: Array, **look: Any) -> None:
    from matplotlib.patches import FancyArrowPatch

    ends = [(float(x), float(y)) for x, y in (start, end)]
    axes.add_patch(FancyArrowPatch(*ends, arrowstyle="-|>", mutation_scale=12.0, shrinkA=0.0, shrinkB=2.0, **look))


def paint_violation(axes: Axes, seen: Violation, unit: str, title: str) -> None:
    """The section with the points of a witness and the way between two of them."""
    paint_section(axes, seen.section, unit, title, fans=False)
    if seen.way is not None:
        axes.plot(
            *seen.way.T, color=_RED, linewidth=2.0, linestyle=(0, (5, 1.5)), zorder=5, label="chord between two points", gid=figure.OPEN
        )
    for i, (role, point) in enumerate(seen.points.items()):
        mark, label = "X" if role == "midpoint" else "o", "_" if i else "witness"
        axes.plot(*point, mark, color=_RED, markeredgecolor="black", markersize=7, zorder=6, label=label)
        words = role if "corner" in seen.points else _ROLES.get(role, f"${role}$" if len(role) == 1 else role)
        figure.note(axes, words, (float(point[0]), float(point[1])))
