"""The nearest admissible law of a law whose K is not convex, with the change of its limit load."""

from __future__ import annotations

from duhem.regions.mending.entry import Mended, Tried, mend

__all__ = ["Mended", "Tried", "mend"]
