"""A law with a state as a routine keeps it: where its variables stand in the routine's state, and what it asks of a step.

With the state chi = (u, alpha, T) read from the routine before and after a step, the implicit step of the law asks that

    g(Y; chi) <= 0,   alpha - alpha_n = lambda h(Y; chi) + dt r(Y; chi),   lambda >= 0,   lambda g = 0        (duhem.path.state_step).

Slips, the variables of forces whose observables are the strains, are read from sigma = d psi/d u, all others from the places given
to them; a place given to a slip too is compared with that.  lambda fits the slips by least squares in the energy of the stiffness, and
all variables where the law has no slips.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import sympy as sp
from numpy.typing import NDArray
from scipy.optimize import nnls

from duhem.errors import InputError
from duhem.expression.branches import gradient
from duhem.expression.parse import parse_expression
from duhem.law.formula_law import Criterion
from duhem.law.state import prescribed
from duhem.path.state_step import Guess, StateFormula, StateLaw, StepEquations
from duhem.projection.projector import Projector
from duhem.projection.result import Array, Status
from duhem.testing.checks.query import NEAR
from duhem.testing.routines import Material, MaterialState

__all__ = ["Kept", "LawInState", "LawStep", "Places"]

_NEWTON = 40
_MET = 1e-14
_TURNED = 1e-3  # of a direction, over a millionth of the stress
_EPS = float(np.finfo(np.float64).eps)
_WORD = re.compile(r"[A-Za-z_]\w*")

Places = Mapping[str, int | slice | Sequence[int]]


@dataclass(frozen=True, eq=False)
class Kept:
    """What stands at one ``place`` of the routine's state: a ``formula`` of the law's variables, as it was ``told``."""

    told: str
    place: int
    formula: StateFormula


@dataclass(frozen=True, eq=False)
class LawInState:
    """``own`` is the law as its steps take it; ``columns`` (o,) has the component of the material of each observable.

    ``observed`` are the forces whose observables are the strains; ``first`` is what is read from the state alone, for the internal
    variables ``known``, and ``slips`` those read from the stress; ``more`` is what is kept of these too.  ``places`` are those of all
    that is kept, as it was told.
    """

    own: StateLaw
    columns: NDArray[np.intp]
    first: tuple[Kept, ...]
    known: NDArray[np.intp]
    slips: NDArray[np.intp]
    observed: frozenset[str]
    more: tuple[Kept, ...]
    places: Mapping[str, list[int]]

    @classmethod
    def of(cls, law: Criterion, material: Material, parameters: Mapping[str, Any], state: Places | None) -> LawInState:
        """The ``state`` is that of the material where left out.

        InputError for parameters without a value, components that do not fit, and a state that does not tell the law's variables.
        """
        where = f"state of {law.name}"
        if law.heat:
            what = f"the temperature of {law.name} follows from heat"
            raise InputError(what, where=law.name, remedy="remove [heat]: a routine is given its temperature")
        warm = law.temperature
        fixed = law.fix({name: value for name, value in parameters.items() if name != warm})
        if open_ := [n for n, d in fixed.parameters.items() if n not in law.variables and d.value is None]:
            what = f"the parameter {open_[0]} has no value, and a material contains its own"
            raise InputError(what, where=law.name, remedy=f'give it, for example parameters={{"{open_[0]}": ...}}')
        forces, d = prescribed(fixed), len(material.elastic)
        tails = [name.rpartition("_")[2] for name in forces]
        if len(forces) != d:
            what = f"the law has {len(forces)} components of stress ({', '.join(forces)}), and the routine {d}"
            raise InputError(what, where=law.name, remedy="state the law in the routine's components")
        own_order = {*tails} == {*material.components}
        columns = np.array([material.components.index(t) for t in tails] if own_order else range(d), dtype=np.intp)
        k = material.elastic[np.ix_(columns, columns)]
        own = StateLaw.of(fixed, k if fixed.energy is None else None, columns=d + (warm is not None))
        places = {told: _listed(at, material) for told, at in (material.state or {} if state is None else state).items()}
        kept = _read_places(own, places, material, tails, where)
        inner = own.names[d : d + own.internal]
        observed = frozenset((*law.variables.observed(), *(() if law.energy is not None else law.forces)))  # type: ignore[attr-defined]
        slipping = {int(own.order[i]) for i, f in enumerate(law.forces) if f in observed}

        def within(each: Kept) -> set[int]:
            return {int(c) - d for c in each.formula.columns if d <= c < d + own.internal}

        first = tuple(each for each in kept if within(each) and not within(each) & slipping)
        known = sorted(set().union(*map(within, first)))
        slips = sorted({*range(own.internal)} - {*known})
        stress = set[sp.Basic]().union(*(slope.free_symbols for slope in gradient(own.energy, own.symbols[:d])))
        if lost := [inner[i] for i in slips if i not in slipping and own.symbols[d + i] not in stress]:
            what = f"nothing says what {lost[0]} is: no place is given, and the stress does not depend on it"
            raise InputError(what, where=where, remedy=f'give its place in STATEV, counted from 0: state={{"{lost[0]}": 0}}')
        if len(first) < len(known):
            what = f"{len(first)} places cannot tell {', '.join(inner[i] for i in known)}"
            raise InputError(what, where=where, remedy="give a place for each")
        more = tuple(each for each in kept if each not in first)
        return cls(own, columns, first, np.array(known, dtype=np.intp), np.array(slips, dtype=np.intp), observed, more, places)

    # -- reading -------------------------------------------------------------------------------------------------------

    def others(self, n: int, pressure: Array | None) -> list[Array]:
        """The numbers that the formulas take beside the variables, each (N,)."""
        law, load = self.own.law, np.zeros(n) if pressure is None else pressure
        return [load if name == law.pressure else np.full(n, law.parameters[name].value, np.float64) for name in self.own.others]

    def read(self, state: MaterialState, others: Sequence[Array], near: Array | None = None) -> Array:
        """chi (N, n) of a state of the routine; nan where its equations have no solution.  ``near`` is where they are begun."""
        own, n, o = self.own, len(state), self.own.observables
        chi = np.zeros((n, len(own.names))) if near is None else near.copy()
        if near is None:
            chi[:, o : o + own.internal] = np.clip(0.0, own.low, own.high)
        chi[:, :o] = state.strain[:, self.columns]
        if own.law.temperature is not None:
            assert state.temperature is not None
            chi[:, -1] = state.temperature

        def of_places(at: Array) -> tuple[Array, Array, Array]:
            found = [each.formula.first(at, others) for each in self.first]
            values = state.variables[:, [each.place for each in self.first]]
            off, slope = np.stack([value for value, _ in found], axis=1) - values, np.stack([slope for _, slope in found], axis=1)
            return off, slope[:, :, o + self.known], np.abs(values).max(axis=1) + np.abs(off).max(axis=1)

        def of_stress(at: Array) -> tuple[Array, Array, Array]:
            _, force, hessian = own.free_energy(at, others)
            given = state.stress[:, self.columns]
            size = np.abs(given).max(axis=1) + np.einsum("noj,nj->no", np.abs(hessian[:, :o]), np.abs(at)).max(axis=1)
            return force[:, :o] - given, hessian[:, :o, o + self.slips], size

        for rows, equations in ((self.known, of_places), (self.slips, of_stress)):
            if rows.size:
                _solve(chi, o + rows, equations)
        return chi


def _solve(chi: Array, columns: NDArray[np.intp], equations: Callable[[Array], tuple[Array, Array, Array]]) -> None:
    """Newton's method by least squares for some ``columns`` of chi, in place; nan where a derivative has no value."""
    for _ in range(_NEWTON):
        off, slope, size = equations(chi)
        by = np.einsum("nij,nj->ni", np.linalg.pinv(np.where(np.isfinite(slope), slope, 0.0)), off)
        chi[:, columns] -= by
        off = np.abs(np.einsum("nij,nj->ni", slope, by)).max(axis=1)
        if not (off > _MET * size).any():
            break


def _spelled(text: str, names: Mapping[str, str]) -> str:
    """The text with other names in the places of some."""
    return _WORD.sub(lambda m: names.get(m[0], m[0]), text)


def _listed(given: int | slice | Sequence[int], material: Material) -> list[int]:
    """The places in the state of a material that are given as a number, several, or a slice."""
    size = len(np.asarray(material.variables))
    return [*range(size)[given]] if isinstance(given, slice) else [given] if isinstance(given, int) else [*given]


def _read_places(own: StateLaw, places: Mapping[str, list[int]], material: Material, tails: Sequence[str], where: str) -> list[Kept]:
    """What stands at each place.  A name that is no variable, but is one with each ending of the stress, is a tensor."""
    law, table = own.law, own.law.symbols()
    known = {name: table[name] for name in own.others} | dict(zip(own.names, own.symbols, strict=True))
    driven = [own.symbols[own.observables + i] for i in own.order.tolist()]
    forces = dict(zip(law.force_symbols(), (-x for x in gradient(own.energy, driven)), strict=True))
    known |= dict(zip(law.forces, law.force_symbols(), strict=True))
    ends, found, size = material.components or tuple(tails), [], len(np.asarray(material.variables))
    for told, at in places.items():
        inside = {w: [f"{w}_{end}" for end in ends] for w in _WORD.findall(told) if w not in known}
        tensors = {w: parts for w, parts in inside.items() if {*parts} <= {*known}}
        texts = [_spelled(told, {w: parts[i] for w, parts in tensors.items()}) for i in range(len(ends) if tensors else 1)]
        if len(texts) != len(at) or not all(isinstance(p, int) and 0 <= p < size for p in at):
            what = f"{told!r} has {len(texts)} components, and the places {at} of {size} are {len(at)}"
            raise InputError(what, where=where, remedy="count from 0, and give NSTATV, or all variables, where the material is made")
        for text, place in zip(texts, at, strict=True):
            formula = parse_expression(text, known, where=where).xreplace(forces)
            found.append(Kept(text, place, StateFormula.of(formula, own.symbols, [table[name] for name in own.others])))
    return found


@dataclass(eq=False)
class LawStep:
    """Steps of a routine from ``before`` to ``after`` against the law, M rows: ``begun`` and ``ended`` chi (M, n), and what follows.

    ``error`` (M,) is the length by which the stress may be off (:meth:`HistoryQuery.error`), of which ``accuracy`` and ``rounding`` are
    the parts relative to the stresses; the rows are the first steps of all ``histories``, then the second ones.  ``multiplier`` (M, S)
    and its error, ``moved`` (M, internal) what the law changes, ``off`` what the routine changes beyond that and ``allowed``, both
    (M, internal); ``level`` g (M, S), what it may be and the size of its terms.  ``slipped`` (M,): the multiplier is more than its
    error.
    """

    of: LawInState
    before: MaterialState
    after: MaterialState
    dt: Array
    others: Sequence[Array]
    error: Array
    accuracy: float
    rounding: float
    histories: int

    def __post_init__(self) -> None:
        with np.errstate(all="ignore"):
            self.begun = self.of.read(self.before, self.others)
            self.ended = self.of.read(self.after, self.others, self.begun)
            self._measure()

    def equations(self, multiplier: Array, dt: Array, chi: Array | None = None, others: Sequence[Array] | None = None) -> StepEquations:
        """The equations of the law's step at the end, or at ``chi``, with other numbers too."""
        own, n = self.of.own, len(self.ended)
        flags, none = np.ones((n, multiplier.shape[1]), dtype=np.bool_), np.zeros((n, own.internal))
        at = Guess(self.ended if chi is None else chi, multiplier, none, flags, none > 0.0)
        return own.system(at, self.begun, none[:, : own.observables], dt, self.others if others is None else others)

    def flows(self, chi: Array | None = None, others: Sequence[Array] | None = None) -> tuple[Array, Array]:
        """h (M, S, internal) and dt r (M, internal) at the end, or at ``chi``; 0 where a flow has no value."""
        many, n = len(self.of.own.criteria), len(self.ended)
        zero, unit = np.zeros((n, many)), np.eye(many)
        rate = np.nan_to_num(self.equations(zero, self.dt, chi, others).flow)
        found = [np.nan_to_num(self.equations(zero + unit[s], 0.0 * self.dt, chi, others).flow) for s in range(many)]
        return np.stack(found, axis=1) if many else np.zeros((n, 0, rate.shape[1])), rate

    def _measure(self) -> None:
        of, own, o = self.of, self.of.own, self.of.own.observables
        inner = slice(o, o + own.internal)
        bent, slips = own.free_energy(self.begun, self.others)[2], of.slips
        known = np.isfinite(bent).all(axis=(1, 2)) & (np.linalg.eigvalsh(np.nan_to_num(bent[:, :o, :o])).min(axis=1) > 0.0)
        self.lower = lower = np.linalg.cholesky(np.where(known[:, None, None], bent[:, :o, :o], np.eye(o)))
        self.flow, self.rate = self.flows()
        self.change = self.ended[:, inner] - self.begun[:, inner]
        stretched = [np.linalg.norm(np.einsum("nji,nj->ni", lower, x[:, :o]), axis=1) for x in (self.begun, self.ended)]
        error = self.error + self.rounding * (stretched[0] + stretched[1])
        # what slips make of the stress, as a vector whose length is that of the stress
        metric = np.tile(np.eye(own.internal), (len(error), 1, 1))
        if slips.size:
            metric = np.zeros((len(error), o, own.internal))
            metric[:, :, slips] = np.linalg.inv(lower) @ np.nan_to_num(bent[:, :o, o + slips])
        self.inverse = np.linalg.pinv(metric[:, :, slips])
        alpha = np.abs(self.ended[:, inner]) + np.abs(self.begun[:, inner]) + np.abs(self.change)
        delta = (self.accuracy + self.rounding) * alpha
        if slips.size:
            delta[:, slips] = error[:, None] * np.linalg.norm(self.inverse, axis=2)
        far = np.einsum("nab,nb->na", metric, self.change - self.rate)
        drawn = np.einsum("nab,nsb->nsa", metric, self.flow)
        length = np.linalg.norm(drawn, axis=2)
        off = error if slips.size else np.linalg.norm(delta, axis=1)
        self.multiplier_error = 2.0 * off[:, None] / np.where(length > 0.0, length, np.inf)
        drawn_off = (np.abs(self.flow) * self.multiplier_error[:, :, None]).sum(axis=1)
        self.delta = delta + np.where(np.isin(np.arange(own.internal), slips), 0.0, drawn_off)
        self.slip_error = error
        self.multiplier = np.zeros((len(error), len(own.criteria)))
        found = self.equations(self.multiplier, self.dt)
        slope = found.by_state[:, own.internal :, :]
        self.level, self.size = found.criteria, found.criterion_size
        self.level_allowed = self.spread(slope, error) + 256.0 * _EPS * self.size
        if self.multiplier.shape[1] == 1:
            square = length[:, 0] ** 2
            self.multiplier[:, 0] = np.where(square > 0.0, (far * drawn[:, 0]).sum(axis=1) / np.where(square > 0.0, square, 1.0), 0.0)
        elif self.multiplier.shape[1]:
            at_end = ~(self.level < -2.0 * self.level_allowed)
            for i in range(len(far)):
                if np.isfinite(far[i]).all() and at_end[i].any():
                    self.multiplier[i, at_end[i]] = nnls(drawn[i, at_end[i]].T, far[i])[0]
        self.moved = np.einsum("ns,nsi->ni", self.multiplier, self.flow) + self.rate
        self.off = self.change - self.moved
        jacobian = self.equations(self.multiplier, self.dt).by_state[:, : own.internal, :]
        jacobian = np.where(np.isfinite(jacobian), jacobian, 0.0)
        self.allowed = 2.0 * (self.spread(jacobian, error) + self.delta)
        at_low, at_high = self.ended[:, inner] <= own.low, self.ended[:, inner] >= own.high
        held = (at_low & (self.off > 0.0)) | (at_high & (self.off < 0.0))
        self.off = np.where(held, 0.0, self.off)
        pushed = self.flow.sum(axis=1) + self.rate  # against a bound, whose reaction takes part in the force
        self.bound = (((at_high & (pushed > 0.0)) | (at_low & (pushed < 0.0))) & own.reacts).any(axis=1)
        self.slipped = (self.multiplier > 4.0 * self.multiplier_error).any(axis=1)

    @cached_property
    def many_ways(self) -> NDArray[np.bool_]:
        """The rows (M,) at a tip or an edge of K, where a flow may have any direction between those beside it.

        Not so where the law has no variables and the stress is not the closest point of K.
        """
        of, o, ways = self.of, self.of.own.observables, np.zeros(len(self.ended), dtype=np.bool_)
        stress, law = self.after.stress[:, of.columns], of.own.law
        if not of.slips.size:
            return ways
        h = np.maximum(NEAR * np.linalg.norm(np.linalg.solve(self.lower, stress[..., None])[..., 0], axis=1), 4.0 * self.error)[:, None]
        for way in (*self.inverse.transpose(2, 0, 1), *-self.inverse.transpose(2, 0, 1)):
            beside = self.ended.copy()
            beside[:, o + of.slips] += h * way
            units = [x / np.linalg.norm(x, axis=2, keepdims=True) for x in (self.flow, self.flows(beside)[0])]
            turned = ~(np.linalg.norm(units[1] - units[0], axis=2) <= _TURNED)  # or is without a value
            ways |= (turned & ~(self.level < -4.0 * self.level_allowed)).any(axis=1)
        if ways.any() and law.energy is None and not law.variables and law.associated:
            k, load = (self.lower @ self.lower.transpose(0, 2, 1))[0], law.pressure and self.others[of.own.others.index(law.pressure)]
            trial = self.before.stress[:, of.columns] + (self.after.strain - self.before.strain)[:, of.columns] @ k
            closest = Projector.of(law, k, {})(trial, load)
            off = np.linalg.norm(np.linalg.solve(self.lower, (stress - closest.stress)[..., None])[..., 0], axis=1)
            ways &= ~((closest.status <= Status.SLIP) & (off > 4.0 * self.error))
        return ways

    def spread(self, slope: Array, error: Array) -> Array:
        """What errors of the state make of values with these derivatives (M, k, n): ``error`` of the slips as one vector, others each."""
        o, slips = self.of.own.observables, self.of.slips
        by = np.abs(slope[:, :, o : o + self.of.own.internal])
        others = np.delete(np.arange(self.of.own.internal), slips)
        along = np.nan_to_num(slope[:, :, o + slips]) @ self.inverse
        return np.asarray(np.linalg.norm(along, axis=2) * error[:, None] + np.einsum("nkj,nj->nk", by[:, :, others], self.delta[:, others]))

    def derived(self, chi: Array | None = None) -> tuple[Array, Array]:
        """What is kept of the slips too, as stress and strain have it (M, k), and what it may be off by: each step adds its error."""
        pairs = [each.formula.first(self.ended if chi is None else chi, self.others) for each in self.of.more]
        value, slope = np.stack([v for v, _ in pairs], axis=1), np.stack([s for _, s in pairs], axis=1)
        error = self.slip_error + np.cumsum(self.error.reshape(-1, self.histories), axis=0).ravel()
        return value, 4.0 * self.spread(slope, error) + 64.0 * _EPS * np.abs(value)
