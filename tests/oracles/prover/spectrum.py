"""Symmetric functions of the principal values of matrices with affine entries, and of the greatest and least of three loads.

f(eigenvalues, forces) is convex, or quasiconvex, where f is so in all of its arguments and the same for every order of the eigenvalues of
each matrix: those of a mean of matrices are a mean of permutations of the mean (Fan 1949; Birkhoff 1946; Davis 1957).
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator
from dataclasses import dataclass
from typing import Any

import sympy as sp

from duhem.expression import EigMax

__all__ = ["Spectrum", "spectrum"]

_MOST_MATRICES = 4


@dataclass(frozen=True)
class Spectrum:
    """A formula with a free name for the greatest and the least eigenvalue of each of its matrices; ``swaps`` exchange two neighbours."""

    freed: sp.Expr
    names: tuple[sp.Symbol, ...]
    swaps: tuple[dict[sp.Symbol, sp.Expr], ...]

    def symmetric(self) -> bool:
        """Whether no exchange of eigenvalues changes the formula."""
        return all(any(_form(self.freed.xreplace(swap), wide) == _form(self.freed, wide) for wide in (False, True)) for swap in self.swaps)


def spectrum(expr: sp.Expr, forces: Collection[sp.Symbol], affine: Callable[[sp.Expr], bool]) -> Spectrum | None:
    """The formula as one of eigenvalues, where it has any of a matrix whose entries are ``affine``."""
    known: dict[tuple[Any, ...], tuple[sp.Symbol, sp.Symbol]] = {}
    free: dict[sp.Expr, sp.Expr] = {}
    swaps = list[dict[sp.Symbol, sp.Expr]]()
    for part in _parts(expr, {*forces}):
        if not all(map(affine, part.args)):
            continue
        entries, opposite = _entries(part, 1), _entries(part, -1)
        turned = entries not in known and opposite in known
        key = opposite if turned else entries
        if key not in known:
            a, c = known[key] = (sp.Dummy("greatest", real=True), sp.Dummy("least", real=True))
            swaps += [{a: c, c: a}, {a: sp.Add(*part.args[:3]) - a - c}]
        a, c = known[key]
        value = c if turned is not isinstance(part, sp.Min) else a
        free[part] = -value if turned else value
    if not 0 < len(known) <= _MOST_MATRICES:
        return None
    return Spectrum(expr.xreplace(free), tuple(x for pair in known.values() for x in pair), tuple(swaps))


def _parts(expr: sp.Expr, forces: set[sp.Symbol]) -> Iterator[sp.Expr]:
    found = [e for e in expr.atoms(EigMax, sp.Max, sp.Min) if e.free_symbols & forces]
    return (e for e in sorted(found, key=sp.default_sort_key) if isinstance(e, EigMax) or len(e.args) == 3)


def _entries(part: sp.Expr, sense: int) -> tuple[Any, ...]:
    """Those of a diagonal matrix in order."""
    entries = [sp.expand(sense * a) for a in part.args]
    return ("matrix", *entries) if isinstance(part, EigMax) else ("loads", *sorted(entries, key=sp.default_sort_key))


def _form(expr: Any, wide: bool) -> Any:
    """Multiplied out, with one of two signs for what stands under |.|; even powers are ``wide`` too, or those of a size."""
    if not expr.args:
        return expr
    args = [_form(a, wide) for a in expr.args]
    if isinstance(expr, sp.Abs):
        return sp.Abs(_one_sign(args[0]))
    if expr.is_Pow and expr.exp.is_Integer and expr.exp > 0 and expr.exp % 2 == 0 and not wide and expr.base.is_Add:
        return sp.Function("size")(_one_sign(args[0])) ** expr.exp
    return sp.expand(expr.func(*args), deep=False)


def _one_sign(x: sp.Expr) -> sp.Expr:
    x = sp.expand(x)
    return -x if x.could_extract_minus_sign() else x
