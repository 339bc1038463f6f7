"""Who is measured, on which law: the methods that apply, other programs if asked for, and why the others are left out."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from importlib.util import find_spec
from typing import Any

from duhem.benchmark.peers import PEERS, PeerOptions
from duhem.benchmark.specimen import Specimen
from duhem.left_out import LeftOut
from duhem.projection import conic_solvers
from duhem.projection.increment import Increment
from duhem.projection.method import Method, Options
from duhem.projection.methods import METHODS
from duhem.projection.projector import Projector
from duhem.projection.result import Array, Projection, Solution

__all__ = ["Contender", "applicable"]

Tolerances = Sequence[float | None]


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
        return any(self.method.name == peer.name for peer in PEERS)


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
        if (reason := peer.missing or peer.load().applies(question)) is not None:
            left_out.append(LeftOut(peer.name, reason))
        else:
            found.append(Contender(peer.name, peer.load(), PeerOptions()))
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
