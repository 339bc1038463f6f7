"""The safe parser: what the language means, what it refuses and where, and that random text meets nothing but InputError."""

import math
from decimal import Decimal
from fractions import Fraction

import flint
import numpy as np
import pytest
import sympy as sp
from hypothesis import assume, given
from hypothesis import strategies as st

from duhem.errors import InputError
from duhem.expression import WORDS, Neg, Norm, Pos, Where, symbol
from duhem.expression.build import call, power, product, total, unacceptable
from duhem.expression.number import exact_number, fraction, ratio, rational
from duhem.expression.parse import parse_expression, parse_relation
from duhem.expression.syntax import PlacedText
from duhem.expression.text import formula

x, y = symbol("x"), symbol("y")
m, s = symbol("m", positive=True), symbol("s", nonpositive=True)
KNOWN = {"x": x, "y": y, "m": m, "s": s}


def parse(text: str) -> sp.Expr:
    return parse_expression(PlacedText(text, "law.toml", 7, 4), KNOWN)


MEANINGS = {
    "1 + 2*3 - 4/8": sp.Rational(13, 2),
    "-x**2": -(x**2),
    "2**-1": sp.Rational(1, 2),
    "2**3**2": sp.Integer(512),
    "x - y - m": x - y - m,
    "x / y / m": x / (y * m),
    "0.15*x": sp.Rational(3, 20) * x,
    "1e-6 + .5 + 2.": sp.Rational(2500001, 1000000),
    "2*pi*x": 2 * sp.pi * x,
    "norm(x/m, y)": Norm(x / m, y),
    "abs(s)": -s,
    "pos(x) - neg(x)": Pos(x) - Neg(x),
    "where(x >= 0, m, y)": Where(x >= 0, m, y),
    "where(m > 0, x, y)": x,
    "where(x > 0 or y < 1 and m > 2, m, s)": Where(x > 0, m, Where(y < 1, Where(m > 2, m, s), s)),
    "where((x > 0 or y < 1) and m > 2, m, s)": Where(x > 0, Where(m > 2, m, s), Where(y < 1, Where(m > 2, m, s), s)),
    "atan2(y, m) + atan2(1, 0) + atan2(0, s - 1)": sp.atan(y / m) + sp.pi / 2 + sp.pi,
    "sign(m) + log10(100) + sinh(0) + cosh(0) + asin(0) + acos(1)": sp.Integer(4),
    "min(x, y, 0)": sp.Min(x, y, 0),
    "sqrt(4) + exp(0) + log(1) + sin(0) + cos(0) + tan(0) + tanh(0) + atan(0)": sp.Integer(4),
    "tan(x + pi/2)": -1 / sp.tan(x),
    "x\n  + y": x + y,
    "x\r\n+ y": x + y,
    "+x": x,
}


@pytest.mark.parametrize("text", MEANINGS)
def test_meaning(text: str) -> None:
    assert parse(text) == MEANINGS[text]


# Each fault with the column of the offending token (the text begins at line 7, column 5) and a word of the message.
FAULTS = {
    "": (5, "empty"),
    "x +": (7, "ends after '+'"),
    "x y": (7, "'y' after 'x'"),
    "2x": (6, "'x' after '2'"),
    "x + mu_c": (9, "unknown name 'mu_c'"),
    "x.real": (6, "attributes are not part"),
    "x ^ 2": (7, "write ** for a power"),
    "x = 2": (7, "comparisons are"),
    "x // 2": (7, "write / for a division"),
    "x + [y]": (9, "group with ( and )"),
    "x + 'y'": (9, "unexpected"),
    "x # y": (7, "comments outside"),
    "(x": (5, "never closed"),
    "x)": (6, "unexpected ')'"),
    "x, y": (6, "commas separate arguments"),
    "max(x, (y, m))": (14, "commas separate arguments"),
    "max(*x)": (9, "unexpected '*'"),
    "max(x,)": (11, "unexpected ')'"),
    "norm": (5, "needs its arguments"),
    "norm()": (10, "unexpected ')'"),
    "y + abs(x, y)": (9, "takes 1 argument, not 2"),
    "open(x)": (5, "not a function"),
    "m(x)": (5, "write m*(...)"),
    "__import__('os')": (5, "'__import__' is not a function"),
    "lambda": (5, "unknown name 'lambda'"),
    "x if y": (7, "'if' after 'x'"),
    "x > 0": (5, "first argument of where"),
    "where(x, y, m)": (5, "is no comparison"),
    "where(0 < x < 1, y, m)": (11, "chains comparisons"),
    "1_000": (6, "'_000' after '1'"),
    "0x1f": (6, "'x1f' after '0'"),
    "007": (5, "begins with 0"),
    "x - \u0661": (9, "the digits 0 to 9"),
    "1\u0661": (6, "the digits 0 to 9"),
    "x\u00b2": (5, "is not a name"),
    "m\u00b2": (5, "is not a name"),
    "1.2.3": (8, "'.3' after '1.2'"),
    "x\0": (6, "unexpected"),
    "1 + 1/0": (9, "division by zero"),
    "x/(y - y)": (5, "division by zero"),
    "1/(sqrt(2) + sqrt(3) - sqrt(5 + 2*sqrt(6)))": (5, "division by zero"),
    "log(0)": (5, "not finite"),
    "log(-2)": (5, "not real"),
    "sqrt(-1)": (5, "not real"),
    "sqrt(-m)": (5, "not real"),
    "log(s - m)": (5, "not real"),
    "x*sqrt(s - 1)": (7, "not real"),
    "(-m)**(1/3)": (5, "not real"),
    "(-8)**(1/3)": (5, "not real"),
    "(-2)**x": (5, "not real"),
    "0**x": (5, "not real"),
    "tan(pi/2)": (5, "not real and finite"),
    "9**9**9": (5, "exponent is too large"),
    "2**65": (5, "exponent is too large"),
    "x**1001": (5, "exponent is too large"),
    "x**-1e300": (5, "exponent is too large"),
    "1e999999": (5, "too large"),
    "1e-999999": (5, "too large"),
    "9" * 500: (5, "too long"),
    "exp(exp(100))": (5, "too large"),
    "(((2*x)**64)**64)**64": (5, "too large"),
    "(" * 100 + "x" + ")" * 100: (65, "nested too deeply"),
    "-" * 1500 + "x": (246, "nested too deeply"),
    "x" + "+x" * 2000: (4005, "too large"),
    "x" * 30_000: (5, "characters"),
    f"max({','.join('x' * 40)})": (5, "arguments"),
}


@pytest.mark.parametrize("text", FAULTS, ids=lambda text: text[:24].encode("unicode_escape").decode())
def test_fault_names_place_and_remedy(text: str) -> None:
    column, words = FAULTS[text]
    with pytest.raises(InputError) as caught:
        parse(text)
    assert caught.value.where == f"law.toml:7:{column}"
    assert words in str(caught.value)
    assert caught.value.remedy
    assert "\n" not in str(caught.value)


def test_place_on_a_later_line() -> None:
    with pytest.raises(InputError, match=r"^law\.toml:9:6: unknown name 'foo'"):
        parse("x +\n y\n   + foo")


@pytest.mark.parametrize(("name", "near"), [("nrom(x)", "norm"), ("mm", "m"), ("po", "pos")])
def test_nearest_name_is_suggested(name: str, near: str) -> None:
    with pytest.raises(InputError, match=f"did you mean '{near}'"):
        parse(name)


@pytest.mark.parametrize("word", ["asinh", "acosh", "atanh"])
def test_for_a_word_of_other_languages_the_formula_is_told(word: str) -> None:
    with pytest.raises(InputError, match=f"'{word}' is not a function of the language; write ") as fault:
        parse(f"{word}(x)")
    own = parse_expression(fault.value.remedy.removeprefix("write "), {"x": x})
    at = 1.5 if word == "acosh" else 0.5
    assert float(own.subs(x, at)) == pytest.approx(getattr(math, word)(at), rel=1e-14)


@pytest.mark.parametrize("name", ["norm", "pi", "lambda"])
def test_a_declared_name_may_not_hide_a_word(name: str) -> None:
    with pytest.raises(InputError, match="already means something"):
        parse_expression("x", {"x": x, name: symbol(name)})


def test_names_beyond_ascii_are_read_as_python_reads_them() -> None:
    fine = symbol("ﬁ")  # a ligature, which Python's own parser spells "fi"
    assert parse_expression("2*ﬁ + μ", {"ﬁ": fine, "μ": y}) == 2 * fine + y


def test_relations() -> None:
    assert parse_relation("x < m/2", KNOWN) == (x < m / 2)
    always = parse_relation("m > -1", KNOWN)
    assert isinstance(always, sp.StrictGreaterThan)
    assert (always.lhs, always.rhs) == (m, -1)
    with pytest.raises(InputError, match="contradictory"):
        parse_relation("m <= -1", KNOWN)
    for text in ("x", "x < y < m", "norm(x)"):
        with pytest.raises(InputError, match="compar"):
            parse_relation(text, KNOWN)


NUMBERS = [
    (3, Fraction(3)), ("3", Fraction(3)), ("0.15", Fraction(3, 20)), (" -1/2 ", Fraction(-1, 2)), ("1e-6", Fraction(1, 10**6)),
    (0.1, Fraction(1, 10)), (5e-324, Fraction(5, 10**324)), (Fraction(2, 6), Fraction(1, 3)), (Decimal("0.10"), Fraction(1, 10)),
    (sp.Rational(3, 7), Fraction(3, 7)), (sp.Float(0.1), Fraction(1, 10)), (np.float32(0.1), Fraction(1, 10)),
    (np.float64(0.1), Fraction(1, 10)), (np.int64(-4), Fraction(-4)), (np.float16(0.25), Fraction(1, 4)),
    (np.longdouble("0.1"), Fraction(1, 10)), (float(np.float16(0.1)), Fraction("0.0999755859375")),
    (float(np.float32(0.1)), Fraction("0.10000000149011612")), (Fraction(0.1), Fraction(0.1)),
]  # fmt: skip


@pytest.mark.parametrize(("given_as", "value"), NUMBERS, ids=repr)
def test_exact_number(given_as: object, value: Fraction) -> None:
    read = exact_number(given_as)
    assert isinstance(read, sp.Rational)
    assert Fraction(read.p, read.q) == value
    assert exact_number(ratio(read)) == read


@pytest.mark.parametrize("x", [np.float16(0.1), np.float16(65504.0), np.float16(-0.3), np.float32(1e-45)], ids=repr)
def test_a_number_that_holds_another_than_its_decimal_is_refused(x: np.floating) -> None:
    with pytest.raises(InputError, match=f"{type(x).__name__} holds {float(x)!r} where .* is written.* float\\(x\\)"):
        exact_number(x)
    assert Fraction(str(exact_number(float(x)))) == Fraction(repr(float(x)))


@pytest.mark.parametrize(
    "bad",
    [True, np.True_, None, math.nan, math.inf, np.float64("nan"), "", "x", "1/0", "1e", "--1", "1e999999", "٣", [1], 1j, sp.pi],
    ids=repr,
)
def test_what_is_no_number(bad: object) -> None:
    with pytest.raises(InputError):
        exact_number(bad)


TOKENS = st.sampled_from(
    [
        *WORDS,
        *KNOWN,
        "pi",
        "z",
        "(",
        "(",
        ")",
        ")",
        ",",
        "+",
        "-",
        "*",
        "/",
        "**",
        "<",
        ">=",
        "0",
        "1",
        "2",
        "0.5",
        "1e9",
        "9",
        " ",
        "\n",
        "=",
        ".",
    ]
)
SOUP = st.lists(TOKENS, max_size=14).map("".join) | st.lists(TOKENS, max_size=14).map(" ".join)


@pytest.mark.slow
@given(st.text(max_size=60) | SOUP)
def test_random_text_meets_nothing_but_input_errors(text: str) -> None:
    try:
        value = parse(text)
    except InputError as fault:
        assert fault.where.startswith("law.toml:")
    else:
        assert unacceptable(value, set(KNOWN.values())) is None


def _grow(inner: st.SearchStrategy[str]) -> st.SearchStrategy[str]:
    """Formulas put together without brackets, so that precedence decides what they mean."""
    two = st.tuples(inner, inner)
    return st.one_of(
        st.tuples(inner, st.sampled_from(["+", "-", "*", " - ", "*-"]), inner).map("".join),
        inner.map("-{}".format), inner.map("({})".format), inner.map("({})**2".format), inner.map("{}/4".format),
        inner.map("abs({})".format), inner.map("pos({})".format), inner.map("neg({})".format),
        two.map(lambda p: f"max({p[0]}, {p[1]})"), two.map(lambda p: f"min({p[0]}, {p[1]}, 1)"),
        inner.map("sign({})".format),
        st.tuples(inner, st.sampled_from(["<", "<=", ">", ">="]), inner, inner, inner).map(lambda p: "where({}{}{}, {}, {})".format(*p)),
        st.tuples(inner, inner, st.sampled_from(["and", "or"]), inner, inner).map(
            lambda p: "where({}<0 and {}>1 {} {}<=1, {}, 2)".format(*p)
        ),
    )  # fmt: skip


ARITHMETIC = {
    "abs": abs, "max": max, "min": min, "pos": lambda v: max(v, 0), "neg": lambda v: max(-v, 0), "where": lambda c, a, b: a if c else b,
    "sign": lambda v: (v > 0) - (v < 0),
}  # fmt: skip


@pytest.mark.slow
@given(st.recursive(st.sampled_from(["x", "y", "m", "2", "0.5", "3"]), _grow, max_leaves=6))
def test_the_value_is_python_s(text: str) -> None:
    point = {"x": 0.75, "y": -1.5, "m": 2.0}
    expected = eval(text, {"__builtins__": {}}, ARITHMETIC | point)  # our own text; dyadic numbers keep it nearly exact
    exact = parse(text).subs({KNOWN[name]: sp.Rational(value) for name, value in point.items()})
    assert float(exact) == pytest.approx(expected, rel=1e-12, abs=1e-12)


@st.composite
def expressions(draw: st.DrawFn) -> sp.Expr:
    """Random trees over the whole vocabulary, built as the parser builds them."""
    numbers = st.sampled_from([sp.Integer(2), sp.Rational(1, 3), sp.Integer(-1), sp.pi])
    stack = draw(st.lists(st.sampled_from([x, y, m, s]) | numbers, min_size=1, max_size=3))
    for _ in range(draw(st.integers(1, 7))):
        a, b = draw(st.sampled_from(stack)), draw(st.sampled_from(stack))
        word = draw(st.sampled_from([*WORDS, "+", "-", "*", "/", "**"]))
        try:
            match word:
                case "+":
                    stack.append(total([a, b], []))
                case "-":
                    stack.append(total([a], [b]))
                case "*":
                    stack.append(product([a, b], []))
                case "/":
                    stack.append(product([a], [b]))
                case "**":
                    stack.append(power(a, draw(st.sampled_from([sp.Integer(2), sp.Integer(3), sp.Rational(1, 2), sp.Integer(-1), b]))))
                case "where":
                    stack.append(call("where", [draw(st.sampled_from([a < b, a >= b])), b, a]))
                case _:
                    stack.append(call(word, [a, b] if WORDS[word].most is None else [a]))
        except (InputError, TypeError, ValueError):  # SymPy will not compare what may be complex, such as log(x)
            assume(False)
    return stack[-1]


POINT = {x: sp.Rational(7, 5), y: sp.Rational(-3, 4), m: sp.Rational(5, 3), s: sp.Rational(-2, 7)}


@pytest.mark.slow
@given(expressions())
def test_what_is_printed_reads_back(expr: sp.Expr) -> None:
    """As the same tree; or, where SymPy builds a constant such as 1/(1 + sqrt(3)) in several ways, as the same value."""
    assume(unacceptable(expr, set(KNOWN.values())) is None)
    read = parse(formula(expr))
    assert read == expr or abs((read - expr).subs(POINT).evalf(30)) < 1e-20


def test_fractions_and_rationals_are_one_number() -> None:
    for value in (Fraction(-22, 7), Fraction(5), Fraction(0), Fraction(1, 10**30)):
        assert rational(value) == sp.Rational(value.numerator, value.denominator)
        assert fraction(rational(value)) == value == fraction(value)
        assert fraction(flint.fmpq(value.numerator, value.denominator)) == value
    assert fraction(sp.Integer(3)) == 3 and fraction(0.1) == Fraction(0.1)
