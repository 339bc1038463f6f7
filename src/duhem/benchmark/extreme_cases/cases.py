"""The extreme cases: one axis of difficulty each, from harmless to the edge of what doubles hold."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from fractions import Fraction

import numpy as np

from duhem.benchmark.contenders import Specimen
from duhem.errors import InputError
from duhem.expression.number import fraction
from duhem.law.domain import Domain
from duhem.projection.result import Array

__all__ = ["AXES", "ExtremeCase", "aspect", "cases", "labels"]

AXES = {
    "load": "|sigma_n| (or the trial stress, for a law without pressure), by powers of ten",
    "stiffness ratio": "largest over smallest stiffness, by powers of ten",
    "aspect of K": "one axis of K shortened by its parameters, by powers of ten",
    "trial size": "trial stress over the reach of K, by powers of ten",
    "seam distance": "component across a coordinate axis over the reach of K, by powers of ten",
    "boundary distance": "how far outside K the trial stress lies, relative, by powers of ten",
    "special values": "zeros, denormals, vanishing pressure",
}
LOADS = (-290, -250, -200, -150, -100, -60, -30, -15, -8, -4, 0, 4, 8, 15, 30, 60, 100, 150, 200, 250, 290)
_RATIOS = range(0, 13, 2)
_ASPECTS = range(0, 9)
_SIZES = range(0, 17, 2)
_OFF = {**{f"1e{-j}": (-j, 10.0**-j) for j in range(0, 21, 2)}, "1e-300": (-300, 1e-300), "0": (-330, 0.0)}
_OUTSIDE = range(0, 16)
_ULP, _NONE = "1 ulp", "0 by doubles"
_TINY = 5e-324


@dataclass(frozen=True)
class ExtremeCase:
    """Trial stresses (M, d) under one pressure, at one place of one axis."""

    axis: str
    label: str
    decade: float
    specimen: Specimen
    trial: Array
    pressure: float | None


def cases(specimen: Specimen, axes: tuple[str, ...] = tuple(AXES)) -> Iterator[ExtremeCase]:
    """Every case of ``axes``, the harmless end first; axes that the law does not have yield nothing."""
    makers = {
        "load": _loads,
        "stiffness ratio": _stiffnesses,
        "aspect of K": _aspects,
        "trial size": _sizes,
        "seam distance": _seams,
        "boundary distance": _distances,
        "special values": _specials,
    }
    for axis in axes:
        yield from makers[axis](specimen, axis)


def labels(axis: str) -> tuple[str, ...]:
    """The labels of every case of an axis, in their order; a law may not have all of them."""
    powers = {"load": LOADS, "stiffness ratio": _RATIOS, "aspect of K": _ASPECTS, "trial size": _SIZES}
    if axis in powers:
        return tuple(f"1e{e}" for e in powers[axis])
    if axis == "boundary distance":
        return (*(f"1e{-j}" for j in _OUTSIDE), _ULP, _NONE)
    return tuple(_OFF) if axis == "seam distance" else tuple(label for label, _, _ in _special(2, -1.0))


def _ways(d: int) -> Array:
    """Two unlike directions, away from the axes."""
    first = 0.6 + 0.5 * np.arange(d) / max(d, 1)
    second = -0.9 + 1.3 * np.arange(d) / max(d - 1, 1)
    return np.array([first * np.where(np.arange(d) % 2, -1.0, 1.0), second])


def _reached(specimen: Specimen, ways: Array, pressure: float | None) -> Array:
    """The last points of K along the directions, those in which it ends (M, d)."""
    reach = [specimen.radius(way, pressure) for way in ways]
    return np.array([r * way for r, way in zip(reach, ways, strict=True) if 0.0 < r < 1e305]).reshape(-1, ways.shape[1])


def _loads(specimen: Specimen, axis: str) -> Iterator[ExtremeCase]:
    d = len(specimen.law.forces)
    for e in LOADS:
        if specimen.pressure is None:
            trial = 10.0**e * _ways(d)
            yield ExtremeCase(axis, f"1e{e}", e, specimen, trial, None)
        else:
            pressure = -(10.0**e)
            edge = _reached(specimen, _ways(d), pressure)
            if len(edge):
                yield ExtremeCase(axis, f"1e{e}", e, specimen, 3.0 * edge, pressure)


def _stiffnesses(specimen: Specimen, axis: str) -> Iterator[ExtremeCase]:
    d = len(specimen.law.forces)
    if d < 2:
        return
    edge = _reached(specimen, _ways(d), specimen.pressure)
    for e in _RATIOS:
        k = np.diag(10.0 ** (e * np.arange(d) / (d - 1)))
        yield ExtremeCase(axis, f"1e{e}", e, replace(specimen, stiffness=k), 3.0 * edge, specimen.pressure)


def aspect(specimen: Specimen) -> tuple[str, ...]:
    """The parameters that scale the reach of K along the last axis alone, found by trying."""
    d, axes = len(specimen.law.forces), np.eye(len(specimen.law.forces))
    if d < 2:
        return ()
    before = np.array([[specimen.radius(s * a, specimen.pressure) for s in (1.0, -1.0)] for a in axes])
    if not (np.isfinite(before).all() and (before > 0.0).all()):
        return ()
    found = []
    for name in specimen.law.parameters:
        other = _scaled(specimen, (name,), Fraction(1, 2))
        try:
            after = np.array([[other.radius(s * a, specimen.pressure) for s in (1.0, -1.0)] for a in axes])
        except InputError:  # half of it breaks a constraint of the law
            continue
        share = after / before
        if (
            np.allclose(share[:-1], 1.0, rtol=1e-9)
            and (np.isclose(share[-1], 0.5) | np.isclose(share[-1], 1.0)).all()
            and (share[-1] < 0.9).any()
        ):
            found.append(name)
    return tuple(found)


def _scaled(specimen: Specimen, names: tuple[str, ...], factor: Fraction) -> Specimen:
    """The law with some parameters times ``factor``, at doubles taken exactly."""

    def moved(name: str, domain: Domain) -> Domain:
        value = domain.value
        assert value is not None
        return Domain.fixed(Fraction(float(fraction(value) * factor))) if name in names else domain

    law = replace(specimen.law, parameters={name: moved(name, domain) for name, domain in specimen.law.parameters.items()})
    return Specimen(law, law, specimen.stiffness)


def _aspects(specimen: Specimen, axis: str) -> Iterator[ExtremeCase]:
    names = aspect(specimen)
    if not names:
        return
    for e in _ASPECTS:
        thin = _scaled(specimen, names, Fraction(1, 10**e))
        edge = _reached(specimen, np.eye(len(specimen.law.forces)), specimen.pressure)
        size = np.abs(edge).max(axis=0)
        yield ExtremeCase(axis, f"1e{e}", e, thin, _ways(len(size)) * size * 3.0, specimen.pressure)


def _sizes(specimen: Specimen, axis: str) -> Iterator[ExtremeCase]:
    edge = _reached(specimen, _ways(len(specimen.law.forces)), specimen.pressure)
    for e in _SIZES:
        yield ExtremeCase(axis, f"1e{e}", e, specimen, 1.5 * 10.0**e * edge, specimen.pressure)


def _seams(specimen: Specimen, axis: str) -> Iterator[ExtremeCase]:
    d = len(specimen.law.forces)
    if d < 2:
        return
    edge = _reached(specimen, np.eye(d)[:1], specimen.pressure)
    if not len(edge):
        return
    size = float(edge[0, 0])
    for label, (e, share) in _OFF.items():
        trial = np.zeros((2, d))
        trial[:, 0], trial[:, 1] = 2.0 * size, (size * share, -size * share)
        yield ExtremeCase(axis, label, e, specimen, trial, specimen.pressure)


def _distances(specimen: Specimen, axis: str) -> Iterator[ExtremeCase]:
    edge = _reached(specimen, _ways(len(specimen.law.forces)), specimen.pressure)
    for j in _OUTSIDE:
        yield ExtremeCase(axis, f"1e{-j}", -j, specimen, edge * (1.0 + 10.0**-j), specimen.pressure)
    out = np.where(edge == 0.0, 0.0, np.nextafter(edge, np.copysign(np.inf, edge)))
    yield ExtremeCase(axis, _ULP, -16, specimen, out, specimen.pressure)
    yield ExtremeCase(axis, _NONE, -17, specimen, edge, specimen.pressure)


def _specials(specimen: Specimen, axis: str) -> Iterator[ExtremeCase]:
    for i, (label, trial, pressure) in enumerate(_special(len(specimen.law.forces), specimen.pressure)):
        yield ExtremeCase(axis, label, float(i), specimen, trial, pressure)


def _special(d: int, plain_pressure: float | None) -> list[tuple[str, Array, float | None]]:
    """Label, trial stresses and pressure of each, in ``d`` forces."""
    signs = np.where(np.arange(d) % 2, -1.0, 1.0)
    denormal = np.array([_TINY * signs, -_TINY * signs, 1e-310 * signs])
    zeros = np.array([np.zeros(d), -np.zeros(d), np.copysign(0.0, signs)])
    plain = _ways(d)
    named: list[tuple[str, Array, float | None]] = [
        ("trial +-0", zeros, plain_pressure),
        ("trial denormal", denormal, plain_pressure),
    ]
    if plain_pressure is not None:
        named += [
            ("sigma_n = 0", plain, 0.0),
            ("sigma_n = -0", plain, -0.0),
            ("both 0", zeros, 0.0),
            ("sigma_n = -5e-324", plain, -_TINY),
            ("sigma_n = -1e-300", plain, -1e-300),
            ("all denormal", denormal, -1e-310),
            ("trial 1e300", 1e300 * plain, -1.0),
        ]
    return named
