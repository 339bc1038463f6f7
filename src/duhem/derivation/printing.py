"""A derivation, or one of its equations, as text, Markdown, LaTeX, sheet, chapters and plain values; printers only, no mathematics."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import groupby
from typing import TYPE_CHECKING, Any

import sympy as sp
from sympy.printing.str import StrPrinter

from duhem.derivation.equation import Derivation, Equation, Names, put
from duhem.derivation.support_function import compression
from duhem.derivation.typeset import Rows, Typesetter, by_name, positive_first
from duhem.expression.vocabulary import Where
from duhem.show.page import PAGE, Page
from duhem.show.printing import Sheet, Typeset, latex, latex_name, markdown, marked, plain, sheet, text

if TYPE_CHECKING:
    from duhem.show.document import Chapter

__all__ = [
    "as_dict", "as_latex", "as_markdown", "as_sheet", "as_text", "chapters", "displayed", "equation_as_dict", "equation_as_latex",
    "equation_as_sheet", "formulas", "in_one", "in_words",
]  # fmt: skip


def _shown(expr: sp.Basic, names: Names) -> Any:
    """The relation in |pressure|, which is how the theory is written."""
    return put(expr, compression(names.law)[0])


_INDENT = " " * 10  # of what stands under a numbered formula


class _Text(StrPrinter):
    """Typesetter in the words of a criterion file."""

    def _as_ordered_terms(self, expr: Any, order: Any = None) -> list[Any]:
        return positive_first(super()._as_ordered_terms(expr, order))

    def _word(self, expr: Any) -> str:
        return f"{type(expr).__name__.lower()}({', '.join(map(self._print, expr.args))})"

    _print_Abs = _print_Max = _print_Min = _print_Pos = _print_Neg = _print_Norm = _print_Atan2 = _print_EigMax = _word

    def _print_Function(self, expr: Any) -> str:
        return f"{expr.func.__name__}({', '.join(map(self._print, expr.args))})"

    def _print_Where(self, expr: Where) -> str:
        return self._word(expr) if expr.sign_of is None else f"sign({self._print(expr.sign_of)})"

    def _print_Belongs(self, expr: Any) -> str:
        return f"{self._print(expr.args[0])} in {self._print(expr.args[1])}"

    def _print_Equality(self, expr: Any) -> str:
        of_columns = isinstance(expr.rhs, sp.MatrixBase) and isinstance(expr.lhs, sp.MatrixBase)
        rows = zip(expr.lhs, expr.rhs, strict=True) if of_columns else [expr.args]
        return "\n".join(f"{self._print(left)} = {self._print(right)}" for left, right in rows)

    def _print_And(self, expr: Any) -> str:
        return ", ".join(self._print(a) for a in by_name(expr))

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
        return f"({', '.join(map(self._print, expr))})"

    _print_MatrixBase = _print_ImmutableDenseMatrix = _print_MutableDenseMatrix = _print_Tuple


def formulas(derivation: Derivation) -> Iterator[tuple[Equation, Rows]]:
    """Every equation with its formula in rows."""
    names, law = derivation.names, derivation.names.law
    written = names.latex | {sp.Symbol("D", real=True): r"\mathcal{D}", sp.Symbol("psi_C", real=True): r"\psi_C",
                             sp.Symbol("Delta_psi_C", real=True): r"\Delta\psi_C"}  # fmt: skip
    if law.pressure is not None:
        written |= {size: rf"\left|{names.latex[law.symbols()[law.pressure]]}\right|" for size in compression(law)[1]}
    defined = {}
    for equation in derivation:
        if equation.name == "criterion" or equation.name.startswith("definition_"):
            relation = _shown(equation.relation, names)
            defined[relation.args[1]] = (latex_name(relation.args[0].name), equation.number)
    typesetter = Typesetter(written, defined)
    for equation in derivation:
        yield equation, typesetter.rows(_shown(equation.relation, names), equation.number)


def in_words(equation: Equation, names: Names | None = None) -> str:
    """The relation in the words of a criterion file; with ``names`` in |pressure|, as in the derivation."""
    return str(_Text().doprint(equation.relation if names is None else _shown(equation.relation, names)))


def in_one(rows: Rows) -> str:
    """All rows as one formula."""
    every = [*rows.formula, *([r"\text{where}", *rows.named] if rows.named else [])]
    return every[0] if len(every) == 1 else rf"\begin{{aligned}}{_joined(every)}\end{{aligned}}"


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
    lines += ["Omitted", "-------", *(line for part in derivation.left_out for line in page.hanging(str(part)))]
    return "\n".join(lines) + "\n"


@markdown.register(Derivation)
def as_markdown(derivation: Derivation) -> str:
    """Markdown; formulas in LaTeX."""
    lines = [f"# Derivation of {marked(derivation.law)}", ""]
    for section, group in groupby(formulas(derivation), key=lambda pair: pair[0].section):
        lines += [f"## {section}", ""]
        for equation, rows in group:
            lines += [f"**({equation.number})** `{equation.name}`: {marked(equation.note)}", "", f"$$\n{in_one(rows)}\n$$", ""]
    lines += ["## Omitted", "", *(f"- {marked(str(part))}" for part in derivation.left_out)]
    return "\n".join(lines) + "\n"


def _joined(rows: Sequence[str]) -> str:
    return "&" + "\\\\\n&".join(rows)


_ESCAPES = {c: rf"\{c}" for c in "&%$#_{}"} | {c: rf"\ensuremath{{{c}}}" for c in "<>|"}
_ESCAPES |= {"~": r"\~{}", "^": r"\^{}", "\\": r"\textbackslash{}", "°": r"\ensuremath{^\circ}"}
_ESCAPES |= {c: rf"{_ESCAPES.get(c, c)}\allowbreak{{}}" for c in "*/+_)"}  # where a formula in a sentence is broken


def _prose(words: str) -> str:
    return "".join(_ESCAPES.get(c, c) for c in words)


@latex.register(Derivation)
def as_latex(derivation: Derivation) -> str:
    """A complete document for pdflatex; amsmath is its only package."""
    lines = [
        r"\documentclass[a4paper]{article}",
        r"\usepackage{amsmath}",
        r"\setlength{\textwidth}{17cm}\setlength{\oddsidemargin}{-5mm}\setlength{\textheight}{24cm}\setlength{\topmargin}{-15mm}",
        r"\setlength{\emergencystretch}{3em}\allowdisplaybreaks",
        r"\begin{document}",
        rf"\section*{{Derivation of {_prose(derivation.law)}}}",
    ]
    for section, group in groupby(formulas(derivation), key=lambda pair: pair[0].section):
        lines.append(rf"\subsection*{{{_prose(section)}}}")
        for equation, rows in group:
            lines += [rf"\noindent {_prose(equation.note)}:", displayed(rows.formula, equation.number)]
            if rows.named:
                lines += [r"\noindent where", displayed(rows.named)]
    lines += [r"\subsection*{Omitted}", r"\begin{itemize}"]
    lines += [rf"\item {_prose(part)}: {_prose(reason)}." for part, reason in derivation.left_out]
    return "\n".join([*lines, r"\end{itemize}", r"\end{document}", ""])


def displayed(rows: Sequence[str], number: str = "") -> str:
    """A formula of amsmath that stands by itself, with its number if there is one."""
    tag = rf"\tag{{{number}}}" if number else ""
    if len(rows) == 1:
        return rf"\begin{{equation*}}{rows[0]}{tag}\end{{equation*}}"
    return rf"\begin{{align*}}{_joined(rows)}{tag}\end{{align*}}"


@sheet.register(Derivation)
def as_sheet(derivation: Derivation) -> Sheet:
    """A field an equation: its number, name and sentence, and the formula."""
    fields = tuple((_title(e), Typeset(_line(in_words(e, derivation.names)), in_one(rows))) for e, rows in formulas(derivation))
    return Sheet(f"Derivation of {derivation.law}", fields, notes=(("Omitted", tuple(map(str, derivation.left_out))),))


@plain.register(Derivation)
def as_dict(derivation: Derivation) -> dict[str, Any]:
    """Every equation with its formula in the words of a criterion file and in LaTeX; what was left out."""
    return {
        "law": derivation.law,
        "equations": [_said(e, _line(in_words(e, derivation.names)), rows) for e, rows in formulas(derivation)],
        "left_out": [part.to_dict() for part in derivation.left_out],
    }


@sheet.register(Equation)
def equation_as_sheet(equation: Equation) -> Sheet:
    """Section and formula; symbols are written by their names, as the equation alone does not know better."""
    formula = Typeset(_line(in_words(equation)), in_one(_alone(equation)))
    return Sheet(_title(equation), (("section", equation.section), ("formula", formula)))


@plain.register(Equation)
def equation_as_dict(equation: Equation) -> dict[str, Any]:
    """As :func:`as_dict` has it."""
    return _said(equation, _line(in_words(equation)), _alone(equation))


@latex.register(Equation)
def equation_as_latex(equation: Equation) -> str:
    """A displayed formula with its number."""
    rows = _alone(equation)
    return displayed([*rows.formula, *rows.named], equation.number)


def _alone(equation: Equation) -> Rows:
    names = {known: latex_name(known.name) for known in equation.relation.atoms(sp.Symbol)}
    return Typesetter(names).rows(equation.relation, equation.number)


def _line(formula: str) -> str:
    """Rows of a vector or of branches one after the other."""
    return "; ".join(row.strip() for row in formula.splitlines())


def _title(equation: Equation) -> str:
    return f"({equation.number}) {equation.name}: {equation.note}"


def _said(equation: Equation, formula: str, rows: Rows) -> dict[str, Any]:
    own = {key: getattr(equation, key) for key in ("number", "name", "section", "note")}
    return own | {"formula": formula, "latex": in_one(rows)}


def chapters(derivation: Derivation) -> tuple[Chapter, ...]:
    """The chapters of a page: one a section, in order, each relation with its number and its sentence."""
    from duhem.show.document import Chapter, Display

    return tuple(
        Chapter(section, tuple(Display(e.number, e.note, in_words(e, derivation.names), (*r.formula,), (*r.named,)) for e, r in group))
        for section, group in groupby(formulas(derivation), key=lambda pair: pair[0].section)
    )
