"""Loops in LLVM's text do to the bit what Python does, and what has no place there is refused."""

from __future__ import annotations

import ast
from typing import Any

import numpy as np
import pytest
import sympy as sp

import duhem
from duhem.projection import code_cache, compiled_judge, compiled_newton
from duhem.projection.code_cache import compiled_text, interpreted_text
from duhem.projection.increment import setting
from duhem.projection.llvm_loops import lowered
from duhem.projection.llvm_values import NotLowered
from duhem.projection.scaled_formula import level_of

WORDS = """
import numpy as np
from math import floor, frexp, isfinite, ldexp
from numpy import arctan2, cos, exp, expm1, hypot, inf, isnan, log, maximum, minimum, nan, sqrt, tanh

FEW, ROWS, SHARES = 3, 2 ** 2, (0.3, -2.0)


def arithmetic(x, y):
    return (x + 2) * y - x / 3 + 2.0 ** -7 + abs(x - y) - -y


def powers(x, y):
    return abs(x) ** 2.5 + 2.0 ** y


def comparisons(x, y):
    return (1 if x < y else 0) + (2 if x <= y else 0.0) + (4 if x != y else 0) + (8.0 if 0 < x < y else 0) + (16 if not x > y else 0)


def extremes(x, y):
    return max(x, y) + 3.0 * min(y, x, 0.25) + maximum(x, y) + minimum(x, y) + max(2, FEW)


def bits(x, y):
    unit = float(np.int64(np.float64(abs(y) + 2.0 ** -1022).view(np.int64) & 0x7FF0000000000000).view(np.float64))
    return unit + frexp(x)[0] + frexp(y)[1] + ldexp(y, int(floor(3.7)))


def words(x, y):
    return cos(x) + exp(-abs(y)) + expm1(y / 9) + hypot(x, y) + arctan2(x, y) + log(1.0 + abs(x)) + sqrt(abs(y)) + tanh(x)


def finite(x, y):
    return (1 if isfinite(x) else 0) + (2 if isnan(y) else 0) + (4 if isfinite(1.0 / (y - y)) else 0)


def noted(v, at):
    v[at, 0] += 1.0
    return v[at, 0] > 1.5


def decided_in_order(x, y):
    v = np.empty((2, 2))
    v[0, 0] = v[1, 0] = 0.0
    sure = (noted(v, 0) and noted(v, 1)) or (x > y and noted(v, 1)) or noted(v, 0)
    return v[0, 0] + 10.0 * v[1, 0] + (100 if sure else 0) + (1000 if 2.0 < x < noted(v, 1) else v[1, 0])


def widened(x, y):
    total = 0
    for i in range(FEW):
        if total > 1:
            total = total / 2 + x
        total += i
    return total


def loops(x, y):
    total, seen, left = 0.0, 0, 9
    for i in range(ROWS, -2, -2):
        for share in SHARES:
            total += share * i * x
        if i == 2:
            continue
        seen += i % 3 + (i - 5) % 3
    while True:
        left -= 1
        if left < 4 or y > left:
            break
        total = total * y + left
    return total + seen + i + left


def exchanged(x, y):
    v, w = np.empty((FEW, 2)), np.empty(2 * FEW)
    for i in range(FEW):
        v[i, 0], v[i, 1] = x * i, y
        w[2 * i] = w[2 * i + 1] = i
    v[0, 0], v[2, 1] = v[2, 1], v[0, 0] + 1
    return total(v, w, (x, 2.0) + (y,))


def total(v, w, q):
    found = 0.0
    for i in range(v.shape[0]):
        data, count = both(v[i, 0], i)
        found += v[i, 0] * q[0] + v[i, 1] * q[2] + data[0] - data[1] * count + len(q)
    return found + below(w, 2)


def both(x, i):
    return (x, x * 0.5), i + 1


def below(w, first):
    rest = tail(w, first)
    return rest[0] - rest[3] * rest.shape[0]


def tail(w, first):
    return w[first:]


def bytes_and_counts(x, y):
    found = 0.0
    for chosen in range(1, 1 << FEW):
        for j in range(FEW):
            if (chosen >> j) & 1:
                found += j * x
    moved = x != y
    moved = moved | (y > 0.0) & (x > 0.0)
    return found + moved


def nothing(out, n, value):
    out[n] = value
    return


def run(given, out):
    for n in range(given.shape[0]):
        x, y = given[n, 0], given[n, 1]
"""
CASES = [node.name for node in ast.parse(WORDS).body if isinstance(node, ast.FunctionDef) and [a.arg for a in node.args.args] == ["x", "y"]]
TEXT = WORDS + "".join(f"        nothing(out[{k}], n, {name}(x, y))\n" for k, name in enumerate(CASES))
SPECIAL = [0.0, -0.0, 1.0, 2.0, 5e-324, -3.5, 1e300, np.inf, -np.inf, np.nan]


@pytest.fixture(scope="module")
def answers(tmp_path_factory: pytest.TempPathFactory) -> tuple[Any, Any, Any]:
    pytest.importorskip("numba")
    draw = np.random.default_rng(6)
    ordinary = draw.normal(size=(200, 2)) * 2.0 ** draw.integers(-4, 4, (200, 1))
    given = np.vstack([np.array([[x, y] for x in SPECIAL for y in SPECIAL]), ordinary])
    found, wanted = np.zeros((len(CASES), len(given))), np.zeros((len(CASES), len(given)))
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("DUHEM_CACHE_DIR", str(tmp_path_factory.mktemp("loops")))
        run = compiled_text(TEXT, "run")
        run(given, found)
    assert run._lowered
    of_numpy = TEXT.replace("floor, frexp, isfinite, ldexp", "floor, isfinite\nfrom numpy import frexp, ldexp")
    with np.errstate(all="ignore"):
        interpreted_text(of_numpy, "run")(given, wanted)
    return given, found, wanted


@pytest.mark.slow
@pytest.mark.parametrize("name", CASES)
def test_each_construction_is_pythons(name: str, answers: tuple[Any, Any, Any]) -> None:
    given, found, wanted = answers
    mine, own = found[CASES.index(name)], wanted[CASES.index(name)]
    if name in ("words", "powers"):  # of another library
        assert np.allclose(mine, own, rtol=1e-14, equal_nan=True)
    else:
        assert [x for x, a, b in zip(given.tolist(), mine, own, strict=True) if not (a == b or (a != a and b != b))] == []
    assert np.isfinite(mine).sum() > 200


REFUSED = {
    "a word": "import os\ndef f(x):\n    return os.getpid()",
    "another word": "def f(x):\n    return round(x)",
    "an index from the end": "def f(v):\n    return v[-1]",
    "an array of two sizes": "import numpy as np\ndef f(x):\n    a = np.empty(2)\n    if x > 0:\n        a = np.empty(3)\n    return a[0]",
    "an array of one branch": "import numpy as np\ndef f(x):\n    if x > 0.0:\n        a = np.empty(3)\n    return a[0]",
    "an array and a number": "import numpy as np\ndef f(x):\n    a = 1.0\n    a = np.empty(3)\n    return a[0]",
    "a size that is not known": "import numpy as np\ndef f(n):\n    a = np.empty(n)\n    return a[0]",
    "a step that is not known": "def f(n):\n    for i in range(0, 5, n):\n        n = i\n    return n",
    "a local before it is given": "later = 2\ndef f(x):\n    a = later\n    later = x\n    return a",
    "a directory": "def f(x):\n    return {x: 1}[x]",
    "more than a number": "def f(x):\n    return x, x",
    "what else there is": "def f(x):\n    for i in range(2):\n        x += 1\n    else:\n        x = 0.0\n    return x",
    "what may fail": "def f(x):\n    try:\n        return x\n    except ValueError:\n        return 0.0",
    "a slice that ends": "def f(v):\n    return v[1:2][0]",
    "a text": "def f(x):\n    return 'a'",
    "a recursion": "def f(x):\n    return f(x - 1.0) if x > 0.0 else x",
    "an end without a number": "def f(x):\n    if x > 0.0:\n        return x",
    "an array of its own": "import numpy as np\ndef g(x):\n    a = np.empty(2)\n    return a[1:]\ndef f(x):\n    return g(x)[0]",
    "an index that is worked out twice": "def g(v):\n    v[0] += 1.0\n    return 0\ndef f(v):\n    v[g(v)] += 1.0\n    return 0",
    "an index of too few": "def f(w):\n    return w[0]",
}


@pytest.mark.parametrize("case", REFUSED)
def test_what_has_no_place_is_refused(case: str) -> None:
    kinds = {"x": "double", "n": "i64", "v": ("double", 1, "C"), "w": ("double", 2, "C")}
    space: dict[str, Any] = {}
    exec(REFUSED[case], space)
    with pytest.raises(NotLowered):
        lowered(REFUSED[case], space, "f", (kinds[space["f"].__code__.co_varnames[0]],), "f")


@pytest.mark.slow
@pytest.mark.parametrize("name", ["antoni2007", "tresca-tensor", "griffith", "cpb06"])
def test_nothing_of_a_law_is_left_to_numba(name: str) -> None:
    law = duhem.load(name)
    row, table = ("double", 1, "C"), ("double", 2, "C")
    numbers = {p: sp.Rational(3, 10) if sp.Rational(3, 10) in own else 2 for p, own in law.parameters.items() if own.value is None}
    asked = setting(law, 1.0, numbers)
    made = compiled_newton._made(asked.g, law.force_symbols(), asked.pressure_symbol, "solve", ())
    assert made is not None
    solved = (table, table, "i64", "double", table, ("double", 3, "C"), table, row, ("i8", 2, "C"), table, table, table, table, row)
    loop = compiled_judge._text(level_of(asked), law.force_symbols(), True)
    assert loop is not None
    constants = [("tuple", *["double"] * len(numbers)) for numbers in loop.constants]
    found = ("tuple", *[row] * 5)
    chunk = (
        row, row, "double", *constants, *[table] * 7, row, *["double"] * 4, row, row, row, row, ("i8", 1, "C"), found, table, table,
        ("double", 2, "F"), table, ("i64", 1, "C"),
    )  # fmt: skip
    for text, entry, kinds in ((made[0], "solved", solved), (loop.text, "chunk", chunk)):
        space: dict[str, Any] = {}
        exec(text, space)
        assert f"@{entry}.made(" in lowered(text, space, entry, kinds, f"{entry}.made")[0]


@pytest.mark.slow
def test_numba_has_what_cannot_be_lowered(tmp_path: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("numba")
    monkeypatch.setenv("DUHEM_CACHE_DIR", str(tmp_path))
    text = "def last(v):\n    return v[-1]\n\n\ndef run(v):\n    return 2.0 * last(v)\n"
    run = code_cache.CompiledText(text, "run")
    assert run(np.array([1.0, 2.5])) == 5.0 and not run._lowered
    assert code_cache.CompiledText(text, "run")(np.array([1.0, 3.5])) == 7.0
