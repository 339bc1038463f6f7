"""Exit codes of the commands: one meaning each, fixed by the interface."""

from __future__ import annotations

__all__ = ["FAILED", "HELD", "INTERRUPTED", "MEANINGS", "REFUTED", "UNDECIDED", "USAGE"]

HELD, REFUTED, USAGE, UNDECIDED, FAILED, INTERRUPTED = 0, 1, 2, 3, 4, 130

MEANINGS = {
    HELD: "nothing refuted",
    REFUTED: "something refuted",
    USAGE: "usage or file error",
    UNDECIDED: "undecided with --strict",
    FAILED: "internal or solver failure",
    INTERRUPTED: "interrupted",
}
