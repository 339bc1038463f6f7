"""Texts of formulas drawn in the grammar, read, printed and read again, by both parsers.

    python -m tests.campaigns.texts --count 20000 --seed 1

Of each text it is asked
- whether the parser of criterion files and that of the kernel both read it or both refuse it (half of the texts have something in
  them that should be refused); what the product refuses because a part has no value whatever its names are, the kernel may read if its
  rules do not show that it has a value, nor that each value of a choice in it has one, read without the condition.  The product
  also refuses 0 to a variable power that SymPy does not know to be > 0: the kernel, whose 0**0 is 1, reads it and knows more signs;
- where they do, whether the formula's text (``expression.text.formula``) is read back as the same formula, its gradient too;
- whether a law of that text has the same text again in what the kernel is given (``law_as_text``), and, made of the expression, one
  that is read as the same law;
- whether both have the same values in 60 digits at drawn points, or no value both; where the kernel's tree alone has none it is
  the stricter one, which is counted.
"""

from __future__ import annotations

import argparse
import operator
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from functools import reduce
from random import Random
from typing import Any

import sympy as sp

from duhem import Criterion, InputError
from duhem.expression import mpmath_, symbol
from duhem.expression.branches import gradient
from duhem.expression.parse import parse_as_written, parse_expression, parse_relation
from duhem.expression.text import formula as text_of
from duhem.proof.certificate import law_as_text
from duhem.proof.kernel.bounds import Bounds
from duhem.proof.kernel.obligations import formula, numbers
from duhem.proof.kernel.stated_law import StatedLaw
from duhem.proof.kernel.term import COMPARISONS, NotWritten, Term, parse
from tests.oracles.drawn_texts import NAMES, Drawn

ZERO, NEGATIVE, POSITIVE = 2, 1, 4
PLAIN = {x: symbol(x) for x in NAMES}
SIGNED = PLAIN | {"n": symbol("n", nonpositive=True), "m": symbol("m", positive=True)}
SIGNS = {"n": NEGATIVE | ZERO, "m": POSITIVE}
DIGITS, CLOSE = 60, 40
POINTS = 2


@dataclass
class Texts:
    """How many texts were read and refused by both, how many points had values; what was found wrong, by kind."""

    counts: Counter[str] = field(default_factory=Counter)
    wrong: dict[str, list[str]] = field(default_factory=dict)
    stricter: list[str] = field(default_factory=list)

    def note(self, kind: str, text: str) -> None:
        self.wrong.setdefault(kind, []).append(text)


def texts(count: int, seed: int) -> Texts:
    """``count`` drawn texts, asked all of it."""
    found = Texts()
    for i in range(count):
        rng = Random(f"texts {seed} {i}")
        drawn = Drawn(rng, odd=0.05 if i % 2 else 0.0)
        signed = i % 4 > 1
        text = drawn.comparison(1 + i % 3) if rng.random() < 0.05 else drawn.text(1 + i % 5)
        ask(text, SIGNED if signed else PLAIN, SIGNS if signed else {}, found, rng)
    return found


def ask(text: str, known: Mapping[str, sp.Symbol], signs: Mapping[str, int], found: Texts, rng: Random) -> None:
    """One text."""
    term, expr = by_kernel(text), by_product(text, known)
    if term is None and expr is not None:
        found.note("read by the product alone", text)
    elif term is not None and expr is None and has_value(term, signs):
        found.note("read by the kernel alone", text)
    elif term is not None and expr is None:
        found.counts["refused by the kernel's rules alone"] += 1
    if term is None or expr is None:
        found.counts["refused"] += 1
        return
    found.counts["read"] += 1
    if isinstance(expr, sp.core.relational.Relational):
        return
    if by_product(text_of(expr), known) != expr:
        found.note("not read back", text)
    forces = [known["a"], known["b"]]
    if rng.random() < 0.2 and expr.has(*forces):
        about_a_law(text, expr, known, found)
        try:
            slopes = gradient(expr, forces)
        except (InputError, RecursionError):
            slopes = ()
        for slope in slopes:
            found.counts["slopes"] += 1
            if by_product(text_of(slope), known) not in (slope, sp.sympify(slope), None):
                found.note("slope not read back", text)
    for _ in range(POINTS):
        compare(text, expr, term, known, found, rng)


def by_product(text: str, known: Mapping[str, sp.Symbol]) -> Any:
    """The formula, or comparison, that criterion files read; None for none."""
    try:
        return parse_expression(text, known)
    except InputError as fault:
        if "comparison may only" not in fault.what:
            return None
    try:
        return parse_relation(text, known)
    except InputError as fault:
        return sp.Ge(0, 1, evaluate=False) if "contradictory" in fault.what else None


def by_kernel(text: str) -> Term | None:
    """The kernel's tree over the names that are known; None for none, and where it has a number without a value."""
    try:
        term = parse(text)
    except NotWritten:
        return None
    return term if term.names() <= {*NAMES, "pi"} and not numbers(text) else None


def has_value(term: Term, signs: Mapping[str, int]) -> bool:
    """Whether the kernel shows that the formula, or both sides of the comparison, have a value, for names of these signs (others: all).

    So it is asked of each value of a choice, the condition aside: one that is never read is refused by the product all the same.
    Of 0 to a variable power it is not said.
    """
    if any(
        part.op == "**" and part.args[1].names() - {"pi"} and not part.args[0].names() - {"pi"} and is_zero(part.args[0])
        for part in term.parts()
    ):
        return False
    domains = {NEGATIVE | ZERO: Bounds(None, Fraction(0)), POSITIVE: Bounds(Fraction(0), None, True)}
    parameters = {x: domains.get(signs.get(x, 0), Bounds(None, None)) for x in NAMES if x not in ("a", "b")}
    values = [x for part in term.parts() if part.op == "where" for x in part.args[1:]]
    return not any(formula(StatedLaw(("a", "b"), None, x, None, parameters, ())) for x in (term, *values))


def is_zero(number: Term) -> bool:
    return value(number, {}, mpmath_.digits(DIGITS)) == 0


def about_a_law(text: str, expr: sp.Expr, known: Mapping[str, sp.Symbol], found: Texts) -> None:
    """A law of the text has that text; one made of the expression has a text that makes the same law."""
    free = {x: known[x] for x in NAMES if x not in ("a", "b")}
    if any(x.is_positive or x.is_nonpositive for x in free.values()):
        return
    from duhem import Domain

    domains = {x: Domain() for x in free}
    try:
        one = Criterion("one", text, domains, ("a", "b"), None)
    except InputError:
        return
    found.counts["laws"] += 1
    if law_as_text(one)["g"] != text:
        found.note("a law has another text than was given", text)
    try:
        two = Criterion("one", one.g, domains, ("a", "b"), None)
        three = Criterion("one", law_as_text(two)["g"], domains, ("a", "b"), None)
    except InputError as fault:
        found.note(f"a law made of an expression is refused: {fault.what[:60]}", text)
        return
    if not one == two == three:
        found.note("a law made of an expression is another", text)


def compare(text: str, expr: sp.Expr, term: Term, known: Mapping[str, sp.Symbol], found: Texts, rng: Random) -> None:
    """Both at one point."""
    at = {x: rng.choice((sp.Rational(rng.randint(-30, 30), 8), sp.Integer(rng.randint(-2, 2)))) for x in NAMES}
    if known is SIGNED:
        at |= {"n": -abs(at["n"]), "m": abs(at["m"]) + sp.Rational(1, 4)}
    before = last = None
    try:
        for digits in (DIGITS, 8 * DIGITS):
            one = mpmath_.evaluate(expr, {known[x]: v for x, v in at.items()}, digits)
            written = mpmath_.evaluate(parse_as_written(text, known), {known[x]: v for x, v in at.items()}, digits)
            context = mpmath_.digits(digits)
            two = value(term, {x: context.mpf(int(v.p)) / int(v.q) for x, v in at.items()}, context)
            finite = all(context.isfinite(v) for v in (one, written))
            if two is None or not finite or all(abs(v - two) <= context.mpf(10) ** -CLOSE * (1 + abs(two)) for v in (one, written)):
                break
            before, last = written, before
    except (OverflowError, MemoryError, InputError, ValueError):
        found.counts["points too large"] += 1
        return
    if two is None:
        found.counts["points without a value"] += 1
        if finite:
            found.stricter.append(f"{text!r} at {', '.join(f'{x} = {v}' for x, v in at.items())}")
    elif not context.isfinite(written):
        found.note("a value of the kernel's alone", text)
    elif not finite:
        found.counts["points where the simplified formula has no value"] += 1
    elif before is not None and last is not None and abs(before - last) > context.mpf(10) ** -CLOSE:
        found.counts["points at which digits do not settle the value"] += 1  # a small power of sin(pi)
    elif any(abs(v - two) > context.mpf(10) ** -CLOSE * (1 + abs(two)) for v in (one, written)):
        found.note("another value", text)
    else:
        found.counts["points"] += 1


def value(term: Term, at: Mapping[str, Any], mp: Any) -> Any:
    """The kernel's tree at a point; None where a part that is read has no real value."""
    if term.op == "number":
        return mp.mpf(term.value.numerator) / term.value.denominator
    if term.op == "name":
        return +mp.pi if term.name == "pi" else at[term.name]
    if term.op == "where":
        holds = value(term.args[0], at, mp)
        return None if holds is None else value(term.args[1 if holds else 2], at, mp)
    x = [value(a, at, mp) for a in term.args]
    if any(v is None for v in x):
        return None
    if term.op in COMPARISONS:
        return {"<": operator.lt, "<=": operator.le, ">": operator.gt, ">=": operator.ge}[term.op](*x)
    try:
        found = _WORDS[term.op](mp, *x) if term.op in _WORDS else getattr(mp, term.op)(x[0])
    except (ZeroDivisionError, ValueError):
        return None
    return found if mp.isfinite(found) and mp.im(found) == 0 else None


def _power(mp: Any, base: Any, exponent: Any) -> Any:
    if base == 0 and exponent < 0:
        raise ZeroDivisionError
    if base < 0 and exponent != mp.floor(exponent):
        raise ValueError
    return mp.mpf(1) if exponent == 0 else base**exponent


def _angle(mp: Any, y: Any, x: Any) -> Any:
    if x == y == 0:
        raise ValueError
    return mp.atan2(y, x)


def _greatest(mp: Any, *entries: Any) -> Any:
    xx, yy, zz, yz, xz, xy = entries
    return max(mp.eigsy(mp.matrix([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]), eigvals_only=True))


_WORDS: Mapping[str, Any] = {
    "+": lambda mp, *x: mp.fsum(x), "*": lambda _, *x: reduce(operator.mul, x), "**": _power, "atan2": _angle, "eigmax": _greatest,
    "norm": lambda mp, *x: mp.sqrt(mp.fsum(v * v for v in x)), "max": lambda _, *x: max(x), "min": lambda _, *x: min(x),
    "abs": lambda _, x: abs(x), "pos": lambda mp, x: max(x, mp.mpf(0)), "neg": lambda mp, x: max(-x, mp.mpf(0)),
    "log": lambda mp, x: mp.log(x) if x > 0 else mp.nan, "asin": lambda mp, x: mp.asin(x) if abs(x) <= 1 else mp.nan,
    "acos": lambda mp, x: mp.acos(x) if abs(x) <= 1 else mp.nan,
}  # fmt: skip


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description="texts of formulas, read by both parsers and read back")
    parser.add_argument("--count", type=int, default=20_000)
    parser.add_argument("--seed", type=int, default=1)
    given = parser.parse_args()
    done = texts(given.count, given.seed)
    print(", ".join(f"{what}: {number}" for what, number in sorted(done.counts.items())))
    print(f"the kernel alone finds no value: {len(done.stricter)}", *done.stricter[:20], sep="\n  ")
    print(f"wrong: {sum(map(len, done.wrong.values()))}")
    for kind, cases in done.wrong.items():
        print(f"{kind}: {len(cases)}", *map(repr, cases[:20]), sep="\n  ")
