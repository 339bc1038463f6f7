"""Update routines right and wrong: what each is, is known by construction."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

import duhem
from duhem.testing import (
    Step,
)

Array = np.ndarray
MU = {"mu_a_plus": 0.2, "mu_a_minus": 0.08, "mu_b_plus": 0.12, "mu_b_minus": 0.15}
ELLIPSE = {"mu_a": 0.5, "mu_b": 0.1}
DISK = {"mu": 0.3}


def antoni(values: dict[str, float]) -> Callable[..., Array]:
    def update(trial: Array, pressure: Array, stiffness: Array) -> Array:
        return duhem.project("antoni2007", trial, pressure, stiffness, values).stress

    return update


def ellipse(trial: Array, pressure: Array, stiffness: Array) -> Array:
    """The closest point, right."""
    return duhem.project("orthotropic", trial, pressure, stiffness, ELLIPSE).stress


def radial_return(trial: Array, pressure: Array, stiffness: Array) -> Array:
    gauge = np.hypot(trial[:, 0] / 0.5, trial[:, 1] / 0.1)
    share = np.where(gauge > -pressure, -pressure / np.where(gauge > 0, gauge, 1.0), 1.0)
    return trial * share[:, None]


def identity_metric(trial: Array, pressure: Array, stiffness: Array) -> Array:
    return duhem.project("orthotropic", trial, pressure, 1.0, ELLIPSE).stress


def inverse_metric(trial: Array, pressure: Array, stiffness: Array) -> Array:
    return duhem.project("orthotropic", trial, pressure, np.linalg.inv(stiffness), ELLIPSE).stress


def nothing(trial: Array, pressure: Array, stiffness: Array) -> Array:
    return trial


def over_projection(trial: Array, pressure: Array, stiffness: Array) -> Array:
    right = ellipse(trial, pressure, stiffness)
    return np.where(right == trial, trial, 0.9 * right)


def to_the_origin(trial: Array, pressure: Array, stiffness: Array) -> Array:
    right = ellipse(trial, pressure, stiffness)
    return np.where((right == trial).all(axis=1, keepdims=True), trial, 0.0)


def swapped_sign(trial: Array, pressure: Array, stiffness: Array) -> Array:
    right = ellipse(trial, pressure, stiffness)
    return np.where((right == trial).all(axis=1, keepdims=True), trial, -right)


def reflected(trial: Array, pressure: Array, stiffness: Array) -> Array:
    return trial + 2.0 * (ellipse(trial, pressure, stiffness) - trial)


def built_in_stress(trial: Array, pressure: Array, stiffness: Array) -> Array:
    """A cohesion of 1e-3 Pa that the law does not have, kept from below."""
    return duhem.project("orthotropic", trial, np.minimum(pressure + 1e-3, 0.0), stiffness, ELLIPSE).stress


def not_a_number(trial: Array, pressure: Array, stiffness: Array) -> Array:
    with np.errstate(all="ignore"):
        gauge = np.hypot(trial[:, 0] / 0.5, trial[:, 1] / 0.1)
        return np.where((gauge <= -pressure)[:, None], trial, trial * (-pressure / gauge)[:, None]) + 0.0 * (1.0 / gauge)[:, None]


def raises(trial: Array, pressure: Array, stiffness: Array) -> Array:
    raise ZeroDivisionError("no pressure")


def wrong_shape(trial: Array, pressure: Array, stiffness: Array) -> Array:
    return trial[:, 0]


def with_extras(**change: Callable[..., Array]) -> Callable[..., Step]:
    def update(trial: Array, pressure: Array, stiffness: Array) -> Step:
        found = duhem.project("orthotropic", trial, pressure, stiffness, ELLIPSE, tangent=True)
        parts = {"slip": found.slip, "multiplier": found.multiplier, "tangent": found.tangent}
        return Step(found.stress, **{name: change.get(name, lambda x: x)(part) for name, part in parts.items()})

    return update


def skewed(tangent: Array) -> Array:
    return tangent + np.array([[0.0, 1e-3], [-1e-3, 0.0]]) * np.abs(tangent).max(axis=(1, 2), keepdims=True)
