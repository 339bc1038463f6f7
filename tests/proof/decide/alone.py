"""Each decider by itself, given little: an open answer is never wrong."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from duhem.proof.decide import Answer, Budget, Question, by_rules, decide
from duhem.proof.decide.smt import System, by_smt

__all__ = ["OF_QUESTIONS", "OF_SYSTEMS"]

_STEPS = 100_000

OF_SYSTEMS: Mapping[str, Callable[[System], Answer]] = {
    "smt": lambda system: by_smt(system, Budget(_STEPS)),
}
OF_QUESTIONS: Mapping[str, Callable[[Question], Answer]] = {
    "all": lambda question: decide(question, Budget(_STEPS)),
    "rules": by_rules,
}
