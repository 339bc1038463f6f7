"""What duhem can say about a claim, as frozen values.

``proved``: there is a proof that covers the whole declared domain.  ``refuted``: there is an exact counterexample, the witness.
``tested``: samples showed no violation; this is not a proof.  ``undecided``: no method decided it within its budget.
``not_applicable``: the claim has no meaning for this law, or (for duality) duhem found no closed form that could be proved.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Any, ClassVar

from duhem.expression.number import nearest_double
from duhem.law.frozen_mapping import FrozenMapping
from duhem.show.printing import Shown

__all__ = ["ClaimResult", "Evidence", "Proof", "Trust", "Unsettled", "Verdict", "Witness"]


_MOST = 60  # characters of parameters in one line

_FORM = "tried: constraints, ranges, other forms and plain values of the parameters; none of them settles the claim"


class Verdict(StrEnum):
    """The five answers; their values are the words of the JSON report."""

    PROVED = "proved"
    REFUTED = "refuted"
    TESTED = "tested"
    UNDECIDED = "undecided"
    NOT_APPLICABLE = "not_applicable"


class Trust(StrEnum):
    """What one relies on when one uses a proof; the values are the words of the JSON report.

    ``checked``: the kernel, a small program that uses no other part of duhem, confirmed the proof from the formula of the law.
    ``solver``: one step of the proof relied on an SMT result that nothing else has checked; versions before this one made such proofs.
    ``prover``: the kernel has no rule for this argument, so the proof relies on the method that is named.
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


@dataclass(frozen=True, repr=False)
class Witness(Shown):
    """An exact violation, re-checkable by hand.

    ``parameters`` and ``points`` hold exact rationals as strings (``points`` by role, each a mapping from force
    or pressure name to coordinate).  ``values`` are enclosures ``[low, high]`` in decimal, outward rounded, of the
    quantities whose signs make the violation; ``statement`` says how to read them.
    ``measures`` are extra figures such as ``deviation_degrees``.
    """

    printed_by: ClassVar[str] = "duhem.proof.report"

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

    def __repr__(self) -> str:
        at = ", ".join(f"{name} = {value}" for name, value in self.parameters.items())
        return f"<Witness{' at ' * bool(at)}{at if len(at) <= _MOST else 'parameters of its own'}: {', '.join(self.points)}>"

    def numbers(self) -> dict[str, Any]:
        """``parameters`` and ``points`` as the nearest doubles, None beyond them: for tables and pictures, not for a second check."""
        points = {role: {name: nearest_double(x) for name, x in point.items()} for role, point in self.points.items()}
        return {"parameters": {name: nearest_double(x) for name, x in self.parameters.items()}, "points": points}

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
class Unsettled:
    """What is said of a claim that is neither proved nor refuted.

    ``inequality`` is what is open; ``part`` the smallest part of the formula that no rule reads, and ``why``.  ``place`` has forces and
    parameters, in decimals, where a search in floats found the least ``margin`` of what it measures.  ``actions`` help, or may.
    """

    inequality: str
    part: str | None = None
    why: str | None = None
    place: Mapping[str, str] = field(default_factory=FrozenMapping)
    measure: str | None = None
    margin: float | None = None
    actions: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        object.__setattr__(self, "place", FrozenMapping(self.place))

    def to_dict(self) -> dict[str, Any]:
        """As the JSON report has it."""
        closest = None if self.margin is None else {"place": dict(self.place), "measure": self.measure, "margin": self.margin}
        return {"inequality": self.inequality, "part": self.part, "why": self.why, "closest": closest, "try": list(self.actions)}

    def sentences(self) -> tuple[str, ...]:
        """The same in words."""
        place = ", ".join(f"{name} = {value}" for name, value in self.place.items())
        return (
            f"open: {self.inequality}",
            *(() if self.part is None else (f"no rule reads: {self.part}, which {self.why}",)),
            *(() if self.margin is None else (f"closest: {self.measure} is {self.margin:g} at {place}",)),
            *(f"try: {action}" for action in self.actions),
            *((_FORM,) if self.part is not None and not self.actions else ()),
        )


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

    @classmethod
    def refuted_by(cls, found: Iterable[Witness | None], method: str, detail: str) -> Evidence | None:
        """By the first witness that was found, if any was."""
        return next((cls(Verdict.REFUTED, method, detail, witness) for witness in found if witness is not None), None)


@dataclass(frozen=True, repr=False)
class ClaimResult(Shown):
    """One row of the verdict table; ``seconds`` of wall clock, ``scope`` what the verdict ranges over.

    ``trust`` says what a proof rests on; ``proof`` is how the kernel confirmed it; ``steps`` is what it cost, counted.
    ``unsettled`` says what is open of a claim that is neither proved nor refuted.
    """

    printed_by: ClassVar[str] = "duhem.proof.report"

    claim: str
    verdict: Verdict
    method: str
    scope: str
    seconds: float
    detail: str
    witness: Witness | None = None
    trust: Trust | None = None
    proof: Proof | None = None
    steps: int = 0
    unsettled: Unsettled | None = None

    def __repr__(self) -> str:
        trust = "" if self.trust is None else f", {self.trust}"
        return f"<{self.claim} {self.verdict} by {self.method}{trust}>"

    def to_dict(self) -> dict[str, Any]:
        """The row as the JSON report has it."""
        return {
            "claim": self.claim,
            "verdict": self.verdict.value,
            "trust": None if self.trust is None else self.trust.value,
            "method": self.method,
            "scope": self.scope,
            "seconds": round(self.seconds, 4),
            "detail": self.detail,
            "open": None if self.unsettled is None else self.unsettled.to_dict(),
            "witness": None if self.witness is None else self.witness.to_dict(),
            "witness_numbers": None if self.witness is None else self.witness.numbers(),
        }
