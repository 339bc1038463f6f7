"""The limit load of a law along directions of force, and by how much that of another law differs from it.

The limit load is how far g <= 0 reaches along a ray from zero force.  A change is that of its part in the ranges of the forces,
measured by the mean limit load of the law, so that directions in which it carries next to nothing do not outweigh all others.
"""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass
from math import prod
from typing import NamedTuple

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from duhem.errors import InputError
from duhem.expression.rays import exits
from duhem.law.domain import REAL
from duhem.law.formula_law import Criterion
from duhem.proof.facts.formula_subject import admitted_values

__all__ = ["Distance", "ScaledLaw", "around", "distance", "limit_loads", "plain_values", "scale_of", "ways_of"]

Array = NDArray[np.float64]
Numbers = Mapping[str, sp.Rational]
_ANGLES, _DRAWN = 2880, 4000  # directions of two forces, and of more
_RADII = np.logspace(-10.0, 10.0, 401)
_ALIKE = 1e-7


class Distance(NamedTuple):
    """The mean and the largest change of the limit load over all directions of force, over the mean limit load."""

    mean: float = 0.0
    largest: float = 0.0


@dataclass(frozen=True, eq=False)
class ScaledLaw:
    """A law whose K is a scale times a fixed set: a product of ``powers`` of its free parameters and of the size of the pressure.

    ``values`` are plain numbers for its parameters, at which and at the pressure -1 the scale is ``size``.  ``loads`` (m,) are the limit
    loads of the fixed set along ``ways`` (m, d).
    """

    law: Criterion
    values: Numbers
    powers: Mapping[str, sp.Rational]
    size: float
    ways: Array
    loads: Array

    @property
    def text(self) -> str:
        """The scale in the words of a criterion file: ``mu*abs(sigma_n)``; "1" where K is fixed."""
        named = {f"abs({name})" if name == self.law.pressure else name: p for name, p in self.powers.items() if p}
        return "*".join(name if p == 1 else f"{name}**({p})" for name, p in named.items()) or "1"


def plain_values(law: Criterion) -> dict[str, sp.Rational]:
    """A number for each parameter: its own, and 1 for those that are free, or plain ones where that is not admitted."""
    ones = {name: sp.S.One for name, own in law.parameters.items() if own.value is None and sp.S.One in own}
    if (found := admitted_values(law.fix(ones)) or admitted_values(law)) is None:
        raise InputError("duhem found no numbers for its parameters", where=law.name, remedy="give each of them with --set")
    return {name: sp.Rational(value) for name, value in found.items()}


def around(angles: Array) -> Array:
    """The directions (m, 2) of two forces at angles (m,) from that of the first one."""
    return np.column_stack([np.cos(angles), np.sin(angles)])


def ways_of(law: Criterion) -> Array:
    """Directions of force (m, d), of two forces evenly around from that of the first one."""
    if len(law.forces) == 2:
        return around(2.0 * np.pi * np.arange(_ANGLES) / _ANGLES)
    drawn = np.random.default_rng(0).normal(size=(_DRAWN, len(law.forces)))
    return np.asarray(drawn / np.linalg.norm(drawn, axis=1, keepdims=True))


def limit_loads(law: Criterion, values: Numbers, ways: Array, load: float = 1.0) -> Array:
    """How far g <= 0 reaches along each of the ``ways`` (m, d) at the pressure -``load``; infinite where no end is found.

    Ranges of the forces are left out.  ``values`` are of the free parameters, and may be of others.
    """
    table = law.symbols()
    others = {table[n]: float(values[n] if own.value is None else own.value) for n, own in law.parameters.items()}
    others |= {table[law.pressure]: -load} if law.pressure else {}
    radii = max([1.0, *map(abs, others.values())]) * _RADII
    inner, outer = exits(law.g, law.force_symbols(), ways, radii, others)
    if (ends := inner <= 0.0).all():
        raise InputError("zero force lies outside K, or on its boundary", where=law.name, remedy="limit loads are counted from zero force")
    if ends.any():
        what = f"K ends at zero force in {ends.mean():.0%} of the directions: there g is positive or has no value"
        raise InputError(what, where=law.name, remedy="choose parameters for which zero force lies inside K")
    return np.where(inner == outer, np.inf, inner)


def distance(scaled: ScaledLaw, other: Criterion) -> Distance:
    """By how much the limit load of another law with the same forces differs, the free parameters at plain values.

    It is compared as far as the forces lie in their ranges.
    """
    most = _in_ranges(scaled.law, scaled.ways) / scaled.size
    own, new = np.minimum(scaled.loads, most), np.minimum(limit_loads(other, scaled.values, scaled.ways) / scaled.size, most)
    with np.errstate(invalid="ignore"):
        change = np.where(own == new, 0.0, np.abs(new - own)) / own[np.isfinite(own)].mean()
    return Distance(float(change.mean()), float(change.max()))


def _in_ranges(law: Criterion, ways: Array) -> Array:
    """How far the forces stay in their ranges (m,), which contain 0; infinitely far where there are none."""
    found = np.full(len(ways), np.inf)
    for name, way in zip(law.forces, ways.T, strict=True):
        low, high = law.domain.get(name, REAL).ends
        found = np.minimum(found, np.divide(np.where(way > 0.0, high, low), way, out=found.copy(), where=way != 0.0))
    return found


def scale_of(law: Criterion) -> ScaledLaw:
    """What K is proportional to, the pressure left out where that is none; InputError for free parameters on which its shape depends."""
    ways, values, powers = ways_of(law), plain_values(law), dict[str, sp.Rational]()
    loads = limit_loads(law, values, ways)
    if not (ended := np.isfinite(loads)).any():
        raise InputError("K has no end in any direction", where=law.name, remedy="there is no limit load that could change")
    some, free = np.flatnonzero(ended)[::37], [name for name, own in law.parameters.items() if own.value is None]
    for name in [*free, *([law.pressure] if law.pressure else [])]:
        other, load = (values, 2.0) if name == law.pressure else ({**values, name: 2 * values[name]}, 1.0)
        with suppress(ValueError, OverflowError):  # zero force lies outside, or there is no end
            rates = np.log2(limit_loads(law, other, ways[some], load) / loads[some])
            power = sp.Rational(round(12 * float(rates.mean())), 12)
            if np.allclose(rates, float(power), atol=_ALIKE) and values.get(name) != 0:
                powers[name] = power
    if shapes := [name for name in free if name not in powers]:
        given = " ".join(f"--set {name}=VALUE" for name in shapes)
        what = f"the shape of K depends on {', '.join(shapes)}, without a value"
        raise InputError(what, where=law.name, remedy=f"give one: {given} (see duhem region)")
    size = prod(float(values.get(name, 1)) ** float(p) for name, p in powers.items())
    return ScaledLaw(law, values, powers, size, ways, loads / size)
