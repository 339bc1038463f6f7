"""Paths of every law of the atlas that has a state: what each history satisfies, at parameters, states and loads that Hypothesis draws.

Forces, entropy, criteria and flows are computed here from the formulas of the law, by symbolic derivatives; the steps use jets.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cache, cached_property
from typing import Any

import numpy as np
import pytest
import sympy as sp
from hypothesis import Phase, given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

import duhem
from duhem import Domain, Paths
from duhem.expression.branches import gradient
from duhem.expression.numpy_ import compiled
from duhem.law.atlas.entry import entry, groups
from duhem.law.state import prescribed
from duhem.path import state_path, state_step
from duhem.path.state_path import StateHistory
from duhem.path.state_step import StateLaw
from tests.long import mostly_long
from tests.path.states import mutate

Array = Any

WIDTH, KNOTS = 40, 4
STIFFNESS, REACH = 2.0, 3.0
EXACT, MET = 1e-12, 1e-9  # of sums, and of conditions that steps meet to 1e-10


@dataclass(frozen=True)
class Formulas:
    """A law of the atlas, and its formulas as functions of variables, forces and parameters."""

    name: str

    @cached_property
    def law(self) -> Any:
        return duhem.load(self.name)

    @cached_property
    def own(self) -> StateLaw:
        """Names and order of the variables, and the energy, which is that of a stiffness where the law states none."""
        law = self.law
        return StateLaw.of(law, STIFFNESS * np.eye(len(law.forces)) if law.energy is None else None)

    @cached_property
    def inner(self) -> slice:
        return slice(self.own.observables, self.own.observables + self.own.internal)

    @cached_property
    def symbols(self) -> list[sp.Symbol]:
        table = self.law.symbols()
        return [*self.own.symbols, *self.law.force_symbols(), *(table[name] for name in self.own.others)]

    def program(self, expr: sp.Expr) -> Any:
        return compiled(expr, self.symbols)

    @cached_property
    def energy(self) -> list[Any]:
        """psi, and its derivatives by all variables."""
        return [*map(self.program, (self.own.energy, *gradient(self.own.energy, self.own.symbols)))]

    @cached_property
    def criteria(self) -> list[tuple[Any, dict[int, Any]]]:
        """g and the flow of each surface, by internal variable."""
        law, inner = self.law, self.own.names[self.inner]
        found = []
        for g, flow in () if law.viscous else [(s.g, s.flow) for s in law.surfaces] or [(law.g, law.flow)]:
            slips = dict(zip(self.own.order.tolist(), flow or gradient(g, law.force_symbols()), strict=True))
            slips |= {inner.index(name): x for name, x in law.unforced.items()}
            found.append((self.program(g), {i: self.program(x) for i, x in slips.items()}))
        return found

    @cached_property
    def rates(self) -> list[tuple[int, Any]]:
        """Rates without a multiplier, by internal variable."""
        law = self.law
        slips = gradient(law.g, law.force_symbols()) if law.viscous else ()
        found = [*zip(self.own.order.tolist(), slips, strict=bool(slips))]
        found += [(self.own.names[self.inner].index(name), x) for name, x in law.rates.items()]
        return [(i, self.program(x)) for i, x in found]

    def proved(self, claim: str) -> bool:
        """Whether the claim is, as the atlas has it."""
        return entry(self.name).verdicts.get(claim) == "proved"


of_law = cache(Formulas)
NAMES = [name for name in groups()["states"] if not duhem.load(name).forces_of_rates]
PROPORTIONAL = ("prager", "slip-hardening")  # linear hardening
WARM = ("frictional-heating",)
CONSTANT = ("slip-softening",)  # a pressure that falls may leave it no state in K
NO_ANSWER = {"slip-softening": 0.1, "frictional-heating": 0.1}  # the share of points that may end without one; of other laws none may
# Softening by slip ends all states of a law with the slip that takes its strength, and by heat it makes the law unstable.
# A rate that is steep in the force has few digits.
RANGES = {
    "slip-softening": {"H": Domain.between("-1/40", 0)},
    "chaboche": {"r": Domain.between(0, "2/3")},  # it begins below its limit 1/b, beyond which the law softens
    "frictional-heating": {"a": Domain.between(0, "1/4")},
    "rate-and-state": {"a": Domain.between(1, 3)},
}


def placed(domain: Domain, part: Array) -> Array:
    """Numbers of a domain, of parts of 1."""
    low, high = domain.ends
    if np.isfinite(low) and np.isfinite(high):
        return low + part * (high - low)
    return 3.0 ** (2.0 * part - 1.0) if domain.positive else low + 2.0 * part if np.isfinite(low) else 2.0 * part - 1.0


@dataclass(frozen=True)
class Load:
    """A law, N points of parameters (N,), and where they begin and go: ``knots`` (N, m, columns)."""

    of: Formulas
    parameters: Mapping[str, Array]
    state: Mapping[str, Array]
    knots: Array
    pressure: Array | None
    time: Array

    @classmethod
    def drawn(cls, name: str, parts: Array, warmed: bool = False, proportional: bool = False) -> Load:
        """Of parts of 1 (N, WIDTH); ``warmed`` the temperature is prescribed; ``proportional`` one step from variables that are all 0."""
        of, columns = of_law(name), iter(np.moveaxis(parts, -1, 0))
        own, law, m = of.own, of.law, 2 if proportional else KNOTS
        ranges = {**law.parameters, **RANGES.get(name, {})}

        def along(domain: Domain) -> Array:
            return np.stack([placed(domain, next(columns)) for _ in range(m)], axis=1)

        parameters = {p: placed(ranges[p], next(columns)) for p in own.others if p != law.pressure}
        state = {v: placed(ranges.get(v, Domain()), next(columns)) / 2.0 for v in own.names[own.observables :]}
        if proportional:
            state = {v: 0.0 * x for v, x in state.items()}
        pressure = None if law.pressure is None else -along(duhem.POSITIVE)
        if pressure is not None and (proportional or name in CONSTANT):
            pressure[:] = pressure[:, :1]
        time = np.concatenate([[0.0], np.cumsum(0.1 + next(columns)[0] * np.arange(1, m))])
        driven = {f: own.names[own.observables + i] for f, i in zip(law.forces, own.order, strict=True)}
        knots = REACH * np.stack([along(Domain()) for _ in range(own.observables)], axis=2)
        made = cls(of, parameters, state, knots, pressure, time)
        while True:  # begin unloaded, and inside K
            knots[:, 0] = np.stack([state[driven[f]] if f in driven else 0.0 * parts[:, 0] for f in prescribed(law)], axis=1)
            if not (out := made.outside()).any():
                break
            for v in driven.values():
                state[v][out] /= 2.0
        if warmed:
            knots = np.concatenate([knots, along(duhem.POSITIVE)[:, :, None]], axis=2)
            made = replace(made, knots=knots, state={v: x for v, x in state.items() if v != law.temperature})
        return made

    def values(self, state: Array, force: Array, pressure: Array | None) -> list[Array]:
        """What the formulas take, each (N, m)."""
        others = [pressure if name == self.of.law.pressure else self.parameters[name][:, None] for name in self.of.own.others]
        return [*np.moveaxis(state, -1, 0), *np.moveaxis(force, -1, 0), *others]

    def outside(self) -> Array:
        """Whether points begin outside K."""
        own = self.of.own
        state = np.concatenate([self.knots[:, :1], np.stack([*self.state.values()], axis=1)[:, None]], axis=2)
        none = np.full((*state.shape[:2], len(own.order)), np.nan)
        pressure = None if self.pressure is None else self.pressure[:, :1]
        places = own.order + own.observables
        forces = np.stack([-self.of.energy[1 + i](*self.values(state, none, pressure)) for i in places], axis=-1)
        return np.any([g(*self.values(state, forces, pressure))[:, 0] > 0.0 for g, _ in self.of.criteria] + [0.0 * forces[:, 0, 0]], axis=0)

    def part(self, which: Array) -> Load:
        """Some of the points."""
        pressure = None if self.pressure is None else self.pressure[which]
        named = ({name: x[which] for name, x in given.items()} for given in (self.parameters, self.state))
        return Load(self.of, *named, self.knots[which], pressure, self.time)

    def run(self, **asked: Any) -> StateHistory:
        stiffness = STIFFNESS if self.of.law.energy is None else None
        path = Paths.linear(self.knots, pressure=self.pressure, time=self.time)
        given = {"parameters": self.parameters, "state": self.state, "stiffness": stiffness} | asked
        found = duhem.simulate(self.of.law, path, **given)
        assert isinstance(found, StateHistory)
        return found


@dataclass(frozen=True)
class Parts:
    """A history of N points and m knots, and what the formulas of the law say at each of them."""

    load: Load
    found: StateHistory

    @cached_property
    def values(self) -> list[Array]:
        return self.load.values(self.found.state, self.found.force, self.found.pressure)

    @cached_property
    def energy(self) -> Array:
        """psi and its derivatives, (1 + variables, N, m)."""
        return np.stack([program(*self.values) for program in self.load.of.energy])

    @cached_property
    def size(self) -> Array:
        """Of the energies, (N, 1)."""
        found = self.found
        parts = [np.abs(getattr(found, name)).max(axis=1) for name in ("psi", "work", "dissipation", "numerical")]
        warm = [] if found.entropy is None else [np.abs(found.entropy * found.state[:, :, -1]).max(axis=1)]
        return np.sum(parts + warm, axis=0)[:, None] + np.finfo(np.float64).tiny

    @property
    def force_size(self) -> Array:
        """Of forces, (N, 1): of terms of the size of the moduli and of the reach."""
        terms = [*self.energy[1:], *np.moveaxis(self.found.force, -1, 0), self.found.pressure]
        most = np.max([np.abs(x).max(axis=1) for x in terms], axis=0)
        return 1.0 + most[:, None]


def energies(at: Parts) -> None:
    """psi, the work and the entropy are those of the formulas, and each step balances."""
    found, own = at.found, at.load.of.own
    psi, slopes = at.energy[0], at.energy[1:]
    assert (np.abs(psi - found.psi) <= EXACT * at.size).all()
    by = np.diff(found.state, axis=1)
    work = sum(slopes[i, :, 1:] * by[:, :, i] for i in range(own.observables))
    gains = {name: np.diff(getattr(found, name), axis=1) for name in ("work", "dissipation", "numerical")}
    assert (np.abs(work - gains["work"]) <= EXACT * at.size).all()
    warmed: Array = 0.0
    if found.entropy is not None and found.heat is not None:
        s, t = -slopes[-1], found.state[:, :, -1]
        assert (np.abs(t * (s - found.entropy)) <= EXACT * at.size).all()
        warmed = s[:, 1:] * np.diff(t, axis=1)
        taken = t[:, 1:] * np.diff(s, axis=1) - gains["dissipation"]
        assert (np.abs(taken - np.diff(found.heat, axis=1)) <= EXACT * at.size).all()
        if at.load.knots.shape[2] == own.observables:  # no temperature is prescribed
            bodies = {name: at.load.parameters[name][:, None] for name in at.load.of.law.heat}
            flows = [at.load.of.program(h)(*at.values) * (bodies[name] - t) for name, h in at.load.of.law.heat.items()]
            inflow = np.diff(found.time) * sum(flow[:, 1:] for flow in flows)
            assert (np.abs(taken - inflow) <= MET * at.size).all()
    rest = gains["work"] - np.diff(psi, axis=1) - warmed - gains["dissipation"] - gains["numerical"]
    assert (np.abs(rest) <= EXACT * at.size).all() and (np.abs(found.balance) <= EXACT * at.size).all()


def losses(at: Parts) -> None:
    """What flows dissipates, and a step of a convex energy gains nothing."""
    of, found = at.load.of, at.found
    assert not of.proved("dissipation") or (np.diff(found.dissipation, axis=1) >= -EXACT * at.size).all()
    assert not of.proved("state_laws") or of.law.temperature or (np.diff(found.numerical, axis=1) >= -EXACT * at.size).all()


def states(at: Parts) -> None:
    """Forces are those of the energy, variables are inside their bounds, and criteria and multipliers are complementary."""
    of, found = at.load.of, at.found
    own = of.own
    inner = found.state[:, :, of.inner]
    assert (inner >= own.low).all() and (inner <= own.high).all()
    assert not (found.held & (inner != own.low) & (inner != own.high)).any()
    forces = np.moveaxis(-at.energy[1 + own.observables + own.order], 0, -1)
    wrong = np.abs(found.force - forces)[:, 1:] > EXACT * at.force_size[:, :, None]
    held, low = found.held[:, 1:, own.order], (inner == own.low)[:, 1:, own.order]
    assert not (wrong & ~held).any()
    assert not (wrong & held & ((found.force > forces)[:, 1:] ^ low)).any()  # a bound holds what would pass it, and pulls nothing
    gained = np.diff(found.multiplier, axis=1)
    assert (gained >= 0.0).all() and gained.shape[2] == len(of.criteria)
    for s, (criterion, _) in enumerate(of.criteria):
        g = criterion(*at.values) / at.force_size
        assert (g <= MET).all() and (np.abs(g[:, 1:] * gained[:, :, s]) <= MET).all()


def flows(at: Parts) -> None:
    """Of implicit steps: what the internal variables change by, and what that dissipates, are those of the law's flow at the end."""
    of, found = at.load.of, at.found
    gained, n = np.diff(found.multiplier, axis=1), of.own.internal
    with np.errstate(all="ignore"):
        moved = np.zeros((*found.psi[:, 1:].shape, n))
        for s, (_, components) in enumerate(of.criteria):
            for i, flow in components.items():
                moved[:, :, i] += np.where(gained[:, :, s] > 0.0, gained[:, :, s] * flow(*at.values)[:, 1:], 0.0)
        for i, rate in of.rates:
            moved[:, :, i] += np.diff(found.time) * np.nan_to_num(rate(*at.values)[:, 1:])  # at no force a norm has no slope
    by, free = np.diff(found.state[:, :, of.inner], axis=1), ~found.held[:, 1:]
    size = 1.0 + np.abs(found.state).max(axis=(1, 2))[:, None, None]
    assert (np.abs(by - moved) <= 1e2 * MET * size)[free].all()
    dissipated = (found.force[:, 1:] * moved[:, :, of.own.order]).sum(axis=2)
    assert (np.abs(dissipated - np.diff(found.dissipation, axis=1)) <= 1e2 * MET * at.size).all()


def answered(load: Load, lost: list[float], **asked: Any) -> tuple[Load, StateHistory]:
    """The points whose paths have an answer to their end; ``lost`` is told the share of the others."""
    found = load.run(**asked)
    good = found.reached == len(found.time) - 1
    lost.append(float((~good).mean()))
    if good.all():
        return load, found
    assert good.any()
    return (left := load.part(good)), left.run(**asked)


def conforming(load: Load, lost: list[float]) -> None:
    """All of the above."""
    at = Parts(*answered(load, lost))
    energies(at)
    losses(at)
    states(at)
    flows(at)


def tangents(load: Load, lost: list[float]) -> int:
    """Tangents of last steps are their slopes by central differences, but where the two sides differ; how many are compared."""
    load, found = answered(load, lost, tangent=True)
    own = load.of.own
    assert found.tangent is not None
    begun = {name: found.state[:, -2, i] for i, name in enumerate(own.names) if i >= own.observables and name in load.state}
    pressure = None if load.pressure is None else load.pressure[:, -2:]

    def stress(column: int, by: float) -> Array:
        knots = load.knots[:, -2:].copy()
        knots[:, 1, column] += by
        end = replace(load, state=begun, knots=knots, pressure=pressure, time=load.time[-2:]).run()
        return Parts(load, end).energy[1 : 1 + own.observables, :, -1].T

    compared, size = 0, 1.0 + np.abs(found.tangent[:, -1]).max(axis=(1, 2))[:, None]
    for column in range(own.observables):
        low, middle, high = (stress(column, by) for by in (-1e-5, 0.0, 1e-5))
        alike = (np.abs(high - 2.0 * middle + low) / 1e-5 <= 1e-2 * size).all(axis=1)
        wrong = np.abs((high - low) / 2e-5 - found.tangent[:, -1, :, column]) > 1e-4 * size
        assert not wrong[alike].any()
        compared += int(alike.sum())
    return compared


def refined(load: Load, lost: list[float]) -> None:
    """What is left to the states in 32 steps falls from 2 steps to 8: of first order it would by 5."""

    def knots(substeps: int) -> Array:
        return load.run(substeps=substeps).state[:, ::substeps]

    coarse, middle, fine = (knots(n) for n in (2, 8, 32))
    lost.append(float(np.isnan(coarse + middle + fine).any(axis=(1, 2)).mean()))
    size = 1.0 + np.abs(fine).max(axis=(1, 2))
    errors = [np.abs(each - fine).max(axis=(1, 2)) / size for each in (coarse, middle)]
    assert not (errors[1] > errors[0] / 2.0 + 2e-2).any()  # nan is no answer


def parts(points: int) -> Any:
    return arrays(np.float64, (points, WIDTH), elements=st.floats(0.0, 1.0), fill=st.nothing())


CASES = [(name, False) for name in NAMES] + [(name, True) for name in WARM]
DEAR = [("lemaitre-damage", False), ("frictional-heating", False), ("slip-softening", False)]  # what is found last, or not at all


def holds(check: Any, name: str, points: int, examples: int, **how: Any) -> None:
    """A check of paths that Hypothesis draws, of which few have no answer."""
    lost: list[float] = []

    @settings(max_examples=examples, deadline=None, derandomize=True, database=None, phases=(Phase.generate,))
    @given(arrays(np.float64, (2, WIDTH), elements=st.floats(0.0, 1.0), fill=st.nothing()), st.integers(0, 2**32))
    def drawn(two: Array, seed: int) -> None:  # many more by Hypothesis itself would take longer than their paths
        parts = np.concatenate([two, np.random.default_rng(seed).random((points - 2, WIDTH))])
        check(Load.drawn(name, parts, **how), lost)

    drawn()
    assert np.mean(lost) <= NO_ANSWER.get(name, 0.0), f"{np.mean(lost):.2g} of the paths have no answer"


@pytest.mark.slow(4)
@pytest.mark.parametrize(("name", "warmed"), mostly_long(CASES, *(case for case in CASES if case not in DEAR)))
def test_histories_conform(name: str, warmed: bool) -> None:
    holds(conforming, name, 12, 2, warmed=warmed)


@pytest.mark.long
@pytest.mark.parametrize(("name", "warmed"), CASES)
def test_many_histories_conform(name: str, warmed: bool) -> None:
    holds(conforming, name, 24, 4 if (name, warmed) in DEAR else 20, warmed=warmed)


@pytest.mark.slow(2)
@pytest.mark.parametrize(("name", "warmed"), mostly_long(CASES, *((name, False) for name in ("adhesion", "chaboche", "norton-hoff"))))
def test_tangents_are_slopes(name: str, warmed: bool) -> None:
    compared: list[int] = []
    holds(lambda load, lost: compared.append(tangents(load, lost)), name, 8, 2, warmed=warmed)
    assert sum(compared) >= 8


@pytest.mark.slow(2)
@pytest.mark.parametrize(("name", "warmed"), mostly_long(CASES, *((name, False) for name in ("at1-damage", "slip-hardening"))))
def test_steps_converge(name: str, warmed: bool) -> None:
    holds(refined, name, 8, 1, warmed=warmed)


@pytest.mark.parametrize("name", PROPORTIONAL)
def test_one_step_of_linear_hardening_is_many(name: str) -> None:
    def same(load: Load, lost: list[float]) -> None:
        one, many = (load.run(substeps=n) for n in (1, 7))
        lost.append(0.0)
        assert one.multiplier.any() and (np.abs(one.state[:, -1] - many.state[:, -1]) <= EXACT * (1.0 + np.abs(one.state[:, -1]))).all()

    holds(same, name, 12, 2, proportional=True)


MUTANTS = [
    (
        state_step,
        "archard-wear",
        'moved = np.einsum("ns,nsi->ni", at.multiplier, flow)',
        'moved = np.einsum("ns,nsi->ni", -at.multiplier, flow)',
    ),
    (state_step, "norton-hoff", "dt[:, None] * rate, 0.0)", "2.0 * dt[:, None] * rate, 0.0)"),
    (state_step, "chaboche-static-recovery", "rate[:, i] += own", "rate[:, i] += 0.5 * own"),
    (state_step, "frictional-heating", "entropy = -force[:, warm]", "entropy = force[:, warm]"),
    (state_step, "frictional-heating", "- heat.sum(axis=1) - inflow", "- 2 * heat.sum(axis=1) - inflow"),
    (state_step, "frictional-heating", "inflow, by_taken = dt * flowing,", "inflow, by_taken = 2 * dt * flowing,"),
    (state_step, "adhesion", "excess[rows, most] > KKT", "excess[rows, most] > 2.0"),
    (state_step, "lemaitre-damage", "ends[held], True, True", "0.9 * ends[held], True, True"),
    (state_step, "lemaitre-damage", "at.reaction < 0.0, at.reaction > 0.0", "at.reaction > 0.0, at.reaction < 0.0"),
    (state_step, "perzyna", "begun - end +", "2.0 * (begun - end) +"),
    (state_path, "lemaitre-damage", "+ (end.reaction * inner).sum(axis=1)", ""),
    (state_path, "prager", "work = (end.observed * by", "work = 2.0 * (end.observed * by"),
    (state_path, "bingham", "(end.forces * end.flow[:, law.order])", "(0.5 * end.forces * end.flow[:, law.order])"),
    (state_path, "frictional-heating", "heat = end.chi[:, -1] *", "heat = base[:, -1] *"),
]

QUICK = ("adhesion", "bingham", "chaboche-static-recovery", "perzyna", "prager")


@pytest.mark.slow(2)
@pytest.mark.parametrize(("module", "name", "old", "new"), mostly_long(MUTANTS, *(mutant for mutant in MUTANTS if mutant[1] in QUICK)))
def test_a_wrong_step_or_history_does_not_conform(module: Any, name: str, old: str, new: str, monkeypatch: pytest.MonkeyPatch) -> None:
    load = Load.drawn(name, np.random.default_rng(1).random((4, WIDTH)))
    conforming(load, [])
    mutate(module, old, new, monkeypatch)
    with pytest.raises(AssertionError):
        lost: list[float] = []
        conforming(load, lost)
        assert not any(lost)


def test_a_wrong_tangent_is_no_slope(monkeypatch: pytest.MonkeyPatch) -> None:
    load = Load.drawn("prager", np.random.default_rng(1).random((4, WIDTH)))
    assert tangents(load, [])
    mutate(state_step, "moved = -_solved(", "moved = 0.9 * -_solved(", monkeypatch)
    with pytest.raises(AssertionError):
        tangents(load, [])


@pytest.mark.long
def test_softening_is_refused_where_no_state_is_an_answer(monkeypatch: pytest.MonkeyPatch) -> None:
    """The step ends at |sigma| = mu N + H alpha, H < 0, with the slip of its multiplier, or nowhere where that takes all of sigma."""
    monkeypatch.delitem(RANGES, "slip-softening")  # type: ignore[attr-defined]
    load = Load.drawn("slip-softening", np.random.default_rng(3).random((12, WIDTH)))
    found, refused = load.run(), 0
    assert load.pressure is not None
    for j in np.flatnonzero(found.reached < KNOTS - 1):
        p, r = {name: x[j] for name, x in load.parameters.items()}, int(found.reached[j])
        _, slip, alpha = found.state[j, r]
        trial, softening = p["k"] * abs(load.knots[j, r + 1, 0] - slip), -p["H"]
        multiplier = (trial + softening * alpha + p["mu"] * load.pressure[j, r + 1]) / (p["k"] - softening)
        assert not (multiplier >= 0.0 and trial - p["k"] * multiplier >= 0.0)
        refused += 1
    assert refused >= 3
