"""Whether K is convex, asked once for a law and its numbers, within a small budget of steps.

Projection finds a stationary point; on a convex K that is the closest one, and nothing that is seen at the point itself
tells.  The claim ``convexity`` is put to the prover for the law over its whole domain, which answers for all
numbers at once, and where that shows nothing for the numbers given, decimals taken exactly.  It speaks of sigma_n < 0: K at
sigma_n = 0 is a question of its own.  No number waits for long: each time the prover has so many steps for all that it does, and what is
open then is kept as such.  Steps are counted, not seconds, so that the answer is the same on every machine, busy or idle.
"""

from __future__ import annotations

import hashlib
import os
import sys
from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
from dataclasses import fields, is_dataclass, replace
from functools import cache, lru_cache
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
import sympy as sp

from duhem.errors import DuhemError, InputError
from duhem.law.convex import check_convex
from duhem.law.domain import Domain, by_name
from duhem.law.formula_law import Criterion
from duhem.projection import file_cache
from duhem.projection.code_cache import kept_folder
from duhem.projection.increment import Convexity

__all__ = ["ANSWERS", "asked", "keep", "place", "recalled"]

Ranges = tuple[tuple[str, Domain], ...]

_STEPS = 750_000  # of the prover: for the whole domain two thirds of them, for the numbers the third; about two seconds at most
_REMEDY = (
    'take numbers for which it is shown, convex="assume" where duhem verify proves it in more steps, '
    'or convex="ask" and heed what is said of stationary points'
)


def asked(law: Criterion, parameters: Mapping[str, Any] | None, convex: str, *, unloaded: bool) -> Convexity | None:
    """What is shown of K with these numbers, which fit the law; None where ``convex`` is ``assume``, and nobody is asked.

    Where a parameter is many numbers, it is shown for the whole range of them.  ``unloaded``: sigma_n = 0 occurs, and is asked
    about too.  Where ``convex`` is ``require`` an InputError says what is not shown.
    """
    check_convex(convex)
    if convex == "assume":
        return None
    ranges = tuple((name, _range(value)) for name, value in by_name(parameters).items())
    at_rest = unloaded and law.pressure is not None
    found, verdict = _known(law, ranges, at_rest)
    if convex == "require" and not (found.loaded and (found.unloaded or not at_rest)):
        where = f" at {law.pressure} = 0" if found.loaded else ""
        what = f"that K of {law.name} is convex{where} is {'refuted' if verdict == 'refuted' else 'not shown'}"
        raise InputError(what, where="convex", remedy=_REMEDY)
    return found


def _range(value: Any) -> Domain:
    """From the least to the greatest number, each taken exactly."""
    ends = (np.min(value), np.max(value)) if np.ndim(value) else (value, value)
    return Domain.between(*ends)


@lru_cache(maxsize=1024)
def _known(law: Criterion, ranges: Ranges, unloaded: bool) -> tuple[Convexity, str]:
    """What is shown of K, and the verdict on the part that is not."""
    loaded = _holds(law, ranges, lambda one: one)
    bare = _holds(law, ranges, _unloaded) if unloaded else ""
    return Convexity(loaded == "proved", unloaded=bare == "proved"), bare if loaded == "proved" else loaded


def _holds(law: Criterion, ranges: Ranges, of: Callable[[Criterion], Criterion | None]) -> str:
    """The verdict for all numbers in the law's domain, if it is a proof, or else for those in the ``ranges``."""
    for_numbers = _STEPS // 3
    if (found := _verdict(of(law), _STEPS - for_numbers)) == "proved" or not ranges:
        return found
    return _verdict(of(replace(law.within(dict(ranges)))), for_numbers)  # a copy, which knows of no whole: that was asked already


@lru_cache(maxsize=1024)
def _verdict(law: Criterion | None, steps: int) -> str:
    """The answer for every number that the law leaves open: ``proved``, ``refuted`` or, within so many steps, ``open``; it is kept."""
    if law is None:
        return "open"
    try:
        law = _everywhere(law)
    except DuhemError:  # no numbers at all
        return "open"
    path = place(law, f"convexity within {steps} steps")
    if path is not None and (known := recalled(path)):
        return known
    from duhem.proof.verification import verdict_within

    try:
        found = verdict_within(law, "convexity", steps).value
    except DuhemError:  # undefined somewhere
        found = "open"
    answer = found if found in ANSWERS else "open"
    if path is not None:
        keep(path, answer)
    return answer


def _everywhere(law: Criterion) -> Criterion:
    """The law without its ranges of forces: a K that is convex within them may come nearer to a trial stress beyond."""
    return replace(law, domain={name: own for name, own in law.domain.items() if name == law.pressure})


def _unloaded(law: Criterion) -> Criterion | None:
    """The law at sigma_n = 0, over its forces alone; None where its formula has no meaning there."""
    assert law.pressure is not None
    g = law.g.xreplace({law.symbols()[law.pressure]: sp.S.Zero})
    if g.has(sp.nan, sp.zoo, sp.oo, -sp.oo):
        return None
    try:
        return Criterion(
            law.name,
            g,
            law.parameters,
            forces=law.forces,
            pressure=None,
            constraints=law.constraints,
            written_constraints=law.written_constraints,
        )
    except InputError:  # no force is left in it
        return None


# -- answers kept on disk: the next process reads whether K is shown to be convex without loading what proves it --------
# What is open is kept too: it is so within the steps that the question names, and asked again it would be.  An answer is found by the whole
# law and everything that had a part in it: the question, the text of duhem by its files' sizes and times, as Python finds its bytecode, and
# the packages that decide.

ANSWERS = "proved", "refuted", "open"

_MOST = 4_000  # files: of a law that is convex for some numbers alone there is a question each time
_DECIDE = "sympy", "mpmath", "flint", "z3", "numpy"


def place(law: Criterion, question: str) -> Path | None:
    """Where the answer to a ``question`` about the law is kept; None where there is no telling what it rests on."""
    try:
        digest = hashlib.sha256("\n".join([*_made_with(), question, *_told(law)]).encode()).hexdigest()
        return kept_folder() / "verdicts" / digest[:40]
    except (LookupError, OSError, ValueError, RuntimeError):  # a value of another kind, no file, no folder of the user's own
        return None


def recalled(path: Path) -> str | None:
    """The answer that is kept there; None where there is none, or not a whole one."""
    content = file_cache.read(path)
    return next((answer for answer in ANSWERS if content == answer.encode()), None)


def keep(path: Path, answer: str) -> None:
    """Write the answer down; where there are many, the older half of them makes room."""
    with suppress(OSError):
        path.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
        file_cache.written(path, answer.encode())
        if len(os.listdir(path.parent)) > _MOST:
            for old in sorted(path.parent.iterdir(), key=lambda one: one.stat().st_mtime_ns)[: _MOST // 2]:
                old.unlink(missing_ok=True)


def _told(value: Any) -> Iterator[str]:
    """A value in words that tell it from every other.  LookupError for a kind that is not known here."""
    if isinstance(value, sp.Basic):
        yield sp.srepr(value)
    elif value is None or isinstance(value, (str, int)):
        yield repr(value)
    elif isinstance(value, tuple):
        yield f"tuple of {len(value)}"
        for each in value:
            yield from _told(each)
    elif isinstance(value, Mapping):
        yield f"mapping of {len(value)}"
        for item in value.items():
            yield from _told(item)
    elif is_dataclass(value) and type(value).__module__.startswith("duhem."):
        yield f"{type(value).__module__}.{type(value).__qualname__}"
        for field in fields(value):
            if field.init:  # what else it knows is made of these
                yield from _told(getattr(value, field.name))
    else:
        raise LookupError(type(value))


@cache
def _made_with() -> tuple[str, ...]:
    """What a proof rests on: Python, duhem's text and the packages that decide."""
    own = Path(__file__).parents[1]
    told = [sys.version, sp.__version__, *sorted(f"{k}={v}" for k, v in os.environ.items() if k.startswith("SYMPY_"))]
    for folder, below, names in os.walk(own):
        below.sort()
        told += [_file(Path(folder, name)) for name in sorted(names) if name.endswith(".py")]
    for name in _DECIDE:
        found = find_spec(name)
        told.append(name if found is None or found.origin is None else _file(Path(found.origin)))
    return tuple(told)


def _file(path: Path) -> str:
    seen = path.stat()
    return f"{path} {seen.st_size} {seen.st_mtime_ns}"
