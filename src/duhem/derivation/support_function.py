"""The dissipation potential in closed form: the support function of K = {g <= 0} (Antoni et al. 2007, Eqs. 27-34).

Phi(d) = sup { sigma . d : g(sigma) <= 0 } is the Legendre-Fenchel conjugate of the indicator of K (Rockafellar 1970,
Theorem 13.2).  Where K is read as centre + radius {gauge <= 1}, Phi(d) = centre . d + radius gauge°(d), with gauge°
the polar gauge.  Units: those of the stresses; rates d are dimensionless or in one unit; sigma_n <= 0 in compression.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import sympy as sp

from duhem.derivation.numerical_check import defects, gauges_agree
from duhem.derivation.potential import SupportFunction
from duhem.derivation.recognise import read_ball
from duhem.law.formula_law import Criterion

__all__ = ["Biconjugate", "biconjugate", "compression", "fixed", "rate_symbols", "support_function"]


@dataclass(frozen=True)
class Biconjugate:
    """The gauge of K recomputed from the potential: ``gauge`` in the forces, and whether it is the one K came with."""

    gauge: sp.Expr
    agrees: bool
    how: str


def rate_symbols(law: Criterion) -> tuple[sp.Symbol, ...]:
    """One real symbol per force: ``d_a`` for ``sigma_a``, ``d_`` and the name for others; more d's if that is taken."""
    taken, found = set(law.symbols()), []
    for force in law.forces:
        name = "d_" + force.removeprefix("sigma_")
        while name in taken:
            name = "d" + name
        taken.add(name)
        found.append(sp.Symbol(name, real=True))
    return tuple(found)


def fixed(law: Criterion, parameters: Mapping[str, Any] | None = None) -> Criterion:
    """The law with ``parameters`` fixed, every fixed value in the place of its symbol."""
    law = law.fix(parameters)
    values = law.settled()
    if not values:
        return law

    def put(expr: sp.Expr) -> sp.Expr:
        return expr.xreplace(values)

    surfaces = tuple(surface.map(put) for surface in law.surfaces)
    flow = None if law.flow is None else tuple(map(put, law.flow))
    return replace(law, g=sp.nan if surfaces else put(law.g), flow=flow, potential=None, surfaces=surfaces)


def support_function(law: Criterion, parameters: Mapping[str, Any] | None = None) -> SupportFunction | None:
    """Closed form of sup { sigma . d : g(sigma, sigma_n) <= 0 }, or None where the calculus has none.

    What the rules give is returned only after :func:`duhem.derivation.numerical_check.defects` finds nothing against it: the
    maximiser lies in K and attains the potential, and no point of K exceeds it, at random exact parameters.
    """
    law = fixed(law, parameters)
    rates = rate_symbols(law)
    inward, outward = compression(law)
    forces = law.force_symbols()
    ball = read_ball(law.g.xreplace(inward), forces)
    if ball is None:
        return None
    try:
        polar, unit = ball.gauge.polar(rates), ball.gauge.maximiser(rates)
        domain = ball.gauge.domain(rates)
        value = ball.gauge.value([f - c for f, c in zip(forces, ball.centre, strict=True)])
    except (ArithmeticError, ValueError, TypeError):
        return None
    potential = sp.Add(*[c * d for c, d in zip(ball.centre, rates, strict=True)]) + ball.radius * polar
    maximiser = tuple(c + ball.radius * u for c, u in zip(ball.centre, unit, strict=True))
    found = SupportFunction(
        potential=potential.xreplace(outward),
        rates=rates,
        domain=domain,
        steps=(
            "the dissipation potential is the conjugate of the indicator of K, its support function (Rockafellar 1970, Theorem 13.2)",
            *ball.gauge.steps,
            *_placing(ball.centre, ball.radius),
        ),
        maximiser=tuple(m.xreplace(outward) for m in maximiser),
        requires=tuple(r.xreplace(outward) for r in ball.requires),
        gauge=(value / ball.radius).xreplace(outward),
        centre=tuple(c.xreplace(outward) for c in ball.centre),
        radius=ball.radius.xreplace(outward),
    )
    return None if defects(law, found) else found


def biconjugate(law: Criterion, support: SupportFunction, parameters: Mapping[str, Any] | None = None) -> Biconjugate | None:
    """Phi** = Phi: the polar of the polar, read afresh from the potential's own formula, compared with the gauge of K.

    The polar of {Phi - centre . d <= 1} on the domain of Phi is the gauge of K about its centre (Rockafellar 1970,
    Theorems 14.5 and 15.1).  None where the potential is not read back in closed form.
    """
    law = fixed(law, parameters)
    inward, outward = compression(law)
    rates, forces = support.rates, law.force_symbols()
    centred = (support.potential - sp.Add(*[c * d for c, d in zip(support.centre, rates, strict=True)])).xreplace(inward)
    rows = sp.Matrix([[form.coeff(d) for d in rates] for form in support.domain]) if support.domain else sp.zeros(0, len(rates))
    basis = sp.Matrix.hstack(*rows.nullspace()) if support.domain else sp.eye(len(rates))
    local = [sp.Dummy(f"e{i}", real=True) for i in range(basis.cols)]
    moved = dict(zip(rates, basis * sp.Matrix(local), strict=True))
    ball = read_ball(centred.xreplace(moved) - 1, local)
    if ball is None or any(ball.centre):
        return None
    shifted = sp.Matrix([f - c for f, c in zip(forces, support.centre, strict=True)])
    gauge = (ball.radius * ball.gauge.polar(list(basis.T * shifted.xreplace(inward)))).xreplace(outward)
    if gauge == support.gauge:
        return Biconjugate(gauge, True, "the two expressions are identical")
    return Biconjugate(gauge, gauges_agree(law, support, gauge), "the two expressions agree to 30 digits at exact points drawn at random")


def compression(law: Criterion) -> tuple[dict[sp.Expr, sp.Expr], dict[sp.Expr, sp.Expr]]:
    """The pressure as minus a positive symbol, and back: on the domain sigma_n < 0 that lets SymPy see signs."""
    if law.pressure is None:
        return {}, {}
    pressure, size = law.symbols()[law.pressure], sp.Symbol(f"|{law.pressure}|", positive=True)
    return {pressure: -size}, {size: -pressure}


def _placing(centre: tuple[sp.Expr, ...], radius: sp.Expr) -> tuple[str, ...]:
    moved = f" and K is centred at ({', '.join(map(str, centre))}): a translation adds centre . d" if any(centre) else ""
    return (f"K is the unit ball scaled by {radius}: the potential is scaled by it{moved} (Rockafellar 1970, section 13)",)
