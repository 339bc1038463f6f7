"""The nearest admissible law of a law whose K is not convex, with the change of its limit load."""

from __future__ import annotations

from duhem.regions.mending.entry import mend
from duhem.regions.mending.result import Mended, Tried

__all__ = ["Mended", "Tried", "mend"]
