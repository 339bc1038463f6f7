"""A claim: what it states, what it rests on, and the methods that may try it, cheapest sound one first."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any, Generic, TypeVar

from duhem.proof.facts.subject import Subject
from duhem.proof.verdict import CONTRADICTION, Evidence, Verdict

__all__ = ["Claim", "Consequence", "ProofMethod", "words"]

S = TypeVar("S", bound=Subject)
Settled = Mapping[str, Evidence]  # claims decided before, by name


@dataclass(frozen=True)
class ProofMethod(Generic[S]):
    """A method of proof or refutation: ``run`` answers, or passes with None, for the kind of law it ``takes``."""

    takes: type[S]
    run: Callable[[S], Evidence | None]

    def answer(self, subject: Subject, settled: Settled) -> Evidence | None:
        """What the method says of the law, whatever was settled before."""
        return self.run(subject) if isinstance(subject, self.takes) else None


@dataclass(frozen=True)
class Consequence(Generic[S]):
    """A method that starts from the evidence of the claims its own claim ``needs``."""

    takes: type[S]
    run: Callable[[S, Settled], Evidence | None]

    def answer(self, subject: Subject, settled: Settled) -> Evidence | None:
        """What follows for the law from what was settled before."""
        return self.run(subject, settled) if isinstance(subject, self.takes) else None


def words(method: ProofMethod[Any] | Consequence[Any], claim: str) -> str:
    """What a method is called while it is tried for the claim: its place in the code, in words."""
    function: Any = method.run.func if isinstance(method.run, partial) else method.run
    own, part = function.__module__.rpartition(".")[2], function.__name__.removeprefix(claim)
    return " ".join(f"{own} {part}".removeprefix(claim).replace("_", " ").split()) or claim.replace("_", " ")


@dataclass(frozen=True)
class Claim:
    """``methods`` try in order, each on the kind of law it takes; ``needs`` names the claims to be settled before.

    ``steps`` is what its methods may cost, whatever other claims cost; what is then still open stays undecided.
    ``refuters`` are the cheap ones among its methods; they look after a proof too where nobody else has confirmed it.
    """

    name: str
    statement: str
    theory: str
    methods: tuple[ProofMethod[Any] | Consequence[Any], ...]
    needs: tuple[str, ...] = ()
    steps: int = 16_000_000
    refuters: tuple[ProofMethod[Any], ...] = ()

    def examine(
        self,
        subject: Subject,
        settled: Settled,
        confirmed: Callable[[Evidence], bool] = lambda _: False,
        on_method: Callable[[str], None] = lambda _: None,
    ) -> Evidence:
        """The first answer, or ``undecided`` when every method passed.

        Of a law that may be undefined somewhere only a proof that is ``confirmed`` counts: who confirms it looks at what it needs.
        ``on_method`` is told of each method for this kind of law before it tries.
        """
        subject.allow(self.steps)
        for method in self.methods:
            if isinstance(subject, method.takes):
                on_method(words(method, self.name))
            found = method.answer(subject, settled)
            if found is not None and self._counts(found, subject, confirmed):
                return found
        return Evidence(Verdict.UNDECIDED, "none", "no method decided it within its budget of steps")

    def _counts(self, found: Evidence, subject: Subject, confirmed: Callable[[Evidence], bool]) -> bool:
        if found.witness is not None:
            return subject.may_refute(self.name, found.witness.points.values())
        return found.verdict is not Verdict.PROVED or subject.may_prove(self.name) or confirmed(found)

    def contradiction(self, subject: Subject, settled: Settled) -> Evidence | None:
        """What is left of a proof that a refuter disagrees with: one of the two is wrong, and who reads it is told so."""
        subject.allow(self.steps)
        for method in self.refuters:
            found = method.answer(subject, settled)
            if found is not None and found.witness is not None and subject.may_refute(self.name, found.witness.points.values()):
                where = {**found.witness.parameters, **{role: dict(point) for role, point in found.witness.points.items()}}
                detail = (
                    f"{settled[self.name].method} proved it and {found.method} refutes it at {where}: a defect of duhem, please report it"
                )
                return Evidence(Verdict.UNDECIDED, CONTRADICTION, detail)
        return None
