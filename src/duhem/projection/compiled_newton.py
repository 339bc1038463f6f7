"""The closest point by a loop that is made for one law and compiled by numba: once a law, then kept on disk.

The functions of the law are its scaled formula and its jets as text (:mod:`duhem.expression.scalar_jets`); the loop is the source of
:mod:`duhem.projection.newton_kernel` and of the step it takes.  Points that the loop leaves are the search's.
"""

from __future__ import annotations

import hashlib
import inspect
import os
import sys
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from functools import lru_cache
from pathlib import Path
from types import ModuleType

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from duhem.errors import InputError, MissingExtraError
from duhem.expression.scalar_jets import FUNCTIONS, ScalarJets, scalar_jets
from duhem.projection import newton_kernel, newton_step
from duhem.projection.increment import Increment
from duhem.projection.newton_kernel import LEFT
from duhem.projection.result import Solution
from duhem.projection.scaled_formula import ScaledFormula, scaled
from duhem.projection.whitened_body import whitening

__all__ = ["kernel_text", "solved"]

_BLOCK = 16_384
MARK = "# -- compiled from here"


def solved(increment: Increment) -> tuple[Solution, NDArray[np.intp]]:
    """The solution, and the points of it that are left to the search.  MissingExtraError without numba."""
    law = increment.law
    symbol = law.symbols()[law.pressure] if law.pressure else None
    formula = scaled(increment.g, law.force_symbols(), symbol)
    n, d = increment.trial.shape
    every = np.arange(n)
    found = Solution(np.empty((n, d)), np.zeros((n, d)), np.zeros(n), np.zeros(n, dtype=bool))
    try:
        jets = scalar_jets(formula.expr, law.force_symbols(), tuple(formula.data))
        run = _kernel(kernel_text(formula, jets, d))
    except InputError:  # a word without derivatives as text
        return found, every
    state = np.empty(n, dtype=np.int8)
    mean, root = whitening(increment)
    root, inverse = np.ascontiguousarray(root), np.ascontiguousarray(np.linalg.inv(root))

    def fill(start: int) -> None:
        block = slice(start, start + _BLOCK)
        trial = np.ascontiguousarray(increment.trial[block])
        values = formula.values(increment.pressure[block], np.ones(len(trial)))
        data = np.stack([values[q] for q in formula.data], axis=1) if values else np.zeros((len(trial), 0))
        out = found.stress[block], found.slip[block], found.multiplier[block], state[block]
        run(trial, np.ascontiguousarray(data), np.array(jets.constants), root, inverse, formula.degree, *out)

    fill(0)  # compiled here, once
    with ThreadPoolExecutor() as pool:  # a point's numbers do not depend on who computes them
        list(pool.map(fill, range(_BLOCK, n, _BLOCK)))
    with np.errstate(over="ignore", invalid="ignore"):
        found.slip[:] /= mean
        found.multiplier[:] /= mean
    return found, every[state == LEFT]


def kernel_text(formula: ScaledFormula, jets: ScalarJets, d: int) -> str:
    """The module that is compiled for one law in ``d`` forces, whatever its parameters but for exponents and whole numbers."""
    head = [
        "from math import floor, frexp, isfinite, ldexp",
        "from typing import Any",
        "import numpy as np",
        f"from numpy import {', '.join(FUNCTIONS)}",
        f"D, KINKS, DATA = {d}, {jets.kinks}, {len(formula.data)}",
    ]
    loop = [inspect.getsource(module).partition(MARK)[2].partition("\n")[2] for module in (newton_step, newton_kernel)]
    return "\n\n\n".join(["\n".join(head), *_functions(formula, jets), *loop])


def _functions(formula: ScaledFormula, jets: ScalarJets) -> list[str]:
    lines = [f"    q[{k}] = {_scaled(k, datum.weight)}" for k, datum in enumerate(formula.data.values())]
    return [jets.level, jets.piece, "\n".join(["def resized(data, n, size, q):", *lines, "    return"])]


def _scaled(k: int, weight: sp.Expr) -> str:
    power = float(weight)
    return {0.0: f"data[n, {k}]", 1.0: f"data[n, {k}] / size", -1.0: f"data[n, {k}] * size"}.get(power, f"data[n, {k}] / size ** {power!r}")


@lru_cache(maxsize=64)
def _kernel(text: str) -> Callable[..., None]:
    """The compiled loop; what is not yet on disk is compiled now (some ten seconds)."""
    try:
        import numba
    except ImportError:
        raise MissingExtraError("numba", "fast") from None
    kept = _kept(text)
    module = ModuleType(f"duhem_{kept.stem}" if kept else "duhem_generated")
    sys.modules[module.__name__] = module  # where what was kept looks for it
    space = module.__dict__
    exec(
        compile(text, str(kept or "<generated>"), "exec"), space
    )  # our own text: of the user's formula it has SymPy's numbers and our names
    functions = [name for name, value in space.items() if inspect.isfunction(value) and value.__module__ == module.__name__]
    for name in functions:
        if name != "solve":
            space[name] = numba.njit(error_model="numpy", cache=False)(space[name])
    run: Callable[..., None] = numba.njit(error_model="numpy", cache=kept is not None, nogil=True)(space["solve"])
    return run


def _kept(text: str) -> Path | None:
    """The file with this text, beside which numba keeps what it compiles; None where there is no place for it."""
    folder = _folder()
    path = folder / f"newton_{hashlib.sha256(text.encode()).hexdigest()[:32]}.py"
    try:
        folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        if not path.is_file() or path.read_text("utf-8") != text:
            beside = path.with_suffix(f".{os.getpid()}")
            beside.write_text(text, "utf-8")
            beside.replace(path)
        return path
    except OSError:
        return None


def _folder() -> Path:
    """Where compiled laws are kept: DUHEM_CACHE_DIR, else the user's folder for such things."""
    if own := os.environ.get("DUHEM_CACHE_DIR"):
        return Path(own)
    if sys.platform == "win32":
        return Path(os.environ.get("LOCALAPPDATA", Path.home())) / "duhem"
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "duhem"
