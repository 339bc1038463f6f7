"""One implicit step of a law with a state as C functions: the loop of :mod:`duhem.path.state_kernel`, and its tangent.

The observables and the temperature at the end of the step, the state and the time it takes go in; stress, tangent and the new state come
out.  What is not solved, and what is no question, leaves the state as it is and nan in the rest.
"""

from __future__ import annotations

import inspect
from collections.abc import Mapping
from functools import lru_cache
from math import isfinite
from typing import Any

import numpy as np
import sympy as sp
from numpy import nan

from duhem.errors import InputError
from duhem.export.c_translation import Array, c_functions
from duhem.export.routine import Routine, conditions, function_text
from duhem.expression.scalar_jets import scalar_values
from duhem.law.formula_law import Criterion
from duhem.path.compiled_state import loop_text
from duhem.path.state_kernel import CONSTANTS, INNER, KINKS, OTHERS, SEEN, D, S, W, Z, cleared, ended, towards
from duhem.path.state_step import StateLaw
from duhem.projection.newton_step import eliminated

__all__ = ["state_law", "state_routine"]

PARAMETERS = CONDITIONS = NUMBERS = 0  # open parameters, what must hold of them, and the fractions in that


def numbered(q: Any, parameters: Any, pressure: float) -> None:
    """The numbers beside the variables, and the fractions of the formulas, in ``q``."""
    raise NotImplementedError


def behind(w: Any) -> None:
    """The fractions of the law's statements."""
    raise NotImplementedError


def stated(w: Any, out: Any) -> None:
    """1 for each of the declared ranges and constraints that holds."""
    raise NotImplementedError


def bounded(order: Any, low: Any, high: Any) -> None:
    """The variable of each force, and the range of each variable."""
    raise NotImplementedError


def step(
    before: Any, after: Any, pressure: float, temperature: float, dt: float, parameters: Any, state: Any, stress: Any, psi: Any,
    dissipation: Any, tangent: Any,
) -> int:  # fmt: skip
    """Stress, state and tangent at the end of a step; 0 where nothing flows, 1 where something does, else as the head says."""
    v, m, choices, q = np.empty((2, W)), np.empty((1, W, W)), np.empty((1, KINKS), np.int8), np.empty(OTHERS + CONSTANTS + 1)
    at, start, f, h, y, both = np.empty(Z), np.empty(Z), np.empty(Z), np.empty((Z, Z)), np.empty(D + Z), np.empty((D, INNER))
    slope, flows, turn = np.empty((S + 1, D + Z)), np.empty((S + 1, INNER)), np.empty((S + 1, INNER, D + Z))
    rate, change, total, by = np.empty(INNER), np.empty((INNER, D + Z)), np.empty((INNER, D + Z)), np.empty((INNER, INNER))
    held, active, g, known = np.empty(S + 1), np.empty(S + 1, np.int8), np.empty(S + 1), np.empty(S + 1)
    r, size, now, much = np.empty(INNER + S), np.empty(INNER + S), np.empty(INNER + S), np.empty(INNER + S)
    point, made, moved, a = np.empty(Z + S), np.empty(Z), np.empty(INNER), np.empty((INNER + S, INNER + S + 1))
    order, low, high = np.empty(D, np.int8), np.empty(INNER), np.empty(INNER)
    w, out = np.empty(1 + PARAMETERS + NUMBERS), np.empty(CONDITIONS + 1)
    bounded(order, low, high)
    sound = isfinite(pressure) and isfinite(temperature) and isfinite(dt) and dt >= 0.0
    w[0] = pressure
    for j in range(PARAMETERS):
        w[1 + j] = parameters[j]
        sound = sound and isfinite(parameters[j])
    for i in range(Z):
        start[i] = temperature
    for i in range(SEEN):
        start[i] = before[i]
        sound = sound and isfinite(before[i]) and isfinite(after[i])
    for i in range(INNER):
        start[SEEN + i] = state[i]
        sound = sound and low[i] <= state[i] <= high[i]
    for i in range(Z):
        at[i] = start[i]
    for i in range(SEEN):
        at[i] = after[i]
    behind(w)
    stated(w, out)
    for j in range(CONDITIONS):
        sound = sound and out[j] == 1.0
    numbered(q, parameters, pressure)
    psi[0], dissipation[0] = nan, nan
    for i in range(SEEN):
        stress[i] = nan
        for j in range(SEEN):
            tangent[i * SEEN + j] = nan
    if not sound:
        return 3
    cleared(f, h, slope, flows, turn)
    value = ended(
        at, start, held, active, dt, order, low, high, q, v, m, choices, f, h, y, both, slope, flows, turn, rate, change, total, made,
        moved, by, g, known, r, size, a, now, much, point,
    )  # fmt: skip
    if not isfinite(value):
        return 2
    psi[0], dissipation[0], status = value, 0.0, 0
    for k in range(D):
        dissipation[0] += y[k] * moved[order[k]]
    for i in range(SEEN):
        stress[i] = f[i]
    for i in range(INNER):
        state[i] = at[SEEN + i]
        if moved[i] != 0.0:
            status = 1
    count = INNER
    for s in range(S):
        count += active[s]
    for j in range(SEEN):
        towards(a, active, by, flows, slope, both, r)
        for i in range(INNER):
            a[i, count] = total[i, D + j]
            for k in range(D):
                a[i, count] -= total[i, k] * h[SEEN + order[k], j]
        place = INNER
        for s in range(S):
            if active[s] == 1:
                a[place, count] = -slope[s, D + j]
                for k in range(D):
                    a[place, count] += slope[s, k] * h[SEEN + order[k], j]
                place += 1
        if not eliminated(a, count):
            return 5
        for i in range(SEEN):
            tangent[i * SEEN + j] = h[i, j]
            for b in range(INNER):
                tangent[i * SEEN + j] += h[i, SEEN + b] * a[b, count]
    return status


_VARIABLES, _INNER, _EACH = Array("double", ("Z",)), Array("double", ("INNER",)), Array("double", ("INNER + S",))
_ARRAYS: Mapping[str, Array] = {
    "v": Array("double", ("2", "W")),
    "m": Array("double", ("1", "W", "W")),
    "choices": Array("signed char", ("1", "KINKS")),
    "axes": Array("double", ("4", "3")),
    **dict.fromkeys(("q", "w", "out", "parameters"), Array("double", ("1",))),
    **dict.fromkeys(("at", "start", "f", "made"), _VARIABLES),
    **dict.fromkeys(("rate", "moved", "low", "high", "state"), _INNER),
    **dict.fromkeys(("r", "size", "now", "much"), _EACH),
    "h": Array("double", ("Z", "Z")),
    "y": Array("double", ("D + Z",)),
    "both": Array("double", ("D", "INNER")),
    "by": Array("double", ("INNER", "INNER")),
    "slope": Array("double", ("S + 1", "D + Z")),
    "flows": Array("double", ("S + 1", "INNER")),
    "turn": Array("double", ("S + 1", "INNER", "D + Z")),
    **dict.fromkeys(("change", "total"), Array("double", ("INNER", "D + Z"))),
    **dict.fromkeys(("held", "g", "known"), Array("double", ("S + 1",))),
    "active": Array("signed char", ("S + 1",)),
    "order": Array("signed char", ("D",)),
    "a": Array("double", ("INNER + S", "INNER + S + 1")),
    "point": Array("double", ("Z + S",)),
    **dict.fromkeys(("before", "after"), Array("double", ("SEEN",), read_only=True)),
    "stress": Array("double", ("SEEN",)),
    **dict.fromkeys(("psi", "dissipation"), Array("double", ("1",))),
    "tangent": Array("double", ("SEEN * SEEN",)),
    "step.parameters": Array("double", ("1",), read_only=True),
    "numbered.parameters": Array("double", ("1",), read_only=True),
}
_PLAIN = dict.fromkeys(("x", "c", "slopes", "bends", "natural", "s"), "int") | {"moving": "bool"}


def state_law(law: Criterion) -> StateLaw:
    """The law as its steps take it; InputError for one that has no routine."""
    if law.energy is None:
        what = f"{law.name} states no energy, from which the stress of a state would follow"
        raise InputError(what, where=law.name, remedy="write psi in [energy]")
    if law.heat:
        raise InputError(f"the temperature of {law.name} follows from heat", where=law.name, remedy="remove [heat]: the caller gives it")
    if ranges := [name for name in law.forces if name in law.domain]:
        what = f"{law.name} declares a range of {', '.join(ranges)}, of which the routine says nothing"
        raise InputError(what, where=law.name, remedy="remove the range of the forces")
    return StateLaw.of(law, None)


@lru_cache(maxsize=16)
def state_routine(law: Criterion) -> Routine:
    """A step of ``law``, its open parameters arguments.  InputError for a law that has none, or a word without derivatives as text."""
    own, table = state_law(law), law.symbols()
    names = tuple(name for name in own.others if name in law.parameters and law.parameters[name].value is None)
    text, constants = loop_text(own)
    relations = conditions(law, law.settled(), names)
    pressure = table[law.pressure] if law.pressure else sp.Dummy("none")
    said, numbers = scalar_values("stated", relations, (pressure, *(table[name] for name in names)))
    lines = []
    for j, name in enumerate(own.others):
        if name == law.pressure:
            lines.append(f"q[{j}] = pressure")
        else:
            lines.append(
                f"q[{j}] = parameters[{names.index(name)}]" if name in names else f"q[{j}] = {float(law.settled()[table[name]])!r}"
            )
    lines += [f"q[{len(own.others) + k}] = {float(x)!r}" for k, x in enumerate(constants)]
    ends = [f"order[{k}] = {i}" for k, i in enumerate(own.order.tolist())]
    for name, array in (("low", own.low), ("high", own.high)):
        ends += [f"{name}[{i}] = {float(x)!r}" for i, x in enumerate(array)]
    counts = {"PARAMETERS": len(names), "CONDITIONS": len(relations), "NUMBERS": len(numbers)}
    functions = [
        "\n".join(f"{name} = {value!r}" for name, value in counts.items()),
        said,
        function_text("behind(w)", [f"w[{1 + len(names) + k}] = {x!r}" for k, x in enumerate(numbers)]),
        function_text("numbered(q, parameters, pressure: float) -> None", lines),
        function_text("bounded(order, low, high)", ends),
        inspect.getsource(step),
    ]
    return Routine(c_functions("\n".join([text, *functions]), "step", _ARRAYS, _PLAIN), names)
