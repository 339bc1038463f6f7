"""What a program gives to state a law: a function whose arguments are the law's names and nothing else, lists, and texts.

Text stays text: beside the expression, which is simplified as it is built, for whoever checks a proof.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterable, Mapping, Sequence
from itertools import chain, repeat
from typing import Any

import sympy as sp
from sympy.core.relational import Relational

from duhem.errors import InputError
from duhem.expression.abbreviations import NONE, Abbreviations
from duhem.expression.given import given_relation
from duhem.expression.parse import parse_as_written, parse_relation, reread, written_out

__all__ = ["Relations", "argument_names", "called", "listed", "moved", "moved_relations", "relations", "text_of"]


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
    arguments = inspect.signature(function).parameters.values()
    by_place = [values[x.name] for x in arguments if x.kind is not x.KEYWORD_ONLY]
    by_name = {x.name: values[x.name] for x in arguments if x.kind is x.KEYWORD_ONLY}
    try:
        return function(*by_place, **by_name)
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


Relations = tuple[tuple[Relational, ...], tuple[str, ...]]  # constraints, each with its text or ""


def text_of(given: Any, expr: sp.Basic, written: str, known: Mapping[str, sp.Symbol], short: Abbreviations) -> str:
    """What was given, if it is text; else what was ``written`` where that still gives the expression, and nothing where it does not."""
    if isinstance(given, str):
        return written_out(given, short)
    try:
        return written if written and _read(written, expr, tuple(known.items())) == expr else ""
    except InputError:  # as division by a parameter that was fixed at 0
        return ""


def moved(expr: sp.Basic, text: str, swap: Mapping[sp.Symbol, sp.Symbol], known: tuple[tuple[str, sp.Symbol], ...]) -> sp.Basic:
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


def moved_relations(
    given: tuple[Relational, ...], written: tuple[str, ...], swap: Mapping[sp.Symbol, sp.Symbol], known: tuple[tuple[str, sp.Symbol], ...]
) -> Relations:
    """Constraints over other symbols; what holds of itself now is kept where its text asks for more, as e/e <= 1 does."""
    kept = [
        (moved(c, text, swap, known), text)
        for c, text in zip(given, written, strict=True)
        if c.xreplace(swap) != sp.true or (text and not _polynomial(parse_as_written(text, dict(known))))
    ]
    return tuple(c for c, _ in kept), tuple(text for _, text in kept)


def _read(text: str, expr: sp.Basic, known: tuple[tuple[str, sp.Symbol], ...]) -> sp.Basic:
    return parse_relation(text, dict(known)) if isinstance(expr, Relational) else reread(text, known)


def _polynomial(tree: sp.Basic) -> bool:
    """Whether a comparison as written is one of polynomials, which have a value everywhere."""
    powers = (x for x in sp.preorder_traversal(tree) if x.args and not isinstance(x, sp.Add | sp.Mul | Relational))
    return all(isinstance(x, sp.Pow) and x.exp.is_Integer and x.exp.is_nonnegative for x in powers)
