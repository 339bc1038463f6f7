"""The formulas of implicit and extrapolated steps, written once: for columns of many rows, for numbers of one, and for a compiler.

On arrays they run as they stand: vectors are (d, n), matrices (d, d, 1).  For one row, where arrays take longer to call than to compute,
and for a compiler they are run once over names, and what they would compute is written down as lines: the same operations in the same
order, so every digit is the same.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterable
from functools import lru_cache
from types import MappingProxyType, SimpleNamespace
from typing import Any

import numpy as np

from duhem.expression.scalar_bounds import Name, statements
from duhem.projection.code_cache import interpreted_text

__all__ = ["FORMULAS", "balance", "booked", "doubled", "energy", "inner", "on_numbers", "pulled", "slipped", "summed", "times", "written"]

Vector = Any  # (d, n)
Numbers = Any  # (n,)
Answer = Any  # stress, slip and multiplier
Energies = Any  # four numbers: what is added to multiplier, dissipation, work and numerical loss


def inner(x: Vector, y: Vector) -> Numbers:
    """The inner product of each row with its other, added from the first entry on, however many rows there are."""
    products = x * y
    total = 0.0 + products[0]
    for product in products[1:]:
        total = total + product
    return total


def times(x: Vector, m: Any) -> Vector:
    """x m, each row by itself: no row's rounding depends on how many there are."""
    total = 0.0 + x[:1] * m[0]
    for i in range(1, len(m)):
        total = total + x[i : i + 1] * m[i]
    return total


def energy(x: Vector, m: Any) -> Numbers:
    """x . m x / 2."""
    return 0.5 * inner(x, times(x, m))


def pulled(stress: Vector, end: Vector, begin: Vector, k: Any) -> Vector:
    """The stress without slip on the way from one displacement to another."""
    return stress + times(end - begin, k)


def booked(
    before: Vector, trial: Vector, near: Vector, slip: Vector, multiplier: Numbers, slips: Any, end: Vector, begin: Vector, k: Any, c: Any
) -> tuple[Vector, Numbers, Energies]:
    """An implicit step from the stress ``before`` to the closest point ``near``, or the trial stress where nothing ``slips``.

    Stress and psi at its end, and what it adds to multiplier, dissipation sigma . du_in, work sigma . du and numerical loss
    du_e . k du_e / 2, in Pa m; where nothing slips the work is stored.
    """
    stress = np.where(slips, near, trial)
    lost, work, numerical = _energies(k, stress, slip, end - begin)
    stored = inner(0.5 * (before + stress), times(stress - before, c))
    added = multiplier, np.where(slips, lost, 0.0), np.where(slips, work, stored), np.where(slips, numerical, 0.0)
    return stress, energy(stress, c), added


def doubled(halves: Vector, once: Vector) -> Vector:
    """Two half steps and a whole one, extrapolated."""
    return 2.0 * halves - once


def summed(
    before: Vector, first: Answer, second: Answer, whole: Answer, back: Vector, start: Vector, middle: Vector, end: Vector, k: Any, c: Any
) -> tuple[Vector, Numbers, Energies]:
    """The slip of a step extrapolated to the stress ``back``, psi at its end, and what it adds.

    Multiplier, dissipation and work are extrapolated alike, but the first two never below zero: where the two estimates of a
    dissipation are so far apart that this would happen, that of the half steps stands.  The balance of energy holds to
    the order of the method.
    """
    du = end - start
    one = whole[2], *_energies(k, whole[0], whole[1], du)
    parts = [(found[2], *_energies(k, found[0], found[1], way)) for found, way in ((first, middle - start), (second, end - middle))]
    two = [a + b for a, b in zip(*parts, strict=True)]
    multiplier, lost, numerical = (np.where(2.0 * two[i] >= one[i], 2.0 * two[i] - one[i], two[i]) for i in (0, 1, 3))
    added = multiplier, lost, 2.0 * two[2] - one[2], numerical  # work has either sign
    return *slipped(before, back, start, end, c), added


def slipped(before: Vector, stress: Vector, start: Vector, end: Vector, c: Any) -> tuple[Vector, Numbers]:
    """The slip of a step, what is not elastic of its displacement, and psi at its end."""
    return end - start - times(stress - before, c), energy(stress, c)


def _energies(k: Any, stress: Vector, slip: Vector, du: Vector) -> tuple[Numbers, Numbers, Numbers]:
    return inner(stress, slip), inner(stress, du), energy(du - slip, k)


def balance(was: Numbers, psi: Numbers, added: Energies) -> Numbers:
    """What a step from psi ``was`` leaves of d work - d psi - d dissipation - d numerical."""
    return added[2] - (psi - was) - added[1] - added[3]


FORMULAS = MappingProxyType({each.__name__: each for each in (pulled, booked, doubled, summed, slipped, balance)})
"""The formulas that one row and compiled loops have as lines."""


@lru_cache(maxsize=16)
def on_numbers(d: int) -> SimpleNamespace:
    """Each of these formulas as :func:`written` makes it, by its name."""
    return SimpleNamespace(**{name: written(formula, d) for name, formula in FORMULAS.items()})


@lru_cache(maxsize=128)
def written(formula: Callable[..., Any], d: int) -> Callable[..., Any]:
    """A formula in d components as a function of plain numbers, vectors and matrices being tuples or lists of them.

    It is run over names, and what it does to them are its lines.
    """
    lines: dict[str, str] = {}
    asked = list(inspect.signature(formula).parameters)
    given = [_named(_SHAPES.get(name, "vector"), name, d, lines) for name in asked]
    found = formula(*given)
    head = [f"    {_listed(each)} = {name}" for name, each in zip(asked, given, strict=True)]
    text = [f"def {formula.__name__}({', '.join(asked)}):", *head, *statements(lines), f"    return {_listed(found)}"]
    return interpreted_text("\n".join(text), formula.__name__)


_SHAPES = {"k": "matrix", "c": "matrix", "added": "energies"}
_SHAPES |= dict.fromkeys(("first", "second", "whole"), "answer") | dict.fromkeys(("multiplier", "slips", "psi", "was", "opening"), "number")


def _named(shape: str, name: str, d: int, lines: dict[str, str]) -> Any:
    """Names for the numbers of an argument."""
    each = [f"{name}_{i}" for i in range(d)]
    match shape:
        case "number":
            return Name(lines, name, truth=name == "slips")
        case "vector":
            return _array(_named("number", one, 1, lines) for one in each)
        case "matrix":
            return np.stack([_named("vector", one, d, lines) for one in each])
        case "energies":
            return _named("vector", name, 4, lines)
    return *(_named("vector", f"{name}_{i}", d, lines) for i in range(2)), Name(lines, f"{name}_2")


def _array(names: Iterable[Name]) -> Any:
    """Names as an array; NumPy would ask one for its numbers."""
    given = list(names)
    found = np.empty(len(given), dtype=object)
    for i, name in enumerate(given):
        found[i] = name
    return found


def _listed(names: Any) -> str:
    return names.name if isinstance(names, Name) else f"({''.join(f'{_listed(name)}, ' for name in names)})"
