"""A formula with its running bound of rounding as straight lines of Python over numbers, for a compiler to make a loop of.

The rows of :mod:`duhem.expression.error_bounds` are run once, over names in place of arrays: what they would compute is written down.
So there is one table of what each word does to a bound, and text that says the same.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
import sympy as sp
from numpy.lib.mixins import NDArrayOperatorsMixin

from duhem.errors import InputError
from duhem.expression.elementary import ELEMENTARY
from duhem.expression.error_bounds import TABLE as ON_ARRAYS
from duhem.expression.error_bounds import Bounded, constant, eigenvalue
from duhem.expression.fold import Table, bound, recorded
from duhem.expression.pnorm import recognised
from duhem.expression.vocabulary import EigMax

__all__ = ["FUNCTIONS", "TABLE", "Name", "ScalarBounds", "scalar_bounds", "statements"]

FUNCTIONS = (
    "arctan2", "expm1", "hypot", "inf", "isfinite", "isnan", "log1p", "maximum", "minimum", "nan", "sqrt",
    *(word.numpy for word in ELEMENTARY.values()),
)  # fmt: skip
"""What the text may call by NumPy's names."""

_TRUE_OR_NOT: Mapping[np.ufunc, str] = {
    np.greater: ">", np.greater_equal: ">=", np.less: "<", np.less_equal: "<=", np.equal: "==", np.not_equal: "!=",
    np.bitwise_and: "and", np.bitwise_or: "or",
}  # fmt: skip
_SIGNS = {np.add: "+", np.subtract: "-", np.multiply: "*", np.true_divide: "/", np.power: "**", **_TRUE_OR_NOT}
_FORMS: Mapping[np.ufunc, str] = {
    **{ufunc: f"{{0}} {sign} {{1}}" for ufunc, sign in _SIGNS.items()},
    np.absolute: "abs({0})", np.negative: "-{0}", np.square: "{0} * {0}", np.invert: "not {0}",
    np.copysign: "{0} if {1} >= 0.0 else -{0}", np.sign: "float({0} > 0.0) - float({0} < 0.0)",
}  # fmt: skip
_NORMAL = 2.0**-1022
_TRUTHS = {*_TRUE_OR_NOT, np.invert, np.isnan, np.isfinite}


@dataclass(frozen=True)
class ScalarBounds:
    """``text``: ``bounded(v, x, q, b)`` returns the value at row ``x`` of ``v`` and ``q`` and a bound of its rounding.

    ``b`` bounds what ``q`` is off by.  ``constants`` of the formula and what they are ``off`` by stand in ``q`` and ``b`` too.
    """

    text: str
    constants: tuple[float, ...]
    off: tuple[float, ...]


def scalar_bounds(
    expr: sp.Expr, forces: Sequence[sp.Symbol], others: Sequence[sp.Symbol], first: int, name: str = "bounded"
) -> ScalarBounds:
    """``expr`` over ``forces``, taken as exact, and ``others``; its constants are ``q[first]`` and following, ``name`` is the function's.

    InputError for a word whose rows need more than lines.
    """
    lines: dict[str, str] = {}
    constants: dict[sp.Rational, Bounded] = {}

    def number(node: Any) -> Callable[[], Bounded]:
        value = constant(node)()
        if node.is_Integer or not node.is_Rational:
            return partial(Bounded, *value)
        constants.setdefault(node, value)
        place = first + list(constants).index(node)
        return partial(Bounded, Name(lines, f"q[{place}]", known=value.value), Name(lines, f"b[{place}]", known=value.bound))

    given = [Bounded(Name(lines, f"v[x, {i}]"), 0.0) for i in range(len(forces))]
    given += [Bounded(Name(lines, f"q[{k}]"), Name(lines, f"b[{k}]")) for k in range(len(others))]
    recording = recorded(recognised(expr), (*forces, *others), bound(TABLE), number)
    try:
        with np.errstate(all="ignore"):
            value, off = recording.value(given)
    except TypeError:
        raise InputError(f"the rounding of {expr} takes more than lines") from None
    text = [f"def {name}(v, x, q, b):", *statements(lines), f"    return {_text(value)}, {_text(off)}"]
    return ScalarBounds("\n".join(text), tuple(c.value for c in constants.values()), tuple(c.bound for c in constants.values()))


def statements(lines: Mapping[str, str]) -> list[str]:
    """Lines by what they say: ``name`` = text, or a statement by itself."""
    return [f"    {name} = {text}" if name else f"    {text}" for text, name in lines.items()]


class Name(NDArrayOperatorsMixin):
    """A number that is only known when the text runs, under its name; what is done to it is a new line, once.

    ``known``: its value for the formula at hand, on which a row may decide; of other numbers nothing can be decided.
    """

    __hash__ = None  # type: ignore[assignment]

    def __init__(self, lines: dict[str, str], name: str, truth: bool = False, known: Any = None) -> None:
        self.lines, self.name, self.truth, self.known = lines, name, truth, known

    def __str__(self) -> str:
        return self.name

    def let(self, text: str, truth: bool = False, known: Any = None) -> Name:
        return type(self)(self.lines, self.lines.setdefault(text, f"t{len(self.lines)}"), truth, known)

    def __bool__(self) -> bool:
        if self.known is None:
            raise TypeError("known only when the text runs")
        return bool(self.known)

    def __array__(self, *_: Any, **__: Any) -> Any:
        raise TypeError("no array")

    def __array_ufunc__(self, ufunc: np.ufunc, method: str, *inputs: Any, **options: Any) -> Any:
        own, *_ = options.pop("out", inputs)  # a name that is written over is another name
        if method != "__call__" or options or own is not inputs[0] or any(isinstance(x, np.ndarray) and x.ndim for x in inputs):
            return NotImplemented
        values = [x.known if isinstance(x, Name) else x for x in inputs]
        known = None if any(v is None for v in values) else ufunc(*values)
        texts = [_text(x) for x in inputs]
        if ufunc in _FORMS:
            return self.let(_FORMS[ufunc].format(*texts), ufunc in _TRUTHS, known)
        if ufunc in (np.maximum, np.minimum) and not isinstance(inputs[1], Name):  # nan stays nan
            return self.let(f"{texts[0]} if not {texts[0]} {'<=' if ufunc is np.maximum else '>='} {texts[1]} else {texts[1]}", known=known)
        if ufunc.__name__ in FUNCTIONS:
            return self.let(f"{ufunc.__name__}({', '.join(texts)})", ufunc in _TRUTHS, known)
        return NotImplemented

    def __array_function__(self, function: Any, _: Any, arguments: tuple[Any, ...], options: Any) -> Any:
        if function is not np.where or len(arguments) != 3 or options:
            return NotImplemented
        condition, yes, no = arguments
        if isinstance(yes, np.ndarray) and yes.ndim:
            return np.frompyfunc(partial(np.where, condition), 2, 1)(yes, no)
        if not isinstance(condition, Name):
            return yes if condition else no
        return self.let(f"{_number(yes)} if {condition.name} else {_number(no)}")


def _eigmax(_: Any, *entries: Bounded) -> Bounded:
    """By a function of :mod:`duhem.expression.principal_axes`; a matrix whose entries are all known has no name, and is one of arrays."""
    named = next((a.value for a in entries if isinstance(a.value, Name)), None)
    if named is None:
        return ON_ARRAYS[EigMax](_, *entries)
    return eigenvalue(named.let(f"greatest({', '.join(_text(a.value) for a in entries)})"), entries)


TABLE: Table[Bounded] = {**ON_ARRAYS, EigMax: _eigmax}


def _text(x: Any) -> str:
    return x.name if isinstance(x, Name) else repr(bool(x)) if isinstance(x, bool | np.bool_) else _number(x)


def _number(x: Any) -> str:
    """A number; the least ones are made normal, because processors take their time for others: as a bound they say as much."""
    if isinstance(x, Name):
        return f"float({x.name})" if x.truth else x.name
    return f"({x})" if isinstance(x, int) else f"({max(float(x), _NORMAL) if 0.0 < x < _NORMAL else float(x)!r})"
