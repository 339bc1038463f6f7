"""A law under examination: what is derived from it, each form once, within a time allowance that the verification renews."""

from __future__ import annotations

import time
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator
from functools import wraps
from typing import Any, TypeVar

from duhem.law.curve_law import Law
from duhem.proof.decide import Answer, Question, decide
from duhem.proof.facts.parameter_choices import Values

__all__ = ["Subject", "fact"]


class Subject(ABC):
    """What the methods of proof are asked about; a law given by a formula and one given by a boundary curve differ in the rest."""

    law: Law

    def __init__(self, question_seconds: float) -> None:
        self._question_seconds = question_seconds
        self._deadline = float("inf")
        self._answers: dict[Question, Answer] = {}
        self.known: dict[object, Any] = {}  # kept by `fact`, which knows the types

    def allow(self, seconds: float) -> None:
        """What is asked from now on shares this many seconds; what comes after is left open."""
        self._deadline = time.monotonic() + seconds

    @property
    def exhausted(self) -> bool:
        """Whether the time allowed has run out."""
        return time.monotonic() >= self._deadline

    def seconds(self, most: float) -> float:
        """What is left of the time allowed, at most ``most``."""
        return min(most, self._deadline - time.monotonic())

    def decided(self, question: Question) -> Answer:
        """The deciders' answer; one that leaves the question open is not kept."""
        known = self._answers.get(question)
        if known is not None and known.holds is not None:
            return known
        seconds = self.seconds(self._question_seconds)
        if seconds <= 0:
            return Answer(None, reason="the claim's time ran out")
        answer = self._answers[question] = decide(question, seconds)
        return answer

    def may_prove(self, claim: str) -> bool:
        """Whether a proof of the claim by any method counts."""
        return True

    @abstractmethod
    def choices(self, most: int) -> Iterator[Values]:
        """Exact values of the free parameters inside the domain, the plainest first."""


S = TypeVar("S", bound=Subject)
T = TypeVar("T")


def fact(derive: Callable[[S], T]) -> Callable[[S], T]:
    """A derived form, made at most once for a subject; None says that it was not found in time, and is asked for again."""

    @wraps(derive)
    def once(subject: S) -> T:
        found: T | None = subject.known.get(derive)
        if found is None and (made := derive(subject)) is not None:
            found = subject.known[derive] = made
        return found  # type: ignore[return-value]

    return once
