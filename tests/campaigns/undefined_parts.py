"""Laws with a part that multiplies out to 0 and has no value somewhere, put into every place of known laws: no claim may be confirmed.

    python -m tests.campaigns.undefined_parts --texts 10000 --seed 1

The part P goes as ``+ P`` or ``* (1 + P)`` to each number, name and operation in g, conditions, branches, flows, potentials, surfaces,
constraints and boundary curves, by Python's own syntax tree.  That the text has no value at some point of the domain at which it
is read is worked out in many digits by an evaluator that shares nothing with duhem.  Then the kernel is asked, by all of its rules
without evidence and by the rules and evidence that proved the claims of the law as it was.
"""

from __future__ import annotations

import argparse
import ast
import json
import sys
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from fractions import Fraction
from pathlib import Path
from random import Random
from typing import Any, NamedTuple

import mpmath

import duhem
from duhem import InputError
from duhem.law import catalogue
from duhem.law.atlas.entry import entries
from duhem.law.curve_law import Law
from duhem.proof.claims import CHEAP, DEAR
from duhem.proof.kernel.certificate import CLAIMS, stated
from duhem.proof.kernel.claims import objection, rules_of
from duhem.proof.kernel.curve import StatedCurve
from duhem.proof.kernel.stated_law import StatedLaw
from duhem.proof.kernel.steps import TooDearError, within
from duhem.proof.kernel.term import NotWritten

KIN = (
    "sqrt({q})*({x} + 1) - sqrt({q})*{x} - sqrt({q})", "2*({q})**(3/2) - ({q})**(3/2) - ({q})**(3/2)", "({q})**(1/4)*({q})**(3/4) - ({q})",
    "log({q}) - log({q})", "max(log({q}), log({q})) - log({q})", "exp(0*log({q})) - 1", "0*log10({q})", "where(log({q}) > 0, 0, 0)",
    "acos({q} - 1) - acos({q} - 1)", "0*asin({q} - 1)", "0*sqrt({q})", "sqrt({q})**2 - ({q})", "pos(sqrt({q})) - sqrt({q})",
    "(sqrt({q}) + 1)**0 - 1", "{u}/{u} - 1", "{u}**(-2)*{u}**2 - 1", "0*{u}**(-1/2)", "0*(1/{u})", "0/{u}", "norm({u})/norm({u}) - 1",
    "abs({u})/abs({u}) - 1", "where(1/{u} >= 0, {x}, {x}) - {x}", "tan({u} + pi/2) - tan({u} + pi/2)", "0*atan2({u}, 0*{x})",
)  # fmt: skip
_POINTS, _TRIES = 24, 40
_NEAR = mpmath.mpf(10) ** -40
_READERS = {"g": CLAIMS[:6], "flow": ("normality", "dissipation"), "constraint": CLAIMS, "boundary": CLAIMS[:5]}  # of a part of the law
SMALL = ("coulomb", "antoni2007", "box", "superellipse", "radial-flow", "regularised", "limacon", "wedge")


class Undefined(Exception):
    """There is no value."""


class Text(NamedTuple):
    """A law with a part put in, where it stands, and a claim that may not be confirmed of it."""

    law: Mapping[str, Any]
    part: str
    kin: str
    undefined_at: Mapping[str, Fraction]
    claims: frozenset[str]


class Found(NamedTuple):
    """How many texts were asked, by the part of the law, how many draws had no such text, and what was confirmed falsely."""

    asked: Counter[str]
    passed: int
    wrong: tuple[str, ...]


def undefined_parts(made: Sequence[Mapping[str, Any]], count: int, seed: int) -> Found:
    """``count`` texts drawn from certificates."""
    rng, asked, passed, wrong = Random(seed), Counter[str](), 0, list[str]()
    with mpmath.workdps(60):
        while asked.total() < count and passed < _TRIES * (count + 1):
            part = rng.choices(list(_READERS), [5, 2, 2, 1])[0]
            certificate = rng.choice([c for c in made if any(own == part for own, _ in _places(c["law"]))] or made)
            if (text := drawn(certificate["law"], part, rng)) is None:
                passed += 1
                continue
            asked[text.part] += 1
            if asked.total() % 500 == 0:
                print(f"{asked.total()} texts, {len(wrong)} confirmed falsely", file=sys.stderr, flush=True)
            if false := sorted(confirmed(text.law, certificate["claims"]) & text.claims):
                place = ", ".join(f"{n} = {v}" for n, v in text.undefined_at.items())
                wrong.append(f"{false} of {json.dumps(text.law)} at {place}")
    return Found(asked, passed, tuple(wrong))


def confirmed(law: Mapping[str, Any], recorded: Sequence[Mapping[str, Any]]) -> set[str]:
    """The claims that the kernel confirms, by what proved them of another law and by its rules without evidence."""
    try:
        known = stated(law)
    except (NotWritten, KeyError, ValueError):
        return set()
    settled = set[str]()
    for claim in CLAIMS:
        offers = [(row["rule"], row["evidence"]) for row in recorded if row["claim"] == claim and row["rule"] is not None]
        offers += [(rule, {}) for rule in rules_of(claim, known)]
        if any(_confirms(claim, rule, settled, known, evidence) for rule, evidence in offers):
            settled.add(claim)
    return settled


def _confirms(claim: str, rule: str, settled: set[str], known: StatedLaw | StatedCurve, evidence: Mapping[str, Any]) -> bool:
    """Whether a rule confirms a claim within the steps that ``verify`` allows it."""
    with suppress(TooDearError), within((DEAR if isinstance(known, StatedLaw) else CHEAP).steps):
        return not objection(claim, rule, frozenset(settled), known, evidence)
    return False


# -- texts ---------------------------------------------------------------------------------------------------------------


def drawn(law: Mapping[str, Any], part: str, rng: Random) -> Text | None:
    """The law with something in one part that has no value somewhere; None where no such point was found, or there is no such part."""
    places = [path for own, path in _places(law) if own == part]
    if not places:
        return None
    path = rng.choice(places)
    text = _at(law, path)
    names = _names(law, part, text)
    x, y = rng.choice(names), rng.choice(names)
    here = {n: _inner(law, n, rng) for n in dict.fromkeys((x, y))}
    u = f"({x} - ({here[x]}))"
    q = f"{u}**2 + ({y} - ({here[y]}))**2 - 1/4" if y != x else f"{u}**2 - 1/4"
    kin = rng.choice(KIN)
    changed = _put(text, kin.format(x=x, u=u, q=q), rng)
    if changed is None:
        return None
    new = _with(law, path, changed)
    claims = set(_READERS[part])
    if (point := _undefined_at(law, new, path, here, rng)) is None:
        return None
    if part == "g" and _value_or_none(_at(new, path), {**point, **dict.fromkeys(law["forces"], Fraction(0))}) is not None:
        claims -= {"origin"}  # g has a value at zero force
    rays = ({**point, **{n: r * point[n] for n in law["forces"]}} for r in (Fraction(1, 3), Fraction(2), Fraction(7)))
    if part == "g" and not any(_has_value(_at(new, path), at) for at in rays):
        claims -= {"dissipation"}  # it has none on a ray from zero force: a boundary that ends there has its normal across the ray
    if "energy" in law and _has_value(_at(new, path), point | _forces(law, point)):
        claims -= {"dissipation"}  # it is asked in states alone, and there is a value in this one
    return Text(new, part, kin, point, frozenset(claims))


def _forces(law: Mapping[str, Any], point: Mapping[str, Fraction]) -> dict[str, Fraction]:
    """The forces of internal variables that the energy gives at their values, where they are numbers."""
    energy, found = ast.parse(f"({law['energy']})", mode="eval").body, dict[str, Fraction]()
    at = {n: mpmath.mpf(v.numerator) / v.denominator for n, v in point.items()}
    for name, variable in law["variables"].items():
        if "force" in variable and not variable.get("observable"):
            with suppress(Undefined):
                slope = mpmath.diff(lambda x, name=name: value(energy, at | {name: x}), at[name])
                found[variable["force"]] = -Fraction(round(slope * 10**20), 10**20)
    return found


def _places(law: Mapping[str, Any]) -> Iterator[tuple[str, tuple[Any, ...]]]:
    """Which part of the law each of its texts is, and where it stands."""
    if "boundary" in law:
        yield from (("boundary", ("boundary", i)) for i in range(2))
        yield from (("flow", ("flow", i)) for i in range(2) if law["flow"])
    for base, entry in ((("surfaces", i), s) for i, s in enumerate(law["surfaces"])) if "surfaces" in law else (((), law),):
        if "g" in entry:
            yield "g", (*base, "g")
            flow = entry["flow"]
            yield from (("flow", (*base, "flow", key)) for key in (flow if isinstance(flow, dict) else range(len(flow or ()))))
    yield from (("constraint", ("constraints", i)) for i in range(len(law["constraints"])))


def _at(law: Any, path: Sequence[Any]) -> str:
    for step in path:
        law = law[step]
    return str(law)


def _with(law: Any, path: Sequence[Any], text: str) -> Any:
    if not path:
        return text
    own = list(law) if isinstance(law, list | tuple) else dict(law)
    own[path[0]] = _with(own[path[0]], path[1:], text)
    return own


def _names(law: Mapping[str, Any], part: str, text: str) -> list[str]:
    """What may stand in a text."""
    moving = [] if part == "constraint" or "boundary" in law else [*law["forces"], *law["forces"]]
    pressure = [law["pressure"]] if law["pressure"] and part != "constraint" and "boundary" not in law else []
    angle = [law["angle"]] * 2 if "angle" in law and part != "constraint" else []
    return [*moving, *pressure, *angle, *law["parameters"]] or [law["forces"][0]]


def _inner(law: Mapping[str, Any], name: str, rng: Random) -> Fraction:
    """A value that a name may have."""
    if name == law["pressure"]:
        return -Fraction(rng.randint(1, 8), 4)
    if name not in law["parameters"]:
        return Fraction(rng.randint(-6, 6), 4)
    entry = law["parameters"][name]
    if "value" in entry:
        return Fraction(entry["value"])
    low = Fraction(0) if "positive" in entry else None if entry.get("min") is None else Fraction(entry["min"])
    high = None if entry.get("max") is None else Fraction(entry["max"])
    share = Fraction(rng.randint(1, 7), 8)
    if low is not None and high is not None:
        return low + share * (high - low)
    return low + 2 * share if low is not None else high - 2 * share if high is not None else 4 * share - 2


def _put(text: str, part: str, rng: Random) -> str | None:
    """The text with the part at one of its places; None where it is no formula."""
    tree = ast.parse(f"({text})", mode="eval")
    spots = [node for node in ast.walk(tree) if isinstance(node, ast.Name | ast.Constant | ast.BinOp | ast.UnaryOp | ast.Call)]
    words = {id(node.func) for node in ast.walk(tree) if isinstance(node, ast.Call)}
    spot = rng.choice([node for node in spots if id(node) not in words])
    own = ast.parse(f"(_spot + ({part}))" if rng.random() < 0.6 else f"(_spot*(1 + ({part})))", mode="eval").body

    class Put(ast.NodeTransformer):
        def visit(self, node: ast.AST) -> ast.AST:
            if node is spot:
                return _Named({"_spot": spot}).visit(own)
            return self.generic_visit(node)

    return ast.unparse(Put().visit(tree))


class _Named(ast.NodeTransformer):
    def __init__(self, meaning: Mapping[str, ast.AST]) -> None:
        self.meaning = meaning

    def visit_Name(self, node: ast.Name) -> ast.AST:
        return self.meaning.get(node.id, node)


# -- values --------------------------------------------------------------------------------------------------------------


def _undefined_at(old: Mapping[str, Any], new: Mapping[str, Any], path: Sequence[Any], here: Mapping[str, Fraction], rng: Random) -> Any:
    """A point of the domain where the text had a value and the new one has none, and where it is read; None if none was met."""
    others = [(c, i) for i, c in enumerate(old["constraints"]) if tuple(path) != ("constraints", i)]
    for _ in range(_POINTS):
        point = {n: _inner(old, n, rng) for n in (*old["forces"], *old["parameters"], *([old["pressure"]] if old["pressure"] else []))}
        point |= {old["angle"]: _inner(old, old["angle"], rng)} if "angle" in old else {}
        point |= {n: v for n, v in here.items() if n not in old["forces"] or rng.random() < 0.9}
        if not all(_value_or_none(c, point) is True for c, _ in others):
            continue
        if path[0] != "constraints" and not all(_value_or_none(c, point) is True for c in old["constraints"]):
            continue
        scale = Fraction(10) ** rng.choice((0, 0, 1, -1, 2))
        point |= {n: point[n] * scale for n in old["forces"] if n not in here}
        if _value_or_none(_at(old, path), point) is not None and not _has_value(_at(new, path), point):
            return point
    return None


def _has_value(text: str, point: Mapping[str, Fraction]) -> bool:
    """Whether it has one, or is a maximum of which another part is > 0: then the point is not in K, whatever the rest is."""
    tree = ast.parse(f"({text})", mode="eval").body
    if isinstance(tree, ast.Call) and getattr(tree.func, "id", "") == "max":
        found = [_of_node_or_none(arm, point) for arm in tree.args]
        return None not in found or any(v is not None and v > 0 for v in found)
    return _of_node_or_none(tree, point) is not None


def _value_or_none(text: str, point: Mapping[str, Fraction]) -> Any:
    return _of_node_or_none(ast.parse(f"({text})", mode="eval").body, point)


def _of_node_or_none(node: ast.AST, point: Mapping[str, Fraction]) -> Any:
    try:
        return value(node, {n: mpmath.mpf(v.numerator) / v.denominator for n, v in point.items()})
    except Undefined:
        return None


def value(node: ast.AST, at: Mapping[str, Any]) -> Any:
    """A number, or whether a condition holds; of a choice the value that is not chosen is not asked for."""
    match node:
        case ast.Constant(value=x):
            return mpmath.mpf(str(x))
        case ast.Name(id="pi"):
            return +mpmath.pi
        case ast.Name(id=name):
            return at[name]
        case ast.UnaryOp(op=op, operand=x):
            return -value(x, at) if isinstance(op, ast.USub) else value(x, at)
        case ast.BoolOp(op=op, values=parts):
            return (all if isinstance(op, ast.And) else any)(value(p, at) for p in parts)
        case ast.Compare(left=left, ops=[op], comparators=[right]):
            x, y = value(left, at), value(right, at)
            return {ast.Lt: x < y, ast.LtE: x <= y, ast.Gt: x > y, ast.GtE: x >= y}[type(op)]
        case ast.Call(func=ast.Name(id="where"), args=[condition, one, two]):
            return value(one if value(condition, at) else two, at)
        case ast.Call(func=ast.Name(id=word), args=args):
            return _WORDS[word](*(value(a, at) for a in args))
        case ast.BinOp(left=left, op=op, right=right):
            return _joined(op, value(left, at), value(right, at))
    raise ValueError(ast.dump(node))


def _joined(op: ast.operator, x: Any, y: Any) -> Any:
    match op:
        case ast.Add():
            return x + y
        case ast.Sub():
            return x - y
        case ast.Mult():
            return x * y
        case ast.Div():
            return x / _nonzero(y)
        case ast.Pow():
            whole = abs(y - mpmath.nint(y)) < _NEAR
            if y < 0:
                _nonzero(x)
            if not whole and x < 0:
                if x < -_NEAR:
                    raise Undefined
                x = mpmath.mpf(0)
            return mpmath.mpf(1) if y == 0 else x ** (int(mpmath.nint(y)) if whole else y)
    raise ValueError(op)


def _nonzero(x: Any) -> Any:
    if abs(x) < _NEAR:
        raise Undefined
    return x


def _log(x: Any) -> Any:
    if x < _NEAR:
        raise Undefined
    return mpmath.log(x)


def _root(x: Any) -> Any:
    if x < -_NEAR:
        raise Undefined
    return mpmath.sqrt(max(x, 0))


def _inverse(word: Callable[[Any], Any]) -> Callable[[Any], Any]:
    def called(x: Any) -> Any:
        if abs(x) > 1 + _NEAR:
            raise Undefined
        return word(max(-1, min(1, x)))

    return called


def _atan2(y: Any, x: Any) -> Any:
    if abs(x) < _NEAR and abs(y) < _NEAR:
        raise Undefined
    return mpmath.atan2(y, x)


def _eigmax(*entries: Any) -> Any:
    xx, yy, zz, yz, xz, xy = entries
    return max(mpmath.eigsy(mpmath.matrix([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]), eigvals_only=True))


_WORDS: Mapping[str, Callable[..., Any]] = {
    "abs": abs, "sign": mpmath.sign, "sqrt": _root, "exp": mpmath.exp, "log": _log, "log10": lambda x: _log(x) / mpmath.log(10),
    "sin": mpmath.sin, "cos": mpmath.cos, "tan": lambda x: mpmath.sin(x) / _nonzero(mpmath.cos(x)), "asin": _inverse(mpmath.asin),
    "acos": _inverse(mpmath.acos), "atan": mpmath.atan, "sinh": mpmath.sinh, "cosh": mpmath.cosh, "tanh": mpmath.tanh,
    "pos": lambda x: max(x, 0), "neg": lambda x: max(-x, 0), "max": max, "min": min, "atan2": _atan2, "eigmax": _eigmax,
    "norm": lambda *x: mpmath.sqrt(sum(y * y for y in x)),
}  # fmt: skip


def made(laws: Sequence[str | Law]) -> list[dict[str, Any]]:
    """The certificates of laws; none for one without exact parameters."""
    found = list[dict[str, Any]]()
    for law in laws:
        try:
            found.append(duhem.verify(law).certificate())
        except InputError:
            continue
    return found


def main(given: Sequence[str]) -> int:
    parser = argparse.ArgumentParser(prog="python -m tests.campaigns.undefined_parts")
    parser.add_argument("--texts", type=int, default=10_000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--laws", nargs="*", help="names of laws; else all built-in and atlas laws")
    parser.add_argument("--certificates", type=Path, help="a folder of certificates, in the place of proving the laws anew")
    asked = parser.parse_args(given)
    if asked.certificates is None:
        certificates = made(asked.laws or [*catalogue.names(), *(entry.name for entry in entries())])
    else:
        certificates = [json.loads(path.read_text()) for path in sorted(asked.certificates.glob("*.json"))]
    found = undefined_parts(certificates, asked.texts, asked.seed)
    print(f"{len(certificates)} laws, {found.asked.total()} texts {dict(found.asked)}, {found.passed} draws without a point")
    print(f"confirmed falsely: {len(found.wrong)}", *found.wrong[:20], sep="\n")
    return 1 if found.wrong else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
