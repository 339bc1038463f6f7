"""What duhem can say about a claim, as frozen values.

``proved``: a sound method decided it over the whole declared domain.  ``refuted``: an exact witness violates it.
``tested``: sampling found no violation, which proves nothing.  ``undecided``: no method decided it.
``not_applicable``: the claim has no content for this law.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Any

from duhem.law.frozen_mapping import FrozenMapping

__all__ = ["CONTRADICTION", "Evidence", "Proof", "Trust", "Verdict", "Witness"]


CONTRADICTION = "contradiction"  # the method of a claim that one method proved and another refutes


class Verdict(StrEnum):
    """The five answers; their values are the words of the JSON report."""

    PROVED = "proved"
    REFUTED = "refuted"
    TESTED = "tested"
    UNDECIDED = "undecided"
    NOT_APPLICABLE = "not_applicable"


class Trust(StrEnum):
    """What a proof rests on; their values are the words of the JSON report.

    ``checked``: the kernel confirmed it against the law's formula as written.  ``solver``: a solver's word stands for a step
    of it.  ``prover``: the kernel has no rule for its argument.
    """

    CHECKED = "checked"
    SOLVER = "solver"
    PROVER = "prover"

    @classmethod
    def weakest(cls, *trusts: Trust) -> Trust:
        """What rests on all of them has this."""
        return max(trusts, key=list(cls).index)


@dataclass(frozen=True)
class Proof:
    """What the kernel needs to confirm a claim: the name of its rule, and evidence of text, whole numbers and lists of them."""

    rule: str
    evidence: Mapping[str, Any] = field(default_factory=FrozenMapping)

    def __post_init__(self) -> None:
        object.__setattr__(self, "evidence", FrozenMapping(self.evidence))


@dataclass(frozen=True)
class Witness:
    """An exact violation, re-checkable by hand.

    ``parameters`` and ``points`` hold exact rationals as strings (``points`` by role, each a mapping from force
    or pressure name to coordinate).  ``values`` are enclosures ``[low, high]`` in decimal, outward rounded, of the
    quantities whose signs make the violation; ``statement`` says how to read them.
    ``measures`` are extra figures such as ``deviation_degrees``.
    """

    parameters: Mapping[str, str]
    points: Mapping[str, Mapping[str, str]]
    values: Mapping[str, tuple[str, str]]
    statement: str
    measures: Mapping[str, float] = field(default_factory=FrozenMapping)

    def __post_init__(self) -> None:
        put = object.__setattr__
        put(self, "points", FrozenMapping({role: FrozenMapping(point) for role, point in self.points.items()}))
        for name in ("parameters", "values", "measures"):
            put(self, name, FrozenMapping(getattr(self, name)))

    def to_dict(self) -> dict[str, Any]:
        """Plain dictionaries and lists, ready for JSON; the measures stand at the top level."""
        return {
            "parameters": dict(self.parameters),
            "points": {role: dict(point) for role, point in self.points.items()},
            "values": {name: list(pair) for name, pair in self.values.items()},
            "statement": self.statement,
            **self.measures,
        }


@dataclass(frozen=True)
class Evidence:
    """One method's answer to one claim: verdict, the method's name, and the argument in a sentence.

    ``proof`` is offered to the kernel; without one it tries what needs no evidence.
    """

    verdict: Verdict
    method: str
    detail: str
    witness: Witness | None = None
    proof: Proof | None = None

    def __post_init__(self) -> None:
        if (self.verdict is Verdict.REFUTED) != (self.witness is not None):
            raise ValueError("a refuted claim carries a witness, and only a refuted one")
