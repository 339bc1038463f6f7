"""Input that must not be answered: it has to raise and to name the argument and the index."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from duhem.benchmark.contenders import Contender
from duhem.benchmark.specimen import Specimen
from duhem.errors import InputError

__all__ = ["Refusal", "refusals"]


@dataclass(frozen=True)
class Refusal:
    """One bad input: ``held`` whether the method raised InputError naming ``place``; ``answer`` what it said or did instead."""

    what: str
    method: str
    place: str
    held: bool
    answer: str


def refusals(specimen: Specimen, contender: Contender) -> Iterator[Refusal]:
    """The bad inputs in turn, each the last of three increments."""
    d = len(specimen.law.forces)
    good = np.full((3, d), 0.5)
    for value in (np.nan, np.inf, -np.inf):
        trial = good.copy()
        trial[2, d - 1] = value
        yield _asked(specimen, contender, f"trial {value}", f"trial[2, {d - 1}]", trial, specimen.pressure)
    if specimen.pressure is not None:
        for value in (np.nan, -np.inf, 1.0):
            pressure = np.array([-1.0, -1.0, value])
            yield _asked(specimen, contender, f"pressure {value}", "pressure[2]", good, pressure)
    for value in (np.nan, np.inf, 0.0, -1.0):
        k = np.ones(d)
        k[d - 1] = value
        yield _asked(specimen, contender, f"stiffness {value}", f"stiffness[{d - 1}]", good, specimen.pressure, k)


def _asked(specimen: Specimen, contender: Contender, what: str, place: str, trial: object, pressure: object, k: object = None) -> Refusal:
    try:
        done = contender.project(specimen, trial, pressure, k)  # type: ignore[arg-type]
    except InputError as fault:
        return Refusal(what, contender.name, place, place in str(fault), str(fault))
    except Exception as fault:  # an error of another kind says less than it should
        return Refusal(what, contender.name, place, False, f"{type(fault).__name__}: {fault}")
    return Refusal(what, contender.name, place, False, f"answered {done.stress[-1].tolist()}")
