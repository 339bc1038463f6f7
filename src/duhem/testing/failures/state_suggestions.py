"""What a material does instead of the step of its law, or what is wrong with its tangent: words that hold at many steps beside the failing one.

A word is believed where it gives what was returned at every wrong step, three at the least, of histories beside the one that failed.  Where
the stress is that of the law's own step from the state before (:meth:`duhem.path.state_step.StateLaw.advance`), what is stored is wrong; where
it is not, the criterion is tried with something else in the place of a variable, a force or a parameter.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from duhem.projection.result import Array
from duhem.testing.checks.history import HistoryQuery
from duhem.testing.checks.law_in_state import LawStep
from duhem.testing.checks.query import NoReply, NothingToCheck
from duhem.testing.drawn.case import Case

__all__ = ["beside_in_state", "of_the_state", "of_the_tangent"]

_ROWS, _KNOTS, _LEAST, _ALIKE = 14, 3, 3, 1e-6
_FACTORS = np.geomspace(0.04, 30.0, 14)  # of parameters


def beside_in_state(case: Case) -> Case:
    """Histories like the one of a case, of other sizes and a little turned."""
    rng, d = np.random.default_rng(5), case.trial.shape[1]
    sizes = np.concatenate([[1.0], np.geomspace(0.05, 2.5, _ROWS - 1)])
    turn = np.concatenate([np.zeros((1, d)), rng.normal(size=(_ROWS - 1, d))])
    far = np.abs(case.path).max(initial=np.abs(case.trial).max())

    def same(given: Array | None) -> Array | None:
        return None if given is None else np.repeat(given, _ROWS, axis=0)

    knots = far * rng.normal(size=(_ROWS, _KNOTS, d))  # from other states too, whatever the path that failed
    knots[:, 0], knots[0] = 0.0, 0.0
    zero, loads = np.zeros((_ROWS, d)), None if case.loads is None else np.repeat(same(case.loads[:, -1:]), _KNOTS, axis=1)  # type: ignore[arg-type]
    return replace(
        case, trial=sizes[:, None] * case.trial + 0.3 * far * turn, path=knots, pressure=same(case.pressure), loads=loads, other=zero,
        third=zero, inside=zero, beside=zero, stretch=np.ones(_ROWS),
    )  # fmt: skip


def of_the_state(query: HistoryQuery) -> dict[str, str]:
    """Return by name what explains the wrong steps of histories (:func:`beside_in_state`), the likeliest first."""
    with suppress(NoReply, NothingToCheck, np.linalg.LinAlgError), np.errstate(all="ignore"):
        probe = _Probe(query.law_step, query.accuracy)
        return dict(probe.words())
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
        back = np.argsort(step.of.columns)
        self.apart = np.linalg.norm(self.reference.observed[:, back] - step.after.stress, axis=1)
        size = np.linalg.norm(step.after.stress, axis=1) + np.linalg.norm(self.reference.observed, axis=1)
        self.right = ~self.reference.failed & (self.apart <= self.near * size)
        self.solved = ~self.reference.failed & np.isfinite(step.ended).all(axis=1)

    @cached_property
    def forces(self) -> tuple[Array, Array]:
        """The forces at the beginning and at the end of the steps."""
        return self.own.stored(self.step.begun, self.step.others)[1], self.own.stored(self.step.ended, self.step.others)[1]

    def same(self, one: Array, other: Array, size: Array) -> NDArray[np.bool_]:
        """Which rows (M,) are alike in all columns, to what counts as such of their sizes."""
        return np.asarray((np.abs(one - other) <= self.near * np.abs(size) + 1e-300).all(axis=1))

    def words(self) -> Iterator[tuple[str, str]]:
        step = self.step
        chosen = self.solved & ~step.bound
        flowed = np.linalg.norm(step.change[:, step.of.slips], axis=1) > 1e3 * np.linalg.norm(step.delta[:, step.of.slips], axis=1)
        wrong = chosen & ~self.right & flowed
        size = np.linalg.norm(step.after.stress, axis=1)
        if wrong.sum() >= _LEAST and (self.apart <= 1e-3 * size)[chosen].all():
            off = float((self.apart / size)[wrong].max())
            yield "imprecise", f"the stress is right to {off:.1g} of it only: single precision, a loose tolerance, or too high an accuracy"
            return
        if wrong.sum() >= _LEAST:
            found = [*self._of_the_criterion(wrong, step.ended)]
            if not found:  # what is stored may be wrong too: with what the law's evolution gives
                meant = step.ended.copy()
                meant[:, self.inner][:, step.of.known] = (step.begun[:, self.inner] + step.moved)[:, step.of.known]
                found = [*self._of_the_criterion(wrong, meant)]
            yield from found
            yield from self._of_the_direction(wrong)
            moved, rate, multiplier = step.moved, step.rate, step.multiplier
            flow = np.einsum("ns,nsi->ni", multiplier, step.flow)
        else:
            end, multiplier = self.reference.chi, self.reference.multiplier
            flow, rate = step.flows(end)
            moved, flow = (end - step.begun)[:, self.inner], np.einsum("ns,nsi->ni", multiplier, flow)
        yield from self._of_what_is_kept(chosen)
        rest = chosen & ~flowed & ~step.slipped & (self.reference.multiplier.sum(axis=1) == 0.0)
        off = np.abs(step.change - moved) > 2.0 * step.allowed + self.near * np.abs(moved)
        for stem, at in _stems(self.names).items():
            variables = [i for i in at if i in step.of.known]
            rows = chosen & off[:, variables].any(axis=1)
            still = rest & (np.abs(step.change) > 2.0 * step.allowed)[:, variables].any(axis=1)
            if not variables or rows.sum() < _LEAST:
                continue
            ends = step.ended[:, self.inner]
            found = [*self._stored(stem, rows, variables, moved, ends, ends - step.change, flow, rate, multiplier)]
            if not found and not step.rate.any() and still.sum() >= _LEAST:
                found = [(f"elastic {stem}", f"{stem} changes in elastic steps too")]
            yield from found

    # -- what is stored ------------------------------------------------------------------------------------------------

    def _stored(
        self, stem: str, rows: NDArray[np.bool_], at: list[int], moved: Array, ends: Array, begun: Array, flow: Array, rate: Array,
        multiplier: Array,
    ) -> Iterator[tuple[str, str]]:
        """What was stored for some variables, against what they should change by."""
        size = np.sum([np.abs(x[:, at]).max(axis=1, keepdims=True) for x in (ends, begun, moved)], axis=0)

        def like(found: Array) -> bool:
            return bool(self.same((ends - begun)[rows][:, at], found[rows][:, at], size[rows]).all())

        dt, at_start = self.step.dt[:, None], self.step.flows(self.step.begun)
        first = np.einsum("ns,nsi->ni", multiplier, at_start[0]) + at_start[1]
        at_end = np.einsum("ns,nsi->ni", multiplier, self.step.flow) + self.step.rate
        first = np.where(self.same(first[:, at], at_end[:, at], size)[:, None], np.nan, first)  # of these the evolution says nothing
        tried: list[tuple[str, str, Array]] = [
            ("not-advanced", f"{stem} is not advanced", 0.0 * moved),
            ("not-accumulated", f"{stem} is not accumulated: only what the step adds is kept", moved - begun),
            ("without-time", f"the rate of {stem} is not multiplied by the time step", flow + rate / np.where(dt > 0.0, dt, 1.0)),
            ("no-rate", f"the rate of {stem} without a multiplier, such as its recovery at rest, is left out", flow),
            ("no-flow", f"{stem} changes by its rate alone, and not with the multiplier", rate),
            ("old-evolution", f"the change of {stem} is taken at the state before the step", first),
        ]
        for name, said, found in tried:
            if like(found):
                yield f"{name} {stem}", said
                return
        with np.errstate(all="ignore"):
            ratio = ((ends - begun) / moved)[rows][:, at]
        ratio = ratio[np.isfinite(ratio) & (np.abs(moved)[rows][:, at] > 1e-3 * size[rows])]
        if ratio.size and np.ptp(ratio) <= 1e3 * self.near * np.abs(ratio).max():
            factor = float(np.median(ratio))
            often = {2.0: "twice", -1.0: "with the opposite sign"}.get(round(factor, 6), f"{factor:.6g} times what the law gives")
            yield f"advanced {factor:.4g} {stem}", f"{stem} is advanced {often}"
            return
        if (order := self._order(rows, at, begun + moved, ends, size)) is not None:
            yield f"order {stem}", order
            return
        yield from self._of_a_parameter(stem, rows, at)

    def _order(self, rows: NDArray[np.bool_], at: list[int], right: Array, ends: Array, size: Array) -> str | None:
        """Whether variables are stored in the places of others."""
        places = [next((j for j in self.step.of.known if self.same(ends[rows, i : i + 1], right[rows, j : j + 1], size[rows]).all()), -1) for i in at]
        if -1 in places or places == at:
            return None
        pairs = [f"{self.names[i]} holds {self.names[j]}" for i, j in zip(at, places, strict=True) if i != j]
        return f"the state is returned in another order: {', '.join(pairs)}"

    def _of_a_parameter(self, stem: str, rows: NDArray[np.bool_], at: list[int]) -> Iterator[tuple[str, str]]:
        """Whether another value of one parameter gives the evolution, the multiplier being that of the slips."""
        step = self.step
        i = int(np.flatnonzero(rows)[np.abs(step.off[rows][:, at]).max(axis=1).argmax()])
        v = at[int(np.abs(step.off[i, at]).argmax())]
        for place, name in enumerate(self.own.others):
            given = step.others[place]

            def off(factor: float, place: int = place, given: Array = given) -> Array:
                others = [*step.others]
                others[place] = factor * given
                asked = replace_others(step, others)
                flow, rate = asked.flows()
                return np.asarray(step.change - np.einsum("ns,nsi->ni", step.multiplier, flow) - rate)

            for factor in (0.0, *_roots(lambda c, off=off: float(off(c)[i, v]))):  # type: ignore[misc]
                size = (np.abs(step.change) + np.abs(step.ended[:, self.inner]))[:, at].max(axis=1, keepdims=True)
                if (np.abs(off(factor))[rows][:, at] <= 1e2 * self.near * size[rows] + 1e-300).all():
                    often = f"taken {factor:.6g} times as large" if factor else "left out"
                    yield f"{name} {stem}", f"in the evolution of {stem}, {name} is {often}"
                    return

    def _of_what_is_kept(self, chosen: NDArray[np.bool_]) -> Iterator[tuple[str, str]]:
        """What is kept of the slips, against the stress."""
        step = self.step
        told = [each.told for each in step.of.more]
        if not told:
            return
        at = [each.place for each in step.of.more]
        ends, begun = step.after.variables[:, at], step.before.variables[:, at]
        (values, allowed), first = step.derived(), step.derived(step.begun)[0]
        size = np.abs(ends).max(axis=1, keepdims=True) + np.abs(values).max(axis=1, keepdims=True)
        for stem, places in _stems(told).items():
            rows = chosen & (np.abs(ends - values)[:, places] > allowed[:, places] + self.near * size).any(axis=1)
            if rows.sum() < _LEAST:
                continue
            order = [next((j for j in places if self.same(ends[rows, i : i + 1], values[rows, j : j + 1], size[rows]).all()), -1) for i in places]
            if -1 not in order and order != places:
                pairs = ", ".join(f"{told[i]} holds {told[j]}" for i, j in zip(places, order, strict=True) if i != j)
                yield f"order {stem}", f"the state is returned in another order: {pairs}"
                continue
            one = (ends[:, places], begun[:, places], (values - first)[:, places], values[:, places])
            kept, former, change, right = (x[rows] for x in one)
            if self.same(kept, former, size[rows]).all():
                yield f"not-advanced {stem}", f"{stem} is not advanced"
            elif self.same(kept, change, size[rows]).all():
                yield f"not-accumulated {stem}", f"{stem} is not accumulated: only what the step adds is kept"
            elif (ratios := _ratios(kept, right)) is not None:
                odd = {told[places[j]]: r for j, r in enumerate(ratios) if abs(r - 1.0) > 1e-6}
                shears = {name for name in odd if len({*name.rpartition("_")[2]}) == 2}
                said = "shear strains of the tensor, not of engineers" if shears == {*odd} and {round(x, 6) for x in odd.values()} == {0.5} else ""
                each = ", ".join(f"{name} {r:.6g} times as large" for name, r in odd.items())
                yield f"kept {stem}", f"{stem} is kept as {said or each}"

    # -- what the stress is ----------------------------------------------------------------------------------------------

    def _level(self, forces: Array, chi: Array, others: Sequence[Array]) -> Array:
        """The greatest g (M,)."""
        taken = np.concatenate([forces, chi], axis=1)
        return np.max([criterion.first(taken, others)[0] for criterion, _, _ in self.own.criteria], axis=0)

    def _instead(self, end: Array) -> Iterator[tuple[str, str, Array, Array]]:
        """What may stand in the criterion in the place of something: a name, words, forces and chi."""
        (forces_0, forces), law, step = self.forces, self.own.law, self.step
        observed = {*law.variables.observed(), *(() if law.energy is not None else law.forces)}  # type: ignore[attr-defined]
        hidden = {s: at for s, at in _stems(law.forces).items() if not {law.forces[i] for i in at} & observed}
        driven = {own.force: name for name, own in law.variables.items()}
        for stem, at in hidden.items():
            named = next((s for s, a in _stems(self.names).items() if {self.names[i] for i in a} == {driven[law.forces[j]] for j in at}), stem)
            what = f"the force {stem} of {named}"
            for key, other, said in (
                ("left-out", 0.0 * forces, f"{what} (its back stress or hardening) does not enter the yield check"),
                ("old-in-check", forces_0, f"{what} in the yield check is that before the step"),
                ("opposite-in-check", -forces, f"{what} enters the yield check with the opposite sign"),
            ):
                changed = forces.copy()
                changed[:, at] = other[:, at]
                yield f"{key} {named}", said, changed, end
        for stem, at in _stems(self.names).items():
            columns = [self.inner.start + i for i in at if i in step.of.known]
            for key, chi, said in (
                ("left-out", 0.0 * end, f"{stem} does not enter the yield check"),
                ("old-in-check", step.begun, f"{stem} in the yield check is that before the step: the hardening of the old step"),
                ("opposite-in-check", -end, f"{stem} enters the yield check with the opposite sign"),
            ):
                changed = end.copy()
                changed[:, columns] = chi[:, columns]
                if columns:
                    yield f"{key} {stem}", said, forces, changed

    def _of_the_criterion(self, wrong: NDArray[np.bool_], end: Array) -> Iterator[tuple[str, str]]:
        """What the yield check takes instead, the state at the end of the steps being ``end``."""
        step = self.step
        if not self.own.criteria:
            return
        forces = self.forces[1]
        level = self._level(forces, end, step.others)
        rows = wrong & ~(np.abs(level) <= 4.0 * step.level_allowed.min(axis=1, initial=np.inf))
        if rows.sum() < _LEAST:
            return
        allowed = 8.0 * step.level_allowed.max(axis=1) + self.near * step.size.max(axis=1)
        for name, said, changed, chi in self._instead(end):
            if (np.abs(self._level(changed, chi, step.others))[rows] <= allowed[rows]).all():
                yield name, said
        i = int(np.flatnonzero(rows)[np.abs(level[rows] / allowed[rows]).argmax()])
        if (warm := self.own.law.temperature) is not None:

            def at(factor: float) -> Array:
                chi = end.copy()
                chi[:, -1] *= factor
                return self._level(forces, chi, step.others)

            for factor in _roots(lambda c: float(at(c)[i])):
                if (np.abs(at(factor))[rows] <= allowed[rows]).all():
                    yield f"temperature {warm}", f"the temperature {warm} is taken as {factor * step.ended[i, -1]:.6g} whatever it is, not {step.ended[i, -1]:.6g}"
        for place, name in enumerate(self.own.others):

            def of(factor: float, place: int = place) -> Array:
                others = [*step.others]
                others[place] = factor * others[place]
                return self._level(forces, end, others)

            for factor in _roots(lambda c, of=of: float(of(c)[i])):  # type: ignore[misc]
                if (np.abs(of(factor))[rows] <= allowed[rows]).all():
                    yield f"parameter {name}", f"in the yield check {name} is taken as {factor * step.others[place][0]:.6g}, not {step.others[place][0]:.6g}"

        for factor in _roots(lambda c: float(self._level(c * forces, end, step.others)[i])):
            if (np.abs(self._level(factor * forces, end, step.others))[rows] <= allowed[rows]).all():
                yield "size of the stress", f"the stress in the yield check is {factor:.6g} times what it is, or the limit {1.0 / factor:.6g} times"

    def _of_the_direction(self, wrong: NDArray[np.bool_]) -> Iterator[tuple[str, str]]:
        step, slips = self.step, self.step.of.slips
        rows = wrong & (np.abs(step.off) > 2.0 * step.allowed)[:, slips].any(axis=1)
        if rows.sum() < _LEAST or len(self.own.criteria) != 1 or not slips.size:
            return
        criterion, associated, _ = self.own.criteria[0]
        change = (step.change - step.rate)[rows][:, slips]
        place = [self.own.order.tolist().index(i) for i in slips.tolist()]

        def along(way: Array) -> bool:
            amount = (change * way).sum(axis=1) / (way * way).sum(axis=1)
            return bool(self.same(change, amount[:, None] * way, np.linalg.norm(change, axis=1, keepdims=True)).all() and (amount > 0.0).all())

        for name, said, forces, chi in self._instead(step.ended):
            taken = np.concatenate([forces, chi], axis=1)
            if associated and along(criterion.first(taken, step.others)[1][rows][:, place]):
                yield f"direction {name}", f"the plastic strain goes where it would if {said.replace('the yield check', 'its direction')}"
        for said, forces, chi in (("of the law's g, and not of its own flow", self.forces[1], step.ended), ("of the state before the step", self.forces[0], step.begun)):
            way = criterion.first(np.concatenate([forces, chi], axis=1), step.others)[1][rows][:, place]
            if along(way):
                yield f"direction {said}", f"the plastic strain goes in the direction of the normal {said}"
        flow = np.einsum("ns,nsi->ni", step.multiplier, step.flow)[rows][:, slips]
        if (ratios := _ratios(change, flow)) is not None and np.ptp(ratios) > 1e-6:
            least = float(np.median(ratios))
            odd = ", ".join(f"{self.names[slips[j]]} {r / least:.6g}" for j, r in enumerate(ratios) if abs(r / least - 1.0) > 1e-6)
            yield "components of the flow", f"components of the plastic strain are too large or small beside the others, by these factors: {odd}"


def replace_others(step: LawStep, others: Sequence[Array]) -> LawStep:
    """The same steps with other numbers, not measured anew."""
    asked = object.__new__(LawStep)
    asked.__dict__.update(step.__dict__, others=others)
    return asked


def _roots(off: Callable[[float], float]) -> Iterator[float]:
    """Factors beside 1 at which a function changes its sign."""
    values = np.array([off(float(c)) for c in _FACTORS])
    for j in np.flatnonzero(np.sign(values[:-1]) * np.sign(values[1:]) < 0):
        found = float(brentq(off, _FACTORS[j], _FACTORS[j + 1], xtol=1e-13, rtol=1e-13))
        if abs(found - 1.0) > 1e-6:
            yield found


def _ratios(one: Array, other: Array) -> Array | None:
    """Of each column (M, k) the factor from one to the other, 1 where both vanish; None where a column has none."""
    found = np.ones(one.shape[1])
    for j in range(one.shape[1]):
        big = np.abs(other[:, j]) > 1e-2 * np.abs(other).max(axis=1)
        if not big.any():
            continue
        ratio = one[big, j] / other[big, j]
        if np.ptp(ratio) > 1e-4 * np.abs(ratio).max():
            return None
        found[j] = np.median(ratio)
    return found


# -- tangents ------------------------------------------------------------------------------------------------------------


def of_the_tangent(query: HistoryQuery) -> dict[str, str]:
    """Return what is wrong with the tangent of the first increment of a case, component by component."""
    with suppress(NoReply, NothingToCheck), np.errstate(all="ignore"):
        given, k = query.here.tangent, query.case.stiffness
        if given is None:
            return {}
        size, d = float(query.length(query.here.trial)[0] + query.length(query.here.stress)[0]), len(k)
        columns, spread = [], []
        for j in range(d):
            way = k[:, j] / np.sqrt(k[j, j])
            h = 1e-5 * (size or 1.0)
            ends = query.ask(*(query.here.trial + s * h * way for s in (1.0, -1.0, 0.5, -0.5)))
            slopes = [(ends[i].stress - ends[i + 1].stress)[0] / (s * h) * np.sqrt(k[j, j]) for i, s in ((0, 2.0), (2, 1.0))]
            columns.append(slopes[1])
            spread.append(np.abs(slopes[0] - slopes[1]))
        right, scale = np.stack(columns, axis=1), np.sqrt(np.outer(np.diag(k), np.diag(k)))
        wrong = np.abs(given[0] - right) > 1e-4 * scale + 2.0 * np.stack(spread, axis=1)
        found: Mapping[str, tuple[Any, str]] = {
            "not-set": (np.zeros((d, d)), "the tangent is not set: it is zero"),
            "elastic-tangent": (k, "the tangent is the elastic stiffness although there is slip"),
            "transposed": (right.T, "the tangent is transposed"),
        }
        for name, (other, said) in found.items():
            if (np.abs(given[0] - other) <= 1e-4 * scale).all():
                return {name: said}
        if not wrong.any() or not np.isfinite(given).all():
            return {"not-set": "the tangent is not a number"} if not np.isfinite(given).all() else {}
        places = [f"({i + 1}, {j + 1}), {given[0, i, j]:.6g} for {right[i, j]:.6g}" for i, j in np.argwhere(wrong)]
        said = "; ".join(places[:6]) + (f"; and {len(places) - 6} more" if len(places) > 6 else "")
        return {"tangent-components": f"the tangent is wrong in {len(places)} of {d * d} components: {said}"}
    return {}
