"""A routine that is driven by increments of strain or displacement and carries a state: what it is given, and what it answers."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from duhem.errors import InputError
from duhem.projection.result import Array
from duhem.testing.routines.routine import FormerAnswers, NoStep, Overwritten, Step, Update, called, named_after, noticed

__all__ = ["ELASTIC", "Material", "MaterialState", "advanced", "from_material", "stateless"]

ELASTIC = 1e-9  # relative error in stress up to which an answer counts as elastic
_DECADES = range(-12, 4)  # of strains or displacements
_LINEAR = 3  # decades of them in which a material is elastic, at least
_MILLIONTH, _AT_ONCE = 1e-6, 1e-15  # the second in s


@dataclass(frozen=True)
class MaterialState:
    """N points of a material after a step.

    ``strain`` (N, d), strain or displacement since the beginning, shears those of engineers; ``stress`` (N, d) in Pa, power
    conjugate to it; ``variables`` (N, s), the state that the routine carries on.  ``stored`` and ``dissipated`` (N,), energies
    since the beginning in J/m^3 (J/m^2 for displacements), None where the routine returns none.  Of the last step alone:
    ``slip`` (N, d), ``tangent`` d stress/d increment (N, d, d) in Pa (Pa/m), and ``solved`` (N,), False where the routine itself
    says that it found no answer; ``overwritten`` (N,) as in :class:`duhem.testing.Step`.  ``temperature`` (N,)
    is given to the routine with the state before the step, where its law has one, and stays the same.
    """

    strain: Array
    stress: Array
    variables: Array
    stored: Array | None = None
    dissipated: Array | None = None
    slip: Array | None = None
    tangent: Array | None = None
    solved: NDArray[np.bool_] | None = None
    overwritten: Overwritten | None = None
    temperature: Array | None = None

    def __len__(self) -> int:
        return len(self.stress)

    def rows(self, index: Any) -> MaterialState:
        """Return some of the points, or all several times."""
        return MaterialState(*(None if part is None else part[index] for part in vars(self).values()))  # type: ignore[arg-type]

    @staticmethod
    def joined(states: Sequence[MaterialState]) -> MaterialState:
        """The points of all, in their order, without what is of the last step alone; an energy that one of them does not have is None."""
        names = ("strain", "stress", "variables", "stored", "dissipated", "temperature")
        parts = {name: [getattr(state, name) for state in states] for name in names}
        joined = {n: None if any(x is None for x in part) else np.concatenate(part) for n, part in parts.items()}
        return MaterialState(**joined)  # type: ignore[arg-type]


# advance(before (N points), increment (N, d), pressure (N,) or None, duration in s) -> the points after the step
Advance = Callable[[MaterialState, Array, Array | None, float], MaterialState]


@dataclass(frozen=True)
class Material:
    """``stiffness`` (d, d), the elastic one, symmetric and positive definite; ``variables`` (s,) at the beginning, where stress is 0.

    A stiffness that is None is measured, of a material with so many components as ``components`` has names.  ``temperature`` is that
    of all its points, where it is given one, and ``state`` says where the variables of a law stand in its own;
    ``pressed``: it needs a pressure, under which nobody measures its stiffness.
    ``energies``: whether the routine returns both energies; ``towards``, of a routine whose only state is its stress, advances to a
    trial stress instead of by an increment; ``line``: Python that makes it again as ``update``, where known.
    InputError for a stiffness that is none.
    """

    advance: Advance
    stiffness: ArrayLike | None
    variables: ArrayLike = ()
    energies: bool = False
    name: str = "material"
    line: str = ""
    towards: Advance | None = None
    components: tuple[str, ...] = ()
    temperature: float | None = None
    state: Mapping[str, Any] | None = None
    pressed: bool = False

    def __post_init__(self) -> None:
        object.__setattr__(self, "variables", np.array(self.variables, dtype=np.float64).ravel())
        if self.stiffness is None and self.components:
            return
        k = np.array(self.stiffness, dtype=np.float64)
        square = k.ndim == 2 and k.shape[0] == k.shape[1]
        if not square or not np.allclose(k, k.T, rtol=1e-12, atol=0.0) or not (np.linalg.eigvalsh(k) > 0.0).all():
            remedy = "give the elastic stiffness (d, d), symmetric and positive definite; shear strains are those of engineers"
            raise InputError("the stiffness of a material is a symmetric, positive definite matrix", where=self.name, remedy=remedy)
        object.__setattr__(self, "stiffness", k)

    @property
    def __duhem_import__(self) -> str:
        return self.line

    @property
    def elastic(self) -> Array:
        """The elastic stiffness (d, d): as it is measured, or else as it is given.  InputError where it is neither."""
        if self.measured is not None:
            return self.measured
        if self.stiffness is None:
            what = "no small step of the routine is elastic, so that its stiffness cannot be measured"
            raise InputError(what, where=self.name, remedy="give the elastic stiffness")
        return np.asarray(self.stiffness)

    @cached_property
    def measured(self) -> Array | None:
        """The stiffness (d, d) that first small steps either way show; None where they show none.

        Strains grow by decades from 1e-12 on until an answer is no longer linear, so that no more is asked than its limit and a decade.
        Of the longest run of decades that agree to a millionth the third counts: there neither curvature nor rounding has a part.  They
        take so little time that nothing creeps.
        """
        if self.towards is not None or self.pressed:
            return None
        d = len(self.components) if self.stiffness is None else len(np.asarray(self.stiffness))
        runs: list[list[Array]] = [[]]
        for power in _DECADES:
            try:
                with np.errstate(all="ignore"):
                    after = self.advance(self.virgin(2 * d), 10.0**power * np.vstack([np.eye(d), -np.eye(d)]), None, _AT_ONCE)
                    there, back = np.split(np.asarray(after.stress, dtype=np.float64), 2)
                    slope, apart = (there - back).T / (2.0 * 10.0**power), np.abs(there + back).max() / (2.0 * 10.0**power)
            except (Exception, SystemExit):  # a check tells of it
                break
            size = _MILLIONTH * np.abs(slope).max()
            linear = size > 0.0 and apart <= size
            if not (linear and runs[-1] and np.abs(slope - runs[-1][-1]).max() <= size):
                runs.append([])
            runs[-1] += [slope] if linear else []
            if len(runs) > 1 and len(runs[-2]) >= _LINEAR:
                break
        run = max(runs, key=len)
        if len(run) < _LINEAR:
            return None
        k = 0.5 * (run[_LINEAR - 1] + run[_LINEAR - 1].T)
        return k if (np.linalg.eigvalsh(k) > 0.0).all() else None

    def virgin(self, n: int) -> MaterialState:
        """Return n points at the beginning."""
        d = len(self.components) if self.stiffness is None else len(np.asarray(self.stiffness))
        zero, none = np.zeros((n, d)), np.zeros(n)
        stored, dissipated = (none, none.copy()) if self.energies else (None, None)
        warm = None if self.temperature is None else np.full(n, self.temperature)
        return MaterialState(zero, zero.copy(), np.tile(np.asarray(self.variables), (n, 1)), stored, dissipated, temperature=warm)


def advanced(
    material: Material, before: MaterialState, increment: Array, pressure: Array | None, duration: float, answered: FormerAnswers
) -> MaterialState:
    """A step of a material, which is given copies, and which of them, or of what it has ``answered`` before, it has overwritten.

    Raises NoStep where what it returns has not the shapes of :class:`MaterialState`.
    """
    own = MaterialState(*(None if part is None else np.array(part) for part in vars(before).values()))  # type: ignore[arg-type]
    step, load = increment.copy(), None if pressure is None else pressure.copy()
    answer = material.advance(own, step, load, duration)
    names = ("stress", "strain", "variables", "stored", "dissipated")
    pairs = {f"{name} before the step": (getattr(own, name), getattr(before, name)) for name in names}
    pairs |= {"increment": (step, increment), "pressure": (load, pressure)}
    said = noticed(pairs, answered, len(increment), lambda: vars(answer))
    after = _read(answer, before)
    return after if said is None or after.overwritten is not None else replace(after, overwritten=said)


def _read(answer: MaterialState, before: MaterialState) -> MaterialState:
    """Return what a material has answered, in arrays of its own.  Raises NoStep."""
    n, d = before.stress.shape
    shapes: dict[str, tuple[int, ...]] = {"strain": (n, d), "stress": (n, d), "variables": before.variables.shape, "tangent": (n, d, d)}
    shapes |= {"slip": (n, d), **dict.fromkeys(("stored", "dissipated", "solved"), (n,))}
    parts: dict[str, Any] = {name: shaped(getattr(answer, name), name, shape, NoStep) for name, shape in shapes.items()}
    if missing := [name for name in ("strain", "variables") if parts[name] is None]:
        raise NoStep(f"the routine returned no {missing[0]}")
    return MaterialState(**parts, overwritten=answer.overwritten)


def stateless(update: Update | Material, stiffness: Array, values: Mapping[str, float]) -> Material:
    """An update routine as a material: the stress is its only state, sigma_tr = sigma + k du; what is a material already stays as it is.

    The energy it stores is sigma . k^-1 sigma/2; it dissipates sigma . slip, slip = k^-1 (sigma_tr - sigma) where it returns none.
    """
    if isinstance(update, Material):
        return update
    routine, inverse, answered = update, np.linalg.inv(stiffness), FormerAnswers()

    def towards(before: MaterialState, trial: Array, pressure: Array | None, duration: float) -> MaterialState:
        step = called(routine, values, trial, pressure, stiffness, answered)
        n, d = trial.shape
        shapes = {"stress": (n, d), "slip": (n, d), "tangent": (n, d, d), "solved": (n,)}
        found: dict[str, Any] = {name: shaped(getattr(step, name), name, shape) for name, shape in shapes.items()}
        stress, slip = found["stress"], found["slip"]
        increment = (trial - before.stress) @ inverse.T
        with np.errstate(all="ignore"):
            stored = 0.5 * np.einsum("ni,ij,nj->n", stress, inverse, stress)
            amount = (trial - stress) @ inverse.T if slip is None else slip
            loss = np.einsum("ni,ni->n", stress, amount)
        lost = loss if before.dissipated is None else before.dissipated + loss
        spoilt = None if step.overwritten is None else np.asarray(step.overwritten, dtype=object)
        return MaterialState(
            before.strain + increment, stress, before.variables, stored, lost, slip, found["tangent"], found["solved"], spoilt
        )

    def advance(before: MaterialState, increment: Array, pressure: Array | None, duration: float) -> MaterialState:
        return towards(before, before.stress + increment @ stiffness.T, pressure, duration)

    return Material(advance, stiffness, (), True, getattr(update, "__name__", "update"), getattr(update, "__duhem_import__", ""), towards)


def shaped(given: Any, name: str, shape: tuple[int, ...], fault: type[Exception] = ValueError) -> NDArray[Any] | None:
    """What a routine returned, as an array of the shape it must have and of its own; None for what is not returned.  Raises ``fault``.

    Of numbers, but for what is ``solved``, which is so or not.
    """
    if given is None and name != "stress":
        return None
    if isinstance(given, np.ndarray) and given.dtype == np.float64 and given.shape == shape:
        return np.array(given)
    try:
        whole = np.asarray(given)
        array = np.array(whole.real, dtype=np.float64)
    except (TypeError, ValueError):
        raise fault(f"the {name} is not made of numbers: {given!r}") from None
    if np.iscomplexobj(whole):
        raise fault(f"the {name} is complex ({whole.dtype}), not real")
    if array.shape != shape:
        raise fault(f"the {name} has the shape {array.shape}, not {shape}")
    return array.astype(np.bool_) if name == "solved" else array


def from_material(made: Callable[..., Material]) -> Update:
    """A material's first step as an update routine, to be held against a law: ``made(stiffness, **parameters)`` makes the material.

    The material begins without stress and is given the increment k^-1 sigma_tr of strain; the stress of the law is the
    material's in its order of components.
    """

    def update(trial: Array, pressure: Array | None, stiffness: Array, **parameters: float) -> Step:
        material = made(stiffness, **parameters)
        found = material.advance(material.virgin(len(trial)), np.asarray(np.linalg.solve(stiffness, trial.T).T), pressure, 1.0)
        return Step(found.stress, found.slip, None, found.tangent, found.solved, found.overwritten)

    return named_after(update, made, "from_material")
