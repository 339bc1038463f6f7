"""One implicit step of laws with a state, many points at once.

With the variables chi = (observables u; internal alpha; temperature T) and the forces Y = -d psi/d alpha the step of a generalized
standard law is a minimum over the admissible states at the observables prescribed,

    chi = argmin psi(chi) + dt Phi((chi - chi_n)/dt),

whose optimality conditions are, at its end,

    alpha - alpha_n = sum lambda_s h_s(Y; chi) + dt r(Y; chi),   g_s(Y; chi) <= 0,   lambda_s >= 0,   lambda_s g_s = 0,

with h = dg/dY, or with r = d Phi*/dY of a viscous law.  A law with a flow h of its own, or with rates r without a multiplier, has the
same equations and no minimum.  At a bound of a variable alpha_i a reaction q_i takes part, Y_i = -d psi/d alpha_i - q_i, q_i >= 0 at an
upper bound; where no formula has Y_i in it, or there is none, the variable just stays there.  A temperature that is
not prescribed obeys T (s - s_n) = Y . (alpha - alpha_n) + dt sum h_k (T_k - T), s = -d psi/dT; without bodies k it is adiabatic.

The state without flow is tried first; then the most violated criterion is taken as an equation, Newton's method, damped, solves
for alpha, lambda (and q, T), and criteria and bounds are exchanged until all conditions hold.  Where that fails, the answer is
followed from no load to all of it; last, it is looked for where bounds hold variables, to which brittle damage jumps.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from typing import Any

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from duhem.errors import InputError
from duhem.expression.jets import Jet, JetProgram, formula
from duhem.law.formula_law import Criterion
from duhem.law.state import prescribed, variables_of
from duhem.projection.result import ACCURACY, Array, Pointwise

__all__ = [
    "GOAL", "HALVINGS", "KKT", "MOST", "ROUNDED", "SPOILT", "UNTRUE", "Advanced", "StateFormula", "StateLaw", "own_dissipation",
]  # fmt: skip

_EPS = float(np.finfo(np.float64).eps)
KKT = 1e-3 * ACCURACY  # the largest residual of an answer, relative to the sizes that the law has there
ROUNDED = 16 * _EPS  # of the terms of which a force is made
GOAL = 16 * _EPS  # of the same: more is not asked for
MOST = 100  # steps of Newton's method, of all sets of criteria and bounds together
HALVINGS = 30
UNTRUE = 1e-6  # of the energies of a step: right answers miss it by rounding, and wrong ones by much of the energies
SPOILT = 64 * _EPS  # of Y . alpha: an energy that is less says nothing, since alpha is rounded
_SHARES = np.union1d(2.0 ** np.arange(-20, -4), np.arange(1, 17) / 16)  # of a load along which a step is followed

Flags = NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class Guess(Pointwise):
    """Where a step may end: chi (N, n), lambda (N, S), q (N, internal), the criteria that are equations and the variables at a bound."""

    chi: Array
    multiplier: Array
    reaction: Array
    active: Flags
    held: Flags


@dataclass(frozen=True, eq=False)
class StepEquations(Pointwise):
    """The equations at a guess: residuals (N, k), what they are small against, and derivatives by chi and q, and by lambda.

    ``forces`` Y, ``observed`` d psi/du, ``entropy`` and ``flow``, the change of alpha that the law gives; ``criteria`` g and its size.
    """

    residual: Array
    size: Array
    by_state: Array
    by_multiplier: Array
    psi: Array
    forces: Array
    observed: Array
    entropy: Array
    flow: Array
    criteria: Array
    criterion_size: Array
    hessian: Array


_Found = tuple[Guess, StepEquations, Flags]  # where Newton's method came, and what it did not solve


@dataclass(frozen=True, eq=False)
class Advanced(Pointwise):
    """The end of a step: the state, what the law says there, the worst residual of the optimality conditions, and what was not solved.

    ``numerical`` (N,) is what the step loses of itself (:func:`own_dissipation`); ``tangent`` (N, o, o) is d sigma/du at the end, by the
    implicit function theorem.
    """

    chi: Array
    multiplier: Array
    reaction: Array
    held: Flags
    psi: Array
    forces: Array
    observed: Array
    entropy: Array
    flow: Array
    numerical: Array
    worst: Array
    failed: Flags
    tangent: Array


@dataclass(frozen=True, eq=False)
class StateFormula:
    """A formula of some of the variables (N, z), which are in these ``columns`` of theirs: derivatives by the others are 0."""

    expr: sp.Expr
    names: tuple[sp.Symbol, ...]
    others: tuple[sp.Symbol, ...]
    columns: NDArray[np.intp]

    @classmethod
    def of(cls, expr: sp.Expr, variables: Sequence[sp.Symbol], others: Sequence[sp.Symbol]) -> StateFormula:
        """``expr`` of these variables and the numbers of the ``others``."""
        columns = [i for i, name in enumerate(variables) if name in expr.free_symbols]
        return cls(expr, tuple(variables[i] for i in columns), tuple(others), np.array(columns, dtype=np.intp))

    @cached_property
    def program(self) -> JetProgram:
        """The formula, compiled once."""
        return formula(self.expr, self.names, self.others)

    def __call__(self, at: Array, others: Sequence[Array]) -> tuple[Array, Array, Array]:
        """Value (N,), gradient (N, z) and second derivatives (N, z, z)."""
        jet, _ = self.program(at[:, self.columns], others)
        hessian = np.zeros((*at.shape, at.shape[1]))
        hessian[:, self.columns[:, None], self.columns] = jet.hessian
        return np.array(jet.value), self._slope(at, jet), hessian

    def first(self, at: Array, others: Sequence[Array]) -> tuple[Array, Array]:
        """Value (N,) and gradient (N, z) alone."""
        jet, _ = self.program(at[:, self.columns], others, second=False)
        return np.array(jet.value), self._slope(at, jet)

    def _slope(self, at: Array, jet: Jet) -> Array:
        gradient = np.zeros(at.shape)
        gradient[:, self.columns] = jet.gradient
        return gradient


@dataclass(frozen=True, eq=False)
class StateLaw:
    """A law as its steps take it: ``names`` of chi, first ``observables``, then the ``internal`` variables, last the temperature if any.

    ``order`` (d,) has the internal variable of each force.  ``stressed``: the forces d psi/du are prescribed, not u; ``adiabatic``: the
    temperature is found, from heat alone.
    """

    law: Criterion
    names: tuple[str, ...]
    observables: int
    internal: int
    order: NDArray[np.intp]
    symbols: tuple[sp.Symbol, ...]
    energy: sp.Expr
    low: Array
    high: Array
    stressed: bool = False
    adiabatic: bool = False

    @classmethod
    def of(cls, law: Criterion, stiffness: Array | None, stressed: bool = False, columns: int | None = None) -> StateLaw:
        """The ``law`` with its energy, or with the quadratic one of the ``stiffness``; a path of so many ``columns``."""
        variables, table = variables_of(law), law.symbols()
        driven, observed, known = variables.driven(), variables.observed(), dict(table)
        energy = law.energy
        if energy is None:
            if lone := [name for force, name in driven.items() if force not in observed]:
                what = f"nothing says how the force {variables[lone[0]].force} follows from {lone[0]}"
                raise InputError(what, where=f"variables of {law.name}", remedy="write an energy, psi in [energy]")
            tails = [force.removeprefix("sigma_") for force in law.forces]
            driven = {f: driven.get(f, f"u_in_{tail}") for f, tail in zip(law.forces, tails, strict=True)}
            observed = {f: observed.get(f, f"u_{tail}") for f, tail in zip(law.forces, tails, strict=True)}
            for name in (*driven.values(), *observed.values()):
                if name not in variables:
                    known[name] = sp.Dummy(name, real=True)
            away = sp.Matrix([known[observed[f]] - known[driven[f]] for f in law.forces])
            k = sp.Matrix([[sp.Rational(float(x)) for x in row] for row in np.asarray(stiffness)])
            energy = (away.T * k * away)[0] / 2
        ends = {name: own.domain.ends for name, own in variables.items()}
        inner = [*driven.values(), *(name for name, own in variables.items() if own.internal and name not in driven.values())]
        seen = [observed[f] for f in prescribed(law)]
        warm = [name for name in (variables.temperature(),) if name is not None]
        names = (*seen, *inner, *warm)
        if len(law.surfaces) > 1 and law.unforced:
            what = f"{', '.join(law.unforced)} has a rate for a unit of the multiplier, and {law.name} has several"
            raise InputError(what, where="law", remedy="give it a force, and a component in the flow of each surface")
        return cls(
            law=law,
            names=names,
            observables=len(seen),
            internal=len(inner),
            order=np.array([inner.index(driven[f]) for f in law.forces], dtype=np.intp),
            symbols=tuple(known[name] for name in names),
            energy=energy,
            low=np.array([ends.get(name, (-np.inf, np.inf))[0] for name in inner]),
            high=np.array([ends.get(name, (-np.inf, np.inf))[1] for name in inner]),
            stressed=stressed,
            adiabatic=bool(warm) and columns == len(seen),
        )

    # -- the formulas, each compiled once ------------------------------------------------------------------------------

    @cached_property
    def others(self) -> tuple[str, ...]:
        """The names of the numbers that the formulas take beside chi: parameters, then the pressure."""
        law = self.law
        return (*(name for name in law.parameters if name not in law.variables), *([law.pressure] if law.pressure else []))

    def _formula(self, expr: sp.Expr) -> StateFormula:
        forces, others = self.law.force_symbols(), [self.law.symbols()[name] for name in self.others]
        return StateFormula.of(expr, (*forces, *self.symbols), others)

    @cached_property
    def free_energy(self) -> StateFormula:
        """psi of all variables."""
        return StateFormula.of(self.energy, self.symbols, [self.law.symbols()[name] for name in self.others])

    def _by_variable(self, given: Sequence[sp.Expr] | None, named: Mapping[str, sp.Expr]) -> dict[int, StateFormula]:
        """Formulas of the internal variables: one a force, and those by name."""
        found = dict(zip(self.order.tolist(), given or (), strict=False))
        found |= {self.names.index(name) - self.observables: expr for name, expr in named.items()}
        return {i: self._formula(expr) for i, expr in found.items() if expr != 0}

    @cached_property
    def criteria(self) -> tuple[tuple[StateFormula, bool, dict[int, StateFormula]], ...]:
        """Each criterion, whether its gradient by the forces is the flow, and the other components of the flow."""
        law = self.law
        if law.viscous:
            return ()
        if law.surfaces:
            bounds = [(s.g, s.flow) for s in law.surfaces]
        else:
            parts = law.g.args if isinstance(law.g, sp.Max) and law.flow is None and not law.unforced else (law.g,)
            bounds = [(g, law.flow) for g in parts]
        return tuple((self._formula(g), flow is None, self._by_variable(flow, law.unforced)) for g, flow in bounds)

    @cached_property
    def rates(self) -> dict[int, StateFormula]:
        """Rates without a multiplier, by internal variable."""
        return self._by_variable(None, self.law.rates)

    @cached_property
    def potential(self) -> StateFormula | None:
        """Phi* of a viscous law."""
        return self._formula(self.law.g) if self.law.viscous else None

    @cached_property
    def exchange(self) -> StateFormula | None:
        """The heat that flows from the bodies into the interface, sum h_k (T_k - T), where the temperature is found."""
        flows = [h * (self.law.symbols()[body] - self.symbols[-1]) for body, h in self.law.heat.items()]
        return self._formula(sp.Add(*flows)) if flows and self.adiabatic else None

    @cached_property
    def timed(self) -> bool:
        """Whether the law depends on the rate."""
        return self.law.viscous or bool(self.law.rates) or self.exchange is not None

    @cached_property
    def minimum(self) -> bool:
        """Whether a step is the minimum above: neither a flow of its own nor rates without a multiplier."""
        return self.law.associated and not (self.law.rates or self.law.unforced)

    @cached_property
    def reacts(self) -> Flags:
        """Internal variables (internal,) of whose force a flow, a rate or a criterion says something."""
        law, found = self.law, np.zeros(self.internal, dtype=np.bool_)
        said = [law.g, *(x for s in law.surfaces for x in (s.g, *(s.flow or ()))), *(law.flow or ()), *law.rates.values()]
        used = set[sp.Basic]().union(*(expr.free_symbols for expr in said))
        found[self.order] = [x in used for x in law.force_symbols()]
        return found

    @property
    def _unknown(self) -> tuple[slice, slice, slice]:
        """Where the observables, the internal variables and the temperature stand among chi."""
        o, i = self.observables, self.observables + self.internal
        return slice(0, o), slice(o, i), slice(i, len(self.names))

    # -- the equations -------------------------------------------------------------------------------------------------

    def system(self, at: Guess, base: Array, load: Array, dt: Array, others: Sequence[Array]) -> StepEquations:
        """The equations at a guess, for a step from ``base`` (N, n); ``load`` (N, o) the forces d psi/du where they are prescribed."""
        u, inner, warm = self._unknown
        (n, size), d = at.chi.shape, len(self.order)
        psi, force, hessian = self.free_energy(at.chi, others)
        place = self.order + self.observables
        forces = 0.0 - (force[:, place] + at.reaction[:, self.order])  # no -0
        entropy = -force[:, warm].sum(axis=1)
        # what the formulas take, (Y, chi), by chi and q
        both = np.zeros((n, d + size, size + self.internal))
        both[:, :d, :size], both[:, d:, :size] = -hessian[:, place], np.eye(size)
        both[:, np.arange(d), size + self.order] = -1.0
        taken = np.concatenate([forces, at.chi], axis=1)

        many = len(self.criteria)
        g, slope = np.zeros((n, many)), np.zeros((n, many, d + size))
        flow, turn = np.zeros((n, many, self.internal)), np.zeros((n, many, self.internal, d + size))
        for s, (criterion, associated, components) in enumerate(self.criteria):
            flows = associated and bool(at.active[:, s].any())
            g[:, s], slope[:, s], *bent = criterion(taken, others) if flows else criterion.first(taken, others)
            if flows:
                flow[:, s, self.order], turn[:, s, self.order] = slope[:, s, :d], bent[0][:, :d]
            for i, component in components.items() if at.active[:, s].any() else ():
                flow[:, s, i], turn[:, s, i] = component.first(taken, others)
        flow[~at.active], turn[~at.active] = 0.0, 0.0  # it may have no value where nothing flows
        rate, change = np.zeros((n, self.internal)), np.zeros((n, self.internal, d + size))
        if self.potential is not None:
            _, towards, turned = self.potential(taken, others)
            rate[:, self.order], change[:, self.order] = towards[:, :d], turned[:, :d]
        for i, component in self.rates.items():
            own, turned = component.first(taken, others)
            rate[:, i] += own
            change[:, i] += turned

        step = at.chi[:, inner] - base[:, inner]
        steps = np.where((dt > 0.0)[:, None], dt[:, None] * rate, 0.0)
        moved = np.einsum("ns,nsi->ni", at.multiplier, flow) + steps
        held = at.held & ~self.reacts
        moved = np.where(held, step, moved)
        change = np.einsum("ns,nsiz->niz", at.multiplier, turn) + np.where((dt > 0.0)[:, None, None], dt[:, None, None] * change, 0.0)
        by = -change @ both
        by[:, np.arange(self.internal), self.observables + np.arange(self.internal)] += 1.0
        made = np.einsum("nij,nj->ni", np.abs(hessian), np.abs(at.chi))  # of what a force is the small difference
        rounding = ROUNDED / KKT * (made[:, place] + np.abs(at.reaction[:, self.order]))
        sizes = np.einsum("ns,nsi->ni", np.abs(at.multiplier), np.abs(flow)) + np.abs(steps)
        sizes = np.maximum(np.maximum(sizes, np.abs(at.chi[:, inner])), np.abs(base[:, inner]))
        sizes = sizes + np.einsum("nid,nd->ni", np.abs(change[:, :, :d]), rounding)
        bend = np.abs(np.einsum("nii->ni", hessian))[:, inner]  # what changes no force by more than rounding is no error
        sizes = sizes + np.where(bend > 0.0, ROUNDED / KKT * made[:, inner] / np.where(bend > 0.0, bend, 1.0), 0.0)
        weight = np.abs(slope[:, :, :d])
        within = np.einsum("nsd,nd->ns", slope[:, :, :d], forces)
        known = np.maximum(np.einsum("nsd,nd->ns", weight, np.abs(forces)), np.abs(g - within))
        known = known + np.einsum("nsd,nd->ns", weight, rounding)

        residuals = [step - moved, np.where(at.active, g, at.multiplier)]
        rows = [np.where(held[:, :, None], 0.0, by), np.where(at.active[:, :, None], slope @ both, 0.0)]
        allowed = [sizes, np.where(at.active, known, 1.0)]
        stresses = force[:, u]
        if self.stressed:
            residuals.insert(0, stresses - load)
            rows.insert(0, np.concatenate([hessian[:, u], np.zeros((n, self.observables, self.internal))], axis=2))
            allowed.insert(0, np.abs(load) + made[:, u])
        if self.adiabatic:
            gained, t = entropy + self.free_energy.first(base, others)[1][:, -1], at.chi[:, -1]
            heat = forces * step[:, self.order]
            by_taken = np.zeros((n, d + size))
            by_taken[:, :d], by_taken[:, d + place], by_taken[:, -1] = -step[:, self.order], -forces, gained
            inflow = np.zeros(n)
            if self.exchange is not None:
                flowing, turned = self.exchange.first(taken, others)
                inflow, by_taken = dt * flowing, by_taken - dt[:, None] * turned
            row = np.einsum("nz,nzj->nj", by_taken, both)
            row[:, :size] -= t[:, None] * hessian[:, -1]
            residuals.append((t * gained - heat.sum(axis=1) - inflow)[:, None])
            rows.append(row[:, None])
            allowed.append((t**2 * np.abs(hessian[:, -1, -1]) + np.abs(heat).sum(axis=1) + np.abs(inflow))[:, None])
        first = self.observables if self.stressed else 0
        residual, by_state = np.concatenate(residuals, axis=1), np.concatenate(rows, axis=1)
        by_multiplier = np.zeros((n, residual.shape[1], many))
        by_multiplier[:, first : first + self.internal] = np.where(held[:, :, None], 0.0, -np.swapaxes(flow, 1, 2))
        each = np.arange(many)
        by_multiplier[:, first + self.internal + each, each] = ~at.active
        return StepEquations(
            residual, np.concatenate(allowed, axis=1) + np.finfo(np.float64).tiny, by_state, by_multiplier, psi, forces,
            np.array(stresses), entropy, moved, g, known, hessian,
        )  # fmt: skip

    def _jacobian(self, at: Guess, system: StepEquations) -> Array:
        """The derivatives by what is unknown: u where forces are prescribed, alpha or, at a bound, q, lambda, and T if adiabatic."""
        u, inner, warm = self._unknown
        size, by = len(self.names), system.by_state
        own = np.where(at.held[:, None, :], by[:, :, size:], by[:, :, inner])
        i = np.arange(self.internal)
        own[:, i + (self.observables if self.stressed else 0), i] += at.held & ~self.reacts
        parts = [by[:, :, u]] if self.stressed else []
        parts += [own, system.by_multiplier] + ([by[:, :, warm]] if self.adiabatic else [])
        return np.concatenate(parts, axis=2)

    def _moved(self, at: Guess, by: Array) -> Guess:
        """The guess a step ``by`` (N, k) of the unknowns further."""
        u, inner, warm = self._unknown
        chi, reaction, many = at.chi.copy(), at.reaction.copy(), len(self.criteria)
        first = self.observables if self.stressed else 0
        last = first + self.internal
        if self.stressed:
            chi[:, u] += by[:, :first]
        chi[:, inner] += np.where(at.held, 0.0, by[:, first:last])
        reaction += np.where(at.held & self.reacts, by[:, first:last], 0.0)
        if self.adiabatic:
            chi[:, warm] += by[:, last + many :]
        return Guess(chi, at.multiplier + np.where(at.active, by[:, last : last + many], 0.0), reaction, at.active, at.held)

    def _exchanged(self, at: Guess, system: StepEquations) -> tuple[Guess, Flags]:
        """The guess with other equations where a condition does not hold, and for which points that is so."""
        inner = self._unknown[1]
        new, alpha = at.copy(), at.chi[:, inner]
        new.active[at.multiplier < 0.0] = False
        new.multiplier[at.multiplier < 0.0] = 0.0
        if at.active.shape[1]:
            excess = np.where(at.active, -np.inf, _excess(system.criteria, system.criterion_size))
            most, rows = np.argmax(excess, axis=1), np.arange(len(excess))
            new.active[rows, most] |= excess[rows, most] > KKT
        out = (alpha < self.low) | (alpha > self.high)
        bounded = np.clip(alpha, self.low, self.high)
        new.chi[:, inner] = bounded
        upper = alpha >= self.high
        free = np.where(self.reacts, np.where(upper, at.reaction < 0.0, at.reaction > 0.0), False)
        new.held[:] = (at.held & ~free) | out
        new.reaction[~new.held] = 0.0
        changed = (new.active != at.active).any(axis=1) | (new.held != at.held).any(axis=1)
        return new, changed

    # -- the step ------------------------------------------------------------------------------------------------------

    def advance(self, base: Array, given: Array, dt: float, others: Sequence[Array], tangent: bool = False) -> Advanced:
        """The end of a step of ``dt`` from ``base`` (N, n); ``given`` (N, columns) is prescribed: u or d psi/du, and T unless adiabatic."""
        n, many = len(base), len(self.criteria)
        zeros, none = np.zeros((n, many)), np.zeros((n, many), dtype=np.bool_)
        begun = Guess(base.copy(), zeros, np.zeros((n, self.internal)), none, np.zeros((n, self.internal), dtype=np.bool_))
        with np.errstate(all="ignore"):
            at, system, failed = self._ended(begun, base, given, dt, others)
            ways: list[Callable[..., _Found]] = [self._followed]
            ways += [partial(self._stopped, ends) for ends in (self.high, self.low) if (self.reacts & np.isfinite(ends)).any()]
            for otherwise in ways:
                if (who := np.flatnonzero(failed)).size:
                    reached, ended, unsolved = otherwise(begun.of(who), base[who], given[who], dt, [x[who] for x in others])
                    at.put(who, reached)
                    system.put(who, ended)
                    failed[who] = unsolved
            slopes = self._tangent(at, system) if tangent else np.zeros((n, 0, 0))
            lost = own_dissipation(self, base, at.chi, others)
        return Advanced(
            at.chi, at.multiplier, at.reaction, at.held, system.psi, system.forces, system.observed, system.entropy, system.flow,
            lost, _worst(system.residual, system.size), failed, slopes,
        )  # fmt: skip

    def _followed(self, at: Guess, base: Array, given: Array, dt: float, others: Sequence[Array]) -> _Found:
        """The end of the same step, found along those of steps from the same ``base`` to a part of the load, each from the two before."""
        u, _, warm = self._unknown
        start = self.free_energy.first(base, others)[1][:, u] if self.stressed else base[:, u]
        start = np.concatenate([start, base[:, warm]], axis=1)[:, : given.shape[1]]
        before, first, last = at, 0.0, 0.0
        for share in _SHARES:
            ahead = (share - last) / (last - first) if last else 0.0  # of the way from the share before, by which both go on
            chi, multiplier = (now + ahead * (now - then) for now, then in ((at.chi, before.chi), (at.multiplier, before.multiplier)))
            guess = Guess(chi, np.maximum(multiplier, 0.0), at.reaction, at.active, at.held)
            before, first, last = at, last, share
            at, system, failed = self._ended(guess, base, start + share * (given - start), share * dt, others)
            if failed.all():
                break
        return at, system, failed

    def _stopped(self, ends: Array, at: Guess, base: Array, given: Array, dt: float, others: Sequence[Array]) -> _Found:
        """The same, begun where the variables with such ``ends`` are held by them: a variable may jump there, as brittle damage does."""
        at, held = at.copy(), self.reacts & np.isfinite(ends)
        at.chi[:, self._unknown[1]][:, held], at.held[:, held], at.active[:] = ends[held], True, True
        return self._ended(at, base, given, dt, others)

    def _ended(self, at: Guess, base: Array, given: Array, dt: float, others: Sequence[Array]) -> _Found:
        """Where Newton's method comes from a guess, with equations exchanged until all conditions hold; and what it did not solve."""
        at, (n, o), times = at.copy(), (len(base), self.observables), np.full(len(base), dt)
        load = given[:, :o]
        if not self.stressed:
            at.chi[:, :o] = load
        if given.shape[1] > o:
            at.chi[:, -1] = given[:, o]

        def asked(guess: Guess, who: NDArray[np.intp]) -> StepEquations:
            return self.system(guess, base[who], load[who], times[who], [x[who] for x in others])

        system = asked(at, np.arange(n))
        failed, still, todo = np.zeros(n, dtype=np.bool_), np.zeros(n, dtype=np.bool_), np.arange(n)
        for _ in range(MOST):
            worst = _worst(system.residual, system.size)
            settled = (worst[todo] <= GOAL) | ((worst[todo] <= KKT) & still[todo])
            if (who := todo[settled]).size:
                new, changed = self._exchanged(at.of(who), system.of(who))
                todo = np.setdiff1d(todo, who[~changed], assume_unique=True)
                if (who := who[changed]).size:
                    at.put(who, new.of(changed))
                    system.put(who, asked(at.of(who), who))
                    still[who] = False
            if not todo.size:
                break
            here, now = at.of(todo), system.of(todo)
            reached, ended, better = self._damped(here, now, lambda guess, part, who=todo: asked(guess, who[part]))
            at.put(todo, reached)
            system.put(todo, ended)
            lost = ~better & (_worst(now.residual, now.size) > KKT)
            failed[todo[lost]] = True
            still[todo] = ~better
            todo = todo[~lost]
        failed[todo] = True
        failed |= ~(_worst(system.residual, system.size) <= KKT) | (at.multiplier < 0.0).any(axis=1)
        return at, system, failed | self._untrue(at, system, base)

    def _untrue(self, at: Guess, system: StepEquations, base: Array) -> Flags:
        """Where rates without a multiplier dissipate another energy than the variables' change does.

        Of a rate that is steep in the force the residual alone says little: the rounding of the force may be as much as all of the rate.
        """
        if not (self.law.viscous or self.law.rates):
            return np.zeros(len(base), dtype=np.bool_)
        u, inner, _ = self._unknown
        by, force = at.chi - base, np.abs(system.forces)
        change, flow = by[:, inner][:, self.order], system.flow[:, self.order]
        energies = (force * (np.abs(change) + np.abs(flow))).sum(axis=1) + np.abs(system.observed * by[:, u]).sum(axis=1)
        rounding = (force * np.abs(at.chi[:, inner][:, self.order])).sum(axis=1)
        return ~((force * np.abs(change - flow)).sum(axis=1) <= UNTRUE * energies + SPOILT * rounding)

    def _damped(self, at: Guess, system: StepEquations, asked: Any) -> tuple[Guess, StepEquations, Flags]:
        """A step of Newton's method, halved until the residuals fall; where it ends, and where they fell."""
        by = -_solved(self._jacobian(at, system), system.residual)
        near = _worst(system.residual, system.size) <= KKT
        reached, ended, better = at.copy(), system.copy(), np.zeros(len(by), dtype=np.bool_)
        left = np.arange(len(by))
        for _ in range(HALVINGS):
            new = self._moved(at.of(left), by[left])
            then = asked(new, left)
            size = np.maximum(system.size[left], then.size)  # what was at rest has none
            good = _length(then.residual, size) < np.where(near[left], 0.5, 1.0) * _length(system.residual[left], size)
            reached.put(left[good], new.of(good))
            ended.put(left[good], then.of(good))
            better[left[good]] = True
            left = left[~good & ~near[left]]  # where little is left, whole steps are taken or none
            if not left.size:
                break
            by[left] *= 0.5
        return reached, ended, better

    def _tangent(self, at: Guess, system: StepEquations) -> Array:
        """d (d psi/du)/du at the end of a step, through all that is unknown there."""
        u, inner, warm = self._unknown
        if self.stressed:
            raise InputError("the forces are prescribed, and no displacement", where="tangent", remedy='use control="displacement"')
        moved = -_solved(self._jacobian(at, system), system.by_state[:, :, u])
        found = system.hessian[:, u, u] + system.hessian[:, u, inner] @ np.where(at.held[:, :, None], 0.0, moved[:, : self.internal])
        return found + system.hessian[:, u, warm] @ moved[:, -1:] if self.adiabatic else found

    @np.errstate(all="ignore")
    def outside(self, at: Array, others: Sequence[Array]) -> Array:
        """By how much states (N, n), no bound of which reacts, lie outside a criterion, relative to its size and its rounding (N,)."""
        n, none = len(at), np.zeros((len(at), self.internal), dtype=np.bool_)
        zeros = np.zeros((n, len(self.criteria)))
        rest = Guess(at, zeros, np.zeros((n, self.internal)), zeros > 0.0, none)
        system = self.system(rest, at, np.zeros((n, self.observables)), np.zeros(n), others)
        return _excess(system.criteria, system.criterion_size).max(axis=1, initial=-np.inf)

    def stored(self, at: Array, others: Sequence[Array]) -> tuple[Array, Array, Array]:
        """psi (N,), the forces Y (N, d) and the entropy (N,) of states."""
        psi, force = self.free_energy.first(at, others)
        return psi, 0.0 - force[:, self.order + self.observables], 0.0 - force[:, self._unknown[2]].sum(axis=1)


def own_dissipation(law: StateLaw, before: Array, after: Array, others: Sequence[Array]) -> Array:
    """What the implicit step from one state to another loses, (N,): psi(before) - psi(after) + d . d psi(after), d = after - before.

    Of a quadratic energy it is 1/2 d . psi'' d, of a convex one >= 0 but for the rounding of psi.
    """
    (begun, _), (end, force) = (law.free_energy.first(at, others) for at in (before, after))
    return np.asarray(begun - end + (force * (after - before)).sum(axis=1))


def _excess(value: Array, size: Array) -> Array:
    """By how much criteria are violated, relative to their sizes; without end where they have no value, or no size."""
    sized = (value > 0.0) & np.isfinite(value) & np.isfinite(size) & (size != 0.0)
    return np.divide(value, size, out=np.where(value <= 0.0, 0.0, np.inf), where=sized)


def _worst(residual: Array, size: Array) -> Array:
    found = np.abs(residual) / size
    return np.asarray(np.where(np.isfinite(found).all(axis=1), found.max(axis=1, initial=0.0), np.inf))


def _length(residual: Array, size: Array) -> Array:
    found = np.square(residual / size).sum(axis=1)
    return np.asarray(np.where(np.isfinite(found), found, np.inf))


def _solved(matrices: Array, right: Array) -> Array:
    """matrices^-1 right; what has no inverse by least squares, and nan where there are no numbers."""
    columns = right[:, :, None] if right.ndim == 2 else right
    known = np.asarray(np.isfinite(matrices).all(axis=(1, 2)) & np.isfinite(columns).all(axis=(1, 2)))
    plain = np.where(known[:, None, None], matrices, np.eye(matrices.shape[1]))
    try:
        found = np.linalg.solve(plain, columns)
    except np.linalg.LinAlgError:
        found = np.linalg.pinv(plain) @ columns
    return np.asarray(np.where(known[:, None, None], found, np.nan).reshape(right.shape))
