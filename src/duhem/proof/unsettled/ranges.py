"""Ranges of the forces around the boundary of K, or around a part of it: where less is claimed, enclosures may show it.

Where the boundary lies is found in floats.  Nothing of that is certain, and nothing needs to be: the kernel is asked about the ranges.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from decimal import Decimal
from fractions import Fraction
from itertools import islice

import numpy as np
from numpy.typing import NDArray

from duhem.expression.numpy_ import Program, compiled
from duhem.expression.rays import Rays
from duhem.law.domain import REAL, Domain
from duhem.law.formula_law import Criterion
from duhem.proof.facts.formula_subject import FormulaSubject
from duhem.proof.facts.subject import Values
from duhem.proof.kernel.boxes import MOST_FORCES

__all__ = ["Ranges", "around_the_boundary", "away_from_zero", "between", "others_at", "places_in_ranges"]

Ranges = dict[str, dict[str, str]]  # the ends of each force and of the pressure, as a criterion file has them
_CHOICES, _MANY, _PAIRS = 3, 4000, 600  # of parameters; places drawn; pairs of a place inside and one outside
_MOST = (0.02, 0.98)  # the quantiles between which most points of the boundary lie
_SAME_SIZE = 3.0  # points count that are at most so many times as large, or as small, as the middle one
_WIDER, _AWAY = 0.2, 0.1  # how far ranges go beyond these points, and how far they keep away from 0, as shares
_PATCHES = (0.5, 0.2)  # ranges around one point of the boundary, as shares of its forces
_RATIO, _SHARES = 3.0, (0.5, 0.2, 0.05)  # of forces where there is no boundary: one to the next, and ranges around them
_BESIDE = 0.1  # ranges of the pressure around that at which the boundary is found, as a share of it
_SIZES = ((-3, 3), (-9, 9))  # powers of ten between which the sizes of places are drawn; the second where the first find no boundary


def around_the_boundary(subject: FormulaSubject) -> Iterator[Ranges]:
    """Ranges that hold most of the boundary; that keep away from 0; on the side of a point; and around that, where no two are equal."""
    law = subject.law
    points = _boundary(subject) if len(law.forces) <= MOST_FORCES else np.zeros((0, 0))
    if not len(points):
        return
    sizes = np.linalg.norm(points, axis=1)
    middle = np.median(sizes)
    near = points[(sizes >= middle / _SAME_SIZE) & (sizes <= middle * _SAME_SIZE)]
    least, most = np.quantile(near, _MOST, axis=0)
    own = np.array([law.domain.get(name, REAL).ends for name in law.forces]).T
    wider, size = _WIDER * (most - least), _AWAY * np.maximum(np.abs(least), np.abs(most))
    ends = [np.clip((least - wider, most + wider), *own)]
    one_sided = np.array([(least >= -size) & (most > size), (most <= size) & (least < -size)])
    ends += [np.array([np.where(one_sided[0], np.maximum(least, size), least), np.where(one_sided[1], np.minimum(most, -size), most)])]
    apart = np.abs(near[:, :, None] - near[:, None]) + np.abs(near)[:, :, None] * np.eye(near.shape[1])  # of principal stresses, too
    centre = near[np.argmax(apart.min(axis=(1, 2)) / np.linalg.norm(near, axis=1))]
    low, high = np.maximum(least, np.minimum(size, centre / 2)), np.minimum(most, np.maximum(-size, centre / 2))
    ends += [np.array([np.where(centre > 0, low, least), np.where(centre < 0, high, most)])]
    ends += [np.clip((centre - share * np.abs(centre), centre + share * np.abs(centre)), *own) for share in _PATCHES]
    yield from _of_forces_and_pressure(law, ends, others_at(subject, next(iter(subject.choices(1))))[0] if law.pressure else 0.0)


def away_from_zero(law: Criterion) -> Iterator[Ranges]:
    """Ranges of plain size that keep away from 0 and from each other, for a law without a boundary, the widest first."""
    middles = np.array([_RATIO**i for i in range(len(law.forces))])
    if len(law.forces) <= MOST_FORCES:
        yield from _of_forces_and_pressure(law, [(middles * (1 - share), middles * (1 + share)) for share in _SHARES], -1.0)


def _of_forces_and_pressure(
    law: Criterion, ends: Iterable[tuple[NDArray[np.float64], NDArray[np.float64]]], pressure: float
) -> Iterator[Ranges]:
    for low, high in ends:
        sides = {name: (a, b) for name, a, b in zip(law.forces, low, high, strict=True)}
        sides |= {law.pressure: (pressure * (1 + _BESIDE), pressure * (1 - _BESIDE))} if law.pressure else {}
        found = {name: _entry(law.domain.get(name, REAL), *side) for name, side in sides.items()}
        if all(Fraction(side["min"]) < Fraction(side["max"]) for side in found.values()):
            yield found


def _entry(own: Domain, low: float, high: float) -> dict[str, str]:
    """Both ends in few digits, or those of the range that a law has of its own, where that ends before."""
    least, most = _plain(low), _plain(high)
    return {
        "min": least if own.low is None or own.low <= Fraction(least) else str(own.low),
        "max": most if own.high is None or own.high >= Fraction(most) else str(own.high),
    }


def _plain(x: float) -> str:
    return f"{Decimal(f'{x:.2g}'):f}"


def between(narrow: Mapping[str, str], wide: Mapping[str, str]) -> list[dict[str, str]]:
    """What holds two ranges, then the narrow one with one end of that, then with both halfway; none where that is the narrow one."""
    ends = {end: least([own[end] for own in (wide, narrow)], key=Fraction) for end, least in (("min", min), ("max", max))}
    half = {end: _plain(float(Fraction(ends[end]) + Fraction(narrow[end])) / 2) for end in ends}
    half = {end: sorted((ends[end], x, narrow[end]), key=Fraction)[1] for end, x in half.items()}
    ways = ends, {**narrow, "max": ends["max"]}, {**narrow, "min": ends["min"]}, half
    return [way for way in ways if way != narrow]


@np.errstate(all="ignore")  # where a formula has no value it is nan, or infinite
def _boundary(subject: FormulaSubject) -> NDArray[np.float64]:
    """Points of the boundary, of all sizes, between places inside and outside."""
    law, rng = subject.law, np.random.default_rng(3)
    run, chosen = compiled(law.g, law.symbols().values()), [*islice(subject.choices(_CHOICES), _CHOICES)]
    for sizes in _SIZES:
        drawn = places_in_ranges(law, sizes)
        drawn = drawn[np.argsort(np.linalg.norm(drawn, axis=1))]
        found = [_between(run, drawn, others_at(subject, parameters), rng) for parameters in chosen]
        if any(map(len, found)):
            return np.concatenate(found)
    return drawn[:0]


@np.errstate(invalid="ignore")  # of ranges without an end
def places_in_ranges(law: Criterion, sizes: tuple[int, int] = _SIZES[0]) -> NDArray[np.float64]:
    """Drawn places of many sizes, some of whose forces are 0, and zero force, as far as the ranges of the forces allow that."""
    rng, (low, high) = np.random.default_rng(11), np.array([law.domain.get(name, REAL).ends for name in law.forces]).T
    drawn = rng.standard_normal((_MANY, len(low))) * 10.0 ** rng.uniform(*sizes, (_MANY, 1))
    drawn = np.concatenate([drawn, drawn * rng.integers(0, 2, drawn.shape), 0 * drawn[:1]])
    both, below, above = np.isfinite(low) & np.isfinite(high), np.isfinite(low), np.isfinite(high)
    inside = low + rng.random(drawn.shape) * (high - low)
    within = np.where(both, inside, np.where(below, low + np.abs(drawn), np.where(above, high - np.abs(drawn), drawn)))
    return np.where(drawn == 0, np.clip(0.0, low, high), within)


def _between(run: Program, places: NDArray[np.float64], others: list[float], rng: np.random.Generator) -> NDArray[np.float64]:
    """Where the boundary is crossed on the way from places inside to those outside, of about the same size."""

    def value(x: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.broadcast_to(run(*np.moveaxis(x, -1, 0), *others), x.shape[:-1])

    here = value(places)
    inside, outside = places[here <= 0], places[here > 0]
    if not (len(inside) and len(outside)):
        return places[:0]
    share = rng.random(_PAIRS)
    one, two = (side[(share * len(side)).astype(int)] for side in (inside, outside))
    ways = Rays(value, one, two - one)
    end = ways.at(ways.narrowed(np.zeros(_PAIRS), np.ones(_PAIRS))[1])
    return end[np.isfinite(value(end))]


def others_at(subject: FormulaSubject, parameters: Values) -> list[float]:
    """The pressure and the parameters, in the order of the law."""
    known = subject.named(subject.values_at(parameters, subject.nowhere))
    return [float(known[name]) for name in [*subject.law.symbols()][len(subject.law.forces) :]]
