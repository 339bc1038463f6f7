"""Text to formula, safely: a whitelist of tokens, then of syntax-tree nodes, then of values.

Nothing in the text is ever executed.  Every fault is one :class:`duhem.errors.InputError` that names its place
(file, line, column), the offending token, and the way out.

Where definitions are too long to be written out, the formula is kept as a graph: each definition is read once, and its value made when
it is asked for.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Callable, Collection, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import lru_cache
from keyword import iskeyword
from typing import Any, Self

import sympy as sp
from sympy.core.relational import Relational

from duhem.errors import InputError, meant
from duhem.expression.abbreviations import INVARIANTS, MOST_CHARACTERS, MOST_DEPTH, NONE, Abbreviations, WrittenOut, names_in
from duhem.expression.build import AS_WRITTEN, EVALUATED, IN_RANGE, UNMADE, Building, settled, unacceptable
from duhem.expression.fold import Graph, Shared, fold
from duhem.expression.number import DECIMAL, exact_number
from duhem.expression.syntax import PlacedText, expression_tree, spelled
from duhem.expression.vocabulary import MOST_ARGUMENTS, NODES, WORDS, symbol

__all__ = [
    "check_formula", "check_size", "own_text", "parse_as_written", "parse_expression", "parse_graph", "parse_relation", "reread",
    "too_long", "written_out",
]  # fmt: skip

MOST_TOKENS = 4_000
MOST_NODES = 8_000  # of what is written out with parts of it repeated

_TOKEN = re.compile(
    rf"(?P<space>[ \t\n]+)|(?P<number>{DECIMAL})|(?P<joint>(?:and|or)(?!\w))|(?P<name>[^\W\d]\w*)"
    r"|(?P<operator>\*\*|<=|>=|[-+*/(),<>])(?!=|(?<=/)/)"
)
_ARITHMETIC = "write it with numbers, declared names, + - * / ** and the words of the language"
_CHOICE = "write where(x > 0, a, b)"
_DIGITS = "write numbers with the digits 0 to 9, powers with **"
_INSTEAD = {  # of words of other languages, which are like others of this one
    "asinh": "write log(x + sqrt(x**2 + 1))", "acosh": "write log(x + sqrt(x**2 - 1))", "atanh": "write log((1 + x)/(1 - x))/2",
}  # fmt: skip
_HINTS = {
    "^": "write ** for a power",
    **dict.fromkeys("=!", "comparisons are < <= > >="),
    "/": "write / for a division",
    ".": "attributes are not part of the language",
    **dict.fromkeys("[{", "group with ( and )"),
    "#": "put comments outside the formula",
    "&": "write and",
    "|": "write or",
}
_COMPARISONS: dict[type[ast.cmpop], type[Relational]] = {
    ast.Lt: sp.StrictLessThan, ast.LtE: sp.LessThan, ast.Gt: sp.StrictGreaterThan, ast.GtE: sp.GreaterThan,
}  # fmt: skip


def parse_expression(text: str, known: Mapping[str, sp.Symbol], *, where: str = "formula", short: Abbreviations = NONE) -> sp.Expr:
    """The formula ``text`` over the symbols ``known``, as a real SymPy expression.

    ``where`` says where a text stands that does not know it, for the messages; ``short`` holds the abbreviations it may use.
    Decimals are exact rationals.  Raises InputError for anything outside the language, for values that are not
    real and finite (``log(0)``, ``sqrt(-1)``), and for what would be too large to compute.
    """
    reader = _Reader.over(text, known, where, short=short)
    tree = reader.syntax()
    return reader.finished(tree, reader.value(tree, 0))


@lru_cache(maxsize=256)
def reread(text: str, known: tuple[tuple[str, sp.Symbol], ...]) -> sp.Expr:
    """The formula of a text that is asked for again and again: by the prover, the kernel's statement of the law, and narrower domains."""
    return parse_expression(text, dict(known))


def parse_as_written(text: str, known: Mapping[str, sp.Expr], build: Building = AS_WRITTEN) -> Any:
    """The tree of a formula or comparison as it stands, over the values ``known``: what it divides by or takes a root of is all there.

    For a text that :func:`parse_expression` or :func:`parse_relation` accepts; made to be walked and evaluated, not to be calculated with.
    """
    reader = _Reader.over(text, known, "formula", build)
    tree = reader.syntax()
    if not isinstance(tree, ast.Compare):
        return reader.value(tree, 0)
    left, right, kind = reader.sides(tree, 0)
    return kind(left, right, evaluate=False)


def written_out(text: str, short: Abbreviations) -> str:
    """The formula without its abbreviations; for a text that :func:`parse_expression` accepts with them."""
    return short.written_out(text, lambda what, at, remedy: InputError(what, remedy=remedy), MOST_CHARACTERS).text


def too_long(text: str, short: Abbreviations) -> bool:
    """Whether a formula is longer than what is read once its definitions are written out; a wrong one is not said to be."""
    if not short.own:
        return False
    try:
        made = written_out(text, short)
    except InputError:
        used = names_in(text)
        return used.isdisjoint(short.to_come) and not used.isdisjoint(short.own)
    return len(made) > MOST_CHARACTERS or _has_too_many_tokens(made)


def check_size(text: PlacedText) -> None:
    """InputError where a formula, of which nothing else is to be checked, is longer than what is read."""
    place = _Place(text)
    place.check_length()
    if _has_too_many_tokens(text):
        raise place.too_large()


def check_formula(text: str, names: Collection[str], where: str, short: Abbreviations) -> None:
    """InputError where the ``text`` is no formula over the ``names``; no value is made of it, so that it may be long."""
    reader = _Reader.over(text, dict.fromkeys(names, sp.S.Zero), where, UNMADE, short)
    reader.value(reader.syntax(), 0)


def parse_relation(text: str, known: Mapping[str, sp.Symbol], *, where: str = "constraint", short: Abbreviations = NONE) -> Relational:
    """One comparison such as ``e < mu_b``.  One that always holds is kept as written; one that never does raises InputError."""
    reader = _Reader.over(text, known, where, short=short)
    tree = reader.syntax()
    if not isinstance(tree, ast.Compare):
        raise reader.place.error(f"{reader.quote(tree)} is no comparison", remedy="compare two expressions with < <= > or >=")
    left, right, kind = reader.sides(tree, 0)
    left, right = (reader.finished(tree, side) for side in (left, right))
    if kind(left, right) == sp.false:
        raise reader.place.error(f"the constraint {reader.quote(tree)} is contradictory: it never holds", remedy="correct or remove it")
    return kind(left, right, evaluate=False)


@dataclass(frozen=True)
class _Place:
    """Where a text stands, so that an offset in it becomes file:line:column."""

    text: PlacedText
    made: WrittenOut | None = None  # what is read instead of it, abbreviations written out

    def error(self, what: str, *, at: int = 0, remedy: str = "") -> InputError:
        """A fault at an offset in what is read."""
        at = self.made.origin(at) if self.made else at
        before = "" if self.text.made else self.text[:at]
        row = before.count("\n")
        column = len(before) - (before.rfind("\n") + 1) + (self.text.column if row == 0 else 0)
        return InputError(what, where=f"{self.text.where}:{self.text.line + row}:{column + 1}", remedy=remedy)

    def too_large(self, at: int = 0) -> InputError:
        return self.error("the formula is too large", at=at, remedy=f"at most {MOST_TOKENS} names, numbers and signs are read")

    def check_length(self) -> None:
        """InputError where the text has more characters than are read."""
        if len(self.text) > MOST_CHARACTERS:
            raise self.error(f"the formula has {len(self.text)} characters", remedy=f"at most {MOST_CHARACTERS} are read")


@dataclass(frozen=True)
class _Reader:
    """One text without abbreviations, with its names; ``known`` is keyed as Python's parser spells names (NFKC)."""

    text: str
    known: Mapping[str, sp.Expr]
    place: _Place
    build: Building
    short: Abbreviations

    @classmethod
    def over(cls, given: str, known: Mapping[str, sp.Expr], where: str, build: Building = EVALUATED, short: Abbreviations = NONE) -> Self:
        place = _Place(given if isinstance(given, PlacedText) else PlacedText(given, where))
        place.check_length()
        text = given.replace("\r", " ")  # line ends of other systems; offsets stay as they are
        names = {spelled(name): symbol for name, symbol in known.items()}
        for name in names:
            if name in WORDS or name in short.words() or name == "pi" or iskeyword(name):
                raise place.error(f"the name {name!r} already means something", remedy="choose another name for the force or parameter")
        if short != NONE:
            made = short.written_out(text, lambda what, at, remedy: place.error(what, at=at, remedy=remedy), MOST_CHARACTERS)
            text, place = made.text, replace(place, made=made)
        return cls(text, names, place, build, short)

    # -- tokens ------------------------------------------------------------------------------------------------

    def tokens(self) -> Iterator[re.Match[str]]:
        at = 0
        while at < len(self.text):
            token = _TOKEN.match(self.text, at)
            if token is None:
                mark = self.text[at]
                remedy = _DIGITS if mark.isdigit() else _HINTS.get(mark, _ARITHMETIC)
                raise self.place.error(f"unexpected {mark!r}", at=at, remedy=remedy)
            at = token.end()
            if token.lastgroup != "space":
                yield token

    def check_tokens(self) -> None:
        """Every token is in the language and in its place, every name has a meaning, brackets match and are not too deep."""
        opened: list[tuple[int, bool]] = []  # place of each open bracket, and whether it holds a word's arguments
        previous: re.Match[str] | None = None
        for count, token in enumerate(self.tokens(), 1):
            at = token.start()
            if count > MOST_TOKENS:
                raise self.place.too_large(at)
            self.check_order(token, previous)
            if token.lastgroup == "name":
                self.check_name(token)
            elif token[0] == "(":
                opened.append((at, previous is not None and previous.lastgroup == "name"))
                if len(opened) > MOST_DEPTH:
                    raise self.place.error("the formula is nested too deeply", at=at, remedy=f"at most {MOST_DEPTH} brackets deep")
            elif token[0] == ")":
                if not opened:
                    raise self.place.error("unexpected ')'", at=at, remedy="remove it or open it before")
                opened.pop()
            elif re.fullmatch(r"0+[1-9]\d*", token[0]):
                raise self.place.error(f"the number {token[0][:24]!r} begins with 0", at=at, remedy=f"write {token[0].lstrip('0')[:24]}")
            elif token[0] == "," and not (opened and opened[-1][1]):
                raise self.place.error("unexpected ','", at=at, remedy="write decimals with a point; commas separate arguments")
            previous = token
        if previous is None:
            raise self.place.error("the formula is empty", remedy=_ARITHMETIC)
        if opened:
            raise self.place.error("'(' is never closed", at=opened[-1][0], remedy="add the missing ')'")
        if not _ends_operand(previous):
            raise self.place.error(f"the formula ends after {previous[0]!r}", at=previous.start(), remedy="complete or remove it")

    def check_order(self, token: re.Match[str], previous: re.Match[str] | None) -> None:
        """Operands and operators alternate."""
        if previous is not None and _ends_operand(previous):
            if token.lastgroup == "joint" and previous.lastgroup == "number" and previous.end() == token.start():
                raise self.place.error(f"{token[0]!r} touches a number", at=token.start(), remedy="put a blank between them")
            joining = token.lastgroup in ("operator", "joint") and token[0] != "("
            if not joining and not (token[0] == "(" and previous.lastgroup == "name"):
                near = f"{self.given(token)!r} after {self.given(previous)!r}"
                raise self.place.error(f"unexpected {near}", at=token.start(), remedy="put an operator between them, such as *")
        elif token.lastgroup in ("operator", "joint") and token[0] not in ("-", "+", "("):
            raise self.place.error(f"unexpected {token[0]!r}", at=token.start(), remedy="put a number, a name or a bracket before it")

    def check_name(self, token: re.Match[str]) -> None:
        name, at = token[0], token.start()
        if not name.isidentifier():  # a superscript is of words to a pattern
            raise self.place.error(f"{name[:40]!r} is not a name", at=at, remedy=f"use letters, digits and underscores; {_DIGITS}")
        called = self.text[token.end() :].lstrip().startswith("(")
        if name in INVARIANTS and (called or name not in self.known):
            remedy = 'declare stress = { name = "sigma", kind = "3d" }, or all components of the tensor and no other'
            raise self.place.error(f"{name} is of a stress, and none is declared", at=at, remedy=remedy)
        if called and name not in WORDS:
            remedy = f"write {name}*(...)" if name in self.known else _INSTEAD.get(name) or self.suggest(name, [*WORDS], "functions")
            raise self.place.error(f"{name[:40]!r} is not a function of the language", at=at, remedy=remedy)
        if not called and name in WORDS:
            raise self.place.error(f"{name!r} needs its arguments in brackets", at=at, remedy=f"write {name}(...)")
        if name == "not":
            raise self.place.error("'not' is not part of the language", at=at, remedy="turn the comparison round: not x > 0 is x <= 0")
        if not called and name != "pi" and spelled(name) not in self.known:
            if self.place.made and (short := self.place.made.abbreviation(at)):
                what, remedy = f"{short[:40]!r} stands for a formula of {name!r}", f"known here: {', '.join(self.known) or 'nothing'}"
                raise self.place.error(f"{what}, which is not known here", at=at, remedy=remedy)
            raise self.place.error(f"unknown name {name[:40]!r}", at=at, remedy=self.suggest(name, [*self.known], "declare it, or use"))

    def given(self, token: re.Match[str]) -> str:
        """The token, or the abbreviation in whose formula it stands."""
        return ((self.place.made and self.place.made.abbreviation(token.start())) or token[0])[:24]

    def suggest(self, name: str, among: list[str], title: str) -> str:
        every = [*among, *self.short.formulas, *sorted(self.short.words()), *WORDS, "pi"]
        return meant(name, every, f"{title}: {', '.join(among) or 'nothing'}")

    # -- syntax ------------------------------------------------------------------------------------------------

    def syntax(self) -> ast.expr:
        """The syntax tree of a text whose tokens are all known, read as one line."""
        self.check_tokens()
        try:
            return expression_tree(f"({self.text})".replace("\n", " "))
        except SyntaxError as fault:  # the tokens are in order, so only Python's own limits are left
            raise self.place.error(f"the formula cannot be read: {fault.msg}", remedy="split it into smaller parts") from None
        except (RecursionError, MemoryError, ValueError):
            raise self.place.error("the formula is nested too deeply", remedy="split it into smaller parts") from None

    def start(self, node: ast.expr) -> int:
        return self.offset(node.col_offset)

    def offset(self, byte: int) -> int:
        """Of a place that Python's parser names, which has read one bracket more at the beginning."""
        return len(self.text.encode()[: max(byte - 1, 0)].decode(errors="ignore"))

    def segment(self, node: ast.expr, of: WrittenOut | None = None) -> str:
        """What stands for the node in the text, or in what that was made ``of``."""
        start, end = self.start(node), self.offset(node.end_col_offset or 0)
        return of.segment(start, end) if of else self.text[start:end]

    def quote(self, node: ast.expr) -> str:
        """The node as it stands in the text that was given."""
        segment = " ".join(self.segment(node, self.place.made).split())
        return repr(segment if len(segment) <= 40 else segment[:37] + "...")

    # -- values ------------------------------------------------------------------------------------------------

    def value(self, node: ast.expr, depth: int) -> sp.Expr:
        """The SymPy value of a node; chains of sums and of products are built at once, so only nesting has depth."""
        if depth > 4 * MOST_DEPTH:
            raise self.place.error("the formula is nested too deeply", at=self.start(node), remedy="split it into smaller parts")
        return self.evaluated(node, self.built, node, depth + 1)

    def evaluated(self, node: ast.expr, build: Callable[..., sp.Expr], *given: Any) -> sp.Expr:
        """What ``build`` makes of ``given``; a fault is one of ``node``."""
        try:
            return build(*given)
        except InputError as fault:
            if fault.where:
                raise
            raise self.place.error(f"{self.quote(node)}: {fault.what}", at=self.start(node), remedy=fault.remedy) from None
        except (ArithmeticError, ValueError, TypeError, RecursionError, NotImplementedError):
            raise self.place.error(f"{self.quote(node)} cannot be evaluated", at=self.start(node), remedy="rewrite that part") from None

    def finished(self, node: ast.expr, value: sp.Expr) -> sp.Expr:
        """The value settled; InputError where it cannot be used."""
        value = self.evaluated(node, settled, value)
        if fault := unacceptable(value, set(self.known.values())):
            raise self.place.error(fault.what, remedy=fault.remedy)
        return value

    def built(self, node: ast.expr, depth: int) -> sp.Expr:
        match node:
            case ast.Constant():
                return exact_number(self.segment(node))
            case ast.Name(id=name):
                return sp.pi if name == "pi" else self.known[name]
            case ast.UnaryOp(op=ast.USub(), operand=inner):
                return self.build.product([self.value(inner, depth)], [], sign=-1)
            case ast.UnaryOp(op=ast.UAdd(), operand=inner):
                return self.value(inner, depth)
            case ast.BinOp(op=ast.Add() | ast.Sub() | ast.Mult() | ast.Div()):
                is_sum = isinstance(node.op, ast.Add | ast.Sub)
                up, down = (ast.Add, ast.Sub) if is_sum else (ast.Mult, ast.Div)
                head, tail = _chain(node, (up, down))
                rest = [(op, self.value(term, depth)) for op, term in tail]
                over = [self.value(head, depth), *(v for op, v in rest if op is up)]
                return (self.build.total if is_sum else self.build.product)(over, [v for op, v in rest if op is down])
            case ast.BinOp(op=ast.Pow(), left=base, right=exponent):
                return self.build.power(self.value(base, depth), self.value(exponent, depth))
            case ast.Call(func=ast.Name(id=name), args=args, keywords=[]):
                return self.called(name, args, depth)
            case ast.Compare() | ast.BoolOp():
                raise InputError("a comparison may only be the first argument of where", remedy="write where(condition, a, b)")
            case _:
                raise InputError("this is not part of the language", remedy=_ARITHMETIC)

    def called(self, name: str, args: list[ast.expr], depth: int) -> sp.Expr:
        """A word of its arguments; InputError where it does not take so many."""
        word, given = WORDS[name], len(args)
        if not word.least <= given <= (word.most or given):
            count = f"{word.least}" if word.most == word.least else f"at least {word.least}"
            raise InputError(f"{name} takes {count} argument{'s' * (count != '1')}, not {given}", remedy=f"{name}: {word.meaning}")
        if given > MOST_ARGUMENTS:
            raise InputError(f"{name} has {given} arguments", remedy=f"at most {MOST_ARGUMENTS} are read")
        if name != "where":
            found = self.build.call(name, [self.value(a, depth) for a in args])
            return _bounded(found) if name == "sign" else found
        return self.choice(args[0], self.value(args[1], depth), self.value(args[2], depth), depth)

    def choice(self, condition: ast.expr, a: sp.Expr, b: sp.Expr, depth: int) -> sp.Expr:
        """``where(condition, a, b)``; p and q chooses by q where p holds, p or q by q where p does not."""
        if isinstance(condition, ast.Compare):
            left, right, kind = self.sides(condition, depth)
            return self.build.call("where", [kind(left, right, evaluate=self.build.evaluate), a, b])
        if isinstance(condition, ast.BoolOp):
            both = isinstance(condition.op, ast.And)
            found = a if both else b
            for part in reversed(condition.values):
                found = _bounded(self.choice(part, found, b, depth) if both else self.choice(part, a, found, depth))
            return found
        raise InputError(f"{self.quote(condition)} is no comparison", remedy=_CHOICE)

    def sides(self, node: ast.Compare, depth: int) -> tuple[sp.Expr, sp.Expr, type[Relational]]:
        if len(node.ops) != 1:
            remedy = "join them: 0 < x and x < 1; list them one by one in constraints"
            raise self.place.error(f"{self.quote(node)} chains comparisons", at=self.start(node), remedy=remedy)
        return self.value(node.left, depth), self.value(node.comparators[0], depth), _COMPARISONS[type(node.ops[0])]


def _has_too_many_tokens(text: str) -> bool:
    return len(text) > MOST_TOKENS and sum(token.lastgroup != "space" for token in _TOKEN.finditer(text)) > MOST_TOKENS


def _ends_operand(token: re.Match[str]) -> bool:
    return token.lastgroup in ("number", "name") or token[0] == ")"


def _bounded(expr: sp.Expr) -> sp.Expr:
    """The expression, of which parts are repeated: each node counts as often as it stands there."""
    if fold(expr, dict.fromkeys(NODES, lambda _, *sizes: 1 + sum(sizes)), lambda _: 1) > MOST_NODES:
        raise InputError("the choice is too large, written out for each comparison", remedy="join fewer comparisons")
    return expr


def _chain(node: ast.BinOp, family: tuple[type[ast.operator], ...]) -> tuple[ast.expr, list[tuple[type[ast.operator], ast.expr]]]:
    """``a + b - c`` as a and [(Add, b), (Sub, c)]: the left spine of one family of operators."""
    tail: list[tuple[type[ast.operator], ast.expr]] = []
    spine: ast.expr = node
    while isinstance(spine, ast.BinOp) and isinstance(spine.op, family):
        tail.append((type(spine.op), spine.right))
        spine = spine.left
    return spine, tail[::-1]


# -- formulas kept as graphs --------------------------------------------------------------------------------------------


def parse_graph(text: str, known: Mapping[str, sp.Symbol], short: Abbreviations, where: str) -> Shared:
    """The formula over the symbols ``known`` and the definitions of ``short``; InputError for anything outside the language."""
    check_formula(text, [*known, *short.own], where, short.alone())
    last = own_text(text, short)
    nodes = tuple((name, short.own[name]) for name in short.used_by(last))
    used = names_in(last).union(*(names_in(formula) for _, formula in nodes))
    names = tuple(name for name in known if name in used)
    return Shared(Graph(nodes, last, tuple(map(symbol, names)), _read), *(known[name] for name in names))


def own_text(text: str, short: Abbreviations) -> str:
    """The formula with its invariants written out, and the names of definitions left in."""
    return written_out(text, short.alone())


def _read(graph: Graph) -> sp.Expr:
    """The formula in a form for doubles, each definition one object wherever its name stands."""
    made: dict[str, sp.Expr] = {x.name: x for x in graph.names}
    for name, text in graph.nodes:
        made[name] = parse_as_written(text, made, IN_RANGE)
        hash(made[name])  # kept by SymPy, the inner ones first
    return parse_as_written(graph.last, made, IN_RANGE)
