"""The kernel's own reading of words that others say as well, and what it shows of angles and hyperbolic functions."""

from __future__ import annotations

import math
from random import Random

import numpy as np
import pytest

from duhem.proof.kernel.bounds import Facts
from duhem.proof.kernel.curvature import over
from duhem.proof.kernel.domain import NEGATIVE, POSITIVE, ZERO
from duhem.proof.kernel.stated_law import StatedLaw
from duhem.proof.kernel.term import NotWritten, Term, parse
from tests.long import mostly_long
from tests.oracles import drawn_formulas
from tests.proof.test_kernel import violation


def shown(text: str) -> Facts:
    stated = StatedLaw.read(drawn_formulas.law(f"a*0 + {text}"))
    return over(stated).facts(stated.g.args[1])


# -- reading -----------------------------------------------------------------------------------------------------------

SAME = {
    "sign(a)": "where(a > 0, 1, where(a < 0, -1, 0))",
    "log10(m)": "log(m)*log(10)**-1",
    "where(a > 0 and b > 0, 1, 2)": "where(a > 0, where(b > 0, 1, 2), 2)",
    "where(a > 0 or b > 0, 1, 2)": "where(a > 0, 1, where(b > 0, 1, 2))",
    "where(a > 0 or b > 0 and a < b, 1, 2)": "where(a > 0, 1, where(b > 0, where(a < b, 1, 2), 2))",
    "where((a > 0 or b > 0) and a < b, 1, 2)": "where(a > 0, where(a < b, 1, 2), where(b > 0, where(a < b, 1, 2), 2))",
    "where((a) > (0) and ((b > 0)), 1, 2)": "where(a > 0, where(b > 0, 1, 2), 2)",
}


@pytest.mark.parametrize("text", SAME)
def test_what_others_say_as_well_is_read_so(text: str) -> None:
    assert parse(text) == parse(SAME[text])


@pytest.mark.parametrize(
    "text",
    [
        "a and b", "(a > 0) + 1", "where(a, 1, 2)", "where(a > 0 and b, 1, 2)", "and", "where(a > 0 and, 1, 2)", "a > 0 and b > 0",
        "where((a > 0 and b > 0) > 0, 1, 2)", "where(1 + (a > 0) > 0, 1, 2)", "max(a > 0, 1)", "sign(a > 0)", "where(0 < a < 1, 1, 2)",
        "where(not a > 0, 1, 2)", "atan2(a)", "sign(a, b)", "sign(" * 40 + "a" + " + 1)" * 40,
        f"where({' and '.join(f'(a > {i} or b > {i})' for i in range(30))}, 1, 2)",
    ],
)  # fmt: skip
def test_what_is_no_formula_is_not_read(text: str) -> None:
    with pytest.raises(NotWritten):
        parse(text)


# -- what is shown -----------------------------------------------------------------------------------------------------
# a, b are forces; 0 <= e <= 1/2, -1 <= q <= 1, m > 0, 1 <= p <= 4, -2 <= k <= -1/2


@pytest.mark.parametrize(
    ("text", "defined"),
    [
        ("asin(q)", True), ("acos(e)", True), ("acos(-q)", True), ("asin(p)", False), ("acos(k)", False), ("asin(a)", False),
        ("atan2(m, a)", True), ("atan2(a, k)", True), ("atan2(b, a)", False), ("atan2(q, e)", False), ("sinh(log(m))", True),
        ("cosh(log(e))", False), ("log10(p)", True), ("log10(e)", False), ("sign(m)", True), ("sign(1/e)", False),
    ],
)  # fmt: skip
def test_where_words_are_defined(text: str, defined: bool) -> None:
    assert shown(text).defined is defined


@pytest.mark.parametrize(
    ("text", "sign"),
    [
        ("asin(e)", POSITIVE | ZERO), ("asin(k/2)", NEGATIVE), ("acos(e)", POSITIVE), ("acos(q)", POSITIVE | ZERO), ("sinh(m)", POSITIVE),
        ("sinh(-m)", NEGATIVE), ("cosh(a)", POSITIVE), ("sign(k)", NEGATIVE), ("log10(1 + m)", POSITIVE), ("acos(1)", ZERO),
    ],
)  # fmt: skip
def test_signs_of_words(text: str, sign: int) -> None:
    assert shown(text).sign == sign


@pytest.mark.parametrize(
    ("text", "convex", "concave", "quasiconvex"),
    [
        ("sinh(abs(a))", True, False, True), ("sinh(a)", False, False, True), ("sinh(-abs(a))", False, True, False),
        ("cosh(a - b)", True, False, True), ("cosh(norm(a, b))", True, False, True), ("cosh(abs(a) - 1)", False, False, False),
        ("asin(abs(a))", True, False, True), ("asin(-abs(a))", False, True, False), ("acos(abs(a))", False, True, False),
        ("acos(-abs(a))", True, False, True), ("acos(a)", False, False, True), ("atan2(a, b)", False, False, False),
        ("atan2(a, 1)", False, False, False), ("sign(a)", False, False, False),
    ],
)  # fmt: skip
def test_curvature_of_words(text: str, convex: bool, concave: bool, quasiconvex: bool) -> None:
    found = shown(text)
    assert (found.convex, found.concave, found.quasiconvex) == (convex, concave, quasiconvex)


@pytest.mark.parametrize("word", ["tanh", "atan"])
@pytest.mark.parametrize(
    ("inner", "concave"),
    [
        ("x", True), ("x/m", True), ("e*x", True), ("sqrt(x)", True), ("sqrt(x) + x", True), ("-x*k", True), ("min(x, 1 + y)", True),
        ("tanh(x)", True), ("x - 1", False), ("x**2", False), ("q*x", False), ("-x", False), ("x - e", False),
        ("x*y", False), ("pos(x - 1)", False),
    ],
)  # fmt: skip
def test_a_word_that_rises_ever_less_of_what_is_concave_and_above_zero(word: str, inner: str, concave: bool) -> None:
    """For x and y >= 0; what is not concave has a chord above it, in floats."""
    text = f"{word}({inner})".replace("x", "a").replace("y", "b")
    quadrant = over(StatedLaw.read(drawn_formulas.law("a + b"))).where({parse("a"): False, parse("b"): False})
    turned = quadrant.facts(parse(text.replace("(", "(-(", 1) + ")"))
    assert (quadrant.facts(parse(text)).concave, turned.convex) == (concave, concave)
    of = compile(text, "g", "eval")
    rng, above = np.random.default_rng(3), 0.0
    words = {"tanh": np.tanh, "atan": np.arctan, "sqrt": np.sqrt, "abs": np.abs, "min": np.minimum, "pos": lambda x: np.maximum(x, 0)}
    for m, e, q, k in [(0.3, 0.4, 1.0, -1.0), (2.0, 0.5, -1.0, -2.0), (1.0, 0.2, -0.5, -0.5)]:
        one, two = rng.uniform(0, 3, size=(2, 2, 4000))
        values = [eval(of, words | {"m": m, "e": e, "q": q, "k": k, "a": a, "b": b}) for a, b in (one, two, (one + two) / 2)]
        above = max(above, float(np.max((values[0] + values[1]) / 2 - values[2])))
    assert (above < 1e-12) is concave


def drawn(rng: Random, depth: int) -> str:
    if depth == 0:
        return rng.choice(("a", "b", "a - b", "abs(a)", "norm(a, b)", "e*a", "m", "q", "p", "-abs(b)", "pos(a)", "k"))
    one, two = drawn(rng, depth - 1), drawn(rng, rng.randrange(depth))
    arc = f"{rng.choice(('asin', 'acos'))}({rng.choice(('q', 'e', '-q', 'e - 1/2', 'q*e', '2*e', 'k/2', 'min(e, q)'))})"
    return rng.choice((
        f"sinh({one})", f"cosh({one})", f"sinh({one})", f"cosh({one})", f"({one})*{arc}", f"{arc} + {one}", f"{one} - {two}",
        f"atan2({one}, {rng.choice(('m', 'k', two))})", f"log10({rng.choice(('p', '1 + m', 'cosh(a)'))})*({one})", f"max({one}, {two})",
        f"sign({rng.choice(('m', 'k', 'p', 'a'))})*({one})", f"norm({one}, {two})", f"where(m > 0 and k < 0, {one}, {two})",
        f"where(m > 0 and k > 0 or p > 0, {one}, {two})", f"neg({one})",
    ))  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize("count", mostly_long([40, 250], 40))
def test_what_is_shown_of_words_holds_at_drawn_points(count: int) -> None:
    rng, said, wrong = Random(11), 0, list[str]()
    for _ in range(count):
        text = drawn(rng, rng.choice((1, 2, 2, 3)))
        found = shown(text)
        if found.defined:
            said += found.quasiconvex or found.concave
            stated = StatedLaw.read(drawn_formulas.law(f"a*0 + {text}"))
            if (fault := violation(stated._replace(g=stated.g.args[1]), found, rng, 25)) is not None:
                wrong.append(f"{text}: {fault}")
    assert wrong == []
    assert said > 0.24 * count


def test_the_oracle_has_the_words_too() -> None:
    at = {"a": -0.5, "b": 2.0}
    term: Term = parse("atan2(b, a) + asin(a) + acos(a) + sinh(a) + cosh(a) + sign(a) + log10(b)")
    known = math.atan2(2, -0.5) + math.asin(-0.5) + math.acos(-0.5) + math.sinh(-0.5) + math.cosh(-0.5) - 1 + math.log10(2)
    assert drawn_formulas.value(term, at) == pytest.approx(known, rel=1e-15)
