"""What a function that states a law takes: its arguments are the names of the law, and nothing else."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterable, Mapping
from typing import Any

import sympy as sp

from duhem.errors import InputError

__all__ = ["argument_names", "called", "listed"]


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
            remedy = f"leave it out, and fix a value by parameters={{{x.name!r}: Domain.fixed({x.default!r})}}"
            raise InputError(f"the argument {x.name} has a default, which no law has", where=where, remedy=remedy)
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
