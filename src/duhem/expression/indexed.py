"""Tables, sums and maxima over an index, and vectors of formulas, written out before a formula is read.

``w[i, j]`` is a number of a table, counted from 1; ``sum(i, 1, n, x)`` and ``max_over(i, 1, n, x)`` repeat x with whole numbers in place
of i; ``vector(i, 1, n, x)``, which stands alone, is a list of formulas, of which ``z[i]`` is one.  What is read then is a formula of the
vocabulary alone.  Numbers pass through as the text that they are.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import accumulate
from typing import NoReturn

from duhem.errors import InputError
from duhem.expression.spelling import spelled
from duhem.expression.vocabulary import nested

__all__ = ["Indexed", "WrittenOver", "component"]

_INDEXED = re.compile(r"\[|(?<!\w)(?:sum|max_over|vector)\s*\(")
_ALLOWED = re.compile(r"[\w\s.+\-*/(),<>=\[\]]*")
_MOST_IN_ALL = 50_000_000
_MOST_CHARACTERS, _MOST_DEPTH, _MOST_TERMS = 20_000, 60, 20_000
_WHOLE = "an index is a whole number, an index of a sum, or made of these by + - *"
_USAGE = "write {0}(i, 1, 24, ...)"
_Scope = Mapping[str, int]


class WrittenOver(str):
    """A text that was made of another: a fault in it lies where that begins."""


def component(name: str, i: int) -> str:
    """The name of a part of a vector."""
    return f"{name}__{i}"


@dataclass(frozen=True)
class Indexed:
    """``tables`` of numbers as texts, row by row; ``vectors`` with their lengths; ``taken`` are names that no index may have."""

    tables: Mapping[str, Sequence[Sequence[str]]] = field(default_factory=dict)
    vectors: Mapping[str, int] = field(default_factory=dict)
    taken: frozenset[str] = frozenset()

    def written_over(self, text: str) -> str:
        """``text`` without indices; as it is where it has none, or a sign that is none of the language, which its reader finds.

        InputError, without a place, for what is wrong with an index.
        """
        if not _INDEXED.search(text) or not _ALLOWED.fullmatch(text):
            return text
        tree, source = _read(text)
        return WrittenOver(_Writer(self, source).text(tree, {}))

    def parts(self, text: str) -> list[str] | None:
        """The formulas of a text that is a vector; None for any other."""
        if not re.match(r"\s*vector\s*\(", text) or not _ALLOWED.fullmatch(text):
            return None
        tree, source = _read(text)
        if not (isinstance(tree, ast.Call) and isinstance(tree.func, ast.Name) and tree.func.id == "vector"):
            raise InputError("a vector stands beside something else", remedy='define it alone: z = "vector(i, 1, 24, ...)"')
        writer = _Writer(self, source)
        return list(map(WrittenOver, writer.within(_MOST_IN_ALL, tree, {})))


def _read(text: str) -> tuple[ast.expr, bytes]:
    """The tree of a text, and what its places count in; nothing of it is executed."""
    text = re.sub(r"\s", " ", text)
    if len(text) > _MOST_CHARACTERS:
        raise InputError(f"the formula has {len(text)} characters", remedy=f"at most {_MOST_CHARACTERS} are read")
    if max(accumulate((mark in "([") - (mark in ")]") for mark in text), default=0) > _MOST_DEPTH:
        raise InputError("the formula is nested too deeply", remedy=f"at most {_MOST_DEPTH} brackets deep")
    try:
        return ast.parse(f"({text})", mode="eval").body, f"({text})".encode()
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
                return f"({' + '.join(x if plain else f'({x})' for x in self.within(_MOST_CHARACTERS, part, scope))})"
            case ast.Call(func=ast.Name(id="max_over")):
                return nested("max", list(self.within(_MOST_CHARACTERS, part, scope)))
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
