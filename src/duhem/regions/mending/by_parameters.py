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
from duhem.regions.entry import region, shape_parameters
from duhem.regions.mending.limit_load import ScaledLaw
from duhem.regions.places import ParameterCell
from duhem.regions.result import ParameterRegion

__all__ = ["by_parameters", "within_region"]

_STEPS = 12_000_000  # for the regions of all parameters
_FINEST = Fraction(1, 10**6)  # values are decimals, which a criterion file can state


def by_parameters(scaled: ScaledLaw, base: Criterion) -> Iterator[tuple[Criterion, str]]:
    """The law with one of its fixed parameters moved into its region; ``base`` is the law before parameters were fixed.

    A parameter that is fixed in ``base`` too may have all values of its sign.  Free ones, to which K is only proportional, are plain here.
    """
    law = scaled.law
    fixed = {n: own.value for n, own in law.parameters.items() if own.value is not None}
    signs = {n: POSITIVE if x > 0 else Domain.between(None, 0) if x < 0 else Domain() for n, x in fixed.items()}
    ranges = {n: signs[n] if base.parameters[n].value is not None else base.parameters[n] for n in fixed}
    plain = law.fix(scaled.values)
    names = [n for n in shape_parameters(law.within(ranges)) if n in fixed]
    if not names:
        raise InputError("it has no fixed parameter on which the shape of K depends", where=law.name, remedy="mend it in another way")
    moved: Criterion | None = None
    for name in names:
        value = Fraction(fixed[name].p, fixed[name].q)
        with suppress(InputError):
            found = region(plain.within({name: ranges[name]}), name, steps=_STEPS // len(names))
            if near := [x for cell in found.stretches("proved") for x in _decimals(cell, value)]:
                x = min(near, key=lambda x: abs(x - value))
                moved = law.within({name: Domain.fixed(sp.Rational(x.numerator, x.denominator))})
                among = f"where {found.over}, " if base.parameters[name].value is not None and found.over != "true" else ""
                yield moved, f"{name} from {value} to {x}; {among}{found.sentence}"
    if moved is None:
        raise InputError(f"convexity is proved for no other value of {', '.join(names)}", where=law.name, remedy="mend it in another way")


def within_region(law: Criterion) -> Criterion:
    """A law over the widest stretch of its one shape parameter on which K is proved to be convex, all of its domain if K is so there.

    Raises InputError where no such stretch is found.
    """
    found = region(law)
    if found.short == "true":
        return law
    stretches = [_ends(cell) for cell in found.stretches("proved")] if isinstance(found, ParameterRegion) else []
    wide = [(low, high) for low, high in stretches if low is None or high is None or low < high]
    if not wide:
        what = "no range of one shape parameter was found in which K is convex"
        raise InputError(what, where=law.name, remedy=f"see duhem region {law.name}, and fix others with --set")
    low, high = max(wide, key=lambda ends: float("inf") if ends[0] is None or ends[1] is None else float(ends[1] - ends[0]))
    return law.within({found.parameters[0]: Domain.between(*(None if end is None else str(end) for end in (low, high)))})


def _ends(cell: ParameterCell) -> tuple[Fraction | None, Fraction | None]:
    """The first and the last decimal of a stretch, None where it has no end."""
    low, high, fine = cell.low, cell.high, _FINEST
    least = None if low is None else fine * (floor(low.high / fine) + 1 if cell.open else ceil(low.high / fine))
    most = None if high is None else fine * (ceil(high.low / fine) - 1 if cell.open_high else floor(high.low / fine))
    return least, most


def _decimals(cell: ParameterCell, value: Fraction) -> list[Fraction]:
    """The value and the decimals next to both ends of a stretch, of these what lies in it."""
    least, most = _ends(cell)
    ends = [x for x in (least, most, value) if x is not None]
    return [x for x in ends if (least is None or least <= x) and (most is None or x <= most)]
