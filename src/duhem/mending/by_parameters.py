"""The nearest point of the exact region of one parameter in which the law is convex, the others as they are."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from fractions import Fraction
from math import ceil, floor

import sympy as sp

from duhem.errors import InputError
from duhem.law.domain import POSITIVE, Domain
from duhem.law.formula_law import Criterion
from duhem.mending.limit_load import plain_values
from duhem.proof.kernel.parameter_cells import ParameterCell
from duhem.regions import region, shape_parameters

__all__ = ["by_parameters"]

_STEPS = 12_000_000  # for the region of one parameter
_FINEST = 6  # decimals of a value that stands for an end which is open or no decimal


def by_parameters(law: Criterion, base: Criterion) -> Iterator[tuple[Criterion, str]]:
    """The law with one of its fixed parameters moved into its region; ``base`` is the law before parameters were fixed.

    The region is asked at plain numbers for the parameters that are free, which K is only proportional to.
    """
    plain = law.fix(plain_values(law))
    ranges = {n: _range(base.parameters[n], own.value) for n, own in law.parameters.items() if own.value is not None}
    for name in shape_parameters(law.within(ranges)):
        if (value := law.parameters[name].value) is None:
            continue
        with suppress(InputError):
            found = region(plain.within({name: ranges[name]}), name, steps=_STEPS)
            ends = [x for cell in found.stretches("proved") if (x := _nearest(cell, Fraction(value.p, value.q))) is not None]
            if ends:
                x = min(ends, key=lambda end: abs(end - Fraction(value.p, value.q)))
                told = f"{name} from {value} to {x}; {found.sentence}"
                yield law.within({name: Domain.fixed(sp.Rational(x.numerator, x.denominator))}), told


def _range(before: Domain, value: sp.Rational) -> Domain:
    """Where a parameter may lie: as the law says, or with the sign of the value that the law fixes."""
    if before.value is None:
        return before
    return POSITIVE if value > 0 else Domain.between(None, 0) if value < 0 else Domain()


def _nearest(cell: ParameterCell, value: Fraction) -> Fraction | None:
    """The decimal in a stretch that is nearest to a value; None where the stretch is shorter than the decimals are fine."""
    low, high, step = cell.low, cell.high, Fraction(1, 10**_FINEST)
    if high is not None and value >= high.low:
        if high.exact and not cell.open_high and _is_decimal(high.low):
            return high.low
        near = ceil(high.low / step - 1) * step
        return near if low is None or near > low.high else None
    if low is not None and value <= low.high:
        if low.exact and not cell.open and _is_decimal(low.low):
            return low.low
        near = floor(low.high / step + 1) * step
        return near if high is None or near < high.low else None
    return value


def _is_decimal(x: Fraction) -> bool:
    rest = x.denominator
    for prime in (2, 5):
        while rest % prime == 0:
            rest //= prime
    return rest == 1
