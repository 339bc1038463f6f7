"""The question of one slip increment, checked: trial stresses, pressures, stiffness and parameter values that fit the law."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from duhem.expression.inert_number import inert_exponent
from duhem.expression.verbatim import Verbatim
from duhem.law.formula_law import Criterion
from duhem.projection.result import Array

__all__ = ["Convexity", "Increment", "at_doubles"]


@dataclass(frozen=True)
class Convexity:
    """Whether K is shown to be convex: ``loaded`` under every pressure sigma_n < 0, or for a law without one, ``unloaded`` at sigma_n = 0.

    False where it is refuted or open.  It is found elsewhere (:mod:`duhem.vouched`): the closest point rests on no proof.
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
