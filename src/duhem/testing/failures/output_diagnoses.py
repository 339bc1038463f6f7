"""What may be wrong with slip, multiplier and tangent where they are returned beside the stress: one suggestion each."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from duhem.projection.result import Array
from duhem.testing.failures.diagnosis import Probe, constant, suggests

__all__: list[str] = []


def _unlike_one(factor: float) -> str:
    """With six digits, or as many as tell it from 1."""
    return next((said for n in range(6, 17) if float(said := f"{factor:.{n}g}") != 1.0), "1")


def _slip(p: Probe) -> Array:
    return _compliant(p, p.trial - p.returned)


def _compliant(p: Probe, stress: Array) -> Array:
    """k^-1 stress."""
    return np.asarray(np.linalg.solve(p.stiffness, stress.T).T)


@suggests("slip")
def opposite_slip(p: Probe) -> Iterator[tuple[str, Array]]:
    yield "the slip has the opposite sign", -_slip(p)


@suggests("slip")
def no_slip(p: Probe) -> Iterator[tuple[str, Array]]:
    yield "the slip returned is always zero", np.zeros_like(p.trial)


@suggests("slip")
def slip_as_a_stress(p: Probe) -> Iterator[tuple[str, Array]]:
    yield "the slip returned is a stress: it is not divided by the stiffness", p.trial - p.returned


@suggests("slip")
def slip_times_the_stiffness(p: Probe) -> Iterator[tuple[str, Array]]:
    said = "the slip is the stiffness times what the stress lacks: a stiffness is taken for a compliance"
    yield said, (p.trial - p.returned) @ p.stiffness


@suggests("slip")
def slip_of_the_closest_point(p: Probe) -> Iterator[tuple[str, Array]]:
    yield "the slip is that of the closest point, and the stress is another one", _compliant(p, p.trial - p.closest)


@suggests("slip")
def slip_of_the_diagonal(p: Probe) -> Iterator[tuple[str, Array]]:
    yield "the slip is taken with the diagonal of the stiffness alone", (p.trial - p.returned) / np.diag(p.stiffness)


@suggests("slip")
def slip_as_a_displacement(p: Probe) -> Iterator[tuple[str, Array]]:
    yield "the elastic displacement is returned as slip", _compliant(p, p.returned)
    yield "the whole displacement is returned as slip", _compliant(p, p.trial)


@suggests("slip")
def multiple_of_the_slip(p: Probe) -> Iterator[tuple[str, Array]]:
    right, given = _slip(p), np.asarray(p.reply.slip)
    if (factor := constant(np.einsum("ij,ij->i", given, right) / np.einsum("ij,ij->i", right, right))) is not None:
        yield f"the slip is {_unlike_one(factor)} times what the stress lacks", factor * right


def _multiplier(p: Probe) -> Array:
    return p.query.length(p.trial - p.returned) / p.query.dual_length(p.gradient)


@suggests("multiplier")
def opposite_multiplier(p: Probe) -> Iterator[tuple[str, Array]]:
    yield "the multiplier has the opposite sign", -_multiplier(p)


@suggests("multiplier")
def multiplier_with_a_shift(p: Probe) -> Iterator[tuple[str, Array]]:
    if (shift := constant(np.asarray(p.reply.multiplier) - _multiplier(p))) is not None:
        yield f"the multiplier is off by {shift:+.6g} everywhere", _multiplier(p) + shift


@suggests("multiplier")
def multiple_of_the_multiplier(p: Probe) -> Iterator[tuple[str, Array]]:
    right = _multiplier(p)
    with np.errstate(all="ignore"):
        factor = constant(np.where(right > 0.0, np.asarray(p.reply.multiplier) / right, np.nan))
    if factor == 0.0:
        yield "the multiplier returned is always zero", np.zeros_like(right)
    elif factor is not None:
        yield f"the multiplier is {_unlike_one(factor)} times the slip over the gradient of g", factor * right


@suggests("multiplier")
def multiplier_of_another_g(p: Probe) -> Iterator[tuple[str, Array]]:
    right, size = _multiplier(p), -p.query.region.level(np.zeros_like(p.trial), p.pressure)  # of g = N - R or N^p - R^p
    yield "the multiplier is the length of the slip, of a g whose gradient has length 1", _length(_slip(p))
    yield "the multiplier is the length of trial stress less stress: it is not divided by the stiffness", _length(p.trial - p.returned)
    if p.query.region.law.pressure is not None:
        yield "the multiplier is that of g divided by the pressure, not of g as it is written", right * np.abs(p.pressure)
    yield "the multiplier is that of g divided by its size, -g(0): of a gauge, not of g as it is written", right * size
    yield "the multiplier is that of g with its parts squared, not of g as it is written", right / (2.0 * size)
    yield "the multiplier is that of g with the root of its parts, not of g as it is written", right * 2.0 * np.sqrt(size)


def _length(vectors: Array) -> Array:
    return np.asarray(np.linalg.norm(vectors, axis=1))


@suggests("tangent")
def elastic_tangent(p: Probe) -> Iterator[tuple[str, Array]]:
    yield "the tangent is the elastic one, the stiffness, where there is slip too", np.broadcast_to(p.stiffness, _shape(p))


@suggests("tangent")
def no_tangent(p: Probe) -> Iterator[tuple[str, Array]]:
    yield "the tangent is zero", np.zeros(_shape(p))


@suggests("tangent")
def continuum_tangent(p: Probe) -> Iterator[tuple[str, Array]]:
    way = p.gradient @ p.stiffness
    along = way[:, :, None] * way[:, None, :] / np.einsum("ij,ij->i", p.gradient, way)[:, None, None]
    slips = (p.returned != p.trial).any(axis=1)[:, None, None]
    yield (
        "the tangent is that of the rates, k less its part along the normal, not that of the finite step",
        np.where(slips, p.stiffness - along, p.stiffness),
    )


@suggests("tangent")
def tangent_by_the_trial(p: Probe) -> Iterator[tuple[str, Array]]:
    yield "the tangent is the slope by the trial stress, not by the displacement", p.slopes @ np.linalg.inv(p.stiffness)


@suggests("tangent")
def opposite_tangent(p: Probe) -> Iterator[tuple[str, Array]]:
    yield "the tangent has the opposite sign", -p.slopes


@suggests("tangent")
def secant(p: Probe) -> Iterator[tuple[str, Array]]:
    share = _length(p.returned) / _length(p.trial)
    yield "the tangent is a secant: the stiffness times stress over trial stress", share[:, None, None] * p.stiffness


@suggests("tangent")
def multiple_of_the_tangent(p: Probe) -> Iterator[tuple[str, Array]]:
    right, given = p.slopes, np.asarray(p.reply.tangent)
    factors = np.einsum("nij,nij->n", given, right) / np.einsum("nij,nij->n", right, right)
    known = factors[np.isfinite(factors)]
    if known.size and np.ptp(known) <= 1e-4 * np.abs(known).max():
        factor = float(np.median(known))
        yield f"the tangent is {factor:.4g} times the slope of the stress", factor * right


def _shape(p: Probe) -> tuple[int, int, int]:
    n, d = p.trial.shape
    return n, d, d
