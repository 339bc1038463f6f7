"""A formula with its gradient and Hessian as straight lines of Python over numbers, for a compiler to make a loop of.

The rows of :mod:`duhem.expression.jets` are run over names in place of arrays: what they would compute is written down, and entries that
are 0 are left out.  Numbers are doubles; where the formula is undefined they are nan or infinite.  What text has for itself are powers by
few operations, the choice of a maximum, and a greatest eigenvalue, whose axes are found by :mod:`duhem.expression.principal_axes`.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import reduce
from typing import Any

import numpy as np
import sympy as sp

from duhem.expression import jets, numpy_
from duhem.expression.fold import Table
from duhem.expression.jets import Axes, ByShift, Entries, Jet, JetProgram, added, form, outer, steepness, total, weighted
from duhem.expression.pnorm import PNorm
from duhem.expression.scalar_bounds import Name, statements
from duhem.expression.vocabulary import EigMax, Norm

__all__ = ["TABLE", "ScalarJets", "scalar_jets", "scalar_values"]

_NAME = re.compile(r"\bt\d+\b")
_MOST_SQUARINGS = 64  # a whole exponent up to this is multiplied out
_MEAN = 0.707106781186548  # 1/sqrt(2) of each of two axes, rounded up: a normal at the very end of an edge is still one of it


@dataclass(frozen=True)
class ScalarJets:
    """Functions as text, over the forces' numbers, row ``x`` of ``v``, and those of the others, ``q``.

    ``level(v, x, q)`` returns the value, ``gradient(v, x, q, slopes)`` fills the row ``slopes`` of ``v``.
    ``piece(v, x, q, natural, choices, c, slopes, m, bends)`` does both and fills the matrix ``bends`` of ``m`` with the second
    derivatives; where ``natural``, the row ``c`` of ``choices`` (``kinks`` small integers) is written, else it names the piece.
    Where ``natural`` is 2 + k, the natural piece is taken with one of three (``c``) in the place of eigenvalue k of ``pairs``, which all
    are K's at an edge where it is double; ``pair_piece(v, x, q, natural, c, slopes)`` does the same without second derivatives, and is
    empty without pairs.
    ``constants`` follow the others in ``q``: the fractions of the formula, which are mostly values of parameters, so that one text
    serves them all.
    """

    level: str
    gradient: str
    pair_piece: str
    piece: str
    kinks: int
    pairs: int
    constants: tuple[float, ...]


def scalar_jets(expr: sp.Expr, forces: Sequence[sp.Symbol], others: Sequence[sp.Symbol]) -> ScalarJets:
    """``expr`` differentiated in the ``forces``.  InputError for what has no text: a norm whose exponent is open."""
    numbers, d = dict[float, int](), range(len(forces))
    program = _program(expr, (*forces, *others))

    def made(head: str, order: int, end: str = "return {value}", named: bool = False, of_pair: bool = False) -> tuple[_Text, str]:
        text = _Text(numbers, len(others), len(d), named, of_pair)
        given = [Jet(text.number(f"v[x, {i}]"), Entries({i: jets.ONE}) if order else None, order=order) for i in d]
        jet = text.run(program, given)
        slopes, bends = (part.of if part else {} for part in (jet.gradient, text.finished(jet)))
        ends = [f"v[slopes, {i}] = {slopes.get(i, 0.0)}" for i in d if order]
        ends += [f"m[bends, {i}, {j}] = {bends.get((min(i, j), max(i, j)), 0.0)}" for i in d for j in d if order == 2]
        return text, text.function(head, [*ends, end.format(value=jet.value)])

    _, level = made("level(v, x, q)", 0)
    _, gradient = made("gradient(v, x, q, slopes)", 1, "return")
    whole, piece = made("piece(v, x, q, natural, choices, c, slopes, m, bends)", 2, named=True, of_pair=True)
    pair_piece = made("pair_piece(v, x, q, natural, c, slopes)", 1, of_pair=True)[1] if whole.shifted else ""
    return ScalarJets(level, gradient, pair_piece, piece, program.kinks, len(whole.shifted), tuple(numbers))


def scalar_values(name: str, exprs: Sequence[sp.Basic], others: Sequence[sp.Symbol]) -> tuple[str, tuple[float, ...]]:
    """A function ``name(q, out)`` as text that fills ``out`` with the values of ``exprs``, and its constants.

    ``q``: numbers of the ``others``, then the constants.  A comparison is 1 or 0.  InputError for a word without a row here.
    """
    text = _Text({}, len(others))
    found = [text.run(_program(expr, tuple(others)), []).value for expr in exprs]
    return text.function(f"{name}(q, out)", [*(f"out[{k}] = {value}" for k, value in enumerate(found)), "return"]), tuple(text.numbers)


def _program(expr: sp.Basic, symbols: tuple[sp.Symbol, ...]) -> JetProgram:
    return jets.made_of(TABLE, expr, symbols, lambda node: lambda text: text.constant(node))


class _Number(Name):
    """A number of the text: its powers take few operations, and what it is divided into already is not divided into it again."""

    def __array_ufunc__(self, ufunc: np.ufunc, method: str, *inputs: Any, **options: Any) -> Any:
        first, second = (*inputs, None)[:2]
        if ufunc is np.multiply and any(not isinstance(x, Name) and x == 1.0 for x in inputs):
            return second if isinstance(second, Name) else first
        if ufunc is np.power and not isinstance(second, Name):
            return _raised(first, float(second))
        if ufunc is np.true_divide and (once := self.lines.get(f"(1.0) / {second}")) is not None:
            return first * _Number(self.lines, once)
        if ufunc is np.maximum and isinstance(second, Name):
            return self.let(f"max({first}, {second})")
        return super().__array_ufunc__(ufunc, method, *inputs, **options)


def _raised(base: Any, exponent: float) -> Any:
    """base^exponent with few operations; 1 for the exponent 0."""
    if exponent < 0.0:
        return _raised(1.0 / base, -exponent)
    whole, rest = divmod(exponent, 1.0)
    if rest not in (0.0, 0.5) or exponent > _MOST_SQUARINGS:
        return base.let(f"{base} ** {exponent!r}")
    found, square, left = np.sqrt(base) if rest else 1.0, base, int(whole)
    while left:
        found = found * square if left & 1 else found
        left >>= 1
        square = square * square if left else square
    return found


class _Text:
    """What is noted while the lines of one function are written: its lines, and frames of axes.

    ``numbers``: constants and their places behind the ``others``.  ``named``: the piece that is followed at a kink may be asked for; else
    it is the one that holds.  ``of_pair``: one of a pair may be.
    """

    def __init__(self, numbers: dict[float, int], others: int, d: int = 0, named: bool = False, of_pair: bool = False) -> None:
        self.numbers, self.others, self.d, self.named, self.of_pair = numbers, others, d, named, of_pair
        self.lines: dict[str, str] = {}
        self.frames: dict[tuple[sp.Expr, ...], str] = {}
        self.shifted: list[Axes] = []

    def number(self, name: str) -> _Number:
        return _Number(self.lines, name)

    def constant(self, node: Any) -> Jet:
        value = np.float64(numpy_.constant(node))
        if node.is_Integer or not node.is_Rational:
            return Jet(value)
        return Jet(self.number(f"q[{self.others + self.numbers.setdefault(float(value), len(self.numbers))}]"))

    def run(self, program: JetProgram, forces: Sequence[Jet]) -> Jet:
        """What the formula is, once the lines so far have run."""
        with np.errstate(all="ignore"):
            jet: Jet = program.recording.value([*forces, *(Jet(self.number(f"q[{k}]")) for k in range(self.others))], self)
        return jet

    def function(self, head: str, ends: Sequence[str]) -> str:
        """The function that ends with these lines, with the others that they need."""
        needed, kept = {name for text in ends for name in _NAME.findall(text)}, dict[str, str]()
        for text, name in reversed(self.lines.items()):
            if not name or name in needed:
                needed.update(_NAME.findall(text))
                kept[text] = name
        return "\n".join([f"def {head}:", *statements({**dict(reversed(kept.items())), **dict.fromkeys(ends, "")})])

    def choose(self, index: int, natural: Any) -> Any:
        """The piece that is followed at a kink; ``natural`` is the number of the one that holds."""
        if not self.named:
            return natural
        said = (text for text, name in reversed(self.lines.items()) if name == str(natural))  # worked out only where it is asked for
        self.lines[f"if natural: choices[c, {index}] = {next(said, natural)}"] = ""
        return self.number("").let(f"choices[c, {index}]")

    def frame(self, node: Any, entries: Sequence[Jet]) -> tuple[str, bool]:
        """The name of eigenvalues and axes, and whether they are those of the matrix, not of its negative."""
        if (name := self.frames.get(tuple(-a for a in node.args))) is not None:
            return name, False
        if (name := self.frames.get(node.args)) is None:
            name = self.frames[node.args] = f"frame{len(self.frames)}"
            self.lines[f"{name} = np.empty((4, 3))"] = ""
            self.lines[f"principal_axes({name}, {', '.join(str(a.value) for a in entries)})"] = ""
        return name, True

    def finished(self, jet: Jet) -> Entries:
        """The second derivatives with what the turning of axes adds, as :mod:`duhem.expression.jets` does."""
        gradient, hessian = (part or Entries({}) for part in (jet.gradient, jet.hessian))
        slopes, forces = [slope for i, slope in gradient.of.items() if i < self.d], range(self.d)
        for shift, axes in reversed(list(enumerate(self.shifted, self.d))):  # one inside another is met before it
            rate, bend = gradient.of.get(shift, 0.0), hessian.of.get((shift, shift), 0.0)
            size = axes.steepness * _length([self.number(f"v[x, {i}]") for i in forces])
            by = ByShift(rate, bend, size, _length(slopes) / axes.steepness)
            for share, turn in zip(axes.shares(by), axes.turns, strict=True):
                if turn is not None:
                    hessian = added(hessian, outer(turn, turn, np.where(by.used, share, 0.0)))
        return hessian


def _length(parts: Sequence[Any]) -> Any:
    return np.sqrt(reduce(np.add, [x * x for x in parts], 0.0))


def _eigenvalue(node: Any, _: int, text: _Text, *entries: Jet) -> Jet:
    """n . dA n with the unit eigenvector n, and a shift; what the turning of n adds is left to :meth:`_Text.finished`.

    Of its own pair the piece ``c`` is that of n, of the middle axis or of their mean, which turn towards the least axis alone.
    """
    frame, greatest = text.frame(node, entries)
    rows = (3, 2, 1) if greatest else (1, 2, 3)
    n, middle, least = ([text.number(f"{frame}[{k}, {i}]") for i in range(3)] for k in rows)
    top, second, last = (text.number(f"{frame}[0, {k - 1}]") * (1.0 if greatest else -1.0) for k in rows)
    if all(a.gradient is None for a in entries) or not text.of_pair:
        return weighted(top, form(n, n), entries)
    shift, c = len(text.shifted), text.number("c")
    paired = c.let(f"natural == {2 + shift}", truth=True)
    mixed = np.where(paired, np.where(c == 0, 0.0, np.where(c == 1, 1.0, _MEAN)), 0.0)
    kept = np.where(paired, np.where(c == 0, 1.0, np.where(c == 1, 0.0, _MEAN)), 1.0)
    axis = [kept * a + mixed * b for a, b in zip(n, middle, strict=True)]
    value = kept * kept * top + mixed * mixed * second
    gaps = value - last, np.where(paired, np.inf, value - second)
    turns = [total(form(axis, m), (a.gradient for a in entries)) for m in (least, middle)]
    text.shifted.append(Axes(gaps, turns, steepness(entries)))
    jet = weighted(value, form(axis, axis), entries)
    return replace(jet, gradient=added(jet.gradient, Entries({text.d + shift: jets.ONE}))) if text.named else jet


def _extreme(node: Any, index: int, text: _Text, *parts: Jet) -> Jet:
    less = "<" if isinstance(node, sp.Max) else ">"
    natural = str(len(parts) - 1)
    for i in reversed(range(len(parts) - 1)):
        first = " and ".join(f"not {parts[i].value} {less} {b.value}" for b in parts[i + 1 :])
        natural = f"{i} if {first} else {natural}"
    return jets.select(text.choose(index, text.number("").let(natural)), parts)


def _known(exponent: sp.Expr) -> Jet:
    return Jet(float(numpy_.evaluate(exponent, {})))


TABLE: Table[Jet] = {
    **jets.TABLE,
    sp.Pow: lambda node, base, e: jets.TABLE[sp.Pow](node, base, _known(node.exp) if node.exp.is_number else e),
    Norm: lambda node, *args: jets.TABLE[PNorm](node, Jet(2.0), *args),
    PNorm: lambda node, _, *args: jets.TABLE[PNorm](node, _known(node.args[0]), *args),
    EigMax: _eigenvalue,
    **dict.fromkeys((sp.Max, sp.Min), _extreme),
}
