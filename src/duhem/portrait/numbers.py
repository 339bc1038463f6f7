"""A number for each parameter of a law: those given, those it fixes, and for what is left open a plain one inside its domain."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import sympy as sp

from duhem.errors import InputError
from duhem.law.curve_law import Law
from duhem.law.parameter_domain import check_domain
from duhem.proof.certificate import admitted_values

__all__ = ["Numbered", "numbered"]


@dataclass(frozen=True)
class Numbered:
    """A law with every parameter fixed, and the names of those that nobody gave: they are ``chosen`` to have something to draw."""

    law: Law
    chosen: tuple[str, ...] = ()

    def values(self) -> dict[str, sp.Rational]:
        """The numbers by name."""
        return {name: domain.value for name, domain in self.law.parameters.items() if domain.value is not None}

    @property
    def size(self) -> float:
        """The greatest of 1 and the parameters: where a boundary is looked for there are stresses of this order."""
        return max([1.0, *(abs(float(value)) for value in self.values().values() if np.isfinite(float(value)))])


def numbered(law: Law, given: Mapping[str, Any] | None = None) -> Numbered:
    """The law at the numbers ``given`` and plain ones for the others.

    InputError for a number outside its domain, and where none is found for what is left open.
    """
    fixed = law.fix(given)
    check_domain(fixed)
    left = tuple(name for name, domain in fixed.parameters.items() if domain.value is None)
    if (found := admitted_values(fixed)) is None:
        raise InputError(f"no numbers for {', '.join(left)} are found by themselves", where=law.name, remedy="give each of them")
    return Numbered(fixed.fix({name: found[name] for name in left}), left)
