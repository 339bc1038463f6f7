"""What a run may be asked: an option that cannot be used is told before anything is drawn."""

from __future__ import annotations

from dataclasses import dataclass
from math import isfinite
from numbers import Integral, Real
from typing import Any

import numpy as np
from hypothesis.strategies import SearchStrategy
from numpy.typing import ArrayLike

from duhem.errors import InputError
from duhem.expression.given_array import reals
from duhem.law.formula_law import Criterion
from duhem.projection.increment import factors, refused
from duhem.projection.result import Array
from duhem.testing.drawn.values import Strategy

__all__ = ["ACCURACY", "TRIES", "RunOptions", "check_share", "numbers", "stiffness_matrix"]

ACCURACY = 1e-9  # relative error in stress a routine is held to, unless it promises another
TRIES = 200  # to make a failing case smaller, counted, so that what is told does not depend on the load of the machine
_SYMMETRIC = "give a symmetric positive definite stiffness, in Pa/m"


@dataclass(frozen=True)
class RunOptions:
    """How a run draws cases and makes a failing one small, as :func:`duhem.testing.conformance` takes it; None where left out."""

    stiffness: ArrayLike | Strategy | None = None
    pressure: float | Strategy | None = None
    accuracy: float = ACCURACY
    max_examples: int | None = None
    rows: int = 30
    every: int | None = None
    tries: int = TRIES
    seconds: float | None = None
    seed: int | None = None
    largest_strain: float | None = None
    scale: float | None = None

    def check(self, law: Criterion | None) -> None:
        """Raise InputError for the first option that cannot be used."""
        _check_stiffness(self.stiffness, law)
        _check_pressure(self.pressure, law)
        if not _is_number(self.accuracy) or not 0.0 < self.accuracy < 1.0:  # beyond, every stress would do
            low = _is_number(self.accuracy) and self.accuracy <= 0.0
            what = "the accuracy is not positive" if low else f"{self.accuracy!r} is not a relative error"
            raise InputError(what, where="accuracy", remedy="give a number between 0 and 1, for example 1e-9")
        if self.seconds is not None and not (_is_number(self.seconds) and self.seconds >= 0.0):
            raise InputError(f"{self.seconds!r} is not a time", where="seconds", remedy="give a number >= 0, or remove it")
        for name in ("largest_strain", "scale"):
            if (strain := getattr(self, name)) is None:
                continue
            if law is not None:
                remedy = "remove it: with a law, increments are drawn by the size of K"
                raise InputError("the size of increments is given with a law", where=name, remedy=remedy)
            if not (_is_number(strain) and strain > 0.0):
                raise InputError(f"{strain!r} is not a strain", where=name, remedy="give a number > 0, for example 1e-2")
        for name, least in (("rows", 1), ("every", 1), ("tries", 0), ("max_examples", 1), ("seed", None)):
            given = getattr(self, name)
            if given is None and name not in ("rows", "tries"):  # which may not be left out
                continue
            if isinstance(given, bool) or not isinstance(given, Integral):
                remedy = f"give one, for example {max(least or 0, 1) * 10}"
                raise InputError(f"{given!r} is not a whole number", where=name, remedy=remedy)
            if least is not None and given < least:
                raise InputError(f"{given} is too small", where=name, remedy=f"give {least} or more")


def check_share(given: Any, where: str) -> None:
    """Raise InputError unless it is a number from 0 to 1."""
    if not _is_number(given) or not 0.0 <= given <= 1.0:
        raise InputError(f"{given!r} is not a fraction", where=where, remedy="give a number from 0 to 1, for example 0.1")


def stiffness_matrix(given: ArrayLike, law: Criterion | None) -> Array:
    """Return k (d, d) of one number, (d,) or (d, d) in Pa/m, without a law (d,) or (d, d).  Raises InputError for another shape.

    One number is a stiffness as :func:`duhem.project` takes it: of the tensors, where the law declares a stress.
    """
    d = 0 if law is None else len(law.forces)
    remedy = f"give one number, ({d},) or ({d}, {d})" if d else "without a law give (d,) or (d, d)"
    k = numbers(given, "stiffness", remedy)
    n = d or len(np.atleast_1d(k))
    if k.size == 0 or k.shape not in ([(), (n,), (n, n)] if d else [(n,), (n, n)]):
        raise InputError(f"stiffness has the shape {k.shape}", where="stiffness", remedy=remedy)
    if k.ndim == 0 and law is not None and law.stress is not None:
        k = k * law.stress.unit_stiffness
    return k if k.ndim == 2 else np.diag(np.broadcast_to(k, (n,)))


def _check_stiffness(given: ArrayLike | Strategy | None, law: Criterion | None) -> None:
    """Raise InputError unless it is of a shape that the law takes, and positive definite; a strategy is not looked into."""
    if given is None or isinstance(given, SearchStrategy):
        return
    k, least = stiffness_matrix(given, law), np.min(np.asarray(given, dtype=np.float64))
    if np.ndim(given) < 2 and least <= 0.0:
        raise InputError(f"{least} is not positive", where="stiffness", remedy=_SYMMETRIC)
    scale = np.sqrt(np.abs(np.diagonal(k)))
    if (np.abs(k - k.T) > 4.0 * np.finfo(float).eps * np.outer(scale, scale)).any():
        raise InputError("the matrix is not symmetric", where="stiffness", remedy=_SYMMETRIC)
    factors(np.tril(k) + np.tril(k, -1).T)


def _check_pressure(given: float | Strategy | None, law: Criterion | None) -> None:
    """Raise InputError unless it is one number <= 0, in Pa, that the law admits; a strategy is not looked into."""
    if given is None or isinstance(given, SearchStrategy):
        return
    value = numbers(given, "pressure", "give one number, for example -1e6")
    name = "sigma_n" if law is None or law.pressure is None else law.pressure
    if value.ndim:
        raise InputError(f"pressure has the shape {value.shape}", where="pressure", remedy="give one number, for example -1e6")
    if value > 0.0:
        raise InputError(f"{name} = {value} is positive", where="pressure", remedy=f"{name} <= 0 in compression: give a number <= 0")
    if law is not None and law.pressure is not None and refused(law, value[None])[0]:
        what = f"{name} = {value} is outside the range of {law.domain[name].stated(name)}"
        raise InputError(what, where="pressure", remedy="give a number within it")


def _is_number(given: Any) -> bool:
    return isinstance(given, Real) and not isinstance(given, bool | np.bool_) and isfinite(given)


def numbers(given: Any, where: str, remedy: str) -> Array:
    """Finite numbers as an array.  Raises InputError for anything else."""
    if (found := reals(given)) is None or not np.isfinite(found).all():
        raise InputError(f"{str(given)[:60]!r} is not made of finite numbers", where=where, remedy=remedy)
    return found
