"""What a material does instead of the step of its law: words that hold at many steps beside.

A word is believed where it gives what was returned at every wrong step, three at the least, of histories beside the one that failed.
Where the stress is that of the law's own step from the state before (:meth:`duhem.path.state_step.StateLaw.advance`), what is stored is
wrong; where it is not, the criterion is tried with something else in the place of a variable, a force or a parameter.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from duhem.projection.result import Array
from duhem.testing.checks.history import HistoryQuery
from duhem.testing.checks.law_in_state import LawStep
from duhem.testing.checks.query import NoReply, NothingToCheck
from duhem.testing.drawn.case import Case

__all__ = ["IMPRECISE", "beside_in_state", "of_the_state", "roots"]

IMPRECISE = "single precision, a loose tolerance, or too high a promised accuracy"

_ROWS, _KNOTS, _LEAST, _ALIKE = 14, 3, 3, 1e-6
_FACTORS = np.geomspace(0.04, 30.0, 14)  # of parameters, between which it is looked for the one that explains
_OFTEN = {0.0: "not advanced", 2.0: "advanced twice", -1.0: "advanced with the opposite sign"}

Rows: TypeAlias = NDArray[np.bool_]
Words: TypeAlias = Iterator[tuple[str, str]]  # by name


def beside_in_state(case: Case) -> Case:
    """Return histories like that of a case: of other sizes, a little turned, and from other states."""
    rng, d = np.random.default_rng(5), case.trial.shape[1]
    sizes = np.concatenate([[1.0], np.geomspace(0.05, 2.5, _ROWS - 1)])
    turn = np.concatenate([np.zeros((1, d)), rng.normal(size=(_ROWS - 1, d))])
    far = np.abs(case.path).max(initial=np.abs(case.trial).max())
    knots = far * rng.normal(size=(_ROWS, _KNOTS, d))
    knots[:, 0], knots[0], zero = 0.0, 0.0, np.zeros((_ROWS, d))
    load = None if case.pressure is None else np.repeat(case.pressure, _ROWS)
    return replace(
        case, trial=sizes[:, None] * case.trial + 0.3 * far * turn, path=knots, pressure=load, other=zero, third=zero, inside=zero,
        beside=zero, stretch=np.ones(_ROWS), loads=None if load is None else np.repeat(load[:, None], _KNOTS, axis=1),
    )  # fmt: skip


def of_the_state(query: HistoryQuery) -> dict[str, str]:
    """Return by name what explains the wrong steps of histories (:func:`beside_in_state`), the likeliest first."""
    with suppress(NoReply, NothingToCheck, np.linalg.LinAlgError), np.errstate(all="ignore"):
        return dict(_Probe(query.law_step, query.accuracy).words())
    return {}


def _stems(names: Sequence[str]) -> dict[str, list[int]]:
    """The places of names that differ in their endings alone, by what they have in common; others by themselves."""
    found: dict[str, list[int]] = {}
    for i, name in enumerate(names):
        found.setdefault(name.rpartition("_")[0] or name, []).append(i)
    return {(stem if len(at) > 1 else names[at[0]]): at for stem, at in found.items()}


class _Probe:
    """Steps of a routine beside the law's own, and what is wrong with them."""

    def __init__(self, step: LawStep, accuracy: float) -> None:
        self.step, self.own, self.near = step, step.of.own, max(_ALIKE, 10.0 * accuracy)
        o = self.own.observables
        self.inner, self.names = slice(o, o + self.own.internal), self.own.names[o : o + self.own.internal]
        given = step.ended[:, [*range(o), *range(o + self.own.internal, len(self.own.names))]]
        self.reference = self.own.advance(step.begun, given, float(step.dt[0]), step.others)
        self.forces = [self.own.stored(chi, step.others)[1] for chi in (step.begun, step.ended)]

    def alike(self, one: Array, other: Array, size: Array) -> bool:
        """Whether numbers (M, k) are alike, to what counts as such of their sizes."""
        return bool((np.abs(one - other) <= self.near * np.abs(size) + 1e-300).all())

    def words(self) -> Words:
        step, ref = self.step, self.reference
        size = np.linalg.norm(step.after.stress, axis=1)
        apart = np.linalg.norm(ref.observed[:, np.argsort(step.of.columns)] - step.after.stress, axis=1)
        chosen = ~ref.failed & np.isfinite(step.ended).all(axis=1) & ~step.bound
        flowed = np.linalg.norm(step.change[:, step.of.slips], axis=1) > 1e3 * np.linalg.norm(step.delta[:, step.of.slips], axis=1)
        wrong = chosen & flowed & (apart > self.near * (size + np.linalg.norm(ref.observed, axis=1)))
        if wrong.sum() < _LEAST:
            flow, rate, multiplier, moved = *step.flows(ref.chi), ref.multiplier, (ref.chi - step.begun)[:, self.inner]
        elif (apart <= 1e-3 * size)[chosen].all():
            least = float((apart / size)[wrong].max())
            yield "imprecise", f"the stress is right to {least:.1g} of its size only: {IMPRECISE}"
            return
        else:
            flow, rate, multiplier, moved = step.flow, step.rate, step.multiplier, step.moved
            found = [*self._of_the_criterion(wrong, step.ended)] or [*self._of_the_criterion(wrong, self._meant(moved))]
            for name, said, by, chi in self._of_the_direction(wrong):
                if not found:  # the multiplier is that of the other direction
                    multiplier, (flow, rate) = by, step.flows(chi)
                    moved = np.einsum("ns,nsi->ni", multiplier, flow) + rate
                    found = [*self._of_the_criterion(wrong, self._meant(moved))]
                found.append((name, said))
            yield from found
        flow = np.einsum("ns,nsi->ni", multiplier, flow)
        yield from self._of_what_is_kept(chosen) if step.of.more else ()
        still = chosen & ~flowed & ~step.slipped & (ref.multiplier.sum(axis=1) == 0.0)
        off = np.abs(step.change - moved) > 2.0 * step.allowed + self.near * np.abs(moved)
        ends, dt = step.ended[:, self.inner], step.dt[:, None]
        for stem, every in _stems(self.names).items():
            at = [i for i in every if i in step.of.known]
            rows = chosen & off[:, at].any(axis=1)
            if not at or rows.sum() < _LEAST:
                continue
            stored = ends[rows], (ends - step.change)[rows], (ends - step.change + moved)[rows]
            others = {
                f"the rate of {stem} is not multiplied by the time step": flow + rate / np.where(dt > 0.0, dt, 1.0),
                f"the rate of {stem} without a multiplier, such as its recovery at rest, is left out": flow,
                f"{stem} changes by its rate alone, and not with the multiplier": rate,
            }
            by_rate = {said: x[rows] for said, x in others.items() if rate[:, at].any()}
            found = [*self._stored(stem, self.names, at, step.of.known.tolist(), by_rate, *stored)]
            found = found or [*self._of_a_parameter(stem, rows, at)]
            if not found and not rate.any() and (still & off[:, at].any(axis=1)).sum() >= _LEAST:
                found = [(f"elastic {stem}", f"{stem} changes in elastic steps too")]
            yield from found

    def _meant(self, moved: Array) -> Array:
        """chi at the end with variables that change by ``moved``: what is stored may be wrong too."""
        meant, known = self.step.ended.copy(), self.step.of.known
        meant[:, self.inner][:, known] = (self.step.begun[:, self.inner] + moved)[:, known]
        return meant

    # -- what is stored ------------------------------------------------------------------------------------------------

    def _stored(
        self, stem: str, names: Sequence[str], at: list[int], places: list[int], others: Mapping[str, Array], *kept: Array
    ) -> Words:
        """What was ``kept`` of some variables ``at``: (M, k) at the end and the beginning, and what is right; it may be of ``others``."""
        ends, begun, right = kept
        size = np.sum([np.abs(x[:, at]).max(axis=1, keepdims=True) for x in (ends, begun, right)], axis=0)
        change, moved = (ends - begun)[:, at], (right - begun)[:, at]
        for said, other in {f"{stem} is not accumulated: only what the step adds is kept": right - 2.0 * begun, **others}.items():
            if self.alike(change, other[:, at], size):
                yield said, said
                return
        ratio = (change / moved)[np.abs(moved) > 1e-3 * size]
        if self.alike(change, 0.0 * change, size) or (ratio.size and np.ptp(ratio) <= 1e3 * self.near * np.abs(ratio).max()):
            factor = round(float(np.median(ratio)), 6) if ratio.size else 0.0
            if factor == 1.0:  # as the law gives here: the mistake is elsewhere
                return
            yield f"advanced {factor} {stem}", f"{stem} is {_OFTEN.get(factor, f'advanced {factor:.6g} times what the law gives')}"
            return
        held = [next((j for j in places if self.alike(ends[:, i : i + 1], right[:, j : j + 1], size)), -1) for i in at]
        if -1 not in held and held != at:
            pairs = ", ".join(f"{names[i]} holds {names[j]}" for i, j in zip(at, held, strict=True) if i != j)
            yield f"order {stem}", f"the state is returned in another order: {pairs}"
        shear = np.array([0.5 if len({*names[i].rpartition("_")[2]}) == 2 else 1.0 for i in at])
        if self.alike(ends[:, at], right[:, at] * shear, size) and (shear < 1.0).any():
            yield f"shears {stem}", f"{stem} is kept as shear strains of the tensor, not of engineers"

    def _of_what_is_kept(self, chosen: Rows) -> Words:
        """What is kept of the slips, against the stress."""
        step, told = self.step, [each.told for each in self.step.of.more]
        at = [each.place for each in step.of.more]
        (values, allowed), (former, _) = step.derived(), step.derived(step.begun)
        ends, begun = step.after.variables[:, at], step.before.variables[:, at]
        size = np.abs(ends).max(axis=1, keepdims=True) + np.abs(values).max(axis=1, keepdims=True)
        for stem, places in _stems(told).items():
            rows = chosen & (np.abs(ends - values)[:, places] > allowed[:, places] + self.near * size).any(axis=1)
            if rows.sum() >= _LEAST:
                added = (values - former + begun)[rows]  # what was kept before may be wrong already
                found = [*self._stored(stem, told, places, places, {}, ends[rows], begun[rows], added)]
                yield from found or self._stored(stem, told, places, places, {}, ends[rows], former[rows], values[rows])

    def _of_a_parameter(self, stem: str, rows: Rows, at: list[int]) -> Words:
        """Whether another value of one parameter gives the evolution, the multiplier being that of the slips."""
        step = self.step
        size = (np.abs(step.change) + np.abs(step.ended[:, self.inner]))[:, at].max(axis=1, keepdims=True)
        for name, _, others in self._other_numbers():

            def off(factor: float, others: Callable[[float], list[Array]] = others) -> Array:
                flow, rate = step.flows(others=others(factor))
                return np.asarray(step.change - np.einsum("ns,nsi->ni", step.multiplier, flow) - rate)[:, at]

            for factor in self._factors(off, rows, 1e2 * self.near * size, 0.0):
                often = f"taken {factor:.6g} times as large" if factor else "left out"
                yield f"{name} {stem}", f"in the evolution of {stem}, {name} is {often}"
                return

    def _other_numbers(self) -> Iterator[tuple[str, float, Callable[[float], list[Array]]]]:
        """Each parameter, its value, and the numbers with so many times that."""
        given = self.step.others
        for place, name in enumerate(self.own.others):
            now = float(given[place][0])
            yield name, now, lambda c, place=place: [c * x if j == place else x for j, x in enumerate(given)]  # type: ignore[misc]

    def _factors(self, off: Callable[[float], Array], rows: Rows, allowed: Array, *first: float) -> Iterator[float]:
        """Factors beside 1 with which (M, k) values are 0 to what is ``allowed`` at all ``rows``: the ``first``, and those found at one."""
        worst = np.where(rows[:, None], np.abs(off(1.0) / allowed), 0.0)
        i, j = np.unravel_index(np.nan_to_num(worst).argmax(), worst.shape)
        for factor in (*first, *roots(lambda tried: np.array([off(float(c))[i, j] for c in tried]), _FACTORS)):
            if abs(factor - 1.0) > _ALIKE and (np.abs(off(factor)) <= allowed)[rows].all():
                yield factor

    # -- what the stress is --------------------------------------------------------------------------------------------

    def _taken(self, end: Array) -> Array:
        """What the criteria take at the end of the steps, the state there being ``end``: forces and chi."""
        return np.concatenate([self.forces[1], end], axis=1)

    def _instead(self, taken: Array) -> Iterator[tuple[str, str, Array]]:
        """What may stand in the criterion in the place of something: a name, words, and what the criteria take then."""
        law, known, before = self.own.law, self.step.of.known, np.concatenate([self.forces[0], self.step.begun], axis=1)
        driven = {own.force: name for name, own in law.variables.items() if own.internal}
        stems, places = _stems(self.names), list[tuple[str, str, list[int]]]()
        for stem, at in _stems(law.forces).items():
            if not {law.forces[i] for i in at} & self.step.of.observed:
                variables = {driven[law.forces[i]] for i in at}
                named = next((s for s, a in stems.items() if {self.names[i] for i in a} == variables), stem)
                places.append((named, f"the force {stem} of {named} (its back stress or hardening)", at))
        first = len(law.forces) + self.inner.start
        places += [(stem, stem, own) for stem, at in stems.items() if (own := [first + i for i in at if i in known])]
        for key, said, columns in places:
            for name, words, other in (
                ("left-out", "does not enter the yield check", 0.0 * taken),
                ("old", "in the yield check is that before the step: the hardening of the old step", before),
                ("opposite", "enters the yield check with the opposite sign", -taken),
            ):
                now = taken.copy()
                now[:, columns] = other[:, columns]
                yield f"{name} {key}", f"{said} {words}", now

    def _of_the_criterion(self, wrong: Rows, end: Array) -> Words:
        """What the yield check takes instead, the state at the end of the steps being ``end``."""
        step, law, taken = self.step, self.own.law, self._taken(end)

        def level(taken: Array, others: Sequence[Array] = step.others) -> Array:
            return np.max([criterion.first(taken, others)[0] for criterion, _, _ in self.own.criteria], axis=0)[:, None]

        if not self.own.criteria:
            return
        rows = wrong & ~(np.abs(level(taken))[:, 0] <= 4.0 * step.level_allowed.min(axis=1))
        if rows.sum() < _LEAST:
            return
        allowed = (8.0 * step.level_allowed.max(axis=1) + self.near * step.size.max(axis=1))[:, None]
        for name, said, changed in self._instead(taken):
            if (np.abs(level(changed)) <= allowed)[rows].all():
                yield name, said
        columns = np.arange(taken.shape[1])
        tried: list[tuple[str, float | None, Callable[[float], Array]]] = []
        if law.temperature is not None:
            warm, now = columns == columns[-1], float(end[0, -1])
            tried.append((f"the temperature {law.temperature}", now, lambda c: level(np.where(warm, c * taken, taken))))
        for name, value, others in self._other_numbers():
            tried.append((f"in the yield check {name}", value, lambda c, others=others: level(taken, others(c))))  # type: ignore[misc]
        of_force = columns < len(law.forces)
        said = "in the yield check the stress, beside the limit,"
        tried.append((said, None, lambda c: level(np.where(of_force, c * taken, taken))))
        for said, value, of in tried:  # type: ignore[assignment]
            for factor in self._factors(of, rows, allowed):
                times = f"{factor:.6g} times as large, or the limit {1.0 / factor:.6g} times"
                yield said, f"{said} is taken {times if value is None else f'as {factor * value:.6g}, not {value:.6g}'}"

    def _of_the_direction(self, wrong: Rows) -> Iterator[tuple[str, str, Array, Array]]:
        """Where the plastic strain goes: a name, words, the multiplier (M, 1), and chi as the direction takes it."""
        step, slips = self.step, self.step.of.slips
        rows = wrong & (np.abs(step.off) > 2.0 * step.allowed)[:, slips].any(axis=1)
        if rows.sum() < _LEAST or len(self.own.criteria) != 1 or not slips.size:
            return
        (criterion, associated, _), change = self.own.criteria[0], (step.change - step.rate)[:, slips]
        place = [self.own.order.tolist().index(i) for i in slips.tolist()]
        for name, said, taken in self._instead(self._taken(step.ended)) if associated else ():
            way = criterion.first(taken, step.others)[1][:, place]
            amount = np.nan_to_num((change * way).sum(axis=1, keepdims=True) / (way * way).sum(axis=1, keepdims=True))
            along, size = amount * way, np.linalg.norm(change, axis=1, keepdims=True)
            if self.alike(change[rows], along[rows], size[rows]) and (amount[rows] > 0.0).all():
                words = f"the plastic strain goes where it would if {said.replace('the yield check', 'its direction')}"
                yield f"direction {name}", words, amount, taken[:, len(self.own.order) :]


def roots(level: Callable[[Array], Array], points: Array) -> Iterator[float]:
    """Where a function of (M,) values changes its sign between neighbouring ``points``, to the last digit."""
    signs = np.sign(level(points))
    for i in np.flatnonzero(signs[:-1] * signs[1:] < 0):
        sides = points[i], points[i + 1]  # where the level is flat a step only halves them
        yield float(brentq(lambda x: level(np.array([x]))[0], *sides, xtol=1e-300, rtol=1e-15, maxiter=2_000))
