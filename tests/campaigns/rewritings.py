"""The same law written otherwise: whether its verdicts depend on the spelling of its formula.

    python -m tests.campaigns.rewritings 10 --seed 1                    ten rewritings a law, the kernel alone
    python -m tests.campaigns.rewritings 3 --laws hill48 coulomb        of these laws
    python -m tests.campaigns.rewritings 3 --whole                      with searches for counterexamples too

A rewriting is a chain of one to three changes of the text; the values of both texts agree at random points, or it is thrown away.
A verdict that is weaker than the original's is printed as *lost*, one that says the opposite as a CONTRADICTION.
"""

from __future__ import annotations

import argparse
import ast
import math
import random
import sys
import time
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
import sympy as sp

from duhem import Criterion, Domain, InputError, load, verify
from duhem.law import catalogue
from duhem.law.atlas.entry import ASKED, groups
from duhem.law.domain import POSITIVE
from duhem.proof.certificate import law_as_text
from duhem.proof.verification import Confirmations

__all__ = ["REWRITINGS", "Rewritten", "rewritten", "verdicts"]

_DECIDED = ("proved", "refuted")
_STEPS, _POINTS, _TRIES = 10_000_000, 12, 40
_LONGEST = 4_000  # letters
_POLYNOMIAL = 400  # terms


# -- values ------------------------------------------------------------------------------------------------------------


def _eigmax(*entries: float) -> float:
    xx, yy, zz, yz, xz, xy = entries
    return float(np.linalg.eigvalsh([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])[-1])


_WORDS: dict[str, Any] = {
    **{word: getattr(math, word) for word in ("sqrt", "exp", "log", "log10", "sin", "cos", "tan", "asin", "acos", "atan", "atan2", "pi")},
    **{word: getattr(math, word) for word in ("sinh", "cosh", "tanh")},
    "abs": abs, "max": max, "min": min, "eigmax": _eigmax,
    "norm": lambda *x: math.sqrt(math.fsum(y * y for y in x)),
    "pos": lambda x: max(x, 0.0), "neg": lambda x: max(-x, 0.0), "sign": lambda x: (x > 0) - (x < 0),
    "where": lambda holds, one, two: one if holds else two,
}  # fmt: skip


def _value(text: str, point: Mapping[str, float]) -> float | None:
    """None where the formula has no value, or one that rounding may have spoilt, or is kept as a graph, with names for its parts."""
    try:
        found = eval(compile(text.replace("\n", " "), "formula", "eval"), {"__builtins__": {}}, {**_WORDS, **point})
    except (NameError, TypeError, ValueError, ZeroDivisionError, OverflowError, IndexError):  # TypeError: a complex value compared
        return None
    return float(found) if isinstance(found, int | float) and math.isfinite(found) else None


def _drawn(domain: Domain, rng: random.Random) -> float:
    low = 0.0 if domain.positive else None if domain.low is None else float(domain.low)
    high = None if domain.high is None else float(domain.high)
    if domain.value is not None:
        return float(domain.value)
    if low is not None and high is not None:
        return low + (high - low) * rng.uniform(0.02, 0.98)
    size = rng.choice((0.1, 0.5, 1.0, 3.0)) * rng.uniform(0.5, 1.5)
    return low + size if low is not None else high - size if high is not None else rng.choice((-1, 1)) * size


# -- rewritings --------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Text:
    """The formulas of a law, one a surface, its parameters, and those that stand for formulas in others."""

    formulas: tuple[str, ...]
    parameters: Mapping[str, Domain]
    stands_for: Mapping[str, str] = field(default_factory=dict)
    forces: tuple[str, ...] = ()
    constraints: tuple[str, ...] = ()

    def each(self, change: Callable[[str], str]) -> Text:
        """The same with every formula changed."""
        return replace(self, formulas=tuple(map(change, self.formulas)))


Rewriting = Callable[[Text, random.Random], Text]
REWRITINGS: dict[str, Rewriting] = {}


def _named(name: str) -> Callable[[Rewriting], Rewriting]:
    def put(change: Rewriting) -> Rewriting:
        REWRITINGS[name] = change
        return change

    return put


class _Calls(ast.NodeTransformer):
    """Changes calls of some words, and whatever else a subclass says, with a share of all places."""

    def __init__(self, change: Callable[[ast.AST], str | None], rng: random.Random) -> None:
        self.change, self.rng, self.share = change, rng, rng.choice((0.5, 1.0))

    def visit(self, node: ast.AST) -> Any:
        node = self.generic_visit(node)
        if isinstance(node, ast.Call | ast.BinOp) and self.rng.random() < self.share and (found := self.change(node)) is not None:
            return ast.parse(f"({found})", mode="eval").body
        return node


def _by_node(change: Callable[[ast.AST], str | None]) -> Rewriting:
    def put(text: Text, rng: random.Random) -> Text:
        return text.each(lambda g: ast.unparse(_Calls(change, rng).visit(ast.parse(_one_line(g), mode="eval"))))

    return put


def _one_line(text: str) -> str:
    return " ".join(text.split())


def _call(node: ast.AST, word: str, args: int | None = None) -> list[str] | None:
    if not (isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == word):
        return None
    if args is not None and len(node.args) != args:
        return None
    return [f"({ast.unparse(a)})" for a in node.args]


def _word(word: str, change: Callable[..., str], args: int | None = None) -> Rewriting:
    return _by_node(lambda node: None if (given := _call(node, word, args)) is None else change(*given))


REWRITINGS |= {
    "norm as root": _word("norm", lambda *x: "sqrt(" + " + ".join(f"{a}**2" for a in x) + ")"),
    "abs as max": _word("abs", lambda x: f"max({x}, -{x})"),
    "abs as root": _word("abs", lambda x: f"sqrt({x}**2)"),
    "abs as ramps": _word("abs", lambda x: f"pos({x}) + neg({x})"),
    "abs as where": _word("abs", lambda x: f"where({x} >= 0, {x}, -{x})"),
    "pos as max": _word("pos", lambda x: f"max({x}, 0)"),
    "pos as half": _word("pos", lambda x: f"({x} + abs({x}))/2"),
    "neg as max": _word("neg", lambda x: f"max(-{x}, 0)"),
    "neg as pos": _word("neg", lambda x: f"pos(-{x})"),
    "pos as where": _word("pos", lambda x: f"where({x} > 0, {x}, 0)"),
    "max as where": _word("max", lambda x, y: f"where({x} >= {y}, {x}, {y})", 2),
    "max as half": _word("max", lambda x, y: f"({x} + {y} + abs({x} - {y}))/2", 2),
    "max as pos": _word("max", lambda x, y: f"{y} + pos({x} - {y})", 2),
    "min as max": _word("min", lambda *x: "-max(" + ", ".join(f"-{a}" for a in x) + ")"),
    "root as power": _word("sqrt", lambda x: f"{x}**0.5"),
}  # fmt: skip


def _squared(node: ast.AST) -> str | None:
    """What the square is of."""
    if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Pow) and ast.unparse(node.right) == "2":
        return ast.unparse(node.left)
    return None


REWRITINGS |= {
    "square as product": _by_node(lambda node: None if (x := _squared(node)) is None else f"({x})*({x})"),
    "square of size": _by_node(lambda node: None if (x := _squared(node)) is None else f"abs({x})**2"),
}


@_named("root as norm")
def _root_as_norm(text: Text, rng: random.Random) -> Text:
    def change(node: ast.AST) -> str | None:
        if _call(node, "sqrt", 1) is None:
            return None
        assert isinstance(node, ast.Call)
        parts = []
        for sign, part in _terms(node.args[0], 1):
            if sign < 0 or (inner := _squared(part)) is None:
                return None
            parts.append(inner)
        return f"norm({', '.join(parts)})"

    return _by_node(change)(text, rng)


def _terms(node: ast.AST, sign: int) -> Iterator[tuple[int, ast.AST]]:
    if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Add | ast.Sub):
        yield from _terms(node.left, sign)
        yield from _terms(node.right, sign if isinstance(node.op, ast.Add) else -sign)
    elif isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub):
        yield from _terms(node.operand, -sign)
    else:
        yield sign, node


def _factors(node: ast.AST, above: bool) -> Iterator[tuple[bool, ast.AST]]:
    if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Mult | ast.Div):
        yield from _factors(node.left, above)
        yield from _factors(node.right, above if isinstance(node.op, ast.Mult) else not above)
    else:
        yield above, node


@_named("order")
def _order(text: Text, rng: random.Random) -> Text:
    def shuffled(node: ast.AST) -> str:
        if (isinstance(node, ast.BinOp) and isinstance(node.op, ast.Add | ast.Sub)) or isinstance(node, ast.UnaryOp):
            parts = [(sign, shuffled(part)) for sign, part in _terms(node, 1)]
            rng.shuffle(parts)
            return "(" + " ".join(f"{'-' if sign < 0 else '+'} {part}" for sign, part in parts) + ")"
        if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Mult | ast.Div):
            parts = [(above, shuffled(part)) for above, part in _factors(node, True)]
            rng.shuffle(parts)
            return "(" + "*".join(part if above else f"(1/{part})" for above, part in parts) + ")"
        if isinstance(node, ast.BinOp):
            return f"({shuffled(node.left)}**{shuffled(node.right)})"
        if isinstance(node, ast.Compare):
            sign = {ast.Lt: "<", ast.LtE: "<=", ast.Gt: ">", ast.GtE: ">="}[type(node.ops[0])]
            return f"{shuffled(node.left)} {sign} {shuffled(node.comparators[0])}"
        if isinstance(node, ast.BoolOp):
            return "(" + (" and " if isinstance(node.op, ast.And) else " or ").join(map(shuffled, node.values)) + ")"
        if isinstance(node, ast.Call):
            args = list(map(shuffled, node.args))
            if ast.unparse(node.func) in ("max", "min", "norm"):
                rng.shuffle(args)
            return f"{ast.unparse(node.func)}({', '.join(args)})"
        return ast.unparse(node)

    return text.each(lambda g: shuffled(ast.parse(_one_line(g), mode="eval").body))


def _algebra(change: Callable[[sp.Expr, Sequence[sp.Symbol], random.Random], sp.Expr]) -> Rewriting:
    """A change of the polynomials and quotients between the words of a formula, the inner ones first."""

    def put(text: Text, rng: random.Random) -> Text:
        def walk(node: ast.AST, words: dict[str, str]) -> str:
            """The text of a part in which calls, powers that are not whole and comparisons have names."""
            if isinstance(node, ast.BinOp):
                if isinstance(node.op, ast.Pow) and not ast.unparse(node.right).isdigit():
                    return name(f"(({rewrite(node.left)})**({rewrite(node.right)}))", words)
                sign = {ast.Add: "+", ast.Sub: "-", ast.Mult: "*", ast.Div: "/", ast.Pow: "**"}[type(node.op)]
                return f"({walk(node.left, words)}){sign}({walk(node.right, words)})"
            if isinstance(node, ast.UnaryOp):
                return f"{'-' if isinstance(node.op, ast.USub) else '+'}({walk(node.operand, words)})"
            if isinstance(node, ast.Call):
                args = [ast.unparse(a) if isinstance(a, ast.Compare | ast.BoolOp) else rewrite(a) for a in node.args]
                return name(f"{ast.unparse(node.func)}({', '.join(args)})", words)
            return ast.unparse(node)

        def name(part: str, words: dict[str, str]) -> str:
            return words.setdefault(part, f"word_{len(words)}_")

        def rewrite(node: ast.AST) -> str:
            words: dict[str, str] = {}
            written = walk(node, words)
            names = sorted({n.id for n in ast.walk(ast.parse(written, mode="eval")) if isinstance(n, ast.Name)})
            symbols = {n: sp.Symbol(n) for n in names}
            expr = sp.sympify(written, locals=symbols, rational=True)
            if len(expr.free_symbols) <= 14:
                found = change(expr, [symbols[f] for f in names if f in text.forces or f.startswith("word_")], rng)
                expr = found if len(sp.Add.make_args(found)) <= _POLYNOMIAL else expr
            said = str(expr)
            for part, own in reversed(words.items()):
                said = said.replace(own, f"({part})")
            return said

        return text.each(lambda g: rewrite(ast.parse(_one_line(g), mode="eval").body))

    return put


REWRITINGS |= {
    "expand": _algebra(lambda e, _, __: sp.expand(e)),
    "factor": _algebra(lambda e, _, __: sp.factor_terms(e) if e.has(sp.Pow) and len(e.free_symbols) > 6 else sp.factor(e)),
    "collect": _algebra(lambda e, forces, _: sp.collect(sp.expand(e), forces)),
    "together": _algebra(lambda e, _, __: sp.together(e)),
    "by a parameter": _algebra(lambda e, _, rng: sp.collect(sp.expand(e), rng.choice(sorted(e.free_symbols, key=str) or [sp.Integer(1)]))),
}


@_named("scale")
def _scale(text: Text, rng: random.Random) -> Text:
    positive = [n for n, d in text.parameters.items() if d.positive]
    factor = rng.choice(["2", "1/3", "sqrt(2)", *positive, *(f"1/{n}" for n in positive)])
    return text.each(lambda g: f"({g})*({factor})")


def _in_place(name: str, formula: str, text: Text, more: Mapping[str, Domain]) -> Text:
    class Put(ast.NodeTransformer):
        def visit_Name(self, node: ast.Name) -> ast.AST:
            return ast.parse(f"({formula})", mode="eval").body if node.id == name else node

    def put(g: str) -> str:
        return ast.unparse(Put().visit(ast.parse(_one_line(g), mode="eval")))

    parameters = {n: d for n, d in text.parameters.items() if n != name} | dict(more)
    return replace(
        text.each(put), parameters=parameters, stands_for={**text.stands_for, name: formula}, constraints=tuple(map(put, text.constraints))
    )


@_named("slope as tan")
def _slope(text: Text, rng: random.Random) -> Text:
    free = [n for n, d in text.parameters.items() if d.value is None and (d.positive or (d.low is not None and d.low >= 0))]
    if not free:
        return text
    name = rng.choice(free)
    own = text.parameters[name]
    high = "1.5" if own.high is None else f"{math.floor(1000 * math.atan(float(own.high))) / 1000}"
    low = {"positive": True} if own.positive else {"min": f"{math.ceil(1000 * math.atan(float(own.low or 0))) / 1000}"}
    return _in_place(name, f"tan(angle_of_{name})", text, {f"angle_of_{name}": _domain(low, high)})


def _domain(low: Mapping[str, Any], high: str) -> Domain:
    return Domain(low=None if "positive" in low else sp.Rational(low["min"]), high=sp.Rational(high), positive="positive" in low)


def _above_zero(formula: str, names: Mapping[str, Domain]) -> Rewriting:
    """A formula that takes every value > 0, in the place of a parameter that does; "{}" is the name of that."""

    def put(text: Text, rng: random.Random) -> Text:
        if not (free := [n for n, d in text.parameters.items() if d.positive and d.high is None]):
            return text
        name = rng.choice(free)
        return _in_place(name, formula.format(name), text, {own.format(name): domain for own, domain in names.items()})

    return put


REWRITINGS |= {
    "quotient": _above_zero("above_{0}/below_{0}", {"above_{0}": POSITIVE, "below_{0}": POSITIVE}),
    "product": _above_zero("{0}*exp(share_of_{0})", {"{0}": POSITIVE, "share_of_{0}": Domain()}),
}


# -- laws --------------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Rewritten:
    """A law, the names of the changes, and the law that they make of it."""

    law: Criterion
    changes: tuple[str, ...]
    other: Criterion


def _parts(law: Criterion) -> list[tuple[str, ...]]:
    """Of each surface g, and its potential or the components of its flow."""
    stated = law_as_text(law)
    flows = [(s["g"], s["flow"]) for s in stated["surfaces"]] if law.surfaces else [(stated["g"], stated["flow"])]
    return [(g, *(() if flow is None else flow.values() if isinstance(flow, dict) else flow)) for g, flow in flows]


def _text_of(law: Criterion) -> Text:
    formulas = (ast.unparse(ast.parse(_one_line(part), mode="eval")) for parts in _parts(law) for part in parts)
    return Text(tuple(formulas), dict(law.parameters), {}, law.forces, tuple(law_as_text(law)["constraints"]))


def _law_of(law: Criterion, text: Text) -> Criterion:
    more: dict[str, Any] = {
        "parameters": text.parameters,
        "constraints": text.constraints,
        "written_constraints": (),
        "closed_form": None,
        "define": {},
    }
    left = iter(text.formulas)

    def put(stated: Any, count: int) -> dict[str, Any]:
        g, *flow = (next(left) for _ in range(count))
        own = {"flow": None, "potential": flow[0]} if stated.potential is not None else {"flow": flow or None, "potential": None}
        return {"g": g, "written": "", "written_flow": (), **own}

    if law.surfaces:
        surfaces = tuple(replace(s, **put(s, len(parts))) for s, parts in zip(law.surfaces, _parts(law), strict=True))
        return replace(law, surfaces=surfaces, g=sp.nan, written="", **more)
    return replace(law, **put(law, len(_parts(law)[0])), **more)


def _agree(one: Text, two: Text, law: Criterion, scaled: bool, rng: random.Random) -> bool:
    """Whether both have one value, or where they are ``scaled`` one sign, at points at which both have one."""
    seen = 0
    for _ in range(_TRIES):
        point = {n: _drawn(d, rng) for n, d in two.parameters.items()}
        point |= {f: rng.choice((-1, 1)) * rng.choice((0.2, 1.0, 4.0)) * rng.uniform(0.3, 1.0) for f in law.forces}
        if law.pressure is not None:
            point[law.pressure] = -rng.uniform(0.2, 3.0)
        inner = dict(point)
        for name, formula in reversed([*two.stands_for.items()]):
            value = _value(formula, inner)
            if value is None:
                return False
            inner[name] = value
        for a, b in zip(one.formulas, two.formulas, strict=True):
            x, y = _value(a, inner), _value(b, point)
            if x is None or y is None:
                continue
            seen += 1
            if abs(x) > 1e-6 and (x > 0) != (y > 0):
                return False
            if not scaled and abs(x - y) > 1e-7 * max(1.0, abs(x)):
                return False
    return seen >= _POINTS


def rewritten(law: Criterion, count: int, rng: random.Random) -> Iterator[Rewritten]:
    """So many other spellings of the law, or fewer where few changes do anything to it."""
    text, seen = _text_of(law), set[tuple[str, ...]]()
    for _ in range(6 * count):
        if len(seen) == count:
            return
        changes, now = list[str](), text
        for _ in range(rng.choice((1, 1, 2, 3))):
            name = rng.choice(sorted(REWRITINGS))
            try:
                new = REWRITINGS[name](now, rng)
            except (sp.PolynomialError, RecursionError):
                continue
            new = new.each(lambda g: ast.unparse(ast.parse(g, mode="eval")))
            if new.formulas != now.formulas and max(map(len, new.formulas)) < _LONGEST:
                now = new
                changes.append(name)
        if not changes or now.formulas in seen or not _agree(text, now, law, "scale" in changes, rng):
            continue
        try:
            other = _law_of(law, now)
        except InputError:
            continue  # the reader refuses it, with a reason
        seen.add(now.formulas)
        yield Rewritten(law, tuple(changes), other)


def verdicts(law: Criterion, whole: bool, steps: int = _STEPS) -> dict[str, str]:
    """The verdict on each claim: of everything, or ``proved`` and ``open`` by the kernel alone."""
    if whole:
        return {r.claim: r.verdict.value for r in verify(law, claims=ASKED).results}
    kernel, found = Confirmations(law), dict[str, str]()
    for claim in ASKED:
        offer = kernel.proof(claim, steps)
        if offer is not None:
            kernel.of(claim, offer)
        found[claim] = "open" if offer is None else "proved"
    return found


def _laws(names: Sequence[str]) -> Iterator[tuple[str, Criterion]]:
    for name in names or (*catalogue.names(), *(name for group in groups().values() for name in group)):
        law = load(name)
        plain = isinstance(law, Criterion) and not (law.viscous or law.forces_of_rates or law.energy or law.heat)
        if plain:
            yield Path(name).stem, law


def main(arguments: Sequence[str] | None = None) -> int:
    """Print what differs and a table of changes; 1 where a verdict contradicts another."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("count", type=int, nargs="?", default=10)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--laws", nargs="*", default=[])
    parser.add_argument("--whole", action="store_true")
    parser.add_argument("--sample", type=int, default=0, help="so many laws, drawn")
    parser.add_argument("--steps", type=int, default=_STEPS)
    asked = parser.parse_args(arguments)
    laws, rng = list(_laws(asked.laws)), random.Random(asked.seed)
    laws = rng.sample(laws, min(asked.sample, len(laws))) if asked.sample else laws
    tried, lost, against, better = Counter[str](), Counter[str](), 0, 0
    for name, law in laws:
        start = time.process_time()
        own, expected = verdicts(law, asked.whole, asked.steps), dict(law.expect)
        for found in rewritten(law, asked.count, rng):
            there = verdicts(found.other, asked.whole, asked.steps)
            for claim, verdict in own.items():
                told = (
                    f"{name} {claim} after {', '.join(found.changes)}: {there[claim]}\n  {' | '.join(_text_of(found.other).formulas)[:400]}"
                )
                if {"proved", "refuted"} <= {verdict, expected.get(claim, verdict), there[claim]}:
                    against += 1
                    print(f"CONTRADICTION {told}", flush=True)
                if verdict not in _DECIDED:
                    better += there[claim] in _DECIDED
                    continue
                for change in {*found.changes, "all"}:
                    tried[change] += 1
                    lost[change] += verdict != there[claim]
                if verdict != there[claim]:
                    print(f"lost {told}", flush=True)
        print(f"{name}: {time.process_time() - start:.1f} s", file=sys.stderr, flush=True)
    for change, n in sorted(tried.items(), key=lambda item: -lost[item[0]] / item[1]):
        print(f"{change:20} {lost[change]:5} of {n:5} lost {100 * lost[change] / n:6.1f} %")
    print(f"{against} contradict, {better} better")
    return int(against > 0)


if __name__ == "__main__":
    sys.exit(main())
