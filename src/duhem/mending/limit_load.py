"""The limit load of a law along directions of force, and by how much that of another law differs from it.

K is star-shaped about zero force as far as it is seen along rays: the limit load is the distance at which a ray leaves K first.  A change
is measured by the mean limit load of the law, so that directions in which it carries next to nothing do not outweigh all others.
"""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass
from math import prod

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from duhem.errors import InputError
from duhem.expression.rays import exits
from duhem.law.formula_law import Criterion
from duhem.proof.certificate import admitted_values

__all__ = ["Distance", "LoadScale", "distance", "limit_loads", "plain_values", "scale_of", "ways_of"]

Array = NDArray[np.float64]
Numbers = Mapping[str, sp.Rational]
_ANGLES = 2880
_DRAWN = 4000  # directions of more than two forces
_RADII = np.logspace(-5.0, 5.0, 201)
_ALIKE = 1e-7


@dataclass(frozen=True)
class Distance:
    """The mean and the largest change of the limit load over all directions of force, over the mean limit load."""

    mean: float
    largest: float


@dataclass(frozen=True)
class LoadScale:
    """What K is proportional to: a product of powers of the free parameters and of the pressure's size, as text."""

    powers: Mapping[str, sp.Rational]
    pressure: str | None
    whole: bool  # not so of a K that does not grow in proportion to a power of the pressure

    @property
    def text(self) -> str:
        """In the words of a criterion file: ``mu*abs(sigma_n)``; "1" where K is fixed."""
        named = {f"abs({name})" if name == self.pressure else name: p for name, p in self.powers.items() if p}
        return "*".join(name if p == 1 else f"{name}**({p})" for name, p in named.items()) or "1"

    def size(self, values: Numbers) -> float:
        """Its value, at the pressure -1."""
        return float(prod(float(values.get(name, 1)) ** float(p) for name, p in self.powers.items()))


def plain_values(law: Criterion) -> dict[str, sp.Rational]:
    """A number for each parameter: its own, and 1 for those that are free, or plain ones where these are not admitted.

    InputError where none are found.
    """
    ones = {name: sp.S.One for name, own in law.parameters.items() if own.value is None and sp.S.One in own}
    found = admitted_values(law.fix(ones)) or admitted_values(law)
    if found is None:
        raise InputError("duhem found no numbers for its parameters", where=law.name, remedy="give each of them with --set")
    return {name: sp.Rational(value) for name, value in found.items()}


def ways_of(law: Criterion) -> Array:
    """Directions of force (m, d), evenly around for two of them, beginning with that of the first force."""
    if len(law.forces) == 1:
        return np.array([[1.0], [-1.0]])
    if len(law.forces) == 2:
        angles = 2.0 * np.pi * np.arange(_ANGLES) / _ANGLES
        return np.column_stack([np.cos(angles), np.sin(angles)])
    drawn = np.random.default_rng(0).normal(size=(_DRAWN, len(law.forces)))
    return np.asarray(drawn / np.linalg.norm(drawn, axis=1, keepdims=True))


def limit_loads(law: Criterion, values: Numbers, ways: Array, load: float = 1.0) -> Array:
    """How far K reaches along each of the ``ways`` (m, d), infinite where no end is found; at the pressure -``load``.

    InputError where zero force lies outside K.
    """
    table = law.symbols()
    others = {table[name]: float(values[name]) for name in law.parameters} | ({table[law.pressure]: -load} if law.pressure else {})
    size = max([1.0, *(abs(x) for x in others.values())])
    inner, outer = exits(law.g, law.force_symbols(), ways, size * _RADII, others)
    if (inner <= 0.0).any():
        raise InputError("zero force lies outside K, or on its boundary", where=law.name, remedy="limit loads are counted from zero force")
    return np.where(inner == outer, np.inf, inner)


def distance(law: Criterion, other: Criterion) -> Distance:
    """By how much the limit load of another law with the same forces differs, each parameter at a plain value."""
    ways, values = ways_of(law), plain_values(law)
    own = limit_loads(law, values, ways)
    new = limit_loads(other, {n: values[n] if domain.value is None else domain.value for n, domain in other.parameters.items()}, ways)
    ended = np.isfinite(own)
    if not ended.any():
        return Distance(0.0, 0.0) if not np.isfinite(new).any() else Distance(np.inf, np.inf)
    with np.errstate(invalid="ignore"):
        change = np.where(~ended & ~np.isfinite(new), 0.0, np.abs(new - own)) / own[ended].mean()
    return Distance(float(change.mean()), float(change.max()))


def scale_of(law: Criterion) -> LoadScale:
    """What K is proportional to; InputError for a free parameter on which its shape depends."""
    ways, values = ways_of(law)[::37], plain_values(law)
    own, powers = limit_loads(law, values, ways), dict[str, sp.Rational]()
    free = [name for name, domain in law.parameters.items() if domain.value is None]
    for name in [*free, *([law.pressure] if law.pressure else [])]:
        rates = dict[int, Array]()
        with suppress(InputError), np.errstate(invalid="ignore"):
            for factor in (2, 3) if values.get(name, 1) else ():
                at = values if name == law.pressure else {**values, name: values[name] * factor}
                rate = limit_loads(law, at, ways, float(factor) if name == law.pressure else 1.0) / own
                rates[factor] = np.where(np.isnan(rate), 1.0, np.log(rate) / np.log(factor))  # 1 where there is no end both times
        power = sp.Rational(round(12 * float(rates[2].min())), 12) if 2 in rates and np.isfinite(rates[2].min()) else None
        if power is not None and len(rates) == 2 and all(np.allclose(rate, float(power), atol=_ALIKE) for rate in rates.values()):
            powers[name] = power
        elif name == law.pressure:
            return LoadScale(powers, name, False)
        else:
            what = f"the shape of K depends on {name}, which has no value"
            raise InputError(what, where=law.name, remedy=f"give it one: --set {name}=VALUE; duhem region tells for which K is convex")
    return LoadScale(powers, law.pressure, True)
