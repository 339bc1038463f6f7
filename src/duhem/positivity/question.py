"""The one question every proof comes down to: is an expression >= 0 (or > 0, or = 0) wherever some relations hold?"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum
from typing import Any

import sympy as sp

__all__ = ["Answer", "Question", "Sense"]


class Sense(StrEnum):
    """What is asked of the expression."""

    NONNEGATIVE = ">="
    POSITIVE = ">"
    ZERO = "=="


@dataclass(frozen=True)
class Question:
    """For all real values of the symbols that satisfy every relation of ``given``: ``expr sense 0``?

    ``circle`` names two symbols x, y restricted to x^2 + y^2 = 1.
    """

    expr: sp.Expr
    sense: Sense
    given: tuple[sp.Basic, ...] = ()
    circle: tuple[sp.Symbol, sp.Symbol] | None = None


@dataclass(frozen=True)
class Answer:
    """``holds`` True: proved by ``method``; False: ``point`` suggests a violation, not yet checked; None: not decided."""

    holds: bool | None
    method: str = ""
    point: Mapping[sp.Symbol, Any] | None = None
    reason: str = ""
