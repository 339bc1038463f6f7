"""A formula with its gradient and Hessian as straight lines of Python over numbers, for a compiler to make a loop of.

The jets of :mod:`duhem.expression.jets`, written out instead of computed: one point, entries that are 0 left out, the same
smooth pieces at the kinks.  Numbers are doubles; where the formula is undefined they are nan or infinite.  A greatest eigenvalue is
followed by a shift, as :mod:`duhem.expression.jets` says, and its axes are found by :mod:`duhem.expression.principal_axes`.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial, reduce
from itertools import combinations
from typing import Any, TypeVar

import sympy as sp

from duhem.errors import InputError
from duhem.expression.elementary import ELEMENTARY, Elementary
from duhem.expression.fold import fold
from duhem.expression.jets import ROUNDING, STEEPEST
from duhem.expression.pnorm import PNorm, recognised
from duhem.expression.vocabulary import COMPARISONS, Atan2, EigMax, Neg, Norm, Pos, Where

__all__ = ["FUNCTIONS", "TABLE", "ScalarJets", "scalar_jets", "scalar_values"]

FUNCTIONS = ("sqrt", *(word.numpy for word in ELEMENTARY.values()), "arctan2", "hypot", "nan")
"""What the text calls by NumPy's names."""

_NAME = re.compile(r"\bt\d+\b")
_LEAST = "2.2250738585072014e-308"
_TINY = "1e-120"  # as for arrays: below this share of a norm an argument counts as this share
_MOST_SQUARINGS = 64  # a whole exponent up to this is multiplied out

Slopes = Mapping[int, str]
Bends = Mapping[tuple[int, int], str]
K = TypeVar("K")


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
    formula, numbers = recognised(expr), dict[str, int]()
    value = _Writer(0, numbers)
    last = value.jet(formula, forces, others)
    level = value.function("def level(v, x, q):", [f"    return {last.value}"])
    whole = _Writer(len(forces), numbers)
    jet = whole.jet(formula, forces, others)
    d = range(len(forces))
    slopes = [f"    v[slopes, {i}] = {jet.slopes.get(i, '0.0')}" for i in d]
    bent = whole.finished(jet)
    bends = [f"    m[bends, {i}, {j}] = {bent.get((min(i, j), max(i, j)), '0.0')}" for i in d for j in d]
    head = "def piece(v, x, q, natural, choices, c, slopes, m, bends):"
    piece = whole.function(head, [*slopes, *bends, f"    return {jet.value}"])

    def first_order(head: str, of_pair: bool) -> str:
        plain = _Writer(len(forces), numbers, named=False, of_pair=of_pair)
        once = plain.jet(formula, forces, others)
        ends = [f"    v[slopes, {i}] = {once.slopes.get(i, '0.0')}" for i in d]
        ends.append(f"    return {once.value}" if of_pair else "    return")
        return plain.function(head, ends)

    gradient = first_order("def gradient(v, x, q, slopes):", of_pair=False)
    pair_piece = first_order("def pair_piece(v, x, q, natural, c, slopes):", of_pair=True) if whole.shifted else ""
    return ScalarJets(level, gradient, pair_piece, piece, whole.kinks, len(whole.shifted), tuple(map(float, numbers)))


@dataclass(frozen=True)
class _Jet:
    """Names of the value, of the slopes and of the second derivatives (i <= j) that are not 0 everywhere."""

    value: str
    slopes: Slopes = field(default_factory=dict)
    bends: Bends = field(default_factory=dict)


@dataclass(frozen=True)
class _Axis:
    """Of an eigenvalue: whether its pair is asked for, how far it is above the least and the middle one, n . dA m for their axes m, and
    how steep the entries are."""

    paired: str
    gaps: tuple[str, ...]
    turns: tuple[Slopes, ...]
    steepness: str


class _Writer:
    """Writes the lines of one function; of ``d`` = 0 forces no derivative is followed.  ``numbers``: constants and their places.

    ``named``: the piece that is followed at a kink may be asked for; else it is the one that holds.  ``of_pair``: one of a pair may be.
    """

    def __init__(self, d: int, numbers: dict[str, int], named: bool = True, of_pair: bool = True) -> None:
        self.d, self.kinks, self.numbers, self.named_pieces, self.of_pair = d, 0, numbers, named and d > 0, of_pair
        self.lines: list[str] = []
        self.frames: dict[tuple[sp.Expr, ...], str] = {}
        self.shifted: list[_Axis] = []

    def let(self, text: str) -> str:
        """A new name for what ``text`` says, unless that is one."""
        if _NAME.fullmatch(text):
            return text
        self.lines.append(f"    t{len(self.lines)} = {text}")
        return f"t{len(self.lines) - 1}"

    def function(self, head: str, ends: Sequence[str]) -> str:
        """The function that ends with these lines, with the others that they need."""
        needed, kept = {name for text in ends for name in _NAME.findall(text)}, list[str]()
        for line in reversed(self.lines):
            name = line.partition(" = ")[0].strip()
            if name.isidentifier() and name not in needed:
                continue
            needed.update(_NAME.findall(line))
            kept.append(line)
        return "\n".join([head, *kept[::-1], *ends])

    def jet(self, formula: sp.Basic, forces: Sequence[sp.Symbol], others: Sequence[sp.Symbol]) -> _Jet:
        """What the formula is, once the lines so far have run."""

        def leaf(node: Any) -> _Jet:
            if node in forces:
                i = list(forces).index(node)
                return _Jet(f"v[x, {i}]", {i: "1.0"} if self.d else {})
            if node in others:
                return _Jet(f"q[{list(others).index(node)}]")
            text = _number(node)
            if node.is_Integer or not node.is_Rational:
                return _Jet(f"({text})")
            return _Jet(f"q[{len(others) + self.numbers.setdefault(text, len(self.numbers))}]")

        return fold(formula, {kind: partial(row, self) for kind, row in TABLE.items()}, leaf)

    # -- smooth ------------------------------------------------------------------------------------------------

    def chain(self, x: _Jet, value: str, slope: str, bend: str) -> _Jet:
        """f(x) from f, f' and f''."""
        if not x.slopes:
            return _Jet(value)
        first, second = self.let(slope), self.let(bend)
        slopes = {i: self.let(f"{first} * {a}") for i, a in x.slopes.items()}
        return self.named(value, slopes, self.with_outer(_times(first, x.bends), _times(second, x.slopes), x.slopes))

    def named(self, value: str, slopes: Slopes, bends: Bends) -> _Jet:
        return _Jet(value, {i: self.let(a) for i, a in slopes.items()}, {ij: self.let(a) for ij, a in bends.items()})

    def with_outer(self, bends: Bends, a: Slopes, b: Slopes) -> Bends:
        """Second derivatives with a b^T added; of a matrix that is not symmetric the half that is kept."""
        more = {(i, j): f"{a[i]} * {b[j]}" for i, j in self.pairs({**a, **b}) if i in a and j in b}
        return {ij: self.let(text) for ij, text in _added(bends, more).items()}

    def sum(self, a: _Jet, b: _Jet) -> _Jet:
        return self.named(self.let(f"{a.value} + {b.value}"), _added(a.slopes, b.slopes), _added(a.bends, b.bends))

    def product(self, a: _Jet, b: _Jet) -> _Jet:
        jet = self.weighted([(b.value, a), (a.value, b)])
        bends = self.with_outer(self.with_outer(jet.bends, a.slopes, b.slopes), b.slopes, a.slopes)
        return self.named(self.let(f"{a.value} * {b.value}"), jet.slopes, bends)

    def power(self, node: Any, base: _Jet, exponent: _Jet) -> _Jet:
        if exponent.slopes:
            return self.elementary(ELEMENTARY["exp"], self.product(exponent, self.elementary(ELEMENTARY["log"], base)))
        if not node.exp.is_number:
            e = exponent.value
            first, second = f"{e} * {base.value} ** ({e} - 1.0)", f"{e} * ({e} - 1.0) * {base.value} ** ({e} - 2.0)"
            return self.chain(base, self.let(f"{base.value} ** {e}"), first, second)
        falling = (sp.S.One, node.exp, node.exp * (node.exp - 1))
        value, slope, bend = (self.let(f"{_number(c)} * {self.raised(base.value, node.exp - k)}") for k, c in enumerate(falling))
        return self.chain(base, value, slope, bend)

    def raised(self, base: str, exponent: Any) -> str:
        """base^exponent with few operations; 1 for the exponent 0."""
        if exponent.is_negative:
            return self.let(f"1.0 / {self.raised(base, -exponent)}")
        if exponent.is_Integer and exponent <= _MOST_SQUARINGS:
            square, found, left = base, "1.0", int(exponent)
            while left:
                if left & 1:
                    found = square if found == "1.0" else self.let(f"{found} * {square}")
                left >>= 1
                square = self.let(f"{square} * {square}") if left else square
            return found
        if (2 * exponent).is_Integer and exponent <= _MOST_SQUARINGS:
            root = self.let(f"sqrt({base})")
            return root if 2 * exponent == 1 else self.let(f"{root} * {self.raised(base, exponent - sp.Rational(1, 2))}")
        return self.let(f"{base} ** {_number(exponent)}")

    def elementary(self, word: Elementary, x: _Jet) -> _Jet:
        v = self.let(f"{word.numpy}({x.value})")
        if not x.slopes:
            return _Jet(v)
        s = self.let(word.slope.format(x=x.value, v=v))
        return self.chain(x, v, s, word.bend.format(x=x.value, v=v, s=s))

    def angle(self, _: Any, y: _Jet, x: _Jet) -> _Jet:
        size = self.let(f"hypot({x.value}, {y.value})")
        value = self.let(f"arctan2({y.value} + 0.0, {x.value}) if {size} > 0.0 else nan")
        c, s = self.let(f"{x.value} / {size} / {size}"), self.let(f"{y.value} / {size} / {size}")
        turn = self.weighted([(c, y), (f"-{s}", x)])
        growth = self.weighted([(c, x), (s, y)])
        less = {i: f"-{a}" for i, a in turn.slopes.items()}
        bends = self.with_outer(self.with_outer(turn.bends, less, growth.slopes), growth.slopes, less)
        return self.named(value, turn.slopes, bends)

    def weighted(self, parts: Sequence[tuple[str, _Jet]]) -> _Jet:
        """The derivatives of a sum of jets with factors that are held fixed."""
        slopes: Slopes = reduce(_added, (_times(factor, jet.slopes) for factor, jet in parts), {})
        bends: Bends = reduce(_added, (_times(factor, jet.bends) for factor, jet in parts), {})
        return self.named("0.0", slopes, bends)

    def norm(self, p: Any, *parts: _Jet) -> _Jet:
        """(sum |a_i|^p)^(1/p) of value P: slopes (|a_i|/P)^(p-1), second derivatives by pairs, so that they keep their sign."""
        sizes = [self.let(f"abs({a.value})") for a in parts]
        largest = self.let(reduce(lambda a, b: f"max({a}, {b})", sizes))
        unit = self.let(f"{largest} if {largest} > 0.0 else 1.0")
        powers = [self.raised(self.let(f"{size} / {unit}"), p) for size in sizes]
        value = self.let(f"{unit} * {self.raised(self.let(' + '.join(powers)), 1 / p)}")
        if not any(a.slopes for a in parts):
            return _Jet(value)
        one = self.let(f"1.0 / {value} if {value} > 0.0 else 1.0")
        shares = [self.let(f"min({size} * {one}, 1.0)") for size in sizes]
        steep = ["1.0" if p == 2 else self.raised(self.let(f"max({share}, {_TINY})"), p - 2) for share in shares]
        signed = [self.let(f"{share} if {a.value} >= 0.0 else -{share}") for share, a in zip(shares, parts, strict=True)]
        jet = self.weighted([(self.let(f"{x} * {k}"), a) for x, k, a in zip(signed, steep, parts, strict=True)])
        bends = jet.bends
        for i, j in combinations(range(len(parts)), 2):
            turn = self.weighted([(signed[j], parts[i]), (f"-{signed[i]}", parts[j])]).slopes  # how their ratio turns
            if not turn:
                continue
            weight = self.let(f"{_number(p - 1)} * {steep[i]} * {steep[j]} * {one} if {value} > 0.0 else 0.0")
            bends = self.with_outer(bends, _times(weight, turn), turn)
        return self.named(value, jet.slopes, bends)

    def pairs(self, keys: Iterable[int]) -> list[tuple[int, int]]:
        """Places of second derivatives: those of the forces, and of each shift its own."""
        return [(i, j) for i in sorted(keys) for j in sorted(keys) if i == j or i < j < self.d]

    # -- eigenvalues -------------------------------------------------------------------------------------------

    def eigenvalue(self, node: Any, *entries: _Jet) -> _Jet:
        """n . dA n with the unit eigenvector n, and a shift; what the turning of n adds is left to :meth:`finished`.

        Of its own pair the piece ``c`` is that of n, of the middle axis or of their mean, which turn towards the least axis alone.
        """
        frame, greatest = self.frame(node, entries)
        sign, (n, middle, least) = ("", (3, 2, 1)) if greatest else ("-", (1, 2, 3))
        top, second = f"{frame}[0, {n - 1}]", f"{frame}[0, 1]"
        if not any(a.slopes for a in entries):
            return _Jet(self.let(sign + top))
        if not self.of_pair:
            axis = [f"{frame}[{n}, {i}]" for i in range(3)]
            jet = self.along(axis, axis, entries)
            return self.named(self.let(sign + top), jet.slopes, jet.bends)
        shift = self.d + len(self.shifted)
        paired = self.let(f"natural == {2 + len(self.shifted)}")
        mixed = self.let(f"(0.0 if c == 0 else 1.0 if c == 1 else {sp.sqrt(0.5)!r}) if {paired} else 0.0")
        kept = self.let(f"(1.0 if c == 0 else 0.0 if c == 1 else {mixed}) if {paired} else 1.0")
        axis = [self.let(f"{kept} * {frame}[{n}, {i}] + {mixed} * {frame}[{middle}, {i}]") for i in range(3)]
        value = self.let(f"{sign}({kept} * {kept} * {top} + {mixed} * {mixed} * {second})")
        gaps = self.let(f"{value} - {sign}{frame}[0, {least - 1}]"), self.let(f"{value} - {sign}{second}")
        turns = [self.along(axis, [f"{frame}[{m}, {i}]" for i in range(3)], entries).slopes for m in (least, middle)]
        steepness = self.let(f"sqrt({_squares([text for a in entries for text in a.slopes.values()])})")
        self.shifted.append(_Axis(paired, gaps, tuple(turns), steepness))
        jet = self.along(axis, axis, entries)
        return self.named(value, {**jet.slopes, shift: "1.0"} if self.named_pieces else jet.slopes, jet.bends)

    def along(self, n: Sequence[str], m: Sequence[str], entries: Sequence[_Jet]) -> _Jet:
        """The derivatives of n . A m, its axes held fixed."""
        weights = [f"{n[i]} * {m[i]}" for i in range(3)] + [f"{n[i]} * {m[j]} + {n[j]} * {m[i]}" for i, j in ((1, 2), (0, 2), (0, 1))]
        return self.weighted([(self.let(weight), a) for weight, a in zip(weights, entries, strict=True) if a.slopes])

    def frame(self, node: Any, entries: Sequence[_Jet]) -> tuple[str, bool]:
        """The name of eigenvalues and axes, and whether they are those of the matrix, not of its negative."""
        if (name := self.frames.get(tuple(-a for a in node.args))) is not None:
            return name, False
        if (name := self.frames.get(node.args)) is None:
            name = self.frames[node.args] = self.let("np.empty((4, 3))")
            self.lines.append(f"    principal_axes({name}, {', '.join(a.value for a in entries)})")
        return name, True

    def finished(self, jet: _Jet) -> Bends:
        """The second derivatives with what the turning of axes adds, as :mod:`duhem.expression.jets` does."""
        bends, forces = jet.bends, range(self.d)
        slope = self.let(f"sqrt({_squares([jet.slopes[i] for i in forces if i in jet.slopes])})") if self.shifted else ""
        length = self.let(f"sqrt({_squares([f'v[x, {i}]' for i in forces])})") if self.shifted else ""
        for shift, axis in reversed(list(enumerate(self.shifted, self.d))):  # one inside another is met before it
            rate, bend = jet.slopes.get(shift, "0.0"), self.let(bends.get((shift, shift), "0.0"))
            own, (far, near) = self.let(f"{slope} / {axis.steepness}"), axis.gaps
            much = self.let(f"abs({bend}) * {axis.steepness} * {length}")
            off = f"abs({rate} - {bend} * 0.5 * {near}) <= {ROUNDING!r} * ({own} + {much})"
            smooth = self.let(f"{off} and {much} <= {STEEPEST!r} * {own}")
            used = f"0.0 if {rate} == 0.0 and {bend} == 0.0 else"
            shares = (
                f"2.0 * {rate} / {far} if {axis.paired} or not {smooth} else {bend} * ({near} + {_LEAST}) / ({far} + 2.0 * {_LEAST})",
                f"0.0 if {axis.paired} else {bend} if {smooth} else 2.0 * {rate} / {near}",
            )
            for share, turn in zip(shares, axis.turns, strict=True):
                factor = self.let(f"{used} ({share})")
                bends = self.with_outer(bends, _times(factor, turn), turn)
        return bends

    # -- kinks -------------------------------------------------------------------------------------------------

    def chosen(self, natural: str) -> str:
        """The name of the piece that is followed at a new kink; ``natural`` is the number of the one that holds."""
        if not self.named_pieces:
            return self.let(natural)
        k, self.kinks = self.kinks, self.kinks + 1
        self.lines.append(f"    if natural: choices[c, {k}] = {natural}")
        return self.let(f"choices[c, {k}]")

    def times(self, factor: str, x: _Jet) -> _Jet:
        return replace(self.weighted([(factor, x)]), value=self.let(f"{factor} * {x.value}"))

    def ramp(self, node: Any, x: _Jet) -> _Jet:
        if isinstance(node, sp.Abs):
            return self.times(self.let(f"float({self.chosen(f'-1 if {x.value} < 0.0 else 1')})"), x)
        side = self.chosen(f"1 if {x.value} {'>= 0.0' if node.slope > 0 else '< 0.0'} else 0")
        return self.times(self.let(f"{float(node.slope)} * {side}"), x)

    def extreme(self, node: Any, *parts: _Jet) -> _Jet:
        less = "<" if isinstance(node, sp.Max) else ">"
        natural = str(len(parts) - 1)
        for i in reversed(range(len(parts) - 1)):
            first = " and ".join(f"not {parts[i].value} {less} {b.value}" for b in parts[i + 1 :])
            natural = f"{i} if {first} else {natural}"
        return self.selected(self.chosen(natural), parts)

    def choice(self, _: Any, condition: _Jet, then: _Jet, otherwise: _Jet) -> _Jet:
        return self.selected(self.chosen(f"0 if {condition.value} == 1.0 else 1"), (then, otherwise))

    def selected(self, which: str, parts: Sequence[_Jet]) -> _Jet:
        def pick(texts: Sequence[str]) -> str:
            heads = [f"{text} if {which} == {i} else " for i, text in enumerate(texts[:-1])]
            return "".join(heads) + texts[-1]

        slopes = {i: pick([a.slopes.get(i, "0.0") for a in parts]) for i in sorted({i for a in parts for i in a.slopes})}
        bends = {ij: pick([a.bends.get(ij, "0.0") for a in parts]) for ij in sorted({ij for a in parts for ij in a.bends})}
        return self.named(self.let(pick([a.value for a in parts])), slopes, bends)


def _compared(sign: str, to: _Writer, _: Any, a: _Jet, b: _Jet) -> _Jet:
    return _Jet(to.let(f"1.0 if {a.value} {sign} {b.value} else 0.0"))


TABLE: Mapping[type, Callable[..., _Jet]] = {
    sp.Add: lambda to, _, *terms: reduce(to.sum, terms),
    sp.Mul: lambda to, _, *factors: reduce(to.product, factors),
    sp.Pow: _Writer.power,
    **{word.node: lambda to, _, x, word=word: to.elementary(word, x) for word in ELEMENTARY.values()},
    Atan2: _Writer.angle,
    Norm: lambda to, _, *parts: to.norm(sp.Integer(2), *parts),
    EigMax: _Writer.eigenvalue,
    PNorm: lambda to, node, _, *parts: to.norm(node.args[0], *parts),
    **dict.fromkeys((sp.Abs, Pos, Neg), _Writer.ramp),
    **dict.fromkeys((sp.Max, sp.Min), _Writer.extreme),
    Where: _Writer.choice,
    **{kind: partial(_compared, kind.rel_op) for kind in COMPARISONS},  # type: ignore[attr-defined]
}


def scalar_values(name: str, exprs: Sequence[sp.Basic], others: Sequence[sp.Symbol]) -> tuple[str, tuple[float, ...]]:
    """A function ``name(q, out)`` as text that fills ``out`` with the values of ``exprs``, and its constants.

    ``q``: numbers of the ``others``, then the constants.  A comparison is 1 or 0.  InputError for a word without a row here.
    """
    numbers = dict[str, int]()
    writer = _Writer(0, numbers)
    found = [writer.jet(recognised(expr), (), others).value for expr in exprs]
    lines = [f"def {name}(q, out):", *writer.lines, *(f"    out[{k}] = {value}" for k, value in enumerate(found)), "    return"]
    return "\n".join(lines), tuple(map(float, numbers))


def _number(node: Any) -> str:
    try:
        value = int(node.p) / int(node.q) if node.is_Rational else float(node)
    except (OverflowError, TypeError):
        raise InputError(f"{node} has no value in double precision", remedy="rescale the formula") from None
    return repr(value)


def _times(factor: str, of: Mapping[K, str]) -> Mapping[K, str]:
    return {place: f"{factor} * {text}" for place, text in of.items()}


def _added(first: Mapping[K, str], second: Mapping[K, str]) -> Mapping[K, str]:
    """Place by place; what has no text is 0."""
    return {place: " + ".join(of[place] for of in (first, second) if place in of) for place in {**first, **second}}


def _squares(texts: Sequence[str]) -> str:
    return " + ".join(f"{text} * {text}" for text in texts) or "0.0"
