"""The limit load of a law along directions of force, and by how much that of another law differs from it.

The limit load is how far K reaches along a ray from zero force.  A change is measured by the mean limit load of the law, so that directions
in which it carries next to nothing do not outweigh all others.
"""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import suppress
from math import prod
from typing import NamedTuple

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from duhem.errors import InputError
from duhem.expression.rays import exits
from duhem.law.formula_law import Criterion
from duhem.proof.certificate import admitted_values

__all__ = ["NO_DISTANCE", "Distance", "LoadScale", "distance", "limit_loads", "plain_values", "scale_of", "ways_of"]

Array = NDArray[np.float64]
Numbers = Mapping[str, sp.Rational]
_ANGLES, _DRAWN = 2880, 4000  # directions of two forces, and of more
_RADII = np.logspace(-5.0, 5.0, 201)
_ALIKE = 1e-7


class Distance(NamedTuple):
    """The mean and the largest change of the limit load over all directions of force, over the mean limit load."""

    mean: float = 0.0
    largest: float = 0.0

    def plain(self) -> dict[str, float | None]:
        """As JSON has it, None for what is infinite."""
        return {name: x if np.isfinite(x) else None for name, x in self._asdict().items()}


NO_DISTANCE = Distance()


class LoadScale(NamedTuple):
    """What K is proportional to: a product of ``powers`` of the free parameters and of the size of the ``pressure``."""

    powers: Mapping[str, sp.Rational]
    pressure: str | None

    @property
    def text(self) -> str:
        """In the words of a criterion file: ``mu*abs(sigma_n)``; "1" where K is fixed."""
        named = {f"abs({name})" if name == self.pressure else name: p for name, p in self.powers.items() if p}
        return "*".join(name if p == 1 else f"{name}**({p})" for name, p in named.items()) or "1"

    def size(self, values: Numbers) -> float:
        """Its value, at the pressure -1."""
        return float(prod(float(values.get(name, 1)) ** float(p) for name, p in self.powers.items()))


def plain_values(law: Criterion) -> dict[str, sp.Rational]:
    """A number for each parameter: its own, and 1 for those that are free, or plain ones where that is not admitted."""
    ones = {name: sp.S.One for name, own in law.parameters.items() if own.value is None and sp.S.One in own}
    if (found := admitted_values(law.fix(ones)) or admitted_values(law)) is None:
        raise InputError("duhem found no numbers for its parameters", where=law.name, remedy="give each of them with --set")
    return {name: sp.Rational(value) for name, value in found.items()}


def ways_of(law: Criterion) -> Array:
    """Directions of force (m, d), of two forces evenly around from that of the first one."""
    if len(law.forces) == 2:
        angles = 2.0 * np.pi * np.arange(_ANGLES) / _ANGLES
        return np.column_stack([np.cos(angles), np.sin(angles)])
    drawn = np.random.default_rng(0).normal(size=(_DRAWN, len(law.forces)))
    return np.asarray(drawn / np.linalg.norm(drawn, axis=1, keepdims=True))


def limit_loads(law: Criterion, values: Numbers, ways: Array, load: float = 1.0) -> Array:
    """How far K reaches along each of the ``ways`` (m, d) at the pressure -``load``; infinite where no end is found."""
    table = law.symbols()
    others = {table[name]: float(values[name]) for name in law.parameters} | ({table[law.pressure]: -load} if law.pressure else {})
    radii = max([1.0, *map(abs, others.values())]) * _RADII
    inner, outer = exits(law.g, law.force_symbols(), ways, radii, others)
    if (inner <= 0.0).any():
        raise InputError("zero force lies outside K, or on its boundary", where=law.name, remedy="limit loads are counted from zero force")
    return np.where(inner == outer, np.inf, inner)


def distance(law: Criterion, other: Criterion) -> Distance:
    """By how much the limit load of another law with the same forces differs, the free parameters at plain values."""
    ways, values = ways_of(law), plain_values(law)
    if not np.isfinite(own := limit_loads(law, values, ways)).any():
        raise InputError("K has no end in any direction", where=law.name, remedy="there is no limit load that could change")
    new = limit_loads(other, {n: values[n] if domain.value is None else domain.value for n, domain in other.parameters.items()}, ways)
    with np.errstate(invalid="ignore"):
        change = np.where(own == new, 0.0, np.abs(new - own)) / own[np.isfinite(own)].mean()
    return Distance(float(change.mean()), float(change.max()))


def scale_of(law: Criterion) -> LoadScale:
    """What K is proportional to, the pressure left out where that is none; InputError for a free parameter on which its shape depends."""
    ways, values = ways_of(law)[::37], plain_values(law)
    own, powers = limit_loads(law, values, ways), dict[str, sp.Rational]()
    for name in [*(n for n, domain in law.parameters.items() if domain.value is None), *([law.pressure] if law.pressure else [])]:
        pressed, ended = name == law.pressure, np.isfinite(own)
        with suppress(InputError):
            twice = limit_loads(law, values if pressed else {**values, name: 2 * values[name]}, ways, 1.0 + pressed)
            rates = np.log2(twice[ended] / own[ended])
            power = sp.Rational(round(12 * float(rates.mean())), 12)
            if (pressed or values[name]) and np.allclose(rates, float(power), atol=_ALIKE):
                powers[name] = power
                continue
        if not pressed:
            what, remedy = f"the shape of K depends on {name}, which has no value", f"give it one: --set {name}=VALUE (see duhem region)"
            raise InputError(what, where=law.name, remedy=remedy)
    return LoadScale(powers, law.pressure)
