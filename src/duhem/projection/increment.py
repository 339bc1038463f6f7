"""The question of one slip increment: trial stresses, pressures, stiffness and parameter values that fit the law.

What a caller may ask is checked here, once, and the first bad entry is named.

Where law and stiffness are isotropic, an increment in six stresses is one in three principal stresses: the closest stress has the axes of
the trial, and its principal stresses are closest to those of the trial in the K that they have (A. S. Lewis 1996, SIAM J. Optim. 6,
164-177).  There planes bound the K of Tresca and of Mohr and Coulomb, and edges where two principal stresses are equal are corners.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any

import numpy as np
import sympy as sp
from numpy.typing import ArrayLike, NDArray

from duhem.errors import InputError
from duhem.expression.given_array import check_rows, in_order, unlabelled, unmasked
from duhem.expression.number import exact_number, inert_exponent
from duhem.expression.unevaluated import Verbatim
from duhem.expression.vocabulary import EigMax, symbol
from duhem.law.domain import by_name
from duhem.law.formula_law import Criterion
from duhem.law.state import frozen
from duhem.projection.declared_ranges import refused
from duhem.projection.metric import ROUNDING, factors
from duhem.projection.result import Array, Solution
from duhem.projection.row_by_row import widest

__all__ = [
    "Convexity", "Increment", "at_doubles", "check_associated", "increment", "posed", "principal", "setting", "stiffness_matrix",
    "stiffness_of", "trial_rows",
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


# -- in principal stresses ---------------------------------------------------------------------------------------------

_ROWS, _COLUMNS = (0, 1, 2, 1, 0, 0), (0, 1, 2, 2, 2, 1)  # of the entries xx, yy, zz, yz, xz, xy
_MATRIX = np.array([[0, 5, 4], [5, 1, 3], [4, 3, 2]])
_FAR = 1e3  # stresses: the axes of a trial farther off leave rounding of its size
_NEAR = 1e-6  # of the trial: a way to the boundary that is shorter has lost as many digits


@dataclass(frozen=True, eq=False)
class Principal:
    """The increments in principal stresses, the ``axes`` (N, 3, 3) of the trials, and the ``places`` of the entries among the forces."""

    increment: Increment
    axes: Array
    places: NDArray[np.intp]

    def back(self, found: Solution) -> tuple[Solution, NDArray[np.bool_]]:
        """The solution in six stresses, and where it has its digits (N,)."""
        stress, slip = np.empty((2, len(self.axes), 6))
        for into, own in ((stress, found.stress), (slip, found.slip)):
            into[:, self.places] = ((self.axes * own[:, None]) @ np.swapaxes(self.axes, 1, 2))[:, _ROWS, _COLUMNS]
        slip[:, self.places[3:]] *= 2.0  # a shear strain of engineers is twice the entry
        far = widest(self.increment.trial)
        away = widest(self.increment.trial - found.stress)
        return Solution(stress, slip, found.multiplier, found.failed), (away > _NEAR * far) & (far / _FAR < widest(found.stress))


def principal(question: Increment) -> Principal | None:
    """Those of a question; None where the law is not known to be isotropic, or the stiffness is not."""
    if (made := _reduced(question.law)) is None:
        return None
    law, known, places = made
    k = question.stiffness[np.ix_(places, places)]
    shear, bulk = 2.0 * k[3, 3], 2.0 * k[3, 3] + 3.0 * k[0, 1]  # the two eigenvalues
    isotropic = np.diag([shear] * 3 + [k[3, 3]] * 3)
    isotropic[:3, :3] += k[0, 1]
    if np.abs(isotropic - k).max() > ROUNDING * min(shear, bulk):
        return None
    with np.errstate(over="ignore", invalid="ignore"):
        values, axes = np.linalg.eigh(question.trial[:, places[_MATRIX]])
    if not np.isfinite(values).all():
        return None
    stiffness, diagonal = stiffness_matrix(isotropic[:3, :3], law.forces)
    own = replace(question, law=law, g=question.g.xreplace(known), trial=values, stiffness=stiffness, diagonal=diagonal)
    return Principal(own, axes, places)


@lru_cache(maxsize=64)
def _reduced(law: Criterion) -> tuple[Criterion, dict[sp.Expr, sp.Expr], NDArray[np.intp]] | None:
    """The law in principal stresses, what takes the place of eigenvalues and entries in it, and where xx, yy, zz, yz, xz, xy stand.

    Of a law whose stresses stand in eigenvalues and in the trace alone, with ranges on none of them.
    """
    forces = law.force_symbols()
    entries = next((node.args for node in law.g.atoms(EigMax) if set(node.args) == set(forces)), None)
    names = "principal_1", "principal_2", "principal_3"
    if entries is None or law.domain or set(names) & set(law.symbols()):
        return None
    nodes, trace = (EigMax(*entries), EigMax(*(-x for x in entries))), sp.Dummy()
    rest = law.g.xreplace({**{node: sp.Dummy() for node in nodes}, entries[0]: trace - entries[1] - entries[2]})
    if rest.free_symbols & set(forces):
        return None
    s = [symbol(name) for name in names]
    known = {nodes[0]: sp.Max(*s), nodes[1]: sp.Max(*(-x for x in s)), **dict(zip(entries, s, strict=False))}
    made = Criterion(law.name, law.g.xreplace(known), law.parameters, names, law.pressure, law.constraints)
    return made, known, np.array([forces.index(x) for x in entries])
