"""Every method on every extreme case, from harmless to the edge of what doubles hold, judged against a reference in many digits.

:func:`stress` notes of each answer whether it is finite, whether it lies in K, how many digits are right, and whether the method flagged
it; bad input must be refused, with the argument and the index named.  :class:`StressCases` asks the same of each row of a campaign: a line
for each case has a verdict (ok, wrong, flagged, ...) and these counts.  A case lies
on one axis of difficulty; :mod:`duhem.benchmark.report` prints the result.
"""

from __future__ import annotations

import json
import math
import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from fractions import Fraction
from time import monotonic
from typing import Any, ClassVar, TypeAlias

import numpy as np

from duhem.benchmark.contenders import Contender, Specimen, applicable
from duhem.benchmark.measurement import Study
from duhem.benchmark.reference import Closest, ReferenceIncrement, distance
from duhem.errors import DuhemError, InputError
from duhem.expression.number import fraction
from duhem.law.catalogue import load_formula
from duhem.law.curve_law import Law
from duhem.law.domain import Domain
from duhem.law.formula_law import Criterion
from duhem.law.parameter_domain import check_fixed
from duhem.omitted import LeftOut
from duhem.projection.methods import METHODS
from duhem.projection.projector import Projector
from duhem.projection.result import Array, Projection, Status

__all__ = [
    "AXES", "MOST", "POOR", "ExtremeCase", "ExtremeCases", "Refusal", "StressCases", "Tally", "aspect", "cases", "digits", "refusals",
    "stress",
]  # fmt: skip

# -- the cases ---------------------------------------------------------------------------------------------------------


AXES = {
    "load": "|sigma_n| (or the trial stress, for a law without pressure), by powers of ten",
    "stiffness ratio": "largest over smallest stiffness, by powers of ten",
    "aspect of K": "one axis of K shortened by its parameters, by powers of ten",
    "trial size": "trial stress over the reach of K, by powers of ten",
    "seam distance": "component across a coordinate axis over the reach of K, by powers of ten",
    "boundary distance": "how far outside K the trial stress lies, relative, by powers of ten",
    "special values": "zeros, denormals, vanishing pressure",
}
LOADS = (-290, -250, -200, -150, -100, -60, -30, -15, -8, -4, 0, 4, 8, 15, 30, 60, 100, 150, 200, 250, 290)
_RATIOS = range(0, 13, 2)
_ASPECTS = range(0, 9)
_SIZES = range(0, 17, 2)
_OFF = {**{f"1e{-j}": (-j, 10.0**-j) for j in range(0, 21, 2)}, "1e-300": (-300, 1e-300), "0": (-330, 0.0)}
_OUTSIDE = range(0, 16)
_ULP, _NONE = "1 ulp", "0 by doubles"
_TINY = 5e-324


@dataclass(frozen=True)
class ExtremeCase:
    """Trial stresses (M, d) under one pressure, at one place of one axis."""

    axis: str
    label: str
    decade: float
    specimen: Specimen
    trial: Array
    pressure: float | None


def cases(specimen: Specimen, axes: tuple[str, ...] = tuple(AXES)) -> Iterator[ExtremeCase]:
    """Every case of ``axes``, the harmless end first; axes that the law does not have yield nothing."""
    makers = {
        "load": _loads,
        "stiffness ratio": _stiffnesses,
        "aspect of K": _aspects,
        "trial size": _sizes,
        "seam distance": _seams,
        "boundary distance": _distances,
        "special values": _specials,
    }
    for axis in axes:
        yield from makers[axis](specimen, axis)


def labels(axis: str) -> tuple[str, ...]:
    """The labels of every case of an axis, in their order; a law may not have all of them."""
    powers = {"load": LOADS, "stiffness ratio": _RATIOS, "aspect of K": _ASPECTS, "trial size": _SIZES}
    if axis in powers:
        return tuple(f"1e{e}" for e in powers[axis])
    if axis == "boundary distance":
        return (*(f"1e{-j}" for j in _OUTSIDE), _ULP, _NONE)
    return tuple(_OFF) if axis == "seam distance" else tuple(label for label, _, _ in _special(2, -1.0))


def _ways(d: int) -> Array:
    """Two unlike directions, away from the axes."""
    first = 0.6 + 0.5 * np.arange(d) / max(d, 1)
    second = -0.9 + 1.3 * np.arange(d) / max(d - 1, 1)
    return np.array([first * np.where(np.arange(d) % 2, -1.0, 1.0), second])


def _reached(specimen: Specimen, ways: Array, pressure: float | None) -> Array:
    """The last points of K along the directions, those in which it ends (M, d)."""
    reach = [specimen.radius(way, pressure) for way in ways]
    return np.array([r * way for r, way in zip(reach, ways, strict=True) if 0.0 < r < 1e305]).reshape(-1, ways.shape[1])


def _loads(specimen: Specimen, axis: str) -> Iterator[ExtremeCase]:
    d = len(specimen.law.forces)
    for e in LOADS:
        if specimen.pressure is None:
            trial = 10.0**e * _ways(d)
            yield ExtremeCase(axis, f"1e{e}", e, specimen, trial, None)
        else:
            pressure = -(10.0**e)
            edge = _reached(specimen, _ways(d), pressure)
            if len(edge):
                yield ExtremeCase(axis, f"1e{e}", e, specimen, 3.0 * edge, pressure)


def _stiffnesses(specimen: Specimen, axis: str) -> Iterator[ExtremeCase]:
    d = len(specimen.law.forces)
    if d < 2:
        return
    edge = _reached(specimen, _ways(d), specimen.pressure)
    for e in _RATIOS:
        k = np.diag(10.0 ** (e * np.arange(d) / (d - 1)))
        yield ExtremeCase(axis, f"1e{e}", e, replace(specimen, stiffness=k), 3.0 * edge, specimen.pressure)


def aspect(specimen: Specimen) -> tuple[str, ...]:
    """The parameters that scale the reach of K along the last axis alone, found by trying."""
    d, axes = len(specimen.law.forces), np.eye(len(specimen.law.forces))
    if d < 2:
        return ()
    before = np.array([[specimen.radius(s * a, specimen.pressure) for s in (1.0, -1.0)] for a in axes])
    if not (np.isfinite(before).all() and (before > 0.0).all()):
        return ()
    found = []
    for name in specimen.law.parameters:
        other = _scaled(specimen, (name,), Fraction(1, 2))
        try:
            after = np.array([[other.radius(s * a, specimen.pressure) for s in (1.0, -1.0)] for a in axes])
        except InputError:  # half of it breaks a constraint of the law
            continue
        share = after / before
        if (
            np.allclose(share[:-1], 1.0, rtol=1e-9)
            and (np.isclose(share[-1], 0.5) | np.isclose(share[-1], 1.0)).all()
            and (share[-1] < 0.9).any()
        ):
            found.append(name)
    return tuple(found)


def _scaled(specimen: Specimen, names: tuple[str, ...], factor: Fraction) -> Specimen:
    """The law with some parameters times ``factor``, at doubles taken exactly."""

    def moved(name: str, domain: Domain) -> Domain:
        value = domain.value
        assert value is not None
        return Domain.fixed(Fraction(float(fraction(value) * factor))) if name in names else domain

    law = replace(specimen.law, parameters={name: moved(name, domain) for name, domain in specimen.law.parameters.items()})
    return Specimen(law, law, specimen.stiffness)


def _aspects(specimen: Specimen, axis: str) -> Iterator[ExtremeCase]:
    names = aspect(specimen)
    if not names:
        return
    for e in _ASPECTS:
        thin = _scaled(specimen, names, Fraction(1, 10**e))
        edge = _reached(specimen, np.eye(len(specimen.law.forces)), specimen.pressure)
        size = np.abs(edge).max(axis=0)
        yield ExtremeCase(axis, f"1e{e}", e, thin, _ways(len(size)) * size * 3.0, specimen.pressure)


def _sizes(specimen: Specimen, axis: str) -> Iterator[ExtremeCase]:
    edge = _reached(specimen, _ways(len(specimen.law.forces)), specimen.pressure)
    for e in _SIZES:
        yield ExtremeCase(axis, f"1e{e}", e, specimen, 1.5 * 10.0**e * edge, specimen.pressure)


def _seams(specimen: Specimen, axis: str) -> Iterator[ExtremeCase]:
    d = len(specimen.law.forces)
    if d < 2:
        return
    edge = _reached(specimen, np.eye(d)[:1], specimen.pressure)
    if not len(edge):
        return
    size = float(edge[0, 0])
    for label, (e, share) in _OFF.items():
        trial = np.zeros((2, d))
        trial[:, 0], trial[:, 1] = 2.0 * size, (size * share, -size * share)
        yield ExtremeCase(axis, label, e, specimen, trial, specimen.pressure)


def _distances(specimen: Specimen, axis: str) -> Iterator[ExtremeCase]:
    edge = _reached(specimen, _ways(len(specimen.law.forces)), specimen.pressure)
    for j in _OUTSIDE:
        yield ExtremeCase(axis, f"1e{-j}", -j, specimen, edge * (1.0 + 10.0**-j), specimen.pressure)
    out = np.where(edge == 0.0, 0.0, np.nextafter(edge, np.copysign(np.inf, edge)))
    yield ExtremeCase(axis, _ULP, -16, specimen, out, specimen.pressure)
    yield ExtremeCase(axis, _NONE, -17, specimen, edge, specimen.pressure)


def _specials(specimen: Specimen, axis: str) -> Iterator[ExtremeCase]:
    for i, (label, trial, pressure) in enumerate(_special(len(specimen.law.forces), specimen.pressure)):
        yield ExtremeCase(axis, label, float(i), specimen, trial, pressure)


def _special(d: int, plain_pressure: float | None) -> list[tuple[str, Array, float | None]]:
    """Label, trial stresses and pressure of each, in ``d`` forces."""
    signs = np.where(np.arange(d) % 2, -1.0, 1.0)
    denormal = np.array([_TINY * signs, -_TINY * signs, 1e-310 * signs])
    zeros = np.array([np.zeros(d), -np.zeros(d), np.copysign(0.0, signs)])
    plain = _ways(d)
    named: list[tuple[str, Array, float | None]] = [
        ("trial +-0", zeros, plain_pressure),
        ("trial denormal", denormal, plain_pressure),
    ]
    if plain_pressure is not None:
        named += [
            ("sigma_n = 0", plain, 0.0),
            ("sigma_n = -0", plain, -0.0),
            ("both 0", zeros, 0.0),
            ("sigma_n = -5e-324", plain, -_TINY),
            ("sigma_n = -1e-300", plain, -1e-300),
            ("all denormal", denormal, -1e-310),
            ("trial 1e300", 1e300 * plain, -1.0),
        ]
    return named


POOR = 6.0  # an answer with fewer digits is wrong
MOST = 16.0  # as many as a double shows
_SMALLEST = 2.0**-1022  # below it doubles lose digits, whoever computes
_LARGEST = 1.79e308
_INSIDE = 1e-7  # of the stress, taken off before asking whether it lies in K

_REFUSALS = "refusals"
_Line: TypeAlias = tuple[str, str | None, str | None, str | None, str | None, int, float]


def digits(got: Sequence[float], exact: Sequence[Any], otherwise: Any) -> float:
    """Accurate digits, between 0 and 16; 0 where the exact number is beyond doubles, which only a flag can tell."""
    size = max(abs(x) for x in exact)
    if size > _LARGEST:
        return 0.0
    unit = max(size if size != 0 else otherwise, _SMALLEST)
    off = distance(got, exact, unit)
    return MOST if off == 0.0 else min(MOST, max(0.0, -math.log10(off))) if math.isfinite(off) else 0.0


@dataclass(frozen=True)
class Refusal:
    """One bad input: ``held`` whether the method raised InputError naming ``place``; ``answer`` what it said or did instead."""

    what: str
    method: str
    place: str
    held: bool
    answer: str


def refusals(specimen: Specimen, contender: Contender) -> Iterator[Refusal]:
    """The bad inputs in turn, each the last of three increments."""
    d, given = len(specimen.law.forces), specimen.pressure
    good = np.full((3, d), 0.5)

    def spoilt(whole: Array, at: tuple[int, ...], value: float) -> Array:
        whole = whole.copy()
        whole[at] = value
        return whole

    bad: list[tuple[str, str, Array, Any, Array | None]] = []
    for value in (np.nan, np.inf, -np.inf):
        bad.append((f"trial {value}", f"trial[2, {d - 1}]", spoilt(good, (2, d - 1), value), given, None))
    for value in (np.nan, -np.inf, 1.0) if given is not None else ():
        bad.append((f"pressure {value}", "pressure[2]", good, spoilt(np.full(3, -1.0), (2,), value), None))
    for value in (np.nan, np.inf, 0.0, -1.0):
        bad.append((f"stiffness {value}", f"stiffness[{d - 1}]", good, given, spoilt(np.ones(d), (d - 1,), value)))
    for what, place, *asked in bad:
        held = False
        try:
            answer = f"answered {contender.project(specimen, *asked).stress[-1].tolist()}"
        except InputError as fault:
            held, answer = place in str(fault), str(fault)
        except Exception as fault:  # an error of another kind says less than it should
            answer = f"{type(fault).__name__}: {fault}"
        yield Refusal(what, contender.name, place, held, answer)


@dataclass(frozen=True)
class Tally:
    """One method at one place of an axis: counts over ``points`` and the fewest accurate digits of stress and slip.

    ``wrong_stress`` and ``wrong_slip`` count answers with fewer than 6 digits that the method did not flag.
    """

    axis: str
    label: str
    decade: float
    method: str
    points: int
    finite: int
    feasible: int
    flagged: int
    stress_digits: float
    slip_digits: float
    wrong_stress: int
    wrong_slip: int
    failure: str | None = None


@dataclass(frozen=True, kw_only=True)
class ExtremeCases(Study):
    """Rows in the order taken; ``refusals`` of input that cannot be used; ``reference`` the largest error of the reference."""

    printed_by: ClassVar[str] = "duhem.benchmark.report"

    rows: tuple[Tally, ...]
    refusals: tuple[Refusal, ...]
    reference: float

    @property
    def methods(self) -> tuple[str, ...]:
        """Who was measured, in order."""
        return tuple(dict.fromkeys(row.method for row in self.rows))

    @property
    def silently_wrong(self) -> dict[str, tuple[int, int]]:
        """By method: points whose stress, and whose slip, is wrong without a flag."""
        return {
            m: (sum(r.wrong_stress for r in self.rows if r.method == m), sum(r.wrong_slip for r in self.rows if r.method == m))
            for m in self.methods
        }

    @property
    def failed(self) -> bool:
        return bool(self.rows) and all(row.finite == 0 for row in self.rows)

    def measured(self) -> dict[str, Any]:
        return {
            "interrupted": self.interrupted,
            "reference": self.reference,
            "rows": [asdict(row) for row in self.rows],
            "refusals": [asdict(refusal) for refusal in self.refusals],
            "silently_wrong": {m: {"stress": a, "slip": b} for m, (a, b) in self.silently_wrong.items()},
        }


def stress(
    law: Criterion,
    *,
    axes: Sequence[str] = tuple(AXES),
    stiffness: Sequence[float] | None = None,
    contenders: Sequence[Contender] | None = None,
    peers: bool = False,
    every: int = 1,
    on_row: Callable[[Tally], None] | None = None,
) -> ExtremeCases:
    """Every method that applies to ``law``, all parameters fixed, on the cases of ``axes``.

    ``stiffness`` (d,) diagonal in Pa/m, left out 1, 2, ...; ``contenders`` in place of all of them; ``peers``: other programs
    too, those that are installed; of the cases each ``every``-th.  KeyboardInterrupt ends it
    with what is done.  Raises InputError for a parameter without value, a law whose increments are more than closest points of K, an
    unknown axis.
    """
    if strange := [axis for axis in axes if axis not in AXES]:
        raise InputError(f"unknown axis {strange[0]!r}", where="axes", remedy=f"choose {', '.join(AXES)}")
    if every < 1:
        raise InputError(f"every is {every}", where="every", remedy="give a whole number >= 1")
    specimen = Specimen.of(law, stiffness)
    found, left_out = applicable(specimen.unloaded, peers=peers)
    chosen = list(found if contenders is None else contenders)
    rows: list[Tally] = []
    refused: list[Refusal] = []
    worst, interrupted, seen = 0.0, False, set[str]()
    try:
        for number, case in enumerate(cases(specimen, tuple(axes))):
            seen.add(case.axis)
            if number % every:
                continue
            try:
                closest = case.specimen.reference()
                answers = [closest(x.tolist(), case.pressure) for x in case.trial]
            except DuhemError as fault:
                left_out.append(LeftOut(f"{case.axis} {case.label}", f"no reference: {fault}"))
                continue
            worst = max([worst, *(a.residual for a in answers)])
            for contender in chosen:
                row = _row(case, contender, closest, answers)
                rows.append(row)
                if on_row is not None:
                    on_row(row)
        left_out += [LeftOut(f"axis {axis}", _absent(specimen, axis)) for axis in axes if axis not in seen]
        refused += [refusal for contender in chosen for refusal in refusals(specimen, contender)]
    except KeyboardInterrupt:
        interrupted = True
    return ExtremeCases(
        law=law.name,
        subject=specimen.describe(),
        rows=tuple(rows),
        refusals=tuple(refused),
        reference=worst,
        left_out=tuple(left_out),
        interrupted=interrupted,
    )


def _absent(specimen: Specimen, axis: str) -> str:
    if axis == "aspect of K" and len(specimen.law.forces) > 1:
        return "no parameter of the law scales one axis of K alone"
    return f"a law in {len(specimen.law.forces)} force has none"


def _row(case: ExtremeCase, contender: Contender, closest: Closest, answers: Sequence[ReferenceIncrement]) -> Tally:
    where = (case.axis, case.label, case.decade, contender.name, len(case.trial))
    try:
        with warnings.catch_warnings(), np.errstate(all="ignore"):
            warnings.simplefilter("ignore")  # an overflow on the way is no flag: what comes back is judged
            done = contender.project(case.specimen, case.trial, case.pressure)
        finite = [bool(np.isfinite([s, u]).all()) for s, u in zip(done.stress, done.slip, strict=True)]
        judged = [_judged(case, closest, answer, done, i) if finite[i] else (False, 0.0, 0.0) for i, answer in enumerate(answers)]
    except Exception as fault:  # an error is a flag: nothing was returned
        return Tally(*where, 0, 0, len(case.trial), 0.0, 0.0, 0, 0, f"{type(fault).__name__}: {fault}")
    flagged = np.isin(done.status, (Status.INACCURATE, Status.FAILED))
    feasible, stress, slip = map(np.array, zip(*judged, strict=True))
    return Tally(
        *where,
        sum(finite),
        int(feasible.sum()),
        int(flagged.sum()),
        float(stress.min()),
        float(slip.min()),
        int((~flagged & ~(stress >= POOR)).sum()),
        int((~flagged & ~(slip >= POOR)).sum()),
    )


def _judged(case: ExtremeCase, closest: Closest, answer: ReferenceIncrement, done: Projection, i: int) -> tuple[bool, float, float]:
    """Whether a stress lies in K, and the accurate digits of stress and slip.

    Digits are relative to the largest component of the exact stress or slip; where that is zero, to the trial stress and
    to k^-1 times it; below the smallest normal number, to that number.
    """
    mp = closest.context
    tail = [] if case.pressure is None else [mp.mpf(case.pressure)]
    shrunk = [mp.mpf(float(s)) * (1 - mp.mpf(_INSIDE)) for s in done.stress[i]]
    trial = mp.matrix([mp.mpf(float(t)) for t in case.trial[i]])
    return (
        bool(closest.formula.read([*shrunk, *tail]).value <= 0),
        digits(done.stress[i].tolist(), answer.stress, max(map(abs, trial))),
        digits(done.slip[i].tolist(), answer.slip, max(map(abs, closest.compliance * trial))),
    )


@dataclass(frozen=True)
class StressCases:
    """Stiff and extreme increments, as ``duhem stress`` tries them, for ``duhem.campaign(..., ask=StressCases())``.

    A line a case of the ``axes`` (all of them if left out), named as axis and label, and, of several ``methods``, the method; ``auto`` is
    the cheapest that applies.  It is ``wrong`` where an answer has fewer than 6 accurate digits of stress or slip and no flag, ``flagged``
    where the method says of an answer that it is none, else ``ok``; ``undecided`` where there is no reference, ``not_applicable`` where
    the law has no such case or the method does not take the law.  The witness has the fewest accurate digits of the points (16 at most)
    and how many are finite, in K, flagged and silently wrong; ``steps`` are the points.  One line more, ``refusals``: what is not
    finite is refused with argument and index named.

    Every row fixes all parameters of its law, at k = diag(1, 2, ...) Pa/m.  Raises InputError for an unknown axis or method.
    """

    axes: tuple[str, ...] = tuple(AXES)
    methods: tuple[str, ...] = ("auto",)
    options: ClassVar[tuple[str, ...]] = ()
    alone: ClassVar[bool] = False

    def __post_init__(self) -> None:
        for where, given, known in (("axes", self.axes, tuple(AXES)), ("methods", self.methods, ("auto", *METHODS))):
            remedy = f"they are: {', '.join(known)}"
            if not isinstance(given, tuple) or not given or len(set(given)) < len(given):
                raise InputError(f"{where} is no list of different names", where=where, remedy=remedy)
            if strange := [name for name in given if name not in known]:
                raise InputError(f"unknown name {str(strange[0])[:40]!r}", where=where, remedy=remedy)

    @property
    def names(self) -> tuple[str, ...]:
        return tuple(self._name(case, method) for method in self.methods for case in (*self._cases(), _REFUSALS))

    def told(self) -> str:
        return f"stress {','.join(self.axes)} by {','.join(self.methods)}"

    def _cases(self) -> list[str]:
        return [f"{axis} {label}" for axis in self.axes for label in labels(axis)]

    def _name(self, case: str, method: str) -> str:
        return case if len(self.methods) == 1 else f"{case}, {method}"

    def answers(self, law: Law) -> Iterator[_Line]:
        """A line for each name; InputError where the law cannot be asked."""
        formula = load_formula(law)
        check_fixed(formula, "give it in set, grid, draw or table")
        for method in self.methods:
            yield from self._of_method(formula, method)

    def _of_method(self, law: Criterion, method: str) -> Iterator[_Line]:
        def without(case: str, verdict: str, reason: str) -> _Line:
            return self._name(case, method), verdict, None, None, json.dumps({"reason": reason}), 0, 0.0

        contender = _contender(law, method)
        if isinstance(contender, str):
            yield from (without(case, "not_applicable", contender) for case in (*self._cases(), _REFUSALS))
            return
        last, taken = monotonic(), dict[str, float]()

        def on_row(row: Tally) -> None:
            nonlocal last
            now = monotonic()
            taken[f"{row.axis} {row.label}"], last = now - last, now

        found = stress(law, axes=self.axes, contenders=[contender], on_row=on_row)
        if found.interrupted:
            raise KeyboardInterrupt
        rows = {f"{row.axis} {row.label}": row for row in found.rows}
        why = {each.part: each.reason for each in found.left_out}
        for axis in self.axes:
            for case in (f"{axis} {label}" for label in labels(axis)):
                if (row := rows.get(case)) is not None:
                    told = self._name(case, method), _verdict(row), contender.name, None, json.dumps(_witness(row))
                    yield *told, row.points, round(taken[case], 6)
                elif case in why:
                    yield without(case, "undecided", why[case])
                else:
                    yield without(case, "not_applicable", why.get(f"axis {axis}", "the law has none"))
        refused = [{"input": each.what, "place": each.place, "answer": each.answer} for each in found.refusals if not each.held]
        witness = json.dumps({"refused": len(found.refusals) - len(refused), "not": refused})
        told = self._name(_REFUSALS, method), "wrong" if refused else "ok", contender.name, None, witness
        yield *told, len(found.refusals), round(monotonic() - last, 6)


def _contender(law: Criterion, method: str) -> Contender | str:
    """Who is asked, or why the method does not take the law."""
    specimen = Specimen.of(law)
    if method == "auto":
        chosen = Projector.of(specimen.law, specimen.stiffness).method
        return Contender(chosen.name, chosen, chosen.options_of({}))
    reason = METHODS[method]().applies(specimen.unloaded)
    return Contender.of(method, method) if reason is None else reason


def _verdict(row: Tally) -> str:
    return "wrong" if row.wrong_stress or row.wrong_slip else "flagged" if row.flagged or row.failure is not None else "ok"


def _witness(row: Tally) -> Mapping[str, Any]:
    found = {
        "points": row.points,
        "digits": {"stress": round(row.stress_digits, 1), "slip": round(row.slip_digits, 1)},
        "finite": row.finite,
        "in_K": row.feasible,
        "flagged": row.flagged,
        "wrong": {"stress": row.wrong_stress, "slip": row.wrong_slip},
    }
    return found if row.failure is None else found | {"failure": row.failure}
