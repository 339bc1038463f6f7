"""The laws of the atlas that have a state as materials: duhem's own implicit step as a routine, whose state are all internal variables."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

import duhem
from duhem.law.atlas.entry import groups
from duhem.law.state import prescribed
from duhem.path.state_step import StateLaw
from duhem.testing import Material, MaterialState

__all__ = ["NAMES", "material"]

Array = np.ndarray
NAMES = [n for n in groups()["states"] if n not in ("frictional-heating", "rate-and-state", "stribeck")]  # of heat, nothing elastic, no K
VALUES = {
    "mu": 0.3, "C": 1.0, "k": 2.0, "w": 0.1, "R": 1.0, "gamma": 0.5, "E": 1.0, "w_1": 0.5, "eta": 1.0, "c": 0.2, "m": 2.0, "H": 0.3,
    "C_1": 1.0, "C_2": 0.5, "gamma_1": 0.3, "gamma_2": 0.2, "Q": 0.5, "b": 0.5, "A": 1.0, "n": 3.0, "sigma_0": 1.0, "Y_0": 0.5,
    "alpha_0": 1.0,
}  # fmt: skip
SOFT = {"slip-softening": {"H": -0.02}}


def material(name: str, store: Callable[[Array, Array], Array] = lambda before, after: after) -> dict[str, Any]:
    """What conformance is given; ``store`` makes of the state before a step and the right one after it what the routine keeps."""
    law = duhem.load(name)
    values = {n: x for n, x in {**VALUES, **SOFT.get(name, {})}.items() if n in law.parameters and n not in law.variables}
    fixed, d = law.fix(values), len(prescribed(law))
    own = StateLaw.of(fixed, 2.0 * np.eye(d) if law.energy is None else None, columns=d)

    def numbers(n: int, pressure: Array | None) -> list[Array]:
        load = np.full(n, -1.0) if pressure is None else pressure
        return [load if x == law.pressure else np.full(n, values[x]) for x in own.others]

    def advance(before: MaterialState, increment: Array, pressure: Array | None, duration: float) -> MaterialState:
        base, strain = np.hstack([before.strain, before.variables]), before.strain + increment
        end = own.advance(base, strain, duration, numbers(len(base), pressure), True)
        return MaterialState(strain, end.observed, store(before.variables, end.chi[:, d:]), tangent=end.tangent, solved=~end.failed)

    whole = (own.low == 0.0) & (own.high == 1.0) & np.array([name == "beta" for name in own.names[d:]])
    first = np.clip(0.0, own.low, own.high) + whole  # an interface begins whole
    stiffness = own.free_energy(np.append(np.zeros(d), first)[None], numbers(1, None))[2][0, :d, :d]
    routine = Material(advance, stiffness, first, name=name)
    given = {"law": law, "update": routine, "parameters": values, "state": {n: i for i, n in enumerate(own.names[d:])}}
    return given | ({"pressure": -1.0} if law.pressure else {}) | ({"scale": 1.0} if law.viscous else {})
