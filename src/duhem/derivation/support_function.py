"""The dissipation potential in closed form: the support function of K = {g <= 0} (Antoni et al. 2007, Eqs. 27-34).

Phi(d) = sup { sigma . d : g(sigma) <= 0 } is the Legendre-Fenchel conjugate of the indicator of K (Rockafellar 1970,
Theorem 13.2).  Where K is read as centre + radius {gauge <= 1}, Phi(d) = centre . d + radius gauge°(d), with gauge°
the polar gauge.  Units: those of the stresses; rates d are dimensionless or in one unit; sigma_n <= 0 in compression.
:func:`biconjugate` goes the way back, from the potential to the gauge of K.  How K is read from g is in :mod:`duhem.derivation.recognise`.

Nothing here is a proof.  What is claimed is tried by evaluation at random exact parameters (:func:`defects`).  Three facts make a support
function: its maximiser lies in K, attains the potential, and no point of K exceeds it.  The first two are evaluated with 40 digits; the
third on points of the boundary of K found from g alone, along rays, without any use of how K was read.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from random import Random
from typing import Any

import mpmath
import sympy as sp

from duhem.derivation.recognise import read_ball
from duhem.expression import holds_at, mpmath_
from duhem.expression.mpmath_ import reach
from duhem.law.formula_law import Criterion

__all__ = [
    "BITS", "ROUGH", "Biconjugate", "SupportFunction", "biconjugate", "compression", "defects", "finite", "fixed", "rate_symbols",
    "sample_values", "support_function", "varies",
]  # fmt: skip


@dataclass(frozen=True)
class SupportFunction:
    """The potential and what it rests on.

    ``potential`` is finite exactly where every expression of ``domain`` (linear in ``rates``) vanishes.  ``gauge``, taken
    about ``centre`` and divided by ``radius``, describes K = {gauge <= 1}.  ``maximiser`` is the stress that attains
    the supremum, for d != 0.  ``steps`` are the theorems used, in order.  All of it holds where every expression of
    ``requires`` is positive.
    """

    potential: sp.Expr
    rates: tuple[sp.Symbol, ...]
    domain: tuple[sp.Expr, ...]
    steps: tuple[str, ...]
    maximiser: tuple[sp.Expr, ...] | None
    requires: tuple[sp.Expr, ...]
    gauge: sp.Expr
    centre: tuple[sp.Expr, ...]
    radius: sp.Expr


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
    stored = {x: value for x, value in values.items() if x.name not in law.variables}  # an energy has a derivative there too

    def put(expr: sp.Expr) -> sp.Expr:
        return expr.xreplace(values)

    surfaces = tuple(surface.map(put) for surface in law.surfaces)
    flow = None if law.flow is None else tuple(map(put, law.flow))
    return replace(
        law,
        g=sp.nan if surfaces else put(law.g),
        flow=flow,
        potential=None,
        surfaces=surfaces,
        energy=None if law.energy is None else law.energy.xreplace(stored),
        unforced={name: put(rate) for name, rate in law.unforced.items()},
        rates={name: put(rate) for name, rate in law.rates.items()},
        heat={name: put(conductance) for name, conductance in law.heat.items()},
    )


def support_function(law: Criterion, parameters: Mapping[str, Any] | None = None) -> SupportFunction | None:
    """Closed form of sup { sigma . d : g(sigma, sigma_n) <= 0 }, or None where the calculus has none.

    What the rules give is returned only after :func:`defects` finds nothing against it: the maximiser lies in K and attains the
    potential, and no point of K exceeds it, at random exact parameters.
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


def biconjugate(law: Criterion, support: SupportFunction) -> Biconjugate | None:
    """Phi** = Phi: the polar of the polar, read afresh from the potential's own formula, compared with the gauge of K.

    The polar of {Phi - centre . d <= 1} on the domain of Phi is the gauge of K about its centre (Rockafellar 1970,
    Theorems 14.5 and 15.1).  None where the potential is not read back in closed form.
    """
    law = fixed(law)
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


DIGITS = 40
BITS = 39  # of a boundary point: 12 digits, so that in 15 no rounding of g takes it out of K
ROUGH = 15  # digits along a ray
SMALL = 25


def finite(values: list[Any]) -> list[Any]:
    """The values as they are; ArithmeticError if one is undefined or infinite, which no comparison would tell."""
    if not all(map(mpmath.isfinite, values)):
        raise ArithmeticError("a value is not real and finite")
    return values


def sample_values(law: Criterion, requires: Sequence[sp.Expr], random: Random, count: int) -> Iterator[dict[sp.Symbol, sp.Rational]]:
    """Rational values of pressure and free parameters inside the domain, the constraints and ``requires``."""
    symbols = law.symbols()
    found = 0
    for _ in range(200 * count):
        values = {x: _inside(domain, random) for x, domain in law.free().items()} | law.fixed_values()
        if law.pressure is not None:
            values[symbols[law.pressure]] = -sp.Rational(random.randint(1, 40), random.randint(1, 12))
        if all(holds_at(relation, values) for relation in (*law.constraints, *(r > 0 for r in requires))):
            yield values
            found += 1
            if found == count:
                return


def _inside(domain: Any, random: Random) -> sp.Rational:
    share = sp.Rational(random.randint(1, 23), 24)
    if domain.low is not None and domain.high is not None:
        return domain.low + share * (domain.high - domain.low)
    size = sp.Rational(random.randint(1, 30), random.randint(4, 16))
    if domain.low is not None:
        return domain.low + size
    return domain.high - size if domain.high is not None else size * random.choice((-1, 1))


def defects(law: Criterion, support: SupportFunction) -> tuple[str, ...]:
    """What was found against ``support``: empty where nothing was; not to be able to evaluate it is a defect too."""
    try:
        return tuple(_defects(law, support))
    except (ArithmeticError, TypeError, ValueError, mpmath.libmp.NoConvergence) as error:
        return (f"the claim cannot be evaluated: {error}",)


def _defects(law: Criterion, support: SupportFunction) -> Iterator[str]:
    random, forces = Random(2007), law.force_symbols()
    others = [s for s in law.symbols().values() if s not in forces]
    fine, rough, doubles = mpmath_.digits(DIGITS), mpmath_.digits(ROUGH), mpmath_.doubles()
    g, g_roughly, g_of_doubles = (mpmath_.compiled([law.g], [*forces, *others], context) for context in (fine, rough, doubles))
    claim = mpmath_.compiled([support.potential, *(support.maximiser or ()), *support.centre], [*support.rates, *others], fine)
    tried, small = 0, fine.mpf(10) ** -SMALL
    for values in sample_values(law, support.requires, random, 3):
        rest = [values[s] for s in others]
        tried += 1
        rates = [_direction(support, values, random) for _ in range(6)]
        claims = [finite(claim(*d, *rest)) for d in rates]
        n = len(forces)
        centre = claims[0][-n:]
        rays = [[random.gauss(0, 1) for _ in range(n)] for _ in range(4 * len(rates))]

        def level(x: list[float], rest: Sequence[Any] = tuple(mpmath_.number(rough, v) for v in rest)) -> float:
            try:
                return float(g_of_doubles(*x, *map(float, rest))[0])
            except (ArithmeticError, TypeError, ValueError):  # beyond their range, or no real one
                return float(g_roughly(*x, *rest)[0])

        reached = [(ray, reach(doubles, level, list(map(float, centre)), ray, BITS)) for ray in rays]
        cloud = [[c + fine.mpf(t) * fine.mpf(r) for c, r in zip(centre, ray, strict=True)] for ray, t in reached if t is not None]
        scale = max([abs(c[0]) for c in claims] + [fine.mpf(10) ** -6])
        for d, (potential, *found) in zip(rates, claims, strict=True):
            exact = [mpmath_.number(fine, x) for x in d]
            size = fine.sqrt(fine.fsum(x**2 for x in exact))
            if support.maximiser is not None:
                point = found[:n]
                if finite(g(*point, *rest))[0] > small * scale:
                    yield f"the maximiser lies outside K at {values}, d = {d}"
                if abs(fine.fdot(point, exact) - potential) > small * scale:
                    yield f"the maximiser does not attain the potential at {values}, d = {d}"
            if any(fine.fdot(x, exact) > potential + size * small * scale for x in cloud):
                yield f"a point of K exceeds the potential at {values}, d = {d}"
    if not tried:
        yield "no parameter values satisfy what the potential requires"


def gauges_agree(law: Criterion, support: SupportFunction, gauge: sp.Expr) -> bool:
    """Whether two gauges of K agree to 30 digits at random exact points, and agree with g on what lies inside."""
    random, forces = Random(1970), law.force_symbols()
    others = [s for s in law.symbols().values() if s not in forces]
    fine = mpmath_.digits(DIGITS)
    both = mpmath_.compiled([gauge, support.gauge, law.g], [*forces, *others], fine)
    small = fine.mpf(10) ** -SMALL
    for values in sample_values(law, support.requires, random, 4):
        for _ in range(24):
            x = [sp.Rational(random.randint(-60, 60), random.randint(7, 40)) for _ in forces]
            *gauges, g = both(*x, *(values[s] for s in others))
            first, second = finite(gauges)
            apart = abs(first - second) > fine.mpf(10) ** -30 * (1 + abs(second))
            if apart or (not g <= small and first < 1) or (g < -small and first > 1):
                return False
    return True


def varies(law: Criterion, expr: sp.Expr) -> bool:
    """Whether ``expr`` takes two values, 20 digits apart at least, at forces drawn at random and the same parameters."""
    random, forces = Random(1755), law.force_symbols()
    others = [s for s in law.symbols().values() if s not in forces]
    fine = mpmath_.digits(DIGITS)
    value = mpmath_.compiled([expr], [*forces, *others], fine)
    for values in sample_values(law, (), random, 3):
        seen = []
        for _ in range(6):
            x = [sp.Rational(random.randint(-60, 60), random.randint(7, 40)) for _ in forces]
            with suppress(ArithmeticError, TypeError, ValueError):
                seen += finite(value(*x, *(values[s] for s in others)))
        if seen and max(seen) - min(seen) > fine.mpf(10) ** -20 * (1 + max(map(abs, seen))):
            return True
    return False


def _direction(support: SupportFunction, values: Mapping[sp.Symbol, sp.Rational], random: Random) -> list[sp.Rational]:
    """A nonzero rational rate on the domain of the potential."""
    rows = sp.Matrix([[form.coeff(d) for d in support.rates] for form in support.domain]).subs(values) if support.domain else None
    basis = rows.nullspace() if rows is not None else [sp.Matrix(column) for column in sp.eye(len(support.rates)).tolist()]
    while True:
        weights = [sp.Rational(random.randint(-9, 9), random.randint(1, 7)) for _ in basis]
        if any(weights):
            return list(sum((w * b for w, b in zip(weights, basis, strict=True)), sp.zeros(len(support.rates), 1)))
