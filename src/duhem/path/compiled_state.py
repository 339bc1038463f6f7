"""Implicit steps of a law with a state as machine code: the loops of :mod:`duhem.path.state_kernel` with the functions of one law.

A point that the loop leaves is a step of :mod:`duhem.path.state_step`, which knows bounds, tangents and prescribed forces as well.
"""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from duhem.errors import InputError
from duhem.expression import principal_axes
from duhem.expression.elementary import imports
from duhem.expression.scalar_bounds import FUNCTIONS
from duhem.expression.scalar_jets import ScalarJets, scalar_jets
from duhem.path import state_kernel
from duhem.path.state_kernel import LEFT, NUMBERS
from duhem.path.state_step import Advanced, StateFormula, StateLaw
from duhem.projection.code_cache import compiled_text, only_read
from duhem.projection.module_text import MARK
from duhem.projection.newton_step import eliminated
from duhem.projection.result import Array

__all__ = ["StateLoop", "loop_text"]


@dataclass(frozen=True, eq=False)
class StateLoop:
    """``run`` takes many points of a law through one step; ``constants`` are the fractions of its formulas."""

    law: StateLaw
    run: Callable[..., None]
    constants: Array

    @classmethod
    def of(cls, law: StateLaw) -> StateLoop | None:
        """The loop; None where forces are prescribed, heat decides the temperature, or a word has no derivatives as text.

        MissingExtraError without numba.
        """
        if law.stressed or law.adiabatic:
            return None
        try:
            text, constants = loop_text(law)
        except InputError:
            return None
        return cls(law, compiled_text(text, "advance"), constants)

    def advance(self, base: Array, given: Array, dt: float, others: Sequence[Array]) -> Advanced:
        """As :meth:`duhem.path.state_step.StateLaw.advance`, without a tangent."""
        law, n = self.law, len(base)
        d, i, o, many = len(law.order), law.internal, law.observables, len(law.criteria)
        numbers = np.stack([np.broadcast_to(x, n) for x in others], axis=1) if others else np.zeros((n, 0))
        shapes = ((n, len(law.names)), (n, many), (n,), (n, d), (n, o), (n,), (n, i), (n,), (n,))
        chi, multiplier, psi, forces, observed, entropy, flow, numerical, worst = out = [np.empty(shape) for shape in shapes]
        state = np.empty(n, dtype=np.int8)
        self.run(
            *map(only_read, (base, given)), float(dt), *map(only_read, (numbers, self.constants, law.order, law.low, law.high)), *out, state
        )
        found = Advanced(
            chi, multiplier, np.zeros((n, i)), np.zeros((n, i), dtype=np.bool_), psi, forces, observed, entropy, flow, numerical, worst,
            np.zeros(n, dtype=np.bool_), np.zeros((n, 0, 0)),
        )  # fmt: skip
        if (who := np.flatnonzero(state == LEFT)).size:
            found.put(who, law.advance(base[who], given[who], dt, [x[who] for x in others]))
        return found


class _Functions:
    """The formulas of a law as functions over numbers, which take the others and then the fractions of all of them in ``q``."""

    def __init__(self) -> None:
        self.known: dict[StateFormula, tuple[int, ScalarJets, int]] = {}
        self.texts: dict[str, None] = {}
        self.constants: list[float] = []

    def lines(self, formula: StateFormula, order: int, value: str, at: str = "y") -> tuple[list[str], list[tuple[int, str]]]:
        """Lines that let ``value`` be that of the formula at ``at``; for ``order`` 1 the slopes too, by column, and for 2 also ``m``."""
        if formula not in self.known:
            made = scalar_jets(formula.expr, formula.names, formula.others)
            self.known[formula] = len(self.known), made, len(self.constants)
            self.constants += made.constants
        k, made, before = self.known[formula]

        def moved(number: re.Match[str]) -> str:
            place = int(number[1])
            return f"q[{place + before if place >= len(formula.others) else place}]"

        for text in ((made.level,), (made.level, made.gradient), (made.piece,))[order]:
            self.texts[re.sub(r"\bq\[(\d+)\]", moved, re.sub(r"^def (\w+)\(", rf"def \g<1>_{k}(", text))] = None
        columns = formula.columns.tolist()
        lines = [f"v[0, {j}] = {at}[{column}]" for j, column in enumerate(columns)]
        if order == 2:
            lines += [f"{f'{value} = ' if value else ''}piece_{k}(v, 0, q, 1, choices, 0, 1, m, 0)"]
        else:
            lines += [f"{value} = level_{k}(v, 0, q)", f"gradient_{k}(v, 0, q, 1)"][: 1 + order]
        return lines, [(column, f"v[1, {j}]") for j, column in enumerate(columns)]

    def energy(self, law: StateLaw) -> str:
        """psi with slopes and second derivatives, and alone."""
        lines, slopes = self.lines(law.free_energy, 2, "psi", "at")
        lines += [f"f[{i}] = {name}" for i, name in slopes]
        lines += [f"h[{i}, {j}] = m[0, {a}, {b}]" for a, (i, _) in enumerate(slopes) for b, (j, _) in enumerate(slopes)]
        alone = _function("stored(at, q, v)", [*self.lines(law.free_energy, 0, "psi", "at")[0], "return psi"])
        return "\n".join([_function("energy(at, q, v, m, choices, f, h)", [*lines, "return psi"]), alone])

    def criterion(self, law: StateLaw) -> str:
        """g with its slope, and where it ``flows`` the direction of the flow with the derivatives of that."""
        lines: list[str] = []
        for s, (g, associated, components) in enumerate(law.criteria):
            plain, slopes = self.lines(g, 1, "g")
            flowing, bent = [], self.lines(g, 2, "g")[0] if associated else []
            for a, (k, name) in enumerate(slopes if associated else ()):
                if k < len(law.order):
                    flowing += [f"flows[{s}, {law.order[k]}] = {name}"]
                    flowing += [f"turn[{s}, {law.order[k]}, {z}] = m[0, {a}, {b}]" for b, (z, _) in enumerate(slopes)]
            found = [f"slope[{s}, {z}] = {name}" for z, name in slopes]
            for i, component in components.items():
                own, slopes = self.lines(component, 1, f"flows[{s}, {i}]")
                flowing += [*own, *(f"turn[{s}, {i}, {z}] = {name}" for z, name in slopes)]
            first = ["if moving:", *_within(bent), "else:", *_within(plain)] if associated else plain
            lines += [f"if s == {s}:", *_within([*first, *found, "if moving:", *_within(flowing or ["pass"]), "return g"])]
        return _function("criterion(s, moving, y, q, v, m, choices, slope, flows, turn)", [*lines, "return 0.0"])

    def rates(self, law: StateLaw) -> str:
        """The rates without a multiplier and their derivatives."""
        lines = ["for i in range(INNER):", "    rate[i] = 0.0", "    for z in range(D + Z):", "        change[i, z] = 0.0"]
        if law.potential is not None:
            bent, slopes = self.lines(law.potential, 2, "")
            lines += bent
            for a, (k, name) in enumerate(slopes):
                if k < len(law.order):
                    lines += [f"rate[{law.order[k]}] = {name}"]
                    lines += [f"change[{law.order[k]}, {z}] = m[0, {a}, {b}]" for b, (z, _) in enumerate(slopes)]
        for i, component in law.rates.items():
            own, slopes = self.lines(component, 1, "own")
            lines += [*own, f"rate[{i}] += own", *(f"change[{i}, {z}] += {name}" for z, name in slopes)]
        return _function("rates(y, q, v, m, choices, rate, change)", [*lines, "return"])


def _function(head: str, lines: Sequence[str]) -> str:
    return "\n".join([f"def {head}:", *_within(lines)])


def _within(lines: Sequence[str]) -> list[str]:
    return [f"    {line}" for line in lines]


def loop_text(law: StateLaw) -> tuple[str, Array]:
    """The module to compile, and the constants of its formulas.  InputError for a word without derivatives as text."""
    made = _Functions()
    wired = [made.energy(law), made.criterion(law), made.rates(law)]
    constants, jets = np.array(made.constants), [each for _, each, _ in made.known.values()]
    sizes = {
        "D": len(law.order), "Z": len(law.names), "S": len(law.criteria),
        "SEEN": law.observables, "INNER": law.internal,
        "W": len(law.order) + len(law.names), "OTHERS": len(law.others), "CONSTANTS": len(constants),
        "KINKS": max(1, *(each.kinks for each in jets)),
        "TIMED": int(law.timed),
    }  # fmt: skip
    head = [
        "from math import floor, frexp, isfinite, ldexp",
        "from typing import Any",
        "import numpy as np",
        "from numpy import inf, nan",
        imports(FUNCTIONS),
        *(f"{name} = {value!r}" for name, value in {**sizes, **NUMBERS}.items()),
    ]
    sources = [inspect.getsource(state_kernel).partition(MARK)[2].partition("\n")[2], inspect.getsource(eliminated)]
    axes = [inspect.getsource(function) for function in principal_axes.FUNCTIONS] if any(each.pairs for each in jets) else []
    return "\n".join([*head, *axes, *made.texts, *wired, *sources]), constants
