"""One step of slip by backward Euler, and the reduction to one direction (Antoni et al. 2007, Eq. 1)."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from random import Random
from typing import Any

import sympy as sp

from duhem.derivation.energy import column, energy, equal
from duhem.derivation.equation import Belongs, Equation
from duhem.derivation.koiter import step_of_surfaces
from duhem.derivation.notation import Names
from duhem.derivation.numerical_check import sample_values
from duhem.derivation.pieces import Pieces
from duhem.derivation.recognise import read_ball
from duhem.derivation.support_function import compression
from duhem.expression import mpmath_
from duhem.law.formula_law import Criterion

__all__ = ["LineSection", "increment_equations", "interval", "one_dimensional_equations"]

STEP, LINE = "Incremental problem", "Reduction to one direction"


def increment_equations(names: Names, found: Pieces | None) -> Iterator[Equation]:
    """The closest-point step in the metric of k^-1 with its optimality conditions; every line from the Lagrangian."""
    law, forces = names.law, names.forces
    predictor = (u - p for u, p in zip(names.total, names.inelastic, strict=True))
    yield Equation(
        "D13",
        "trial_stress",
        equal(column(names.trial), column(names.stiffness * sp.Matrix(list(predictor)))),
        "stress if nothing slipped over the step: u at its end, u_in at its beginning",
        STEP,
    )
    compliance = names.stiffness.inv()
    gap = sp.Matrix([t - s for t, s in zip(names.trial, forces, strict=True)])
    slip = compliance * gap
    if not law.associated and law.flow is None:
        yield from step_of_surfaces(names, STEP)
    elif law.flow is not None:
        moved = column(t - c for t, c in zip(names.trial, names.step * names.stiffness * sp.Matrix(law.flow), strict=True))
        yield Equation("D14", "step_stress", equal(column(forces), moved), "own flow: a fixed point, not a projection", STEP)
    else:
        distance = (gap.T * compliance * gap)[0] / 2
        yield Equation(
            "D14",
            "step_objective",
            equal(sp.Function("J")(*forces), distance),
            "the stress minimises J over K: the closest point to the trial stress in the metric of k^-1",
            STEP,
        )
        if found is not None:
            slopes = [
                found.joined([sp.factor_terms(distance.diff(f)) + (names.step * value).diff(f) for value in found.values]) for f in forces
            ]
            yield Equation(
                "D15",
                "step_stationarity",
                equal(column(slopes), column([sp.S.Zero] * len(forces))),
                "gradient of the Lagrangian J + Delta_lambda g: k^-1 (sigma_trial - sigma) = Delta_lambda dg/dsigma",
                STEP,
            )
    if law.associated or law.flow is not None:
        three = (sp.GreaterThan(names.step, 0, evaluate=False), sp.LessThan(law.g, 0, evaluate=False), equal(names.step * law.g, sp.S.Zero))
        yield Equation(
            "D16", "step_complementarity", sp.And(*three, evaluate=False), "the step slips only if it ends on the boundary", STEP
        )
    yield Equation(
        "D17", "step_slip", equal(column(names.slip_step), column(slip)), "slip over the step: the trial stress in excess, released", STEP
    )
    yield _energy_identity(names)


def _energy_identity(names: Names) -> Equation:
    """sigma . Du = Dpsi + sigma . Du_in + 1/2 Du_e . k Du_e, expanded to zero here before it is stated."""
    ends, steps = names.elastic, names.elastic_step
    lost = energy(names, steps)
    stored = energy(names, ends) - energy(names, tuple(e - s for e, s in zip(ends, steps, strict=True)))
    stress = names.stiffness * sp.Matrix(list(ends))
    work = sp.Add(*[s * (e + p) for s, e, p in zip(names.forces, steps, names.slip_step, strict=True)])
    slipped = sp.Add(*[s * p for s, p in zip(names.forces, names.slip_step, strict=True)])
    if sp.expand((work - slipped).xreplace(dict(zip(names.forces, stress, strict=True))) - stored - lost) != 0:
        raise ArithmeticError("the discrete energy identity does not hold")
    return Equation(
        "D18",
        "step_energy",
        equal(work, sp.Symbol("Delta_psi_C", real=True) + slipped + lost),
        "work = change of stored energy + dissipation + a numerical part that is never negative, for every step size",
        STEP,
    )


@dataclass(frozen=True)
class LineSection:
    """low <= force <= high is K where the other forces vanish, wherever every expression of ``requires`` is positive."""

    force: sp.Symbol
    low: sp.Expr
    high: sp.Expr
    requires: tuple[sp.Expr, ...]


def interval(law: Criterion, force: sp.Symbol) -> LineSection | None:
    """K on the line of one force, from the formula; None where it is unbounded, not closed or not confirmed by g."""
    others = dict.fromkeys((f for f in law.force_symbols() if f != force), sp.S.Zero)
    inward, outward = compression(law)
    g = law.g.xreplace({**others, **inward})
    ball = read_ball(g, [force])
    if ball is not None:
        ends = [ball.centre[0] + ball.radius * sign / ball.gauge.value([sp.Integer(sign)]) for sign in (-1, 1)]
    else:
        below, above = (_positive_root(g, force, sign) for sign in (-1, 1))
        if below is None or above is None:
            return None
        ends = [-below, above]
    if any(end.has(sp.AccumBounds, sp.nan, sp.zoo, sp.oo) for end in ends):
        return None
    low, high = (sp.factor_terms(end).xreplace(outward) for end in ends)
    found = LineSection(force, low, high, tuple(r.xreplace(outward) for r in ball.requires) if ball is not None else ())
    return found if _confirmed(law, found) else None


def _confirmed(law: Criterion, found: LineSection) -> bool:
    """Whether g, at exact parameters drawn at random, is zero at both ends, not positive between and positive outside."""
    symbols = list(law.symbols().values())
    try:
        context = mpmath_.digits(30)
        evaluate = mpmath_.compiled([law.g, found.low, found.high], symbols, context)
        tried = 0
        for values in sample_values(law, found.requires, Random(1), 12):
            line = {s: sp.S.Zero for s in law.force_symbols()} | values

            def at(x: Any, line: dict[sp.Symbol, Any] = line) -> list[Any]:
                return evaluate(*(x if s == found.force else line[s] for s in symbols))

            _, low, high = at(sp.S.Zero)
            small = (high - low) * context.mpf(10) ** -9
            inside = [at(low + share * (high - low) / 8)[0] <= 0 for share in range(1, 8)]
            ends = [at(low + small)[0] <= 0 < at(low - small)[0], at(high - small)[0] <= 0 < at(high + small)[0]]
            if not (low < high and all(inside) and all(ends)):
                return False
            tried += 1
        return tried > 0
    except (ArithmeticError, TypeError, ValueError, NotImplementedError):
        return False


def _positive_root(g: sp.Expr, force: sp.Symbol, sign: int) -> sp.Expr | None:
    """The one positive t with g(sign t) = 0, if g is a polynomial there with exactly one."""
    t = sp.Dummy("t", positive=True)
    along = sp.factor(g.xreplace({force: sign * t}))
    if not along.is_polynomial(t):
        return None
    x = sp.Dummy("x")
    roots = [r for r in sp.roots(sp.Poly(along.xreplace({t: x}), x)) if r != 0 and r.is_real is not False and r.is_positive is not False]
    return roots[0] if len(roots) == 1 else None


def one_dimensional_equations(names: Names) -> Iterator[Equation]:
    """Eq. (1) for each force alone: the interval of the sticking state and the elastic, perfectly plastic branch."""
    law = names.law
    for i, force in enumerate(names.forces):
        found = interval(law, force)
        if found is None:
            continue
        low, high = found.low, found.high
        needs = f"; where {', '.join(f'{names.shown(r)} > 0' for r in found.requires)}" if found.requires else ""
        tail = law.forces[i].removeprefix("sigma_")
        bounds = Belongs(force, sp.Interval(low, high))
        number = "D19" if len(names.forces) == 1 else f"D19.{i + 1}"
        yield Equation(
            number,
            f"interval_{tail}",
            bounds,
            ("K with the other forces zero" if len(names.forces) > 1 else "K as an interval") + needs,
            LINE,
        )
        if not law.associated:
            continue
        elastic = names.stiffness[i, i] * names.total[i]
        stick = sp.And(sp.StrictLessThan(low, elastic, evaluate=False), sp.StrictLessThan(elastic, high, evaluate=False), evaluate=False)
        law_1d = sp.Piecewise(
            (elastic, stick),
            (high, sp.GreaterThan(elastic, high, evaluate=False)),
            (low, sp.LessThan(elastic, low, evaluate=False)),
            evaluate=False,
        )
        yield Equation(
            "1" if len(names.forces) == 1 else f"1.{i + 1}",
            f"one_dimensional_{tail}",
            equal(force, law_1d),
            "first loading from rest along this direction: elastic between the ends, slipping at either",
            LINE,
        )
