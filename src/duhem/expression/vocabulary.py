"""The words a formula may use, as SymPy functions that derive and print properly.

``norm``, ``pos``, ``neg``, ``where`` and ``atan2`` are ours; the rest are SymPy's own.  ``WORDS`` is the single list from
which the parser takes its names; every interpreter has one row per node class of ``NODES``.  A word that others say as well
is built of them and needs no row: ``sqrt``, ``log10``, ``sign``, ``softplus``, ``logsumexp``, and a ``where`` whose condition joins
comparisons.
"""

from __future__ import annotations

import operator
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache, reduce
from typing import Any

import mpmath
import sympy as sp

from duhem.expression.elementary import ELEMENTARY

__all__ = [
    "COMPARISONS", "KINKS", "MOST_ARGUMENTS", "NODES", "UNDEFINED", "WORDS", "Atan2", "EigMax", "Neg", "Norm", "Pos", "Where", "Word",
    "adopted", "defined_at", "deviator", "holds_at", "nested", "rows", "symbol",
]  # fmt: skip


def rows(xx: Any, yy: Any, zz: Any, yz: Any, xz: Any, xy: Any) -> list[list[Any]]:
    """The matrix, row by row."""
    return [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]


def deviator(xx: Any, yy: Any, zz: Any, yz: Any, xz: Any, xy: Any) -> tuple[Any, Any, Any]:
    """A third of the trace; J2 and J3, half the square and the determinant of what is left without it.

    The greatest eigenvalue is mean + 2 sqrt(J2/3) cos(theta), cos(3 theta) = 3 sqrt(3)/2 J3/J2^(3/2), 0 <= theta <= pi/3.
    """
    mean = (xx + yy + zz) / 3
    x, y, z = ((2 * xx - yy - zz) / 3, (2 * yy - zz - xx) / 3, (2 * zz - xx - yy) / 3)
    squares = [d * d for d in (xx - yy, yy - zz, zz - xx)]
    shears = [s * s for s in (yz, xz, xy)]
    second = (squares[0] + squares[1] + squares[2]) / 6 + (shears[0] + shears[1] + shears[2])
    return mean, second, x * y * z + 2 * yz * xz * xy - x * shears[0] - y * shears[1] - z * shears[2]


class _Real(sp.Function):
    """A function with real values, which LaTeX shows as its ``_body``."""

    def _eval_is_extended_real(self) -> bool | None:
        return True

    def _latex(self, printer: Any, exp: str | None = None) -> str:
        body = self._body(printer)
        return rf"{body}^{{{exp}}}" if exp else body


class Norm(_Real):
    r"""Euclidean norm :math:`\sqrt{x_1^2 + \dots + x_n^2}` of real arguments, n >= 1; not differentiable at 0."""

    is_extended_nonnegative = True

    @classmethod
    def eval(cls, *args: sp.Expr) -> sp.Expr | None:
        kept = [a for a in args if a.is_zero is not True]
        if not kept:
            return sp.S.Zero
        if len(kept) == 1:
            return _absolute(kept[0])
        if all(a.is_Number for a in kept):
            return sp.sqrt(sp.Add(*[a**2 for a in kept]))
        return cls(*kept) if len(kept) < len(args) else None

    def fdiff(self, argindex: int = 1) -> sp.Expr:
        return self.args[argindex - 1] / self

    def _eval_evalf(self, prec: int) -> sp.Expr:
        return self._eval_rewrite_as_Pow(*self.args)._eval_evalf(prec)

    def _eval_rewrite_as_Pow(self, *args: sp.Expr, **_: Any) -> sp.Expr:
        return sp.sqrt(sp.Add(*[a**2 for a in args]))

    def _body(self, printer: Any) -> str:
        inner = r",\,".join(printer.doprint(a) for a in self.args)
        return rf"\left\|{inner}\right\|_2"


class _Ramp(_Real):
    """A ramp max(s x, 0) with s = +1 (``pos``) or -1 (``neg``)."""

    is_extended_nonnegative = True
    slope: int
    mark: str

    @classmethod
    def eval(cls, x: sp.Expr) -> sp.Expr | None:
        signed = cls.slope * x
        if signed.is_extended_nonnegative:
            return signed
        if signed.is_extended_nonpositive:
            return sp.S.Zero
        return None

    def fdiff(self, argindex: int = 1) -> sp.Expr:
        x = self.args[0]
        return Where(x > 0, sp.S.One, sp.S.Zero) if self.slope > 0 else Where(x < 0, sp.S.NegativeOne, sp.S.Zero)

    def _body(self, printer: Any) -> str:
        return rf"\left\langle {printer.doprint(self.args[0])} \right\rangle_{{{self.mark}}}"


class Pos(_Ramp):
    r"""Positive part :math:`\langle x\rangle_+ = \max(x, 0)`."""

    slope, mark = 1, "+"


class Neg(_Ramp):
    r"""Negative part :math:`\langle x\rangle_- = \max(-x, 0)`, itself never negative."""

    slope, mark = -1, "-"


class Where(_Real):
    """``where(condition, a, b)``: a where the condition holds, else b; differentiated branch by branch.

    A condition that joins others by and, or (SymPy's ``And``, ``Or``) becomes a choice within a choice.
    """

    nargs = 3

    @classmethod
    def eval(cls, condition: Any, a: sp.Expr, b: sp.Expr) -> sp.Expr | None:
        if condition is sp.true or condition == True:  # noqa: E712 - a SymPy boolean, not Python's
            return a
        if condition is sp.false or condition == False:  # noqa: E712
            return b
        if isinstance(condition, sp.And):
            return reduce(lambda inner, part: cls(part, inner, b), reversed(condition.args), a)
        if isinstance(condition, sp.Or):
            return reduce(lambda inner, part: cls(part, a, inner), reversed(condition.args), b)
        return a if a == b else None

    @property
    def sign_of(self) -> sp.Expr | None:
        """x where this is what ``sign(x)`` is built as, for whoever prints it."""
        condition = self.args[0]
        return condition.lhs if isinstance(condition, sp.StrictGreaterThan) and self == _sign(condition.lhs) else None

    def _eval_derivative(self, s: sp.Symbol) -> sp.Expr:
        condition, a, b = self.args
        return Where(condition, a.diff(s), b.diff(s))

    def _latex(self, printer: Any, exp: str | None = None) -> str:
        body = super()._latex(printer, exp if self.sign_of is not None else None)
        return rf"\left({body}\right)^{{{exp}}}" if exp and self.sign_of is None else body

    def _body(self, printer: Any) -> str:
        if self.sign_of is not None:
            return rf"\operatorname{{sgn}}\left({printer.doprint(self.sign_of)}\right)"
        condition, a, b = (printer.doprint(x) for x in self.args)
        return rf"\begin{{cases}} {a} & {condition} \\ {b} & \text{{otherwise}} \end{{cases}}"


class Atan2(_Real):
    r"""Angle of the point (x, y) in :math:`(-\pi, \pi]`, in rad, as ``atan2(y, x)``: it jumps across y = 0 > x.

    At (0, 0) there is no angle and no value.
    """

    nargs = 2

    @classmethod
    def eval(cls, y: sp.Expr, x: sp.Expr) -> sp.Expr | None:
        if x.is_positive:
            return sp.atan(y / x)
        if x.is_negative and (y.is_nonnegative or y.is_negative):
            return sp.atan(y / x) + (sp.pi if y.is_nonnegative else -sp.pi)
        if x.is_zero and y.is_zero:
            return sp.nan
        if x.is_zero and (y.is_positive or y.is_negative):
            return sp.pi / 2 if y.is_positive else -sp.pi / 2
        return None

    def fdiff(self, argindex: int = 1) -> sp.Expr:
        y, x = self.args
        return (x if argindex == 1 else -y) / (x**2 + y**2)

    def opened(self) -> sp.Expr:
        """The angle in its cases, by ``where`` and atan; undefined at (0, 0) too."""
        y, x = self.args
        left = Where(y >= 0, sp.atan(y / x) + sp.pi, sp.atan(y / x) - sp.pi)
        side = x if y.is_zero else y  # the quotient is a sign, and none at (0, 0)
        return Where(x > 0, sp.atan(y / x), Where(x < 0, left, sp.pi / 2 * side / sp.Abs(side)))

    def _eval_is_extended_real(self) -> bool | None:
        return True if any(a.is_nonzero for a in self.args) else None

    def _body(self, printer: Any) -> str:
        return rf"\operatorname{{atan_2}}\left({', '.join(printer.doprint(a) for a in self.args)}\right)"


class EigMax(_Real):
    r"""Greatest eigenvalue of the symmetric matrix with entries xx, yy, zz, yz, xz, xy: convex in them.

    Where it is a double one it has a kink.  The least one is ``-eigmax`` of the negative matrix.
    """

    nargs = 6

    @classmethod
    def eval(cls, *entries: sp.Expr) -> sp.Expr | None:
        return sp.Max(*entries[:3]) if all(shear.is_zero for shear in entries[3:]) else None

    def _eval_is_finite(self) -> bool | None:
        return all(a.is_finite for a in self.args) or None

    def fdiff(self, argindex: int = 1) -> sp.Expr:
        """By the adjugate of self - matrix, which is a multiple of n n^T, n the unit eigenvector; undefined at a double eigenvalue."""
        x, y, z, yz, xz, xy = (*(self - a for a in self.args[:3]), *(-a for a in self.args[3:]))
        diagonal = (y * z - yz**2, x * z - xz**2, x * y - xy**2)
        doubled = (2 * (xy * xz - x * yz), 2 * (xy * yz - y * xz), 2 * (xz * yz - z * xy))  # a shear stands twice in the matrix
        return (*diagonal, *doubled)[argindex - 1] / sp.Add(*diagonal)

    def _eval_evalf(self, prec: int) -> sp.Float:
        with mpmath.workprec(prec + 16):
            values = mpmath.eigsy(mpmath.matrix(rows(*(a._to_mpmath(prec + 16) for a in self.args))), eigvals_only=True)
            return sp.Float(max(values), precision=prec)

    def _body(self, printer: Any) -> str:
        return rf"\lambda_{{\max}}\left({', '.join(printer.doprint(a) for a in self.args)}\right)"


def _absolute(x: sp.Expr, evaluate: bool = True) -> sp.Expr:
    """SymPy's absolute value, with exponents taken as real: of exp(x**(2/3)) it would make waves of the angle of x."""
    exponents = {node.exp for node in x.atoms(sp.Pow, sp.exp) if node.exp.is_extended_real is None} if evaluate else set()
    if not exponents:
        return sp.Abs(x, evaluate=evaluate)
    stand_ins = {exponent: sp.Dummy(real=True) for exponent in sorted(exponents, key=sp.default_sort_key)}
    return sp.Abs(x.xreplace(stand_ins)).xreplace({dummy: exponent for exponent, dummy in stand_ins.items()})


def _sign(x: sp.Expr, evaluate: bool = True) -> sp.Expr:
    """-1, 0 or 1."""
    below = Where(sp.StrictLessThan(x, 0, evaluate=evaluate), sp.S.NegativeOne, sp.S.Zero, evaluate=evaluate)
    return Where(sp.StrictGreaterThan(x, 0, evaluate=evaluate), sp.S.One, below, evaluate=evaluate)


def _log10(x: sp.Expr, evaluate: bool = True) -> sp.Expr:
    """log(x)/log(10), a whole number where it is one."""
    return sp.log(x, 10) if evaluate else sp.Mul(sp.log(x, evaluate=False), sp.Pow(sp.log(10), -1), evaluate=False)


def _log_sum_exp(*args: sp.Expr, evaluate: bool = True) -> sp.Expr:
    """log(exp(x) + exp(y) + ...)."""
    return sp.log(sp.Add(*(sp.exp(x, evaluate=evaluate) for x in args), evaluate=evaluate), evaluate=evaluate)


def _softplus(x: sp.Expr, evaluate: bool = True) -> sp.Expr:
    """log(1 + exp(x))."""
    return sp.log(sp.Add(sp.S.One, sp.exp(x, evaluate=evaluate), evaluate=evaluate), evaluate=evaluate)


def adopted(expr: sp.Basic) -> sp.Basic:
    """A SymPy expression with SymPy's own sign and atan2 as words of ours: their derivatives are formulas, without distributions."""
    return expr.replace(sp.sign, _sign).replace(sp.atan2, Atan2) if expr.has(sp.sign, sp.atan2) else expr


@dataclass(frozen=True)
class Word:
    """One word of the vocabulary: how it is built and how many arguments it takes."""

    build: Callable[..., sp.Expr]
    least: int
    most: int | None
    meaning: str


WORDS: dict[str, Word] = {
    "abs": Word(_absolute, 1, 1, "absolute value"),
    "sign": Word(_sign, 1, 1, "-1, 0 or 1 as its argument is negative, 0 or positive"),
    "sqrt": Word(sp.sqrt, 1, 1, "square root"),
    **{name: Word(word.node, 1, 1, word.meaning) for name, word in ELEMENTARY.items()},
    "log10": Word(_log10, 1, 1, "logarithm to base 10"),
    "softplus": Word(_softplus, 1, 1, "log(1 + exp(x)), a smooth max(x, 0); infinite in double precision for x > 710"),
    "logsumexp": Word(
        _log_sum_exp, 1, None, "log(exp(x) + exp(y) + ...), a smooth max; infinite in double precision for an argument > 710"
    ),
    "atan2": Word(Atan2, 2, 2, "atan2(y, x), the angle (rad) of the point (x, y)"),
    "min": Word(sp.Min, 1, None, "least of its arguments"),
    "max": Word(sp.Max, 1, None, "greatest of its arguments"),
    "pos": Word(Pos, 1, 1, "positive part max(x, 0)"),
    "neg": Word(Neg, 1, 1, "negative part max(-x, 0)"),
    "norm": Word(Norm, 1, None, "Euclidean norm of its arguments"),
    "eigmax": Word(EigMax, 6, 6, "greatest eigenvalue of the symmetric matrix with entries xx, yy, zz, yz, xz, xy"),
    "where": Word(Where, 3, 3, "where(condition, a, b)"),
}

COMPARISONS: Mapping[type, Callable[[Any, Any], Any]] = {
    sp.StrictGreaterThan: operator.gt, sp.GreaterThan: operator.ge, sp.StrictLessThan: operator.lt, sp.LessThan: operator.le,
}  # fmt: skip

# The inner nodes a formula can contain; relations occur only as the condition of ``where``.
NODES: tuple[type, ...] = (
    sp.Add, sp.Mul, sp.Pow, sp.Abs, *(word.node for word in ELEMENTARY.values()), Atan2,
    sp.Min, sp.Max, Pos, Neg, Norm, EigMax, Where,
    *COMPARISONS,
)  # fmt: skip

# The nodes whose value has a kink or may jump, one smooth piece meeting another.
KINKS: tuple[type, ...] = (sp.Abs, sp.Max, sp.Min, Pos, Neg, Where)


@lru_cache(maxsize=4096)
def symbol(name: str, **assumptions: bool) -> sp.Symbol:
    """A real symbol; all names of a criterion go through here so that equal names are equal symbols."""
    return sp.Symbol(name, **({"real": True} | assumptions))


# What a root of -1, a logarithm of 0 or a quotient by 0 becomes in SymPy where values are put in: no real number.
UNDEFINED = (sp.nan, sp.zoo, sp.oo, -sp.oo, sp.I)


def defined_at(expr: sp.Expr, place: Mapping[sp.Symbol, sp.Expr]) -> sp.Expr | None:
    """The expression with values, or other expressions, put in; None where part of it has no value there."""
    try:
        value = expr.xreplace(place)
    except (ValueError, TypeError):  # SymPy compares something with nan
        return None
    return None if value.has(*UNDEFINED) else value


def holds_at(relation: sp.Basic, place: Mapping[sp.Symbol, sp.Expr]) -> bool:
    """Whether a relation holds with values put in; it does not hold where a part of it has no value."""
    compare = COMPARISONS.get(type(relation))
    try:
        if compare is None:
            return relation.xreplace(place) == sp.true
        left, right = (sp.sympify(side.xreplace(place)) for side in relation.args)
        if left.is_Rational and right.is_Rational:  # SymPy's relation asks the same in ten times the time
            return bool(compare(left, right))
        return relation.func(left, right) == sp.true
    except (ValueError, TypeError):  # SymPy compares nothing with what is no real number
        return False


MOST_ARGUMENTS = 32  # of a word


def nested(word: str, parts: Sequence[str]) -> str:
    """The text of a ``max`` or ``min`` of any number of parts, within one another, as many at once as are read."""
    while len(parts) > MOST_ARGUMENTS:
        parts = [nested(word, parts[k : k + MOST_ARGUMENTS]) for k in range(0, len(parts), MOST_ARGUMENTS)]
    return f"{word}({', '.join(parts)})"
