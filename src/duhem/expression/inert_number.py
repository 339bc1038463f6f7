"""Exponents that SymPy leaves alone."""

from __future__ import annotations

from typing import Any
from weakref import WeakValueDictionary

import sympy as sp
from sympy.printing.precedence import precedence

__all__ = ["MOST_ROOT", "InertNumber", "inert_exponent", "plain_exponent", "reckoned"]

# 0.3**3.0012 has SymPy write out 3**30012; up to this denominator the integers stay small and the algebra is worth having.
MOST_ROOT = 12
_MOST_PASSES = 8


class InertNumber(sp.NumberSymbol):
    """The rational ``value`` as a number that is never combined with others, as pi is; every interpreter reads the value."""

    is_real = True
    is_zero = False
    is_rational = None
    is_irrational = None
    is_integer = False
    is_algebraic = None
    is_transcendental = None

    value: sp.Rational

    def __new__(cls, value: sp.Rational) -> InertNumber:
        """One object for each value as long as anybody has it: SymPy compares such numbers by identity."""
        if (found := _living.get(value)) is None:
            _living[value] = found = sp.AtomicExpr.__new__(cls)
            found.value = value
        return found

    def _eval_is_positive(self) -> bool:
        return bool(self.value > 0)

    def _hashable_content(self) -> tuple[Any, ...]:
        return (self.value,)

    def _as_mpf_val(self, prec: int) -> Any:
        return self.value._as_mpf_val(prec)

    def approximation_interval(self, number_cls: Any) -> tuple[Any, Any]:
        return (self.value, self.value)

    @property
    def precedence(self) -> int:
        """How closely its text holds together, by which SymPy's printers set brackets: 13/20 is a quotient, -3 has a sign."""
        return int(precedence(self.value))

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


def reckoned(expr: Any) -> Any:
    """The expression with inert numbers as whole exponents alone, as :func:`duhem.expression.parse.parse_expression` has them.

    A derivative brings an exponent down to the factors, and a product adds exponents up: ``101/100/(-1 + 101/100)`` is 101.
    """
    for _ in range(_MOST_PASSES):
        if not _open(expr) or (found := _reckoned_once(expr)) == expr:
            break
        expr = found
    return expr


def _open(expr: sp.Basic) -> bool:
    return expr.has(InertNumber) or any(power.exp.is_Rational and power.exp.q > MOST_ROOT for power in expr.atoms(sp.Pow))


def _reckoned_once(expr: sp.Basic) -> sp.Basic:
    if not expr.args:
        return expr.value if isinstance(expr, InertNumber) else expr
    if isinstance(expr, sp.Pow):
        changed = _reckoned_once(expr.base), inert_exponent(_reckoned_once(plain_exponent(expr.exp)))
    else:
        changed = tuple(map(_reckoned_once, expr.args))
    return expr if changed == expr.args else expr.func(*changed)
