"""The words a formula may use, as SymPy functions that derive and print properly.

``norm``, ``pos``, ``neg`` and ``where`` are ours; the rest are SymPy's own.  ``WORDS`` is the single list from which
the parser takes its names; every interpreter has one row per node class of ``NODES``.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import sympy as sp

__all__ = ["NODES", "WORDS", "Neg", "Norm", "Pos", "Where", "Word", "symbol"]


class Norm(sp.Function):
    r"""Euclidean norm :math:`\sqrt{x_1^2 + \dots + x_n^2}` of real arguments, n >= 1; not differentiable at 0."""

    @classmethod
    def eval(cls, *args: sp.Expr) -> sp.Expr | None:
        kept = [a for a in args if a.is_zero is not True]
        if not kept:
            return sp.S.Zero
        if len(kept) == 1:
            return sp.Abs(kept[0])
        if all(a.is_Number for a in kept):
            return sp.sqrt(sp.Add(*[a**2 for a in kept]))
        return cls(*kept) if len(kept) < len(args) else None

    def fdiff(self, argindex: int = 1) -> sp.Expr:
        return self.args[argindex - 1] / self

    def _eval_is_extended_real(self) -> bool:
        return True

    def _eval_is_extended_nonnegative(self) -> bool:
        return True

    def _eval_rewrite_as_Pow(self, *args: sp.Expr, **_: Any) -> sp.Expr:
        return sp.sqrt(sp.Add(*[a**2 for a in args]))

    def _latex(self, printer: Any, exp: str | None = None) -> str:
        inner = r",\,".join(printer.doprint(a) for a in self.args)
        body = rf"\left\|{inner}\right\|_2"
        return rf"{body}^{{{exp}}}" if exp else body


class _Ramp(sp.Function):
    """A ramp max(s x, 0) with s = +1 (``pos``) or -1 (``neg``)."""

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

    def _eval_is_extended_real(self) -> bool:
        return True

    def _eval_is_extended_nonnegative(self) -> bool:
        return True

    def _latex(self, printer: Any, exp: str | None = None) -> str:
        body = rf"\left\langle {printer.doprint(self.args[0])} \right\rangle_{{{self.mark}}}"
        return rf"{body}^{{{exp}}}" if exp else body


class Pos(_Ramp):
    r"""Positive part :math:`\langle x\rangle_+ = \max(x, 0)`."""

    slope, mark = 1, "+"


class Neg(_Ramp):
    r"""Negative part :math:`\langle x\rangle_- = \max(-x, 0)`, itself never negative."""

    slope, mark = -1, "-"


class Where(sp.Function):
    """``where(condition, a, b)``: a where the condition holds, else b; differentiated branch by branch."""

    nargs = 3

    @classmethod
    def eval(cls, condition: Any, a: sp.Expr, b: sp.Expr) -> sp.Expr | None:
        if condition is sp.true or condition == True:  # noqa: E712 - a SymPy boolean, not Python's
            return a
        if condition is sp.false or condition == False:  # noqa: E712
            return b
        return a if a == b else None

    def _eval_derivative(self, s: sp.Symbol) -> sp.Expr:
        condition, a, b = self.args
        return Where(condition, a.diff(s), b.diff(s))

    def _eval_is_extended_real(self) -> bool:
        return True

    def _latex(self, printer: Any, exp: str | None = None) -> str:
        condition, a, b = (printer.doprint(x) for x in self.args)
        body = rf"\begin{{cases}} {a} & {condition} \\ {b} & \text{{otherwise}} \end{{cases}}"
        return rf"\left({body}\right)^{{{exp}}}" if exp else body


@dataclass(frozen=True)
class Word:
    """One word of the vocabulary: how it is built and how many arguments it takes."""

    build: Callable[..., sp.Expr]
    least: int
    most: int | None
    meaning: str


WORDS: dict[str, Word] = {
    "abs": Word(sp.Abs, 1, 1, "absolute value"),
    "sqrt": Word(sp.sqrt, 1, 1, "square root"),
    "exp": Word(sp.exp, 1, 1, "exponential"),
    "log": Word(sp.log, 1, 1, "natural logarithm"),
    "sin": Word(sp.sin, 1, 1, "sine (rad)"),
    "cos": Word(sp.cos, 1, 1, "cosine (rad)"),
    "tan": Word(sp.tan, 1, 1, "tangent (rad)"),
    "tanh": Word(sp.tanh, 1, 1, "hyperbolic tangent"),
    "atan": Word(sp.atan, 1, 1, "arc tangent (rad)"),
    "min": Word(sp.Min, 1, None, "least of its arguments"),
    "max": Word(sp.Max, 1, None, "greatest of its arguments"),
    "pos": Word(Pos, 1, 1, "positive part max(x, 0)"),
    "neg": Word(Neg, 1, 1, "negative part max(-x, 0)"),
    "norm": Word(Norm, 1, None, "Euclidean norm of its arguments"),
    "where": Word(Where, 3, 3, "where(condition, a, b)"),
}

# The inner nodes a formula can contain; relations occur only as the condition of ``where``.
NODES: tuple[type, ...] = (
    sp.Add, sp.Mul, sp.Pow, sp.Abs, sp.exp, sp.log, sp.sin, sp.cos, sp.tan, sp.tanh, sp.atan,
    sp.Min, sp.Max, Pos, Neg, Norm, Where,
    sp.StrictGreaterThan, sp.GreaterThan, sp.StrictLessThan, sp.LessThan,
)  # fmt: skip


def symbol(name: str, **assumptions: bool) -> sp.Symbol:
    """A real symbol; all names of a criterion go through here so that equal names are equal symbols."""
    return sp.Symbol(name, **({"real": True} | assumptions))
