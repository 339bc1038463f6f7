"""What is asked of each row: an inquiry is a value that can be sent to another process, with an answer for each line."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import dataclass
from typing import ClassVar, NamedTuple, Protocol, TypeAlias

from duhem.law.curve_law import Law

__all__ = ["Answer", "Answered", "Claimed", "Inquiry"]


class Answered(NamedTuple):
    """One line of a row: of which claim, and what came of it; ``witness`` is JSON text, ``steps`` what it cost, counted."""

    claim: str
    verdict: str | None
    method: str | None
    trust: str | None
    witness: str | None
    steps: int
    seconds: float


Answer: TypeAlias = tuple[str, str | None, str | None, str | None, str | None, int, float]
"""The fields of :class:`Answered` in turn, as rooms give them that do not know this one."""


class Inquiry(Protocol):
    """``names`` are the lines that each row has, whatever comes of it; ``options`` what the command line names beside the campaign.

    ``alone`` says that a row may leave behind what the next one meets, so that each is asked in a process of its own.
    """

    @property
    def names(self) -> tuple[str, ...]: ...

    @property
    def options(self) -> tuple[str, ...]: ...

    @property
    def alone(self) -> bool: ...

    def told(self) -> str:
        """The inquiry in words that tell it from every other."""
        ...

    def answers(self, law: Law) -> Iterator[Answer]:
        """A line for each name; InputError where the law cannot be asked."""
        ...


@dataclass(frozen=True)
class Claimed:
    """The claims of :func:`duhem.verify`, over what the row leaves open of the parameters."""

    claims: tuple[str, ...]
    effort: str = "normal"
    options: ClassVar[tuple[str, ...]] = ()
    alone: ClassVar[bool] = False

    @property
    def names(self) -> tuple[str, ...]:
        return self.claims

    def told(self) -> str:
        return f"claims {','.join(self.claims)} {self.effort}"

    def answers(self, law: Law) -> Iterator[Answered]:
        from duhem.proof.verification import claim_results

        for r in claim_results(law, self.claims, self.effort):
            witness = None if r.witness is None else json.dumps(r.witness.to_dict())
            trust = None if r.trust is None else r.trust.value
            yield Answered(r.claim, r.verdict.value, r.method, trust, witness, r.steps, round(r.seconds, 6))
