"""A derivation as text, Markdown or LaTeX; printers only, no mathematics."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import groupby
from typing import Any

import sympy as sp
from sympy.core.relational import Relational
from sympy.functions.elementary.piecewise import ExprCondPair
from sympy.printing.latex import LatexPrinter
from sympy.printing.str import StrPrinter

from duhem.derivation.equation import Derivation, Equation
from duhem.derivation.notation import Names
from duhem.derivation.support_function import compression
from duhem.expression.vocabulary import Where
from duhem.show.page import PAGE, Page
from duhem.show.printing import latex, markdown, text

__all__ = ["as_latex", "as_markdown", "as_text"]


def _shown(expr: sp.Basic, names: Names) -> sp.Basic:
    """The relation in |pressure|, which is how the theory is written."""
    return _swapped(expr, compression(names.law)[0])


def _swapped(expr: Any, swap: Mapping[Any, sp.Expr]) -> Any:
    """Symbols replaced, with every relation kept as written: SymPy would turn some into true."""
    if isinstance(expr, Relational | sp.And | sp.Piecewise):
        return type(expr)(*(_swapped(a, swap) for a in expr.args), evaluate=False)
    if isinstance(expr, ExprCondPair):
        return ExprCondPair(*(_swapped(a, swap) for a in expr.args))
    if isinstance(expr, sp.MatrixBase):
        return expr.applyfunc(lambda entry: _swapped(entry, swap))
    if expr.args and expr.has(sp.Piecewise):
        return expr.func(*(_swapped(a, swap) for a in expr.args))
    return expr.xreplace(swap)


def _by_name(conjunction: Any) -> list[Any]:
    """Conditions on symbols by the symbols' names; any others in SymPy's order."""
    parts = list(conjunction.args)
    return sorted(parts, key=lambda p: p.lhs.name) if all(isinstance(p, Relational) and p.lhs.is_Symbol for p in parts) else parts


_INDENT = " " * 10  # of what stands under a numbered formula


class _PositiveFirst:
    """Sums with their positive terms first."""

    def _as_ordered_terms(self, expr: Any, order: Any = None) -> list[Any]:
        terms = super()._as_ordered_terms(expr, order)  # type: ignore[misc]
        return sorted(terms, key=lambda term: bool(term.could_extract_minus_sign()))


class _Text(_PositiveFirst, StrPrinter):
    """Formulas in the words of a criterion file."""

    def _print_Function(self, expr: Any) -> str:
        name = {"Pos": "pos", "Neg": "neg", "Norm": "norm", "Atan2": "atan2", "EigMax": "eigmax"}.get(
            expr.func.__name__, expr.func.__name__
        )
        return f"{name}({', '.join(self._print(a) for a in expr.args)})"

    def _print_Where(self, expr: Where) -> str:
        if expr.sign_of is not None:
            return f"sign({self._print(expr.sign_of)})"
        return f"where({', '.join(self._print(a) for a in expr.args)})"

    def _print_Abs(self, expr: Any) -> str:
        return f"abs({self._print(expr.args[0])})"

    def _print_Max(self, expr: Any) -> str:
        return f"{expr.func.__name__.lower()}({', '.join(self._print(a) for a in expr.args)})"

    _print_Min = _print_Max

    def _print_Belongs(self, expr: Any) -> str:
        return f"{self._print(expr.args[0])} in {self._print(expr.args[1])}"

    def _print_Equality(self, expr: Any) -> str:
        left, right = (self._print(a) for a in expr.args)
        if isinstance(expr.rhs, sp.MatrixBase) and isinstance(expr.lhs, sp.MatrixBase):
            return "\n".join(f"{self._print(a)} = {self._print(b)}" for a, b in zip(expr.lhs, expr.rhs, strict=True))
        return f"{left} = {right}"

    def _print_And(self, expr: Any) -> str:
        return ", ".join(self._print(a) for a in _by_name(expr))

    def _print_Implies(self, expr: Any) -> str:
        return f"({self._print(expr.args[0])}) implies {self._print(expr.args[1])}"

    def _print_Piecewise(self, expr: Any) -> str:
        rows = [f"{self._print(e)}{'  otherwise' if c == True else f'  if {self._print(c)}'}" for e, c in expr.args]  # noqa: E712
        return "{ " + "\n  ".join(rows) + " }"

    def _print_ConditionSet(self, expr: Any) -> str:
        return f"{{ {self._print(expr.sym)} : {self._print(expr.condition)} }}"

    def _print_Interval(self, expr: Any) -> str:
        return f"[{self._print(expr.start)}, {self._print(expr.end)}]"

    def _print_Tuple(self, expr: Any) -> str:
        return f"({', '.join(self._print(a) for a in expr.args)})"

    def _print_MatrixBase(self, expr: Any) -> str:
        return f"({', '.join(self._print(a) for a in expr)})"

    _print_ImmutableDenseMatrix = _print_MatrixBase
    _print_MutableDenseMatrix = _print_MatrixBase


_FUNCTIONS = {"Phi_C_star": r"\Phi_C^{*}", "Phi_C": r"\Phi_C", "N_K": "N_K", "I_K": "I_K", "gamma_K": r"\gamma_K", "J": "J"}


class _Latex(_PositiveFirst, LatexPrinter):
    def _hprint_Function(self, func: str) -> str:
        return _FUNCTIONS.get(func) or str(super()._hprint_Function(func))

    def _print_Belongs(self, expr: Any) -> str:
        return rf"{self._print(expr.args[0])} \in {self._print(expr.args[1])}"

    def _print_And(self, expr: Any) -> str:
        return r",\; ".join(self._print(a) for a in _by_name(expr))

    def _print_ConditionSet(self, expr: Any) -> str:
        return rf"\left\{{ {self._print(expr.sym)} : {self._print(expr.condition)} \right\}}"


def _printer(names: Names) -> _Latex:
    law = names.law
    written = names.latex | {sp.Symbol("D", real=True): r"\mathcal{D}", sp.Symbol("psi_C", real=True): r"\psi_C",
                             sp.Symbol("Delta_psi_C", real=True): r"\Delta\psi_C"}  # fmt: skip
    if law.pressure is not None:
        written |= {size: rf"\left|{names.latex[law.symbols()[law.pressure]]}\right|" for size in compression(law)[1]}
    return _Latex({"symbol_names": written, "mat_delim": "(", "mat_str": "matrix"})


def _formula(equation: Equation, names: Names) -> str:
    return str(_printer(names).doprint(_shown(equation.relation, names)))


@text.register(Derivation)
def as_text(derivation: Derivation, page: Page = PAGE) -> str:
    """Plain text, one block per section; formulas stay in one line, however long."""
    lines = [f"Derivation of {derivation.law}", ""]
    printer = _Text()
    for section, group in groupby(derivation.equations, key=lambda e: e.section):
        lines += [section, "-" * len(section)]
        for equation in group:
            body = printer.doprint(_shown(equation.relation, derivation.names)).replace("\n", f"\n{_INDENT}")
            lines += [f"{f'({equation.number})':9} {body}", *page.hanging(f"[{equation.name}] {equation.note}", _INDENT, f"{_INDENT}  ")]
        lines.append("")
    lines += ["Left out", "--------", *(line for part in derivation.left_out for line in page.hanging(str(part)))]
    return "\n".join(lines) + "\n"


@markdown.register(Derivation)
def as_markdown(derivation: Derivation) -> str:
    """Markdown; formulas in LaTeX."""
    lines = [f"# Derivation of {derivation.law}", ""]
    for section, group in groupby(derivation.equations, key=lambda e: e.section):
        lines += [f"## {section}", ""]
        for equation in group:
            formula = _formula(equation, derivation.names)
            lines += [f"**({equation.number})** `{equation.name}`: {equation.note}", "", f"$$\n{formula}\n$$", ""]
    lines += ["## Left out", "", *(f"- {part}" for part in derivation.left_out)]
    return "\n".join(lines) + "\n"


_ESCAPES = {c: rf"\{c}" for c in "&%$#_{}"} | {c: rf"\ensuremath{{{c}}}" for c in "<>|"}
_ESCAPES |= {"~": r"\~{}", "^": r"\^{}", "\\": r"\textbackslash{}", "°": r"\ensuremath{^\circ}"}


def _prose(words: str) -> str:
    return "".join(_ESCAPES.get(c, c) for c in words)


@latex.register(Derivation)
def as_latex(derivation: Derivation) -> str:
    """A complete document for pdflatex; amsmath is its only package."""
    lines = [
        r"\documentclass[a4paper]{article}",
        r"\usepackage{amsmath}",
        r"\setlength{\textwidth}{17cm}\setlength{\oddsidemargin}{-5mm}\allowdisplaybreaks",
        r"\begin{document}",
        rf"\section*{{Derivation of {_prose(derivation.law)}}}",
    ]
    for section, group in groupby(derivation.equations, key=lambda e: e.section):
        lines.append(rf"\subsection*{{{_prose(section)}}}")
        for equation in group:
            formula = _formula(equation, derivation.names)
            lines += [rf"\noindent {_prose(equation.note)}:", rf"\begin{{equation*}}{formula}\tag{{{equation.number}}}\end{{equation*}}"]
    lines += [r"\subsection*{Left out}", r"\begin{itemize}"]
    lines += [rf"\item {_prose(part)}: {_prose(reason)}." for part, reason in derivation.left_out]
    return "\n".join([*lines, r"\end{itemize}", r"\end{document}", ""])
