"""The ways along a loading path that there are, by name."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from types import MappingProxyType

from duhem.path import exact, extrapolated, implicit
from duhem.path.exact import Piece
from duhem.path.ledger import Ledger
from duhem.path.run import Plan

__all__ = ["INTEGRATORS", "Integrator"]


@dataclass(frozen=True)
class Integrator:
    """One way along a path, as a value.

    ``why(plan)`` says what the path is integrated by; ``advance(plan, ledger)`` fills the ledger row by row and yields
    the number of rows done.  ``piece(plan)`` moves the stress within a step, for what lies between two knots; None where
    the knots are all that is known.
    """

    why: Callable[[Plan], str]
    advance: Callable[[Plan, Ledger], Iterator[int]]
    piece: Callable[[Plan], Piece] | None = None


INTEGRATORS: Mapping[str, Integrator] = MappingProxyType(
    {
        "implicit": Integrator(implicit.why, implicit.advance),
        "extrapolated": Integrator(extrapolated.why, extrapolated.advance),
        "exact": Integrator(exact.why, exact.advance, exact.piece),
    }
)
