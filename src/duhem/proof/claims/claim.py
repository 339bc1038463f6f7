"""A claim: what it states, what it rests on, and the methods that may try it, cheapest sound one first."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any, Generic, Protocol, TypeVar

from duhem.proof.facts.subject import Subject
from duhem.proof.verdict import CONTRADICTION, Evidence, Verdict

__all__ = ["CHEAP", "DEAR", "Claim", "Consequence", "Finder", "Kernel", "ProofMethod", "Rules", "words"]

S = TypeVar("S", bound=Subject)
Settled = Mapping[str, Evidence]  # claims decided before, by name


class Kernel(Protocol):
    """Who decides what is proved, by rules of its own."""

    def proof(self, claim: str, steps: int) -> Evidence | None:
        """The first of its rules that proves the claim without evidence, each within so many steps; None where none does."""

    def confirms(self, claim: str, evidence: Evidence) -> bool:
        """Whether it accepts a proof of the claim."""


class _Nobody:
    """A kernel without rules, for who asks a claim's methods alone."""

    def proof(self, claim: str, steps: int) -> None:
        return None

    def confirms(self, claim: str, evidence: Evidence) -> bool:
        return False


NOBODY = _Nobody()


@dataclass(frozen=True)
class Rules:
    """The kernel's rules that need no evidence, as a method of proof of either kind of law; each may cost so many ``steps``."""

    steps: int
    takes: type[Any] = Subject


@dataclass(frozen=True)
class ProofMethod(Generic[S]):
    """A method of proof or refutation: ``run`` answers, or passes with None, for the kind of law it ``takes``."""

    takes: type[S]
    run: Callable[[S], Evidence | None]


@dataclass(frozen=True)
class Consequence(Generic[S]):
    """A method that starts from the evidence of the claims its own claim ``needs``."""

    takes: type[S]
    run: Callable[[S, Settled], Evidence | None]


@dataclass(frozen=True)
class Finder(Generic[S]):
    """A method that finds evidence and decides nothing: the first of its proofs that the kernel confirms counts, and no other."""

    takes: type[S]
    run: Callable[[S], Iterable[Evidence]]


Method = Rules | ProofMethod[Any] | Consequence[Any] | Finder[Any]
CHEAP, DEAR = Rules(500_000), Rules(10_000_000)


def words(method: Method, claim: str) -> str:
    """What a method is called while it is tried for the claim: its place in the code, in words."""
    if isinstance(method, Rules):
        return "kernel"
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
    methods: tuple[Method, ...]
    needs: tuple[str, ...] = ()
    steps: int = 16_000_000
    refuters: tuple[ProofMethod[Any], ...] = ()

    def examine(
        self,
        subject: Subject,
        settled: Settled,
        kernel: Kernel = NOBODY,
        on_method: Callable[[str], None] = lambda _: None,
    ) -> Evidence:
        """The first answer, or ``undecided`` when every method passed.

        Of a law that may be undefined somewhere only a proof that the ``kernel`` confirms counts: it asks itself what its rule needs.
        ``on_method`` is told of each method for this kind of law before it tries.
        """
        subject.allow(self.steps)
        for method in self.methods:
            if not isinstance(subject, method.takes):
                continue
            on_method(words(method, self.name))
            match method:
                case Rules():
                    found = kernel.proof(self.name, method.steps)
                case Finder():
                    found = next((proof for proof in method.run(subject) if kernel.confirms(self.name, proof)), None)
                case _:
                    found = method.run(subject, settled) if isinstance(method, Consequence) else method.run(subject)
                    found = found if found is not None and self._counts(found, subject, kernel) else None
            if found is not None:
                return found
        return Evidence(Verdict.UNDECIDED, "none", "no method decided it within its budget of steps")

    def _counts(self, found: Evidence, subject: Subject, kernel: Kernel) -> bool:
        if found.witness is not None:
            return subject.may_refute(self.name, found.witness.points.values())
        return found.verdict is not Verdict.PROVED or subject.may_prove(self.name) or kernel.confirms(self.name, found)

    def contradiction(self, subject: Subject, settled: Settled) -> Evidence | None:
        """What is left of a proof that a refuter disagrees with: one of the two is wrong, and who reads it is told so."""
        subject.allow(self.steps)
        for method in self.refuters:
            found = method.run(subject) if isinstance(subject, method.takes) else None
            if found is not None and found.witness is not None and subject.may_refute(self.name, found.witness.points.values()):
                where = {**found.witness.parameters, **{role: dict(point) for role, point in found.witness.points.items()}}
                detail = (
                    f"{settled[self.name].method} proved it and {found.method} refutes it at {where}: a defect of duhem, please report it"
                )
                return Evidence(Verdict.UNDECIDED, CONTRADICTION, detail)
        return None
