"""What a program gives as a formula or a comparison: any Python object, held to the language as a text is.

SymPy's own sign and atan2 become words of ours, whose derivatives are formulas without distributions; a float counts as its
decimal, as everywhere.  What SymPy evaluated before is not seen: the formula is what came.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import sympy as sp
from sympy.core.relational import Relational

from duhem.errors import InputError
from duhem.expression.build import unacceptable
from duhem.expression.inert_number import inert_exponent, reckoned
from duhem.expression.number import exact_number
from duhem.expression.vocabulary import COMPARISONS, adopted

__all__ = ["given_formula", "given_relation"]

_FAULTS = (ArithmeticError, AttributeError, TypeError, ValueError, RecursionError, NotImplementedError)


def given_formula(given: Any, known: Iterable[sp.Symbol], where: str) -> sp.Expr:
    """``given`` as a real formula over the symbols ``known``; InputError, at ``where``, for what is not one.

    It must be made of real finite numbers, these very symbols and the words of the language, and no part of it may be known
    not to be real: sqrt(-1), log(-1), (-2)**x.
    """
    try:
        return _formula(given, set(known))
    except InputError as fault:
        raise InputError(fault.what, where=where, remedy=fault.remedy) from None
    except _FAULTS:  # SymPy's, on objects that it has no arithmetic for
        raise InputError(f"{_quoted(given)} cannot be read", where=where, remedy="give one SymPy expression, or text") from None


def given_relation(given: Any, known: Iterable[sp.Symbol], where: str) -> Relational | None:
    """``given`` as a comparison of two formulas, None where it holds of itself; InputError, at ``where``, for what is not one."""
    if given is True or given is sp.true:
        return None
    if given is False or given is sp.false:
        raise InputError("the constraint is contradictory: it never holds", where=where, remedy="correct or remove it")
    if type(given) not in COMPARISONS:
        raise InputError(f"{_quoted(given)} is no comparison", where=where, remedy="compare two expressions with < <= > or >=")
    symbols = set(known)
    return type(given)(given_formula(given.lhs, symbols, where), given_formula(given.rhs, symbols, where), evaluate=False)


def _formula(given: Any, known: set[sp.Symbol]) -> sp.Expr:
    try:
        expr = sp.sympify(given, strict=True)
    except _FAULTS:
        expr = None
    if isinstance(expr, Relational):
        raise InputError(f"{_quoted(given)} is a comparison", remedy="give the difference of its sides: x - 1 for x <= 1")
    if not isinstance(expr, sp.Expr):
        raise InputError(f"{_quoted(given)} is no formula", remedy="give one SymPy expression, or text")
    _check_symbols(expr, known)
    expr = adopted(expr)
    if expr.has(sp.Float):
        expr = expr.replace(
            lambda x: isinstance(x, sp.Pow) and isinstance(x.exp, sp.Float), lambda x: sp.Pow(x.base, inert_exponent(exact_number(x.exp)))
        )
        expr = expr.xreplace({x: exact_number(x) for x in expr.atoms(sp.Float)})
    expr = reckoned(expr)
    if fault := unacceptable(expr, known):
        raise fault
    return expr


def _check_symbols(expr: sp.Expr, known: set[sp.Symbol]) -> None:
    """Symbols are the same where name and assumptions are: sqrt(x**2) is x already where x was made as a positive symbol."""
    stray = sorted(map(str, expr.free_symbols - known))
    if not stray:
        return
    names = {x.name for x in known}
    if alike := [name for name in stray if name in names]:
        what = f"the symbol {alike[0]} has other assumptions than the law's {alike[0]}"
        raise InputError(what, remedy=f"use the function's arguments, or symbols() of a law, or write {alike[0]} in text")
    raise InputError(f"{', '.join(stray)} is not declared", remedy=f"declare it as a parameter, or use: {', '.join(sorted(names))}")


def _quoted(given: Any) -> str:
    """The object on one line, with what it is."""
    try:
        words = " ".join(str(given).split())
    except ValueError:  # an integer longer than Python prints
        words = "..."
    return f"{words if len(words) <= 40 else words[:37] + '...'} ({type(given).__name__})"
