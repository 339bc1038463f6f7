"""Who is measured, on which law, on what machine: the methods that apply, and why the others are left out."""

from __future__ import annotations

import os
import platform
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import partial
from importlib import import_module
from importlib.metadata import PackageNotFoundError, version
from importlib.util import find_spec
from typing import Any, cast

import numpy as np

from duhem.benchmark.reference import Closest
from duhem.errors import InputError
from duhem.expression.numpy_ import compiled
from duhem.expression.rays import Rays
from duhem.law.formula_law import Criterion, Domain
from duhem.left_out import LeftOut
from duhem.projection.increment import Increment
from duhem.projection.project import METHODS, project
from duhem.projection.result import Array, Projection, Solution
from duhem.projection.validation import increment

__all__ = ["Contender", "Subject", "contenders", "machine"]

CONIC_SOLVERS = ("CLARABEL", "CVXOPT", "ECOS", "OSQP", "QOCO", "SCS")
_RADII = np.ldexp(1.0, np.arange(-1070, 1021))
_PACKAGES = ("numpy", "scipy", "sympy", "mpmath", "cvxpy", "clarabel", "numba", "cvxopt", "ecos", "osqp", "qoco", "scs")


@dataclass(frozen=True)
class Subject:
    """A law with numbers in place and the stiffness (d, d) in Pa/m it is measured at.

    ``law`` has its parameters at the doubles that the methods read, taken exactly; ``declared`` as they were given.
    """

    declared: Criterion
    law: Criterion
    stiffness: Array

    @classmethod
    def of(cls, law: Criterion, stiffness: Sequence[float] | None = None) -> Subject:
        """``law`` with every parameter at a double, taken exactly, as the methods will read it; k = diag(1, 2, ...) if left out.

        Raises InputError for a parameter without value and for a law with a flow of its own.
        """
        if missing := [name for name, domain in law.parameters.items() if domain.value is None]:
            remedy = f"give {' '.join(f'--set {name}=VALUE' for name in missing)}"
            raise InputError(f"no value is given for {', '.join(missing)}", where=law.name, remedy=remedy)
        d = len(law.forces)
        k = np.diag(np.arange(1.0, d + 1) if stiffness is None else np.asarray(stiffness, dtype=np.float64))
        trial = np.zeros((1, d))
        asked = increment(law, trial, None if law.pressure is None else -1.0, k, None)
        exact = {name: Domain.fixed(Fraction(value)) for name, value in asked.parameters.items()}
        return cls(law, replace(law, parameters=exact), k)  # same signs, so the symbols stay

    @property
    def pressure(self) -> float | None:
        """The pressure sigma_n = -1 of the plain cases, in the unit of the parameters; None for a law without."""
        return None if self.law.pressure is None else -1.0

    def question(self, trial: Array, pressure: Array | float | None, stiffness: Array | None = None) -> Increment:
        """The checked increments."""
        return increment(self.law, trial, pressure, self.stiffness if stiffness is None else stiffness, None)

    def reference(self, stiffness: Array | None = None, digits: int = 50) -> Closest:
        """The closest point in many digits."""
        question = self.question(np.zeros((1, len(self.law.forces))), self.pressure, stiffness)
        symbol = None if self.law.pressure is None else self.law.symbols()[self.law.pressure]
        return Closest(question.g, self.law.force_symbols(), symbol, question.stiffness.tolist(), digits)

    def radius(self, direction: Array, pressure: float | None) -> float:
        """How far K reaches along ``direction`` from the origin, in doubles; 0 where the origin is outside, inf where it never ends."""
        question = self.question(np.zeros((1, len(self.law.forces))), self.pressure)
        names = [*self.law.force_symbols(), *([] if pressure is None else [self.law.symbols()[self.law.pressure or ""]])]
        g = compiled(question.g, names)

        def level(points: Array) -> Array:
            return g(*np.moveaxis(points, -1, 0), *([] if pressure is None else [pressure]))

        (last,), (first,) = Rays(level, np.zeros(len(direction)), direction[None]).left(_RADII)
        return 0.0 if last < _RADII[0] else float("inf") if last == first else float(last)

    def describe(self) -> str:
        """The law's parameters and the stiffness in words."""
        values = ", ".join(f"{name} = {float(domain.value):g}" for name, domain in self.law.parameters.items() if domain.value is not None)
        k = ", ".join(f"{x:g}" for x in np.diagonal(self.stiffness))
        return f"{values + '; ' if values else ''}stiffness {k}"


@dataclass(frozen=True)
class Contender:
    """One way to the closest point: ``solve`` from a checked question, unjudged; ``method`` and ``options`` as duhem.project takes them."""

    name: str
    method: str
    solve: Callable[[Increment], Solution]
    options: Mapping[str, Any]

    @classmethod
    def of(cls, name: str, method: str, **options: Any) -> Contender:
        """One of duhem's own methods."""
        return cls(name, method, partial(import_module(f"duhem.projection.{METHODS[method]}").solve, **options), options)

    def again(self, question: Increment, into: Solution) -> Solution:
        """The same into the arrays of an earlier solution of as many points; TypeError for a method that cannot."""
        return cast(Solution, import_module(f"duhem.projection.{METHODS[self.method]}").solve(question, into=into, **self.options))

    def project(self, subject: Subject, trial: Array, pressure: Any, stiffness: Array | None = None) -> Projection:
        """The increment with statuses and residuals, as users get it."""
        k = subject.stiffness if stiffness is None else stiffness
        return project(subject.law, trial, pressure, k, method=self.method, **self.options)


def contenders(question: Increment, tolerances: Sequence[float | None] = (None,)) -> tuple[list[Contender], list[LeftOut]]:
    """Every method that applies to the law, the conic solvers once for each tolerance (None: the tightest that is met)."""
    found, left_out = list[Contender](), list[LeftOut]()
    reasons = {name: import_module(f"duhem.projection.{module}").applies(question) for name, module in METHODS.items()}
    if reasons["closed-form"] is None:
        found.append(Contender.of("closed-form", "closed-form"))
        if find_spec("numba") is None:
            left_out.append(LeftOut("closed-form, numba", 'numba is not installed, pip install "duhem[fast]"'))
        elif question.trial.shape[1] == 2:
            found.append(Contender.of("closed-form, numba", "closed-form", compiled=True))
    else:
        left_out.append(LeftOut("closed-form", reasons["closed-form"]))
    found.append(Contender.of("newton", "newton"))
    if reasons["cvxpy"] is not None:
        left_out.append(LeftOut("cvxpy", reasons["cvxpy"]))
        return found, left_out
    installed: list[str] = import_module("cvxpy").installed_solvers()
    for solver in CONIC_SOLVERS:
        if solver not in installed:
            left_out.append(LeftOut(f"cvxpy {solver}", f"not installed, pip install {solver.lower()}"))
            continue
        for tolerance in tolerances:
            options = {"solver": solver} | ({} if tolerance is None else {"tolerance": tolerance})
            found.append(Contender.of(f"cvxpy {solver}", "cvxpy", **options))
    left_out += [LeftOut(f"cvxpy {s}", "no solver of second-order cones known to duhem") for s in installed if s not in CONIC_SOLVERS]
    return found, left_out


def machine() -> dict[str, Any]:
    """What the numbers were taken on: processor, system, versions."""
    usable = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()
    return {
        "processor": _processor(),
        "processors_usable": usable,
        "system": f"{platform.system()} {platform.release()} {platform.machine()}",
        "python": platform.python_version(),
        "versions": {name: found for name in _PACKAGES if (found := _version(name)) is not None},
    }


def _processor() -> str:
    try:
        with open("/proc/cpuinfo", encoding="utf-8") as stream:
            for line in stream:
                if line.startswith("model name"):
                    return line.partition(":")[2].strip()
    except OSError:
        pass
    return platform.processor() or platform.machine()


def _version(name: str) -> str | None:
    for candidate in (name, f"{name}-base"):
        try:
            return version(candidate)
        except PackageNotFoundError:
            continue
    return None
