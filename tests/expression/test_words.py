"""Words that others say as well, conditions that are joined, angles: what they mean is one thing to every interpreter."""

from __future__ import annotations

import math
from collections.abc import Mapping
from fractions import Fraction
from random import Random
from typing import Any

import flint
import mpmath
import numpy as np
import pytest
import sympy as sp

from duhem import Criterion
from duhem.errors import InputError
from duhem.expression import Atan2, Norm, Where, ball_series, balls, fold, jets, mpmath_, numpy_, symbol
from duhem.expression.angles import algebraic_angles
from duhem.expression.dimensions import degree
from duhem.expression.parse import parse_as_written, parse_expression
from duhem.expression.text import formula
from tests.long import mostly_long

x, y = symbol("x"), symbol("y")
m = symbol("m", positive=True)
KNOWN = {"x": x, "y": y, "m": m}
DOUBLES = mpmath_.table(mpmath_.doubles())
Point = Mapping[sp.Symbol, Fraction]


def parse(text: str) -> sp.Expr:
    return parse_expression(text, KNOWN)


# -- what is built of other words --------------------------------------------------------------------------------------


@pytest.mark.parametrize(("value", "sign"), [(-2.5, -1.0), (-1e-300, -1.0), (0.0, 0.0), (1e-300, 1.0), (7.0, 1.0)])
def test_sign_is_zero_at_zero(value: float, sign: float) -> None:
    for read in (parse, lambda text: parse_as_written(text, KNOWN)):
        assert numpy_.evaluate(read("sign(x)"), {x: value}) == sign
        assert mpmath_.evaluate(read("sign(x)"), {x: value}) == sign
        assert balls.enclose(read("sign(x)"), {x: balls.ball(Fraction(value))}) == sign


def test_words_say_what_they_mean_to_sympy() -> None:
    assert parse("sign(m) + sign(-m)*x") == 1 - x
    assert parse("log10(1000) + log10(1/10)") == 2
    assert parse("log10(x)") == sp.log(x) / sp.log(10)
    assert sp.diff(parse("x*sign(x)"), x) == parse("sign(x)")
    assert formula(parse("x*sign(x - y)")) == "x*sign(x - y)" and formula(Where(x > 0, 1, Where(x < 1, -1, 0))).startswith("where(")
    assert sp.latex(parse("2*sign(x)**2")) == r"2 \operatorname{sgn}\left(x\right)^{2}"
    for text in ("sign(x)", "log10(m)", "atan2(y, x)*sinh(x) - cosh(y)", "acos(x/2) + asin(y/4)", "where(x > 0 or y < 1 and x < y, m, x)"):
        assert parse(formula(parse(text))) == parse(text)


CONDITIONS = {
    "x > 0 and y > 0": lambda a, b: a > 0 and b > 0,
    "x > 0 or y > 0": lambda a, b: a > 0 or b > 0,
    "x > 0 or y > 0 and x < -1": lambda a, b: a > 0 or (b > 0 and a < -1),
    "(x > 0 or y > 0) and x < 1": lambda a, b: (a > 0 or b > 0) and a < 1,
    "x > 0 and (y > 0 or x < 1 and y <= -1) or y <= -2": lambda a, b: (a > 0 and (b > 0 or (a < 1 and b <= -1))) or b <= -2,
    "((x >= 0)) and ((y) >= 0 and (x + y) > 0)": lambda a, b: a >= 0 and b >= 0 and a + b > 0,
}


@pytest.mark.parametrize("condition", CONDITIONS)
def test_joined_conditions_choose_as_python_does(condition: str) -> None:
    for read in (parse, lambda text: parse_as_written(text, KNOWN)):
        chosen = numpy_.compiled(read(f"where({condition}, 2*x + 1, y - 3)"), (x, y))
        for a in range(-3, 4):
            for b in range(-3, 4):
                assert chosen(float(a), float(b)) == (2 * a + 1 if CONDITIONS[condition](a, b) else b - 3)


def test_conditions_joined_in_python_mean_the_same() -> None:
    assert Where(sp.And(x > 0, y > 0), x, y) == Where(x > 0, Where(y > 0, x, y), y)
    assert Where(sp.Or(x > 0, y > 0), x, y) == Where(x > 0, x, Where(y > 0, x, y))
    assert Where(sp.And(x > 0, sp.Not(y > 0)), 1, 2) == parse("where(y <= 0 and x > 0, 1, 2)")  # in the order SymPy has them
    assert Where(sp.And(m > 0, x > 0), 1, 2) == Where(x > 0, 1, 2)


def test_sympy_s_own_sign_and_angle_are_read_as_ours() -> None:
    a, b = symbol("a"), symbol("b")
    given = Criterion("own", sp.sign(a) * a + Norm(a, b) * sp.cos(2 * sp.atan2(b, a)) - 1, forces=("a", "b"), pressure=None)
    assert given.g == parse_expression("sign(a)*a + norm(a, b)*cos(2*atan2(b, a)) - 1", {"a": a, "b": b})
    assert sp.diff(given.g, a).has(sp.DiracDelta) is False


def test_what_a_joined_condition_does_not_reach_needs_no_value() -> None:
    """As in Python: the second comparison is looked at only where the first leaves the choice open."""
    chosen = parse("where(x > 0 and log(x) > 1, x, 7)")
    assert numpy_.evaluate(chosen, {x: [-1.0, 1.0, 10.0]}).tolist() == [7.0, 7.0, 10.0]


@pytest.mark.parametrize(
    ("text", "column", "words"),
    [
        ("x and y", 1, "first argument of where"),
        ("1 + (x > 0 and y > 0)", 6, "first argument of where"),
        ("where(x and y > 0, 1, 2)", 1, "'x' is no comparison"),
        ("where(x > 0 and, 1, 2)", 16, "unexpected ','"),
        ("where(or x > 0, 1, 2)", 7, "unexpected 'or'"),
        ("where(0 < x < 1, 1, 2)", 7, "0 < x and x < 1"),
        ("where(not x > 0, 1, 2)", 7, "turn the comparison round"),
        ("where(x > 0 & y > 0, 1, 2)", 13, "write and"),
        ("where(x > 0 | y > 0, 1, 2)", 13, "write or"),
        ("where((x > 0 and y > 0) > 0, 1, 2)", 8, "first argument of where"),
        (f"where({' and '.join(f'(x > {i} or y > {i})' for i in range(30))}, 1, 2)", 1, "join fewer"),
        ("sign(" * 40 + "x" + " + 1)" * 40, 151, "too large"),
        ("acos(2)", 1, "not real"),
        ("asin(1 + m)", 1, "asin and acos in [-1, 1]"),
        ("atan2(0, 0)", 1, "not real and finite"),
        ("atan2(y, atan2(y, x))", 1, "inside atan2"),
        ("log10(0)", 1, "log10(0) is not finite"),
        ("log10(-10)", 1, "not real"),
        ("cosh(1000)", 1, "too large"),
        ("atan2(x)", 1, "takes 2 arguments, not 1"),
    ],
)
def test_faults_name_place_and_remedy(text: str, column: int, words: str) -> None:
    with pytest.raises(InputError) as caught:
        parse(text)
    assert words in str(caught.value) and caught.value.remedy
    assert int(caught.value.where.rsplit(":", 1)[1]) == column


# -- the angle of a point ----------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("a", "b"), [(1.0, 2.0), (-1.0, 2.0), (-1.0, -2.0), (1.0, -2.0), (0.0, 3.0), (0.0, -3.0), (-2.0, 0.0), (2.0, 0.0)])
def test_atan2_and_its_cases_are_the_angle(a: float, b: float) -> None:
    for angle in (Atan2(y, x), Atan2(y, x).opened(), Atan2(sp.Rational(b), sp.Rational(a))):
        assert numpy_.evaluate(angle, {x: a, y: b}) == pytest.approx(math.atan2(b, a), rel=1e-15)
    point = {x: balls.ball(Fraction(a)), y: balls.ball(Fraction(b))}
    assert balls.enclose(Atan2(y, x), point).overlaps(balls.enclose(Atan2(y, x).opened(), point))


def test_there_is_no_angle_of_zero() -> None:
    """nan, and for a ball of points around it nothing is said; -0 is 0."""
    assert np.isnan(numpy_.evaluate(Atan2(y, x), {x: [0.0, -0.0], y: [0.0, -0.0]})).all()
    assert mpmath.isnan(mpmath_.evaluate(Atan2(y, x), {x: 0, y: 0}))
    assert not balls.enclose(Atan2(y, x), {x: balls.ball(Fraction(-1), Fraction(1)), y: balls.ball(Fraction(0))}).is_finite()
    assert numpy_.evaluate(Atan2(y, x), {x: -1.0, y: -0.0}) == math.pi
    assert math.isnan(fold(Atan2(y, x), DOUBLES, lambda _: -0.0))
    assert fold(Atan2(y, x), DOUBLES, {x: -1.0, y: -0.0}.__getitem__) == math.pi


def test_an_angle_jumps_on_its_cut_and_balls_say_so() -> None:
    around = {x: balls.ball(Fraction(-2), Fraction(-1)), y: balls.ball(Fraction(-1, 9), Fraction(1, 9))}
    both = balls.enclose(Atan2(y, x), around)
    assert both.contains(flint.arb.pi()) and both.contains(-flint.arb.pi())
    series = [flint.arb_series([v, 1], prec=3) for v in around.values()]
    (value,) = ball_series.compiled([Atan2(y, x)], [x, y])(*series)
    assert value[0].contains(flint.arb.pi()) and not value[1].is_finite()


@pytest.mark.parametrize("text", ["cos(3*t)", "sin(2*t)", "cos(t - m)", "sin(5*t + 1/3)", "cos(4*t)*sin(t)", "1 + m*cos(6*t)"])
def test_waves_of_an_angle_are_algebra(text: str) -> None:
    wave = parse_expression(text.replace("t", "atan2(y, x)"), KNOWN)
    algebra = algebraic_angles(wave)
    assert not algebra.has(Atan2, sp.atan, Where)
    for point in ({x: -1.5, y: 0.25, m: 2.0}, {x: -1.0, y: -2.0, m: 0.5}, {x: 0.0, y: -1.0, m: 1.0}, {x: -2.0, y: 0.0, m: 1.0}):
        assert numpy_.evaluate(algebra, point) == pytest.approx(float(numpy_.evaluate(wave, point)), rel=1e-13, abs=1e-13)
    assert np.isnan(numpy_.evaluate(algebra, {x: 0.0, y: 0.0, m: 1.0}))


def test_what_is_no_wave_is_opened() -> None:
    for text in ("atan2(y, x)", "cos(atan2(y, x)/2)", "cos(x*atan2(y, x))", "cos(atan2(y, x) + atan2(x, y))", "tanh(atan2(y, x))"):
        opened = algebraic_angles(parse(text))
        assert opened.has(Where) and not opened.has(Atan2)


def test_an_angle_has_no_unit() -> None:
    assert degree(parse("norm(x, y)*(1 + cos(atan2(y, x)/2))"), [x, y]) == 1
    assert degree(parse("norm(x, y)*(1 + atan2(y, x*norm(x, y)))"), [x, y]) is None


# -- all interpreters --------------------------------------------------------------------------------------------------

_ONE = ("sign", "sinh", "cosh", "abs", "tanh", "pos", "atan", "exp", "sin")


def drawn(rng: Random, depth: int) -> str:
    """A formula with many of the words above in it, defined almost everywhere."""
    if depth == 0:
        return rng.choice(("x", "y", "x - y", "x/2", "2*y", "1/3", "x + 1", "-y"))
    one, two = drawn(rng, depth - 1), drawn(rng, rng.randrange(depth))
    match rng.randrange(9):
        case 0:
            return f"({one} {rng.choice('+-*')} {two})"
        case 1:
            return f"({one})/(2 + cosh(tanh({two})))"
        case 2:
            return f"{rng.choice(('asin', 'acos'))}({rng.choice(('tanh', 'sin', ''))}({one}))"
        case 3:
            return f"atan2({one}, {two})"
        case 4:
            return f"log10({rng.choice(('2 + tanh', ''))}({one}))"
        case 5:
            first, second = f"{one} {rng.choice(('<', '>='))} {two}", f"{two} {rng.choice(('<=', '>'))} 1/2"
            return f"where({first} {rng.choice(('and', 'or'))} {second}, {two}, {one})"
    return f"{rng.choice(_ONE)}({one})"


def _near(value: Any, fine: Any) -> bool:
    return bool(abs(value - fine) <= 1e-7 * (1 + abs(fine)))


@pytest.mark.slow
@pytest.mark.parametrize("count", mostly_long([100, 300], 100))
def test_every_interpreter_has_the_value_of_mpmath(count: int) -> None:
    """Formulas at exact points, often on a cut or a jump: the value, or that there is none."""
    rng, defined, open_cases = Random(7), 0, 0
    for _ in range(count):
        try:
            expr = parse(drawn(rng, rng.choice((1, 2, 2, 3))))
        except InputError:  # atan2(0, 0), acos(4/3) or atan2 within atan2
            continue
        names = sorted(expr.free_symbols, key=str)
        at = {s: Fraction(rng.choice((0, 1, -1, rng.randint(-64, 64), rng.randint(-64, 64))), 32) for s in names}
        fine, plain = mpmath_.evaluate(expr, at, 60), float(numpy_.evaluate(expr, {s: float(v) for s, v in at.items()}))
        with balls.precision(240):
            enclosed = balls.enclose(expr, {s: balls.ball(v) for s, v in at.items()})
        if mpmath.isnan(fine):
            assert math.isnan(plain) and not enclosed.is_finite(), expr
            continue
        if not enclosed.is_finite() or enclosed.rad() > 1e-30:  # a comparison or a range whose border is met
            open_cases += 1
            continue
        if abs(fine) > 1e6:
            continue
        defined += 1
        assert enclosed.overlaps(flint.arb(mpmath.nstr(fine, 55))), expr
        assert _near(plain, fine), expr
        assert _near(fold(expr, DOUBLES, lambda leaf, at=at: float(at[leaf]) if leaf in at else float(leaf)), fine), expr
        written = mpmath_.evaluate(parse_as_written(formula(expr), KNOWN), at, 60)
        assert _near(written, fine), expr
        if names:
            jet, _ = jets.formula(expr, names, [])(np.array([[float(at[s]) for s in names]]), [])
            assert _near(jet.value[0], fine), expr
            series = [flint.arb_series([balls.ball(v), 1], prec=2) for v in at.values()]
            (line,) = ball_series.compiled([expr], names)(*series)
            here = line[0] if isinstance(line, flint.arb_series) else line
            assert not here.is_finite() or here.overlaps(flint.arb(mpmath.nstr(fine, 55))), expr
    assert defined > count / 2 and open_cases < count / 7.5
