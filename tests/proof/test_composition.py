"""The composition rules against CVXPY's: two implementations of disciplined convex programming, and samples against both.

For each built-in law and for formulas composed at random, node by node.  CVXPY sees numbers in place of parameters;
its word counts only where its atoms do not cut the domain.
"""

from __future__ import annotations

import contextlib
import random
from collections.abc import Iterator
from functools import cache
from typing import Any

import numpy as np
import pytest
import sympy as sp

from duhem import Criterion, InputError, load
from duhem.expression import numpy_
from duhem.expression.cvxpy_ import expression
from duhem.law.catalogue import load_formula, names
from duhem.proof.facts.formula_subject import FormulaSubject
from duhem.proof.methods import refuters
from tests.long import mostly_long
from tests.oracles.prover import composition
from tests.oracles.prover.curvature import curvature
from tests.oracles.prover.decide import AskedSubject
from tests.oracles.prover.shape import Curvature

cp = pytest.importorskip("cvxpy")

FORMULAS = 60


def _affine(rng: random.Random) -> str:
    return rng.choice(["a", "b", "a + b", "a - 2*b", "a/2 + b - 1/3", "2*a + 1/5", "1 - b"])


def _formula(rng: random.Random, depth: int) -> str:
    """A formula over the whole vocabulary of the rules; convex by luck only."""
    if depth == 0:
        return _affine(rng)

    def inner() -> str:
        return _formula(rng, depth - 1)

    kind = rng.randrange(13)
    if kind < 4:
        words = rng.choice(["max", "max", "norm", "norm", "min"])
        return f"{words}({inner()}, {inner()})"
    if kind < 7:
        return f"{rng.choice(['abs', 'pos', 'neg'])}({inner()})"
    if kind < 9:
        return f"(({inner()}) + {rng.choice(['1', '2', '1/3'])}*({inner()}))"
    if kind == 9:
        return f"(({inner()}) - {rng.choice(['1', '1/2'])}*({inner()}))"
    if kind == 10:
        return f"({inner()})**2"
    if kind == 11:
        return f"abs({inner()})**{rng.choice(['(3/2)', '3', '(1/2)'])}"
    return f"exp({_affine(rng)})"


def _generated(name: str) -> Criterion:
    rng = random.Random(f"composition/{name.removeprefix('formula-')}")
    while True:
        with contextlib.suppress(InputError):  # without forces once simplified: another
            g = f"{_formula(rng, rng.randint(1, 3))} - {rng.randint(1, 3)}"
            return Criterion(name=name, g=g, forces=("a", "b"), pressure=None)


LAWS = [*(law.name for law in map(load, names()) if isinstance(law, Criterion)), *(f"formula-{k}" for k in range(FORMULAS))]
EVERY_RUN = LAWS[: 8 - FORMULAS]  # the built-in laws and eight formulas


@cache
def _subject(name: str) -> FormulaSubject:
    subject = AskedSubject(_generated(name) if name.startswith("formula-") else load_formula(name))
    subject.allow(20_000_000)
    return subject


@cache
def _numbers(name: str) -> dict[sp.Symbol, sp.Rational]:
    """The plainest admitted parameters of the law's simplest form."""
    return {x: sp.Rational(v.numerator, v.denominator) for x, v in next(_subject(name).choices(1)).items()}


def _nodes(name: str) -> Iterator[tuple[sp.Expr, Curvature, sp.Expr]]:
    """Each part of the formula that depends on the forces, what our rules say of it, and the part at those numbers."""
    subject = _subject(name)
    seen = set()
    for node in sp.preorder_traversal(subject.simple.g):
        if isinstance(node, sp.Expr) and node.free_symbols & set(subject.simple.forces) and node not in seen:
            seen.add(node)
            at = node.subs(_numbers(name))
            if at.free_symbols <= set(subject.simple.forces):
                yield node, curvature(node, subject), at


def _cvxpy(expr: sp.Expr, forces: tuple[sp.Symbol, ...]) -> Any | None:
    """CVXPY's expression, or None where it has none or restricts the domain."""
    try:
        found = expression(expr, {x: cp.Variable(name=str(x)) for x in forces})
    except InputError:
        return None
    return None if found.domain else found


def _samples(expr: sp.Expr, forces: tuple[sp.Symbol, ...]) -> tuple[Any, Any, Any]:
    """Values at 4000 pairs of points of many sizes, and at their midpoints."""
    rng = np.random.default_rng(7)
    p, q = (rng.standard_normal((len(forces), 4000)) * 10.0 ** rng.uniform(-1.5, 1, 4000) for _ in range(2))
    with np.errstate(all="ignore"):
        values = [np.broadcast_to(numpy_.evaluate(expr, dict(zip(forces, x, strict=True))), 4000) for x in (p, q, (p + q) / 2)]
    return values[0], values[1], values[2]


@pytest.mark.slow
@pytest.mark.parametrize("name", mostly_long(LAWS, *EVERY_RUN))
def test_samples_do_not_contradict_the_rules(name: str) -> None:
    forces = _subject(name).simple.forces
    for node, facts, at in _nodes(name):
        p, q, middle = _samples(at, forces)
        finite = np.isfinite(p) & np.isfinite(q) & np.isfinite(middle)
        p, q, middle = p[finite], q[finite], middle[finite]
        slack = 1e-9 * (1 + np.abs(p) + np.abs(q))
        assert not facts.convex or np.all(middle <= (p + q) / 2 + slack), node
        assert not facts.concave or np.all(middle >= (p + q) / 2 - slack), node
        assert not facts.quasiconvex or np.all(middle <= np.maximum(p, q) + slack), node
        assert not facts.nonnegative or np.all(p >= -slack), node
        assert not facts.nonpositive or np.all(p <= slack), node


@pytest.mark.slow
@pytest.mark.parametrize("name", mostly_long(LAWS, *EVERY_RUN))
def test_what_cvxpy_proves_is_not_refuted(name: str) -> None:
    """And what the composition method proves neither, by the search for chords."""
    subject = _subject(name)
    theirs = _cvxpy(subject.simple.g.subs(_numbers(name)), subject.simple.forces)
    convex = theirs is not None and theirs.is_dqcp() and theirs.is_quasiconvex()
    if convex and subject.simple.parameters == ():
        assert refuters.convexity_by_scouting(subject) is None
    if composition.convexity(subject) is not None:
        assert refuters.convexity_by_scouting(subject) is None


def _agreement() -> dict[tuple[bool, bool], int]:
    """How many parts are convex by (our rules, CVXPY's)."""
    counts = dict.fromkeys([(a, b) for a in (True, False) for b in (True, False)], 0)
    for name in LAWS:
        for _, facts, at in _nodes(name):
            theirs = _cvxpy(at, _subject(name).simple.forces)
            if theirs is not None:
                counts[facts.convex, bool(theirs.is_dcp() and theirs.is_convex())] += 1
    return counts


@pytest.mark.long
def test_our_rules_know_whatever_cvxpy_knows() -> None:
    counts = _agreement()
    assert counts[True, True] > 200 and counts[False, False] > 20
    assert counts[False, True] == 0  # a rule that CVXPY knows and we lack


@pytest.mark.parametrize(("p", "root", "convex"), [("17/10", "10/17", True), ("101/100", "100/101", True), ("101/100", "100/103", False)])
def test_a_norm_is_one_whatever_the_length_of_its_exponents(p: str, root: str, convex: bool) -> None:
    """p r = 1 is reckoned with, though SymPy is kept from combining such numbers."""
    law = Criterion(name="norm", g=f"(abs(a + b)**({p}) + abs(3*b)**({p}))**({root}) - 1", forces=("a", "b"), pressure=None)
    assert curvature(law.g, AskedSubject(law)).convex == convex
