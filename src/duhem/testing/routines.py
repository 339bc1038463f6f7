"""The routine under test: what it is given, may answer and must not spoil, and adapters for other shapes of routine.

A material is a routine that is driven by increments of strain or displacement and carries a state.  The origin of a routine, and that
of a law, is the Python by which another file has them again, where they have names that it can import.
"""

from __future__ import annotations

import sys
import sysconfig
from collections import deque
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cached_property, partial
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from duhem.errors import DuhemError, InputError
from duhem.expression.text import formula
from duhem.law.catalogue import file_read, installed, load, load_named, shipped
from duhem.law.domain import Domain
from duhem.law.formula_law import Criterion
from duhem.law.registry import registered
from duhem.projection.result import Array

__all__ = [
    "ELASTIC", "FormerAnswers", "Material", "MaterialState", "NoStep", "Origin", "Overwritten", "Step", "Unfinished", "Update", "advanced",
    "called", "changed", "from_displacements", "from_material", "law_as_written", "named", "named_after", "noticed", "origin",
    "overwritten", "pointwise", "stateless",
]  # fmt: skip


@dataclass(frozen=True)
class Step:
    """What a routine may return besides the stress (N, d) in Pa, or a mapping with these names; None for what it does not compute.

    ``slip`` (N, d) in m, taken to be k^-1 (sigma_tr - sigma) where left out; ``multiplier`` lambda (N,) with
    slip = lambda dg/dsigma; ``tangent`` d sigma/d u (N, d, d) in Pa/m; ``solved`` (N,), False where the routine itself says
    that it found no answer: such points are counted and not judged.  An array may be the one that was given, and has to stay as it
    is once it is returned.  ``overwritten`` (N,), set by what calls routines of other
    languages: the names of what they were only given and have changed, "" where nothing; ``returned``, set by what makes the step
    of something else: what the routine itself has returned, by name.
    """

    stress: ArrayLike
    slip: ArrayLike | None = None
    multiplier: ArrayLike | None = None
    tangent: ArrayLike | None = None
    solved: ArrayLike | None = None
    overwritten: ArrayLike | None = None
    returned: Mapping[str, Any] | None = None


# update(trial (N, d), pressure (N,) or None for a law without, stiffness (d, d), **parameters left open) -> stress, Step or its mapping
Update: TypeAlias = Callable[..., ArrayLike | Step | Mapping[str, ArrayLike | None]]


class Unfinished(DuhemError):
    """A routine has had all the time that it may take, and has not answered; raised by what can end it.

    ``row``: which of the increments it was asked together does so alone, None where that is not known, and ``case`` the case
    of that increment, as the one that is tried.  ``failure``, of one met in a conformance run: what shows it again, as that of the
    check which asked (:class:`duhem.testing.Failure`, with its ``replay()``).
    """

    row: int | None = None
    case: Any = None
    failure: Any = None


class NoStep(Exception):
    """This is raised where the answer of a routine is neither a stress nor a :class:`Step`."""


def _as_step(answer: Any) -> Step:
    """Return what a routine returned as a step.  Raises NoStep."""
    if isinstance(answer, Step):
        return answer
    if isinstance(answer, Mapping):
        names = [*Step.__dataclass_fields__]
        if unknown := [str(name) for name in answer if name not in names]:
            raise NoStep(f"the routine returned a mapping with {', '.join(unknown)}; what is known is {', '.join(names[:-2])}")
        if "stress" not in answer:
            raise NoStep("the routine returned a mapping without stress")
        return Step(**answer)
    if isinstance(answer, Iterator):
        what = type(answer).__name__
        raise NoStep(f"the routine returned a {what}, which gives its rows one by one: return them together, as an array or a list")
    return Step(answer)


def _parts(answer: Any) -> Mapping[str, Any]:
    """Return the parts of what a routine returned, by name.  Raises NoStep."""
    parts = dict(vars(_as_step(answer)))
    return parts | (parts.pop("returned") or {})


def pointwise(step: Callable[..., Any]) -> Update:
    """Adapt a routine for one increment, ``step(trial (d,), pressure, stiffness (d, d), **parameters) -> stress (d,) or Step``, to many."""

    def update(trial: Array, pressure: Array | None, stiffness: Array, **parameters: float) -> Step:
        loads = [None] * len(trial) if pressure is None else pressure.tolist()
        answered, each, spoilt = FormerAnswers(), [], []
        for t, p in zip(trial, loads, strict=True):
            answer = step(t.copy(), p, stiffness.copy(), **parameters)
            spoilt.append(answered.spoilt(1, partial(_parts, answer)))
            each.append({name: None if part is None else np.array(part) for name, part in _parts(answer).items()})

        def together(name: str) -> Any:
            parts = [parts.get(name) for parts in each]
            return None if any(p is None for p in parts) else np.array(parts)

        told = np.array(spoilt, dtype=object) if any(spoilt) else None
        returned = _parts(answer) if len(each) == 1 else None  # the next call may overwrite it
        return Step(**{name: together(name) for name in [*Step.__dataclass_fields__][:-2]}, overwritten=told, returned=returned)

    return named_after(update, step, "pointwise")


def from_displacements(step: Callable[..., ArrayLike]) -> Update:
    """Adapt a routine ``step(u (N, d), u_in (N, d), pressure, stiffness, **parameters) -> u_in (N, d)`` at the end of the increment.

    It is given a former slip that is not zero, u_in = the elastic displacement with its components reversed: a routine
    that forgets what has slipped before is found out.
    """

    def update(trial: Array, pressure: Array | None, stiffness: Array, **parameters: float) -> Step:
        elastic = np.linalg.solve(stiffness, trial.T).T
        before = elastic[:, ::-1].copy()
        answer = step(elastic + before, before.copy(), pressure, stiffness, **parameters)
        slip = np.asarray(answer) - before
        return Step(trial - slip @ stiffness, slip, returned={"u_in": answer})

    return named_after(update, step, "from_displacements")


def named_after(update: Update, step: Callable[..., Any], adapter: str) -> Update:
    """Return an adapted routine with the name of what it adapts, and the Python that makes it again."""
    update.__name__, update.__wrapped__ = getattr(step, "__name__", "update"), step  # type: ignore[attr-defined]
    if making := made_by(step):
        update.__duhem_import__ = f"{making}\nfrom duhem.testing import {adapter}\n\nupdate = {adapter}(update)"  # type: ignore[attr-defined]
    return update


def called(
    update: Update, values: Mapping[str, float], trial: Array, pressure: Array | None, stiffness: Array, answered: FormerAnswers
) -> Step:
    """Call a routine on copies; return its answer, with the names of the copies and former answers that it has overwritten."""
    given = trial.copy(), None if pressure is None else pressure.copy(), stiffness.copy()
    answer = update(*given, **values)
    step = _as_step(answer)
    pairs = {"trial": (given[0], trial), "pressure": (given[1], pressure), "stiffness": (given[2][None], stiffness[None])}
    said = noticed(pairs, answered, len(trial), partial(_parts, answer))
    return step if said is None else replace(step, overwritten=said)


# -- what a routine must not spoil --------------------------------------------------------------------------------------

Overwritten = NDArray[np.object_]  # (N,) names with commas, "" where nothing was


def changed(pairs: Mapping[str, tuple[NDArray[Any], NDArray[Any]]]) -> dict[str, NDArray[np.bool_]]:
    """Return which rows (N,) of arrays have changed, of pairs by name; pairs that are equal to the last bit are omitted."""
    return {name: _differs(*pair) for name, pair in pairs.items() if pair[0].tobytes() != pair[1].tobytes()}


def overwritten(found: Mapping[str, NDArray[np.bool_]]) -> Overwritten | None:
    """Return the names of what was changed at each of N increments, from (N,) by name; None where nothing was changed."""
    if not any(each.any() for each in found.values()):
        return None
    rows = np.array(list(found.values())).T
    return np.array([", ".join(name for name, bad in zip(found, row, strict=True) if bad) for row in rows], dtype=object)


def noticed(pairs: Mapping[str, tuple[Any, Any]], answered: FormerAnswers, count: int, parts: _Parts) -> Overwritten | None:
    """Return what a call for ``count`` increments has overwritten: arrays of ``pairs`` that have changed, and former answers.

    An array of one row is that of all increments; ``parts`` reads what was answered (:meth:`FormerAnswers.spoilt`).
    """
    former = answered.spoilt(count, parts)
    found = changed({name: pair for name, pair in pairs.items() if pair[1] is not None})
    found |= {former: np.ones(1, dtype=np.bool_)} if former else {}
    return overwritten({name: np.broadcast_to(rows, count) for name, rows in found.items()})


def _differs(one: NDArray[Any], other: NDArray[Any]) -> NDArray[np.bool_]:
    """Return which rows (N,) differ in an entry; two nan count as equal."""
    unlike = (one != other) & ~(np.isnan(one) & np.isnan(other))
    return np.asarray(unlike.reshape(len(one), -1).any(axis=1))


_KEPT = 4  # answers to so many increments: as many buffers may be taken by turns
_Parts: TypeAlias = Callable[[], Mapping[str, Any]]
_Answer: TypeAlias = tuple[_Parts, dict[str, bytes]]


class FormerAnswers:
    """The last answers to each number of increments, as the routine gave them, and what they said then.

    A routine that hands out one and the same buffer, as wrappers of C are prone to, changes the answers that its caller has already.
    """

    def __init__(self) -> None:
        self._kept: dict[int, deque[_Answer]] = {}
        self._last = 0

    def spoilt(self, count: int, parts: _Parts) -> str:
        """Which parts of former answers are no longer what they were, "" where none; the answer to ``count`` increments is kept.

        ``parts`` reads what was answered, by name, and reads it anew whenever it is called.
        """
        changed: dict[str, None] = {}
        for number in {count, self._last} & self._kept.keys():
            kept, same = self._kept[number], deque[_Answer](maxlen=_KEPT)
            for i, (read, said) in enumerate(kept):
                now = _said(read) if i in (0, len(kept) - 2, len(kept) - 1) else said  # each is looked at early, and once more at last
                differs = [name for name in said if said[name] != now.get(name)]
                changed |= dict.fromkeys(differs)
                if not differs:
                    same.append((read, said))
            self._kept[number] = same
        self._kept.setdefault(count, deque(maxlen=_KEPT)).append((parts, _said(parts)))
        self._last = count
        return ", ".join(f"{name} of an earlier answer" for name in changed)


def _said(parts: _Parts) -> dict[str, bytes]:
    """Return the bytes of each part of an answer; a part that is no array has none."""
    said = {}
    for name, part in parts().items():
        try:
            said[name] = b"" if part is None else np.asarray(part).tobytes()
        except (TypeError, ValueError):
            said[name] = b""
    return said


# -- where a routine and a law come from -------------------------------------------------------------------------------


@dataclass(frozen=True)
class Origin:
    """Where a replay finds what it tests: lines of Python that bind ``update``, the folder they need on the path, and the law.

    ``making`` is empty where the routine has no name that a file can import, ``law`` where the law has none.
    """

    making: str = ""
    folder: str = ""
    law: str = ""


def origin(update: Any, law: Criterion | None, given: Any) -> Origin:
    """Return the origin of a routine and of the law that it was tested with, as the law was ``given``."""
    return Origin(made_by(update), _folder(_defined(update)), "None" if law is None else law_as_written(law, given))


def made_by(update: Any) -> str:
    """Return lines of Python that bind ``update`` to the routine: its ``__duhem_import__``, or an import by name, or ''."""
    said = getattr(update, "__duhem_import__", None)
    if said is not None:
        return str(said)
    module, name = getattr(_called(update), "__module__", None), getattr(update, "__qualname__", "")
    if not module or module == "__main__" or module not in sys.modules:
        return ""
    found: Any = sys.modules[module]
    for part in name.split("."):
        found = getattr(found, part, None)
    if name and found is update:
        first, _, rest = name.partition(".")
        return f"from {module} import {first}\n\nupdate = {name}" if rest else f"from {module} import {name} as update"
    bound = (name for name, value in vars(sys.modules[module]).items() if value is update and name.isidentifier())
    return next((f"from {module} import {name} as update" for name in bound), "")


def _called(update: Any) -> Any:
    """Return the routine that a partial application calls, or the routine itself."""
    while isinstance(update, partial):
        update = update.func
    return update


def _defined(update: Any) -> Any:
    """Return the routine inside, if it is wrapped or partly applied."""
    while hasattr(inner := _called(update), "__wrapped__"):
        update = inner.__wrapped__
    return inner


def _folder(update: Any) -> str:
    """Return the folder that must be on the path to import the routine's module; '' if the module is installed."""
    module = sys.modules.get(getattr(update, "__module__", None) or "")
    file = getattr(module, "__file__", None)
    if module is None or file is None or module.__name__ == "__main__":
        return ""
    top = Path(file).resolve().parents[module.__name__.count(".") + (Path(file).name == "__init__.py")]
    installed = {Path(sysconfig.get_path(name)).resolve() for name in ("purelib", "platlib", "stdlib")}
    return "" if top in installed else str(top)


def law_as_written(law: Criterion, given: Any = None) -> str:
    """Return Python for a law: its name or file with the values it fixes, or its formula if that reads as the same law, or ''."""
    with suppress(InputError):
        if (known_by := _known_by(given)) is not None:
            return _fixed(known_by, load(known_by), law)
        if shipped(law.name) and installed(law.name) and _same(known := load_named(law.name), law):
            return _fixed(law.name, known, law)
    with suppress(InputError):
        said = law.written or formula(law.g)
        again = Criterion(name=law.name, g=said, forces=law.forces, pressure=law.pressure, parameters=law.parameters)
        if _same(again, law) and law.closed_form is None:
            domains = ", ".join(f"{name!r}: {_domain(domain)}" for name, domain in law.parameters.items())
            return f"Criterion({law.name!r}, {again.written!r}, {{{domains}}}, {law.forces!r}, {law.pressure!r})"
    return ""


def _known_by(given: Any) -> str | None:
    """Return a name, ``module:attribute`` or a whole path by which another process loads the law; None if there is none."""
    if isinstance(given, Path):
        return str(given.resolve())
    if not isinstance(given, str):
        return None
    name = given.strip().replace("_", "-")
    if not given.endswith(".toml") and (installed(name) or name in registered()):
        return given if installed(name) else None  # else this process alone knows the name
    file = file_read(given)
    return given if file is None else str(file.resolve())


def _fixed(name: str, known: Any, law: Criterion) -> str:
    """Return Python for the known law, with the parameters fixed that the other law fixes."""
    values = {n: str(d.value) for n, d in law.parameters.items() if d.value is not None and known.parameters[n].value is None}
    return f"load({name!r}).fix({values!r})" if values else repr(name)


def _domain(domain: Domain) -> str:
    if domain.positive:
        return "Domain(positive=True)"  # a case lies below a greatest value
    return f"Domain.between({', '.join('None' if end is None else repr(str(end)) for end in (domain.low, domain.high))})"


def _same(known: Any, law: Criterion) -> bool:
    same = isinstance(known, Criterion) and (known.forces, known.pressure) == (law.forces, law.pressure)
    own, other = law.parameters, known.parameters
    same = same and all(getattr(known, part) == getattr(law, part) for part in ("variables", "unforced", "rates", "energy", "flow"))
    return same and str(known.g) == str(law.g) and {*own} == {*other} and all(other[n].value in (None, own[n].value) for n in own)


def named(update: Any) -> str:
    """Return the module and the name of a routine, or of the routine inside if it is wrapped."""
    update = _defined(update)
    name = getattr(update, "__qualname__", type(update).__qualname__)
    return f"{getattr(update, '__module__', '')}.{name}"


# -- a routine that carries a state ------------------------------------------------------------------------------------

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
