"""What is measured, one law with numbers in place at one stiffness; and who is: the methods that apply, or why they are left out."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from importlib.util import find_spec
from typing import Any

import numpy as np

from duhem.benchmark.peers import PEERS, PeerOptions
from duhem.benchmark.reference import Closest
from duhem.expression.rays import exits
from duhem.law.domain import Domain
from duhem.law.formula_law import Criterion
from duhem.law.parameter_domain import check_fixed
from duhem.law.state import check_stateless
from duhem.omitted import LeftOut
from duhem.projection import conic_solvers
from duhem.projection.increment import Increment, increment
from duhem.projection.method import Method, Options
from duhem.projection.methods import METHODS
from duhem.projection.projector import Projector
from duhem.projection.result import Array, Projection, Solution

__all__ = ["Contender", "Specimen", "applicable"]

Tolerances = Sequence[float | None]

_RADII = np.ldexp(1.0, np.arange(-1070, 1021))


@dataclass(frozen=True)
class Contender:
    """One way to the closest point: a method with its options, under the name it has in tables."""

    name: str
    method: Method[Any]
    options: Options

    @classmethod
    def of(cls, name: str, method: str, **options: Any) -> Contender:
        """One of duhem's own methods."""
        found = METHODS[method]()
        return cls(name, found, found.options_of(options))

    def solve(self, question: Increment) -> Solution:
        """The method's answer to a checked question, unjudged."""
        return self.method.solve(question, self.options)

    def again(self, question: Increment, into: Solution) -> Solution:
        """The same into the arrays of an earlier solution of as many points; InputError for a method that cannot."""
        return self.method.solve(question, self.method.options_of({**vars(self.options), "into": into}))

    def project(self, specimen: Specimen, trial: Array, pressure: Any, stiffness: Array | None = None) -> Projection:
        """The increment with statuses and residuals, as users get it."""
        k = specimen.stiffness if stiffness is None else stiffness
        return Projector.of(specimen.law, k, method=self.method)(trial, pressure, **vars(self.options))

    @property
    def peer(self) -> bool:
        """Whether it is another program."""
        return any(self.method is peer.method for peer in PEERS)


def applicable(question: Increment, tolerances: Tolerances = (None,), peers: bool = False) -> tuple[list[Contender], list[LeftOut]]:
    """Every method that applies to the law, the conic solvers once for each tolerance (None: the tightest that is met).

    ``peers``: other programs too, as they come.
    """
    found, left_out = list[Contender](), list[LeftOut]()
    for name, imported in METHODS.items():
        if (reason := imported().applies(question)) is not None:
            left_out.append(LeftOut(name, reason))
            continue
        for entry in _VARIANTS[name](question, tolerances) if name in _VARIANTS else (Contender.of(name, name),):
            if isinstance(entry, Contender):
                found.append(entry)
            else:
                left_out.append(entry)
    for peer in PEERS if peers else ():
        if (reason := peer.missing or peer.method.applies(question)) is not None:
            left_out.append(LeftOut(peer.method.name, reason))
        else:
            found.append(Contender(peer.method.name, peer.method, PeerOptions()))
    return found, left_out


def _closed_form(question: Increment, _: Tolerances) -> Iterator[Contender | LeftOut]:
    """The closed form in NumPy, and compiled."""
    yield Contender.of("closed-form", "closed-form", compiled=False)
    if question.trial.shape[1] == 2:
        yield _compiled("closed-form")


def _newton(question: Increment, _: Tolerances) -> Iterator[Contender | LeftOut]:
    """Newton's method in NumPy, and the loop that is compiled for the law."""
    yield Contender.of("newton", "newton", compiled=False)
    if METHODS["closed-form"]().applies(question) is None:
        yield LeftOut("newton, numba", "the law has a closed form")
    else:
        yield _compiled("newton")


def _compiled(name: str) -> Contender | LeftOut:
    if find_spec("numba") is None:
        return LeftOut(f"{name}, numba", 'numba is not installed, pip install "duhem[fast]"')
    return Contender.of(f"{name}, numba", name, compiled=True)


def _conic(_: Increment, tolerances: Tolerances) -> Iterator[Contender | LeftOut]:
    """Each conic solver at each tolerance."""
    installed = conic_solvers.installed()
    for solver in conic_solvers.KNOWN:
        if solver not in installed:
            yield LeftOut(f"cvxpy {solver}", f"not installed, pip install {solver.lower()}")
            continue
        for tolerance in tolerances:
            yield Contender.of(f"cvxpy {solver}", "cvxpy", solver=solver, tolerance=tolerance)
    for solver in installed:
        if solver not in conic_solvers.KNOWN:
            yield LeftOut(f"cvxpy {solver}", "no solver of second-order cones known to duhem")


# Methods that are measured in several ways; any other is measured once, as it comes.
_VARIANTS: Mapping[str, Callable[[Increment, Tolerances], Iterator[Contender | LeftOut]]] = {
    "closed-form": _closed_form,
    "newton": _newton,
    "cvxpy": _conic,
}


@dataclass(frozen=True)
class Specimen:
    """A law with numbers in place and the stiffness (d, d) in Pa/m it is measured at.

    ``law`` has its parameters at the doubles that the methods read, taken exactly; ``declared`` as they were given.
    """

    declared: Criterion
    law: Criterion
    stiffness: Array

    @classmethod
    def of(cls, law: Criterion, stiffness: Sequence[float] | None = None) -> Specimen:
        """``law`` with every parameter at a double, taken exactly, as the methods will read it; k = diag(1, 2, ...) if left out.

        Raises InputError for a parameter without value and for a law whose increments are more than closest points of K.
        """
        check_stateless(law, "a benchmark of single increments")
        check_fixed(law)
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
        others = {} if self.law.pressure is None or pressure is None else {self.law.symbols()[self.law.pressure]: pressure}
        (last,), (first,) = exits(question.g, self.law.force_symbols(), direction[None], _RADII, others)
        return 0.0 if last < _RADII[0] else float("inf") if last == first else float(last)

    def width(self) -> float:
        """How far K reaches along the axes, either way: the median of where it ends, 1 where it does nowhere."""
        axes = np.eye(len(self.law.forces))
        reach = [self.radius(way, self.pressure) for axis in axes for way in (axis, -axis)]
        return float(np.median([r for r in reach if 0.0 < r < 1e300] or [1.0]))

    def describe(self) -> str:
        """The law's parameters and the stiffness in words."""
        values = ", ".join(f"{name} = {float(domain.value):g}" for name, domain in self.law.parameters.items() if domain.value is not None)
        k = ", ".join(f"{x:g}" for x in np.diagonal(self.stiffness))
        return f"{values + '; ' if values else ''}stiffness {k}"
