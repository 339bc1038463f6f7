"""Formulas in lines that fit a page, and how wide TeX sets them, estimated from their LaTeX without TeX.

Where a formula is too wide, columns are written component by component and branches one by one, sums are broken at + and -, conditions at
commas; what no sign breaks, a quotient or a root, has its widest part named, and the name is defined below.  A name stands for the
same expression in the whole document.

The widths are those of Computer Modern (Knuth 1986, The TeXbook, chapters 17 and 18, appendix G), a little generous: letters by their
class, the spaces of binary operators and relations, scripts cut wider for their size, fractions as wide as their wider part.
Unit: em.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby
from typing import Any

import sympy as sp
from sympy.core.function import AppliedUndef
from sympy.core.relational import Relational
from sympy.printing.latex import LatexPrinter

from duhem.expression import symbol
from duhem.expression.vocabulary import Norm

__all__ = ["Rows", "Typesetter", "by_name", "positive_first", "width"]

_TOKEN = re.compile(r"\\begin\{(\w+\*?)\}|\\end\{(\w+\*?)\}|\\operatorname\*?|\\[a-zA-Z]+|\\.|[{}^_&]|\[|\]|.", re.DOTALL)
_SCALE = (1.0, 0.81, 0.7)  # of text, scripts and scripts of scripts: 7 and 5 pt are cut wider than 10 pt
_SPACES = {r"\,": 0.167, r"\:": 0.223, r"\;": 0.278, r"\ ": 0.34, r"\quad": 1.0, r"\qquad": 2.0, r"\!": -0.167}
_RELATION_SIGNS = {"=", "<", ">", r"\leq", r"\geq", r"\neq", r"\in", ":", r"\Rightarrow"}
_BINARY = {"+", "-", r"\cdot", r"\wedge", r"\vee", r"\times"}
_WIDE = {
    "m": 0.9, "w": 0.74, "M": 1.1, "W": 1.1, r"\infty": 1.0, r"\Delta": 0.84, r"\Rightarrow": 1.0, r"\cdot": 0.28, r"\psi": 0.7,
    r"\Phi": 0.75, r"\varphi": 0.7, r"\omega": 0.7, r"\Psi": 0.8, r"\Omega": 0.75, r"\pi": 0.62, r"\mu": 0.62, r"\phi": 0.62, ".": 0.28,
    ",": 0.45, ";": 0.45, ":": 0.28, "!": 0.3, "'": 0.3, "|": 0.28, r"\|": 0.5, "(": 0.4, ")": 0.4, "[": 0.3, "]": 0.3,
}  # fmt: skip
_UPRIGHT = dict.fromkeys("ABCDEFGHIJKLNOPQRSTUVXYZ", 0.76) | dict.fromkeys("mwMW", 0.84) | dict.fromkeys("iljtf,.'", 0.4)
_WORDS = {"max", "min", "sin", "cos", "tan", "sinh", "cosh", "tanh", "log", "exp", "ln", "arcsin", "arccos", "arctan"}
_OF_OTHERS = {r"\displaystyle", r"\dot", r"\limits", r"\mathcal", r"\mathsf", r"\hphantom", r"\bigl", r"\bigr"}  # no width of their own
_FENCES = {".": (0.12, 0.12), "|": (0.34, 0.34), r"\|": (0.56, 0.56)}  # short and tall; others are brackets
_TALL = (r"\frac", r"\begin", r"\sqrt")


def width(formula: str) -> float:
    """The width in em of one line of ``formula``, set as a display."""
    return _Tokens([found.group() for found in _TOKEN.finditer(formula)]).line(0, None)


class _Tokens:
    """One pass over the tokens; ``level`` 0 is a display, 1 the text style of its fractions, 2 and 3 scripts."""

    def __init__(self, tokens: list[str]) -> None:
        self._tokens = tokens
        self._at = 0

    def _next(self) -> str:
        self._at += 1
        return self._tokens[self._at - 1]

    def _ahead(self) -> str | None:
        return self._tokens[self._at] if self._at < len(self._tokens) else None

    def line(self, level: int, end: str | None) -> float:
        """Everything up to ``end`` or the end, which is read too."""
        total, before = 0.0, "("
        while (ahead := self._ahead()) is not None:
            if ahead == end:
                self._next()
                break
            total += self._item(level, before)
            if not ahead.isspace():
                before = self._tokens[self._at - 1]
        return total

    def _size(self, level: int) -> float:
        return _SCALE[max(0, level - 1)]

    def _group(self, level: int) -> float:
        """An argument: what stands in braces, or one token."""
        while self._ahead() == " ":
            self._next()
        if self._ahead() == "{":
            self._next()
            return self.line(level, "}")
        return self._item(level, "(") if self._ahead() is not None else 0.0

    def _words(self) -> float:
        """The letters of a text in upright type."""
        self._next()
        depth, total = 1, 0.0
        while depth and (token := self._ahead()) is not None:
            self._next()
            depth += {"{": 1, "}": -1}.get(token, 0)
            total += 0.0 if token in "{}" else 0.34 if token.isspace() else _UPRIGHT.get(token, 0.6)
        return total

    def _item(self, level: int, before: str) -> float:
        token, size = self._next(), self._size(level)
        if token.isspace() or token in _OF_OTHERS or token in ("}", r"\\", "&"):
            return 0.0
        if token == "{":
            return self.line(level, "}")
        if token in _SPACES:
            return _SPACES[token] * size
        if token in "^_":
            return self._scripts(token, level)
        if token == r"\frac":
            return max(self._group(min(level + 1, 3)), self._group(min(level + 1, 3))) + 0.24
        if token == r"\sqrt":
            return self._root(level)
        if token == r"\left":
            return self._fenced(level)
        if token.startswith(r"\begin"):
            return self._environment(token[len(r"\begin{") : -1], level)
        if token in (r"\text", r"\mathrm", r"\operatorname"):
            return self._words() * size + (0.167 if token == r"\operatorname" else 0.0)
        if token[1:] in _WORDS:
            return (0.167 + 0.56 * (len(token) - 1)) * size
        return self._sign(token, before, level) * size

    def _sign(self, token: str, before: str, level: int) -> float:
        if token in _RELATION_SIGNS:
            return 0.78 + (0.556 if level < 2 else 0.0)
        if token in _BINARY:
            binary = before not in _RELATION_SIGNS | _BINARY | {"(", "&", ",", r"\\"}
            return _WIDE.get(token, 0.78) + (0.445 if binary and level < 2 else 0.0)
        if token in _WIDE:
            return _WIDE[token]
        return 0.5 if token.isdigit() else 0.8 if token.isupper() and len(token) == 1 else 0.6

    def _scripts(self, first: str, level: int) -> float:
        """Index and exponent stand above each other."""
        below = min(max(level, 1) + 1, 3)
        wide = self._group(below)
        if self._ahead() in ({"^", "_"} - {first}):
            self._next()
            wide = max(wide, self._group(below))
        return wide + 0.06

    def _root(self, level: int) -> float:
        index = 0.0
        if self._ahead() == "[":
            self._next()
            index = 0.5 * self.line(3, "]")
        return self._group(level) + index + self._size(level)

    def _fenced(self, level: int) -> float:
        """Brackets that grow with what stands between them."""
        first, start = self._next(), self._at
        inside = self.line(level, r"\right")
        tall = any(token.startswith(_TALL) for token in self._tokens[start : self._at])
        return inside + sum(_FENCES.get(end, (0.6, 0.88))[tall] for end in (first, self._next())) * max(self._size(level), 0.7)

    def _environment(self, name: str, level: int) -> float:
        """Rows of cells: every column as wide as its widest cell."""
        rows: list[list[float]] = [[0.0]]
        before = "("
        while (token := self._ahead()) is not None:
            if token == rf"\end{{{name}}}":
                self._next()
                break
            if token == r"\\":
                self._next()
                if self._ahead() == "[":  # space between rows
                    while self._next() != "]":
                        pass
                rows.append([0.0])
            elif token == "&":
                self._next()
                rows[-1].append(0.0)
            else:
                rows[-1][-1] += self._item(max(level, 1), before)
            before = before if token.isspace() else self._tokens[self._at - 1]
        columns = max(map(len, rows))
        cells = sum(max(row[i] for row in rows if i < len(row)) for i in range(columns))
        return cells + columns - 1 + (1.9 if name == "cases" else 0.0)


WIDE = 43.0  # em: the text of 17 cm at 10 pt, less the equation's number
TALL = 20  # rows of a column or of branches that stand in one bracket
_SHORT = 3.0  # em: what is no wider is not named
_LONG = 10**20  # what has no more digits is not named
_INDENT = r"\qquad "
_FUNCTIONS = {"Phi_C_star": r"\Phi_C^{*}", "Phi_C": r"\Phi_C", "N_K": "N_K", "I_K": "I_K", "gamma_K": r"\gamma_K", "J": "J"}
_RELATIONS = {"==": "=", "<=": r"\leq", ">=": r"\geq", "<": "<", ">": ">", "!=": r"\neq"}


def by_name(conjunction: Any) -> list[Any]:
    """Conditions on symbols by the symbols' names; any others in SymPy's order."""
    parts = list(conjunction.args)
    return sorted(parts, key=lambda p: p.lhs.name) if all(isinstance(p, Relational) and p.lhs.is_Symbol for p in parts) else parts


def positive_first(terms: Iterable[Any]) -> list[Any]:
    """The terms of a sum with the positive ones first."""
    return sorted(terms, key=lambda term: bool(term.could_extract_minus_sign()))


class _NamingPrinter(LatexPrinter):
    """LaTeX in which ``named`` expressions are their names, atoms that need no bracket; ``met`` are those that were."""

    def __init__(self, settings: dict[str, Any]) -> None:
        super().__init__(settings)
        self.named: dict[sp.Basic, str] = {}
        self.met: dict[sp.Basic, None] = {}
        self._written: dict[Any, tuple[str, dict[sp.Basic, None]]] = {}  # with the names as they are
        self._names: dict[sp.Basic, str] = {}

    def write(self, expr: Any) -> str:
        """The expression with the names as they are; what is met of them is ``met``."""
        if self.named != self._names:
            self._names, self._written = dict(self.named), {}
        self.met = {}
        return str(self.doprint(expr))

    def _print(self, expr: Any, **kwargs: Any) -> str:
        if isinstance(expr, sp.Basic) and expr in self.named:
            self.met[expr] = None
            return self.named[expr] + (f"^{{{kwargs['exp']}}}" if kwargs.get("exp") else "")
        if not isinstance(expr, sp.Basic) or not expr.args:
            return str(super()._print(expr, **kwargs))
        key = (expr, kwargs.get("exp"))
        if key not in self._written:
            outside, self.met = self.met, {}
            self._written[key] = str(super()._print(expr, **kwargs)), self.met
            self.met = outside
        written, met = self._written[key]
        self.met |= met
        return written

    def parenthesize(self, item: Any, level: int, is_neg: bool = False, strict: bool = False) -> str:
        return self._print(item) if item in self.named else str(super().parenthesize(item, level, is_neg, strict))

    def _needs_brackets(self, expr: Any) -> bool:
        return expr not in self.named and bool(super()._needs_brackets(expr))

    def _needs_mul_brackets(self, expr: Any, first: bool = False, last: bool = False) -> bool:
        return expr not in self.named and bool(super()._needs_mul_brackets(expr, first, last))

    def _needs_add_brackets(self, expr: Any) -> bool:
        return expr not in self.named and bool(super()._needs_add_brackets(expr))

    def _as_ordered_terms(self, expr: Any, order: Any = None) -> list[Any]:
        return positive_first(super()._as_ordered_terms(expr, order))

    def _hprint_Function(self, func: str) -> str:
        named = self._settings["symbol_names"].get(symbol(func))  # a quantity, and what it is a function of
        return _FUNCTIONS.get(func) or named or str(super()._hprint_Function(func))

    def _print_Belongs(self, expr: Any) -> str:
        return rf"{self._print(expr.args[0])} \in {self._print(expr.args[1])}"

    def _print_And(self, expr: Any) -> str:
        return r",\; ".join(self._print(a) for a in by_name(expr))

    def _print_Piecewise(self, expr: Any) -> str:
        conditions = [r"\text{otherwise}" if c == True else rf"\text{{for}}\: {self._print(c)}" for _, c in expr.args]  # noqa: E712
        rows = [f"{self._print(value)} & {condition}" for (value, _), condition in zip(expr.args, conditions, strict=True)]
        end = r" \\[2pt] " if any(r"\frac" in row for row in rows) else r" \\ "
        return rf"\begin{{cases}} {end.join(rows)} \end{{cases}}"

    def _print_ConditionSet(self, expr: Any) -> str:
        return rf"\left\{{ {self._print(expr.sym)} : {self._print(expr.condition)} \right\}}"


@dataclass(frozen=True)
class Rows:
    """The rows of one formula, and below them those that say what is named in it."""

    formula: list[str]
    named: list[str]


class Typesetter:
    """The formulas of one document, in order; ``symbols`` says how its symbols are written.

    ``defined`` are expressions that have a name already, with the number of the equation that gives it.
    """

    def __init__(self, symbols: Mapping[sp.Symbol, str], defined: Mapping[sp.Basic, tuple[str, str]] | None = None) -> None:
        self._printer = _NamingPrinter({"symbol_names": symbols, "mat_delim": "(", "mat_str": "matrix", "mul_symbol": r"\,"})
        self._names = dict(defined or {})
        self._count = 0  # of the names given so far
        self._number = ""  # of the equation in hand
        self._used: dict[sp.Basic, None] = {}  # the names met in its rows, in order

    def rows(self, relation: Any, number: str) -> Rows:
        """The formula in one row if it fits, else in several."""
        self._printer.named = {}
        written = self._trial(relation)
        cramped = isinstance(relation.args[-1], sp.MatrixBase) and any(tall in written for tall in (r"\frac", r"\begin{cases}"))
        if not cramped and _height(relation) <= TALL and width(written) <= WIDE:
            return Rows([written], [])
        self._number, self._used = number, {}
        formula, done = list(self._broken(relation)), 0
        named: list[str] = []
        while done < len(self._used):
            part = list(self._used)[done]
            done += 1
            if self._names[part][1] == number:
                named += self._definition(part)
        elsewhere = sorted(((at, name) for name, at in map(self._names.__getitem__, self._used) if at != number), key=lambda pair: pair[0])
        cited = [
            rf"{', '.join(name for _, name in group)} \text{{ as in ({at})}}" for at, group in groupby(elsewhere, lambda pair: pair[0])
        ]
        self._names = {part: named for part, named in self._names.items() if part in self._used or not _OPEN.fullmatch(named[0])}
        return self._numbered(Rows(formula, [*_packed([(name, ",") for name in cited]), *named]))

    def _numbered(self, rows: Rows) -> Rows:
        """Names counted in the order in which they are met."""
        order: dict[str, str] = {}

        def counted(found: re.Match[str]) -> str:
            if found.group() not in order:
                self._count += 1
                order[found.group()] = rf"\mathsf{{A}}_{{{self._count}}}"
            return order[found.group()]

        made = Rows(*([_OPEN.sub(counted, row) for row in part] for part in (rows.formula, rows.named)))
        self._names = {part: (order.get(name, name), at) for part, (name, at) in self._names.items()}
        return made

    def _broken(self, relation: Any) -> Iterator[str]:
        if isinstance(relation, sp.And):
            yield from self._listed(by_name(relation))
        elif isinstance(relation, sp.Eq) and isinstance(relation.lhs, sp.MatrixBase) and isinstance(relation.rhs, sp.MatrixBase):
            for left, right in zip(relation.lhs, relation.rhs, strict=True):
                yield from self._broken(sp.Eq(left, right, evaluate=False))
        elif isinstance(relation, Relational):
            yield from self._chain(relation.lhs, _RELATIONS[relation.rel_op], relation.rhs)
        else:
            yield self._fitting(relation, WIDE)

    def _listed(self, parts: Sequence[Any]) -> Iterator[str]:
        """Relations with commas between them."""
        waiting: list[_Item] = []
        for part in parts:
            written = self._written(part)
            if width(written) <= WIDE - 1:
                waiting.append((written, ",\\;"))
                continue
            yield from _packed(waiting)
            waiting = []
            yield from self._broken(part)
        yield from _packed(waiting)

    def _chain(self, left: Any, sign: str, right: Any) -> Iterator[str]:
        """``left sign right`` broken before terms; branches one after the other."""
        whole = f"{self._trial(left)} {sign} {self._trial(right)}"
        if _height(right) <= TALL and width(whole) <= WIDE:
            self._written(left), self._written(right)
            yield whole
        elif isinstance(right, sp.Piecewise):
            for value, condition in right.args:
                yield from _packed([*self._related(left, sign, value), *self._condition(condition)])
        else:
            yield from _packed(self._related(left, sign, right))

    def _definition(self, part: sp.Basic) -> Iterator[str]:
        name = self._names[part][0]
        self._printer.named.pop(part, None)
        whole = rf"{name} = {self._trial(part)}"
        if _height(part) <= TALL and width(whole) <= WIDE:
            self._written(part)
            yield whole
        elif isinstance(part, sp.Integer):
            yield from _packed([(name, ""), *_led("=", [(digits, "") for digits in re.findall(".{1,12}", str(part))])])
        elif isinstance(part, sp.Piecewise):
            for value, condition in part.args:
                yield from _packed([(name, ""), *_led("=", self._terms(value)), *self._condition(condition)])
        else:
            yield from _packed([(name, ""), *_led("=", self._terms(part))])
        self._printer.named[part] = name

    def _related(self, left: Any, sign: str, right: Any) -> list[_Item]:
        return [*self._terms(left), *_led(sign, self._terms(right))]

    def _condition(self, condition: Any) -> list[_Item]:
        if condition == True:  # noqa: E712 - a SymPy boolean, not Python's
            return [(r"\quad\text{otherwise}", "")]
        parts = by_name(condition) if isinstance(condition, sp.And) else [condition]
        items = [(self._fitting(part, WIDE - 6), ",\\;") for part in parts]
        whole = " ".join(item + (end if item != items[-1][0] else "") for item, end in items)
        return _led(r"\quad\text{for}\;", [(whole, "")] if width(whole) <= WIDE - 6 else items)

    def _terms(self, expr: Any) -> list[_Item]:
        """A sum term by term, each with its sign and no wider than a row; anything else whole."""
        if not isinstance(expr, sp.Add):
            return self._listing(expr) or [(self._fitting(expr, WIDE - 4), "")]
        items: list[_Item] = []
        for i, term in enumerate(self._printer._as_ordered_terms(expr)):
            minus = term.could_extract_minus_sign()
            size = -term if minus else term
            items += _led("-" if minus else "+" if i else "", self._listing(size) or [(self._fitting(size, WIDE - 6), "")])
        return items

    def _listing(self, expr: Any) -> list[_Item]:
        """A maximum, minimum or norm that is too wide, argument by argument; nothing of what is none or fits."""
        if not isinstance(expr, sp.Max | sp.Min | Norm) or (_height(expr) <= TALL and width(self._trial(expr)) <= WIDE - 6):
            return []
        args = expr.args if isinstance(expr, Norm) else sorted(expr.args, key=sp.default_sort_key)
        first, last = (r"\bigl\|", r"\bigr\|_2") if isinstance(expr, Norm) else (rf"\{expr.func.__name__.lower()}\bigl(", r"\bigr)")
        *items, (end, _) = [(self._fitting(arg, WIDE - 8), ",") for arg in args]
        return _led(first, [*items, (end + last, "")])

    def _trial(self, expr: Any) -> str:
        return self._printer.write(expr)

    def _written(self, expr: Any) -> str:
        """The expression as it stands in a row: the names in it are used."""
        written = self._trial(expr)
        self._used |= self._printer.met
        return written

    def _fitting(self, expr: Any, room: float) -> str:
        """The expression in ``room``: names known from before are taken first, then its widest part is named, and so on."""
        tall, before = _height(expr) > TALL, self._trial(expr)
        if tall or width(before) > room:
            for part, (name, at) in self._names.items():
                if at != self._number and part != expr and expr.has(part):
                    self._printer.named[part] = name
        unnamed: set[sp.Basic] = set()
        while tall or width(before := self._trial(expr)) > room:
            sizes = {part: width(self._trial(part)) for part in _parts(expr, unnamed) if part not in self._printer.named}
            widest = max(sizes, key=sizes.__getitem__, default=None)
            if widest is None or sizes[widest] <= _SHORT:
                break
            if not any(self._named(part, expr, before) for part in (widest, -widest)):  # a sum may be written with the other sign
                unnamed.add(widest)
            tall = tall and _height(expr, self._printer.named) > TALL
        return self._written(expr)

    def _named(self, part: sp.Basic, expr: Any, before: str) -> bool:
        """Gives the part a name if that changes how the expression is written."""
        name = rf"\mathsf{{A}}_{{?{len(self._names)}}}"
        self._names[part], self._printer.named[part] = (name, self._number), name
        if self._trial(expr) != before:
            return True
        del self._names[part], self._printer.named[part]
        return False


_Item = tuple[str, str]  # what stands together, and what follows it if more does
_OPEN = re.compile(r"\\mathsf\{A\}_\{\?\d+\}")  # a name that is not counted yet


def _led(sign: str, items: Sequence[_Item]) -> list[_Item]:
    """The items with a sign before the first."""
    (first, end), *rest = items
    return [(f"{sign} {first}".lstrip(), end), *rest]


def _packed(items: Sequence[_Item]) -> list[str]:
    """As many items in a row as fit; rows after the first are indented."""
    rows: list[str] = []
    for i, (item, end) in enumerate(items):
        said = item + (end if i + 1 < len(items) else "")
        longer = f"{rows[-1]} {said}" if rows else said
        if rows and width(longer) <= WIDE:
            rows[-1] = longer
        else:
            rows.append(_INDENT + said if rows else said)
    return rows


def _height(expr: Any, named: Collection[sp.Basic] = ()) -> int:
    """Rows that columns and branches take one below the other; what is named takes one."""
    if named and expr in named:
        return 1
    if isinstance(expr, sp.MatrixBase):
        return sum(_height(entry, named) for entry in expr)
    if isinstance(expr, sp.Piecewise):
        return sum(_height(value, named) for value, _ in expr.args)
    return max((_height(part, named) for part in expr.args), default=1)


def _parts(expr: Any, opened: Collection[sp.Basic], inside: type | None = None) -> Iterator[sp.Basic]:
    """What can be named in an expression and is not within something that can; what is ``opened`` cannot."""
    if isinstance(expr, sp.Rational):
        yield from (whole for whole in map(sp.Integer, (abs(expr.p), expr.q)) if whole > _LONG and whole not in opened)
    sums = isinstance(expr, sp.Add | sp.Piecewise) or (isinstance(expr, sp.Function) and not isinstance(expr, AppliedUndef))
    whole = sums or (isinstance(expr, sp.Mul) and inside is not None and not issubclass(inside, sp.Add | sp.Mul))
    if whole and inside is not None and expr not in opened:
        yield expr
        return
    for part in expr.args:
        yield from _parts(part, opened, type(expr))
