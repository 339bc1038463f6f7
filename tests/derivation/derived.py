"""The derivations of the built-in laws, each made once for the tests of the whole folder."""

from __future__ import annotations

from functools import cache

from duhem.derivation import Derivation, derive
from duhem.law.catalogue import load

__all__ = ["LAWS", "derived"]

LAWS = (
    "antoni2007", "antoni2007-1d", "box", "capped", "cohesive", "coulomb", "drucker1949", "hosford", "limacon", "lobes", "matchstick",
    "orthotropic", "polygon", "quartic", "radial-flow", "regularised", "rotated-flow", "shifted-ellipse", "superellipse", "tresca",
    "von-mises",
)  # fmt: skip
EVERY_RUN = (  # of smooth laws, of some with corners, of each flow: those that are derived soonest
    "antoni2007", "antoni2007-1d", "box", "coulomb", "limacon", "matchstick", "radial-flow",
)  # fmt: skip


@cache
def derived(name: str, stiffness: str = "orthotropic") -> Derivation:
    return derive(load(name), stiffness=stiffness)
