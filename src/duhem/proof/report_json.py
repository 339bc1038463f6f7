"""The JSON object of ``duhem verify --format json``."""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from duhem.version import __version__

if TYPE_CHECKING:
    from duhem.law.curve_law import Law
    from duhem.proof.verification import ClaimResult, Verification

__all__ = ["complete", "interrupted"]


def complete(verification: Verification) -> str:
    """The object of a finished run."""
    return json.dumps(verification.to_dict(), indent=2, ensure_ascii=False)


def interrupted(law: Law, results: Sequence[ClaimResult], effort: str = "normal") -> str:
    """The same object with the claims decided so far; nothing is concluded from them."""
    claims = [result.to_dict() for result in results]
    head = {
        "duhem": __version__,
        "criterion": law.name,
        "parameters": {n: d.plain() for n, d in law.parameters.items()},
        "domains": {n: d.numbers() for n, d in law.parameters.items()},
    }
    asked = {} if effort == "normal" else {"effort": effort}
    tail: dict[str, Any] = {"generalized_standard": None, "dissipative": None, "left_out": [], "remarks": [], "interrupted": True}
    return json.dumps(head | asked | {"claims": claims} | tail, indent=2, ensure_ascii=False)
