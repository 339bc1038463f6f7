"""Terms of the kernel as text of the language, with the names that a law has for parts of its formulas."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from contextlib import suppress
from fractions import Fraction

from duhem.errors import InputError
from duhem.expression.abbreviations import INVARIANTS
from duhem.law.curve_law import Law
from duhem.law.formula_law import Criterion, Definitions
from duhem.proof.kernel.stated_law import without_angles
from duhem.proof.kernel.term import COMPARISONS, UNREADABLE, Term, number, parse

__all__ = ["in_text", "names_of"]

Names = Mapping[Term, str | Term]  # of a part with the values of parameters put in, the part as it is written
_SUM, _PRODUCT, _POWER, _ATOM = range(1, 5)  # how closely a text binds
_HALF, _ONE, _ZERO = (number(Fraction(n, 2)) for n in (1, 2, 0))


def names_of(law: Law) -> Names:
    """What the law calls parts of its formulas: its definitions, and the invariants of its stress."""
    short = law.define.short.formulas if isinstance(law, Criterion) and isinstance(law.define, Definitions) else {}
    texts = {re.sub("__([0-9]+)", r"[\1]", name): text for name, text in short.items()}  # an entry of a list
    if isinstance(law, Criterion) and law.stress is not None:
        for word, own in INVARIANTS.items():
            for i in range(1, 3 if law.stress.kind == "plane" else 4) if own.indexed else (None,):
                with suppress(InputError):  # one that is always 0
                    texts[f"{word}({law.stress.name}{'' if i is None else f', {i}'})"] = law.stress.written_out(word, i)
    found = dict[Term, str | Term]()
    values = {Term("name", name=name): number(Fraction(str(x.value))) for name, x in law.parameters.items() if x.value is not None}
    for name, text in texts.items():
        with suppress(*UNREADABLE):
            found |= dict.fromkeys((part := parse(text), part.put(values)), found.get(part, name))
    with suppress(*UNREADABLE):
        for part in (parts := [*parse(law.written).parts()] if isinstance(law, Criterion) else []):
            if (read := without_angles(part).put(values)) not in parts:
                found.setdefault(read, part)
    return {term: name for term, name in found.items() if term.args}


def in_text(term: Term, names: Names, binds: int = 0) -> str:
    """A part of a formula as a law has it; in brackets where it binds less closely than that."""
    text, own = _text(term, names)
    return f"({text})" if own < binds else text


def _text(term: Term, names: Names) -> tuple[str, int]:
    """The text, and how closely it binds."""
    if known := names.get(term, term.name):
        return _text(known, names) if isinstance(known, Term) else (known, _ATOM)
    if term.op == "number":
        return str(term.value), _SUM if term.value < 0 else _ATOM if term.value.denominator == 1 else _PRODUCT
    if [term.op, *(x.op for a in term.args[:1] for x in (a, *a.args))] == ["log", "+", "number", "exp"] and term.args[0].args[0] == _ONE:
        return f"softplus({in_text(term.args[0].args[1].args[0], names)})", _ATOM
    if term.op == "+":
        first, *rest = [a for a in term.args if a != _ZERO] or [_ZERO]
        if not rest:
            return _text(first, names)
        texts = (in_text(a, names) for a in rest)
        return in_text(first, names) + "".join(f" - {t[1:]}" if t.startswith("-") else f" + {t}" for t in texts), _SUM
    if term.op == "*":
        return _product(term, names)
    if term.op == "**":
        base, exponent = term.args
        if exponent == _HALF:
            return f"sqrt({in_text(base, names)})", _ATOM
        if exponent.op == "number" and exponent.value < 0:
            return _product(Term("*", (term,)), names)
        return f"{in_text(base, names, _ATOM)}**{in_text(exponent, names, _ATOM)}", _POWER
    if term.op == ",":
        return f"({', '.join(in_text(a, names) for a in term.args)})", _ATOM
    if term.op in COMPARISONS:
        return f" {term.op} ".join(in_text(a, names) for a in term.args), 0
    return f"{term.op}({', '.join(in_text(a, names) for a in term.args)})", _ATOM


def _product(term: Term, names: Names) -> tuple[str, int]:
    value, above, below = Fraction(1), list[str](), list[str]()
    for factor in _factors(term, names):
        if factor.op == "number":
            value *= factor.value
        elif factor.op == "**" and all(a.op == "number" for a in factor.args) and factor.args[1].value == -1 and factor.args[0].value:
            value /= factor.args[0].value
        elif factor.op == "**" and factor.args[1].op == "number" and factor.args[1].value < 0 and factor not in names:
            base, e = factor.args[0], -factor.args[1].value
            below.append(in_text(base if e == 1 else Term("**", (base, number(e))), names, _POWER))
        else:
            above.append(in_text(factor, names, _POWER))
    above = [str(abs(value.numerator)), *above] if abs(value.numerator) != 1 or not above else above
    below = [str(value.denominator), *below] if value.denominator != 1 else below
    text = "*".join(above) + "".join(f"/{part}" for part in below)
    if value < 0:
        return f"-{text}", _SUM
    return text, _PRODUCT if len(above) + len(below) > 1 else _ATOM if text.isidentifier() or text.isdigit() else _POWER


def _factors(term: Term, names: Names) -> Iterator[Term]:
    for a in term.args:
        yield from _factors(a, names) if a.op == "*" and a not in names else (a,)
