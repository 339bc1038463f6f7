"""Names that stand for a formula, invariants of a stress, and indices, written out before a formula is read.

What is read, simplified, proved and checked is a formula of the vocabulary alone; nothing further on knows an abbreviation.

An invariant is that of a tensor: of the stress, or of a sum of multiples of tensors, each of which has all of its components declared.

Tension is positive, stresses in one unit.  ``3d`` is the symmetric tensor sigma with the components xx, yy, zz, yz, xz, xy; ``plane``
is plane stress, the same tensor with sigma_zz = sigma_yz = sigma_xz = 0; ``principal`` are its principal stresses 1, 2, 3 in no order.

Each shear component stands once among the forces.  Its work-conjugate is the engineering strain gamma_xy = 2 epsilon_xy, so that
sum_i sigma_i d_i over the listed components is the inner product sigma : epsilon of the tensors.  The derivative of g by the listed
sigma_xy is twice the tensor's component, a shear strain again: the normality rule in the listed components is the tensor's.

``w[i, j]`` is a number of a table, counted from 1; ``sum(i, 1, n, x)`` and ``max_over(i, 1, n, x)`` repeat x with whole numbers in place
of i; ``vector(i, 1, n, x)``, which stands alone, is a list of formulas, of which ``z[i]`` is one.  What is read then is a formula of the
vocabulary alone.  Numbers pass through as the text that they are.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import accumulate
from typing import NamedTuple, NoReturn

from duhem.errors import InputError
from duhem.expression.number import DECIMAL
from duhem.expression.syntax import PlacedText, expression_tree, spelled
from duhem.expression.vocabulary import nested

__all__ = [
    "INVARIANTS", "KINDS", "MOST_CHARACTERS", "MOST_DEPTH", "NONE", "Abbreviations", "Indexed", "Stress", "WrittenOut", "component",
    "names_in",
]  # fmt: skip

KINDS: Mapping[str, tuple[str, ...]] = {
    "3d": ("xx", "yy", "zz", "yz", "xz", "xy"),
    "plane": ("xx", "yy", "xy"),
    "principal": ("1", "2", "3"),
}
_ENDS = ("xx", "yy", "zz", "yz", "xz", "xy", "zy", "zx", "yx", "1", "2", "3")  # of names that may be meant for components
_MOST_OF_A_COMPONENT = 5_000  # letters, where definitions are written out
MOST_CHARACTERS, MOST_DEPTH = 20_000, 60  # of a formula that is read


@dataclass(frozen=True)
class Stress:
    """The stress tensor ``name`` (so that its components are name_xx ...) of one of the ``KINDS``."""

    name: str
    kind: str

    def __post_init__(self) -> None:
        if not isinstance(self.name, str) or not self.name.isidentifier():
            raise InputError(f"{self.name!r} is no name of a stress", remedy="use letters, digits and underscores")
        object.__setattr__(self, "name", spelled(self.name))
        if not isinstance(self.kind, str) or self.kind not in KINDS:
            raise InputError(f"{self.kind!r} is no kind of stress", remedy=f"kinds are: {', '.join(KINDS)}")

    @property
    def components(self) -> tuple[str, ...]:
        """The names of the forces that a law of this stress has."""
        return tuple(f"{self.name}_{end}" for end in KINDS[self.kind])

    @property
    def shears(self) -> tuple[bool, ...]:
        """Which of the components are shear stresses, whose conjugate is an engineering strain."""
        return tuple(len(set(end)) == 2 for end in KINDS[self.kind])

    @property
    def unit_stiffness(self) -> tuple[float, ...]:
        """Stress a conjugate, where one number, 1, is the stiffness of the tensors: 1/2 for a shear, whose conjugate is 2 epsilon."""
        return tuple(0.5 if shear else 1.0 for shear in self.shears)

    def written_out(self, word: str, index: int | None = None) -> str:
        """An invariant as a formula in the components; ``index`` from 1 is that of ``principal``, the greatest first."""
        return INVARIANTS[word].text(Tensor(self.kind, self.components), *([] if index is None else [index]))


class Tensor(NamedTuple):
    """The components of one ``kind``, each a name or a formula in brackets: of the stress, or of a sum such as sigma - alpha."""

    kind: str
    components: tuple[str, ...]


@dataclass(frozen=True)
class Invariant:
    """A word that takes a tensor; ``text`` gives its formula, ``indexed`` says that it takes a number, one digit, as well."""

    text: Callable[..., str]
    meaning: str
    indexed: bool = False


def _trace(tensor: Tensor) -> str:
    return " + ".join(tensor.components[: 2 if tensor.kind == "plane" else 3])


def _det(tensor: Tensor) -> str:
    if tensor.kind == "plane":
        x, y, xy = tensor.components
        raise InputError("det of plane stress is 0", remedy=f"that in the plane is {x}*{y} - {xy}**2")
    x, y, z, *shear = tensor.components
    return f"{x}*{y}*{z}" + (_shear_terms(x, y, z, *shear) if shear else "")


def _shear_terms(x: str, y: str, z: str, yz: str, xz: str, xy: str) -> str:
    """What shear adds to the product of the diagonal in a determinant."""
    return f" + 2*{yz}*{xz}*{xy} - {x}*{yz}**2 - {y}*{xz}**2 - {z}*{xy}**2"


def _second(tensor: Tensor) -> str:
    """A sum of squares, so that its sign and curvature are seen."""
    x, y, *rest = tensor.components
    if tensor.kind == "plane":
        return f"(({x} - {y})**2 + {x}**2 + {y}**2)/6 + {rest[0]}**2"
    z, *shear = rest
    return f"(({x} - {y})**2 + ({y} - {z})**2 + ({z} - {x})**2)/6" + "".join(f" + {s}**2" for s in shear)


def _third(tensor: Tensor) -> str:
    if tensor.kind == "plane":
        x, y, xy = tensor.components
        return f"({x} + {y})*(9*{xy}**2 - (2*{x} - {y})*(2*{y} - {x}))/27"
    x, y, z, *shear = tensor.components
    deviator = [f"(2*{a} - {b} - {c})" for a, b, c in ((x, y, z), (y, z, x), (z, x, y))]
    return f"{'*'.join(deviator)}/27" + (_shear_terms(*(f"{s}/3" for s in deviator), *shear) if shear else "")


def _cos3theta(tensor: Tensor) -> str:
    return f"3*sqrt(3)/2*({_third(tensor)})/({_second(tensor)})**(3/2)"


def _principal(tensor: Tensor, index: int) -> str:
    if tensor.kind == "3d":
        greatest = f"eigmax({', '.join(tensor.components)})"
        least = f"eigmax({', '.join(f'-{x}' for x in tensor.components)})"  # less its negative
        return {1: greatest, 2: f"{_trace(tensor)} - {greatest} + {least}", 3: f"-{least}"}[index]
    if tensor.kind == "plane":
        x, y, xy = tensor.components
        if index == 3:
            raise InputError("the third principal stress of plane stress is 0", remedy="1 and 2 are those in the plane, the greater first")
        return f"({x} + {y})/2 {'+' if index == 1 else '-'} norm(({x} - {y})/2, {xy})"
    listed = ", ".join(tensor.components)
    greatest, least = f"max({listed})", f"min({listed})"
    return {1: greatest, 2: f"{_trace(tensor)} - {greatest} - {least}", 3: least}[index]


INVARIANTS: Mapping[str, Invariant] = {
    "I1": Invariant(_trace, "trace"),
    "tr": Invariant(_trace, "trace"),
    "det": Invariant(_det, "determinant"),
    "J2": Invariant(_second, "half the square of the deviator, s:s/2"),
    "J3": Invariant(_third, "determinant of the deviator"),
    "cos3theta": Invariant(_cos3theta, "3*sqrt(3)/2*J3/J2**(3/2), 1 in triaxial tension, -1 in compression"),
    "lode": Invariant(lambda tensor: f"acos({_cos3theta(tensor)})/3", "Lode angle acos(cos3theta)/3 (rad), from 0 to pi/3"),
    "principal": Invariant(_principal, "principal stress 1, 2 or 3, the greatest first", indexed=True),
}


_TOKEN = re.compile(rf"(?P<number>{DECIMAL})|(?P<name>[^\W\d]\w*)")


def names_in(text: str) -> set[str]:
    """Every name in a formula."""
    return {spelled(token[0]) for token in _TOKEN.finditer(text) if token.lastgroup == "name"}


def _arguments(text: str, at: int) -> tuple[list[str], int]:
    """What stands between the commas of the brackets that open at ``at``, and where these end; nothing where none do."""
    depth, begin, found = 0, at, list[str]()
    for i in range(at, len(text)):
        depth += {"(": 1, ")": -1}.get(text[i], 0)
        if depth == 0 and not text[i].isspace():
            return [*found, text[begin:i].strip()] if text[i] == ")" else [], i + 1
        if depth == 1 and text[i] in "(,":
            found += [text[begin:i].strip()] if text[i] == "," else []
            begin = i + 1
    return [], at


@dataclass(frozen=True)
class WrittenOut:
    """A formula without abbreviations, and the ``source`` it was made of.

    ``seams`` are places (in the text, in the source, whether what begins there was copied): in order, each up to the next.
    """

    text: str
    source: str
    seams: tuple[tuple[int, int, bool], ...]

    def origin(self, at: int) -> int:
        """Where in the source a place of the text comes from: inside of an abbreviation, where that stands."""
        here, there, copied = self._seam(at)
        return there + (at - here) * copied

    def abbreviation(self, at: int) -> str | None:
        """The abbreviation in whose formula a place of the text lies, if it lies in one."""
        here, _, copied = self._seam(at)
        return None if copied else self.segment(here, at + 1)

    def segment(self, start: int, end: int) -> str:
        """What stands in the source for a part of the text that is not empty."""
        here, there, copied = self._seam(end - 1)
        behind = there + (end - here) if copied else next(seam[1] for seam in self.seams if seam[0] >= end)
        return self.source[self.origin(start) : behind]

    def _seam(self, at: int) -> tuple[int, int, bool]:
        return next(seam for seam in reversed(self.seams) if seam[0] <= at)


@dataclass(frozen=True)
class Abbreviations:
    """``formulas`` by name, nothing abbreviated left in them; the ``stress`` whose invariants are words; names ``to_come``.

    ``own`` has each formula with the names above it left in; one that is not among ``formulas`` is too long to be written out.
    ``known`` are the other names of the law: those of which all components are among these, or defined, are tensors.
    """

    formulas: Mapping[str, str] = field(default_factory=dict)
    stress: Stress | None = None
    to_come: frozenset[str] = frozenset()
    own: Mapping[str, str] = field(default_factory=dict)
    known: frozenset[str] = frozenset()

    def used_by(self, text: str) -> list[str]:
        """The definitions that a text uses, itself or by others, in order."""
        found, queue = set[str](), [text]
        while queue:
            new = {name for name in names_in(queue.pop()) if name in self.own} - found
            found |= new
            queue += [self.own[name] for name in new]
        return [name for name in self.own if name in found]

    def alone(self) -> Abbreviations:
        """The invariants without the definitions, whose names stay."""
        return replace(self, formulas={}, own={}, known=self.known.union(self.own))

    def words(self) -> frozenset[str]:
        """The invariants that may be used, whose names are taken."""
        return frozenset(INVARIANTS) if self.stress else frozenset()

    def written_out(self, text: str, fault: Callable[[str, int, str], InputError], most: int) -> WrittenOut:
        """``text`` without abbreviations, up to ``most`` characters; a wrong one raises ``fault`` (what, where, remedy)."""
        made, seams, length, behind = list[str](), [(0, 0, True)], 0, 0

        def put(part: str, at: int, copied: bool) -> None:
            nonlocal length
            seams.append((length, at, copied))
            made.append(part)
            length += len(part)

        for token in _TOKEN.finditer(text):
            if token.lastgroup != "name" or token.start() < behind:
                continue
            at = token.start()
            try:
                long, end = self._long(text, token)
            except InputError as wrong:
                raise fault(wrong.what, at, wrong.remedy) from None
            if long is not None:
                put(text[behind:at], behind, True)
                put(f"({long})", at, False)
                behind = end
                if length > most:
                    raise fault("the formula is too large with its definitions written out", at, f"at most {most} characters are read")
        put(text[behind:], behind, True)
        return WrittenOut("".join(made), text, tuple(seams))

    def _long(self, text: str, token: re.Match[str]) -> tuple[str | None, int]:
        """What the name at ``token`` stands for, if it is an abbreviation, and where it ends."""
        name, end = spelled(token[0]), token.end()
        called = text[end:].lstrip().startswith("(")
        if name in self.to_come:
            raise InputError(f"{name!r} is used before it is defined", remedy="a definition may use only the names above it")
        if name in self.own and name not in self.formulas:
            raise InputError(f"{name!r} is too large to be written out, which is done here", remedy="g alone may use it; shorten it")
        if name in self.formulas:
            if called:
                raise InputError(f"{name!r} is not a function of the language", remedy=f"write {name}*(...)")
            return self.formulas[name], end
        if name not in INVARIANTS or not (called or self.stress):
            return None, end
        if called:
            given, end = _arguments(text, end)
        else:
            given = [self.stress.name] if self.stress and not INVARIANTS[name].indexed else []
        return self._invariant(name, given), end

    def _invariant(self, word: str, given: list[str]) -> str | None:
        """``J2`` is ``J2(sigma)`` and ``principal(1)`` is ``principal(sigma, 1)``, as in print; None without a tensor or a stress."""
        indexed, stress = INVARIANTS[word].indexed, self.stress.name if self.stress else ""
        of, index = (given[:-1], "".join(given[-1:])) if indexed else (given, "")
        tensor = self._tensor(of[0] if of else stress) if len(of) <= 1 and (given or indexed) else None
        if tensor is not None and (index.isdigit() or not indexed):
            if indexed and index not in ("1", "2", "3"):
                raise InputError(f"there is no principal stress {index[:24]}", remedy="1 is the greatest, 3 the least")
            return INVARIANTS[word].text(tensor, *map(int, index))
        if self.stress is None:
            return None
        usage = f"{word}({stress}, 1)" if indexed else f"{word}({stress})"
        first = f"X_{KINDS[self.stress.kind][0]}"
        other = f"; for a sum such as {stress} - X, declare all components {first} ... of X and no other, or define them above"
        what = f"{word} takes the declared stress{' and a number' * indexed}"
        raise InputError(what, remedy=f"write {usage}: {INVARIANTS[word].meaning}{other}")

    def _tensor(self, text: str) -> Tensor | None:
        """The tensor that a formula is, linear in the names of tensors; None where it is no tensor of the stress's kind, or of any."""
        for kind in [self.stress.kind] if self.stress else KINDS:
            names = {x for x in names_in(text) if self._is_tensor(x, kind)}
            if names and _degree(text, names) == 1:
                ends = KINDS[kind]
                if text in names:
                    return Tensor(kind, tuple(self._plain(f"{text}_{end}") for end in ends))
                return Tensor(kind, tuple(f"({self._plain(_of_components(text, names, end))})" for end in ends))
        return None

    def _is_tensor(self, name: str, kind: str) -> bool:
        """Whether the stress, or the components of this kind, and of no larger one, are declared."""
        if self.stress is not None and name == self.stress.name:
            return True
        declared = {end for end in _ENDS if f"{name}_{end}" in self.known or f"{name}_{end}" in self.own}
        return declared == {*KINDS[kind]}

    def _plain(self, text: str) -> str:
        return self.written_out(text, lambda what, _, remedy: InputError(what, remedy=remedy), len(text) + _MOST_OF_A_COMPONENT).text


def _of_components(text: str, tensors: Collection[str], end: str) -> str:
    return _TOKEN.sub(lambda x: f"{x[0]}_{end}" if spelled(x[0]) in tensors else x[0], text)


def _degree(text: str, tensors: set[str]) -> int | None:
    """1 for a sum of tensors times numbers, 0 for what has no tensor in it; None for anything else."""

    def degree(node: ast.AST) -> int | None:
        match node:
            case ast.BinOp(one, ast.Add() | ast.Sub() | ast.Mult() | ast.Div() as way, two):
                ones, twos = degree(one), degree(two)
                if ones is None or twos is None:
                    return None
                if isinstance(way, ast.Add | ast.Sub):
                    return ones if ones == twos else None
                return None if ones + twos > 1 or (twos and isinstance(way, ast.Div)) else ones + twos
            case ast.UnaryOp(_, one):
                return degree(one)
            case ast.Name(name) if spelled(name) in tensors:
                return 1
        return None if any(isinstance(x, ast.Name) and spelled(x.id) in tensors for x in ast.walk(node)) else 0

    try:
        return degree(expression_tree(f"({text})"))
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return None  # who reads the formula says what is wrong with it


NONE = Abbreviations()


# -- indices: tables, sums, maxima and vectors -------------------------------------------------------------------------


_INDEXED = re.compile(r"\[|(?<!\w)(?:sum|max_over|vector)\s*\(")
_ALLOWED = re.compile(r"[\w\s.+\-*/(),<>=\[\]]*")
_MOST_IN_ALL = 50_000_000
_MOST_TERMS = 20_000
_WHOLE = "an index is a whole number, an index of a sum, or made of these by + - *"
_USAGE = "write {0}(i, 1, 24, ...)"
_Scope = Mapping[str, int]


def component(name: str, i: int) -> str:
    """The name of a part of a vector."""
    return f"{name}__{i}"


@dataclass(frozen=True)
class Indexed:
    """``tables`` of numbers as texts, row by row; ``vectors`` with their lengths; ``taken`` are names that no index may have."""

    tables: Mapping[str, Sequence[Sequence[str]]] = field(default_factory=dict)
    vectors: Mapping[str, int] = field(default_factory=dict)
    taken: frozenset[str] = frozenset()

    def written_over(self, text: PlacedText) -> PlacedText:
        """``text`` without indices; as it is where it has none, or a sign that is none of the language, which its reader finds.

        InputError, without a place, for what is wrong with an index.
        """
        if not _INDEXED.search(text) or not _ALLOWED.fullmatch(text):
            return text
        tree, source = _read(text)
        return text.made_into(_Writer(self, source).text(tree, {}))

    def parts(self, text: PlacedText) -> list[PlacedText] | None:
        """The formulas of a text that is a vector; None for any other."""
        if not re.match(r"\s*vector\s*\(", text) or not _ALLOWED.fullmatch(text):
            return None
        tree, source = _read(text)
        if not (isinstance(tree, ast.Call) and isinstance(tree.func, ast.Name) and tree.func.id == "vector"):
            raise InputError("a vector stands beside something else", remedy='define it alone: z = "vector(i, 1, 24, ...)"')
        return list(map(text.made_into, _Writer(self, source).within(_MOST_IN_ALL, tree, {})))


def _read(text: str) -> tuple[ast.expr, bytes]:
    """The tree of a text, and what its places count in; nothing of it is executed."""
    text = re.sub(r"\s", " ", text)
    if len(text) > MOST_CHARACTERS:
        raise InputError(f"the formula has {len(text)} characters", remedy=f"at most {MOST_CHARACTERS} are read")
    if max(accumulate((mark in "([") - (mark in ")]") for mark in text), default=0) > MOST_DEPTH:
        raise InputError("the formula is nested too deeply", remedy=f"at most {MOST_DEPTH} brackets deep")
    try:
        return expression_tree(f"({text})"), f"({text})".encode()
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        raise InputError("the formula with its indices cannot be read", remedy="check its brackets and operators") from None


@dataclass(frozen=True)
class _Writer:
    """Writes parts of one source out; what holds no index is copied as it stands."""

    own: Indexed
    source: bytes
    _found: dict[tuple[int, frozenset[str]], list[ast.expr]] = field(default_factory=dict)

    def text(self, node: ast.expr, scope: _Scope) -> str:
        """A part of the source with the indices of ``scope`` put in."""
        made, at, end = list[str](), node.col_offset, node.end_col_offset or 0
        for part in self.indexed(node, frozenset(scope)):
            made += [self.source[at : part.col_offset].decode(), self.written(part, scope)]
            at = part.end_col_offset or 0
        return "".join([*made, self.source[at:end].decode()])

    def indexed(self, node: ast.expr, names: frozenset[str]) -> list[ast.expr]:
        """The outermost parts that an index has to do with, in order; the same for all values of the indices."""
        if (key := (id(node), names)) not in self._found:
            self._found[key] = sorted(_outermost(node, names), key=lambda part: part.col_offset)
        return self._found[key]

    def written(self, part: ast.expr, scope: _Scope) -> str:
        match part:
            case ast.Name(id=name):
                return _signed(str(scope[name]))
            case ast.Subscript(value=ast.Name(id=name), slice=place):
                return self.entry(spelled(name), [self.whole(x, scope) for x in (place.elts if isinstance(place, ast.Tuple) else [place])])
            case ast.Call(func=ast.Name(id="sum")):
                plain = len(part.args) == 4 and _is_factor(part.args[3])
                return f"({' + '.join(x if plain else f'({x})' for x in self.within(MOST_CHARACTERS, part, scope))})"
            case ast.Call(func=ast.Name(id="max_over")):
                return nested("max", list(self.within(MOST_CHARACTERS, part, scope)))
        self.refuse(part, "a vector or a table stands where a formula should", "take one entry of it, as in w[1, 2] or z[1]")

    def within(self, most: int, call: ast.Call, scope: _Scope) -> Iterator[str]:
        """What a call repeats, written out, up to so many characters in all."""
        length = 0
        for body, here in self.repeated(call, scope):
            length += len(made := self.text(body, here))
            if length > most:
                self.refuse(call, "it is too large, written out", f"at most {most} characters are read")
            yield made

    def repeated(self, call: ast.Call, scope: _Scope) -> Iterator[tuple[ast.expr, _Scope]]:
        """The formula that a call repeats, with the indices of each time."""
        word = call.func.id if isinstance(call.func, ast.Name) else ""
        if len(call.args) != 4 or call.keywords or not isinstance(call.args[0], ast.Name):
            self.refuse(call, f"{word} takes an index, two whole numbers and a formula", _USAGE.format(word))
        name, body = call.args[0].id, call.args[3]
        if name in scope or spelled(name) in {*self.own.taken, *self.own.tables, *self.own.vectors}:
            self.refuse(call, f"the index {name!r} already means something", "choose another name for it")
        first, last = (self.whole(x, scope) for x in call.args[1:3])
        if last < first:
            self.refuse(call, f"the range from {first} to {last} is empty", "correct its ends")
        if last - first >= _MOST_TERMS:
            self.refuse(call, f"the range from {first} to {last} is too long", f"at most {_MOST_TERMS} terms are written out")
        yield from ((body, {**scope, name: k}) for k in range(first, last + 1))

    def whole(self, node: ast.expr, scope: _Scope) -> int:
        """The whole number that an index expression is."""
        match node:
            case ast.Constant(value=int(value)) if not isinstance(value, bool):
                return value
            case ast.Name(id=name) if name in scope:
                return scope[name]
            case ast.UnaryOp(op=ast.USub(), operand=inner):
                return -self.whole(inner, scope)
            case ast.BinOp(left=left, op=ast.Add() | ast.Sub() | ast.Mult() as op, right=right):
                a, b = self.whole(left, scope), self.whole(right, scope)
                return a + b if isinstance(op, ast.Add) else a - b if isinstance(op, ast.Sub) else a * b
        self.refuse(node, "this is no whole number", _WHOLE)

    def entry(self, name: str, places: Sequence[int]) -> str:
        """A number of a table, or the name of a part of a vector."""
        said = f"{name}[{', '.join(map(str, places))}]"
        if name in self.own.vectors:
            if len(places) != 1 or not 1 <= places[0] <= self.own.vectors[name]:
                raise InputError(f"{said} is not there", remedy=f"{name} has the parts 1 to {self.own.vectors[name]}")
            return component(name, places[0])
        if name not in self.own.tables:
            known = ", ".join([*self.own.tables, *self.own.vectors]) or "nothing"
            raise InputError(f"{said}: {name} is no table and no vector defined above", remedy=f"those are: {known}")
        rows = self.own.tables[name]
        height, width = len(rows), len(rows[0])
        if len(places) == 1 and 1 in (height, width):
            places = [1, *places] if height == 1 else [*places, 1]
        if len(places) != 2 or not (1 <= places[0] <= height and 1 <= places[1] <= width):
            raise InputError(f"{said} is not there", remedy=f"{name} has the rows 1 to {height} and the columns 1 to {width}")
        return _signed(rows[places[0] - 1][places[1] - 1])

    def refuse(self, node: ast.expr, what: str, remedy: str) -> NoReturn:
        said = " ".join(self.source[node.col_offset : node.end_col_offset or 0].decode().split())
        raise InputError(f"{said[:40]!r}: {what}", remedy=remedy)


def _outermost(node: ast.AST, names: frozenset[str]) -> Iterator[ast.expr]:
    call = isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id in ("sum", "max_over", "vector")
    if isinstance(node, ast.expr) and (call or isinstance(node, ast.Subscript) or (isinstance(node, ast.Name) and node.id in names)):
        yield node
        return
    for inner in ast.iter_child_nodes(node):
        yield from _outermost(inner, names)


def _is_factor(node: ast.expr) -> bool:
    """Whether it is added as it stands."""
    return not isinstance(node, ast.BinOp | ast.UnaryOp) or isinstance(getattr(node, "op", None), ast.Mult | ast.Div | ast.Pow)


def _signed(number: str) -> str:
    return f"({number})" if number.startswith("-") else number
