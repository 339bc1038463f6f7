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
from duhem.proof.kernel.parameter_cells import ParameterCell
from duhem.regions.entry import region, shape_parameters
from duhem.regions.mending.limit_load import plain_values
from duhem.regions.result import ParameterRegion

__all__ = ["by_parameters"]

_STEPS = 12_000_000  # for the regions of all parameters
_FINEST = Fraction(1, 10**6)  # values are decimals, which a criterion file can state


def by_parameters(law: Criterion, base: Criterion) -> Iterator[tuple[Criterion, str]]:
    """The law with one of its fixed parameters moved into its region; ``base`` is the law before parameters were fixed.

    A parameter that is fixed in ``base`` too may have all values of its sign.  Free ones, to which K is only proportional, are plain here.
    """
    fixed = {n: own.value for n, own in law.parameters.items() if own.value is not None}
    signs = {n: POSITIVE if x > 0 else Domain.between(None, 0) if x < 0 else Domain() for n, x in fixed.items()}
    ranges = {n: signs[n] if base.parameters[n].value is not None else base.parameters[n] for n in fixed}
    plain = law.fix(plain_values(law))
    names = [n for n in shape_parameters(law.within(ranges)) if n in fixed]
    for name in names:
        value = Fraction(fixed[name].p, fixed[name].q)
        with suppress(InputError):
            found = region(plain.within({name: ranges[name]}), name, steps=_STEPS // len(names))
            stretches = found.stretches("proved") if isinstance(found, ParameterRegion) else []  # it is of one
            near = [x for cell in stretches if (x := _nearest(cell, value)) is not None]
            if near:
                x = min(near, key=lambda x: abs(x - value))
                moved = law.within({name: Domain.fixed(sp.Rational(x.numerator, x.denominator))})
                yield moved, f"{name} from {value} to {x}; {found.sentence}"


def _nearest(cell: ParameterCell, value: Fraction) -> Fraction | None:
    """The decimal in a stretch that is nearest to a value; None where the stretch is shorter than the decimals are fine."""
    low = None if cell.low is None else ceil(cell.low.high / _FINEST) * _FINEST
    high = None if cell.high is None else floor(cell.high.low / _FINEST) * _FINEST
    if cell.low is not None and low is not None and cell.open and low == cell.low.high:
        low += _FINEST
    if cell.high is not None and high is not None and cell.open_high and high == cell.high.low:
        high -= _FINEST
    if low is not None and high is not None and low > high:
        return None
    value = value if low is None else max(value, low)
    return value if high is None else min(value, high)
