"""How much is drawn: a name for how many cases a routine is put to, and whether they are the same in every run."""

from __future__ import annotations

from typing import Any

__all__ = ["PROFILES"]

# as the arguments of :func:`duhem.testing.conformance`: cases of some 30 increments, and the seed where they repeat themselves;
# those of duhem test
PROFILES: dict[str, dict[str, Any]] = {
    "dev": {"max_examples": 30},
    "ci": {"max_examples": 100, "seed": 0},
    "deep": {"max_examples": 2000},
}
