"""The routine under test: what it is given, may answer and must not spoil, and adapters for other shapes of routine.

Its origin, and that of a law, is the Python by which another file has them again, where they have names that it can import.
"""

from __future__ import annotations

import sys
import sysconfig
from collections import deque
from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import partial
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
    "FormerAnswers",
    "NoStep",
    "Origin",
    "Overwritten",
    "Step",
    "Unfinished",
    "Update",
    "called",
    "changed",
    "from_displacements",
    "law_as_written",
    "named",
    "named_after",
    "noticed",
    "origin",
    "overwritten",
    "pointwise",
]


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
