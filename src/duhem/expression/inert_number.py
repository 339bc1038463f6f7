"""Exponents that SymPy leaves alone."""

from __future__ import annotations

from typing import Any
from weakref import WeakValueDictionary

import sympy as sp

__all__ = ["MOST_ROOT", "InertNumber", "inert_exponent", "plain_exponent"]

# 0.3**3.0012 has SymPy write out 3**30012; up to this denominator the integers stay small and the algebra is worth having.
MOST_ROOT = 12


class InertNumber(sp.NumberSymbol):
    """The rational ``value`` as a number that is never combined with others, as pi is; every interpreter reads the value."""

    is_real = True
    is_rational = True
    is_irrational = False
    is_integer = False
    is_algebraic = True
    is_transcendental = False

    value: sp.Rational

    def __new__(cls, value: sp.Rational) -> InertNumber:
        """One object for each value as long as anybody has it: SymPy compares such numbers by identity."""
        if (found := _living.get(value)) is None:
            _living[value] = found = sp.AtomicExpr.__new__(cls)
            found.value = value
        return found

    def _eval_is_positive(self) -> bool:
        return bool(self.value > 0)

    def _eval_is_negative(self) -> bool:
        return bool(self.value < 0)

    def _eval_is_zero(self) -> bool:
        return False

    def _hashable_content(self) -> tuple[Any, ...]:
        return (self.value,)

    def _as_mpf_val(self, prec: int) -> Any:
        return self.value._as_mpf_val(prec)

    def approximation_interval(self, number_cls: Any) -> tuple[Any, Any]:
        return (self.value, self.value)

    def _sympystr(self, printer: Any) -> str:
        return str(printer._print(self.value))

    def _latex(self, printer: Any) -> str:
        return str(printer._print(self.value))

    def __getnewargs__(self) -> tuple[sp.Rational]:
        return (self.value,)


_living: WeakValueDictionary[sp.Rational, InertNumber] = WeakValueDictionary()


def inert_exponent(value: Any) -> Any:
    """A rational with a long denominator as :class:`InertNumber`; anything else as it is."""
    return InertNumber(value) if isinstance(value, sp.Rational) and value.q > MOST_ROOT else value


def plain_exponent(exponent: sp.Expr) -> sp.Expr:
    """An exponent with the rationals that its inert numbers stand for, to reckon with."""
    return exponent.xreplace({x: x.value for x in exponent.atoms(InertNumber)})
