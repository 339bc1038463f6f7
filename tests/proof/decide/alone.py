"""Each decider by itself, given little: an open answer is never wrong."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from duhem.proof.decide import Answer, Budget, Question, decide
from duhem.proof.decide.deciders import by_rules
from duhem.proof.decide.enclosure import by_enclosure
from duhem.proof.decide.exact import by_exact
from duhem.proof.decide.line_cells import by_cells
from duhem.proof.decide.plane_curve import by_plane
from duhem.proof.decide.plane_region import by_region
from duhem.proof.decide.polynomials import System
from duhem.proof.decide.smt import by_smt

__all__ = ["OF_QUESTIONS", "OF_SYSTEMS"]

_STEPS = 100_000

OF_SYSTEMS: Mapping[str, Callable[[System], Answer]] = {
    "exact": lambda system: by_exact(system, Budget(_STEPS)),
    "cells": lambda system: by_cells(system, Budget(_STEPS)),
    "curve": lambda system: by_plane(system, Budget(_STEPS)),
    "region": lambda system: by_region(system, Budget(_STEPS)),
    "smt": lambda system: by_smt(system, Budget(_STEPS)),
}
OF_QUESTIONS: Mapping[str, Callable[[Question], Answer]] = {
    "all": lambda question: decide(question, Budget(_STEPS)),
    "rules": by_rules,
    "enclosure": lambda question: by_enclosure(question, Budget(_STEPS // 5)),
}
