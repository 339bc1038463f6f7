"""What a question or a claim may cost, in steps instead of seconds: counted alike on every machine, busy or idle.

A step is about a microsecond of a core.  z3 counts its own (one unit of its ``rlimit`` is a step); the other engines have
prices, as measured.  What cannot be stopped half-way is priced by its size before it is begun.
"""

from __future__ import annotations

from fractions import Fraction

__all__ = ["ANY_STEPS", "EFFORTS", "Budget"]

ANY_STEPS = 1 << 62  # more than anybody spends
EFFORTS = {"quick": Fraction(1, 8), "normal": Fraction(1), "thorough": Fraction(8)}  # each budget is multiplied by


class Budget:
    """Steps that may still be spent; a part of it draws on the whole as well."""

    def __init__(self, steps: int, whole: Budget | None = None) -> None:
        self._given, self._left, self._whole = steps, steps, whole

    @property
    def spent(self) -> int:
        """How many steps were paid."""
        return self._given - self._left

    @property
    def left(self) -> int:
        """How many steps may be spent at once."""
        return self._left if self._whole is None else min(self._left, self._whole.left)

    def part(self, most: int) -> Budget:
        """Up to ``most`` of the steps that are left."""
        return Budget(min(most, self.left), self)

    def pays(self, steps: int) -> bool:
        """Pay for something before it is done; False, and nothing is paid, where it costs more than is left."""
        if steps > self.left:
            return False
        self._left -= steps
        return self._whole is None or self._whole.pays(steps)
