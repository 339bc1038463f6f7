"""The nearest admissible law of a law whose K is not convex, with the change of its limit load."""

from __future__ import annotations

from duhem.mending.entry import WAYS, mend
from duhem.mending.result import Mended, Tried

__all__ = ["WAYS", "Mended", "Tried", "mend"]
