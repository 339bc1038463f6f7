"""What a program gives to state a law: a function whose arguments are the law's names and nothing else, lists, texts, and expressions.

Text stays text: beside the expression, which is simplified as it is built, for whoever checks a proof.  Any other object given as a formula
or a comparison is held to the language as a text is: SymPy's own sign and atan2 become words of ours, whose derivatives are formulas
without distributions; a float counts as its decimal, as everywhere.  What SymPy evaluated before is not seen: the formula is what came.
"""

from __future__ import annotations

import inspect
from collections import OrderedDict
from collections.abc import Callable, Iterable, Mapping, Sequence
from itertools import chain, repeat
from typing import Any

import sympy as sp
from sympy.core.relational import Relational

from duhem.errors import InputError
from duhem.expression.abbreviations import NONE, Abbreviations
from duhem.expression.build import unacceptable
from duhem.expression.number import exact_number, inert_exponent, reckoned
from duhem.expression.parse import parse_as_written, parse_relation, reread, written_out
from duhem.expression.vocabulary import COMPARISONS, adopted

__all__ = [
    "Known", "Relations", "Swap", "argument_names", "called", "given_formula", "given_relation", "listed", "moved", "moved_relations",
    "relations", "text_of",
]  # fmt: skip


def argument_names(function: Callable[..., Any]) -> list[str]:
    """The names of the arguments, in order, however they are passed; InputError for what names nothing, and for defaults."""
    where = getattr(function, "__name__", repr(function))
    try:
        arguments = inspect.signature(function).parameters.values()
    except (TypeError, ValueError):
        what = f"{function!r} is no function with named arguments"
        raise InputError(what, where="criterion", remedy="decorate a function of the forces, the pressure and the parameters") from None
    for x in arguments:
        if x.kind in (x.VAR_POSITIONAL, x.VAR_KEYWORD):
            raise InputError(f"the argument {x} names nothing", where=where, remedy="name every force and parameter as an argument")
        if x.default is not x.empty:
            remedy = f"remove it, and fix a value by parameters={{{x.name!r}: Domain.fixed({x.default!r})}}"
            raise InputError(f"the argument {x.name} has a default value, which is not allowed", where=where, remedy=remedy)
    return [x.name for x in arguments]


def called(function: Callable[..., Any], values: Mapping[str, Any]) -> Any:
    """The function of these values of its arguments; InputError, with the cause, where it cannot be computed with symbols."""
    signature = inspect.signature(function)
    given = inspect.BoundArguments(signature, OrderedDict((name, values[name]) for name in signature.parameters))
    try:
        return function(*given.args, **given.kwargs)
    except InputError:
        raise
    except (TypeError, ValueError, ArithmeticError) as fault:  # an if on a symbol, math.sqrt, a comparison of what is not real
        what = " ".join(f"its formula cannot be computed with symbols: {fault}".split())
        remedy = "use SymPy's functions instead of if and math, or return text in the words of the language"
        raise InputError(what, where=getattr(function, "__name__", repr(function)), remedy=remedy) from fault


def listed(given: Any, what: str, law: str) -> tuple[Any, ...]:
    """What should be a list as a tuple; InputError for one text or expression, and for what is no list."""
    if (isinstance(given, (str, bytes, Mapping, sp.Basic)) and not isinstance(given, sp.Tuple)) or not isinstance(given, Iterable):
        raise InputError(f"{what} is no list: {given!r}", where=law, remedy="write it as a list: [..., ...]")
    return tuple(given)


Swap = Mapping[sp.Symbol, sp.Symbol]  # what takes the place of symbols over other domains of parameters
Known = tuple[tuple[str, sp.Symbol], ...]  # every declared name with its symbol
Relations = tuple[tuple[Relational, ...], tuple[str, ...]]  # constraints, each with its text or ""


def text_of(given: Any, expr: sp.Basic, written: str, known: Mapping[str, sp.Symbol], short: Abbreviations) -> str:
    """What was given, if it is text; else what was ``written`` where that still gives the expression, and nothing where it does not."""
    if isinstance(given, str):
        return written_out(given, short)
    try:
        return written if written and _read(written, expr, tuple(known.items())) == expr else ""
    except InputError:  # as division by a parameter that was fixed at 0
        return ""


def moved(expr: sp.Basic, text: str, swap: Swap, known: Known) -> sp.Basic:
    """The expression over other symbols of the same names; a text that gave it is read anew, so that it stays the law's text."""
    try:
        return _read(text, expr, known) if text else expr.xreplace(swap)
    except InputError:  # as division by a parameter that is 0 now
        return expr.xreplace(swap)


def relations(given: Any, written: Sequence[str], known: Mapping[str, sp.Symbol], law: str, short: Abbreviations = NONE) -> Relations:
    """The constraints of a law, texts or SymPy's comparisons, with what was ``written``; without SymPy's own that hold of themselves."""
    where, found = f"constraint of {law}", []
    for c, text in zip(listed(given, "constraints", law), chain(written, repeat("")), strict=False):
        as_text = isinstance(c, str)
        relation = parse_relation(c, known, where=where, short=short) if as_text else given_relation(c, known.values(), where)
        if relation is not None:
            found.append((relation, text_of(c, relation, text, known, short)))
    return tuple(relation for relation, _ in found), tuple(text for _, text in found)


def moved_relations(given: tuple[Relational, ...], written: tuple[str, ...], swap: Swap, known: Known) -> Relations:
    """Constraints over other symbols; what holds of itself now is kept where its text asks for more, as e/e <= 1 does."""
    kept = [
        (moved(c, text, swap, known), text)
        for c, text in zip(given, written, strict=True)
        if c.xreplace(swap) != sp.true or (text and not _polynomial(parse_as_written(text, dict(known))))
    ]
    return tuple(c for c, _ in kept), tuple(text for _, text in kept)


def _read(text: str, expr: sp.Basic, known: Known) -> sp.Basic:
    return parse_relation(text, dict(known)) if isinstance(expr, Relational) else reread(text, known)


def _polynomial(tree: sp.Basic) -> bool:
    """Whether a comparison as written is one of polynomials, which have a value everywhere."""
    powers = (x for x in sp.preorder_traversal(tree) if x.args and not isinstance(x, sp.Add | sp.Mul | Relational))
    return all(isinstance(x, sp.Pow) and x.exp.is_Integer and x.exp.is_nonnegative for x in powers)


# -- formulas and comparisons ------------------------------------------------------------------------------------------


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
