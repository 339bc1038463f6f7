"""What can be said against a claimed support function, by evaluation at random exact parameters.

Three facts make a support function: its maximiser lies in K, attains the potential, and no point of K exceeds it.
The first two are evaluated with 40 digits; the third on points of the boundary of K found from g alone, along rays,
without any use of how K was read.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from random import Random
from typing import Any

import mpmath
import sympy as sp

from duhem.derivation.potential import SupportFunction
from duhem.expression import mpmath_
from duhem.expression.rays_mpmath import reach
from duhem.law.formula_law import Criterion

__all__ = ["BITS", "ROUGH", "defects", "finite", "gauges_agree", "sample_values", "varies"]

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
    names = [name for name, domain in law.parameters.items() if domain.value is None]
    found = 0
    for _ in range(200 * count):
        values = {symbols[name]: _inside(law.parameters[name], random) for name in names}
        values |= {symbols[name]: domain.value for name, domain in law.parameters.items() if domain.value is not None}
        if law.pressure is not None:
            values[symbols[law.pressure]] = -sp.Rational(random.randint(1, 40), random.randint(1, 12))
        if all(c.subs(values) == True for c in law.constraints) and all((r > 0).subs(values) == True for r in requires):  # noqa: E712
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


def defects(law: Criterion, support: SupportFunction, parameters: int = 3, directions: int = 6) -> tuple[str, ...]:
    """What was found against ``support``: empty where nothing was; not to be able to evaluate it is a defect too."""
    try:
        return tuple(_defects(law, support, parameters, directions))
    except (ArithmeticError, TypeError, ValueError, mpmath.libmp.NoConvergence) as error:
        return (f"the claim cannot be evaluated: {error}",)


def _defects(law: Criterion, support: SupportFunction, parameters: int, directions: int) -> Iterator[str]:
    random, forces = Random(2007), law.force_symbols()
    others = [s for s in law.symbols().values() if s not in forces]
    fine, rough = mpmath_.digits(DIGITS), mpmath_.digits(ROUGH)
    g, g_roughly = (mpmath_.compiled([law.g], [*forces, *others], context) for context in (fine, rough))
    claim = mpmath_.compiled([support.potential, *(support.maximiser or ()), *support.centre], [*support.rates, *others], fine)
    tried, small = 0, fine.mpf(10) ** -SMALL
    for values in sample_values(law, support.requires, random, parameters):
        rest = [values[s] for s in others]
        tried += 1
        rates = [_direction(support, values, random) for _ in range(directions)]
        claims = [finite(claim(*d, *rest)) for d in rates]
        n = len(forces)
        centre = claims[0][-n:]
        rays = [[rough.mpf(random.gauss(0, 1)) for _ in range(n)] for _ in range(4 * directions)]
        start, level = [rough.mpf(c) for c in centre], _at(g_roughly, rest)
        reached = [(ray, reach(rough, level, start, ray, BITS)) for ray in rays]
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


def gauges_agree(law: Criterion, support: SupportFunction, gauge: sp.Expr, points: int = 24) -> bool:
    """Whether two gauges of K agree to 30 digits at random exact points, and agree with g on what lies inside."""
    random, forces = Random(1970), law.force_symbols()
    others = [s for s in law.symbols().values() if s not in forces]
    fine = mpmath_.digits(DIGITS)
    both = mpmath_.compiled([gauge, support.gauge, law.g], [*forces, *others], fine)
    small = fine.mpf(10) ** -SMALL
    for values in sample_values(law, support.requires, random, 4):
        for _ in range(points):
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


def _at(g: Callable[..., list[Any]], rest: Sequence[Any]) -> Callable[[list[Any]], Any]:
    return lambda x: g(*x, *rest)[0]
