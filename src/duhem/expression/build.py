"""Building a formula step by step, each step refused if its value is not real and finite or too large to compute.

SymPy evaluates as it builds: 9**9**9 would fill the memory, 1/0 is its complex infinity, sqrt(-1) its imaginary unit.
Here the size of a result is bounded before SymPy is asked for it, and what comes back is looked at.

Of Max and Min SymPy compares every pair of arguments in up to eight ways and drops those that another always covers.  Of most pairs now
one, now the other is the greater; two points show that, and what holds at every point cannot be said of them.

What is too large or not real shows in double precision, in Python's own arithmetic.
"""

from __future__ import annotations

import math
import random
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from itertools import combinations
from typing import Any, NamedTuple

import sympy as sp

from duhem.errors import InputError
from duhem.expression import mpmath_
from duhem.expression.fold import Table, fold
from duhem.expression.number import InertNumber, inert_exponent, reckoned
from duhem.expression.vocabulary import NODES, WORDS, Atan2

__all__ = ["AS_WRITTEN", "EVALUATED", "IN_RANGE", "UNMADE", "Building", "greatest", "least", "settled", "unacceptable"]

MOST_POINTS = 16
_MARGIN = 1e-6  # far beyond what rounding does to a formula of a law
_SIGNED = frozenset(sp.Symbol("x", positive=True).assumptions0) | frozenset(sp.Symbol("x", negative=True).assumptions0)


def greatest(*args: sp.Expr) -> sp.Expr:
    """``sp.Max(*args)``, the same expression; ValueError as there."""
    return _extreme(sp.Max, args)


def least(*args: sp.Expr) -> sp.Expr:
    """``sp.Min(*args)``, the same expression; ValueError as there."""
    return _extreme(sp.Min, args)


def _extreme(kind: type[sp.Max] | type[sp.Min], args: Collection[sp.Expr]) -> sp.Expr:
    flat = dict.fromkeys(inner for a in args for inner in (a.args if isinstance(a, kind) else (a,)))
    # Within one another SymPy factors them, even where nothing can be compared.
    plain = len(flat) > 1 and not any(isinstance(a, sp.Max | sp.Min) for a in flat)
    return kind(*flat, evaluate=not (plain and _cross(tuple(flat))))


def _cross(args: tuple[sp.Expr, ...]) -> bool:
    """Whether points show of each two that neither is always the greater; False where that stays open."""
    symbols = sorted(set().union(*(a.free_symbols for a in args)), key=str)
    if not symbols or not all(s.assumptions0.keys() <= _SIGNED for s in symbols):  # as integers they are not all that the points are
        return False
    seen: set[tuple[int, int]] = set()
    left = [*combinations(range(len(args)), 2)]
    for point in _points(symbols):
        try:
            values = [value_at(a, point) for a in args]
        except (OverflowError, ValueError, ZeroDivisionError):
            continue
        except (InputError, TypeError):
            return False
        for i, j in left:
            apart = values[i] - values[j]
            if abs(apart) > _MARGIN * (abs(values[i]) + abs(values[j])):
                seen.add((i, j) if apart > 0 else (j, i))
        left = [(i, j) for i, j in left if (i, j) not in seen or (j, i) not in seen]
        if not left:
            return True
    return False


def _points(symbols: Collection[sp.Symbol]) -> Iterator[dict[sp.Symbol, float]]:
    """Points that the symbols' signs allow, always the same."""
    drawn = random.Random(1)
    for _ in range(MOST_POINTS):
        sizes = {s: 2.0 ** drawn.uniform(-4, 4) for s in symbols}
        signs = {s: -1 if s.is_nonpositive else 1 if s.is_nonnegative else drawn.choice((-1, 1)) for s in symbols}
        yield {s: signs[s] * sizes[s] for s in symbols}


MOST_BITS = 8192
MOST_EXPONENT = 1000
MOST_NUMERIC_EXPONENT = 64
_MOST_TOGETHER = 128  # of a Min or Max, once those inside are flattened
MOST_PASSES = 8
_BUILT = {"max": greatest, "min": least}
_INFINITE = tuple(map(type, (sp.nan, sp.zoo, sp.oo, -sp.oo)))
_REWRITE = "write it with real numbers, declared names, + - * / ** and the words of the language"


def total(plus: Sequence[sp.Expr], minus: Sequence[sp.Expr]) -> sp.Expr:
    """Sum of ``plus`` less the sum of ``minus``."""
    _bound_bits(sum(_bits(x) for x in (*plus, *minus)))
    return _checked(sp.Add(*plus, *(-x for x in minus)))


def product(over: Sequence[sp.Expr], under: Sequence[sp.Expr], sign: int = 1) -> sp.Expr:
    """Product of ``over`` divided by the product of ``under``; a divisor that is zero raises InputError."""
    if any(map(_is_zero, under)):
        raise InputError("division by zero", remedy="correct the divisor")
    _bound_bits(sum(_bits(x) for x in (*over, *under)))
    return _checked(sp.Mul(sp.Integer(sign), *over, *(sp.Pow(x, -1) for x in under)))


def power(base: sp.Expr, exponent: sp.Expr) -> sp.Expr:
    """``base ** exponent`` for exponents that are small or symbolic."""
    if exponent.is_number:
        size = abs(approximate(exponent))
        if size > (MOST_NUMERIC_EXPONENT if base.is_number else MOST_EXPONENT):
            most = f"{MOST_NUMERIC_EXPONENT} on a number, {MOST_EXPONENT} on a variable"
            raise InputError("the exponent is too large", remedy=f"use exponents up to {most}")
        _bound_bits(int(size) * max((_bits(x) for x in base.atoms(sp.Rational)), default=0))
        if _is_zero(base) and approximate(exponent) < 0:
            raise InputError("division by zero", remedy="correct the divisor")
    _check_base(base, exponent)
    return _checked(sp.Pow(base, inert_exponent(exponent)))


def call(word: str, args: Sequence[sp.Basic]) -> sp.Expr:
    """A word of the vocabulary applied to its arguments."""
    # Nested Min and Max are flattened and every pair compared, so it is the flattened count that is bounded.
    count = sum(len(a.args) if isinstance(a, (sp.Min, sp.Max)) else 1 for a in args)
    if count > _MOST_TOGETHER:
        raise InputError(f"{word} has {count} arguments", remedy=f"at most {_MOST_TOGETHER} are read")
    if word == "sqrt":
        return power(args[0], sp.S.Half)
    if word == "atan2" and any(a.has(Atan2) for a in args):
        raise InputError("atan2 occurs inside atan2", remedy="write the inner angle otherwise")
    if word in ("log", "log10") and _is_zero(args[0]):
        raise InputError(f"{word}(0) is not finite", remedy=f"give {word} a positive argument")
    if word == "exp" and args[0].is_number and approximate(args[0]) > 700:
        raise InputError("the value is too large", remedy="exp takes arguments up to 700")
    return _checked(_in_words(_BUILT.get(word, WORDS[word].build)(*args)))


def _in_words(expr: sp.Expr) -> sp.Expr:
    """What SymPy made of a word, without words of its own: tan(x + pi/2) is -cot(x)."""
    return expr.replace(sp.cot, lambda x: 1 / sp.tan(x)) if expr.has(sp.cot) else expr


def settled(expr: sp.Expr) -> sp.Expr:
    """The expression built anew from its parts until it stays what it is.

    What SymPy makes of abs(m/b) it makes otherwise of its own answer, m*abs(1/b); a formula that is settled is read back from its
    text (:func:`duhem.expression.text.formula`) as it was.
    """
    for _ in range(MOST_PASSES):
        again = reckoned(_rebuilt(expr))
        if again == expr:
            break
        expr = again
    return expr


def _rebuilt(expr: sp.Basic) -> sp.Basic:
    done: dict[sp.Basic, sp.Basic] = {}
    for node in sp.postorder_traversal(expr):
        if node not in done:
            build = {sp.Max: greatest, sp.Min: least, sp.Abs: WORDS["abs"].build}.get(type(node), node.func)
            done[node] = _in_words(build(*(done[x] for x in node.args))) if node.args else node
    return done[expr]


class Building(NamedTuple):
    """How a formula's nodes are made of their parts."""

    total: Callable[[Sequence[sp.Expr], Sequence[sp.Expr]], sp.Expr]
    product: Callable[..., sp.Expr]
    power: Callable[[sp.Expr, sp.Expr], sp.Expr]
    call: Callable[[str, Sequence[sp.Basic]], sp.Expr]
    evaluate: bool  # whether SymPy makes of a comparison true or false where the signs of the symbols decide it


def _written_total(plus: Sequence[sp.Expr], minus: Sequence[sp.Expr]) -> sp.Expr:
    terms = (*plus, *(_written_product([x], [], sign=-1) for x in minus))
    return sp.Add(*terms, evaluate=all(x.is_Rational for x in terms))


def _written_product(over: Sequence[sp.Expr], under: Sequence[sp.Expr], sign: int = 1) -> sp.Expr:
    factors = [*([] if sign == 1 else [sp.Integer(sign)]), *over, *(_written_power(x, sp.S.NegativeOne) for x in under)]
    return factors[0] if len(factors) == 1 else sp.Mul(*factors, evaluate=all(x.is_Rational for x in factors))


def _written_power(base: sp.Expr, exponent: sp.Expr) -> sp.Expr:
    if base.is_Rational and exponent.is_Rational:
        try:
            return power(base, exponent)
        except InputError:  # 1/0, where a fixed parameter is 0: left as it stands, for whoever asks what is defined
            pass
    return sp.Pow(base, inert_exponent(exponent), evaluate=False)


def _written_call(word: str, args: Sequence[sp.Basic]) -> sp.Expr:
    if word == "sqrt":
        return _written_power(args[0], sp.S.Half)
    return WORDS[word].build(*args, evaluate=False)


def _call_in_range(word: str, args: Sequence[sp.Expr]) -> sp.Expr:
    """The greatest argument taken out of a logarithm of exponentials, so that none overflows."""
    if word not in ("softplus", "logsumexp"):
        return _written_call(word, args)
    terms = [*([sp.S.Zero] if word == "softplus" else []), *args]
    most = sp.Max(*terms, evaluate=False)
    away = (sp.exp(sp.Add(x, sp.Mul(sp.S.NegativeOne, most, evaluate=False), evaluate=False), evaluate=False) for x in terms)
    return sp.Add(most, sp.log(sp.Add(*away, evaluate=False), evaluate=False), evaluate=False)


def _nothing(*_: Any, **__: Any) -> sp.Expr:
    return sp.S.Zero


EVALUATED = Building(total, product, power, call, evaluate=True)
# Nothing cancelled, combined or put in order but numbers: x/x, exp(log(x)) and sqrt(x)**2 stay what they are.
AS_WRITTEN = Building(_written_total, _written_product, _written_power, _written_call, evaluate=False)
# The same for who evaluates it in doubles.
IN_RANGE = AS_WRITTEN._replace(call=_call_in_range)
# Nothing is made of the parts: for a formula that is to be checked alone, and may be long.
UNMADE = Building(_nothing, _nothing, _nothing, _nothing, evaluate=False)


def unacceptable(expr: sp.Expr, known: set[sp.Symbol]) -> InputError | None:
    """Why a finished formula, however it was made, cannot be used, or None."""
    try:
        nodes = dict.fromkeys(sp.preorder_traversal(expr))
        for node in nodes:
            _bound_bits(_bits(node))
            _check_real(node)
        for node in nodes:
            if node.args:
                _check_node(node)
            elif not (node in known or isinstance(node, sp.Rational | InertNumber) or node in (sp.pi, sp.E)):
                raise InputError(f"no meaning is given to {node}", remedy=_REWRITE)
    except InputError as fault:
        return fault
    return None


def _check_node(node: sp.Basic) -> None:
    if type(node) not in NODES:
        raise InputError(f"no meaning is given to {type(node).__name__} in {' '.join(str(node).split())[:60]!r}", remedy=_REWRITE)
    if isinstance(node, sp.Pow):
        if node.exp.is_number and abs(approximate(node.exp)) > MOST_EXPONENT:
            raise InputError(f"the exponent of {str(node.base)[:40]!r} is too large", remedy=f"use exponents up to {MOST_EXPONENT}")
        _check_base(node.base, node.exp)
    if node.is_number:
        approximate(node)


def _check_base(base: sp.Expr, exponent: sp.Expr) -> None:
    if not exponent.is_number and base.is_number and ((_is_zero(base) and not exponent.is_positive) or approximate(base) < 0):
        raise InputError("a variable power of a number that is not positive is not real", remedy="use a positive base")


def _check_real(expr: sp.Basic) -> None:
    if _is_unreal(expr):
        raise InputError("the value is not real", remedy="take roots and logarithms of what is never negative, asin and acos in [-1, 1]")
    if isinstance(expr, _INFINITE):
        raise InputError("the value is not real and finite", remedy="divide by what is never 0, and use finite numbers")


def _checked(expr: sp.Expr) -> sp.Expr:
    _bound_bits(_bits(expr))
    for part in (expr, *(expr.args if isinstance(expr, sp.Mul) else ())):
        _check_real(part)
    if expr.is_number and not expr.is_Rational:
        approximate(expr)
    return expr


def _is_unreal(expr: sp.Expr) -> bool:
    """Whether SymPy knows a root, a logarithm, an arc sine or cosine not to be real, whatever the symbols in it are."""
    if isinstance(expr, sp.Pow) and isinstance(expr.exp, sp.Rational | InertNumber) and expr.exp.is_integer is False:
        return expr.base.is_extended_nonpositive is True  # a root, as log, of what is never positive
    return expr is sp.I or (isinstance(expr, (sp.Pow, sp.log, sp.asin, sp.acos)) and expr.is_extended_real is False)


def _is_zero(expr: sp.Expr) -> bool:
    """Whether a constant is zero, or cannot be told from it in a hundred digits."""
    if expr.is_Rational or not expr.is_number:
        return bool(expr == 0)
    if abs(approximate(expr)) > 1e-9:
        return False
    return bool(abs(expr.evalf(20, maxn=120)) < sp.Float("1e-100"))


def _bits(expr: sp.Basic) -> int:
    """Size of the number in front: of a rational itself, of a product's coefficient."""
    if isinstance(expr, sp.Mul):
        expr = expr.args[0]
    return expr.p.bit_length() + expr.q.bit_length() if isinstance(expr, sp.Rational) else 0


def _bound_bits(bits: int) -> None:
    if bits > MOST_BITS:
        raise InputError("the number is too large", remedy="use numbers of ordinary size")


# -- values in double precision ----------------------------------------------------------------------------------------


def approximate(expr: sp.Expr) -> float:
    """The value of a constant in double precision; InputError if it is not real and finite."""
    try:
        value = value_at(expr, {})
    except (OverflowError, ValueError, ZeroDivisionError, TypeError):
        value = math.nan
    if not math.isfinite(value):
        raise InputError("the value is not real and finite, or too large", remedy="keep every part of the formula real and finite")
    return value


def value_at(expr: sp.Expr, point: Mapping[sp.Symbol, float]) -> float:
    """The value where the symbols have those of ``point``; where there is none, no finite number or what Python raises."""
    return fold(expr, _DOUBLES, lambda node: point[node] if node in point else float(node))


_DOUBLES: Table[float] = mpmath_.table(mpmath_.doubles())
