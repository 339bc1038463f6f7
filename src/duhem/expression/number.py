"""Numbers read exactly: 0.15 is 3/20, whether it comes as text, as a float or from NumPy.

An exponent with a long denominator is a number that SymPy leaves alone, because its algebra would write out huge powers.
"""

from __future__ import annotations

import numbers
import re
from decimal import Decimal
from fractions import Fraction
from typing import Any
from weakref import WeakValueDictionary

import sympy as sp
from sympy.printing.precedence import precedence

from duhem.errors import InputError

__all__ = [
    "DECIMAL", "MOST_DIGITS", "MOST_ROOT", "InertNumber", "exact_number", "exact_text", "fraction", "inert_exponent", "nearest_double",
    "plain_exponent", "ratio", "rational", "reckoned",
]  # fmt: skip

# A decimal without sign.  At most MOST_DIGITS digits and a scale of at most 10^+-MOST_DIGITS: beyond doubles, yet cheap.
DECIMAL = r"(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?"
MOST_DIGITS = 400
_NUMBER = re.compile(rf"([+-]?)({DECIMAL})(?:\s*/\s*({DECIMAL}))?", re.ASCII)
_NEAR = Fraction(1, 10**6)  # of a number: single precision holds its decimals to less, half precision to a part in 2000
_SHORTEN = f"at most {MOST_DIGITS} digits and exponents up to {MOST_DIGITS} are read"
_REMEDY = "write a finite number such as 0.15, 1e-6 or 1/2"


def exact_number(x: Any) -> sp.Rational:
    """``x`` as an exact rational.

    Accepts integers, fractions, SymPy rationals, decimals, NumPy scalars, and text (``"0.15"``, ``"1e-6"``, ``"1/2"``).
    A float counts as the shortest decimal that its own type reads as it: 0.1 is 1/10, and so is ``numpy.float32(0.1)``, which
    holds 0.100000001490...; ``float(x)`` counts as what it holds.  One of half precision is taken where the two are the same to a
    part in a million, as they are of 0.25; of 0.1 it holds 0.0999755859375, and which is meant nobody can tell.  That, infinities,
    truth values and anything else raise InputError.
    """
    if isinstance(x, bool):
        raise InputError(f"{x} is a truth value, not a number", remedy=_REMEDY)
    if isinstance(x, str):
        return _from_text(x)
    if isinstance(x, numbers.Rational):
        return _bounded(rational(x))
    if isinstance(x, (float, Decimal, sp.Float)):
        return _from_text(str(x))
    if isinstance(x, numbers.Real):
        return _of_few_digits(x)
    raise InputError(f"{str(x)[:40]!r} ({type(x).__name__}) is not a number", remedy=_REMEDY)


def _of_few_digits(x: Any) -> sp.Rational:
    """Return a float of another type than Python's as a rational; its shortest decimal may be far from what it holds."""
    read = _from_text(str(x))
    held = Fraction(*x.as_integer_ratio()) if hasattr(x, "as_integer_ratio") else Fraction(float(x))
    if abs(fraction(read) - held) > _NEAR * abs(held):
        what = f"{type(x).__name__} holds {float(held)!r} where {x} is written, and which of them is meant cannot be told"
        raise InputError(what, remedy=f"give the decimal, {x}, or what it holds, float(x)")
    return read


def _bounded(x: sp.Rational) -> sp.Rational:
    """Return ``x``; raise InputError if it has more digits than text may have.  Sums and products may have more, as they are no input."""
    if max(int(x.p).bit_length(), int(x.q).bit_length()) > 8 * MOST_DIGITS:
        raise InputError("the number is too long or too large", remedy=_SHORTEN)
    return x


def rational(x: numbers.Rational) -> sp.Rational:
    """Return a fraction or an integer as SymPy's rational."""
    return sp.Rational(int(x.numerator), int(x.denominator))


def fraction(x: Any) -> Fraction:
    """Return an exact number as a fraction: a rational of SymPy or FLINT, which have ``p`` and ``q``, or what ``Fraction`` takes."""
    return Fraction(int(x.p), int(x.q)) if hasattr(x, "p") else Fraction(x)


def nearest_double(x: Any) -> float | None:
    """Return the double nearest to a number that :func:`fraction` takes; None if it is larger than all doubles."""
    try:
        return float(fraction(x))
    except OverflowError:
        return None


def ratio(x: sp.Rational) -> str:
    """Return ``x`` as text, ``p`` or ``p/q``; :func:`exact_number` reads it back unless it has too many digits."""
    return f"{x.p}/{x.q}" if x.q != 1 else f"{x.p}"


def exact_text(x: Any) -> str:
    """A number as text that :func:`exact_number` reads as the same: its :func:`ratio`, or what was given where that is too long.

    InputError where it is none.
    """
    text = ratio(exact_number(x))
    try:
        exact_number(text)
    except InputError:
        return str(x)
    return text


def _from_text(text: str) -> sp.Rational:
    match = _NUMBER.fullmatch(text.strip())
    if match is None:
        raise InputError(f"{text[:40]!r} is not a number", remedy=_REMEDY)
    sign, over, under = match.groups()
    value, divisor = _decimal(over), _decimal(under or "1")
    if divisor == 0:
        raise InputError(f"{text[:40]!r} divides by zero", remedy=_REMEDY)
    return rational((-value if sign == "-" else value) / divisor)


def _decimal(text: str) -> Fraction:
    digits, _, scale = text.lower().partition("e")
    if len(digits) > MOST_DIGITS or len(scale) > 6 or abs(int(scale or 0)) > MOST_DIGITS:
        raise InputError(f"the number {text[:24]}{'...' if len(text) > 24 else ''} is too long or too large", remedy=_SHORTEN)
    return Fraction(text)


# -- exponents that SymPy leaves alone ---------------------------------------------------------------------------------

# 0.3**3.0012 has SymPy write out 3**30012; up to this denominator the integers stay small and the algebra is worth having.
MOST_ROOT = 12
_MOST_PASSES = 8


class InertNumber(sp.NumberSymbol):
    """A number that SymPy never combines with others, as it does not combine pi; every interpreter reads its rational ``value``."""

    is_real = True
    is_zero = False
    is_rational = None
    is_irrational = None
    is_integer = False
    is_algebraic = None
    is_transcendental = None

    value: sp.Rational

    def __new__(cls, value: sp.Rational) -> InertNumber:
        """Return the one object of this value, as long as anything refers to it: SymPy compares such numbers by identity."""
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

    _latex = _sympystr

    __getnewargs__ = _hashable_content


_living: WeakValueDictionary[sp.Rational, InertNumber] = WeakValueDictionary()


def inert_exponent(value: Any) -> Any:
    """Return a rational with a long denominator as :class:`InertNumber`, and anything else unchanged."""
    return InertNumber(value) if isinstance(value, sp.Rational) and value.q > MOST_ROOT else value


def plain_exponent(exponent: sp.Expr) -> sp.Expr:
    """Return the exponent with rationals in the place of its inert numbers."""
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
