"""Texts drawn at random in the grammar of formulas: every form of number, exponents of all kinds, signs, nestings, words, choices.

``odd`` ones have something in them, at one place or more, that a reader might take otherwise or should refuse: leading zeros,
digits and blanks of other scripts, divisors that are 0, roots of what is negative, marks that do not belong there.
"""

from __future__ import annotations

from dataclasses import dataclass
from random import Random

__all__ = ["NAMES", "Drawn"]

NAMES = ("a", "b", "n", "m", "k")
_NUMBERS = ("0", "1", "2", "3", "10", "1.5", "0.65", ".5", "2.", "1e3", "2.5e-2", "1E+1", "7/20", "0.0", "0.1234567", "12", "64", "1/3")
_EXPONENTS = (
    "2", "3", "-1", "-2", "1/2", "-1/2", "0.65", "1.05", "13/20", "-0.65", "7/13", "101/100", "1e-2", "m", "1/m", "m/2", "1 - m", "-m",
    "2.5", "3.0012", "0", "1", "2/3", "0.05", "20/13", "1.2*m", "m + 0.65", "-7/13",
)  # fmt: skip
_ODD_NUMBERS = (
    "007", "00", "08.5", "0_1", "\u0663", "\u00b2", "1e999", "1e", "5e-401", "1..2", "0x1", "1j", "9" * 401, "00.5", "1e007", "0e0",
    "\uff11",
)  # fmt: skip
_BLANKS = ("", "", "", " ", "  ", "\t", "\n")
_ODD_BLANKS = ("\r", "\u00a0", "\f", "\v", "\u2003", "\u200b", "\x1c", "\x85")
_WORDS = (
    "abs", "sqrt", "exp", "log", "log10", "sin", "cos", "tan", "asin", "acos", "atan", "sinh", "cosh", "tanh", "pos", "neg", "sign",
)  # fmt: skip
_ODD_ENDS = (
    "+", "*", ")", "(", ",", "^2", "//2", "%2", "==0", "!", ".a", "[0]", "#", ";", " a", " 2", "(a)", "and a", "if a", "\\", "'", "**",
    "<1", "=1",
)  # fmt: skip
_ODD_PARTS = (
    "a/0", "a/0.0", "1/(2 - 2)", "0**-1", "sqrt(-1)", "(-2)**0.5", "log(0)", "log(-1)", "asin(2)", "acos(-3/2)", "(-8)**(1/3)",
    "(-1)**m", "0**m", "exp(701)", "2**65", "a**1001", "3**-70", "atan2(0, 0)", "sqrt(1 - 2)", "log(cos(2))", "1/sin(0)", "log(1 - 1)",
    "norm()", "max()", "abs(a, b)", "where(a, 1, 2)", "where(a > 0, 1)", "a < b", "(a > 0) + 1", "where(0 < a < 1, a, b)", "not a",
    "a and b", "f(a)", "zoo", "I", "oo", "nan", "True", "None", "lambda", "abs", "where(not a > 0, a, b)", "where(a == 0, a, b)",
    "where(a > 0 or, 1, 2)", "where(1 > 0, a, 1/0)", "where(2 > 3, sqrt(-2), a)", "atan2(atan2(a, b), 1)", "eigmax(a, b)", "0*log(-2)",
    "a/(b - b)", "pi/0", "acos(2*pi)", "tan(pi/2)", "sqrt(-exp(1))", "log(-abs(a))", "sqrt(-1 - a**2)", "max(a, 1/0)", "(1/2)**-64",
    "(1/0)*0", "abs(a,)", "a b", "2a", "2 a", "a2(1)",
)  # fmt: skip


@dataclass(frozen=True)
class Drawn:
    """A source of texts; the share ``odd`` of its parts is not of the language, or has no value."""

    rng: Random
    odd: float = 0.0

    def text(self, depth: int) -> str:
        """A formula."""
        made = self._formula(depth)
        if self._strange():
            made += self.rng.choice(_ODD_ENDS)
        return self._blank() + made + self._blank()

    def comparison(self, depth: int) -> str:
        """Two formulas compared."""
        return f"{self._formula(depth)} {self.rng.choice(('<', '<=', '>', '>='))} {self._formula(depth)}"

    def number(self) -> str:
        return self.rng.choice(_ODD_NUMBERS if self._strange() else _NUMBERS)

    def _strange(self) -> bool:
        return self.odd > 0 and self.rng.random() < self.odd

    def _blank(self) -> str:
        return self.rng.choice(_ODD_BLANKS if self._strange() else _BLANKS)

    def _formula(self, depth: int) -> str:
        rng = self.rng
        if self._strange():
            return rng.choice(_ODD_PARTS)
        if depth <= 0 or rng.random() < 0.1:
            return rng.choice((*NAMES, *NAMES, "pi")) if rng.random() < 0.65 else self.number()
        shape = rng.random()
        if shape < 0.08:
            return f"{rng.choice('-+-')}{self._blank()}{self._formula(depth - 1)}"
        if shape < 0.36:
            parts = [self._formula(depth - 1) for _ in range(rng.choice((2, 2, 3)))]
            made = parts[0]
            for part in parts[1:]:
                made += f"{self._blank()}{rng.choice('+-*/')}{self._blank()}{part}"
            return f"({made})" if rng.random() < 0.6 else made
        if shape < 0.62:
            return self._power(depth)
        if shape < 0.68:
            return f"({self._blank()}{self._formula(depth - 1)}{self._blank()})"
        return self._word(depth)

    def _power(self, depth: int) -> str:
        rng, inner = self.rng, self._formula(depth - 1)
        base = rng.choice((f"abs({inner})", f"abs({inner})", f"({inner})", rng.choice(NAMES), f"norm({inner}, b)", self.number()))
        exponent = rng.choice(_EXPONENTS) if rng.random() < 0.85 else self._formula(min(depth - 1, 1))
        bare = exponent.replace(".", "").lstrip("-").isalnum() and rng.random() < 0.6
        return f"{base}{self._blank()}**{self._blank()}{exponent if bare else f'({exponent})'}"

    def _word(self, depth: int) -> str:
        rng = self.rng
        kind = rng.random()
        if kind < 0.5:
            return f"{rng.choice(_WORDS)}{self._blank()}({self._formula(depth - 1)})"
        if kind < 0.75:
            parts = [self._formula(depth - 1) for _ in range(rng.choice((1, 2, 2, 3)))]
            return f"{rng.choice(('norm', 'max', 'min'))}({f',{self._blank()}'.join(parts)})"
        if kind < 0.8:
            return f"atan2({self._formula(depth - 1)}, {self._formula(depth - 1)})"
        if kind < 0.82:
            return f"eigmax({', '.join(self._formula(0) for _ in range(6))})"
        joined = self.comparison(min(depth - 1, 1))
        for _ in range(rng.choice((0, 0, 0, 1, 2))):
            joined += f" {rng.choice(('and', 'or'))} {self.comparison(0)}"
        return f"where({joined}, {self._formula(depth - 1)}, {self._formula(depth - 1)})"
