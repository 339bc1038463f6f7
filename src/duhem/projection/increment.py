"""The question of one slip increment, checked: trial stresses, pressures, stiffness and parameter values that fit the law."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import sympy as sp

from duhem.expression.inert_number import inert_exponent
from duhem.expression.verbatim import Verbatim
from duhem.law.formula_law import Criterion
from duhem.projection.result import Array

__all__ = ["Increment", "at_doubles"]


@dataclass(frozen=True)
class Increment(Verbatim):
    """N validated increments of one law.

    ``g``: the criterion with parameter values in place, over the force symbols and the pressure symbol.
    ``trial`` (N, d) in Pa; ``pressure`` (N,) sigma_n <= 0 in Pa (zeros for a law without pressure);
    ``stiffness`` (d, d) symmetric positive definite in Pa/m, ``diagonal`` whether it is diagonal;
    ``parameters`` every parameter of the law by name, as floats.
    """

    law: Criterion
    g: sp.Expr
    trial: Array
    pressure: Array
    stiffness: Array
    diagonal: bool
    parameters: Mapping[str, float]


def at_doubles(law: Criterion, parameters: Mapping[str, float]) -> sp.Expr:
    """The criterion with these numbers, taken exactly: as the methods read it, and not as it was written in decimals."""
    symbols = law.symbols()
    exponents = {x for power in law.g.atoms(sp.Pow) for x in power.exp.free_symbols}
    values = {symbols[name]: sp.Rational(value) for name, value in parameters.items()}
    return law.g.xreplace({x: inert_exponent(value) if x in exponents else value for x, value in values.items()})
