"""What a way to the closest point is: when it applies, its solution, its tangent and the options it takes."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields, replace
from difflib import get_close_matches
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any, Generic, Self, TypeVar

from duhem.errors import InputError

if TYPE_CHECKING:
    from duhem.projection.increment import Increment
    from duhem.projection.result import Array, Solution

__all__ = ["WORTH_COMPILING", "ClosestPoint", "Compiling", "Method", "Options"]


@dataclass(frozen=True)
class Options:
    """What a caller may set; a method that takes options has its own, each with its type and what holds where it is left out."""


@dataclass(frozen=True)
class Compiling(Options):
    """Those of a method that can be compiled, by numba: ``compiled``, and on how many ``threads``.

    ``compiled`` left out: from 100,000 points on, where numba is installed.  Whether it is done never depends on what is already on
    disk.  ``threads`` left out: all there are where it is compiled, else one; NumPy's passes are so short that two threads mostly wait
    for each other.  What is returned does not depend on their number.  Residuals and statuses of more than 4 points are compiled
    with it, unless the law has ranges of its forces.  The first increment of a law waits for the compiler, some 3 to 15 seconds, and a
    warning of the logger ``duhem`` says so; then the code is kept on disk (DUHEM_CACHE_DIR, else the user's folder for such things), and
    the next process loads it.  A missing numba raises MissingExtraError.
    """

    compiled: bool | None = None
    threads: int | None = None

    def __post_init__(self) -> None:
        if self.threads is not None and not (isinstance(self.threads, int) and self.threads >= 1):
            raise InputError(f"threads is {self.threads!r}", where="threads", remedy="give a whole number >= 1, or remove it")

    def decided(self, points: int) -> Self:
        """With ``compiled`` said for so many points, where it was left out."""
        return self if self.compiled is not None else replace(self, compiled=points >= WORTH_COMPILING and find_spec("numba") is not None)

    @property
    def sharing(self) -> int | None:
        """How many threads are to share the work, None for all there are."""
        return self.threads if self.compiled else self.threads or 1


WORTH_COMPILING = 100_000  # points: some fifty calls save what the compiler takes by Newton's method, a thousand by the closed form

Own = TypeVar("Own", bound=Options)

ClosestPoint = Callable[[Any, Any], tuple[Any, Any, Any] | None]
"""Stress, slip and multiplier of one point from its trial stress and pressure; None where many points are to be asked.

Run by Python it takes and returns lists of numbers and numbers.  Compiled it takes and returns arrays of one point, (1, d) and (1,);
those that it takes must not be writable.
"""


@dataclass(frozen=True)
class Method(Generic[Own]):
    """One way to the closest point, as a value.

    ``applies(question)`` is None where the method can be used, else the reason why not, with the remedy.
    ``solve(question, options)`` returns the solution as the method left it, unjudged; ``tangent(question, solution)``
    d sigma/d u (N, d, d) in Pa/m and d sigma/d sigma_n (N, d), None for a law without pressure; no tangent at all is None.
    ``options`` is the type of the options.  ``convex``: where the method can be used K is convex, by a declared shape or by rules
    of composition; else the judge looks for points of K that speak against it.  ``again(options, points)`` is the way to ask
    where the judge refuses what ``solve`` found of so many points.  ``plain(question, compiled)`` is the closest point to one trial,
    sooner than ``solve`` for one point, run by Python on plain numbers or compiled; None where there is none.  It belongs to the
    ``solve`` beside it, in one module: a method that was given another ``solve`` is asked by that alone.
    """

    name: str
    applies: Callable[[Increment], str | None]
    solve: Callable[[Increment, Own], Solution]
    options: type[Own]
    tangent: Callable[[Increment, Solution], tuple[Array, Array | None]] | None = None
    convex: bool = False
    again: Callable[[Own, int], Callable[[Increment, Own], Solution]] | None = None
    plain: Callable[[Increment, bool], ClosestPoint | None] | None = None

    @property
    def has_its_own_solve(self) -> bool:
        """Whether there is a ``plain``, and ``solve`` is the one it belongs to: no other was put in its place."""
        return self.plain is not None and self.plain.__module__ == self.solve.__module__

    def options_of(self, given: Mapping[str, Any]) -> Own:
        """Options by name; InputError for one that the method does not have, naming those it has."""
        known = [field.name for field in fields(self.options)]
        if strange := [name for name in given if name not in known]:
            near = get_close_matches(strange[0], known, n=1)
            meant = f"did you mean {near[0]!r}? " if near else ""
            remedy = f"{meant}its options are {', '.join(known)}" if known else "remove it: this method has no options"
            raise InputError(f"method {self.name} has no option {strange[0]!r}", where=strange[0], remedy=remedy)
        return self.options(**given)
