r"""How wide TeX sets a formula, estimated from its LaTeX without TeX.

The widths are those of Computer Modern (Knuth 1986, The TeXbook, chapters 17 and 18, appendix G), a little generous: letters by their
class, the spaces of binary operators and relations, scripts cut wider for their size, fractions as wide as their wider part.
Unit: em.
"""

from __future__ import annotations

import re

__all__ = ["width"]

_TOKEN = re.compile(r"\\begin\{(\w+\*?)\}|\\end\{(\w+\*?)\}|\\operatorname\*?|\\[a-zA-Z]+|\\.|[{}^_&]|\[|\]|.", re.DOTALL)
_SCALE = (1.0, 0.81, 0.7)  # of text, scripts and scripts of scripts: 7 and 5 pt are cut wider than 10 pt
_SPACES = {r"\,": 0.167, r"\:": 0.223, r"\;": 0.278, r"\ ": 0.34, r"\quad": 1.0, r"\qquad": 2.0, r"\!": -0.167}
_RELATIONS = {"=", "<", ">", r"\leq", r"\geq", r"\neq", r"\in", ":", r"\Rightarrow"}
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
        if token in _RELATIONS:
            return 0.78 + (0.556 if level < 2 else 0.0)
        if token in _BINARY:
            binary = before not in _RELATIONS | _BINARY | {"(", "&", ",", r"\\"}
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
