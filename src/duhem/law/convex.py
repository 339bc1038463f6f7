"""What a caller may say of a set K: look whether it is shown to be convex, refuse one that is not, or take it as it is."""

from __future__ import annotations

from duhem.errors import InputError

__all__ = ["CONVEX", "check_convex"]

CONVEX = ("ask", "require", "assume")


def check_convex(convex: object) -> None:
    """InputError for what is none of CONVEX."""
    if not isinstance(convex, str) or convex not in CONVEX:
        raise InputError(f"convex = {convex!r} is not a choice", where="convex", remedy=f"choose {', '.join(CONVEX)}")
