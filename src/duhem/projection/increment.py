"""The question of one slip increment: trial stresses, pressures, stiffness and parameter values that fit the law.

What a caller may ask is checked here, once, and the first bad entry is named.  The lengths that a stiffness gives to slips and stresses,
and the ranges that a law declares, belong to the question too.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import lru_cache
from typing import Any

import numpy as np
import sympy as sp
from numpy.typing import ArrayLike, NDArray

from duhem.errors import InputError
from duhem.expression.given_array import check_rows, in_order, unlabelled, unmasked
from duhem.expression.number import exact_number, inert_exponent
from duhem.expression.unevaluated import Verbatim
from duhem.law.domain import by_name
from duhem.law.formula_law import Criterion
from duhem.law.state import frozen
from duhem.projection.result import ACCURACY, Array

__all__ = [
    "ROUNDING", "Convexity", "Increment", "Metric", "at_doubles", "beyond", "check_associated", "crossed", "factors", "increment", "posed",
    "refused", "setting", "stiffness_matrix", "stiffness_of", "too_far_apart", "trial_rows",
]  # fmt: skip


@dataclass(frozen=True)
class Convexity:
    """Whether K is shown to be convex: ``loaded`` under every pressure sigma_n < 0, or for a law without one, ``unloaded`` at sigma_n = 0.

    False where it is refuted or open.  It is found elsewhere (:mod:`duhem.api`): the closest point rests on no proof.
    """

    loaded: bool
    unloaded: bool


@dataclass(frozen=True)
class Increment(Verbatim):
    """N validated increments of one law.

    ``g``: the criterion with parameter values in place, over the force symbols and the pressure symbol.
    ``trial`` (N, d) in Pa; ``pressure`` (N,) sigma_n <= 0 in Pa (zeros for a law without pressure);
    ``stiffness`` (d, d) symmetric positive definite in Pa/m, ``diagonal`` whether it is diagonal;
    ``parameters`` every parameter of the law by name, as floats.
    ``convexity`` what is known of K where somebody has asked, else None.
    """

    law: Criterion
    g: sp.Expr
    trial: Array
    pressure: Array
    stiffness: Array
    diagonal: bool
    parameters: Mapping[str, float]
    convexity: Convexity | None = None

    @property
    def pressure_symbol(self) -> sp.Symbol | None:
        """The symbol of the pressure, None for a law without one."""
        return self.law.symbols()[self.law.pressure] if self.law.pressure else None

    def of(self, at: Any) -> Increment:
        """The increments ``at`` alone."""
        return replace(self, trial=self.trial[at], pressure=self.pressure[at])

    def shown_convex(self) -> NDArray[np.bool_]:
        """Points (N,) at whose pressure K is shown to be convex."""
        known = self.convexity or Convexity(loaded=False, unloaded=False)
        pressed = self.pressure < 0.0 if self.law.pressure else np.ones(self.pressure.shape, dtype=np.bool_)
        return np.where(pressed, known.loaded, known.unloaded)


def at_doubles(law: Criterion, parameters: Mapping[str, float]) -> sp.Expr:
    """The criterion with these numbers, taken exactly: as the methods read it, and not as it was written in decimals."""
    symbols = law.symbols()
    exponents = {x for power in law.g.atoms(sp.Pow) for x in power.exp.free_symbols}
    values = {symbols[name]: sp.Rational(value) for name, value in parameters.items()}
    return law.g.xreplace({x: inert_exponent(value) if x in exponents else value for x, value in values.items()})


# -- what may be asked --------------------------------------------------------------------------------------------------


def increment(
    law: Criterion, trial: ArrayLike, pressure: ArrayLike | None, stiffness: ArrayLike | None, parameters: Mapping[str, Any] | None
) -> Increment:
    """The checked question; InputError names the argument and the index of the first entry that cannot be used."""
    return posed(setting(law, stiffness, parameters), trial, pressure)


def check_associated(law: Criterion) -> None:
    """InputError for a law with a flow of its own, with rates beside it, or with rates that are the gradient of a potential."""
    if law.rates:
        what = f"{law.name} has rates without a multiplier, and a closest point is no increment of them"
        raise InputError(what, where="law", remedy="let duhem.simulate integrate them, or project onto the same criterion without them")
    if law.viscous:
        what = f"the rates of {law.name} are the gradient of a potential, and a closest point is no increment of them"
        remedy = "let duhem.simulate integrate them, or project onto the criterion that its potential has in it"
        raise InputError(what, where="law", remedy=remedy)
    if not law.associated:
        raise InputError(
            f"{law.name} has its own flow direction, but the closest point is the slip increment of associated laws only",
            where="law",
            remedy="let duhem.simulate integrate its flow rule, or project onto the same criterion without its flow",
        )


def setting(law: Criterion, stiffness: ArrayLike | None, parameters: Mapping[str, Any] | None) -> Increment:
    """The checked question but for its points: no trial stress yet."""
    check_associated(law)
    law = frozen(law)
    values, g = _settled(law, _exact(parameters))
    k, diagonal = stiffness_of(law, stiffness)
    return Increment(
        law=law,
        g=g,
        trial=np.empty((0, len(law.forces))),
        pressure=np.empty(0),
        stiffness=k,
        diagonal=diagonal,
        parameters={name: int(value.p) / int(value.q) for name, value in values},
    )


def posed(setting: Increment, trial: ArrayLike, pressure: ArrayLike | None) -> Increment:
    """The question ``setting`` at other points, which are checked."""
    d = len(setting.law.forces)
    stresses = trial_rows(trial, setting.law.forces)
    pressures = _pressure(pressure, setting.law)
    check_rows(trial, pressure, "pressure")
    if stresses.shape[:1] == pressures.shape:
        return replace(setting, trial=stresses, pressure=pressures)
    try:
        n = np.broadcast_shapes((stresses.shape[0],), pressures.shape)[0]
    except ValueError:
        raise InputError(
            f"{stresses.shape[0]} trial stresses and {pressures.shape[0]} pressures do not broadcast",
            where="pressure",
            remedy="give one pressure, or one a trial stress",
        ) from None
    return replace(setting, trial=np.broadcast_to(stresses, (n, d)), pressure=np.broadcast_to(pressures, (n,)))


Values = tuple[tuple[str, sp.Rational], ...]


def _exact(given: Mapping[str, Any] | None) -> Values:
    exact = {}
    for name, value in by_name(given).items():
        try:
            exact[name] = exact_number(value)
        except InputError as fault:
            raise InputError(fault.what, where=f"parameter {name}", remedy=fault.remedy) from None
    return tuple(exact.items())


@lru_cache(maxsize=256)
def _settled(law: Criterion, given: Values) -> tuple[Values, sp.Expr]:
    """All parameters of the law, and its formula with them in place: once for increments that follow one another."""
    fixed = law.fix(dict(given))
    values = {name: domain.value for name, domain in fixed.parameters.items()}
    if missing := [name for name, value in values.items() if value is None]:
        raise InputError(f"no value is given for {', '.join(missing)}", where=f"parameters of {law.name}", remedy=_example(missing))
    known = {law.symbols()[name]: value for name, value in values.items()}
    for relation in law.constraints:
        if relation.xreplace(known) == sp.false:
            at = ", ".join(f"{name} = {values[str(name)]}" for name in sorted(map(str, relation.free_symbols)))
            raise InputError(f"{relation} does not hold at {at}", where=f"parameters of {law.name}", remedy="choose values that satisfy it")
    for name, value in values.items():
        if value is not None and not _representable(value):
            raise InputError(f"{name} = {value} is beyond double precision", where=f"parameters of {law.name}", remedy="rescale the units")
    numbers = {name: value for name, value in values.items() if value is not None}
    return tuple(numbers.items()), _formula(law, numbers)


def _formula(law: Criterion, values: Mapping[str, sp.Rational]) -> sp.Expr:
    fixed = law.fix(values)
    g = fixed.g.xreplace(fixed.settled())
    if g.has(sp.zoo, sp.nan, sp.oo, -sp.oo):
        at = ", ".join(f"{name} = {value}" for name, value in values.items())
        raise InputError(
            f"g is not defined at {at}", where=f"parameters of {law.name}", remedy="a coefficient of zero? give a positive one"
        )
    return g


def _representable(value: sp.Rational) -> bool:
    try:
        number = int(value.p) / int(value.q)
    except OverflowError:
        return False
    return (number == 0.0) == (value == 0)


def _example(names: list[str]) -> str:
    return f"give parameters={{{', '.join(f'{name!r}: ...' for name in names)}}}"


def _array(given: Any, where: str) -> Array:
    try:
        raw = np.asarray(given)
        if raw.dtype.kind not in "iuf":
            raise ValueError
        array = raw.astype(np.float64, copy=False)
    except (ValueError, TypeError):
        raise InputError("these are not real numbers of a rectangular shape", where=where, remedy="give a NumPy array of floats") from None
    if not (finite := np.isfinite(array)).all():
        at = _first(~finite) or ()
        raise InputError(f"{_at(where, at)} is {array[at]}", remedy="give finite numbers")
    return array


def _first(bad: NDArray[np.bool_]) -> tuple[int, ...] | None:
    """The index of the first True, () for a lone number, None where there is none."""
    return tuple(int(i) for i in np.unravel_index(int(np.argmax(bad)), bad.shape)) if bad.any() else None


def _at(where: str, index: tuple[int, ...]) -> str:
    return f"{where}[{', '.join(map(str, index))}]" if index else where


def trial_rows(given: ArrayLike, axes: Sequence[str]) -> Array:
    """Trial stresses (N, d) of finite numbers, a column for each of the ``axes``."""
    d, array = len(axes), _array(in_order(given, axes, "trial"), "trial")
    trial = array[None] if array.ndim == 1 else array
    if trial.ndim != 2 or trial.shape[1] != d:
        raise InputError(f"trial has the shape {array.shape}", where="trial", remedy=f"give (N, {d}) or ({d},), columns {', '.join(axes)}")
    return trial


def _pressure(given: ArrayLike | None, law: Criterion) -> Array:
    if law.pressure is None:
        if given is not None:
            raise InputError(f"{law.name} has no pressure", where="pressure", remedy="remove it")
        return np.zeros(1)
    if given is None:
        raise InputError(f"{law.name} needs the pressure {law.pressure}", where="pressure", remedy="give one number or one a trial stress")
    pressure = _array(unmasked(given, "pressure"), "pressure")
    if pressure.ndim > 1:
        raise InputError(f"pressure has the shape {pressure.shape}", where="pressure", remedy="give one number or the shape (N,)")
    if (at := _first(pressure > 0.0)) is not None:
        raise InputError(
            f"{_at('pressure', at)} is {pressure[at]} > 0",
            remedy=f"{law.pressure} <= 0 in compression; an open contact carries no friction",
        )
    if law.pressure in law.domain and (at := _first(refused(law, pressure))) is not None:
        raise InputError(
            f"{_at('pressure', at)} is {pressure[at]}, outside the range of {law.domain[law.pressure].stated(law.pressure)}",
            remedy=f"{law.name} says nothing there: keep to the range, or declare a wider one in its domain",
        )
    return np.atleast_1d(pressure)


def stiffness_of(law: Criterion, given: ArrayLike | None) -> tuple[Array, bool]:
    """The matrix of a law's forces, and whether it is diagonal."""
    if given is None:
        raise InputError(f"{law.name} has no energy of its own, and there is no stiffness", where="stiffness", remedy="give one")
    return stiffness_matrix(given, law.forces, None if law.stress is None else law.stress.unit_stiffness)


def stiffness_matrix(given: ArrayLike, axes: Sequence[str], unit: tuple[float, ...] | None = None) -> tuple[Array, bool]:
    """The matrix, not to be written to, and whether it is diagonal; ``unit`` is the diagonal that the number 1 stands for."""
    d = len(axes)
    remedy = f"give one number, ({d},) or ({d}, {d})"
    k = _array(unlabelled(given, "stiffness", f"{remedy}, in the order of {', '.join(axes)}"), "stiffness")
    if k.shape not in ((), (d,), (d, d)):
        raise InputError(f"stiffness has the shape {k.shape}", where="stiffness", remedy=remedy)
    return _matrix(k.tobytes(), k.shape, unit or (1.0,) * d)


@lru_cache(maxsize=256)
def _matrix(given: bytes, shape: tuple[int, ...], one: tuple[float, ...]) -> tuple[Array, bool]:
    """Once for increments that follow one another."""
    k = np.frombuffer(given).reshape(shape)
    matrix = k if k.ndim == 2 else np.diag(k if k.ndim else k * np.array(one))
    if (bad := _first(np.diagonal(matrix) <= 0.0)) is not None:
        i = bad[0]
        index = () if k.ndim == 0 else (i,) * k.ndim
        raise InputError(
            f"{_at('stiffness', index)} is {matrix[i, i]}, not positive", remedy="give a symmetric positive definite stiffness"
        )
    scale = np.sqrt(np.diagonal(matrix))
    unit = matrix / scale[:, None] / scale[None]
    if (bad := _first(np.abs(unit - unit.T) > 4.0 * np.finfo(float).eps)) is not None:
        i, j = bad
        raise InputError(
            f"stiffness[{i}, {j}] is {matrix[i, j]} and stiffness[{j}, {i}] is {matrix[j, i]}", remedy="give a symmetric stiffness"
        )
    symmetric = np.tril(matrix) + np.tril(matrix, -1).T
    factors(symmetric)  # exact, so that it tells a singular matrix from an ill-conditioned one
    symmetric.flags.writeable = False
    return symmetric, bool((symmetric == np.diag(np.diagonal(symmetric))).all())


# -- the metric of a stiffness -----------------------------------------------------------------------------------------
#
# Lengths are (x . k x)^1/2 of slips and (x . k^-1 x)^1/2 of stresses, however ill-conditioned k is.


def too_far_apart(stiffness: Array) -> str | None:
    """None where k over its largest entry has a Cholesky factor in double precision, else why not, with the remedy."""
    relative = stiffness / np.max(np.diagonal(stiffness))
    try:
        np.linalg.cholesky(relative)
    except np.linalg.LinAlgError:
        return "the stiffnesses are too far apart for double precision; measure the forces in units that bring them together"
    return None


def factors(stiffness: Array) -> tuple[Array, Array]:
    """L lower triangular and its inverse, for a symmetric positive definite (d, d) ``stiffness`` in Pa/m.

    slip @ L and stress @ L^-T then have the lengths (slip . k slip)^1/2 and (stress . k^-1 stress)^1/2, in (J/m^2)^1/2.
    k = U D U^T is found exactly, in fractions: in floating point the last pivot keeps no digit once the condition
    exceeds 1e16 (G. H. Golub and C. F. Van Loan, 2013, Matrix Computations, section 4.2).  InputError if k is not
    positive definite.
    """
    d = len(stiffness)
    k = [[Fraction(x) for x in row] for row in np.asarray(stiffness, dtype=np.float64).tolist()]
    unit = [[Fraction(i == j) for j in range(d)] for i in range(d)]
    inverse = [[Fraction(i == j) for j in range(d)] for i in range(d)]
    for j in range(d):
        if k[j][j] <= 0:
            raise InputError("the matrix is not positive definite", where="stiffness", remedy="give a symmetric positive definite one")
        for i in range(j + 1, d):
            share = k[i][j] / k[j][j]
            unit[i][j] = share
            k[i] = [x - share * y for x, y in zip(k[i], k[j], strict=True)]
            inverse[i] = [x - share * y for x, y in zip(inverse[i], inverse[j], strict=True)]
    roots = np.sqrt([float(k[j][j]) for j in range(d)])
    rows = ([[float(x) for x in row] for row in matrix] for matrix in (unit, inverse))
    lower, upper = (np.array(row) for row in rows)
    return lower * roots, upper / roots[:, None]


ROUNDING = 4e-15  # of each number that enters


@dataclass(frozen=True, eq=False)
class Metric:
    """Matrices (d, d): rows times ``of_slip`` or ``of_stress`` have these lengths, ``to_stress`` is the way back.

    ``blur``: what a difference of stresses may be off by as a share of their lengths; ``steepest``: the most that the components
    of a slip are longer than in the metric; ``good``: what a slip may be off by in it for all its components to be good, ``certain``
    what a point may be off by as a share of its stress, or of its slip, for those of either to be.
    """

    of_slip: Array
    of_stress: Array
    to_stress: Array
    blur: float
    steepest: float
    good: float
    certain: float

    @classmethod
    def of(cls, stiffness: Array) -> Metric:
        """That of k, symmetric and positive definite."""
        return _metric(stiffness.tobytes(), len(stiffness))


@lru_cache(maxsize=64)
def _metric(stiffness: bytes, d: int) -> Metric:
    k = np.frombuffer(stiffness).reshape(d, d)
    lower, inverse = factors(k)
    blur = 2.0 * ROUNDING * float(np.linalg.norm(np.abs(lower.T) @ np.abs(inverse.T), 2))  # of components, which the metric weighs
    steepest = float(np.linalg.norm(inverse, 2))
    good = ACCURACY / max(1.0, steepest * float(np.linalg.norm(lower, 2)))
    return Metric(lower, inverse.T, lower.T, blur, steepest, good, good / float(np.sqrt(d)))


# -- the ranges of a law's pressure and forces -------------------------------------------------------------------------
#
# A pressure outside is no question to the law, and a stress outside no answer.  What a law claims it claims in its ranges alone (``domain``
# of :class:`duhem.Criterion`).  The closest point of K that lies in them is that of K within them too; one that does not is the closest
# point of nothing that is claimed to be convex.  A trial stress is no state of the law, and may lie anywhere.

_AT_AN_END = 1e-12  # of the size of a stress: an end of a range may be where K ends too


def refused(law: Criterion, pressure: Array) -> NDArray[np.bool_]:
    """Which of the pressures (N,) lie outside the law's range; a double stands for the number that it is the nearest to."""
    if law.pressure is None or law.pressure not in law.domain:
        return np.zeros(pressure.shape, dtype=np.bool_)
    low, high = law.domain[law.pressure].ends
    out: NDArray[np.bool_] = (pressure < low) | (pressure > high)
    return out


def beyond(law: Criterion, stress: Array, trial: Array | None = None) -> NDArray[np.bool_]:
    """Which of the ``stress`` (N, d) lie outside the ranges by more than rounding, of the ``trial`` (N, d) too; (N,)."""
    return np.asarray(_beyond(law, stress, trial).any(axis=1))


def crossed(law: Criterion, stress: Array) -> str:
    """What the first of the ``stress`` (N, d) that lies beyond a range crosses: ``sigma_a = 12 lies outside its range [-10, 10]``."""
    row, column = np.argwhere(_beyond(law, stress, None))[0]
    force = [name for name in law.forces if name in law.domain][column]
    low, high = law.domain[force].ends
    x = float(stress[row, law.forces.index(force)])
    said = f"{x:g}" if not low <= float(f"{x:g}") <= high else repr(x)  # with digits enough to be outside
    return f"{force} = {said} lies outside its range {law.domain[force].describe()}"


def _beyond(law: Criterion, stress: Array, trial: Array | None) -> NDArray[np.bool_]:
    """The same for each range of a force, (N, ranges)."""
    ranged = [i for i, name in enumerate(law.forces) if name in law.domain]
    if not ranged:
        return np.zeros((len(stress), 0), dtype=np.bool_)
    low, high = np.array([law.domain[law.forces[i]].ends for i in ranged]).T
    size = np.abs(stress).max(axis=1)
    slack = _AT_AN_END * size if trial is None else _AT_AN_END * size + 4.0 * np.finfo(float).eps * np.abs(trial).max(axis=1)
    own: NDArray[np.bool_] = (stress[:, ranged] < low - slack[:, None]) | (stress[:, ranged] > high + slack[:, None])
    return own
